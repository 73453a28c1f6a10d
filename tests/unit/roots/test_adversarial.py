"""Models made to mislead: double roots, pairs without distance, roots on the boundary, roots without number.

Every expectation is a closed form, or solved by mpmath from the physics. A result may be refused or left
without certificate; it may not be certified and wrong.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from mpmath import cos, cosh, findroot, mp, mpc, mpf, pi, sin, sqrt, tanh

import symflex
from symflex.roots.root import exact_fraction
from tests.house.repository import slow_ones
from tests.independent.boundary_value import Problem, bending
from tests.independent.winding import count_inside, determinant

if TYPE_CHECKING:
    from collections.abc import Callable

WORKING = 90
NEAR = mpf(10) ** -60
"""What is at most this far from a limit of the region is on it: closed forms know 80 digits."""

Expected = list[tuple[Any, int]]  # mpmath's numbers have no types


@dataclass(frozen=True)
class Case:
    """A model with roots known in advance.

    Parameters
    ----------
    name : str
        What is hard about it.
    text : str
        The specification; its transfer function is X/F.
    expected : callable
        Returns poles and zeros with multiplicities, at least all in the region, without what cancels.
    band : (float, float), optional
        [Hz].
    region : (float, float, float, float), optional
        [rad/s].
    digits : int
        Asked for.
    """

    name: str
    text: str
    expected: Callable[[], tuple[Expected, Expected]]
    band: tuple[float, float] | None = None
    region: tuple[float, float, float, float] | None = None
    digits: int = 30

    def within(self, s: Any) -> bool:
        """Return whether a root lies in the closed region."""
        if self.band is not None:
            low, high = (2 * pi * mpf(repr(hertz)) for hertz in self.band)
            return (not low or low - NEAR <= abs(s)) and abs(s) <= high + NEAR
        if self.region is not None:
            left, right, bottom, top = (mpf(repr(x)) for x in self.region)
            return left - NEAR <= s.real <= right + NEAR and bottom - NEAR <= s.imag <= top + NEAR
        return True

    def solve(self):
        """Return what the program finds."""
        bound = symflex.loads(self.text).transfer_function("X", "F").bind()
        return bound.pole_zero_map(digits=self.digits, band=self.band, region=self.region)


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(WORKING):
        yield


# ------------------------------------------------------------------------------------------------- texts

ROD = 'type = "rod", E = "1 Pa", A = "1 m^2", rho = "1 kg/m^3"'
BEAM = 'type = "beam", E = "1 Pa", I = "1 m^4", rho = "1 kg/m^3", A = "1 m^2"'


def spec(elements="", output="x", source='{ force = "x" }', more=""):
    return f'symflex = 1\n{more}\n[elements]\n{elements}\n[inputs]\nF = {source}\n[outputs]\nX = "{output}"\n'


def cascade(kind, longer):
    """Return two parts held at one end, the second pushed as the first moves: a product of functions."""
    return spec(
        f'a = {{ {kind}, between = ["ground", "x"], l = "1 m" }}\n'
        f'b = {{ {kind}, between = ["ground", "y"], l = "{longer} m" }}\n'
        'push = { type = "force_source", at = "y", f = "k*x" }\n',
        output="y",
        more='[parameters]\nk = "1 N/m"\n',
    )


def side_by_side(longer):
    """Return two rods, their ends pressed apart: a sum of functions."""
    return spec(
        f'a = {{ {ROD}, between = ["ground", "x"], l = "1 m" }}\n'
        f'b = {{ {ROD}, between = ["ground", "y"], l = "{longer} m" }}\n',
        output="x - y",
        source='{ force = ["x", "y"] }',
    )


def delays(signal, *lengths):
    """Return a loop or filter of delays; in ``signal``, D_1, D_2, ... delay by the lengths in seconds."""
    blocks = "".join(
        f'D_{k} = {{ type = "delay", T = "{length} s" }}\n' for k, length in enumerate(lengths, 1)
    )
    return (
        f'symflex = 1\n[signals]\ny = "{signal}"\n[blocks]\n{blocks}[inputs]\nF = {{}}\n[outputs]\nX = "y"\n'
    )


def delays_in_series(second):
    """Return a loop around two delays that is the product of a loop around each."""
    return delays("(F + D_1*y + D_2*y - D_1*D_2*y)", "1", second)


OSCILLATORS = spec(
    'm_1 = { type = "mass", at = "x", m = "1 kg" }\n'
    'k_1 = { type = "spring", between = ["x", "ground"], k = "1 N/m" }\n'
    'm_2 = { type = "mass", at = "y", m = "1 kg" }\n'
    'k_2 = { type = "spring", between = ["y", "ground"], k = "STIFFER N/m" }\n'
    'push = { type = "force_source", at = "y", f = "k*x" }\n',
    output="y",
    more='[parameters]\nk = "1 N/m"\n',
)

DIFFUSION = """
symflex = 1
[parameters]
T = "1 s"
l = "1 m"
[fields.v]
domain = ["0", "l"]
equation = "l^2*v'' = s*T*v"
conditions = ["l*v'(0) = -F", "v'(l) = 0"]
[fields.w]
domain = ["0", "l"]
equation = "l^2*w'' = s*T*w"
conditions = ["l*w'(0) = -v(0)", "w'(l) = 0"]
[inputs]
F = {}
[outputs]
X = "w(0)"
"""

MISPRINT = """
symflex = 1
[parameters]
T = "1 s"
l = "1 m"
[fields.v]
domain = ["0", "l"]
equation = "l^2*v'' = s*T*v"
conditions = ["v(0) = F", "v'(l) = 0"]
[fields.w]
domain = ["0", "l"]
equation = "l^2*w'' = s*T*w"
conditions = ["w(0) = v(l)", "w'(l) = 0"]
[inputs]
F = {}
[outputs]
X = "w(l)"
"""

FREE_BEAM = spec(f'bar = {{ {BEAM}, between = ["x", "q"], l = "1 m" }}\n')
HELD_ROD = spec(f'bar = {{ {ROD}, between = ["ground", "x"], l = "1 m" }}\n')

KELVIN_VOIGT = spec(
    f'bar = {{ {ROD}, between = ["ground", "x"], l = "1 m", eta = "0.1 s" }}\n',
)

CHAIN_MASSES = 200


def chain(loss):
    """Return masses of 1 kg, links of 1 N/m and ``loss``, held at one end and driven at the other."""
    lines = []
    for k in range(CHAIN_MASSES):
        ends = f'["{f"x_{k - 1}" if k else "ground"}", "x_{k}"]'
        lines.append(f'm_{k} = {{ type = "mass", at = "x_{k}", m = "1 kg" }}')
        lines.append(f'k_{k} = {{ type = "spring", between = {ends}, k = "1 N/m" }}')
        if loss:
            lines.append(f'b_{k} = {{ type = "damper", between = {ends}, b = "{loss} N*s/m" }}')
    last = f"x_{CHAIN_MASSES - 1}"
    return spec("\n".join(lines), output=last, source=f'{{ force = "{last}" }}')


# Three beams, all different, and a mass on a spring and dashpot: twelve components of states.
STEPS = ((1, 1, "1"), (2, 3, "0.8"), (5, 2, "1.3"))
THREE_BEAMS = spec(
    "\n".join(
        f'bar_{k} = {{ type = "beam", E = "{ei} Pa", I = "1 m^4", rho = "{mass} kg/m^3", A = "1 m^2", '
        f'between = ["{f"p_{k - 1}" if k else "ground"}", "p_{k}"], l = "{length} m" }}'
        for k, (ei, mass, length) in enumerate(STEPS)
    )
    + '\nrope = { type = "spring", between = ["p_2", "hung"], k = "3 N/m" }\n'
    'loss = { type = "damper", between = ["p_2", "hung"], b = "0.5 N*s/m" }\n'
    'hung = { type = "mass", at = "hung", m = "0.7 kg" }\n',
    output="p_2",
    source='{ force = "p_2" }',
)


THEIR_REGION = (-1.0, 0.5, 0.1, 9.0)
CORNERS = (-1 + 0.1j, 0.5 + 9j)


# ---------------------------------------------------------------------------------------- expectations


def pairs(values, multiplicity=1):
    """Return conjugate pairs on the imaginary axis."""
    return [(mpc(0, sign * value), multiplicity) for value in values for sign in (1, -1)]


def equal_rods():
    # (sinh s/(s cosh s))^2
    return pairs([(k + mpf(1) / 2) * pi for k in range(8)], 2), pairs([k * pi for k in range(1, 8)], 2)


def unequal_rods(longer):
    # sinh s sinh s L/(s^2 cosh s cosh s L)
    lengths = (mpf(1), mpf(longer))
    return (
        pairs([(k + mpf(1) / 2) * pi / length for k in range(8) for length in lengths]),
        pairs([k * pi / length for k in range(1, 8) for length in lengths]),
    )


def rods_apart(longer):
    # sinh s/(s cosh s) + sinh s L/(s cosh s L) = sinh s (1 + L)/(s cosh s cosh s L)
    return unequal_rods(longer)[0], pairs([k * pi / (1 + mpf(longer)) for k in range(1, 16)])


def cantilevers(longer):
    """Return squares of the wavenumbers over lengths: clamped-free for poles, clamped-pinned for zeros."""
    free = [
        findroot(lambda x: cos(x) + 1 / cosh(x), g)
        for g in (mpf("1.875"), *((k - mpf(1) / 2) * pi for k in (2, 3, 4)))
    ]
    pinned = [findroot(lambda x: sin(x) - cos(x) * tanh(x), (k + mpf(1) / 4) * pi) for k in (1, 2, 3, 4)]
    lengths = (mpf(1), mpf(longer))
    if lengths[0] == lengths[1]:
        return pairs([x**2 for x in free], 2), pairs([x**2 for x in pinned], 2)
    return (
        pairs([(x / length) ** 2 for x in free for length in lengths]),
        pairs([(x / length) ** 2 for x in pinned for length in lengths]),
    )


def oscillators(stiffer):
    return pairs([mpf(1), sqrt(mpf(stiffer))]), []


def diffusion():
    # (cosh q/(q sinh q))^2 with q^2 = s: q^2 sinh^2 q has a double root at s = 0 too.
    return (
        [(mpc(-((k * pi) ** 2)), 2) for k in range(12)],
        [(mpc(-(((k + mpf(1) / 2) * pi) ** 2)), 2) for k in range(12)],
    )


def misprint():
    # 1/cosh^2 q: what the misprinted numerator has for zeros.
    return [(mpc(-(((k + mpf(1) / 2) * pi) ** 2)), 2) for k in range(12)], []


def free_beam():
    flexure = [findroot(lambda x: cos(x) - 1 / cosh(x), (k + mpf(1) / 2) * pi) for k in range(1, 6)]
    pinned = [findroot(lambda x: sin(x) - cos(x) * tanh(x), (k + mpf(1) / 4) * pi) for k in range(1, 6)]
    # The driven end held: free-pinned, which still turns, hence its double root at zero against the four.
    return [(mpc(0), 2), *pairs([x**2 for x in flexure])], pairs([x**2 for x in pinned])


def held_rod():
    return pairs([(k + mpf(1) / 2) * pi for k in range(8)]), pairs([k * pi for k in range(1, 8)])


def dead_beat():
    # 1/(1 - e^-s)
    return [(mpc(0), 1), *pairs([2 * pi * k for k in range(1, 40)])], []


def hold():
    # (1 - e^-s)/s
    return [], pairs([2 * pi * k for k in range(1, 40)])


def two_delays(second):
    # 1/((1 - e^-s)(1 - e^-s T))
    lengths = (mpf(1), mpf(second))
    return [(mpc(0), 2), *pairs([2 * pi * k / t for k in range(1, 12) for t in lengths])], []


def damped_rod():
    # s^2 + (1 + eta s) omega_k^2 = 0 with omega_k = (k - 1/2) pi for poles, k pi for zeros.
    eta = mpf("0.1")

    def both(omega):
        root = sqrt(mpc((eta * omega / 2) ** 2 - 1)) * omega
        return [(-eta * omega**2 / 2 + sign * root, 1) for sign in (1, -1)]

    count = range(1, 60)
    return (
        [entry for k in count for entry in both((k - mpf(1) / 2) * pi)],
        [entry for k in count for entry in both(k * pi)],
    )


def chain_roots(loss):
    # s^2 + mu (1 + b s) = 0: mu = 4 sin^2((2 j - 1) pi/(2 (2 N + 1))) for poles; for zeros the last mass is
    # held, N - 1 masses between walls, mu = 4 sin^2(j pi/(2 N)).
    b = mpf(loss or 0)

    def both(angle):
        mu = 4 * sin(angle) ** 2
        root = sqrt(mpc((mu * b / 2) ** 2 - mu))
        return [(-mu * b / 2 + sign * root, 1) for sign in (1, -1)]

    n = CHAIN_MASSES
    return (
        [entry for j in range(1, n + 1) for entry in both((2 * j - 1) * pi / (2 * (2 * n + 1)))],
        [entry for j in range(1, n) for entry in both(j * pi / (2 * n))],
    )


CASES = (
    Case("squares of hyperbolic cosines", cascade(ROD, "1"), equal_rods, band=(0.0, 2.1)),
    Case("squares of beams", cascade(BEAM, "1"), functools.partial(cantilevers, "1"), band=(0.0, 10.0)),
    *(
        Case(
            f"{name}, lengths {longer}",
            text(longer),
            functools.partial(expected, longer),
            band=(0.0, reach),
        )
        for longer in ("1.000001", "1.0000000001", "1.00000000000001")
        for name, text, expected, reach in (
            ("rods in series", functools.partial(cascade, ROD), unequal_rods, 1.1),
            ("rods side by side", side_by_side, rods_apart, 1.1),
            ("beams in series", functools.partial(cascade, BEAM), cantilevers, 4.0),
            ("delays in series", delays_in_series, two_delays, 2.5),
        )
    ),
    *(
        Case(
            f"oscillators of stiffness {stiffer}",
            OSCILLATORS.replace("STIFFER", stiffer),
            functools.partial(oscillators, stiffer),
        )
        for stiffer in ("1.000001", "1.0000000001", "1.00000000000001")
    ),
    Case("double real roots of two lines", DIFFUSION, diffusion, region=(-150.0, 1.0, -3.0, 3.0)),
    Case("the numerator as misprinted", MISPRINT, misprint, region=(-150.0, 1.0, -3.0, 3.0)),
    Case("double root at zero", FREE_BEAM, free_beam, band=(0.0, 20.0)),
    Case("all roots on the side of the region", HELD_ROD, held_rod, region=(0.0, 5.0, 0.5, 10.0)),
    Case("a corner at a root", delays("F + D_1*y", "1"), dead_beat, region=(0.0, 5.0, 0.0, 10.0)),
    Case("a root at the limit of the band", delays("F + D_1*y", "1"), dead_beat, band=(0.5, 3.0)),
    Case("roots at both limits of the band", delays("F + D_1*y", "1"), dead_beat, band=(1.0, 4.0)),
    Case("a loop without end", delays("F + D_1*y", "1"), dead_beat, band=(0.0, 30.5)),
    Case("a zero-order hold", delays("(F - D_1*F)/s", "1"), hold, band=(0.0, 5.5)),
    Case("two equal delays", delays("(F + 2*D_1*y - D_1*D_1*y)", "1"),
         lambda: ([(mpc(0, 2 * pi * k), 2) for k in range(-9, 10)], []), band=(0.0, 2.5)),
    Case("200 masses without losses", chain(None), functools.partial(chain_roots, None), digits=50),
    Case("200 masses with losses", chain("0.3"), functools.partial(chain_roots, "0.3"), digits=50),
)  # fmt: skip

IDS = [case.name for case in CASES]


# -------------------------------------------------------------------------------------------- comparison


def numbers(root):
    """Return a root's value and its radius as numbers of mpmath, exactly."""

    def number(ball):
        fraction = exact_fraction(ball)
        return mpf(fraction.numerator) / fraction.denominator

    re, im = number(root.re), number(root.im)
    return mpc(re, im), number(root.re.rad()) + number(root.im.rad())


def in_sight(value, radius, places):
    """Return the indices of what may lie within a radius, by doubles: most need no more digits."""
    return np.flatnonzero(np.abs(places - complex(value)) <= float(radius) + 1e-9 * (1 + abs(complex(value))))


def check_exactly(found, expected):
    """Check that the roots found are the expected ones, each inside its enclosure."""
    places = np.array([complex(s) for s, _ in expected])
    met = [0] * len(expected)
    for root in found:
        value, radius = numbers(root)
        allowed = radius + mpf(10) ** -(WORKING - 15) * (1 + abs(value))
        inside = [i for i in in_sight(value, allowed, places) if abs(expected[i][0] - value) <= allowed]
        # One box may hold several roots; it says so by its multiplicity and is then not certified.
        assert sum(expected[i][1] for i in inside) == root.multiplicity, (value, radius, inside)
        assert len(inside) == 1 or not root.certified
        for i in inside:
            met[i] += 1
    assert met == [1] * len(expected)


def not_left_out(case, result, expected):
    """Return the expected roots in the region, without those in the parts that are said to be left out."""
    return [
        (s, multiplicity)
        for s, multiplicity in expected
        if case.within(s)
        and not any(
            abs(s - mpc(part.re, sign * part.im)) <= part.radius
            for part in result.excluded
            for sign in (1, -1)
        )
    ]


LARGE = slow_ones(CASES, lambda case: case.name == "200 masses with losses")


# ----------------------------------------------------------------- certified: what the engine has to reach


@pytest.mark.parametrize("case", LARGE, ids=IDS)
@pytest.mark.slow
def test_certified_the_whole_region_is_proved(case):
    result = case.solve()
    assert result.certificate.certified
    assert all(root.certified for root in (*result.poles, *result.zeros))
    for found, expected in zip((result.poles, result.zeros), case.expected(), strict=True):
        check_exactly(found, not_left_out(case, result, expected))


ON_THE_BOUNDARY = [case for case in CASES if "limit" in case.name or "side of the region" in case.name]


@pytest.mark.slow
@pytest.mark.parametrize("case", ON_THE_BOUNDARY, ids=lambda case: case.name)
def test_certified_roots_on_the_boundary_are_in_and_say_so(case):
    result = case.solve()
    assert result.certificate.certified
    for root in result.poles:
        s, _ = numbers(root)
        if case.band is not None:
            at_a_limit = any(abs(abs(s) - 2 * pi * hertz) < mpf(10) ** -20 for hertz in case.band)
        else:
            at_a_limit = root.on_imaginary_axis
        assert root.on_boundary == at_a_limit


@pytest.mark.slow
def test_certified_no_mode_of_three_beams_is_missing():
    bound = symflex.loads(THREE_BEAMS).transfer_function("X", "F").bind()
    result = bound.pole_zero_map(digits=30, region=THEIR_REGION)
    assert result.certificate.certified
    check_three_beams(result)


# ------------------------------------------------------------------------------- roots without closed form


def three_beams(load):
    """Return the determinant of the three beams with the tip free, or held."""

    def at(s):
        problem = Problem()
        values = [
            {"E": mpf(ei), "I": mpf(1), "rho": mpf(mass), "A": mpf(1), "l": mpf(length)}
            for ei, mass, length in STEPS
        ]
        lines = [problem.line(bending(v, mpc(s))) for v in values]
        ends = [line.at(v["l"]) for line, v in zip(lines, values, strict=True)]
        problem.require(*lines[0].start[:2])
        for end, line in zip(ends, lines[1:], strict=False):
            problem.require(*(a - b for a, b in zip(end, line.start, strict=True)))
        tip, _, moment, shear = ends[-1]
        hung = problem.unknown()
        link = (mpf(3) + s / 2) * (tip - hung)
        problem.require(moment, mpf("0.7") * s**2 * hung - link, link - shear if load else tip)
        return determinant(problem)

    return at


def check_three_beams(result):
    with mp.workdps(15):
        for found, load in ((result.poles, True), (result.zeros, False)):
            function = three_beams(load)
            assert all(root.multiplicity == 1 for root in found)
            assert len(found) == count_inside(function, *CORNERS, 12)
            for root in found:
                s, _ = numbers(root)
                assert abs(function(s)) < mpf(10) ** -6 * abs(function(s + mpf("0.001")))


@pytest.mark.slow
def test_the_modes_of_three_beams_are_those_of_twelve_states():
    bound = symflex.loads(THREE_BEAMS).transfer_function("X", "F").bind()
    check_three_beams(bound.pole_zero_map(digits=20, region=THEIR_REGION))


# ---------------------------------------------------------------------------------- roots without number

POINT = mpf(-10)
"""-1/eta: the lower of each pair of real roots tends there."""
AROUND = Case("accumulation inside", KELVIN_VOIGT, damped_rod, region=(-400.0, 1.0, -50.0, 50.0))


@pytest.mark.slow
def test_a_region_around_an_accumulation_leaves_its_neighbourhood_out_and_says_so():
    result = AROUND.solve()
    (part,) = result.excluded
    assert abs(mpc(part.re, part.im) - POINT) < part.radius < 2
    for found, expected in zip((result.poles, result.zeros), damped_rod(), strict=True):
        left = not_left_out(AROUND, result, expected)
        outside = [r for r in found if abs(numbers(r)[0] - mpc(part.re, part.im)) > part.radius]
        assert len(outside) == len(left)
        for root in outside:
            value, _ = numbers(root)
            assert min(abs(s - value) for s, _ in left) < mpf(10) ** -25 * abs(value)


@pytest.mark.slow
def test_certified_all_but_the_neighbourhood_of_an_accumulation_is_proved():
    result = AROUND.solve()
    assert result.certificate.certified
    assert len(result.excluded) == 1
    (part,) = result.excluded
    for found, expected in zip((result.poles, result.zeros), damped_rod(), strict=True):
        outside = [r for r in found if abs(complex(r.re, r.im) - complex(part.re, part.im)) > part.radius]
        check_exactly(outside, not_left_out(AROUND, result, expected))


@pytest.mark.slow
def test_certified_a_region_without_the_accumulation_leaves_nothing_out():
    case = Case("left of it", KELVIN_VOIGT, damped_rod, region=(-400.0, -12.5, -50.0, 50.0))
    result = case.solve()
    assert result.certificate.certified
    assert result.excluded == ()
    for found, expected in zip((result.poles, result.zeros), damped_rod(), strict=True):
        check_exactly(found, not_left_out(case, result, expected))
