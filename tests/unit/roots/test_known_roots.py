"""Functions whose roots are known, asked of the search, in regions of every kind, and of every engine."""

from __future__ import annotations

import itertools
import re
from fractions import Fraction
from itertools import chain, islice

import mpmath
import numpy as np
import pytest
from mpmath import cos, cosh, expm, findroot, matrix, mp, mpc, mpf, pi, sin, sqrt, tan, tanh

from symflex import pipeline
from symflex.budget import Budget
from symflex.errors import BudgetError, ModelError
from symflex.roots import Band, Mode, Modes, Rectangle
from symflex.roots.counting import winding
from symflex.roots.distributed.proof import Proof
from symflex.roots.distributed.side import Side
from symflex.roots.engines import LOSSLESS, SEARCHES, SUBDIVISION
from symflex.roots.locate import locate
from tests.unit.roots.distributed_models import bound
from tests.unit.roots.known_roots import (
    BENDS,
    PINS,
    UNIT,
    Case,
    along,
    assert_are,
    cases,
    check,
    elements,
    expected,
    hinged,
    known,
    lambert,
    late,
    member,
    on_axis,
    quadratic,
    solved,
    upper,
)

DIGITS = 25
FREE_FREE = (4.730040744862704, 7.853204624095838, 10.99560783800167)
"""x of cos x cosh x = 1 (Blevins 1979, table 8-1)."""


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(DIGITS + 40):
        yield


def half(n):
    return (n - mpf(1) / 2) * pi


CLAMPED_FREE = solved(lambda x: cos(x) + 1 / cosh(x), half, 2)
CLAMPED_PINNED = solved(lambda x: tan(x) - tanh(x), lambda n: (n + mpf(1) / 4) * pi, 2)
SLIDING = solved(lambda x: tan(x) + tanh(x), lambda n: (n - mpf(1) / 4) * pi, 2)
SLIDER = 'slide = { type = "slider", at = "x" }'
PUSHED = 'push = { type = "force_source", at = "v", f = "k*x" }'
GAIN = 'parameters.k = "1 N/m"'
TWO_SLIDE = f'a = {{ type = "beam", between = ["x", "y"], {BENDS} }}\n{SLIDER}\n{PUSHED}\n'
TWO_SLIDE += f'b = {{ type = "beam", between = ["v", "w"], {BENDS} }}\nc = {{ type = "slider", at = "v" }}'
ROD = 'type = "rod", E = 1, A = 1, rho = 1'
TWO_RODS = f'a = {{ {ROD}, between = ["ground", "x"], l = 1 }}\n'
TWO_RODS += f'b = {{ {ROD}, between = ["ground", "v"], l = LONGER }}\n'
TWO_LINES = """symflex = 1
fields.v = { domain = [0, 1], equation = "v'' = s*v", conditions = ["v'(0) = -F", "v'(1) = 0"] }
fields.w = { domain = [0, 1], equation = "w'' = s*w", conditions = ["w'(0) = -v(0)", "w'(1) = 0"] }
inputs.F = {}
outputs.X = "w(0)"
"""
LOOP = late("y", more='signals.y = "u + D*y"')
TWO_LOOPS = late("y", more='signals.y = "u + 2*D*y - D*D*y"')
NO_TIME = 'parameters.T = { value = "0 s", assume = "nonnegative" }'
CREEPS = f"{UNIT}, eta = 0.1"


def creeping(omega):
    """Return s^2 + (1 + s/10) omega^2 = 0, which accumulates at -10 where omega grows."""
    return quadratic(omega, lambda n: omega(n) ** 2 / 10)


CASES = {
    # Rods, strings and shafts: sines and cosines of omega.
    "a rod that is held": Case(member("rod", UNIT), on_axis(half), word="marginal"),
    "a rod that is free": Case(
        member("rod", UNIT, '"y", "x"'), on_axis(lambda n: n * pi), on_axis(half), 2, "marginal"
    ),
    "a rod with a mass": Case(
        member("rod", UNIT, more='tip = { type = "mass", at = "x", m = 0.5 }'),
        solved(lambda x: x * sin(x) - 2 * cos(x), lambda n: (n - 1) * pi + mpf(1) / n),
        word="marginal", lossless=True,
    ),
    "a shaft with an inertia": Case(
        member("shaft", "G = 1, J = 1, rho = 1, l = 1", more='tip = { type = "inertia", at = "x", J = 2 }'),
        solved(lambda x: 2 * x * sin(x) - cos(x), lambda n: (n - 1) * pi + mpf("0.6") / n),
        word="marginal",
    ),
    "a string on a foundation": Case(
        member("string", "N = 1, rho = 1, A = 1, l = 1, k_f = 3"),
        on_axis(lambda n: sqrt(half(n) ** 2 + 3)), word="marginal",
    ),
    "a string in a fluid": Case(
        member("string", "N = 1, rho = 1, A = 1, l = 1, c_f = 0.5"),
        quadratic(half, lambda _: mpf(1) / 2), word="stable",
    ),
    "a string in a thick fluid": Case(
        member("string", "N = 1, rho = 1, A = 1, l = 1, c_f = 6"),
        lambda: sorted(islice(quadratic(half, lambda _: mpf(6))(), 5), key=abs), word="stable",
    ),
    "a damped rod": Case(
        member("rod", f"{UNIT}, eta = 0.01"), quadratic(half, lambda n: half(n) ** 2 / 100), word="stable"
    ),
    "a rod behind a delay": Case(
        along("w'' = s^2*w", "w(0) = D*F", "w'(1) = 0", more='blocks.D = { type = "delay", T = 0.001 }'),
        on_axis(half), word="unknown",
    ),
    "a rod of which frequencies times frequencies are no doubles": Case(
        elements('bar = { type = "rod", between = ["x", "y"], E = 7e-188, A = 3, rho = 7, l = 1e100 }'),
        on_axis(lambda n: n * pi * mpf(10) ** -194), at_zero=2, region=Modes(2),
    ),
    "two rods, the second pushed as the first moves": Case(
        elements(TWO_RODS.replace("LONGER", "1") + PUSHED, output="v", more=GAIN),
        on_axis(half, times=2), on_axis(lambda n: n * pi, times=2), region=Band(0, 2),
    ),
    "two rods pressed apart, one a part in 1e10 longer": Case(
        elements(TWO_RODS.replace("LONGER", "1.0000000001"), 'F = { force = ["x", "v"] }', "x - v"),
        lambda: (mpc(0, half(n) * x) for n in range(1, 5) for x in (1, 1 / mpf("1.0000000001"))),
        on_axis(lambda n: n * pi / mpf("2.0000000001")), region=Band(0, Fraction(3, 5)),
    ),
    # Beams: s = j x^2.
    "a cantilever": Case(member("beam", BENDS), CLAMPED_FREE, word="marginal"),
    "a free beam": Case(
        member("beam", BENDS, '"y", "x"'),
        solved(lambda x: cos(x) - 1 / cosh(x), lambda n: (n + mpf(1) / 2) * pi, 2),
        CLAMPED_PINNED,  # the driven end held
        2, "marginal", hidden=lambda: [(0, 2)], lossless=True,
    ),
    "a beam that slides": Case(
        member("beam", BENDS, '"x", "y"', SLIDER), SLIDING, CLAMPED_FREE, 2, "marginal"
    ),
    "two hundred modes of a beam that slides": Case(
        member("beam", BENDS, '"x", "y"', SLIDER), SLIDING, at_zero=2, region=Modes(200)
    ),
    "the tip of a beam that slides": Case(
        member("beam", BENDS, '"x", "y"', SLIDER, "y"),
        SLIDING,
        # cos q cosh q = 0, s = +-2 q^2 (Spector & Flashner 1990)
        lambda: (sign * 2 * half(n) ** 2 for n in range(1, 9) for sign in (-1, 1)),
        2, "marginal",
    ),
    "a beam that slides, pushed as another one moves": Case(
        elements(TWO_SLIDE, output="v", more=GAIN),
        lambda: ((s, 2) for s, _ in SLIDING()), lambda: ((s, 2) for s, _ in CLAMPED_FREE()), 4,
        region=Modes(4),
    ),
    "a hinged beam": Case(hinged(""), on_axis(lambda n: (n * pi) ** 2), CLAMPED_PINNED, word="marginal"),
    "a hinged beam that is pulled": Case(
        hinged(", N = 20"), on_axis(lambda n: sqrt((n * pi) ** 4 + 20 * (n * pi) ** 2)), word="unknown"
    ),
    "a hinged beam on a foundation": Case(
        hinged(", k_f = 50"), on_axis(lambda n: sqrt((n * pi) ** 4 + 50)), word="marginal", lossless=True
    ),
    "Rayleigh's hinged beam": Case(
        hinged(', theory = "rayleigh"'), on_axis(lambda n: (n * pi) ** 2 / sqrt(1 + (n * pi) ** 2)),
        word="unknown",
    ),
    "a damped hinged beam": Case(
        hinged(", eta = 0.004"), quadratic(lambda n: (n * pi) ** 2, lambda n: (n * pi) ** 4 / 250),
        word="stable", region=Modes(2),
    ),
    "a hinged beam beyond its buckling load": Case(
        hinged(", N = -12"),
        lambda: chain(
            (sign * sqrt(12 * pi**2 - pi**4) for sign in (1, -1)),
            (mpc(0, sqrt((n * pi) ** 4 - 12 * (n * pi) ** 2)) for n in (2, 3, 4)),
        ),
        word="unstable",
    ),
    "two hinged beams in a row, whose middle is a node of every other mode": Case(
        elements(
            f'one = {{ type = "beam", between = ["p", "x"], {BENDS.replace("l = 1", "l = 0.5")} }}\n'
            f'two = {{ type = "beam", between = ["x", "q"], {BENDS.replace("l = 1", "l = 0.5")} }}\n{PINS}'
        ),
        on_axis(lambda n: ((2 * n - 1) * pi) ** 2), word="marginal",
        hidden=lambda: [mpc(0, (n * pi) ** 2) for n in (2, 4)],
    ),
    # Fields with an x in them.
    "a hanging string": Case(  # J_0(2 omega) = 0 (Daniel Bernoulli 1733)
        along("(x*w')' = s^2*w", "w(1) = F", output="w(0)"),
        on_axis(lambda n: mpmath.besseljzero(0, n) / 2), word="marginal", region=Modes(2),
    ),
    "a conical rod": Case(  # (1 - x/2) w is a sine
        along("((1 - x/2)^2*w')' = (1 - x/2)^2*s^2*w", "w(0) = 0", "w'(1) = F"),
        solved(lambda x: x * cos(x) + sin(x), lambda n: half(n) + mpf("0.3")),
        word="marginal", region=Modes(2),
    ),
    "a string that moves along": Case(  # waves at 2 + 1 and 2 - 1
        along("3*w'' - 2*s*w' - s^2*w = 0", "w(0) = F", "w(1) = 0", output="w(1/2)"),
        on_axis(lambda n: (2 * n - 1) * 3 * pi / 2), hidden=lambda: [mpc(0, 3 * n * pi) for n in (1, 2)],
    ),
    # Diffusion and lines.
    "diffusion": Case(
        along("w'' = s*w", "w(0) = 0", "w'(1) = F"), lambda: (-(half(n) ** 2) for n in range(1, 9)),
        word="stable",
    ),
    "diffusion that reacts": Case(
        along("w'' = (s - 30)*w", "w(0) = 0", "w'(1) = F"),
        lambda: sorted((30 - half(n) ** 2 for n in range(1, 6)), key=abs), word="unstable",
    ),
    "two lines of diffusion in a row": Case(
        TWO_LINES,
        lambda: ((-((n * pi) ** 2), 2) for n in range(1, 9)),
        lambda: ((-(half(n) ** 2), 2) for n in range(1, 9)), 2, region=Rectangle(-150, 1, -3, 3),
    ),
    "a lossy line": Case(
        along("w'' = (s + 1)*(s + 3)*w", "w(0) = 0", "w'(1) = (s + 1)*F"),
        lambda: (mpc(-2, sqrt(half(n) ** 2 - 1)) for n in range(1, 70)), word="stable",
    ),
    # Delays.
    "a loop with a delay": Case(late("u/(s + 2*D)", "0.5"), lambert(-1, 2), word="stable", region=Modes(4)),
    "an unstable loop with a delay": Case(late("u/(s + 3*D)"), lambert(-3), word="unstable"),
    "a delay beside a polynomial": Case(
        late("u*(s + 7)/((s + 1)*(s + 4)*(s + 2*D))", "0.5"),
        lambda: sorted([-1, -4, *(s for s, _ in islice(lambert(-1, 2)(), 4))], key=abs), known(-7),
        word="stable",
    ),
    "the square of a loop with a delay": Case(
        late("u/(s + 2*D)^2", "0.5"), lambert(-1, 2, 2), word="stable", region=Modes(4)
    ),
    "a square that is multiplied out": Case(
        TWO_LOOPS, on_axis(lambda n: 2 * pi * n, times=2), at_zero=2, region=Band(0, Fraction(5, 2))
    ),
    "a delay of no time": Case(
        late("u*(s + 2*D)/((s + 3*D)*(s + 5))", '"T"', NO_TIME), known(-3, -5), known(-2)
    ),
    # Limits of regions that meet roots, and places where roots accumulate.
    "a corner at a root": Case(
        LOOP, on_axis(lambda n: 2 * pi * n), at_zero=1, region=Rectangle(0, 5, 0, 10), on_boundary=2
    ),
    "roots at both limits of a band": Case(
        LOOP, on_axis(lambda n: 2 * pi * n), region=Band(1, 4), on_boundary=4
    ),
    "all roots on the side of a rectangle": Case(
        member("rod", UNIT), on_axis(half), on_axis(lambda n: n * pi),
        region=Rectangle(0, 5, Fraction(1, 2), 10), on_boundary=3,
    ),
    "nothing beside the axis": Case(member("rod", UNIT), on_axis(half), region=Rectangle(1, 5, 0, 10)),
    "left of an accumulation": Case(
        member("rod", CREEPS), creeping(half), creeping(lambda n: n * pi),
        region=Rectangle(-400, Fraction(-25, 2), -50, 50),
    ),
    "all but an accumulation": Case(
        member("rod", CREEPS), creeping(half), creeping(lambda n: n * pi), region=Rectangle(-400, 1, -50, 50)
    ),
    "a mode beyond the last": Case(late("u/(s^2 + 1)"), known(1j), region=Mode(2)),
}  # fmt: skip


@pytest.mark.parametrize("case", cases(CASES))
def test_poles_zeros_and_verdicts_are_those_of_the_formula(case):
    for part in check(case).excluded:
        assert (part.re, part.im) == pytest.approx((-10, 0)), part
        assert part.radius < 2
        assert part.reason == "infinitely many roots accumulate there"


# --------------------------------------------------- where wavenumbers vanish or meet, or have no formula

SOFT = 'type = "beam", between = ["x", "y"], E = 4, I = 1, rho = 2, A = 1, l = 1'
STEEL = 'type = "beam", E = "200 GPa", I = "4000 mm^4", rho = "8000 kg/m^3", A = "500 mm^2", l = "1 m"'
SHEARS = 'theory = "timoshenko", G = "80 GPa", kappa = "0.85"'
TURNS = 'theory = "timoshenko", kappa = 0.5, G = 28'
HELD = 'p = { type = "pin", at = "x" }\nq = { type = "pin", at = "y" }'
CUT_OFF = Band(Fraction("0.4"), Fraction("0.44"))
"""About sqrt(7) rad/s."""


def soft(more, lines="", output="x"):
    turned = 'M = { torque = "x.theta" }' if lines else 'F = { force = "x" }'
    return elements(f"b = {{ {SOFT}, {more} }}\n{lines}", turned, output)


def steel(more, between='"x", "y"'):
    return elements(f"bar = {{ between = [{between}], {STEEL}, {more} }}")


def founded(stiffness, damping):
    """Return m s^2 + c s + k + EI beta^4 = 0 of a free beam of 4 kg/m and 800 N m^2 that moves and turns."""

    def roots():
        every = [np.roots([4.0, damping, stiffness + 800 * b**4]) for b in (0.0, *FREE_FREE)]
        return sorted({complex(s) for pair in every for s in pair if s.imag >= 0 and s}, key=abs)

    return roots


def grown(length, *rows):
    return expm(length * matrix(rows))


def sheared(s):
    """Return moment and force at the free end of a Timoshenko cantilever on 10 kN/m^2 and 40 N s/m^2."""
    area, inertia = mpf(500) / 10**6, mpf(4000) / 10**12
    shear, rotary = mpf("0.85") * 80 * 10**9 * area, 8000 * inertia * s**2
    bent, held = 1 / (200 * 10**9 * inertia), 4 * s**2 + 40 * s + 10000
    end = grown(1, [0, 1, 0, 1 / shear], [0, 0, bent, 0], [0, rotary, 0, -1], [held, 0, 0, 0])
    return end[2, 2] * end[3, 3] - end[2, 3] * end[3, 2]


def sprung(s):
    """Return the conditions at a spring of 100 N/m, of two Timoshenko beams from a clamp in a fluid."""
    held, rotary = s * s / 2 + 3 * s / 10, s * s / 500
    across = grown(
        2, [0, 1, 0, mpf(1) / 80], [0, 0, mpf(1) / 7, 0], [0, rotary, 0, -1], [held, 0, 0, 0]
    )  # fmt: skip
    ends = [(across[2, j], across[3, j] + 100 * across[0, j]) for j in (2, 3)]
    return ends[0][0] * ends[1][1] - ends[0][1] * ends[1][0]


HEAVY = 'type = "beam", EI = 7, rhoA = 0.5, rhoI = 0.002, kappaGA = 80, c_f = 0.3, theory = "timoshenko"'
SPRUNG = f"""m = {{ between = ["a", "b"], l = 1, {HEAVY} }}
n = {{ between = ["b", "x"], l = 1, {HEAVY} }}
f = {{ type = "fixed", at = "a" }}
k = {{ type = "spring", between = ["x", "ground"], k = 100 }}"""
MASS, POLAR, LENGTH, BENDING, TORSION, OFF = 0.162, 8.91e-5, 0.8, 140.0, 67.6, 0.008
"""rho A, rho I_p, l, E I, G J and e of a blade."""
BLADE = """symflex = 1
parameters = { EI = 140, GJ = 67.6, m = 0.162, p = 8.91e-5, e = 0.008, l = 0.8 }
inputs.u = {}
outputs.out = "OUTPUT"
[fields.beam]
unknowns = ["w", "phi"]
domain = ["0", "l"]
equations = [
    "EI*w'''' + (m*s^2 + FLUID*s)*w + m*e*s^2*phi = 0",
    "GJ*phi'' = (p + m*e^2)*s^2*phi + m*e*s^2*w",
]
conditions = ["w(0) = 0", "phi(0) = 0", "w''(l) = 0", ENDS]
"""
PINNED = BLADE.replace("ENDS", """"w''(0) = u/EI", "w(l) = 0", "phi(l) = 0\"""").replace("FLUID", "2")
CLAMPED = BLADE.replace("ENDS", """"w'(0) = 0", "EI*w'''(l) = -u", "phi'(l) = 0\"""").replace("FLUID", "0")


def pinned_blade():
    """Return roots of pinned ends: w and phi go with sin(n pi x/l), a quartic in s for each n."""
    inertia, found = POLAR + MASS * OFF**2, []
    for k in (n * np.pi / LENGTH for n in range(1, 12)):
        both = np.polymul([MASS, 2.0, BENDING * k**4], [inertia, 0.0, TORSION * k**2])
        found += [s for s in np.roots(np.polysub(both, [(MASS * OFF) ** 2, 0, 0, 0, 0])) if s.imag >= 0]
    return sorted(map(complex, found), key=abs)


def clamped_blade(s):
    """Return moment, force and torque at the free end over those at the clamped end."""
    mass, e = mpf("0.162"), mpf("0.008")
    rows = mpmath.zeros(6)
    rows[0, 1] = rows[2, 3] = 1
    rows[1, 2], rows[4, 5] = 1 / mpf(140), 1 / mpf("67.6")
    rows[3, 0], rows[3, 4] = -mass * s**2, -mass * e * s**2
    rows[5, 0], rows[5, 4] = mass * e * s**2, (mpf("8.91e-5") + mass * e**2) * s**2
    end = expm(rows * mpf("0.8"))
    return mpmath.det(matrix([[end[i, j] for j in (2, 3, 5)] for i in (2, 3, 5)]))


LAYERED = ("w(0) = 0", "w''(0) = 0", "w''''(0) = 0", "w(1) = 0", "w''(1) = F", "w''''(1) = 0")
SPECIAL = {
    # A free beam moves without strain where stiffness and mass cancel: there a wavenumber vanishes.
    "a free beam on a damped foundation": Case(
        steel('k_f = "10 kN/m^2", c_f = "40 N*s/m^2"'), founded(1e4, 40.0), region=Modes(4), digits=12,
        hidden=lambda: [mpc(-5, sqrt(2475))],
    ),
    "a free beam on a viscous foundation": Case(
        steel('c_f = "40 N*s/m^2"'), founded(0.0, 40.0), at_zero=1, region=Modes(4), digits=12,
        hidden=lambda: [-10, (0, 1)],
    ),
    "a pulled beam on a foundation": Case(
        soft("N = 3, k_f = 14"), lambda: [mpc(0, sqrt(7))], region=Modes(1)
    ),
    "Rayleigh's beam on a foundation": Case(
        soft('theory = "rayleigh", k_f = 14'), among=lambda: [mpc(0, sqrt(7))], region=Modes(2)
    ),
    "sections of a pinned beam that turn alike": Case(
        soft(TURNS, HELD, "x.theta"), lambda: [mpc(0, sqrt(7))], region=CUT_OFF
    ),
    # Double wavenumbers, where (3/4)^2 = 2 (s^2 + 7), and a shear force that is not zero at a free end.
    "two wavenumbers that meet": Case(
        soft("N = 3, k_f = 14", output="y"), absent=lambda: [mpc(0, sqrt(7 - mpf(9) / 32))],
        region=Modes(2), digits=15,
    ),
    "a wavenumber that vanishes without a motion": Case(
        soft(TURNS, output="y"), absent=lambda: [mpc(0, sqrt(7))], region=CUT_OFF, digits=15
    ),
    "a Timoshenko cantilever on a damped foundation": Case(
        steel(f'k_f = "10 kN/m^2", c_f = "40 N*s/m^2", {SHEARS}', '"ground", "x"'), equation=sheared,
        region=Modes(2), digits=12,
    ),
    "a free Timoshenko beam, a zero 5e-9 rad/s beside a pole": Case(
        steel(f'k_f = "10 kN/m^2", c_f = "40 N*s/m^2", {SHEARS}'), among=lambda: [mpc(-5, sqrt(2475))],
        region=Modes(2), digits=14, slow=True,
    ),
    "two beams whose wavenumbers vanish at four places": Case(
        elements(SPRUNG, output="b"), equation=sprung, region=Modes(2), digits=15, word="stable"
    ),
    # Wavenumbers without a formula.
    "a pinned blade that bends and turns": Case(
        PINNED.replace("OUTPUT", "w'(0)"), pinned_blade, digits=12, slow=True
    ),
    "a clamped blade that bends and turns": Case(
        CLAMPED.replace("OUTPUT", "w(l)"), equation=clamped_blade, digits=12, slow=True
    ),
    "a sandwich beam": Case(  # Mead and Markus 1969: D k^6 + D g (1 + Y) k^4 = m omega^2 (k^2 + g), k = n pi
        along("50*w'''''' - 8000*w'''' + 1.2*s^2*w'' - 48*s^2*w = 0", *LAYERED, output="w'(1)"),
        on_axis(lambda n: (n * pi) ** 2 * sqrt((50 * (n * pi) ** 2 + 8000) / (1.2 * ((n * pi) ** 2 + 40)))),
        digits=12, slow=True,
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", cases(SPECIAL))
def test_roots_are_found_where_wavenumbers_vanish_or_meet_and_where_they_have_no_formula(case):
    check(case)


# --------------------------------------------------------------------- every engine, every kind of region

SEARCHED = (
    "a rod with a mass", "a string in a fluid", "a free beam", "a hinged beam on a foundation",
    "a lossy line", "a loop with a delay",
)  # fmt: skip
"""One of each kind: a wavenumber of s or of its root, damped or not, a double pole at 0, a delay."""
BROKEN_OFF = ("a rod with a mass", "a free beam", "a loop with a delay")


def first(name, count, start=0):
    return expected(lambda: islice(CASES[name].poles(), start, None), Modes(9), range(count))


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
    wanted = [s for s, _ in first(name, 5)]
    low, high = ((abs(wanted[i]) + abs(wanted[i + 1])) / 2 for i in (0, 2))
    edges = [Fraction(float(x)) for x in (low, high)]
    for region, there in (
        (Modes(2), wanted[:2]),
        (Band(*(Fraction(float(x / (2 * pi))) for x in (low, high))), wanted[1:3]),
        (Rectangle(Fraction(-200), Fraction(200), *edges), wanted[1:3]),
    ):
        side = Side(source, source.den, DIGITS, engines=(engine, SUBDIVISION))
        side.search(region)
        proof = side.prove(region)
        assert proof.is_complete, (region, proof)
        near, far = (0, (abs(wanted[1]) + abs(wanted[2])) / 2) if region == Modes(2) else (low, high)
        inside = [r for r in side.roots if r.im > 0 and near < abs(complex(r)) < far]
        assert_are(inside, [(s, 1) for s in there], DIGITS)
        if not isinstance(region, Rectangle):
            assert engine in (side.engine, LOSSLESS), region


def test_where_a_count_speaks_against_what_was_found_all_is_searched_again_with_proof(monkeypatch):
    monkeypatch.setattr(Side, "counted", lambda self: Proof(9, 8))
    for name, region in (
        ("a rod with a mass", Modes(2)),
        ("a rod with a mass", Band(Fraction(1, 4), 1)),
        ("a loop with a delay", Modes(2)),
    ):
        shown = locate(bound(CASES[name].text), region, DIGITS)
        assert shown.certificate.certified, (name, region)
        assert "subdivision" in shown.certificate.engine, (name, region)
        assert_are(shown.poles, first(name, len(upper(shown.poles, DIGITS)), region != Modes(2)), DIGITS)


def test_a_band_far_up_holds_its_modes_and_no_others():
    for name in ("a rod with a mass", "a string in a fluid"):
        wanted = first(name, 3, 50)
        low, high = ((abs(wanted[i][0]) + j) / (2 * pi) for i, j in ((0, -1), (-1, 1)))
        shown = locate(bound(CASES[name].text), Band(Fraction(float(low)), Fraction(float(high))), DIGITS)
        assert shown.certificate.certified, name
        assert_are(shown.poles, wanted, DIGITS)


def test_a_mode_is_that_of_its_number():
    for name, number in ((name, number) for name in SEARCHED for number in (1, 2, 3)):
        shown = locate(bound(CASES[name].text), Mode(number), DIGITS)
        assert shown.certificate.certified, (name, number)
        assert_are(shown.poles, first(name, 1, number - 1), DIGITS)
    for number in (10, 1000, 10**6):
        for name, equation, guess, power in (
            ("a beam that slides", lambda x: tan(x) + tanh(x), (number - mpf(1) / 4) * pi, 2),
            ("a rod with a mass", lambda x: x * tan(x) - 2, (number - 1) * pi + 2 / (number * pi), 1),
        ):
            shown = locate(bound(CASES[name].text), Mode(number), DIGITS)
            assert shown.certificate.certified, number
            assert_are(shown.poles, [(mpc(0, findroot(equation, guess) ** power), 1)], DIGITS)


HALVES_ON_SPRINGS = """
symflex = 1
[elements]
one = { type = "beam", between = ["p", "q"], EI = 5, rhoA = 1, l = 0.5 }
two = { type = "beam", between = ["q", "r"], EI = 5, rhoA = 1, l = 0.5 }
left = { type = "spring", between = ["p.y", "ground"], k = 30 }
right = { type = "spring", between = ["r.y", "ground"], k = 30 }
middle = { type = "damper", between = ["q.y", "ground"], b = 1 }
[inputs]
F = { force = "q.y" }
[outputs]
Y = "q.y"
"""


def test_a_mode_is_found_by_its_number_where_the_estimate_of_turns_leads_away():
    # With the middle held, the second mode is that of a half clamped there, with a spring at its end.
    def at_the_end(x):
        sine, cosine, cosh_ = sin(x / 2), cos(x / 2), cosh(x / 2)
        sinh_ = tanh(x / 2) * cosh_
        a, b = sinh_ + sine, -(cosh_ + cosine)  # no moment
        shear = 5 * x**3 * (a * (sinh_ - sine) + b * (cosh_ + cosine))
        return shear - 30 * (a * (cosh_ - cosine) + b * (sinh_ - sine))

    expected = sqrt(mpf(5)) * findroot(at_the_end, mpf("3.95")) ** 2
    shown = locate(bound(HALVES_ON_SPRINGS), Mode(2), DIGITS)
    assert_are(shown.zeros, [(mpc(0, expected), 1)], DIGITS)


def test_what_is_found_until_a_search_is_broken_off_is_right_and_is_not_called_complete():
    for name in BROKEN_OFF:
        case, ends = CASES[name], set()
        every = [s for s, _ in first(name, 12)]
        for looks in (3, 30, 120, 250, 400, 700, 1200, 2500):
            try:
                with Budget(looks, clock=itertools.count().__next__).entered():
                    shown = locate(bound(case.text), Modes(4), DIGITS)
            except BudgetError as error:
                assert error.diagnostics[0].code == "SF506"
                ends.add("nothing")
                continue
            told = shown.certificate
            found = [s for s, _ in upper(shown.poles, DIGITS)]
            assert all(min(abs(s - each) for each in every) < mpf(10) ** -20 for s in found), (name, looks)
            assert told.certified is not told.is_exceeded, (name, looks)
            if told.is_exceeded:
                assert told.reason.startswith("the time budget is used up"), told.reason
                assert told.code == "SF506"
                ends.add("some")
            else:
                assert len(found) >= 4 - (case.at_zero > 0)
        assert ends == {"nothing", "some"}, (name, ends)


def test_a_search_that_takes_too_long_says_what_it_found(monkeypatch):
    monkeypatch.setattr(winding, "WORK_LIMIT", 12_000)
    shown = locate(bound(CASES["a loop with a delay"].text), Modes(30), 12)
    poles = upper(shown.poles, 12)
    assert 0 < len(poles) < 30
    assert_are(shown.poles, first("a loop with a delay", len(poles)), 12)
    assert shown.certificate.is_exceeded
    assert re.search(r"takes too long; \d+ modes were found up to .* Hz", shown.certificate.reason)
    with pytest.raises(BudgetError, match="SF505"):
        locate(bound(CASES["a cantilever"].text), Modes(10**6), 12)


CLOSE = late(  # 1/((1 - e^-s)(1 - e^-s T))
    "y", more='blocks.E = { type = "delay", T = 1.00000000000001 }\nsignals.y = "u + D*y + E*y - D*E*y"'
)
CRITICAL = steel('k_f = "10 kN/m^2", c_f = "400 N*s/m^2"')
"""(s + 50)^2 of a beam that moves, and, hidden, that turns."""


def test_roots_that_are_not_told_apart_are_enclosed_together_and_not_certified():
    for text, region, wanted, is_hidden in (
        (CLOSE, Band(0, Fraction(3, 2)), [2j * np.pi], False),
        (CRITICAL, Modes(5), founded(1e4, 400.0)(), True),
    ):
        shown = locate(bound(text), region, 12)
        assert not shown.certificate.certified
        assert "could not be separated" in shown.certificate.reason
        assert shown.certificate.counted == shown.certificate.found
        poles = [r for r in shown.poles if not r.is_zero and not r.im < 0]
        values = [complex(r.re.mid(), r.im.mid()) for r in poles]
        assert values == pytest.approx([complex(s) for s in wanted], rel=1e-9)
        assert poles[0].multiplicity == 2
        hidden = [(float(h.root.re.mid()), h.root.multiplicity) for h in shown.hidden]
        assert hidden == ([(pytest.approx(-50), 2)] if is_hidden else [])


def test_what_does_not_depend_on_s_has_no_poles_and_without_length_there_is_no_function():
    static = along("100*w'''' + 5*w = 0", "w''(0) = 0", "100*w'''(0) = F", "w''(1) = 0", "w'''(1) = 0")
    assert locate(bound(static)).all_poles == ()
    beam = 'arm = { type = "beam", between = ["y", "x"], EI = "1 N*m^2", rhoA = "1 kg/m", l = "l - g" }'
    (tf,) = pipeline.derive_all(
        pipeline.loads(elements(beam, more='parameters = { l = "1 m", g = "0.5 m" }'))
    )
    with pytest.raises(ModelError, match="SF231"):
        locate(pipeline.bind(tf, {"g": 1}))


@pytest.mark.slow
def test_frequencies_beyond_doubles_are_a_typed_error():
    # About sqrt(E I/(rho A)) = 1e168 rad/s, whose square is no double.
    text = elements(
        'b = { type = "beam", between = ["ground", "x"], E = 9e3, I = 8e62, A = 7e-270, rho = 0.26, l = 1 }\n'
        'load = { type = "mass", at = "x", m = 165 }'
    )
    with pytest.raises(BudgetError, match="SF505"):
        locate(bound(text), Modes(1))
