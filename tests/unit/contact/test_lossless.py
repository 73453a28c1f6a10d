"""What stores energy right at a port is taken away; all else stays."""

from symflex.contact.lossless import without_storage
from symflex.model.ports import port_named
from tests.unit.contact.machines import ARM, LAGGED, machine


def kept(text, name="tip"):
    model = machine(text)
    return [e.name for e in without_storage(model, port_named(model, name)).elements]


def test_a_mass_at_the_port_is_taken_away():
    assert kept(LAGGED) == ["friction", "motor"]


def test_a_mass_whose_force_is_measured_stays():
    assert "body" in kept(LAGGED.replace('X = "x"', 'X = "body.f"'))


def test_a_body_at_the_port_keeps_its_moment_of_inertia():
    load = 'load = { type = "rigid_body", at = "tip", m = "1 kg", J = "2 kg*m^2" }'
    model = machine(ARM.replace("servo =", f"{load}\nservo ="))
    bare = without_storage(model, port_named(model, "tip"))
    load = next(e for e in bare.elements if e.name == "load")
    assert [str(dict(load.values)[n].value) for n in ("m", "J")] == ["0", "2"]
