"""What explains zeros, as plain text for a terminal, and as JSON data."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from symflex.print.notebook import Printed
from symflex.print.roots import SHORT_DIGITS
from symflex.print.text import WIDTH, Passage

if TYPE_CHECKING:
    from symflex.analysis.explanation.ends import Bending
    from symflex.analysis.explanation.parts import ConstrainedPart
    from symflex.roots import Root

Kind = Literal["colocated", "beyond", "partly", "noncolocated", "open circuit", "free", "zero"]
Status = Literal["proved", "almost surely", "not shown"]

INDENT = "  "
LISTED = 6  # parts, and real zeros, that are listed one by one
NAMES = 8
CONTEXT = {
    "colocated": "colocated",
    "beyond": "poles of what lies beyond the output",
    "partly": "partly poles of what lies beyond the output",
    "noncolocated": "noncolocated",
    "open circuit": "poles of the open circuit",
    "free": "poles of the system whose motion is not imposed",
    "zero": "identically zero",
}


@dataclass(frozen=True, slots=True)
class EndChange:
    """How the ends of a beam, rod, shaft, string or field are held in the system and when constrained."""

    name: str
    before: str
    after: str


@dataclass(frozen=True, slots=True)
class RealZero:
    """A real zero in the right half-plane, and whether its mirror image is a zero too."""

    root: Root
    is_paired: bool


@dataclass(frozen=True, slots=True)
class ZeroExplanation(Printed):
    """What the zeros of a transfer function are the poles of.

    Parameters
    ----------
    tf : str
        ``"OUT/IN"``.
    kind : str
        ``colocated``: the zeros are the poles of the system with one coordinate held, on which the input
        acts, or acts in effect. ``beyond``: the input acts elsewhere; the zeros are the poles of those parts
        of the held system that it does not drive. ``partly``: such poles, and others. ``noncolocated``: the
        poles of no held system. ``open circuit``: of the system with the terminals open. ``free``: of the
        system in which nothing imposes the motion. ``zero``: the function is identically zero.
    status : str
        ``proved`` in the exact ring of the equations; ``almost surely`` of large networks, by comparison at
        random points, which errs with odds below 1 in 2^50; ``not shown`` where the two forms cannot be
        compared.
    output, input : str
        Their names.
    is_direct : bool
        The input acts on the very coordinate that the output shows.
    held, words, spec : str
        What is zero in the constrained system, in words, and the line of the specification for it.
    order : int
        Power of s by which the output multiplies its coordinate: zeros at 0 without a constraint.
    filtered, extra, transmission : str
        Factors in s: of the output itself; whose roots are poles of the constrained system but not zeros;
        whose roots are zeros but not poles of it. Empty without such, ``...`` when too long to print.
    is_delayed : bool
        The numerator also contains exponentials of s, which have no zeros.
    has_hidden : bool
        There are hidden modes: together with the zeros they are the poles of the constrained system, but
        cancel with poles of the system itself.
    parts : tuple of ConstrainedPart
        What the constrained system separates into.
    ends : tuple of EndChange
        How line elements and fields are held at their ends, where the constraint changes that.
    right_half_plane : int
        Zeros with a positive real part in the region shown, with multiplicity.
    real_zeros : tuple of RealZero
        The real ones of them.
    on_axis : int
        Zeros in the region shown that are proved to lie on the imaginary axis, 0 left out.
    bending : Bending or None
        The beam that lies between input and output.
    has_zeros : bool
        Whether the function has zeros at all.
    """

    tf: str
    kind: Kind
    status: Status
    output: str
    input: str
    is_direct: bool = False
    held: str = ""
    words: str = ""
    spec: str = ""
    order: int = 0
    filtered: str = ""
    extra: str = ""
    transmission: str = ""
    is_delayed: bool = False
    has_hidden: bool = False
    parts: tuple[ConstrainedPart, ...] = ()
    ends: tuple[EndChange, ...] = ()
    right_half_plane: int = 0
    real_zeros: tuple[RealZero, ...] = ()
    on_axis: int = 0
    bending: Bending | None = None
    has_zeros: bool = True

    def __repr__(self) -> str:
        return f"<ZeroExplanation {self.tf}: {self.kind}, {self.status}>"

    def passages(self) -> Iterator[Passage]:
        """Return the title and the text."""
        return (Passage(lines) for lines in ([_title(self)], *explanation_paragraphs(self)))

    def __str__(self) -> str:
        return explanation_text(self)

    def to_json_dict(self) -> dict[str, object]:
        """Return it as JSON data, the key ``explanation`` of ``symflex.roots/1``."""
        bending = self.bending
        return {
            "kind": self.kind,
            "status": self.status,
            "direct": self.is_direct,
            "held": self.held or None,
            "spec": self.spec or None,
            "power_of_s": self.order,
            "output_factor": self.filtered or None,
            "poles_without_zero": self.extra or None,
            "zeros_of_transmission": self.transmission or None,
            "parts": [
                {
                    "elements": list(part.elements),
                    "fields": list(part.fields),
                    "signals": list(part.signals),
                    "poles": part.order,
                    "driven": part.has_input,
                }
                for part in self.parts
            ],
            "ends": [{"name": e.name, "before": e.before, "after": e.after} for e in self.ends],
            "right_half_plane": self.right_half_plane,
            "real_zeros": [
                {"re": zero.root.decimal(SHORT_DIGITS).re, "paired": zero.is_paired}
                for zero in self.real_zeros
            ],
            "on_imaginary_axis": self.on_axis,
            "beam_between": None
            if bending is None
            else {"name": bending.name, "massless": bending.is_massless, "evanescent": bending.is_evanescent},
            "text": [" ".join(paragraph) for paragraph in explanation_paragraphs(self)],
        }


def explanation_text(explained: ZeroExplanation, width: int = WIDTH) -> str:
    """Return an explanation as lines of at most ``width`` columns; longer names stand over."""
    lines = [_title(explained)]
    for paragraph in explanation_paragraphs(explained):
        lines.append("")
        for i, line in enumerate(paragraph):
            first = INDENT if i == 0 else 2 * INDENT
            indent = INDENT if i == 0 else 3 * INDENT
            lines += textwrap.wrap(
                line,
                width,
                initial_indent=first,
                subsequent_indent=indent,
                break_long_words=False,
                break_on_hyphens=False,
            )
    return "\n".join(lines)


def _title(explained: ZeroExplanation) -> str:
    return f"zeros of {explained.tf} explained   {CONTEXT[explained.kind]}"


def explanation_paragraphs(explained: ZeroExplanation) -> Iterator[list[str]]:
    """Yield what there is to say; the lines after the first of a paragraph are items."""
    output, source = explained.output, explained.input
    if explained.kind == "zero":
        yield [f"{source} does not move {output}: there are no zeros, and every mode is hidden."]
        return
    if not explained.has_zeros:
        yield ["There are no zeros: the numerator does not depend on s."]
    if explained.kind == "noncolocated":
        if explained.has_zeros:
            yield [_noncolocated(explained)]
    else:
        yield [_statement(explained)]
        yield [_proof(explained)]
        yield from _structure(explained)
    for end in explained.ends:
        yield [end.name, f"in the system: {end.before}", f"constrained: {end.after}"]
    if explained.spec and explained.kind != "noncolocated" and not explained.spec.startswith('"'):
        yield ["To see that system, add under [elements]", explained.spec]
    yield from _whereabouts(explained)


def _statement(explained: ZeroExplanation) -> str:
    """Return which system's poles the zeros are."""
    output, source = explained.output, explained.input
    held = "" if explained.held in explained.words else f" ({explained.held})"
    system = f"the system with {explained.words}{held}"
    zeros = "The zeros, with the hidden modes," if explained.has_hidden else "The zeros"
    undriven = f"those parts of {system} that {source} then does not drive"
    if explained.kind == "beyond":
        return f"{source} does not act where {output} measures. {zeros} are the poles of {undriven}."
    if explained.kind == "partly":
        among = f"Among {zeros[0].lower()}{zeros[1:]}"
        return f"{source} does not act where {output} measures. {among} are the poles of {undriven}."
    if explained.kind == "open circuit":
        where = f"{output} is proportional to the current that {source} delivers."
    elif explained.kind == "free":
        where = f"{output} is proportional to the effort that imposes {source}."
    elif explained.is_direct:
        where = f"{source} acts where {output} measures."
    else:
        where = f"{source} does not act where {output} measures, but has the same effect up to a factor."
    verb = "should be" if explained.status == "not shown" else "are"
    return f"{where} {zeros} {verb} the poles of {system}."


def _proof(explained: ZeroExplanation) -> str:
    if explained.status == "not shown":
        return "Not proved: the exact forms could not be compared."
    sure = explained.status == "proved"
    lead = "Proved" if sure else "Compared at random points, which errs with odds below 1 in 2^50"
    factor = _own(explained)
    more = f"*({explained.transmission})" if explained.transmission else ""
    more += f"/({explained.extra})" if explained.extra and explained.kind != "partly" else ""
    system = "those parts" if explained.kind == "partly" else "the constrained system"
    said = [f"{lead}: num = c{factor}{more}*det, where det belongs to {system} and c does not depend on s."]
    if factor:
        said.append(f"{factor[1:]} is the factor that {explained.output} applies to what it measures.")
    if explained.extra:
        divisor = explained.extra if explained.extra != "..." else "What is divided by"
        said.append(f"{divisor} is the driven part's own.")
    if explained.is_delayed:
        said.append("num also contains exponentials of s, which have no zeros.")
    if explained.has_hidden:
        said.append("Factors that num shares with the poles have cancelled and are listed as hidden.")
    return " ".join(said)


def _own(explained: ZeroExplanation) -> str:
    """Return the output's own factor, with the sign of a product before it."""
    power = f"*s^{explained.order}" if explained.order > 1 else "*s" if explained.order else ""
    return power + (f"*({explained.filtered})" if explained.filtered else "")


def _noncolocated(explained: ZeroExplanation) -> str:
    output, source = explained.output, explained.input
    text = (
        f"{source} does not act where {output} measures. The zeros are the poles of the system in which "
        f"{source} takes whatever value keeps {output} at zero (Cramer's rule); no support does that."
    )
    if explained.words:
        text += (
            f" Here it is the system with {explained.words}. Proved: num = c{_own(explained)}*det, where "
            "det belongs to that system and c does not depend on s."
        )
    return text


def _structure(explained: ZeroExplanation) -> Iterator[list[str]]:
    """Yield what moves in the constrained system."""
    parts = explained.parts
    if explained.status == "not shown":
        return
    if explained.kind in ("beyond", "partly"):
        yield ["It consists of", *_listed_parts(parts, explained.input)]
    elif len(parts) > 1:
        lead = f"It separates into {len(parts)} parts; the zeros are the poles of all of them:"
        yield [lead, *_listed_parts(parts, "")]
    elif not parts:
        yield ["Nothing moves in it: it has no poles."]
    elif parts[0].names:
        yield ["What moves in it", _members(parts[0])]


def _listed_parts(parts: Sequence[ConstrainedPart], source: str) -> Iterator[str]:
    for part in parts[:LISTED]:
        role = "" if not source else f", driven by {source}" if part.has_input else ", not driven"
        yield _members(part) + role
    if len(parts) > LISTED:
        yield f"and {len(parts) - LISTED} more"


def _members(part: ConstrainedPart) -> str:
    names = part.names
    shown = ", ".join(names[:NAMES]) + (f" and {len(names) - NAMES} more" if len(names) > NAMES else "")
    if part.order is None:
        return f"{shown} (infinitely many poles)"
    return f"{shown} ({part.order} pole{'' if part.order == 1 else 's'})"


def _whereabouts(explained: ZeroExplanation) -> Iterator[list[str]]:
    """Yield what the zeros in the region shown mean for control."""
    if explained.on_axis:
        lies = "zero lies" if explained.on_axis == 1 else "zeros lie"
        text = f"{explained.on_axis} {lies} on the imaginary axis"
        if explained.kind == "colocated":
            text += ": at those frequencies the held system vibrates freely and the output stays at rest"
        yield [f"{text}."]
    if not explained.right_half_plane:
        return
    count = explained.right_half_plane
    one = count == 1
    yield [
        f"Nonminimum phase: {count} zero{'' if one else 's'} shown {'lies' if one else 'lie'} in the right "
        f"half-plane{_real_values(explained)}."
    ]
    bending = explained.bending
    if bending is None or not explained.real_zeros:
        return
    said = [f"Between {explained.input} and {explained.output} lies {bending.name}, which bends."]
    if bending.is_evanescent:
        said.append(
            "At real s all its waves grow or decay along x and none travels (proved: mu^4 > 0). Real "
            "zeros of a noncolocated pair come from such nonpropagating bending (Miu 1991)."
        )
    else:
        said.append("Real zeros of a noncolocated pair come from nonpropagating bending (Miu 1991).")
    yield [" ".join(said)]


def _real_values(explained: ZeroExplanation) -> str:
    real = explained.real_zeros
    if not real:
        return ""
    said = []
    for lead, sign, is_paired in (("in pairs", "+-", True), ("at", "+", False)):
        values = [sign + z.root.decimal(SHORT_DIGITS).re for z in real if z.is_paired == is_paired]
        more = f" and {len(values) - LISTED} more" if len(values) > LISTED else ""
        said += [f"real zeros {lead} {', '.join(values[:LISTED])}{more}"] if values else []
    return ", " + "; ".join(said)
