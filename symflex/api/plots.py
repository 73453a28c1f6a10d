"""Figures of transfer functions and loops, as Python asks for them: options of ``symflex plot``, and axes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, Any

from symflex.model import Model
from symflex.options import Ends, PlotOptions, Stated, gain_ends
from symflex.print.latex import width_of
from symflex.transfer import AnyBoundFunction, Given

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from symflex.figures import AxesGiven
    from symflex.loops import AnyLoop


def plot_functions(
    given: PlotOptions,
    drawn: Sequence[AnyBoundFunction] | AnyLoop,
    ax: AxesGiven | None = None,
    limits: tuple[Fraction | None, Fraction | None] | None = None,
) -> Figure:
    """Draw a figure of transfer functions, or of a loop; see :func:`symflex.figures.draw`."""
    from symflex.figures import DEFAULT_FONT, draw, part_shown  # imports matplotlib

    if given.modes is not None and isinstance(drawn, Sequence):
        drawn = [_with_modes(bound, given.modes) for bound in drawn]
    band, frame = part_shown(given.kind, given)
    shown = partial(draw, given.kind, drawn, band_hz=band, frame=frame, spread=given.spread, ax=ax)
    width, font = width_of(given.width), given.font or DEFAULT_FONT
    return shown(limits=limits, modes=given.modes, width_mm=width, font=font)


def _with_modes(bound: AnyBoundFunction, modes: int) -> AnyBoundFunction:
    """Return a function whose model asks for so many modes."""
    model = bound.source.model
    model = replace(model, analysis=replace(model.analysis, modes=modes))
    source: Any = replace(bound.source, model=model)  # of the kind that it was
    return replace(bound, source=source)


class Plotted:
    """A transfer function with numbers that draws itself, alone or with others."""

    if TYPE_CHECKING:

        @property
        def bound(self) -> AnyBoundFunction:
            """What is drawn."""

    def bode(
        self,
        *others: Plotted,
        band: Ends | None = None,
        ylim: Ends | None = None,
        phase: Ends | None = None,
        width: float | str | None = None,
        font: str | None = None,
        asymptotes: bool = False,
        ax: AxesGiven | None = None,
    ) -> Figure:
        r"""Return a Bode plot, of other transfer functions too, as ``symflex plot bode`` draws it.

        Parameters
        ----------
        *others : BoundTransferFunction or BoundNestedTransferFunction
            Drawn over it.
        band : (float, float), optional
            Frequencies shown [Hz], or strings with units; by default the model's, or all poles and zeros.
        ylim, phase : (float, float), optional
            Ends of the axes of magnitudes [dB] and phases [deg].
        width : float or str, optional
            Width of the figure [mm], or ``"ieee"`` or ``"a4"``.
        font : str, optional
            ``times``, ``latex`` or ``sans``.
        asymptotes : bool
            Draw the leading terms at both ends, of functions of finite order.
        ax : two matplotlib axes, optional
            Your own axes to draw on, in your own style; lines that are already there keep their colours,
            and the next ones are used. One axes alone shows magnitudes.

        Returns
        -------
        matplotlib.figure.Figure
            A figure without a window: a notebook shows it, ``savefig`` writes it, and you can draw on its
            ``axes``. For a window, give axes of :func:`matplotlib.pyplot.subplots`.

        Raises
        ------
        UsageError
            SF902 for invalid limits, and for too many axes or too few.
        ModelError
            SF402 if a function is identically zero.

        Examples
        --------
        >>> from symflex import loads
        >>> loop = loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/((s + 1)*(s + 3))"')
        >>> figure = loop.transfer_function("y", "u").bind().bode(band=(0.01, 10), ylim=(-60, 0))
        >>> [axes.get_ylabel() for axes in figure.axes], figure.axes[0].get_ylim() == (-60, 0)
        (['Magnitude [dB, 0 dB = 1 $\\mathrm{s^{2}}$]', 'Phase [deg]'], True)
        """
        given = PlotOptions(
            "bode", band=band, ylim=ylim, phase=phase, width=width, font=font, asymptotes=asymptotes
        )
        return plot_functions(given, [self.bound, *(other.bound for other in others)], ax)

    def pole_zero_plot(
        self,
        *others: Plotted,
        modes: int | None = None,
        band: Ends | None = None,
        xlim: Ends | None = None,
        ylim: Ends | None = None,
        width: float | str | None = None,
        font: str | None = None,
        verdict: bool = False,
        ax: AxesGiven | None = None,
        spread: str | float | None = None,
    ) -> Figure:
        r"""Return the poles and zeros in the s plane, of other transfer functions in panels beside it.

        Roots far outside the figure are named at its border, where an arrow points to them.

        Parameters
        ----------
        *others, width, font, ax : optional
            As for :meth:`bode`; one axes per function.
        modes : int, optional
            For a distributed system, how many modes are shown; by default the model's, or five.
        band : (float, float), optional
            The figure ends where the band ends [Hz].
        xlim, ylim : (float, float), optional
            Ends of the axes [rad/s].
        verdict : bool
            Print above the panels whether the functions are stable.
        spread : str or float, optional
            Shade where roots lie for all combinations of values; see :meth:`root_clouds`.

        Examples
        --------
        >>> from symflex import loads
        >>> loop = loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/((s + 1)*(s + 3))"')
        >>> (panel,) = loop.transfer_function("y", "u").bind().pole_zero_plot(xlim=(-4, 1)).axes
        >>> panel.get_xlim() == (-4, 1), panel.get_title()
        (True, '$y/u$')
        """
        given = PlotOptions("poles_zeros", (), None, band, xlim, ylim, modes=modes, width=width, font=font)
        given = replace(given, verdict=verdict, spread=spread)
        return plot_functions(given, [self.bound, *(other.bound for other in others)], ax)

    def nyquist(
        self,
        *others: Plotted,
        band: Ends | None = None,
        xlim: Ends | None = None,
        ylim: Ends | None = None,
        width: float | str | None = None,
        font: str | None = None,
        ax: AxesGiven | None = None,
    ) -> Figure:
        r"""Return the values on the imaginary axis as a curve; the legend counts the unstable poles.

        :meth:`Model.nyquist` draws the gain of a loop that is closed in the model.

        Parameters
        ----------
        *others, width, font, ax : optional
            As for :meth:`bode`; one axes for all.
        band : (float, float), optional
            Frequencies drawn [Hz].
        xlim, ylim : (float, float), optional
            Ends of the axes.

        Examples
        --------
        >>> from symflex import loads
        >>> loop = loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/((s - 1)*(s + 3))"')
        >>> figure = loop.transfer_function("y", "u").bind().nyquist()
        >>> [text.get_text() for text in figure.legends[0].get_texts()]
        ['$y/u$, $P = 1$']
        """
        given = PlotOptions("nyquist", band=band, xlim=xlim, ylim=ylim, width=width, font=font)
        return plot_functions(given, [self.bound, *(other.bound for other in others)], ax)

    def nichols(
        self,
        *others: Plotted,
        band: Ends | None = None,
        xlim: Ends | None = None,
        ylim: Ends | None = None,
        width: float | str | None = None,
        font: str | None = None,
        ax: AxesGiven | None = None,
    ) -> Figure:
        """Return magnitudes [dB] over phases [deg] with contours of the closed loop; see :meth:`nyquist`."""
        given = PlotOptions("nichols", band=band, xlim=xlim, ylim=ylim, width=width, font=font)
        return plot_functions(given, [self.bound, *(other.bound for other in others)], ax)

    def deflection_plot(
        self,
        *at: Stated,
        width: float | str | None = None,
        font: str | None = None,
        ax: AxesGiven | None = None,
    ) -> Figure:
        r"""Return how the model moves under this input at frequencies [Hz], as mode shapes are drawn.

        Raises SF406 at a resonance without damping, where the motion is infinite.

        Examples
        --------
        >>> from symflex import Model
        >>> body = {"type": "mass", "at": "x", "m": 2}
        >>> hook = {"type": "spring", "between": ["x", "ground"], "k": 8}
        >>> model = Model(elements={"m": body, "k": hook}, inputs={"F": {"force": "x"}}, outputs={"X": "x"})
        >>> figure = model.transfer_function("X", "F").bind().deflection_plot("1 rad/s", "4 rad/s")
        >>> print(figure.axes[1].get_title(loc="left"))
        $0.6366$ Hz, largest $0.0417$ $\mathrm{m/N}$, $180$° from $F$
        """
        given = PlotOptions("deflection", width=width, font=font, at=at)
        return plot_functions(given, [self.bound], ax)


def plot_loop(
    given: PlotOptions, model: Model, values: Mapping[str, Given], ax: AxesGiven | None = None
) -> Figure:
    """Draw a root locus or the Nyquist plot of a loop gain; see :func:`symflex.figures.draw`."""
    from symflex.loops.of_model import characteristic_loop

    loop = characteristic_loop(model, given.gain or "", values)
    return plot_functions(given, loop, ax, gain_ends(given.limits, loop.gain))
