"""Residues, and rational approximations with the band of frequencies they are valid in."""

from symflex.rational.approximate import approximate
from symflex.rational.approximation import RationalApproximation
from symflex.rational.approximation_error import BandError, ErrorScan
from symflex.rational.forms import FORMS
from symflex.rational.laurent import LaurentSeries, expand_at_pole, expand_at_zero
from symflex.rational.residues import Residue, find_residues

__all__ = [
    "FORMS",
    "BandError",
    "ErrorScan",
    "LaurentSeries",
    "RationalApproximation",
    "Residue",
    "approximate",
    "expand_at_pole",
    "expand_at_zero",
    "find_residues",
]
