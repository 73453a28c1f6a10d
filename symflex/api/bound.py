"""A transfer function with numbers: its values, and everything found at its poles and zeros."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

from symflex import pipeline
from symflex.api.analyses import Analyses
from symflex.api.response import TimeResponse
from symflex.api.root import Sensitivity, SensitivityTable
from symflex.model.loss_factors import check_causal
from symflex.options import RootsOptions

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    import sympy
    from numpy.typing import ArrayLike, NDArray

    from symflex import transfer as transfer_room
    from symflex.analysis.explanation import ZeroExplanation
    from symflex.analysis.input_shaping import InputShaper
    from symflex.analysis.sampling import SampledTransferFunction
    from symflex.options import Stated
    from symflex.state_space.numeric import BoundStateSpace


@dataclass(frozen=True)
class BoundTransferFunction(Analyses):
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
        if not ((points.real == 0) & (points.imag > 0)).all():
            check_causal(self.bound.source.model, "a value at another s")
        if points.ndim == 0:
            return self.bound(complex(points))
        values = np.array([self.bound(complex(p)) for p in points.ravel()], dtype=complex)
        return values.reshape(points.shape)

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
        check_causal(self.bound.source.model, "a value at s = 0")
        return self.bound.limit_at_zero()
