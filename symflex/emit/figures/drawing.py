"""What every kind of figure offers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from symflex.transfer import BoundTransferFunction, TransferFunction


class Drawing(Protocol):
    """A function that draws transfer functions; :func:`symflex.emit.figures.draw` sets the style."""

    def __call__(
        self,
        tfs: Sequence[TransferFunction],
        bounds: Sequence[BoundTransferFunction],
        *,
        band_hz: tuple[float, float] | None,
        title: str | None,
        width: float | None,
    ) -> Figure:
        """Return the figure, as wide as asked for [inches] or as suits it."""
        ...
