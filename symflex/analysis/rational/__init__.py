"""Residues, and rational approximations with the band of frequencies they are valid in."""

from symflex.analysis.rational.approximate import FORMS, approximate
from symflex.analysis.rational.approximation import BandError, RationalApproximation
from symflex.analysis.rational.laurent import PrincipalPart, expand_at_pole, expand_at_zero, find_residues
