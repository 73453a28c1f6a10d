"""What is hidden where wavenumbers vanish or meet, against motions without strain that are known there.

A free slender beam on a foundation moves without strain, w = a + b x, where rho A s^2 + c_f s + k_f = 0. A
force at one end, with the motion there as output, sees one of these motions; the turn about that end is
hidden.
Axial force and rotary inertia resist the turn, not the translation.
"""

from fractions import Fraction
from math import inf
from types import SimpleNamespace

from flint import acb

from symflex import pipeline
from symflex.roots import Band
from symflex.roots.degenerate import DegeneratePoints, degenerate_points, roots_about
from symflex.roots.locate import locate
from tests.unit.roots.stand_ins import places

BEAM = """
symflex = 1
[elements]
b = {{ type = "beam", between = ["a", "c"], EI = 4, rhoA = 2, l = 1, {more} }}
{ends}
[inputs]
F = {{ {load} }}
[outputs]
Y = "{output}"
"""


def bound(more="k_f = 18", load='force = "a.y"', output="a.y", ends=""):
    model = pipeline.loads(BEAM.format(more=more, load=load, output=output, ends=ends))
    return pipeline.derive_bound(model, model.transfer_functions)[0]


def hidden(function, place):
    """Return how many modes are hidden at a degenerate point."""
    points = DegeneratePoints(function, degenerate_points(function))
    (here,) = [p for p in points.distinct if abs(complex(p) - place) < 1e-9]
    assert not points.unproved
    return sum(h.root.multiplicity for h in points.hidden([here]))


def test_motions_without_strain_that_input_or_output_do_not_see_are_hidden():
    pinned = 'p = { type = "pin", at = "a" }'
    damped = complex(-1, 8**0.5)
    for given, place, expected in [
        ((), 3j, 1), (("k_f = 18", 'force = "a.y"', "c.y"), 3j, 1),
        (("k_f = 18", 'torque = "a.theta"', "a.theta"), 3j, 1),
        (("k_f = 18", 'force = "a.y"', "a.y", 'm = { type = "mass", at = "c.y", m = 1 }'), 3j, 0),
        (("k_f = 18", 'torque = "a.theta"', "a.theta", pinned), 3j, 0), (("k_f = 18, N = 3",), 3j, 0),
        (('k_f = 18, theory = "rayleigh", rhoI = 0.1',), 3j, 0), (("k_f = 18, c_f = 4",), damped, 1),
        (("k_f = 18, c_f = 4, eta = 0.01",), damped.conjugate(), 1), (("c_f = 4",), -2, 1),
    ]:  # fmt: skip
        assert hidden(bound(*given), place) == expected, given


def test_an_elbow_on_a_foundation_hides_two_of_its_three_motions_as_a_rigid_body():
    # A force along x at the elbow moves it along x alone: motion along y and the turn about it are hidden.
    member = 'type = "frame", EI = 4, EA = 50, rhoA = 2, l = 1, k_f = 18'
    model = pipeline.loads(
        f'symflex = 1\n[elements]\na = {{ {member}, between = ["p", "q"] }}\n'
        f'b = {{ {member}, between = ["q", "r"], angle = "pi/2" }}\n'
        '[inputs]\nF = { force = "q.x" }\n[outputs]\nX = "q.x"\n'
    )
    assert hidden(pipeline.derive_bound(model, model.transfer_functions)[0], 3j) == 2


def test_sections_that_turn_alike_at_the_cut_off_frequency_are_hidden_from_a_force():
    # Pinned ends: w = 0, phi = 1 at kappa G A = -rho I s^2 does no work with a force across.
    more = 'theory = "timoshenko", rhoI = 2, kappaGA = 18'
    ends = 'p = { type = "pin", at = "a" }\nq = { type = "pin", at = "c" }'
    assert hidden(bound(more, 'torque = "a.theta"', "a.theta", ends), 3j) == 0
    halves = BEAM.replace('"c"], EI', '"m"], EI') + 'Z = "m.y"\n'
    second = f'r = {{ type = "beam", between = ["m", "c"], EI = 4, rhoA = 2, l = 1, {more} }}\n{ends}'
    model = pipeline.loads(halves.format(more=more, load='force = "m.y"', output="m.y", ends=second))
    for function in pipeline.derive_bound(model, model.transfer_functions[:1]):
        assert hidden(function, 3j) == 1


def test_a_hidden_turn_is_listed_among_the_roots_with_its_place_and_in_the_verdict():
    found = locate(bound(), Band(Fraction("0.4"), Fraction("0.5")), 15)
    assert places(h.root for h in found.hidden) == [(0, 3, 1), (0, -3, 1)]
    assert places(found.poles) == [(0, 3, 1), (0, -3, 1)]
    assert found.certificate.certified


def test_roots_are_not_counted_about_a_point_next_to_which_no_bound_is_known():
    # As next to a pole of a member's stiffness.
    one = SimpleNamespace(den=acb(1), num=acb(1))
    unbounded = SimpleNamespace(bounds_on=lambda _: (inf, inf), at=lambda *_: one)
    assert roots_about(unbounded, acb(-2)) == (None, None)
