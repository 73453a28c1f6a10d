"""Systems whose waves lose energy in the material: how much poles beyond a circle may add to a response.

Input: a bound transfer function. Output: a bound of its response less the terms of all poles with abs(s)
below a radius R. Nothing need be passive: loops, imposed motion, unstable systems and velocities are bounded
alike.

Example: the tip of a cantilever with damping, ``E I (1 + eta s) w'''' + rho A s^2 w = 0``. Far from 0 its
wavenumber goes like s^(1/4), but for a factor that turns cosines into exponentials everywhere but next to the
negative real axis, where high modes are overdamped. So H is about c s^(-7/4) there, within a share that
:mod:`~symflex.roots.distributed.far_out` finds, and has no poles.

A response is the integral of H e^(st)/s^n along a line right of all poles. It is moved to the left, to

    a ray from infinity to R e^(-j 120 deg), the arc to R e^(-j 180 deg) = R e^(j 180 deg), and their mirror
    images,

and on the way meets all poles within R and no others, whose residues are summed. On the rays and arcs

    abs(e^(st))  <=  e^(-R t/2)

so what they add fades at once but at the first instants, and there H/s^n, which falls off, bounds it: on the
arcs by an integral covered with balls, on the rays by c abs(s)^(-7/4 - n). Where poles lie beyond R at 120
degrees and more, but none into the right half-plane, the rays are those of the axis, and nothing fades.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, log, pi
from typing import ClassVar

from flint import arb

from symflex.analysis.time_response.effort import EFFORT
from symflex.analysis.time_response.function_size import BoundBySize, Rest, SizeOfExponentials
from symflex.analysis.time_response.sample_times import SampleTimes
from symflex.analysis.time_response.sampled import ZERO, Refused
from symflex.balls import ball, precision
from symflex.roots.distributed.far_out import SECTORS, TILTED, FunctionFarOut
from symflex.roots.functions.kernel_function import KernelFunction
from symflex.transfer import BoundTransferFunction

SLOPE = 0.4999  # decay on a ray at 120 degrees, over abs(s): no more than one half
FAR = 1e4  # largest ratio of least radii at which a ray at 120 degrees is preferred to the axis
VAST = 1e60  # abs(s) [rad/s] at which the limit of a function is read off, with some 60 digits
INWARD = 1 - 1e-12  # factor on a radius, so that rounding moves it to the inside


@dataclass(frozen=True, eq=False)
class LossyBound(BoundBySize):
    """A transfer function that is about a power of s in the right half-plane, and beyond, far from 0."""

    name: ClassVar = "lossy modes"

    function: SizeOfExponentials
    far_out: FunctionFarOut
    known_from: float  # ln of the radius from which on it is

    @property
    def least(self) -> float:
        """Return ln of the radius from which on something is known."""
        return self.known_from

    def rest(self, reached: float, integrations: int, times: SampleTimes) -> Rest | None:
        """Return what two rays and the arcs between them add at most."""
        with precision(EFFORT.bits):
            radius = arb(reached).exp()
            size = self.far_out.size(float(radius.mid()) * INWARD)
            if size is None:
                return None
            is_tilted = self.far_out.sectors > SECTORS
            arc = self.function.on_arc(reached, 2 * pi / 3 if is_tilted else pi / 2, pi)
            falls = integrations - size.power  # H/s^n is about s^-falls
            if arc is None or not falls > 0:
                return None
            # Arc and ray stand for their mirror images as well: 2/(2 pi).
            arc = arc * radius ** (1 - integrations) / arb.pi()
            ray = size.most * radius ** (1 - ball(falls)) / arb.pi()
            always = (arc + ray / ball(falls - 1)).upper() if falls > 1 else arb(inf)
            start = arb(0) if falls > 1 else None
            if falls == 1:
                limit = self.far_out.size(VAST)
                start = limit.lead.real if limit is not None and limit.power == size.power else None
            tails = []
            for t in times.enclosed():
                bound = always
                if is_tilted and t > 0:
                    turned = SLOPE * radius * t
                    bound = (-turned).exp() * bound.min(arc + ray / turned)
                if not bound.is_finite() and not (t == 0 and start is not None):
                    return None
                tails.append(bound.upper())
            fade = SLOPE * radius if is_tilted else ZERO
            return Rest(always, tuple(tails), start, fade)


def lossy_bound(bound: BoundTransferFunction, integrations: int) -> tuple[LossyBound, int] | Refused:
    """Return what bounds the modes of a function whose waves all lose energy in the material."""
    function = SizeOfExponentials.of(bound)
    if function is None:
        return Refused("it is not a short sum of exponentials")
    denominator = KernelFunction(bound, bound.den)
    # About as many half waves as modes.
    start, far = (denominator.frequency_of(growth) for growth in (1.0, pi * EFFORT.far_modes))
    bounds, is_damped = list[LossyBound](), False
    for sectors in (TILTED, SECTORS):
        far_out = FunctionFarOut.of(bound, sectors)
        if far_out is not None and far_out.size(VAST) is not None:
            is_damped = True
            least = None if far_out.size(far) is None else far_out.least(start)
            bounds += [] if least is None else [LossyBound(function, far_out, log(least))]
    if not is_damped:
        return Refused("some waves have no material damping")
    if not bounds:
        return Refused("a bound on poles is known only beyond very many modes")
    return bounds[-1 if bounds[0].least > bounds[-1].least + log(FAR) else 0], integrations
