"""Long chains with rational numbers: exact transfer functions and certified poles, against other ways.

The task is the driving-point receptance of a free chain of N masses whose every m, k and b is a number, as an
exact quotient of polynomials in s; then all its poles and zeros at 30 digits. symflex starts from a resolved
model, SymPy from the finished matrix over ZZ[s], Lcapy from its own description. Times are processor times.
"""

from __future__ import annotations

import sympy

from benchmarks.measure import (
    Claim,
    Extent,
    Measured,
    Measurement,
    interpreter_with,
    milliseconds,
    run_snippet,
    times_as_fast,
)

SIZES, QUICK_SIZES = (10, 50, 200), (30,)
LARGEST = 200
CEILING = 1.0
"""Seconds the exact transfer function of the largest chain may take."""
ROOT_CEILINGS = {"undamped": 1.0, "damped": 4.0}
"""Seconds for all its poles and zeros, proved, at 30 digits."""
FLOOR = 10.0
"""Times as fast as the fastest other way, at so many masses."""
COMPARED = (30, 50)

SYMFLEX = """
import time
from benchmarks.numeric_chain import specification
from symflex import pipeline
from symflex.roots import locate  # imported before the clock starts, as the other ways' libraries are

model = pipeline.loads(specification({n}, damped={damped}))
begin = time.process_time()
(bound,) = pipeline.derive_bound(model, model.transfer_functions)
{then}
print(time.process_time() - begin)
"""
ROOTS = """
begin = time.process_time()
found = pipeline.roots(bound, None, 30)
assert found.certificate.certified and len(found.poles) == 2 * {n} - 1, found.certificate
"""

SYMPY = """
import time
from sympy import Matrix, Symbol, ZZ
from sympy.polys.matrices import DomainMatrix
from benchmarks.numeric_chain import values

s = Symbol("s")
n = {n}
rows = [[0 * s] * n for _ in range(n)]
for i, (m, k, b) in enumerate(values(n)):
    rows[i][i] += m * s**2
    if i < n - 1:
        w = k + b * s
        rows[i][i] += w
        rows[i + 1][i + 1] += w
        rows[i][i + 1] -= w
        rows[i + 1][i] -= w
exact = [DomainMatrix.from_Matrix(Matrix(a)).convert_to(ZZ[s]) for a in (rows, [r[1:] for r in rows[1:]])]
begin = time.process_time()
for a in exact:
    a.{method}
print(time.process_time() - begin)
"""
SYMPY_METHODS = {"det()": "det()", "charpoly()": "charpoly()[-1]"}
SYMPY_WAY = "SymPy `DomainMatrix.{}` over ZZ[s]"
FASTEST = SYMPY_WAY.format("charpoly()")
"""The fastest other way, and the only one that a quick run compares with."""

END = "print(time.process_time() - begin)"
FEW = 6
POLES_FLOOR = 40.0
"""Times as fast as other ways with thirty digits or a proof, at six masses."""
COEFFICIENTS = """
import time
from benchmarks.numeric_chain import coefficients

num, den = coefficients({n})
"""
MPMATH = "mpmath `polyroots`, 30 digits"
POLE_WAYS = {
    MPMATH: """
import mpmath

mpmath.mp.dps = 30
begin = time.process_time()
for each in (num, den):
    mpmath.polyroots(each, maxsteps=500, extraprec=200)
""",
    "sympy.physics.control `poles()` and `zeros()`, exact, without digits": """
from sympy import Poly, Symbol
from sympy.physics.control import TransferFunction

s = Symbol("s")
system = TransferFunction(Poly(num, s).as_expr(), Poly(den, s).as_expr(), s)
begin = time.process_time()
system.poles(), system.zeros()
""",
    "`numpy.roots`, double precision, no proof": """
import numpy as np

begin = time.process_time()
for each in (num, den):
    np.roots([float(c) for c in each])
""",
}
UNPROVED = "`numpy.roots`, double precision, no proof"

LCAPY = """
import time
from lcapy import Circuit

def values(n):
    return [(2 + i % 7, 1000 + 37 * (i % 11), 1 + i % 5) for i in range(n)]

lines = []
for i, (m, k, b) in enumerate(values({n}), 1):
    lines.append(f"C{{i}} {{i}} 0 {{m}}")
    if i < {n}:
        lines += [f"L{{i}} {{i}} {{i + 1}} {{{{1/{{k}}}}}}", f"R{{i}} {{i}} {{i + 1}} {{{{1/{{b}}}}}}"]
circuit = Circuit("\\n".join(lines))
begin = time.process_time()
circuit.impedance(1, 0).N
print(time.process_time() - begin)
"""


def values(n: int) -> list[tuple[int, int, int]]:
    """Return m, k and b of every mass and the link after it."""
    return [(2 + i % 7, 1000 + 37 * (i % 11), 1 + i % 5) for i in range(n)]


def specification(n: int, *, damped: bool) -> str:
    """Return the specification of a chain with these numbers."""
    lines = ["symflex = 1", 'inputs = { F = { force = "x_1" } }', 'outputs = { X = "x_1" }', "[elements]"]
    for i, (m, k, b) in enumerate(values(n), 1):
        lines.append(f'm_{i} = {{ type = "mass", at = "x_{i}", m = "{m} kg" }}')
        if i < n:
            ends = f'between = ["x_{i}", "x_{i + 1}"]'
            lines.append(f'k_{i} = {{ type = "spring", {ends}, k = "{k} N/m" }}')
            if damped:
                lines.append(f'b_{i} = {{ type = "damper", {ends}, b = "{b} N*s/m" }}')
    return "\n".join(lines)


def coefficients(n: int) -> tuple[list[int], list[int]]:
    """Return the coefficients of numerator and denominator of the damped chain, highest power first.

    From determinants over ZZ[s], by SymPy.
    """
    s = sympy.Symbol("s")
    rows = [[sympy.Integer(0)] * n for _ in range(n)]
    for i, (m, k, b) in enumerate(values(n)):
        rows[i][i] += m * s**2
        if i < n - 1:
            for row, column, sign in ((i, i, 1), (i + 1, i + 1, 1), (i, i + 1, -1), (i + 1, i, -1)):
                rows[row][column] += sign * (k + b * s)
    minors = (sympy.Matrix([r[1:] for r in rows[1:]]), sympy.Matrix(rows))
    num, den = (sympy.Poly(a.det(method="berkowitz"), s).all_coeffs() for a in minors)
    return [int(c) for c in num], [int(c) for c in den]


def measure(extent: Extent) -> Measured:
    """Measure the transfer function at every size, the roots at the largest, and those of a short chain."""
    limit = extent.limit
    found: list[Measurement] = []
    claims: list[Claim] = []
    gone: set[str] = set()
    for n in extent.of(SIZES, QUICK_SIZES):
        task = f"exact transfer function of {n} masses with numbers"
        ours = run_snippet(task, "symflex", SYMFLEX.format(n=n, damped=True, then=""), limit)
        theirs, others = [], _others(n)
        for way in extent.of(list(others), [FASTEST]):
            if way not in gone:
                interpreter, code = others[way]
                theirs.append(run_snippet(task, way, code, limit, interpreter))
        gone |= {other.way for other in theirs if other.seconds is None}
        found += [ours, *theirs]
        if n in COMPARED and theirs:
            ratio = times_as_fast(ours, *theirs)
            claims.append(
                Claim(f"{n} masses with numbers: times as fast as the fastest other way", FLOOR, ratio)
            )
        if n == LARGEST:
            claims.append(milliseconds(f"{n} masses with numbers: milliseconds", CEILING, ours))
    for kind, ceiling in extent.of(ROOT_CEILINGS, {}).items():
        task = f"poles and zeros of {LARGEST} masses, {kind}, proved at 30 digits"
        then = ROOTS.format(n=LARGEST)
        code = SYMFLEX.format(n=LARGEST, damped=kind == "damped", then=then)
        ours = run_snippet(task, "symflex", code, limit)
        found.append(ours)
        claims.append(milliseconds(f"{task}: milliseconds", ceiling, ours))
    ours, *theirs = _pole_ways(limit, extent.of(list(POLE_WAYS), [MPMATH]))
    ratio = times_as_fast(ours, *(other for other in theirs if other.way != UNPROVED))
    text = f"{FEW} masses, poles and zeros: times as fast as the fastest other way with digits or proof"
    claims.append(Claim(text, POLES_FLOOR, ratio))
    return Measured([*found, ours, *theirs], claims)


def _pole_ways(limit: float, ways: list[str]) -> list[Measurement]:
    """Return how long poles and zeros of a short chain take, by symflex and by other ways."""
    task = f"poles and zeros of {FEW} masses, damped"
    code = SYMFLEX.format(n=FEW, damped=True, then=ROOTS.format(n=FEW))
    start = COEFFICIENTS.format(n=FEW)
    ours = run_snippet(task, "symflex, proved, 30 digits", code, limit)
    return [ours, *(run_snippet(task, way, start + POLE_WAYS[way] + END, limit) for way in ways)]


def _others(n: int) -> dict[str, tuple[str, str]]:
    """Return the other ways that can run here: interpreter and code."""
    ways: dict[str, tuple[str, str]] = {}
    if (interpreter := interpreter_with("sympy")) is not None:
        for name, method in SYMPY_METHODS.items():
            ways[SYMPY_WAY.format(name)] = interpreter, SYMPY.format(n=n, method=method)
    if (interpreter := interpreter_with("lcapy")) is not None:
        ways["Lcapy `Circuit.impedance`"] = interpreter, LCAPY.format(n=n)
    return ways
