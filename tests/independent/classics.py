"""Characteristic equations of classic beams, rods and shafts, as textbooks print them, and their roots.

x is the dimensionless wavenumber: beta l of a beam, with omega = x^2/l^2 sqrt(E I/(rho A)); omega l/c of rods
and shafts.
"""

from __future__ import annotations

import re
import tomllib
from typing import TYPE_CHECKING, Any

import mpmath
from mpmath import cos, cosh, findroot, mp, mpf, pi, sin, sinh, sqrt

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

Number = Any  # mpmath's numbers have no types
Values = dict[str, Number]

DIGITS = 60

# First dimensionless wavenumbers, On-Line Encyclopedia of Integer Sequences.
CLAMPED_CLAMPED = (  # cos x cosh x = 1, also free-free; A076414
    "4.73004074486270402602404810083388481989834180070684868909635584536913666985201318218195489392732091658591"
)
CLAMPED_FREE = (  # cos x cosh x = -1; A076417
    "1.87510406871196116644530824107821416257011173353106998824541371310567995284042863852656655058188603708410"
)

_SI = {
    "": "1", "1": "1", "GPa": "1e9", "mm^2": "1e-6", "mm^4": "1e-12", "m": "1", "us": "1e-6", "s": "1",
    "mH": "1e-3",
}  # fmt: skip


def values(path: Path) -> Values:
    """Return the parameters of a derivation in SI units at the working precision, read without symflex.

    Units that are coherent (kg, N*s/m, ...) have the factor one; a revolution is 2 pi.
    """
    entries = tomllib.loads(path.read_text("utf-8"))["parameters"]
    return {
        name: _si(entry["value"] if isinstance(entry, dict) else entry) for name, entry in entries.items()
    }


def _si(written: object) -> Number:
    number, _, unit = str(written).partition(" ")
    if unit == "mm/rev":
        return mpf(number) / 1000 / (2 * pi)
    coherent = re.fullmatch(r"(kg|N|V|A|[oO]hm|m|s|rad)([*/^](kg|N|V|A|ohm|m|s|rad|\d))*", unit)
    return mpf(number) * mpf("1" if coherent else _SI[unit])


def beam_frequency(x: Number, v: Values) -> Number:
    """Return omega of an Euler-Bernoulli beam [rad/s]."""
    return (x / v["l"]) ** 2 * sqrt(v["E"] * v["I"] / (v["rho"] * v["A"]))


def refined(equation: Callable[[Number], Number], guess: object) -> Number:
    """Return the root of a characteristic equation near ``guess``."""
    return findroot(equation, mpmath.mpmathify(guess), tol=mpf(10) ** (-2 * mp.dps + 20))


def between(equation: Callable[[Number], Number], low: Number, high: Number) -> Number:
    """Return the one root of a real function between ``low`` and ``high``, both left out by a little."""
    low, high = low + mpf("1e-6"), high - mpf("1e-6")
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if equation(low) * equation(middle) > 0 else (low, middle)
    return refined(equation, (low + high) / 2)


def clamped_free(k: int) -> Number:
    """Return the k-th root of cos x cosh x = -1 (Blevins 1979, table 8-1)."""
    return refined(lambda x: cos(x) + 1 / cosh(x), mpf("1.875") if k == 1 else (k - mpf(1) / 2) * pi)


def clamped_clamped(k: int) -> Number:
    """Return the k-th root of cos x cosh x = 1, of free-free beams too (Blevins 1979, table 8-1)."""
    return refined(lambda x: cos(x) - 1 / cosh(x), mpf("4.73") if k == 1 else (k + mpf(1) / 2) * pi)


def sliding_free(k: int) -> Number:
    """Return the k-th root of tan x + tanh x = 0 (Blevins 1979, table 8-1)."""
    return refined(lambda x: sin(x) * cosh(x) + cos(x) * sinh(x), (k - mpf(1) / 4) * pi)


def rod_with_mass(k: int, v: Values) -> Number:
    """Return the k-th root of x tan x = rho A l/m (Rao 2007, chapter 9)."""
    ratio = v["rho"] * v["A"] * v["l"] / v["m"]
    # One root in each interval ((k - 1) pi, (k - 1/2) pi), at whose ends cosine or sine vanishes.
    return between(lambda x: x * sin(x) - ratio * cos(x), (k - 1) * pi, (k - mpf(1) / 2) * pi)


def shaft_with_discs(k: int, v: Values) -> Number:
    """Return the k-th root of tan x = x (m_1 + m_2)/(m_1 m_2 x^2 - 1), m_i = J_i/(rho J l).

    Rao 2007, chapter 10; the angle is cos(x xi) - m_1 x sin(x xi).
    """
    inertia = v["rho"] * v["J"] * v["l"]
    m_1, m_2 = v["J_1"] / inertia, v["J_2"] / inertia

    def equation(x: Number) -> Number:
        return sin(x) * (m_1 * m_2 * x**2 - 1) - x * (m_1 + m_2) * cos(x)

    # One root in each interval ((k - 1) pi, k pi): the sine vanishes at its ends, the cosine changes sign.
    return between(equation, (k - 1) * pi, k * pi)


def timoshenko_cantilever(omega_guess: object, v: Values) -> Number:
    """Return omega near a guess from the frequency equation of Huang 1961, clamped-free.

    2 + (b^2 (r^2 - s^2)^2 + 2) cosh(b alpha) cos(b beta) - b (r^2 + s^2)/sqrt(1 - b^2 r^2 s^2) sinh(b alpha)
    sin(b beta) = 0 with b^2 = rho A l^4 omega^2/(E I), r^2 = I/(A l^2), s^2 = E I/(kappa G A l^2).
    """
    stiffness = v["E"] * v["I"]
    r2 = v["I"] / (v["A"] * v["l"] ** 2)
    s2 = stiffness / (v["kappa"] * v["G"] * v["A"] * v["l"] ** 2)

    def equation(omega: Number) -> Number:
        b = omega * v["l"] ** 2 * sqrt(v["rho"] * v["A"] / stiffness)
        root = sqrt((r2 - s2) ** 2 + 4 / b**2)
        alpha, beta = sqrt((root - r2 - s2) / 2), sqrt((root + r2 + s2) / 2)
        both = cosh(b * alpha) * cos(b * beta)
        odd = sinh(b * alpha) * sin(b * beta)
        return 2 + (b**2 * (r2 - s2) ** 2 + 2) * both - b * (r2 + s2) / sqrt(1 - b**2 * r2 * s2) * odd

    return refined(equation, omega_guess)


def loaded_cantilever(guess: object, v: Values) -> Number:
    """Return the pole s near a guess of a Kelvin-Voigt cantilever with mass and dashpot at its tip.

    With a tip mass alone, 1 + cos x cosh x + (m/(rho A l)) x (cos x sinh x - sin x cosh x) = 0 (Rao 2007,
    chapter 11); here E (1 + eta s) stands for E and m s^2 + b s for m s^2 = -m omega^2.
    """

    def equation(s: Number) -> Number:
        stiffness = v["E"] * v["I"] * (1 + v["eta"] * s)
        beta = (-v["rho"] * v["A"] * s**2 / stiffness) ** mpf("0.25")
        x = beta * v["l"]
        load = (v["m"] * s**2 + v["b"] * s) / (stiffness * beta**3)
        return 1 + cos(x) * cosh(x) - load * (cos(x) * sinh(x) - sin(x) * cosh(x))

    return refined(equation, guess)


def one_link_arm(guess: object, v: Values) -> Number:
    """Return x near a guess from the determinant of a pinned-free beam with hub inertia and payload.

    w is a sum of sin, cos, sinh and cosh of x xi; w(0) = 0, E I w''(0) = -omega^2 J_h w'(0), w''(l) = 0 and
    E I w'''(l) = -omega^2 m w(l) (Rao 2007, chapter 11).
    """
    mass = v["rho"] * v["A"] * v["l"]
    hub, payload = v["J_h"] / (mass * v["l"] ** 2), v["m"] / mass

    def equation(x: Number) -> Number:
        # Rows: derivatives of (sin, cos, sinh, cosh)(x xi) over x^n; omega^2 rho A l^4/(E I) = x^4.
        return (
            mpmath.det(
                mpmath.matrix(
                    [
                        [0, 1, 0, 1],
                        [hub * x**3, -1, hub * x**3, 1],
                        [-sin(x), -cos(x), sinh(x), cosh(x)],
                        [
                            -cos(x) + payload * x * sin(x),
                            sin(x) + payload * x * cos(x),
                            cosh(x) + payload * x * sinh(x),
                            sinh(x) + payload * x * cosh(x),
                        ],
                    ]
                )
            )
            / cosh(x) ** 2
        )

    return refined(equation, guess)
