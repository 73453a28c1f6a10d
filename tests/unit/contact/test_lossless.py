"""What stores energy right at a port is taken away; all else stays."""

from math import acos, pi

import pytest

from symflex import pipeline
from symflex.contact.lossless import without_ladder, without_storage
from symflex.contact.passivity import find_passivity
from symflex.contact.real_part import real_part
from symflex.model.ports import port_named
from tests.unit.contact.machines import ARM, LAGGED, machine


def kept(text, name="tip"):
    model = machine(text)
    return [e.name for e in without_storage(model, port_named(model, name)).elements]


def test_a_mass_at_the_port_is_taken_away():
    assert kept(LAGGED) == ["friction", "motor"]


def test_a_mass_at_the_deflection_of_a_planar_node_is_at_its_port():
    load = 'load = { type = "mass", at = "tip.y", m = "1 kg" }'
    assert "load" not in kept(ARM.replace("servo =", f"{load}\nservo ="))


def test_a_mass_whose_force_is_measured_stays():
    assert "body" in kept(LAGGED.replace('X = "x"', 'X = "body.f"'))


def test_a_body_at_the_port_keeps_its_moment_of_inertia():
    load = 'load = { type = "rigid_body", at = "tip", m = "1 kg", J = "2 kg*m^2" }'
    model = machine(ARM.replace("servo =", f"{load}\nservo ="))
    bare = without_storage(model, port_named(model, "tip"))
    load = next(e for e in bare.elements if e.name == "load")
    assert [str(dict(load.values)[n].value) for n in ("m", "J")] == ["0", "2"]


WALL = """symflex = 1
parameters = { m = "0.3 kg", b = "0.7 N*s/m", K = "1 kN/m", T = "1 ms" }
[equations]
unknowns = ["x"]
equations = ["m*s^2*x + b*s*x + K*exp(-s*T/2)*x = F"]
[inputs]
F = { unit = "N" }
[outputs]
V = "s*x"
[ports]
hand = { force = "F", velocity = "V" }
"""


@pytest.mark.parametrize(("stiffness", "is_passive"), [("1.39 kN/m", True), ("1.41 kN/m", False)])
def test_a_wall_behind_a_mass_in_equations_is_passive_up_to_its_damping_over_half_a_period(
    stiffness, is_passive
):
    # Re Z = b - K sin(omega T/2)/omega, which is negative next to 0 where K T/2 > b.
    model = pipeline.loads(WALL.replace("1 kN/m", stiffness))
    assert find_passivity(model, "hand", is_explained=False).passive is is_passive


def test_a_filter_between_a_delayed_current_loop_and_the_grid_leaves_its_bands_where_they_are():
    # A converter with an LCL filter: Re Z has the sign of R + K cos(omega T), however far out.
    text = """symflex = 1
[inputs]
i = {}
[outputs]
v = "(s*3/5000 + 1/(s/100000 + 1/(s*9/5000 + 1/20 + 6*exp(-s*3/20000))))*i"
"""
    (impedance,) = pipeline.derive_bound(pipeline.loads(text), [("v", "i")])
    bands = real_part(without_ladder(impedance), 12).active
    corner = acos(-0.05 / 6)
    for k, band in enumerate(bands[:5]):
        ends = (corner + 2 * pi * k, 2 * pi * (k + 1) - corner)
        assert [float(x.mid()) * 1.5e-4 for x in (band.low, band.high)] == pytest.approx(ends)
    assert len(bands) >= 5
