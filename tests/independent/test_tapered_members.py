"""Members of all kinds and theories that taper against Taylor steps of their own equations in many digits.

The equations are written down here from equilibrium of a slice; nothing of the program is used to solve them.
"""

import random
from dataclasses import replace
from fractions import Fraction
from functools import cache, partial
from itertools import pairwise

import numpy as np
import pytest
from flint import acb, acb_mat, acb_series, ctx, fmpq
from mpmath import findroot, mp, mpf
from scipy.linalg import expm

from benchmarks.generated import imported
from symflex import pipeline
from symflex.codegen.exporters import EXPORTERS
from symflex.roots.locate import locate
from symflex.roots.region import Modes
from symflex.transfer import bind

E, RHO, G, N, K_F, C_F, M_TIP, J_HUB = 200 * 10**9, 7800, 77 * 10**9, 20_000, 300_000, 40, 1.5, 0.25
A_0, I_0, ETA, KAPPA = fmpq(16, 10**4), fmpq(213, 10**9), fmpq(2, 10**5), fmpq(17, 20)
BITS, TERMS, STEPS = 128, 36, 30

TAPERS = {
    "exponential": (
        "exp(-2*a*x)*(1 + x/l)",
        "exp(-a*x)",
        lambda x: ((x * -1.5).exp() * (1 + x), (x * -0.75).exp()),
    ),
    "wedge": ("(1 - x/(2*l))^3", "(1 - x/(2*l))", lambda x: ((1 - x / 2) ** 3, 1 - x / 2)),
    "double": ("(1 - 0.6*x/l)^4", "(1 - 0.6*x/l)^2", lambda x: ((1 - x * 3 / 5) ** 4, (1 - x * 3 / 5) ** 2)),
    "quotient": (
        "1/(1 + x^2/l^2)",
        "(2 + x/l)/(2 + x^2/l^2)",
        lambda x: (1 / (1 + x**2), (2 + x) / (2 + x**2)),
    ),
    "root": ("sqrt(1 + x/l)", "(1 - sin(2*x/l)/3)", lambda x: ((1 + x).sqrt(), 1 - (x * 2).sin() / 3)),
}
GROUND = ', k_f = "k_f*(1 + x/l)", c_f = "c_f"'
MORE = {"none": "", "eta": ', eta = "eta"', "foundation": GROUND, "tension": ', N = "N*(2 - x/l)"'}
MODEL = """
symflex = 1
[parameters]
E = "200 GPa"
rho = "7800 kg/m^3"
G = "77 GPa"
A_0 = "16 cm^2"
I_0 = "21.3 cm^4"
l = "1 m"
a = "0.75 1/m"
eta = "20 us"
k_f = "300 kN/m^2"
c_f = "40 N*s/m^2"
N = "20 kN"
[elements]
%s
[inputs]
F = { %s }
[outputs]
y = "%s"
"""
TIP = 'load = { type = "mass", at = "tip", m = "1.5 kg" }'
HUB = 'pin = { type = "pin", at = "base" }\nhub = { type = "inertia", at = "base.theta", J = "0.25 kg*m^2" }'
# Each theory, taper, loss and pair of ends, not each with each; foundations and tensions along functions that
# are not rational take seconds a point.
BEAMS = (
    ("euler-bernoulli", "exponential", "none", "tip"),
    ("euler-bernoulli", "double", "foundation", "tip"),
    ("euler-bernoulli", "quotient", "tension", "hub"),
    ("euler-bernoulli", "root", "none", "tip"),
    ("rayleigh", "wedge", "eta", "hub"),
    ("timoshenko", "wedge", "eta", "hub"),
    ("timoshenko", "quotient", "foundation", "tip"),
)
BARS = (
    ("rod", "exponential", "none"),
    ("rod", "wedge", "foundation"),
    ("shaft", "root", "eta"),
    ("string", "quotient", "foundation"),
)


def beam_text(theory, taper, loss, ends):
    second, section, _ = TAPERS[taper]
    start = "ground" if ends == "tip" else "base"
    values = f'E = "E", rho = "rho", l = "l", I = "I_0*{second}", A = "A_0*{section}", theory = "{theory}"'
    shear = ', kappa = "0.85", G = "G"' if theory == "timoshenko" else ""
    arm = f'arm = {{ type = "beam", between = ["{start}", "tip"], {values}{MORE[loss]}{shear} }}'
    if ends == "tip":
        return MODEL % (f"{arm}\n{TIP}", 'force = "tip"', "tip")
    return MODEL % (f"{arm}\n{HUB}", 'torque = "base"', "base.theta")


def beam_slopes(theory, taper, loss):
    """Return the coefficients of y, slope, moment and M' - N y'."""

    def slopes(x, s):
        second, section = TAPERS[taper][2](x)
        one = section * 0 + 1
        lossy = 1 + ETA * s if loss == "eta" else acb(1)
        tension = (one * 2 - x) * N if loss == "tension" else one * 0
        ground = (one + x) * K_F + one * (C_F * s) if loss == "foundation" else one * 0
        rotary = second * (RHO * I_0) * s**2 if theory != "euler-bernoulli" else one * 0
        made = {(0, 1): one, (1, 2): 1 / (second * (E * I_0) * lossy), (2, 3): one}
        made[2, 1] = tension + rotary
        made[3, 0] = -(section * (RHO * A_0) * s**2 + ground)
        if theory == "timoshenko":
            made[0, 3] = -1 / (section * (KAPPA * G * A_0) * lossy)
        return made

    return slopes


def propagated(slopes, size, free, s):
    """Return the state at x = 1 per state at x = 0, by Taylor steps; columns of what is not free are 0."""
    total = acb_mat([[int(i == j and j in free) for j in range(size)] for i in range(size)])
    for step in range(STEPS):
        ctx.cap = TERMS
        made = slopes(acb_series([acb(step) / STEPS, 1]), s)
        ctx.cap = 10
        parts = [acb_mat(size, size) for _ in range(max(map(len, made.values())))]
        for place, series in made.items():
            for k, c in enumerate(series.coeffs()):
                parts[k][place] = c
        terms = [total]
        for k in range(TERMS - 1):
            following = parts[0] * terms[k]
            for p in range(1, min(k + 1, len(parts))):
                following += parts[p] * terms[k - p]
            terms.append(following * (acb(1) / (k + 1)))
        for k, term in enumerate(terms[1:], 1):
            total += term * (acb(1) / STEPS) ** k
    return total


def beam_response(z, s, ends):
    if ends == "tip":
        # Clamped: moment and shear at the start follow from M = 0 and V = m s^2 y - F at the tip.
        rows = acb_mat(2, 2)
        for j in (0, 1):
            rows[0, j] = z[2, 2 + j]
            rows[1, j] = z[3, 2 + j] - M_TIP * s**2 * z[0, 2 + j]
        found = rows.solve(acb_mat([[0], [-1]]))
        return z[0, 2] * found[0, 0] + z[0, 3] * found[1, 0]
    # Hinged: y = 0 and M = J s^2 theta - 1 at the start, no moment and no force at the end.
    rows, right = acb_mat(2, 2), acb_mat(2, 1)
    for i in (0, 1):
        rows[i, 0] = z[2 + i, 1] + J_HUB * s**2 * z[2 + i, 2]
        rows[i, 1] = z[2 + i, 3]
        right[i, 0] = z[2 + i, 2]
    return rows.solve(right)[0, 0]


def bar_text(kind, taper, loss):
    second, section, _ = TAPERS[taper]
    values = {
        "rod": f'type = "rod", E = "E", A = "A_0*{section}"',
        "shaft": f'type = "shaft", G = "G", J = "I_0*{second}"',
        "string": f'type = "string", N = "N*{second}", A = "A_0*{section}"',
    }[kind]
    force = 'torque = "tip"' if kind == "shaft" else 'force = "tip"'
    arm = f'arm = {{ between = ["ground", "tip"], rho = "rho", l = "l", {values}{MORE[loss]} }}'
    return MODEL % (arm, force, "tip")


def bar_slopes(kind, taper, loss):
    def slopes(x, s):
        second, section = TAPERS[taper][2](x)
        lossy = 1 + ETA * s if loss == "eta" else acb(1)
        stiff, heavy = {
            "rod": (section * (E * A_0), section * (RHO * A_0)),
            "shaft": (second * (G * I_0), second * (RHO * I_0)),
            "string": (second * N, section * (RHO * A_0)),
        }[kind]
        ground = (x + 1) * K_F + C_F * s if loss == "foundation" else section * 0
        return {(0, 1): 1 / (stiff * lossy), (1, 0): heavy * s**2 + ground}

    return slopes


def points(seed, fastest, count=6):
    """Return complex frequencies, of which most are far from the imaginary axis."""
    chance = random.Random(seed)
    return [
        complex(fastest * chance.uniform(-0.3, 0.3), fastest * chance.uniform(0.001, 1)) for _ in range(count)
    ]


@cache
def bound_of(text):
    model = pipeline.loads(text)
    (found,) = pipeline.derive_bound(model, model.transfer_functions)
    (tf,) = pipeline.derive_all(model)
    return found, tf


def exported(tf):
    """Return the function of a module in numpy; its own verification, not wanted here, is kept short."""
    model = replace(tf.model, analysis=replace(tf.model.analysis, band=(Fraction(1), Fraction(2))))
    made = EXPORTERS["numpy"].export(model, [replace(tf, model=model)], samples=2)
    return imported(made.text, "exported").y_over_F


def check(text, slopes, size, free, response, fastest):
    bound, tf = bound_of(text)
    places = points(text, fastest)
    enclosed = bound.enclosed(128)
    with ctx.workprec(BITS):
        expected = [response(propagated(slopes, size, free, acb(s)), acb(s)) for s in places]
        for s, value in zip(places, expected, strict=True):
            ball = enclosed(acb(s))
            # Taylor steps are cut off, but far below the ball's digits.
            assert (ball - value.mid()).abs_upper() < 1e-25 * abs(value)
    found = exported(tf)(np.array(places))
    for value, e in zip(found, map(complex, expected), strict=True):
        assert abs(value - e) <= 1e-11 * abs(e)


@pytest.mark.slow
@pytest.mark.parametrize("case", BEAMS, ids="-".join)
def test_tapered_beams_answer_as_taylor_steps_do(case):
    theory, taper, loss, ends = case
    free = (2, 3) if ends == "tip" else (1, 2, 3)

    def response(z, s):
        return beam_response(z, s, ends)

    check(beam_text(*case), beam_slopes(theory, taper, loss), 4, free, response, 4000.0)


@pytest.mark.parametrize(
    "case", [BARS[0], *(pytest.param(c, marks=pytest.mark.slow) for c in BARS[1:])], ids="-".join
)
def test_tapered_rods_shafts_and_strings_answer_as_taylor_steps_do(case):
    kind, _, _ = case
    fastest = 500.0 if kind == "string" else 4e4
    check(bar_text(*case), bar_slopes(*case), 2, (1,), lambda z, _: z[0, 1] / z[1, 1], fastest)


def stepped(s, count):
    """Return the receptance of a rod of uniform pieces, each with the section of its middle."""
    state = np.array([0, 1], dtype=complex)
    speed = 1j * s * np.sqrt(RHO / E)
    for piece in range(count):
        stiff = E * float(A_0) * (1 - (piece + 0.5) / (2 * count))
        grown = -speed / count
        wave = np.array(
            [
                [np.cos(grown), np.sin(grown) / (-speed * stiff)],
                [speed * stiff * np.sin(grown), np.cos(grown)],
            ]
        )
        state = wave @ state
    return state[0] / state[1]


def stepped_beam(s, count):
    """Return the receptance of a cantilever of uniform pieces with a mass at its tip."""
    state = np.eye(4, dtype=complex)
    for piece in range(count):
        thick = 1 - (piece + 0.5) / (2 * count)
        law = np.zeros((4, 4), dtype=complex)
        law[0, 1] = law[2, 3] = 1
        law[1, 2] = 1 / (E * float(I_0) * thick**3)
        law[3, 0] = -RHO * float(A_0) * thick * s**2
        state = expm(law / count) @ state
    # Clamped: the state starts with moment and M' alone; at the tip M = 0 and M' = m s^2 y - F.
    y, m, v = state[0, 2:], state[2, 2:], state[3, 2:]
    return y @ np.linalg.solve([m, v - M_TIP * s**2 * y], [0, -1])


@pytest.mark.parametrize(
    ("text", "steps", "s"),
    [
        (bar_text("rod", "wedge", "none"), stepped, 700 + 9000j),
        (beam_text("euler-bernoulli", "wedge", "none", "tip"), stepped_beam, 30 + 900j),
    ],
    ids=["rod", "beam"],
)
def test_uniform_steps_come_closer_by_the_square_of_their_number(text, steps, s):
    bound, _ = bound_of(text)
    errors = [abs(steps(s, count) - bound(s)) for count in (20, 40, 80, 160)]
    assert errors[0] < 1e-2 * abs(bound(s))
    for coarse, fine in pairwise(errors):
        assert coarse / fine == pytest.approx(4, rel=0.01)


SLOPE = """
symflex = 1
[parameters]
E = "200 GPa"
rho = "7800 kg/m^3"
l = "1 m"
c = { value = 0, assume = "nonnegative" }
[elements]
arm = { type = "beam", between = ["ground", "tip"], E = "E", rho = "rho", l = "l", %s }
[inputs]
F = { force = "tip" }
[outputs]
y = "tip"
"""
SLIGHT = "1e-15"


@cache
def slight_taper():
    # In symbols: with the declared slope of 0 the beam would be uniform before anything is derived.
    model = pipeline.loads(SLOPE % 'I = "2.13e-7*l^4*(1 - c*x/l)^3", A = "1.6e-3*l^2*(1 - c*x/l)"')
    return pipeline.derive_all(model)[0]


def lowest_frequencies(slope, digits=30):
    located = locate(bind(slight_taper(), {"c": slope}), Modes(3), digits=digits)
    assert located.certificate.certified
    return [mpf(root.im.mid().str(digits + 2, radius=False)) for root in located.poles if root.im > 0]


def uniform_frequencies():
    """Return wavenumbers and frequencies of a clamped beam: cos q cosh q = -1."""
    found = [findroot(lambda q: mp.cos(q) + 1 / mp.cosh(q), guess) for guess in (1.875, 4.694, 7.855)]
    unit = mp.sqrt(mpf(E) * mpf("2.13e-7") / (RHO * mpf("1.6e-3")))
    return [(q, q**2 * unit) for q in found]


@pytest.mark.slow
def test_a_taper_of_no_slope_has_the_frequencies_of_the_uniform_beam_to_all_digits():
    with mp.workdps(40):
        for found, (_, expected) in zip(lowest_frequencies("1e-40"), uniform_frequencies(), strict=True):
            assert abs(found - expected) < mpf(10) ** -28 * expected


def mean_place(weight):
    """Return where a weight sits on average from 0 to 1."""
    return mp.quad(lambda x: x * weight(x), [0, 1]) / mp.quad(weight, [0, 1])


@pytest.mark.slow
def test_a_slight_slope_moves_frequencies_as_rayleighs_quotient_says():
    with mp.workdps(40):
        for found, (q, expected) in zip(lowest_frequencies(SLIGHT), uniform_frequencies(), strict=True):
            ratio = (mp.cosh(q) + mp.cos(q)) / (mp.sinh(q) + mp.sin(q))

            def squared(x, sign, q=q, ratio=ratio):
                """Return the square of the shape, or with 1 that of its second derivative over q^2."""
                even = mp.cosh(q * x) + sign * mp.cos(q * x)
                return (even - ratio * (mp.sinh(q * x) + sign * mp.sin(q * x))) ** 2

            # Where stiffness and mass sit on average; they fall by 3 c x and c x (Rayleigh 1877, section 90).
            stiff, heavy = (mean_place(partial(squared, sign=sign)) for sign in (1, -1))
            moved = (found - expected) / expected / mpf(SLIGHT)
            assert abs(moved - (heavy - 3 * stiff) / 2) < mpf(10) ** -12
