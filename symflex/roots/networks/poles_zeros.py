"""Poles and zeros of a transfer function of a network without losses, from counts alone.

A pole is an eigenvalue of the network. What is held at the input, or at the output, has eigenvalues between
them; a pole that is one of these as well is a mode that input or output does not see, and hidden. Zeros of a
receptance at the input are the eigenvalues of the network held there.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi
from typing import TYPE_CHECKING

from flint import arb, ctx

from symflex.errors import BudgetError
from symflex.model.signs import is_passive
from symflex.roots.networks.anywhere import CRAMER, mirrored, roots_in_disc
from symflex.roots.networks.at_rest import nullity_at_rest
from symflex.roots.networks.counting import Counter
from symflex.roots.networks.cramer import CramerEquations, EssentialSingularityError, is_zero
from symflex.roots.networks.estimates import estimates
from symflex.roots.networks.members import UndecidedError
from symflex.roots.networks.network import OtherNetworkError, network_of
from symflex.roots.networks.repeated import repeated_parts
from symflex.roots.networks.search import Eigenvalue, EigenvalueSearch
from symflex.roots.networks.single_path import BEYOND_ALL, beside_path
from symflex.roots.pole_zero_map import (
    Certificate,
    HiddenRoot,
    PoleZeroMap,
    StabilityVerdict,
    judge,
    right_beyond,
)
from symflex.roots.polynomial_roots import in_order
from symflex.roots.region import Band, Mode, Modes, Position, Rectangle, Region
from symflex.roots.root import Root

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.budget import Budget
    from symflex.equations import Equations
    from symflex.roots.networks.network import Network

WITTRICK_WILLIAMS = "wittrick-williams"
"""What stands in a certificate: the count of Wittrick and Williams."""
WIDER = 1e-3
"""How far beyond the limits of a band is searched, relative to them."""
MATCHING_ROUNDS = 20
"""Searches that go further because input or output do not see some of the modes."""
PASSIVE = "passive, energy is nowhere supplied"
NOT_PASSIVE = "it is not proved that energy is nowhere supplied, and real poles were not counted"
NONE_ON_AXIS = "none of those found lies on the imaginary axis"
ACCUMULATE = "roots accumulate where a denominator vanishes, and could not be counted"
NOT_COUNTED = "the roots could not be counted"
REACHED = "poles are known up to {:.4g} Hz only"
ZERO = "the transfer function is zero: its modes, which are all hidden, were not searched"
TOO_FEW = "fewer modes than asked for lie where could be searched"
UNTOLD = "some roots could not be told apart"
UNDECIDED_AT_REST = "how often 0 is a root could not be told"
SHRINKING = 2.0**-30
ROUNDS_AT_REST = 4


Held = tuple[Counter, int | None]
"""What counts a network's eigenvalues, and which of its borders is held."""


@dataclass(frozen=True, slots=True)
class _Spectrum:
    """Eigenvalues of a network, or of the network with a motion held."""

    at_zero: int  # how often 0 is one
    is_exact: bool  # that is proved; else so many lie about 0
    near_zero: arb  # lambdas of those about 0
    eigenvalues: tuple[Eigenvalue, ...]

    @property
    def reached(self) -> arb:
        """Up to where all eigenvalues are known."""
        return self.eigenvalues[-1].high.value if self.eigenvalues else arb(0)

    @property
    def count(self) -> int:
        """How many of them are known."""
        last = self.eigenvalues[-1:]
        return sum(each.number + each.multiplicity - 1 for each in last)


def locate_in_network(
    equations: Equations,
    name: str,
    pair: tuple[str, str],
    region: Region,
    digits: int,
    budget: Budget,
    *,
    is_default: bool,
) -> PoleZeroMap:
    """Find poles and zeros of a transfer function, by counts where nothing loses energy, else in discs.

    ``equations`` have numbers in place of all parameters. Of a function that is zero, nothing is searched.
    """
    if is_zero(equations, *pair):
        nothing = Certificate(CRAMER, False, 0, 0, ZERO)
        unknown = judge([], ZERO)
        return PoleZeroMap(
            name,
            region,
            (),
            (),
            (),
            nothing,
            digits,
            is_default_region=is_default,
            is_infinite=True,
            verdict=unknown,
        )
    network: Network | None
    try:
        network = network_of(equations, *pair)
    except OtherNetworkError:
        network = None
    if network is None or not (network.driven and network.read):
        found = _anywhere(
            equations,
            pair,
            region,
            digits,
            budget,
            symmetric=(False, False) if network is None else network.symmetric,
        )
    else:
        found = _without_losses(network, equations, pair, region, digits, budget)
    return _with_certificate(found, name, region, digits, is_default=is_default)


def locate_quotient(
    cramer: CramerEquations, name: str, region: Region, digits: int, budget: Budget
) -> PoleZeroMap:
    """Find poles and zeros of a quotient of determinants, in a disc that holds the region."""
    found = _in_disc(cramer, region, digits, budget, symmetric=(False, False))
    return _with_certificate(found, name, region, digits)


def _with_certificate(
    found: LocatedRoots, name: str, region: Region, digits: int, *, is_default: bool = False
) -> PoleZeroMap:
    every = (*found.poles, *found.zeros, *(h.root for h in found.hidden))
    reasons = list(found.reasons)
    if not all(root.certified for root in every):
        reasons.append(UNTOLD)
    count = sum(root.multiplicity for root in (*every, *found.unstable))
    reason = "; ".join(dict.fromkeys(reasons)) or None
    certificate = Certificate(
        found.engine,
        reason is None,
        count,
        count,
        reason,
        is_exceeded=found.code is not None,
        code=found.code,
    )
    return PoleZeroMap(
        name,
        region,
        found.poles,
        found.zeros,
        found.hidden,
        certificate,
        digits,
        is_default_region=is_default,
        is_infinite=True,
        verdict=found.verdict,
        unstable=found.unstable,
    )


@dataclass(frozen=True, slots=True)
class LocatedRoots:
    """What a search has come to."""

    engine: str
    poles: tuple[Root, ...]
    zeros: tuple[Root, ...]
    hidden: tuple[HiddenRoot, ...]
    verdict: StabilityVerdict
    reasons: tuple[str, ...] = ()  # what is not proved
    unstable: tuple[Root, ...] = ()
    code: str | None = None  # of what was exceeded


def _without_losses(
    network: Network, equations: Equations, pair: tuple[str, str], region: Region, digits: int, budget: Budget
) -> LocatedRoots:
    """Count the poles, and the zeros where the output is what the input drives; else find these in a disc."""
    search = _NetworkSearch(network, region, digits, budget)
    reasons: list[str] = []
    code: str | None = None
    engine = WITTRICK_WILLIAMS
    found: LocatedRoots | None = None
    try:
        search.find()
        if search.zeros_of is None:
            found = _anywhere(equations, pair, region, digits, budget, symmetric=network.symmetric)
            engine = f"{WITTRICK_WILLIAMS}, {CRAMER}"
            reasons += found.reasons
    except BudgetError as error:
        reasons.append("; ".join(d.message for d in error.diagnostics))
        code = error.diagnostics[0].code
    except UndecidedError:
        reasons.append(NOT_COUNTED)
    poles, zeros, hidden = search.roots()
    if found is not None and not found.reasons:
        # What is at 0 is known from there, too, and how much of it is hidden.
        zeros = found.zeros
        poles = (*(r for r in found.poles if _is_at_zero(r)), *(r for r in poles if not _is_at_zero(r)))
        hidden = (
            *(h for h in found.hidden if _is_at_zero(h.root)),
            *(h for h in hidden if not _is_at_zero(h.root)),
        )
    elif found is not None:
        zeros = (*(r for r in zeros if not found.zeros), *found.zeros)
    known = [*poles, *(h.root for h in hidden if not h.is_proved)]
    proof = PASSIVE if network.passive else ""
    unseen = [h.root for h in hidden if h.is_proved]
    verdict = judge(known, NONE_ON_AXIS if proof else NOT_PASSIVE, proof, unseen)
    reasons += search.reasons
    return LocatedRoots(engine, poles, zeros, hidden, verdict, tuple(reasons), (), code)


def _is_at_zero(root: Root) -> bool:
    return bool(root.re.contains(0) and root.im.contains(0))


def _anywhere(
    equations: Equations,
    pair: tuple[str, str],
    region: Region,
    digits: int,
    budget: Budget,
    *,
    symmetric: tuple[bool, bool],
) -> LocatedRoots:
    proof = PASSIVE if is_passive(equations.model) else ""
    cramer = CramerEquations.of(equations, *pair)
    return _in_disc(cramer, region, digits, budget, symmetric=symmetric, proof=proof)


def _in_disc(
    cramer: CramerEquations,
    region: Region,
    digits: int,
    budget: Budget,
    *,
    symmetric: tuple[bool, bool],
    proof: str = "",
) -> LocatedRoots:
    """Find all roots in a disc that holds the region; ``proof`` says why no pole lies right of the axis."""
    try:
        found = roots_in_disc(cramer, region, digits, budget, symmetric=symmetric)
    except BudgetError as error:
        code, message = error.diagnostics[0].code, "; ".join(d.message for d in error.diagnostics)
        return _nothing(message, proof, code)
    except EssentialSingularityError:
        return _nothing(ACCUMULATE, proof)
    except UndecidedError:
        return _nothing(NOT_COUNTED, proof)
    poles, zeros = (_lowest(roots, region) for roots in (found.poles, found.zeros))
    shared = found.shared
    if isinstance(region, Modes):
        highest = max((root.natural_frequency() for root in poles), default=arb(0))
        shared = tuple(r for r in shared if r.is_zero or not r.natural_frequency() > highest)
    elif not isinstance(region, Mode):
        shared = _chosen(shared, region)
    reasons = []
    if isinstance(region, Modes | Mode):
        wanted = region.count if isinstance(region, Modes) else region.number
        if not found.holds(wanted):
            reasons.append(TOO_FEW)
    known = [*found.poles, *(r for r in found.shared if not r.is_zero)]
    beyond = REACHED.format(found.radius / (2 * pi))
    at_rest = [r for r in found.shared if r.is_zero]
    verdict = judge(known, NONE_ON_AXIS if proof else beyond, proof, at_rest)
    hidden = tuple(HiddenRoot(r, "cancelled" if r.is_zero else "coincident") for r in shared)
    unstable = right_beyond(found.poles, poles)
    return LocatedRoots(CRAMER, poles, zeros, hidden, verdict, tuple(reasons), unstable)


def _nothing(reason: str, proof: str, code: str | None = None) -> LocatedRoots:
    """Return that no root was found: of a passive network some may still lie on the imaginary axis."""
    verdict = judge([], f"{proof}, but it may vibrate for ever; {reason}" if proof else reason)
    return LocatedRoots(CRAMER, (), (), (), verdict, (reason,), (), code)


def _lowest(roots: Sequence[Root], region: Region) -> tuple[Root, ...]:
    """Return the roots of a disc that the region asks for; of modes, those that mirror each other are one."""
    if not isinstance(region, Modes | Mode):
        return _chosen(roots, region)
    taken = [root for root in roots if root.is_zero] if isinstance(region, Modes) else []
    reached = 0
    for group in mirrored(in_order(roots)):
        before, reached = reached, reached + group[0].multiplicity
        if isinstance(region, Modes) and before < region.count:
            taken += group
        elif isinstance(region, Mode) and before < region.number <= reached:
            taken += group
    return tuple(taken)


class _NetworkSearch:
    """Eigenvalues of a network, and of what is held at input and output."""

    def __init__(self, network: Network, region: Region, digits: int, budget: Budget) -> None:
        self.network, self.region, self.digits, self.budget = network, region, digits, budget
        borders = (network.driven,) if network.is_colocated else (network.driven, network.read)
        self.counter = Counter(network, borders)
        self.poles_of: Held = self.counter, None
        # ``None`` where zeros are no eigenvalues of anything.
        self.zeros_of: Held | None = (self.counter, 0) if network.is_colocated else None
        if not network.is_colocated and (beside := beside_path(network)) is not None:
            self.zeros_of = Counter(beside, ()), None
        self.are_all_zeros_known = False
        self.reasons: list[str] = []
        self.visible: list[Root] = []
        self.held: list[Root] = []
        self.shared: list[Root] = []
        self.unseen: dict[int, int] = {}  # per number of an eigenvalue
        # Per motion that is held: parts that make eigenvalues coincide, and how many.
        self.repeated: dict[Held, tuple[tuple[Counter, int], ...]] = {}
        self.searched: dict[Held, tuple[EigenvalueSearch, _Spectrum]] = {}

    def find(self) -> None:
        """Find the roots the region asks for, and perhaps more."""
        if isinstance(self.region, Modes):
            wanted = self.region.count
            for _ in range(MATCHING_ROUNDS):
                self._find(1, wanted, None)
                sides = [self.visible]
                if self.zeros_of is not None and not self.are_all_zeros_known:
                    sides.append(self.held)
                lacking = max(self.region.count - _modes(roots) for roots in sides)
                if lacking <= 0:
                    return
                wanted += lacking
            self.reasons.append("too many modes are hidden to tell those that are not")
        elif isinstance(self.region, Mode):
            self._find(self.region.number, self.region.number, None)
        else:
            self._find(1, 0, self._limits())

    def _limits(self) -> tuple[float, float]:
        """Return between which omega [rad/s] the region reaches along the imaginary axis."""
        match self.region:
            case Band(low, high):
                return 2 * pi * float(low) * (1 - WIDER), 2 * pi * float(high) * (1 + WIDER)
            case Rectangle(_, _, im_low, im_high):
                ends = abs(float(im_low)), abs(float(im_high))
                nearest = 0.0 if im_low <= 0 <= im_high else min(ends)
                return nearest * (1 - WIDER), max(ends) * (1 + WIDER)
        message = f"no limits of {type(self.region).__name__}"
        raise TypeError(message)

    def _find(self, first: int, last: int, limits: tuple[float, float] | None) -> None:
        budget = self.budget
        budget.progress.report(0.0, "counting poles")
        self.visible, self.held, self.shared = [], [], []
        poles = self._spectrum(self.poles_of, first, last, limits)
        zeros: _Spectrum | None = None
        if self.zeros_of is not None:
            budget.progress.report(0.5, "counting zeros")
            zeros = self._spectrum(self.zeros_of, first, last, limits)
            self.are_all_zeros_known = limits is None and zeros.count < last
        for each in poles.eigenvalues:
            unseen = self._unseen(each)
            is_one = self._is_one(each, self.poles_of)
            self.shared += _pair(each, unseen, is_one=is_one)
            self.visible += _pair(each, each.multiplicity - unseen, is_one=is_one)
        if zeros is not None:
            self.held = [root for each in zeros.eigenvalues for root in self._apart(each)]
        self._at_zero(poles, zeros)

    def _is_one(self, each: Eigenvalue, held: Held) -> bool:
        """Tell whether the eigenvalues of an interval are proved to be one, by equal parts of the network."""
        if each.multiplicity == 1:
            return True
        if held not in self.repeated:
            counter, border = held
            unknowns = () if border is None else counter.borders[border]
            parts = () if len(unknowns) > 1 else repeated_parts(counter.network, unknowns)
            self.repeated[held] = tuple((Counter(p.part, ()), p.multiplicity) for p in parts)
        return any(
            multiplicity == each.multiplicity and self._between(counter, each) == 1
            for counter, multiplicity in self.repeated[held]
        )

    def _between(self, counter: Counter, each: Eigenvalue) -> int:
        """Return how many eigenvalues of a part lie in an interval."""
        search = EigenvalueSearch(counter, None, self.digits, self.budget)
        high, low = (counter.sample(x.value, search.bits) for x in (each.high, each.low))
        return high.below - low.below

    def _at_zero(self, poles: _Spectrum, zeros: _Spectrum | None) -> None:
        network = self.network
        below = 2 * poles.at_zero + network.below
        # Where the output is elsewhere, one of the motions at rest is seen, or none.
        above = network.above + (2 * zeros.at_zero if zeros is not None else 2 * max(0, poles.at_zero - 1))
        exact = poles.is_exact and (zeros is None or zeros.is_exact)
        if not exact:
            self.reasons.append(UNDECIDED_AT_REST)
        hidden = min(below, above)
        self.visible += _zero(below - hidden, poles)
        self.shared += _zero(hidden, poles)
        self.held += _zero(above - hidden, poles if zeros is None else zeros)

    def _spectrum(self, held: Held, first: int, last: int, limits: tuple[float, float] | None) -> _Spectrum:
        """Return eigenvalues by number, or between two frequencies."""
        known_before = self.searched.get(held)
        if known_before is not None:
            return self._further(held, *known_before, last)
        counter, border = held
        search = EigenvalueSearch(counter, border, self.digits, self.budget)
        low, high = (None, None) if limits is None else (limits[0] ** 2, limits[1] ** 2)
        guesses = estimates(counter.level(search.bits), last, low, high, border)
        lowest = guesses[0] if guesses else (high or 1.0)
        count, exact = 0, True
        above = None
        for _ in range(ROUNDS_AT_REST):
            count, above = search.start(lowest)
            if not count:
                break
            known = nullity_at_rest(counter, border)
            exact = known == count
            if exact or known is None:
                break
            lowest *= SHRINKING
        if above is None:
            raise UndecidedError
        last = self._at_most(search, last)
        start = above if low is None or low <= float(above.value) else search.at(arb(low), arb(low))
        top = search.reach(last, None if high is None else arb(high), guesses, start)
        numbers = (first, last) if limits is None else (1, None)
        search.isolate(start, top, guesses, *numbers)
        spectrum = _Spectrum(count, exact, above.value.union(-above.value), search.ordered())
        self.searched[held] = search, spectrum
        return spectrum

    def _at_most(self, search: EigenvalueSearch, last: int) -> int:
        """Return the number of an eigenvalue, or of the last: without members there are finitely many."""
        if search.counter.network.members:
            return last
        return min(last, search.counter.sample(arb(BEYOND_ALL), search.bits).below - (search.base or 0))

    def _further(self, held: Held, search: EigenvalueSearch, before: _Spectrum, last: int) -> _Spectrum:
        """Return a spectrum with eigenvalues beyond those found before."""
        last = self._at_most(search, last)
        if before.count >= last:
            return before
        counter, border = held
        reached = before.eigenvalues[-1]
        guesses = estimates(counter.level(search.bits), last, None, None, border)
        top = search.reach(last, None, guesses, reached.high)
        beyond = [g for g in guesses if g > float(reached.high.value)]
        search.isolate(reached.high, top, beyond, before.count + 1, last)
        spectrum = replace(before, eigenvalues=search.ordered())
        self.searched[held] = search, spectrum
        return spectrum

    def _unseen(self, each: Eigenvalue) -> int:
        """Return how many of the modes of an eigenvalue input or output do not see."""
        if each.number not in self.unseen:
            unseen = self._most_held(each)
            self.unseen[each.number] = min(
                each.multiplicity, unseen and self._most_held(self._closer(each, self.poles_of))
            )
        return self.unseen[each.number]

    def _most_held(self, each: Eigenvalue) -> int:
        return max(self._held_within(each, border) for border in range(len(self.counter.borders)))

    def _held_within(self, each: Eigenvalue, border: int) -> int:
        """Return how many eigenvalues of the network held at a border lie in the same interval."""
        search = EigenvalueSearch(self.counter, border, self.digits, self.budget)
        return search.count(each.high) - search.count(each.low)

    def _closer(self, each: Eigenvalue, held: Held) -> Eigenvalue:
        """Return an eigenvalue to twice the digits."""
        search = EigenvalueSearch(*held, 2 * self.digits, self.budget)
        search.base = search.count(each.low) - each.number + 1
        search.isolate(each.low, each.high, (), each.number, None)
        return search.found[min(search.found)]

    def _apart(self, zero: Eigenvalue) -> list[Root]:
        """Return a zero but for what is hidden in it: poles at the same place that are not seen."""
        if self.zeros_of is None:
            return []
        within = self._poles_within(zero)
        if within is not None:
            within = self._poles_within(self._closer(zero, self.zeros_of))
        unseen = 0 if within is None else min(within.multiplicity, self._most_held(within))
        return _pair(zero, zero.multiplicity - unseen, is_one=self._is_one(zero, self.zeros_of))

    def _poles_within(self, zero: Eigenvalue) -> Eigenvalue | None:
        """Return the poles in the interval of a zero as one; ``None`` where there are none."""
        search = EigenvalueSearch(*self.poles_of, self.digits, self.budget)
        low, high = zero.low, zero.high
        if not self.network.is_colocated:  # these are samples of another network
            low, high = (search.at(x.value, arb(0)) for x in (low, high))
        found = search.count(high) - search.count(low)
        return Eigenvalue(low, high, 0, found) if found else None

    def roots(self) -> tuple[tuple[Root, ...], tuple[Root, ...], tuple[HiddenRoot, ...]]:
        """Return poles, zeros and hidden modes in the region."""
        poles, zeros = (_chosen(roots, self.region) for roots in (self.visible, self.held))
        within = self.region
        if isinstance(within, Modes):
            highest = max((root.natural_frequency() for root in poles), default=arb(0))
            shared = [r for r in in_order(self.shared) if r.is_zero or not r.natural_frequency() > highest]
        else:
            shared = list(_chosen(self.shared, within))
        hidden = tuple(HiddenRoot(r, "cancelled" if r.is_zero else "coincident") for r in shared)
        return poles, zeros, hidden


def _chosen(roots: Sequence[Root], region: Region) -> tuple[Root, ...]:
    ordered = in_order(roots)
    if isinstance(region, Mode):
        return tuple(root for root in ordered if not root.is_zero)
    positions = region.classify(ordered)
    return tuple(
        r if position is Position.INSIDE else replace(r, on_boundary=True)
        for r, position in zip(ordered, positions, strict=True)
        if position is not Position.OUTSIDE
    )


def _pair(each: Eigenvalue, multiplicity: int, *, is_one: bool) -> list[Root]:
    """Return s and its conjugate of so many eigenvalues, which are one where that is proved."""
    if multiplicity <= 0:
        return []
    with ctx.workprec(max(each.low.value.bits(), each.high.value.bits()) + 32):
        omega = each.low.value.sqrt().union(each.high.value.sqrt())
    is_one = is_one or multiplicity == 1
    return [
        Root(arb(0), im, multiplicity, on_imaginary_axis=True, is_real=False, certified=is_one)
        for im in (omega, -omega)
    ]


def _modes(roots: Sequence[Root]) -> int:
    """Return how many modes there are among roots on the imaginary axis."""
    return sum(root.multiplicity for root in roots if root.im > 0)


def _zero(order: int, spectrum: _Spectrum) -> list[Root]:
    if order <= 0:
        return []
    if spectrum.is_exact:
        return [Root(arb(0), arb(0), order, on_imaginary_axis=True, is_real=True)]
    size = spectrum.near_zero.abs_upper().sqrt()
    box = arb(0, size.upper())
    return [Root(box, box, order, on_imaginary_axis=False, is_real=False, certified=False)]
