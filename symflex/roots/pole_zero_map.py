"""Poles and zeros of one transfer function in a region, with the certificate that none is missing.

What the poles say of stability, as far as they are known, is a :class:`StabilityVerdict`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import inf, pi
from typing import Literal, Self

from symflex.budget import entered_budget, spend
from symflex.errors import BudgetError, Diagnostic
from symflex.roots.engines import POLYNOMIAL
from symflex.roots.polynomial_roots import find_polynomial_roots, in_order
from symflex.roots.problem import RootProblem
from symflex.roots.region import Band, Everything, Mode, Modes, Position, Region
from symflex.roots.root import ROUNDING, TOUCHING, Root, count_roots, groups, overlap

SCHEMA = "symflex.roots/1"
REFINEMENTS = 4  # doublings of the digits before a root counts as on the boundary
ROUNDS = 20  # searches that go further, as coincident poles and zeros are hidden, for enough modes

AT_REST = "at s = 0"
MOST_NAMES = 3  # nodes and signals that one line of hidden motion names
ON_AXIS = "a pole lies on the imaginary axis or too close to it to decide"
NONE_FOUND = "no pole was found, and those elsewhere may lie on the imaginary axis"
NONE_ON_AXIS = "none of those found lies on the imaginary axis, but others may"
WITHOUT_END = "infinitely many poles lie in the right half-plane"


@dataclass(frozen=True, slots=True)
class StabilityVerdict:
    """Whether a system is stable, in the words that all commands, reports and figures use.

    ``stable``: all controllable and observable poles lie in the open left half-plane, and no hidden one lies
    in the right. ``marginal``: no pole lies in the right half-plane, and some controllable and observable are
    on the imaginary axis. ``unstable``: a pole lies in the right half-plane, seen or hidden. ``unknown``:
    none of these is proved, or only that no pole lies in the right half-plane. Hidden poles on the axis leave
    the word as it is and are named beside it.

    Examples
    --------
    >>> StabilityVerdict("unstable", 2, True, "", 2).sentence
    'unstable: 2 poles in the right half-plane'
    >>> StabilityVerdict("unknown", None, False, "poles have no end").headline
    'stability not known'
    >>> StabilityVerdict("unknown", 0, False, "passive").headline
    'stable or marginal'
    >>> StabilityVerdict("stable", 0, True, hidden="a hidden pole at s = 0", moving=("phi",)).hidden_motion
    'a hidden pole at s = 0: phi is arbitrary at equilibrium'
    """

    word: Literal["stable", "marginal", "unstable", "unknown"]
    right: int | None  # poles in the open right half-plane; ``None`` where they are not all counted
    certified: bool  # the word is proved
    reason: str = ""  # what it follows from, or what is not proved. Never empty where something is not.
    found: int = 0  # poles in the right half-plane that are known, at least
    hidden: str = ""  # which hidden poles do not lie in the open left half-plane
    moving: tuple[str, ...] = ()  # what moves at a hidden pole at s = 0, where that is known

    def __post_init__(self) -> None:
        if not self.reason and (not self.certified or self.right is None):
            raise ValueError("what is not proved needs a reason")

    @property
    def sentence(self) -> str:
        """What stands at the head of a list of poles."""
        if self.word == "unknown":
            return f"{self.brief}: {self.reason}"
        if self.word == "unstable":
            least = "" if self.right is not None else "at least "
            poles = "1 pole" if self.found == 1 else f"{self.found} poles"
            said = f"unstable: {least}{poles} in the right half-plane" if self.found else "unstable"
            return f"{said}; {self.reason}" if self.reason else said
        said = "marginal, not asymptotically stable" if self.word == "marginal" else self.word
        return f"{said}: {self.reason}" if self.reason else said

    @property
    def headline(self) -> str:
        """The verdict and the number of poles that grow, or that are hidden, without what it follows from."""
        said = self.sentence.removesuffix(self.reason).rstrip(":; ") if self.found else self.brief
        return f"{said}, with {self.hidden}" if self.hidden and not self.found else said

    @property
    def hidden_motion(self) -> str:
        """Hidden motion that does not decay, in a line; empty without."""
        if not self.hidden:
            return ""
        if not self.moving or not self.hidden.endswith(AT_REST):  # elsewhere it is not known what moves
            return f"{self.hidden}, uncontrollable or unobservable"
        more = len(self.moving) - MOST_NAMES
        shown = [*self.moving[:MOST_NAMES], *([f"{more} other{'s' * (more > 1)}"] if more > 0 else [])]
        names = " and ".join([", ".join(shown[:-1]), shown[-1]] if len(shown) > 1 else shown)
        return f"{self.hidden}: {names} {'are' if len(shown) > 1 else 'is'} arbitrary at equilibrium"

    @property
    def brief(self) -> str:
        """The verdict in a word or two."""
        if self.word == "unknown":
            return "stability not known" if self.right is None else "stable or marginal"
        return self.word

    def to_json_dict(self) -> dict[str, object]:
        """Return the verdict as JSON data."""
        return {
            "verdict": self.word,
            "right_half_plane": self.right,
            "certified": self.certified,
            "reason": self.reason,
            "right_half_plane_found": self.found,
            "hidden_motion": self.hidden_motion,
        }

    def beside(self, other: StabilityVerdict) -> StabilityVerdict:
        """Return the verdict on a system that has the poles of two.

        >>> stable = StabilityVerdict("stable", 0, True)
        >>> stable.beside(StabilityVerdict("marginal", 0, True, "a pole at 0")).sentence
        'marginal, not asymptotically stable: a pole at 0'
        """
        both = (self, other)
        word = min((each.word for each in both), key=WORST_FIRST.index)
        right = None if self.right is None or other.right is None else self.right + other.right
        decides = (each for each in both if each.word == word or (right is None and each.right is None))
        return StabilityVerdict(
            word,
            right,
            word != "unknown",
            "; ".join(dict.fromkeys(each.reason for each in decides if each.reason)),
            self.found + other.found,
            " and ".join(each.hidden for each in both if each.hidden),
            tuple(dict.fromkeys((*self.moving, *other.moving))),
        )


WORST_FIRST = ("unstable", "unknown", "marginal", "stable")  # what decides about a whole comes first
NOT_EXAMINED = StabilityVerdict("unknown", None, certified=False, reason="not examined")


def is_right(root: Root) -> bool:
    """Tell whether a root is proved to lie in the open right half-plane."""
    return bool(root.re > 0)


def judge(
    roots: Sequence[Root],
    unproved: str = "",
    proof: str = "",
    hidden: Sequence[Root] = (),
    more: tuple[bool, bool] = (False, False),
) -> StabilityVerdict:
    """Return the verdict that known poles allow.

    ``roots`` are the controllable and observable poles, ``hidden`` the others: all that are not in the open
    left half-plane, unless ``unproved`` says why there may be more in the right half-plane or on the axis.
    ``proof`` says what proves that there are none in the open right half-plane, but maybe on the axis.
    ``more`` says whether further hidden poles may lie on the axis, and in the right half-plane.
    """
    on_axis = [root for root in hidden if root.on_imaginary_axis]
    at_rest = count_roots(root for root in on_axis if root.is_zero)
    beside: float = count_roots(on_axis) - at_rest
    is_endless, is_open = more
    beside = inf if beside and is_endless else beside
    named = hidden_poles(at_rest, beside, count_right(hidden), is_open=is_open)
    return replace(_judged(roots, hidden, unproved, proof), hidden=named)


def _judged(roots: Sequence[Root], hidden: Sequence[Root], unproved: str, proof: str) -> StabilityVerdict:
    every = (*roots, *hidden)
    count = count_right(every)
    unclear = any(root.re.contains(0) and not root.on_imaginary_axis for root in every)
    if count:
        if unclear:
            unproved = unproved or ON_AXIS
        return StabilityVerdict("unstable", None if unproved else count, True, unproved, count)
    if WITHOUT_END in unproved:
        return StabilityVerdict("unstable", None, True, unproved)
    on_axis = [root for root in roots if root.on_imaginary_axis]
    if on_axis:
        where = "poles on the imaginary axis"
        if all(root.is_zero for root in on_axis):
            times = count_roots(on_axis)
            where = "a pole at 0" if times == 1 else f"{times} poles at 0"
        if unproved and not proof:  # a pole that grows may lie beyond what was counted
            return StabilityVerdict("unknown", None, False, f"{where}; {unproved}")
        return StabilityVerdict("marginal", 0, True, f"{where}; {proof}" if proof else where)
    if proof and not unclear and not unproved:
        return StabilityVerdict("stable", 0, True, proof)
    if proof:
        where = ON_AXIS if unclear else unproved if every else NONE_FOUND
        return StabilityVerdict("unknown", 0, False, f"{proof}; {where}")
    if unproved or unclear:
        return StabilityVerdict("unknown", None, False, unproved or ON_AXIS)
    return StabilityVerdict("stable", 0, True)


def hidden_poles(at_rest: int, on_axis: float, right: int, *, is_open: bool = False) -> str:
    """Return in words how many hidden poles lie at s = 0, elsewhere on the axis, and right of it.

    Where more may lie on the axis, their number is infinite and is not said; more to the right ``is_open``.

    >>> hidden_poles(1, 2, 0)
    'a hidden pole at s = 0 and 2 on the imaginary axis'
    >>> hidden_poles(0, 0, 2), hidden_poles(0, 0, 0)
    ('2 hidden poles in the right half-plane', '')
    >>> hidden_poles(0, inf, 0), hidden_poles(1, inf, 0)
    ('hidden poles on the imaginary axis', 'a hidden pole at s = 0 and others on the imaginary axis')
    >>> hidden_poles(0, 0, 5, is_open=True)
    'at least 5 hidden poles in the right half-plane'
    """
    places = ((at_rest, AT_REST), (on_axis, "on the imaginary axis"), (right, "in the right half-plane"))
    said: list[str] = []
    for count, where in places:
        if count:
            kind = "" if said else " hidden pole" if count == 1 else " hidden poles"
            number = "a" if count == 1 and not said else f"{count}".replace("inf", "others" if said else "")
            if is_open and where == places[-1][1]:
                number = f"at least {count}"
            said.append(f"{number}{kind} {where}".strip())
    return " and ".join(said)


def count_right(roots: Sequence[Root]) -> int:
    """Return how many roots are proved to lie there, with multiplicity."""
    return count_roots(filter(is_right, roots))


@dataclass(frozen=True, slots=True)
class Certificate:
    """What was proved about a list of roots.

    Parameters
    ----------
    engine : str
        Name of the root finder.
    counted : int
        Roots that exist, with multiplicity: the degrees of numerator, denominator and hidden factors.
    found : int
        Roots enclosed, with multiplicity.
    reason : str, optional
        Why it is not certified.
    code : str, optional
        The error code of what was exceeded.
    """

    engine: str
    counted: int
    found: int
    reason: str | None = None
    code: str | None = None

    @property
    def certified(self) -> bool:
        """Whether every root counted was found, and separated from the others."""
        return self.reason is None

    @property
    def is_exceeded(self) -> bool:
        """Whether the budget was exceeded: every root shown is certified, and others may be missing."""
        return self.code is not None


@dataclass(frozen=True, slots=True)
class HiddenRoot:
    """A root of a factor that cancelled between numerator and denominator."""

    root: Root  # the mode that is uncontrollable or unobservable
    cause: str = "cancelled"  # exactly; ``"coincident"`` when two agree in all digits
    is_exact: bool = False  # what coincides is proved to be equal

    @property
    def is_proved(self) -> bool:
        """Whether pole and zero are equal: what agrees in all digits may still be seen."""
        return self.is_exact or self.cause == "cancelled" or self.root.is_zero


@dataclass(frozen=True, slots=True)
class Exclusion:
    """A part of the s plane that no search can exhaust."""

    re: float  # re and im: its centre [rad/s]; the conjugate is left out too
    im: float
    radius: float  # [rad/s]
    reason: str  # why

    def to_json_dict(self) -> dict[str, object]:
        """Return the exclusion as JSON data."""
        return {"re": self.re, "im": self.im, "radius": self.radius, "reason": self.reason}


@dataclass(frozen=True, slots=True)
class PoleZeroMap:
    """Poles and zeros in a region of the s plane.

    Parameters
    ----------
    tf : str
        ``"OUT/IN"``.
    region : Region
        What was searched; roots on its boundary are included and carry ``on_boundary``.
    poles, zeros : tuple of Root
        By natural frequency; both members of each conjugate pair.
    hidden : tuple of HiddenRoot
        Cancelled modes.
    certificate : Certificate
        The count behind it.
    digits : int
        Significant digits printed.
    excluded : tuple of Exclusion
        Parts of the region that were left out.
    is_default_region : bool
        A region was chosen because all roots were requested of a function with infinitely many.
    is_infinite : bool
        The function is transcendental: there are roots beyond any region.
    verdict : StabilityVerdict
        Whether the model is stable, judged by all poles, not only those in the region.
    unstable : tuple of Root
        Poles in the right half-plane outside the requested region. If only a number of modes was
        requested, they are among ``poles``, wherever they lie.
    hides_more : bool
        Hidden modes are infinite in number, and poles and zeros are not: some are listed, and those known in
        the right half-plane.
    """

    tf: str
    region: Region
    poles: tuple[Root, ...]
    zeros: tuple[Root, ...]
    hidden: tuple[HiddenRoot, ...]
    certificate: Certificate
    digits: int = 30
    excluded: tuple[Exclusion, ...] = ()
    is_default_region: bool = False
    is_infinite: bool = False
    verdict: StabilityVerdict = NOT_EXAMINED
    unstable: tuple[Root, ...] = ()
    hides_more: bool = False

    def __repr__(self) -> str:
        counts = f"{count_roots(self.all_poles)} poles, {count_roots(self.zeros)} zeros"
        status = "certified" if self.certificate.certified else "not certified"
        return f"<PoleZeroMap {self.tf}: {counts}, {status}, {self.verdict.headline}>"

    @classmethod
    def of(
        cls,
        tf: str,
        region: Region,
        digits: int,
        engine: str,
        shown: tuple[Sequence[Root], Sequence[Root], Sequence[HiddenRoot]],
        verdict: StabilityVerdict,
        *,
        growing: Sequence[Root] = (),
        found: int | None = None,
        missing: int = 0,
        reasons: Iterable[str | None] = (),
        code: str | None = None,
        excluded: Sequence[Exclusion] = (),
        is_default: bool = False,
        is_infinite: bool = True,
    ) -> Self:
        """Assemble what a search delivers: poles, zeros and hidden modes of the region.

        ``growing`` poles on the right become ``unstable``, or poles in a region by default.
        """
        poles, zeros, hidden = shown
        beyond = in_order(right_beyond(growing, poles))
        every = (*poles, *zeros, *(h.root for h in hidden), *beyond)
        said = dict.fromkeys(filter(None, reasons))
        if not all(root.certified for root in every):
            said |= {TOUCHING: None}
        count = count_roots(every) if found is None else found
        is_free = is_default and isinstance(region, Modes)
        return cls(
            tf,
            region,
            (*poles, *(beyond if is_free else ())),
            tuple(zeros),
            tuple(hidden),
            Certificate(engine, count + missing, count, "; ".join(said) or None, code),
            digits,
            tuple(excluded),
            is_default,
            is_infinite,
            verdict,
            () if is_free else beyond,
        )

    @property
    def all_poles(self) -> tuple[Root, ...]:
        """The poles in the region, and those in the right half-plane outside of it."""
        return (*self.poles, *self.unstable)

    def complete(self) -> Self:
        """Return the map if the budget sufficed.

        Raises
        ------
        BudgetError
            SF505, SF506 when it did not; ``found`` is this map.

        Examples
        --------
        >>> from symflex.roots.problem import RootProblem
        >>> pole = RootProblem.from_rationals([1, 1])
        >>> find_pole_zero_map("x/F", pole, RootProblem(())).complete().certificate.certified
        True
        """
        certificate = self.certificate
        if certificate.code is not None:
            hint = "the attribute 'found' of this error has what was proved until then"
            raise BudgetError(Diagnostic(certificate.code, certificate.reason or "", None, hint), found=self)
        return self

    def to_json_dict(self) -> dict[str, object]:
        """Return the map in the schema ``symflex.roots/1``, ready for :func:`json.dumps`."""
        certificate = self.certificate
        return {
            "schema": SCHEMA,
            "tf": self.tf,
            "region": self.region.to_json_dict(),
            "certified": certificate.certified,
            "stability": self.verdict.to_json_dict(),
            "poles": [root_json(root, self.digits) for root in self.poles],
            "zeros": [root_json(root, self.digits) for root in self.zeros],
            "right_half_plane": [root_json(root, self.digits) for root in self.unstable],
            "hidden": [{**root_json(h.root, self.digits), "cause": h.cause} for h in self.hidden],
            "hides_more": self.hides_more,
            "excluded": [exclusion.to_json_dict() for exclusion in self.excluded],
            "certificate": {
                "engine": certificate.engine,
                "counted": certificate.counted,
                "found": certificate.found,
                "reason": certificate.reason,
                "budget_exceeded": certificate.is_exceeded,
            },
        }


def find_pole_zero_map(
    tf: str,
    poles: RootProblem,
    zeros: RootProblem,
    region: Region | None = None,
    digits: int = 30,
    hidden: Sequence[tuple[RootProblem, str]] = (),
) -> PoleZeroMap:
    """Find poles and zeros, without common factors, in a region; by default everywhere.

    ``hidden`` are cancelled factors, each with its cause; of a number of modes all their roots are reported.
    """
    where = region if region is not None else Everything()
    whole = Everything() if isinstance(where, Modes) else where
    sought = [(poles, where), (zeros, where), *((problem, whole) for problem, _ in hidden)]
    counted = sum(problem.degree for problem, _ in sought)
    located: list[tuple[Root, ...]] = []
    every: list[tuple[Root, ...]] = []
    exceeded: Diagnostic | None = None
    for i, (problem, within) in enumerate(sought):
        entered_budget().progress.report(i / len(sought), f"polynomial {i + 1} of {len(sought)}")
        roots, everywhere, exceeded = _locate(problem, within, digits)
        located.append(roots)
        every.append(everywhere)
        if exceeded is not None:
            break
    count = sum(map(count_roots, every))
    located += [()] * (len(sought) - len(located))
    pole_roots, zero_roots, *others = located
    concealed = [
        HiddenRoot(root, cause) for (_, cause), roots in zip(hidden, others, strict=True) for root in roots
    ]
    concealed += [
        HiddenRoot(root, cause)
        for (_, cause), known, whole_roots in zip(hidden, others, every[2:], strict=False)
        for root in right_beyond(whole_roots, known)
    ]
    reason = None if exceeded is None else exceeded.message
    if reason is None and counted != count:
        reason = f"{counted} roots exist, {count} were found"
    elif reason is None and not all(root.certified for roots in every for root in roots):
        reason = TOUCHING
    missing = "" if counted == count else reason or "not all poles were found"
    return PoleZeroMap.of(
        tf,
        where,
        digits,
        POLYNOMIAL,
        (pole_roots, zero_roots, concealed),
        judge(every[0], missing, hidden=[root for roots in every[2:] for root in roots]),
        growing=every[0],
        found=count,
        missing=counted - count,
        reasons=[reason],
        code=None if exceeded is None else exceeded.code,
        is_infinite=False,
    )


EXAMINED = PoleZeroMap("", Everything(), (), (), (), Certificate("", 0, 0))  # nothing more is asked of poles
COINCIDE = "too many poles and zeros coincide to identify the modes"


def search_modes(wanted: int, search: Callable[[int], int]) -> bool:
    """Search for so many modes, and for more as poles and zeros that coincide are hidden.

    ``search`` finds a number of modes and returns how many of those wanted are lacking; whether none is in
    the end is returned.

    >>> asked = []
    >>> search_modes(3, lambda modes: asked.append(modes) or 3 - modes // 2), asked
    (True, [3, 5, 6])
    """
    modes = wanted
    for _ in range(ROUNDS):
        if (lacking := search(modes)) <= 0:
            return True
        modes += lacking
    return False


def hidden_region(region: Region, poles: Sequence[Root]) -> Region:
    """Return where hidden modes are shown: of a number of modes those up to the highest pole shown."""
    if not isinstance(region, Modes | Mode):
        return region
    # A little more, so that what lies at the highest pole itself is in.
    highest = max((float(root.size().mid()) for root in poles), default=0.0) / (2 * pi) * (1 + 4 * ROUNDING)
    if highest:
        return Band(Fraction(0), Fraction(highest))
    return region if isinstance(region, Modes) else Everything()


def right_beyond(roots: Sequence[Root], shown: Sequence[Root]) -> tuple[Root, ...]:
    """Return the roots in the right half-plane that are not shown."""
    return tuple(
        root for root in roots if is_right(root) and not any(overlap(root, other) for other in shown)
    )


def chosen(roots: Sequence[Root], region: Region) -> tuple[Root, ...]:
    """Return the roots in a region in order of natural frequency, mirror images with the requested modes."""
    ordered = in_order(roots)
    if not isinstance(region, Modes | Mode):
        return _inside(ordered, region.classify(ordered))
    first, last = (1, region.count) if isinstance(region, Modes) else (region.number, region.number)
    taken = [root for root in ordered if root.is_zero] if isinstance(region, Modes) else []
    reached = 0
    for group in groups(ordered):
        before, reached = reached, reached + group[0].multiplicity
        if before < last and reached >= first:
            taken += group
    return tuple(taken)


def take_out_shared(
    poles: Sequence[Root], zeros: Sequence[Root], *closer: Callable[[Root], Root]
) -> tuple[list[Root], list[Root], list[Root]]:
    """Return poles and zeros without those that still overlap to twice the digits, and these."""
    of_pole, of_zero = closer

    def coincide(pole: Root, zero: Root) -> bool:
        return overlap(pole, zero) and overlap(of_pole(pole), of_zero(zero))

    left, kept, shared = list(zeros), list[Root](), list[Root]()
    for pole in poles:
        i = next((i for i, zero in enumerate(left) if coincide(pole, zero)), None)
        if i is None:
            kept.append(pole)
            continue
        zero = left.pop(i)
        multiplicity = min(pole.multiplicity, zero.multiplicity)
        certified = pole.certified and zero.certified
        shared.append(replace(pole, multiplicity=multiplicity, certified=certified))
        if pole.multiplicity > multiplicity:
            kept.append(replace(pole, multiplicity=pole.multiplicity - multiplicity))
        if zero.multiplicity > multiplicity:
            left.insert(i, replace(zero, multiplicity=zero.multiplicity - multiplicity))
    return kept, left, shared


def _inside(roots: Sequence[Root], positions: Sequence[Position]) -> tuple[Root, ...]:
    return tuple(
        root if position is Position.INSIDE else replace(root, on_boundary=True)
        for root, position in zip(roots, positions, strict=True)
        if position is not Position.OUTSIDE
    )


def _locate(
    problem: RootProblem, region: Region, digits: int
) -> tuple[tuple[Root, ...], tuple[Root, ...], Diagnostic | None]:
    """Return the roots in the region, all roots, and what failed."""
    roots: tuple[Root, ...] = ()
    positions: tuple[Position, ...] = ()
    exceeded = None
    for doubling in range(REFINEMENTS):
        try:
            spend()
            roots = find_polynomial_roots(problem, digits << doubling)
        except BudgetError as error:
            exceeded = error.diagnostics[0]
            if doubling == 0:
                roots = error.found if isinstance(error.found, tuple) else ()
                # Which is the n-th cannot be told where others may be missing.
                unknown = isinstance(region, Mode)
                positions = (Position.OUTSIDE,) * len(roots) if unknown else region.classify(roots)
            break
        positions = region.classify(roots)
        if Position.UNDECIDED not in positions:
            break
    return _inside(roots, positions), roots, exceeded


def root_json(root: Root, digits: int) -> dict[str, object]:
    """Return a root as JSON data, in so many digits."""
    decimals = root.decimal(digits)
    factor = root.loss_factor()
    return {
        **({} if factor is None else {"loss_factor": float(factor.mid())}),
        "re": decimals.re,
        "im": decimals.im,
        "radius": decimals.radius,
        "multiplicity": root.multiplicity,
        "frequency_hz": root.frequency_hz(),
        "damping_ratio": root.damping_ratio(),
        "on_imaginary_axis": root.on_imaginary_axis,
        "is_real": root.is_real,
        "certified": root.certified,
        "boundary": root.on_boundary,
    }
