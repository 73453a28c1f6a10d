"""Prints: ladders, a product of many written factors, and a nonlinear arm, against SymPy.

Timed is what follows the import: symflex reads the model, derives, proves, arranges, reads back and breaks
lines; SymPy does as much of that as it can. The ladder is of resistors and capacitors, each a symbol of its
own: SymPy multiplies its recurrence out and collects powers of s. The product is of quadratic factors with a
damping ratio each: SymPy is given the factors as they are written, and half of them multiplied out. The arm
has two links: SymPy makes Lagrange's equations, linearises them and solves them for one function. Times are
processor times, each way in a process of its own.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

from benchmarks.measure import Claim, Extent, Measured, Measurement, run_snippet, times_as_fast

SECTIONS, EXPANDED, FACTORS = 8, 10, 10
ARM: Final = Path(__file__).parents[1] / "derivations" / "nonlinear" / "arm_at_a_pose.toml"
LADDER_FLOOR, EXPANDED_FLOOR, ARM_FLOOR = 8.0, 4.0, 4.0
PRODUCT_CEILING: Final = 4.0
"""Times as long as SymPy, which prints factors it was given and proves nothing."""

OURS = """
import time
from symflex import pipeline
from symflex.print import forms
from symflex.print.forms import definitions, nested
from symflex.print.text import derive_text
begin = time.process_time()
model = {load}
tfs, _ = pipeline.derive_as(model, model.transfer_functions[:1], {representation!r}, is_read=True)
printed, _ = forms.print_forms(tfs)
derive_text(list(zip(tfs, printed)))
print(time.process_time() - begin)
"""
SYMPY = """
import time
import sympy as sp
begin = time.process_time()
s, w = sp.symbols("s w")
{code}
print(time.process_time() - begin)
"""
SYMPY_LADDER = """
v, i = sp.Integer(1), sp.Integer(0)
for k in range({n}, 0, -1):
    i = sp.expand(i + s * sp.Symbol(f"C_{{k}}") * v)
    v = sp.expand(v + sp.Symbol(f"R_{{k}}") * i)
str(sp.collect(v, s))
"""
SYMPY_NESTED = """
v, i = sp.Integer(1), sp.Integer(0)
for k in range({n}, 0, -1):
    i = i + s * sp.Symbol(f"C_{{k}}") * v
    v = v + sp.Symbol(f"R_{{k}}") * i
str(v)
"""
SYMPY_PRODUCT = """
z = sp.symbols("z_1:11")
factors = [s**2 + 2 * z_i * w * s + w**2 for z_i in z]
str(sp.factor({whole}))
"""
AS_WRITTEN, MULTIPLIED = "w**20 / sp.Mul(*factors)", "sp.expand(sp.Mul(*factors[:5]))"
SYMPY_ARM = """
t = sp.Symbol("t")
m_1, m_2, l_1, l_2, b, g, q_10, q_20, u = sp.symbols("m_1 m_2 l_1 l_2 b g q_10 q_20 u")
q = [sp.Function(f"q_{i}")(t) for i in (1, 2)]
x, y = l_1 * sp.cos(q[0]) + l_2 * sp.cos(sum(q)), l_1 * sp.sin(q[0]) + l_2 * sp.sin(sum(q))
kinetic = m_1 * l_1**2 * q[0].diff(t)**2 / 2 + m_2 * (x.diff(t)**2 + y.diff(t)**2) / 2
potential = m_1 * g * l_1 * sp.sin(q[0]) + m_2 * g * y
rest = {q_i: value for q_i, value in zip(q, (q_10, q_20))}
rows = []
for q_i in q:
    rate = q_i.diff(t)
    row = kinetic.diff(rate).diff(t) - kinetic.diff(q_i) + potential.diff(q_i) + b * rate
    still = {q_j.diff(t, n): 0 for q_j in q for n in (2, 1)}
    rows.append([
        sp.simplify(sum(
            row.diff(q_j.diff(t, n) if n else q_j).subs(still).subs(rest) * s**n for n in (0, 1, 2)
        ))
        for q_j in q
    ])
str(sp.Matrix(rows).LUsolve(sp.Matrix([1, 0]))[0].together())
"""


def ladder(n: int) -> str:
    """Return the specification of a ladder of so many resistors and capacitors.

    Examples
    --------
    >>> ladder(3).count("resistor")
    3
    """
    sections = range(1, n + 1)
    values = ", ".join(f"R_{k} = {{}}, C_{k} = {{}}" for k in sections)
    parts = [
        f'{kind[0]}{k} = {{ type = "{kind}", between = ["n{first}", "{last}"], {c} = "{c}_{k}" }}'
        for k in sections
        for kind, c, first, last in (("resistor", "R", k - 1, f"n{k}"), ("capacitor", "C", k, "ground"))
    ]
    head = f'symflex = 1\nparameters = {{ {values} }}\ninputs.U = {{ voltage = "n0" }}\noutputs.V = "n{n}"'
    return "\n".join([head, "[elements]", *parts])


def product(n: int) -> str:
    """Return the specification of a product of quadratic factors."""
    values = ", ".join(f"z_{k} = {{}}" for k in range(1, n + 1))
    factors = "*".join(f"(s^2 + 2*z_{k}*w*s + w^2)" for k in range(1, n + 1))
    head = f"symflex = 1\nparameters = {{ w = {{}}, {values} }}\ninputs.u = {{}}"
    return f'{head}\noutputs.y = "w^{2 * n}/({factors})*u"'


def measure(extent: Extent) -> Measured:
    """Measure all prints and compare them."""
    limit = extent.limit
    found: list[Measurement] = []
    claims: list[Claim] = []

    def compared(task: str, load: str, representation: str, others: dict[str, str]) -> list[Measurement]:
        code = OURS.format(load=load, representation=representation)
        rows = [run_snippet(task, "symflex", code, limit)]
        rows += [run_snippet(task, way, SYMPY.format(code=other), limit) for way, other in others.items()]
        found.extend(rows)
        return rows

    collected = "SymPy `expand`, `collect` and `str`"
    sizes = [(SECTIONS, "expanded", LADDER_FLOOR, collected, SYMPY_LADDER)]
    if not extent.is_quick:
        sizes.append((EXPANDED, "expanded", EXPANDED_FLOOR, collected, SYMPY_LADDER))
    for n, representation, floor, way, code in sizes:
        task = f"print of a ladder of {n} sections"
        load = f"pipeline.loads({ladder(n)!r})"
        ours, theirs = compared(task, load, representation, {way: code.format(n=n)})
        claims.append(Claim(f"{task}: times as fast as SymPy", floor, times_as_fast(ours, theirs)))
    nested = {"SymPy, nested, unreduced": SYMPY_NESTED.format(n=EXPANDED)}
    compared(
        f"nested print of a ladder of {EXPANDED} sections",
        f"pipeline.loads({ladder(EXPANDED)!r})",
        "nested",
        nested,
    )
    task = f"print of a product of {FACTORS} written factors"
    others = {
        "SymPy `factor`, as written": SYMPY_PRODUCT.format(whole=AS_WRITTEN),
        "SymPy `factor`, five of them multiplied out": SYMPY_PRODUCT.format(whole=MULTIPLIED),
    }
    ours, written, _ = compared(task, f"pipeline.loads({product(FACTORS)!r})", "auto", others)
    ratio = ours.at_least / written.at_least
    claims.append(Claim(f"{task}: times as long as SymPy", PRODUCT_CEILING, ratio, larger_is_better=False))
    task = "one function of a two-link arm, from its energies to the print"
    lagrange = {"SymPy, Lagrange's equations by hand": SYMPY_ARM}
    ours, theirs = compared(task, f"pipeline.load({str(ARM)!r})", "auto", lagrange)
    claims.append(Claim(f"{task}: times as fast as SymPy", ARM_FLOOR, times_as_fast(ours, theirs)))
    return Measured(found, claims)
