"""The result of a sweep: labelled arrays, in a few lines for a terminal, in a few numbers as JSON."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from symflex.errors import counted
from symflex.errors.optional import installed
from symflex.print.notebook import Printed
from symflex.print.text import Passage
from symflex.quantities import unit_of
from symflex.sweep.design import Array, Design, Rows, Task, number
from symflex.sweep.follow import Between, NameOrigin, follow, predecessors
from symflex.sweep.points import MARGINS, VERDICTS, PointStatus, RootStatus

SCHEMA = "symflex.sweep/1"
MODE, FREQUENCY, DRAW = "mode", "frequency", "draw"
RESERVED = frozenset(
    {MODE, FREQUENCY, DRAW, "re", "im", "radius", "status", "link", "multiplicity", "at_zero", "stable"}
    | {"verdict", "hidden_motion"}
    | {"point_status", "code", "frequency_hz", "damping_ratio", "s", "response"}
    | {name + end for name in MARGINS for end in ("", "_radius")}
)
ROOT_STATUS = "0 absent, 1 certified, 2 several that cannot be separated"
POINT_STATUS = "0 certified, 1 certified except where roots accumulate, 2 not certified, 3 failed"
STABILITY = {
    "verdict": "0 not known, 1 unstable, 2 marginal, 3 stable: of all poles, shown or not",
    "hidden_motion": "1 where hidden poles lie on the imaginary axis or in the right half-plane",
}
LINKS = (
    "0 absent, 1 start, 2 similar: proved, 3 clearly the nearest, 4 in doubt, 5 met the real axis, 6 appears"
)


@dataclass(frozen=True, eq=False, slots=True)
class Labelled:
    """An array whose axes have names."""

    name: str  # of the array
    dims: tuple[str, ...]  # of its axes
    values: Array  # read-only
    # unit and doc: SI unit, empty without one; what it is.
    unit: str = ""
    doc: str = ""

    def __repr__(self) -> str:
        return f"<Labelled {self.name}: {' x '.join(self.dims) or 'a number'}, {self.values.shape}>"

    def __post_init__(self) -> None:
        values = np.array(self.values)
        values.setflags(write=False)
        if values.ndim != len(self.dims):
            raise ValueError(f"'{self.name}' has {values.ndim} axes and {len(self.dims)} names for them")
        object.__setattr__(self, "values", values)


@dataclass(frozen=True, eq=False, slots=True)
class Sweep(Printed):
    """What was found at all points of a design."""

    # What was swept, in words: ``schema``, ``tf``, ``of``, ``parameters``, ``title``, ``version``, ``key``.
    attributes: tuple[tuple[str, str], ...]
    # Values of the swept parameters in SI units; numbers of modes or frequencies [Hz].
    coordinates: tuple[Labelled, ...]
    variables: tuple[Labelled, ...]  # the results; their first axes are those of the design

    def __repr__(self) -> str:
        status = "certified" if self.is_certified else "not certified"
        names = ", ".join(each.name for each in self.parameters)
        points = counted(self["point_status"].size, "point")
        return f"<Sweep {self.attribute('tf')}: {self.of} at {points}, {names}, {status}>"

    def passages(self) -> Iterator[Passage]:
        """Return what was swept, how much of it is proved, and between which values each mode moves."""
        status = self["point_status"]
        shape = " x ".join(map(str, status.shape))
        points = counted(status.size, "point") + (f" ({shape})" if status.ndim > 1 else "")
        lines = [f"{self.attribute('tf')}: {self.of} at {points}"]
        for each in self.shown:
            unit = f" {each.unit}" if each.unit else ""
            drawn = each.dims == ("draw",)
            how = ", drawn" if drawn else f", {counted(each.values.size, 'value')}"
            lines.append(f"{INDENT}{each.name} = {_span(each.values)}{unit}{how}")
        yield Passage(lines)
        proved = [f"{INDENT}{count} {STATES[name]}" for name, count in self.counts.items() if count]
        codes = sorted({code for code in self["code"].reshape(-1).tolist() if code})
        if codes:
            proved.append(f"{INDENT}codes: {', '.join(codes)}")
        if self.of == "poles":
            proved += _stability(self, points)
        if self.of in ("poles", "zeros"):
            yield Passage([*proved, *_doubts(self)])
            more = self["status"].shape[-1] - MODES_SHOWN
            shown = f"the lowest {MODES_SHOWN} modes, and {more} more" if more > 0 else "modes"
            rows: list[tuple[str, ...]] = [("mode", "frequency [Hz]", "damping ratio", "points")]
            every = range(self["status"].shape[-1])
            for k in every[:MODES_SHOWN]:
                there = self["status"][..., k] > 0
                spans = (_span(self[name][..., k][there]) for name in ("frequency_hz", "damping_ratio"))
                rows.append((str(k + 1), *spans, str(int(np.sum(there)))))
            yield Passage([INDENT + shown], rows)
        else:
            yield Passage(proved)
            if self.of == "margins":
                yield Passage(_margins(self))

    def __getitem__(self, name: str) -> Array:
        """Return an array by its name."""
        return {each.name: each.values for each in (*self.coordinates, *self.variables)}[name]

    def attribute(self, name: str) -> str:
        """Return an attribute, empty where there is none."""
        return dict(self.attributes).get(name, "")

    @property
    def of(self) -> str:
        """``poles``, ``zeros``, ``response`` or ``margins``."""
        return self.attribute("of")

    @property
    def parameters(self) -> tuple[Labelled, ...]:
        """The coordinates that are swept parameters."""
        names = self.attribute("parameters").split()
        return tuple(each for each in self.coordinates if each.name in names)

    @property
    def shown(self) -> tuple[Labelled, ...]:
        """The swept parameters in the units in which they print: what was declared in rpm is in rpm."""
        declared = dict(pair.split("=") for pair in self.attribute("declared_units").split("; ") if pair)
        units = {name: unit_of(unit) for name, unit in declared.items()}
        sizes = {name: float(unit.scale) * np.pi**unit.pi_power for name, unit in units.items()}
        return tuple(
            replace(p, unit=declared[p.name], values=p.values / sizes[p.name]) if p.name in declared else p
            for p in self.parameters
        )

    @property
    def counts(self) -> dict[str, int]:
        """How many points have which status."""
        status = self["point_status"]
        return {each.name.lower(): int(np.sum(status == each)) for each in PointStatus}

    @property
    def is_certified(self) -> bool:
        """Nothing is missing at any point, and all roots are separated."""
        if np.any(self["point_status"] > PointStatus.EXCEPT_ACCUMULATION):
            return False
        return self.of not in ("poles", "zeros") or not bool(np.any(self["status"] == RootStatus.TOGETHER))

    def to_xarray(self) -> object:
        """Return the sweep as an ``xarray.Dataset``, with roots and responses as complex numbers ``s``.

        SF914 when xarray is not installed.
        """
        xarray = installed("xarray")
        arrays = {v.name: (v.dims, v.values, _described(v)) for v in self.variables}
        if "re" in arrays:
            name = "response" if self.of == "response" else "s"
            dims = arrays["re"][0]
            about = {"long_name": name} if name == "response" else {"long_name": "roots", "units": "rad/s"}
            arrays[name] = (dims, self["re"] + 1j * self["im"], about)
        return xarray.Dataset(
            arrays,
            coords={c.name: (c.dims, c.values, _described(c)) for c in self.coordinates},
            attrs=dict(self.attributes),
        )


def _described(each: Labelled) -> dict[str, str]:
    return {k: v for k, v in (("units", each.unit), ("long_name", each.doc)) if v}


def assembled(
    task: Task, design: Design, rows: Rows, attributes: Mapping[str, str], between: Between | None = None
) -> Sweep:
    """Return the sweep that all rows make; ``between`` solves points where names are in doubt."""
    dims = tuple(label(axis.name) for axis in design.axes) + ((DRAW,) if design.draws else ())
    coordinates = list(_parameters(task, design))
    if design.draws:
        coordinates.append(Labelled(DRAW, (DRAW,), np.arange(design.draws, dtype=np.int32), "", "number"))
    if task.of in ("poles", "zeros"):
        named, more = _roots(design, rows, between)
        coordinates.append(Labelled(MODE, (MODE,), np.arange(1, more + 1, dtype=np.int32), "", "name"))
    elif task.of == "response":
        values = np.array(task.frequencies)
        coordinates.append(Labelled(FREQUENCY, (FREQUENCY,), values, "Hz", "frequency"))
        named = [(name, (FREQUENCY,), rows[name], "", f"{name} of the response") for name in ("re", "im")]
    else:
        named = [(name, (), rows[name], unit, doc) for name, unit, doc in _margin_names()]
    if task.of in ("poles", "margins"):
        named += [(name, (), rows[name], "", doc) for name, doc in STABILITY.items()]
    named.append(("point_status", (), rows["point_status"], "", POINT_STATUS))
    named.append(("code", (), rows["code"], "", "error code of a point that failed"))
    shape = design.shape
    variables = tuple(
        Labelled(name, dims + own, values.reshape(shape + values.shape[1:]), unit, doc)
        for name, own, values, unit, doc in named
    )
    names = " ".join(label(name) for name in design.names)
    swept = [p for p in task.model.parameters if p.name in design.names and p.counted_in[1] != 1]
    units = "; ".join(f"{label(p.name)}={p.written_unit}" for p in swept)
    said = {"schema": SCHEMA, "tf": "/".join(task.pair), "of": task.of, "parameters": names, **attributes}
    said |= {"declared_units": units}
    return Sweep(tuple((k, v) for k, v in said.items() if v), tuple(coordinates), variables)


def label(name: str) -> str:
    """Return what a parameter is called among the arrays, whose own names it must not take.

    >>> label("k"), label("mode")
    ('k', 'mode_')
    """
    while name in RESERVED:
        name += "_"
    return name


def _parameters(task: Task, design: Design) -> list[Labelled]:
    parameters = {p.name: p for p in task.model.parameters}
    rows = [(axis.name, label(axis.name), axis.values) for axis in design.axes]
    for i, limits in enumerate(design.ranges, start=len(design.axes)):
        rows.append((limits.name, DRAW, tuple(point[i] for point in design.points[: design.draws])))
    return [
        Labelled(
            label(name),
            (dim,),
            np.array(list(map(number, values))),
            parameters[name].unit,
            parameters[name].doc,
        )
        for name, dim, values in rows
    ]


Named = tuple[str, tuple[str, ...], "Array", str, str]


def _roots(design: Design, rows: Rows, between: Between | None) -> tuple[list[Named], int]:
    """Return the arrays of roots, sorted by the names of modes, and how many modes there are."""
    s = rows["re"] + 1j * rows["im"]
    names = follow(s, rows["family"].astype(np.int64), predecessors(design), between)
    # One at least, absent everywhere: not all formats and readers take an empty axis.
    modes_kept = max(names.modes, 1)
    shape = (design.count, modes_kept)
    points, places = np.nonzero(names.mode >= 0)
    modes = names.mode[points, places]

    def sorted_by_mode(values: Array, empty: float) -> Array:
        result = np.full(shape, empty, values.dtype)
        result[points, modes] = values[points, places]
        return result

    re, im = sorted_by_mode(rows["re"], np.nan), sorted_by_mode(rows["im"], np.nan)
    size = np.hypot(re, im)
    ratio = np.divide(-re, size, out=np.full(shape, np.nan), where=size > 0)
    own = (MODE,)
    named: list[Named] = [
        ("re", own, re, "rad/s", "real part"),
        ("im", own, im, "rad/s", "imaginary part; not negative, conjugates are left out"),
        ("radius", own, sorted_by_mode(rows["radius"], np.nan), "rad/s", "bound on the distance to the root"),
        ("status", own, sorted_by_mode(rows["status"], RootStatus.ABSENT), "", ROOT_STATUS),
        ("multiplicity", own, sorted_by_mode(rows["multiplicity"], 0), "", "multiplicity"),
        ("link", own, sorted_by_mode(names.link, NameOrigin.ABSENT), "", LINKS),
        ("frequency_hz", own, size / (2 * np.pi), "Hz", "natural frequency"),
        ("damping_ratio", own, ratio + 0.0, "", "damping ratio"),
        ("at_zero", (), rows["at_zero"], "", "multiplicity of the root at s = 0"),
    ]
    return named, modes_kept


def _margin_names() -> list[tuple[str, str, str]]:
    docs = {
        "gain_margin_up": ("", "factor by which the gain may grow"),
        "gain_margin_down": ("", "factor to which the gain may fall"),
        "phase_margin": ("deg", "smallest phase margin"),
        "crossover": ("Hz", "where the loop gain is one, of that margin"),
    }
    named = [(name, *docs[name]) for name in MARGINS]
    radii = [(f"{name}_radius", unit, "bound of the error") for name, unit, _ in named]
    return [*named, *radii, ("stable", "", "1 stable, 0 marginal or unstable, -1 not known")]


INDENT = "  "
MODES_SHOWN = 24
STATES = {
    "certified": "certified",
    "except_accumulation": "certified except next to points where roots accumulate",
    "not_certified": "not certified",
    "failed": "failed",
}


def _words(sweep: Sweep) -> dict[str, int]:
    """Return at how many points which word is said of stability; nothing in files from before it was."""
    if "verdict" not in (each.name for each in sweep.variables):
        return {}
    return {word: int(np.sum(sweep["verdict"] == i)) for i, word in reversed([*enumerate(VERDICTS)])}


def _stability(sweep: Sweep, points: str) -> list[str]:
    """Return at how many points the system is stable, and at how many some of it moves unseen."""
    words = _words(sweep)
    if not words:
        return [f"{INDENT}stability not known: this file does not record it"]
    shown = {word.replace("unknown", "stability not known"): count for word, count in words.items() if count}
    first, *said = [f"{word} at {count}" for word, count in shown.items()]
    unseen = int(np.sum(sweep["hidden_motion"]))
    hidden = f"{INDENT}hidden poles on the imaginary axis or in the right half-plane at {unseen}"
    return [f"{INDENT}{', '.join([f'{first} of {points}', *said])}", *([hidden] if unseen else [])]


def _doubts(sweep: Sweep) -> list[str]:
    """Return where roots, or the names of modes, are not separated."""
    together = int(np.sum(sweep["status"] == RootStatus.TOGETHER))
    holding = f"{counted(together, 'enclosure')} {'holds' if together == 1 else 'hold'}"
    lines = [f"{INDENT}{holding} roots that cannot be separated"] if together else []
    return lines + [f"{INDENT}{text}" for text in _links(sweep)]


def _links(sweep: Sweep) -> list[str]:
    counts = _link_counts(sweep)
    said = (
        ("doubtful", "name", "in doubt: modes come close, cross, or the steps are long"),
        ("real_axis", "name", "by choice: a pair met the real axis"),
    )
    lines = [f"{counted(counts[name], what)} {text}" for name, what, text in said if counts[name]]
    if counts["appears"] == 1:
        lines.append("1 root enters the region or leaves it, and has a name of its own")
    elif counts["appears"]:
        text = "enter the region or leave it, and have names of their own"
        lines.append(f"{counts['appears']} roots {text}")
    return lines


def _link_counts(sweep: Sweep) -> dict[str, int]:
    named = (each for each in NameOrigin if each is not NameOrigin.ABSENT)
    return {each.name.lower(): int(np.sum(sweep["link"] == each)) for each in named}


def _margins(sweep: Sweep) -> list[str]:
    stable = sweep["stable"]
    points = counted(stable.size, "point")
    plain = [f"{INDENT}stable at {int(np.sum(stable == 1))} of {points}"]
    lines = _stability(sweep, points) if _words(sweep) else plain
    for name, unit, _ in _margin_names()[: len(MARGINS)]:
        values = sweep[name][np.isfinite(sweep[name])]
        if values.size:
            lines.append(f"{INDENT}{name.replace('_', ' ')}: {_span(values)} {unit}".rstrip())
    return lines


def _span(values: Array) -> str:
    if not values.size or np.all(np.isnan(values)):
        return "-"
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    return f"{low:.6g}" if low == high else f"{low:.6g} to {high:.6g}"


def sweep_json(sweep: Sweep) -> dict[str, object]:
    """Return the summary in the schema ``symflex.sweep/1``; the arrays themselves are for files."""
    document: dict[str, object] = {
        **dict(sweep.attributes),
        "certified": sweep.is_certified,
        "points": sweep.counts,
        "shape": list(sweep["point_status"].shape),
        "parameters": [
            {"name": p.name, "unit": p.unit, "count": int(p.values.size), "range": _ends(p.values)}
            for p in sweep.parameters
        ],
        "codes": sorted({code for code in sweep["code"].reshape(-1).tolist() if code}),
    }
    if words := _words(sweep):
        document["stability"] = words
        document["hidden_motion_points"] = int(np.sum(sweep["hidden_motion"]))
    if sweep.of in ("poles", "zeros"):
        if sweep.of == "poles":
            document["unstable_points"] = _words(sweep).get("unstable")
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
        document |= {name: _ends(sweep[name]) for name in MARGINS}
    return document


def _largest(values: Array) -> float | None:
    ends = _ends(values)
    return None if ends is None else ends[1]


def _ends(values: Array) -> list[float] | None:
    finite = values[np.isfinite(values)]
    return [float(np.min(finite)), float(np.max(finite))] if finite.size else None
