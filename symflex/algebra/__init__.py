"""The exact ring, factored rational functions over it, and the functions that may appear as generators."""

from symflex.algebra.dispersion import NO_KERNELS, Dispersion, Kernel, KernelTable
from symflex.algebra.factored import (
    PRIME,
    Factored,
    common_denominator,
    composed,
    evaluated,
    in_lowest_terms,
    least_common_multiple,
    random_point,
    residue,
    summed,
)
from symflex.algebra.radicals import Radicals
from symflex.algebra.ring import (
    FUNCTIONS,
    LAPLACE,
    MEMORY_LIMIT,
    PolynomialMemo,
    Ring,
    by_powers,
    degree_in,
    expanded_length,
    irreducible_factors,
    real_parts,
    square_free_factors,
    terms_of,
)
