"""Mode shapes of plane frames: where members lie, and what is 1."""

import functools

import pytest

from symflex import pipeline
from symflex.analysis.modes import lowest_modes
from symflex.figures.runs import Plan, panels_of

STEEL = 'E = "210 GPa", I = "1e-8 m^4", A = "1e-4 m^2", rho = "7800 kg/m^3", l = "0.5 m"'


@functools.cache
def shapes(elements, count=2):
    text = f'symflex = 1\n[elements]\n{elements}\n[inputs]\nF = {{ force = "p.x" }}\n[outputs]\nX = "p.x"\n'
    model = pipeline.loads(text)
    found, _ = lowest_modes(pipeline.derive_bound(model, [("X", "F")])[0], count, None)
    return model, [each.shape for each in found]


def member(name, first, second, angle=0):
    return (
        f'{name} = {{ type = "frame", between = ["{first}", "{second}"], {STEEL}, angle = "{angle} deg" }}\n'
    )


PORTAL = member("left", "ground", "p", 90) + member("right", "ground", "q", 90) + member("beam", "p", "q")


@pytest.mark.slow
def test_members_are_placed_by_their_lengths_and_directions():
    (plan,) = panels_of(*shapes(PORTAL))
    assert isinstance(plan, Plan)
    placed = {name: (round(x, 12), round(y, 12)) for name, x, y in plan.members}
    assert placed == {"left": (0, 0), "beam": (0, 0.5), "right": (0.5, 0)}


@pytest.mark.slow
def test_what_a_hinge_joins_is_drawn_at_one_place():
    hinged = member("one", "ground", "p") + member("two", "h", "q", 90)
    hinged += (
        'hinge = { type = "pin", between = ["p", "h"] }\nload = { type = "rigid_body", at = "q", m = 1 }\n'
    )
    (plan,) = panels_of(*shapes(hinged, 1))
    assert [(name, round(x, 12), round(y, 12)) for name, x, y in plan.members] == [
        ("one", 0, 0),
        ("two", 0.5, 0),
    ]
    assert [(node, round(x, 12), round(y, 12)) for node, x, y in plan.loaded] == [("q", 0.5, 0.5)]


@pytest.mark.slow
def test_the_largest_displacement_of_a_frame_is_that_along_x_or_y():
    """The sway of a portal moves its corners most, its symmetric mode the middle of the beam."""
    _, (sway, symmetric) = shapes(PORTAL)
    assert float(abs(sway.motion("p.x").value.mid()).mid()) == pytest.approx(1, abs=2e-3)
    assert symmetric.reference == "beam.y(0.25)"


@pytest.mark.slow
def test_along_a_member_the_shape_is_given_along_the_axes_of_the_plane():
    _, (bending,) = shapes(member("left", "ground", "p", 90) + member("arm", "p", "q"), 1)
    left = bending.along("left")
    assert left.states == ("x", "y", "theta", "f_x", "f_y", "tau")
    end = left.state_at_share(1)
    assert end[0].overlaps(bending.motion("p.x").value)
    assert end[1].overlaps(bending.motion("p.y").value)
