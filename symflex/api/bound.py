"""A transfer function with numbers: its values, and everything found at its poles and zeros."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from math import inf
from typing import TYPE_CHECKING

from symflex import pipeline
from symflex.analysis import response as response_room
from symflex.analysis.time_response import StepInfo
from symflex.api.mode_shape import ModeShape
from symflex.api.plots import Plotted
from symflex.api.response import FrequencyResponse, TimeResponse
from symflex.api.root import (
    Mode,
    PoleZeroMap,
    Residue,
    ResidueTable,
    Root,
    RootTable,
    Sensitivity,
    SensitivityTable,
    plain_mode,
)
from symflex.budget import Budget, entered_budget
from symflex.errors import Diagnostic, UsageError
from symflex.options import RootsOptions
from symflex.roots.region import region_of

if TYPE_CHECKING:
    import numpy as np
    import sympy
    from numpy.typing import ArrayLike, NDArray

    from symflex import roots as roots_room
    from symflex import transfer as transfer_room
    from symflex.analysis import rational as rational_room
    from symflex.analysis.explanation import ZeroExplanation
    from symflex.analysis.input_shaping import InputShaper
    from symflex.analysis.sampling import SampledTransferFunction
    from symflex.options import Stated
    from symflex.state_space.numeric import BoundStateSpace

POINTS = 201
"""Of a response in time where no times are given."""


@dataclass(frozen=True)
class BoundTransferFunction(Plotted):
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

    def _repr_html_(self) -> str:
        from symflex.print.html import bound_html  # only notebooks ask

        return bound_html(self.bound)

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
        return FrequencyResponse.of(response_room.respond(self.bound, omega))

    def step_response(
        self, times: ArrayLike | None = None, digits: int = 12, shaper: InputShaper | None = None
    ) -> TimeResponse:
        r"""Return the response to a unit step at t = 0, from rest, at increasing times [s] from 0 on.

        Without ``times`` at 201, until the slowest motion has died away or was seen often enough: in a
        notebook ``H.step_response()`` is a figure.

        Every value has a radius, within which the true one is proved to lie where the result says
        ``certified``: ``digits`` digits of the largest value are correct. With a ``shaper``, as of
        :meth:`input_shaper`, the input is convolved by its impulses.

        Raises
        ------
        UsageError
            SF811 for times that are negative or do not increase; SF812, from ``values``, where a response
            grows beyond the range of doubles.
        UncertifiedError
            SF810 when poles cannot be told apart.

        Examples
        --------
        >>> from symflex import loads
        >>> lag = loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/(s + 1)"').transfer_function("y", "u")
        >>> found = lag.bind().step_response([0.0, 1.0, 2.0])
        >>> found.values.round(9).tolist(), bool(found.radius.max() < 1e-12)
        ([0.0, 0.632120559, 0.864664717], True)
        """
        return self._in_time("step", times, digits, shaper)

    def step_info(self, digits: int = 12) -> StepInfo | None:
        r"""Return final value, peak, overshoot, rise and settling time of the step response, each a ball.

        That no later peak is higher, and no later crossing of a level follows, is proved. None where the
        response does not come to rest, or at 0, and of functions with waves or delays.

        Examples
        --------
        >>> from symflex import loads
        >>> text = 'symflex = 1\ninputs.u = {}\noutputs.y = "9*u/(s^2 + 6*s/10 + 9)"'
        >>> info = loads(text).transfer_function("y", "u").bind().step_info()
        >>> round(float(info.overshoot), 9), round(float(info.settling_time), 6)
        (0.729247614, 12.794427)
        """
        from symflex.analysis.time_response import find_step_info

        return find_step_info(self.bound, digits)

    def impulse_response(
        self, times: ArrayLike | None = None, digits: int = 12, shaper: InputShaper | None = None
    ) -> TimeResponse:
        r"""Return the response to a unit impulse at t = 0; see :meth:`step_response`.

        What passes straight through to the output is an impulse itself. It is no value: ``impulses`` holds
        its time and weight, and those of its derivatives.

        Examples
        --------
        >>> from symflex import loads
        >>> lead = loads('symflex = 1\ninputs.u = {}\noutputs.y = "u*(s + 2)/(s + 1)"')
        >>> found = lead.transfer_function("y", "u").bind().impulse_response([0.0])
        >>> found.values.tolist(), [float(i.weight) for i in found.impulses]
        ([1.0], [1.0])
        """
        return self._in_time("impulse", times, digits, shaper)

    def ramp_response(
        self, times: ArrayLike | None = None, digits: int = 12, shaper: InputShaper | None = None
    ) -> TimeResponse:
        """Return the response to the input t from t = 0 on; see :meth:`step_response`."""
        return self._in_time("ramp", times, digits, shaper)

    def forced_response(
        self, times: ArrayLike, u: ArrayLike, digits: int = 12, shaper: InputShaper | None = None
    ) -> TimeResponse:
        r"""Return the response, from rest, to an input that is a straight line between samples.

        Parameters
        ----------
        times : array_like of float, shape (n,)
            Increasing times [s] of the samples, at which the response is given too. Those that are evenly
            spaced but for rounding count as even.
        u : array_like of float, shape (n,)
            The input at these times. It is 0 before the first; where it does not begin with 0, it jumps.
        digits : int
            As for :meth:`step_response`.
        shaper : InputShaper, optional
            Convolves the input by its impulses.

        Raises
        ------
        UsageError
            SF811 for times that do not increase, or values that are no numbers or not as many.
        UncertifiedError
            SF810 as for :meth:`step_response`, and where the transfer function differentiates its input.

        Examples
        --------
        >>> from symflex import loads
        >>> integrator = loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/s"').transfer_function("y", "u")
        >>> integrator.bind().forced_response([0.0, 1.0, 3.0], [0.0, 2.0, 2.0]).values.tolist()
        [0.0, 1.0, 5.0]
        """
        from symflex.analysis.time_response import SampleTimes, exact_values

        instants = SampleTimes.of(times)
        exactly = instants.exactly()
        given = exact_values(u, len(exactly))
        found = pipeline.forced_response(self.bound, exactly, given, exactly, digits, shaper)
        return TimeResponse(**{f.name: getattr(found, f.name) for f in fields(found)})

    def input_shaper(
        self, modes: int = 1, kind: str = "zv", digits: int = 15, *, joint: bool = False
    ) -> InputShaper:
        r"""Return impulses by which a command is convolved so that the lowest modes do not ring after it.

        See :func:`symflex.analysis.input_shaping.input_shaper`.

        Examples
        --------
        >>> from symflex import loads
        >>> arm = loads('symflex = 1\ninputs.u = {}\noutputs.y = "9*u/(s^2 + 9)"').transfer_function("y", "u")
        >>> shaper = arm.bind().input_shaper()
        >>> arm.bind().step_response([shaper.times[-1] / 2, 2.0, 3.0], shaper=shaper).values.round(9).tolist()
        [0.5, 1.0, 1.0]
        """
        from symflex.analysis.input_shaping import input_shaper

        return input_shaper(self.bound, modes, kind, digits, joint=joint)

    def _in_time(
        self, kind: str, times: ArrayLike | None, digits: int, shaper: InputShaper | None
    ) -> TimeResponse:
        from symflex.analysis.time_response import SampleTimes, responses_by_default

        if times is None:
            (found,) = responses_by_default([self.bound], kind, POINTS, digits, shaper)
        else:
            found = pipeline.time_response(self.bound, kind, SampleTimes.of(times), digits, shaper)
        return TimeResponse(**{f.name: getattr(found, f.name) for f in fields(found)})

    def poles(
        self,
        modes: int | None = None,
        *,
        mode: int | None = None,
        band: tuple[float, float] | None = None,
        digits: int = 15,
        budget: float | None = None,
    ) -> tuple[Root, ...]:
        """Return the poles by natural frequency, both members of each conjugate pair.

        Poles in the right half plane are always among them: those outside of what was asked for stand at the
        end. :attr:`PoleZeroMap.verdict` of :meth:`pole_zero_map` says whether they are all.

        Parameters
        ----------
        modes : int, optional
            Only the lowest modes, with the roots at the origin. For a distributed system the model's
            ``[analysis]`` decides when nothing else is asked for, and else the number is five.
        mode : int, optional
            Only the mode of this number, from 1 by natural frequency, both members of a conjugate pair; of a
            lossless system it is found without those below it.
        band : (float, float), optional
            Only natural frequencies in this band [Hz].
        digits : int
            Correct significant digits.
        budget : float, optional
            Time the search may take [s].

        Raises
        ------
        BudgetError
            SF505, SF506 when the search takes too long: its ``found`` is a
            :class:`~symflex.roots.PoleZeroMap` with all that was proved until then, ``None`` if that is
            nothing.
        UsageError
            SF902 for more than one choice, or one that is impossible.

        Examples
        --------
        >>> from symflex import Model
        >>> from symflex.errors import BudgetError
        >>> rod = Model(
        ...     elements={
        ...         "bar": {"type": "rod", "between": ["ground", "x"], "E": "1 Pa", "A": "1 m^2",
        ...                 "rho": "1 kg/m^3", "l": "1 m"},
        ...     },
        ...     inputs={"F": {"force": "x"}},
        ...     outputs={"X": "x"},
        ... ).transfer_function("X", "F").bind()
        >>> upper, lower = rod.poles(mode=1000)  # (1000 - 1/2) pi
        >>> upper
        <Root 0, 3140.02185726 j, radius ...
        >>> try:
        ...     poles = rod.poles(modes=2, budget=60)
        ... except BudgetError as error:
        ...     poles = () if error.found is None else error.found.poles
        >>> [round(float(p.im), 6) for p in poles]
        [1.570796, -1.570796, 4.712389, -4.712389]
        """
        found = self._found(RootsOptions(None, modes, mode, band, digits=digits), budget)
        return RootTable(Root(r) for r in found.all_poles)

    def zeros(
        self,
        modes: int | None = None,
        *,
        mode: int | None = None,
        band: tuple[float, float] | None = None,
        digits: int = 15,
        budget: float | None = None,
    ) -> tuple[Root, ...]:
        """Return the zeros; see :meth:`poles`."""
        found = self._found(RootsOptions(None, modes, mode, band, digits=digits), budget)
        return RootTable(Root(r) for r in found.zeros)

    def _found(self, given: RootsOptions, budget: float | None) -> PoleZeroMap:
        """Return the map if the budget suffices: a tuple of roots could not say that it did not."""
        return PoleZeroMap.of(self._map(given, budget).complete())

    def _map(self, given: RootsOptions, budget: float | None) -> roots_room.PoleZeroMap:
        digits = 15 if given.digits is None else given.digits
        return pipeline.roots(self.bound, region_of(given), digits, budget_of(budget))

    def pole_zero_map(
        self,
        digits: int = 15,
        *,
        modes: int | None = None,
        mode: int | None = None,
        band: tuple[float, float] | None = None,
        region: tuple[float, float, float, float] | None = None,
        budget: float | None = None,
    ) -> PoleZeroMap:
        r"""Return poles, zeros and hidden modes with their certificate.

        Parameters
        ----------
        digits, modes, mode, band : optional
            As for :meth:`poles`, of poles and zeros alike.
        region : (float, float, float, float), optional
            Only the rectangle ``(re_low, re_high, im_low, im_high)`` [rad/s].
        budget : float, optional
            Time the search may take [s]. When it is over, what was proved is returned: every root is, but not
            that none is missing, and ``certificate.is_exceeded`` is true. Without it, the search of a
            distributed system is limited by the work it does.

        Raises
        ------
        BudgetError
            SF505, SF506 when nothing but roots at 0 was found of a distributed system.
        UsageError
            SF902 for more than one choice, or one that is impossible.

        Examples
        --------
        >>> from symflex import loads
        >>> loop = loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/((s^2 + 1)*(s^2 + 9))"')
        >>> found = loop.transfer_function("y", "u").bind().pole_zero_map(6, mode=2, budget=60)
        >>> [root.decimal(6).im for root in found.poles], found.certificate.is_exceeded
        (['3.00000', '-3.00000'], False)
        """
        return PoleZeroMap.of(self._map(RootsOptions(None, modes, mode, band, region, digits), budget))

    def residues(
        self,
        modes: int | None = None,
        *,
        mode: int | None = None,
        band: tuple[float, float] | None = None,
        digits: int = 15,
        budget: float | None = None,
    ) -> tuple[Residue, ...]:
        r"""Return the residues at the poles, in their order; see :meth:`poles`.

        Parameters
        ----------
        modes, mode, band, digits, budget : optional
            As for :meth:`poles`: at which poles, and how they are searched for.

        Raises
        ------
        UncertifiedError
            SF405 when poles cannot be told apart, or the behaviour at one cannot be told.
        BudgetError
            As for :meth:`poles`.

        Examples
        --------
        >>> from symflex import loads
        >>> loop = loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/((s + 1)*(s + 3))"')
        >>> [complex(r) for r in loop.transfer_function("y", "u").bind().residues(mode=2)]
        [(-0.5+0j)]
        """
        region = region_of(RootsOptions(None, modes, mode, band))
        return ResidueTable(
            Residue(r) for r in pipeline.residues(self.bound, region, digits, budget_of(budget))
        )

    def rational(
        self, modes: int | None = None, form: str = "product", *, band: tuple[float, float] | None = None
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
        mode: int | None = None,
        band: tuple[float, float] | None = None,
        digits: int = 15,
        budget: float | None = None,
    ) -> tuple[Sensitivity, ...]:
        """Return how poles, and then zeros, move with parameters.

        Parameters
        ----------
        modes, mode, band, budget : optional
            As for :meth:`poles`; the budget is for the search for the roots.
        parameters : sequence of str
            All on which the function depends when none is given.
        digits : int
            Correct significant digits of every derivative.

        Raises
        ------
        UsageError
            SF902 for an unknown parameter.
        BudgetError
            As for :meth:`poles`.
        """
        found = self._found(RootsOptions(None, modes, mode, band, digits=digits), budget)
        model = self.bound.source.model
        return SensitivityTable(
            Sensitivity(m) for m in pipeline.sensitivities(model, self.bound, found, parameters, digits)
        )

    def explain_zeros(
        self,
        modes: int | None = None,
        *,
        mode: int | None = None,
        band: tuple[float, float] | None = None,
        digits: int = 15,
        budget: float | None = None,
    ) -> ZeroExplanation:
        """Return what the zeros are the poles of; print it to read it.

        Parameters
        ----------
        modes, mode, band, digits, budget : optional
            As for :meth:`zeros`: which zeros are spoken of one by one.

        Raises
        ------
        BudgetError
            As for :meth:`poles`.
        """
        found = self._found(RootsOptions(None, modes, mode, band, digits=digits), budget)
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
        from symflex.analysis.modes import mode_shape

        return ModeShape(mode_shape(self.bound, plain_mode(mode), digits), self.bound.source.model)

    def mode_shapes(self, mode: Mode, digits: int = 15) -> tuple[ModeShape, ...]:
        """Return all independent shapes of a mode's pole: more than one where equal parts move alike.

        Several are a basis: in each, one of as many places is at 1 and the others are at rest, before the
        largest displacement is made 1. See :meth:`mode_shape`.
        """
        from symflex.analysis.modes import mode_shapes

        found = mode_shapes(self.bound, plain_mode(mode), digits)
        return tuple(ModeShape(shape, self.bound.source.model) for shape in found)

    def state_space(self, *, minimal: bool = False) -> BoundStateSpace:
        """Return state equations of the model's network as arrays, every entry rounded once.

        The states are displacements and velocities of nodes, currents, voltages; see :class:`StateSpace`.

        Parameters
        ----------
        minimal : bool
            Leave out what the input does not reach or the output does not show. The states left are
            quantities of the model, or differences and other combinations of them.

        Raises
        ------
        ModelError
            SF235 for beams, rods and delays, SF236 when the function grows with s.
        """
        from symflex.analysis.rational.toolboxes import ExactFunction

        return ExactFunction(self.bound, is_minimal=minimal).state_space()

    def discretise(
        self, dt: Stated, method: str = "zoh", prewarp: Stated | None = None
    ) -> SampledTransferFunction:
        r"""Return the function from one sample to the next, with its poles and zeros in z.

        Parameters
        ----------
        dt : float, Fraction or str
            The sampling time, [s] or with a unit, ``"1 ms"``.
        method : str
            ``zoh``, the input held between samples, exactly, with dead times of any fraction; for controllers
            ``tustin``, the bilinear transformation, and ``matched``, every root s becomes exp(s dt).
        prewarp : float, Fraction or str, optional
            Of ``tustin``: the frequency at which it is right besides at 0, [Hz] or with a unit.

        Raises
        ------
        UsageError
            SF902 for a method, a time or a frequency that cannot be.
        ModelError
            SF235 for beams, and delays in loops; SF236 for a function that grows with s.

        Examples
        --------
        >>> from symflex import loads
        >>> lag = loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/(s + 2)"').transfer_function("y", "u")
        >>> lag.bind().discretise("100 ms", "tustin").coefficients()
        (array([0.04545455, 0.04545455]), array([ 1.        , -0.81818182]))
        """
        from symflex.analysis.sampling import sampled_transfer_function
        from symflex.state_space.sampled import sampling_of

        return sampled_transfer_function(self.bound, sampling_of(dt, method, prewarp, "a sampling time"))

    def to_control(self, form: str = "transfer-function", *, minimal: bool = False) -> object:
        """Return a system of python-control with named input, output and states.

        Parameters
        ----------
        form : str
            ``transfer-function``; or ``state-space``, see :meth:`state_space`, which loses far fewer digits
            where the degree is high.
        minimal : bool
            For ``state-space``.

        Returns
        -------
        control.TransferFunction or control.StateSpace
            Coefficients are the doubles nearest to the exact ones. The attribute ``metadata`` holds units and
            ``coefficients_error``, what rounding coefficients does to the function.

        Raises
        ------
        ModelError
            SF235 for beams, rods and delays: :meth:`rational` first; SF233 when a coefficient does not fit in
            double precision; SF236 as for :meth:`state_space`.
        UsageError
            SF902 when python-control is not installed, and for an unknown form.
        """
        from symflex.analysis.rational.toolboxes import ExactFunction

        return ExactFunction(self.bound, is_minimal=minimal).to_control(form)

    def to_frd(self, omega: ArrayLike) -> object:
        """Return a ``control.FrequencyResponseData``, of beams and delays too, without approximation.

        Parameters
        ----------
        omega : array_like of float
            Increasing angular frequencies [rad/s], none of them negative or at a pole.

        Raises
        ------
        UsageError
            SF902 when python-control is not installed, for other frequencies, and at a pole.
        """
        from symflex.analysis.rational.toolboxes import end_units, frequency_response_data

        source = self.bound.source
        label = f"{source.output.name}_over_{source.input.name}"
        return frequency_response_data(source, self.bound, omega, label, end_units(source))

    def to_scipy(self, form: str = "zeros-poles-gain", *, minimal: bool = False) -> object:
        """Return a system of ``scipy.signal``.

        Parameters
        ----------
        form : str
            ``zeros-poles-gain``, from the proved roots, which loses no digits; ``transfer-function``;
            ``state-space``.
        minimal : bool
            For ``state-space``.

        Returns
        -------
        scipy.signal.ZerosPolesGain, TransferFunction or StateSpace
            Its attribute ``metadata`` holds names and units.

        Raises
        ------
        ModelError, UsageError
            As :meth:`to_control`.
        """
        from symflex.analysis.rational.toolboxes import ExactFunction

        return ExactFunction(self.bound, is_minimal=minimal).to_scipy(form)

    def to_sympy(self) -> sympy.Basic:
        """Return a ``sympy.physics.control.TransferFunction`` of ``s`` with exact coefficients.

        Raises
        ------
        ModelError
            SF235 for beams, rods and delays.
        """
        from symflex.print.sympy import sympy_system

        return sympy_system(self.bound)

    def dcgain(self) -> float:
        """Return the limit for s -> 0 from the right, possibly infinite."""
        return self.bound.limit_at_zero()


def budget_of(seconds: float | None) -> Budget:
    """Return a budget of so many seconds that starts now, the one that is entered when no time is given.

    Raises UsageError: SF902 when the time is not positive and finite.

    Examples
    --------
    >>> budget_of(2.5).seconds
    2.5
    """
    if seconds is None:
        return entered_budget()
    if not 0 < seconds < inf:
        raise UsageError(Diagnostic("SF902", f"a budget is a positive time in seconds, not {seconds}"))
    return Budget(seconds)
