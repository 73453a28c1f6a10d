"""Critical speeds, loads and friction of books by ``--over``, each beside a root of its determinant.

Expected values: mpmath solves det(M(j omega, p)) = 0 in omega and p from a rough guess, with matrices that
stand here; where two poles of an undamped model meet, d det/d omega = 0 in place of the imaginary part.
"""

import pytest
from mpmath import det, diff, findroot, matrix, mp, mpf, sqrt

from symflex import loads

HEAD = "symflex = 1\nparameters = {{ {} }}\ninputs = {{ F = {{}} }}\noutputs = {{ X = '{}' }}\n[equations]\n"


def model_of(parameters, unknowns, equations):
    rows = ",\n".join(f'"{row}"' for row in equations)
    return loads(f"{HEAD.format(parameters, unknowns[0])}unknowns = {unknowns}\nequations = [\n{rows}\n]\n")


def middle_of(ball):
    return mpf(ball.mid().str(30, radius=False))


def whirl(s, p):
    return [[2 * s**2 + 95 * s + 50000, 35 * p], [-35 * p, 2 * s**2 + 95 * s + 50000]]


def wheelset(s, v):
    return [
        [1500 * s**2 + mpf("16e6") / v * s + mpf("1e6"), -mpf("16e6")],
        [mpf("16e6") * mpf("0.75") * mpf("0.15") / mpf("0.46"),
         750 * s**2 + mpf("16e6") * mpf("0.5625") / v * s + mpf("2e6")],
    ]  # fmt: skip


def section(s, v):
    lift = mpf("0.6") * mpf("0.5") * mpf("6.28") * v * v
    return [
        [12 * s**2 + 3000 + lift * s / v, mpf("0.6") * s**2 + lift],
        [mpf("0.6") * s**2 - lift * s / v / 10, mpf("0.2") * s**2 + 150 - lift / 10],
    ]


def brake(s, mu):
    return [[s**2 + s / 20 + 12 - 2 * mu, 2 - 14 * mu], [2, s**2 + s / 10 + 14]]


def shimmy(s, v):
    return [
        [mpf("0.4") * s**2 + s / 2 + 200, 20000 * mpf("0.08")],
        [-1 - mpf("0.08") * s / v, mpf("0.3") / v * s + 1],
    ]


def ground(s, w):
    return [
        [1100 * s**2 + 1000 * s + 400000, 0, 30 * s**2, 0],
        [0, 1100 * s**2 + 1000 * s + 400000, 0, 30 * s**2],
        [30 * s**2, 0, 60 * (s**2 - w**2) + 20 * s + 6000, 120 * w * s + 20 * w],
        [0, 30 * s**2, -120 * w * s - 20 * w, 60 * (s**2 - w**2) + 20 * s + 6000],
    ]


def ziegler(s, p, b=0):
    return [[3 * s**2 + 2 * b * s + 2 - p, s**2 + p - 1 - b * s], [s**2 - b * s - 1, s**2 + b * s + 1]]


def meeting(s, mu):
    return [[s**2 + 2, 1 - mu], [1, s**2 + 3]]


def shaft(s, w):  # different stiffnesses, seen from the shaft that rotates
    return [[s**2 + s / 5 + 100 - w**2, -2 * w * s - w / 5], [2 * w * s + w / 5, s**2 + s / 5 + 144 - w**2]]


WHIRL = ["2*s^2*x + 95*s*x + 50000*x + 35*p*y = F", "2*s^2*y + 95*s*y + 50000*y - 35*p*x = 0"]
WHEELSET = [
    "1500*s^2*x + 16e6/p*s*x + 1e6*x - 16e6*y = F",
    "750*s^2*y + 16e6*0.75^2/p*s*y + 2e6*y + 16e6*0.75*0.15/0.46*x = 0",
]
SECTION = [
    "12*s^2*x + 0.6*s^2*y + 3000*x + 0.6*0.5*6.28*p^2*(y + s*x/p) = F",
    "0.6*s^2*x + 0.2*s^2*y + 150*y - 0.6*0.5*0.1*6.28*p^2*(y + s*x/p) = 0",
]
BRAKE = ["s^2*x + 0.05*s*x + 12*x - 2*p*x + (2 - 14*p)*y = F", "s^2*y + 0.1*s*y + 2*x + 14*y = 0"]
SHIMMY = ["0.4*s^2*x + 0.5*s*x + 200*x + 20000*0.08*y = F", "0.3/p*s*y + y - x - 0.08/p*s*x = 0"]
GROUND = [
    "1100*s^2*x + 1000*s*x + 400000*x + 30*s^2*a = F",
    "1100*s^2*y + 1000*s*y + 400000*y + 30*s^2*b = 0",
    "60*(s^2*a + 2*p*s*b - p^2*a) + 20*(s*a + p*b) + 6000*a + 30*s^2*x = 0",
    "60*(s^2*b - 2*p*s*a - p^2*b) + 20*(s*b - p*a) + 6000*b + 30*s^2*y = 0",
]
ZIEGLER = ["3*s^2*x + s^2*y + (2 - p)*x + (p - 1)*y = F", "s^2*x + s^2*y - x + y = 0"]
DAMPED = [
    "3*s^2*x + s^2*y + (0.2*s + 2 - p)*x + (p - 1 - 0.1*s)*y = F",
    "s^2*x + s^2*y - (0.1*s + 1)*x + (0.1*s + 1)*y = 0",
]
MEETING = ["s^2*x + 2*x + (1 - p)*y = F", "s^2*y + x + 3*y = 0"]
SHAFT = [
    "s^2*x + 0.2*s*x + (100 - p^2)*x - 2*p*s*y - 0.2*p*y = F",
    "s^2*y + 0.2*s*y + (144 - p^2)*y + 2*p*s*x + 0.2*p*x = 0",
]
XY, FOUR = ["x", "y"], ["x", "y", "a", "b"]


@pytest.mark.parametrize(
    ("equations", "unknowns", "rows", "guess", "limits", "is_damped"),
    [
        (WHIRL, XY, whirl, (158, 429), (0, 1000), True),
        (WHEELSET, XY, wheelset, (40, 61), (1, 500), True),
        (SECTION, XY, section, (24, 13.5), (1, 20), True),
        (BRAKE, XY, brake, (3.5, 0.19), (0, 2), True),
        (SHIMMY, XY, shimmy, (45, 100), (1, 2000), True),
        (GROUND, FOUR, ground, (17, 26), (5, 30), True),
        (ZIEGLER, XY, ziegler, (0.84, 2.08), (0, 6), False),
        (DAMPED, XY, lambda s, p: ziegler(s, p, mpf("0.1")), (0.53, 1.47), (0, 6), True),
        (MEETING, XY, meeting, (1.58, 1.25), (0, 2), False),
    ],
    ids="whirl hunting flutter squeal shimmy ground ziegler ziegler_damped meeting".split(),
)
def test_a_critical_value_is_where_the_determinant_vanishes(
    equations, unknowns, rows, guess, limits, is_damped
):
    found = model_of(f"p = {sum(limits) / 2}", unknowns, equations).stability(over="p", limits=limits)
    with mp.workdps(40):

        def value(omega, p):
            at = det(matrix(rows(mpf(0) + 1j * omega, p)))
            other = at.imag if is_damped else diff(lambda w: det(matrix(rows(1j * w, p))).real, omega)
            return [at.real, other]

        omega, p = findroot(value, guess)
        assert found.certified
        (boundary,) = found.proved.boundaries
        (own,) = boundary.frequencies
        assert abs(middle_of(boundary.gain) / p - 1) < mpf("1e-12")
        assert abs(middle_of(own) / omega - 1) < mpf("1e-12")


def test_a_shaft_of_two_stiffnesses_is_unstable_between_its_critical_speeds():
    # Seen from the shaft, a pole passes 0 where k - Omega^2 and the damping 0.2 Omega make det M(0) = 0:
    # (100 - w^2) (144 - w^2) + 0.04 w^2 = 0, of x = w^2: x^2 - 243.96 x + 14400 = 0.
    found = model_of("p = 5", XY, SHAFT).stability(over="p", limits=(0, 20))
    with mp.workdps(30):
        middle, half = mpf("121.98"), sqrt(mpf("121.98") ** 2 - 14400)
        expected = [sqrt(middle - half), sqrt(middle + half)]
        assert found.certified
        own = [middle_of(boundary.gain) for boundary in found.proved.boundaries]
        assert [abs(x / y - 1) < mpf("1e-12") for x, y in zip(own[:2], expected, strict=True)] == [True] * 2
