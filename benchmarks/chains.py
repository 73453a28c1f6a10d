"""Free-free chains of masses, every m, k and b symbolic: symflex against other ways to the same polynomials.

The task is the same for all: numerator and denominator of the driving-point receptance x_1/F_1 and of the
transfer receptance x_N/F_1, as polynomials expanded in s and all parameters. symflex starts from a resolved
model: assembling A(s), proving numerator and denominator coprime and keeping the closed form count as well.
SymPy and SymEngine start from the matrix, Lcapy from its own description, for the first function alone.
Times are processor times: other programs on the machine count little.
"""

from __future__ import annotations

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

SIZES, QUICK_SIZES = (2, 4, 6, 8, 10, 12), (8,)
COMPARED = 8
"""Masses up to which medians of eleven runs are taken; beyond, of three."""

FLOORS = {6: 10.0, 8: 85.0}
"""Per size, how many times as fast as the fastest other way: half of what docs/benchmarks.md reports."""
CEILINGS = {6: 0.003, 8: 0.030, 10: 0.3, 12: 4.0}
"""Per size, seconds from assembled equations."""
CLOSED = 16
CLOSED_CEILING = 1.0
"""Masses, and seconds, with every link's impedance k + b*s kept as one symbol."""

SYMFLEX = """
import statistics
import time
from benchmarks.chains import specification
from symflex import pipeline
from symflex.transfer import derive_all

model = pipeline.loads(specification({n}))
times, engine = [], []
for _ in range({repeats}):
    if 2 * sum(times) > {limit}:    # one more run might meet the limit, and nothing would have been measured
        break
    begin = time.process_time()
    equations = pipeline.assemble(model)
    middle = time.process_time()
    found = derive_all(equations, model.transfer_functions)
    opened = [{result} for tf in found]
    times.append(time.process_time() - begin)
    engine.append(time.process_time() - middle)
    del found, opened, equations
print(statistics.median({clock}))
"""
SYMFLEX_WAYS = {
    "symflex": {"repeats": 11, "clock": "times"},
    "symflex, first run of a process": {"repeats": 1, "clock": "times"},
    "symflex, from assembled equations": {"repeats": 11, "clock": "engine"},
}

MATRIX = """
import time
import {library} as library

n = {n}
s = library.Symbol("s")
m = [library.Symbol(f"m_{{i}}") for i in range(1, n + 1)]
k = [library.Symbol(f"k_{{i}}") for i in range(1, n)]
b = [library.Symbol(f"b_{{i}}") for i in range(1, n)]
names = (s, *m, *k, *b)
rows = [[library.Integer(0)] * n for _ in range(n)]
for i in range(n):
    rows[i][i] += m[i] * s**2
for i in range(n - 1):
    w = k[i] + b[i] * s
    rows[i][i] += w
    rows[i + 1][i + 1] += w
    rows[i][i + 1] -= w
    rows[i + 1][i] -= w
minors = [rows, [r[1:] for r in rows[1:]], [r[:-1] for r in rows[1:]]]
"""
SYMPY = """
from sympy.polys.matrices import DomainMatrix
A, *_ = minors = [library.Matrix(r) for r in minors]
exact = [DomainMatrix.from_Matrix(a).convert_to(library.ZZ[names]) for a in minors]
begin = time.process_time()
"""
SYMENGINE = """
minors = [library.DenseMatrix(r) for r in minors]
begin = time.process_time()
"""
END = "print(time.process_time() - begin)"

FASTEST = "SymPy `DomainMatrix.charpoly()` over ZZ[s, m, k, b]"
"""The fastest other way from six masses on, and the only one that a quick run compares with."""
SYMPY_WAYS = {
    "SymPy `Matrix.det(method='berkowitz')`": """
for a in minors:
    library.Poly(a.det(method="berkowitz"), *names)
""",
    "SymPy `Matrix.det(method='bareiss')`": """
for a in minors:
    library.Poly(a.det(method="bareiss"), *names)
""",
    "SymPy `DomainMatrix.det()` over ZZ[s, m, k, b]": """
for a in exact:
    a.det()
""",
    FASTEST: """
for a in exact:
    a.charpoly()[-1]
""",
    "SymPy `Matrix.LUsolve`, then `cancel`": """
x = A.LUsolve(library.eye(n)[:, 0])
library.cancel(x[0]), library.cancel(x[n - 1])
""",
}
SYMENGINE_WAYS = {
    "SymEngine `DenseMatrix.det()`, then `expand`": """
for a in minors:
    a.det().expand()
"""
}

LCAPY = """
import time
from lcapy import Circuit

n = {n}
lines = [f"C{{i}} {{i}} 0 m_{{i}}" for i in range(1, n + 1)]
lines += [f"L{{i}} {{i}} {{i + 1}} l_{{i}}" for i in range(1, n)]
lines += [f"R{{i}} {{i}} {{i + 1}} r_{{i}}" for i in range(1, n)]
circuit = Circuit("\\n".join(lines))
begin = time.process_time()
circuit.impedance(1, 0).N
"""
"""Masses as capacitors, springs as inductors, dampers as resistors: the impedance is a mobility."""


def specification(n: int) -> str:
    """Return the specification of a free-free chain of ``n`` masses.

    Examples
    --------
    >>> print(specification(2))
    symflex = 1
    parameters = { m_1 = {}, m_2 = {}, k_1 = {}, b_1 = {} }
    inputs = { F = { force = "x_1" } }
    outputs = { X_first = "x_1", X_last = "x_2" }
    <BLANKLINE>
    [elements]
    mass_1 = { type = "mass", at = "x_1", m = "m_1" }
    mass_2 = { type = "mass", at = "x_2", m = "m_2" }
    spring_1 = { type = "spring", between = ["x_1", "x_2"], k = "k_1" }
    damper_1 = { type = "damper", between = ["x_1", "x_2"], b = "b_1" }
    """
    masses, links = range(1, n + 1), range(1, n)
    names = [f"m_{i}" for i in masses] + [f"{c}_{i}" for c in "kb" for i in links]
    return "\n".join(
        [
            "symflex = 1",
            f"parameters = {{ {', '.join(f'{name} = {{}}' for name in names)} }}",
            'inputs = { F = { force = "x_1" } }',
            f'outputs = {{ X_first = "x_1", X_last = "x_{n}" }}',
            "",
            "[elements]",
            *(f'mass_{i} = {{ type = "mass", at = "x_{i}", m = "m_{i}" }}' for i in masses),
            *(
                f'{kind}_{i} = {{ type = "{kind}", between = ["x_{i}", "x_{i + 1}"], {c} = "{c}_{i}" }}'
                for kind, c in (("spring", "k"), ("damper", "b"))
                for i in links
            ),
        ]
    )


def measure(extent: Extent) -> Measured:
    """Measure every size and way, each within the limit, and compare with the fastest other way."""
    limit = extent.limit
    found: list[Measurement] = []
    claims: list[Claim] = []
    gone: set[str] = set()
    for n in extent.of(SIZES, QUICK_SIZES):
        task = f"chain of {n} masses"
        ways = extent.of(list(SYMFLEX_WAYS), ["symflex"])
        ours = [_ours(task, way, n, "tf.ratio", SYMFLEX_WAYS[way], limit) for way in ways]
        theirs, others = [], _others(n)
        for way in extent.of(list(others), [FASTEST]):
            if way not in gone:
                interpreter, code = others[way]
                theirs.append(run_snippet(task, way, code + END, limit, interpreter))
        # What reached the limit once does so at every larger size.
        gone |= {other.way for other in theirs if other.seconds is None}
        found += [*ours, *theirs]
        if n in FLOORS:
            ratio = times_as_fast(ours[0], *theirs)
            claims.append(Claim(f"{n} masses: times as fast as the fastest other way", FLOORS[n], ratio))
        if n in CEILINGS and not extent.is_quick:
            text = f"{n} masses: milliseconds from assembled equations"
            claims.append(milliseconds(text, CEILINGS[n], ours[2]))
    if extent.is_quick:
        return Measured(found, claims)
    task = f"chain of {CLOSED} masses, links kept as one symbol"
    way, asked = "symflex, first run of a process", SYMFLEX_WAYS["symflex, first run of a process"]
    closed = _ours(task, way, CLOSED, "tf.closed", asked, limit)
    claims.append(milliseconds(f"{task}: milliseconds", CLOSED_CEILING, closed))
    return Measured([*found, closed], claims)


def _ours(task: str, way: str, n: int, result: str, asked: dict[str, object], limit: float) -> Measurement:
    repeats = asked["repeats"] if n <= COMPARED else min(3, int(str(asked["repeats"])))
    code = SYMFLEX.format(n=n, result=result, repeats=repeats, clock=asked["clock"], limit=limit)
    return run_snippet(task, way, code, limit)


def _others(n: int) -> dict[str, tuple[str, str]]:
    """Return the other ways that can run here: interpreter and code."""
    ways: dict[str, tuple[str, str]] = {}
    for library, begin, codes in (("sympy", SYMPY, SYMPY_WAYS), ("symengine", SYMENGINE, SYMENGINE_WAYS)):
        interpreter = interpreter_with(library)
        if interpreter is not None:
            start = MATRIX.format(n=n, library=library) + begin
            ways |= {way: (interpreter, start + code) for way, code in codes.items()}
    interpreter = interpreter_with("lcapy")
    if interpreter is not None:
        ways["Lcapy `Circuit.impedance`, one function"] = (interpreter, LCAPY.format(n=n))
    return ways
