"""Is a machine stable with what touches it? Coupled stability, for one environment or all of a class.

Input: the text of a specification, a port and an environment. Output: a :class:`CoupledStability`.

The environment becomes elements of the specification, and the questions are those of ``roots`` and
``stability``: poles are counted in the right half-plane, hidden ones too. Letters of the environment without
a value may have any positive one. Example: the mass m of a haptic wall, held to it by a force ``-K x`` that
comes T late, and a spring ``k_e`` in the hand: stable for every ``k_e`` above 0, or up to which.

Where only finite ranges can be searched, a value without end is ``scale*share/(1 - share)`` with a share
from 0 to 1. Next to a share of 1, poles may lie beyond all bounds, and what is proved ends before.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from math import inf, isfinite, log10
from pathlib import Path

from flint import acb

from symflex.analysis.sampled_loop import SampledPoles, sampled_loop, sampled_poles, sampled_stability
from symflex.balls import ball
from symflex.contact.hybrid import HybridPassivity, find_hybrid
from symflex.contact.joined import joined
from symflex.contact.law import (
    ANY,
    MECHANICAL,
    Environment,
    read_environment,
    share_name,
    with_environment,
)
from symflex.contact.passivity import PortPassivity, find_passivity
from symflex.contact.port import at_port
from symflex.errors import Diagnostic, Source, SymflexError, UsageError, refused
from symflex.loops import of_model
from symflex.loops.chart import StabilityChart
from symflex.loops.over import characteristic, seen_pair, stability_over, with_values
from symflex.loops.spread import SpreadStability, find_spread
from symflex.loops.stability_map import StabilityMap
from symflex.model import ContactPort, Model, ModelParameter, Setting, load_with
from symflex.model.ports import port_named
from symflex.model.sampled import refused as sampled_refused
from symflex.model.spec import read
from symflex.model.spec.read import NETLISTS
from symflex.options import ContactOptions, StabilityOptions, gain_ends
from symflex.print.notebook import Printed
from symflex.print.text import INDENT, Passage
from symflex.roots.locate import locate
from symflex.roots.passivity import observed
from symflex.roots.pole_zero_map import PoleZeroMap
from symflex.roots.region import Modes
from symflex.roots.root import exact_fraction
from symflex.transfer.of_model import derive_bound, derive_for_roots

SCHEMA = "symflex.contact/1"
MODES = 3  # modes of a distributed machine whose poles are found where only a verdict is asked for
LAWS = {
    "translation": "force over displacement",
    "rotation": "torque over angle",
    "electrical": "voltage over current",
    "acoustic": "pressure over flow",
}
SPECIFICATIONS = (".toml", *NETLISTS)  # ends of names of files
HELD = {ANY: "every passive one", "short": "nothing is left there"}  # of environments without elements
SIZES = {
    "k": (1, 0),
    "b": (1, -1),
    "m": (1, -2),
    "J": (1, -2),
    "R": (1, 0),
    "L": (1, -1),
    "M": (1, -1),
    "C": (-1, -1),
}
"""Powers of the size at a frequency, and of this, that parameters of elements have."""
Range = tuple[Fraction, Fraction | None]  # the ends of what a letter may be, in SI units; None without one
Answer = (
    StabilityMap
    | StabilityChart
    | SpreadStability
    | PoleZeroMap
    | SampledPoles
    | PortPassivity
    | HybridPassivity
)


@dataclass(frozen=True)
class CoupledStability(Printed):
    """What is proved of a machine with an environment at a port."""

    environment: Environment
    answer: Answer
    reason: str = ""  # why what was asked for is not decided, or which letters were set

    def __repr__(self) -> str:
        return f"<CoupledStability at {self.environment.port.name}: {self.word}>"

    @property
    def is_stable(self) -> bool | None:
        """Whether the machine is stable for all that was asked for; None where that is not proved."""
        answer = self.answer
        if isinstance(answer, PortPassivity | HybridPassivity):
            return answer.passive
        if isinstance(answer, StabilityMap):
            if any(not i.poles.is_stable for i in answer.intervals):
                return False
            return True if answer.certified and len(answer.intervals) == 1 else None
        if isinstance(answer, StabilityChart):
            words = {region.verdict.word for region in answer.regions}
            return False if words & {"unstable", "marginal"} else None
        word = answer.word if isinstance(answer, SpreadStability) else answer.verdict.word
        return {"stable": True, "unstable": False, "marginal": False}.get(word)

    @property
    def word(self) -> str:
        """The answer in a few words."""
        if isinstance(self.answer, PoleZeroMap):
            return self.answer.verdict.headline
        if isinstance(self.answer, SampledPoles):
            return self.answer.sentence
        if self.is_stable is None:
            return "not decided"
        scope = "with all of them" if self.environment.text == ANY else "for all values"
        return f"stable {scope}" if self.is_stable else f"not stable {scope}"

    @property
    def certified(self) -> bool:
        """Whether what was asked for is decided and proved."""
        if isinstance(self.answer, PoleZeroMap | SampledPoles):
            return self.answer.verdict.word != "unknown"
        return (
            self.is_stable is not None
            if isinstance(self.answer, PortPassivity | HybridPassivity)
            else self.answer.certified
        )

    def passages(self) -> list[Passage]:
        """Return what touches the machine, and the answer."""
        port, environment = self.environment.port, self.environment
        held = HELD.get(environment.text, "nothing moves")
        law = LAWS[port.domain] if environment.elements else held
        law = f"{environment.lone}: {law}" if environment.lone else law
        law = "of a file" if _file_of(environment.text) else law
        head = f"port {port.name}, environment {environment.text} ({law})"
        if isinstance(self.answer, PoleZeroMap):
            return [Passage([head, *self._poles(self.answer)])]
        head = f"{head}: {self.word}"
        return [
            Passage([head, *([f"{INDENT}{self.reason}"] if self.reason else [])]),
            *self.answer.passages(),
        ]

    @staticmethod
    def _poles(located: PoleZeroMap) -> list[str]:
        """Return the verdict, and the poles that are not in the left half-plane."""
        lines = [f"{INDENT}{located.verdict.sentence}"]
        if located.verdict.hidden:
            lines.append(f"{INDENT}{located.verdict.hidden_motion}")
        right = [root for root in located.all_poles if root.re > 0 and not root.im < 0]
        return lines + [f"{INDENT}pole at s = {complex(root):.9g} rad/s" for root in right]

    def to_json_dict(self) -> dict[str, object]:
        """Return the result in the schema ``symflex.contact/1``, in SI units."""
        answer = self.answer
        verdict = answer.verdict.to_json_dict() if isinstance(answer, PoleZeroMap) else None
        return {
            "schema": SCHEMA,
            "port": self.environment.port.name,
            "domain": self.environment.port.domain,
            "environment": self.environment.text,
            "letters": list(self.environment.letters),
            "stable": self.is_stable,
            "certified": self.certified,
            "reason": self.reason,
            "verdict": verdict,
            "stability": None if verdict else answer.to_json_dict(),
        }


def coupled_stability(
    source: Source,
    given: ContactOptions,
    settings: Mapping[str, Setting] | None = None,
    allow_outside: Iterable[str | Path] = (),
) -> CoupledStability:
    """Return whether a machine is stable with an environment at a port.

    ``settings`` are values of parameters, those of the environment too. Raises UsageError: SF902 for an
    environment or a letter without a value that cannot be read so, SF804 for a range that is empty or has no
    end where it needs one; SpecError: at places of the text with the environment; and as ``stability`` does.
    """
    load = partial(load_with, allow_outside=tuple(allow_outside))
    settings, machine = settings or {}, load(source, {})
    port = port_named(machine, given.port)
    own = {n: v for n, v in settings.items() if n in {p.name for p in machine.parameters}}
    if given.environment == ANY:
        if given.over or given.limits or given.ranges or given.up_to is not None:
            raise refused(f"'{ANY}' takes no --over, --range or --up-to: it has no letters")
        model, everything = load(source, settings), Environment(port, ANY, ())
        if model.sampled is not None:
            return CoupledStability(everything, find_hybrid(model, given.port))
        return CoupledStability(everything, find_passivity(model, port, given.digits or 12))
    if (place := _file_of(given.environment)) is not None:
        others = {n: v for n, v in settings.items() if n not in own}
        return _beside(load(source, own), port, load(read(place[0]), {}), place[1], given, others)
    environment = read_environment(machine, port, given.environment)
    model = load(with_environment(source, machine, environment), settings)
    free = tuple(p for p in model.parameters if p.name in environment.letters and p.value is None)
    names = tuple(given.over) or tuple(p.name for p in free)
    if lost := [p.name for p in free if p.name not in names]:
        hint = f"give it one: --set {lost[0]}=VALUE, or ask for it: --over {lost[0]}"
        raise refused(f"'{lost[0]}' of the environment has no value", hint)
    _check_ranges(given, names)
    if not names:
        return CoupledStability(environment, _located(model))
    if len(names) > 2:  # noqa: PLR2004 (a chart has two axes)
        raise refused(f"{len(names)} letters have no value: at most two", "give others one: --set NAME=VALUE")
    ranges = {p.name: _range(p, given, len(names)) for p in free}
    endless = [name for name, (_, high) in ranges.items() if high is None]
    if endless and model.sampled is not None:
        message = f"the values of '{endless[0]}' need an end, as poles of a sampled loop are followed so far"
        raise UsageError(Diagnostic("SF804", message, None, f"give one: --range {endless[0]} 0 HI"))
    if not endless or (given.over and len(names) > 1):
        return CoupledStability(environment, _answer(model, given, names, ranges))
    if len(names) == 1:
        (name,), (letter,) = names, free
        exact = _exactly(model, name, ranges[name], given)
        if exact is not None:
            return CoupledStability(environment, exact)
        size = _size(load(source, own), port)
        scale, low = _scale(environment, name, size), ranges[name][0]
        text = with_environment(source, machine, environment, {name: f"{scale} {letter.unit}".strip()})
        whole = {share_name(name): (low / (low + scale), Fraction(1))}
        found = _answer(load(text, settings), given, (*whole,), whole)
        return CoupledStability(environment, _of_letter(found, name, scale, letter.unit))
    passivity = find_passivity(load(source, own), port, given.digits or 12, is_explained=False)
    if passivity.passive:
        return CoupledStability(environment, passivity, "no passive environment makes it unstable")
    for name, other in ((names[0], names[1]), (names[1], names[0])):
        alone = load(with_environment(source, machine, environment), {**settings, other: 0})
        unstable = _exactly(alone, name, ranges[name], given)
        if unstable is not None and any(i.poles.right for i in unstable.intervals):
            return CoupledStability(environment, unstable, f"with {other} = 0")
    ranged = " ".join(f"--range {name} LO HI" for name in names)
    both = f"all values of '{names[0]}' and '{names[1]}' together"
    message = f"{both}, without an end, are proved only where the port is passive"
    raise UsageError(Diagnostic("SF804", message, None, f"give ranges: {ranged}"))


def _check_ranges(given: ContactOptions, names: Sequence[str]) -> None:
    """Refuse ranges of what is not asked for."""
    if spare := [name for name, *_ in given.ranges if name not in names]:
        raise refused(f"a range of '{spare[0][:64]}', which is not asked for", f"--over {spare[0][:64]} asks")
    if not names and (given.limits or given.up_to is not None):
        raise refused("no letter of the environment is without a value, and so none has a range")


def _beside(
    machine: Model,
    port: ContactPort,
    other: Model,
    name: str | None,
    given: ContactOptions,
    values: Mapping[str, Setting],
) -> CoupledStability:
    """Return what holds of a machine that touches another one at its port of a name.

    ModelError: SF261 where the controller of the other one takes samples.
    """
    if other.sampled is not None:
        raise sampled_refused(other)
    model = with_values(joined(machine, port, other, port_named(other, name)), values)
    parts = tuple((each.element.type_name, "", each.name) for each in other.elements)
    answer = _answer(model, given, given.over, {}) if given.over else _located(model)
    return CoupledStability(Environment(port, given.environment, parts), answer)


def _file_of(text: str) -> tuple[Path, str | None] | None:
    """Return the specification that an environment names, ``FILE`` or ``FILE:PORT``, with its port."""
    path, _, port = text.rpartition(":") if Path(text.rpartition(":")[0]).suffix else (text, "", "")
    return (Path(path), port or None) if Path(path).suffix in SPECIFICATIONS else None


def _exactly(model: Model, name: str, limits: Range, given: ContactOptions) -> StabilityMap | None:
    """Return what holds for all values of a parameter that polynomials have; None with delays and waves."""
    try:
        found = of_model.of_rational(model, name, limits, given.digits or 15, None, has_pairs=False)
    except UsageError:  # SF804: a finite range is needed
        return None
    return None if found is None else found.of_parameter


def _range(letter: ModelParameter, given: ContactOptions, count: int) -> Range:
    """Return the range of a letter of the environment, without its ends: all positive values by default."""
    named = {name: (low, high) for name, low, high in given.ranges}
    stated = named.get(letter.name, given.limits if count == 1 else None)
    if given.up_to is not None:
        if count > 1 or stated is not None:
            hint = f"write --range {letter.name} 0 {given.up_to}"
            raise refused("--up-to is for an environment with one letter, and no --range", hint)
        stated = (0, given.up_to)
    low, high = (gain_ends(stated, letter) if stated else None) or (None, None)
    low = low or Fraction(0)
    if low < 0 or (high is not None and not low < high):
        raise refused(f"the range of '{letter.name}' must lie above 0, from a smaller to a larger value")
    return low, high


def _answer(model: Model, given: ContactOptions, names: Sequence[str], ranges: Mapping[str, Range]) -> Answer:
    """Return what holds for letters in finite ranges: over one or two, or for all combinations of both."""
    if len(names) == 1 or given.over:
        of_letters = tuple((n, low, inf if high is None else high) for n, (low, high) in ranges.items())
        others = tuple(each for each in given.ranges if each[0] not in ranges)
        limits = None if of_letters else given.limits
        search = stability_over if model.sampled is None else sampled_stability
        return search(
            model,
            StabilityOptions(
                "", limits, None, given.digits, tuple(names), (*of_letters, *others), given.resolve
            ),
        )
    box = tuple((low, high) for low, high in (ranges[name] for name in names) if high is not None)
    parameters = [next(p for p in model.parameters if p.name == name) for name in names]
    if model.sampled is not None:
        loop = sampled_loop(model, dict(zip(names, box, strict=True)))
        return find_spread(loop.characteristic(names), box, parameters)
    return find_spread(characteristic(model, names, box), box, parameters)


def _of_letter(found: Answer, name: str, scale: Fraction, unit: str) -> Answer:
    """Return a map over a share in terms of the letter, as far as values are proved."""
    if not isinstance(found, StabilityMap):
        return found
    ends = [i.high.lower() for i in found.intervals[-1:] if i.high is not None and i.high.contains(1)]
    if not ends:
        return found
    last: Fraction | None = exact_fraction(ends[0])
    with_end = replace(found.intervals[-1], high=ends[0])
    if last == 1:  # the share below 1, and so the letter, has no end
        last, with_end = None, replace(with_end, high=None)
    found = replace(found, limits=(found.limits[0], last), intervals=(*found.intervals[:-1], with_end))
    size = ball(scale)
    return found.in_terms_of(name, unit, lambda g: size * g / (1 - g), lambda g: scale * g / (1 - g))


def _size(machine: Model, port: ContactPort) -> tuple[float, float]:
    """Return the dynamic stiffness of a machine at a port, or its impedance, near its lowest mode, and where.

    One and one where it has parameters without values, or is too large: only the search is scaled by them.
    """
    try:
        driven, pair = at_port(machine, port)
        (bound,) = derive_bound(driven, [pair])
        poles = locate(bound, None if bound.is_rational else Modes(1), with_zeros=False).poles
        omega = 1.5 * min((abs(complex(p)) for p in poles if not p.is_zero), default=1.0)
        answer = abs(complex(bound.enclosed(64)(acb(0, omega))))
    except SymflexError:
        return 1.0, 1.0
    if not (isfinite(answer) and answer):
        return 1.0, omega
    return (omega / answer if port.domain in MECHANICAL else answer), omega


def _scale(environment: Environment, letter: str, size: tuple[float, float]) -> Fraction:
    """Return a power of ten [SI units] near which the value of a letter matters."""
    keys = (key for _, key, value in environment.elements if value == letter)
    of_size, of_omega = SIZES.get(next(keys, ""), (0, 0))
    return Fraction(10) ** round(of_size * log10(size[0]) + of_omega * log10(size[1]))


def _located(model: Model) -> PoleZeroMap | SampledPoles:
    """Return the poles of a model whose parameters have values, of a distributed one the lowest."""
    if model.sampled is not None:
        return sampled_poles(model)
    pair = seen_pair(model)
    (bound,) = derive_for_roots(observed(model, pair[0]), [pair])
    return locate(bound, None if bound.is_rational else Modes(MODES), with_zeros=False)
