"""How many zeros there are at most, where losses and loops leave no count of eigenvalues."""

from __future__ import annotations

import pytest

from symflex.roots.networks.blocks import most_zeros
from symflex.roots.networks.cramer import CramerEquations
from symflex.roots.region import Modes
from tests.unit.roots.networks.network_models import BEAM, equations_of, located, specification

SHAFT = 'type = "shaft", G = "80 GPa", J = "1e-8 m^4", rho = "7800 kg/m^3", eta = "1e-7 s"'
FLEXIBLE = [
    f's{i} = {{ {SHAFT}, between = ["{a}", "{b}"], l = "0.{3 + i} m" }}'
    for i, (a, b) in enumerate(("ab", "bc"))
]
TRAIN = (
    *FLEXIBLE,
    *(f'J_{x} = {{ type = "inertia", at = "{x}", J = "1e-3 kg*m^2" }}' for x in "abc"),
    'bearing = { type = "rotary_damper", between = ["b", "ground"], b = "0.1 N*m*s/rad" }',
)
ABSORBER = (
    'soft = { type = "torsion_spring", between = ["b", "d"], k = "100 N*m/rad" }',
    'loss = { type = "rotary_damper", between = ["b", "d"], b = "0.2 N*m*s/rad" }',
    'load = { type = "inertia", at = "d", J = "1e-2 kg*m^2" }',
)


def driven(*lines, output="c", more=""):
    return specification("\n".join(lines), 'F = { torque = "a" }', f'X = "{output}"') + more


def most(text):
    return most_zeros(CramerEquations.of(equations_of(text), "X", "F"))


@pytest.mark.parametrize(
    ("lines", "output", "expected"),
    [
        (TRAIN, "c", 0),
        (TRAIN, "s*c", 1),
        ((*TRAIN, *ABSORBER), "c", 2),
        (TRAIN, "b", None),  # the shaft behind it
        ((*TRAIN, f'branch = {{ {SHAFT}, between = ["b", "d"], l = "0.2 m" }}'), "c", None),
        ((*TRAIN, f'other = {{ {SHAFT}, between = ["a", "b"], l = "0.9 m" }}'), "c", None),
    ],
)
def test_zeros_of_trains_are_those_of_what_stands_beside_the_way(lines, output, expected):
    assert most(driven(*lines, output=output)) == expected


def test_a_loop_with_a_delay_adds_none_to_the_way():
    loop = 'loop = { type = "torque_source", at = "a", tau = "-K*D*c" }'
    text = driven(
        *TRAIN, loop, more='[parameters]\nK = "10 N*m/rad"\n[blocks]\nD = { type = "delay", T = "0.01 s" }\n'
    )
    assert most(text) == 0


def test_beams_may_have_infinitely_many_anywhere():
    beams = [
        f'b{i} = {{ {BEAM}, between = ["{s}", "{e}"], l = "1 m" }}' for i, (s, e) in enumerate(("za", "ac"))
    ]
    text = specification("\n".join(['clamp = { type = "fixed", at = "z" }', *beams]), outputs='X = "c"')
    assert most(text) is None


def test_a_train_with_losses_is_proved_to_have_no_zeros():
    found = located(driven(*TRAIN), Modes(3))
    assert found.certificate.certified
    assert found.zeros == ()


def test_the_zeros_of_an_absorber_are_all_there_are():
    found = located(driven(*TRAIN, *ABSORBER), Modes(4))
    assert found.certificate.certified
    # J s^2 + b s + k = 0: s = -10 +- j sqrt(10^4 - 10^2).
    assert [(float(z.re), abs(float(z.im))) for z in found.zeros] == [pytest.approx((-10, 9900**0.5))] * 2
