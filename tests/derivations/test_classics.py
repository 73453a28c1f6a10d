"""The classic beams, rods and shafts: poles, mode shapes and static limits known from elsewhere."""

import functools
from pathlib import Path

import mpmath
import pytest
from mpmath import cos, cosh, mp, mpc, mpf, pi, sin, sinh, sqrt

import symflex
from tests.independent import classics
from tests.independent.classics import clamped_clamped, clamped_free
from tests.independent.spec_expressions import distance_to_root

FOLDER = Path(__file__).parents[2] / "derivations" / "classics"
RELATIVE = mpf(10) ** -28
"""How well a denominator printed by the program knows its root: far beyond double precision."""


@functools.cache
def derived(name, tf):
    return symflex.load(FOLDER / f"{name}.toml").transfer_function(*tf.split("/"))


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(classics.DIGITS):
        yield


@functools.cache
def values(name):
    return classics.values(FOLDER / f"{name}.toml")


@functools.cache
def printed(name, tf):
    return derived(name, tf).to_json_dict()  # what derive --json prints


def newton_step(name, tf, part, s):
    found = printed(name, tf)
    return distance_to_root(found[part], values(name), found["where"], s)


# --------------------------------------------------------------------------------------- natural frequencies


def beam_mode(name, wavenumber):
    return mpc(0, classics.beam_frequency(wavenumber, values(name)))


def rod_mode(k):
    v = values("rod_tip_mass")
    return mpc(0, classics.rod_with_mass(k, v) / v["l"] * sqrt(v["E"] / v["rho"]))


def shaft_mode(k):
    v = values("shaft_discs")
    return mpc(0, classics.shaft_with_discs(k, v) / v["l"] * sqrt(v["G"] / v["rho"]))


def timoshenko_mode(k):
    guess = (3300, 17900, 42600, 70800)[k - 1]
    return mpc(0, classics.timoshenko_cantilever(guess, values("timoshenko_cantilever")))


def arm_mode(k):
    v = values("one_link_arm")
    wavenumber = classics.one_link_arm(("3.03", "4.74", "7.35", "10.37")[k - 1], v)
    return beam_mode("one_link_arm", wavenumber)


def damped_mode(k):
    guess = ((-1, 32), (-1, 250), (-6, 759), (-24, 1551))[k - 1]
    return classics.loaded_cantilever(mpc(*guess), values("kelvin_voigt_cantilever"))


POLES = {
    ("clamped_free", "W_tip/F"): ((1, 2, 5), lambda k: beam_mode("clamped_free", clamped_free(k))),
    # A uniform load at the middle drives and shows symmetric modes only.
    ("clamped_clamped", "W_mid/p"): ((1, 3, 5), lambda k: beam_mode("clamped_clamped", clamped_clamped(k))),
    ("free_free", "A_far/F"): ((1, 2, 5), lambda k: beam_mode("free_free", clamped_clamped(k))),
    ("pinned_pinned", "theta_far/tau"): ((1, 2, 5), lambda k: beam_mode("pinned_pinned", k * pi)),
    ("sliding_sliding", "V_far/F"): ((1, 2, 5), lambda k: beam_mode("sliding_sliding", k * pi)),
    ("rod_tip_mass", "X_tip/F"): ((1, 2, 5), rod_mode),
    ("shaft_discs", "angle_2/tau"): ((1, 2, 5), shaft_mode),
    ("timoshenko_cantilever", "W_tip/F"): ((1, 2, 4), timoshenko_mode),
    ("one_link_arm", "y_tip/tau"): ((1, 2, 4), arm_mode),
    ("kelvin_voigt_cantilever", "X_tip/F"): ((1, 2, 4), damped_mode),
}
"""For each transfer function, the numbers of some modes and the function that returns their poles."""
SEARCHED = ("rod_tip_mass", "timoshenko_cantilever", "one_link_arm", "kelvin_voigt_cantilever")
"""Whose poles no table of ``test_published_roots`` has."""


@pytest.mark.slow
def test_printed_denominators_vanish_at_poles():
    steps = {
        (name, k): newton_step(name, tf, "den", pole(k))
        for (name, tf), (modes, pole) in POLES.items()
        for k in modes
    }
    assert {at: step for at, step in steps.items() if not step < RELATIVE} == {}
    # A first mode's digits are those that are published, and a numerator does not vanish there.
    assert abs(clamped_free(1) - mpf(classics.CLAMPED_FREE)) < mpf(10) ** -30
    assert abs(clamped_clamped(1) - mpf(classics.CLAMPED_CLAMPED)) < mpf(10) ** -30
    first = beam_mode("clamped_free", clamped_free(1))
    assert newton_step("clamped_free", "W_tip/F", "num", first) > mpf("1e-3")


@pytest.mark.parametrize("case", [case for case in POLES if case[0] in SEARCHED], ids="-".join)
def test_the_bound_function_finds_the_poles(case):
    modes, pole = POLES[case]
    found = [complex(root) for root in derived(*case).bind().poles(modes=max(modes) + 1)]
    for k in modes:
        expected = complex(pole(k))
        assert min(abs(root - expected) for root in found) < 1e-11 * abs(expected), k


# ----------------------------------------------------------------------------------------------- mode shapes


def cantilever_shape(x, xi):
    """Return the mode of wavenumber x at xi = x/l (Blevins 1979, table 8-1)."""
    sigma = (sinh(x) - sin(x)) / (cosh(x) + cos(x))
    return cosh(x * xi) - cos(x * xi) - sigma * (sinh(x * xi) - sin(x * xi))


def clamped_shape(x, xi):
    """Return the mode of a beam clamped at both ends (Blevins 1979, table 8-1)."""
    sigma = (cosh(x) - cos(x)) / (sinh(x) - sin(x))
    return cosh(x * xi) - cos(x * xi) - sigma * (sinh(x * xi) - sin(x * xi))


def slope_at_the_tip(k):
    x = clamped_free(k)
    return mpmath.diff(lambda xi: cantilever_shape(x, xi), 1) / cantilever_shape(x, 1)  # l = 1 m


def moment_at_the_root(k):
    # E I w''(0) = E I beta^2 (-1)^(k+1) w(l): the mode is its own second derivative, read from the other end.
    v = values("clamped_free")
    return v["E"] * v["I"] * (clamped_free(k) / v["l"]) ** 2 * (-1) ** (k + 1)


def tension_at_the_wall(k):
    # u = sin(x xi)/sin x: tension E A x/(l sin x) at the wall, which the rod pulls backwards.
    v = values("rod_tip_mass")
    x = classics.rod_with_mass(k, v)
    return v["E"] * v["A"] * x / (v["l"] * sin(x))


def second_disc(k):
    v = values("shaft_discs")
    x = classics.shaft_with_discs(k, v)
    return cos(x) - v["J_1"] / (v["rho"] * v["J"] * v["l"]) * x * sin(x)


def at(name):
    return next(pole for (model, _), (_, pole) in POLES.items() if model == name)


# (model, output, other output, input): modes, and the ratio of both outputs at the pole, what the mode has.
SHAPES = {
    ("clamped_free", "W_mid", "W_tip", "F"): (
        range(1, 5),
        lambda k: cantilever_shape(clamped_free(k), mpf("0.5")) / cantilever_shape(clamped_free(k), 1),
    ),
    ("clamped_free", "slope_tip", "W_tip", "F"): (range(1, 5), slope_at_the_tip),
    ("clamped_free", "M_root", "W_tip", "F"): (range(1, 5), moment_at_the_root),
    ("clamped_clamped", "W_quarter", "W_mid", "p"): (
        (1, 3, 5),
        lambda k: (
            clamped_shape(clamped_clamped(k), mpf("0.25")) / clamped_shape(clamped_clamped(k), mpf("0.5"))
        ),
    ),
    ("free_free", "A_far", "A_near", "F"): (range(1, 6), lambda k: (-1) ** (k + 1)),
    ("pinned_pinned", "theta_far", "theta_near", "tau"): (range(1, 6), lambda k: (-1) ** k),
    ("sliding_sliding", "V_far", "V_near", "F"): (range(1, 6), lambda k: (-1) ** k),
    ("sliding_sliding", "V_mid", "V_near", "F"): (range(1, 6), lambda k: cos(k * pi / 2)),
    ("rod_tip_mass", "F_wall", "X_tip", "F"): (range(1, 6), tension_at_the_wall),
    ("shaft_discs", "angle_2", "angle_1", "tau"): (range(1, 6), second_disc),
}


@pytest.mark.slow
def test_outputs_move_beside_each_other_as_the_modes_say():
    wrong = {}
    for (name, output, other, source), (modes, ratio) in SHAPES.items():
        one, two = (derived(name, f"{each}/{source}").bind() for each in (output, other))
        for k in modes:
            # The pole is rounded to double precision; the input's part is common to both.
            s, expected = complex(at(name)(k)), complex(ratio(k))
            size = abs(expected) if abs(expected) > 1e-9 else 1  # at a node of the mode nothing moves
            if not abs(one(s) / two(s) - expected) < 1e-10 * size:
                wrong[name, output, k] = one(s) / two(s), expected
    assert wrong == {}


# -------------------------------------------------------------------------------------------- static limits


def mass(v):
    return v["rho"] * v["A"] * v["l"]


def bending(v):
    return v["E"] * v["I"]


STATIC = {
    ("clamped_free", "W_tip/F"): lambda v: v["l"] ** 3 / (3 * bending(v)),
    ("clamped_free", "W_mid/F"): lambda v: 5 * v["l"] ** 3 / (48 * bending(v)),
    ("clamped_free", "slope_tip/F"): lambda v: v["l"] ** 2 / (2 * bending(v)),
    ("clamped_free", "M_root/F"): lambda v: v["l"],
    ("clamped_clamped", "W_mid/p"): lambda v: v["l"] ** 4 / (384 * bending(v)),
    ("clamped_clamped", "M_end/p"): lambda v: v["l"] ** 2 / 12,
    ("pinned_pinned", "theta_near/tau"): lambda v: v["l"] / (3 * bending(v)),
    ("pinned_pinned", "theta_far/tau"): lambda v: -v["l"] / (6 * bending(v)),
    ("free_free", "A_near/F"): lambda v: 4 / mass(v),
    ("free_free", "A_far/F"): lambda v: -2 / mass(v),
    ("rod_tip_mass", "X_tip/F"): lambda v: v["l"] / (v["E"] * v["A"]),
    ("rod_tip_mass", "F_wall/F"): lambda v: mpf(1),
    ("kelvin_voigt_cantilever", "X_tip/F"): lambda v: v["l"] ** 3 / (3 * bending(v)),
    # The bar lies before the wall: a force up at its far left end turns the wall clockwise.
    ("kelvin_voigt_cantilever", "M_root/F"): lambda v: -v["l"],
    ("timoshenko_cantilever", "W_tip/F"): lambda v: (
        v["l"] ** 3 / (3 * bending(v)) + v["l"] / (v["kappa"] * v["G"] * v["A"])
    ),
    ("timoshenko_cantilever", "phi_tip/F"): lambda v: v["l"] ** 2 / (2 * bending(v)),
    ("timoshenko_cantilever", "M_root/F"): lambda v: v["l"],
}
"""Textbook statics, and for free beams the rigid body's acceleration (1/m + r r'/J with J = m l^2/12)."""


@pytest.mark.slow
def test_static_limits_are_those_of_the_textbook():
    found = {case: derived(*case).bind().dcgain() for case in STATIC}
    assert found == {
        case: pytest.approx(float(expected(values(case[0]))), rel=1e-12) for case, expected in STATIC.items()
    }


RIGID = {
    ("sliding_sliding", "V_near/F"): (1, lambda v: 1 / mass(v)),
    ("sliding_sliding", "V_far/F"): (1, lambda v: 1 / mass(v)),
    ("one_link_arm", "theta_hub/tau"): (2, lambda v: 1 / arm_inertia(v)),
    ("one_link_arm", "y_tip/tau"): (2, lambda v: v["l"] / arm_inertia(v)),
    ("shaft_discs", "angle_1/tau"): (2, lambda v: 1 / (v["J_1"] + v["J_2"] + v["rho"] * v["J"] * v["l"])),
    ("shaft_discs", "angle_2/tau"): (2, lambda v: 1 / (v["J_1"] + v["J_2"] + v["rho"] * v["J"] * v["l"])),
}
"""The power of 1/s at low frequency and its factor."""


def arm_inertia(v):
    return v["J_h"] + mass(v) * v["l"] ** 2 / 3 + v["m"] * v["l"] ** 2


def test_slowly_models_move_as_rigid_bodies():
    s = 1e-5
    found = {case: derived(*case).bind()(s) * s**order for case, (order, _) in RIGID.items()}
    assert found == {
        case: pytest.approx(float(factor(values(case[0]))), rel=1e-8) for case, (_, factor) in RIGID.items()
    }
