"""A sweep as a Python user holds it: arrays, a figure, a few lines."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex import sweep as sweep_package
from symflex.print.latex import width_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from symflex.figures import AxesGiven


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Sweep(sweep_package.Sweep):
    """The results at all points of a design, with a figure of them. See :class:`symflex.sweep.Sweep`."""

    def plot(
        self,
        *,
        modes: int | None = None,
        width: float | str | None = None,
        font: str | None = None,
        ax: AxesGiven | None = None,
    ) -> Figure:
        """Return a figure: modes over a parameter and their loci, magnitudes, margins, or their spread.

        Parameters
        ----------
        modes : int, optional
            How many modes, the first by name.
        width, font, ax : optional
            As for :meth:`BoundTransferFunction.bode`; as many axes as there are panels.

        Raises
        ------
        ModelError
            SF402 there is nothing to draw.
        UsageError
            SF902 for too many axes or too few.

        Examples
        --------
        >>> from symflex import Model
        >>> model = Model(parameters={"k": 4}, inputs={"u": {}}, outputs={"x": "u/(s^2 + k)"})
        >>> (panel,) = model.sweep({"k": [1, 4, 9]}).plot().axes
        >>> panel.get_lines()[0].get_ydata()  # sqrt(k)/(2 pi)
        array([0.15915494, 0.31830989, 0.47746483])
        """
        from symflex.figures import DEFAULT_FONT, draw_sweep  # imports matplotlib

        return draw_sweep(self, modes=modes, width_mm=width_of(width), font=font or DEFAULT_FONT, ax=ax)
