r"""Equations of motion, as a paper prints them, as a specification.

Input: the mathematics of a paper. Output: the text of a specification with ``[equations]``, or ``[fields]``
where derivatives along x occur; comments say what each line was read from, and gaps are marked.

    (M+m)\ddot{x} + ml\ddot\theta = F      equations = ["(M + m)*x'' + m*l*theta'' = F"]

What is differentiated in time is an unknown. In a linear equation each term has an unknown in it or is an
input; what else occurs is a parameter. Values are not in equations, so they are gaps.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence, Set
from dataclasses import dataclass, field, replace
from typing import Final

from symflex.errors import Span, SpecError
from symflex.expressions import (
    FUNCTIONS,
    Call,
    Derivative,
    Differentiated,
    Expression,
    Name,
    Negative,
    Sum,
    format_expression,
    is_number,
    names,
    nodes,
    number,
    substitute,
)
from symflex.papers.formula import defined_symbol, read_value
from symflex.papers.laplace import Signals, degree, is_ratio, signals_in, terms_of
from symflex.papers.matrices import Matrix, Value
from symflex.papers.matrix_equations import NamedMatrices
from symflex.papers.reader import FRACTIONS
from symflex.papers.source import (
    LatexToken,
    Paper,
    PrintedEquation,
    group_end,
    refusal,
    statements,
    text_of,
    written,
)
from symflex.papers.symbols import LAPLACE, LETTERS, PRIMES, PaperNotation, PrintedSymbol

GAP: Final = "# GAP:"
FORCES: Final = ("F", "f", "u", "U", "tau", "T", "M", "Q", "V", "v", "i", "I", "w", "q", "p", "r", "d")
CONSTANT: Final = ("g", "pi")  # what is no input, however it stands there
ENERGIES: Final = 3  # from L to T and V, and to their parts
LAGRANGE: Final = re.compile(
    r"\\d?fracddt\\d?frac\\partial\w+\\partial\\dot.*?-\\d?frac\\partial\w+\\partial\\?\w+"
)
ALONG: Final = re.compile(r"\\partial(t|x\^)")
SUBSCRIPT: Final = re.compile(r"_\{?,?([xt]+)(?![\w,])\}?")
STEEP: Final = re.compile(r"('{3,}|\^\{?\((3|4|iv|IV)\))")  # derivatives too high to be in time
DOTTED: Final = re.compile(r"\\d?dot\{?\Z")
PARTIAL: Final = re.compile(r"\\partial(\^\{?\d\}?)?\Z")
SUPPORT: Final = re.compile(
    r"\b(clamped|built[- ]in|fixed|cantilevered|pinned|hinged|simply[- ]supported|free)\b"
    r"[^.;$]{0,60}((?:\$\s*x\s*=\s*[^$]{1,20}\$(?:,|\s|and|at)*)+)",
    re.IGNORECASE,
)
POINT: Final = re.compile(r"\$\s*x\s*=\s*\\?(\w{1,9})\s*\$")
SLOPES: Final = {"clamp": (0, 1), "built": (0, 1), "fixed": (0, 1), "canti": (0, 1), "free": (2, 3)}
"""Which derivatives of a deflection are zero where a beam is held as a word says, (0, 2) for pins."""
RESTING: Final = ("0", "e", "eq")  # indices of a length or an angle at rest


@dataclass(frozen=True)
class _Equation:
    """One equation with both sides."""

    left: Expression
    right: Expression
    printed: PrintedEquation

    @property
    def text(self) -> str:
        return f"{format_expression(self.left)} = {format_expression(self.right)}"

    @property
    def terms(self) -> tuple[Expression, ...]:
        """The terms of both sides that are not zero, without their signs."""
        return tuple(terms_of((self.left, self.right)))


@dataclass
class _PaperMotion:
    """What was read of a paper."""

    equations: list[_Equation] = field(default_factory=list)
    definitions: dict[str, tuple[Expression, PrintedEquation]] = field(default_factory=dict)
    gaps: list[str] = field(default_factory=list)
    timed: set[str] = field(default_factory=set)  # what is written as a function of t, or of s
    matrices: NamedMatrices = field(default_factory=NamedMatrices)


def motion_specification(paper: Paper, title: str) -> str:
    """Return the specification of the equations of motion in a paper; SF115 when there are none."""
    fields = _fields(paper)
    # Lagrange's equations have partial derivatives too, but none in time alone.
    is_field = bool(fields) or any(ALONG.search(text_of(d.tokens)) for d in paper.displays)
    notation = PaperNotation({PrintedSymbol("s"): LAPLACE}, motion="time")
    found = _read(paper, replace(notation, motion="field", fields=fields) if is_field else notation)
    if not any(
        isinstance(n, Derivative | Call)
        for one in found.equations
        for n in (*names(one.left), *names(one.right))
    ):
        if (text := _laplace_text(paper, title)) is not None:
            return text
        span = paper.displays[0].span if paper.displays else None
        message = "there are no equations of motion: no displayed equation has a derivative in time"
        if found.gaps:
            message = f"no equation of motion is read; {found.gaps[0]}"
        hint = r"derivatives are \dot{x}, x'' or \frac{d^2 x}{dt^2}; signals in s are X(s)"
        raise refusal(span, message, hint)
    if not is_field and (lagrangian := _lagrangian(paper, found)) is not None:
        return _energy_text(found, title, lagrangian, paper)
    return _field_text(found, title, paper) if is_field else _text(found, title)


def _fields(paper: Paper) -> frozenset[str]:
    """Return the letters of a paper that vary in time and along x, by their derivatives."""
    slopes, rates, both = set[str](), set[str](), set[str]()
    for display in paper.displays:
        texts = [t.text for t in display.tokens]
        for i, text in enumerate(texts):
            letter = LETTERS.get(text, text)
            if not letter.isalnum() or letter.isdigit():
                continue
            after = "".join(texts[i + 1 : i + 12])
            before = "".join(texts[max(i - 5, 0) : i])
            if index := SUBSCRIPT.match(after):
                slopes |= {letter} if "x" in index[1] else set()
                rates |= {letter} if "t" in index[1] else set()
                both |= {letter} if len(index[1]) > 1 else set()
            slopes |= {letter} if after.startswith(tuple(PRIMES)) else set()
            rates |= {letter} if DOTTED.search(before) else set()
            both |= {letter} if STEEP.match(after) else set()
            if PARTIAL.search(before) and re.match(r".*?\\partial(t|x\^)", after):
                both.add(letter)
    return frozenset((both | (slopes & rates)) - {"x", "t", "s"})


def _read(paper: Paper, notation: PaperNotation) -> _PaperMotion:
    found = _PaperMotion()
    read: list[tuple[PrintedEquation, list[Value], bool]] = []
    for display in paper.displays:
        try:
            if display.problem is not None:
                raise SpecError(display.problem)
            equations = statements(display.tokens)
        except SpecError as error:
            if not display.is_inline:
                found.gaps.append(f"line {display.span.line} is not read: {error.diagnostics[0].message}")
            continue
        for equation in _with_places(equations, notation.fields):
            if len(equation.sides) > 1 and not equation.is_condition:
                sides = _sides(equation, notation, found, is_inline=display.is_inline)
                if sides and not found.matrices.takes(sides, equation):
                    read.append((equation, sides, display.is_inline))
    for equation, sides, is_inline in read:
        _take(equation, found.matrices.written_out(sides, equation), notation, found, is_inline=is_inline)
    return found


def _with_places(equations: Sequence[PrintedEquation], fields: Set[str]) -> Iterator[PrintedEquation]:
    r"""Yield equations with the place of ``w' = 0 \text{ at } x = l`` behind each field that has none."""
    waiting: list[PrintedEquation] = []
    for equation in equations:
        first = text_of(equation.sides[0])
        if equation.is_condition and first == "x" and len(equation.sides) == 2 and fields:  # noqa: PLR2004
            yield from (_at_place(one, equation.sides[1], fields) for one in waiting)
            waiting = []
            continue
        held = {LETTERS.get(t.text, t.text) for t in equation.tokens}
        waiting.append(equation._replace(is_condition=False) if held & fields else equation)
    yield from waiting


def _at_place(equation: PrintedEquation, point: Sequence[LatexToken], fields: Set[str]) -> PrintedEquation:
    """Return an equation in which fields are taken at a point."""
    typed = [t.text for t in equation.tokens]
    if equation.is_condition or (point and not set(typed) - {"x"}):
        return equation
    opening = [point[0]._replace(text=text) for text in ("(",)]
    closing = [point[0]._replace(text=text) for text in (",", "t", ")")]
    sides = []
    for side in equation.sides:
        out: list[LatexToken] = []
        i = 0
        while i < len(side):
            token = side[i]
            end = i + 1
            is_field = LETTERS.get(token.text, token.text) in fields
            if is_field:
                while end < len(side) and (side[end].text in PRIMES or side[end].text in ("_", "^")):
                    end = end + 1 if side[end].text in PRIMES else group_end(side, end + 1)
            is_fraction = token.text in FRACTIONS and r"\partial" in [t.text for t in side[i + 1 : i + 4]]
            if is_fraction:
                end = group_end(side, group_end(side, i + 1))
            out += side[i:end]
            if (is_field or is_fraction) and "(" not in [t.text for t in side[end : end + 1]]:
                out += [*opening, *point, *closing]
            i = end
        sides.append(tuple(out))
    return equation._replace(sides=tuple(sides))


def _sides(
    equation: PrintedEquation, notation: PaperNotation, found: _PaperMotion, *, is_inline: bool
) -> list[Value]:
    """Return the sides of an equation; none, and a gap, where it is not read."""
    said = "holds only nearly" if equation.nearly is not None else ""
    try:
        sides = found.matrices.read(equation, notation)
    except SpecError as error:
        said = f"is not read: {error.diagnostics[0].message}"
    if said and not is_inline:
        found.gaps.append(f"line {equation.span.line} {said}: {_comment(equation)}")
    return [] if said else sides


def _take(
    equation: PrintedEquation,
    sides: Sequence[Value],
    notation: PaperNotation,
    found: _PaperMotion,
    *,
    is_inline: bool,
) -> None:
    typed = [t.text for t in equation.tokens]
    rows = _rows(sides[0], sides[-1])
    # A chain such as w(0) = w'(0) = 0 has a condition in each side.
    rows += [row for side in sides[1:-1] if _is_placed(side) for row in _rows(side, sides[-1])]
    if not rows and not is_inline:
        found.gaps.append(f"line {equation.span.line} has sides of different sizes: {_comment(equation)}")
    for left, right in rows:
        if left == right:  # of a state that is the derivative of another
            continue
        one = _Equation(left, right, equation)
        held = (*names(left), *names(right))
        moving = any(isinstance(n, Derivative) for n in held)
        if notation.motion != "time":
            moving |= any(isinstance(n, Name) and n.name == LAPLACE for n in held)
        is_placed = _is_placed(left) or _is_placed(right)
        if (moving or is_placed) and (not is_inline or (is_placed and notation.motion == "field")):
            found.equations.append(one)
        elif defined_symbol(equation) is not None and isinstance(left, Name) and not _is_value(right):
            if notation.motion == "field" and left.name == "x":
                continue
            found.definitions.setdefault(left.name, (right, equation))
    for node in (n for side in sides for e in _entries(side) for n in names(e)):
        symbol = node.name.split("_")[0]
        for i, text in enumerate(typed):
            if text.lstrip("\\") == symbol and _is_timed(typed[i + 1 : i + 8]):
                found.timed.add(node.name)


def _is_timed(following: Sequence[str]) -> bool:
    """Tell whether the argument t follows a symbol, behind its index."""
    before, bracket, after = "".join(following).partition("(")
    return (
        bool(bracket)
        and after.startswith(("t)", "s)"))
        and re.fullmatch(r"\}*(_(\w|\{\w+\}))?\}*", before) is not None
    )


def _is_placed(side: Value) -> bool:
    """Tell whether a side has a field at a point."""
    return any(isinstance(n, Call) and n.name not in FUNCTIONS for e in _entries(side) for n in names(e))


def _is_value(expression: Expression) -> bool:
    return not names(expression)


def _entries(value: Expression | Matrix) -> Iterator[Expression]:
    if isinstance(value, Expression):
        yield value
    else:
        yield from (e for row in value.rows for e in row)


def _rows(left: Expression | Matrix, right: Expression | Matrix) -> list[tuple[Expression, Expression]]:
    """Return the equations between two sides, one for each entry of vectors."""
    if isinstance(left, Expression) and isinstance(right, Expression):
        return [(left, right)]
    first, second = list(_entries(left)), list(_entries(right))
    if isinstance(left, Expression) or isinstance(right, Expression):
        whole = first if isinstance(left, Matrix) else second
        other = second[0] if isinstance(left, Matrix) else first[0]
        return [(e, number(0)) for e in whole] if is_number(other, 0) else []
    return list(zip(first, second, strict=True)) if len(first) == len(second) else []


def _comment(equation: PrintedEquation) -> str:
    return " ".join(written(equation.tokens).split())[:200]


def _named(expressions: Iterable[Expression]) -> dict[str, None]:
    return dict.fromkeys(
        n.name
        for e in expressions
        for n in names(e)
        if isinstance(n, Name | Derivative) and n.name != LAPLACE
    )


def _lagrangian(paper: Paper, found: _PaperMotion) -> Expression | None:
    """Return L, where the paper derives it and says what it is; ``None`` for equations written out."""
    displayed = [text_of(d.tokens) for d in paper.displays]
    if not any(r"\partialL}{\partial\dot" in text.replace(r"\mathcal{L}", "L") for text in displayed):
        return None
    said = {one.left.name: one.right for one in found.equations if isinstance(one.left, Name)}
    said |= {name: value for name, (value, _) in found.definitions.items()}
    lagrangian = next((said[name] for name in ("L", "Lcal") if name in said), None)
    for _ in range(ENERGIES):
        lagrangian = lagrangian and substitute(lagrangian, said)
    return lagrangian


def _forces(paper: Paper, gaps: list[str]) -> dict[str, str]:
    """Return what acts on each coordinate: the symbol that is alone on the right of Lagrange's equation."""
    found: dict[str, str] = {}
    notation = PaperNotation({PrintedSymbol("s"): LAPLACE}, motion="time")
    for equation in (e for d in paper.displays if d.problem is None for e in statements(d.tokens)):
        left, texts = equation.sides[0], [t.text for t in equation.sides[0]]
        if r"\partial" not in texts or r"\dot" not in texts or len(equation.sides) == 1:
            continue
        moving = left[texts.index(r"\dot") :]
        try:
            coordinate = read_value(moving[: group_end(moving, 1)], notation)
            force = read_value(equation.sides[-1], notation)
        except SpecError as error:
            gaps.append(f"line {equation.span.line} is not read: {error.diagnostics[0].message}")
            continue
        if isinstance(coordinate, Derivative) and isinstance(force, Name):
            found[coordinate.name] = force.name
        elif not (isinstance(force, Expression) and is_number(force, 0)):
            gaps.append(f"line {equation.span.line}: what acts is not read: {_comment(equation)}")
        if LAGRANGE.fullmatch(re.sub(r"\\(left|right|mathrm)\b|[(){}\[\]]", "", text_of(left))) is None:
            said = "has more than the derivatives of L; add it to forces or dissipation"
            gaps.append(f"line {equation.span.line} {said}: {_comment(equation)}")
    return found


def _energy_text(found: _PaperMotion, title: str, lagrangian: Expression, paper: Paper) -> str:
    """Return a specification with the energies of a paper, from which Lagrange's equations are derived."""
    everything = _named([lagrangian])
    coordinates = list(dict.fromkeys(n.name for n in names(lagrangian) if isinstance(n, Derivative)))
    parameters = [name for name in everything if name not in (*coordinates, "pi")]
    found.gaps = [gap for gap in found.gaps if r"\partial" not in gap]
    forces = _forces(paper, found.gaps)
    acting = {name: force for name, force in forces.items() if name in coordinates}
    lines = [*_heading(found, title)]
    if not acting:
        lines.append(f"{GAP} no input was found: add what acts to forces and to [inputs]")
    lines += [
        *_parameters(parameters),
        "",
        "# L, with its sign: potential energy is subtracted in it",
        "[energy]",
    ]
    lines.append(f"coordinates = [{', '.join(map(_quoted, coordinates))}]")
    lines.append(f"kinetic     = {_quoted(format_expression(lagrangian))}")
    if acting:
        lines.append(f"forces      = {{ {', '.join(f'{q} = {_quoted(f)}' for q, f in acting.items())} }}")
    lines += ["", f"{GAP} rest at zero is assumed here", "[operating_point]"]
    lines += [f'{name} = "0"' for name in (*coordinates, *acting.values())]
    return "\n".join([*lines, *_ends(coordinates, list(dict.fromkeys(acting.values()))), ""])


def _laplace_text(paper: Paper, title: str) -> str | None:
    """Return the specification of equations in s; ``None`` if a paper has none."""
    found = _read(paper, PaperNotation({PrintedSymbol("s"): LAPLACE}))
    functions = {
        one.left.name: one.right
        for one in found.equations
        if isinstance(one.left, Name) and not set(_named([one.right])) & found.timed
    }
    algebraic = [
        _Equation(Name(name), value, printed)
        for name, (value, printed) in found.definitions.items()
        if name in found.timed and set(_named([value])) & found.timed
    ]
    equations = [
        replace(one, left=substitute(one.left, functions), right=substitute(one.right, functions))
        for one in (*found.equations, *algebraic)
        if not (isinstance(one.left, Name) and one.left.name in functions)
        and not is_ratio((one.left, one.right), found.timed)
    ]
    signals = signals_in([(one.left, one.right) for one in equations], found.timed, FORCES)
    if signals is None:
        return None
    if signals.doubt:
        found.gaps.append(signals.doubt)
    found.definitions = {n: d for n, d in found.definitions.items() if n not in found.timed}
    found.equations = equations
    return _text(found, title, signals)


def _text(found: _PaperMotion, title: str, signals: Signals | None = None) -> str:
    sides = [e for one in found.equations for e in (one.left, one.right)]
    derived = dict.fromkeys(n.name for e in sides for n in names(e) if isinstance(n, Derivative))
    unknowns = list(derived if signals is None else signals.unknowns)
    kept: dict[str, Expression] = {}
    for name, (value, printed) in found.definitions.items():
        if name in unknowns or set(_named([value])) & set(unknowns):
            found.equations.append(_Equation(Name(name), value, printed))
            unknowns += [] if name in unknowns else [name]
        elif name in _named([*sides, *kept.values()]):
            kept[name] = value
    is_nonlinear = any(degree(term, unknowns) > 1 for one in found.equations for term in one.terms)
    everything = _named([e for one in found.equations for e in (one.left, one.right)] + list(kept.values()))
    inputs = list(_inputs(found, unknowns, kept, everything) if signals is None else signals.inputs)
    parameters = [n for n in everything if n not in (*unknowns, *inputs, *kept, "pi")]
    lines = [*_heading(found, title)]
    if len(found.equations) != len(unknowns):
        lines.append(
            f"{GAP} {len(found.equations)} equations for {len(unknowns)} unknowns: {', '.join(unknowns)}"
        )
    if not inputs:
        lines.append(f"{GAP} no input was found: add what acts to an equation and to [inputs]")
    lines += _parameters(parameters)
    if kept:
        lines += ["", "[definitions]", *(f'{n} = "{format_expression(e)}"' for n, e in kept.items())]
    lines += ["", "[equations]", f"unknowns  = [{', '.join(_quoted(u) for u in unknowns)}]"]
    lines += _listed("equations", found.equations)
    if is_nonlinear:
        lines += [
            "",
            f"{GAP} the equations are not linear; rest at zero is assumed here",
            "[operating_point]",
        ]
        lines += [f'{name} = "0"' for name in (*unknowns, *inputs)]
    return "\n".join([*lines, *_ends(unknowns, inputs), ""])


def _heading(found: _PaperMotion, title: str) -> Iterator[str]:
    yield f"# Read from the equations of motion in {title}."
    yield "# Each line says what it was read from; look for GAP where something is still to be said."
    yield from (f"{GAP} {gap}" for gap in found.gaps)
    yield "symflex = 1"
    yield f"title   = {_quoted(title)}"


def _parameters(parameters: Sequence[str]) -> Iterator[str]:
    if parameters:
        yield ""
        yield f'{GAP} values and units of parameters, such as value = "2 kg"'
        yield "[parameters]"
        yield from (f"{name} = {{}}" for name in parameters)


def _ends(unknowns: Sequence[str], inputs: Sequence[str], outputs: Sequence[str] = ()) -> Iterator[str]:
    yield from ("", "[inputs]", *(f"{name} = {{}}" for name in inputs))
    yield from ("", "[outputs]")
    taken = {*unknowns, *inputs}
    for name, written_as in zip(unknowns, outputs or unknowns, strict=True):
        shown = name[0].upper() + name[1:]
        yield f'{shown if shown not in taken else f"{name}_out"} = "{written_as}"'


def _quoted(text: str) -> str:
    return '"' + "".join(c for c in text if c.isprintable()).replace("\\", "/").replace('"', "'") + '"'


def _inputs(
    found: _PaperMotion, unknowns: Sequence[str], kept: dict[str, Expression], everything: Iterable[str]
) -> Iterator[str]:
    """Yield what acts: functions of time that are no unknowns, and what stands alone in a term."""
    moving = [t for one in found.equations for t in one.terms if set(_named([t])) & set(unknowns)]
    chosen = dict.fromkeys(_like_unknowns(moving, unknowns))
    beside = set(_named(moving))
    for one in found.equations:
        for term in one.terms:
            held = [n for n in _named([term]) if n not in (*kept, *CONSTANT)]
            if set(held) & set(unknowns):
                continue
            if "t" in held:
                said = f"the term {format_expression(term)} of line {one.printed.span.line}"
                found.gaps.append(f"{said} is a function of time; give it a name as an input")
                continue
            timed = [n for n in held if n in found.timed]
            alone = [n for n in held if n not in beside] or (held if len(held) == 1 else [])
            forces = [n for n in alone if n.split("_")[0] in FORCES]
            pick = timed or (alone if len(alone) == 1 else forces[:1])
            if "g" in _named([term]) and not timed:
                pick = []
            if pick:
                chosen.setdefault(pick[0])
            else:
                found.gaps.append(
                    f"the term {format_expression(term)} of line {one.printed.span.line} has no unknown in "
                    "it and is no input"
                )
    yield from chosen
    yield from (n for n in everything if n in found.timed and n not in unknowns and n not in chosen)


def _like_unknowns(terms: Iterable[Expression], unknowns: Sequence[str]) -> Iterator[str]:
    """Yield what is added to an unknown and named like one, such as the road z_r in k_t*(z_u - z_r)."""
    stems = {name.partition("_")[0] for name in unknowns}
    for part in (node for term in terms for node in nodes(term) if isinstance(node, Sum)):
        bare = [term.operand if isinstance(term, Negative) else term for term in part.terms]
        added = [one.name for one in bare if isinstance(one, Name | Derivative)]
        for name in added if set(added) & set(unknowns) else ():
            stem, _, index = name.partition("_")
            if name not in unknowns and stem in stems and index not in RESTING:
                yield name


# --- fields ---


def _field_text(found: _PaperMotion, title: str, paper: Paper) -> str:
    """Return a specification with one field: an equation along x, and conditions at its ends."""
    found.equations += _supports(found, paper)
    sides = [e for one in found.equations for e in (one.left, one.right)]
    points = [n for e in sides for n in names(e) if isinstance(n, Call) and n.name not in FUNCTIONS]
    along = dict.fromkeys(n.name for e in sides for n in names(e) if isinstance(n, Derivative))
    unknowns = list(along) or list(dict.fromkeys(n.name for n in points))
    fields = [
        one for one in found.equations if not any(n in names(one.left) + names(one.right) for n in points)
    ]
    conditions = [one for one in found.equations if one not in fields]
    kept = {n: v for n, (v, _) in found.definitions.items() if n in _named(sides) and n not in unknowns}
    ends = list(dict.fromkeys(format_expression(n.argument) for n in points))
    everything = _named([*sides, *kept.values(), *(n.argument for n in points)])
    inputs = [n for n in everything if n in found.timed and n not in unknowns]
    inputs += [n for n in _inputs_of_conditions(conditions) if n not in (*inputs, *ends)]
    parameters = [n for n in everything if n not in (*unknowns, *inputs, *kept, "x", "pi")]
    last = next((e for e in reversed(ends) if e != "0"), "l")
    lines = [*_heading(found, title)]
    if len(unknowns) != len(fields):
        lines.append(f"{GAP} {len(fields)} equations along x for the fields {', '.join(unknowns) or 'none'}")
    order = sum(max((_order(e, name) for e in sides), default=0) for name in unknowns)
    if len(conditions) != order:
        lines.append(f"{GAP} {len(conditions)} conditions for equations of order {order} along x")
    if not inputs:
        lines.append(f"{GAP} no input was found: add what acts to a condition and to [inputs]")
    lines += _parameters(list(dict.fromkeys([*parameters, *([last] if last.isidentifier() else [])])))
    if kept:
        lines += ["", "[definitions]", *(f'{n} = "{format_expression(e)}"' for n, e in kept.items())]
    name = unknowns[0] if unknowns else "w"
    lines += ["", f"[fields.{name}]"]
    if len(unknowns) > 1:
        lines += [f"unknowns   = [{', '.join(map(_quoted, unknowns))}]"]
    lines += [f'domain     = ["0", "{last}"]']
    if len(fields) == 1 and len(unknowns) < 2:  # noqa: PLR2004 (a system)
        one = fields[0]
        lines += [
            f"equation   = {_quoted(one.text)}  # line {one.printed.span.line}: {_comment(one.printed)}"
        ]
    else:
        lines += _listed("equations ", fields)
    lines += _listed("conditions", conditions)
    shown = [f"{n}({_free_point(n, last, conditions)})" for n in unknowns or [name]]
    return "\n".join([*lines, *_ends(unknowns or [name], inputs, shown), ""])


def _supports(found: _PaperMotion, paper: Paper) -> list[_Equation]:
    """Return the conditions of one beam, rod or string that a sentence says, at ends that have none."""
    sides = [e for one in found.equations for e in (one.left, one.right)]
    slopes = [n for e in sides for n in names(e) if isinstance(n, Derivative)]
    held = {format_expression(n.argument) for e in sides for n in names(e) if isinstance(n, Call)}
    order = max((n.order for n in slopes), default=0)
    if len({n.name for n in slopes}) != 1 or order not in (2, 4):
        return []
    source = paper.displays[0].span.source
    is_plain = all(n.order == order for n in slopes)  # a free end of a beam in tension has another force
    supports = []
    for match in SUPPORT.finditer(source.text):
        word = match[1].lower()
        zero = SLOPES.get(word[:5].rstrip("- "), (0, 2)) if order > 2 else (int(word == "free"),)  # noqa: PLR2004
        said = PrintedEquation(((LatexToken(match[0], Span(source, *match.span())),),))
        for at in POINT.findall(match[2]):
            point = number(int(at)) if at.isdigit() else Name(at)
            if at not in held and (is_plain or word != "free"):
                supports += [_Equation(Call(slopes[0].name, point, n), number(0), said) for n in zero]
    return supports


def _free_point(name: str, last: str, conditions: Sequence[_Equation]) -> str:
    """Return where a field may move: its end, its beginning, or between them."""
    given = {
        format_expression(one.left) for one in conditions if isinstance(one.left, Call) and not one.left.order
    }
    return next((point for point in (last, "0") if f"{name}({point})" not in given), f"{last}/2")


def _listed(key: str, equations: Sequence[_Equation]) -> Iterator[str]:
    yield f"{key} = ["
    for one in equations:
        yield f"    {_quoted(one.text)},  # line {one.printed.span.line}: {_comment(one.printed)}"
    yield "]"


def _order(node: Expression, name: str) -> int:
    """Return the order of the highest derivative of a field along x."""
    if isinstance(node, Derivative):
        return node.order if node.name == name else 0
    inner = max((_order(child, name) for child in node.children), default=0)
    holds = isinstance(node, Differentiated) and name in _named([node])
    return inner + node.order if holds and isinstance(node, Differentiated) else inner


def _inputs_of_conditions(conditions: Sequence[_Equation]) -> Iterator[str]:
    for one in conditions:
        for term in one.terms:
            held = list(_named([term]))
            has_field = any(isinstance(n, Call) and n.name not in FUNCTIONS for n in names(term))
            if len(held) == 1 and not has_field:
                yield held[0]
