"""Roots and sides of transfer functions as tests of searches make them up, and the end of a budget."""

from flint import arb

from symflex.errors import BudgetError, Diagnostic
from symflex.roots import Mode, Position
from symflex.roots.distributed.side import Side
from symflex.roots.engines import LOSSLESS
from symflex.roots.polynomial_roots import in_order
from symflex.roots.root import Root
from tests.unit.roots.distributed_models import ROD, bound

OVER = BudgetError(Diagnostic("SF506", "the time budget is used up"))


def root(re, im=0.0, times=1, size=0.0, *, certified=True):
    """Return a root; where it has a size, nothing is known of the axes."""
    return Root(
        arb(re, size),
        arb(im, size),
        times,
        on_imaginary_axis=re == 0 and not size,
        is_real=im == 0 and not size,
        certified=certified,
    )


def places(roots):
    return [(float(r.re), float(r.im), r.multiplicity) for r in roots]


def poles_by(engine, source, region, digits):
    """Return the poles in a region that one engine finds, none where it does not prove that they are all."""
    one = Side(source, source.den, digits, engines=(engine,))
    if isinstance(region, Mode):
        one.numbered(region.number)
        return in_order(one.roots) if one.engine == LOSSLESS else ()
    one.search(region)
    if not one.prove(region).is_complete:
        return ()
    ordered = in_order(one.roots)
    positions = zip(ordered, region.classify(ordered), strict=True)
    return tuple(root for root, position in positions if position is not Position.OUTSIDE)


def side(text=ROD, **options):
    """Return the denominator's side of a specification's first transfer function."""
    source = bound(text, 0)
    return Side(source, source.den, 20, **options)
