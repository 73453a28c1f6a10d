"""Frequencies of a beam that tapers, beside collocation, initial value problems and mpmath's Taylor series.

The beam is clamped, of square section, 40 mm wide at the clamp and 10 mm at the tip. Collocation is that of
chebop (Driscoll, Bornemann & Trefethen 2008) by hand: displacement and moment at Chebyshev points. Shooting
integrates both solutions that are clamped, and seeks where the free end's determinant changes sign.

Exported C of the same beam is compared with that of the beam without taper, whose formula it has.
"""

from __future__ import annotations

import re
import shutil
import sys
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import mpmath
import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from benchmarks.generated import loaded, responding
from benchmarks.measure import Claim, Extent, Measured, Measurement, fastest
from symflex import pipeline
from symflex.codegen.c.module import C99
from symflex.roots import Modes

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

BENDING, MASS = 200e9 * 0.04**4 / 12, 7800 * 0.04**2
"""E I [N m^2] and rho A [kg/m] at the clamp."""
TAPER = 0.75
MODEL = """
symflex = 1
[elements.arm]
type = "beam"
between = ["ground", "tip"]
E = "200 GPa"
rho = "7800 kg/m^3"
l = "l"
I = "0.04^4/12*l^4*(1 - 0.75*x/l)^4"
A = "0.04^2*l^2*(1 - 0.75*x/l)^2"
[parameters]
l = "1 m"
[inputs]
F = { force = "tip" }
[outputs]
y = "tip"
"""
RISER = """
symflex = 1
[parameters]
EI = "1e8 N*m^2"
m = "300 kg/m"
T = "2e6 N"
w = "4000 N/m"
l = "300 m"
c = "30 N*s/m^2"
[fields.u]
domain = ["0", "l"]
equation = "(EI*u'')'' - ((T - w*x)*u')' + c*s*u + m*s^2*u = 0"
conditions = ["u(0) = X", "u''(0) = 0", "u(l) = 0", "u''(l) = 0"]
[inputs]
X = { unit = "m" }
[outputs]
y = "u(l/2)"
"""
RISER_POINTS = 80
"""Collocation points: layers of 7 m at both ends have five of them."""
RISER_OVER_COLLOCATION = 5000.0
"""Most that certified poles of a riser, zeros and a count may take over one dense eigenvalue problem."""
MODES = 5
POINTS = 40
"""Collocation points, with which the fifth frequency has 11 digits."""
STEPS = 60
"""In the frequency's square root, between which the determinant's sign is compared."""
HIGHEST = 90.0
"""Square root of the highest angular frequency sought: above that of the fifth mode, 83.6."""
FEW_DIGITS = 20
ROUNDS, QUICK_ROUNDS = 2, 1
TIMES_COLLOCATION = 5000.0
"""Most that certified digits, zeros and a count may take over one dense eigenvalue problem of 2 ms."""
TIMES_SHOOTING = 20.0
"""Most that they may take over shooting in doubles; six is usual."""
TIMES_SERIES = 3.0
"""Speed over mpmath's Taylor series for one frequency, at least; ten is usual."""
POINTS_OF_C = 10_000
BAND_OF_C = 60.0, HIGHEST**2
"""In rad/s: the five modes are in it."""
TIMES_UNIFORM = 2.0
"""Most that C in band form may take over the formula of the uniform beam, both in vectors; 1.6 is usual."""


def ours(modes: int, digits: int, text: str = MODEL) -> NDArray[Any]:
    """Return the lowest frequencies [rad/s], proved."""
    model = pipeline.loads(text)
    (bound,) = pipeline.derive_bound(model, model.transfer_functions)
    poles = pipeline.roots(bound, Modes(modes), digits).poles
    return np.sort([float(root.im.mid()) for root in poles if root.im > 0])


def collocated() -> NDArray[Any]:
    """Return the same by collocation: ``w'' = M/(E I)`` and ``M'' = omega^2 rho A w``."""
    n, (x, d) = POINTS + 1, _chebyshev(POINTS)
    second, thin = d @ d, 1 - TAPER * x
    stiff, heavy = np.zeros((2 * n, 2 * n)), np.zeros((2 * n, 2 * n))
    # Moments in units of E I, so that all entries are of one size.
    stiff[:n, :n], stiff[:n, n:] = second, -np.diag(1 / thin**4)
    stiff[n:, n:], heavy[n:, :n] = second, np.diag(thin**2) * MASS / BENDING
    # Four rows next to the ends make room for w(0), w'(0), M(1) and M'(1).
    for row, block, values in (
        (0, 0, np.eye(n)[0]),
        (1, 0, d[0]),
        (2 * n - 1, n, np.eye(n)[-1]),
        (2 * n - 2, n, d[-1]),
    ):
        stiff[row], heavy[row] = 0, 0
        stiff[row, block : block + n] = values
    # Turned upside down: what has no mass is at 0, far from the lowest modes.
    values = np.sort(np.linalg.eigvals(np.linalg.solve(stiff, heavy)).real)
    return np.asarray(1 / np.sqrt(values[-MODES:][::-1]))


def _chebyshev(points: int) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return Chebyshev points between 0 and 1, and the matrix that takes values there to slopes."""
    k = np.arange(points + 1)
    x = (1 - np.cos(np.pi * k / points)) / 2
    c = np.where((k == 0) | (k == points), 2.0, 1.0) * (-1.0) ** k
    d = np.outer(c, 1 / c) / (np.subtract.outer(x, x) + np.eye(points + 1))
    return x, d - np.diag(d.sum(axis=1))


def riser_collocated() -> NDArray[Any]:
    """Return imaginary parts of the lowest poles of the riser: u and its moment are 0 at both ends.

    Damping is alike along it, so that ``m s^2 + c s`` is minus the square of a frequency without it.
    """
    length, mass, damping = 300.0, 300.0, 30.0
    x, d = _chebyshev(RISER_POINTS)
    d = d / length
    second = (d @ d)[1:-1, 1:-1]
    tension = (d @ np.diag(2e6 - 4000 * length * x) @ d)[1:-1, 1:-1]
    squares = np.sort(np.linalg.eigvals(1e8 * second @ second - tension).real)[:MODES] / mass
    return np.asarray(np.sqrt(squares - (damping / (2 * mass)) ** 2))


def shot() -> NDArray[Any]:
    """Return the same by solve_ivp and brentq."""

    def determinant(root: float) -> float:
        square = root**4 * MASS / BENDING

        def slopes(x: float, z: NDArray[Any]) -> NDArray[Any]:
            y, slope, moment, force = z.reshape(4, 2)
            thin = 1 - TAPER * x
            return np.concatenate([slope, moment / thin**4, force, square * thin**2 * y])

        start = np.zeros((4, 2))
        start[2, 0] = start[3, 1] = 1
        end = solve_ivp(slopes, (0, 1), start.ravel(), method="DOP853", rtol=1e-10, atol=1e-12).y[:, -1]
        return float(np.linalg.det(end.reshape(4, 2)[2:]))

    grid = np.linspace(HIGHEST / STEPS, HIGHEST, STEPS)
    values = [determinant(root) for root in grid]
    pairs = zip(pairwise(grid), pairwise(values), strict=True)
    roots = [brentq(determinant, *ends, xtol=1e-10) for ends, (one, other) in pairs if one * other < 0]
    return np.array(roots) ** 2


def by_series() -> NDArray[Any]:
    """Return the first frequency by mpmath's odefun and secant steps."""
    with mpmath.workdps(FEW_DIGITS):
        taper, ratio = mpmath.mpf(TAPER), mpmath.mpf(12) * 7800 / (200 * 10**9 * mpmath.mpf("0.0016"))

        def end(omega: float, moment: int) -> list[float]:
            def slopes(x: float, z: list[float]) -> list[float]:
                thin = 1 - taper * x
                return [z[1], z[2] / thin**4, z[3], omega**2 * ratio * thin**2 * z[0]]

            found: list[float] = mpmath.odefun(slopes, 0, [0, 0, moment, 1 - moment])(1)
            return found

        def determinant(omega: float) -> float:
            one, other = end(omega, 1), end(omega, 0)
            return one[2] * other[3] - one[3] * other[2]

        return np.array([float(mpmath.findroot(determinant, (339, 342), solver="secant", tol=1e-12))])


def measure(extent: Extent) -> Measured:
    """Measure the frequencies of one beam, and exported C."""
    found: list[Measurement] = []
    claims: list[Claim] = []
    _compare(
        found,
        f"{MODES} frequencies of a tapered beam",
        {
            "symflex, 15 digits proved, with the zeros": lambda: ours(MODES, 15),
            "numpy, collocation in doubles": collocated,
            "scipy, solve_ivp and brentq": shot,
        },
        extent,
    )
    own, dense, shooting = (m.at_least for m in found)
    text = "5 frequencies of a tapered beam: times as long as collocation in doubles"
    claims.append(Claim(text, TIMES_COLLOCATION, own / dense, larger_is_better=False))
    text = "5 frequencies of a tapered beam: times as long as solve_ivp and brentq"
    claims.append(Claim(text, TIMES_SHOOTING, own / shooting, larger_is_better=False))
    task = f"{MODES} poles of a damped riser"
    ways = {
        "symflex, 10 digits proved, with the zeros": lambda: ours(MODES, 10, RISER),
        "numpy, collocation in doubles": riser_collocated,
    }
    _compare(found, task, ways, extent)
    *_, riser, dense = (m.at_least for m in found)
    text = f"{task}: times as long as collocation in doubles"
    claims.append(Claim(text, RISER_OVER_COLLOCATION, riser / dense, larger_is_better=False))
    if extent.is_quick:
        return Measured(found, claims)
    _compare(
        found,
        f"the first frequency of a tapered beam to {FEW_DIGITS} digits",
        {"symflex, proved, with a zero": lambda: ours(1, FEW_DIGITS), "mpmath, odefun": by_series},
        extent,
    )
    text = "the first frequency of a tapered beam: times as fast as mpmath's odefun"
    claims.append(Claim(text, TIMES_SERIES, found[-1].at_least / found[-2].at_least))
    if shutil.which("cc") is None:
        print("skipped, there is no C compiler `cc`: exported C of a tapered beam", file=sys.stderr)
        return Measured(found, claims)
    for flag in ("-O2", "-O3"):
        times = []
        for name, text in (("tapered", MODEL), ("uniform", re.sub(r"\*\(1 - .*\)\^[24]", "", MODEL))):
            task = f"exported C ({flag}) of a {name} beam at {POINTS_OF_C} frequencies"
            best = fastest({name: _in_c(text, flag)}, extent.limit, rounds=20, agreement=1e-7)
            times += [Measurement(task, way, seconds, extent.limit) for way, seconds in best.items()]
        found += times
        text = f"exported C ({flag}) of a tapered beam: times as long as that of a uniform one"
        ratio = times[0].at_least / times[1].at_least
        # What else shares a processor slows one of them more than the other.
        claims.append(Claim(text, TIMES_UNIFORM, ratio, larger_is_better=False, is_ratio=False))
    return Measured(found, claims)


def _in_c(text: str, flag: str) -> Callable[[], NDArray[Any]]:
    """Return what computes a model's response, which is real, by exported C."""
    model = pipeline.loads(text)
    made = C99.export(model, pipeline.derive_all(model), stem="beam", is_alone=False)
    library = loaded({"beam.c": made.text, "beam.h": made.companions[".h"]}, ("-std=c99", flag))
    return responding(library, "beam", "y_over_F", np.geomspace(*BAND_OF_C, POINTS_OF_C), 0)


def _compare(
    found: list[Measurement], task: str, ways: dict[str, Callable[[], NDArray[Any]]], extent: Extent
) -> None:
    best = fastest(ways, extent.limit, rounds=extent.of(ROUNDS, QUICK_ROUNDS), agreement=1e-7)
    found += [Measurement(task, name, seconds, extent.limit) for name, seconds in best.items()]
