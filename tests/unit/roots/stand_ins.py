"""Roots as tests make them up."""

from flint import arb

from symflex.roots.root import Root


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
