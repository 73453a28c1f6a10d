"""Responses over frequency and in time, which draw themselves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.analysis import response as response_room
from symflex.analysis.time_response import EnclosedResponse
from symflex.errors import Diagnostic, UsageError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from symflex.figures import AxesGiven

LARGEST_DRAWING = 4000
"""Frequencies up to which the picture is a drawing, which grows with their number, and beyond a raster."""


@dataclass(frozen=True, eq=False)
class FrequencyResponse(response_room.SampledResponse):
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
            message = "a drawing of a response needs at least two positive frequencies"
            raise UsageError(Diagnostic("SF902", message))
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
