"""Poles and zeros of a bound transfer function: all of a lumped one, a distributed one's in a region."""

from __future__ import annotations

from cmath import exp as cexp
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property, partial
from itertools import chain
from math import exp, inf, isfinite, pi

from symflex.algebra import Factored
from symflex.budget import Budget, entered_budget
from symflex.equations import Equations
from symflex.equations.elimination import free_at_rest
from symflex.errors import BudgetError, Diagnostic, SymflexError, UncertifiedError
from symflex.model import Model, with_numbers
from symflex.model.loss_factors import check_causal, has_loss_factors
from symflex.model.model import IMAGINARY
from symflex.roots.counting.winding import Cell
from symflex.roots.degenerate import DegeneratePoints, degenerate_points
from symflex.roots.distributed.proof import limits
from symflex.roots.distributed.right_half_plane import (
    DEGENERATE,
    RightHalfPlane,
    gaps_text,
    last_on_axis,
    search_right,
)
from symflex.roots.distributed.side import Side
from symflex.roots.engines import LOSSLESS, POLYNOMIAL
from symflex.roots.exact_zeros import is_shared_exactly
from symflex.roots.functions.simplified import without_lengths_of_zero
from symflex.roots.loss_modes import NO_STABILITY, OwnRoots, locate_lossy
from symflex.roots.passivity import EnergyProof, energy_proof
from symflex.roots.plane.search import HIGHEST
from symflex.roots.pole_zero_map import (
    COINCIDE,
    NONE_ON_AXIS,
    Certificate,
    Exclusion,
    HiddenRoot,
    PoleZeroMap,
    StabilityVerdict,
    chosen,
    find_pole_zero_map,
    hidden_region,
    is_right,
    judge,
    right_beyond,
    search_modes,
    take_out_shared,
)
from symflex.roots.polynomial_roots import in_order
from symflex.roots.problem import cancelled, problem_of
from symflex.roots.region import Band, Everything, Mode, Modes, Rectangle, Region
from symflex.roots.root import ROUNDING, TOUCHING, Root, count_roots, overlap, root_at_zero
from symflex.roots.sheets import locate_on_sheet
from symflex.transfer import AnyBoundFunction, BoundNested, BoundTransferFunction
from symflex.transfer.bind import with_waves
from symflex.transfer.of_model import assemble, assemble_sparse, derive_bound, derive_if_small


def locate(
    bound: AnyBoundFunction,
    region: Region | None = None,
    digits: int = 30,
    *,
    with_zeros: bool = True,
    judged: PoleZeroMap | None = None,
) -> PoleZeroMap:
    """Find the poles and zeros of a transfer function, with its hidden modes, proved to so many digits.

    Those of a distributed system are searched in :func:`default_region` where everything is asked for.
    Poles in the right half-plane of a map that was ``judged`` are not counted again.
    """
    if isinstance(bound, BoundNested):
        # Figures, responses and tables of one function ask for the same roots.
        known = bound.located.get((region, digits))
        if not isinstance(known, PoleZeroMap):
            known = _locate_nested(bound, region, digits)
            if known.certificate.certified:
                bound.located[region, digits] = known
        return known
    located = _locate_seen(bound, region, digits, with_zeros=with_zeros, judged=judged)
    try:
        whole = with_waves(bound)
        if whole is None:
            return located
        every = _locate_seen(whole, region, digits, with_zeros=with_zeros, judged=judged)
    except SymflexError as error:
        return replace(located, verdict=located.verdict.beside(not_searched(error)), hides_more=True)
    return _with_hidden(located, every)


def not_searched(error: SymflexError) -> StabilityVerdict:
    """Return the verdict on hidden modes that a search does not find."""
    reason = f"uncontrollable or unobservable parts are not searched: {error.diagnostics[0].message}"
    return StabilityVerdict("unknown", None, certified=False, reason=reason)


def _locate_seen(
    bound: BoundTransferFunction,
    region: Region | None,
    digits: int,
    *,
    with_zeros: bool = True,
    judged: PoleZeroMap | None = None,
) -> PoleZeroMap:
    """Find poles and zeros, and hidden modes as far as the function's ring holds them."""
    bound = without_lengths_of_zero(bound)
    if bound.sheets > 1:
        if IMAGINARY in bound.ratio.ring.index:
            check_causal(bound.source.model, "a search on the sheets of a root of s")
        where, is_default = _region_of(bound, region)
        return replace(locate_on_sheet(bound, where, digits, _locate_seen), is_default_region=is_default)
    if IMAGINARY in bound.ratio.ring.index:
        return locate_lossy(bound, _region_of(bound, region)[0], digits, locate_distributed)
    if not bound.is_rational:
        located = locate_distributed(bound, region, digits, with_zeros=with_zeros, judged=judged)
        is_whole = bound.values and bound.is_of_model and bound.variable == "model"
        if located.certificate.reason != TOUCHING or not is_whole:
            return located
        # Lengths whose values are multiples share their kernels once they are numbers.
        again = locate_distributed(of_numbers(bound), region, digits, with_zeros=with_zeros, judged=judged)
        return again if again.certificate.certified else located
    above = [(f, e) for f, e in bound.ratio.factors if e > 0]
    below = [(f, -e) for f, e in bound.ratio.factors if e < 0]
    hidden = [(f.polynomial, f.multiplicity) for f in bound.hidden]
    # Polynomials in roots that look different may have roots in common: they are split together.
    together = [hidden] if bound.radicals and hidden else [[factor] for factor in hidden]
    located = find_pole_zero_map(
        bound.name,
        problem_of(bound, below),
        problem_of(bound, above),
        region,
        digits,
        [(problem_of(bound, factors), "cancelled") for factors in together],
    )
    return replace(located, verdict=replace(located.verdict, moving=_moving_unseen(bound)))


def _with_hidden(seen: PoleZeroMap, every: PoleZeroMap) -> PoleZeroMap:
    """Return a map of poles and zeros with the hidden modes, and the verdict, of a map that has them too."""
    roots = (*seen.poles, *seen.zeros, *seen.unstable, *(h.root for h in every.hidden))
    found, (one, other) = count_roots(roots), (seen.certificate, every.certificate)
    missing = max(one.counted - one.found, 0) + max(other.counted - other.found, 0)
    engine = ", ".join(sorted({*one.engine.split(", "), *other.engine.split(", ")}))
    certificate = Certificate(
        engine, found + missing, found, one.reason or other.reason, one.code or other.code
    )
    return replace(seen, hidden=every.hidden, certificate=certificate, verdict=every.verdict, hides_more=True)


def _moving_unseen(bound: BoundTransferFunction) -> tuple[str, ...]:
    """Return what moves at hidden poles at s = 0 of a lumped model, nothing where that is not known."""
    model = bound.source.model
    zero = [bound.ratio.ring.coefficients(f.polynomial)[0] for f in bound.hidden]
    at_rest = not all(len(x) for x in zero)
    if not at_rest or model.is_distributed:
        return ()
    equations = assemble(with_numbers(model, (), dict(bound.values)))
    return () if equations.constants else free_at_rest(equations, bound.source.output.name)


def equations_of(bound: BoundNested) -> Equations:
    """Return the equations a function in nested form solves, with numbers in place of all parameters."""
    source, model = bound.source, _with_values(bound)
    known = source.equations if model == source.model else None
    return known or assemble_sparse(model)


def _with_values(bound: AnyBoundFunction) -> Model:
    return with_numbers(bound.source.model, (), dict(bound.values), in_kernels=True)


def of_numbers(bound: AnyBoundFunction) -> BoundTransferFunction:
    """Return a function as the quotient that numbers in place of all parameters make of its model."""
    (derived,) = derive_bound(_with_values(bound), [(bound.source.output.name, bound.source.input.name)])
    return derived


def as_quotient(bound: AnyBoundFunction) -> BoundTransferFunction:
    """Return a function as a quotient in lowest terms: as it is, or of numbers where it is nested."""
    return bound if bound.is_reduced else of_numbers(bound)


def _locate_nested(bound: BoundNested, region: Region | None, digits: int) -> PoleZeroMap:
    """Find poles and zeros of a function in nested form, from the equations it solves."""
    from symflex.roots.networks.poles_zeros import locate_in_network  # few models are so large

    source = bound.source
    model = _with_values(bound)
    pair = (source.output.name, source.input.name)
    if not model.is_distributed:
        return locate(of_numbers(bound), region, digits)
    if model.imaginary and not has_loss_factors(model):
        expanded = derive_if_small(model, pair)
        if expanded is None:
            message = f"poles and zeros of {bound.name} are not searched: its coefficients are complex"
            hint = "write real equations, of both planes or axes; or plot its frequency response (plot bode)"
            raise UncertifiedError(Diagnostic("SF404", message, None, hint))
        return locate(expanded, region, digits)
    where, is_default = _region_of(bound, region)
    energy = energy_proof(source.model, bound.values, source.output)
    located = locate_in_network(
        equations_of(bound), bound.name, pair, where, digits, is_default=is_default, energy=energy
    )
    if has_loss_factors(model):
        located = replace(located, verdict=NO_STABILITY)
    certificate, verdict = located.certificate, located.verdict
    is_judged = verdict.word != "unknown" or has_loss_factors(model)
    is_whole = certificate.certified and is_judged and all(h.is_proved for h in located.hidden)
    if is_whole or certificate.code is not None:
        return located
    # What resists the counts of a network may yield to those of its formula, where that is not too large.
    try:
        expanded = derive_if_small(model, pair, is_quick=certificate.certified)
        other = located if expanded is None else locate(expanded, region, digits)
    except BudgetError:
        return located
    if certificate.certified and not other.certificate.certified:
        return located if is_judged else replace(located, verdict=other.verdict)
    is_better = other.certificate.certified or other.certificate.found > certificate.found
    return other if is_better else located


DEFAULT_MODES = 5  # number of modes if neither the model nor the user gives it


def default_region(model: Model) -> Region:
    """Return where to search by default: the model's modes, its band, or five modes."""
    analysis = model.analysis
    if analysis.modes is not None:
        return Modes(analysis.modes)
    return Modes(DEFAULT_MODES) if analysis.band is None else Band(*analysis.band)


def _region_of(bound: AnyBoundFunction, region: Region | None) -> tuple[Region, bool]:
    """Return where to search, and whether nobody said where: all roots of a rational function are found."""
    if region is None or isinstance(region, Everything):
        return (Everything(), False) if bound.is_rational else (default_region(bound.source.model), True)
    return region, False


def locate_distributed(
    bound: BoundTransferFunction,
    region: Region | None,
    digits: int,
    *,
    with_zeros: bool = True,
    judged: PoleZeroMap | None = None,
    own: OwnRoots | None = None,
) -> PoleZeroMap:
    """Find the poles and zeros of a transfer function with kernels, to so many significant digits, proved.

    Roots that mirror each other count as one mode. What is certified is returned when the budget is exceeded.
    With ``own``, a function times its mirror image keeps the roots of the function alone.
    """
    where, is_default = _region_of(bound, region)
    searched = _Searched(bound, where, digits, with_zeros=with_zeros, own=own)
    reason, code = None, None
    try:
        searched.find()
        reason = searched.prove()
    except BudgetError as error:
        # What was found stays; the roots are certified one by one, only their number is not.
        for side in searched.sides:
            side.recall()
        reason = "; ".join(d.message for d in error.diagnostics) + searched.extent()
        code = error.diagnostics[0].code
        if all(root.is_zero for side in searched.sides for root in side.roots):
            raise
        with Budget().entered():  # what is known is told also when the time is over
            searched.settle()
    if reason is None and not all(root.certified for root in chain(*searched.chosen())):
        reason = TOUCHING
    try:
        if code is not None:
            raise BudgetError(Diagnostic(code, reason or ""))
        verdict, right, hidden = searched.judged(reason, judged)
    except BudgetError as error:
        with Budget().entered():
            verdict, right, hidden = searched.judged(error.diagnostics[0].message, judged, is_over=True)
    poles, zeros, known = map(searched.owned, searched.chosen(), range(3))
    shown_hidden = [replace(h, root=r) for h in searched.hidden for r in searched.owned([h.root], 2)]
    beyond = in_order(right_beyond(searched.owned(hidden, 2), known))
    located = PoleZeroMap.of(
        bound.name,
        where,
        digits,
        ", ".join(sorted({side.engine for side in searched.sides if not side.is_finite})) or POLYNOMIAL,
        (poles, zeros, (*shown_hidden, *map(HiddenRoot, beyond))),
        verdict,
        growing=right_beyond(searched.owned(right, 0), known),
        missing=sum(side.missing for side in searched.sides),
        reasons=[reason],
        code=code,
        excluded=searched.excluded(),
        is_default=is_default,
    )
    return replace(located, is_default_region=is_default and not all(s.is_finite for s in searched.sides[:1]))


class _Searched:
    """Numerator, denominator and what cancelled between them, searched in a region."""

    def __init__(
        self,
        bound: BoundTransferFunction,
        region: Region,
        digits: int,
        *,
        with_zeros: bool = True,
        own: OwnRoots | None = None,
    ) -> None:
        self.bound, self.region, self._own = bound, region, own
        self._side, self._with_zeros = partial(Side, bound, digits=digits), with_zeros
        match region:
            case Modes(count) | Mode(count):
                bound.expect(count)
            case Band() | Rectangle():
                bound.expect(0, exp(min(limits(region, is_even=False)[1], HIGHEST)))
        self.sides: list[Side] = []
        self.hidden: list[HiddenRoot] = []
        self._within: Region = region

    def find(self) -> None:
        """Find the roots of all sides."""
        bound, where = self.bound, self.region
        if not bound.ratio.is_zero:
            self.sides.append(self._side(bound.den))
            above = bound.num if self._with_zeros else Factored.number(bound.ratio.ring, 1)
            self.sides.append(self._side(above))
        if isinstance(where, Mode):
            for side in self.sides:
                side.numbered(where.number)
            return
        shared = _find(self.sides, where)
        # Where a pole lies where wavenumbers vanish or meet, a zero may lie, too.
        degenerate = [] if self._with_zeros else [point for point in self._degenerate if not point.is_zero]
        if any(overlap(root, point) for side in self.sides for root in side.roots for point in degenerate):
            self.sides[1] = self._side(bound.num)
            shared = _find(self.sides, where)
        # Modes are of the poles; what cancelled has modes of its own where poles are finite in number.
        if not all(side.is_finite for side in self.sides[:1]):
            self._within = hidden_region(where, self.chosen()[0])
        hidden = self._side(cancelled(bound), is_hidden=True)
        self.sides.append(hidden)
        _find((hidden,), self._within)
        self._hide(shared)

    @cached_property
    def _degenerate(self) -> list[Root]:
        return degenerate_points(self.bound)

    @cached_property
    def _points(self) -> DegeneratePoints:
        return DegeneratePoints(self.bound, self._degenerate)

    def _hide(self, shared: Sequence[Root]) -> None:
        """List what cancelled, and what poles and zeros share, as hidden."""
        within = self._within
        sides = self.sides if self.bound.ratio.is_zero else self.sides[2:]
        gone = [root for side in sides for root in side.roots]
        self.hidden = [
            HiddenRoot(root)
            for root in _chosen(gone, within)
            # Where two wavenumbers meet or vanish, what cancels belongs to how the function is written.
            if root.is_zero or not any(overlap(root, other) for other in self._degenerate)
        ]
        self.hidden += self._points.hidden(_chosen(self._points.distinct, within))
        self.hidden += [
            HiddenRoot(root, "coincident", is_exact=is_shared_exactly(self.bound, root))
            for root in _chosen(shared, within)
            if not any(overlap(root, other) for other in (*self._degenerate, *gone))
        ]

    def prove(self) -> str | None:
        """Count the roots of all sides with proof; return what could not be proved."""
        reasons: list[str] = []
        if isinstance(self.region, Mode):
            # Its number was counted, or all below it were found.
            below = Modes(self.region.number)
            proofs = [side.prove(below) for side in self.sides if side.engine != LOSSLESS]
            reasons = [p.reason or "roots were counted but not found" for p in proofs if not p.is_complete]
            return "; ".join(dict.fromkeys(reasons)) or None
        engines = [side.engine for side in self.sides]
        for i, side in enumerate(self.sides):
            entered_budget().progress.report(i / len(self.sides), "proving that no root is missing")
            proof = side.prove(self._within if side is self.sides[-1] else self.region)
            if not proof.is_complete:
                missing = proof.counted - proof.found
                reasons.append(proof.reason or f"{abs(missing)} roots were counted but not found")
        if engines != [side.engine for side in self.sides]:
            reasons += self._match_again()
        reasons += filter(None, [self._points.unproved])
        return "; ".join(dict.fromkeys(reasons)) or None

    def _match_again(self) -> list[str]:
        """Take out what poles and zeros share where roots were searched anew; return what is lost by it."""
        pair = self._pair
        for side in self.sides:
            side.restore()
        self._hide(_match(*pair) if pair else [])
        if isinstance(self.region, Modes) and pair and pair[0].modes < self.region.count:
            return [COINCIDE]
        return []

    def settle(self) -> None:
        """Take out what may be no pole or zero where a search was broken off."""
        pair = self._pair
        if not pair or isinstance(self.region, Mode):
            return
        for side in self.sides:
            side.restore()
        shared = _match(*pair)
        # Where wavenumbers vanish or meet, both may have a root; one of them was perhaps not yet met.
        for side, other in (pair, pair[::-1]):
            side.roots = [
                root
                for root in side.roots
                if root.is_zero
                or other.is_finite
                or float(root.natural_frequency().log().mid()) < other.reached
                or not any(overlap(root, point) for point in self._degenerate)
            ]
        self._hide(shared)

    @property
    def _pair(self) -> list[Side]:
        """Denominator and numerator; nothing when the function is zero."""
        return self.sides[:2] if len(self.sides) > 1 else []

    def judged(
        self, unproved: str | None, before: PoleZeroMap | None = None, *, is_over: bool = False
    ) -> tuple[StabilityVerdict, tuple[Root, ...], tuple[Root, ...]]:
        """Return the verdict, and poles and hidden modes on the right; ``before`` is of another region."""
        bound = self.bound
        product = cancelled(bound)
        poles = [] if bound.ratio.is_zero else [(0, bound.den)]
        coincident = self._points.coincident_elsewhere(self.hidden)
        energy = energy_of(bound) if bound.is_of_model and bound.variable == "model" else EnergyProof()
        proof, rests = (energy.reason, energy.rests) if energy.is_passive else ("", False)
        if before is not None and before.certificate.certified and not proof:
            return before.verdict, before.all_poles, tuple(h.root for h in before.hidden)
        degenerate = self._points.hidden(
            p for p in self._points.distinct if not (rests or p.re < 0 or (proof and p.re > 0))
        )
        limit = energy.limit or None
        sides: list[tuple[Root, ...]] = []
        gaps = [RightHalfPlane((), self._points.unproved)]
        has_more = bool(self._points.unproved)  # poles than those that are known
        is_endless = False
        for place, part in (*poles, (2 * len(poles), product)):
            is_hidden, is_searched, known = part is product, place < len(self.sides), list[Root]()
            try:
                side = self.sides[place] if is_searched else self._side(part, is_hidden=is_hidden)
                known = [*side.roots, *(h.root for h in coincident if h.is_proved is is_hidden)]
                is_plain = rests or is_over or side.is_finite
                end = limit if not proof else None if is_plain else last_on_axis(side)
                # Hidden poles on the axis, which are all that energy leaves, do not change the word.
                has_more = has_more or not (side.is_finite or (proof and (is_hidden or end is not None)))
                is_endless = not side.is_finite and end is None  # of what cancelled, which is last
                if is_over or (proof and end is None):
                    more = side.all_roots if side.is_finite else side.at_origin if rests else ()
                    known += [
                        r for r in more if r not in known and (is_hidden or not _is_gone(r, coincident))
                    ]
                    sides.append(tuple(known))
                    gaps.append(RightHalfPlane((), unproved or ""))
                    continue
                reached = 0.0 if unproved else self._reached(side)
                whole = search_right(side, known, reached, end)
            except SymflexError as error:
                has_more, known = has_more or not (proof and is_hidden), known if proof else []
                sides.append(tuple(known))
                gaps.append(RightHalfPlane((), error.diagnostics[0].message))
                continue
            # Where wavenumbers meet or vanish, a function may have a root that the system does not have.
            apart = tuple(
                r
                for r in whole.roots
                if (proof and r in known) or not self._points.is_spurious(r, is_hidden=is_hidden)
            )
            has_more = has_more or bool(whole.unproved) or len(apart) < len(whole.roots)
            if any(is_right(r) for r in whole.roots if r not in apart):
                gaps.append(RightHalfPlane((), DEGENERATE))
            sides.append(apart)
            gaps.append(whole)
        unsure = gaps_text(gaps)
        if limit is not None and not unsure and all(r.re < 0 or r.on_imaginary_axis for r in chain(*sides)):
            proof, rests = energy.reason, energy.rests
        if proof:
            unsure = "" if rests or not has_more else NONE_ON_AXIS
        seen = [*chain(*sides[:-1]), *(h.root for h in degenerate if not h.is_proved)]
        # Where wavenumbers vanish, a factor may have a root that is no pole: s itself tells how many are.
        at_rest = root_at_zero(product.exponent_of(bound.ratio.ring.context.gen(0)))
        unseen = self.owned([*(r for r in sides[-1] if not r.is_zero), *at_rest], 2)
        ends = (is_endless, bool(gaps[-1].unproved) and not proof)
        return judge(self.owned(seen, 0), unsure, proof, unseen, ends), sides[0] if poles else (), sides[-1]

    def owned(self, roots: Sequence[Root], place: int) -> list[Root]:
        """Return which roots of denominator (0), numerator (1) or what cancelled (2) are the function's."""
        if self._own is None:
            return list(roots)
        bound = self._own.bound
        return self._own(roots, (bound.den, bound.num, cancelled(bound))[place])

    def _reached(self, side: Side) -> float:
        """Return up to which abs(s) all roots of a side are known [rad/s]."""
        match self.region:
            case Modes():
                return exp(min(side.reached, HIGHEST))
            case Band(low, high) if not low:
                return 2 * pi * float(high)
        return 0.0

    def chosen(self) -> tuple[list[Root], list[Root], list[Root]]:
        """Return the poles, zeros and hidden modes of the region."""
        pair = [_chosen(side.roots, self.region) for side in self._pair]
        poles, zeros = pair or ([], [])
        return poles, zeros, [h.root for h in self.hidden]

    def excluded(self) -> list[Exclusion]:
        """Return what was left out of the region."""
        holes = {hole for side in self.sides for hole in side.excluded()}
        return [_exclusion(hole) for hole in sorted(holes, key=lambda hole: hole.low)]

    def extent(self) -> str:
        """Say how far a search came that was broken off."""
        if not isinstance(self.region, Modes) or not self._pair or not isfinite(self._pair[0].reached):
            return ""
        poles, zeros = self._pair
        modes = {0: "no modes were", 1: "1 mode was"}.get(poles.modes, f"{poles.modes} modes were")
        up_to = [f"{exp(side.reached) / (2 * pi):g} Hz" if side.modes else "" for side in self._pair]
        said = f"; {modes} found" + (f" up to {up_to[0]}" if up_to[0] else "")
        if zeros.is_finite or zeros.reached >= poles.reached:
            return said
        return said + (f", zeros up to {up_to[1]}" if up_to[1] else ", no zeros yet")


def _is_gone(root: Root, coincident: Sequence[HiddenRoot]) -> bool:
    """Tell whether a root is proved to be taken out."""
    return any(h.is_exact and overlap(root, h.root) for h in coincident)


def _find(sides: Sequence[Side], region: Region) -> list[Root]:
    """Find the roots of both sides in a region, and perhaps more; take out and return what they share."""
    if not isinstance(region, Modes):
        for side in sides:
            side.search(region)
        return _match(*sides) if len(sides) > 1 else []
    shared: list[Root] = []

    def search(modes: int) -> int:
        nonlocal shared
        for side in sides:
            side.extend(modes)
        reached = max((side.reached for side in sides), default=-inf)
        for side in sides:
            side.extend(0, reached)
        shared = _match(*sides) if len(sides) > 1 else []
        return max(region.count - side.modes for side in sides) if shared else 0

    search_modes(region.count, search)
    if shared and sides[0].modes < region.count:
        # Of zeros there may be none that no pole takes with it; poles are what was asked for.
        raise BudgetError(
            Diagnostic("SF505", COINCIDE, None, "ask for a band, which shows those that do not")
        )
    return shared


def _match(poles: Side, zeros: Side) -> list[Root]:
    """Take out and return what poles and zeros share to more than twice the requested digits."""
    poles.roots, zeros.roots, shared = take_out_shared(poles.roots, zeros.roots, poles.refined, zeros.refined)
    return shared


def _chosen(roots: Sequence[Root], region: Region) -> list[Root]:
    # Of a mode asked for by its number, no other was sought.
    return list(in_order(roots) if isinstance(region, Mode) else chosen(roots, region))


def energy_of(bound: BoundTransferFunction) -> EnergyProof:
    """Return what energy says of the poles of a function's model, hidden ones among them."""
    return energy_proof(bound.source.model, bound.all_values, bound.source.output)


def _exclusion(hole: Cell) -> Exclusion:
    """Return a disc that contains a neighbourhood, which is a rectangle of ln(s)."""
    centre = cexp(hole.centre)
    corners = [complex(x, y) for x in (hole.low, hole.high) for y in (hole.right, hole.left)]
    radius = max(abs(cexp(corner) - centre) for corner in corners)
    im = 0.0 if hole.right <= pi <= hole.left or hole.right <= 0 <= hole.left else centre.imag
    re = 0.0 if abs(centre.real) < ROUNDING * abs(centre) else centre.real
    return Exclusion(re, im, radius, "infinitely many roots accumulate there")
