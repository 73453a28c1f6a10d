"""The exact ring, factored rational functions over it, and the functions that may appear as generators."""

from symflex.kernels.factored import Factored
from symflex.kernels.functions import FUNCTIONS, ElementaryFunction
from symflex.kernels.residue import PRIME, random_point, residue
from symflex.kernels.ring import LAPLACE, MEMORY_LIMIT, Ring, degree_in

__all__ = [
    "FUNCTIONS",
    "LAPLACE",
    "MEMORY_LIMIT",
    "PRIME",
    "ElementaryFunction",
    "Factored",
    "Ring",
    "degree_in",
    "random_point",
    "residue",
]
