"""How long a response is looked at when nobody says."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

from flint import acb

from symflex.analysis.response import roots_if_found
from symflex.transfer import BoundNested
from symflex.transfer.balls import at_centre

if TYPE_CHECKING:
    from symflex.transfer import AnyBoundFunction

TIME_CONSTANTS = 5.0
"""After which 1 % of a motion is left."""
PERIODS, UNDAMPED_PERIODS = 12, 4
"""Of the slowest oscillation: more show nothing new."""


def default_until(bound: AnyBoundFunction) -> float:
    """Return a time [s] by which the slowest motion has died away, or has been seen often enough.

    Examples
    --------
    >>> from symflex import loads
    >>> lag = loads('symflex = 1' + chr(10) + 'inputs.u = {}' + chr(10) + 'outputs.y = "u/(s + 2)"')
    >>> default_until(lag.transfer_function("y", "u").bind().bound)
    2.5
    """
    waits = [TIME_CONSTANTS * delay for delay in _delays(bound)]
    for root in roots_if_found(bound).all_poles:
        size = float(root.natural_frequency())
        if root.is_zero or not size > 0:
            continue
        damping = abs(float(root.re.mid())) if not root.on_imaginary_axis else 0.0
        period = 2 * pi / size
        decay = TIME_CONSTANTS / damping if damping else UNDAMPED_PERIODS * period
        waits.append(decay if root.is_real else min(decay, PERIODS * period))
    return max(waits, default=0.0) or 1.0


def _delays(bound: AnyBoundFunction) -> list[float]:
    if isinstance(bound, BoundNested) or not bound.is_distributed:
        return []
    evaluator, found = bound.kernel_values(), []
    values = {"s": acb(1), **{name: acb(c) for name, c in evaluator.constants.items()}}
    for kernel in bound.kernels.kernels:
        if kernel.function == "exp":
            delay = evaluator.value(kernel.dispersion.shift, values) * evaluator.value(kernel.length, values)
            found.append(abs(float(at_centre(delay).real)))
    return found
