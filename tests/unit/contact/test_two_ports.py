"""Two ports against dense grids of nodal equations by numpy, and conditions derived by hand."""

from random import Random

import numpy as np
import pytest

from symflex import Model
from symflex.contact.two_ports import TwoPorts, find_two_ports


def of(model: Model, *names: str) -> TwoPorts:
    """Return what is proved at two ports."""
    return find_two_ports(model.resolved, names or ("x", "y"))


def teleoperator(T: float, b_y: float = 6, gain: float = 1) -> Model:
    """Return two masses that springs hold to each other's position, T late; ``gain`` times to the left."""
    return Model(
        parameters={
            "m": 0.5,
            "M": 2,
            "b": 4,
            "B": b_y,
            "k": 30,
            "g": gain,
            "T": {"value": T, "assume": "nonnegative"},
        },
        elements={
            "master": {"type": "mass", "at": "x", "m": "m"},
            "slave": {"type": "mass", "at": "y", "m": "M"},
            "grip": {"type": "damper", "between": ["x", "ground"], "b": "b"},
            "load": {"type": "damper", "between": ["y", "ground"], "b": "B"},
            "left": {"type": "force_source", "at": "x", "f": "g*k*exp(-s*T)*y - k*x"},
            "right": {"type": "force_source", "at": "y", "f": "k*exp(-s*T)*x - k*y"},
        },
        inputs={"F": {"force": "x"}},
        outputs={"Y": "y"},
    )


def test_a_delay_is_paid_for_by_friction() -> None:
    # Z11 = m s + b + k/s and Z12 = -k exp(-s T)/s: b B >= (k sin(omega T)/omega)^2, the most at 0.
    limit = np.sqrt(4 * 6) / 30
    found = of(teleoperator(0.9 * limit))
    assert found.passive is True and found.absolutely_stable is True and found.is_reciprocal
    found = of(teleoperator(1.5 * limit))
    assert found.passive is False and found.absolutely_stable is False
    omega = float(found.active[0].high.mid())
    assert 30 * np.sin(omega * 1.5 * limit) / omega == pytest.approx(np.sqrt(24))


def test_what_is_not_reciprocal_may_be_absolutely_stable_and_active() -> None:
    # Without delay eta = (2 b B + g k^2/omega^2)/(g k^2/omega^2) > 1, while with g = 9 the Hermitian part
    # 4 b B - (8 k/omega)^2 is negative at low frequencies.
    found = of(teleoperator(0, gain=0.25))
    assert not found.is_reciprocal
    assert found.passive is False
    assert found.absolutely_stable is True
    edge = float(found.active[-1].high.mid())
    assert edge == pytest.approx(0.75 * 30 / (2 * np.sqrt(24)))


def test_a_network_of_springs_and_dampers_is_passive_by_energy() -> None:
    model = Model(
        parameters={"m": 1, "k": 2, "b": 3},
        elements={
            "left": {"type": "mass", "at": "x", "m": "m"},
            "right": {"type": "mass", "at": "y", "m": "m"},
            "spring": {"type": "spring", "between": ["x", "y"], "k": "k"},
            "damper": {"type": "damper", "between": ["y", "ground"], "b": "b"},
        },
        inputs={"F": {"force": "x"}},
        outputs={"Y": "y"},
    )
    found = of(model)
    assert found.passive is True and found.proof
    assert found.to_json_dict()["absolutely_stable"] is True


@pytest.mark.parametrize("seed", range(8))
def test_random_machines_are_judged_as_a_dense_grid_judges_them(seed: int) -> None:
    draw = Random(seed)
    m, b, k = (np.array([10 ** draw.uniform(-1, 1) for _ in range(3)]) for _ in range(3))
    k_1, k_2 = (10 ** draw.uniform(0, 2) for _ in range(2))
    gain, rate = draw.uniform(-2, 2), draw.uniform(-0.5, 0.5)
    nodes, names = ("x", "z", "y"), ("x", "y")
    elements: dict[str, object] = {}
    for i, node in enumerate(nodes):
        elements |= {
            f"m{i}": {"type": "mass", "at": node, "m": float(m[i])},
            f"b{i}": {"type": "damper", "between": [node, "ground"], "b": float(b[i])},
            f"k{i}": {"type": "spring", "between": [node, "ground"], "k": float(k[i])},
        }
    elements |= {
        "one": {"type": "spring", "between": ["x", "z"], "k": k_1},
        "two": {"type": "spring", "between": ["z", "y"], "k": k_2},
        "act": {"type": "force_source", "at": "y", "f": "g*x + h*s*x"},
    }
    parameters = {name: {"value": x, "assume": "real"} for name, x in (("g", gain), ("h", rate))}
    model = Model(parameters=parameters, elements=elements, inputs={"F": {"force": "x"}}, outputs={"Y": "y"})
    found = of(model, *names)

    springs = np.array([[k_1, -k_1, 0], [-k_1, k_1 + k_2, -k_2], [-gain, -k_2, k_2]])
    stiffness = np.diag(k) + springs
    damping = np.diag(b)
    damping[2, 0] = -rate
    inverse = np.diag(1 / m)
    companion = np.block([[np.zeros((3, 3)), np.eye(3)], [-inverse @ stiffness, -inverse @ damping]])
    is_stable = bool((np.linalg.eigvals(companion).real < 0).all())
    omega = np.geomspace(1e-3, 1e4, 20_001)
    s = 1j * omega[:, None, None]
    y = np.linalg.inv(np.diag(m) * s**2 + damping * s + stiffness)[:, [0, 2]][:, :, [0, 2]] * s
    least = np.linalg.eigvalsh(y + y.conj().transpose(0, 2, 1))[:, 0]
    size = np.abs(y).max(axis=(1, 2))
    real = y.real
    eta = (2 * real[:, 0, 0] * real[:, 1, 1] - (y[:, 0, 1] * y[:, 1, 0]).real) / abs(y[:, 0, 1] * y[:, 1, 0])
    is_passive = is_stable and bool((least > -1e-9 * size).all())
    is_safe = is_stable and bool(
        (real[:, 0, 0] > 0).all() and (real[:, 1, 1] > 0).all() and (eta >= 1 - 1e-9).all()
    )
    assert found.passive is is_passive
    assert found.absolutely_stable is is_safe
    if is_safe and found.least is not None:
        assert float(found.least.value.mid()) == pytest.approx(eta.min(), rel=1e-4)


def test_equal_modes_keep_the_margin() -> None:
    # Two equal resonators p = J s^2 + b s + k that levers join to both ports: Y = s/p times a matrix of
    # numbers, so abs(D)^2 does not divide what eta compares.
    lever = {"type": "planetary_gear", "rho": 1}
    elements: dict[str, object] = {
        "at_x": {**lever, "sun": "u", "ring": "v", "carrier": "x"},  # x = (u + v)/2
        "at_y": {**lever, "rho": 3, "sun": "u", "ring": "v", "carrier": "y"},  # y = (u + 3 v)/4
    }
    for node in ("u", "v"):
        elements |= {
            f"J_{node}": {"type": "inertia", "at": node, "J": "J"},
            f"b_{node}": {"type": "rotary_damper", "between": [node, "ground"], "b": "b"},
            f"k_{node}": {"type": "torsion_spring", "between": [node, "ground"], "k": "k"},
        }
    parameters = {"J": 1, "b": 2, "k": 5}
    model = Model(parameters=parameters, elements=elements, inputs={"M": {"torque": "x"}}, outputs={"Y": "y"})
    found = of(model)
    # Y = y [[1/2, 1/2], [1/2, 5/8]] with y = s/p.
    omega = np.linspace(0.01, 30, 300_001)
    y = 1j * omega / (5 - omega**2 + 2j * omega)
    eta = (0.625 * y.real**2 - (y**2).real / 4) / (abs(y) ** 2 / 4)
    assert found.passive is True and found.least is not None
    assert abs(float(found.least.value.mid()) - eta.min()) < 1e-4


def test_waves_that_a_controller_drives_are_not_decided() -> None:
    model = Model(
        parameters={"EA": 1, "rhoA": 1, "l": 1, "K": 1},
        elements={
            "rod": {"type": "rod", "between": ["x", "y"], "EA": "EA", "rhoA": "rhoA", "l": "l"},
            "act": {"type": "force_source", "at": "x", "f": "-K*y"},
        },
        inputs={"F": {"force": "x"}},
        outputs={"Y": "y"},
    )
    found = of(model)
    assert found.passive is None and found.reasons


def test_a_lagged_motor_at_the_end_of_a_rod_is_passive_with_enough_friction_there() -> None:
    # Re(b + K/(s (1 + s T))) is least at 0, b - K T, with K T = 2 * 0.5.
    def rod(b: float) -> Model:
        return Model(
            parameters={"EA": 1, "rhoA": 1, "l": 1, "K": 2, "T": 0.5, "b": b},
            elements={
                "rod": {"type": "rod", "between": ["x", "y"], "EA": "EA", "rhoA": "rhoA", "l": "l"},
                "act": {"type": "force_source", "at": "x", "f": "-K/(1 + T*s)*x"},
                "slide": {"type": "damper", "between": ["x", "ground"], "b": "b"},
            },
            inputs={"F": {"force": "x"}},
            outputs={"Y": "y"},
        )

    assert (of(rod(1)).passive, of(rod(1)).absolutely_stable) == (True, True)
    assert of(rod(0.99)).passive is None


def test_the_margin_of_an_amplifier_is_the_stability_factor_of_its_scattering_parameters() -> None:
    # Rollett (1962): K = (1 - |S11|^2 - |S22|^2 + |det S|^2)/(2 |S12 S21|) of any reference resistance.
    elements = {
        "r_b": {"type": "resistor", "between": ["b", "ground"], "R": "300 Ohm"},
        "c_b": {"type": "capacitor", "between": ["b", "ground"], "C": "12 pF"},
        "c_m": {"type": "capacitor", "between": ["b", "c"], "C": "2 pF"},
        "g_m": {
            "type": "vccs",
            "inputs": ["b", "ground"],
            "terminals": ["ground", "c"],
            "g": "40 mA/V",
        },
        "r_c": {"type": "resistor", "between": ["c", "ground"], "R": "90 Ohm"},
    }
    found = of(Model(elements=elements, inputs={"i": {"current": "b"}}, outputs={"v": "c"}), "b", "c")
    omega = np.geomspace(1e5, 1e12, 400_001)
    s, one = 1j * omega, np.eye(2)
    y = np.array([[1 / 300 + 14e-12 * s, -2e-12 * s], [0.04 - 2e-12 * s, 1 / 90 + 2e-12 * s]])
    y = np.moveaxis(50 * y, 2, 0)
    S = (one - y) @ np.linalg.inv(one + y)
    size = abs(S) ** 2
    factor = 1 - size[:, 0, 0] - size[:, 1, 1] + abs(np.linalg.det(S)) ** 2
    factor /= 2 * np.sqrt(size[:, 0, 1] * size[:, 1, 0])
    assert (found.absolutely_stable, found.least is None) == (factor.min() >= 1, False)
    assert found.least is not None
    assert float(found.least.value.mid()) == pytest.approx(factor.min(), rel=1e-6)
