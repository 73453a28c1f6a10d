"""Which poles stay where they are when more are allowed: the stabilisation diagram.

A response with resonances at 10 and 12 Hz, measured with noise, gives:

    poles      found at [Hz]
    2          10.4
    4          10.0  12.0
    6          10.0  12.0  17.3
    8          10.0  12.0  14.1  19.8

Those of the structure return with the same frequency and damping, those of the noise do not (van der Auweraer
and Peeters, Shock and Vibration Digest 36(1), 2004).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from symflex.data.fitting.fit import MOST_LINES, ResonanceFit
from symflex.data.fitting.resonances import Mask, Real
from symflex.data.fitting.starts import relocated, spread

FEWEST_ORDERS, MORE_ORDERS, MOST_ORDER = 6, 4, 40  # fewest pairs, those beyond the fit's, most poles
SAME_FREQUENCY, SAME_DAMPING = 0.01, 0.05  # custom of modal analysis: relative moves of a stable pole


@dataclass(frozen=True, eq=False)
class StablePoles:
    """The poles in the band found with one number of them."""

    order: int  # that number
    frequency_hz: Real
    damping_ratio: Real
    is_stable: Mask  # whether one with two poles less is the same


def stabilisation(fit: ResonanceFit) -> list[StablePoles]:
    """Return the poles that vector fitting finds in the data of a fit, with more and more of them."""
    thin = fit.problem.thinned(max(MOST_LINES // len(fit.problem.lines), 1))
    low, high = thin.band
    most = min(2 * max(FEWEST_ORDERS, fit.resonances.count + MORE_ORDERS), MOST_ORDER)
    orders: list[StablePoles] = []
    for order in range(2, most + 1, 2):
        poles = relocated(thin, spread(low, high, order))
        poles = poles[(poles.imag > 0) & (np.abs(poles) >= low) & (np.abs(poles) <= high)]
        poles = poles[np.argsort(np.abs(poles))]
        hertz, damping = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
        stable = np.zeros(poles.size, dtype=bool)
        if orders:
            before = orders[-1]
            near = np.abs(hertz[:, None] / before.frequency_hz - 1) < SAME_FREQUENCY
            alike = np.abs(damping[:, None] / before.damping_ratio - 1) < SAME_DAMPING
            stable = np.any(near & alike, axis=1)
        orders.append(StablePoles(order, hertz, damping, stable))
    return orders
