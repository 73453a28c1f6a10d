"""Free-free chains of masses, every m, k and b symbolic: symflex against four ways of doing it in sympy.

The task is the same for all: numerator and denominator of the driving-point receptance x_1/F_1 and of the
transfer receptance x_N/F_1, as polynomials expanded in s and all parameters. symflex starts from a resolved
model, so that assembling A(s), cancelling common factors and keeping the closed form as well are timed; sympy
starts from the finished matrix. Times are processor times: other programs on the machine count little.
"""

from __future__ import annotations

from benchmarks.measure import Claim, Measurement, run_snippet

SIZES = (2, 4, 6, 8)

FLOORS = {6: 2.5, 8: 6.8}
"""Per size, how many times as fast as the fastest way in sympy: half of what docs/benchmarks.md reports."""
CEILINGS = {6: 0.020, 8: 0.300}
"""Per size, seconds the derivation may take."""

SYMFLEX = """
import statistics
import time
from benchmarks.chains import specification
from symflex import pipeline
from symflex.transfer import derive_all

model = pipeline.loads(specification({n}))
times = []
for _ in range({repeats}):
    begin = time.process_time()
    derive_all(pipeline.assemble(model), model.transfer_functions)
    times.append(time.process_time() - begin)
print({statistic})
"""
SYMFLEX_WAYS = {
    "symflex": {"repeats": 11, "statistic": "statistics.median(times)"},
    "symflex, first run of a process": {"repeats": 1, "statistic": "times[0]"},
}

MATRIX = """
import time
import sympy
from sympy.polys.matrices import DomainMatrix

n = {n}
s = sympy.Symbol("s")
m = sympy.symbols(f"m_1:{{n + 1}}")
k = sympy.symbols(f"k_1:{{n}}")
b = sympy.symbols(f"b_1:{{n}}")
names = (s, *m, *k, *b)
A = sympy.zeros(n, n)
for i in range(n):
    A[i, i] += m[i] * s**2
for i in range(n - 1):
    w = k[i] + b[i] * s
    A[i, i] += w
    A[i + 1, i + 1] += w
    A[i, i + 1] -= w
    A[i + 1, i] -= w
minors = [A, A.minor_submatrix(0, 0), A.minor_submatrix(0, n - 1)]
exact = [DomainMatrix.from_Matrix(a).convert_to(sympy.ZZ[names]) for a in minors]
begin = time.process_time()
"""

WAYS = {
    "sympy `Matrix.det(method='berkowitz')`": """
for a in minors:
    sympy.Poly(a.det(method="berkowitz"), *names)
""",
    "sympy `Matrix.det(method='bareiss')`": """
for a in minors:
    sympy.Poly(a.det(method="bareiss"), *names)
""",
    "sympy `DomainMatrix.det()` over ZZ[s, m, k, b]": """
for a in exact:
    a.det()
""",
    "sympy `DomainMatrix.charpoly()` over ZZ[s, m, k, b]": """
for a in exact:
    a.charpoly()[-1]
""",
    "sympy `Matrix.LUsolve`, then `cancel`": """
x = A.LUsolve(sympy.eye(n)[:, 0])
sympy.cancel(x[0]), sympy.cancel(x[n - 1])
""",
}


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


def measure(limit: float) -> tuple[list[Measurement], list[Claim]]:
    """Measure every size and way, each within ``limit`` seconds, and compare with sympy's fastest."""
    found: list[Measurement] = []
    claims: list[Claim] = []
    for n in SIZES:
        task = f"chain of {n} masses"
        ours = [
            run_snippet(task, way, SYMFLEX.format(n=n, **asked), limit) for way, asked in SYMFLEX_WAYS.items()
        ]
        theirs = [
            run_snippet(task, way, MATRIX.format(n=n) + code + "print(time.process_time() - begin)", limit)
            for way, code in WAYS.items()
        ]
        found += [*ours, *theirs]
        if n in FLOORS:
            ratio = min(other.at_least for other in theirs) / ours[0].at_least
            claims.append(Claim(f"{n} masses: times as fast as sympy's fastest way", FLOORS[n], ratio))
        if n in CEILINGS:
            text = f"{n} masses: milliseconds, first run of a process"
            taken = 1e3 * ours[1].at_least
            claims.append(Claim(text, 1e3 * CEILINGS[n], taken, larger_is_better=False, is_ratio=False))
    return found, claims
