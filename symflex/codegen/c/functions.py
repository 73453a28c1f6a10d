"""C functions of one transfer function: its value at a complex s, and its frequency response.

Input: the programs of a transfer function and identifiers.
Output: text of C functions. What depends on parameters alone is computed once per call, before the loop over
frequencies.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from symflex.codegen.c.choice import choose, conditions_of
from symflex.codegen.c.expression import Kind, Term, complex_term, quotient
from symflex.codegen.c.lanes import fits_lanes, is_rational_in_lanes, lanes, rational_lanes
from symflex.codegen.c.scope import AXIS, POSITIVE, STEP, WIDTH, Body, S
from symflex.codegen.program import CodePiece, Piecewise

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence


@dataclass(frozen=True)
class Functions:
    """Prints the C functions of one transfer function."""

    name: str  # identifier of the function of s, without what all names of the file begin with
    prefix: str  # what public names begin with
    structure: str  # name of the type that holds the parameters
    members: Mapping[str, str]  # the structure's members by the parameters' names
    program: Piecewise  # the function of s
    axis: Piecewise | None = None  # the frequency response in real arithmetic, where there is one

    @property
    def value_prototype(self) -> str:
        """The declaration of the function of s, without semicolon."""
        return self._declared("double complex", "", ["double complex s"])

    @property
    def freq_prototype(self) -> str:
        """The declaration of the frequency response, without semicolon."""
        given = ["const double *omega", "double *real", "double *imag", "size_t n"]
        return self._declared("void", "_freq", given)

    def _declared(self, kind: str, suffix: str, arguments: Sequence[str]) -> str:
        opening = f"{kind} {self.prefix}_{self.name}{suffix}("
        given = [*arguments, f"const {self.structure} *p"]
        one_line = f"{opening}{', '.join(given)})"
        if len(one_line) <= WIDTH:
            return one_line
        indent = len(opening) if len(opening) + len(given[-1]) < WIDTH else len(STEP)
        lines = [opening + given[0]]
        for argument in given[1:]:
            if len(lines[-1]) + len(argument) + 4 > WIDTH:
                lines[-1] += ","
                lines.append(" " * indent + argument)
            else:
                lines[-1] += f", {argument}"
        return "\n".join(lines) + ")"

    def text(self) -> tuple[str, int]:
        """Return the definitions, and the largest order of a differential equation they solve."""
        orders: set[int] = set()
        blocks: list[list[str]] = []
        if self.program.is_lumped:
            blocks.append(self._lumped_value(self.program))
        else:
            blocks += self._pieces(self.program, orders)
        blocks.append(self._frequency_response(orders))
        return "\n\n".join("\n".join(block) for block in blocks) + "\n", max(orders, default=0)

    # ------------------------------------------------------------------------------------- at a complex s

    def _head(self, name: str) -> list[str]:
        return [f"static cx {name}(cx s, const {self.structure} *p)", "{"]

    def _ends(self, scope: Body, head: list[str]) -> list[str]:
        unused = [] if any(_mentions(line, "s") for line in scope.lines) else [f"{STEP}(void)s;"]
        return [*head, *scope.opening(self.members), *unused, *scope.lines, "}"]

    def _lumped_value(self, program: Piecewise) -> list[str]:
        scope = Body.of(self.members, S)
        _lumped(program, scope, lambda inner, term: inner.say("return", complex_term(term).text))
        return self._wrapped_value(self._ends(scope, self._head(f"value_of_{self.name}")))

    def _wrapped_value(self, lines: list[str]) -> list[str]:
        """Return a function of s and, where the compiler has complex numbers, the public one."""
        return [
            *lines,
            "",
            "#ifndef __STDC_NO_COMPLEX__",
            *self.value_prototype.split("\n"),
            "{",
            f"{STEP}return complex_of(value_of_{self.name}(cx_of(creal(s), cimag(s)), p));",
            "}",
            "#endif",
        ]

    def _pieces(self, program: Piecewise, orders: set[int]) -> list[list[str]]:
        blocks = []
        for number, piece in enumerate(program.code):
            blocks += self._piece(f"piece_{number}_of_{self.name}", piece, orders)
        scope = Body.of(self.members, S)
        conditions = conditions_of(program, scope)
        orders |= scope.orders

        def call(k: int, inner: Body) -> None:
            inner.say("return", f"piece_{k}_of_{self.name}(s, p)")

        choose(program, conditions, scope, call)
        blocks.append(self._wrapped_value(self._ends(scope, self._head(f"value_of_{self.name}"))))
        return blocks

    def _piece(self, name: str, piece: CodePiece, orders: set[int]) -> list[list[str]]:
        scope = Body.of(self.members, S)
        code = piece.code.needed(piece.code.values)
        scope.assign((*code.constants, *code.assignments))
        values = [scope.term(v) for v in piece.code.values]
        if not piece.circle:
            num, den = values
            scope.say("return", complex_term(quotient(num, den)).text)
            orders |= scope.orders
            return [self._ends(scope, self._head(name))]
        for i, value in enumerate(values):
            scope.say(f"value[{i}] =", complex_term(value).text)
        orders |= scope.orders
        parts = [f"static void parts_of_{name}(cx s, const {self.structure} *p, cx *value)", "{"]
        whole = f"{STEP}return cx_circle(parts_of_{name}, s, p, {piece.circle});"
        return [self._ends(scope, parts), [*self._head(name), whole, "}"]]

    # -------------------------------------------------------------------------------- frequency response

    def _frequency_response(self, orders: set[int]) -> list[str]:
        if self.axis is not None and fits_lanes(self.axis):
            return [*self.freq_prototype.split("\n"), "{", *lanes(self.axis, self.members), "}"]
        program = self.axis or self.program
        if program.is_lumped and is_rational_in_lanes(program):
            return [*self.freq_prototype.split("\n"), "{", *rational_lanes(program, self.members), "}"]
        is_axis = self.axis is not None
        outer = Body.of(self.members, POSITIVE if is_axis else AXIS)
        # Names are unique in the whole function; the loop's statements come after all constants.
        inner = outer.within()
        if program.is_lumped:
            _lumped(program, outer, self._store, inner)
        else:
            self._axis_pieces(program, outer, inner)
        orders |= outer.orders
        w = "fabs(omega[i])" if is_axis else "omega[i]"
        varies = any(_mentions(line, "w") for line in inner.lines)
        is_odd = any(_mentions(line, "sign") for line in inner.lines)
        loop = [f"{STEP}for (size_t i = 0; i < n; i++) {{"]
        loop += [f"{STEP * 2}const double w = {w};"] if varies else []
        loop += [f"{STEP * 2}const double sign = signbit(omega[i]) ? -1.0 : 1.0;"] if is_odd else []
        unused = [] if varies or is_odd else [f"{STEP}(void)omega;"]
        return [
            *self.freq_prototype.split("\n"),
            "{",
            *outer.opening(self.members),
            *unused,
            *outer.lines,
            *loop,
            *inner.lines,
            f"{STEP}}}",
            "}",
        ]

    def _axis_pieces(self, program: Piecewise, outer: Body, inner: Body) -> None:
        conditions = conditions_of(program, outer, inner)
        codes = [piece.code.needed(piece.code.values) for piece in program.code]
        fixed: list[dict[str, Term]] = []
        for piece, code in zip(program.code, codes, strict=True):
            outer.known = {}
            if not piece.circle:
                outer.assign(code.constants)
            fixed.append(outer.known)

        def body(k: int, block: Body) -> None:
            piece, code = program.code[k], codes[k]
            if piece.circle:
                # Points on a circle are complex: the piece of the function of s serves.
                call = f"piece_{k}_of_{self.name}(cx_of(0.0, w), p)"
                self._store(block, Term(call, Kind.COMPLEX, varies=True))
                return
            block.known = dict(fixed[k])
            if piece.is_complex:
                block.s = AXIS
            block.assign(code.assignments)
            num, den = (block.term(v) for v in code.values)
            value = quotient(num, den)
            if program.turn and not piece.is_complex:
                value = replace(value, kind=Kind.IMAGINARY)
            self._store(block, value)

        choose(program, conditions, inner, body)

    def _store(self, scope: Body, value: Term) -> None:
        """Write a value into the arrays; it is that at a positive frequency in real arithmetic."""
        sign = "sign * " if self.axis is not None else ""
        if value.kind is Kind.COMPLEX:
            scope.say("const cx g =", value.text)
            scope.say("real[i] =", "g.re")
            scope.say("imag[i] =", f"{sign}g.im")
        elif value.kind is Kind.REAL:
            scope.say("real[i] =", value.text)
            scope.say("imag[i] =", "0.0")
        else:
            scope.say("real[i] =", "0.0")
            scope.say("imag[i] =", f"{sign}({value.text})" if sign else value.text)


def _mentions(line: str, name: str) -> bool:
    """Tell whether a line of code has an identifier."""
    at = line.find(name)
    while at >= 0:
        before, after = line[at - 1 : at], line[at + len(name) : at + len(name) + 1]
        if not (before.isalnum() or before == "_" or after.isalnum() or after == "_"):
            return True
        at = line.find(name, at + 1)
    return False


def _lumped(
    program: Piecewise,
    scope: Body,
    store: Callable[[Body, Term], None],
    varying: Body | None = None,
) -> None:
    """Print a program of one or two branches; what varies goes to a scope of its own if there is one."""
    inner = varying or scope
    near = program.near
    far = program.far
    scope.assign(near.constants)
    if varying is not None:
        inner.known = dict(scope.known)
    inner.assign(near.assignments)
    if far is None:
        store(inner, inner.term(near.values[0]))
        return
    size = "cx_abs(s)" if inner.s.kind is Kind.COMPLEX else f"fabs({inner.s.text})"
    inner.lines.append(f"{STEP * inner.depth}if ({size} > {program.limit!r}) {{")
    block = inner.within()
    block.assign(program.late)
    store(block, block.term(far.values[0]))
    inner.lines += block.lines
    if varying is None:
        inner.lines.append(f"{STEP * inner.depth}}}")
        store(inner, inner.term(near.values[0]))
        return
    inner.lines.append(f"{STEP * inner.depth}}} else {{")
    block = inner.within()
    store(block, block.term(near.values[0]))
    inner.lines += [*block.lines, f"{STEP * inner.depth}}}"]
