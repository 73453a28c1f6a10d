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
from mpmath import mp, mpc, mpf, pi, sqrt

import symflex
from symflex.roots.root import exact_fraction

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
    names_boundary : bool
        Whether its poles lie on the boundary of the region, or inside, and say which.
    """

    name: str
    text: str
    expected: Callable[[], tuple[Expected, Expected]]
    band: tuple[float, float] | None = None
    region: tuple[float, float, float, float] | None = None
    names_boundary: bool = False

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
        return bound.pole_zero_map(digits=30, band=self.band, region=self.region)


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(WORKING):
        yield


# ------------------------------------------------------------------------------------------------- texts

ROD = 'type = "rod", E = "1 Pa", A = "1 m^2", rho = "1 kg/m^3"'


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
    'k_2 = { type = "spring", between = ["y", "ground"], k = "1.00000000000001 N/m" }\n'
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


HELD_ROD = spec(f'bar = {{ {ROD}, between = ["ground", "x"], l = "1 m" }}\n')

KELVIN_VOIGT = spec(f'bar = {{ {ROD}, between = ["ground", "x"], l = "1 m", eta = "0.1 s" }}\n')


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


def oscillators():
    return pairs([mpf(1), sqrt(mpf("1.00000000000001"))]), []


def diffusion():
    # (cosh q/(q sinh q))^2 with q^2 = s: q^2 sinh^2 q has a double root at s = 0 too.
    return (
        [(mpc(-((k * pi) ** 2)), 2) for k in range(12)],
        [(mpc(-(((k + mpf(1) / 2) * pi) ** 2)), 2) for k in range(12)],
    )


def held_rod():
    return pairs([(k + mpf(1) / 2) * pi for k in range(8)]), pairs([k * pi for k in range(1, 8)])


def dead_beat():
    # 1/(1 - e^-s)
    return [(mpc(0), 1), *pairs([2 * pi * k for k in range(1, 40)])], []


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


CASES = (
    Case("squares of hyperbolic cosines", cascade(ROD, "1"), equal_rods, band=(0.0, 2.1)),
    Case("rods side by side, 1e-10 apart", side_by_side("1.0000000001"),
         functools.partial(rods_apart, "1.0000000001"), band=(0.0, 0.6)),
    Case("oscillators 5e-15 apart", OSCILLATORS, oscillators),
    Case("double real roots of two lines", DIFFUSION, diffusion, region=(-150.0, 1.0, -3.0, 3.0)),
    Case("all roots on the side of the region", HELD_ROD, held_rod, region=(0.0, 5.0, 0.5, 10.0),
         names_boundary=True),
    Case("a corner at a root", delays("F + D_1*y", "1"), dead_beat, region=(0.0, 5.0, 0.0, 10.0)),
    Case("roots at both limits of the band", delays("F + D_1*y", "1"), dead_beat, band=(1.0, 4.0),
         names_boundary=True),
    Case("left of an accumulation", KELVIN_VOIGT, damped_rod, region=(-400.0, -12.5, -50.0, 50.0)),
    Case("two equal delays", delays("(F + 2*D_1*y - D_1*D_1*y)", "1"),
         lambda: ([(mpc(0, 2 * pi * k), 2) for k in range(-9, 10)], []), band=(0.0, 2.5)),
)  # fmt: skip


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


# ----------------------------------------------------------------- certified: what the engine has to reach


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_certified_the_whole_region_is_proved_and_roots_on_its_boundary_say_so(case):
    result = case.solve()
    assert result.certificate.certified
    assert result.excluded == ()
    assert all(root.certified for root in (*result.poles, *result.zeros))
    for found, expected in zip((result.poles, result.zeros), case.expected(), strict=True):
        check_exactly(found, not_left_out(case, result, expected))
    if case.names_boundary:
        for root in result.poles:
            s, _ = numbers(root)
            at_a_limit = (
                root.on_imaginary_axis
                if case.band is None
                else any(abs(abs(s) - 2 * pi * hertz) < mpf(10) ** -20 for hertz in case.band)
            )
            assert root.on_boundary == at_a_limit, s


CLOSER = Case(
    "delays in series, 1e-14 apart",
    delays_in_series("1.00000000000001"),
    functools.partial(two_delays, "1.00000000000001"),
    band=(0.0, 1.5),
)


@pytest.mark.slow
def test_roots_closer_than_cells_are_cut_are_enclosed_together_and_not_certified():
    result = CLOSER.solve()
    assert not result.certificate.certified
    assert result.certificate.counted == result.certificate.found
    assert any(root.multiplicity > 1 and not root.certified for root in result.poles)
    for found, expected in zip((result.poles, result.zeros), CLOSER.expected(), strict=True):
        check_exactly(found, not_left_out(CLOSER, result, expected))


# ---------------------------------------------------------------------------------- roots without number

POINT = mpf(-10)
"""-1/eta: the lower of each pair of real roots tends there."""
AROUND = Case("accumulation inside", KELVIN_VOIGT, damped_rod, region=(-400.0, 1.0, -50.0, 50.0))


@pytest.mark.slow
def test_certified_all_but_the_neighbourhood_of_an_accumulation_is_proved():
    result = AROUND.solve()
    assert result.certificate.certified
    (part,) = result.excluded
    assert abs(mpc(part.re, part.im) - POINT) < part.radius < 2
    for found, expected in zip((result.poles, result.zeros), damped_rod(), strict=True):
        outside = [r for r in found if abs(numbers(r)[0] - mpc(part.re, part.im)) > part.radius]
        check_exactly(outside, not_left_out(AROUND, result, expected))
