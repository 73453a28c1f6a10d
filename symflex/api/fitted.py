"""Resonances, and parameters of a specification, fitted to measured frequency responses."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Literal, overload

import numpy as np

from symflex.api.model import Model, loads
from symflex.data.measurement import Estimate, MeasuredResponse, prepared, read_measurement
from symflex.options import FitOptions
from symflex.pipeline import fit_parameters
from symflex.print.notebook import Printed

if TYPE_CHECKING:
    import numpy.typing as npt
    from matplotlib.figure import Figure

    from symflex.analysis.input_shaping import InputShaper
    from symflex.data import fitting
    from symflex.data.fitting.resonances import Resonances
    from symflex.figures import AxesGiven
    from symflex.print.text import Passage

    Real = npt.NDArray[np.float64]
    Complex = npt.NDArray[np.complex128]

Data = str | Path | MeasuredResponse


@dataclass(frozen=True, eq=False)
class Fit(Printed):
    """Resonances that fit measured responses, with standard errors.

    Parameters
    ----------
    found : symflex.data.fitting.ResonanceFit
        The fit in full: data, start, residuals, covariance.
    """

    found: fitting.ResonanceFit

    @property
    def resonances(self) -> Resonances:
        """Poles ``omega_p`` [rad/s], ``zeta_p``, shape (n,), and zeros ``omega_z``, ``zeta_z``, (m, n)."""
        return self.found.resonances

    @property
    def standard_errors(self) -> Resonances:
        """Standard errors of :attr:`resonances`, in the same shapes; 0 for what was not fitted."""
        return self.found.standard_errors()

    @property
    def frequencies_hz(self) -> Real:
        """Natural frequencies of the resonances in the band [Hz], ascending."""
        return self.resonances.omega_p[self.found.modes] / (2 * np.pi)

    @property
    def is_minimum_phase(self) -> tuple[bool, ...]:
        """Whether a minimum-phase function has the measured magnitude and phase, for each response.

        Also False if the data do not decide it; ``found.phase_tests`` has the three verdicts.
        """
        return tuple(test.is_minimum_phase for test in self.found.phase_tests)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Cautions about the fit, as sentences."""
        return self.found.warnings

    @property
    def poor(self) -> tuple[str, ...]:
        """Why the fit is poor: its numbers may be off by more than their errors; empty for a good fit."""
        return self.found.poor

    def values(self, response: int = 0) -> Complex:
        """Return the fitted function on the lines of one response, shape (k,)."""
        return self.found.values(response)

    def specification(self, folder: str | Path = ".", loop: str | None = None) -> str:
        """Return the text of a specification for a folder; it refers to the base or copies it.

        ``loop`` is the name of a gain: a loop is closed with it, from the first response to the input.
        """
        from symflex.data.fitting.specification import fit_specification  # imports scipy

        return fit_specification(self.found, folder, loop)

    def model(self) -> Model:
        """Return the fitted model, which derives, prints and exports like any other."""
        # Specifications given as text refer to files from the current folder.
        allowed = {folder for base in self.found.bases for folder in base.folders}
        return loads(self.specification(Path()), "<fit>", allow_outside=allowed)

    def input_shaper(self, modes: int = 1, kind: str = "zv", *, joint: bool = False) -> InputShaper:
        """Return an input shaper for the lowest resonances."""
        first, *_ = self.model().transfer_functions()
        return first.bind().input_shaper(modes, kind, joint=joint)

    def plot(self, response: int = 0, *, ax: AxesGiven | None = None) -> Figure:
        """Return a figure of data, fit and residual of one response, as ``symflex fit --plot`` draws it.

        Two axes of your own, ``ax``, get magnitude and phase in your own style.

        Raises
        ------
        UsageError
            SF902 for too many axes or too few.
        """
        from symflex.figures import draw_fit  # imports matplotlib

        return draw_fit(self.found, response, ax)

    def to_json_dict(self) -> dict[str, object]:
        """Return the result in the schema ``symflex.fit/1``."""
        from symflex.data.fitting.text import fit_json

        return fit_json(self.found)

    def passages(self) -> Iterator[Passage]:
        """Return the report."""
        from symflex.data.fitting.text import fit_passages

        return fit_passages(self.found, None)

    def __repr__(self) -> str:
        modes = ", ".join(f"{f:.3g}" for f in self.frequencies_hz)
        kind = " to synthetic data" if any(m.is_synthetic for m in self.found.measured) else ""
        return f"<Fit{kind}: {modes} Hz>"


@dataclass(frozen=True, eq=False)
class FittedParameters(Printed):
    """Parameters of a specification that fit measured responses, with standard errors.

    Parameters
    ----------
    found : symflex.data.fitting.ParameterFit
        The fit in full: data, residuals, covariance, what the data can tell apart.
    """

    found: fitting.ParameterFit

    @property
    def values(self) -> dict[str, float]:
        """The fitted values by name, in SI units; without those that the data do not determine."""
        return {name: self.found.values[name] for name in self._determined}

    @property
    def standard_errors(self) -> dict[str, float]:
        """Standard errors by name."""
        errors = dict(zip(self.found.machine.names, self.found.errors.tolist(), strict=True))
        return {name: errors[name] for name in self._determined}

    @property
    def intervals(self) -> dict[str, tuple[float, float]]:
        """Intervals by name that hold the true values in 95 % of cases."""
        every = dict(zip(self.found.machine.names, self.found.intervals(), strict=True))
        return {name: every[name] for name in self._determined}

    @property
    def _determined(self) -> tuple[str, ...]:
        return self.found.machine.identifiability.alone

    @property
    def correlations(self) -> Real:
        """Correlations of the errors of all free parameters, shape (p, p)."""
        return self.found.correlations

    @property
    def definitions(self) -> dict[str, tuple[float, float]]:
        """Definitions that depend on the free parameters: value and standard error by name."""
        return {one.name: (value, error) for one, value, error in self.found.definitions()}

    @property
    def combinations(self) -> dict[str, tuple[float, float]]:
        """What is determined of parameters that are not: value and standard error by expression."""
        return {name: (value, error) for name, value, error in self.found.combinations()}

    @property
    def is_identifiable(self) -> bool:
        """Whether the data can tell all free parameters apart."""
        return self.found.machine.identifiability.is_complete

    @property
    def other_values(self) -> tuple[dict[str, float], ...]:
        """Other values with the same response, or ones that describe the data as well."""
        names = self.found.machine.names
        return tuple(dict(zip(names, twin.tolist(), strict=True)) for twin in self.found.twins)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Cautions about the fit, as sentences."""
        return self.found.warnings

    @property
    def poor(self) -> tuple[str, ...]:
        """Why the specification does not describe the data; empty for a good fit."""
        return self.found.poor

    def specification(self, folder: str | Path = ".", date: str | None = None) -> str:
        """Return the text of the specification with fitted values, errors and a date, by default today's."""
        from symflex.data.fitting.specification import machine_specification  # imports scipy

        return machine_specification(self.found, folder, date or datetime.now(UTC).date().isoformat())

    def model(self) -> Model:
        """Return the model with the fitted values."""
        return loads(
            self.specification(Path()), "<fit>", allow_outside=[Path(self.found.machine.path).parent]
        )

    def plot(self, response: int = 0, *, ax: AxesGiven | None = None) -> Figure:
        """Return a figure of data, fit and residual of one response; ``ax`` as for :meth:`Fit.plot`."""
        from symflex.figures import draw_fit  # imports matplotlib

        return draw_fit(self.found.residual, response, ax)

    def to_json_dict(self) -> dict[str, object]:
        """Return the result in the schema ``symflex.fit_parameters/1``."""
        from symflex.data.fitting.text import parameters_json

        return parameters_json(self.found)

    def passages(self) -> Iterator[Passage]:
        """Return the report."""
        from symflex.data.fitting.text import parameter_passages

        return parameter_passages(self.found)

    def __repr__(self) -> str:
        values = ", ".join(f"{name} = {value:.4g}" for name, value in self.values.items())
        return f"<FittedParameters: {values or 'none is determined'}>"


@overload
def fit(
    data: Data | Sequence[Data],
    base: str | Path | None = None,
    tf: str | Sequence[str] = (),
    *,
    model: None = None,
    modes: int | None = None,
    start: Literal["auto", "peaks", "vector", "aaa"] = "auto",
    criterion: Literal["bic", "aicc"] = "bic",
    band: tuple[float, float] | None = None,
    columns: str = "",
    axis: tuple[float, float] | None = None,
    averages: float | None = None,
    window: str | None = None,
    gain: bool = False,
    lag: bool | Literal["signed"] = False,
    delay: bool = False,
    slope: int | None = None,
    allow_outside: Sequence[str | Path] = (),
    estimator: str = "h1",
    segments: int | None = None,
    hold: Literal["auto", "held", "joined", "smooth"] = "auto",
    validate: bool = False,
) -> Fit: ...


@overload
def fit(
    data: Data | Sequence[Data],
    *,
    model: str | Path,
    free: str | Sequence[str],
    tf: str | Sequence[str] = (),
    band: tuple[float, float] | None = None,
    columns: str = "",
    axis: tuple[float, float] | None = None,
    averages: float | None = None,
    window: str | None = None,
    allow_outside: Sequence[str | Path] = (),
    estimator: str = "h1",
    segments: int | None = None,
    hold: Literal["auto", "held", "joined", "smooth"] = "auto",
) -> FittedParameters: ...


def fit(
    data: Data | Sequence[Data],
    base: str | Path | None = None,
    tf: str | Sequence[str] = (),
    *,
    model: str | Path | None = None,
    free: str | Sequence[str] = (),
    modes: int | None = None,
    start: Literal["auto", "peaks", "vector", "aaa"] = "auto",
    criterion: Literal["bic", "aicc"] = "bic",
    band: tuple[float, float] | None = None,
    columns: str = "",
    axis: tuple[float, float] | None = None,
    averages: float | None = None,
    window: str | None = None,
    gain: bool = False,
    lag: bool | Literal["signed"] = False,
    delay: bool = False,
    slope: int | None = None,
    allow_outside: Sequence[str | Path] = (),
    estimator: str = "h1",
    segments: int | None = None,
    hold: Literal["auto", "held", "joined", "smooth"] = "auto",
    validate: bool = False,
) -> Fit | FittedParameters:
    """Fit resonances, or parameters of a specification, to measured frequency responses.

    Parameters
    ----------
    data : str, Path, MeasuredResponse or a sequence of them
        Files (see :func:`read_measurement`) or responses; several are fitted together and share their poles.
    base : str or Path, optional
        The specification whose transfer function the resonances are multiplied by; without it a gain and a
        power of s.
    tf : str or sequence of str
        That function, or that of ``model``, "OUT/IN"; one, or one per response.
    model : str or Path, optional
        The specification whose parameters are fitted, in place of resonances; it goes with neither ``base``
        nor the options of resonances.
    free : str or sequence of str
        The names of these parameters, such as ``"k, b"``.
    modes : int, optional
        How many resonances; by default what ``criterion`` prefers.
    start : str
        Where the fit begins: ``peaks`` is the procedure of Eppinger and Seering (1988).
    criterion : str
        ``bic`` (Schwarz 1978) or ``aicc`` (Hurvich and Tsai 1989).
    band : (float, float), optional
        Only lines between these frequencies [Hz].
    columns : str
        What the columns of the files are, if these do not state it: see :func:`read_measurement`.
    axis : (float, float), optional
        First frequency and step [Hz] of files without frequencies.
    averages : float, optional
        Independent averages, if the data do not state them.
    window : str, optional
        ``hann``, ``none`` or ``exponential:0.5`` (time constant [s]), if the data do not state it.
    gain : bool
        Fit a gain in addition to the base.
    lag : bool or "signed"
        Fit a lag of the sensor, 1/(1 + T s), with T not negative unless this is ``"signed"``.
    delay : bool
        Fit a delay, exp(-T s), which is not negative.
    slope : int, optional
        Without a base: the power of s; by default the best.
    allow_outside : sequence of str or Path
        Folders that ``model`` blocks of the base may read besides its own.
    estimator : str
        Time records: ``h1`` for noise at the output, ``h2`` for noise at the input.
    segments : int, optional
        Time records: average this many segments by Welch's method, and fit the response that gives.
    hold : str
        Time records: the input is ``held`` between samples, ``joined`` by lines, or ``smooth``, without
        frequencies above half the sampling rate.
    validate : bool
        Time records: fit the first half alone, too, and compare its prediction with the second half.

    Raises
    ------
    DataError
        SF601 to SF607: data that cannot be used.
    FitError
        SF615: the base vanishes in the band. Otherwise the best fit is returned, and ``poor`` gives the
        reason if it is not a good one.
    UsageError
        SF902 names and options that contradict each other.

    Examples
    --------
    >>> import symflex
    >>> found = symflex.fit(
    ...     "derivations/eppinger1988/data/synthetic_figure_3.csv",
    ...     "derivations/eppinger1988/rigid_body.toml",
    ...     "A_tip/V_cmd",
    ...     modes=5,
    ...     lag=True,
    ... )
    >>> found
    <Fit to synthetic data: 11, 38, 44, 67, 77 Hz>
    >>> bool(max(found.standard_errors.zeta_p) < 0.0005), found.is_minimum_phase
    (True, (True,))
    >>> found.model().outputs, len(found.plot().axes)
    (('A_tip',), 4)
    """
    from symflex.analysis.measured import fit as fitted  # imports scipy

    given = [data] if isinstance(data, str | Path | MeasuredResponse) else list(data)
    responses: list[MeasuredResponse] = []
    is_chosen = bool(segments or window or estimator != Estimate.estimator)
    estimate = Estimate(estimator, segments, window or "hann", is_chosen)
    for one in given:
        if isinstance(one, MeasuredResponse):
            responses.append(one)
        else:
            responses += read_measurement(one, columns, estimate, axis)
    asked = FitOptions(
        model=model,
        free=free if isinstance(free, str) else ",".join(free),
        base=base,
        tfs=[tf] if isinstance(tf, str) else list(tf),
        modes=modes,
        start=start,
        criterion=criterion,
        is_gain_free=gain,
        is_lag_free=bool(lag),
        is_lag_signed=lag == "signed",
        is_delay_free=delay,
        slope=slope,
        allow_outside=allow_outside,
        hold=hold,
        is_validated=validate,
        band=band,
    )
    every = prepared(responses, band, averages, window)
    return (
        FittedParameters(fit_parameters(every, asked)) if asked.fits_parameters else Fit(fitted(every, asked))
    )
