"""Verdicts on passivity, against real parts derived by hand."""

from math import pi, sqrt

import pytest

from symflex import pipeline
from symflex.contact.passivity import _grows, driving_function, find_passivity, residue_at
from symflex.errors import SymflexError, UsageError
from symflex.roots import Modes
from symflex.roots.locate import locate
from tests.unit.contact.machines import ARM, DELAYED, LAGGED, machine


def bands(found):
    return [(float(b.low.mid()), None if b.high is None else float(b.high.mid())) for b in found.active]


def test_a_lag_makes_a_stiff_wall_active_below_a_frequency():
    # Re Z = b - K tau/(1 + (omega tau)^2) < 0 where omega < sqrt(K tau/b - 1)/tau.
    found = find_passivity(machine(K="20.5 N/m"), "tip")
    assert found.passive is False
    ((low, high),) = bands(found)
    assert low == 0
    assert high == pytest.approx(sqrt(20.5 * 0.05 - 1) / 0.05, rel=1e-11)


def test_a_wall_at_the_bound_touches_zero_and_is_passive():
    assert find_passivity(machine(K="20 N/m"), "tip").passive is True


def test_a_delay_makes_a_wall_active_up_to_the_root_of_a_sinc():
    # sin(u)/u = 1/2 at u = 1.8954942670339809 (mpmath), with b/(K tau) = 1/2.
    found = find_passivity(machine(DELAYED, K="40 N/m"), "tip")
    ((low, high),) = bands(found)
    assert (low, found.passive) == (0, False)
    assert high == pytest.approx(1.8954942670339809 / 0.05, rel=1e-11)


def test_a_delay_that_is_short_enough_is_proved_passive():
    assert find_passivity(machine(DELAYED, K="19.9 N/m"), "tip").passive is True


@pytest.mark.slow
def test_an_arm_with_a_delay_is_active_up_to_a_frequency_or_passive():
    # 18.21568 rad/s: a dense grid of transfer matrices in mpmath, and Taylor forms of an own program.
    found = find_passivity(machine(ARM), "tip", is_explained=False)
    ((_, high),) = bands(found)
    assert high == pytest.approx(18.21568, abs=5e-6)
    assert find_passivity(machine(ARM, T="0.05 s"), "tip").passive is True


def test_energy_proves_what_nothing_supplies():
    beam = ARM.replace("*exp(-s*T)", "").replace("*(1 + eta*s)", "")
    found = find_passivity(machine(beam), "tip")
    assert (found.passive, found.proof) == (True, "passive, nothing supplies energy")


def test_a_circuit_without_resistance_is_lossless():
    text = """symflex = 1
[elements]
L = { type = "inductor", between = ["v", "w"], L = "1 mH" }
C = { type = "capacitor", between = ["w", "ground"], C = "1 uF" }
[inputs]
i = { current = "v" }
[outputs]
V = "v"
"""
    found = find_passivity(machine(text), "v")
    assert (found.passive, found.is_lossless, found.function) == (True, True, "v_v/i_v")


def test_a_negative_spring_is_active_by_its_pole_and_not_on_the_axis():
    # Z = m s + b - k/s: Re Z = b, and m s^2 + b s - k has a positive root.
    text = LAGGED.replace("-K/(tau*s + 1)*x", "K*x")
    found = find_passivity(machine(text), "tip")
    assert (found.passive, found.active) == (False, ())
    assert "1 pole in the right half-plane" in found.faults[0]
    # s = (-1 + sqrt(1 + 4*20.5))/2
    assert float(found.example.root.re.mid()) == pytest.approx((-1 + sqrt(83)) / 2)
    assert found.example.elements == ()


def test_a_residue_that_is_not_positive_is_a_fault():
    # f = 2 m s^2 x leaves a mass of -m: v/f = -1/(m s).
    text = LAGGED.replace("-K/(tau*s + 1)*x", "2*M*s^2*x")
    text = text.replace("[parameters]", '[parameters]\nM = "1 kg"').replace('b = "b"', 'b = "0 N*s/m"')
    found = find_passivity(machine(text), "tip")
    assert found.passive is False
    assert "residue" in found.faults[0]
    assert [x.type_name for x in found.example.elements] == ["spring"]


def test_a_node_that_does_not_move_is_refused():
    text = LAGGED.replace(
        "[inputs]",
        'rod = { type = "spring", between = ["x", "y"], k = "1 N/m" }\n[inputs]\nmove = { velocity = "y" }',
    )
    with pytest.raises(SymflexError, match="follows input 'move'"):
        find_passivity(machine(text), "y")


def test_the_only_port_needs_no_name():
    assert find_passivity(machine(K="20 N/m"), None).port.name == "tip"
    with pytest.raises(UsageError, match="name the port"):
        find_passivity(machine(LAGGED.split("[ports]")[0]), None)


def test_json_has_the_keys_of_the_schema():
    data = find_passivity(machine(), "tip").to_json_dict()
    assert data["schema"] == "symflex.passivity/1"
    (band,) = data["active"]
    assert band == {"from_hz": 0.0, "to_hz": pytest.approx(sqrt(0.025) / 0.05 / (2 * pi))}
    assert set(data["least"]) >= {"value", "radius", "frequency_hz"}
    assert float(data["repair"]["parallel"]["limit"]["value"]) == pytest.approx(0.025)
    assert data["example"]["root"]["radius"]


def test_loss_factors_are_refused():
    text = LAGGED.replace(
        "[inputs]", 'k = { type = "spring", between = ["x", "ground"], k = 5, eta_s = 0.1 }\n[inputs]'
    )
    with pytest.raises(SymflexError, match="loss factors"):
        driving_function(machine(text), "tip")


def bound_of(formula):
    text = f'symflex = 1\n[inputs]\nu = {{}}\n[outputs]\ny = "({formula})*u"\n'
    return pipeline.derive_bound(pipeline.loads(text), [("y", "u")])[0]


@pytest.mark.parametrize(
    ("formula", "exact"),
    [
        ("s/(s^2 + 4)", [1 / 2]),
        ("-3*s/(s^2 + 4)", [-3 / 2]),
        ("5/s", [5]),
        ("s/((s^2 + 4)*(s + 1))", [1 / 10]),  # 1/(2 (1 + 2j)) has this real part
        # coth(T s) has 1/T at 0, pi j/T, 2 pi j/T, ... ; here T = 2.
        ("(1 + exp(-4*s))/(1 - exp(-4*s))", [1 / 2] * 3),
        ("-(1 + exp(-4*s))/(1 - exp(-4*s))", [-1 / 2] * 3),
        # tanh(T s) has them halfway between.
        ("(1 - exp(-4*s))/(1 + exp(-4*s))", [1 / 2] * 3),
    ],
)
def test_residues_on_the_axis(formula, exact):
    bound = bound_of(formula)
    poles = locate(bound, None if bound.is_rational else Modes(3), with_zeros=False).poles
    found = [residue_at(bound, p) for p in poles if p.on_imaginary_axis and not p.im < 0]
    assert [float(x) for x in found][:3] == pytest.approx(exact)


@pytest.mark.parametrize(
    ("formula", "grows"),
    [
        ("s", False),
        ("-s", True),
        ("s^2 + s", True),
        ("(2*s^2 + 1)/(s + 1)", False),
        ("(1 - 2*s^2)/(s + 1)", True),
        ("-1/s", False),
        ("-7", False),
        ("s*(2 + exp(-s))", False),
        ("exp(-s)/(s + 1)", False),
        ("-s*(2 + exp(-s))", None),
        ("s^2*(2 + exp(-s))", None),
    ],
)
def test_a_function_may_grow_as_s_and_no_faster(formula, grows):
    assert _grows(bound_of(formula)) is grows


@pytest.mark.parametrize(
    ("equation", "unit", "fault"),
    [
        ("c*(s^2 + w^2)*x", "kg", None),
        ("c*(s^2 + w^2)^2*x", "kg*s^2", "a pole on the imaginary axis is not simple: 0.31831 Hz"),
        (
            "-c*(s^2 + w^2)*x",
            "kg",
            "a pole on the imaginary axis has a residue that is not positive: 0.31831 Hz",
        ),
        ("c*s^3*x", "kg*s", "a pole on the imaginary axis is not simple: 0 Hz"),  # V/F = 1/(c s^2)
        ("c*x", "N/m", None),
        ("-c*x", "N/m", "the function grows faster than s, or with a negative factor"),  # V/F = -s/c
    ],
)
def test_what_loses_nothing_on_the_axis_may_be_active_by_its_poles_there(equation, unit, fault):
    text = f"""symflex = 1
parameters = {{ c = "1 {unit}", w = "2 rad/s" }}
[equations]
unknowns = ["x"]
equations = ["{equation} = F"]
[inputs]
F = {{ unit = "N" }}
[outputs]
V = "s*x"
[ports]
hand = {{ force = "F", velocity = "V" }}
"""
    found = find_passivity(pipeline.loads(text), "hand", is_explained=False)
    assert found.is_lossless is (equation != "c*s^3*x")
    assert found.passive is (fault is None)
    assert not found.faults if fault is None else any(fault in each for each in found.faults)
