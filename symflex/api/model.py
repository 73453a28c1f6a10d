"""A model as a Python user holds it: read, built of mappings, asked for its transfer functions."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn, overload

from symflex import pipeline
from symflex.api.analyses import budget_of
from symflex.api.face import face_of
from symflex.api.plots import plot_loop
from symflex.api.response import MeasuredResponse
from symflex.api.stability import Stability
from symflex.api.state_space import StateSpace
from symflex.api.toolboxes import refuse_attribute
from symflex.api.transfer_function import (
    BoundTransferFunction,
    NestedTransferFunction,
    Number,
    TransferFunction,
)
from symflex.errors import BudgetError, Diagnostic, Source, refused
from symflex.expressions.format import number_text
from symflex.files.write import write_atomically
from symflex.model.spec import read
from symflex.model.spec.write import write
from symflex.options import (
    ColocationOptions,
    MeasureOptions,
    PlotOptions,
    StabilityOptions,
    SweepOptions,
    checked_digits,
)

if TYPE_CHECKING:
    from concurrent.futures import Executor
    from fractions import Fraction

    from matplotlib.figure import Figure

    from symflex import model as model_layer
    from symflex.analysis.sampled_loop import SampledPoles
    from symflex.api.live import LivePage
    from symflex.api.sweep import Sweep
    from symflex.api.transfer_matrix import TransferMatrix
    from symflex.codegen.export import Exporter
    from symflex.contact.coupled import CoupledStability
    from symflex.contact.hybrid import HybridPassivity
    from symflex.contact.over import PassiveChart, PassiveValues
    from symflex.contact.passivity import PortPassivity
    from symflex.contact.two_ports import TwoPorts
    from symflex.figures import AxesGiven
    from symflex.loops import DynamicColocation
    from symflex.loops.chart import StabilityChart
    from symflex.loops.peak import Peak
    from symflex.loops.spread import SpreadStability
    from symflex.model import Setting
    from symflex.options import Ends
    from symflex.symbolic.routh import Conditions

Table = Mapping[str, object]


@dataclass(frozen=True, init=False)
class Model:
    """A resolved model.

    Parameters
    ----------
    parameters, definitions, elements, signals, equations, operating_point, energy : mapping
    blocks, fields, inputs, outputs, analysis, figures, drawing, ports, published, notation, tables : mapping
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

    resolved: model_layer.Model
    _source: Source = field(compare=False, repr=False)  # its text
    _values: Mapping[str, Setting] = field(compare=False, repr=False)  # given in place of those of the text
    _outside: tuple[str | Path, ...] = field(compare=False, repr=False)  # folders that blocks may read, too

    def __init__(
        self,
        *,
        parameters: Table | None = None,
        definitions: Table | None = None,
        elements: Table | None = None,
        signals: Table | None = None,
        equations: Table | None = None,
        operating_point: Table | None = None,
        energy: Table | None = None,
        blocks: Table | None = None,
        sampled: Table | None = None,
        fields: Table | None = None,
        inputs: Table | None = None,
        outputs: Table | None = None,
        analysis: Table | None = None,
        figures: Table | None = None,
        drawing: Table | None = None,
        ports: Table | None = None,
        published: Table | None = None,
        notation: Table | None = None,
        tables: Table | None = None,
        title: str = "",
        source: str = "",
    ) -> None:
        # The keywords are the keys of a specification, in their order; those of the whole stand above tables.
        given = {key: value for key, value in locals().items() if value and key != "self"}
        above: dict[str, object] = {key: given.pop(key) for key in ("title", "source") if key in given}
        self._resolve(Source("<python>", write({"symflex": 1, **above, **given})), {}, ())

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> NoReturn:
            """Say what a method is called, or what a transfer function answers once it has numbers."""
            refuse_attribute(self, name, BoundTransferFunction, 'model.transfer_function("X/F").bind()')

    @staticmethod
    def of(source: Source, values: Mapping[str, Setting], allow_outside: Iterable[str | Path]) -> Model:
        """Return the model of a text with values in place of its own; errors as of :func:`loads`."""
        model = object.__new__(Model)
        model._resolve(source, values, allow_outside)
        return model

    def _resolve(
        self, source: Source, values: Mapping[str, Setting], allow_outside: Iterable[str | Path]
    ) -> None:
        outside = tuple(allow_outside)
        resolved = pipeline.load_with(source, values, allow_outside=outside)
        told = {"resolved": resolved, "_source": source, "_values": dict(values), "_outside": outside}
        for name, value in told.items():
            object.__setattr__(self, name, value)

    def to_toml(self, path: str | Path | None = None) -> str:
        """Return the specification of the model, and write it to a file if one is given.

        Raises
        ------
        UsageError
            SF902 for a value given to a parameter of a block's own file; SF903 if the file cannot be written.

        Examples
        --------
        >>> Model(parameters={"k": 4}, inputs={"u": {}}, outputs={"y": "k*u"}).to_toml().split()[:6]
        ['symflex', '=', '1', '[parameters]', 'k', '=']
        """
        text = self._source.text
        if self._values:
            spec = tomllib.loads(text)
            declared = spec.get("parameters", {})
            for p in self.parameters:
                value, unit = p.as_written()
                if p.name not in self._values or value is None:
                    continue
                if p.name not in declared:
                    raise refused(f"'{p.name}' is a parameter of another file, which cannot be written here")
                sign, pi = "-" * (value.rational < 0), f"*pi^{value.pi_power}" if value.pi_power else ""
                new = f"{sign}{number_text(abs(value.rational))}{pi} {unit}".rstrip()
                table = declared[p.name] if isinstance(declared[p.name], dict) else {}
                declared[p.name] = {key: v for key, v in table.items() if key != "unit"} | {"value": new}
            text = write(spec)
        if path is not None:
            write_atomically(Path(path), text.encode())
        return text

    def __repr__(self) -> str:
        return repr(self.resolved)

    def _repr_html_(self) -> str:
        from symflex.print.html import model_html

        try:
            from symflex.drawing import LARGEST_DRAWING, drawing_of, render_drawing  # only notebooks ask

            if len(self.resolved.elements) > LARGEST_DRAWING:
                return model_html(self.resolved)
            drawn = render_drawing(drawing_of(self.resolved), "svg").decode()
        except ImportError:  # matplotlib, which a notebook in a browser may lack
            return model_html(self.resolved)
        # Without its own style, which would be that of the whole notebook.
        head, _, tail = drawn[drawn.index("<svg") :].partition("<style")
        return f"<div>{head}{tail.partition('</style>')[2]}</div>\n{model_html(self.resolved)}"

    def draw(self, *, values: bool = False, width: float | None = None, font: str = "times") -> Figure:
        """Draw the model as a textbook would, like ``symflex draw``.

        Parameters
        ----------
        values : bool
            Label symbols with values and units.
        width : float, optional
            Width of the figure [mm]; by default a column (88.5), a page (170), or what the model needs.
            Lengths in the figure are those in print.
        font : str
            ``times``, ``latex`` or ``sans``.

        Raises
        ------
        UsageError
            SF902 a width that is too small for the model, or is not between 80 and 1000 mm; SF208 an
            unknown font.

        Examples
        --------
        >>> wall = {"type": "spring", "between": ["x", "ground"], "k": "8 N/m"}
        >>> model = Model(elements={"wall": wall}, inputs={"F": {"force": "x"}}, outputs={"X": "x"})
        >>> round(25.4 * float(model.draw().get_figwidth()), 1)
        88.5
        """
        from symflex.drawing import draw_model  # imports matplotlib

        return draw_model(self.resolved, values=values, width_mm=width, font=font)

    @property
    def title(self) -> str:
        """What the model is."""
        return self.resolved.title

    @property
    def parameters(self) -> tuple[model_layer.ModelParameter, ...]:
        """The parameters in declared order, with exact values in SI units."""
        return self.resolved.parameters

    @property
    def warnings(self) -> tuple[Diagnostic, ...]:
        """Warnings of ``symflex check``: possible mistakes in the specification.

        Examples
        --------
        >>> wall = {"type": "spring", "between": ["x", "gruond"], "k": "8 N/m"}
        >>> model = Model(elements={"wall": wall}, inputs={"F": {"force": "x"}}, outputs={"X": "x"})
        >>> [(w.code, w.hint) for w in model.warnings]
        [('SF650', "did you mean 'ground'?")]
        """
        return pipeline.warnings(self.resolved)

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs."""
        return tuple(i.name for i in self.resolved.inputs)

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs."""
        return tuple(o.name for o in self.resolved.outputs)

    def transfer_function(self, output: str, input: str | None = None) -> TransferFunction:
        """Derive output over input; one name for both works too, as on the command line: ``"X/F"``.

        Raises
        ------
        UsageError
            SF902 when there is no such output or input.
        ModelError
            SF30x when the equations are singular, with the reason.
        BudgetError
            SF501, SF502 when its expanded form is too large, as for frames; use :meth:`nested` then.
        """
        return self._derived(self._picked(output, input))[0]

    def _picked(self, output: str, input: str | None) -> Sequence[tuple[str, str]]:
        return pipeline.pick_pairs(self.resolved, [output if input is None else f"{output}/{input}"])

    def nested(self, output: str, input: str | None = None) -> NestedTransferFunction:
        """Derive output over input as a straight-line program, for models too large to expand.

        Raises
        ------
        UsageError
            SF902 when there is no such output or input.
        ModelError
            SF30x when the equations are singular, with the reason.

        Examples
        --------
        >>> model = loads('''
        ... symflex = 1
        ... parameters = { m_1 = {}, m_2 = {}, k = {} }
        ... elements.motor = { type = "mass", at = "x", m = "m_1" }
        ... elements.tip = { type = "mass", at = "y", m = "m_2" }
        ... elements.link = { type = "spring", between = ["x", "y"], k = "k" }
        ... inputs.F = { force = "x" }
        ... outputs.X = "x"
        ... ''')
        >>> G = model.nested("X/F")
        >>> G.num, G.den, G.where
        (1, Z_1*k/(Z_1 + k) + m_1*s**2, ((Z_1, m_2*s**2),))
        >>> G.bind(m_1=1, m_2=2, k=3)(1j) == 1 / (-2 * 3 / (-2 + 3) - 1)
        True
        """
        return NestedTransferFunction(pipeline.derive_nested(self.resolved, self._picked(output, input))[0])

    def transfer_functions(self) -> tuple[TransferFunction, ...]:
        """Derive every output over every input, sharing one elimination."""
        return self._derived(self.resolved.transfer_functions)

    def transfer_matrix(
        self, outputs: Sequence[str] | str = (), inputs: Sequence[str] | str = ()
    ) -> TransferMatrix:
        """Derive all functions of some outputs and inputs as a matrix over their common denominator.

        Parameters
        ----------
        outputs, inputs : sequence of str or str, optional
            Names, or one of them; by default all.

        Raises
        ------
        UsageError
            SF902 when there is no such output or input.
        """
        from symflex.api.transfer_matrix import TransferMatrix
        from symflex.matrices import derive_matrix

        rows, columns = ([names] if isinstance(names, str) else names for names in (outputs, inputs))
        return TransferMatrix(derive_matrix(self.resolved, rows, columns))

    def _derived(self, pairs: Sequence[tuple[str, str]]) -> tuple[TransferFunction, ...]:
        try:
            return tuple(map(TransferFunction, pipeline.derive_all(self.resolved, pairs)))
        except BudgetError as error:
            if error.diagnostics[0].code not in ("SF501", "SF502"):
                raise
            (output, source), hint = pairs[0], error.diagnostics[0].hint
            way = f"model.nested({output!r}, {source!r}) has its values, poles and zeros; or {hint}"
            raise BudgetError(replace(error.diagnostics[0], hint=way)) from None

    def state_space(
        self,
        outputs: Sequence[str] | None = None,
        inputs: Sequence[str] | None = None,
        *,
        minimal: bool = False,
    ) -> StateSpace:
        """Return one realisation with several outputs and inputs, all by default.

        Parameters
        ----------
        outputs, inputs : sequence of str, optional
            Names; inputs that are not named are zero.
        minimal : bool
            Leave out uncontrollable and unobservable states.

        Raises
        ------
        UsageError
            SF902 for an unknown name.
        ModelError
            SF235 for beams, rods and delays, SF236 when an output grows with s.
        """
        wanted = [
            f"{output}/{source}"
            for output in (self.outputs if outputs is None else outputs)
            for source in (self.inputs if inputs is None else inputs)
        ]
        return StateSpace.of(self.resolved, pipeline.pick_pairs(self.resolved, wanted), minimal=minimal)

    @overload
    def stability(
        self,
        gain: str = "",
        limits: tuple[float | None, float | None] | None = None,
        *,
        digits: int = 15,
        budget: float | None = None,
        up_to_hz: float | None = None,
        over: str = "",
        ranges: Mapping[str, tuple[float, float]] | None = None,
        resolve: float = 0.01,
        spread: None = None,
        peaks: bool = False,
        **values: Number,
    ) -> Stability: ...

    @overload
    def stability(
        self,
        gain: str = "",
        limits: None = None,
        *,
        over: tuple[str, str],
        digits: int = 15,
        ranges: Mapping[str, tuple[float, float]] | None = None,
        resolve: float = 0.01,
        peaks: bool = False,
        budget: float | None = None,
        up_to_hz: float | None = None,
        spread: None = None,
        **values: Number,
    ) -> StabilityChart: ...

    @overload
    def stability(
        self, *, spread: str | float, budget: float | None = None, **values: Number
    ) -> SpreadStability: ...

    def stability(  # type: ignore[misc]  # options of gains could be values beside a spread
        self,
        gain: str = "",
        limits: tuple[float | None, float | None] | None = None,
        *,
        digits: int = 15,
        budget: float | None = None,
        up_to_hz: float | None = None,
        over: str | tuple[str, str] = "",
        ranges: Mapping[str, tuple[float, float]] | None = None,
        resolve: float = 0.01,
        spread: str | float | None = None,
        peaks: bool = False,
        **values: Number,
    ) -> Stability | StabilityChart | SpreadStability:
        """Return the gains for which all closed-loop poles are in the open left half-plane, proved.

        Parameters
        ----------
        gain : str
            A parameter; the loop is closed in the model's signals.
        limits : (float or None, float or None), optional
            Range of the gain in SI units, without its ends; ``None`` for no limit. By default all values of
            its assumed sign; with beams, rods or delays up to 100 times its declared value.
        digits : int
            Significant digits of boundaries and frequencies.
        budget : float, optional
            Time [s].
        up_to_hz : float, optional
            If infinitely many poles lie along the axis: how far they are counted [Hz].
        over : str or pair of str, optional
            Any parameter in place of a gain: a delay, a length, a mass. Two of them make a chart.
        ranges : mapping, optional
            Ranges of the parameters of a chart, in SI units. By default the ``range`` declared; else from 0,
            or half the value, to ten times or twice the value.
        resolve : float
            Share of the chart that may stay undecided.
        spread : str or float, optional
            In place of a gain: every parameter at once, each off by up to this share, "10 %" or 0.1; "" for
            those that declare a ``spread``.
        peaks : bool
            Find the peaks of S and T and the disk margin with beams, rods or delays too.
        **values : number or str
            In place of declared values, as for :meth:`TransferFunction.bind`.

        Returns
        -------
        Stability, StabilityChart or SpreadStability
            A chart for two parameters; what holds for every combination of a spread.

        Raises
        ------
        UsageError
            SF902 no such parameter, SF804 a range that is empty, or missing where one is needed.
        ModelError
            SF801 no pole depends on the parameter, SF803 it occurs squared beside beams, rods or delays.
        BudgetError
            SF505, SF506.

        Examples
        --------
        >>> loop = {"y": "K/(s*(s + 1)*(s + 2))*(r - y)"}
        >>> model = Model(parameters={"K": 1}, signals=loop, inputs={"r": {}}, outputs={"Y": "y"})
        >>> model.stability("K")
        <Stability: 0.0 < K < 6.0, certified>
        >>> delayed = {"y": "K/s*exp(-s*T)*(r - y)"}
        >>> given = {"K": 1, "T": 0.1}
        >>> model = Model(parameters=given, signals=delayed, inputs={"r": {}}, outputs={"Y": "y"})
        >>> model.stability(over="T", limits=(0, 3))  # up to pi/2
        <Stability: 0.0 < T < 1.5707963, certified>
        >>> chart = model.stability(over=("K", "T"), ranges={"K": (0, 4), "T": (0, 2)})
        >>> chart.at(1, 1.4), chart.at(1, 1.8)
        ('stable', 'unstable by 2')
        >>> model.stability(spread="50 %", T=1.0)
        <SpreadStability of 2 parameters: unstable>
        """
        from symflex.loops.chart import StabilityChart  # imports numpy
        from symflex.loops.spread import stability_spread

        names: tuple[str, ...] = tuple(over) if not isinstance(over, str) else (over,) if over else ()
        each = tuple((name, *ends) for name, ends in (ranges or {}).items())
        arguments = (gain, limits, up_to_hz, checked_digits(digits), names, each, resolve)
        given = StabilityOptions(*arguments, peaks=peaks, spread=spread)
        with budget_of(budget).besides().entered():
            if spread is not None:
                return stability_spread(self.resolved, given, values)
            proved = pipeline.stability(self.resolved, given, values)
            return proved if isinstance(proved, StabilityChart) else Stability(proved)

    @overload
    def passivity(
        self, port: str | None = None, *, digits: int = 12, **values: Number
    ) -> PortPassivity | HybridPassivity: ...

    @overload
    def passivity(self, port: tuple[str, str], *, digits: int = 12, **values: Number) -> TwoPorts: ...

    def passivity(
        self, port: str | tuple[str, str] | None = None, *, digits: int = 12, **values: Number
    ) -> PortPassivity | TwoPorts | HybridPassivity:
        """Return whether the machine is passive at a port, proved, and if not where, with repairs.

        Parameters
        ----------
        port : str or pair of str, optional
            A port of ``[ports]``, or a node; by default the only port. Of two ports, whether the machine is
            passive, and absolutely stable, at both.
        digits : int
            Correct significant digits.
        **values : number or str
            In place of declared values.

        Returns
        -------
        PortPassivity or TwoPorts or HybridPassivity
            ``passive`` (``None`` where it is not decided), ``active`` bands, ``least`` real part, ``repair``
            and ``example``; of two ports ``passive``, ``absolutely_stable``, and ``least`` eta; with a
            sampled controller ``passive``, the ``condition`` in symbols, and the ``needed`` damping.

        Raises
        ------
        UsageError
            SF210 no such port, SF218 a node that does not move.

        Examples
        --------
        A proportional controller with a first-order lag: ``Re Z = b - K*tau/(1 + (omega*tau)^2)``.

        >>> hand = {"body": {"type": "mass", "at": "x", "m": "1 kg"},
        ...         "friction": {"type": "damper", "between": ["x", "ground"], "b": "1 N*s/m"},
        ...         "f": {"type": "force_source", "at": "x", "f": "-K/(tau*s + 1)*x"}}
        >>> model = Model(parameters={"K": "20.5 N/m", "tau": "50 ms"}, elements=hand,
        ...               inputs={"F": {"force": "x"}}, outputs={"X": "x"}, ports={"tip": {"at": "x"}})
        >>> print(model.passivity("tip", digits=6))
        port tip, v_tip/f_tip [m/(N*s)]   ACTIVE, proved
          real part negative from 0 Hz to 0.503292 Hz
          least real part -0.000299969, at 0.41187 Hz
        <BLANKLINE>
        what makes it passive
          a damper in parallel: b at least 0.0250000 N*s/m (damper b = 0.02501 N*s/m
            is enough)
          a damper in series: b at most 3333.68 N*s/m (damper b = 3333 N*s/m is
            enough)
          a spring or a mass alone leaves the sign of the real part as it is
        <BLANKLINE>
        what it is unstable with
          mass m = 1.1 kg
          pole at 0.000264397 + 3.08782 j rad/s, 0.491442 Hz
        >>> model.passivity("tip", K="20 N/m").passive
        True
        """
        from symflex.contact.passivity import find_passivity  # imports numpy
        from symflex.contact.two_ports import find_two_ports
        from symflex.loops.over import with_values

        model = with_values(self.resolved, values)
        if isinstance(port, tuple):
            return find_two_ports(model, port, checked_digits(digits))
        if model.sampled is not None:
            from symflex.contact.hybrid import find_hybrid  # few models have a sampled controller

            return find_hybrid(model, port)
        return find_passivity(model, port, checked_digits(digits))

    def passive_values(
        self,
        port: str | None,
        over: str | tuple[str, str],
        *,
        ranges: Mapping[str, tuple[float, float]] | None = None,
        digits: int = 12,
        **values: Number,
    ) -> PassiveValues | PassiveChart:
        """Return for which values of one parameter, or of two, the machine is passive at a port.

        Parameters
        ----------
        port : str or None
            A port of ``[ports]``, or a node; None for the only port.
        over : str or tuple of str
            The parameter, or two: then the values of the first at many values of the second.
        ranges : mapping, optional
            Ranges in SI units, by default as for :meth:`stability`.
        digits : int
            Correct significant digits.
        **values : number or str
            In place of declared values.

        Examples
        --------
        >>> wall = {"body": {"type": "mass", "at": "x", "m": "1 kg"},
        ...         "friction": {"type": "damper", "between": ["x", "ground"], "b": "1 N*s/m"},
        ...         "f": {"type": "force_source", "at": "x", "f": "-K/(tau*s + 1)*x"}}
        >>> model = Model(parameters={"K": "10 N/m", "tau": "50 ms"}, elements=wall,
        ...               inputs={"F": {"force": "x"}}, outputs={"X": "x"})
        >>> print(model.passive_values("x", "K"))
        K [N/m]   certified: passive at port x
          examined: 0 < K < 100
          passive for:
            0 < K < 20
        """
        from symflex.contact.over import passive_over  # imports numpy
        from symflex.loops.over import with_values
        from symflex.options import PassivityOptions

        names = (over,) if isinstance(over, str) else tuple(over)
        each = tuple((name, *ends) for name, ends in (ranges or {}).items())
        given = PassivityOptions((port,) if port else (), names, None, each, digits=checked_digits(digits))
        return passive_over(with_values(self.resolved, values), given)

    def contact(
        self,
        port: str | None,
        environment: str,
        *,
        over: str | tuple[str, ...] = (),
        ranges: Mapping[str, tuple[float, float]] | None = None,
        up_to: float | str | None = None,
        digits: int = 15,
        resolve: float = 0.01,
        budget: float | None = None,
        **values: Number,
    ) -> CoupledStability:
        """Return whether the machine is stable with an environment at a port, proved.

        Parameters
        ----------
        port : str
            A port of ``[ports]``, or a node.
        environment : str
            A force over a displacement, such as ``"k_e + b_e*s + m_e*s^2"``; in circuits a voltage over a
            current. Or a class: spring, damper, mass, spring-damper, wall; any: every passive one. Names
            that the model does not have become parameters.
        over : str or tuple of str
            Parameters of the environment or of the model; two of them make a chart. By default the letters of
            the environment without a value, of two of which all combinations are meant.
        ranges : mapping, optional
            Ranges of these in SI units. By default all positive values of a letter of the environment.
        up_to : float or str, optional
            The largest value of the environment's one letter.
        digits, resolve, budget :
            As for :meth:`stability`.
        **values : number or str
            In place of declared values, and of letters of the environment.

        Returns
        -------
        CoupledStability
            ``is_stable``, ``certified``, and the ``answer``: a map, a chart, or poles.

        Raises
        ------
        UsageError
            SF902 a letter without a value, SF210 no such port, SF804 a range that needs an end.
        SpecError
            An environment with a mistake, such as a unit that does not fit.

        Examples
        --------
        >>> parameters = {"m": "2 kg", "b": "3 N*s/m", "K": "100 N/m", "T": "0.05 s"}
        >>> hand = {"body": {"type": "mass", "at": "x", "m": "m"}, "f": {
        ...     "type": "damper", "between": ["x", "ground"], "b": "b"}, "wall": {
        ...     "type": "force_source", "at": "x", "f": "-K*exp(-s*T)*x"}}
        >>> model = Model(
        ...     parameters=parameters, elements=hand, inputs={"F": {"force": "x"}}, outputs={"X": "x"})
        >>> model.contact("x", "damper", up_to=10)
        <CoupledStability at x: not stable for all values>
        """
        from symflex.contact.coupled import coupled_stability  # imports numpy
        from symflex.options import ContactOptions

        names = (over,) if isinstance(over, str) else tuple(over)
        each = tuple((name, *ends) for name, ends in (ranges or {}).items())
        digits = checked_digits(digits)
        given = ContactOptions(port, environment, names, None, each, up_to, digits, resolve)
        with budget_of(budget).besides().entered():
            return coupled_stability(self._source, given, {**self._values, **values}, self._outside)

    def sampled_poles(self, digits: int = 15, **values: Number) -> SampledPoles:
        """Return the poles of the loop that a sampled controller closes, in z and as s = ln(z)/T.

        Parameters
        ----------
        digits : int
            Significant digits.
        **values : number or str
            In place of declared values, as for :meth:`TransferFunction.bind`.

        Raises
        ------
        ModelError
            SF260 without ``[sampled]``, or where it cannot be read as a loop.

        Examples
        --------
        >>> model = Model(
        ...     parameters={"K": 1, "T": 0.5}, blocks={"C": "K*z/z"}, sampled={"period": "T"},
        ...     signals={"y": "C*(r - y)/s"}, inputs={"r": {}}, outputs={"Y": "y"},
        ... )
        >>> model.sampled_poles()  # z = 1 - K*T
        <SampledPoles: 1 poles, stable>
        """
        from symflex.analysis.sampled_loop import sampled_poles  # imports numpy

        return sampled_poles(self.resolved, checked_digits(digits), values)

    def conditions(
        self, of: str = "poles", tf: str | None = None, *, over: tuple[str, str] | None = None
    ) -> Conditions:
        """Return inequalities that hold exactly where all poles, or zeros, lie in the left half-plane.

        Parameters
        ----------
        of : str
            ``poles``, or ``zeros`` of a transfer function.
        tf : str, optional
            ``"OUT/IN"`` for zeros, the first one by default.
        over : pair of str, optional
            The boundary over two parameters as a curve instead.

        Examples
        --------
        >>> loop = {"y": "K/(s*(T_1*s + 1)*(T_2*s + 1))*(r - y)"}
        >>> letters = {"K": {}, "T_1": {}, "T_2": {}}
        >>> model = Model(parameters=letters, signals=loop, inputs={"r": {}}, outputs={"Y": "y"})
        >>> print(*model.conditions().conditions)
        T_1 + T_2 > K*T_1*T_2
        """
        from symflex.symbolic.boundary import boundary  # for start-up time
        from symflex.symbolic.routh import conditions  # for start-up time

        with budget_of(None).entered():
            return boundary(self.resolved, over) if over else conditions(self.resolved, of, tf)

    def stability_plot(
        self,
        over: str | tuple[str, str],
        *,
        ranges: Mapping[str, tuple[float, float]] | None = None,
        resolve: float = 0.01,
        box: bool = False,
        width: float | str | None = None,
        font: str | None = None,
        ax: AxesGiven | None = None,
        **values: Number,
    ) -> Figure:
        """Draw for which values of one parameter or two the model is stable.

        Parameters
        ----------
        over, ranges, resolve, **values : optional
            As for :meth:`stability`.
        box : bool
            Draw the largest box about the declared values in which the count of unstable poles is the same.
        width, font, ax : optional
            As for :meth:`BoundTransferFunction.bode`; one axes.

        Examples
        --------
        >>> delayed = {"y": "K/s*exp(-s*T)*(r - y)"}
        >>> given = {"K": 1, "T": 0.1}
        >>> model = Model(parameters=given, signals=delayed, inputs={"r": {}}, outputs={"Y": "y"})
        >>> figure = model.stability_plot(("K", "T"), ranges={"K": (0, 4), "T": (0, 2)}, resolve=0.1)
        >>> [text.get_text() for text in figure.axes[0].texts]
        ['stable', '2 unstable']
        """
        from symflex.figures import draw_over  # imports matplotlib

        names = (over,) if isinstance(over, str) else tuple(over)
        each = tuple((name, *ends) for name, ends in (ranges or {}).items())
        given = PlotOptions(
            "stability", over=names, ranges=each, resolve=resolve, box=box, width=width, font=font
        )
        return draw_over(pipeline.stability(self.resolved, given.stability, values), given, ax)

    def locus(
        self,
        gain: str,
        limits: tuple[float | None, float | None] | None = None,
        *,
        modes: int | None = None,
        band: Ends | None = None,
        xlim: Ends | None = None,
        ylim: Ends | None = None,
        width: float | str | None = None,
        font: str | None = None,
        verdict: bool = False,
        ax: AxesGiven | None = None,
        **values: Number,
    ) -> Figure:
        r"""Return the root locus: the paths of closed-loop poles as a gain grows.

        Parameters
        ----------
        gain : str
            A parameter; the loop is closed in the model's signals.
        limits : (float, float), optional
            First and last gain in SI units; from 0 to ten times the declared value by default.
        modes : int, optional
            For a distributed system, how many modes are traced.
        band : (float, float), optional
            The figure ends where the band ends [Hz].
        xlim, ylim : (float, float), optional
            Ends of the axes [rad/s].
        verdict : bool
            Print above the figure at which gains the loop is stable.
        width, font, ax : optional
            As for :meth:`BoundTransferFunction.bode`; one axes.
        **values : number or str
            In place of declared values.

        Raises
        ------
        UsageError
            SF902 no such parameter, SF804 no range, SF806 no value, or no loop linear in the gain.
        ModelError
            SF801 no pole depends on the parameter.
        UncertifiedError
            SF807 the curves do not end in certified poles.

        Examples
        --------
        >>> loop = {"y": "K/(s*(s + 1)*(s + 2))*(r - y)"}
        >>> model = Model(parameters={"K": 1}, signals=loop, inputs={"r": {}}, outputs={"Y": "y"})
        >>> figure = model.locus("K", (0, 20), ylim=(-4, 4))
        >>> figure.axes[0].get_ylim() == (-4, 4), figure.axes[0].get_xlabel()
        (True, '$\\mathrm{Re}(s)$ [rad/s]')
        """
        given = PlotOptions("locus", (), gain, band, xlim, ylim, None, limits, modes=modes, verdict=verdict)
        return plot_loop(replace(given, width=width, font=font), self.resolved, values, ax)

    def nyquist(
        self,
        gain: str,
        *,
        band: Ends | None = None,
        xlim: Ends | None = None,
        ylim: Ends | None = None,
        width: float | str | None = None,
        font: str | None = None,
        verdict: bool = False,
        ax: AxesGiven | None = None,
        **values: Number,
    ) -> Figure:
        """Return the Nyquist plot of the loop that a gain closes, about the point -1.

        Parameters and errors are those of :meth:`locus`; ``band`` gives the frequencies [Hz]. The verdict
        says whether the closed loop is stable.

        Examples
        --------
        >>> loop = {"y": "K/(s*(s + 1)*(s + 2))*(r - y)"}
        >>> model = Model(parameters={"K": 1}, signals=loop, inputs={"r": {}}, outputs={"Y": "y"})
        >>> print(model.nyquist("K", verdict=True).legends[0].get_title().get_text())
        closed loop stable
        """
        given = PlotOptions("nyquist", (), gain, band, xlim, ylim, width=width, font=font, verdict=verdict)
        return plot_loop(given, self.resolved, values, ax)

    def nichols(
        self,
        gain: str,
        *,
        band: Ends | None = None,
        xlim: Ends | None = None,
        ylim: Ends | None = None,
        width: float | str | None = None,
        font: str | None = None,
        verdict: bool = False,
        ax: AxesGiven | None = None,
        **values: Number,
    ) -> Figure:
        """Return the Nichols chart of the loop gain, axes in degrees and dB; see :meth:`nyquist`.

        Examples
        --------
        >>> loop = {"y": "K/(s*(s + 1)*(s + 2))*(r - y)"}
        >>> model = Model(parameters={"K": 1}, signals=loop, inputs={"r": {}}, outputs={"Y": "y"})
        >>> model.nichols("K", xlim=(-270, 0)).axes[0].get_xlabel()
        'Phase [deg]'
        """
        given = PlotOptions("nichols", (), gain, band, xlim, ylim, width=width, font=font, verdict=verdict)
        return plot_loop(given, self.resolved, values, ax)

    def sensitivity_plot(
        self,
        gain: str,
        *,
        band: Ends | None = None,
        ylim: Ends | None = None,
        width: float | str | None = None,
        font: str | None = None,
        ax: AxesGiven | None = None,
        **values: Number,
    ) -> Figure:
        """Return S = 1/(1 + L) and T = L/(1 + L) of the loop gain L over frequency, with certified peaks.

        Parameters are those of :meth:`nyquist`.

        Examples
        --------
        >>> loop = {"y": "K/(s*(s + 1)*(s + 2))*(r - y)"}
        >>> model = Model(parameters={"K": 1}, signals=loop, inputs={"r": {}}, outputs={"Y": "y"})
        >>> [text.get_text() for text in model.sensitivity_plot("K").axes[0].get_legend().get_texts()]
        ['$|S|$, $M_S = 1.568$', '$|T|$, $M_T = 1.113$']
        """
        given = PlotOptions("sensitivity", (), gain, band, ylim=ylim, width=width, font=font)
        return plot_loop(given, self.resolved, values, ax)

    def peak(self, output: str, input: str, *, digits: int = 12, band: Ends | None = None) -> Peak:
        """Return the largest magnitude over all frequencies, or in a band [Hz], and where it is, proved.

        Examples
        --------
        >>> print(Model(inputs={"u": {}}, outputs={"y": "u/(s^2 + s/5 + 1)"}).peak("y", "u"))
        y/u [s^2]   certified
          largest magnitude 5.02518907630, radius 4.0e-12, at 0.157555 Hz
          H2 norm 1.58113883008, radius 4.2e-12
        """
        from symflex.loops.peak import find_peak  # imports numpy

        (bound,) = pipeline.derive_bound(self.resolved, self._picked(output, input))
        return find_peak(bound, checked_digits(digits), band)

    def colocation(
        self,
        output: str,
        reference: str,
        input: str,
        *,
        phase: float = 10.0,
        magnitude: float = 1.0,
        band: tuple[float, float] | None = None,
    ) -> DynamicColocation:
        """Return the frequency up to which an output moves with a colocated one.

        Parameters
        ----------
        output, reference, input : str
            Such as "X_tip", "X_act" and "F".
        phase : float
            Largest difference of phase [degrees].
        magnitude : float
            Largest difference of magnitude [dB].
        band : (float, float), optional
            Frequencies examined [Hz]; by default the model's.

        Examples
        --------
        >>> signals = {"x": "(u - 4*(x - y))/s^2", "y": "4*(x - y)/s^2"}  # two masses on a spring
        >>> model = Model(signals=signals, inputs={"u": {}}, outputs={"X": "x", "Y": "y"})
        >>> print(model.colocation("Y", "X", "u", band=(0.01, 1)))
        Y/u within 10 deg and 1 dB of X/u: up to 0.104969441593 Hz, where the magnitude differs by more
        """
        from symflex.loops.of_model import colocation

        given = ColocationOptions(f"{output}/{input}", f"{reference}/{input}", phase, magnitude, band)
        return colocation(self.resolved, given)

    def measure(
        self,
        output: str,
        input: str,
        band: tuple[float, float],
        spacing: float,
        *,
        averages: int = 40,
        noise: float = 0.03,
        rolloff: float | None = 5000.0,
        seed: int = 1,
    ) -> MeasuredResponse:
        """Return a synthetic measurement of a transfer function, labelled as synthetic.

        Parameters
        ----------
        output, input : str
            Names.
        band : (float, float)
            The lines shown [Hz].
        spacing : float
            Distance of lines [Hz], one over the length of a record.
        averages : int
            Records averaged; they overlap by half and have a Hann window.
        noise : float
            Ratio of sensor noise to signal, rms.
        rolloff : float, optional
            Corner of the accelerometer [Hz]; ``None`` for none.
        seed : int
            Seed of the random numbers.

        Raises
        ------
        UsageError
            SF902 an undamped pole, an unknown name or an impossible band.

        Examples
        --------
        >>> import symflex
        >>> model = Model(inputs={"u": {}}, outputs={"a": "s^2*u/(s^2 + 3*s + 4000)"})
        >>> data = model.measure("a", "u", (2, 40), 0.1)
        >>> data.is_synthetic, data.frequency_hz.size, len(data.plot().axes)
        (True, 381, 2)
        >>> symflex.fit(data, modes=1, slope=2)
        <Fit to synthetic data: 10.1 Hz>
        """
        from symflex.analysis.measured import measure

        given = MeasureOptions(f"{output}/{input}", "", band, spacing, averages, noise, rolloff, seed)
        return face_of(MeasuredResponse, measure(self.resolved, given))

    def sweep(
        self,
        over: Mapping[str, str | Sequence[Number]],
        *,
        of: str = "poles",
        tf: str | None = None,
        modes: int | None = None,
        band: tuple[float, float] | None = None,
        frequencies: Sequence[float] = (),
        gain: str = "",
        draws: int = 0,
        seed: int = 1,
        output: str | Path | None = None,
        fresh: bool = False,
        executor: Executor | None = None,
        workers: int = 1,
    ) -> Sweep:
        """Solve the model at many values of its parameters, as ``symflex sweep`` does.

        Parameters
        ----------
        over : mapping of str to str or sequence
            Values per parameter, in SI units or with a unit: a sequence; ``"1e4:1e6:log:200"`` for 200 values
            between two limits; ``"1e4:1e6"``, ``"1e4:1e6:log"`` or ``"+-5%"`` as ranges to draw from.
        of : str
            ``poles``, ``zeros``, ``response`` or ``margins``.
        tf : str, optional
            ``"OUT/IN"``; the first transfer function by default.
        modes, band : int, (float, float), optional
            Which roots: a number of the lowest modes, or those in a band [Hz].
        frequencies : sequence of float
            Frequencies of a response [Hz].
        gain : str
            Parameter that is the loop's gain, for ``margins``.
        draws, seed : int
            How many points are drawn from ranges, as a Latin hypercube, and the seed of the random numbers.
        output : str or Path, optional
            A .nc, .npz, .csv or .parquet to write. Until then, finished points are kept in ``FILE.part``,
            and the same call continues after a kill.
        fresh : bool
            Discard what an earlier call kept there.
        executor : concurrent.futures.Executor, optional
            Where points are solved; in this process by default.
        workers : int
            How many points the executor solves at a time.

        Returns
        -------
        Sweep
            Labelled arrays; ``to_xarray()`` makes a dataset of them, ``plot()`` a figure.

        Raises
        ------
        UsageError
            SF902 for something that cannot be swept or read, SF916 ``FILE.part`` belongs to another sweep.
        BudgetError
            SF507 too many points, SF508 a worker died.

        Examples
        --------
        >>> model = Model(parameters={"k": 4}, inputs={"u": {}}, outputs={"x": "u/(s^2 + k)"})
        >>> sweep = model.sweep({"k": [1, 4, 9]})
        >>> sweep
        <Sweep x/u: poles at 3 points, k, certified>
        >>> sweep["im"].tolist(), sweep.is_certified
        ([[1.0], [2.0], [3.0]], True)
        """
        from symflex import sweep as sweep_package  # imports numpy and scipy
        from symflex.api.sweep import Sweep

        if of not in sweep_package.QUANTITIES:
            hint = "choose from: " + ", ".join(sweep_package.QUANTITIES)
            raise refused(f"nothing is called '{of[:64]}' in a sweep", hint)
        if of == "response" and not len(frequencies):
            raise refused("a response needs frequencies")
        given = SweepOptions(over, draws, seed, of, tf, modes, band, gain=gain, output=output, fresh=fresh)
        task, design = sweep_package.plan_sweep(self.resolved, given, frequencies)
        return face_of(Sweep, sweep_package.sweep(task, design, given, executor, workers=workers))

    def live(self, *tfs: str) -> LivePage:
        """Return a page with a slider for every parameter, like ``symflex live``; a notebook shows it.

        Parameters
        ----------
        *tfs : str
            Transfer functions shown, such as "X/F"; by default all.

        Raises
        ------
        UsageError
            SF902 when there is no such transfer function.
        ModelError
            SF251 for models with loss factors; others as of :meth:`transfer_function`.

        Examples
        --------
        >>> wall = {"type": "spring", "between": ["x", "ground"], "k": "k"}
        >>> body = {"type": "mass", "at": "x", "m": "m"}
        >>> model = Model(parameters={"k": "8 N/m", "m": "2 kg"}, elements={"wall": wall, "body": body},
        ...               inputs={"F": {"force": "x"}}, outputs={"X": "x"})
        >>> page = model.live()
        >>> page.html[:15], "https:" in page.html
        ('<!DOCTYPE html>', False)
        """
        from symflex.api.live import LivePage  # only pages need the numeric packages
        from symflex.budget import Silent
        from symflex.live.page import live_page

        return LivePage(live_page([(self.resolved, pipeline.pick_pairs(self.resolved, tfs))], Silent()))

    def export_numpy(self) -> str:
        """Return a numpy module with a function per transfer function."""
        return self._export("numpy")

    def export_array_api(self) -> str:
        """Return a module for the library of its arguments: numpy, torch, jax.numpy, cupy."""
        return self._export("array-api")

    def export_jax(self) -> str:
        """Return a module for jax; jit, grad and vmap work through its functions."""
        return self._export("jax")

    def export_c(self) -> str:
        """Return a C99 source that needs no header, with a function per transfer function."""
        return self._export("c")

    def export_state_space(self) -> str:
        """Return a numpy module with the state equations as a function of the parameters."""
        return self._export("state-space")

    def export_matlab(self, name: str = "") -> str:
        """Return a function file for MATLAB and Octave.

        Parameters
        ----------
        name : str
            The name of its main function, which must be that of the file; by default made from the title.
        """
        return self._export("matlab", name)

    def export_julia(self, name: str = "") -> str:
        """Return a Julia module.

        Parameters
        ----------
        name : str
            The source of the module's name; by default the title.
        """
        return self._export("julia", name)

    def export_js(self) -> str:
        """Return an ES module without dependencies, for browsers and Node."""
        return self._export("js")

    def export_modelica(self) -> str:
        """Return a Modelica model: symbolic state equations."""
        return self._export("modelica")

    def export_latex(self) -> str:
        """Return a standalone LaTeX document of the model."""
        return self._export("latex")

    def export_typst(self) -> str:
        """Return a standalone Typst document of the model."""
        return self._export("typst")

    def export_sampled(
        self,
        target: str,
        dt: float | Fraction | str,
        method: str = "zoh",
        prewarp: float | Fraction | str | None = None,
        *,
        direct: bool = False,
        name: str = "",
    ) -> str:
        r"""Return code that takes one step per sample, as ``symflex export --sample`` writes it.

        Parameters
        ----------
        target : str
            A language, for instance ``c`` or ``numpy``.
        dt, method, prewarp
            As for :meth:`symflex.TransferFunction.discretise`, with its errors.
        direct : bool
            One section for all poles, not one for each pair.
        name : str
            The file's name without suffix.

        Raises
        ------
        UsageError
            SF902 for a language that has no such code.

        Examples
        --------
        >>> lag = loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/(s + 2)"')
        >>> print(lag.export_sampled("numpy", "100 ms", "tustin").splitlines()[-3].strip())
        w[0] = 0.045454545454545456 * x + 0.8181818181818182 * y
        """
        from symflex.codegen.exporters import SAMPLED  # imports numpy
        from symflex.codegen.sampled import DifferenceExporter
        from symflex.state_space.sampled import sampling_of

        if target not in SAMPLED:
            raise refused(f"no sampled code for '{target[:64]}'", f"targets: {', '.join(SAMPLED)}")
        sampling = sampling_of(dt, method, prewarp, "a sampling time")
        return self._exported(DifferenceExporter(SAMPLED[target], sampling, is_direct=direct), name)

    def _export(self, target: str, name: str = "") -> str:
        from symflex.codegen.exporters import EXPORTERS  # the numeric exporters import numpy

        return self._exported(EXPORTERS[target], name, is_read=target == "latex")

    def _exported(self, exporter: Exporter, name: str, *, is_read: bool = False) -> str:
        pairs = self.resolved.transfer_functions
        derived, _ = pipeline.derive_as(self.resolved, pairs, solves=exporter.solves, is_read=is_read)
        return exporter.export(self.resolved, derived, name).text


def load(
    path: str | Path, values: Mapping[str, Setting] | None = None, *, allow_outside: Iterable[str | Path] = ()
) -> Model:
    """Read a specification file.

    Parameters
    ----------
    path : str or Path
        The file.
    values : mapping of str to str or number, optional
        Values that replace those of the file: quantities (``"80 kN/m"``), or numbers in SI
        units. They are checked like the file's own.
    allow_outside : iterable of str or Path
        Folders that its ``model`` blocks may read besides the folder of ``path`` and its subfolders.

    Raises
    ------
    SpecError
        With every problem of the file as ``file:line:col``.
    UsageError
        SF902 an unknown parameter; SF203, SF209 and others that the same value in the file would cause.
    """
    return Model.of(read(Path(path)), values or {}, allow_outside)


def loads(
    text: str,
    name: str = "<string>",
    values: Mapping[str, Setting] | None = None,
    *,
    allow_outside: Iterable[str | Path] = (),
) -> Model:
    """Read a specification from a string; ``name`` is its name in messages, ``values`` as in :func:`load`.

    ``model`` blocks read files in the folder of ``name``, in those of ``allow_outside``, and in their
    subfolders.

    Examples
    --------
    >>> text = '''
    ... symflex = 1
    ... parameters = { m = "2 kg", k = "8 N/m" }
    ... elements.body = { type = "mass", at = "x", m = "m" }
    ... elements.wall = { type = "spring", between = ["x", "ground"], k = "k" }
    ... inputs.F = { force = "x" }
    ... outputs.X = "x"
    ... '''
    >>> model = loads(text, values={"k": "0.018 kN/m"})
    >>> [complex(p) for p in model.transfer_function("X", "F").bind().poles()]
    [3j, -3j]
    """
    return Model.of(Source(name, text), values or {}, allow_outside)
