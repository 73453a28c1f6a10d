"""Laws whose wavenumbers are equal, or whose characteristic polynomial factors, against matrix exponentials.

Every case gives the equations once more as a first-order system, with numbers only: `z' = A(s) z`, conditions
at points, and what is seen. mpmath solves that; nothing is divided by a difference of wavenumbers there.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import pi, sqrt
from typing import TYPE_CHECKING

import numpy as np
import pytest
from mpmath import expm, eye, findroot, lu_solve, matrix, mp, mpc, mpf
from scipy import linalg

import symflex
from benchmarks.generated import imported
from symflex import pipeline
from symflex.roots import Modes, Rectangle
from symflex.transfer.bind import is_degenerate
from tests.independent.winding import count_inside

if TYPE_CHECKING:
    from collections.abc import Callable

POINTS = (0.03 + 0.01j, 0.4 + 2j, -0.3 + 7j)
"""[rad/s]"""
DIGITS = 30
EXPORT_ERROR = 1e-11
WORST_RELATIVE_ERROR = 1e-13


@dataclass(frozen=True)
class Case:
    """A model, and the same as a boundary-value problem of numbers."""

    text: str
    slope: Callable[[mpc], list[list[mpc]]]  # A(s)
    conditions: tuple[tuple[float, dict[int, object], float], ...]  # at x, weights of states, right side
    seen: dict[str, tuple[float, int]]  # per output, x and the state


def _field(parameters: str, body: str, outputs: str) -> str:
    head = f"symflex = 1\nparameters = {{ {parameters} }}\n[fields.u]\n{body}"
    return f"{head}\n[inputs]\nF = {{}}\n[outputs]\n{outputs}\n"


def _single(c_0: Callable[[mpc], mpc], c_2: Callable[[mpc], mpc]) -> Callable[[mpc], list[list[mpc]]]:
    """Return A of ``w'''' + c_2 w'' + c_0 w = 0``."""
    return lambda s: [[0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1], [-c_0(s), 0, -c_2(s), 0]]


def _waves(couplings: Callable[[mpc], list[list[mpc]]]) -> Callable[[mpc], list[list[mpc]]]:
    """Return A of ``u_i'' = sum(couplings[i][j] u_j)``, states ``u_1, u_1', u_2, ...``."""

    def slope(s: mpc) -> list[list[mpc]]:
        rows = []
        for i, row in enumerate(couplings(s)):
            rows.append([int(j == 2 * i + 1) for j in range(2 * len(row))])
            rows.append([x for c in row for x in (c, 0)])
        return rows

    return slope


def _beams(couplings: Callable[[mpc], list[list[mpc]]]) -> Callable[[mpc], list[list[mpc]]]:
    """Return A of ``u_i'''' = sum(couplings[i][j] u_j)``, states ``u_1, u_1', u_1'', u_1''', u_2, ...``."""

    def slope(s: mpc) -> list[list[mpc]]:
        rows = []
        for i, row in enumerate(couplings(s)):
            rows += [[int(j == 4 * i + k + 1) for j in range(4 * len(row))] for k in range(3)]
            rows.append([x for c in row for x in (c, 0, 0, 0)])
        return rows

    return slope


PLATE = """unknowns = ["w"]
domain = ["0", "1"]
equation = "w'''' - 2*{0}*w'' + {0}^2*w = 0"
conditions = ["w'(0) = 0", "w'''(0) = F", "w''(1) = 0", "w'''(1) = 0"]"""
FREE = ((0, {1: 1}, 0), (0, {3: 1}, 1), (1, {2: 1}, 0), (1, {3: 1}, 0))
STRINGS = """unknowns = ["u", "v"]
domain = ["0", "l"]
equations = [{}]
conditions = ["u(0) = 0", "v(0) = 0", "T*u'(l) = 0", "{}*v'(l) = F"]"""
DRIVEN = ((0, {0: 1}, 0), (0, {2: 1}, 0), (1.3, {1: 1}, 0))
BEAM = """symflex = 1
[parameters]
k_f = { value = "%s N/m^2", assume = "nonnegative" }
l = "%s m"
rho = { value = "%s kg/m^3", assume = "nonnegative" }
B = "2 N*m^2"
%s
[elements.b]
type = "beam"
between = ["ground", "x"]
E = "2 Pa"
I = "1 m^4"
rho = "rho"
A = "1 m^2"
l = "l"
k_f = "k_f"
N = "N"
[elements.m]
type = "mass"
at = "x"
m = "1 kg"
[inputs]
F = { force = "x" }
[outputs]
X = "x"
"""
TENSION = 'N = { value = "%s N", assume = "real" }'
CRITICAL = '[definitions]\nN = "2*sqrt(k_f*B)"'


def _tip(tension: mpf) -> dict[int, object]:
    """Return the force on a mass of 1 kg at the end of a beam with EI = 2."""
    return {0: lambda s: s * s, 1: tension, 3: -2}


def _beam(k_f: mpf, tension: mpf, rho: float, length: float) -> dict[str, object]:
    return {
        "slope": _single(lambda s: (rho * s * s + k_f) / 2, lambda _: -tension / 2),
        "conditions": ((0, {0: 1}, 0), (0, {1: 1}, 0), (length, {2: 1}, 0), (length, _tip(tension), 1)),
        "seen": {"X": (length, 0)},
    }


CASES = {
    "identical, of s^2": Case(
        _field("c = 2", PLATE.format("((s/c)^2)"), 'X = "w(1)"'),
        _single(lambda s: (s / 2) ** 4, lambda s: -2 * (s / 2) ** 2),
        FREE,
        {"X": (1, 0)},
    ),
    "identical, of s": Case(
        _field("c = 2", PLATE.format("(s + c)"), 'X = "w(1)"\nY = "w(1/3)"'),
        _single(lambda s: (s + 2) ** 2, lambda s: -2 * (s + 2)),
        FREE,
        {"X": (1, 0), "Y": (mpf(1) / 3, 0)},
    ),
    "in a definition within a definition": Case(
        _field(
            "T = 3, mu = 2, l = 1.3, k = 5",
            STRINGS.format("\"u'' = both*u/2 + g2*v\", \"v'' = h2*v\"", "T"),
            'U = "u(l)"\nV = "v(l/2)"',
        ).replace("[fields.u]", '[definitions]\ng2 = "mu*s^2/T"\nh2 = "g2 + k/T"\nboth = "2*h2"\n[fields.u]'),
        _waves(lambda s: [[(2 * s * s + 5) / 3, 2 * s * s / 3], [0, (2 * s * s + 5) / 3]]),
        (*DRIVEN, (1.3, {3: 3}, 1)),
        {"U": (1.3, 0), "V": (0.65, 2)},
    ),
    "by the declared values": Case(
        _field(
            "T = 3, S = 6, mu = 2, nu = 4, l = 1.3",
            STRINGS.format("\"T*u'' = mu*s^2*u + mu*s^2*v/2\", \"S*v'' = nu*s^2*v\"", "S"),
            'U = "u(l)"\nV = "v(l)"',
        ),
        _waves(lambda s: [[2 * s * s / 3, s * s / 3], [0, 2 * s * s / 3]]),
        (*DRIVEN, (1.3, {3: 6}, 1)),
        {"U": (1.3, 0), "V": (1.3, 2)},
    ),
    "three times": Case(
        _field(
            "T = 3, mu = 2, l = 1.3, c = 0.4",
            """unknowns = ["u", "v", "w"]
domain = ["0", "l"]
equations = ["T*u'' = mu*s^2*u + c*mu*s^2*v", "T*v'' = mu*s^2*v + c*mu*s^2*w", "T*w'' = mu*s^2*w"]
conditions = ["u(0) = 0", "v(0) = 0", "w(0) = 0", "u'(l) = 0", "v'(l) = 0", "T*w'(l) = F"]""",
            'U = "u(l)"',
        ),
        _waves(
            lambda s: [
                [2 * s * s / 3, 0.8 * s * s / 3, 0],
                [0, 2 * s * s / 3, 0.8 * s * s / 3],
                [0, 0, 2 * s * s / 3],
            ]
        ),
        (
            (0, {0: 1}, 0),
            (0, {2: 1}, 0),
            (0, {4: 1}, 0),
            (1.3, {1: 1}, 0),
            (1.3, {3: 1}, 0),
            (1.3, {5: 3}, 1),
        ),
        {"U": (1.3, 0)},
    ),
    "of beams": Case(
        _field(
            "EI = 3, m = 2, l = 1.3",
            """unknowns = ["u", "v"]
domain = ["0", "l"]
equations = ["EI*u'''' + m*s^2*u + m*s^2*v/2 = 0", "EI*v'''' + m*s^2*v = 0"]
conditions = [
  "u(0) = 0", "u'(0) = 0", "u''(l) = 0", "u'''(l) = 0",
  "v(0) = 0", "v'(0) = 0", "v''(l) = 0", "EI*v'''(l) = F",
]""",
            'U = "u(l)"',
        ),
        _beams(lambda s: [[-2 * s * s / 3, -s * s / 3], [0, -2 * s * s / 3]]),
        (*((0, {k: 1}, 0) for k in (0, 1, 4, 5)), *((1.3, {k: 1}, 0) for k in (2, 3, 6)), (1.3, {7: 3}, 1)),
        {"U": (1.3, 0)},
    ),
    "a uniform load": Case(
        _field(
            "T = 3, mu = 2, l = 1.3",
            """unknowns = ["u", "v"]
domain = ["0", "l"]
equations = ["T*u'' = mu*s^2*u + mu*s^2*v/2", "T*v'' = mu*s^2*v - F"]
conditions = ["u(0) = 0", "v(0) = 0", "u'(l) = 0", "v'(l) = 0"]""",
            'U = "u(l/2)"',
        ),
        # The load is one more state, which stays what it is.
        lambda s: [
            [0, 1, 0, 0, 0],
            [2 * s * s / 3, 0, s * s / 3, 0, 0],
            [0, 0, 0, 1, 0],
            [0, 0, 2 * s * s / 3, 0, -mpf(1) / 3],
            [0] * 5,
        ],
        (*DRIVEN, (1.3, {3: 1}, 0), (0, {4: 1}, 1)),
        {"U": (0.65, 0)},
    ),
    "first order twice": Case(
        _field(
            "l = 2, b = 0.7",
            """unknowns = ["w"]
domain = ["0", "l"]
equation = "w'' + 2*(b + s)*w' + (b + s)^2*w = 0"
conditions = ["w(0) = F", "w'(l) + b*w(l) = 0"]""",
            'X = "w(l/2)"',
        ),
        lambda s: [[0, 1], [-((s + 0.7) ** 2), -2 * (s + 0.7)]],
        ((0, {0: 1}, 1), (2, {0: 0.7, 1: 1}, 0)),
        {"X": (1, 0)},
    ),
    "two beams that a layer joins": Case(
        _field(
            "EI = 3, m = 2, l = 1.2, K = 50",
            """unknowns = ["u", "v"]
domain = ["0", "l"]
equations = ["EI*u'''' + m*s^2*u + K*(u - v) = 0", "EI*v'''' + m*s^2*v + K*(v - u) = 0"]
conditions = [
  "u(0) = 0", "u'(0) = 0", "u''(l) = 0", "EI*u'''(l) = F",
  "v(0) = 0", "v'(0) = 0", "v''(l) = 0", "v'''(l) = 0",
]""",
            'U = "u(l)"\nV = "v(l)"',
        ),
        _beams(lambda s: [[-(2 * s * s + 50) / 3, mpf(50) / 3], [mpf(50) / 3, -(2 * s * s + 50) / 3]]),
        (*((0, {k: 1}, 0) for k in (0, 1, 4, 5)), *((1.2, {k: 1}, 0) for k in (2, 6, 7)), (1.2, {3: 3}, 1)),
        {"U": (1.2, 0), "V": (1.2, 4)},
    ),
    "two rods that a layer with damping joins": Case(
        _field(
            "EA = 3, m = 2, k = 5, c = 0.2",
            """unknowns = ["u", "v"]
domain = ["0", "1"]
equations = ["EA*u'' = m*s^2*u + (k + c*s)*(u - v)", "EA*v'' = m*s^2*v + (k + c*s)*(v - u)"]
conditions = ["u(0) = 0", "v'(0) = 0", "EA*u'(1) = F", "v'(1) = 0"]""",
            'U = "u(1)"\nV = "v(1)"',
        ),
        _waves(
            lambda s: [
                [(2 * s * s + 5 + s / 5) / 3, -(5 + s / 5) / 3],
                [-(5 + s / 5) / 3, (2 * s * s + 5 + s / 5) / 3],
            ]
        ),
        ((0, {0: 1}, 0), (0, {3: 1}, 0), (1, {1: 3}, 1), (1, {3: 1}, 0)),
        {"U": (1, 0), "V": (1, 2)},
    ),
    "three strings": Case(
        _field(
            "T = 3, mu = 2, l = 1.3, k = 7",
            """unknowns = ["u", "v", "w"]
domain = ["0", "l"]
equations = [
  "T*u'' = mu*s^2*u + k*(u - v)", "T*v'' = mu*s^2*v + k*(2*v - u - w)",
  "T*w'' = mu*s^2*w + k*(w - v)",
]
conditions = ["u(0) = 0", "v(0) = 0", "w(0) = 0", "T*u'(l) = F", "v(l) = 0", "w'(l) = 0"]""",
            'U = "u(l)"\nW = "w(l)"',
        ),
        _waves(
            lambda s: [
                [(2 * s * s + 7) / 3, -mpf(7) / 3, 0],
                [-mpf(7) / 3, (2 * s * s + 14) / 3, -mpf(7) / 3],
                [0, -mpf(7) / 3, (2 * s * s + 7) / 3],
            ]
        ),
        (
            (0, {0: 1}, 0),
            (0, {2: 1}, 0),
            (0, {4: 1}, 0),
            (1.3, {1: 3}, 1),
            (1.3, {2: 1}, 0),
            (1.3, {5: 1}, 0),
        ),
        {"U": (1.3, 0), "W": (1.3, 4)},
    ),
    "a beam without mass, by its values": Case(BEAM % (2, 8, 0, TENSION % 4), **_beam(mpf(2), mpf(4), 0, 8)),
    "the same by a root": Case(BEAM % (3, 2, 0, CRITICAL), **_beam(mpf(3), 2 * mp.sqrt(6), 0, 2)),
    "a beam, where s = 0": Case(BEAM % (8, 1, 3, TENSION % 8), **_beam(mpf(8), mpf(8), 3, 1)),
    "tension without mass": Case(BEAM % (0, 2, 0, TENSION % 5), **_beam(mpf(0), mpf(5), 0, 2)),
}


def _number(weight: object, s: mpc) -> mpc:
    return weight(s) if callable(weight) else mpc(weight)


def _system(case: Case, s: mpc) -> tuple[matrix, matrix]:
    """Return the conditions on the state at x = 0, and their right sides."""
    slope = matrix(case.slope(s))
    size = slope.rows
    rows, right = matrix(size, size), matrix(size, 1)
    for i, (x, weights, value) in enumerate(case.conditions):
        grown = expm(slope * x) if x else eye(size)
        rows[i, :] = sum((grown[k, :] * _number(w, s) for k, w in weights.items()), matrix(1, size))
        right[i] = value
    return rows, right


def _determinant(case: Case, s: mpc) -> mpc:
    """Return the determinant of the conditions in doubles: turns need its first digit only."""
    slope = np.array(case.slope(s), complex)
    grown = {x: linalg.expm(slope * float(x)) for x, *_ in case.conditions}
    rows = [sum(complex(_number(w, s)) * grown[x][k] for k, w in ws.items()) for x, ws, _ in case.conditions]
    return mpc(linalg.det(np.array(rows)))


def _value(case: Case, output: str, s: mpc) -> complex:
    x, state = case.seen[output]
    start = lu_solve(*_system(case, s))
    return complex((expm(matrix(case.slope(s)) * x) * start)[state])


def _error(got: complex, wanted: complex) -> float:
    return abs(got - wanted) / abs(wanted)


@pytest.mark.slow
def test_values_are_those_of_matrix_exponentials():
    wrong = []
    with mp.workdps(DIGITS):
        for name, case in CASES.items():
            model = pipeline.loads(case.text)
            for tf in pipeline.derive_all(model):
                bound = pipeline.bind(tf)
                errors = [_error(bound(s), _value(case, tf.output.name, mpc(s))) for s in POINTS]
                wrong += [(name, tf.name, e) for e in errors if not e < WORST_RELATIVE_ERROR]
    assert wrong == []


@pytest.mark.parametrize("name", CASES)
def test_no_formula_is_zero_over_zero_for_the_declared_values(name):
    assert not any(map(is_degenerate, pipeline.derive_all(pipeline.loads(CASES[name].text))))


COUNTED = ("identical, of s^2", "by the declared values", "three times", "a beam, where s = 0")


@pytest.mark.slow
@pytest.mark.parametrize("name", COUNTED)
def test_as_many_poles_are_certified_as_the_determinant_has_zeros(name):
    low, high, end = Fraction(-31, 10), Fraction(16, 5), Fraction(87, 10)
    model = pipeline.loads(CASES[name].text)
    (bound,) = pipeline.derive_for_roots(model, model.transfer_functions[:1])
    found = pipeline.roots(bound, Rectangle(low, high, -end, end))
    count = sum(r.multiplicity for r in (*found.poles, *(h.root for h in found.hidden)))
    corners = complex(low, -end), complex(high, end)
    wanted = count_inside(lambda s: _determinant(CASES[name], s), *corners)
    assert (found.certificate.certified, count) == (True, wanted)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["by the declared values", "of beams", "a beam without mass, by its values"])
def test_exported_code_has_the_values_too(name):
    case = CASES[name]
    functions = imported(symflex.loads(case.text).export_numpy(), "equal").TRANSFER_FUNCTIONS
    with mp.workdps(DIGITS):
        errors = [
            _error(functions[f"{output}/F"](s), _value(case, output, mpc(s)))
            for output in case.seen
            for s in (1e-3j, *POINTS, 60j)
        ]
    assert max(errors) < EXPORT_ERROR


PROPORTIONAL = """
symflex = 1
parameters = { K = "3 N/m^2", e_1 = "2 N*m^2", e_2 = "4 N*m^2", m_1 = "0.5 kg/m", m_2 = "1 kg/m" }
inputs.M = { unit = "N*m" }
outputs.U = "u(0.5 m)"
[fields.w]
unknowns = ["u", "v"]
domain = ["0", "1 m"]
equations = ["e_1*u'''' + m_1*s^2*u + K*(u - v) = 0", "e_2*v'''' + m_2*s^2*v + K*(v - u) = 0"]
conditions = [
  "u(0) = 0", "u''(0) = 0", "v(0) = 0", "v''(0) = 0",
  "u(1 m) = 0", "e_1*u''(1 m) = M", "v(1 m) = 0", "v''(1 m) = 0",
]
"""


@pytest.mark.slow
def test_beams_that_are_proportional_by_value_alone_have_wavenumbers_with_formulas():
    """At the middle modes of odd n are seen: omega^2 = 4 (n pi)^4, or that and K (1/m_1 + 1/m_2) more."""
    model = pipeline.loads(PROPORTIONAL)
    (bound,) = pipeline.derive_for_roots(model, model.transfer_functions)
    assert all(law.kind == "bending" for law in bound.kernels.dispersions)
    found = [float(r.im.mid()) for r in pipeline.roots(bound, Modes(4)).poles if r.im > 0]
    wanted = sorted(sqrt(4 * (n * pi) ** 4 + layer) for n in (1, 3) for layer in (0, 9))
    assert found == pytest.approx(wanted, rel=1e-12)


SHEARED = """
symflex = 1
inputs.F = { force = "tip" }
outputs.X = "tip"
[elements.arm]
type = "beam"
theory = "timoshenko"
between = ["ground", "tip"]
E = 1
I = 1
rho = 1
A = 1
l = 1
G = 1
kappa = 1
c_f = 0.1
"""


@pytest.mark.slow
def test_waves_of_bending_and_of_shear_may_be_equally_fast():
    # E = kappa G: for large s the wavenumbers differ by a constant, which is lost in what they are.
    def free_end(s):
        # The clamp leaves moment and shear, M' = rho I s^2 theta - V and V' = (rho A s^2 + c_f s) w.
        slope = matrix([[0, 1, 0, 1], [0, 0, 1, 0], [0, s * s, 0, -1], [s * s + s / 10, 0, 0, 0]])
        along = expm(slope, method="taylor")
        return along[2, 2] * along[3, 3] - along[2, 3] * along[3, 2]

    model = pipeline.loads(SHEARED)
    (bound,) = pipeline.derive_for_roots(model, [("X", "F")])
    found = pipeline.roots(bound, Modes(1), 15)
    assert found.certificate.certified
    for pole in found.poles:
        near = mpc(float(pole.re.mid()), float(pole.im.mid()))
        assert abs(findroot(free_end, near) - near) < 1e-12
