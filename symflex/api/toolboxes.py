"""What programs for control design call a system: the methods that both kinds of bound functions share."""

from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn

from symflex.model.loss_factors import check_causal

if TYPE_CHECKING:
    import sympy
    from numpy.typing import ArrayLike

    from symflex.analysis.sampling import SampledTransferFunction
    from symflex.options import Stated
    from symflex.state_space.numeric import BoundStateSpace
    from symflex.transfer import AnyBoundFunction, BoundTransferFunction


CALLED = {
    "derive": "transfer_function",
    "tf": "transfer_function",
    "roots": "poles",
    "damp": "poles",
    "pzmap": "pole_zero_plot",
    "step": "step_response",
    "impulse": "impulse_response",
    "ramp": "ramp_response",
    "respond": "step_response",
    "lsim": "forced_response",
    "freqresp": "frequency_response",
    "c2d": "discretise",
    "residue": "residues",
    "modes": "mode_shapes",
    "plot": "bode",
    "margin": "stability",
    "margins": "stability",
    "is_stable": "stability",
    "root_locus": "locus",
    "export": "export_numpy",
    "save": "to_toml",
}
"""Methods by what commands, MATLAB and python-control call them."""
OF_LOOPS = ("stability", "locus", "colocation", "sweep")  # methods of a model alone


def refuse_attribute(item: object, name: str, bound: type | None = None, way: str = "G.bind()") -> NoReturn:
    """Say what an attribute is called here, or the way to what has numbers, which is ``bound``."""
    message = f"'{type(item).__name__}' object has no attribute '{name}'"
    called = CALLED.get(name, name)
    if called != name and hasattr(type(item), called):
        message += f"; it is called {called}"
    elif not name.startswith("_") and hasattr(bound, called):
        message += f"; a function has it once it has numbers: {way}.{called}"
    elif called in OF_LOOPS:
        message += f"; it is asked of a model, model.{called}"
    raise AttributeError(message, name=name, obj=item)


class Toolboxes:
    """State equations, samples, and systems of python-control, scipy and SymPy.

    ``bound`` is the function of ``transfer``, ``_expanded`` the same as a quotient of polynomials.
    """

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> NoReturn:
            refuse_attribute(self, name)

    if TYPE_CHECKING:

        @property
        def bound(self) -> AnyBoundFunction:
            """What is handed over."""

        @property
        def _expanded(self) -> BoundTransferFunction:
            """A quotient of polynomials."""

    def state_space(self, *, minimal: bool = False) -> BoundStateSpace:
        """Return state equations of the model's network as arrays, every entry rounded once.

        The states are displacements and velocities of nodes, currents, voltages; see :class:`StateSpace`.

        Parameters
        ----------
        minimal : bool
            Leave out uncontrollable and unobservable states. The states left are
            quantities of the model, or differences and other combinations of them.

        Raises
        ------
        ModelError
            SF235 for beams, rods and delays, SF236 when the function grows with s.
        """
        from symflex.analysis.rational.toolboxes import ExactFunction

        return ExactFunction(self._expanded, is_minimal=minimal).state_space()

    def discretise(
        self, dt: Stated, method: str = "zoh", prewarp: Stated | None = None
    ) -> SampledTransferFunction:
        r"""Return the function from one sample to the next, with its poles and zeros in z.

        Parameters
        ----------
        dt : float, Fraction or str
            The sampling time, [s] or with a unit, ``"1 ms"``.
        method : str
            ``zoh``, the exact step with the input held between samples, with delays of any fraction.
            For controllers: ``tustin``, the bilinear transformation, or ``matched``, where every root s
            becomes exp(s dt).
        prewarp : float, Fraction or str, optional
            For ``tustin``: the frequency at which it is exact in addition to 0, [Hz] or with a unit.

        Raises
        ------
        UsageError
            SF902 for an impossible method, time or frequency.
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

        return sampled_transfer_function(self._expanded, sampling_of(dt, method, prewarp, "a sampling time"))

    def to_control(self, form: str = "transfer-function", *, minimal: bool = False) -> object:
        """Return a system of python-control with named input, output and states.

        Parameters
        ----------
        form : str
            ``transfer-function``; or ``state-space``, see :meth:`state_space`, which loses far fewer digits
            if the degree is high.
        minimal : bool
            For ``state-space``.

        Returns
        -------
        control.TransferFunction or control.StateSpace
            Coefficients are the doubles nearest to the exact ones. The attribute ``metadata`` has units
            and ``coefficients_error``, the error of the function that comes from rounding coefficients.

        Raises
        ------
        ModelError
            SF235 for beams, rods and delays: use :meth:`rational` first; SF233 when a coefficient does not
            fit in double precision; SF236 as for :meth:`state_space`.
        UsageError
            SF902 when python-control is not installed, and for an unknown form.
        """
        from symflex.analysis.rational.toolboxes import ExactFunction

        return ExactFunction(self._expanded, is_minimal=minimal).to_control(form)

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
            ``zeros-poles-gain``, from the certified roots, which loses no digits; ``transfer-function``;
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

        return ExactFunction(self._expanded, is_minimal=minimal).to_scipy(form)

    def to_sympy(self) -> sympy.Basic:
        """Return a ``sympy.physics.control.TransferFunction`` of ``s`` with exact coefficients.

        Raises
        ------
        ModelError
            SF235 for beams, rods and delays.
        """
        from symflex.print.sympy import sympy_system

        return sympy_system(self._expanded)

    def dcgain(self) -> float:
        """Return the limit for s -> 0 from the right, possibly infinite; it is proved to the last digit.

        Raises
        ------
        UncertifiedError
            SF405 when it cannot be decided.
        """
        from symflex.analysis.rational.laurent import limit_at_zero

        check_causal(self.bound.source.model, "a value at s = 0")
        return float(limit_at_zero(self.bound).mid())
