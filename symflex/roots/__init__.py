"""Certified roots: every pole and zero enclosed, with its multiplicity, and none missing.

A new engine is one file and one line in :data:`ROOT_FINDERS`.
"""

from symflex.budget import Budget, Progress
from symflex.roots.finder import RootFinder
from symflex.roots.kernel_finder import KernelRootFinder
from symflex.roots.pole_zero_map import Certificate, HiddenRoot, PoleZeroMap, find_pole_zero_map
from symflex.roots.polynomial_roots import POLYNOMIAL, PolynomialRootFinder, find_polynomial_roots
from symflex.roots.polynomials.durand_kerner import propose_by_durand_kerner
from symflex.roots.polynomials.laguerre import propose_by_laguerre
from symflex.roots.precision import precision
from symflex.roots.problem import KernelProblem, PolynomialInS, Problem, RealConstant, RootProblem
from symflex.roots.region import Band, Everything, Mode, Modes, Position, Rectangle, Region
from symflex.roots.root import Root, RootDecimals, decimals

ROOT_FINDERS: dict[str, RootFinder] = {
    "polynomial": POLYNOMIAL,
    "laguerre": PolynomialRootFinder("laguerre", (propose_by_laguerre,)),
    "durand-kerner": PolynomialRootFinder("durand-kerner", (propose_by_durand_kerner,)),
    "lossless": KernelRootFinder("lossless"),
    "guess-and-prove": KernelRootFinder("guess-and-prove"),
    "subdivision": KernelRootFinder("subdivision"),
}

__all__ = [
    "ROOT_FINDERS",
    "Band",
    "Budget",
    "Certificate",
    "Everything",
    "HiddenRoot",
    "KernelProblem",
    "KernelRootFinder",
    "Mode",
    "Modes",
    "PoleZeroMap",
    "PolynomialInS",
    "PolynomialRootFinder",
    "Position",
    "Problem",
    "Progress",
    "RealConstant",
    "Rectangle",
    "Region",
    "Root",
    "RootDecimals",
    "RootFinder",
    "RootProblem",
    "decimals",
    "find_pole_zero_map",
    "find_polynomial_roots",
    "precision",
]
