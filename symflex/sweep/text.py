"""A sweep in a few lines for a terminal, and in a few numbers as JSON."""

from __future__ import annotations

from textwrap import wrap
from typing import TYPE_CHECKING

import numpy as np

from symflex.print.text import aligned
from symflex.sweep.follow import NameOrigin
from symflex.sweep.points import RootStatus

if TYPE_CHECKING:
    from symflex.sweep import Sweep
    from symflex.sweep.design import Array

INDENT = "  "
MODES_SHOWN = 24
STATES = {
    "certified": "certified",
    "except_accumulation": "certified except next to points where roots accumulate",
    "not_certified": "not certified",
    "failed": "failed",
}


def sweep_text(sweep: Sweep, width: int = 80) -> str:
    """Return what was swept, how much of it is proved, and between which values each mode moves."""
    status = sweep["point_status"]
    shape = " x ".join(map(str, status.shape))
    points = counted(status.size, "point") + (f" ({shape})" if status.ndim > 1 else "")
    lines = [f"{sweep.attribute('tf')}: {sweep.of} at {points}"]
    for each in sweep.parameters:
        unit = f" {each.unit}" if each.unit else ""
        drawn = each.dims == ("draw",)
        how = ", drawn" if drawn else f", {counted(each.values.size, 'value')}"
        lines.append(f"{INDENT}{each.name} = {_span(each.values)}{unit}{how}")
    lines += ["", *(f"{INDENT}{count} {STATES[name]}" for name, count in sweep.counts.items() if count)]
    codes = sorted({code for code in sweep["code"].reshape(-1).tolist() if code})
    if codes:
        lines.append(f"{INDENT}codes: {', '.join(codes)}")
    if sweep.of == "poles":
        unstable = _unstable_points(sweep)
        lines.append(
            f"{INDENT}unstable at {unstable} of {points}"
            if unstable
            else f"{INDENT}stability not known: no pole shown grows; others and hidden modes are not examined"
        )
    if sweep.of in ("poles", "zeros"):
        lines += _roots(sweep)
    elif sweep.of == "margins":
        lines += _margins(sweep)
    return "\n".join(piece for line in lines for piece in _fitted(line, width))


def _unstable_points(sweep: Sweep) -> int:
    """Return at how many points a pole that is shown lies in the right half plane, which is proved."""
    return int(np.sum(np.any((sweep["status"] > 0) & (sweep["damping_ratio"] < 0), axis=-1)))


def counted(count: int, what: str) -> str:
    """Return how many there are of what, in words.

    Examples
    --------
    >>> counted(1, "point"), counted(2, "point")
    ('1 point', '2 points')
    """
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def _fitted(line: str, width: int) -> list[str]:
    if len(line) <= width:
        return [line]
    return wrap(line, width, subsequent_indent=2 * INDENT, drop_whitespace=True, replace_whitespace=False)


def _roots(sweep: Sweep) -> list[str]:
    together = int(np.sum(sweep["status"] == RootStatus.TOGETHER))
    holding = f"{counted(together, 'enclosure')} {'holds' if together == 1 else 'hold'}"
    lines = [f"{INDENT}{holding} roots that cannot be told apart"] if together else []
    lines += [f"{INDENT}{text}" for text in _links(sweep)]
    rows = [("mode", "frequency [Hz]", "damping ratio", "points")]
    every = range(sweep["status"].shape[-1])
    for k in every[:MODES_SHOWN]:
        there = sweep["status"][..., k] > 0
        rows.append(
            (
                str(k + 1),
                _span(sweep["frequency_hz"][..., k][there]),
                _span(sweep["damping_ratio"][..., k][there]),
                str(int(np.sum(there))),
            )
        )
    lines += ["", *aligned(rows, INDENT)]
    if len(every) > MODES_SHOWN:
        lines.append(f"{INDENT}and {len(every) - MODES_SHOWN} more")
    return lines


def _links(sweep: Sweep) -> list[str]:
    counts = _link_counts(sweep)
    said = (
        ("doubtful", "name", "in doubt: modes come close, cross, or the steps are long"),
        ("real_axis", "name", "by choice: a pair met the real axis"),
    )
    lines = [f"{counted(counts[name], what)} {text}" for name, what, text in said if counts[name]]
    if counts["appears"] == 1:
        return [*lines, "1 root enters the region or leaves it, and has a name of its own"]
    if counts["appears"]:
        text = "enter the region or leave it, and have names of their own"
        return [*lines, f"{counts['appears']} roots {text}"]
    return lines


def _link_counts(sweep: Sweep) -> dict[str, int]:
    link = sweep["link"]
    return {
        each.name.lower(): int(np.sum(link == each)) for each in NameOrigin if each is not NameOrigin.ABSENT
    }


def _margins(sweep: Sweep) -> list[str]:
    stable = sweep["stable"]
    lines = ["", f"{INDENT}stable at {int(np.sum(stable == 1))} of {counted(stable.size, 'point')}"]
    for name, unit in (
        ("gain_margin_up", ""),
        ("gain_margin_down", ""),
        ("phase_margin", " deg"),
        ("crossover", " Hz"),
    ):
        values = sweep[name][np.isfinite(sweep[name])]
        if values.size:
            lines.append(f"{INDENT}{name.replace('_', ' ')}: {_span(values)}{unit}")
    return lines


def _span(values: Array) -> str:
    if not values.size or np.all(np.isnan(values)):
        return "-"
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    return f"{low:.6g}" if low == high else f"{low:.6g} to {high:.6g}"


def sweep_json(sweep: Sweep) -> dict[str, object]:
    """Return the summary in the schema ``symflex.sweep/1``; the arrays themselves are for files.

    Ranges are ``[smallest, largest]``, or ``null`` where there is no finite value.
    """
    document: dict[str, object] = {
        **dict(sweep.attributes),
        "certified": sweep.is_certified,
        "points": sweep.counts,
        "shape": list(sweep["point_status"].shape),
        "parameters": [
            {
                "name": each.name,
                "unit": each.unit,
                "count": int(each.values.size),
                "range": _ends(each.values),
            }
            for each in sweep.parameters
        ],
        "codes": sorted({code for code in sweep["code"].reshape(-1).tolist() if code}),
    }
    if sweep.of in ("poles", "zeros"):
        if sweep.of == "poles":
            document["unstable_points"] = _unstable_points(sweep)
        document["links"] = _link_counts(sweep)
        document["modes"] = [
            {
                "mode": k + 1,
                "points": int(np.sum(sweep["status"][..., k] > 0)),
                "frequency_hz": _ends(sweep["frequency_hz"][..., k]),
                "damping_ratio": _ends(sweep["damping_ratio"][..., k]),
                "largest_radius": _largest(sweep["radius"][..., k]),
            }
            for k in range(sweep["status"].shape[-1])
        ]
    elif sweep.of == "margins":
        document["stable"] = int(np.sum(sweep["stable"] == 1))
        for name in ("gain_margin_up", "gain_margin_down", "phase_margin", "crossover"):
            document[name] = _ends(sweep[name])
    return document


def _largest(values: Array) -> float | None:
    ends = _ends(values)
    return None if ends is None else ends[1]


def _ends(values: Array) -> list[float] | None:
    finite = values[np.isfinite(values)]
    return [float(np.min(finite)), float(np.max(finite))] if finite.size else None
