"""The body of a C function while it is printed: its variables, and the statements that make them."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from itertools import count
from textwrap import TextWrapper
from typing import TYPE_CHECKING

from symflex.codegen.c.expression import CPrinter, Kind, Term, complex_term
from symflex.codegen.c.names import TAKEN
from symflex.codegen.c.plan import modal_plan
from symflex.codegen.program import (
    Assignment,
    CodeNode,
    ModalValue,
    ModeValues,
    Roots,
    Solutions,
    identifiers,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

WIDTH = 88
"""Columns of generated C."""

STEP = "    "

S = Term("s", Kind.COMPLEX, varies=True)
AXIS = Term("w", Kind.IMAGINARY, varies=True)
POSITIVE = Term("w", Kind.REAL, varies=True)
LANE = Term("w[j]", Kind.REAL, varies=True)
AXIS_LANE = Term("w[j]", Kind.IMAGINARY, varies=True)
"""What s is: complex; j w; the frequency w of a response in real arithmetic; the last two, one of several."""

_NUMBERED = re.compile(r"[a-z]_\d{1,9}")


def statement(opening: str, value: str, depth: int) -> list[str]:
    """Return ``opening value;`` on as many lines as it needs.

    Examples
    --------
    >>> statement("return", "a + b", 1)
    ['    return a + b;']
    """
    indent = STEP * depth
    line = f"{indent}{opening} {value};"
    if len(line) <= WIDTH:
        return [line]
    # Only between operators: an identifier longer than a line stays whole.
    wrapper = TextWrapper(
        width=WIDTH,
        initial_indent=indent,
        subsequent_indent=indent + STEP,
        break_long_words=False,
        break_on_hyphens=False,
    )
    return wrapper.wrap(f"{opening} {value};")


@dataclass
class Body:
    """The variables of one C function, and the statements that make them."""

    # Identifiers of the variables that hold parameters, by the names in the model.
    parameters: Mapping[str, str]
    s: Term  # what s is
    depth: int = 1  # how far statements are indented
    lines: list[str] = field(default_factory=list)  # the statements so far
    known: dict[str, Term] = field(default_factory=dict)  # assigned values by their names in the program
    used: set[str] = field(default_factory=set)  # names of the parameters in use
    orders: set[int] = field(default_factory=set)  # orders of the differential equations solved
    _taken: set[str] = field(default_factory=set)
    _shared: dict[tuple[str, Kind], Term] = field(default_factory=dict)

    @classmethod
    def of(cls, members: Mapping[str, str], s: Term) -> Body:
        """Return the scope of a function of parameters that are members of a structure."""
        own = cls(identifiers(members, TAKEN), s)
        own._taken |= {*TAKEN, *own.parameters.values()}
        return own

    def within(self, depth: int | None = None) -> Body:
        """Return the scope of a block: it sees these variables, and what it makes stays known to itself."""
        return replace(self, depth=depth or self.depth + 1, lines=[], known=dict(self.known))

    def name(self, wanted: str) -> str:
        """Return an identifier that nothing else in the function has."""
        found = wanted
        if not _NUMBERED.fullmatch(wanted):
            found = identifiers({"": wanted}, self._taken)[""]
        elif wanted in self._taken:
            stem, _, number = wanted.partition("_")
            others = (f"{stem}_{n}" for n in count(int(number)))
            found = next(other for other in others if other not in self._taken)
        self._taken.add(found)
        return found

    @property
    def printer(self) -> CPrinter:
        """Prints expressions of these variables."""
        in_lanes = self.s in (LANE, AXIS_LANE)
        return CPrinter(self._parameter, self.known, self.s, self._array, self._hold, in_lanes)

    def term(self, node: CodeNode) -> Term:
        """Return an expression of these variables."""
        return self.printer.print(node)

    def say(self, opening: str, value: str) -> None:
        """Add a statement."""
        self.lines += statement(opening, value, self.depth)

    def add(self, *lines: str) -> None:
        """Add lines as they are, indented."""
        self.lines += [STEP * self.depth + line for line in lines]

    def assign(self, assignments: Sequence[Assignment]) -> None:
        """Make variables; what is free of s and made already is not made again."""
        for assignment in assignments:
            if isinstance(assignment.value, Solutions | Roots | ModeValues | ModalValue):
                self.known[assignment.name] = self._array(assignment.value, assignment.name)
                continue
            term = self.printer.whole(assignment.value)
            key = (term.text, term.kind)
            if term.varies:
                self.known[assignment.name] = self.hold(assignment.name, term)
                continue
            if key not in self._shared:
                self._shared[key] = self.hold(assignment.name, term)
            self.known[assignment.name] = self._shared[key]

    def hold(self, wanted: str, term: Term) -> Term:
        """Make a variable with a value."""
        name = self.name(wanted)
        self.say(f"const {term.kind.type} {name} =", term.text)
        return Term(name, term.kind, term.varies)

    def opening(self, members: Mapping[str, str]) -> list[str]:
        """Return the lines that take the parameters in use out of their structure."""
        lines = [
            f"{STEP}const double {variable} = p->{members[name]};"
            for name, variable in self.parameters.items()
            if name in self.used
        ]
        return lines or [f"{STEP}(void)p;"]

    def _hold(self, term: Term) -> Term:
        return self.hold("t_1" if term.varies else "c_1", term)

    def _parameter(self, name: str) -> str:
        self.used.add(name)
        return self.parameters[name]

    def _array(self, node: CodeNode, wanted: str = "solutions") -> Term:
        match node:
            case Solutions(coefficients, count):
                given, order, varies = self._given(coefficients)
                self.orders.add(order)
                found = self.name(wanted)
                call = (
                    f"cx_series({given}, {order}, {count}," if count else f"cx_propagated({given}, {order},"
                )
                self.add(f"cx {found}[{order}];", f"{call} {found});")
                return Term(found, Kind.COMPLEX, varies)
            case Roots(coefficients):
                given, order, varies = self._given(coefficients)
                self.orders.add(order)
                found = self.name(wanted)
                self.add(f"cx {found}[{order + 1}];", f"cx_roots({given}, {order}, {found});")
                return Term(found, Kind.COMPLEX, varies, real_at=order)
            case ModeValues(roots, length):
                held, scale = self.printer.listed(roots), complex_term(self.term(length))
                found = self.name(wanted)
                self.add(f"cx_mode {found};")
                self.say(f"cx_modes({held.text}, {held.real_at},", f"{scale.text}, &{found})")
                return Term(found, Kind.COMPLEX, held.varies or scale.varies)
            case ModalValue():
                return self._modal(node, wanted)
        message = f"no text for {type(node).__name__}"
        raise TypeError(message)

    def _given(self, nodes: Sequence[CodeNode]) -> tuple[str, int, bool]:
        """Declare an array of coefficients; return its name, its length and whether it depends on s."""
        terms = [complex_term(self.term(c)) for c in nodes]
        given = self.name("coefficients")
        self.say(f"const cx {given}[{len(terms)}] =", f"{{{', '.join(t.text for t in terms)}}}")
        return given, len(terms), any(t.varies for t in terms)

    def _modal(self, node: ModalValue, wanted: str) -> Term:
        modes = [self.printer.listed(mode) for mode in node.modes]
        given, _, varies = self._given(node.coefficients)
        plan, most = modal_plan(node.frames)
        names = [self.name(x) for x in ("modes", "plan", "sums", wanted)]
        self.say(f"const cx_mode *const {names[0]}[] =", f"{{{', '.join(f'&{m.text}' for m in modes)}}}")
        self.say(f"static const int {names[1]}[] =", f"{{{', '.join(map(str, plan))}}}")
        self.add(f"cx {names[2]}[{most}], {names[3]}[2];")
        self.say(f"cx_modal({names[0]}, {given}, {names[1]},", f"{names[2]}, {names[3]})")
        return Term(names[3], Kind.COMPLEX, varies or any(m.varies for m in modes), real_at=1)
