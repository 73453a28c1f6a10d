"""A reduced model with a proved error: state equations of the lowest modes, and how far they are off at most.

Input: transfer functions of one model, by output and input, and how many modes or which error. Output: a
:class:`ReducedModel`.

Example: a cantilever of three modes with damping, tip force to tip displacement: the error is between
2.105e-6 and 2.107e-6 m/N at all frequencies, 0.17 % of the static value.

The state equations count as the doubles they are. The error is the largest singular value of ``G - R`` on the
imaginary axis, by :func:`~symflex.analysis.norms.largest.largest_gain`: an input of a given energy makes an
error of at most that much in the output (Zhou, Doyle and Glover 1996).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from math import inf, isfinite, pi
from typing import TYPE_CHECKING

import numpy as np
from flint import acb, acb_mat, arb

from symflex.analysis.norms.axis import MatrixOnAxis, norm
from symflex.analysis.norms.energy import H2Norm, integrated, noise_filter
from symflex.analysis.norms.expanded import BITS, DIGITS, Expanded, expanded, static_value, turning_delays
from symflex.analysis.norms.largest import (
    NOTHING,
    LargestGain,
    eigenvalue_bound,
    eigenvalue_met,
    largest_gain,
)
from symflex.analysis.norms.matrix_peak import matrix_on_axis
from symflex.analysis.norms.modal_model import ModalModel, modal_model
from symflex.analysis.rational.laurent import residues_at
from symflex.balls import ball, precision
from symflex.errors import Diagnostic, ModelError, UncertifiedError, refused
from symflex.model.loss_factors import check_causal
from symflex.model.spec.write import write
from symflex.options import Stated, share_of
from symflex.print.notebook import Printed
from symflex.print.text import Passage
from symflex.roots import Modes, Position, Root
from symflex.roots.pole_zero_map import is_right
from symflex.roots.polynomial_roots import in_order
from symflex.roots.root import figure, modes_of, overlap, real_json, short_hertz
from symflex.state_space import Channel
from symflex.state_space.numeric import BoundState, BoundStateSpace
from symflex.transfer import AnyBoundFunction, points_of

if TYPE_CHECKING:
    import numpy.typing as npt

SCHEMA = "symflex.reduced/1"
MOST_MODES = 60  # kept for an error
# Share of the size of a matrix anywhere on the axis [rad/s] that is no error: doubles round to more.
NO_ERROR, ANYWHERE = 2.0**-57, 1.1
SHOWN_DIGITS = 6
Rows = Sequence[Sequence[AnyBoundFunction]]


@dataclass(frozen=True, eq=False)
class ReducedModel(Printed):
    """State equations of a few modes in place of transfer functions, with a proved error.

    Parameters
    ----------
    error : LargestGain
        Bounds of the largest singular value of ``G - R`` over frequency.
    channels : tuple of tuple of LargestGain
        The same of each pair alone, a row per output.
    static : arb or None
        Largest singular value of G at s = 0; ``None`` if it is zero or infinite.
    modes : int
        How many modes are kept, poles at s = 0 aside.
    band : (float, float) or None
        Where the error is stated [Hz]; ``None`` for all frequencies.
    """

    exact: MatrixOnAxis  # G, without delays
    difference: MatrixOnAxis  # G - R
    kept: ModalModel
    modes: int
    error: LargestGain
    channels: tuple[tuple[LargestGain, ...], ...]
    static: arb | None
    band: tuple[float, float] | None
    notes: tuple[str, ...]

    @property
    def sources(self) -> list[list[AnyBoundFunction]]:
        """The functions it stands for."""
        return [[f.bound for f in row] for row in self.exact.functions]

    @property
    def name(self) -> str:
        """The pair, or how many outputs and inputs."""
        return self._label("/", " x ")

    def _label(self, over: str, times: str) -> str:
        rows, columns = self.exact.shape
        if rows == columns == 1:
            source = self.sources[0][0].source
            return f"{source.output.name}{over}{source.input.name}"
        return f"{rows}{times}{columns} matrix".replace(" ", " ")

    @property
    def certified(self) -> bool:
        """Whether the error is proved."""
        return not self.error.reasons and self.error.most.is_finite()

    @property
    def relative(self) -> arb | None:
        """The error over the static value; ``None`` without one."""
        with precision(BITS):
            return None if self.static is None else self.error.enclosure / self.static

    @property
    def delays(self) -> tuple[tuple[float, ...], ...]:
        """The delay of each pair that is kept outside of the state equations [s]."""
        return tuple(tuple(float(f.delay.mid()) for f in row) for row in self.exact.functions)

    def state_space(self) -> BoundStateSpace:
        """Return the state equations, of which delays are no part."""
        arrays = self.kept.arrays
        states = tuple(BoundState(f"z_{i + 1}", (), "") for i in range(len(arrays.a)))
        sources = self.sources
        inputs = tuple(Channel(b.source.input.name, _unit(b, "input")) for b in sources[0])
        outputs = tuple(Channel(row[0].source.output.name, _unit(row[0], "output")) for row in sources)
        ends = ("_".join(x.name for x in group) for group in (outputs, inputs))
        label = f"{'_over_'.join(ends)}_{self.modes}_modes"
        return BoundStateSpace(label, arrays, states, inputs, outputs, is_minimal=True)

    def specification(self, title: str) -> str:
        """Return the state equations as a specification, whose title says the error."""
        system, a = self.state_space(), self.kept.arrays
        groups = (system.outputs, system.inputs, system.states)
        outputs, inputs, states = ([x.name for x in group] for group in groups)
        equations = [
            f"s*{state} = {_sum([*zip(a.a[i], states, strict=True), *zip(a.b[i], inputs, strict=True)])}"
            for i, state in enumerate(states)
        ]
        lines = {
            y: _sum([*zip(a.c[i], states, strict=True), *zip(a.d[i], inputs, strict=True)])
            for i, y in enumerate(outputs)
        }
        error = self.statements()[0].replace(" <= error <= ", " <= error of the H-infinity norm <= ")
        spec: dict[str, object] = {
            "symflex": 1,
            "title": f"{title}, {self.name} in {self.modes} modes: {error}",
        }
        if states:
            spec["equations"] = {"unknowns": states, "equations": equations}
        return write({**spec, "inputs": {name: {} for name in inputs}, "outputs": lines})

    def facts(self) -> dict[str, object]:
        """Return the error in numbers, for the metadata of other programs."""
        relative = self.relative
        return {
            "modes": self.modes,
            "error_bounds": (float(self.error.least.lower()), float(self.error.most.upper())),
            "error_relative": None if relative is None else float(relative.upper()),
            "error_at_hz": self.error.omega / (2 * pi),
            "error_is_proved": self.certified,
            "error_band_hz": self.band,
            "delays": self.delays,
        }

    def h2_error(self, noise: str = "") -> H2Norm:
        """Return the RMS of the error under white noise, shaped by ``noise``; infinite with a constant D."""
        name, unit = f"error of {self.name}", self.sources[0][0].source.unit
        unit = unit if self.exact.shape == (1, 1) else ""
        shaper = noise_filter(self.sources[0][0].source.model, noise)
        because = ""
        if self.notes and any("undamped" in note for note in self.notes):
            because = "a mode without damping is left out"
        elif shaper is None and any(x != 0 for x in self.difference.limit().entries()):
            because = "the static correction lets white noise pass; shape the noise"
        if because:
            return H2Norm(name, unit, arb("inf"), noise, (), because)
        total, reasons = integrated(self.difference, None if shaper is None else expanded(shaper, 0))
        with precision(BITS):
            return H2Norm(name, unit, (total / arb.pi()).sqrt(), noise, reasons)

    def to_control(self) -> object:
        """Return a ``control.StateSpace``; ``metadata`` has units, the error and delays kept outside."""
        return self.state_space().to_control(self.facts())

    def to_scipy(self) -> object:
        """Return a ``scipy.signal.StateSpace``; ``metadata`` has units, the error and delays kept outside."""
        return self.state_space().to_scipy(self.facts())

    def at(self, s: npt.ArrayLike) -> npt.NDArray[np.complex128]:
        """Return R, delays included, at complex frequencies [rad/s]: (outputs, inputs) + the shape of s."""
        points = points_of(s)
        arrays, n = self.kept.arrays, len(self.kept.arrays.a)
        flat = points.ravel()
        values = np.empty((*self.exact.shape, flat.size), dtype=complex)
        for k, point in enumerate(flat):
            inner = np.linalg.solve(point * np.eye(n) - arrays.a, arrays.b) if n else arrays.b
            values[:, :, k] = (arrays.c @ inner + arrays.d) * np.exp(-point * np.array(self.delays))
        return values.reshape(*self.exact.shape, *points.shape)

    def passages(self) -> Iterator[Passage]:
        """Return the error, what it means, and the modes that are kept."""
        status = "certified" if self.certified else "NOT CERTIFIED"
        modes = "1 mode" if self.modes == 1 else f"{self.modes} modes"
        states = len(self.kept.arrays.a)
        yield Passage([f"{self.name}   state equations of {modes}, {states} states; error {status}"])
        yield Passage(["  " + line for line in self.statements()])
        if self.exact.shape != (1, 1):
            rows = [("pair", "error at least", "at most", "at [Hz]")]
            for row, sources in zip(self.channels, self.sources, strict=True):
                for gain, bound in zip(row, sources, strict=True):
                    rows.append((bound.name, _down(gain.least), _up(gain.most), _hertz(gain)))
            yield Passage(["  largest error of each pair"], rows)
        poles = [("Re [rad/s]", "Im [rad/s]", "f [Hz]")]
        for p in self.kept.poles:
            im = f"+-{p.imag:.10g}" if p.imag else "0"
            poles.append((f"{p.real:.10g}", im, f"{abs(p) / (2 * pi):.6g}"))
        if self.kept.poles:
            yield Passage([f"  poles kept: {sum(2 if p.imag else 1 for p in self.kept.poles)}"], poles)

    def statements(self) -> list[str]:
        """Return what is proved of the error, line by line."""
        unit = self.sources[0][0].source.unit if self.exact.shape == (1, 1) else ""
        unit = f" {unit}" if unit else ""
        error, lines = self.error, []
        where = self._range()
        if error.most.is_finite():
            bounds = f"{_down(error.least)} <= error <= {_up(error.most)}{unit}"
            lines.append(f"{bounds}, {where}")
            lines.append(f"largest {_at(error)}")
            relative = self.relative
            if relative is not None:
                static = "" if self.static is None else f" {figure(self.static, SHOWN_DIGITS)}{unit}"
                lines.append(f"relative to the static value{static}: at most {_up(relative)}")
        else:
            lines.append(f"the error is infinite {where}")
        lines += [f"not proved: {reason}" for reason in error.reasons]
        lines += self.notes
        if any(any(row) for row in self.delays):
            shown = ", ".join(sorted({f"{d:.6g} s" for row in self.delays for d in row if d}))
            lines.append(f"delay kept outside of the state equations: {shown}")
        return lines

    def _range(self) -> str:
        if self.band is None:
            return "at all frequencies"
        return f"from {self.band[0]:g} Hz to {self.band[1]:g} Hz"

    def to_json_dict(self) -> dict[str, object]:
        """Return the model in the schema ``symflex.reduced/1``, ready for :func:`json.dumps`."""
        system = self.state_space()
        relative = self.relative
        return {
            "schema": SCHEMA,
            "outputs": [x.name for x in system.outputs],
            "inputs": [x.name for x in system.inputs],
            "modes": self.modes,
            "certified": self.certified,
            "reasons": list(self.error.reasons),
            "notes": list(self.notes),
            "band_hz": self.band and list(self.band),
            "error": _gain_json(self.error),
            "static": real_json(self.static, SHOWN_DIGITS),
            "relative": None
            if relative is None
            else {"least": float(relative.lower()), "most": float(relative.upper())},
            "channels": [[_gain_json(gain) for gain in row] for row in self.channels],
            "delays": [list(row) for row in self.delays],
            "A": system.A.tolist(),
            "B": system.B.tolist(),
            "C": system.C.tolist(),
            "D": system.D.tolist(),
        }


def _sum(terms: Sequence[tuple[float, str]]) -> str:
    """Return a sum of products as an expression; every double is the shortest decimal that prints it."""
    return " + ".join(f"({float(c)!r})*{name}" for c, name in terms if c) or "0"


def _unit(bound: AnyBoundFunction, end: str) -> str:
    source = bound.source
    if end == "output":
        return source.output.unit
    return source.input.unit or str(source.input.dimension or "")


def _down(value: arb) -> str:
    """Print a bound from below, rounded down."""
    return _rounded(value.lower(), ROUND_FLOOR)


def _up(value: arb) -> str:
    """Print a bound from above, rounded up."""
    return _rounded(value.upper(), ROUND_CEILING)


def _rounded(value: arb, rounding: str) -> str:
    if not value.is_finite():
        return "infinite"
    decimal = Context(prec=SHOWN_DIGITS, rounding=rounding).create_decimal(Decimal(float(value.mid())))
    return f"{float(decimal):.{SHOWN_DIGITS}g}"


def _hertz(gain: LargestGain) -> str:
    return f"{gain.omega / (2 * pi):.6g}" if isfinite(gain.omega) else "as f grows"


def _at(gain: LargestGain) -> str:
    return f"about {gain.omega / (2 * pi):.6g} Hz" if isfinite(gain.omega) else "as the frequency grows"


def _gain_json(gain: LargestGain) -> dict[str, object]:
    most = float(gain.most.upper())
    return {
        "least": float(gain.least.lower()),
        "most": most if isfinite(most) else None,
        "frequency_hz": gain.omega / (2 * pi) if isfinite(gain.omega) else None,
    }


@dataclass(frozen=True, eq=False)
class _Poles:
    """The poles of a matrix, with residues of all its functions."""

    functions: tuple[tuple[Expanded, ...], ...]
    poles: tuple[Root, ...]  # in order of size; those of all functions, once each

    @classmethod
    def of(cls, rows: Rows, modes: int) -> _Poles:
        functions = matrix_on_axis(rows, modes, None).functions  # with those that are kept wherever they lie
        poles: list[Root] = []
        for function in (f for row in functions for f in row):
            for root in function.located.all_poles:
                at = next((i for i, other in enumerate(poles) if overlap(root, other)), None)
                if at is None:
                    poles.append(root)
                elif root.multiplicity > poles[at].multiplicity:
                    poles[at] = root
        return cls(functions, in_order(poles))

    @property
    def is_rational(self) -> bool:
        """Whether all poles of all functions are known."""
        return all(f.radius == inf for row in self.functions for f in row)

    def kept(self, modes: int) -> tuple[list[Root], list[Root]]:
        """Return the poles of so many modes, with those at 0 and in the right half-plane, and the others."""
        positions = Modes(modes).classify(self.poles)
        keep = [p is not Position.OUTSIDE or is_right(r) for r, p in zip(self.poles, positions, strict=True)]
        return [r for r, k in zip(self.poles, keep, strict=True) if k], [
            r for r, k in zip(self.poles, keep, strict=True) if not k
        ]

    def model(self, kept: Sequence[Root]) -> ModalModel:
        """Return the state equations of poles that are kept, with the static correction of the others."""
        shape = len(self.functions), len(self.functions[0])
        with precision(BITS):
            constant = [[static_value(f).real for f in row] for row in self.functions]
            residues: list[tuple[Root, acb, dict[int, npt.NDArray[np.complex128]]]] = []
            for root in kept:
                if root.im < 0:
                    continue
                by_power: dict[int, npt.NDArray[np.complex128]] = {}
                enclosure = root.enclosure()
                for i, row in enumerate(self.functions):
                    for j, function in enumerate(row):
                        part = self._part(function, root)
                        for k, c in enumerate(() if part is None else part[1], 1):
                            zero = np.zeros(shape, dtype=complex)
                            by_power.setdefault(k, zero)[i, j] = complex(c.mid())
                            if not root.is_zero and part is not None:
                                enclosure = part[0]
                                own = c / (-part[0]) ** k
                                constant[i][j] -= own.real if root.is_real else 2 * own.real
                if by_power:
                    residues.append((root, enclosure, by_power))
            return modal_model(residues, constant)

    def _part(self, function: Expanded, root: Root) -> tuple[acb, tuple[acb, ...]] | None:
        own = next((r for r in function.located.all_poles if overlap(r, root)), None)
        if own is None:
            return None
        part = next((p for p in function.parts if overlap(p.root, root)), None)
        if part is None:  # beyond the disc
            (part,) = residues_at(function.bound, [own], DIGITS)
        return part.pole, part.coefficients


def reduced_model(
    rows: Rows,
    modes: int | None = None,
    error: Stated | None = None,
    band: tuple[float, float] | None = None,
) -> ReducedModel:
    """Return state equations of so many modes, or of as few as an error allows, with the error proved.

    ``rows`` are the functions of one model, a row per output; ``error`` is relative to the largest singular
    value at s = 0, and ``band`` is in Hz. SF902 for a wrong number, SF802 where no principal parts are known,
    SF236 for functions that grow with frequency, SF405 where residues are not known.
    """
    if modes is not None and (modes < 0 or modes % 1):
        raise refused(f"the number of modes cannot be {modes}")
    share = None if error is None else share_of(error, "--error", inf)
    check_causal(rows[0][0].source.model, "a reduced model")
    first = modes if modes is not None else rows[0][0].source.model.analysis.modes or 5
    poles = _Poles.of(rows, first)
    if turning_delays(poles.functions):
        message = "pairs of the matrix have delays that are not those of their input and output"
        raise UncertifiedError(Diagnostic("SF802", message, None, "reduce one pair at a time"))
    if share is None:
        found = _of_modes(poles, first, band)
        return replace(found, channels=_channels(found))
    static = _static(poles)
    if static is None:
        hint = "give --modes; a function that is zero or infinite at s = 0 has no relative error"
        raise ModelError(Diagnostic("SF402", "there is no static value", None, hint))
    with precision(BITS):
        wanted = (static * ball(share)).lower()
    searched = first
    for count in range(MOST_MODES + 1):
        if count > searched and not poles.is_rational:
            searched = 2 * count
            poles = _Poles.of(rows, searched)
        found = _of_modes(poles, count, band, enough=float(wanted))
        if found.error.most <= wanted or not poles.kept(count)[1]:
            return replace(found, channels=_channels(found))
    message = f"more than {MOST_MODES} modes are needed for an error of {float(share):g}"
    raise UncertifiedError(Diagnostic("SF405", message, None, "allow a larger error, or give a --band"))


def _static(poles: _Poles) -> arb | None:
    """Return the largest singular value at s = 0, None where it is zero or infinite."""
    if any(part.root.is_zero for row in poles.functions for f in row for part in f.parts):
        return None
    with precision(BITS):
        shape = len(poles.functions), len(poles.functions[0])
        value = acb_mat(*shape, [static_value(f) for row in poles.functions for f in row])
        square = value.conjugate().transpose() * value
        met, most = eigenvalue_met(square), eigenvalue_bound(square)
        return met.union(most).sqrt() if met > 0 else None


def _of_modes(
    poles: _Poles, modes: int, band: tuple[float, float] | None, enough: float = inf
) -> ReducedModel:
    """Return the model of so many modes; the errors of its channels are not bounded yet."""
    kept, left_out = poles.kept(modes)
    model = poles.model(kept)
    constant = tuple(tuple(map(arb, row)) for row in model.arrays.d.tolist())
    difference = MatrixOnAxis(poles.functions, model.terms, constant)
    notes = []
    undamped = [root for root in left_out if root.on_imaginary_axis and root.im > 0]
    first = min((float(root.im.mid()) for root in undamped), default=inf)
    if band is None and undamped:
        below = [size for root in kept if (size := float(root.size().mid())) < first]
        band = (0.0, (max(below, default=0.0) or first / 2) / (2 * pi))
        shown = short_hertz(arb(first))
        notes.append(f"the mode at {shown} Hz, which is left out, is undamped: there no error is finite")
    if any(root.on_imaginary_axis for root in kept):
        notes.append("poles on the imaginary axis count as those of the model, without their rounding")
    ends = None if band is None else (2 * pi * band[0], 2 * pi * band[1])
    if ends is not None and ends[0] <= first <= ends[1]:
        error = LargestGain(arb(0), arb("inf"), first, ends[1], difference.reasons, (arb(first),))
    else:
        error = largest_gain(difference, ends, enough=enough, floor=_no_error(MatrixOnAxis(poles.functions)))
    if band is None and error.high < inf:
        band = (0.0, error.high / (2 * pi))
    return ReducedModel(
        MatrixOnAxis(poles.functions),
        difference,
        model,
        len(modes_of(kept)),
        error,
        ((error,),),
        _static(poles),
        band,
        tuple(notes),
    )


def _no_error(exact: MatrixOnAxis) -> arb:
    """Return an error that is none: far below what rounding to doubles costs, where that is not exact."""
    with precision(BITS):
        size = norm(exact.value(acb(0, ANYWHERE)))
        return size * NO_ERROR if size.is_finite() else NOTHING


def _channels(model: ReducedModel) -> tuple[tuple[LargestGain, ...], ...]:
    """Return the error of each pair alone."""
    rows, columns = model.exact.shape
    if rows == columns == 1 or not model.error.most.is_finite():
        return tuple((model.error,) * columns for _ in range(rows))
    ends = None if model.band is None else (2 * pi * model.band[0], 2 * pi * model.band[1])
    most, floor = model.error.most, _no_error(model.exact)

    def channel(i: int, j: int) -> LargestGain:
        found = largest_gain(model.difference.entry(i, j), ends, floor=floor)
        # No entry is larger than the largest singular value.
        return replace(found, most=most) if found.most > most or not found.most.is_finite() else found

    return tuple(tuple(channel(i, j) for j in range(columns)) for i in range(rows))
