"""The result of a sweep: labelled arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from symflex.errors import Diagnostic, UsageError
from symflex.sweep.design import Array, Design, Rows, Task, number
from symflex.sweep.follow import Between, NameOrigin, follow, predecessors
from symflex.sweep.points import MARGINS, PointStatus, RootStatus

SCHEMA = "symflex.sweep/1"
MODE, FREQUENCY, DRAW = "mode", "frequency", "draw"
RESERVED = frozenset(
    {MODE, FREQUENCY, DRAW, "re", "im", "radius", "status", "link", "multiplicity", "at_zero", "stable"}
    | {"point_status", "code", "frequency_hz", "damping_ratio", "s", "response"}
    | {name + end for name in MARGINS for end in ("", "_radius")}
)
ROOT_STATUS = "0 absent, 1 certified, 2 several that cannot be told apart"
POINT_STATUS = "0 certified, 1 certified except where roots accumulate, 2 not certified, 3 failed"
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

    def __post_init__(self) -> None:
        values = np.array(self.values)
        values.setflags(write=False)
        if values.ndim != len(self.dims):
            message = f"'{self.name}' has {values.ndim} axes and {len(self.dims)} names for them"
            raise ValueError(message)
        object.__setattr__(self, "values", values)


@dataclass(frozen=True, eq=False, slots=True)
class Sweep:
    """What was found at all points of a design."""

    # What was swept, in words: ``schema``, ``tf``, ``of``, ``parameters``, ``title``, ``version``, ``key``.
    attributes: tuple[tuple[str, str], ...]
    # Values of the swept parameters in SI units; numbers of modes or frequencies [Hz].
    coordinates: tuple[Labelled, ...]
    variables: tuple[Labelled, ...]  # the results; their first axes are those of the design

    def __getitem__(self, name: str) -> Array:
        """Return an array by its name."""
        for each in (*self.variables, *self.coordinates):
            if each.name == name:
                return each.values
        raise KeyError(name)

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
    def counts(self) -> dict[str, int]:
        """How many points have which status."""
        status = self["point_status"]
        return {each.name.lower(): int(np.sum(status == each)) for each in PointStatus}

    @property
    def is_certified(self) -> bool:
        """Nothing is missing at any point, and all roots are told apart."""
        if np.any(self["point_status"] > PointStatus.EXCEPT_ACCUMULATION):
            return False
        return self.of not in ("poles", "zeros") or not bool(np.any(self["status"] == RootStatus.TOGETHER))

    def to_xarray(self) -> object:
        """Return the sweep as an ``xarray.Dataset``, with roots and responses as complex numbers ``s``.

        SF914 when xarray is not installed.
        """
        xarray = extra("xarray", "a labelled dataset")
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


def extra(name: str, purpose: str) -> Any:  # noqa: ANN401 (these libraries have no types)
    """Return a module that an extra brings; SF914 says how to install it."""
    try:
        return import_module(name)
    except ImportError:
        message = f"{purpose} needs the library {name.partition('.')[0]}, which is not installed"
        raise UsageError(Diagnostic("SF914", message, None, "pip install 'symflex[sweep]'")) from None


def _described(each: Labelled) -> dict[str, str]:
    return {k: v for k, v in (("units", each.unit), ("long_name", each.doc)) if v}


def assembled(
    task: Task, design: Design, rows: Rows, attributes: Mapping[str, str], between: Between | None = None
) -> Sweep:
    """Return the sweep that the rows of all points, in order, make.

    ``attributes`` are added to what the task says; ``between`` solves points between others where names are
    in doubt, see :func:`symflex.sweep.follow.follow`.
    """
    dims = tuple(label(axis.name) for axis in design.axes) + ((DRAW,) if design.draws else ())
    coordinates = list(_parameters(task, design))
    if design.draws:
        coordinates.append(Labelled(DRAW, (DRAW,), np.arange(design.draws, dtype=np.int32), "", "number"))
    if task.of in ("poles", "zeros"):
        found, more = _roots(design, rows, between)
        coordinates.append(Labelled(MODE, (MODE,), np.arange(1, more + 1, dtype=np.int32), "", "name"))
    elif task.of == "response":
        values = np.array(task.frequencies)
        coordinates.append(Labelled(FREQUENCY, (FREQUENCY,), values, "Hz", "frequency"))
        found = [(name, (FREQUENCY,), rows[name], "", f"{name} of the response") for name in ("re", "im")]
    else:
        found = [(name, (), rows[name], unit, doc) for name, unit, doc in _margin_names()]
    found.append(("point_status", (), rows["point_status"], "", POINT_STATUS))
    found.append(("code", (), rows["code"], "", "error code of a point that failed"))
    shape = design.shape
    variables = tuple(
        Labelled(name, dims + own, values.reshape(shape + values.shape[1:]), unit, doc)
        for name, own, values, unit, doc in found
    )
    names = " ".join(label(name) for name in design.names)
    said = {"schema": SCHEMA, "tf": "/".join(task.pair), "of": task.of, "parameters": names, **attributes}
    return Sweep(tuple((k, v) for k, v in said.items() if v), tuple(coordinates), variables)


def label(name: str) -> str:
    """Return what a parameter is called among the arrays, whose own names it must not take.

    Examples
    --------
    >>> label("k"), label("mode")
    ('k', 'mode_')
    """
    while name in RESERVED:
        name += "_"
    return name


def _parameters(task: Task, design: Design) -> list[Labelled]:
    known = {p.name: p for p in task.model.parameters}
    found = [
        Labelled(
            label(axis.name),
            (label(axis.name),),
            np.array([number(value) for value in axis.values]),
            known[axis.name].unit,
            known[axis.name].doc,
        )
        for axis in design.axes
    ]
    first = design.points[: design.draws]
    for i, limits in enumerate(design.ranges, start=len(design.axes)):
        values = np.array([number(point[i]) for point in first])
        about = known[limits.name]
        found.append(Labelled(label(limits.name), (DRAW,), values, about.unit, about.doc))
    return found


Named = tuple[str, tuple[str, ...], "Array", str, str]


def _roots(design: Design, rows: Rows, between: Between | None) -> tuple[list[Named], int]:
    """Return the arrays of roots, sorted by the names of modes, and how many modes there are."""
    s = rows["re"] + 1j * rows["im"]
    names = follow(s, rows["family"].astype(np.int64), predecessors(design), between)
    modes_kept = max(
        names.modes, 1
    )  # one at least, absent everywhere: not all formats and readers take an empty axis
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
    found: list[Named] = [
        ("re", own, re, "rad/s", "real part"),
        ("im", own, im, "rad/s", "imaginary part; not negative, conjugates are left out"),
        ("radius", own, sorted_by_mode(rows["radius"], np.nan), "rad/s", "the true root is no further away"),
        ("status", own, sorted_by_mode(rows["status"], RootStatus.ABSENT), "", ROOT_STATUS),
        ("multiplicity", own, sorted_by_mode(rows["multiplicity"], 0), "", "multiplicity"),
        ("link", own, sorted_by_mode(names.link, NameOrigin.ABSENT), "", LINKS),
        ("frequency_hz", own, size / (2 * np.pi), "Hz", "natural frequency"),
        ("damping_ratio", own, ratio + 0.0, "", "damping ratio"),
        ("at_zero", (), rows["at_zero"], "", "multiplicity of the root at s = 0"),
    ]
    return found, modes_kept


def _margin_names() -> list[tuple[str, str, str]]:
    docs = {
        "gain_margin_up": ("", "factor by which the gain may grow"),
        "gain_margin_down": ("", "factor to which the gain may fall"),
        "phase_margin": ("deg", "smallest phase margin"),
        "crossover": ("Hz", "where the loop gain is one, of that margin"),
    }
    named = [(name, *docs[name]) for name in MARGINS]
    radii = [(f"{name}_radius", unit, "bound of the error") for name, unit, _ in named]
    return [*named, *radii, ("stable", "", "1 stable, 0 unstable, -1 not known")]
