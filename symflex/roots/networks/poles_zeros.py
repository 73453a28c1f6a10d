"""Poles and zeros of a transfer function of an undamped network, from counts alone.

A pole is an eigenvalue of the network. What is held at the input, or at the output, has eigenvalues between
them; a pole that is one of these as well is a mode that is uncontrollable or unobservable, and hidden. Zeros
of a receptance at the input are the eigenvalues of the network held there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from math import pi

from flint import arb

from symflex.balls import UndecidedError, opposite, precision
from symflex.budget import entered_budget
from symflex.equations import Equations
from symflex.errors import BudgetError
from symflex.roots.networks.anywhere import CRAMER, roots_in_disc, wanted_modes
from symflex.roots.networks.at_rest import order_at_zero
from symflex.roots.networks.counting import Counter
from symflex.roots.networks.cramer import CramerEquations, is_zero
from symflex.roots.networks.network import Network, OtherNetworkError, network_of
from symflex.roots.networks.parity import mirrored
from symflex.roots.networks.search import Eigenvalue, EigenvalueSearch
from symflex.roots.passivity import EnergyProof
from symflex.roots.pole_zero_map import (
    COINCIDE,
    NONE_ON_AXIS,
    HiddenRoot,
    PoleZeroMap,
    chosen,
    hidden_region,
    judge,
    search_modes,
)
from symflex.roots.polynomial_roots import in_order
from symflex.roots.region import Band, Mode, Modes, Rectangle, Region
from symflex.roots.root import TOUCHING, Root, count_modes, root_at_zero
from symflex.transfer.equations_at import EssentialSingularityError

WITTRICK_WILLIAMS = "wittrick-williams"  # what stands in a certificate: the count of both
WIDER = 1e-3  # how far beyond the limits of a band is searched, relative to them
NOT_PASSIVE = "it is not proved that nothing supplies energy, and real poles were not counted"
ACCUMULATE = "roots accumulate where a denominator vanishes, and could not be counted"
NOT_COUNTED = "the roots could not be counted"
REACHED = "poles are known up to {:.4g} Hz only"
ZERO = "the transfer function is zero: its modes, which are all hidden, were not searched"
TOO_FEW = "the part that could be searched has fewer modes than requested"
UNDECIDED_AT_REST = "the multiplicity of the root at 0 could not be determined"


def locate_in_network(
    equations: Equations,
    name: str,
    pair: tuple[str, str],
    region: Region,
    digits: int,
    *,
    is_default: bool,
    energy: EnergyProof,
) -> PoleZeroMap:
    """Find poles and zeros of a network, by counts where nothing loses energy, else in discs."""
    if is_zero(equations, *pair):
        return _Sought(name, region, digits, is_default).nothing(ZERO)
    cramer = CramerEquations.of(equations, *pair)
    network: Network | None = None
    with suppress(OtherNetworkError):
        network = network_of(equations, *pair, is_passive=energy.is_passive) if cramer.is_real else None
    proof = energy.reason if energy.is_passive else ""
    unsure = "" if proof and energy.rests else NONE_ON_AXIS
    sought = _Sought(name, region, digits, is_default, proof, unsure)
    if network is None or not (network.driven and network.read):
        return sought.in_disc(cramer)
    return sought.without_losses(network, cramer)


def locate_quotient(cramer: CramerEquations, name: str, region: Region, digits: int) -> PoleZeroMap:
    """Find poles and zeros of a quotient of determinants, in a disc that contains the region."""
    return _Sought(name, region, digits).in_disc(cramer)


@dataclass(frozen=True, slots=True)
class _Sought:
    """Which poles and zeros are asked for, and what is known before they are searched."""

    name: str
    region: Region
    digits: int
    is_default: bool = False
    proof: str = ""  # why no pole lies in the right half-plane
    unsure: str = NONE_ON_AXIS  # what is not known with that proof

    @property
    def located(self) -> Callable[..., PoleZeroMap]:
        """What makes a map of the region from the rest of what :meth:`PoleZeroMap.of` asks for."""
        return partial(PoleZeroMap.of, self.name, self.region, self.digits, is_default=self.is_default)

    def nothing(self, reason: str, code: str | None = None) -> PoleZeroMap:
        """Return that no root was found: of a passive network some may still lie on the imaginary axis."""
        said = f"{self.proof}, but it may vibrate forever; {reason}" if self.proof else reason
        return self.located(CRAMER, ((), (), ()), judge([], said), reasons=[reason], code=code)

    def without_losses(self, network: Network, cramer: CramerEquations) -> PoleZeroMap:
        """Count the poles, and the zeros if the output is what the input drives; else find all in a disc."""
        in_disc = None if network.is_colocated else self.in_disc(cramer)
        if in_disc is not None and in_disc.certificate.reason in (None, TOUCHING):
            return in_disc
        search = _NetworkSearch(network, cramer, self.region, self.digits)
        reasons: list[str] = []
        code: str | None = None
        try:
            search.find()
        except BudgetError as error:
            reasons.append("; ".join(d.message for d in error.diagnostics))
            code = error.diagnostics[0].code
        except UndecidedError:
            reasons.append(NOT_COUNTED)
        poles, zeros, hidden = search.roots()
        engine = WITTRICK_WILLIAMS
        if in_disc is not None:
            engine, zeros = f"{WITTRICK_WILLIAMS}, {CRAMER}", in_disc.zeros or zeros
            reasons.append(in_disc.certificate.reason or "")
        known = [*poles, *(h.root for h in hidden if not h.is_proved)]
        unseen = [h.root for h in hidden if h.is_proved]
        verdict = judge(known, self.unsure if self.proof else NOT_PASSIVE, self.proof, unseen)
        return self.located(
            engine, (poles, zeros, hidden), verdict, reasons=reasons + search.reasons, code=code
        )

    def in_disc(self, cramer: CramerEquations) -> PoleZeroMap:
        """Find all roots in a disc that contains the region."""
        region = self.region
        try:
            in_disc = roots_in_disc(cramer, region, self.digits, symmetric=mirrored(cramer))
        except BudgetError as error:
            return self.nothing("; ".join(d.message for d in error.diagnostics), error.diagnostics[0].code)
        except EssentialSingularityError:
            return self.nothing(ACCUMULATE)
        except UndecidedError:
            return self.nothing(NOT_COUNTED)
        poles, zeros = (chosen(roots, region) for roots in (in_disc.poles, in_disc.zeros))
        known = [*in_disc.poles, *(r for r in in_disc.shared if not r.is_zero)]
        beyond = REACHED.format(in_disc.radius / (2 * pi))
        at_rest = [r for r in in_disc.shared if r.is_zero]
        verdict = judge(known, self.unsure if self.proof else beyond, self.proof, at_rest)
        shown = (poles, zeros, _hidden(in_disc.shared, poles, region))
        reasons = [] if in_disc.holds(wanted_modes(region)) else [TOO_FEW]
        return self.located(CRAMER, shown, verdict, reasons=reasons, growing=in_disc.poles)


def _hidden(shared: Sequence[Root], poles: Sequence[Root], region: Region) -> tuple[HiddenRoot, ...]:
    shown = chosen(shared, hidden_region(region, poles))
    return tuple(HiddenRoot(r, "cancelled" if r.is_zero else "coincident") for r in shown)


class _NetworkSearch:
    """Eigenvalues of a network, and of what is held at input and output: borders 0 and 1, poles' is None."""

    def __init__(self, network: Network, cramer: CramerEquations, region: Region, digits: int) -> None:
        self.network, self.cramer = network, cramer
        self.region, self.digits = region, digits
        borders = (network.driven,) if network.is_colocated else (network.driven, network.read)
        self.counter = Counter(network, borders)
        self.reasons: list[str] = []
        self.visible: list[Root] = []
        self.held: list[Root] = []
        self.shared: list[Root] = []
        self.unseen: dict[int, int] = {}  # per number of an eigenvalue
        self.searched: dict[int | None, EigenvalueSearch] = {}  # per border

    def find(self) -> None:
        """Find the roots the region asks for, and perhaps more; zeros where they are eigenvalues."""
        if isinstance(self.region, Modes):
            if not search_modes(self.region.count, self._find_modes):
                self.reasons.append(COINCIDE)
        elif isinstance(self.region, Mode):
            self._find(self.region.number, self.region.number, None)
        else:
            self._find(1, None, self._limits())

    def _find_modes(self, modes: int) -> int:
        self._find(1, modes, None)
        sides = [self.visible, self.held] if self.network.is_colocated else [self.visible]
        return max(wanted_modes(self.region) - count_modes(roots) for roots in sides)

    def _limits(self) -> tuple[float, float]:
        """Return between which omega [rad/s] the region reaches along the imaginary axis."""
        match self.region:
            case Band(low, high):
                return 2 * pi * float(low) * (1 - WIDER), 2 * pi * float(high) * (1 + WIDER)
            case Rectangle(_, _, im_low, im_high):
                ends = abs(float(im_low)), abs(float(im_high))
                nearest = 0.0 if im_low <= 0 <= im_high else min(ends)
                return nearest * (1 - WIDER), max(ends) * (1 + WIDER)
        raise TypeError(f"no limits of {type(self.region).__name__}")

    def _find(self, first: int, last: int | None, limits: tuple[float, float] | None) -> None:
        entered_budget().progress.report(0.0, "counting poles")
        self.visible, self.held, self.shared = [], [], []
        poles = self._spectrum(None, first, last, limits)
        for each in poles.ordered():
            unseen = self._unseen(each)
            self.shared += _pair(each, unseen)
            self.visible += _pair(each, each.multiplicity - unseen)
        zeros: EigenvalueSearch | None = None
        if self.network.is_colocated:
            entered_budget().progress.report(0.5, "counting zeros")
            zeros = self._spectrum(0, first, last, limits)
            self.held = [root for each in zeros.ordered() for root in self._apart(each)]
        self._at_zero(poles, zeros)

    def _at_zero(self, poles: EigenvalueSearch, zeros: EigenvalueSearch | None) -> None:
        network = self.network
        below = 2 * poles.at_zero + network.below
        # Where the output is elsewhere, one of the motions at rest is seen, or none.
        above = network.above + 2 * (zeros.at_zero if zeros is not None else max(0, poles.at_zero - 1))
        if not all(side.is_exact for side in (poles, zeros) if side is not None):
            self.reasons.append(UNDECIDED_AT_REST)
        hidden = min(below, above)
        self.visible += _zero(below - hidden, poles)
        self.shared += _zero(hidden, poles)
        self.held += _zero(above - hidden, zeros or poles)

    def _spectrum(
        self, border: int | None, first: int, last: int | None, limits: tuple[float, float] | None
    ) -> EigenvalueSearch:
        """Return a search that has found eigenvalues by number, or between two omega [rad/s]."""
        search = self.searched.get(border)
        if search is not None:
            start = search.ordered()[-1].high
        else:
            search = self.searched[border] = EigenvalueSearch(self.counter, border, self.digits)
            start = search.start(partial(self._nullity, border))
        if limits is None:
            search.isolate(start, search.reach(last or first, start), first, last)
            return search
        low, high = (arb(x * x) for x in limits)
        start = start if low <= start.value else search.at(low, low)
        search.isolate(start, search.at(high, high), 1, None)
        return search

    def _nullity(self, border: int | None, about: int) -> int | None:
        """Return how often 0 is an eigenvalue, if it is about so often; ``None`` where that is not told."""
        powers = self.network.below if border is None else self.network.above
        size = len(self.cramer.entries) - (border is None)
        order = order_at_zero(self.cramer, size, 2 * about + powers)
        return None if order is None or (order - powers) % 2 else (order - powers) // 2

    def _unseen(self, each: Eigenvalue) -> int:
        """Return how many of the modes of an eigenvalue are uncontrollable or unobservable."""
        if each.number not in self.unseen:
            held = self._most_held(each) and self._most_held(self._closer(each, None))
            self.unseen[each.number] = min(each.multiplicity, held)
        return self.unseen[each.number]

    def _most_held(self, each: Eigenvalue) -> int:
        return max(self._held_within(each, border) for border in range(len(self.counter.borders)))

    def _held_within(self, each: Eigenvalue, border: int | None) -> int:
        """Return how many eigenvalues of the network, held at a border or free, lie in the same interval."""
        search = EigenvalueSearch(self.counter, border, self.digits)
        return search.count(each.high) - search.count(each.low)

    def _closer(self, each: Eigenvalue, border: int | None) -> Eigenvalue:
        """Return an eigenvalue to twice the digits."""
        search = EigenvalueSearch(self.counter, border, 2 * self.digits)
        search.base = search.count(each.low) - each.number + 1
        search.isolate(each.low, each.high, each.number, None)
        return search.found[min(search.found)]

    def _apart(self, zero: Eigenvalue) -> list[Root]:
        """Return a zero but for what is hidden in it: poles at the same place that are not seen."""
        unseen = 0
        if self._held_within(zero, None):
            closer = self._closer(zero, 0)
            unseen = min(self._held_within(closer, None), self._most_held(closer))
        return _pair(zero, zero.multiplicity - unseen)

    def roots(self) -> tuple[tuple[Root, ...], tuple[Root, ...], tuple[HiddenRoot, ...]]:
        """Return poles, zeros and hidden modes in the region."""
        poles, zeros = (self._chosen(roots) for roots in (self.visible, self.held))
        return poles, zeros, _hidden(self.shared, poles, self.region)

    def _chosen(self, roots: Sequence[Root]) -> tuple[Root, ...]:
        if isinstance(self.region, Mode):  # no other was sought
            return tuple(root for root in in_order(roots) if not root.is_zero)
        return chosen(roots, self.region)


def _pair(each: Eigenvalue, multiplicity: int) -> list[Root]:
    """Return s and its conjugate of so many eigenvalues."""
    if multiplicity <= 0:
        return []
    with precision(max(each.low.value.bits(), each.high.value.bits()) + 32):
        omega = each.low.value.sqrt().union(each.high.value.sqrt())
    is_one = multiplicity == 1
    return [
        Root(arb(0), im, multiplicity, on_imaginary_axis=True, is_real=False, certified=is_one)
        for im in (omega, opposite(omega))
    ]


def _zero(order: int, search: EigenvalueSearch) -> list[Root]:
    return root_at_zero(order, 0 if search.is_exact else search.near_zero.sqrt().upper())
