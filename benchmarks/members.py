"""Networks of many beams: how derivation, roots and responses grow, beside dynamic stiffness by hand.

The beams are unequal, on springs, clamped at the start. By hand each is the dynamic stiffness of its ends
after Kolousek (1941), in numpy, assembled and solved as a dense matrix; frequencies are sought by bisection
on the count of negative pivots (Wittrick and Williams 1971) in doubles, with the count of clamped beams left
out, which is zero as far up as is sought.
"""

from __future__ import annotations

import time
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from benchmarks.generated import imported
from benchmarks.measure import Claim, Extent, Measured, Measurement, fastest
from symflex import pipeline
from symflex.codegen.exporters import EXPORTERS
from symflex.print.forms import print_form
from symflex.roots import Modes

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from symflex.model import Model

BENDING, MASS = 200.0, 0.78
"""E I [N m^2] and rho A [kg/m]."""
SIZES, QUICK_SIZES = (10, 30, 100, 300), (10, 30, 100)
MODES, DIGITS = 10, 20
POINTS = 1000
SEARCHED = 30
"""Beams whose frequencies are sought, by both."""
SOLVED = 100
"""Beams whose response is computed, by both; with forty dense matrices are three times as fast."""
EVEN = 2.5
"""Largest over smallest time of derivation per beam, from 30 beams on: start-up shares in few."""
TIMES_BISECTION = 3.0
"""Most that twenty certified digits may take, over ten or so from doubles."""
TIMES_FASTER = 1.0
"""Than dense solves, at least."""
ROUNDS, QUICK_ROUNDS = 3, 1


def lengths(n: int) -> list[Fraction]:
    """Return the beams' lengths [m], thirteen different ones."""
    return [Fraction(30 + 7 * i % 13, 100) for i in range(n)]


def stiffnesses(n: int) -> list[int]:
    """Return the springs' stiffnesses [N/m]."""
    return [1000 + 37 * (5 * i % 11) for i in range(n)]


def chain(n: int) -> Model:
    """Return a clamped chain of unequal beams, each held by a spring at its end, with a force on the tip."""
    elements = []
    for i, (length, k) in enumerate(zip(lengths(n), stiffnesses(n), strict=True)):
        start = f"n{i}" if i else "ground"
        law = 'E = "200 GPa", rho = "7800 kg/m^3", A = "100 mm^2", I = "1000 mm^4"'
        elements += [
            f'b{i} = {{ type = "beam", between = ["{start}", "n{i + 1}"], {law}, l = "{float(length)} m" }}',
            f's{i} = {{ type = "spring", between = ["n{i + 1}", "ground"], k = "{k} N/m" }}',
        ]
    listed = "\n".join(elements)
    return pipeline.loads(
        f"symflex = 1\n[analysis]\nband = ['1 Hz', '100 Hz']\n[elements]\n{listed}\n"
        f"[inputs]\nF = {{ force = 'n{n}' }}\n[outputs]\nY = 'n{n}'\n"
    )


def by_hand(omega: NDArray[Any], n: int) -> NDArray[Any]:
    """Return the dynamic stiffness of a chain's ends, over frequencies [rad/s]; w and w' of each in turn."""
    wavenumber = (MASS / BENDING) ** 0.25 * np.sqrt(omega)
    whole = np.zeros((len(omega), 2 * n + 2, 2 * n + 2))
    for i, length in enumerate(lengths(n)):
        x = wavenumber * float(length)
        c, s, ch, sh = np.cos(x), np.sin(x), np.cosh(x), np.sinh(x)
        below = BENDING / (1 - c * ch)
        k = wavenumber
        a, b, d = (s * ch + c * sh) * k**3, s * sh * k**2, (s * ch - c * sh) * k
        e, f, g = (s + sh) * k**3, (ch - c) * k**2, (sh - s) * k
        block = below[:, None, None] * np.moveaxis(
            np.array([[a, b, -e, f], [b, d, -f, g], [-e, -f, a, -b], [f, g, -b, d]]), -1, 0
        )
        whole[:, 2 * i : 2 * i + 4, 2 * i : 2 * i + 4] += block
    for i, k_s in enumerate(stiffnesses(n)):
        whole[:, 2 * i + 2, 2 * i + 2] += k_s
    return whole[:, 2:, 2:]


def bisected(n: int, modes: int) -> NDArray[Any]:
    """Return the lowest frequencies [rad/s] by bisection on the number of negative eigenvalues."""

    def below(omega: float) -> int:
        return int((np.linalg.eigvalsh(by_hand(np.array([omega]), n)[0]) < 0).sum())

    found = []
    for mode in range(1, modes + 1):
        low, high = 1e-3, 1e3
        while high - low > 1e-13 * high:
            middle = (low + high) / 2
            if not low < middle < high:
                break
            low, high = (low, middle) if below(middle) >= mode else (middle, high)
        found.append(high)
    return np.array(found)


def measure(extent: Extent) -> Measured:
    """Measure growth, roots and, in a full run, responses: dense matrices take seven seconds for these."""
    found: list[Measurement] = []
    shares = []
    for n in extent.of(SIZES, QUICK_SIZES):
        begin = time.process_time()
        model = chain(n)
        (tf,), _ = pipeline.derive_as(model, model.transfer_functions, "nested")
        print_form(tf)
        taken = time.process_time() - begin
        found.append(
            Measurement("a chain of beams read, derived and printed", f"{n} beams", taken, extent.limit)
        )
        shares.append(taken / n)
    text = "chains of 30 beams and more derived: largest over smallest time per beam"
    claims = [Claim(text, EVEN, max(shares[1:]) / min(shares[1:]), larger_is_better=False)]
    found += _roots(claims, extent)
    if not extent.is_quick:
        found += _responses(claims, extent)
    return Measured(found, claims)


def _roots(claims: list[Claim], extent: Extent) -> list[Measurement]:
    model = chain(SEARCHED)

    def ours() -> NDArray[Any]:
        (bound,) = pipeline.derive_for_roots(model, model.transfer_functions)
        poles = pipeline.roots(bound, Modes(MODES), DIGITS).poles
        return np.sort([float(root.im.mid()) for root in poles if root.im > 0])

    task = f"{MODES} frequencies of {SEARCHED} beams"
    way, other = f"symflex, {DIGITS} digits proved, with the zeros", "numpy, bisection in doubles"
    best = _timed({way: ours, other: lambda: bisected(SEARCHED, MODES)}, extent)
    text = f"{task}: times as long as bisection in doubles"
    claims.append(Claim(text, TIMES_BISECTION, best[way] / best[other], larger_is_better=False))
    return [Measurement(task, name, seconds, extent.limit) for name, seconds in best.items()]


def _responses(claims: list[Claim], extent: Extent) -> list[Measurement]:
    model = chain(SOLVED)
    tfs, _ = pipeline.derive_as(model, model.transfer_functions, "nested")
    module: Any = imported(EXPORTERS["numpy"].export(model, tfs, "many_beams").text, "many_beams")
    omega = 2 * np.pi * np.geomspace(1.0, 100.0, POINTS)
    load = np.zeros(2 * SOLVED)
    load[-2] = 1.0

    def dense() -> NDArray[Any]:
        matrix = by_hand(omega, SOLVED)
        return np.linalg.solve(matrix, np.broadcast_to(load, (POINTS, len(load)))[..., None])[:, -2, 0]

    task = f"{SOLVED} beams at {POINTS} frequencies"
    best = _timed({"exported numpy": lambda: module.Y_over_F(1j * omega), "numpy by hand": dense}, extent)
    text = f"{task}: times as fast as dense dynamic stiffness"
    claims.append(Claim(text, TIMES_FASTER, best["numpy by hand"] / best["exported numpy"]))
    return [Measurement(task, name, seconds, extent.limit) for name, seconds in best.items()]


def _timed(ways: dict[str, Callable[[], NDArray[Any]]], extent: Extent) -> dict[str, float]:
    return fastest(ways, extent.limit, rounds=extent.of(ROUNDS, QUICK_ROUNDS), agreement=1e-6)
