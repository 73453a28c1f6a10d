"""Frequency responses, several values at a time.

Input: a program in real arithmetic with two pieces, one of them for small frequencies; or a rational one.
Output: lines of a C function. Every loop has a fixed number of turns and, where it can, neither branches nor
calls; so compilers make it work on several values at once.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from symflex.codegen.c.choice import limit_text
from symflex.codegen.c.expression import LANE_FUNCTIONS, Kind, Term, quotient
from symflex.codegen.c.scope import AXIS_LANE, LANE, STEP, Body
from symflex.codegen.program import Apply, Assigned, CodeNode, Divide, Piecewise, Solutions, Straight

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

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


def fits_lanes(program: Piecewise) -> bool:
    """Tell whether a program in real arithmetic has two pieces, one for small frequencies."""
    return (
        len(program.conditions) == 1
        and bool(program.conditions[0].limit)
        and len(set(program.pieces)) > 1
        and not any(p.is_complex or p.circle for p in program.code)
    )


def is_rational_in_lanes(program: Piecewise) -> bool:
    """Tell whether a program varies, has one branch, and calls no function of s."""
    near = program.near
    values = (*(a.value for a in near.assignments), *near.values)
    calls = (n for value in values for n in value.walk() if isinstance(n, Apply | Solutions))
    return program.varies and program.far is None and not any(calls)


def lanes(program: Piecewise, members: Mapping[str, str]) -> list[str]:
    """Return the body of the function that computes the frequency response.

    Parameters
    ----------
    program : Piecewise
        Such that :func:`fits_lanes` holds.
    members : mapping of str to str
        The structure's members by the parameters' names.
    """
    outer = Body.of(members, LANE)
    (condition,) = program.conditions
    fixed = program.tests.needed([condition.scale])
    outer.assign(fixed.constants)
    limit = limit_text(condition, outer)
    tested = program.tests.needed([condition.quantity])
    outer.assign(tested.constants)
    tests = outer.within(3)
    pieces: list[tuple[Straight, dict[str, Term]]] = []
    for k in program.pieces:
        code = program.code[k].code.needed(program.code[k].code.values)
        outer.known = {}
        outer.assign(code.constants)
        pieces.append((code, outer.known))

    tests.assign(tested.assignments)
    size = tests.term(condition.quantity)
    tests.add(f"is_near[j] = {size.text if size == LANE else f'fabs({size.text})'} < {limit};")
    tests.add("near += is_near[j];")
    loop = outer.within()
    is_odd = bool(program.turn)
    loop.add("double padded[3][LANES], w[LANES], g[LANES] = {0.0};", "int near = 0, is_near[LANES];")
    loop.add(*(["double sign[LANES];"] if is_odd else []), *PADDING.split("\n"))
    loop.add(LOOP, f"{STEP}w[j] = fabs(x[j]);")
    loop.add(*([f"{STEP}sign[j] = copysign(1.0, x[j]);"] if is_odd else []), "}")
    loop.add(LOOP)
    loop.lines += tests.lines
    loop.add("}")
    for (code, known), opening in zip(pieces, ("near < LANES", "near > 0"), strict=True):
        block = loop.within()
        block.known = dict(known)
        _stages(code, block, "is_near[j]" if opening == "near > 0" else "")
        loop.add(f"if ({opening}) {{")
        loop.lines += block.lines
        loop.add("}")
    value, zero = ("sign[j] * g[j]", "0.0") if is_odd else ("g[j]", "0.0")
    real, imag = (zero, value) if is_odd else (value, zero)
    loop.add(LOOP, f"{STEP}re[j] = {real};", "}", LOOP, f"{STEP}im[j] = {imag};", "}")
    loop.add(*UNPADDING.split("\n"))
    return _looped(outer, loop, members)


def rational_lanes(program: Piecewise, members: Mapping[str, str]) -> list[str]:
    """Return the body of the function that computes the frequency response.

    Parameters
    ----------
    program : Piecewise
        Such that :func:`is_rational_in_lanes` holds.
    members : mapping of str to str
        The structure's members by the parameters' names.
    """
    outer = Body.of(members, AXIS_LANE)
    outer.assign(program.near.constants)
    block = outer.within(3)
    block.assign(program.near.assignments)
    value = block.term(program.near.values[0])
    parts = {"re": "0.0", "im": "0.0"}
    if value.kind is Kind.COMPLEX:
        block.say("const cx g =", value.text)
        parts = {"re": "g.re", "im": "g.im"}
    else:
        parts["re" if value.kind is Kind.REAL else "im"] = value.text
    varying = {name: text for name, text in parts.items() if text != "0.0"}
    arrays = {name: block.name(f"g_{name}") for name in varying}
    for name, text in varying.items():
        block.say(f"{arrays[name]}[j] =", text)
    loop = outer.within()
    loop.add(f"double padded[3][LANES], w[LANES], {', '.join(f'{a}[LANES]' for a in arrays.values())};")
    loop.add(*PADDING.split("\n"))
    # Copied, since the arrays outside might overlap for all that a compiler knows.
    loop.add(LOOP, f"{STEP}w[j] = x[j];", "}", LOOP)
    loop.lines += block.lines
    loop.add("}")
    for name in parts:
        stored = f"{arrays[name]}[j]" if name in arrays else "0.0"
        loop.add(LOOP, f"{STEP}{name}[j] = {stored};", "}")
    loop.add(*UNPADDING.split("\n"))
    return _looped(outer, loop, members)


def _looped(outer: Body, loop: Body, members: Mapping[str, str]) -> list[str]:
    head = [*outer.opening(members), *outer.lines, f"{STEP}for (size_t i = 0; i < n; i += LANES) {{"]
    return [*head, *loop.lines, f"{STEP}}}"]


def _stages(code: Straight, scope: Body, condition: str) -> None:
    """Print loops that compute a quotient; expressions that call the library are in loops of their own."""
    values = [*(a.value for a in code.assignments), Divide(*code.values)]
    stages = [0]
    for before, value in pairwise(values):
        stages.append(stages[-1] + (_calls(value) is not _calls(before)))
    arrays = {
        assignment.name: scope.name(assignment.name)
        for assignment, stage in zip(code.assignments, stages, strict=False)
        if _is_used_later(assignment.name, stage, values, stages)
    }
    if arrays:
        scope.add(f"double {', '.join(f'{array}[LANES]' for array in arrays.values())};")
    inner = scope.within()
    for stage in range(stages[-1] + 1):
        inner.lines = []
        for assignment, own in zip(code.assignments, stages, strict=False):
            if own != stage:
                continue
            if assignment.name not in arrays:
                inner.assign([assignment])
                continue
            term = inner.printer.whole(assignment.value)
            place = f"{arrays[assignment.name]}[j]"
            inner.say(f"{place} =", term.text)
            inner.known[assignment.name] = Term(place, term.kind, varies=True)
        if stage == stages[-1]:
            num, den = (inner.term(v) for v in code.values)
            target = inner.within() if condition else inner
            target.say("g[j] =", quotient(num, den).text)
            if condition:
                inner.add(f"if ({condition}) {{")
                inner.lines += target.lines
                inner.add("}")
        scope.add(LOOP)
        scope.lines += inner.lines
        scope.add("}")


def _is_used_later(name: str, stage: int, values: Sequence[CodeNode], stages: Sequence[int]) -> bool:
    return any(
        other > stage and any(isinstance(n, Assigned) and n.name == name for n in value.walk())
        for value, other in zip(values, stages, strict=True)
    )


def _calls(root: CodeNode) -> bool:
    """Tell whether an expression has a function that there is only in the library."""
    others = ("abs", *LANE_FUNCTIONS)
    return any(isinstance(node, Apply) and node.function not in others for node in root.walk())
