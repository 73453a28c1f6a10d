"""Poles in z against matrix exponentials in doubles (scipy), and by hand."""

import numpy as np
import pytest

from symflex import loads
from tests.unit.analysis.sampled_loop.exact_steps import closed_poles


def polynomial(coefficients, name):
    last = len(coefficients) - 1
    return " + ".join(f"({c})*{name}^{last - i}" for i, c in enumerate(coefficients))


def poles(plant, controller, period, delay):
    num, den = (polynomial(p, "s") for p in plant)
    above, below = (polynomial(p, "z") for p in controller)
    return loads(f"""symflex = 1
blocks  = {{ G = "({num})/({den})", C = "({above})/({below})" }}
sampled = {{ period = "{period} s", delay = "{delay} s", blocks = ["C"] }}
signals = {{ y = "G*(F - C*y)" }}
inputs  = {{ F = {{}} }}
outputs = {{ Y = "y" }}
""").sampled_poles(digits=12)


PLANTS = (
    ([1.0], [1.0, 0.0]),
    ([3.0], [1.0, 2.0, 90.0]),
    ([2.0, 5.0], [1.0, 1.5, 40.0, 0.0]),
    ([7.0], [1.0, 4.0, 300.0, 500.0, 0.0]),
    ([1.0, 3.0], [1.0, 9.0, 80.0, 400.0, 900.0, 0.0]),
)
CONTROLLERS = (([1.5], [1.0]), ([21.5, -20.0], [1.0, 0.0]), ([1.6, -1.5], [1.0, -1.0]))


@pytest.mark.parametrize("delay", [0.0, 0.3, 1.0, 2.25])
def test_poles_are_those_of_matrix_exponentials(delay):
    period, failed = 0.02, []
    for plant in PLANTS:
        for controller in CONTROLLERS:
            found = poles(plant, controller, period, round(delay * period, 6))
            z = np.array([complex(p.z.mid()) for p in found.poles for _ in range(p.multiplicity)])
            pairs = np.array([complex(p.z.mid()).conjugate() for p in found.poles if p.is_pair])
            every = np.concatenate([z, pairs])
            expected = closed_poles(plant, controller, period, round(delay * period, 6))
            # A pole at z = 0, of a sample that waits, is not printed where nothing moves it.
            distance = max(np.abs(every - x).min() for x in expected if abs(x) > 1e-4)
            if distance > 1e-9 or found.verdict.right != (np.abs(expected) > 1).sum():
                failed.append((plant, controller, distance))
    assert not failed


def test_a_pole_is_given_in_s_too():
    # z = 1 - K T = 1/2, so s = -ln(2)/T
    (pole,) = poles(([1.0], [1.0, 0.0]), ([1.0], [1.0]), 0.5, 0.0).poles
    assert float(pole.s.real.mid()) == pytest.approx(-2 * np.log(2), rel=1e-12)


def test_poles_in_s_are_the_logarithms_of_those_in_z():
    # z - 1 + K T = 0 at z = -1/2: s = (ln(1/2) + pi j)/T; and z^2 - z + K T = 0 with a delay of one period.
    (alternating,) = poles(([1.0], [1.0, 0.0]), ([3.0], [1.0]), 0.5, 0.0).poles
    assert complex(alternating.s.mid()) == pytest.approx((-np.log(2) + 1j * np.pi) / 0.5, rel=1e-12)
    assert (alternating.side, alternating.is_pair, float(alternating.size)) == (-1, False, 0.5)
    (turning,) = poles(([1.0], [1.0, 0.0]), ([1.0], [1.0]), 0.5, 0.5).poles
    assert complex(turning.z.mid()) == pytest.approx(0.5 + 0.5j, rel=1e-12)
    assert complex(turning.s.mid()) == pytest.approx(np.log(0.5 + 0.5j) / 0.5, rel=1e-12)
    assert turning.is_pair and float(turning.size.mid()) == pytest.approx(0.5**0.5)


def test_a_pole_on_the_circle_is_exactly_there():
    # A controller that differentiates does not see where an integrator is: z = 1 stays
    found = poles(([1.0], [1.0, 0.0]), ([1.0, -1.0], [1.0, 0.0]), 0.5, 0.0)
    assert [p.side for p in found.poles if p.z == 1] == [0]
    assert found.sentence == "marginal, not asymptotically stable: a pole at z = 1"


def test_the_document_and_the_text_say_the_same():
    found = poles(([1.0], [1.0, 0.0]), ([5.0], [1.0]), 0.5, 0.0)  # z = -1.5
    document = found.to_json_dict()
    assert (document["stable"], document["outside"], document["poles"][0]["where"]) == (False, 1, "outside")
    assert "unstable: 1 pole outside the unit circle" in str(found)
