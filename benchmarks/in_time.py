"""Responses in time beside numeric ones: python-control's of state equations, mpmath's inverse Laplace.

The lumped system is the six masses of derivations/eppinger1988, V_tip/F after a step at 1000 times; the
distributed one the sliding-free beam's X_tip/F, which is V_tip/F after a ramp, at 1000 times to 10^-9 of the
largest value. python-control has no beams. mpmath inverts one time after the other, so it is asked for few
and counts for 1000; of the beam infinitely many poles lie right of Talbot's contour, and what it is off by
there stands beside it. A damped shaft between a hub and a damper is asked for at four times.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import mpmath
import numpy as np

import symflex
from benchmarks.measure import Claim, Extent, Measured, Measurement, fastest
from symflex.errors.optional import installed

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

FOLDER = Path(__file__).parents[1] / "derivations" / "eppinger1988"
POINTS = 1000
CHAIN_LAST, BEAM_LAST = 1.0, 0.02
"""Last times [s]: some periods of the lowest modes."""
FEW = 5
"""Times that mpmath inverts."""
ROUNDS, QUICK_ROUNDS = 7, 3
BEAM_ROUNDS, QUICK_BEAM_ROUNDS = 3, 1
CHAIN, BEAM = "six masses, a step at 1000 times", "sliding-free beam, a step at 1000 times to 1e-9"
OURS = "symflex, enclosed"
CONTROL_AGREEMENT = 1e-6
"""Median relative difference; python-control steps through 1000 samples."""

CHAIN_SECONDS, BEAM_SECONDS = 0.02, 0.5
AS_FAST_AS_CONTROL = 0.5
AS_FAST_AS_MPMATH = {CHAIN: 50.0, BEAM: 20.0}
SHAFT = "damped shaft, a step at 4 times"
SHAFT_TIMES = 0.25, 0.5, 0.75, 1.0
AS_LONG_AS_MPMATH = 200.0
"""Most that enclosed values may take over Talbot's in doubles, which are proved by nothing."""
SHAFT_MODEL = """
symflex = 1
[parameters]
G = "80 GPa"
d = "20 mm"
J_p = "pi*d^4/32"
rho = "7800 kg/m^3"
[elements]
shaft  = { type = "shaft", between = ["a", "b"], G = "G", J = "J_p", rho = "rho", l = "1 m", eta = "2e-6 s" }
hub    = { type = "inertia", at = "a", J = "0.001 kg*m^2" }
damper = { type = "rotary_damper", between = ["b", "ground"], b = "0.05 N*m*s/rad" }
[inputs]
T = { torque = "a" }
[outputs]
w = "s*b"
"""
BEAM_RADIUS = 1e-9


def measure(extent: Extent) -> Measured:
    """Measure both responses, as many rounds as fit in the limit, and compare.

    Raises
    ------
    RuntimeError
        When the ways do not compute the same response.
    """
    limit = extent.limit
    chain = symflex.load(FOLDER / "six_mass.toml").transfer_function("V_tip", "F").bind()
    times = np.linspace(0, CHAIN_LAST, POINTS + 1)[1:]
    ways: dict[str, Callable[[], NDArray[Any]]] = {OURS: lambda: chain.step_response(times).values}
    try:
        control: Any = installed("control")
    except symflex.errors.UsageError:
        print("skipped, python-control is not installed: step_response of six masses", file=sys.stderr)
    else:
        system = chain.to_control("state-space")
        every = np.linspace(0, CHAIN_LAST, POINTS + 1)
        ways["`control.step_response` of state equations"] = lambda: control.step_response(system, every)[1][
            1:
        ]
    best = fastest(ways, limit, rounds=extent.of(ROUNDS, QUICK_ROUNDS), agreement=CONTROL_AGREEMENT)
    found = [Measurement(CHAIN, way, taken, limit) for way, taken in best.items()]
    claims = [Claim(CHAIN, CHAIN_SECONDS, best[OURS], larger_is_better=False, is_ratio=False)]
    claims += [
        Claim(f"{CHAIN}: times as fast as {way}", AS_FAST_AS_CONTROL, taken / best[OURS])
        for way, taken in best.items()
        if way != OURS
    ]
    seconds, _ = _inverted(_chain(chain.to_control()), times, chain.step_response(times).values)
    found.append(Measurement(CHAIN, "`mpmath.invertlaplace` (Talbot), 1000 times", seconds, limit))
    claims.append(Claim(f"{CHAIN}: times as fast as mpmath", AS_FAST_AS_MPMATH[CHAIN], seconds / best[OURS]))

    model = symflex.load(FOLDER / "sliding_free_beam.toml")
    beam = model.transfer_function("V_tip", "F").bind()
    times = np.linspace(0, BEAM_LAST, POINTS + 1)[1:]
    response = beam.ramp_response(times, 9)
    rounds = extent.of(BEAM_ROUNDS, QUICK_BEAM_ROUNDS)
    ramp = {OURS: lambda: beam.ramp_response(times, 9).values}
    ours = fastest(ramp, limit, rounds=rounds, agreement=1.0)[OURS]
    seconds, off = _inverted(_beam(model), times, response.values)
    largest = float(np.max(np.abs(response.values)))
    found.append(Measurement(BEAM, OURS, ours, limit))
    found.append(Measurement(BEAM, f"`mpmath.invertlaplace` (Talbot), off by {off:.1e}", seconds, limit))
    claims += [
        Claim(BEAM, BEAM_SECONDS, ours, larger_is_better=False, is_ratio=False),
        Claim(
            f"{BEAM}: largest radius over the largest value",
            BEAM_RADIUS,
            float(np.max(response.radius)) / largest,
            larger_is_better=False,
        ),
        Claim(f"{BEAM}: times as fast as mpmath", AS_FAST_AS_MPMATH[BEAM], seconds / ours),
    ]
    ratio, measured = _shaft_compared(limit)
    return Measured([*found, *measured], [*claims, ratio])


def _shaft_compared(limit: float) -> tuple[Claim, list[Measurement]]:
    shaft = symflex.loads(SHAFT_MODEL).transfer_function("w", "T").bind()
    times = np.array(SHAFT_TIMES)
    ways = {
        OURS: lambda: shaft.step_response(times).values,
        "`mpmath.invertlaplace` (Talbot)": lambda: np.array(
            [float(mpmath.invertlaplace(_shaft, t, method="talbot")) for t in SHAFT_TIMES]
        ),
    }
    best = fastest(ways, limit, rounds=1, agreement=CONTROL_AGREEMENT)
    ours, theirs = best.values()
    text = f"{SHAFT}: times as long as mpmath"
    ratio = Claim(text, AS_LONG_AS_MPMATH, ours / theirs, larger_is_better=False)
    return ratio, [Measurement(SHAFT, way, taken, limit) for way, taken in best.items()]


def _shaft(s: mpmath.mpc) -> mpmath.mpc:
    """Return the transform of the speed at the damper after a step of the torque on the hub.

    The angle is a cosh(k x) + b sinh(k x); J s^2 a = T + K k b at the hub, and K times its slope is -c s
    times the angle at the damper.
    """
    twisted = mpmath.pi * mpmath.mpf("0.02") ** 4 / 32
    stiffness = 80 * 10**9 * twisted * (1 + mpmath.mpf("2e-6") * s)
    k = s * mpmath.sqrt(7800 * twisted / stiffness)
    cosh, sinh, wave, loss = mpmath.cosh(k), mpmath.sinh(k), stiffness * k, mpmath.mpf("0.05") * s
    hub = mpmath.mpf("0.001") * s**2
    return wave / (hub * (wave * cosh + loss * sinh) + wave * (wave * sinh + loss * cosh))


def _chain(system: Any) -> Callable[[mpmath.mpc], mpmath.mpc]:  # noqa: ANN401
    """Return the step response's transform, from coefficients in double precision."""
    num, den = ([mpmath.mpf(float(c)) for c in side[0][0]] for side in (system.num, system.den))
    return lambda s: mpmath.polyval(num, s) / mpmath.polyval(den, s) / s


def _beam(model: symflex.Model) -> Callable[[mpmath.mpc], mpmath.mpc]:
    """Return the transform of X_tip after a step of F: w = a cosh + b cos + c (sinh - sin) of q x.

    w'(0) = 0 holds; EI w'''(0) = F gives c, and w''(l) = w'''(l) = 0 give a and b.
    """
    value = {p.name: mpmath.mpf(float(p.value.nearly)) for p in model.parameters if p.value is not None}
    stiffness, mass = value["E"] * value["I"], value["rho"] * value["A"]

    def transform(s: mpmath.mpc) -> mpmath.mpc:
        q = mpmath.root(-mass * s**2 / stiffness, 4)
        x = q * value["l"]
        c = 1 / (2 * stiffness * q**3)
        cosh, sinh, cos, sin = mpmath.cosh(x), mpmath.sinh(x), mpmath.cos(x), mpmath.sin(x)
        below = cosh * sin + sinh * cos
        a = -c * ((sinh + sin) * sin + (cosh + cos) * cos) / below
        b = (a * cosh + c * (sinh + sin)) / cos
        return (a * cosh + b * cos + c * (sinh - sin)) / s

    return transform


def _inverted(
    transform: Callable[[mpmath.mpc], mpmath.mpc], times: NDArray[Any], values: NDArray[Any]
) -> tuple[float, float]:
    """Return the seconds that 1000 times take, and how far mpmath is off, over the largest value."""
    chosen = np.linspace(POINTS // 10, POINTS - 1, FEW).astype(int)
    began = time.process_time()
    found = [mpmath.invertlaplace(transform, float(times[i]), method="talbot") for i in chosen]
    taken = (time.process_time() - began) / FEW * POINTS
    off = max(abs(float(y) - values[i]) for y, i in zip(found, chosen, strict=True))
    return taken, float(off / np.max(np.abs(values)))
