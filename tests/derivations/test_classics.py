"""The classic beams, rods and shafts: poles, mode shapes and static limits known from elsewhere."""

from __future__ import annotations

import functools
import math
from pathlib import Path

import mpmath
import pytest
from mpmath import cos, cosh, mp, mpc, mpf, pi, sin, sinh, sqrt

import symflex
from tests.independent import classics
from tests.independent.spec_expressions import distance_to_root

FOLDER = Path(__file__).parents[2] / "derivations" / "classics"
RELATIVE = mpf(10) ** -28
"""How well a denominator printed by the program knows its root: far beyond double precision."""


@functools.cache
def model(name):
    return symflex.load(FOLDER / f"{name}.toml")


@functools.cache
def derived(name, tf):
    return model(name).transfer_function(*tf.split("/"))


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(classics.DIGITS):
        yield


def values(name):
    return classics.values(FOLDER / f"{name}.toml")


def newton_step(name, tf, part, s):
    found = derived(name, tf).to_json_dict()  # what derive --json prints
    return distance_to_root(found[part], values(name), found["where"], s)


def at_axis(omega):
    return mpc(0, omega)


# --------------------------------------------------------------------------------------- natural frequencies


def beam_mode(name, wavenumber):
    return at_axis(classics.beam_frequency(wavenumber, values(name)))


def published_clamped_clamped():
    return mpf(classics.CLAMPED_CLAMPED)


TIMOSHENKO = (3300, 17900, 42600, 70800)
ARM = ("3.03", "4.74", "7.35", "10.37")
KELVIN_VOIGT = ((-1, 32), (-1, 250), (-6, 759), (-24, 1551))


def poles():
    """Yield (model, transfer function, mode, function that returns the pole)."""
    yield "clamped_free", "W_tip/F", 1, lambda: beam_mode("clamped_free", mpf(classics.CLAMPED_FREE))
    for k in range(2, 6):
        yield "clamped_free", "W_tip/F", k, lambda k=k: beam_mode("clamped_free", classics.clamped_free(k))
    yield (
        "clamped_clamped",
        "W_mid/p",
        1,
        lambda: beam_mode("clamped_clamped", published_clamped_clamped()),
    )
    for k in (3, 5):  # a uniform load at the middle drives and shows symmetric modes only
        yield (
            "clamped_clamped",
            "W_mid/p",
            k,
            lambda k=k: beam_mode("clamped_clamped", classics.clamped_clamped(k)),
        )
    yield "free_free", "A_far/F", 1, lambda: beam_mode("free_free", published_clamped_clamped())
    for k in range(2, 6):
        yield "free_free", "A_far/F", k, lambda k=k: beam_mode("free_free", classics.clamped_clamped(k))
    for k in range(1, 6):
        yield "pinned_pinned", "theta_far/tau", k, lambda k=k: beam_mode("pinned_pinned", k * pi)
        yield "sliding_sliding", "V_far/F", k, lambda k=k: beam_mode("sliding_sliding", k * pi)
        yield "rod_tip_mass", "X_tip/F", k, lambda k=k: rod_mode(k)
        yield "shaft_discs", "angle_2/tau", k, lambda k=k: shaft_mode(k)
    for k, guess in enumerate(TIMOSHENKO, 1):
        yield "timoshenko_cantilever", "W_tip/F", k, lambda guess=guess: timoshenko_mode(guess)
    for k, guess in enumerate(ARM, 1):
        yield "one_link_arm", "y_tip/tau", k, lambda guess=guess: arm_mode(guess)
    for k, guess in enumerate(KELVIN_VOIGT, 1):
        yield "kelvin_voigt_cantilever", "X_tip/F", k, lambda guess=guess: damped_mode(guess)


def rod_mode(k):
    v = values("rod_tip_mass")
    return at_axis(classics.rod_with_mass(k, v) / v["l"] * sqrt(v["E"] / v["rho"]))


def shaft_mode(k):
    v = values("shaft_discs")
    return at_axis(classics.shaft_with_discs(k, v) / v["l"] * sqrt(v["G"] / v["rho"]))


def timoshenko_mode(guess):
    return at_axis(classics.timoshenko_cantilever(guess, values("timoshenko_cantilever")))


def arm_mode(guess):
    v = values("one_link_arm")
    return at_axis(classics.beam_frequency(classics.one_link_arm(guess, v), v))


def damped_mode(guess):
    return classics.loaded_cantilever(mpc(*guess), values("kelvin_voigt_cantilever"))


POLES = tuple(pytest.param(*entry, id=f"{entry[0]}-{entry[2]}") for entry in poles())


@pytest.mark.parametrize(("name", "tf", "mode", "pole"), POLES)
def test_the_printed_denominator_vanishes_at_the_pole(name, tf, mode, pole):
    del mode
    assert newton_step(name, tf, "den", pole()) < RELATIVE


@pytest.mark.parametrize(("name", "tf", "mode", "pole"), POLES)
def test_the_bound_function_finds_the_pole(name, tf, mode, pole):
    expected = complex(pole())
    found = derived(name, tf).bind().poles(modes=mode + 2)
    assert min(abs(complex(root) - expected) for root in found) < 1e-11 * abs(expected)


def test_the_printed_numerator_does_not_vanish_at_the_pole():
    s = beam_mode("clamped_free", mpf(classics.CLAMPED_FREE))
    assert newton_step("clamped_free", "W_tip/F", "num", s) > mpf("1e-3")


# ----------------------------------------------------------------------------------------------- mode shapes


def shape(name, output, reference, source, s):
    """Return the ratio of two outputs at a pole: what the mode has there, for the inputs' part is common.

    The pole is rounded to double precision; the ratio of the responses is then as good as that.
    """
    at = complex(s)
    return derived(name, f"{output}/{source}").bind()(at) / derived(name, f"{reference}/{source}").bind()(at)


def cantilever_shape(x, xi):
    """Return the mode of wavenumber x at xi = x/l (Blevins 1979, table 8-1)."""
    sigma = (sinh(x) - sin(x)) / (cosh(x) + cos(x))
    return cosh(x * xi) - cos(x * xi) - sigma * (sinh(x * xi) - sin(x * xi))


def clamped_shape(x, xi):
    """Return the mode of a beam clamped at both ends (Blevins 1979, table 8-1)."""
    sigma = (cosh(x) - cos(x)) / (sinh(x) - sin(x))
    return cosh(x * xi) - cos(x * xi) - sigma * (sinh(x * xi) - sin(x * xi))


@pytest.mark.parametrize("k", [1, 2, 3, 4])
def test_the_middle_of_a_cantilever_moves_as_the_mode_says(k):
    x = classics.clamped_free(k)
    expected = cantilever_shape(x, mpf("0.5")) / cantilever_shape(x, 1)
    found = shape("clamped_free", "W_mid", "W_tip", "F", beam_mode("clamped_free", x))
    assert abs(found - complex(expected)) < 1e-10


@pytest.mark.parametrize("k", [1, 2, 3, 4])
def test_the_tip_of_a_cantilever_turns_as_the_mode_says(k):
    x = classics.clamped_free(k)
    expected = mpmath.diff(lambda xi: cantilever_shape(x, xi), 1) / cantilever_shape(x, 1)
    found = shape("clamped_free", "slope_tip", "W_tip", "F", beam_mode("clamped_free", x))
    assert abs(found / complex(expected) - 1) < 1e-10  # l = 1 m


@pytest.mark.parametrize("k", [1, 2, 3, 4])
def test_the_root_of_a_cantilever_is_bent_as_its_tip_moves(k):
    # E I w''(0) = E I beta^2 (-1)^(k+1) w(l): the mode is its own second derivative, read from the other end.
    x, v = classics.clamped_free(k), values("clamped_free")
    expected = v["E"] * v["I"] * (x / v["l"]) ** 2 * (-1) ** (k + 1)
    found = shape("clamped_free", "M_root", "W_tip", "F", beam_mode("clamped_free", x))
    assert abs(found / complex(expected) - 1) < 1e-10


@pytest.mark.parametrize("k", [1, 3, 5])
def test_a_clamped_beam_moves_at_a_quarter_as_the_mode_says(k):
    x = classics.clamped_clamped(k)
    expected = clamped_shape(x, mpf("0.25")) / clamped_shape(x, mpf("0.5"))
    found = shape("clamped_clamped", "W_quarter", "W_mid", "p", beam_mode("clamped_clamped", x))
    assert abs(found - complex(expected)) < 1e-10


@pytest.mark.parametrize("k", [1, 2, 3, 4, 5])
def test_the_ends_of_a_free_beam_move_alike_in_odd_modes_and_oppositely_in_even_ones(k):
    found = shape("free_free", "A_far", "A_near", "F", beam_mode("free_free", classics.clamped_clamped(k)))
    assert abs(found - (-1) ** (k + 1)) < 1e-10


@pytest.mark.parametrize("k", [1, 2, 3, 4, 5])
def test_the_ends_of_a_pinned_beam_turn_as_a_sine(k):
    found = shape("pinned_pinned", "theta_far", "theta_near", "tau", beam_mode("pinned_pinned", k * pi))
    assert abs(found - (-1) ** k) < 1e-10


@pytest.mark.parametrize("k", [1, 2, 3, 4, 5])
def test_the_ends_of_a_sliding_beam_move_as_a_cosine(k):
    found = shape("sliding_sliding", "V_far", "V_near", "F", beam_mode("sliding_sliding", k * pi))
    assert abs(found - (-1) ** k) < 1e-10


@pytest.mark.parametrize("k", [1, 2, 3, 4, 5])
def test_the_middle_of_a_sliding_beam_moves_as_a_cosine(k):
    found = shape("sliding_sliding", "V_mid", "V_near", "F", beam_mode("sliding_sliding", k * pi))
    assert abs(found - math.cos(k * math.pi / 2)) < 1e-10


@pytest.mark.parametrize("k", [1, 2, 3, 4, 5])
def test_the_wall_feels_the_rod_as_its_sine_says(k):
    # u = sin(x xi)/sin x: tension E A x/(l sin x) at the wall, which the rod pulls backwards.
    v = values("rod_tip_mass")
    x = classics.rod_with_mass(k, v)
    expected = v["E"] * v["A"] * x / (v["l"] * sin(x))
    found = shape("rod_tip_mass", "F_wall", "X_tip", "F", rod_mode(k))
    assert abs(found / complex(expected) - 1) < 1e-10


@pytest.mark.parametrize("k", [1, 2, 3, 4, 5])
def test_the_discs_turn_as_the_mode_of_the_shaft_says(k):
    v = values("shaft_discs")
    x = classics.shaft_with_discs(k, v)
    ratio = v["J_1"] / (v["rho"] * v["J"] * v["l"])
    expected = cos(x) - ratio * x * sin(x)
    found = shape("shaft_discs", "angle_2", "angle_1", "tau", shaft_mode(k))
    assert abs(found / complex(expected) - 1) < 1e-10


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


@pytest.mark.parametrize("case", tuple(STATIC), ids="-".join)
def test_the_static_limit_is_that_of_the_textbook(case):
    name, tf = case
    expected = STATIC[case](values(name))
    assert derived(name, tf).bind().dcgain() == pytest.approx(float(expected), rel=1e-12)


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


@pytest.mark.parametrize("case", tuple(RIGID), ids="-".join)
def test_slowly_the_model_moves_as_a_rigid_body(case):
    name, tf = case
    order, factor = RIGID[case]
    s = 1e-5
    assert derived(name, tf).bind()(s) * s**order == pytest.approx(float(factor(values(name))), rel=1e-8)


@pytest.mark.parametrize(
    "name", ["clamped_free", "free_free", "pinned_pinned", "clamped_clamped", "rod_tip_mass", "shaft_discs"]
)
def test_the_engine_for_systems_without_losses_proves_their_roots_itself(name):
    # Were it to fail, the next engine would find the same roots, and nobody would notice.
    [(output, source), *_] = [(o, i) for o in model(name).outputs for i in model(name).inputs]
    bound = model(name).transfer_function(output, source).bind()
    assert bound.pole_zero_map(modes=2).certificate.engine == "lossless"
