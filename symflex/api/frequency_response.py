"""A frequency response as a notebook shows it."""

from __future__ import annotations

from dataclasses import dataclass

from symflex.analysis import response as response_room

LARGEST_DRAWING = 4000
"""Frequencies up to which the picture is a drawing, which grows with their number, and beyond a raster."""


@dataclass(frozen=True, eq=False)
class FrequencyResponse(response_room.SampledResponse):
    """Values on the imaginary axis; in a notebook, a Bode plot.

    See :class:`symflex.analysis.response.SampledResponse`.
    """

    @staticmethod
    def of(response: response_room.SampledResponse) -> FrequencyResponse:
        """Return the face of a response."""
        return FrequencyResponse(
            response.tf, response.omega, response.values, response.quantity, response.unit, response.turns
        )

    def __repr__(self) -> str:
        count = len(self.omega)
        if not count:
            return f"<FrequencyResponse {self.tf}: {self.quantity}, no frequency>"
        low, high = self.omega.min(), self.omega.max()
        return f"<FrequencyResponse {self.tf}: {self.quantity}, {count} from {low:.6g} to {high:.6g} rad/s>"

    def _repr_svg_(self) -> str | None:
        picture = self._picture("svg") if len(self.omega) <= LARGEST_DRAWING else None
        return None if picture is None else picture.decode()

    def _repr_png_(self) -> bytes | None:
        return self._picture("png") if len(self.omega) > LARGEST_DRAWING else None

    def _picture(self, format: str) -> bytes | None:
        from symflex.figures import draw_response, render  # imports matplotlib

        figure = draw_response(self)
        return None if figure is None else render(figure, format)
