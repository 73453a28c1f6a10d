"""Coupled stability against roots of nodal determinants by numpy, which share nothing with symflex."""

from random import Random

import numpy as np
import pytest

from symflex import Model, loads
from symflex.errors import ModelError, SpecError, SymflexError, UsageError
from tests.unit.analysis.sampled_loop.test_plant import HANDLE, edge, size

POLYNOMIAL = np.polynomial.polynomial

FORCE_LOOP = """
symflex = 1
parameters = { K = 8, k_s = 1e5, m_1 = "60 kg", m_2 = "20 kg", k = "95 kN/m", b = 40, b_1 = 400 }
inputs = { F_cmd = {} }
outputs = { F_tip = "F_contact" }
[signals]
F_contact = "k_s*(x_tip - x_touch)"
[elements]
drive  = { type = "force_source", at = "x_act", f = "K*(F_cmd - F_contact)" }
sensor = { type = "spring", between = ["x_tip", "x_touch"], k = "k_s" }
motor  = { type = "mass", at = "x_act", m = "m_1" }
slide  = { type = "damper", between = ["x_act", "ground"], b = "b_1" }
load   = { type = "mass", at = "x_tip", m = "m_2" }
spring = { type = "spring", between = ["x_act", "x_tip"], k = "k" }
damper = { type = "damper", between = ["x_act", "x_tip"], b = "b" }
[ports]
touch = { at = "x_touch" }
"""
"""A force loop about two masses, with the sensor's spring before what it touches."""


def determinant(K: float, law: tuple[float, float, float]) -> np.ndarray:
    """Return the determinant of the nodal equations of FORCE_LOOP, by powers of s, ascending."""
    k_s, m_1, m_2, k, b, b_1 = 1e5, 60.0, 20.0, 95e3, 40.0, 400.0
    rows = [
        [(k, b + b_1, m_1), (-k + K * k_s, -b), (-K * k_s,)],
        [(-k, -b), (k + k_s, b, m_2), (-k_s,)],
        [(0.0,), (-k_s,), (k_s + law[0], law[1], law[2])],
    ]

    def minor(rows: list) -> np.ndarray:
        if len(rows) == 1:
            return np.array(rows[0][0])
        total = np.zeros(1)
        for i, entry in enumerate(rows[0]):
            rest = [[*row[:i], *row[i + 1 :]] for row in rows[1:]]
            total = POLYNOMIAL.polyadd(total, (-1) ** i * POLYNOMIAL.polymul(entry, minor(rest)))
        return total

    return np.trim_zeros(minor(rows), "b")


def unstable(K: float, law: tuple[float, float, float]) -> int:
    """Return how many roots of the determinant lie in the right half-plane."""
    return int((POLYNOMIAL.polyroots(determinant(K, law)).real > 1e-7).sum())


def test_the_stiffest_stable_spring_is_where_a_root_meets_the_axis() -> None:
    found = loads(FORCE_LOOP).contact("touch", "k_e")
    low, high = 1e3, 1e6
    while high - low > 1e-7 * low:
        middle = (low + high) / 2
        low, high = (low, middle) if unstable(8, (middle, 0, 0)) else (middle, high)
    (stable,) = found.answer.stable
    assert float(stable.high.mid()) == pytest.approx(low, rel=1e-6)
    assert found.is_stable is False and found.certified
    assert found.answer.intervals[-1].high is None


def test_a_class_is_its_law() -> None:
    model = loads(FORCE_LOOP)
    by_law, by_class = (model.contact("touch", text).answer for text in ("b_e*s", "damper"))
    assert by_law.to_json_dict() == by_class.to_json_dict()


def test_verdicts_at_values_are_those_of_numpy() -> None:
    draw = Random(1)
    for _ in range(12):
        K, law = (
            draw.choice([1.2, 4, 8]),
            tuple(10 ** draw.uniform(*ends) for ends in ((2, 6), (0, 3), (-1, 2))),
        )
        values = dict(zip(("k_e", "b_e", "m_e"), law, strict=True))
        found = loads(FORCE_LOOP).contact("touch", "k_e + b_e*s + m_e*s^2", K=K, **values)
        assert found.certified
        assert (found.answer.verdict.right or 0) == unstable(K, law)


def test_a_wall_is_the_limit_of_stiff_springs() -> None:
    for K in (0.5, 8):
        found = loads(FORCE_LOOP).contact("touch", "wall", K=K)
        assert found.is_stable is (unstable(K, (1e12, 0, 0)) == 0)


def test_a_spring_damper_without_end_is_unstable_if_a_spring_is() -> None:
    found = loads(FORCE_LOOP).contact("touch", "spring-damper")
    assert found.is_stable is False
    assert found.reason == "with b_e = 0"


def test_all_combinations_of_a_box_are_proved_stable() -> None:
    ranges = {"k_e": (1e3, 1e4), "b_e": (1, 10)}
    found = loads(FORCE_LOOP).contact("touch", "k_e + b_e*s", ranges=ranges)
    assert found.is_stable is True
    corners = [unstable(8, (k, b, 0)) for k in ranges["k_e"] for b in ranges["b_e"]]
    assert corners == [0] * 4
    found = loads(FORCE_LOOP).contact("touch", "k_e + b_e*s", ranges={**ranges, "b_e": (1, 100)})
    assert found.is_stable is False
    k, b = map(float, found.answer.combination)
    assert unstable(8, (k, b, 0)) == 2


def test_a_mass_between_two_nodes_is_a_law_of_a_spring() -> None:
    text = FORCE_LOOP.replace('at = "x_touch"', 'at = ["x_touch", "x_act"]')
    found = loads(text).contact("touch", "k_e + m_e*s^2", m_e=1, k_e=100)
    assert [kind for kind, _, _ in found.environment.elements] == ["spring"]


@pytest.mark.slow
def test_delays_are_searched_to_the_largest_stiffness_that_is_proved() -> None:
    # m s^2 + b s + k exp(-s T): with another spring k_e stable while b is above k T, whatever k_e.
    model = Model(
        parameters={"m": 1, "b": 2, "K": 10, "T": 0.05},
        elements={
            "body": {"type": "mass", "at": "x", "m": "m"},
            "friction": {"type": "damper", "between": ["x", "ground"], "b": "b"},
            "wall": {"type": "force_source", "at": "x", "f": "-K*exp(-s*T)*x"},
        },
        inputs={"F": {"force": "x"}},
        outputs={"X": "x"},
    )
    found = model.contact("x", "spring")
    assert found.is_stable is True
    assert found.answer.limits[1] > 10**9


def test_circuits_are_touched_by_impedances() -> None:
    # A negative resistance of 50 Ohm beside a capacitor, which a resistor below 50 Ohm makes stable.
    model = Model(
        parameters={"C": "1 uF", "g": "20 mA/V"},
        elements={
            "c": {"type": "capacitor", "between": ["v", "ground"], "C": "C"},
            "active": {"type": "vccs", "inputs": ["v", "ground"], "terminals": ["v", "ground"], "g": "g"},
        },
        inputs={"i": {"current": "v"}},
        outputs={"V": "v"},
    )
    (stable,) = model.contact("v", "R_e").answer.stable
    assert float(stable.high.mid()) == pytest.approx(50)


@pytest.mark.parametrize(
    ("environment", "said"),
    [
        ("k_e + x_tip", "a node"),
        ("resistor", "no environment of a port in translation"),
        ("k_e + b_e*s + m_e*s^2", "at most two"),
    ],
)
def test_what_is_no_environment_is_refused(environment: str, said: str) -> None:
    with pytest.raises(UsageError, match=said):
        loads(FORCE_LOOP).contact("touch", environment)


def test_a_letter_without_a_value_beside_another_is_refused() -> None:
    with pytest.raises(UsageError, match="'b_e' of the environment has no value"):
        loads(FORCE_LOOP).contact("touch", "k_e + b_e*s", over="k_e")


def test_units_of_letters_follow_from_the_place() -> None:
    found = loads(FORCE_LOOP).contact("touch", "k_e", k_e="1 kN/m")
    assert found.is_stable
    with pytest.raises(SpecError, match="SF203"):
        loads(FORCE_LOOP).contact("touch", "k_e + m_1*s", k_e=1)


SAMPLED_TOOL = """symflex = 1
parameters = { T = "1 ms", K = "9 N/m" }
sampled = { period = "T" }
blocks = { w = "K/z" }
inputs = { F = { force = "q" } }
outputs = { Q = "q" }
[elements]
m = { type = "mass", at = "q", m = 1 }
f = { type = "force_source", at = "q", f = "-w*q" }
d = { type = "damper", between = ["q", "ground"], b = 1 }
"""


def test_a_tool_whose_controller_takes_samples_is_refused(tmp_path):
    tool = tmp_path / "tool.toml"
    tool.write_text(SAMPLED_TOOL)
    with pytest.raises(SymflexError, match="SF261"):
        loads(FORCE_LOOP).contact("x_touch", f"{tool}:q", z_e=0.5)


def test_a_spring_at_a_sampled_handle_is_part_of_what_is_sampled():
    # The handle of tests/unit/analysis/sampled_loop/test_plant.py with its spring as the environment.
    text = "\n".join(line for line in HANDLE.splitlines() if not line.startswith("tool"))
    text = text.replace('k = "1 kN/m", ', "")
    found = loads(text).contact("x", "k_e", ranges={"k_e": (1e5, 3e5)})
    assert found.is_stable is False
    assert float(found.answer.boundaries[0].gain) == pytest.approx(edge("k", 1e5, 3e5), rel=1e-8)


def test_values_at_a_sampled_handle_give_its_poles_in_z():
    found = loads(HANDLE).contact("x", "0.01*s")
    assert found.is_stable
    assert float(found.answer.poles[-1].size.mid()) == pytest.approx(size(b=0.71), rel=1e-12)


def test_a_sampled_handle_needs_ends_of_ranges_and_something_that_moves():
    with pytest.raises(UsageError, match="SF804"):
        loads(HANDLE).contact("x", "spring")
    with pytest.raises(ModelError, match="closes no loop"):
        loads(HANDLE).contact("x", "wall")
