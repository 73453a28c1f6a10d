"""Certified roots: every pole and zero enclosed, with its multiplicity, and none missing.

Which engine finds what is said in :mod:`symflex.roots.engines`.
"""

from symflex.budget import Budget, Progress
from symflex.roots.engines import ROOT_FINDERS
from symflex.roots.pole_zero_map import Certificate, HiddenRoot, PoleZeroMap, find_pole_zero_map
from symflex.roots.polynomial_roots import find_polynomial_roots
from symflex.roots.problem import PolynomialInS, RealConstant, RootProblem
from symflex.roots.region import Band, Everything, Mode, Modes, Position, Rectangle, Region
from symflex.roots.root import Root, decimals, figure
