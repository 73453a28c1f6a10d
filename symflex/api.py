"""The classes a user meets: thin faces over the pipeline, with SymPy and mpmath at the surface."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import mpmath

from symflex import pipeline
from symflex import roots as roots_room
from symflex.emit.forms import PrintedForm, counts_of, print_form
from symflex.emit.json_format import derive_json
from symflex.emit.sympy_expression import symbols_of, to_sympy
from symflex.emit.text import form_text
from symflex.errors import Diagnostic, UsageError
from symflex.errors.diagnostic import nearest
from symflex.expressions import Expression, Name
from symflex.roots.multiprecision import to_complex_mpmath, to_mpmath
from symflex.spec import write

if TYPE_CHECKING:
    import numpy as np
    import sympy
    from flint import acb
    from numpy.typing import ArrayLike, NDArray

    from symflex import model as model_room
    from symflex import modes as modes_room
    from symflex import rational as rational_room
    from symflex import sensitivity as sensitivity_room
    from symflex import transfer as transfer_room
    from symflex.explanation import ZeroExplanation
    from symflex.response import FrequencyResponse

Number = int | float | Fraction | Decimal | str
Table = Mapping[str, object]
SHOWN_DIGITS = 12
SHOWN_PAIRS = 6
END_TOLERANCE = 1e-12
"""Relative distance by which rounding may put a place beyond the end of a beam."""


@dataclass(frozen=True, init=False)
class Model:
    """A resolved model.

    Parameters
    ----------
    parameters, definitions, elements, signals, blocks, fields, inputs, outputs : mapping
    analysis, figures, published : mapping
        The tables of the specification language, as Python mappings of the same shape.
    title, source : str
        What the model is and where it comes from.

    Raises
    ------
    SpecError
        With every problem; positions refer to the specification text the mappings stand for.

    Examples
    --------
    >>> model = Model(
    ...     parameters={"m": "2 kg"},
    ...     elements={"body": {"type": "mass", "at": "x", "m": "m"}},
    ...     inputs={"F": {"force": "x"}},
    ...     outputs={"X": "x"},
    ... )
    >>> print(model.transfer_function("X", "F"))
    X/F = 1/(m*s^2)
    """

    resolved: model_room.Model

    def __init__(
        self,
        *,
        parameters: Table | None = None,
        definitions: Table | None = None,
        elements: Table | None = None,
        signals: Table | None = None,
        blocks: Table | None = None,
        fields: Table | None = None,
        inputs: Table | None = None,
        outputs: Table | None = None,
        analysis: Table | None = None,
        figures: Table | None = None,
        published: Table | None = None,
        title: str = "",
        source: str = "",
    ) -> None:
        tables = {
            "parameters": parameters,
            "definitions": definitions,
            "elements": elements,
            "signals": signals,
            "blocks": blocks,
            "fields": fields,
            "inputs": inputs,
            "outputs": outputs,
            "analysis": analysis,
            "figures": figures,
            "published": published,
        }
        header = {"symflex": 1, **{k: v for k, v in (("title", title), ("source", source)) if v}}
        text = write({**header, **{name: table for name, table in tables.items() if table}})
        object.__setattr__(self, "resolved", pipeline.loads(text, "<python>"))

    @staticmethod
    def of(resolved: model_room.Model) -> Model:
        """Return the face of an already resolved model."""
        model = object.__new__(Model)
        object.__setattr__(model, "resolved", resolved)
        return model

    def __repr__(self) -> str:
        names = ", ".join("/".join(pair) for pair in self.resolved.transfer_functions[:SHOWN_PAIRS])
        more = ", ..." if len(self.resolved.transfer_functions) > SHOWN_PAIRS else ""
        return f"<Model {self.title or 'without title'}: {names}{more}>"

    @property
    def title(self) -> str:
        """What the model is."""
        return self.resolved.title

    @property
    def parameters(self) -> tuple[model_room.Parameter, ...]:
        """The parameters in declared order, with exact values in SI units."""
        return self.resolved.parameters

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs."""
        return tuple(i.name for i in self.resolved.inputs)

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs."""
        return tuple(o.name for o in self.resolved.outputs)

    def transfer_function(self, output: str, input: str) -> TransferFunction:
        """Derive output over input.

        Raises
        ------
        UsageError
            SF902 when there is no such output or input.
        ModelError
            SF30x when the equations are singular, with the reason.
        """
        (pair,) = pipeline.pick_pairs(self.resolved, [f"{output}/{input}"])
        return TransferFunction(pipeline.derive_all(self.resolved, [pair])[0])

    def transfer_functions(self) -> tuple[TransferFunction, ...]:
        """Derive every output over every input, sharing one elimination."""
        return tuple(TransferFunction(tf) for tf in pipeline.derive_all(self.resolved))

    def export_numpy(self) -> str:
        """Return a numpy module with a function per transfer function."""
        return self._export("numpy")

    def export_latex(self) -> str:
        """Return a standalone LaTeX document of the model."""
        return self._export("latex")

    def _export(self, target: str) -> str:
        from symflex.emit.exporters import EXPORTERS  # the numeric exporters import numpy

        return EXPORTERS[target].export(self.resolved, pipeline.derive_all(self.resolved)).text


def load(path: str | Path) -> Model:
    """Read a specification file.

    Raises
    ------
    SpecError
        With every problem of the file as ``file:line:col``.
    """
    return Model.of(pipeline.load(path))


def loads(text: str, name: str = "<string>") -> Model:
    """Read a specification given as text; ``name`` is what messages call it."""
    return Model.of(pipeline.loads(text, name))


@dataclass(frozen=True)
class Form:
    """A transfer function arranged for print, as SymPy expressions and as text.

    Parameters
    ----------
    source : TransferFunction
        The transfer function.
    printed : PrintedForm
        Its arrangement.
    """

    source: transfer_room.TransferFunction
    printed: PrintedForm

    @property
    def name(self) -> str:
        """The form's name."""
        return self.printed.name

    @cached_property
    def _symbols(self) -> dict[str, sympy.Symbol]:
        return symbols_of(self.source.model)

    def _sympy(self, expression: Expression) -> sympy.Expr:
        return to_sympy(expression, self._symbols)

    @property
    def num(self) -> sympy.Expr:
        """Numerator."""
        return self._sympy(self.printed.num)

    @property
    def den(self) -> sympy.Expr:
        """Denominator."""
        return self._sympy(self.printed.den)

    @property
    def expr(self) -> sympy.Expr:
        """Numerator over denominator."""
        return self.num / self.den

    @property
    def where(self) -> tuple[tuple[sympy.Symbol, sympy.Expr], ...]:
        """The closed names that occur, with what they stand for."""
        return tuple((self._sympy(Name(n)), self._sympy(e)) for n, e in self.printed.where)

    def latex(self) -> str:
        """Return the equation in LaTeX."""
        from symflex.emit.latex import inline_latex

        return inline_latex(self.source, self.printed)

    def __repr__(self) -> str:
        return f"<Form {self.name} of {self.source.name}>"

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {self.latex()}$"

    def __str__(self) -> str:
        return form_text(self.source, self.printed)


@dataclass(frozen=True)
class TransferFunction:
    """An exact transfer function; its parts are SymPy expressions in the shortest form."""

    exact: transfer_room.TransferFunction

    @property
    def name(self) -> str:
        """``OUT/IN``."""
        return self.exact.name

    @property
    def quantity(self) -> str:
        """Receptance, mobility, accelerance, impedance, ..."""
        return self.exact.quantity

    @property
    def unit(self) -> str:
        """SI unit, empty when unknown."""
        return self.exact.unit

    @property
    def is_distributed(self) -> bool:
        """True when waves or delays make the function transcendental, with infinitely many poles or zeros."""
        return self.exact.is_distributed

    @cached_property
    def _shortest(self) -> Form:
        return self.form()

    @property
    def num(self) -> sympy.Expr:
        """Numerator of the shortest form."""
        return self._shortest.num

    @property
    def den(self) -> sympy.Expr:
        """Denominator of the shortest form."""
        return self._shortest.den

    @property
    def expr(self) -> sympy.Expr:
        """Numerator over denominator; closed names are explained by :attr:`where`."""
        return self._shortest.expr

    @property
    def where(self) -> tuple[tuple[sympy.Symbol, sympy.Expr], ...]:
        """The definitions that occur in :attr:`expr`."""
        return self._shortest.where

    @property
    def hidden(self) -> tuple[tuple[sympy.Expr, int], ...]:
        """The factors in s that cancelled, with multiplicity: uncontrollable or unobservable modes."""
        from symflex.emit.forms import hidden_expressions

        symbols = symbols_of(self.exact.model)
        return tuple((to_sympy(e, symbols), m) for e, m in hidden_expressions(self.exact))

    def form(self, name: str | None = None, digits: int = 6) -> Form:
        """Return the function in one of the forms of ``symflex derive``.

        ``polynomial``, ``monic``, ``factored``, ``zpk`` and ``definitions`` for rational functions,
        ``hyperbolic``, ``krylov``, ``vaughan``, ``factored`` and ``polynomial`` for those of beams, rods and
        delays, ``frequency`` for all.

        Parameters
        ----------
        name : str, optional
            The shortest symbolic form when missing.
        digits : int
            Significant digits of ``zpk``.
        """
        return Form(self.exact, print_form(self.exact, name, digits))

    def latex(self, form: str | None = None) -> str:
        """Return the equation in LaTeX."""
        return self.form(form).latex()

    def to_json_dict(self, form: str | None = None) -> dict[str, object]:
        """Return the transfer function as ``symflex derive --json`` lists it."""
        return derive_json(self.exact, print_form(self.exact, form))

    def bind(self, **values: Number) -> BoundTransferFunction:
        """Return the function with the declared values, or the given ones in their place.

        Numbers are in SI units; strings may carry a unit, ``l="80 cm"``.

        Raises
        ------
        ModelError
            SF229 when a parameter has no value.
        UsageError
            SF902 for an unknown parameter.
        """
        return BoundTransferFunction(pipeline.bind(self.exact, values))

    def sensitivity_formula(self, parameter: str, of: str = "pole") -> tuple[sympy.Expr, sympy.Expr]:
        """Return numerator and denominator of ds/dp for a pole s, a formula in s and the parameters.

        With D the denominator it is ``-(dD/dp)/(dD/ds)``, valid at every simple root of D that moves with the
        parameter; those that do not are left out of D. The derivative goes through all definitions,
        wavenumbers and kernels, whose names are replaced by what they stand for.

        Parameters
        ----------
        parameter : str
            A parameter of the model.
        of : str
            ``"pole"``, or ``"zero"`` for the numerator's roots.

        Raises
        ------
        UsageError
            SF902 for an unknown parameter, or where wavenumbers have no formula.
        """
        from symflex.emit.sensitivity_formula import sensitivity_formula  # needs all of SymPy

        symbols = symbols_of(self.exact.model)
        if parameter not in symbols or of not in ("pole", "zero"):
            what = f"parameter '{parameter[:64]}'" if parameter not in symbols else f"root called '{of[:64]}'"
            raise UsageError(Diagnostic("SF902", f"there is no {what}", None, nearest(parameter, symbols)))
        form = self.form("hyperbolic") if self.is_distributed else self._shortest
        if form.printed.laws:
            message = f"the waves of {self.name} have no formula, and so neither have its sensitivities"
            raise UsageError(Diagnostic("SF902", message, None, "use sensitivities() of the bound function"))
        part = form.den if of == "pole" else form.num
        return sensitivity_formula(part, form.where, to_sympy(Name("s"), symbols), symbols[parameter])

    def __repr__(self) -> str:
        if self.is_distributed:
            return f"<TransferFunction {self.name}: {self.quantity}, distributed>"
        zeros, poles = ("infinitely many" if n is None else n for n in counts_of(self.exact))
        return f"<TransferFunction {self.name}: {self.quantity}, {zeros} zeros, {poles} poles>"

    def _repr_latex_(self) -> str:
        return self._shortest._repr_latex_()

    def __str__(self) -> str:
        return str(self._shortest)


@dataclass(frozen=True)
class Root:
    """A root s [rad/s].

    Parameters
    ----------
    certified_root : symflex.roots.Root
        The enclosure and what was proved about it.
    """

    certified_root: roots_room.Root

    @property
    def re(self) -> mpmath.mpf:
        """Real part [rad/s], midpoint of its enclosure; exactly zero on the imaginary axis."""
        return to_mpmath(self.certified_root.re)

    @property
    def im(self) -> mpmath.mpf:
        """Imaginary part [rad/s]; exactly zero for a real root."""
        return to_mpmath(self.certified_root.im)

    @property
    def value(self) -> mpmath.mpc:
        """The midpoint of the enclosure [rad/s], with all its digits whatever the working precision.

        Arithmetic with it rounds to ``mpmath.mp.dps`` digits, as mpmath does; see ``mpmath.workdps``.
        """
        return to_complex_mpmath(self.certified_root.enclosure())

    @property
    def radius(self) -> mpmath.mpf:
        """A bound on the distance from :attr:`value` to the root [rad/s]."""
        root = self.certified_root
        with roots_room.precision(64):
            return to_mpmath((root.re.rad() ** 2 + root.im.rad() ** 2).sqrt().upper())

    @property
    def multiplicity(self) -> int:
        """How often the root counts."""
        return self.certified_root.multiplicity

    @property
    def certified(self) -> bool:
        """False when several roots could not be told apart inside the enclosure, or nothing is proved."""
        return self.certified_root.certified

    @property
    def on_imaginary_axis(self) -> bool:
        """True when the real part is proved to be zero."""
        return self.certified_root.on_imaginary_axis

    @property
    def is_real(self) -> bool:
        """True when the imaginary part is proved to be zero."""
        return self.certified_root.is_real

    @property
    def frequency_hz(self) -> float:
        """Natural frequency abs(s)/(2 pi) [Hz]."""
        return self.certified_root.frequency_hz()

    @property
    def damping_ratio(self) -> float | None:
        """``-re/abs(s)``, None at the origin."""
        return self.certified_root.damping_ratio()

    def __repr__(self) -> str:
        printed = self.certified_root.decimal(SHOWN_DIGITS)
        times = f", {self.multiplicity} times" if self.multiplicity > 1 else ""
        return f"<Root {printed.re}, {printed.im} j{times}, radius {printed.radius}>"

    def __complex__(self) -> complex:
        return complex(self.re, self.im)


@dataclass(frozen=True)
class Residue:
    """How much of a mode a transfer function holds: its principal part at a pole p.

    Parameters
    ----------
    principal : symflex.rational.Residue
        The enclosures.
    """

    principal: rational_room.Residue

    @property
    def pole(self) -> Root:
        """The pole p."""
        return Root(self.principal.root)

    @property
    def value(self) -> mpmath.mpc:
        """The coefficient of ``1/(s - p)``, midpoint of its enclosure; in the function's unit times rad/s."""
        return to_complex_mpmath(self.principal.value)

    @property
    def radius(self) -> mpmath.mpf:
        """A bound on the distance from :attr:`value` to the residue; if unproved, an estimate."""
        return to_mpmath(self.principal.value.rad())

    @property
    def coefficients(self) -> tuple[mpmath.mpc, ...]:
        """The coefficients of ``1/(s - p)``, ``1/(s - p)^2``, ... up to the pole's multiplicity."""
        return tuple(map(to_complex_mpmath, self.principal.coefficients))

    @property
    def certified(self) -> bool:
        """Whether the pole, and with it the residue, is proved."""
        return not self.principal.is_estimate

    def __repr__(self) -> str:
        re, im = (mpmath.nstr(part, SHOWN_DIGITS) for part in (self.value.real, self.value.imag))
        return f"<Residue {re}, {im} j at {complex(self.pole):.6g}, radius {mpmath.nstr(self.radius, 2)}>"

    def __complex__(self) -> complex:
        return complex(self.value)


@dataclass(frozen=True)
class Sensitivity:
    """How a root s moves with a parameter p; numbers are midpoints of proved enclosures.

    Parameters
    ----------
    moved : symflex.sensitivity.Sensitivity
        The enclosures.
    """

    moved: sensitivity_room.Sensitivity

    @property
    def kind(self) -> str:
        """``pole`` or ``zero``."""
        return self.moved.kind

    @property
    def root(self) -> Root:
        """The root."""
        return Root(self.moved.root)

    @property
    def parameter(self) -> str:
        """The parameter's name."""
        return self.moved.parameter.name

    @property
    def status(self) -> str:
        """``certified``, ``multiple`` (there is no derivative) or ``undecided``."""
        return self.moved.status

    @property
    def derivative(self) -> mpmath.mpc | None:
        """ds/dp [rad/s per unit of the parameter]; ``None`` where there is none."""
        return None if self.moved.derivative is None else to_complex_mpmath(self.moved.derivative)

    @property
    def radius(self) -> mpmath.mpf | None:
        """A bound on the distance from :attr:`derivative` to the true one."""
        derivative = self.moved.derivative
        if derivative is None:
            return None
        with roots_room.precision(64):
            return to_mpmath((derivative.real.rad() ** 2 + derivative.imag.rad() ** 2).sqrt().upper())

    @property
    def normalised(self) -> mpmath.mpc | None:
        """``(p/s) ds/dp``; its real part is ``(p/f) df/dp``. ``None`` at s = 0."""
        normalised = self.moved.normalised
        return None if normalised is None else to_complex_mpmath(normalised)

    @property
    def frequency(self) -> mpmath.mpf | None:
        """df/dp [Hz per unit of the parameter] of the natural frequency ``f = abs(s)/(2 pi)``."""
        frequency = self.moved.frequency
        return None if frequency is None else to_mpmath(frequency)

    @property
    def damping_ratio(self) -> mpmath.mpf | None:
        """dzeta/dp [1 per unit of the parameter]; ``None`` for real roots."""
        damping_ratio = self.moved.damping_ratio
        return None if damping_ratio is None else to_mpmath(damping_ratio)

    def __repr__(self) -> str:
        if self.moved.derivative is None:
            return f"<Sensitivity of a {self.kind} to {self.parameter}: {self.status}>"
        derivative = self.moved.derivative
        printed = roots_room.decimals(derivative.real, derivative.imag, SHOWN_DIGITS)
        return f"<Sensitivity of a {self.kind} to {self.parameter}: {printed.re}, {printed.im} j>"


Mode = int | Root | roots_room.Root | roots_room.HiddenRoot


@dataclass(frozen=True)
class ModeShape:
    """The motion of everything at one pole, up to a common factor; the largest displacement found is 1.

    Displacements are those of nodes in translation, along beams, rods and strings, and of each field's first
    unknown [m]; where none of them moves, the largest angle is 1, else the largest voltage. At an undamped
    pole a shape is real, as far as all that moves depends on s^2 alone.

    Parameters
    ----------
    enclosed : symflex.modes.ModeShape
        With a ball around every amplitude.

    Examples
    --------
    >>> model = Model(
    ...     elements={
    ...         "bar": {"type": "rod", "between": ["ground", "x"], "E": "1 Pa", "A": "1 m^2",
    ...                 "rho": "1 kg/m^3", "l": "1 m"},
    ...     },
    ...     inputs={"F": {"force": "x"}},
    ...     outputs={"X": "x"},
    ... )
    >>> shape = model.transfer_function("X", "F").bind().mode_shape(1)  # sin(pi x/2)
    >>> shape.names, shape.along("bar", [0, 0.5, 1]).round(6)
    (('x', 'bar.f_a', 'bar.f'), array([0.      , 0.707107, 1.      ]))
    """

    enclosed: modes_room.ModeShape

    @property
    def pole(self) -> Root:
        """Where."""
        return Root(self.enclosed.pole)

    @property
    def frequency_hz(self) -> float:
        """Natural frequency [Hz]."""
        return self.enclosed.pole.frequency_hz()

    @property
    def damping_ratio(self) -> float | None:
        """``-re/abs(s)`` of the pole, None at the origin."""
        return self.enclosed.pole.damping_ratio()

    @property
    def certified(self) -> bool:
        """True when the pole is proved and has one shape: every amplitude lies within its radius."""
        return self.enclosed.certified

    @property
    def reference(self) -> str:
        """What is 1: a node, or ``beam(0.3)``, a place along an element or field."""
        return self.enclosed.reference

    @property
    def is_real(self) -> bool:
        """True when the pole is undamped and everything moves in phase."""
        return self.enclosed.is_real

    @property
    def names(self) -> tuple[str, ...]:
        """The nodes, element quantities and signals that have an amplitude."""
        return tuple(motion.name for motion in self.enclosed.motions)

    def __getitem__(self, name: str) -> mpmath.mpc:
        """Return the amplitude of a node, element quantity or signal; a planar node's is its deflection.

        Raises
        ------
        UsageError
            SF902 when there is none of that name.
        """
        value = self.enclosed.motion(name).value
        return mpmath.mp.make_mpc((to_mpmath(value.real)._mpf_, to_mpmath(value.imag)._mpf_))

    def radius(self, name: str) -> mpmath.mpf:
        """Return a bound on the distance from ``shape[name]`` to the amplitude; an estimate if unproved."""
        return _radius(self.enclosed.motion(name).value)

    @property
    def distributed(self) -> tuple[str, ...]:
        """The beams, rods, shafts, strings and fields."""
        return tuple(part.name for part in self.enclosed.distributed)

    def quantities(self, part: str) -> tuple[str, ...]:
        """Return what is known along a part: ``y theta f tau`` of a beam, ``w w' w'' w'''`` of a field."""
        return self.enclosed.along(part).states

    def domain(self, part: str) -> tuple[float, float]:
        """Return where a part begins and ends [m]; an element begins at 0."""
        found = self.enclosed.along(part)
        with roots_room.precision(found.bits):
            return float(found.start.mid()), float((found.start + found.length).mid())

    def along(
        self, part: str, x: ArrayLike, quantity: str | None = None
    ) -> NDArray[np.float64] | NDArray[np.complex128]:
        """Return a quantity of a distributed part at x [m]; real when the shape is.

        Parameters
        ----------
        part : str
            A distributed element or a field.
        x : array_like
            Places within :meth:`domain`.
        quantity : str, optional
            One of :meth:`quantities`; the first one, a displacement, by default. ``theta`` is a beam's slope
            (in the Timoshenko theory the rotation of its section), ``f`` and ``tau`` are the force and moment
            that the part beyond x exerts on the part before it.

        Raises
        ------
        UsageError
            SF902 no such part or quantity; SF240 a place outside the domain.
        """
        import numpy as np

        places = np.asarray(x, dtype=float)
        balls = self._balls(part, places, quantity)
        values = np.array([complex(float(b.real.mid()), float(b.imag.mid())) for b in balls], dtype=complex)
        values = values.reshape(places.shape)
        return values.real if self.is_real else values

    def radius_along(self, part: str, x: ArrayLike, quantity: str | None = None) -> NDArray[np.float64]:
        """Return bounds on the error of :meth:`along`, but for the rounding to double precision."""
        import numpy as np

        places = np.asarray(x, dtype=float)
        found = [float(_radius(ball)) for ball in self._balls(part, places, quantity)]
        return np.array(found, dtype=float).reshape(places.shape)

    def _balls(self, part: str, places: NDArray[np.float64], quantity: str | None) -> list[acb]:
        found = self.enclosed.along(part)
        position = found.position(quantity)
        start, end = self.domain(part)
        slack = END_TOLERANCE * (end - start)
        for place in places.ravel():
            if not start - slack <= place <= end + slack:
                message = f"x = {place:g} lies outside '{part}', which reaches from {start:g} to {end:g}"
                raise UsageError(Diagnostic("SF240", message))
        return [found.at(Fraction(float(place)))[position] for place in places.ravel()]

    def __repr__(self) -> str:
        damping = self.damping_ratio
        damped = f", damping ratio {damping:.4g}" if damping else ""
        return f"<ModeShape at {self.frequency_hz:.6g} Hz{damped}, {self.reference} = 1>"


def _radius(ball: acb) -> mpmath.mpf:
    with roots_room.precision(64):
        return to_mpmath((ball.real.rad() ** 2 + ball.imag.rad() ** 2).sqrt().upper())


def _mode(mode: Mode) -> int | roots_room.Root:
    if isinstance(mode, Root):
        return mode.certified_root
    return mode.root if isinstance(mode, roots_room.HiddenRoot) else mode


@dataclass(frozen=True)
class BoundTransferFunction:
    """A transfer function with numbers: evaluates, and finds its poles and zeros.

    Each is proved. A distributed system has infinitely many; they are found in a region.
    """

    bound: transfer_room.BoundTransferFunction

    @property
    def name(self) -> str:
        """``OUT/IN``."""
        return self.bound.name

    @property
    def is_distributed(self) -> bool:
        """True when the function is transcendental."""
        return self.bound.is_distributed

    def __repr__(self) -> str:
        return f"<BoundTransferFunction {self.name}>"

    def __call__(self, s: ArrayLike) -> complex | NDArray[np.complex128]:
        """Return the value at s [rad/s], a number or an array, to double precision."""
        import numpy as np

        points = np.asarray(s, dtype=complex)
        if points.ndim == 0:
            return self.bound(complex(points))
        values = np.array([self.bound(complex(p)) for p in points.ravel()], dtype=complex)
        return values.reshape(points.shape)

    def frequency_response(self, omega: ArrayLike) -> FrequencyResponse:
        """Return the response at real angular frequencies [rad/s]."""
        from symflex.response import respond

        return respond(self.bound, omega)

    def poles(
        self, modes: int | None = None, *, band: tuple[float, float] | None = None, digits: int = 15
    ) -> tuple[Root, ...]:
        """Return the poles by natural frequency, both members of each conjugate pair.

        Parameters
        ----------
        modes : int, optional
            Only the lowest modes, with the roots at the origin. For a distributed system the model's
            ``[analysis]`` decides when neither modes nor band are given, and else the number is five.
        band : (float, float), optional
            Only natural frequencies in this band [Hz].
        digits : int
            Correct significant digits.
        """
        return tuple(Root(r) for r in pipeline.roots(self.bound, _region(modes, band), digits).poles)

    def zeros(
        self, modes: int | None = None, *, band: tuple[float, float] | None = None, digits: int = 15
    ) -> tuple[Root, ...]:
        """Return the zeros; see :meth:`poles`."""
        return tuple(Root(r) for r in pipeline.roots(self.bound, _region(modes, band), digits).zeros)

    def pole_zero_map(
        self,
        digits: int = 15,
        *,
        modes: int | None = None,
        band: tuple[float, float] | None = None,
        region: tuple[float, float, float, float] | None = None,
    ) -> roots_room.PoleZeroMap:
        """Return poles, zeros and hidden modes with their certificate.

        Parameters
        ----------
        digits : int
            Correct significant digits.
        modes : int, optional
            Only the lowest modes, with the roots at the origin.
        band : (float, float), optional
            Only natural frequencies in this band [Hz].
        region : (float, float, float, float), optional
            Only the rectangle ``(re_low, re_high, im_low, im_high)`` [rad/s].
        """
        return pipeline.roots(self.bound, _region(modes, band, region), digits)

    def residues(
        self, modes: int | None = None, *, band: tuple[float, float] | None = None, digits: int = 15
    ) -> tuple[Residue, ...]:
        """Return the residues at the poles, in their order; see :meth:`poles`.

        Parameters
        ----------
        modes : int, optional
            Only at the poles of the lowest modes and at the origin.
        band : (float, float), optional
            Only at poles with natural frequencies in this band [Hz].
        digits : int
            Correct significant digits.

        Raises
        ------
        UncertifiedError
            SF405 when poles cannot be told apart, or the behaviour at one cannot be told.
        """
        return tuple(Residue(r) for r in pipeline.residues(self.bound, _region(modes, band), digits))

    def rational(
        self,
        modes: int | None = None,
        form: str = "product",
        *,
        band: tuple[float, float] | None = None,
    ) -> rational_room.RationalApproximation:
        """Return a rational approximation, with its error along the imaginary axis.

        Parameters
        ----------
        modes : int, optional
            How many modes are kept, besides roots at the origin. By default those up to the end of ``band``,
            else as many as the model's ``[analysis]`` says, else five.
        form : str
            ``product``: the poles and zeros, right to the leading order at s = 0; ``modal``: the principal
            parts at the poles, and a constant that makes the finite part at s = 0 exact.
        band : (float, float), optional
            Where the error is stated [Hz].

        Raises
        ------
        UsageError
            SF902 for an unknown form, SF227 for a band that is empty or not positive.
        UncertifiedError
            SF405 when residues, or the behaviour near s = 0, cannot be told.
        """
        return pipeline.rational(self.bound, modes, form, band)

    def sensitivities(
        self,
        modes: int | None = None,
        *,
        parameters: Sequence[str] = (),
        band: tuple[float, float] | None = None,
        digits: int = 15,
    ) -> tuple[Sensitivity, ...]:
        """Return how poles, and then zeros, move with parameters.

        Parameters
        ----------
        modes, band : optional
            As for :meth:`poles`.
        parameters : sequence of str
            All on which the function depends when none is given.
        digits : int
            Correct significant digits of every derivative.

        Raises
        ------
        UsageError
            SF902 for an unknown parameter.
        """
        found = pipeline.roots(self.bound, _region(modes, band), digits)
        model = self.bound.source.model
        return tuple(
            Sensitivity(m) for m in pipeline.sensitivities(model, self.bound, found, parameters, digits)
        )

    def explain_zeros(
        self, modes: int | None = None, *, band: tuple[float, float] | None = None, digits: int = 15
    ) -> ZeroExplanation:
        """Return what the zeros are the poles of; print it to read it.

        Parameters
        ----------
        modes, band, digits
            As for :meth:`zeros`: which zeros are spoken of one by one.
        """
        found = pipeline.roots(self.bound, _region(modes, band), digits)
        return pipeline.explain_zeros(self.bound.source.model, self.bound, found)

    def mode_shape(self, mode: Mode, digits: int = 15) -> ModeShape:
        """Return how everything moves in one mode; the largest displacement is 1.

        The shape is taken from the model's equations, not from the transfer function: hidden modes have one.

        Parameters
        ----------
        mode : int, Root or HiddenRoot
            1 is the lowest pole other than 0, 2 the next: a conjugate pair or a real pole is one mode, and
            one of multiplicity m counts as m. 0 is the rigid-body motion at s = 0. Or a root: a pole, or the
            root of a hidden mode.
        digits : int
            Correct digits, relative to the largest displacement.

        Raises
        ------
        UsageError
            SF902 when there is no such mode; SF904 when a pole has several shapes, see :meth:`mode_shapes`.
        UncertifiedError
            SF406 when the equations cannot be solved at the pole.
        """
        from symflex.modes import mode_shape

        return ModeShape(mode_shape(self.bound, _mode(mode), digits))

    def mode_shapes(self, mode: Mode, digits: int = 15) -> tuple[ModeShape, ...]:
        """Return all independent shapes of a mode's pole: more than one where equal parts move alike.

        Several are a basis: in each, one of as many places is at 1 and the others are at rest, before the
        largest displacement is made 1. See :meth:`mode_shape`.
        """
        from symflex.modes import mode_shapes

        return tuple(ModeShape(shape) for shape in mode_shapes(self.bound, _mode(mode), digits))

    def dcgain(self) -> float:
        """Return the limit for s -> 0 from the right, possibly infinite."""
        return self.bound.limit_at_zero()


def _region(
    modes: int | None,
    band: tuple[float, float] | None,
    rectangle: tuple[float, float, float, float] | None = None,
) -> roots_room.Region | None:
    if sum(choice is not None for choice in (modes, band, rectangle)) > 1:
        raise UsageError(Diagnostic("SF902", "give only one of modes, band and region"))
    if modes is not None:
        return roots_room.Modes(modes)
    if band is not None:
        return roots_room.Band(*map(_exact, band))
    return None if rectangle is None else roots_room.Rectangle(*map(_exact, rectangle))


def _exact(number: float) -> Fraction:
    """Return the shortest decimal that prints a number."""
    return Fraction(Decimal(repr(float(number))))
