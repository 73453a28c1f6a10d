"""What is asked of a transfer function with numbers, expanded or nested."""

from __future__ import annotations

from functools import partial
from math import inf
from typing import TYPE_CHECKING

from symflex.analysis import response as response_layer
from symflex.analysis.time_response import StepInfo
from symflex.api.face import face_of
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
from symflex.errors import refused
from symflex.options import POINTS, Ends, RootsOptions, Stated, band_ends, checked_digits, duration
from symflex.print.sympy import symbols_of
from symflex.roots.locate import locate
from symflex.roots.region import region_of
from symflex.symbolic.frequency_equation import symbolic_roots

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from symflex import roots as roots_layer
    from symflex.analysis.explanation import ZeroExplanation
    from symflex.analysis.input_shaping import InputShaper
    from symflex.analysis.norms.energy import H2Norm
    from symflex.analysis.norms.reduced import ReducedModel
    from symflex.analysis.rational import RationalApproximation
    from symflex.loops.clouds import RootCloud
    from symflex.loops.peak import Peak
    from symflex.transfer.nested_form import AnyTransferFunction


class Analyses(Plotted):
    """Responses, poles and zeros, and what follows from them; each is proved, or says that it is not."""

    def frequency_response(self, omega: ArrayLike) -> FrequencyResponse:
        """Return the response at real angular frequencies [rad/s]."""
        return face_of(FrequencyResponse, response_layer.respond(self.bound, omega))

    def peak(self, digits: int = 12, band: Ends | None = None) -> Peak:
        """Return the largest magnitude over all frequencies, or in a band [Hz]; see :meth:`Model.peak`."""
        from symflex.loops.peak import find_peak

        return find_peak(self.bound, checked_digits(digits), band)

    def h2(self, noise: str = "") -> H2Norm:
        """Return the H2 norm: the RMS of the output when white noise of two-sided density 1 per Hz drives it.

        Parameters
        ----------
        noise : str
            What shapes the noise: an expression in s and the model's parameters, such as ``"1/(s + 2)"``.

        Raises
        ------
        UncertifiedError
            SF802 where no principal parts are known; SF405 where stability or residues are not.

        Examples
        --------
        >>> import symflex
        >>> model = symflex.Model(inputs={"u": {}}, outputs={"y": "u/(s + 2)"})
        >>> print(f"{float(model.transfer_function('y', 'u').bind().h2().value):.6f}")
        0.500000
        """
        from symflex.analysis.norms.energy import find_h2_norm, noise_filter

        return find_h2_norm([[self.bound]], noise_filter(self._stated.model, noise), noise)

    def reduced(
        self, modes: int | None = None, *, error: Stated | None = None, band: Ends | None = None
    ) -> ReducedModel:
        """Return state equations of a few modes, with a proved error over all frequencies.

        Parameters
        ----------
        modes : int, optional
            How many modes are kept; by default as many as the model's ``[analysis]`` gives, else five.
        error : float or str, optional
            In place of ``modes``: the largest error relative to the static value; as few modes as it takes.
        band : (float, float), optional
            Frequencies of the error [Hz]; by default all. If a mode without damping is left out, by default
            those up to the highest mode that is kept.

        Raises
        ------
        UsageError
            SF902 for a number of modes or an error that is none.
        UncertifiedError
            SF802 where no principal parts are known; SF405 where residues are not.
        ModelError
            SF236 for functions that grow with frequency; SF402 for an error without static value.

        Examples
        --------
        >>> import symflex
        >>> model = symflex.Model(inputs={"u": {}}, outputs={"y": "u/(s + 1) + u/(s + 100)"})
        >>> R = model.transfer_function("y", "u").bind().reduced(1)
        >>> R.certified, len(R.state_space().A), f"{R.error.least.lower().str(4, radius=False)}"
        (True, 1, '0.01000')
        """
        from symflex.analysis.norms.reduced import reduced_model

        return reduced_model([[self.bound]], modes, error, band_in_hertz(band))

    def step_response(
        self, times: ArrayLike | None = None, digits: int = 12, shaper: InputShaper | None = None
    ) -> TimeResponse:
        r"""Return the response to a unit step at t = 0, from rest, at increasing times [s] from 0 on.

        Without ``times``, there are 201 of them, until the slowest motion has died away or has repeated
        often enough; ``times = "1 s"``, or 1, is the last of 201. In a notebook, the result is a figure.

        Every value has a radius. If the result says ``certified``, the true value is proved to lie within
        it, and ``digits`` digits of the largest value are correct. A ``shaper``, from :meth:`input_shaper`,
        convolves the input with its impulses.

        Raises
        ------
        UsageError
            SF811 for times that are negative or do not increase; SF812 when ``values`` are read and the
            response grows beyond the range of doubles, or at once if it grows beyond 10^100000.
        UncertifiedError
            SF810 when poles cannot be separated.

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

        It is proved that no later peak is higher, and that no level is crossed again later. The result is
        None if the response does not come to rest, comes to rest at 0, jumps after delays, or is not proved.

        Examples
        --------
        >>> from symflex import loads
        >>> text = 'symflex = 1\ninputs.u = {}\noutputs.y = "9*u/(s^2 + 6*s/10 + 9)"'
        >>> info = loads(text).transfer_function("y", "u").bind().step_info()
        >>> round(float(info.overshoot), 9), round(float(info.settling_time), 6)
        (0.729247614, 12.794427)
        """
        from symflex.analysis.time_response import find_step_info

        return find_step_info(self.bound, checked_digits(digits))

    def impulse_response(
        self, times: ArrayLike | None = None, digits: int = 12, shaper: InputShaper | None = None
    ) -> TimeResponse:
        r"""Return the response to a unit impulse at t = 0; see :meth:`step_response`.

        If the function has direct feedthrough, the response contains an impulse, which has no
        value: ``impulses`` contains its time and weight, and those of its derivatives.

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

    def input_shaper(
        self, modes: int = 1, kind: str = "zv", digits: int = 15, *, joint: bool = False
    ) -> InputShaper:
        r"""Return impulses to convolve with a command, so that the lowest modes do not ring after it.

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

        return input_shaper(self.bound, modes, kind, checked_digits(digits), joint=joint)

    def _in_time(
        self, kind: str, times: ArrayLike | None, digits: int, shaper: InputShaper | None
    ) -> TimeResponse:
        from symflex.analysis.time_response import SampleTimes, responses_by_default, time_response

        checked_digits(digits)
        if times is None:
            (response,) = responses_by_default([self.bound], kind, POINTS, digits, shaper)
        else:
            if isinstance(times, str | int | float):
                given = SampleTimes.evenly(duration(str(times), "the last time"), POINTS)
            else:
                given = SampleTimes.of(times)
            response = time_response(self.bound, kind, given, digits, shaper)
        return face_of(TimeResponse, response)

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

        Poles in the right half-plane are always included; those outside the requested region come last.
        :attr:`PoleZeroMap.verdict` of :meth:`pole_zero_map` tells whether these are all.

        Parameters
        ----------
        modes : int, optional
            Only the lowest modes, with the roots at the origin. For a distributed system, the default is
            the number in the model's ``[analysis]``, or five.
        mode : int, optional
            Only the mode of this number, from 1 by natural frequency, both members of a conjugate pair; in an
            undamped system it is found without those below it.
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
            :class:`~symflex.roots.PoleZeroMap` with all roots certified so far, ``None`` if there are none.
        UsageError
            SF902 for more than one choice, or one that is impossible.

        Examples
        --------
        >>> from symflex import Model
        >>> from symflex.errors import BudgetError
        >>> bar = {"type": "rod", "between": ["ground", "x"], "E": 1, "A": 1, "rho": 1, "l": 1}
        >>> model = Model(elements={"bar": bar}, inputs={"F": {"force": "x"}}, outputs={"X": "x"})
        >>> rod = model.transfer_function("X", "F").bind()
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
        located = self._found(RootsOptions(None, modes, mode, band, digits=digits), budget)
        return self._table(located, located.all_poles)

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
        located = self._found(RootsOptions(None, modes, mode, band, digits=digits), budget)
        return self._table(located, located.zeros)

    @property
    def _stated(self) -> AnyTransferFunction:
        """The function with all parameters, also with those that are 0 and were left out."""
        symbolic = self.bound.symbolic if self.bound.is_reduced else None
        return symbolic or self.bound.source

    def _table(self, located: PoleZeroMap, listed: Sequence[roots_layer.Root]) -> RootTable:
        factors = partial(symbolic_roots, self.bound.source, self.bound, located)
        return RootTable(Root(root, factors, symbols_of(self.bound.source.model)) for root in listed)

    def _found(self, given: RootsOptions, budget: float | None) -> PoleZeroMap:
        """Return the map if the budget suffices: a tuple of roots could not say that it did not."""
        return face_of(PoleZeroMap, self._map(given, budget).complete())

    def _map(self, given: RootsOptions, budget: float | None) -> roots_layer.PoleZeroMap:
        digits = checked_digits(15 if given.digits is None else given.digits)
        with budget_of(budget).besides().entered():
            return locate(self.bound, region_of(given), digits)

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
            Time the search may take [s]. When it runs out, the roots certified so far are returned; others
            may be missing, and ``certificate.is_exceeded`` is true. Without it, a
            fixed amount of work limits the search of a distributed system.

        Raises
        ------
        BudgetError
            SF505, SF506 if only roots at 0 were found for a distributed system.
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
        return face_of(PoleZeroMap, self._map(RootsOptions(None, modes, mode, band, region, digits), budget))

    def root_clouds(
        self, spread: str | float, modes: int | None = None, *, budget: float | None = None
    ) -> tuple[RootCloud, ...]:
        r"""Return rectangles that poles and zeros do not leave for any combination of values.

        Parameters
        ----------
        spread : str or float
            How far every parameter is off, "10 %" or 0.1; "" for those that declare a ``spread``.
        modes, budget : optional
            As for :meth:`poles`.

        Examples
        --------
        >>> from symflex import loads
        >>> text = 'symflex = 1\nparameters.T = 0.5\ninputs.u = {}\noutputs.y = "u/(T*s + 1)"'
        >>> (cloud,) = loads(text).transfer_function("y", "u").bind().root_clouds("10 %")
        >>> cloud.kind, cloud.count, cloud.sides[0] < -1 / 0.45 < -1 / 0.55 < cloud.sides[1]
        ('pole', 1, True)
        """
        from symflex.loops.clouds import root_clouds  # not needed for roots

        located = self._found(RootsOptions(None, modes), budget)
        return root_clouds(self.bound, located, spread, self._stated.model)

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

        Parameters and errors are those of :meth:`poles`. UncertifiedError: SF405 when poles cannot be
        separated, or the behaviour at one cannot be determined.

        Examples
        --------
        >>> from symflex import loads
        >>> loop = loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/((s + 1)*(s + 3))"')
        >>> [complex(r) for r in loop.transfer_function("y", "u").bind().residues(mode=2)]
        [(-0.5+0j)]
        """
        from symflex.analysis.rational import find_residues  # not needed for roots

        region = region_of(RootsOptions(None, modes, mode, band))
        with budget_of(budget).besides().entered():
            return ResidueTable(Residue(r) for r in find_residues(self.bound, region, checked_digits(digits)))

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
        """Return how poles and zeros move with parameters, poles first.

        Parameters
        ----------
        modes, mode, band, budget : optional
            As for :meth:`poles`; the budget is for the search for the roots.
        parameters : sequence of str
            By default all parameters on which the function depends.
        digits : int
            Correct significant digits of every derivative.

        Raises
        ------
        UsageError
            SF902 for an unknown parameter.
        BudgetError
            As for :meth:`poles`.
        """
        from symflex.analysis.sensitivity.sensitivity import sensitivities  # not needed for roots

        located = self._found(RootsOptions(None, modes, mode, band, digits=digits), budget)
        model = self._stated.model
        return SensitivityTable(
            Sensitivity(m) for m in sensitivities(model, self.bound, located, parameters, digits)
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
        """Return the system whose poles are the zeros, with the proof; print the result to read it.

        Parameters and errors are those of :meth:`zeros`; they choose the zeros that the text names.
        """
        from symflex.analysis.explanation import explain_zeros  # not needed for roots

        located = self._found(RootsOptions(None, modes, mode, band, digits=digits), budget)
        return explain_zeros(self._stated.model, self.bound, located)

    def rational(
        self, modes: int | None = None, form: str = "product", *, band: tuple[float, float] | None = None
    ) -> RationalApproximation:
        """Return a rational approximation, with its error along the imaginary axis.

        Parameters
        ----------
        modes : int, optional
            How many modes are kept, in addition to roots at the origin. By default those up to the end of
            ``band``, else as many as the model's ``[analysis]`` gives, else five.
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
            SF405 when residues, or the behaviour near s = 0, cannot be determined.
        """
        from symflex.analysis.rational import approximate  # not needed for roots

        return approximate(self.bound, modes, form, band_in_hertz(band))

    def mode_shape(self, mode: Mode, digits: int = 15) -> ModeShape:
        """Return how the model moves in one mode; the largest displacement is 1.

        The shape comes from the model's equations, not from the transfer function, so hidden modes have one
        too.

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

        return ModeShape(
            mode_shape(self.bound, plain_mode(mode), checked_digits(digits)), self.bound.source.model
        )

    def mode_shapes(self, mode: Mode, digits: int = 15) -> tuple[ModeShape, ...]:
        """Return all independent shapes of a mode's pole: more than one where equal parts move alike.

        Several shapes form a basis: n shapes have n places, and each is 1 at one and 0 at the others, before
        it is scaled to a largest displacement of 1. See :meth:`mode_shape`.
        """
        from symflex.analysis.modes import mode_shapes

        shapes = mode_shapes(self.bound, plain_mode(mode), checked_digits(digits))
        return tuple(ModeShape(shape, self.bound.source.model) for shape in shapes)


def band_in_hertz(band: Ends | None) -> tuple[float, float] | None:
    """Return the ends of a band in Hz; SF227 for one that is none."""
    if band is None:
        return None
    low, high = band_ends(band)
    return float(low), float(high)


def budget_of(seconds: float | None) -> Budget:
    """Return a budget of so many seconds that starts now, the one that is entered when no time is given.

    Raises UsageError: SF902 when the time is not positive and finite.

    >>> budget_of(2.5).seconds
    2.5
    """
    if seconds is None:
        return entered_budget()
    if not 0 < seconds < inf:
        raise refused(f"a budget must be a positive time in seconds, not {seconds}")
    return Budget(seconds)
