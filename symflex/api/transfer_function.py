"""Exact transfer functions, expanded or nested, in symbols and with numbers, and their forms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, NoReturn

from symflex import pipeline
from symflex import transfer as transfer_layer
from symflex.api.analyses import Analyses
from symflex.api.face import face_of
from symflex.api.response import TimeResponse
from symflex.api.state_space import StateSpace
from symflex.api.toolboxes import Toolboxes, refuse_attribute
from symflex.errors import counted, nearest, refused
from symflex.expressions import Expression, Name
from symflex.library.elements import LineElement
from symflex.model import Model, with_numbers
from symflex.model.loss_factors import check_causal
from symflex.options import DeriveOptions, Stated, checked_digits
from symflex.print.forms import PrintedForm, counts_of, hidden_expressions, print_form
from symflex.print.json_format import derive_json
from symflex.print.sympy import symbols_of, to_sympy
from symflex.print.text import form_text
from symflex.state_space import not_rational
from symflex.symbolic.groups import dimensionless_of
from symflex.symbolic.limits import SymbolicForm, limits_of
from symflex.transfer import BoundNested, bind_nested
from symflex.transfer.double_value import FIRST_BITS

if TYPE_CHECKING:
    import numpy as np
    import sympy
    from numpy.typing import ArrayLike, NDArray

    from symflex.analysis.input_shaping import InputShaper


Number = int | float | Fraction | Decimal | str


@dataclass(frozen=True)
class Form:
    """A printed form of a transfer function, as SymPy expressions and as text.

    Parameters
    ----------
    source : TransferFunction or NestedTransferFunction
        The transfer function.
    printed : PrintedForm
        Its arrangement.
    """

    source: transfer_layer.AnyTransferFunction
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
        """The names that the form introduces or keeps, with their expressions."""
        return tuple((self._sympy(Name(n)), self._sympy(e)) for n, e in self.printed.where)

    @property
    def closed(self) -> tuple[tuple[sympy.Expr, sympy.Expr], ...]:
        """Closed forms of tapered members, ``Z_11(l)``, ``besseli(0, q)``, then the names in them."""
        return tuple((self._sympy(function), self._sympy(e)) for function, e in self.printed.closed)

    @property
    def statement(self) -> tuple[str, ...]:
        """What is proved of a form that is not exact, a sentence an entry."""
        return self.printed.approximation.said if self.printed.approximation else ()

    def latex(self, width: float | str | None = None) -> str:
        """Return the equation in LaTeX: on one line, or as a display for a column of a width.

        ``width`` is in mm, or ``"ieee"`` or ``"a4"``.
        """
        from symflex.print.latex import inline_latex, transfer_function_latex, width_of

        if width is None:
            return inline_latex(self.source, self.printed)
        return transfer_function_latex(self.source, self.printed, width_mm=width_of(width))

    def __repr__(self) -> str:
        return f"<Form {self.name} of {self.source.name}>"

    def _repr_latex_(self) -> str | None:
        """Return the equation for a notebook, in lines where one would be too long; None for a huge one."""
        from symflex.print.latex import notebook_latex

        latex = notebook_latex(self.source, self.printed)
        return None if latex is None else f"$\\displaystyle {latex}$"

    def __str__(self) -> str:
        return form_text(self.source, self.printed)


@dataclass(frozen=True)
class _Derived:
    """What a transfer function tells of itself, however it was derived."""

    exact: transfer_layer.AnyTransferFunction

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

    @cached_property
    def _shortest(self) -> Form:
        return Form(self.exact, print_form(self.exact))

    @property
    def num(self) -> sympy.Expr:
        """Numerator of the shortest form, in the names of :attr:`where`."""
        return self._shortest.num

    @property
    def den(self) -> sympy.Expr:
        """Denominator of the shortest form, in the names of :attr:`where`."""
        return self._shortest.den

    @property
    def expr(self) -> sympy.Expr:
        """Numerator over denominator; closed names are explained by :attr:`where`."""
        return self._shortest.expr

    @property
    def where(self) -> tuple[tuple[sympy.Symbol, sympy.Expr], ...]:
        """The definitions that occur, and the sub-impedances in order, each in terms of earlier ones."""
        return self._shortest.where

    def _repr_latex_(self) -> str | None:
        return self._shortest._repr_latex_()

    def __str__(self) -> str:
        return str(self._shortest)

    def __reduce__(self) -> tuple[object, ...]:
        pair = self.exact.output.name, self.exact.input.name
        return _derive_again, (self.exact.model, pair, not self.exact.is_reduced)

    def __call__(self, *_: object) -> NoReturn:
        """Say that only numbers have a value."""
        raise TypeError(f"{self.name} has no numbers yet: call bind() first, as in G.bind()(2j)")

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> NoReturn:
            """Say which attributes a function has once it has numbers."""
            refuse_attribute(self, name, BoundTransferFunction)


@dataclass(frozen=True)
class TransferFunction(_Derived):
    """An exact transfer function; its parts are SymPy expressions in the shortest form."""

    exact: transfer_layer.TransferFunction

    @property
    def is_distributed(self) -> bool:
        """True when waves or delays make the function transcendental, with infinitely many poles or zeros."""
        return not self.exact.is_rational

    @property
    def hidden(self) -> tuple[tuple[sympy.Expr, int], ...]:
        """The factors in s that cancelled, with multiplicity: uncontrollable or unobservable modes."""
        symbols = symbols_of(self.exact.model)
        return tuple((to_sympy(e, symbols), m) for e, m in hidden_expressions(self.exact))

    def form(self, name: str | None = None, digits: int = 6) -> Form:
        """Return the function in one of the forms of ``symflex derive``.

        ``polynomial``, ``monic``, ``constant``, ``factored``, ``zpk`` and ``definitions`` for rational
        functions; ``hyperbolic``, ``krylov``, ``vaughan``, ``factored`` and ``polynomial`` for those of
        beams, rods and delays; ``frequency`` for all.

        Parameters
        ----------
        name : str, optional
            The shortest symbolic form when missing.
        digits : int
            Significant digits of ``zpk``.
        """
        return Form(self.exact, print_form(self.exact, name, digits))

    def latex(self, form: str | None = None, *, width: float | str | None = None) -> str:
        """Return the equation in LaTeX; see :meth:`Form.latex`."""
        return self.form(form).latex(width)

    def to_json_dict(self, form: str | None = None) -> dict[str, object]:
        """Return the transfer function as ``symflex derive --json`` lists it."""
        return derive_json(self.exact, print_form(self.exact, form))

    def bind(self, **values: Number) -> BoundTransferFunction:
        """Return the function with the declared values, or with the given ones.

        Numbers are in SI units; strings may carry a unit, ``l="80 cm"``.

        Raises
        ------
        ModelError
            SF229 when a parameter has no value.
        UsageError
            SF902 for an unknown parameter.
        """
        return BoundTransferFunction(pipeline.bind(self.exact, values))

    def limits(self) -> SymbolicForm:
        r"""Return the leading terms for s -> 0 and s -> infinity: what ``symflex derive --limits`` prints.

        Examples
        --------
        >>> from symflex import loads
        >>> loop = loads('symflex = 1\nparameters.T = "2 s"\ninputs.u = {}\noutputs.y = "u/(T*s + 1)"')
        >>> limits = loop.transfer_function("y", "u").limits()
        >>> limits.expr("s -> 0"), limits.expr("s -> infinity"), limits.row("corner frequency").value
        (1, 1/(T*s), 0.5)
        """
        return limits_of(self.exact)

    def dimensionless(self) -> SymbolicForm:
        r"""Return the function in dimensionless groups: what ``symflex derive --dimensionless`` prints.

        Examples
        --------
        >>> from symflex import loads
        >>> loop = loads('symflex = 1\nparameters.T = "2 s"\ninputs.u = {}\noutputs.y = "u/(T*s + 1)"')
        >>> groups = loop.transfer_function("y", "u").dimensionless()
        >>> groups.expr("y/u"), groups.expr("S"), groups.expr("scale")
        (1/(S + 1), T*s, 1)
        """
        return dimensionless_of(self.exact)

    def short(self, bound: Stated = "1 %", spread: Stated | None = None) -> Form:
        """Return a shorter formula, with the changes of coefficients, roots and magnitude that are proved.

        No coefficient of s changes by more than ``bound``, ``0.01`` or ``"1 %"``, at the values or over the
        spread of each parameter, or ``spread`` of all. Raises ModelError: SF229 when one has no value.

        Examples
        --------
        >>> from symflex import Model
        >>> parts = {"m": "2 kg", "d": "1 g", "b": "3 kg/s"}
        >>> drag = Model(parameters=parts, inputs={"F": {}}, outputs={"V": "F/((m + d)*s + b)"})
        >>> drag.transfer_function("V", "F").short().den
        b + m*s
        """
        from symflex.symbolic.short import approximation  # imports the search of roots

        return Form(*approximation(self.exact, DeriveOptions(short=bound, spread=spread)))

    def order(self, power: int) -> Form:
        """Return a function of beams, rods and delays as a rational one, exact up to a power of s, 0 to 12.

        At the driven point of a compliance it is the dynamic stiffness that is expanded. Raises UsageError:
        SF902 where wavenumbers do not vanish at s = 0.
        """
        from symflex.symbolic.short import approximation

        return Form(*approximation(self.exact, DeriveOptions(order=power)))

    def state_space(self, *, minimal: bool = False) -> StateSpace:
        """Return state equations of the model's network with SymPy matrices.

        Parameters
        ----------
        minimal : bool
            Leave out states that are uncontrollable or unobservable at almost all values of the
            parameters.

        Raises
        ------
        ModelError
            SF235 for beams, rods and delays, SF236 when the function grows with s.
        BudgetError
            SF502 when the matrices become too large.
        """
        pair = (self.exact.output.name, self.exact.input.name)
        return StateSpace.of(self.exact.model, [pair], minimal=minimal)

    def to_sympy(self) -> sympy.Basic:
        """Return a ``sympy.physics.control.TransferFunction`` of ``s`` with the parameters as symbols.

        Raises
        ------
        ModelError
            SF235 for beams, rods and delays.
        BudgetError
            SF501 when numerator or denominator are too large to be multiplied out.
        """
        from symflex.print.sympy import sympy_system

        return sympy_system(self.exact)

    def sensitivity_formula(self, parameter: str, of: str = "pole") -> tuple[sympy.Expr, sympy.Expr]:
        """Return numerator and denominator of ds/dp for a pole s, a formula in s and the parameters.

        With D the denominator it is ``-(dD/dp)/(dD/ds)``, valid at every simple root of D that moves with
        the parameter; those that do not are left out of D. The derivative goes through all definitions,
        wavenumbers and kernels, whose names are replaced by their expressions.

        Parameters
        ----------
        parameter : str
            A parameter of the model.
        of : str
            ``"pole"``, or ``"zero"`` for the numerator's roots.

        Raises
        ------
        UsageError
            SF902 for an unknown parameter, or if wavenumbers have no formula.
        """
        from symflex.analysis.sensitivity.text import sensitivity_formula  # needs all of SymPy

        symbols = symbols_of(self.exact.model)
        if parameter not in symbols or of not in ("pole", "zero"):
            what = f"parameter '{parameter[:64]}'" if parameter not in symbols else f"root called '{of[:64]}'"
            raise refused(f"there is no {what}", nearest(parameter, symbols))
        form = self._shortest if self.exact.is_rational else self.form("hyperbolic")
        if form.printed.laws:
            message = f"the waves of {self.name} have no formula, so its sensitivities have none either"
            raise refused(message, "use sensitivities() of the bound function")
        part = form.den if of == "pole" else form.num
        return sensitivity_formula(part, form.where, to_sympy(Name("s"), symbols), symbols[parameter])

    def __repr__(self) -> str:
        if not self.exact.is_rational:
            return f"<TransferFunction {self.name}: {self.quantity}, distributed>"
        many = zip(counts_of(self.exact), ("zero", "pole"), strict=True)
        said = ", ".join(f"infinitely many {of}s" if n is None else counted(n, of) for n, of in many)
        return f"<TransferFunction {self.name}: {self.quantity}, {said}>"


@dataclass(frozen=True)
class NestedTransferFunction(_Derived):
    """A transfer function as a straight-line program: numerator over denominator, in named sub-impedances.

    Numerator and denominator need not be polynomials, and may have common factors. See
    :func:`symflex.transfer.derive_nested`.
    """

    exact: transfer_layer.NestedTransferFunction

    @property
    def size(self) -> int:
        """Number of operations for a value; shared ones count once."""
        return self.exact.size

    def latex(self, *, width: float | str | None = None) -> str:
        """Return the equation in LaTeX; see :meth:`Form.latex`."""
        return self._shortest.latex(width)

    def to_json_dict(self) -> dict[str, object]:
        """Return the transfer function as ``symflex derive --json`` lists it."""
        return derive_json(self.exact, print_form(self.exact))

    def bind(self, **values: Number) -> BoundNestedTransferFunction:
        """Return the function with the declared values, or with the given ones.

        Numbers are in SI units; strings may carry a unit, ``k="95 kN/m"``. The result ``H`` gives
        a value in double precision, ``H(2j)``, and arrays of values, ``H.at(s)``.

        Raises
        ------
        ModelError
            SF229 when a parameter has no value.
        UsageError
            SF902 for an unknown parameter.
        """
        bound = bind_nested(self.exact, values)
        return BoundNestedTransferFunction(bound.source, bound.values)

    def __repr__(self) -> str:
        return f"<NestedTransferFunction {self.name}, {self.size} operations>"


@dataclass(frozen=True)
class BoundTransferFunction(Toolboxes, Analyses):
    """A transfer function with numbers: its values, poles, zeros and responses.

    Poles, zeros and responses are proved. A distributed system has infinitely many poles and zeros; symflex
    finds those in a region.
    """

    bound: transfer_layer.BoundTransferFunction

    @property
    def name(self) -> str:
        """``OUT/IN``."""
        return self.bound.name

    @property
    def is_distributed(self) -> bool:
        """True when the function is transcendental."""
        return not self.bound.is_rational

    @property
    def _expanded(self) -> transfer_layer.BoundTransferFunction:
        return self.bound

    def __reduce__(self) -> tuple[object, ...]:
        source = self.bound.symbolic or self.bound.source
        return _bind_again, (TransferFunction(source), dict(self.bound.values))

    def __repr__(self) -> str:
        return f"<BoundTransferFunction {self.name}>"

    def _repr_html_(self) -> str:
        from symflex.print.html import bound_html  # only notebooks ask

        return bound_html(self.bound)

    def __call__(self, s: ArrayLike) -> complex | NDArray[np.complex128]:
        """Return the value at s [rad/s], a number or an array, to double precision."""
        return _values(self.bound.source.model, self.bound, s)

    def forced_response(
        self, times: ArrayLike, u: ArrayLike, digits: int = 12, shaper: InputShaper | None = None
    ) -> TimeResponse:
        r"""Return the response from rest to an input given by samples, joined by straight lines.

        Parameters
        ----------
        times : array_like of float, shape (n,)
            Increasing times [s] of the samples, and of the response. Times that are evenly spaced except
            for rounding count as evenly spaced.
        u : array_like of float, shape (n,)
            The input at these times. It is 0 before the first time; if it does not begin with 0, it jumps
            there.
        digits : int
            As for :meth:`step_response`.
        shaper : InputShaper, optional
            Convolves the input with its impulses.

        Raises
        ------
        UsageError
            SF811 for times that do not increase, or values that are not numbers or do not match the times.
        UncertifiedError
            SF810 as for :meth:`step_response`, and if the transfer function differentiates its input.

        Examples
        --------
        >>> from symflex import loads
        >>> integrator = loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/s"').transfer_function("y", "u")
        >>> integrator.bind().forced_response([0.0, 1.0, 3.0], [0.0, 2.0, 2.0]).values.tolist()
        [0.0, 1.0, 5.0]
        """
        from symflex.analysis.time_response import SampleTimes, exact_values, forced_response

        exactly = SampleTimes.of(times).exactly()
        given = exact_values(u, len(exactly))
        response = forced_response(self.bound, exactly, given, exactly, checked_digits(digits), shaper)
        return face_of(TimeResponse, response)


@dataclass(frozen=True, repr=False)
class BoundNestedTransferFunction(BoundNested, Toolboxes, Analyses):
    r"""A nested transfer function with numbers: values, poles and zeros, responses, and figures.

    Examples
    --------
    >>> from symflex import loads
    >>> model = loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/((s + 1)*(s + 3))"')
    >>> bound = model.nested("y", "u").bind()
    >>> round(abs(bound(1j)), 4), len(bound.bode(band=(0.01, 10)).axes)
    (0.2236, 2)
    >>> [round(float(p.re)) for p in bound.poles()], bound.step_response([1.0]).values.round(6).tolist()
    ([-1, -3], [0.157691])
    """

    def __call__(  # type: ignore[override]  # an array is answered by an array
        self, s: ArrayLike, bits: int = FIRST_BITS
    ) -> complex | NDArray[np.complex128]:
        """Return the value at s [rad/s], a number or an array, to double precision."""
        return _values(self.source.model, lambda p: BoundNested.__call__(self, p, bits), s)

    def __reduce__(self) -> tuple[object, ...]:
        return _bind_again, (NestedTransferFunction(self.source), dict(self.values))

    @property
    def bound(self) -> BoundNestedTransferFunction:
        """The function itself, which is already bound."""
        return self

    @cached_property
    def _expanded(self) -> transfer_layer.BoundTransferFunction:
        """Derived again with the numbers in place, so that its polynomials contain no name but s.

        SF235 for beams, rods and fields, whose expanded form would hold kernels.
        """
        model = self.source.model
        if model.fields or any(isinstance(use.element, LineElement) for use in model.elements):
            raise not_rational(self.name)
        numbered = with_numbers(model, (), dict(self.values), in_kernels=True)
        return pipeline.derive_bound(numbered, [(self.source.output.name, self.source.input.name)])[0]


def _derive_again(
    model: Model, pair: tuple[str, str], is_nested: bool
) -> TransferFunction | NestedTransferFunction:
    """Return a function for a copy, or for another process: its ring cannot be pickled."""
    if is_nested:
        return NestedTransferFunction(pipeline.derive_nested(model, [pair])[0])
    return TransferFunction(pipeline.derive_all(model, [pair])[0])


def _bind_again(
    function: TransferFunction | NestedTransferFunction, values: dict[str, Any]
) -> BoundTransferFunction | BoundNestedTransferFunction:
    return function.bind(**values)


def _values(
    model: Model, function: Callable[[complex], complex], s: ArrayLike
) -> complex | NDArray[np.complex128]:
    """Return the values of a function at a number or an array; SF251 where loss factors do not hold."""
    import numpy as np

    points = transfer_layer.points_of(s)
    if not ((points.real == 0) & (points.imag > 0)).all():
        check_causal(model, "a value at another s")
    if points.ndim == 0:
        return function(complex(points))
    values = np.array([function(complex(p)) for p in points.ravel()], dtype=complex)
    return values.reshape(points.shape)
