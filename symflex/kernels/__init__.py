"""The exact ring, factored rational functions over it, and the functions that may appear as generators."""

from symflex.kernels.collection import uncollected
from symflex.kernels.dispersion import NO_KERNELS, Dispersion, Kernel, KernelTable
from symflex.kernels.factored import Factored, common_denominator, least_common_multiple
from symflex.kernels.factorisation import irreducible_factors, square_free_factors
from symflex.kernels.functions import FUNCTIONS, ElementaryFunction
from symflex.kernels.memo import PolynomialMemo
from symflex.kernels.modal_sum import ModalSums, modal_amplitudes, mode_values
from symflex.kernels.propagators import Propagation, Propagator, propagate
from symflex.kernels.residue import PRIME, random_point, residue
from symflex.kernels.ring import LAPLACE, MEMORY_LIMIT, Ring, degree_in, expanded_length, terms_of

__all__ = [
    "FUNCTIONS",
    "LAPLACE",
    "MEMORY_LIMIT",
    "NO_KERNELS",
    "PRIME",
    "Dispersion",
    "ElementaryFunction",
    "Factored",
    "Kernel",
    "KernelTable",
    "ModalSums",
    "PolynomialMemo",
    "Propagation",
    "Propagator",
    "Ring",
    "common_denominator",
    "degree_in",
    "expanded_length",
    "irreducible_factors",
    "least_common_multiple",
    "modal_amplitudes",
    "mode_values",
    "propagate",
    "random_point",
    "residue",
    "square_free_factors",
    "terms_of",
    "uncollected",
]
