"""A transfer function from one sample to the next: its poles and zeros in z, and its difference equation.

Input: a bound transfer function that is rational but for delays, a sampling time h, a method.
Output: a :class:`SampledTransferFunction`, everything in balls.

    1/(s + 2), h = 0.1    zoh        0.0906 /(z - e^(-0.2))          its step response is that of 1/(s + 2)
                          tustin     0.0455 (z + 1)/(z - 0.9/1.1)    s = 2/h (z - 1)/(z + 1)
                          matched    0.0906 /(z - e^(-0.2))          every root s becomes e^(s h)

``zoh`` is what a plant does whose input a computer holds between samples; ``tustin`` and ``matched`` make
difference equations of controllers and filters that were designed in s (Franklin, Powell and Workman 1998,
Digital Control of Dynamic Systems, chapter 6). A delay of any fraction of samples is exact with ``zoh``:

    g(k h - T), the step response at samples, less itself one sample before, is the impulse response, and that
    times the denominator is the numerator: n + 1 numbers, whatever the multiplicities of the poles.

A map may take roots together or to infinity: ``tustin`` takes a zero at 2/h to infinity, and poles that
differ by ``2 pi j/h`` are one pole at samples. So what is made of roots is compared with what is not:
``G(k (z - 1)/(z + 1))`` at one z, and twice as many samples of the step response.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import ceil, prod

import numpy as np
import numpy.typing as npt
from flint import acb, acb_poly, arb

from symflex.analysis.time_response.delayed_terms import delayed_quotient
from symflex.analysis.time_response.partial_fractions import EnclosedQuotient, partial_fractions, values_of
from symflex.analysis.time_response.sample_times import SampleTimes
from symflex.balls import UndecidedError, ball, bits_for_digits, current_bits, precision, settled
from symflex.budget import spend
from symflex.errors import REPORT, Diagnostic, InternalError, ModelError, UncertifiedError, refused
from symflex.errors.optional import installed
from symflex.model.loss_factors import check_causal
from symflex.roots import Root, find_polynomial_roots
from symflex.roots.functions.simplified import without_lengths_of_zero
from symflex.roots.problem import RootProblem, problem_of
from symflex.roots.root import exact_fraction
from symflex.state_space import not_rational
from symflex.state_space.sampled import Sampling
from symflex.transfer import BoundTransferFunction

FIRST_DIGITS, LAST_DIGITS = 60, 4000
TRIED_AT = acb(1.2345, 0.5432)  # where a function of z is compared: a pole there is a rare accident
GOOD_BITS = 110  # precision of every coefficient: twice a double's, and room to measure rounding to it
NOTHING_BITS = 180  # a coefficient so many bits below the largest counts as zero if its sign stays open


@dataclass(frozen=True, eq=False)
class SampledTransferFunction:
    """``z^-late * gain * prod(z - zeros)/prod(z - poles)``, from one sample to the next."""

    tf: str  # ``"OUT/IN"``
    sampling: Sampling
    late: int  # whole samples of delay
    numerator: tuple[arb, ...]  # in descending powers of z, as many as the denominator has
    denominator: tuple[arb, ...]  # monic
    poles: tuple[acb, ...]  # as often as their multiplicities say, without those of ``late``
    zeros: tuple[acb, ...] | None  # likewise; None if they cannot be separated
    bits: int  # of the precision all this was computed at

    @property
    def dt(self) -> float:
        """The sampling time [s]."""
        return float(self.sampling.sample)

    def __repr__(self) -> str:
        count = len(self.poles) + self.late
        return (
            f"<SampledTransferFunction {self.tf}: {self.sampling.method}, every {self.dt:g} s, {count} poles>"
        )

    def __call__(self, z: complex) -> complex:
        """Return the value at z; not a number at a pole."""
        with precision(self.bits):
            return complex(self.enclosed(acb(z)).mid())

    def enclosed(self, z: acb) -> acb:
        """Return the value in a ball of the current precision."""
        above, below = (acb_poly([acb(c) for c in p[::-1]])(z) for p in (self.numerator, self.denominator))
        return above / below / z**self.late

    def coefficients(self) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Return numerator and denominator in descending powers of z, delay included, as doubles.

        They lose digits where poles lie close together; second-order sections, as of exported code, do not.
        """
        above = np.array([float(c.mid()) for c in self.numerator])
        below = np.array([float(c.mid()) for c in self.denominator])
        first = int(np.argmax(above != 0)) if above.any() else above.size - 1
        return above[first:], np.concatenate([below, np.zeros(self.late)])

    def to_control(self) -> object:
        """Return a discrete ``control.TransferFunction``; SF902 when python-control is not installed."""
        return installed("control").TransferFunction(*self.coefficients(), self.dt)

    def to_scipy(self) -> object:
        """Return a discrete ``scipy.signal.TransferFunction``."""
        return installed("scipy.signal").TransferFunction(*self.coefficients(), dt=self.dt)


@dataclass(frozen=True, eq=False)
class Delayed:
    """A quotient of polynomials times a delay."""

    numerator: acb_poly
    late: arb  # the delay [s]


@dataclass(frozen=True, eq=False)
class Continuous:
    """What is sampled: terms with a common denominator, in balls of the current precision."""

    terms: tuple[Delayed, ...]
    denominator: acb_poly
    poles: tuple[Root, ...]
    zeros: tuple[Root, ...]  # of the only term; empty where there are several

    @property
    def order(self) -> int:
        """The degree of the denominator."""
        return int(self.denominator.degree())


def sampled_transfer_function(bound: BoundTransferFunction, sampling: Sampling) -> SampledTransferFunction:
    r"""Return a transfer function as it is seen, or is to be computed, at samples.

    Parameters
    ----------
    bound : BoundTransferFunction
        Rational, but for delays outside of loops.
    sampling : Sampling
        How often, and by which method.

    Raises
    ------
    UsageError
        SF902 for a delay of too many samples, or with another method than ``zoh`` of no whole number,
        and for a pole that ``tustin`` takes to infinity.
    ModelError
        SF235 for beams, and for delays in loops; SF236 for a function that grows with s.
    UncertifiedError
        SF810 where poles cannot be separated.

    Examples
    --------
    >>> from symflex import loads
    >>> lag = loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/(s + 2)"').transfer_function("y", "u")
    >>> found = sampled_transfer_function(lag.bind().bound, Sampling(Fraction(1, 10), "tustin"))
    >>> [c.round(9).tolist() for c in found.coefficients()]  # (z + 1)/22 over z - 9/11
    [[0.045454545, 0.045454545], [1.0, -0.818181818]]
    """
    check_causal(bound.source.model, "a sampled function")
    if bound.ratio.is_zero:
        return SampledTransferFunction(bound.name, sampling, 0, (arb(0),), (arb(1),), (), (), GOOD_BITS)
    bound = without_lengths_of_zero(bound)
    try:
        return settled(lambda: _sampled(bound, sampling), 2 * bits_for_digits(FIRST_DIGITS))
    except UndecidedError:
        message = f"poles of {bound.name} cannot be separated, so it cannot be sampled"
        raise UncertifiedError(Diagnostic("SF810", message)) from None


def _sampled(bound: BoundTransferFunction, sampling: Sampling) -> SampledTransferFunction:
    spend()
    bits = current_bits()
    given = continuous_parts(bound, bits * FIRST_DIGITS // (2 * bits_for_digits(FIRST_DIGITS)), bits)
    numerator, denominator, poles, zeros, late, size = MAPS[sampling.method](bound, given, sampling)
    above, below = _told(numerator, size), _told(denominator)
    zeros = _roots_of(above) if zeros is None else zeros
    return SampledTransferFunction(bound.name, sampling, late, above, below, poles, zeros, bits)


def _check(bound: BoundTransferFunction, difference: acb, size: acb) -> None:
    """Refuse a function whose difference from what it should be is not zero."""
    if not _is_nothing(difference, size):
        message = f"the function of z of {bound.name} is wrong by {complex(difference):.4g} at a point"
        raise InternalError(Diagnostic("SF991", message, None, REPORT))


def continuous_parts(bound: BoundTransferFunction, digits: int, bits: int) -> Continuous:
    """Return what is sampled, with poles to so many digits; SF235, SF236 where that fails."""
    if bound.is_rational:
        sides = [[(f, e * sign) for f, e in bound.ratio.factors if e * sign > 0] for sign in (1, -1)]
        zeros, poles = (find_polynomial_roots(problem_of(bound, side), digits) for side in sides)
        num, den = EnclosedQuotient.of(bound, bits).multiplied_out()
        _check_order(bound, num, den)
        return Continuous((Delayed(num, arb(0)),), den, poles, zeros)
    quotient = delayed_quotient(bound)
    if quotient is None:
        raise not_rational(bound.name)
    if len(quotient.below) > 1:
        message = f"{bound.name} has a delay in a loop, or waves: infinitely many states between samples"
        hint = "sample the plant and the controller separately, and close the loop in z"
        raise ModelError(Diagnostic("SF235", message, None, hint))
    durations = quotient.durations
    ((first, below),) = quotient.below.items()
    den = acb_poly(durations.polynomial(below))
    terms = []
    for delay, above in quotient.above.items():
        late = durations.seconds(delay) - durations.seconds(first)
        num = acb_poly(durations.polynomial(above))
        _check_order(bound, num, den)
        if late < 0:
            message = f"{bound.name} looks ahead: its output would come before its input"
            raise ModelError(Diagnostic("SF235", message, None, "make every delay zero or positive"))
        terms.append(Delayed(num, late))
    exact = [durations.exact(p) for p in (below, *quotient.above.values())]
    roots = [find_polynomial_roots(RootProblem(((p, 1),)), digits) if p.degree > 0 else () for p in exact[:2]]
    return Continuous(tuple(terms), den, roots[0], roots[1] if len(terms) == 1 else ())


def _check_order(bound: BoundTransferFunction, num: acb_poly, den: acb_poly) -> None:
    if num.degree() > den.degree():
        message = f"{bound.name} has more zeros than poles: it cannot be computed from samples"
        hint = "filter it, as with T_f of a pid, or take an output with fewer derivatives"
        raise ModelError(Diagnostic("SF236", message, None, hint))


Found = tuple["list[arb]", "list[arb]", "tuple[acb, ...]", "tuple[acb, ...] | None", int, arb]
"""Numerator, denominator, poles, zeros where they are known, whole samples of delay, and a size beside
which a coefficient of the numerator may be nothing."""


def _held(bound: BoundTransferFunction, given: Continuous, sampling: Sampling) -> Found:
    """Return the function whose step response is that of the given one at samples."""
    poles = _poles_at_samples(given.poles, sampling)
    below = monic(poles)
    n = len(poles)
    size = arb(0)
    parts: list[tuple[int, list[arb]]] = []
    for term in given.terms:
        delay = whole_delay(term.late, sampling)
        samples = ceil(delay / sampling.sample)
        ahead = samples * sampling.sample - delay
        quotient = EnclosedQuotient(((term.numerator, 1),), ((given.denominator, 1),), acb(1))
        exponentials = partial_fractions(quotient, given.poles, 1)
        if exponentials is None:
            raise UndecidedError
        times = SampleTimes.evenly(sampling.sample * (2 * n + 2), 2 * n + 3)
        # Between samples as well: at samples the response of a mode may be zero.
        between = values_of(exponentials, times, delay=-ball(sampling.sample) / 3)
        step = values_of(exponentials, times, delay=-ball(ahead))
        size = max([size, *(c.abs_upper() for c in (*step, *between))])
        if not ahead and term.numerator.degree() < given.order:
            step[0] = arb(0)
        pulses = [step[0], *(b - a for a, b in pairwise(step))]
        products = ((below[k] * pulses[i - k] for k in range(min(i, n) + 1)) for i in range(2 * n + 2))
        above = [sum(each, arb(0)) for each in products]
        for beyond in above[n + 1 :]:
            _check(bound, acb(beyond), acb(size))
        parts.append((samples, above[: n + 1]))
    late = min(samples for samples, _ in parts)
    extra = max(samples for samples, _ in parts) - late
    total = [arb(0)] * (n + 1 + extra)
    for samples, above in parts:
        for i, c in enumerate(above):
            total[i + samples - late] = total[i + samples - late] + c
    none = [arb(0)] * extra
    return total, [*below, *none], (*poles, *(acb(0) for _ in none)), None, late, size


def _poles_at_samples(poles: Sequence[Root], sampling: Sampling) -> tuple[acb, ...]:
    """Return the poles in z, those of a step response; poles of s that are one at samples count once."""
    found = [(acb(1), 1 + sum(root.multiplicity for root in poles if root.is_zero))]
    for root in poles:
        (z,) = _mapped([root], lambda s: (s * sampling.seconds).exp())[:1]
        same = next((i for i, (other, _) in enumerate(found) if _is_nothing(z - other, z)), len(found))
        if same == len(found):
            found.append((z, 0))
        if not root.is_zero:
            found[same] = (found[same][0], max(found[same][1], root.multiplicity))
    found[0] = (found[0][0], found[0][1] - 1)
    return tuple(z for z, count in found for _ in range(count))


def _tustin(bound: BoundTransferFunction, given: Continuous, sampling: Sampling) -> Found:
    """Return the function of s = k (z - 1)/(z + 1), where s - r is ((k - r) z - (k + r))/(z + 1)."""
    late = _only_whole(bound, given, sampling)
    k = acb(sampling.rate)
    if any(_is_nothing(k - p.enclosure(), k) for p in given.poles):
        message = f"{bound.name} has a pole at {float(k.real.mid()):g} rad/s, which tustin takes to infinity"
        raise refused(message, "choose another sampling time")
    finite = [root for root in given.zeros if not _is_nothing(k - root.enclosure(), k)]
    poles, zeros = (_mapped(roots, lambda s: (k + s) / (k - s)) for roots in (given.poles, finite))
    gain = _leading(given)
    for root in given.zeros:
        gain = gain * (k - root.enclosure() if root in finite else -2 * k) ** root.multiplicity
    for root in given.poles:
        gain = gain / (k - root.enclosure()) ** root.multiplicity
    surplus = len(poles) - sum(root.multiplicity for root in given.zeros)
    zeros, z = (*zeros, *(acb(-1) for _ in range(surplus))), TRIED_AT
    value = gain * prod((z - r for r in zeros), start=acb(1)) / prod((z - p for p in poles), start=acb(1))
    s = k * (z - 1) / (z + 1)
    _check(bound, value - given.terms[0].numerator(s) / given.denominator(s), value)
    return _product(gain, zeros, poles, late)


def _matched(bound: BoundTransferFunction, given: Continuous, sampling: Sampling) -> Found:
    """Return the function whose roots are exp(s h), and which is the same where s is small.

    Of zeros at infinity all but one come to z = -1: the one left is the sample that computing may take.
    """
    late = _only_whole(bound, given, sampling)
    h = sampling.seconds
    poles, zeros = (_mapped(roots, lambda s: (s * h).exp()) for roots in (given.poles, given.zeros))
    more = max(len(poles) - len(zeros) - 1, 0)
    gain = _leading(given) / 2**more
    for roots, sign in ((given.zeros, 1), (given.poles, -1)):
        for root in roots:
            s = root.enclosure()
            if not root.is_zero and _is_nothing(1 - (s * h).exp(), acb(1)):
                message = f"{bound.name} has {'a zero' if sign > 0 else 'a pole'} at {complex(s):.6g} rad/s, "
                message += "which matched takes to z = 1, as if it were at s = 0"
                raise refused(message, "choose another sampling time")
            ratio = 1 / acb(h) if root.is_zero else -s / (1 - (s * h).exp())
            gain = gain * ratio ** (sign * root.multiplicity)
    return _product(gain, (*zeros, *(acb(-1) for _ in range(more))), poles, late)


def _product(gain: acb, zeros: tuple[acb, ...], poles: tuple[acb, ...], late: int) -> Found:
    above = [c * gain.real for c in monic(zeros)]
    return [arb(0)] * (len(poles) - len(zeros)) + above, monic(poles), poles, zeros, late, arb(0)


MAPS: dict[str, Callable[[BoundTransferFunction, Continuous, Sampling], Found]] = {
    "zoh": _held,
    "tustin": _tustin,
    "matched": _matched,
}  # one for every method of :class:`Sampling`


def delay_of(bound: BoundTransferFunction, sampling: Sampling) -> Fraction:
    """Return the delay [s] of a function that is rational otherwise; errors as of sampling it."""
    bits = 2 * bits_for_digits(FIRST_DIGITS)
    with precision(bits):
        given = continuous_parts(without_lengths_of_zero(bound), FIRST_DIGITS, bits)
        if len(given.terms) > 1:
            message = f"{bound.name} is a sum of delays: its state equations are not those of the model"
            raise ModelError(Diagnostic("SF235", message, None, "export code with --to c or numpy"))
        return whole_delay(given.terms[0].late, sampling)


def whole_delay(late: arb, sampling: Sampling) -> Fraction:
    """Return a delay as a number; one that no precision tells from whole samples is so many."""
    ratio = late / sampling.seconds
    near = round(float(ratio.mid()))
    delay = near * sampling.sample if ratio.contains(near) else exact_fraction(late.mid())
    sampling.check_delay(delay)
    return delay


def _only_whole(bound: BoundTransferFunction, given: Continuous, sampling: Sampling) -> int:
    if len(given.terms) > 1:
        raise refused(f"{bound.name} is a sum of delays, which '{sampling.method}' cannot handle", "take zoh")
    return int(whole_delay(given.terms[0].late, sampling) / sampling.sample)


def _leading(given: Continuous) -> acb:
    above = given.terms[0].numerator
    return above[above.degree()] / given.denominator[given.order]


def _mapped(roots: Sequence[Root], move: Callable[[acb], acb]) -> tuple[acb, ...]:
    mapped = []
    for root in roots:
        z = move(root.enclosure())
        # Roots that are not real may become so: exp(s h) where s + pi j/h is real.
        z = acb(z.real) if root.is_real or _is_nothing(acb(z.imag), z) else z
        mapped += [acb(0) if _is_nothing(z, acb(1)) else z] * root.multiplicity
    return tuple(mapped)


def _is_nothing(value: acb, beside: acb) -> bool:
    """Whether a number is zero, as far as many digits tell; UndecidedError where more may tell."""
    if not value.contains(0):
        return False
    if not value.abs_upper() < beside.abs_lower() * arb(2) ** -NOTHING_BITS:
        raise UndecidedError
    return True


def monic(roots: Sequence[acb]) -> list[arb]:
    """Return the monic polynomial with conjugate or real roots, in descending powers."""
    polynomial = prod((acb_poly([-root, acb(1)]) for root in roots), start=acb_poly([1]))
    return [c.real for c in polynomial.coeffs()[::-1]]


def _told(coefficients: Sequence[arb], size: arb | None = None) -> tuple[arb, ...]:
    """Return coefficients that are known well, zeros that are nothing beside the others, or a size."""
    largest = acb(max([size or arb(0), *(c.abs_upper() for c in coefficients)]))
    told = [arb(0) if c == 0 or _is_nothing(acb(c), largest) else c for c in coefficients]
    if any(c != 0 and c.rel_accuracy_bits() < GOOD_BITS for c in told):
        raise UndecidedError
    return tuple(told)


def _roots_of(coefficients: Sequence[arb]) -> tuple[acb, ...] | None:
    """Return the roots of a polynomial in descending powers; None if they cannot be separated."""
    remaining = list(coefficients)
    while remaining and remaining[0] == 0:
        remaining.pop(0)
    at_zero = 0
    while remaining and remaining[-1] == 0:
        remaining.pop()
        at_zero += 1
    if not remaining:
        return ()
    try:
        roots = acb_poly([acb(c) for c in remaining[::-1]]).roots(
            tol=arb(2) ** -GOOD_BITS, maxprec=LAST_DIGITS
        )
    except ValueError:
        return None
    # Of isolated roots one whose ball meets the real axis is its own conjugate.
    real = (acb(z.real) if z.imag.contains(0) else z for z in roots)
    return (*real, *(acb(0) for _ in range(at_zero)))
