"""Limits of gains and delays, and peaks of delayed functions, as publications print their digits."""

from __future__ import annotations

import math
from decimal import Decimal

import pytest

import symflex

DELAYED = "exp(-s*T)"


def loop(gain: str) -> symflex.Model:
    """Return a unity feedback loop around an expression in s, K = 1 and T = 0.1 s."""
    own = {"K": 1, "T": "0.1 s"}
    return symflex.Model(
        parameters=own, signals={"y": f"{gain}*(r - y)"}, inputs={"r": {}}, outputs={"Y": "y"}
    )


def states(*terms, T="1 s", w=(1, 0), seen="x1"):
    """Return x' = (A_0 + A_1 e_1 + ...) x + w, of pairs of a matrix and its e."""
    rows = [
        [f"({a})*{e}*x{j + 1}" for matrix, e in terms for j, a in enumerate(matrix[i]) if a] + [f"({w[i]})*w"]
        for i in range(len(terms[0][0]))
    ]
    signals = {f"x{i + 1}": f"({' + '.join(row)})/s" for i, row in enumerate(rows)}
    return symflex.Model(parameters={"T": T}, signals=signals, inputs={"w": {}}, outputs={"Y": seen})


# Gu, Kharitonov and Chen, Stability of Time-Delay Systems (2003), pages 192 and 193.
TRIANGULAR = ([[-2, 0], [0, -0.9]], "1"), ([[-1, 0], [-1, -1]], DELAYED)
OSCILLATOR = ([[0, 1], [-2, 0.1]], "1"), ([[0, 0], [1, 0]], DELAYED)
# Peet (2018), A dual to Lyapunov's second method, example D: one delay is half of the other.
TWO_DELAYS = ([[0, 1], [-1, 0.1]], "1"), ([[0, 0], [-1, 0]], "exp(-s*T/2)"), ([[0, 0], [1, 0]], DELAYED)
# Control System Toolbox, reference of allmargin: L = 25/(s^3 + 10 s^2 + 10 s + 10).
REFERENCE = "25/(s^3 + 10*s^2 + 10*s + 10)"


def two_masses():
    """Return two masses and a spring, each v times 20 % off: Robust Control Toolbox, Robust Stability and
    Worst-Case Gain of Uncertain System; the masses grow smaller as the spring grows stiffer."""
    signals = {
        "f": "100*((s + 1)/(0.001*s + 1))^3*(r - x_2)",
        "x_1": "(f + (1 + 0.2*v)*(x_2 - x_1))/((1 - 0.2*v)*s^2)",
        "x_2": "(1 + 0.2*v)*(x_1 - x_2)/((1 - 0.2*v)*s^2)",
    }
    return symflex.Model(parameters={"v": 1}, signals=signals, inputs={"r": {}}, outputs={"Y": "x_2"})


def resonator():
    """Return a delayed resonator with the mass that carries it, its neighbour held: Peichl, Kure, Michiels
    and Vyhlidal (2025), Integrated design of system structure and delayed resonator."""
    signals = {
        "u": "g*exp(-s*T)*x_a",
        "x_a": "((1.8*s + 407)*(x_1 - x_a) - u)/(0.42*s^2)",
        "x_1": "(w + u - (1.8*s + 407)*(x_1 - x_a) - (5.2*s + 1750)*x_1)/(1.49*s^2)",
    }
    own = {"g": 78.05282, "T": "0.03303 s"}
    return symflex.Model(parameters=own, signals=signals, inputs={"w": {}}, outputs={"Y": "x_1"})


LIMITS = [
    # Model, parameter, range, its printed limit, printed frequency [rad/s] or none.
    pytest.param(states(*TRIANGULAR), "T", (0, 10), "6.17258", None, id="gu-2003-192"),
    pytest.param(states(*OSCILLATOR), "T", (0.5, 3), "1.71785", None, id="gu-2003-193"),
    pytest.param(states(*TWO_DELAYS), "T", (0.5, 3), "1.3722", None, id="peet-2018-D"),
    # Caliskan and Ozbay (2009): x_t = x_zz + 1.9 x - x(t - T), 0 < z < pi; its first mode, -1 + 1.9.
    pytest.param(loop("1/(s - 0.9)*exp(-s*T)"), "T", (0.1, 3), "1.0347", None, id="caliskan-2009"),
    pytest.param(loop(f"K*{REFERENCE}"), "K", None, "3.6000", "3.1623", id="allmargin-gain"),
    pytest.param(loop(f"{REFERENCE}*{DELAYED}"), "T", (0, 1), "0.2847", "1.7844", id="allmargin-delay"),
    # Control System Toolbox, Assessing Gain and Phase Margins: 0 < k < 2.7.
    pytest.param(
        loop("K*(0.5*s + 1.3)/(s^3 + 1.2*s^2 + 1.6*s)"), "K", None, "2.7", None, id="assessing-margins"
    ),
    pytest.param(two_masses(), "v", (2, 3), "2.8864", "575.0339", id="robstab"),
    # Bequette (2003), Process Control, module M6.3: 1/(10 s + 1) and 5 min of delay.
    pytest.param(loop("K/(10*s + 1)*exp(-5*s)"), "K", (0, 10), "3.8", "0.36", id="bequette-2003"),
    pytest.param(resonator(), "T", (0.02, 0.05), "0.03303", str(8.4 * math.pi)[:8], id="peichl-2025"),
]


def prints(digits: str, value: float) -> bool:
    """Return whether a value has these digits, rounded or cut off."""
    unit = 10.0 ** int(Decimal(digits).as_tuple().exponent)
    return -0.5 * unit <= value - float(digits) < unit


@pytest.mark.parametrize(("model", "parameter", "ends", "limit", "frequency"), LIMITS)
def test_stability_ends_at_the_printed_limit(model, parameter, ends, limit, frequency):
    found = (
        model.stability(parameter, ends) if parameter == "K" else model.stability(over=parameter, limits=ends)
    )
    assert found.certified
    (boundary,) = found.boundaries
    assert boundary.entering == 2
    assert prints(limit, float(boundary.gain))
    assert frequency is None or prints(frequency, 2 * math.pi * boundary.frequencies_hz[0])


def test_peaks_of_delayed_functions_are_as_printed():
    # PIETOOLS, library of delayed systems: bounds of L2 gains by semidefinite programs, digits cut off.
    for terms, T, w, seen, printed in (
        (TRIANGULAR, "0.846 s", (-0.5, 1), "x1", "0.2364"),  # Egorov and Mondie (2014)
        ([([[0]], "1"), ([[-1]], DELAYED)], "1.5 s", (1,), "x1 + w", "25.907"),
        (TWO_DELAYS, "1 s", (-0.5, 1), "x1", "4.9784"),
    ):
        peak = states(*terms, T=T, w=w, seen=seen).peak("Y", "w")
        assert peak.certified, printed
        assert prints(printed, float(peak.magnitude)), printed
