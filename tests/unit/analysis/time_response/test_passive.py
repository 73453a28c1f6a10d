"""Beams with anything passive at their ends: responses hold what closed forms, inverted otherwise, give."""

import mpmath
import numpy as np
import pytest
from flint import acb, arb

from symflex import loads, pipeline
from symflex.analysis.time_response import SampleTimes, time_response
from symflex.analysis.time_response.estimated_modes import estimated
from symflex.analysis.time_response.function_size import SizeOfExponentials
from symflex.analysis.time_response.modal import BoundedModes
from symflex.analysis.time_response.passive_modes import passive_bound
from symflex.analysis.time_response.sampled import Refused

UNIT = 'E = "1 Pa", A = "1 m^2", I = "1 m^4", rho = "1 kg/m^3"'
WHOLE = 'l = "1 m"'


def of(text, output="X", source="F"):
    return loads(f"symflex = 1\n{text}").transfer_function(output, source).bind().bound


def clamped(rest="", kind="", output="x"):
    text = f'elements.arm = {{ type = "beam", between = ["ground", "x"], {UNIT}, {WHOLE}{kind} }}\n{rest}\n'
    return of(f'{text}inputs.F = {{ force = "x" }}\noutputs.X = "{output}"')


def damper(b):
    return f'elements.d = {{ type = "damper", between = ["ground", "x"], b = "{b} N*s/m" }}'


def spring(k):
    return f'elements.k = {{ type = "spring", between = ["ground", "x"], k = "{k} N/m" }}'


def hub(rest="", eta="0", output="tip", drives='torque = "hub"'):
    """Return a pinned beam with a hub at one end and a mass at the other, turned by a torque at the hub."""
    return of(
        f"""
elements.arm  = {{ type = "beam", between = ["hub", "tip"], {UNIT}, {WHOLE}, eta = "{eta} s" }}
elements.pin  = {{ type = "pin", at = "hub" }}
elements.J    = {{ type = "inertia", at = "hub.theta", J = "0.1 kg*m^2" }}
elements.loss = {{ type = "rotary_damper", between = ["hub.theta", "ground"], b = "0.2 N*m*s/rad" }}
elements.m    = {{ type = "mass", at = "tip", m = "0.3 kg" }}
inputs.F  = {{ {drives} }}
outputs.X = "{output}"
{rest}"""
    )


DRIVE = """
[elements.drive]
type      = "dc_motor"
terminals = ["u", "ground"]
shaft     = "hub.theta"
k_t       = "0.3 N*m/A"
R         = "2 ohm"
L         = "10 mH"
"""


def wave(s, eta):
    """Return the wavenumber of a beam with E I = rho A = 1, and its bending stiffness."""
    stiff = 1 + mpmath.mpf(eta) * s
    return (-(s**2) / stiff) ** mpmath.mpf("0.25"), stiff


def tip_of_clamped(s, load, eta):
    """Return the deflection of a cantilever's tip under 1, with a stiffness ``load`` beside the beam's."""
    q, stiff = wave(s, eta)
    c, h = mpmath.cos, mpmath.cosh
    beam = stiff * q**3 * (1 + c(q) * h(q)) / (h(q) * mpmath.sin(q) - mpmath.sinh(q) * c(q))
    return 1 / (beam + load(s))


def tip_of_hub(s, drive, eta):
    """Return what the tip moves under a torque 1 at the hub: w = a sin + b sinh + d (cos - cosh)."""
    q, stiff = wave(s, eta)
    sine, cosine, sinh, cosh = mpmath.sin(q), mpmath.cos(q), mpmath.sinh(q), mpmath.cosh(q)
    hinge = mpmath.mpf("0.1") * s**2 + mpmath.mpf("0.2") * s + drive(s)
    mass = mpmath.mpf("0.3") * s**2
    rows = mpmath.matrix(
        [
            # Moments at the hub: EI w'' = hinge w' - 1, w''(0) = -2 d q^2.
            [hinge * q, hinge * q, 2 * stiff * q**2],
            # No moment at the tip, and EI w''' = m s^2 w.
            [-sine, sinh, -(cosine + cosh)],
            [
                -stiff * q**3 * cosine - mass * sine,
                stiff * q**3 * cosh - mass * sinh,
                stiff * q**3 * (sine - sinh) - mass * (cosine - cosh),
            ],
        ]
    )
    a, b, d = mpmath.lu_solve(rows, mpmath.matrix([1, 0, 0]))
    return a * sine + b * sinh + d * (cosine - cosh)


def inverted(function, integrations, times, degree=120):
    """Return an inverse Laplace transform by Talbot's contour, right where high frequencies die."""
    with mpmath.workdps(70):
        return [
            float(
                mpmath.invertlaplace(
                    lambda s: function(s) / s**integrations, t, method="talbot", degree=degree
                )
            )
            for t in times
        ]


def assert_holds(found, expected, share=1e-9, off=0.0):
    """Check that all values lie in their balls, and that these are narrow beside the largest."""
    expected = np.array(expected)
    assert found.certified
    assert np.all(np.abs(found.values - expected) <= found.radius + off)
    assert found.radius.max() <= share * np.abs(found.values).max()


TIMES = [0.1, 0.37, 1.0, 2.9]
MASS_ON_SPRING = (
    'elements.m = { type = "mass", at = "z", m = "0.2 kg" }\n'
    'elements.k = { type = "spring", between = ["x", "z"], k = "3 N/m" }'
)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "load", "eta"),
    [
        (f"{spring(5)}\n{damper(0.5)}", lambda s: 5 + s / 2, "0.3"),
        (MASS_ON_SPRING, lambda s: 3 * s**2 / (s**2 + 15), "0.02"),
    ],
    ids=["spring and damper", "mass on a spring"],
)
def test_a_step_of_a_beam_damped_in_its_material_with_a_load_is_its_inverse_transform(text, load, eta):
    found = time_response(clamped(text, f', eta = "{eta} s"'), "step", SampleTimes.of(TIMES))
    assert_holds(found, inverted(lambda s: tip_of_clamped(s, load, eta), 1, TIMES), off=1e-15)


def clamped_between(s, place, load, eta, order=0):
    """Return the deflection of a cantilever somewhere, or its slope, under 1 at the tip."""
    q, stiff = wave(s, eta)
    c, h, sine, sinh = mpmath.cos, mpmath.cosh, mpmath.sin, mpmath.sinh
    # w = a (cos - cosh) + b (sin - sinh), without a moment at the tip, where E I times the third derivative
    # is load w - 1.
    rows = mpmath.matrix(
        [
            [-c(q) - h(q), -sine(q) - sinh(q)],
            [
                stiff * q**3 * (sine(q) - sinh(q)) - load(s) * (c(q) - h(q)),
                stiff * q**3 * (-c(q) - h(q)) - load(s) * (sine(q) - sinh(q)),
            ],
        ]
    )
    a, b = mpmath.lu_solve(rows, mpmath.matrix([0, -1]))
    z = q * place
    if order:
        return q * (a * (-sine(z) - sinh(z)) + b * (c(z) - h(z)))
    return a * (c(z) - h(z)) + b * (sine(z) - sinh(z))


@pytest.mark.slow
def test_a_section_between_the_ends_of_a_beam_with_a_damper_turns_as_its_inverse_transform():
    bound = clamped(damper(0.5), ', eta = "0.02 s"', "arm.theta(0.4 m)")
    found = time_response(bound, "step", SampleTimes.of(TIMES))
    place = mpmath.mpf("0.4")
    expected = inverted(lambda s: clamped_between(s, place, lambda s: s / 2, "0.02", order=1), 1, TIMES)
    assert_holds(found, expected, 1e-6, off=1e-15)


@pytest.mark.slow
def test_an_arm_driven_by_a_ramp_of_a_voltage_moves_as_its_inverse_transform():
    found = time_response(hub(DRIVE, "0.02", drives='voltage = "u"'), "ramp", SampleTimes.of(TIMES))

    def tip(s):
        around = 2 + s / 100
        return tip_of_hub(s, lambda s: mpmath.mpf("0.09") * s / around, "0.02") * mpmath.mpf("0.3") / around

    assert_holds(found, inverted(tip, 2, TIMES), off=1e-15)


def modes_of_damped_tip(b, count):
    """Return poles and residues of 1/(beam + b s) by Newton's method in doubles, s = j q^2.

    With S = sin - cos tanh and C = cos + sech, both over cosh, the denominator is ``q C + j b S`` times q^2.
    """

    def parts(q):
        low = np.real(q) > 15
        bounded = np.where(low, 1, q)
        tanh = np.where(low, 1, np.tanh(bounded))
        sech = np.where(low, 0, 1 / np.cosh(bounded))
        return np.sin(q) - np.cos(q) * tanh, np.cos(q) + sech, tanh, sech

    def slopes(q):
        _, _, tanh, sech = parts(q)
        return np.cos(q) + np.sin(q) * tanh - np.cos(q) * sech**2, -np.sin(q) - sech * tanh

    n = np.arange(1, count + 1)
    q = (n - 0.5) * np.pi + 0j
    for share in (*np.linspace(0.05, 1, 20), *[1] * 12):
        S, C, _, _ = parts(q)
        dS, dC = slopes(q)
        q = q - (q * C + 1j * share * b * S) / (C + q * dC + 1j * share * b * dS)
    S, _, _, _ = parts(q)
    dS, dC = slopes(q)
    # H = S/(q^3 C + b s S), and ds = 2 j q dq.
    C = -1j * b * S / q
    return 1j * q**2, S / (q**2 * (C + q * dC + 1j * b * dS)) * 2j * q


@pytest.mark.slow
def test_a_step_of_a_beam_with_a_damper_at_its_tip_is_its_modal_sum():
    times = [0.0, 0.01, *TIMES]
    found = time_response(clamped(damper(0.5)), "step", SampleTimes.of(times), 9)
    poles, residues = modes_of_damped_tip(0.5, 6000)
    assert abs(1 / 3 + 2 * np.sum((residues / poles).real)) < 1e-11  # none is missing
    expected = [1 / 3 + 2 * np.sum((residues / poles * np.exp(poles * t)).real[::-1]) for t in times]
    assert_holds(found, expected, off=1e-11)


@pytest.mark.parametrize(
    "cut", ["3*l/10", pytest.param("70710678*l/100000000", marks=pytest.mark.slow)], ids=["short", "long"]
)
def test_a_beam_cut_in_two_moves_as_the_whole(cut):
    text = 'parameters.l = "1 m"\n'
    text += f'elements.p = {{ type = "beam", between = ["ground", "z"], {UNIT}, l = "{cut}" }}\n'
    text += f'elements.q = {{ type = "beam", between = ["z", "x"], {UNIT}, l = "l - {cut}" }}\n'
    times = SampleTimes.of([0.0, *TIMES])
    found = time_response(of(f'{text}inputs.F = {{ force = "x" }}\noutputs.X = "x"'), "step", times)
    whole = time_response(clamped(), "step", times)
    assert_holds(found, whole.values, off=whole.radius)


def rod(kind):
    text = f'elements.bar = {{ type = "rod", between = ["ground", "x"], E = "1 Pa", A = "1 m^2", {kind}, '
    return of(f'{text}rho = "1 kg/m^3", {WHOLE} }}\ninputs.F = {{ force = "x" }}\noutputs.X = "x"')


@pytest.mark.parametrize(
    ("kind", "eta", "c", "share"),
    [
        ('c_f = "0.5 N*s/m^2"', 0, 0.5, 1e-9),
        pytest.param('eta = "0.05 s"', 0.05, 0, 1e-8, marks=pytest.mark.slow),
    ],
    ids=["around it", "in its material"],
)
def test_a_rod_that_loses_energy_is_a_sum_of_damped_modes(kind, eta, c, share):
    found = time_response(rod(kind), "step", SampleTimes.of([0.3, 1.0, 2.9]))
    kappa = ((np.arange(1, 200_001) - 0.5) * np.pi) ** 2
    half = (c + eta * kappa) / 2
    root = np.sqrt((half**2 - kappa).astype(complex))
    fast = -half - root
    slow = np.where(half**2 > kappa, kappa / fast, -half + root)
    expected = []
    for t in [0.3, 1.0, 2.9]:
        left = (slow * np.exp(fast * t) - fast * np.exp(slow * t)) / (slow - fast)
        # Of all that is left out the slow pole is -1/eta; what is 1/kappa adds up to 1/2.
        last = (0.5 - np.sum(1 / kappa[::-1])) * (np.exp(-t / eta) if eta else 0)
        expected.append(1 - 2 * np.sum((left.real / kappa)[::-1]) - 2 * last)
    assert_holds(found, expected, share, off=1e-10 if eta else 2e-6)


@pytest.mark.slow
def test_timoshenkos_beam_is_held_too_with_a_wider_radius():
    kind = 'theory = "timoshenko", G = "0.4 Pa", kappa = "5/6"'
    text = 'elements.arm = { type = "beam", between = ["ground", "x"], E = "1 Pa", A = "1 m^2", l = "1 m", '
    text += f'I = "0.01 m^4", rho = "1 kg/m^3", {kind} }}\ninputs.F = {{ force = "x" }}\noutputs.X = "x"'
    times = [0.0, 3.0, 10.0, 31.0]
    found = time_response(of(text), "step", SampleTimes.of(times), 2)
    # Legendre polynomials times x for deflection and slope: Ritz's method, whose statics are exact.
    n, shear, bend, turn = 60, 0.4 * 5 / 6, 0.01, 0.01
    x, weight = np.polynomial.legendre.leggauss(200)
    x, weight = (x + 1) / 2, weight / 2
    shapes = [np.polynomial.Legendre.basis(k, domain=[0, 1]) for k in range(n)]
    value = np.array([x * p(x) for p in shapes])
    slope = np.array([p(x) + x * p.deriv()(x) for p in shapes])
    zero = np.zeros((n, n))

    def product(a, b):
        return (a * weight) @ b.T

    mass = np.block([[product(value, value), zero], [zero, turn * product(value, value)]])
    stiff = np.block(
        [
            [shear * product(slope, slope), -shear * product(slope, value)],
            [-shear * product(value, slope), shear * product(value, value) + bend * product(slope, slope)],
        ]
    )
    lower = np.linalg.inv(np.linalg.cholesky(mass))
    squared, modes = np.linalg.eigh(lower @ stiff @ lower.T)
    tip = np.concatenate([[p(1.0) for p in shapes], np.zeros(n)])
    weights = (tip @ lower.T @ modes) ** 2
    expected = [np.sum(weights / squared * (1 - np.cos(np.sqrt(squared) * t))) for t in times]
    assert_holds(found, expected, share=1e-2)


@pytest.mark.slow
def test_the_bound_of_what_lies_beyond_a_circle_holds_for_a_thousand_modes():
    modes = BoundedModes(*passive_bound(clamped(), 1), SampleTimes.of([0.0, 0.37, 1.0]))
    few, many = modes.summed(16), modes.summed(1000)
    off = [abs(a - b) for a, b in zip(few.values, many.values, strict=True)]
    assert max(off, key=lambda d: d.mid()) < few.rest
    assert few.rest < arb("1e-4")


@pytest.mark.slow
def test_a_velocity_is_within_its_radius_from_the_first_instants_on_estimated_or_not():
    # Infinitely many poles lie next to -1/eta, and all of them matter at first.
    times = SampleTimes.of([1e-8, 1e-6, 1e-4, 1e-2, 0.1, 1.0])
    bound = clamped(damper(8), ', eta = "0.02 s"', "s*x")
    expected = inverted(
        lambda s: tip_of_clamped(s, lambda s: 8 * s, "0.02"), 0, times.seconds.tolist(), degree=60
    )
    assert_holds(time_response(bound, "step", times, 8), expected, share=1e-8, off=1e-14)
    sampled = estimated(bound, 1, times)
    largest = np.abs(expected).max()
    for value, y in zip(sampled.values, expected, strict=True):
        assert abs(value.mid() - y) <= value.rad() < 0.02 * largest


@pytest.mark.slow
def test_what_accumulates_about_a_loss_time_is_estimated_with_the_rest():
    # From some damping time of the first mode on, what is left out is no more than the rounding of doubles.
    bound = clamped(damper(0.5), ', eta = "0.3 s"', "s*x")
    found = time_response(bound, "step", SampleTimes.of([0.1, 1.0]))
    expected = inverted(lambda s: tip_of_clamped(s, lambda s: s / 2, "0.3"), 0, [0.1, 1.0], degree=60)
    assert np.abs(found.values - expected).max() < 1e-14


def tip_of_timoshenkos(s, load, eta):
    """Return the same of a Timoshenko beam with kappa G = 1/2, of (w, psi, M, V) as a transfer matrix."""
    stiff = 1 + mpmath.mpf(eta) * s
    rows = [[0, 1, 0, 2 / stiff], [0, 0, 1 / stiff, 0], [0, s**2, 0, -1], [s**2, 0, 0, 0]]
    whole = mpmath.expm(mpmath.matrix(rows))
    # No moment at the tip, and V = 1 - load w.
    ends = mpmath.matrix([[whole[2, j] for j in (2, 3)], [whole[3, j] + load * whole[0, j] for j in (2, 3)]])
    moment, shear = mpmath.lu_solve(ends, mpmath.matrix([0, 1]))
    return whole[0, 2] * moment + whole[0, 3] * shear


def test_the_size_of_a_function_whose_terms_cancel_holds_in_a_wide_ball():
    kind = ', theory = "timoshenko", kappa = "1/2", G = "1 Pa", eta = "0.02 s"'
    size = SizeOfExponentials.of(clamped(damper(0.5), kind))
    for width in (1e-4, 1e-2):
        ball = acb(arb(-50, width), arb(4, width))
        corners = [mpmath.mpc(-50 + a * width, 4 + b * width) for a in (-1, 1) for b in (-1, 1)]
        with mpmath.workdps(60):
            least = max(abs(tip_of_timoshenkos(s, s / 2, "0.02")) for s in corners)
        assert float(least) < float(size.at(ball)) < 3 * float(least), width


def test_what_an_active_model_leaves_out_is_not_bounded_by_its_energy():
    assert isinstance(passive_bound(clamped(spring("-1")), 1), Refused)
    assert isinstance(passive_bound(clamped(output="arm.y(0.5 m) - arm.y(0.2 m)"), 1), Refused)
    grows = passive_bound(clamped('parameters.T = "1 s"', output="x/(1 - T*s)"), 1)
    assert grows == Refused("something in the model may supply energy")


WALL = """symflex = 1
parameters = { a = "1e-6 m^2/s", l = "0.1 m" }
fields.T = { domain = ["0", "l"], equation = "a*T'' = s*T", conditions = ["T(0) = u", "T'(l) = 0"] }
inputs.u = { unit = "K" }
outputs.back = "T(l)"
"""


def test_a_field_is_not_said_to_supply_energy():
    model = pipeline.loads(WALL)
    (wall,) = pipeline.derive_bound(model, model.transfer_functions)
    assert passive_bound(wall, 1) == Refused("stored energy is known for elements, not for fields")


@pytest.mark.slow
def test_a_search_that_ends_by_itself_leaves_what_was_proved_before(monkeypatch):
    text = 'elements.arm = { type = "beam", between = ["ground", "x"], E = "1 Pa", A = "1 m^2", l = "1 m", '
    text += 'I = "0.01 m^4", rho = "1 kg/m^3" }\n'
    text += 'elements.d = { type = "damper", between = ["x", "ground"], b = "0.1 N*s/m" }\n'
    text += 'inputs.F = { force = "x" }\noutputs.X = "x"'
    summed, asked = BoundedModes.summed, []

    def ends_early(self, count):
        asked.append(count)
        if len(asked) > 1:
            self.is_exhausted = True
            return None
        return summed(self, count)

    times = SampleTimes.of([0.0, 3.0, 10.0])
    whole = time_response(of(text), "step", times)
    monkeypatch.setattr(BoundedModes, "summed", ends_early)
    found = time_response(of(text), "step", times)
    assert len(asked) == 2
    assert found.certified
    assert np.all(np.abs(found.values - whole.values) <= found.radius + whole.radius)


@pytest.mark.slow
def test_modes_are_summed_where_a_wavenumber_vanishes_in_numerator_and_denominator():
    # There, at s = -0.1 +- j sqrt(0.99), both strings move as rigid bodies, and no pole is.
    half = 'type = "string", N = "N", rhoA = "mu", l = "L/2", c_f = "c", k_f = "k"'
    bound = of(
        f"""
parameters = {{ N = 1, mu = 1, L = 2, c = 0.2, k = 1 }}
elements.a = {{ {half}, between = ["ground", "x"] }}
elements.b = {{ {half}, between = ["x", "ground"] }}
elements.m = {{ type = "mass", at = "x", m = 1 }}
inputs.F = {{ force = "x" }}
outputs.X = "x"
"""
    )

    def receptance(s):
        gamma = mpmath.sqrt(s**2 + s / 5 + 1)
        return 1 / (s**2 + 2 * gamma * mpmath.coth(gamma))

    times = [0.5, 2.0, 5.0]
    found = estimated(bound, 1, SampleTimes.of(times))
    for t, value in zip(times, found.values, strict=True):
        # Echoes bend it: the series of de Hoog, Knight & Stokes (1982), not Talbot's contour.
        y = mpmath.invertlaplace(lambda s: receptance(s) / s, t, method="dehoog", degree=60)
        assert abs(value.mid() - float(y)) <= value.rad() < 1e-4


def finite_elements(n, k, rotary, b, times):
    """Return a cantilever's tip under a unit step: foundation, rotary inertia, dashpot at the tip."""
    h, mass, stiffness = 1 / n, *np.zeros((2, 2 * n + 2, 2 * n + 2))
    for i in range(n):
        part = slice(2 * i, 2 * i + 4)
        element = np.array(
            [
                [156, 22 * h, 54, -13 * h],
                [22 * h, 4 * h * h, 13 * h, -3 * h * h],
                [54, 13 * h, 156, -22 * h],
                [-13 * h, -3 * h * h, -22 * h, 4 * h * h],
            ]
        )
        turned = [[36, 3 * h, -36, 3 * h], [3 * h, 4 * h * h, -3 * h, -h * h]]
        turned += [[-36, -3 * h, 36, -3 * h], [3 * h, -h * h, -3 * h, 4 * h * h]]
        mass[part, part] += element * h / 420 + rotary * np.array(turned) / (30 * h)
        bending = [[12, 6 * h, -12, 6 * h], [6 * h, 4 * h * h, -6 * h, 2 * h * h]]
        bending += [[-12, -6 * h, 12, -6 * h], [6 * h, 2 * h * h, -6 * h, 4 * h * h]]
        stiffness[part, part] += np.array(bending) / h**3 + k * element * h / 420
    mass, stiffness = mass[2:, 2:], stiffness[2:, 2:]
    size, loss, force = 2 * n, np.zeros((2 * n, 2 * n)), np.zeros(2 * n)
    loss[-2, -2], force[-2] = b, 1
    slopes = [np.linalg.solve(mass, x) for x in (stiffness, loss)]
    system = np.block([[np.zeros((size, size)), np.eye(size)], [-slopes[0], -slopes[1]]])
    poles, modes = np.linalg.eig(system)
    shares = np.linalg.solve(modes, np.concatenate([np.zeros(size), np.linalg.solve(mass, force)]))
    return [((modes[size - 2] * shares) @ ((np.exp(poles * t) - 1) / poles)).real for t in times]


@pytest.mark.slow
def test_a_root_that_the_numerator_shares_where_wavenumbers_vanish_adds_nothing_to_a_step():
    # At s = j sqrt(3) the foundation carries the beam's inertia, and no pole is.
    found = time_response(clamped(damper(0.1), ', k_f = "3 N/m^2"'), "step", SampleTimes.of([0.95, 1.9, 200]))
    assert found.certified
    assert found.values[:2] == pytest.approx(finite_elements(40, 3, 0, 0.1, [0.95, 1.9]), abs=3e-6)
    # Hetenyi 1946, Beams on Elastic Foundation, section 23: the deflection under a load at the free end
    q = (3 / 4) ** 0.25
    at_rest = (
        2 * q / 3 * (np.sinh(q) * np.cosh(q) - np.sin(q) * np.cos(q)) / (np.cosh(q) ** 2 + np.cos(q) ** 2)
    )
    assert found.values[2] == pytest.approx(at_rest, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("b", [0, 0.1])
def test_a_step_of_rayleighs_beam_is_certified_from_a_thousand_modes(b):
    # One wavenumber grows with s, the other tends to a constant.
    kind = ', theory = "rayleigh", rhoI = "0.01 kg*m"'
    text = f"""
elements.arm = {{ type = "beam", between = ["ground", "x"], EI = 1, rhoA = 1, l = 1{kind} }}
{damper(b) if b else ""}
inputs.F = {{ force = "x" }}
outputs.X = "x"
"""
    found = time_response(of(text), "step", SampleTimes.of([0.95, 1.9]))
    assert found.certified
    assert found.radius.max() < 1e-6
    assert found.values == pytest.approx(finite_elements(40, 0, 0.01, b, [0.95, 1.9]), abs=3e-6)


def test_the_ends_of_matched_rods_whose_wavenumbers_hold_numbers_are_bounded():
    rods = "".join(
        f'{name} = {{ type = "rod", between = ["{a}", "{b}"], '
        f'E = "E{k}", rho = "r{k}", A = "1e-4 m^2", l = "1 m" }}\n'
        for name, a, b, k in (("one", "ground", "p", 1), ("two", "p", "q", 2), ("three", "q", "x", 1))
    )
    text = (
        'symflex = 1\nparameters = { E1 = "4 GPa", E2 = "1 GPa", r1 = "1000 kg/m^3", r2 = "4000 kg/m^3" }\n'
        f'inputs.F = {{ force = "x" }}\noutputs.X = "p"\n[elements]\n{rods}'
    )
    model = pipeline.loads(text)
    (bound,) = pipeline.derive_for_roots(model, model.transfer_functions, is_explained=True)
    assert not isinstance(passive_bound(bound, 1), Refused)


def test_a_source_that_multiplies_its_input_multiplies_the_bound():
    # Between two places: what lies beyond a circle is a thousand times what a unit force leaves there.
    beams = f'one = {{ type = "beam", between = ["ground", "p"], {UNIT}, {WHOLE} }}\n' + (
        f'two = {{ type = "beam", between = ["p", "x"], {UNIT}, {WHOLE} }}\n'
        'd = { type = "damper", between = ["x", "ground"], b = "1 N*s/m" }\n'
    )
    rests = []
    for drive in ['inputs.F = { force = "x" }', 'inputs.F = {}\nparameters.g = "1000 N"']:
        source = 'f = { type = "force_source", at = "x", f = "g*F" }' if "g =" in drive else ""
        model = loads(f'symflex = 1\n{drive}\noutputs.X = "p"\n[elements]\n{beams}{source}')
        found = passive_bound(model.transfer_function("X", "F").bind().bound, 1)
        rests.append(found[0].rest(3.0, 1, SampleTimes.of(TIMES)).always)
    assert float(rests[1] / rests[0]) == pytest.approx(1000, rel=1e-9)
