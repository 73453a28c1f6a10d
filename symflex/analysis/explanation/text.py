"""An explanation of zeros as plain text for a terminal, and as JSON data."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

from symflex.print.text import Passage

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from symflex.analysis.explanation.parts import ConstrainedPart
    from symflex.analysis.explanation.zeros import ZeroExplanation

WIDTH = 80
INDENT = "  "
DIGITS = 6
LISTED = 6
"""Parts, and real zeros, that are listed one by one."""
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


def explanation_text(explained: ZeroExplanation, width: int = WIDTH) -> str:
    """Return an explanation as lines of at most ``width`` columns; longer names stand over."""
    lines = [_title(explained)]
    for paragraph in explanation_paragraphs(explained):
        lines.append("")
        for i, line in enumerate(paragraph):
            first = INDENT if i == 0 else 2 * INDENT
            rest = INDENT if i == 0 else 3 * INDENT
            lines += textwrap.wrap(
                line,
                width,
                initial_indent=first,
                subsequent_indent=rest,
                break_long_words=False,
                break_on_hyphens=False,
            )
    return "\n".join(lines)


def explanation_html(explained: ZeroExplanation) -> str:
    """Return the same for a notebook: a paragraph for each."""
    from symflex.print.html import passages_html  # only notebooks ask

    paragraphs = explanation_paragraphs(explained)
    return passages_html(Passage(lines) for lines in ([_title(explained)], *paragraphs))


def _title(explained: ZeroExplanation) -> str:
    return f"zeros of {explained.tf} explained   {CONTEXT[explained.kind]}"


def explanation_json(explained: ZeroExplanation) -> dict[str, object]:
    """Return an explanation as JSON data, the key ``explanation`` of ``symflex.roots/1``."""
    bending = explained.bending
    return {
        "kind": explained.kind,
        "status": explained.status,
        "direct": explained.is_direct,
        "held": explained.held or None,
        "spec": explained.spec or None,
        "power_of_s": explained.order,
        "output_factor": explained.filtered or None,
        "poles_without_zero": explained.extra or None,
        "zeros_of_transmission": explained.transmission or None,
        "parts": [
            {
                "elements": list(part.elements),
                "fields": list(part.fields),
                "signals": list(part.signals),
                "poles": part.order,
                "driven": part.has_input,
            }
            for part in explained.parts
        ],
        "ends": [{"name": e.name, "before": e.before, "after": e.after} for e in explained.ends],
        "right_half_plane": explained.right_half_plane,
        "real_zeros": [
            {"re": zero.root.decimal(DIGITS).re, "paired": zero.is_paired} for zero in explained.real_zeros
        ],
        "on_imaginary_axis": explained.on_axis,
        "beam_between": None
        if bending is None
        else {"name": bending.name, "massless": bending.is_massless, "evanescent": bending.is_evanescent},
        "text": [" ".join(paragraph) for paragraph in explanation_paragraphs(explained)],
    }


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
    verb = "are" if explained.status == "proved" else "should be"
    return f"{where} {zeros} {verb} the poles of {system}."


def _proof(explained: ZeroExplanation) -> str:
    if explained.status != "proved":
        return "Not proved: the exact forms could not be compared."
    own = _own(explained)
    more = f"*({explained.transmission})" if explained.transmission else ""
    more += f"/({explained.extra})" if explained.extra and explained.kind != "partly" else ""
    whole = "those parts" if explained.kind == "partly" else "the constrained system"
    said = [f"Proved: num = c{own}{more}*det, where det belongs to {whole} and c does not depend on s."]
    if own:
        said.append(f"{own[1:]} is the factor that {explained.output} applies to what it measures.")
    if explained.extra:
        divisor = explained.extra if explained.extra != "..." else "What is divided by"
        said.append(f"{divisor} is the driven part's own.")
    if explained.is_delayed:
        said.append("num also holds exponentials of s, which have no zeros.")
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
    if explained.status != "proved":
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
        f"half plane{_real_values(explained)}."
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
        values = [sign + z.root.decimal(DIGITS).re for z in real if z.is_paired == is_paired]
        more = f" and {len(values) - LISTED} more" if len(values) > LISTED else ""
        said += [f"real zeros {lead} {', '.join(values[:LISTED])}{more}"] if values else []
    return ", " + "; ".join(said)
