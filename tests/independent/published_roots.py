"""Roots that others have published: numbers no part of this project computed.

Wavenumbers are dimensionless, x = beta l of a beam with omega = x^2/l^2 sqrt(E I/(rho A)), or omega l/c of
a string or rod.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Expansion:
    """A decimal expansion from the On-Line Encyclopedia of Integer Sequences.

    Parameters
    ----------
    number : str
        The sequence, "A076414".
    equation : str
        What it solves.
    index : int
        Which positive root of it, from one.
    digits : str
        As listed there; the last digit may be rounded.
    """

    number: str
    equation: str
    index: int
    digits: str


COS_COSH_ONE = "cos x cosh x = 1"
COS_COSH_MINUS_ONE = "cos x cosh x = -1"
TAN_TANH = "tan x = tanh x"
TAN_MINUS = "tan x = -x"

EXPANSIONS = (
    Expansion(
        "A076414",
        COS_COSH_ONE,
        1,
        "4.73004074486270402602404810083388481989834180070684868909635584536913666985201318218195489392732091658591",
    ),
    Expansion(
        "A076415",
        COS_COSH_ONE,
        2,
        "7.85320462409583755647706668725404979032230417399067461484133730851055941781929284948388676003124388441027",
    ),
    Expansion(
        "A076416",
        COS_COSH_ONE,
        3,
        "10.9956078380016709066690325191058924175428030305763619970765559026569228289002871203761787620235349827799",
    ),
    Expansion(
        "A076417",
        COS_COSH_MINUS_ONE,
        1,
        "1.87510406871196116644530824107821416257011173353106998824541371310567995284042863852656655058188603708410",
    ),
    Expansion(
        "A076418",
        COS_COSH_MINUS_ONE,
        2,
        "4.69409113297417457643639177801981204938989673754576682897280327784907793680105250800358850278155427315772",
    ),
    Expansion(
        "A076419",
        COS_COSH_MINUS_ONE,
        3,
        "7.85475743823761256486100858276457045784854192923004669442328144882656142140865352823498667893999800536213",
    ),
    Expansion(
        "A076420",
        TAN_TANH,
        1,
        "3.92660231204791877823853334362702489516115208699533730742066865425527970890964642474194338001562194220513",
    ),
    Expansion(
        "A076421",
        TAN_TANH,
        2,
        "7.06858274562873208855295892754666537643764755006423564405943775434501343056608693954084752615223660838204",
    ),
    Expansion(
        "A076422",
        TAN_TANH,
        3,
        "10.2101761228130305454682055946565398249530579895513919233482111258175310751579140107639303585957682422870",
    ),
    # Listed as the least x > 0 with x + tan x = 0 (Finch 2003, Mathematical Constants, page 239).
    Expansion(
        "A196504",
        TAN_MINUS,
        1,
        "2.0287578381104342235769711247347143761083800287593940888171660744498665031042762345922795150425630639",
    ),
)

# Wavenumbers by the ends, Blevins 1979, Formulas for Natural Frequency and Mode Shape, table 8-1, modes 1 to
# 5, without those at zero. Where the book gives multiples of pi/2 it gives them as formulas.
WAVENUMBERS = {
    ("free", "free"): ("4.73004074", "7.85320462", "10.9956078", "14.1371655", "17.2787597"),
    ("free", "sliding"): ("2.36502037", "5.49780392", "8.63937983", "11.78097245", "14.92256510"),
    ("clamped", "free"): ("1.87510407", "4.69409113", "7.85475744", "10.99554073", "14.13716839"),
    ("free", "pinned"): ("3.92660231", "7.06858275", "10.21017612", "13.35176878", "16.49336143"),
    ("clamped", "clamped"): ("4.73004074", "7.85320462", "10.9956078", "14.1371655", "17.2787597"),
    ("clamped", "pinned"): ("3.92660231", "7.06858275", "10.21017612", "13.35176878", "16.49336143"),
    ("clamped", "sliding"): ("2.36502037", "5.49780392", "8.63937983", "11.78097245", "14.92256510"),
    ("pinned", "pinned"): tuple(f"{k} pi/2" for k in (2, 4, 6, 8, 10)),
    ("pinned", "sliding"): tuple(f"{k} pi/2" for k in (1, 3, 5, 7, 9)),
    ("sliding", "sliding"): tuple(f"{k} pi/2" for k in (2, 4, 6, 8, 10)),
}

# omega/sqrt(E I/(rho A l^4)) of a cantilever whose tip bears a point mass equal to the beam's: Mathematical
# Problems in Engineering 2017, 1568019, table 1, last column (mass ratio one, no moment of inertia).
CANTILEVER_WITH_ITS_OWN_MASS = ("1.557298", "16.25009", "50.89584", "105.1983", "179.2320")

# NAFEMS 1989, Selected benchmarks for natural frequency analysis, test FV5: a simply supported beam of 10 m,
# 2 m by 2 m, E = 200 GPa, nu = 0.3, rho = 8000 kg/m^3. Closed form, [Hz]. Extension is a rod, one end held.
# The shear coefficient is not stated; 0.85 gives the printed digits up to one in ten thousand.
DEEP_BEAM_FLEXURE = ("42.650", "148.15", "283.47")
DEEP_BEAM_EXTENSION = "125.00"

# A string with a mass on a spring at its end, N = rho A = l = K = M = 1, by so many linear finite elements:
# lambda = omega^2. Kressner 2009, A block Newton method for nonlinear eigenvalue problems, Numer. Math. 114.
# The problem is of Solov'ev 2006, and "loaded_string" in the NLEVP collection (Betcke et al. 2013). Only
# lambda > K/M is tabulated.
LOADED_STRING = {
    100: ("4.4821765459", "24.223573113", "63.723821142", "123.03122107", "202.20089914"),
    400: ("4.4820338110", "24.219005847", "63.692138408", "122.91317036", "201.88234012"),
}
