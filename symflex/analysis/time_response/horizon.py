"""How long a response is looked at when nobody says."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

from flint import acb

from symflex.analysis.response import roots_if_found
from symflex.transfer.balls import at_centre

if TYPE_CHECKING:
    from symflex.transfer import BoundTransferFunction

TIME_CONSTANTS = 5.0
"""After which 1 % of a motion is left."""
PERIODS, UNDAMPED_PERIODS = 12, 4
"""Of the slowest oscillation: more show nothing new."""


def default_until(bound: BoundTransferFunction) -> float:
    """Return a time [s] by which the slowest motion has died away, or has been seen often enough.

    Examples
    --------
    >>> from symflex import loads
    >>> lag = loads('symflex = 1' + chr(10) + 'inputs.u = {}' + chr(10) + 'outputs.y = "u/(s + 2)"')
    >>> default_until(lag.transfer_function("y", "u").bind().bound)
    2.5
    """
    waits = [0.0]
    evaluator = bound.kernel_values() if bound.is_distributed else None
    for kernel in bound.kernels.kernels:
        if kernel.function == "exp" and evaluator is not None:
            values = {"s": acb(1), **{name: acb(c) for name, c in evaluator.constants.items()}}
            delay = evaluator.value(kernel.dispersion.shift, values) * evaluator.value(kernel.length, values)
            waits.append(TIME_CONSTANTS * abs(float(at_centre(delay).real)))
    for root in roots_if_found(bound).all_poles:
        size = float(root.natural_frequency())
        if root.is_zero or not size > 0:
            continue
        damping = abs(float(root.re.mid())) if not root.on_imaginary_axis else 0.0
        period = 2 * pi / size
        decay = TIME_CONSTANTS / damping if damping else UNDAMPED_PERIODS * period
        waits.append(decay if root.is_real else min(decay, PERIODS * period))
    return max(waits) or 1.0
