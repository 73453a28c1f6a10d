"""Other programs beside symflex at the work that people use them for, each checked to give the same numbers.

Every way prepares its input, works, and gives numbers: those are compared with a solution by hand in numpy
(of a frame, with modes that symflex proved). Only the work is timed, in processor time with one thread, after
the same work on other input: no import counts, and no result is remembered. A peer that is not installed is
left out. What a peer leaves undone (a proof, the choice of an order) is said in its row.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from benchmarks import frames
from benchmarks.measure import (
    OWN,
    Claim,
    Extent,
    Measured,
    Measurement,
    interpreter_with,
    run_snippet,
    times_as_fast,
)
from symflex import pipeline
from symflex.roots import Modes

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

NESTED_SECTIONS: Final = (8, 10)
EXPANDED_SECTIONS: Final = (5, 8)
STOREYS: Final = 10
POINTS: Final = 12
"""How many gains and how many delays TDCpy finds the roots at: every pair of them."""


@dataclass(frozen=True, slots=True)
class Task:
    """What is done, by whom, and what comes out.

    Parameters
    ----------
    name : str
        In words.
    given, before : object
        The input, and other input for the first run, which is not timed.
    expected : callable
        Returns the numbers that come out.
    agreement : float
        The largest relative difference from them.
    ours : mapping
        Code by way; the first is compared.
    theirs : mapping
        A module that must be installed, and code, by way.
    floor : float
        How many times as fast as the fastest peer symflex is at least: below one where the peer is faster.
    """

    name: str
    given: object
    before: object
    expected: Callable[[], Sequence[complex]]
    agreement: float
    ours: Mapping[str, str]
    theirs: Mapping[str, tuple[str, str]]
    floor: float


BEGIN = """
import os
os.environ["OPENBLAS_NUM_THREADS"] = "1"    # the time of one processor
import time
import numpy as np

def prepare(given):
    return given
"""
END = """
values(work(prepare({before!r})))
prepared = prepare({given!r})
begin = time.process_time()
result = work(prepared)
taken = time.process_time() - begin
found, expected = list(values(result)), {expected!r}
unknown = sum(bool(a != a) for a in found)
if len(found) != len(expected) or 20 * unknown > len(found):
    raise AssertionError(found)
if any(abs(a - b) > {agreement!r} * abs(b) for a, b in zip(found, expected)):
    raise AssertionError((found, expected))
print(taken)
"""
"""What is not decided is nan, and at most a twentieth may be."""


def measure(extent: Extent) -> Measured:
    """Measure every task that has a peer here; in a quick run, what the bounds need."""
    found: list[Measurement] = []
    claims: list[Claim] = []
    for make in TASKS:
        task = make()
        peers = {
            way: python for way, (module, _) in task.theirs.items() if (python := interpreter_with(module))
        }
        if not peers:
            continue
        end = END.format(
            given=task.given, before=task.before, expected=task.expected(), agreement=task.agreement
        )
        ours = [
            run_snippet(task.name, way, BEGIN + code + end, max(extent.limit, OWN))
            for way, code in list(task.ours.items())[: extent.of(None, 1)]
        ]
        theirs = [
            run_snippet(task.name, way, BEGIN + task.theirs[way][1] + end, extent.limit, interpreter)
            for way, interpreter in peers.items()
        ]
        found += [*ours, *theirs]
        text = f"{task.name}: times as fast as the fastest peer"
        claims.append(Claim(text, task.floor, times_as_fast(ours[0], *theirs)))
    return Measured(found, claims)


# ----------------------------------------------------------------------- ladders of R and C in symbols

LADDER_VALUES = """
def letters(n):
    return {f"{c}{i}": 0.5 + (i % 7) / 4 + (c == "C") / 8 for c in "RC" for i in range(1, n + 1)}

S = 0.03 + 0.07j
"""
LADDER_SYMFLEX = (
    LADDER_VALUES
    + """
import tempfile
from pathlib import Path
import symflex

def prepare(n):
    lines = [f"R{i} n{i - 1} n{i} 1k\\nC{i} n{i} 0 1u" for i in range(1, n + 1)]
    whole = ["ladder", "V1 n0 0 AC 1", *lines, ".ac dec 10 1 1k", f".print ac v(n{n})", ".end"]
    path = Path(tempfile.mkdtemp()) / "ladder.cir"
    path.write_text("\\n".join(whole))
    return path, n

def values(result):
    function, n = result
    return [complex(function.bind(**letters(n))(S))]

def work(prepared):
    path, n = prepared
    model = symflex.load(path)
"""
)
LADDER_NESTED = """
    return model.nested(f"V_n{n}", "V1"), n
"""
LADDER_EXPANDED = """
    function = model.transfer_function(f"V_n{n}", "V1")
    function.exact.ratio
    return function, n
"""
LADDER_VALUE = (
    LADDER_VALUES
    + """
import math
import sympy

def number(formula, known):
    # Each subexpression once: a formula that is not expanded shares most of them.
    if formula not in known:
        parts = [number(part, known) for part in formula.args]
        if not parts:
            known[formula] = complex(formula)
        elif formula.is_Pow:
            known[formula] = parts[0] ** parts[1]
        else:
            known[formula] = math.prod(parts) if formula.is_Mul else sum(parts)
    return known[formula]

def values(result):
    formula, n = result
    named = letters(n) | {"s": S}
    return [number(formula, {x: named[str(x)] for x in formula.free_symbols})]
"""
)
LADDER_SYCAN = (
    LADDER_VALUE
    + """
from sycan import Circuit, cas
from sycan.mna import solve_ac

def work(n):
    circuit = Circuit()
    circuit.add_vsource("V1", "n0", "0", 1, ac_value=1)
    for i in range(1, n + 1):
        circuit.add_resistor(f"R{i}", f"n{i - 1}", f"n{i}", cas.Symbol(f"R{i}"))
        circuit.add_capacitor(f"C{i}", f"n{i}", "0", cas.Symbol(f"C{i}"))
    solution = solve_ac(circuit)
    (found,) = (value for name, value in solution.items() if str(name) == f"V(n{n})")
    return sympy.sympify(found), n
"""
)
LADDER_SYMPY = (
    LADDER_VALUE
    + """
def work(n):
    s = sympy.Symbol("s")
    R, C = ([sympy.Symbol(f"{c}{i}") for i in range(1, n + 1)] for c in "RC")
    A, b = sympy.zeros(n, n), sympy.zeros(n, 1)
    for i in range(n):
        A[i, i] += s * C[i] + 1 / R[i]
        if i:
            A[i - 1, i - 1] += 1 / R[i]
            A[i - 1, i] = A[i, i - 1] = -1 / R[i]
    b[0] = 1 / R[0]
    return A.LUsolve(b)[n - 1], n
"""
)
LADDER_LCAPY = (
    LADDER_VALUE
    + """
from lcapy import Circuit

def work(n):
    lines = [f"R{i} {i - 1 if i > 1 else 'in'} {i}\\nC{i} {i} 0" for i in range(1, n + 1)]
    found = Circuit("\\n".join(lines)).transfer("in", 0, str(n), 0)
    return found.sympy, n
"""
)
LADDER_SYMCIRC = (
    LADDER_VALUE
    + """
import symcirc

def work(n):
    lines = [f"R{i} {i} {i + 1} 1k\\nC{i} {i + 1} 0 1u" for i in range(1, n + 1)]
    netlist = "ladder\\nV1 1 0 dc 1 ac 1\\n" + "\\n".join(lines)
    found = symcirc.AnalyseCircuit(netlist, "TF", method="two_graph_node")
    return found.transfer_function("1", str(n + 1)), n
"""
)


IS_EXPANDED = """
by_numbers = values

def values(result):
    for part in sympy.fraction(result[0]):
        if sympy.expand(part) != part:
            raise AssertionError
    return by_numbers(result)
"""
CANCELLED = (
    IS_EXPANDED
    + """
solved = work

def work(n):
    found, n = solved(n)
    return sympy.cancel(found), n
"""
)


def ladder_value(n: int) -> complex:
    """Return V_n/V_1 of the ladder, from its open end: one section after the other."""
    s, voltage, current = 0.03 + 0.07j, 1 + 0j, 0j
    for i in range(n, 0, -1):
        resistance = 0.5 + (i % 7) / 4
        current += s * (resistance + 1 / 8) * voltage
        voltage += resistance * current
    return 1 / voltage


def _nested(n: int) -> Task:
    ours = {"symflex, nested form": LADDER_SYMFLEX + LADDER_NESTED}
    theirs = {
        "sycan `solve_ac`, all nodes": ("sycan", LADDER_SYCAN),
        "SymPy `Matrix.LUsolve`, all nodes": ("sympy", LADDER_SYMPY),
        "Lcapy `Circuit.transfer`": ("lcapy", LADDER_LCAPY),
    }
    return Task(
        f"ladder of {n} sections, nested",
        n,
        2,
        lambda: [ladder_value(n)],
        1e-9,
        ours,
        theirs,
        FLOORS["nested"],
    )


def _expanded(n: int) -> Task:
    ours = {"symflex, expanded": LADDER_SYMFLEX + LADDER_EXPANDED}
    theirs = {
        "Lcapy `Circuit.transfer`, then SymPy `cancel`": ("lcapy", LADDER_LCAPY + CANCELLED),
        "symcirc, two-graph method": ("symcirc", LADDER_SYMCIRC + IS_EXPANDED),
    }
    return Task(
        f"ladder of {n} sections, expanded",
        n,
        2,
        lambda: [ladder_value(n)],
        1e-9,
        ours,
        theirs,
        FLOORS["expanded"],
    )


# --------------------------------------------------------------------- largest magnitude of ten masses

TEN = 10
PEAK_SYMFLEX = """
import symflex

def values(peak):
    if not peak.certified:
        raise AssertionError
    return [float(peak.magnitude)]

def loaded(k):
    text = ['symflex = 1\\n[parameters]\\nm = "1 kg"\\nb = "0.5 N*s/m"', f'k = "{k} N/m"\\n[elements]']
    for i in range(10):
        ends = f'["{f"x{i - 1}" if i else "ground"}", "x{i}"]'
        text.append(f'mass{i} = {{ type = "mass", at = "x{i}", m = "m" }}')
        text.append(f'spring{i} = {{ type = "spring", between = {ends}, k = "k" }}')
        text.append(f'damper{i} = {{ type = "damper", between = {ends}, b = "b" }}')
    return symflex.loads("\\n".join([*text, '[inputs]\\nF = { force = "x9" }\\n[outputs]\\ny = "x9"']))
"""
PEAK_ALONE = """
def prepare(k):
    model = loaded(k)
    model.transfer_function("y", "F")
    return model

def work(model):
    return model.peak("y", "F")
"""
PEAK_WHOLE = """
def work(k):
    return loaded(k).peak("y", "F")
"""
PEAK_MATRICES = """
def prepare(k):
    links = 2 * np.eye(10) - np.eye(10, k=1) - np.eye(10, k=-1)
    links[9, 9] = 1
    A = np.block([[np.zeros((10, 10)), np.eye(10)], [-k * links, -0.5 * links]])
    return A, np.eye(20)[:, 19:], np.eye(20)[9:10]

def values(peak):
    return [float(peak)]
"""
PEAK_SLYCOT = (
    PEAK_MATRICES
    + """
import slycot

def work(system):
    A, B, C = system
    return slycot.ab13dd("C", "I", "N", "D", 20, 1, 1, A, np.eye(20), B, C, np.zeros((1, 1)), tol=1e-12)[0]
"""
)
PEAK_CONTROL = (
    PEAK_MATRICES
    + """
import control

def work(system):
    return control.system_norm(control.ss(*system, 0), "inf", tol=1e-12, method="scipy")
"""
)


def ten_masses_peak(k: float = 1000.0, b: float = 0.5) -> float:
    """Return the largest |y/F|, on finer and finer grids of frequencies."""
    links = 2 * np.eye(TEN) - np.eye(TEN, k=1) - np.eye(TEN, k=-1)
    links[-1, -1] = 1
    strengths, shapes = np.linalg.eigh(links)
    low, high, most = 0.0, 70.0, 0.0
    for _ in range(6):
        omega = np.linspace(low, high, 4001)
        s = 1j * omega[:, None]
        size = np.abs((shapes[-1] ** 2 / (s * s + (k + b * s) * strengths)).sum(axis=1))
        at, step = omega[int(np.argmax(size))], omega[1] - omega[0]
        low, high, most = max(0.0, at - step), at + step, float(size.max())
    return most


def _peak() -> Task:
    ours = {
        "symflex, proved, from the model": PEAK_SYMFLEX + PEAK_ALONE,
        "symflex, proved, from the text": PEAK_SYMFLEX + PEAK_WHOLE,
    }
    theirs = {
        "slycot `ab13dd`, from matrices, no proof": ("slycot", PEAK_SLYCOT),
        "`control.system_norm`, without slycot, no proof": ("control", PEAK_CONTROL),
    }
    name = "largest magnitude of ten masses"
    return Task(name, 1000.0, 900.0, lambda: [ten_masses_peak()], 1e-9, ours, theirs, FLOORS["peak"])


# ----------------------------------------------------------------------------- fit of five noisy modes

FREQUENCIES: Final = (20.0, 45.0, 80.0, 120.0, 160.0)
FIT_DATA = """
def data(seed):
    rng = np.random.default_rng(seed)
    f = np.linspace(5, 200, 2000)
    s = 2j * np.pi * f
    omega = 2 * np.pi * np.array([20, 45, 80, 120, 160])
    zeta, residue = [0.01, 0.02, 0.008, 0.015, 0.01], [1, 0.7, 0.5, -0.4, 0.3]
    H = sum(r / (s * s + 2 * z * w * s + w * w) for r, z, w in zip(residue, zeta, omega))
    noise = rng.standard_normal((4, f.size))
    return f, H * (1 + 0.01 * (noise[0] + 1j * noise[1])) + 1e-7 * (noise[2] + 1j * noise[3])
"""
FIT_SYMFLEX = (
    FIT_DATA
    + """
import tempfile
from pathlib import Path
import symflex

def prepare(seed):
    path = Path(tempfile.mkdtemp()) / "five.csv"
    rows = [f"{f:.6f},{h.real:.8e},{h.imag:.8e}" for f, h in zip(*data(seed))]
    path.write_text("f_Hz,re,im\\n" + "\\n".join(rows) + "\\n")
    return path

def values(fit):
    return sorted(fit.frequencies_hz.tolist())

def work(path):
"""
)
FIT_FOUND, FIT_GIVEN = "    return symflex.fit(path)\n", "    return symflex.fit(path, modes=5)\n"
FIT_SKRF = (
    FIT_DATA
    + """
import warnings
import skrf
from skrf.vectorFitting import VectorFitting

warnings.simplefilter("ignore")

def prepare(seed):
    f, H = data(seed)
    return skrf.Network(f=f, f_unit="Hz", s=(H / abs(H).max()).reshape(-1, 1, 1), z0=50)

def values(poles):
    return sorted(abs(poles) / (2 * np.pi))

def work(network):
    fitting = VectorFitting(network)
    fitting.vector_fit(n_poles_real=0, n_poles_cmplx=5, fit_constant=False, fit_proportional=False)
    return fitting.poles
"""
)


def _fit() -> Task:
    ours = {
        "symflex, five modes given, zeros and standard errors": FIT_SYMFLEX + FIT_GIVEN,
        "symflex, number of modes found": FIT_SYMFLEX + FIT_FOUND,
    }
    theirs = {"scikit-rf `vector_fit`, five pairs of poles given": ("skrf", FIT_SKRF)}
    name = "fit of five noisy modes"
    return Task(name, 3, 4, lambda: FREQUENCIES, 1e-3, ours, theirs, FLOORS["fit"])


# ----------------------------------------------------------------- stable region of a gain and a delay

CHART_GRID = """
POINTS = [(K, T) for K in np.linspace(5, 195, 12) for T in np.linspace(0.02, 0.48, 12)]
"""
CHART_SYMFLEX = (
    CHART_GRID
    + """
import symflex

VERDICTS = {"stable": 0.0, "undecided": float("nan")}
TEXT = '''
symflex = 1
[parameters]
m = "1 kg"
c = "1 N*s/m"
K = "20 N/m"
T = "0.05 s"
k = "STIFFNESS N/m"
[equations]
unknowns = ["x"]
equations = ["m*s^2*x + c*s*x + k*x = F - K*exp(-s*T)*(1 + 0.1*s)*x"]
[inputs]
F = {}
[outputs]
y = "x"
'''

def values(chart):
    verdicts = [chart.at(K, T) for K, T in POINTS]
    return [VERDICTS[v] if v in VERDICTS else float(v.removeprefix("unstable by ")) for v in verdicts]

def work(k):
    model = symflex.loads(TEXT.replace("STIFFNESS", str(k)))
    return model.stability(over=("K", "T"), ranges={"K": (0, 200), "T": (0, 0.5)})
"""
)
CHART_TDCPY = (
    CHART_GRID
    + """
import tdcpy

def values(counts):
    return counts

def work(k):
    counts = []
    for K, T in POINTS:
        A = np.stack([np.array([[0.0, 1.0], [-k, -1.0]]), np.array([[0.0, 0.0], [-K, -0.1 * K]])], axis=2)
        roots, _ = tdcpy.roots(tdcpy.RDDE(A=A, hA=np.array([0.0, T])), r=0.0)
        counts.append(int(np.sum(roots.real > 0)))
    return counts
"""
)


def unstable_roots(K: float, T: float, k: float = 100.0) -> float:
    """Return how many roots are in the right half-plane, by the turns of the function along the axis."""
    s = 1j * np.linspace(0, 2e3, 100_001)
    value = s * s + s + k + K * np.exp(-s * T) * (1 + 0.1 * s)
    turned = float(np.sum(np.angle(value[1:] / value[:-1])))
    return float(round((math.pi - turned) / math.pi))


def _chart() -> Task:
    grid = [(K, T) for K in np.linspace(5, 195, POINTS) for T in np.linspace(0.02, 0.48, POINTS)]
    ours = {"symflex, 99 % of the area proved": CHART_SYMFLEX}
    theirs = {"TDCpy `roots` at 144 points, no proof, nothing between": ("tdcpy", CHART_TDCPY)}
    name = "stable region of a gain and a delay"
    return Task(
        name,
        100.0,
        90.0,
        lambda: [unstable_roots(K, T) for K, T in grid],
        1e-9,
        ours,
        theirs,
        FLOORS["chart"],
    )


# ------------------------------------------------------------------------------------ modes of a frame

FRAME_SYMFLEX = """
from benchmarks.frames import specification
from symflex import pipeline
from symflex.roots import Modes

def values(found):
    return sorted(float(pole.im) for pole in found.poles if pole.im > 0)

def work(height):
    model = pipeline.loads(specification(10).replace('"3 m"', f'"{height} m"'))
    (bound,) = pipeline.derive_for_roots(model, model.transfer_functions)
    return pipeline.roots(bound, Modes(10), 15)
"""
FRAME_PYDYNSM = """
import contextlib
import io
import pydynsm
from scipy.optimize import brentq

PROPERTIES = {"E": 210e9, "A": 5.38e-3, "rho": 7850.0, "ksi": 0.0}

def values(modes):
    return modes

def work(height):
    with contextlib.redirect_stdout(io.StringIO()):
        frame = pydynsm.Assembler("frame")
        node = {(x, i): frame.CreateNode(6.0 * x, -height * i) for i in range(11) for x in (0, 1)}
        columns = [(node[x, i], node[x, i + 1]) for i in range(10) for x in (0, 1)]
        for x in (0, 1):
            node[x, 0].fix_node("x", "z", "phi_y")
        for ends in columns + [(node[0, i], node[1, i]) for i in range(1, 11)]:
            member = frame.CreateElement(list(ends))
            member.SetSection("Rod", dict(PROPERTIES))
            member.SetSection("EulerBernoulli Beam", PROPERTIES | {"Ib": 8.36e-5, "Wb": 1.0})
        frame.run_connectivity()

    def determinant(omega):
        sign, size = np.linalg.slogdet(frame.GlobalConstrainedStiffness(omega).real)
        return sign * np.exp((size - 1000) / 100)

    modes, low, left = [], 0.05, determinant(0.05)
    while len(modes) < 10:
        high = low + 1.0
        right = determinant(high)
        if left * right < 0:
            modes.append(brentq(determinant, low, high, xtol=1e-9))
        low, left = high, right
    return modes
"""


def frame_modes() -> list[float]:
    """Return the frequencies that symflex proved: what each way gives must lie there."""
    model = pipeline.loads(frames.specification(STOREYS))
    (bound,) = pipeline.derive_for_roots(model, model.transfer_functions)
    return sorted(float(pole.im) for pole in pipeline.roots(bound, Modes(10), 15).poles if pole.im > 0)


def _frame() -> Task:
    ours = {"symflex, proved": FRAME_SYMFLEX}
    theirs = {"PyDynSM, signs of its determinant every rad/s, no proof": ("pydynsm", FRAME_PYDYNSM)}
    name = "ten frequencies of a frame of 30 members"
    return Task(name, 3, 2.9, frame_modes, 1e-6, ours, theirs, FLOORS["frame"])


# ----------------------------------------------------------------------------- linearisation of an arm

ARM_VALUES = """
VALUES = {"m_1": 2, "m_2": 1.5, "l_1": 0.4, "l_2": 0.3, "b": 0.2, "g": 9.81, "p_1": 0.5, "p_2": 0.7}
S = 1 + 2j
"""
ARM_SYMFLEX = (
    ARM_VALUES
    + '''
import symflex

TEXT = """
symflex = 1
[parameters]
m_1 = {}
m_2 = {}
l_1 = {}
l_2 = {}
b = {}
g = {}
p_1 = {}
p_2 = {}
[energy]
coordinates = ["q_1", "q_2"]
kinetic = "m_1*l_1^2*q_1'^2/2 + m_2*(X'^2 + Y'^2)/2"
potential = "m_1*g*l_1*sin(q_1) + m_2*g*Y"
dissipation = "b*(q_1'^2 + q_2'^2)/2"
forces = { q_1 = "tau_1", q_2 = "tau_2" }
[operating_point]
q_1 = "p_1"
q_2 = "p_2"
tau_1 = "tau_10"
tau_2 = "tau_20"
solve = ["tau_10", "tau_20"]
[inputs]
tau_1 = {}
tau_2 = {}
[outputs]
Q_1 = "q_1"
Q_2 = "q_2"
"""
def values(functions):
    return [complex(function.bind(**VALUES)(S)) for function in functions]

def work(letter):
    hand = {"X": "(l_1*cos(q_1) + l_2*cos(q_1 + q_2))", "Y": "(l_1*sin(q_1) + l_2*sin(q_1 + q_2))"}
    text = TEXT.replace("X'", hand["X"] + "'").replace("Y", hand["Y"])
    model = symflex.loads(text.replace("q_", letter + "_"))
    return model.transfer_functions()
'''
)
ARM_SYMPY = (
    ARM_VALUES
    + """
import sympy
from sympy import cos, sin
from sympy.physics.mechanics import LagrangesMethod, ReferenceFrame, dynamicsymbols

def values(functions):
    named = VALUES | {"s": S}
    return [complex(sympy.N(f.subs({x: named[str(x)] for x in f.free_symbols}))) for f in functions]

def work(letter):
    q, tau = dynamicsymbols(f"{letter}_1 {letter}_2"), dynamicsymbols("tau_1 tau_2")
    t = dynamicsymbols._t
    v = [x.diff(t) for x in q]
    m_1, m_2, l_1, l_2, b, g, p_1, p_2, s = sympy.symbols("m_1 m_2 l_1 l_2 b g p_1 p_2 s")
    x, y = l_1 * cos(q[0]) + l_2 * cos(q[0] + q[1]), l_1 * sin(q[0]) + l_2 * sin(q[0] + q[1])
    kinetic = m_1 * l_1**2 * v[0] ** 2 / 2 + m_2 * (x.diff(t) ** 2 + y.diff(t) ** 2) / 2
    potential = m_1 * g * l_1 * sin(q[0]) + m_2 * g * y
    ground = ReferenceFrame("N")
    upper = ground.orientnew("A", "Axis", [q[0], ground.z])
    lower = upper.orientnew("B", "Axis", [q[1], upper.z])
    first, second = (torque - b * speed for torque, speed in zip(tau, v))
    torques = [(upper, (first - second) * ground.z), (lower, second * ground.z)]
    method = LagrangesMethod(kinetic - potential, q, forcelist=torques, frame=ground)
    method.form_lagranges_equations()
    rest = {q[0]: p_1, q[1]: p_2} | {x: 0 for x in v} | {x.diff(t): 0 for x in v}
    A, B, _ = method.linearize(q_ind=q, qd_ind=v, A_and_B=True, op_point=rest)
    return list((s * sympy.eye(4) - A).LUsolve(B)[:2, :])
"""
)


def arm_values() -> list[complex]:
    """Return both angles over both torques at s = 1 + 2j, from matrices of mass, damping and stiffness."""
    s, m, M, upper, lower, b, g, p, q = 1 + 2j, 2, 1.5, 0.4, 0.3, 0.2, 9.81, 0.5, 0.7
    folded, weight = upper * lower * math.cos(q), -M * g * lower * math.sin(p + q)
    first = (m + M) * upper**2 + M * lower**2 + 2 * M * folded
    coupled = M * (lower**2 + folded)
    mass = np.array([[first, coupled], [coupled, M * lower**2]])
    stiffness = np.array([[weight - (m + M) * g * upper * math.sin(p), weight], [weight, weight]])
    return [complex(x) for x in np.linalg.inv(mass * s * s + b * s * np.eye(2) + stiffness).ravel()]


def _arm() -> Task:
    ours = {"symflex, `derive`": ARM_SYMFLEX}
    theirs = {"SymPy `LagrangesMethod.linearize`, then `LUsolve`, not reduced": ("sympy", ARM_SYMPY)}
    return Task(
        "two-link arm, linearised in symbols", "q", "r", arm_values, 1e-9, ours, theirs, FLOORS["arm"]
    )


FLOORS: Final[Mapping[str, float]] = {
    "nested": 0.8,
    "expanded": 4.0,
    "peak": 0.003,
    "fit": 0.04,
    "chart": 0.02,
    "frame": 1.0,
    "arm": 2.5,
}
TASKS: Final[tuple[Callable[[], Task], ...]] = (
    *(lambda n=n: _nested(n) for n in NESTED_SECTIONS),
    *(lambda n=n: _expanded(n) for n in EXPANDED_SECTIONS),
    _peak,
    _fit,
    _chart,
    _frame,
    _arm,
)
