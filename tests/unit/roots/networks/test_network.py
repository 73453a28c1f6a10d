"""What is an undamped network, where its powers of s stand, and how many zeros its paths leave."""

import pytest

from symflex import pipeline
from symflex.roots.networks.blocks import most_zeros
from symflex.roots.networks.cramer import CramerEquations
from symflex.roots.networks.network import OtherNetworkError
from symflex.roots.passivity import energy_proof
from tests.unit.roots.networks.network_models import BEAM, equations_of, network, specification

TWO = f"""
one = {{ {BEAM}, between = ["ground", "a"], l = "0.4 m" }}
two = {{ {BEAM}, between = ["a", "b"], l = "0.3 m" }}
"""


def test_what_loses_energy_has_negative_inertia_or_a_loop_is_refused():
    for elements, reason in [
        ('d = { type = "damper", between = ["a.y", "ground"], b = "1 N*s/m" }', "loses"),
        ('m = { type = "mass", at = "b.y", m = "-1 kg" }', "inertia is negative"),
        (f'e = {{ {BEAM}, between = ["b", "c"], l = "1 m", eta = "1 us" }}', r"loses|polynomial"),
        ('f = { type = "force_source", at = "b.y", f = "-k*a.y" }\n[parameters]\nk = "3 N/m"', "loop"),
    ]:
        with pytest.raises(OtherNetworkError, match=reason):
            network(specification(TWO + elements))


def test_springs_levers_and_links_are_taken_and_masses_beside_a_point_are_no_negative_inertia():
    parts = """
    k = { type = "spring", between = ["a.y", "ground"], k = "-10 N/m" }
    m = { type = "mass", at = "b.y", m = "1 kg" }
    body = { type = "rigid_body", at = "b", m = "1 kg", J = "1 kg*m^2", cg = "0.3 m" }
    link = { type = "rigid_link", between = ["b", "c"], length = "0.1 m" }
    lever = { type = "transformer", from = "c.y", to = "d", ratio = "-2" }
    soft = { type = "massless_beam", between = ["c", "ground"], EI = "3 N*m^2", l = "0.2 m" }
    """
    found = network(specification(TWO + parts))
    assert found.is_colocated
    assert not energy_proof(pipeline.loads(specification(TWO + parts))).is_passive
    body = 'body = { type = "rigid_body", at = "b", m = "1 kg", J = "0 kg*m^2", cg = "0.3 m" }'
    assert network(specification(TWO + body)).is_colocated


def test_a_rate_is_read_as_a_power_of_s():
    for output, above in [("a.y", 0), ("s*a.y", 1), ("3*s^2*a.y", 2)]:
        found = network(specification(TWO, outputs=f'X = "{output}"'))
        assert (found.below, found.above) == (0, above), output
        assert found.is_colocated, output


def test_what_is_told_or_read_elsewhere_is_found():
    # A velocity puts a power of s below; a signal that nothing hears is put in its place.
    assert network(specification(TWO, 'v = { velocity = "b" }', 'X = "b.y"'), source="v").below == 1
    assert not network(specification(TWO, outputs='X = "b"')).is_colocated
    text = specification(TWO, 'F = { force = "a" }\n[signals]\nv = "2*a.y"', 'X = "v"')
    assert network(text).is_colocated


# -------------------------------------------------------------------- how many zeros there are at most


SHAFT = 'type = "shaft", G = "80 GPa", J = "1e-8 m^4", rho = "7800 kg/m^3", eta = "1e-7 s"'
FLEXIBLE = [
    f's{i} = {{ {SHAFT}, between = ["{a}", "{b}"], l = "0.{3 + i} m" }}'
    for i, (a, b) in enumerate(("ab", "bc"))
]
SHAFTS = (
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


def test_zeros_of_trains_are_those_of_what_stands_beside_the_way_and_loops_add_none():
    for lines, output, expected in [
        (SHAFTS, "c", 0),
        (SHAFTS, "s*c", 1),
        ((*SHAFTS, *ABSORBER), "c", 2),
        (SHAFTS, "b", None),  # the shaft behind it
        ((*SHAFTS, f'branch = {{ {SHAFT}, between = ["b", "d"], l = "0.2 m" }}'), "c", None),
        ((*SHAFTS, f'other = {{ {SHAFT}, between = ["a", "b"], l = "0.9 m" }}'), "c", None),
    ]:
        assert most(driven(*lines, output=output)) == expected
    loop = 'loop = { type = "torque_source", at = "a", tau = "-K*D*c" }'
    text = driven(
        *SHAFTS, loop, more='[parameters]\nK = "10 N*m/rad"\n[blocks]\nD = { type = "delay", T = "0.01 s" }\n'
    )
    assert most(text) == 0
    beams = [
        f'b{i} = {{ {BEAM}, between = ["{s}", "{e}"], l = "1 m" }}' for i, (s, e) in enumerate(("za", "ac"))
    ]
    text = specification("\n".join(['clamp = { type = "fixed", at = "z" }', *beams]), outputs='X = "c"')
    assert most(text) is None
