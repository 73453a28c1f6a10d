"""The frames of ``derivations/frames``, against dynamic stiffness matrices and published frequencies."""

from pathlib import Path

import pytest
from mpmath import mp, mpf, pi

from symflex import pipeline
from symflex.roots import Modes
from symflex.transfer import NestedTransferFunction, TransferFunction
from tests.independent.classics import values
from tests.independent.plane_frames import Member, clamped, pinned, response

FOLDER = Path(__file__).parents[2] / "derivations" / "frames"
POINTS = (20 + 90j, 400j, -30 + 2000j)


def agrees(name, members, held, freedom):
    """Tell whether the driving point of a model is that of a dynamic stiffness."""
    model = pipeline.load(FOLDER / f"{name}.toml")
    (bound,) = pipeline.derive_bound(model, model.transfer_functions[:1])
    return all(abs(bound(s) / response(members, held, freedom, freedom, s) - 1) < 1e-11 for s in POINTS)


def given(name):
    with mp.workdps(30):
        return values(FOLDER / f"{name}.toml")


def section(v):
    """Return what a member of square section is made of."""
    return {"E": v["E"], "I": v["a"] ** 4 / 12, "A": v["a"] ** 2, "rho": v["rho"], "l": v["l"]}


def test_the_l_frame_moves_as_its_dynamic_stiffness_says():
    v = section(given("l_frame"))
    members = [Member("a", "b", **v, angle=pi / 2), Member("b", "c", **v)]
    assert agrees("l_frame", members, clamped("a"), ("c", "y"))


def test_the_portal_frame_moves_as_its_dynamic_stiffness_says():
    v = {k: x for k, x in given("portal_frame").items() if k != "F"}
    members = [
        Member("a", "p", **v, angle=pi / 2),
        Member("b", "q", **v, angle=pi / 2),
        Member("p", "q", **v),
    ]
    assert agrees("portal_frame", members, clamped("a", "b"), ("p", "x"))


def test_a_formula_of_pages_is_shown_in_steps_and_given_to_programs_whole():
    model = pipeline.load(FOLDER / "portal_frame.toml")
    (shown,), reason = pipeline.derive_as(model, [("x", "F")], is_read=True)
    assert isinstance(shown, NestedTransferFunction) and "--representation expanded" in reason
    (given_on,), _ = pipeline.derive_as(model, [("x", "F")])
    assert isinstance(given_on, TransferFunction)
    (read,), reason = pipeline.derive_as(
        pipeline.load(FOLDER / "l_frame.toml"), [("y_tip", "F")], is_read=True
    )
    assert isinstance(read, TransferFunction) and not reason


@pytest.mark.slow
def test_the_sway_of_the_portal_frame_is_below_thomson_s_bound():
    """Example 10.5-4: 3.21 with one element a member and no stretching, which both raise it."""
    model = pipeline.load(FOLDER / "portal_frame.toml")
    found = pipeline.roots(pipeline.derive_bound(model, [("x", "F")])[0], Modes(1))
    v = given("portal_frame")
    unit = mp.sqrt(v["E"] * v["I"] / (v["rho"] * v["A"])) / v["l"] ** 2
    (sway,) = (mpf(str(float(p.im.mid()))) / unit for p in found.poles if p.im > 0)
    assert mpf("0.99") * mpf("3.21") < sway < mpf("3.21")


def test_the_pin_ended_cross_moves_as_its_dynamic_stiffness_says():
    v = section(given("pin_ended_cross"))
    members = [Member("c", f"e{i}", **v, angle=i * pi / 2) for i in range(4)]
    held = pinned(*(f"e{i}" for i in range(4)))
    assert agrees("pin_ended_cross", members, held, ("c", "x"))


@pytest.mark.slow
def test_the_elbow_of_the_two_link_arm_turns_as_its_dynamic_stiffness_says():
    """The motor is a damper k_t^2/R between the links, and its voltage a torque k_t v/R on both."""
    v = given("two_link_arm")
    link = {k: v[k] for k in ("E", "I", "A", "rho", "l")}
    members = [Member("a", "b", **link), Member("b'", "c", **link, angle=pi / 2)]
    elbow, fore = ("b", "theta"), ("b'", "theta")

    def added(s):
        damper = v["k_t"] ** 2 * s / v["R"]
        motor = {(elbow, elbow): damper, (fore, fore): damper, (elbow, fore): -damper, (fore, elbow): -damper}
        hub = {(("a", "theta"), ("a", "theta")): v["J"] * s**2}
        return motor | hub | {(("c", c), ("c", c)): v["m"] * s**2 for c in ("x", "y")}

    model = pipeline.load(FOLDER / "two_link_arm.toml")
    (bound,) = pipeline.derive_bound(model, [("theta_2", "v")])
    for s in POINTS:
        turned = {
            (at, load): response(members, pinned("a"), load, at, s, added(s))
            for at in (elbow, fore)
            for load in (elbow, fore)
        }
        relative = turned[fore, fore] - turned[fore, elbow] - turned[elbow, fore] + turned[elbow, elbow]
        assert abs(bound(s) / (float(v["k_t"] / v["R"]) * relative) - 1) < 1e-11
