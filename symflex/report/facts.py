"""What a report compares and judges: facts about each transfer function of a model, as plain data."""

from __future__ import annotations

import itertools
from dataclasses import asdict, dataclass, replace
from math import inf, tau
from typing import TYPE_CHECKING, Final, Literal

from symflex.errors import SymflexError
from symflex.expressions import format_expression
from symflex.report.document import Mathematics, mathematics
from symflex.report.minimum_phase import PhaseCondition, minimum_phase
from symflex.report.structure import Compliance, compliances, is_colocated
from symflex.roots.pole_zero_map import NOT_EXAMINED, StabilityVerdict

if TYPE_CHECKING:
    from flint import arb

    from symflex.audit import Audit
    from symflex.loops import DynamicColocation, StabilityMap
    from symflex.model import Model
    from symflex.report.study import Study
    from symflex.roots import PoleZeroMap, Root
    from symflex.transfer import AnyTransferFunction, TransferFunction

Place = Literal["origin", "imaginary axis", "real axis", "plane"]
SCHEMA: Final = "symflex.report-facts/1"


@dataclass(frozen=True, slots=True)
class RootFact:
    """A pole or zero."""

    # re and im: [rad/s], in double precision.
    re: float
    im: float
    radius: float  # bound on the distance of the printed decimals from the root [rad/s]
    place: Place  # ``origin``, ``imaginary axis`` or ``real axis`` where that is proved, else ``plane``
    multiplicity: int  # as often as it is counted
    frequency_hz: float  # abs(s)/(2 pi)

    @property
    def is_in_right_half_plane(self) -> bool:
        """Whether the root is proved to have a positive real part."""
        return self.place in ("real axis", "plane") and self.re - self.radius > 0

    @property
    def is_oscillatory(self) -> bool:
        """Whether it is the upper member of a conjugate pair."""
        return self.place in ("imaginary axis", "plane") and self.im > 0


@dataclass(frozen=True, slots=True)
class TruncationFacts:
    """How far a product of the lowest modes is right."""

    modes: int  # how many it keeps
    last_hz: float  # natural frequency of the last one [Hz]
    # one_percent_hz and five_percent_hz: up to which its relative error stays within 1 % and 5 % (sampled).
    one_percent_hz: float
    five_percent_hz: float


@dataclass(frozen=True, slots=True)
class TransferFacts:
    """Facts about one transfer function."""

    # tf and quantity: ``"OUT/IN"``; receptance, mobility, ...
    tf: str
    quantity: str
    # poles and zeros: those in the report's tables, by natural frequency.
    poles: tuple[RootFact, ...]
    zeros: tuple[RootFact, ...]
    certified: bool  # all of them are proved, and their number
    is_infinite: bool  # there are more: the function is transcendental
    counts: tuple[int, int] | None = None  # zeros and poles of a rational function, with multiplicity
    # rigid and undamped: the same with all compliances rigid, and with all dampers taken away; None if
    # there is no limit. Zeros are None where the rigid model has no response, as nothing moves.
    rigid: tuple[int | None, int] | None = None
    undamped: tuple[int, int] | None = None
    # colocated: the output is taken where the input acts; None if one of them has no place.
    colocated: bool | None = None
    # What its zeros are the poles of: a kind of :class:`~symflex.analysis.explanation.ZeroExplanation`.
    explained: str = "unknown"
    # condition and reason: when it is minimum phase; see
    # :class:`~symflex.report.minimum_phase.PhaseCondition`.
    condition: str = "unknown"
    reason: str = ""
    bracket: str = ""  # the expression that must not be negative, in the spec language; empty without one
    bracket_mathematics: Mathematics | None = None  # the same for print
    truncation: TruncationFacts | None = None  # of distributed systems
    verdict: StabilityVerdict = NOT_EXAMINED  # on all poles, listed or not

    @property
    def right_half_plane_zeros(self) -> int:
        """Zeros in the right half-plane among those listed."""
        return sum(z.multiplicity for z in self.zeros if z.is_in_right_half_plane)

    @property
    def is_minimum_phase(self) -> bool:
        """Whether none of the zeros listed lies in the right half-plane."""
        return not self.right_half_plane_zeros

    @property
    def searched_hz(self) -> float:
        """Natural frequency up to which both poles and zeros are listed [Hz]; infinite when all are."""
        if not self.is_infinite:
            return inf
        # Poles in the right half-plane are listed wherever they lie.
        left_half_plane = [p for p in self.poles if not p.is_in_right_half_plane] or self.poles
        ends = [max((r.frequency_hz for r in roots), default=0.0) for roots in (left_half_plane, self.zeros)]
        return min(ends) if self.zeros else ends[0]

    @property
    def modes(self) -> int:
        """Flexible modes: those that rigid compliances take away; pairs of poles of distributed systems."""
        if self.rigid is not None and self.counts is not None:
            return (self.counts[1] - self.rigid[1]) // 2
        return sum(p.multiplicity for p in self.poles if p.is_oscillatory) if self.is_infinite else 0

    @property
    def added(self) -> tuple[int, int] | None:
        """Zeros and poles that flexibility adds, the listed ones of a distributed system; None without it."""
        if self.rigid is not None and self.counts is not None:
            zeros, poles = self.rigid
            return None if zeros is None else (self.counts[0] - zeros, self.counts[1] - poles)
        if not self.is_infinite or not self.modes:
            return None
        last = max(p.frequency_hz for p in self.poles if p.is_oscillatory)
        if self.searched_hz < last and len(self.zeros) < len(self.poles) - 1:
            return None
        kept = [z for z in self.zeros if 0 < z.frequency_hz < last]
        return sum(z.multiplicity for z in kept), 2 * self.modes

    @property
    def alternates(self) -> bool:
        """Whether all poles and zeros listed lie on the imaginary axis and take turns there."""
        listed = (*self.poles, *self.zeros)
        if any(r.place not in ("imaginary axis", "origin") for r in listed):
            return False
        ups = [(r.im, kind) for kind, roots in (("pole", self.poles), ("zero", self.zeros)) for r in roots]
        row = [kind for im, kind in sorted(x for x in ups if x[0] > 0)]
        return len(row) > 1 and all(a != b for a, b in itertools.pairwise(row))

    @property
    def has_mirrored_real_zeros(self) -> bool:
        """Whether there are zeros, all real, each with its mirror image in the imaginary axis."""
        zeros = [z for z in self.zeros if z.place != "origin"]
        right = sorted(z.re for z in zeros if z.re > 0)
        left = sorted(-z.re for z in zeros if z.re < 0)
        slack = sum(z.radius for z in zeros)
        is_mirrored = len(left) == len(right) and all(
            abs(a - b) <= slack for a, b in zip(left, right, strict=True)
        )
        return bool(zeros) and all(z.place == "real axis" for z in zeros) and is_mirrored

    def to_json_dict(self) -> dict[str, object]:
        """Return the facts as JSON data; the roots themselves are in the report's ``roots.json``."""
        added, condition = self.added, {"condition": self.condition, "reason": self.reason}
        return {
            "tf": self.tf,
            "quantity": self.quantity,
            "certified": self.certified,
            "stability": self.verdict.word,
            "is_infinite": self.is_infinite,
            "zeros": self.counts and self.counts[0],
            "poles": self.counts and self.counts[1],
            "modes": self.modes,
            "zeros_added": added and added[0],
            "poles_added": added and added[1],
            "colocated": self.colocated,
            "zeros_are_poles_of": self.explained,
            "right_half_plane_zeros": self.right_half_plane_zeros,
            "minimum_phase": condition | {"bracket": self.bracket or None},
            "alternates": self.alternates,
            "mirrored_real_zeros": self.has_mirrored_real_zeros,
        }


@dataclass(frozen=True, slots=True)
class LoopFacts:
    """For which gains a feedback loop is stable."""

    # gain and unit: name and SI unit.
    gain: str
    unit: str
    # Intervals with all closed-loop poles in the left half-plane; None if there is no end.
    stable: tuple[tuple[float | None, float | None], ...]
    unstable_at_last: int  # poles in the right half-plane for the largest gains examined
    crossings_hz: tuple[float, ...]  # where poles are on the axis at the boundaries [Hz]
    is_bounded: bool  # gains were examined up to an end
    certified: bool  # all of it is proved, for all poles
    # Where the loop gain first falls below one with a gain margin of 6 dB [Hz]; infinite when no gain is too
    # high, ``None`` when there is no such frequency.
    bandwidth_hz: float | None
    is_bandwidth_limited: bool  # by a boundary; otherwise by the gains examined


@dataclass(frozen=True, slots=True)
class ColocationFact:
    """Up to which frequency an output moves with one where the input acts."""

    # tf and reference: of the output elsewhere and of the colocated one.
    tf: str
    reference: str
    # phase_degrees and magnitude_db: within which.
    phase_degrees: float
    magnitude_db: float
    bandwidth_hz: float | None  # none when they stay together throughout
    examined_hz: float  # up to which frequency that was examined
    is_together: bool  # at the lowest frequency they are
    certified: bool = True  # it is proved that they part there, or do not


@dataclass(frozen=True, slots=True)
class DataFact:
    """How far a model is off a measured response, root mean squares over its lines."""

    tf: str  # ``"OUT/IN"``
    # decibels and degrees: of magnitude and phase.
    decibels: float
    degrees: float
    is_synthetic: bool  # the data are computed


@dataclass(frozen=True, slots=True)
class ModelFacts:
    """Facts about one model."""

    # stem, title and source: name of its file without suffix, title and source; those may be empty.
    stem: str
    title: str = ""
    source: str = ""
    compliances: tuple[Compliance, ...] = ()  # what gives way in it
    is_distributed: bool = False  # it has infinitely many modes
    functions: tuple[TransferFacts, ...] = ()  # of its transfer functions that could be bound to numbers
    # Printed formulas, "OUT/IN", their verdicts, and what should be changed in them, in words.
    audits: tuple[tuple[str, str, str], ...] = ()
    loops: tuple[LoopFacts, ...] = ()  # of the gains that figures name
    # Of functions that are not colocated, where a colocated one of the same kind is there.
    colocations: tuple[ColocationFact, ...] = ()
    data: tuple[DataFact, ...] = ()  # of measured responses named like a transfer function

    def of(self, tf: str) -> TransferFacts:
        """Return the facts of one transfer function. Raises KeyError when there are none."""
        return {facts.tf: facts for facts in reversed(self.functions)}[tf]

    def to_json_dict(self) -> dict[str, object]:
        """Return the facts as JSON data."""
        return {
            "schema": SCHEMA,
            "model": self.stem,
            "title": self.title,
            "source": self.source,
            "compliances": [
                {"name": c.name, "bends": c.is_bending, "place": c.place} for c in self.compliances
            ],
            "transfer_functions": [f.to_json_dict() for f in self.functions],
            "loops": [_loop_json(loop) for loop in self.loops],
            "colocations": [asdict(colocation) for colocation in self.colocations],
            "data": [asdict(one) for one in self.data],
        }


def _loop_json(loop: LoopFacts) -> dict[str, object]:
    """Return the facts of a loop; JSON has no infinity, and says by a flag that nothing limits it."""
    is_unlimited = loop.bandwidth_hz == inf
    hertz = None if is_unlimited else loop.bandwidth_hz
    return asdict(loop) | {"bandwidth_hz": hertz, "is_bandwidth_unlimited": is_unlimited}


def bare_facts(stem: str, model: Model) -> ModelFacts:
    """Return what a model says of itself, without anything computed."""
    return ModelFacts(stem, model.title, model.source, compliances(model), model.is_distributed)


def facts_of(study: Study) -> ModelFacts:
    """Return the facts about a model. Functions that cannot be bound to numbers have none."""
    model = study.model
    rigid, undamped = study.rigid_counts, study.undamped_counts
    functions = []
    for tf, located, explained in study.located:
        pair = (tf.output.name, tf.input.name)
        # A function of numbers alone says nothing about other values.
        condition = minimum_phase(tf, explained) if study.has_symbols else PhaseCondition("unknown", "")
        bracket = condition.expression
        functions.append(
            replace(
                _of_roots(model, tf, located, condition.reason),
                counts=None if located.is_infinite else tf.order,
                rigid=rigid.get(pair),
                undamped=undamped.get(pair),
                explained=explained.kind,
                condition=condition.kind,
                truncation=_truncation(study, tf, located),
                bracket="" if bracket is None else format_expression(bracket),
                bracket_mathematics=None if bracket is None else mathematics(bracket, tf.model),
            )
        )
    functions += [_of_roots(model, tf, located, reason) for tf, located, reason in study.unexplained]
    return replace(
        bare_facts(study.stem, model),
        functions=tuple(functions),
        audits=tuple((audit.tf.name, audit.verdict, _changes(audit)) for audit in study.audits),
        loops=tuple(_loop(located) for located in study.loops if not isinstance(located, SymflexError)),
        colocations=tuple(_colocation(located) for located in study.colocations),
        data=tuple(
            DataFact(c.measured.name, c.decibels, c.degrees, c.measured.is_synthetic)
            for c in study.comparisons
        ),
    )


def _of_roots(model: Model, tf: AnyTransferFunction, located: PoleZeroMap, reason: str) -> TransferFacts:
    """Return what the roots of a function tell of it; ``reason`` says what its formula does, or why none."""
    return TransferFacts(
        tf=tf.name,
        quantity=tf.quantity,
        poles=tuple(map(_root_fact, located.all_poles)),
        zeros=tuple(map(_root_fact, located.zeros)),
        certified=located.certificate.certified,
        is_infinite=located.is_infinite,
        colocated=is_colocated(model, tf.output, tf.input),
        reason=reason,
        verdict=located.verdict,
    )


def _loop(stability: StabilityMap) -> LoopFacts:
    stability = stability.shown
    intervals = stability.intervals
    band = stability.crossover
    last = None if band is None else _number(band.frequency, tau)
    return LoopFacts(
        gain=stability.gain,
        unit=stability.unit,
        stable=tuple((_number(i.low), _number(i.high)) for i in stability.stable),
        unstable_at_last=intervals[-1].poles.right if intervals else stability.verdict.found,
        crossings_hz=tuple(float(w.mid()) / tau for b in stability.boundaries for w in b.frequencies),
        is_bounded=stability.limits[1] is not None,
        certified=stability.certified,
        bandwidth_hz=inf if band is not None and band.gain is None else last,
        is_bandwidth_limited=band is not None and band.is_limited,
    )


def _number(value: arb | None, unit: float = 1.0) -> float | None:
    return None if value is None else float(value.mid()) / unit


def _colocation(colocation: DynamicColocation) -> ColocationFact:
    limits = colocation.phase, colocation.magnitude, _number(colocation.edge, tau), colocation.limits[1]
    return ColocationFact(
        colocation.tf, colocation.reference, *limits, colocation.begins, colocation.is_decided
    )


def _changes(audit: Audit) -> str:
    shown = [
        f"{c.place}: {format_expression(c.printed)} should be {format_expression(c.derived)}"
        for c in audit.changes
    ]
    shown += [f"violated: {law.law}" for law in audit.laws if not law.kept]
    return "; ".join(shown)


def _root_fact(root: Root) -> RootFact:
    on_axis: Place = "imaginary axis" if root.on_imaginary_axis else "real axis" if root.is_real else "plane"
    location: Place = "origin" if root.is_zero else on_axis
    re, im, radius = float(root.re.mid()), float(root.im.mid()), float(root.decimal(15).radius)
    return RootFact(re, im, radius, location, root.multiplicity, root.frequency_hz())


def _truncation(study: Study, tf: TransferFunction, located: PoleZeroMap) -> TruncationFacts | None:
    last = max((p.frequency_hz() for p in located.poles if p.im > 0), default=0.0)
    kept = study.rational(tf) if located.is_infinite and last else None
    if kept is None:
        return None
    return TruncationFacts(kept.modes, last, kept.valid_to(0.01), kept.valid_to(0.05))
