"""Beck's column: its tip's motion, its poles and its critical load, by a derivation that stands here.

With w(0) = w'(0) = 0 the solution is A (cosh b x - cos a x) + B (sinh b x/b - sin a x/a), where
a^2 - b^2 = P/EI and a^2 b^2 = mu omega^2/EI. The conditions at the tip, w'' = 0 and EI w''' = -F, give A and
B. D is Beck's equation (1952).
"""

from pathlib import Path

import pytest
from mpmath import cos, cosh, diff, findroot, mp, mpf, sin, sinh, sqrt

import symflex

COLUMN = Path(__file__).parents[2] / "derivations" / "classics" / "beck_column.toml"
EI, MU, L = mpf(70), mpf("0.27"), mpf("0.5")


def arguments(p, w):
    half = sqrt(p * p / 4 + w * w)
    return sqrt(half + p / 2), sqrt(half - p / 2)


def beck(p, w):
    a, b = arguments(p, w)
    return p * p + 2 * w * w + 2 * w * w * cos(a) * cosh(b) + p * w * sin(a) * sinh(b)


def tip(p, w):
    a, b = arguments(p, w)
    waves = (a * a + b * b) * (sin(a) * cosh(b) / a - cos(a) * sinh(b) / b)
    return L**3 / EI * waves / beck(p, w)


@pytest.mark.parametrize(("load", "omega"), [(3000, 200), (3000, 2000), (7000, 500)])
def test_the_tip_follows_a_force_across_it(load, omega):
    w = omega * L**2 * sqrt(MU / EI)
    tf = symflex.load(COLUMN).transfer_function("Y_tip", "F").bind(P=load)
    assert complex(tf(1j * omega)) == pytest.approx(float(tip(load * L**2 / EI, w)), rel=1e-12)


def test_poles_are_roots_of_becks_equation():
    p = 3000 * L**2 / EI
    expected = [findroot(lambda w: beck(p, w), guess) / (L**2 * sqrt(MU / EI)) for guess in (5, 18, 58)]
    found = symflex.load(COLUMN).transfer_function("Y_tip", "F").bind().poles(modes=3)
    above = sorted(float(root.im) for root in found if root.im > 0)
    assert above == pytest.approx([float(omega) for omega in expected], rel=1e-12)


@pytest.mark.slow
def test_poles_leave_the_axis_where_becks_equation_has_a_double_root():
    found = symflex.load(COLUMN).stability(over="P", limits=("5.6 kN", "5.63 kN"), up_to_hz=120, digits=13)
    with mp.workdps(30):
        p, w = findroot(lambda p, w: [beck(p, w), diff(lambda x: beck(p, x), w)], (20, 11))
        load, omega = float(p * EI / L**2), float(w / (L**2 * sqrt(MU / EI)))
    (boundary,) = found.proved.boundaries
    assert float(boundary.gain.mid()) == pytest.approx(load, rel=1e-12)
    assert [float(each.mid()) for each in boundary.frequencies] == pytest.approx([omega], rel=1e-12)
    assert [i.poles.word for i in found.proved.intervals] == ["marginal", "unstable"]
