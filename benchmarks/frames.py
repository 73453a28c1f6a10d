"""Frames of many storeys: derived in nested form, and their lowest modes proved, beside numpy's determinant.

A storey is two columns and a beam. The other way assembles the same members' exact dynamic stiffness as a
dense matrix of doubles, and looks for signs of its determinant on a grid of frequencies: no root is
certified, and two within one step are missed.
"""

from __future__ import annotations

from benchmarks.measure import OWN, Claim, Extent, Measured, Measurement, run_snippet

STOREYS, QUICK_STOREYS = (10, 33, 100), (10,)
MODES = 10
SLOWER_THAN_NUMPY = {10: 45.0, 33: 15.0, 100: 6.0}
"""By storeys, times as long as numpy, at most: about three times what docs/benchmarks.md reports, as small
matrices are solved in caches that others share."""
CEILINGS = {10: 3.0, 33: 8.0, 100: 30.0}
"""By storeys, seconds for ten modes, proved."""


SECTION = 'E = "E", I = "I", A = "A", rho = "rho"'


def specification(storeys: int) -> str:
    """Return a frame of so many storeys with clamped feet, pushed at its top.

    Examples
    --------
    >>> from symflex import pipeline
    >>> model = pipeline.loads(specification(10))
    >>> len(model.elements), len(model.nodes)
    (30, 20)
    """
    lines = []
    for i in range(storeys):
        for side in ("left", "right"):
            below = f"{side}_{i}" if i else "ground"
            ends = f'["{below}", "{side}_{i + 1}"]'
            name = f"column_{side}_{i + 1}"
            lines.append(
                f'{name} = {{ type = "frame", between = {ends}, {SECTION}, l = "h", angle = "90 deg" }}'
            )
        ends = f'["left_{i + 1}", "right_{i + 1}"]'
        lines.append(f'beam_{i + 1} = {{ type = "frame", between = {ends}, {SECTION}, l = "b" }}')
    members = "\n".join(lines)
    return f"""
symflex = 1
title   = "Frame of {storeys} storeys"

[parameters]
E   = "210 GPa"
I   = "8.36e-5 m^4"
A   = "5.38e-3 m^2"
rho = "7850 kg/m^3"
h   = "3 m"
b   = "6 m"

[elements]
{members}

[inputs]
F = {{ force = "left_{storeys}.x" }}

[outputs]
X = "left_{storeys}.x"
"""


SYMFLEX = """
import time
from benchmarks.frames import specification
from symflex import pipeline
from symflex.roots import Modes

model = pipeline.loads(specification({storeys}))
begin = time.process_time()
(bound,) = pipeline.derive_for_roots(model, model.transfer_functions)
found = pipeline.roots(bound, Modes({modes}), 20)
if not found.certificate.certified or sum(p.im > 0 for p in found.poles) != {modes}:
    raise AssertionError
print(time.process_time() - begin)
"""
NUMPY = """
import os
os.environ["OPENBLAS_NUM_THREADS"] = "1"    # the time of the processor, not of two
import time
import numpy as np

n, E, I, A, rho, h, b = {storeys}, 210e9, 8.36e-5, 5.38e-3, 7850.0, 3.0, 6.0


def stiffness(omega, l):
    lam, gamma = l * (rho * A * omega**2 / (E * I)) ** 0.25, omega * l * (rho / E) ** 0.5
    c, s, ch, sh = np.cos(lam), np.sin(lam), np.cosh(lam), np.sinh(lam)
    k = E * I * lam / l / (1 - c * ch)
    vv, vt, tt = k * (lam / l) ** 2 * (s * ch + c * sh), k * lam / l * s * sh, k * (s * ch - c * sh)
    far = -k * (lam / l) ** 2 * (s + sh), k * lam / l * (ch - c), k * (sh - s)
    uu, uu_far, o = E * A / l * gamma / np.tan(gamma), -E * A / l * gamma / np.sin(gamma), 0 * omega
    rows = [
        [uu, o, o, uu_far, o, o],
        [o, vv, vt, o, far[0], far[1]],
        [o, vt, tt, o, -far[1], far[2]],
        [uu_far, o, o, uu, o, o],
        [o, far[0], -far[1], o, vv, -vt],
        [o, far[1], far[2], o, -vt, tt],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


def signs(omega):
    up, along = np.kron(np.eye(2), [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]), np.eye(6)
    whole = np.zeros((len(omega), 6 * n + 6, 6 * n + 6))
    column, beam = up.T @ stiffness(omega, h) @ up, stiffness(omega, b)
    for i in range(n):
        for side in (0, 3):
            at = [*range(6 * i + side, 6 * i + side + 3), *range(6 * i + 6 + side, 6 * i + 9 + side)]
            whole[:, np.ix_(at, at)[0], np.ix_(at, at)[1]] += column
        whole[:, 6 * i + 6 : 6 * i + 12, 6 * i + 6 : 6 * i + 12] += beam
    return np.linalg.slogdet(whole[:, 6:, 6:])[0]


begin = time.process_time()
brackets, start, step = [], 0.05, 10 / n
while len(brackets) < {modes}:
    omega = start + step * np.arange(33)
    sign = signs(omega)
    brackets += [(omega[i], omega[i + 1]) for i in range(32) if sign[i] != sign[i + 1]]
    start = omega[-1]
low, high = np.array(brackets[:{modes}]).T
left = signs(low)
for _ in range(45):
    middle = (low + high) / 2
    same = signs(middle) == left
    low, high = np.where(same, middle, low), np.where(same, high, middle)
print(time.process_time() - begin)
"""


def measure(extent: Extent) -> Measured:
    """Measure ten modes of frames of several sizes."""
    limit = extent.limit
    found: list[Measurement] = []
    claims: list[Claim] = []
    for storeys in extent.of(STOREYS, QUICK_STOREYS):
        task = f"ten modes of a frame of {3 * storeys} members"
        own, dense = (code.format(storeys=storeys, modes=MODES) for code in (SYMFLEX, NUMPY))
        ours = run_snippet(task, "symflex, 20 digits, proved", own, max(limit, OWN))
        theirs = run_snippet(task, "numpy, signs of a dense determinant", dense, limit)
        found += [ours, theirs]
        text = f"{task}, symflex: seconds"
        ceiling = CEILINGS[storeys]
        claims.append(Claim(text, ceiling, ours.taken, larger_is_better=False, is_ratio=False))
        bound, ratio = SLOWER_THAN_NUMPY[storeys], ours.taken / theirs.at_least
        claims.append(Claim(f"{task}: times as long as numpy", bound, ratio, larger_is_better=False))
    return Measured(found, claims)
