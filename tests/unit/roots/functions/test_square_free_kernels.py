"""Squares hidden in polynomials in kernels: found with their multiplicities, and nothing else changed."""

from flint import acb

from symflex.algebra import Factored
from symflex.balls import precision
from symflex.roots.functions.simplified import without_squares
from tests.unit.roots.distributed_models import ROD, SLIDING_FREE, bound

PLACES = [0.7, 2 + 3j, 1 + 8j]


def product_of(text, make):
    """Return a function, and a product of polynomials in its kernels, each given with its exponent."""
    source = bound(text)
    ring = source.ratio.ring
    names = {k.function: ring.generator(k.generator) for k in source.kernels.kernels}
    part = Factored.number(ring, 1)
    for polynomial, exponent in make(s=ring.context.gen(0), **names):
        part = part * Factored.polynomial(ring, polynomial) ** exponent
    return source, part


SQUARES = {
    # (cosh sinh)^2 with sinh of twice the half, 2 sinh(x/2)^2, 2 cosh(x/2)^2, once more squared
    "sinh and cosh": (ROD, lambda s, cosh, sinh: [(cosh**4 - cosh**2, 1)], [2, 2, 2]),
    "cosh - 1": (ROD, lambda s, cosh, sinh: [(cosh - 1, 1)], [2]),
    "cosh + 1": (ROD, lambda s, cosh, sinh: [(cosh + 1, 2)], [4]),
    "beside another": (ROD, lambda s, cosh, sinh: [(cosh - 1, 1), (cosh + s * sinh, 1)], [1, 2]),
    "under it": (ROD, lambda s, cosh, sinh: [(cosh - 1, -1), (cosh + s * sinh, 3)], [-2, 3]),
    # of the circular ones as well: 2 sin(x/2)^2, and both
    "1 - cos": (SLIDING_FREE, lambda s, cosh, sinh, cos, sin: [(1 - cos, 1)], [2]),
    "both": (SLIDING_FREE, lambda s, cosh, sinh, cos, sin: [((cosh - 1) * (1 + cos), 1)], [2, 2]),
    "squared": (
        SLIDING_FREE,
        lambda s, cosh, sinh, cos, sin: [
            (sinh**2 * cos**2 + 2 * sinh * cos * sin * cosh + sin**2 * cosh**2, 1)
        ],
        [2],
    ),
}


def test_squares_are_found_with_their_multiplicity_and_change_the_product_by_one_number():
    for name, (text, make, exponents) in SQUARES.items():
        before = product_of(text, make)
        function, part = after = without_squares(*before)
        kernels = [function.ratio.ring.index[g] for g in function.kernels.generators]
        assert sorted(e for f, e in part.factors if any(f.degrees()[i] for i in kernels)) == exponents, name
        with precision(160):
            ratios = [value(*after, s) / value(*before, s) for s in PLACES]
            assert all((ratio / ratios[0] - 1).contains(0) for ratio in ratios), name
            assert all(ratio.rel_accuracy_bits() > 80 for ratio in ratios), name


def value(function, part, s):
    with precision(160):
        kernels = function.kernel_values()
        return kernels.value(part, kernels.at(acb(s)))
