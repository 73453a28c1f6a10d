"""C functions of one transfer function: its value at a complex s, and its frequency response.

What depends on parameters alone is computed once per call, before the loop over frequencies. Where it can be,
that loop has a fixed number of turns and neither branches nor calls, so that compilers make it work on
several values at once: in lanes.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from symflex.codegen.c.body import (
    AXIS_LANE,
    LANE,
    LANE_FUNCTIONS,
    STEP,
    Body,
    Kind,
    S,
    Term,
    choose,
    complex_term,
    conditions_of,
    limit_text,
    quotient,
)
from symflex.codegen.module_text import WIDTH
from symflex.codegen.program import nodes as tree


@dataclass(frozen=True)
class Functions:
    """Prints the C functions of one transfer function."""

    name: str  # identifier of the function of s, without what all names of the file begin with
    prefix: str  # what public names begin with
    structure: str  # name of the type that contains the parameters
    members: Mapping[str, str]  # the structure's members by the parameters' names
    program: tree.Piecewise  # the function of s
    axis: tree.Piecewise | None = None  # the frequency response in real arithmetic, where it fits lanes

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

    def text(self) -> str:
        """Return the definitions."""
        blocks = [self._lumped_value()] if self.program.is_lumped else self._pieces()
        return "\n\n".join("\n".join(block) for block in (*blocks, self._frequency_response())) + "\n"

    @property
    def order(self) -> int:
        """The largest order of a differential equation that they solve; 0 for none."""
        codes = [c for p in (self.program, self.axis) if p for c in (p.tests, *(x.code for x in p.code))]
        solving = (n for code in codes for n in code.nodes() if isinstance(n, tree.Solutions))
        return max((len(n.coefficients) for n in solving), default=0)

    # ------------------------------------------------------------------------------------- at a complex s

    def _head(self, name: str) -> list[str]:
        return [f"static cx {name}(cx s, const {self.structure} *p)", "{"]

    def _ends(self, scope: Body, head: list[str]) -> list[str]:
        is_used = any(re.search(r"\bs\b", line) for line in scope.lines)
        unused = [] if is_used else [f"{STEP}(void)s;"]
        return [*head, *scope.opening(self.members), *unused, *scope.lines, "}"]

    def _lumped_value(self) -> list[str]:
        program, scope = self.program, Body.of(self.members, S)
        near, far = program.near, program.far
        scope.assign(near.every)
        if far is not None:
            block = scope.within()
            block.assign(program.late)
            block.say("return", complex_term(block.term(far.values[0])).text)
            scope.enclose(f"if (cx_abs(s) > {program.limit!r}) {{", block.lines)
        scope.say("return", complex_term(scope.term(near.values[0])).text)
        return self._whole_value(scope)

    def _whole_value(self, scope: Body) -> list[str]:
        """Return a function of s and, where the compiler has complex numbers, the public one."""
        return [
            *self._ends(scope, self._head(f"value_of_{self.name}")),
            "",
            "#ifndef __STDC_NO_COMPLEX__",
            *self.value_prototype.split("\n"),
            "{",
            f"{STEP}return complex_of(value_of_{self.name}(cx_of(creal(s), cimag(s)), p));",
            "}",
            "#endif",
        ]

    def _pieces(self) -> list[list[str]]:
        program, blocks = self.program, []
        for number, piece in enumerate(program.code):
            blocks += self._piece(f"piece_{number}_of_{self.name}", piece)
        scope = Body.of(self.members, S)
        choose(program, conditions_of(program, scope), scope, lambda k: f"piece_{k}_of_{self.name}(s, p)")
        blocks.append(self._whole_value(scope))
        return blocks

    def _piece(self, name: str, piece: tree.CodePiece) -> list[list[str]]:
        scope = Body.of(self.members, S)
        scope.assign(piece.code.needed(piece.code.values).every)
        values = [scope.term(v) for v in piece.code.values]
        if not piece.circle:
            num, den = values
            scope.say("return", complex_term(quotient(num, den)).text)
            return [self._ends(scope, self._head(name))]
        for i, value in enumerate(values):
            scope.say(f"value[{i}] =", complex_term(value).text)
        parts = [f"static void parts_of_{name}(cx s, const {self.structure} *p, cx *value)", "{"]
        returned = f"{STEP}return cx_circle(parts_of_{name}, s, p, {piece.circle});"
        return [self._ends(scope, parts), [*self._head(name), returned, "}"]]

    # -------------------------------------------------------------------------------- frequency response

    def _frequency_response(self) -> list[str]:
        """Return the response: in lanes, else with calls of the function of s."""
        if self.axis is not None:
            body = lanes(self.axis, self.members)
        elif self.program.is_lumped and is_rational_in_lanes(self.program):
            body = rational_lanes(self.program, self.members)
        else:
            body = [
                f"{STEP}for (size_t i = 0; i < n; i++) {{",
                f"{STEP * 2}const cx g = value_of_{self.name}(cx_of(0.0, omega[i]), p);",
                f"{STEP * 2}real[i] = g.re;",
                f"{STEP * 2}imag[i] = g.im;",
                f"{STEP}}}",
            ]
        return [*self.freq_prototype.split("\n"), "{", *body, "}"]


LOOP = "for (int j = 0; j < LANES; j++) {"

PADDING = """\
const size_t count = n - i < LANES ? n - i : LANES;
const double *x = omega + i;
double *re = real + i, *im = imag + i;
if (count < LANES) {    /* the last ones: made up to LANES */
    for (size_t j = 0; j < LANES; j++) {
        padded[0][j] = omega[j < count ? i + j : i];
    }
    x = padded[0];
    re = padded[1];
    im = padded[2];
}"""

UNPADDING = """\
if (count < LANES) {
    for (size_t j = 0; j < count; j++) {
        real[i + j] = re[j];
        imag[i + j] = im[j];
    }
}"""


def fits_lanes(program: tree.Piecewise) -> bool:
    """Tell whether a program in real arithmetic has two pieces, one for small frequencies."""
    return (
        len(program.conditions) == 1
        and bool(program.conditions[0].limit)
        and len(set(program.pieces)) > 1
        and not any(p.is_complex or p.circle for p in program.code)
    )


def is_rational_in_lanes(program: tree.Piecewise) -> bool:
    """Tell whether lanes can compute a program's response: one branch, and no calls but of exponentials."""
    near = program.near
    values = (*(a.value for a in near.assignments), *near.values)
    calls = any(
        isinstance(n, tree.Solutions)
        or (isinstance(n, tree.Apply) and n.function != "complex_exp")
        or (isinstance(n, tree.RootFactor) and not n.is_real_on_axis)
        for value in values
        for n in value.walk()
    )
    return program.varies and program.far is None and not calls


def lanes(program: tree.Piecewise, members: Mapping[str, str]) -> list[str]:
    """Return the body of the function that computes the frequency response, where :func:`fits_lanes`."""
    outer = Body.of(members, LANE)
    (condition,) = program.conditions
    outer.assign(program.tests.needed([condition.scale]).constants)
    limit = limit_text(condition, outer)
    tested = program.tests.needed([condition.quantity])
    outer.assign(tested.constants)
    tests = outer.within(3)
    pieces: list[tuple[tree.Straight, dict[str, Term]]] = []
    for k in program.pieces:
        code = program.code[k].code.needed(program.code[k].code.values)
        outer.values = {}
        outer.assign(code.constants)
        pieces.append((code, outer.values))

    tests.assign(tested.assignments)
    size = tests.term(condition.quantity)
    tests.add(f"is_near[j] = {size.text if size == LANE else f'fabs({size.text})'} < {limit};")
    tests.add("near += is_near[j];")
    loop, is_odd = outer.within(), bool(program.turn)
    loop.add("double padded[3][LANES], w[LANES], g[LANES] = {0.0};", "int near = 0, is_near[LANES];")
    loop.add(*(["double sign[LANES];"] if is_odd else []), *PADDING.split("\n"))
    loop.add(LOOP, f"{STEP}w[j] = fabs(x[j]);")
    loop.add(*([f"{STEP}sign[j] = copysign(1.0, x[j]);"] if is_odd else []), "}")
    loop.enclose(LOOP, tests.lines)
    for (code, values), opening in zip(pieces, ("near < LANES", "near > 0"), strict=True):
        block = loop.within()
        block.values = dict(values)
        _stages(code, block, "is_near[j]" if opening == "near > 0" else "")
        loop.enclose(f"if ({opening}) {{", block.lines)
    value, zero = ("sign[j] * g[j]", "0.0") if is_odd else ("g[j]", "0.0")
    real, imag = (zero, value) if is_odd else (value, zero)
    return _looped(outer, loop, members, {"re": real, "im": imag})


def rational_lanes(program: tree.Piecewise, members: Mapping[str, str]) -> list[str]:
    """Return the body of the function that computes the response, where :func:`is_rational_in_lanes`."""
    outer = Body.of(members, AXIS_LANE)
    outer.assign(program.near.constants)
    block = outer.within(3)
    block.assign(program.near.assignments)
    value = block.term(program.near.values[0])
    parts = {"im" if value.kind is Kind.IMAGINARY else "re": value.text}
    if value.kind is Kind.COMPLEX:
        block.say("const cx g =", value.text)
        parts = {"re": "g.re", "im": "g.im"}
    arrays = {name: block.name(f"g_{name}") for name in parts}
    for name, text in parts.items():
        block.say(f"{arrays[name]}[j] =", text)
    loop = outer.within()
    loop.add(f"double padded[3][LANES], w[LANES], {', '.join(f'{a}[LANES]' for a in arrays.values())};")
    loop.add(*PADDING.split("\n"))
    # Copied, since the arrays outside might overlap for all that a compiler knows.
    loop.add(LOOP, f"{STEP}w[j] = x[j];", "}")
    loop.enclose(LOOP, block.lines)
    stored = {name: f"{arrays[name]}[j]" if name in arrays else "0.0" for name in ("re", "im")}
    return _looped(outer, loop, members, stored)


def entries_in_lanes(program: tree.Piecewise, members: Mapping[str, str]) -> list[str]:
    """Return the body of the function that computes all entries of a matrix, likewise."""
    outer = Body.of(members, AXIS_LANE)
    outer.assign(program.near.constants)
    loop, block, count = outer.within(), outer.within(3), len(program.near.values)
    block.assign(program.near.assignments)
    for k, node in enumerate(program.near.values):
        value = block.term(node)
        re, im = ("0.0", value.text) if value.kind is Kind.IMAGINARY else (value.text, "0.0")
        if value.kind is Kind.COMPLEX:
            g = block.hold("g", value).text
            re, im = f"{g}.re", f"{g}.im"
        block.say(f"re[{k}][j] =", re)
        block.say(f"im[{k}][j] =", im)
    loop.add(
        f"double w[LANES], re[{count}][LANES], im[{count}][LANES];",
        "const size_t count = n - i < LANES ? n - i : LANES;",
        "for (size_t j = 0; j < LANES; j++) {    /* the last ones: made up to LANES */",
        f"{STEP}w[j] = omega[j < count ? i + j : i];",
        "}",
    )
    loop.enclose(LOOP, block.lines)
    entry = outer.name("entry")
    loop.add(
        f"for (size_t {entry} = 0; {entry} < {count}; {entry}++) {{",
        f"{STEP}for (size_t j = 0; j < count; j++) {{",
        f"{STEP * 2}real[{entry} * n + i + j] = re[{entry}][j];",
        f"{STEP * 2}imag[{entry} * n + i + j] = im[{entry}][j];",
        f"{STEP}}}",
        "}",
    )
    head = [*outer.opening(members), *outer.lines, f"{STEP}for (size_t i = 0; i < n; i += LANES) {{"]
    return [*head, *loop.lines, f"{STEP}}}"]


def _looped(outer: Body, loop: Body, members: Mapping[str, str], stored: Mapping[str, str]) -> list[str]:
    """Return a loop over frequencies, and what it stores in the end."""
    for name, value in stored.items():
        loop.add(LOOP, f"{STEP}{name}[j] = {value};", "}")
    loop.add(*UNPADDING.split("\n"))
    head = [*outer.opening(members), *outer.lines, f"{STEP}for (size_t i = 0; i < n; i += LANES) {{"]
    return [*head, *loop.lines, f"{STEP}}}"]


def _stages(code: tree.Straight, scope: Body, condition: str) -> None:
    """Print loops that compute a quotient; expressions that call the library are in loops of their own."""
    values = [*(a.value for a in code.assignments), tree.Divide(*code.values)]
    stages = [0]
    for before, value in pairwise(values):
        stages.append(stages[-1] + (_calls(value) is not _calls(before)))
    arrays = {
        assignment.name: scope.name(assignment.name)
        for assignment, stage in zip(code.assignments, stages, strict=False)
        if any(
            other > stage
            and any(isinstance(n, tree.Assigned) and n.name == assignment.name for n in value.walk())
            for value, other in zip(values, stages, strict=True)
        )
    }
    if arrays:
        scope.add(f"double {', '.join(f'{array}[LANES]' for array in arrays.values())};")
    inner = scope.within()
    for stage in range(stages[-1] + 1):
        inner.lines = []
        for assignment, own_stage in zip(code.assignments, stages, strict=False):
            if own_stage != stage:
                continue
            if assignment.name not in arrays:
                inner.assign([assignment])
                continue
            term = inner.whole(assignment.value)
            entry = f"{arrays[assignment.name]}[j]"
            inner.say(f"{entry} =", term.text)
            inner.values[assignment.name] = Term(entry, term.kind, varies=True)
        if stage == stages[-1]:
            num, den = (inner.term(v) for v in code.values)
            target = inner.within() if condition else inner
            target.say("g[j] =", quotient(num, den).text)
            if condition:
                inner.enclose(f"if ({condition}) {{", target.lines)
        scope.enclose(LOOP, inner.lines)


def _calls(root: tree.CodeNode) -> bool:
    """Tell whether an expression has a function that there is only in the library."""
    others = ("abs", *LANE_FUNCTIONS)
    return any(isinstance(node, tree.Apply) and node.function not in others for node in root.walk())
