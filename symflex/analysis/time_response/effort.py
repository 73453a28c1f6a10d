"""How hard responses in time are worked at: every number that bounds a search, and why it is that."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True)
class Effort:
    """Limits of all ways, each with its reason."""

    # Digits and precision
    guard_digits: int = 6  # of poles, beyond those of the response: what sums of their terms lose
    shaped_digits: int = 2  # of responses that a shaper sums, beyond those of the sum, which may be smaller
    attempts: int = 7  # doublings of digits: poles that lie together to 10^-1000 are as good as a double one
    most_digits: int = 20_000
    bits: int = 128  # of sizes: exponents of some 10^6 leave a phase of 30 digits

    # Echoes
    echoes: int = 2000  # rational functions that one response is made of
    powers: int = 10_000  # sum of the powers of their denominators: 140 echoes of a lag take some seconds
    tie_bits: int = 256  # at which delays are put in order; equal ones are equal exactly

    # Waves that change their form
    wave_bits: int = 64  # of bounds
    wave_circles: float = 1.25  # from one circle that is tried to the next
    wave_arcs: int = 48  # balls that half a circle is covered with
    wave_guard_bits: int = 32  # for what sums of echoes lose
    wave_reach: int = (
        3000  # the largest R t: 1300 digits cancel then, and a series has three times as many terms
    )
    wave_work: float = 3e7  # echoes times squared terms of their series: some five seconds

    # Loops with delays that settle. Far from the axis many poles are right of a line, and a loop soon beyond.
    lines: tuple[float, ...] = (4.0, 3.0, 2.5, 2.0, 1.5, 1.0, 0.7, 0.5, 0.3, 0.2, 0.1)
    line_modes: int = 6  # looked at besides, where the lowest are not those right of the line
    line_parts: int = 4000  # a loop that rings at a thousand times its bandwidth takes some of them
    line_begun: int = 16  # parts at first

    # Modes
    mode_digits: int = 9  # of the largest value, where modes have no end: 10^-9 takes 500 of a displacement
    pole_digits: int = 24  # those of a double, and what the phase loses after some million turns
    first_modes: tuple[int, int] = (16, 32)  # modes whose bounds decide how many more are needed
    axis_modes: int = 2000  # on the axis: velocities fall off so slowly that no number is enough
    plane_modes: int = 100  # where each is searched in the plane: that takes some seconds
    far_modes: int = 200  # below the radius from which on a bound is known: 350 of a frame cost 25 s, in vain
    continued_modes: int = 5000  # where those before point to the next: a millisecond or two each
    slow_modes: int = 1000  # where even these would not do
    long: int = 100  # exponentials of a function of which no more are searched than at first: a frame has 274
    enough: float = 0.8  # of the radius allowed: the rest is for what values are known to
    rounds: int = 3  # rounds of that decision
    beside: float = 0.01  # of ln(abs(s)): zeros are sought a little farther than the root that may be one
    next_to: float = 0.05  # how far a mode may be from where those before point to, over the last step

    # Undamped beams
    cells: int = 360  # balls that one turn is covered with
    paths: int = 24  # thetas at which paths between poles are tried
    depths: int = 64  # balls that a path is covered with

    # What is estimated
    estimated_modes: int = 25
    few_estimated: int = 12  # of a network, tried first: 25 modes of two links with damping take a minute
    little: float = 1e-3  # estimated rest over the largest value below which these few are enough
    hopeless: float = 10.0  # the same above which more modes do not help
    too_much: float = 0.3  # the same from which on the modes say nothing at a time
    last_modes: int = 5  # from whose residues the rest is estimated
    slowest: float = 0.9  # half of a sum over the quarter before: it falls off so slowly that nothing is said
    far: int = 100  # of the highest pole, where H shows how a response begins; 1 where members taper
    begun_bits: int = 16_384  # highest precision of that value
    begun_closely: float = 1e-12  # its radius over the largest term, at which it is known well enough
    surer: int = 2  # by what the lack at t = 0 is multiplied: terms that differ in sign may add up to more

    # Sizes on arcs and rings
    arc_step: float = 0.1  # [rad]; where values vary much on one, it is halved
    smallest_step: float = 1e-9
    sharp: float = 0.25  # radius of the balls of sums on a step, over their middle: sizes are that uncertain
    series_terms: int = 4  # of sums on a step: with more, they hardly become longer
    widest: float = 2.0  # how far from poles that accumulate a ring is sought, over what they lie in
    ring_steps: int = 16  # of half a ring, at first
    ring_power: int = 50  # a sum over a ring lacks about exp(-50), or 10^-21, of the largest value on it


EFFORT: Final = Effort()
