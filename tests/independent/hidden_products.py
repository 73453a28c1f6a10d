"""Products of which a pole cancels, in every place that takes an expression of s, and what is true of them.

A case is a place, a spelling and a dynamics: the value of a spring, written as a product of two blocks, of
which the pole s = 1 cancels. The truth is that of its twin, in which each stage of the product is an unknown
of its own: a matrix of polynomials, from the equations beside each place. Its determinant is the
characteristic polynomial of all poles; those that the transfer function lacks in lowest terms are hidden.
Models with waves have the characteristic function of a textbook instead.

``python -m tests.independent.hidden_products`` prints what each command reports of each case.
"""

from __future__ import annotations

import argparse
import json
import traceback
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import chain, product
from time import process_time

import mpmath
import numpy as np
import sympy as sp
from sympy.polys.matrices import DomainMatrix

import symflex
from symflex.errors import InternalError, SymflexError
from tests.independent.hidden_places import PLACES, E, Place, q, s

z = sp.Symbol("z")  # the delay, or the root of s, of a dynamics
RING = sp.QQ[s, z, q]
NEAR = 1e-6  # poles of numpy are as near as that, relatively; multiple ones are found factor by factor
Polynomial = sp.polys.rings.PolyElement


# ------------------------------------------------------------------------------------------------- dynamics


@dataclass(frozen=True)
class Dynamics:
    """A factor that a product has below and above."""

    name: str
    text: str
    factor: sp.Expr
    grows: bool  # whether a root of it lies in the right half-plane
    roots: tuple[complex, ...] = ()  # those that have to be listed
    kernel: Callable[[mpmath.mpc], mpmath.mpc] | None = None  # what z stands for, with T = 1 s and a = 1 s


def _delay(p: mpmath.mpc) -> mpmath.mpc:
    return mpmath.exp(-p)


def _exponential(p: mpmath.mpc) -> mpmath.mpc:
    return mpmath.exp(-mpmath.sqrt(p))


DYNAMICS = (
    Dynamics("unstable", "s - 1", s - 1, True, (1,)),
    Dynamics("stable", "s + 4", s + 4, False, (-4,)),
    Dynamics("delay, unstable", "1 - 2*exp(-s*T)", 1 - 2 * z, True, kernel=_delay),  # ln 2 + 2 pi j k
    Dynamics("delay, stable", "1 - exp(-s*T)/2", 1 - z / 2, False, kernel=_delay),  # -ln 2 + 2 pi j k
    Dynamics("unstable pair", "s^2 - 2*s + 5", s**2 - 2 * s + 5, True, (1 + 2j, 1 - 2j)),
    Dynamics("exp of a root", "1 - 2*exp(-sqrt(s*a))", 1 - 2 * z, True, kernel=_exponential),  # (ln 2)^2
    Dynamics("root", "sqrt(s*a) - 1", z - 1, True, kernel=mpmath.sqrt),  # 1
    Dynamics(
        "root, stable", "sqrt(s*a) + 1", z + 1, False, kernel=mpmath.sqrt
    ),  # none on the principal sheet
    Dynamics("at rest", "s", s, False, (0,)),
)


# ------------------------------------------------------------------------------------------------ spellings

Stage = tuple[sp.Expr, sp.Expr]  # above and below
Chains = tuple[tuple[Stage, ...], ...]


@dataclass(frozen=True)
class Spelled:
    """An expression as written, and as ``constant`` plus a sum of chains of stages in series."""

    text: str
    chains: Chains
    constant: int = 0
    definitions: dict[str, str] = field(default_factory=dict)
    blocks: dict[str, str] = field(default_factory=dict)
    signals: dict[str, str] = field(default_factory=dict)  # ``@`` is what the place multiplies

    def value(self, p: mpmath.mpc, kernel: Callable[[mpmath.mpc], mpmath.mpc] | None) -> mpmath.mpc:
        """Return the expression at a point, infinity at a pole."""
        products = (sp.prod(above / below for above, below in stages) for stages in self.chains)
        above, below = sp.fraction(sp.cancel(self.constant + sum(products)))
        above, below = (_number(x, {s: p, z: kernel(p) if kernel else 0}) for x in (above, below))
        return above / below if below else mpmath.inf


def _number(expression: sp.Expr, at: dict[sp.Symbol, mpmath.mpc]) -> mpmath.mpc:
    return sp.lambdify(list(at), expression, "mpmath")(*at.values())


def _stages(d: Dynamics) -> tuple[Stage, ...]:
    return (sp.Integer(1), d.factor), (d.factor, s + 2)


def _pc(d: Dynamics) -> dict[str, str]:
    return {"P": f"1/({d.text})", "C": f"({d.text})/(s + 2)"}


def _p(d: Dynamics) -> dict[str, str]:
    return {"P": f"1/({d.text})"}


def _difference(d: Dynamics) -> Spelled:
    """P less what makes it 1/(s + 2)."""
    chains = (((sp.Integer(1), d.factor),), ((d.factor - s - 2, d.factor * (s + 2)),))
    return Spelled(f"(P - (s + 2 - ({d.text}))/(({d.text})*(s + 2)))", chains, blocks=_p(d))


def _loop(d: Dynamics) -> Spelled:
    """The open loop, followed by 1/(1 + P C)."""
    last = d.factor * (s + 2), d.factor * (s + 2) + d.factor
    return Spelled("P*C/(1 + P*C)", ((*_stages(d), last),), blocks=_pc(d))


def _series(text: str, **given: Callable[[Dynamics], dict[str, str]] | dict[str, str]) -> Spelling:
    """Return how to write P C; ``given`` are sections, made of the dynamics where they are functions."""

    def spelled(d: Dynamics) -> Spelled:
        sections = {key: each if isinstance(each, dict) else each(d) for key, each in given.items()}
        return Spelled(text.replace("%", d.text), (_stages(d),), **sections)

    return spelled


Spelling = Callable[[Dynamics], Spelled]
SPELLINGS: dict[str, Spelling] = {
    "blocks": _series("P*C", blocks=_pc),
    "definitions": _series("P*C", definitions=_pc),
    "inline": lambda d: Spelled(f"({d.text})/(({d.text})*(s + 2))", (((d.factor, d.factor * (s + 2)),),)),
    "two inline": _series("1/(%)*((%)/(s + 2))"),
    "block times inline": _series("P*(%)/(s + 2)", blocks=_p),
    "inline times definition": _series("(%)/(s + 2)*P", definitions=_p),
    "nested definitions": _series(
        "Q", definitions=lambda d: {"R_1": d.text, "P": "1/R_1", "C": "R_1/(s + 2)", "Q": "P*C"}
    ),
    "nested blocks": _series("Q", blocks=lambda d: {**_pc(d), "Q": "P*C"}),
    "definition of blocks": _series("Q", blocks=_pc, definitions={"Q": "P*C"}),
    "sum with blocks": lambda d: Spelled("(1 + P*C)", (_stages(d),), 1, blocks=_pc(d)),
    "sum with definitions": lambda d: Spelled("(1 + P*C)", (_stages(d),), 1, definitions=_pc(d)),
    "inverse of a block": _series("1/(1/P)*C", blocks=_pc),
    "inverse of a definition": _series("1/(1/P)*C", definitions=_pc),
    "power of blocks": lambda d: Spelled("(P*C)^2", (_stages(d) * 2,), blocks=_pc(d)),
    "power of definitions": lambda d: Spelled("(P*C)^2", (_stages(d) * 2,), definitions=_pc(d)),
    "quotient": _series("P/R_1", definitions=lambda d: {**_p(d), "R_1": f"(s + 2)/({d.text})"}),
    "difference": _difference,
    "loop as a formula": _loop,
    "tf": lambda d: Spelled(
        "G_1",
        (((d.factor, d.factor * (s + 2)),),),
        blocks={"G_1": f'{{ type = "tf", num = "{d.text}", den = "({d.text})*(s + 2)" }}'},
    ),
    "signal": _series("v", blocks=_pc, signals={"v": "P*C*@"}),
    "two signals": _series("v", blocks=_pc, signals={"u": "P*@", "v": "C*u"}),
    "inline signal": _series("v", signals=lambda d: {"v": f"1/({d.text})*({d.text})/(s + 2)*@"}),
    "signal of definitions": _series("v", definitions=_pc, signals={"v": "P*C*@"}),
}


# ----------------------------------------------------------------------------------------------- the truth


@dataclass(frozen=True)
class Truth:
    """The characteristic polynomials of what a transfer function shows, and of what it hides."""

    visible: Polynomial
    hidden: Polynomial

    @property
    def poles(self) -> list[complex]:
        """The visible poles, where there are no kernels, by numpy."""
        return [
            complex(root)
            for factor, times in self.visible.factor_list()[1]
            for root in np.repeat(np.roots([float(x) for x in _in_s(factor)]), times)
        ]


def _in_s(polynomial: Polynomial) -> list[sp.Rational]:
    return sp.Poly(polynomial.as_expr(), s).all_coeffs()


def truth(place: Place, spelling: str, d: Dynamics) -> Truth:
    """Return what is true of a case without waves: determinants of its twin."""
    spelled = SPELLINGS[spelling](d)
    *rows, given = zip(*place.rows, strict=True)  # columns
    rows = [list(row) for row in zip(*rows, strict=True)]
    given = list(given)
    size = len(rows)
    for column in range(size):
        slopes = [sp.diff(row[column], E) for row in rows]
        for row in rows:
            row[column] = sp.sympify(row[column]).subs(E, spelled.constant if column < size else 0)
        if not any(slopes):
            continue
        for stages in spelled.chains:
            before = column
            for above, below in stages:
                for row in rows:
                    row.append(sp.Integer(0))
                row = [sp.Integer(0)] * len(rows[0])
                row[before], row[-1] = -above, below
                rows.append(row)
                given.append(0)
                before = len(row) - 1
            for i, slope in enumerate(slopes):
                rows[i][before] += slope
    below = _determinant(rows)
    above = _determinant([[x, *row[1:]] for row, x in zip(rows, given, strict=True)])
    assert below, "the equations determine nothing"
    shared = below.gcd(above)
    return Truth(below.exquo(shared), shared)


def _determinant(rows: list[list[sp.Expr]]) -> Polynomial:
    matrix = DomainMatrix(
        [[RING.from_sympy(sp.expand(x)) for x in row] for row in rows], (len(rows),) * 2, RING
    )
    return matrix.charpoly()[-1] * (-1) ** len(rows)


def _is_root(polynomial: Polynomial, p: complex, kernel: Callable[[mpmath.mpc], mpmath.mpc] | None) -> bool:
    """Tell whether a factor of a polynomial in s, z and q vanishes, compared with its terms."""
    if p == 0 and kernel is None:
        return polynomial.evaluate([(0, 0)]) == 0
    point = [
        mpmath.mpmathify(p),
        kernel(p) if kernel else mpmath.mpf(0),
        mpmath.exp(-0.3 * mpmath.mpmathify(p)),
    ]
    for factor, _ in polynomial.factor_list()[1]:
        terms = [
            float(x) * mpmath.fprod(v**n for v, n in zip(point, m, strict=True)) for m, x in factor.terms()
        ]
        if abs(mpmath.fsum(terms)) <= NEAR * max(map(abs, terms)):
            return True
    return False


# --------------------------------------------------------------------------------------------------- cases


@dataclass(frozen=True)
class Case:
    """An expression in a place."""

    place: Place
    spelling: str
    dynamics: Dynamics

    def __str__(self) -> str:
        return f"{self.place.name} | {self.spelling} | {self.dynamics.name}"

    @property
    def spelled(self) -> Spelled:
        """The expression."""
        return SPELLINGS[self.spelling](self.dynamics)

    @property
    def text(self) -> str:
        """The specification."""
        spelled, place = self.spelled, self.place
        lines = ["symflex = 1"]
        lines += [f'definitions.{name} = "{text}"' for name, text in spelled.definitions.items()]
        for name, text in spelled.blocks.items():
            lines.append(f"blocks.{name} = {text}" if text[0] == "{" else f'blocks.{name} = "{text}"')
        lines += [f'signals.{n} = "{text.replace("@", place.of)}"' for n, text in spelled.signals.items()]
        product = f"{spelled.text}*{place.of}" if place.of and not spelled.signals else spelled.text
        body = place.text.replace("@", product)
        for letter in "Ta" if self.dynamics.kernel else "":
            if letter in "".join(c if c.isalnum() else " " for c in self.dynamics.text).split():
                body = body.replace("parameters = { ", f'parameters = {{ {letter} = "1 s", ', 1)
                body = body.replace("[parameters]\n", f'[parameters]\n{letter} = "1 s"\n', 1)
        return "\n".join([*lines, *filter(None, body.splitlines())]) + "\n"


def cases() -> Iterator[Case]:
    """Yield a case for each place and spelling; the dynamics take turns, so that each meets each of both."""
    spellings = list(SPELLINGS)
    for i, place in enumerate(PLACES):
        fitting = [x for x in spellings if place.of or not SPELLINGS[x](DYNAMICS[0]).signals]
        for j, spelling in enumerate(fitting):
            yield Case(place, spelling, DYNAMICS[(i + j) % len(DYNAMICS)])


def every_case() -> Iterator[Case]:
    """Yield all combinations."""
    for place, (spelling, written), dynamics in product(PLACES, SPELLINGS.items(), DYNAMICS):
        if place.of or not written(dynamics).signals:
            yield Case(place, spelling, dynamics)


# ------------------------------------------------------------------------------------------- what is said

WRONG = "WRONG"  # how a finding that must not be begins
COMMANDS = ("roots", "gain", "over", "spread", "letters", "live")


def examined(case: Case, commands: Sequence[str] = COMMANDS, seconds: float | None = None) -> dict[str, str]:
    """Return what each command reports: a word, a code that refuses, or what is wrong."""
    try:
        model = symflex.loads(case.text)
    except InternalError:
        return {"load": f"{WRONG} SF991"}
    except SymflexError as error:
        return {"load": _refusal(error)}
    except Exception as error:  # noqa: BLE001 (a traceback is what is looked for)
        return {"load": f"{WRONG} traceback {_last(error)}"}
    found = {}
    for command in commands:
        try:
            with symflex.Budget(seconds=seconds).entered():
                said = ASKED[command](model, case)
        except InternalError as error:
            said = f"{WRONG} {error.diagnostics[0].code} {error.diagnostics[0].message[:80]}"
        except SymflexError as error:
            said = _refusal(error)
        except Exception as error:  # noqa: BLE001 (a traceback is what is looked for)
            said = f"{WRONG} traceback {_last(error)}"
        found[command] = said
    return found


def _refusal(error: SymflexError) -> str:
    first = error.diagnostics[0]
    return f"{WRONG if first.code == 'SF991' else 'refused'} {first.code} {first.message[:110]}"


def _last(error: Exception) -> str:
    frame = traceback.extract_tb(error.__traceback__)[-1]
    return f"{type(error).__name__}: {error} at {frame.filename.split('symflex/')[-1]}:{frame.lineno}"[:160]


def _judged(word: str, case: Case) -> str:
    """Return a word of stability, with what is wrong about it."""
    if case.dynamics.grows and word in ("stable", "marginal"):
        return f"{WRONG} {word}, and a hidden pole grows"
    if not case.dynamics.grows and word in ("unstable", "marginal"):
        return f"{WRONG} {word}, and all poles decay or are hidden"
    return word


def _roots(model: symflex.Model, case: Case) -> str:
    function = model.transfer_function("X", model.inputs[0])
    found = function.bind().pole_zero_map(modes=2 if case.place.law else None)
    wrong = []
    kernel, spelled = case.dynamics.kernel, case.spelled
    poles = [complex(root) for root in found.poles for _ in range(root.multiplicity)]
    hidden = [complex(mode.root) for mode in found.hidden]
    far = (
        max(map(abs, poles), default=0) if case.place.law else np.inf
    )  # with waves, what is listed ends there
    for root in case.dynamics.roots:
        if abs(root) < far and not any(abs(root - p) < NEAR for p in hidden):
            wrong.append(f"hidden {root:.4g} missing")
    if case.place.rows is not None:
        true = truth(case.place, case.spelling, case.dynamics)
        if true.visible.degree(1) <= 0 >= true.visible.degree(2):
            expected = true.poles
            if found.certificate.certified and _alone(poles, expected):
                wrong.append(f"poles {_shown(poles)} for {_shown(expected)}")
        else:
            wrong += [f"pole {p:.6g} is none" for p in poles if not _is_root(true.visible, p, kernel)]
        wrong += [f"hidden {p:.6g} is none" for p in hidden if not _is_root(true.hidden, p, kernel)]
    else:

        def law(p: mpmath.mpc) -> mpmath.mpc:
            return case.place.law(p, spelled.value(p, kernel))

        for p in poles:
            if not _is_near_root(law, mpmath.mpc(p)):
                wrong.append(f"pole {p:.6g} is none")
        stages = [x for x in chain(*spelled.chains)]
        for p in hidden:
            at = {s: p, z: kernel(p) if kernel else 0}
            if (
                all(abs(_number(x, at)) > NEAR for x in chain(*stages))
                and abs(1 + spelled.value(p, kernel)) > NEAR
            ):
                wrong.append(f"hidden {p:.6g} is none")
    judged = _judged(found.verdict.word, case)
    if case.dynamics.name == "at rest" and not wrong and not found.verdict.hidden:
        wrong.append("hidden pole at rest not named")
    if wrong and not judged.startswith(WRONG):
        judged = f"{WRONG} {judged}"
    return "; ".join([judged, *wrong])


def _is_near_root(law: Callable[[mpmath.mpc], mpmath.mpc], p: mpmath.mpc) -> bool:
    """Tell whether Newton's method stays at a point."""
    try:
        with mpmath.workdps(30):
            return abs(law(p)) <= NEAR * (1 + abs(p)) * abs(mpmath.diff(law, p))
    except ZeroDivisionError:  # a stiffness of zero, where infinitely many poles gather
        return False


def _alone(ones: Sequence[complex], others: Sequence[complex]) -> bool:
    """Tell whether two lists of poles differ."""
    left = list(others)
    for p in ones:
        near = [x for x in left if abs(x - p) < NEAR * (1 + abs(p))]
        if not near:
            return True
        left.remove(near[0])
    return bool(left)


def _shown(poles: Sequence[complex]) -> str:
    return ", ".join(f"{p:.5g}" for p in sorted(poles, key=lambda p: (p.real, p.imag)))


def _mapped(model: symflex.Model, case: Case, **given: str) -> str:
    found = model.stability(**given)
    judged = _judged(found.verdict.word, case)
    if case.dynamics.grows and found.stable and not judged.startswith(WRONG):
        return f"{WRONG} {judged}, with ranges of stable values"
    return judged


def _letters(model: symflex.Model, case: Case) -> str:
    found = model.conditions()
    if found.is_never:
        return _judged("unstable", case)
    names = {p.name: sp.Symbol(p.name) for p in model.parameters}
    values = {names[p.name]: sp.Rational(str(p.value.rational)) for p in model.parameters if p.value}
    for condition in found.conditions:
        if condition.sign != ">" or condition.sides is None:
            return "unknown"
        left, right = (sp.sympify(text.replace("^", "**"), names) for text in str(condition).split(" > "))
        if not (left - right).subs(values) > 0:
            return _judged("unstable", case)
    return _judged("stable", case)


def _live(model: symflex.Model, case: Case) -> str:
    html = model.live(f"X/{model.inputs[0]}").html
    data, _ = json.JSONDecoder().raw_decode(html, html.index('{"title": '))
    function = data["functions"][0]
    judged = _judged((function["verdict"] or {"word": "unknown"})["word"], case)
    tape = function.get("tape", {"refused": ""})
    if case.dynamics.grows and "refused" not in tape and not judged.startswith(WRONG):
        if tape.get("passive"):
            return f"{WRONG} {judged}, and passive"
        if not function.get("hides"):
            return f"{WRONG} {judged}, and hides nothing"
    return judged


ASKED: dict[str, Callable[[symflex.Model, Case], str]] = {
    "roots": _roots,
    "gain": lambda model, case: _mapped(model, case, gain="K"),
    "over": lambda model, case: _mapped(model, case, over="c"),
    "spread": lambda model, case: _judged(
        {"undecided": "unknown"}.get(word := model.stability(spread="1 %").word, word), case
    ),
    "letters": _letters,
    "live": _live,
}


# ------------------------------------------------------------------------------------------------- a table


def main() -> int:
    """Print a table, and what is wrong, kind by kind, with an example of each."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--all", action="store_true", help="all combinations")
    parser.add_argument("--commands", default=",".join(COMMANDS), help="which commands are asked")
    parser.add_argument("--place", default="", help="only places whose names contain this")
    parser.add_argument("--dynamics", default="", help="only dynamics whose names contain this")
    parser.add_argument("--part", default="0/1", help="I/N: the cases I, I + N, ...")
    parser.add_argument("--texts", action="store_true", help="print the specification of each kind")
    parser.add_argument("--seconds", type=float, default=60.0, help="time for each command")
    given = parser.parse_args()
    first, step = map(int, given.part.split("/"))
    counts: Counter[str] = Counter()
    kinds: dict[str, list[Case]] = {}
    for i, case in enumerate(every_case() if given.all else cases()):
        if (
            i % step != first
            or given.place not in case.place.name
            or given.dynamics not in case.dynamics.name
        ):
            continue
        start = process_time()
        found = examined(case, given.commands.split(","), given.seconds)
        counts["cases"] += 1
        expected = "unstable" if case.dynamics.grows else "stable"
        print(f"{case!s:<75} {expected:<8} {process_time() - start:6.2f} s", flush=True)
        for command, said in found.items():
            print(f"    {command:<8} {said}", flush=True)
            outcome = said.split()[0] if not said.startswith("refused") else " ".join(said.split()[:2])
            counts[f"{command}: {outcome}"] += 1
            if said.startswith(WRONG):
                kinds.setdefault(f"{command}: {said.split('; ')[0]}"[:90], []).append(case)
        counts["wrong cases"] += any(said.startswith(WRONG) for said in found.values())
    print()
    for count in sorted(counts.items()):
        print(*count)
    for kind, those in sorted(kinds.items()):
        print(f"\n{len(those)} x {kind}\n   in {dict(Counter(c.place.name for c in those))}"[:1500])
        print(f"   spelt {dict(Counter(c.spelling for c in those))}")
        if given.texts:
            print(f"   {those[0]}\n{those[0].text}")
    return 1 if kinds else 0


if __name__ == "__main__":
    raise SystemExit(main())
