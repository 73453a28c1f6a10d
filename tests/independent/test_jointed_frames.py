"""Frames with joints and material damping, of which no closed form fits into memory, against numbers."""

from functools import partial

import pytest
from mpmath import findroot, mp, mpc, mpf, pi

from symflex import pipeline
from symflex.errors import BudgetError
from symflex.roots import Modes
from symflex.transfer import NestedTransferFunction
from tests.independent.plane_frames import Member, freedoms, pinned, response, stiffness

WALL = mpf("0.06") ** 2 - mpf("0.052") ** 2, (mpf("0.06") ** 4 - mpf("0.052") ** 4) / 12
ETA = mpf("5e-6")
HEAD = """
definitions = { A = "b^2 - (b - 2*t)^2", I = "(b^4 - (b - 2*t)^4)/12" }
[parameters]
E = "70 GPa"
rho = "2700 kg/m^3"
b = "60 mm"
t = "4 mm"
l_1 = "0.8 m"
l_2 = "0.6 m"
l_3 = "0.5 m"
k_1 = "40 kN*m/rad"
k_2 = "15 kN*m/rad"
m = "6 kg"
J = "0.01 kg*m^2"
eta = "5 us"
"""
LINKS = """
shoulder = { type = "pin", at = "a" }
gear_1 = { type = "torsion_spring", between = ["a.theta", "ground"], k = "k_1" }
motor = { type = "rigid_body", at = "b", m = "m", J = "J" }
hinge = { type = "pin", between = ["b", "h"] }
gear_2 = { type = "torsion_spring", between = ["b.theta", "h.theta"], k = "k_2" }
payload = { type = "rigid_body", at = "c", m = "m", J = "J" }
"""
TWO_LINKS = (LINKS, [("a", "b", 50, 1), ("h", "c", -20, 2)])
FOUR_BAR = (
    'a_pin = { type = "pin", at = "a" }\nd_pin = { type = "pin", at = "d" }\n'
    'gear = { type = "torsion_spring", between = ["a.theta", "ground"], k = "k_1" }\n'
    'motor = { type = "rigid_body", at = "b", m = "m", J = "J" }\n'
    'b_pin = { type = "pin", between = ["b", "h"] }\n'
    'c_pin = { type = "pin", between = ["c", "g"] }\n',
    [("a", "b", 80, 2), ("h", "c", 10, 1), ("d", "g", 60, 3)],
)
PORTAL = (
    'a_pin = { type = "pin", at = "a" }\nd_pin = { type = "pin", at = "d" }\n'
    'load = { type = "rigid_body", at = "c", m = "m", J = "J" }\n',
    [("a", "b", 90, 1), ("b", "c", 0, 2), ("d", "c", 90, 1)],
)
HINGES = {"h": "b'", "g": "c'"}
"""What the reference calls a joint that shares the translations of another."""


def written(kind, loss="eta"):
    """Return a specification of a kind of frame."""
    joints, bars = kind
    frames = "".join(
        f'bar_{i} = {{ type = "frame", between = ["{p}", "{q}"], angle = "{angle} deg", E = "E", I = "I", '
        f'rho = "rho", A = "A", l = "l_{n}"{f", eta = {chr(34)}{loss}{chr(34)}" if loss else ""} }}\n'
        for i, (p, q, angle, n) in enumerate(bars)
    )
    ends = '[inputs]\nF = { force = "c.x" }\n[outputs]\nX = "c.x"\nY = "b.y"\n'
    return f"symflex = 1\n{HEAD}[elements]\n{joints}{frames}{ends}"


def members(kind, s):
    """Return the same bars, with the modulus at s."""
    lengths = {1: mpf("0.8"), 2: mpf("0.6"), 3: mpf("0.5")}
    area, inertia = WALL
    return [
        Member(
            HINGES.get(p, p),
            HINGES.get(q, q),
            mpf("70e9") * (1 + ETA * s),
            inertia,
            area,
            mpf(2700),
            lengths[n],
            angle * pi / 180,
        )
        for p, q, angle, n in kind[1]
    ]


def added(kind, s):
    """Return what springs and bodies add to the stiffness."""
    found = {}

    def add(first, second, value):
        found[first, second] = found.get((first, second), 0) + value

    bodies = {"two": "bc", "four": "b", "portal": "c"}[name_of(kind)]
    for joint in bodies:
        for component, inertia in (("x", 6), ("y", 6), ("theta", mpf("0.01"))):
            add((joint, component), (joint, component), inertia * s**2)
    if kind is not PORTAL:
        add(("a", "theta"), ("a", "theta"), 40_000)
    if kind is TWO_LINKS:
        for p, q in (("b", "b'"), ("b'", "b")):
            add((p, "theta"), (p, "theta"), 15_000)
            add((p, "theta"), (q, "theta"), -15_000)
    return found


def name_of(kind):
    return "two" if kind is TWO_LINKS else "four" if kind is FOUR_BAR else "portal"


def held(kind):
    return pinned("a") if kind is TWO_LINKS else pinned("a", "d")


def determinant(kind, s):
    """Return the determinant of the dynamic stiffness of what is free."""
    bars = members(kind, s)
    whole = stiffness(bars, s, added(kind, s))
    kept = [i for i, freedom in enumerate(freedoms(bars)) if freedom not in held(kind)]
    return mp.det(mp.matrix([[whole[i, j] for j in kept] for i in kept]))


@pytest.mark.slow
@pytest.mark.parametrize("kind", [TWO_LINKS, FOUR_BAR, PORTAL], ids=name_of)
def test_a_jointed_frame_with_loss_has_the_response_and_poles_of_its_dynamic_stiffness(kind):
    model = pipeline.loads(written(kind))
    functions = pipeline.derive_for_roots(model, model.transfer_functions)
    for k in range(20):
        s = mpc(0, 30 * mpf("1.4") ** k)
        for function, shown in zip(functions, (("c", "x"), ("b", "y")), strict=True):
            expected = response(members(kind, s), held(kind), ("c", "x"), shown, s, added(kind, s))
            assert abs(function(complex(s)) / expected - 1) < 1e-11
    found = pipeline.roots(functions[0], Modes(4))
    assert found.certificate.certified and found.verdict.word == "stable"
    upper = [p for p in found.poles if p.im > 0]
    assert len(upper) == 4
    with mp.workdps(30):
        for pole in upper:
            # From three digits of it the reference finds its own.
            exact = complex(float(pole.re.mid()), float(pole.im.mid()))
            start = complex(f"{exact.real:.3g}{exact.imag:+.3g}j")
            other = findroot(partial(determinant, kind), (start, start * 1.001), verify=False)
            assert abs(complex(other) - exact) < 1e-9 * abs(exact)


@pytest.mark.parametrize("loss", ["eta", ""])
def test_a_jointed_frame_is_nested_unasked_and_refused_expanded(loss):
    """A determinant of 26,541 terms, of which the estimate says 480: one link's motion is the other's."""
    model = pipeline.loads(written(TWO_LINKS, loss))
    pairs = model.transfer_functions[:1]
    (found,), reason = pipeline.derive_as(model, pairs, is_read=True)
    assert isinstance(found, NestedTransferFunction) and "5000 terms" in reason
    with pytest.raises(BudgetError, match=r"SF502.*10000 terms"):
        pipeline.derive_all(model, pairs)


def test_what_opens_to_too_many_terms_is_refused_before_it_is_made():
    """A portal frame: 994 terms with sums closed, 160,941 without."""
    model = pipeline.loads(written(PORTAL))
    with pytest.raises(BudgetError, match=r"SF502.*50000 terms"):
        pipeline.derive_all(model, model.transfer_functions[:1])
