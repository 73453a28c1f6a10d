"""What an export target is, and the one driver of all languages that numeric code is printed in.

Input: the transfer functions of a model.
Output: an :class:`Export`. For numeric code a program is chosen for each function and measured against ball
arithmetic; what a language prints is made of these :class:`Contents` alone, and of the functions that
generated code calls. These stand in files of the language, ``codegen/sources``, cut into parts by lines
that say what each defines; code gets the parts it calls and those that they call, in the order of the file::

    #: _mean_over_circle
    function _mean_over_circle(parts, s, points)
    ...
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cache
from importlib import resources
from math import inf, isfinite
from typing import Protocol

from symflex.budget import spend
from symflex.codegen.module_text import (
    default_value,
    described,
    formula_of,
    identifiers,
    inert,
    origin_lines,
    wrapped,
)
from symflex.codegen.program.band import is_closed
from symflex.codegen.program.nodes import Piecewise
from symflex.codegen.program.verify import (
    SAMPLES,
    Verification,
    choose_band,
    choose_programs,
    frequency_text,
)
from symflex.errors import BudgetError
from symflex.model import Model, ModelParameter
from symflex.model.loss_factors import check_causal
from symflex.transfer import AnyTransferFunction

MATRIX = "transfer_matrix"  # what the function of all entries is called
BAND = "band"  # the form of code that is a product over poles and zeros
ACCURACY = 1e-13  # relative error of exported code above which the user is warned
LOST = 1e-8  # that of a formula with kernels, half of a double's digits, above which the band form is better
CLOSED_OPERATIONS = 3_000
"""Operations of a formula with kernels up to which it is code in every language: some 110 kilobytes of C. Two
beams have 1,000, in tension 3,000; a portal frame has 4,000, and two Timoshenko beams 12,000."""
NO_FORMULA = "it has no short formula, and only code for numpy solves equations at every frequency"


@dataclass(frozen=True, slots=True)
class Export:
    """What an exporter made."""

    text: str  # the file's content
    warnings: tuple[str, ...] = ()  # what the user should know, for instance an accuracy that was not reached
    notes: tuple[str, ...] = ()  # what is in band form, up to where and why
    companions: Mapping[str, str] = field(default_factory=dict)  # files that belong beside it, by suffix
    archive: bytes = b""  # in place of the text, where the file is no text
    name: str = ""  # of the module or main function, where the language has such
    # How well the functions agree with ball arithmetic: one for each function of s, in order, then one for
    # each frequency response in real arithmetic.
    verified: tuple[Verification, ...] = ()


class Exporter(Protocol):
    """Turns the transfer functions of a model into a file of some language."""

    @property
    def suffix(self) -> str:
        """The end of the file's name."""
        ...

    @property
    def summary(self) -> str:
        """What is made, in a line."""
        ...

    @property
    def solves(self) -> bool:
        """True to get functions of networks as equations, from which values at points are computed."""
        ...

    def export(
        self, model: Model, tfs: Sequence[AnyTransferFunction], stem: str = "", *, is_alone: bool = True
    ) -> Export:
        """Return the file of transfer functions; ``stem`` is its name without suffix, empty for none."""
        ...


@dataclass(frozen=True, slots=True)
class Member:
    """One function of a file."""

    tf: AnyTransferFunction  # whose values it computes
    program: Piecewise  # of s; of the angular frequency where it is real
    wanted: str  # the name it has where the language and the other names admit it
    verification: Verification  # how well it agrees with ball arithmetic
    formula: tuple[str, ...]  # in paragraphs, or a sentence on one that is long
    is_response: bool = False  # true for the frequency response, at s = j omega
    note: str = ""  # of a band form: where it ends, and why there is one

    @property
    def headline(self) -> str:
        """What it computes, in one inert line."""
        tf, how = self.tf, ", in real arithmetic" if self.program.is_real else ""
        at = f" at s = j omega{how}" if self.is_response else ""
        unit = f" [{tf.unit}]" if tf.unit else ""
        return inert(f"{tf.quantity[:1].upper()}{tf.quantity[1:]} {tf.name}{unit}{at}.")

    @property
    def parameters(self) -> tuple[ModelParameter, ...]:
        """The parameters it takes, in declared order."""
        return tuple(p for p in self.tf.model.parameters if p.name in self.program.parameters)

    @property
    def is_fixed(self) -> bool:
        """True for a band form, which consists of numbers."""
        return self.verification.form == BAND

    @property
    def key(self) -> str:
        """Tells it from the other members."""
        return f"{'at' if self.is_response else 'of'} {self.tf.name}"


@dataclass(frozen=True, slots=True)
class MatrixMember:
    """The function that returns all values of a matrix at once."""

    rows: tuple[tuple[Member, ...], ...]  # the functions of s of its entries, a row per output
    # Computes all entries, row by row, and shares what they have in common; None where each is called.
    program: Piecewise | None = None
    verification: Verification | None = None  # how well the worst entry of the program agrees

    @property
    def each(self) -> tuple[Member, ...]:
        """The functions of all entries, row by row."""
        return tuple(member for row in self.rows for member in row)

    @property
    def shape(self) -> tuple[int, int]:
        """How many outputs and inputs it has."""
        return len(self.rows), len(self.rows[0])

    @property
    def parameters(self) -> tuple[ModelParameter, ...]:
        """The parameters that some entry takes, in declared order."""
        used = {p.name for member in self.each for p in member.parameters}
        return tuple(p for p in self.rows[0][0].tf.model.parameters if p.name in used)

    @property
    def headline(self) -> str:
        """What it computes, in one inert line."""
        outputs = ", ".join(row[0].tf.output.name for row in self.rows)
        inputs = ", ".join(member.tf.input.name for member in self.rows[0])
        return inert(f"Transfer matrix of {outputs} (rows) by {inputs} (columns).")


@dataclass(frozen=True, slots=True)
class Contents:
    """What a file of numeric code consists of, in no language yet."""

    model: Model  # title, source and parameters
    # One for each transfer function, each followed by its frequency response where there is one.
    members: tuple[Member, ...]
    stem: str  # the file's name without suffix; empty for none
    is_alone: bool  # there can be no other files beside it
    matrix: MatrixMember | None = None  # the function of all at once, where one is wanted

    def names(self, reserved: Collection[str]) -> tuple[Mapping[str, str], Mapping[str, str]]:
        """Return identifiers of members by their keys, and of parameters by their names."""
        public = identifiers({m.key: m.wanted for m in self.members}, reserved)
        wanted = {p.name: p.name for p in self.model.parameters}
        return public, identifiers(wanted, {*reserved, *public.values()})

    @property
    def notes(self) -> tuple[str, ...]:
        """The notes on band forms that a user reads."""
        return tuple(member.note for member in self.members if member.note)

    @property
    def verified(self) -> tuple[Verification, ...]:
        """How well members agree with ball arithmetic: functions of s, then responses."""
        ordered = sorted(self.members, key=lambda member: member.is_response)
        return tuple(member.verification for member in ordered)


@dataclass(frozen=True, slots=True)
class Outline:
    """How a language spells what every file contains."""

    room: int  # columns of text in a comment
    string: Callable[[str], str] = str  # a literal
    # The value of a parameter that has none: in tables, and in comments.
    missing: str = ""
    unset: str = ""
    # Inert text without what those obey who read the language's comments.
    disarmed: Callable[[str], str] = str
    formula: str = "    "  # begins the lines of a formula
    # argument and more: what the first line about an argument begins with, and what the others do.
    argument: str = ""
    more: str = "    "
    # parameter and function: templates of their rows in tables.
    parameter: str = ""
    function: str = "    {}: {},"

    def heading(
        self, first: str, model: Model, paragraphs: Sequence[str], verified: Iterable[Verification] = ()
    ) -> list[str]:
        """Return the head of a file: what it is, of which model, prose, accuracies."""
        lines = [first, "", *map(self.disarmed, origin_lines(model, self.room))]
        said = (self.disarmed(inert(f"{v.name}: {v.text()}")) for v in verified)
        for i, paragraph in enumerate((*paragraphs, *said)):
            lines += [*([""] if i else []), *wrapped(paragraph, self.room)]
        return lines

    def about(self, member: Member) -> list[str]:
        """Return what a function computes, and its formula, each followed by an empty line."""
        lines = (
            line
            for x in member.formula
            for line in wrapped(x, self.room, self.formula, f"{self.formula}    ")
        )
        return [self.disarmed(member.headline), "", *map(self.disarmed, lines), ""]

    def verified(self, member: Member | MatrixMember, end: str = "") -> list[str]:
        """Return how accurate a function is; nothing of a matrix without a program of its own."""
        if member.verification is None:
            return []
        return wrapped(self.disarmed(inert(f"{member.verification.text()}{end}")), self.room)

    def arguments(self, parameters: Iterable[ModelParameter], names: Mapping[str, str]) -> list[str]:
        """Return what parameters are called, their values and what they are."""
        lines: list[str] = []
        for p in parameters:
            name, value = names[p.name], default_value(p) or self.unset
            text = f"{name}{f' = {value}' if value else ''}: {self.disarmed(described(p, name))}"
            lines += wrapped(f"{self.argument}{text}", self.room, "", self.more)
        return lines

    def parameter_rows(self, model: Model, names: Mapping[str, str]) -> list[str]:
        """Return the rows of the table of parameters."""
        return [
            self.parameter.format(
                names[p.name], default_value(p) or self.missing, self.string(p.unit), self.string(p.doc)
            )
            for p in model.parameters
        ]

    def function_rows(self, functions: Mapping[str, str]) -> list[str]:
        """Return the rows of a table of functions by the names of what they compute."""
        return [
            self.function.format(self.string(name), function_name)
            for name, function_name in functions.items()
        ]


@dataclass(frozen=True, slots=True)
class Language:
    """A language that numeric code is exported to: the exporter that prints verified programs.

    A file has a function ``OUT_over_IN`` of s and parameters for each transfer function; undamped distributed
    systems get ``OUT_over_IN_at`` besides, the frequency response.
    """

    suffix: str  # of the file's name
    summary: str  # what is made, in a line
    print: Callable[[Contents], Export]  # makes the file of its contents
    # True where generated code solves networks, follows waves along members that taper and finds roots of
    # polynomials; elsewhere what has no formula of CLOSED_OPERATIONS is written in band form.
    is_open: bool = False
    is_complex: bool = False  # true where parameters may be complex, as the imaginary unit is
    has_real: bool = False  # true where frequency responses are computed in real arithmetic
    form: str | None = None  # "band" to write all functions in band form
    rows: tuple[
        tuple[str, ...], ...
    ] = ()  # names of functions that are wanted as one matrix, a row per output
    shares: bool = False  # true where the function of a matrix has a program of its own
    up_to: Fraction | None = None  # where the band of band forms ends [Hz]

    @property
    def solves(self) -> bool:
        """True to get functions of networks as equations."""
        return self.is_open or self.form == BAND

    def export(
        self,
        model: Model,
        tfs: Sequence[AnyTransferFunction],
        stem: str = "",
        *,
        is_alone: bool = True,
        samples: int = SAMPLES,
    ) -> Export:
        """Return the file, the same on every run; accuracy that was not reached is a warning.

        The error is measured in the model's ``[analysis]`` band, else from 0.1 Hz to 10 kHz, at so many
        ``samples`` besides those around poles and zeros. Raises SF503 when a function's text would be too
        long, SF233 when a number does not fit in double precision, SF910 when a function without a short
        formula has no band form, SF902 when ``stem`` cannot be the name of a companion.
        """
        contents = self.contents(model, tfs, stem, is_alone=is_alone, samples=samples)
        made = self.print(contents)
        warnings = (*shortfalls(contents.verified), *made.warnings)
        return replace(made, warnings=warnings, notes=contents.notes, verified=contents.verified)

    def contents(
        self,
        model: Model,
        tfs: Sequence[AnyTransferFunction],
        stem: str = "",
        *,
        is_alone: bool = True,
        samples: int = SAMPLES,
    ) -> Contents:
        """Return what :meth:`export` prints, with its arguments and errors."""
        if not self.is_complex or self.form:
            check_causal(model, "band form" if self.form else "code in this language")
        members: list[Member] = []
        for tf in {tf.name: tf for tf in tfs}.values():
            members += self._members(tf, samples)
        matrix = self._matrix(members) if self.rows else None
        return Contents(model, tuple(members), stem, is_alone, matrix)

    def _matrix(self, members: Sequence[Member]) -> MatrixMember:
        """Return the function of all entries, with a program of its own where that shares something."""
        of_s = {m.tf.name: m for m in members if not m.is_response}
        plain = MatrixMember(tuple(tuple(of_s[name] for name in row) for row in self.rows))
        if not self.shares or any(m.is_fixed or not m.program.is_lumped for m in plain.each):
            return plain
        from symflex.codegen.program.matrix import matrix_program  # few exports are of matrices

        made = matrix_program([[m.tf for m in row] for row in plain.rows])
        return plain if made is None else replace(plain, program=made[0], verification=made[1])

    def _members(self, tf: AnyTransferFunction, samples: int) -> tuple[Member, ...]:
        """Return a transfer function and its frequency response, where there is one, or its band form."""
        wanted, reason = f"{tf.output.name}_over_{tf.input.name}", ""
        if not self.is_open and not is_closed(tf):
            reason = NO_FORMULA
        if self.form != BAND and not reason:
            most = inf if self.is_open else CLOSED_OPERATIONS
            try:
                chosen, response = choose_programs(tf, samples, has_real=self.has_real, most=most)
            except BudgetError as problem:
                if self.is_open or tf.is_rational:
                    raise
                spend()
                reason = problem.diagnostics[0].message
            else:
                if self.is_open or tf.is_rational or (chosen[1].error or 0.0) <= LOST:
                    return _members_of(tf, wanted, chosen, response)
                reason = "code of its formula would overflow, or lose more than half of the digits"
        program, verification, formula = choose_band(tf, self.up_to, samples)
        end = frequency_text(verification.band[1])
        note = f"{tf.name} is in band form, up to {end} and with the numbers of the file"
        said = f"{note}: {reason}" if reason else note
        return (Member(tf, program, wanted, verification, tuple(map(inert, formula)), note=said),)


_Measured = tuple[Piecewise, Verification]


def _members_of(
    tf: AnyTransferFunction, wanted: str, chosen: _Measured, response: _Measured | None
) -> tuple[Member, ...]:
    formula = formula_of(tf)
    value = Member(tf, chosen[0], wanted, chosen[1], formula)
    if response is None:
        return (value,)
    return value, Member(tf, response[0], f"{wanted}_at", response[1], formula, is_response=True)


def shortfalls(verified: Sequence[Verification]) -> tuple[str, ...]:
    """Return what falls short: of a function and its response in real arithmetic the worse one, once."""
    worst: dict[str, Verification] = {}
    for v in verified:
        if v.name not in worst or (v.error or 0.0) > (worst[v.name].error or 0.0):
            worst[v.name] = v
    warnings = []
    for v in worst.values():
        over = "over {:g} Hz to {:g} Hz".format(*map(float, v.band))
        if v.error is None:
            warnings.append(f"{v.name} is not verified: {v.reason}")
        elif not isfinite(v.error):
            warnings.append(f"{v.name} overflows somewhere {over}")
        elif v.error > ACCURACY:
            warnings.append(f"{v.name} is accurate to {v.error:.1e} only, {over}")
    return tuple(warnings)


_MARK = re.compile(r"^(?:#|%|//): (.+)\n", re.MULTILINE)
_CALL = re.compile(r"(\w+)\(")


@cache
def parts_of(file: str, dialect: str = "") -> Mapping[tuple[str, ...], str]:
    """Return the parts of a file in ``codegen/sources`` by the names that each defines.

    Those of a ``dialect``, another file, take the place of those that define one of the same names.
    """
    source = resources.files("symflex.codegen").joinpath("sources", file).read_text(encoding="utf-8")
    _, *cut = _MARK.split(source)
    parts = {
        tuple(names.split()): f"{text.strip()}\n" for names, text in zip(cut[::2], cut[1::2], strict=True)
    }
    if not dialect:
        return parts
    texts: dict[tuple[str, ...], str] = {}
    others = parts_of(dialect)
    for names, text in parts.items():
        key = next((other for other in others if not set(other).isdisjoint(names)), names)
        texts.setdefault(key, others.get(key, text))
    return texts


def called_parts(code: str, parts: Mapping[tuple[str, ...], str], always: Iterable[str] = ()) -> list[str]:
    """Return the parts that code needs, in order, and those that ``always`` are; texts call none."""
    home = {name: names for names in parts for name in names}
    needed: set[tuple[str, ...]] = set()
    pending = [*always, *_CALL.findall(code)]
    while pending:
        names = home.get(pending.pop())
        if names is not None and names not in needed:
            needed.add(names)
            pending += _CALL.findall(parts[names])
    return [text for names, text in parts.items() if names in needed]
