"""Responses over frequency and in time, which draw themselves."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from symflex.analysis import response as response_layer
from symflex.analysis.time_response import EnclosedResponse
from symflex.api.face import face_of
from symflex.data import measurement
from symflex.data.measurement import Estimate
from symflex.errors import refused

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from symflex.figures import AxesGiven

LARGEST_DRAWING = 4000
"""Frequencies up to which the picture is a drawing, which grows with their number, and beyond a raster."""


@dataclass(frozen=True, eq=False)
class FrequencyResponse(response_layer.SampledResponse):
    """Values on the imaginary axis; in a notebook, a Bode plot.

    See :class:`symflex.analysis.response.SampledResponse`.
    """

    def __repr__(self) -> str:
        count = len(self.omega)
        if not count:
            return f"<FrequencyResponse {self.tf}: {self.quantity}, no frequency>"
        low, high = self.omega.min(), self.omega.max()
        return f"<FrequencyResponse {self.tf}: {self.quantity}, {count} from {low:.6g} to {high:.6g} rad/s>"

    def plot(self, ax: AxesGiven | None = None) -> Figure:
        r"""Return magnitude and phase at these frequencies; ``ax`` as for :meth:`BoundTransferFunction.bode`.

        Raises
        ------
        UsageError
            SF902 for less than two positive frequencies.

        Examples
        --------
        >>> from symflex import loads
        >>> loop = loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/(s + 1)"')
        >>> response = loop.transfer_function("y", "u").bind().frequency_response([0.1, 1.0, 10.0])
        >>> len(response.plot().axes[0].get_lines()[0].get_xdata())
        3
        """
        from symflex.figures import draw_response  # imports matplotlib

        figure = draw_response(self, ax)
        if figure is None:
            raise refused("a drawing of a response needs at least two positive frequencies")
        return figure

    def _repr_svg_(self) -> str | None:
        picture = self._picture("svg") if len(self.omega) <= LARGEST_DRAWING else None
        return None if picture is None else picture.decode()

    def _repr_png_(self) -> bytes | None:
        return self._picture("png") if len(self.omega) > LARGEST_DRAWING else None

    def _picture(self, format: str) -> bytes | None:
        from symflex.figures import draw_response, render  # imports matplotlib

        figure = draw_response(self)
        return None if figure is None else render(figure, format)


@dataclass(frozen=True, eq=False)
class TimeResponse(EnclosedResponse):
    """A response in time; in a notebook, its curve. See :class:`EnclosedResponse`."""

    def __repr__(self) -> str:
        last = f"up to {self.times[-1]:.6g} s" if len(self.times) else "at no time"
        return f"<TimeResponse {self.tf}: {self.input}, {len(self.times)} values {last}>"

    def plot(self, ax: Axes | None = None) -> Figure:
        """Return the values over time, and their enclosures where they are wide, as a matplotlib figure."""
        from symflex.figures import draw_in_time  # imports matplotlib

        return draw_in_time(self, ax)

    def _repr_svg_(self) -> str | None:
        from symflex.figures import render

        return render(self.plot(), "svg").decode() if 1 < len(self.times) <= LARGEST_DRAWING else None


@dataclass(frozen=True, eq=False, repr=False)
class MeasuredResponse(measurement.MeasuredResponse):
    """A measured frequency response; see :class:`symflex.data.measurement.MeasuredResponse`."""

    def plot(self, *, ax: AxesGiven | None = None) -> Figure:
        """Return magnitude and, if it was measured, phase from -180 to 180 deg, on the lines.

        Two axes of your own, ``ax``, get them in your own style.

        Raises
        ------
        UsageError
            SF902 for less than two lines, and for too many axes or too few.

        Examples
        --------
        >>> figure = MeasuredResponse("X/F", [1.0, 2.0, 4.0], [1, -1j, -0.1], unit="m/N").plot()
        >>> [line.get_ydata().tolist() for axes in figure.axes for line in axes.get_lines()]
        [[0.0, 0.0, -20.0], [0.0, -90.0, 180.0]]
        """
        from symflex.figures import draw_measured  # imports matplotlib

        if not self.frequency_hz[1:].size:
            raise refused("a drawing of a response needs at least two frequencies")
        return draw_measured(self, ax=ax)


def read_measurement(
    path: str | Path,
    columns: str = "",
    estimate: Estimate | None = None,
    axis: tuple[float, float] | None = None,
) -> tuple[MeasuredResponse, ...]:
    """Read measured responses that draw themselves; see :func:`symflex.data.measurement.read_measurement`.

    Examples
    --------
    >>> read_measurement("derivations/eppinger1988/data/synthetic_figure_3.csv")
    (<MeasuredResponse A_tip/V_cmd: synthetic, 393 lines, 2 to 100 Hz>,)
    """
    read = measurement.read_measurement(path, columns, estimate, axis)
    return tuple(face_of(MeasuredResponse, one) for one in read)
