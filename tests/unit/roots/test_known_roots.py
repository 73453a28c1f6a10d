"""Thirty functions whose roots have formulas, asked of the search and of every engine that serves them.

A case has the poles of the upper half plane and the real axis in the order of their distance from 0, the
multiplicity at 0, and zeros where they have a formula. Whatever way they are found, they are the same.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from fractions import Fraction
from itertools import count, islice
from typing import TYPE_CHECKING

import mpmath
import pytest
from mpmath import cos, cosh, findroot, mp, mpc, mpf, pi, sin, sqrt, tan, tanh

from symflex.budget import Budget
from symflex.errors import BudgetError
from symflex.roots import Band, Mode, Modes, Rectangle
from symflex.roots.distributed.proof import Proof
from symflex.roots.distributed.side import Side
from symflex.roots.engines import LOSSLESS, SEARCHES, SUBDIVISION
from symflex.roots.locate import locate
from tests.unit.roots.distributed_models import bound

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

DIGITS = 25
PINS = 'left = { type = "pin", at = "p" }\nright = { type = "pin", at = "q" }\n'
ANGLE = 'inputs.M = { torque = "p.theta" }\noutputs.Y = "p.theta"\n'


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(DIGITS + 15):
        yield


@dataclass(frozen=True)
class Case:
    text: str
    poles: Callable[[], Iterator]
    zeros: Callable[[], Iterator] | None = None
    at_zero: int = 0
    word: str = "marginal"  # unknown where two wavenumbers are branches that leave the axis open
    lossless: bool = True
    count: int = 3  # modes asked for
    times: int = 1  # multiplicity
    hidden: tuple = ()  # modes that are not seen, by number


def member(kind, values, between='"ground", "x"', more=""):
    inputs = "torque" if kind == "shaft" else "force"
    return (
        f'symflex = 1\ninputs.F = {{ {inputs} = "x" }}\noutputs.Y = "x"\n[elements]\n'
        f'member = {{ type = "{kind}", between = [{between}], {values} }}\n{more}'
    )


def hinged(values):
    """Return a beam of EI = rho A = l = 1 between two pins, driven and seen as the angle at one of them."""
    given = f'between = ["p", "q"], E = 1, I = 1, rho = 1, A = 1, l = 1{values}'
    return f'symflex = 1\n{ANGLE}[elements]\narm = {{ type = "beam", {given} }}\n{PINS}'


def along(equation, *conditions, output="w(1)", parameters=""):
    """Return a field on 0 <= x <= 1."""
    listed = ", ".join(f'"{each}"' for each in conditions)
    return (
        f"symflex = 1\n{parameters}\ninputs.F = {{}}\noutputs.Y = '{output}'\n[fields.w]\n"
        f'domain = ["0", "1"]\nequation = "{equation}"\nconditions = [{listed}]\n'
    )


def late(expression, delay=1):
    return (
        f'symflex = 1\nblocks.D = {{ type = "delay", T = {delay} }}\ninputs.u = {{}}\n'
        f'outputs.Y = "{expression}"\n'
    )


def on_axis(omega, first=1):
    """Return the poles of a formula for the frequency of mode n."""
    return lambda: (mpc(0, omega(n)) for n in count(first))


def solved(equation, guess, power=1):
    """Return frequencies that an equation gives, one beside each guess."""
    return on_axis(lambda n: findroot(equation, guess(n)) ** power)


def quadratic(omega, damping):
    """Return the upper root of ``s^2 + damping s + omega^2`` for every mode, or both where they are real."""

    def roots():
        for n in count(1):
            c, k = damping(n), omega(n) ** 2
            root = mpmath.sqrt(mpc(c * c / 4 - k))
            yield -c / 2 + root if root.imag >= 0 else -c / 2 - root

    return roots


def lambert(argument, scale=1):
    """Return the branches of Lambert's function in the upper half plane in the order of their size."""

    def roots():
        every = sorted((scale * mpmath.lambertw(argument, k) for k in range(-12, 13)), key=abs)
        return iter([s for s in every if s.imag > -1e-20])

    return roots


def known(*values):
    return lambda: iter(sorted((mpc(v) for v in values), key=abs))


UNIT = "E = 1, rho = 1, A = 1, l = 1"
BENDS = f"{UNIT}, I = 1"
CASES = {
    # Rods, strings and shafts: sines and cosines of omega.
    "a rod that is held": Case(member("rod", UNIT), on_axis(lambda n: (n - mpf(1) / 2) * pi)),
    "a rod that is free": Case(
        member("rod", UNIT, '"y", "x"'),
        on_axis(lambda n: n * pi),
        on_axis(lambda n: (n - mpf(1) / 2) * pi),
        at_zero=2,
    ),
    "a rod with a mass": Case(
        member("rod", UNIT, more='tip = { type = "mass", at = "x", m = 0.5 }'),
        solved(lambda x: x * sin(x) - 2 * cos(x), lambda n: (n - 1) * pi + mpf(1) / n),
    ),
    "a shaft with an inertia": Case(
        member("shaft", "G = 1, J = 1, rho = 1, l = 1", more='tip = { type = "inertia", at = "x", J = 2 }'),
        solved(lambda x: 2 * x * sin(x) - cos(x), lambda n: (n - 1) * pi + mpf("0.6") / n),
    ),
    "a string on a foundation": Case(
        member("string", "N = 1, rho = 1, A = 1, l = 1, k_f = 3"),
        on_axis(lambda n: sqrt(((n - mpf(1) / 2) * pi) ** 2 + 3)),
    ),
    "a string in a fluid": Case(
        member("string", "N = 1, rho = 1, A = 1, l = 1, c_f = 0.5"),
        quadratic(lambda n: (n - mpf(1) / 2) * pi, lambda _: mpf(1) / 2),
        word="stable",
        lossless=False,
    ),
    "a string in a thick fluid": Case(
        member("string", "N = 1, rho = 1, A = 1, l = 1, c_f = 6"),
        lambda: iter(
            [
                -3 + sqrt(9 - pi**2 / 4),
                mpc(-3, sqrt((3 * pi / 2) ** 2 - 9)),
                -3 - sqrt(9 - pi**2 / 4),
                mpc(-3, sqrt((5 * pi / 2) ** 2 - 9)),
            ]
        ),
        word="stable",
        lossless=False,
    ),
    "a lossy rod": Case(
        member("rod", f"{UNIT}, eta = 0.01"),
        quadratic(lambda n: (n - mpf(1) / 2) * pi, lambda n: ((n - mpf(1) / 2) * pi) ** 2 / 100),
        word="stable",
        lossless=False,
    ),
    "a rod behind a delay": Case(
        along(
            "w'' = s^2*w", "w(0) = D*F", "w'(1) = 0", parameters='blocks.D = { type = "delay", T = 0.001 }'
        ),
        on_axis(lambda n: (n - mpf(1) / 2) * pi),
        word="unknown",
    ),
    # Beams: s = j x^2.
    "a cantilever": Case(
        member("beam", BENDS), solved(lambda x: cos(x) + 1 / cosh(x), lambda n: (n - mpf(1) / 2) * pi, 2)
    ),
    "a free beam": Case(
        member("beam", BENDS, '"y", "x"'),
        solved(lambda x: cos(x) - 1 / cosh(x), lambda n: (n + mpf(1) / 2) * pi, 2),
        # With the driven end pinned: tan x = tanh x.
        solved(lambda x: tan(x) - tanh(x), lambda n: (n + mpf(1) / 4) * pi, 2),
        at_zero=2,
    ),
    "a beam that slides": Case(
        member("beam", BENDS, '"x", "y"', 'slide = { type = "slider", at = "x" }'),
        solved(lambda x: tan(x) + tanh(x), lambda n: (n - mpf(1) / 4) * pi, 2),
        solved(lambda x: cos(x) + 1 / cosh(x), lambda n: (n - mpf(1) / 2) * pi, 2),
        at_zero=2,
    ),
    "a hinged beam": Case(
        hinged(""),
        on_axis(lambda n: (n * pi) ** 2),
        # With the driven end clamped: tan x = tanh x.
        solved(lambda x: tan(x) - tanh(x), lambda n: (n + mpf(1) / 4) * pi, 2),
    ),
    "a hinged beam that is pulled": Case(
        hinged(", N = 20"), on_axis(lambda n: sqrt((n * pi) ** 4 + 20 * (n * pi) ** 2)), word="unknown"
    ),
    "a hinged beam on a foundation": Case(hinged(", k_f = 50"), on_axis(lambda n: sqrt((n * pi) ** 4 + 50))),
    "Rayleigh's hinged beam": Case(
        hinged(', theory = "rayleigh"'),
        on_axis(lambda n: (n * pi) ** 2 / sqrt(1 + (n * pi) ** 2)),
        word="unknown",
    ),
    "a lossy hinged beam": Case(
        hinged(", eta = 0.004"),
        quadratic(lambda n: (n * pi) ** 2, lambda n: (n * pi) ** 4 / 250),
        word="stable",
        lossless=False,
        count=2,
    ),
    "a hinged beam beyond its buckling load": Case(
        hinged(", N = -12"),
        lambda: iter(
            [
                sqrt(12 * pi**2 - pi**4),
                -sqrt(12 * pi**2 - pi**4),
                *(mpc(0, sqrt((n * pi) ** 4 - 12 * (n * pi) ** 2)) for n in (2, 3, 4)),
            ]
        ),
        word="unstable",
    ),
    "two hinged beams in a row": Case(
        "symflex = 1\n"
        'inputs.F = { force = "m" }\noutputs.Y = "m"\n[elements]\n'
        'one = { type = "beam", between = ["p", "m"], E = 1, I = 1, rho = 1, A = 1, l = 0.5 }\n'
        f'two = {{ type = "beam", between = ["m", "q"], E = 1, I = 1, rho = 1, A = 1, l = 0.5 }}\n{PINS}',
        on_axis(lambda n: ((2 * n - 1) * pi) ** 2),
        hidden=(2, 4),  # the middle is a node of every other mode
    ),
    # Fields with an x in them.
    "a hanging string": Case(
        along("(x*w')' = s^2*w", "w(1) = F", output="w(0)"),
        # J_0(2 omega) = 0 (Daniel Bernoulli 1733).
        on_axis(lambda n: mpmath.besseljzero(0, n) / 2),
        count=2,
    ),
    "a conical rod": Case(
        along("((1 - x/2)^2*w')' = (1 - x/2)^2*s^2*w", "w(0) = 0", "w'(1) = F"),
        # u = (1 - x/2) w is a sine: w' = 0 at the end where omega cos(omega) + sin(omega) = 0.
        solved(lambda x: x * cos(x) + sin(x), lambda n: (n - mpf(1) / 2) * pi + mpf("0.3")),
        count=2,
    ),
    # Diffusion, lines and delays.
    "diffusion": Case(
        along("w'' = s*w", "w(0) = 0", "w'(1) = F"),
        lambda: (-(((n - mpf(1) / 2) * pi) ** 2) for n in count(1)),
        word="stable",
        lossless=False,
    ),
    "diffusion that reacts": Case(
        along("w'' = (s - 30)*w", "w(0) = 0", "w'(1) = F"),
        lambda: iter(
            sorted((30 - ((n - mpf(1) / 2) * pi) ** 2 for n in range(1, 6)), key=abs),
        ),
        word="unstable",
        lossless=False,
    ),
    "a line with losses": Case(
        along("w'' = (s + 1)*(s + 3)*w", "w(0) = 0", "w'(1) = (s + 1)*F"),
        lambda: (mpc(-2, sqrt(((n - mpf(1) / 2) * pi) ** 2 - 1)) for n in count(1)),
        word="stable",
        lossless=False,
    ),
    "a loop with a delay": Case(
        late("u/(s + 2*D)", "0.5"), lambert(-1, 2), word="stable", lossless=False, count=4
    ),
    "an unstable loop with a delay": Case(late("u/(s + 3*D)"), lambert(-3), word="unstable", lossless=False),
    "a delay beside a polynomial": Case(
        late("u*(s + 7)/((s + 1)*(s + 4)*(s + 2*D))", "0.5"),
        lambda: iter(sorted([mpc(-1), mpc(-4), *islice(lambert(-1, 2)(), 4)], key=abs)),
        known(-7),
        word="stable",
        lossless=False,
    ),
    "the square of a loop with a delay": Case(
        late("u/(s + 2*D)^2", "0.5"), lambert(-1, 2), word="stable", lossless=False, times=2
    ),
}

SEARCHED = (
    "a rod with a mass",
    "a string in a fluid",
    "a free beam",
    "a hinged beam on a foundation",
    "a line with losses",
    "a loop with a delay",
)
"""One of each kind: a wavenumber of s or of its root, with losses or without, a double pole at 0, a delay."""
BROKEN_OFF = ("a rod with a mass", "a free beam", "a loop with a delay")


def upper(roots):
    """Return the roots with im >= 0, without those at 0, and their multiplicities."""
    shown = [(root.decimal(DIGITS), root.multiplicity) for root in roots if not root.is_zero]
    return [(mpc(p.re, p.im), times) for p, times in shown if not p.im.startswith("-")]


def in_order(numbers):
    return sorted(numbers, key=lambda s: (round(abs(s), 9), round(s.real, 9)))


def assert_are(found, wanted, times=1, digits=DIGITS):
    """Assert that the roots found in the upper half plane are just those, and every one is certified."""
    numbers = upper(found)
    for one, other in zip(in_order(s for s, _ in numbers), in_order(map(mpc, wanted)), strict=True):
        assert abs(one - other) <= mpf(10) ** (1 - digits) * abs(other), (one, other)
    assert {multiplicity for _, multiplicity in numbers} <= {times}
    assert all(root.certified for root in found)


def first(roots, found):
    """Return as many of the roots of a formula as were found."""
    return list(islice(roots(), len(upper(found))))


@pytest.mark.parametrize("name", CASES)
def test_poles_zeros_and_verdicts_are_those_of_the_formula(name):
    case = CASES[name]
    shown = locate(bound(case.text), Modes(case.count), DIGITS)
    told = shown.certificate
    assert (told.certified, told.reason, told.counted) == (True, None, told.found)
    assert_are(shown.poles, first(case.poles, shown.poles), case.times)
    if case.zeros is not None:
        assert_are(shown.zeros, first(case.zeros, shown.zeros))
    assert sum(r.multiplicity for r in shown.poles if r.is_zero) == case.at_zero
    assert len(upper(shown.poles)) * case.times + (case.at_zero > 0) >= case.count
    assert shown.verdict.word == case.word, shown.verdict
    hidden = sorted(float(h.root.im) for h in shown.hidden if h.root.im > 0)
    assert hidden == pytest.approx([float((n * pi) ** 2) for n in case.hidden])


@pytest.mark.parametrize(
    ("engine", "name"),
    [
        pytest.param(
            engine, name, marks=[pytest.mark.slow] * (engine == SUBDIVISION and name not in BROKEN_OFF)
        )
        for engine in SEARCHES
        for name in SEARCHED
    ],
)
def test_every_engine_finds_the_same_in_regions_of_every_kind(engine, name):
    case = CASES[name]
    source = bound(case.text)
    if engine == LOSSLESS and not case.lossless:
        with pytest.raises(TypeError, match=r"^not for the engine lossless$"):
            Side(source, source.den, DIGITS, engines=(engine,))
        return
    wanted = [mpc(s) for s in islice(case.poles(), 5)]
    between = (abs(wanted[0]) + abs(wanted[1])) / 2, (abs(wanted[2]) + abs(wanted[3])) / 2
    band = Band(*(Fraction(float(x / (2 * pi))) for x in between))
    low, high = (Fraction(float(x)) for x in between)
    for region, there in (
        (Modes(2), wanted[:2]),
        (band, wanted[1:3]),
        (Rectangle(Fraction(-200), Fraction(200), low, high), wanted[1:3]),
    ):
        side = Side(source, source.den, DIGITS, engines=(engine, SUBDIVISION))
        side.search(region)
        proof = side.prove(region)
        assert proof.is_complete, (region, proof)
        assert_are([r for r in side.roots if is_in(r, region, wanted)], there, case.times)
        if not isinstance(region, Rectangle):
            assert engine in (side.engine, LOSSLESS), region


def is_in(root, region, wanted):
    s = complex(root.re, root.im)
    if isinstance(region, Rectangle):
        return s.imag > 0 and region.im_low < s.imag < region.im_high
    if isinstance(region, Band):
        return 2 * pi * region.low < abs(s) < 2 * pi * region.high
    return 0 < abs(s) < (abs(wanted[1]) + abs(wanted[2])) / 2


def test_where_a_count_speaks_against_what_was_found_all_is_searched_again_with_proof(monkeypatch):
    monkeypatch.setattr(Side, "counted", lambda self: Proof(9, 8))
    for name, region in (
        ("a rod with a mass", Modes(2)),
        ("a rod with a mass", Band(Fraction(1, 4), 1)),
        ("a loop with a delay", Modes(2)),
    ):
        case = CASES[name]
        shown = locate(bound(case.text), region, DIGITS)
        assert shown.certificate.certified, (name, region)
        assert "subdivision" in shown.certificate.engine, (name, region)
        every = islice(case.poles(), 6)
        inside = every if region == Modes(2) else (s for s in every if pi / 2 < abs(s) < 2 * pi)
        assert_are(shown.poles, list(inside)[: len(upper(shown.poles))])


def test_a_band_far_up_holds_its_modes_and_no_others():
    for name in ("a rod with a mass", "a string in a fluid"):
        case = CASES[name]
        wanted = [mpc(s) for s in islice(case.poles(), 56)][50:53]
        low, high = ((abs(wanted[i]) + j) / (2 * pi) for i, j in ((0, -1), (-1, 1)))
        shown = locate(bound(case.text), Band(Fraction(float(low)), Fraction(float(high))), DIGITS)
        assert shown.certificate.certified, name
        assert_are(shown.poles, wanted)


def test_a_mode_is_that_of_its_number():
    for name in SEARCHED:
        case = CASES[name]
        for number, wanted in enumerate(islice(case.poles(), 3), 1):
            shown = locate(bound(case.text), Mode(number), DIGITS)
            assert shown.certificate.certified, (name, number)
            assert_are(shown.poles, [wanted], case.times)


def test_what_is_found_until_a_search_is_broken_off_is_right_and_is_not_called_complete():
    for name in BROKEN_OFF:
        case, ends = CASES[name], set()
        every = [mpc(s) for s in islice(case.poles(), 12)]
        for looks in (3, 30, 120, 250, 400, 700, 1200, 2500):
            try:
                with Budget(looks, clock=itertools.count().__next__).entered():
                    shown = locate(bound(case.text), Modes(4), DIGITS)
            except BudgetError as error:
                assert error.diagnostics[0].code == "SF506"
                ends.add("nothing")
                continue
            told = shown.certificate
            found = [s for s, _ in upper(shown.poles)]
            assert all(min(abs(s - each) for each in every) < mpf(10) ** -20 for s in found), (name, looks)
            assert told.certified is not told.is_exceeded, (name, looks)
            if told.is_exceeded:
                assert told.reason.startswith("the time budget is used up"), told.reason
                assert told.code == "SF506"
                ends.add("some")
            else:
                assert len(found) >= 4 - (case.at_zero > 0)
        assert ends == {"nothing", "some"}, (name, ends)
