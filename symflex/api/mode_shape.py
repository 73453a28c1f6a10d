"""The motion in one mode as mpmath numbers and numpy arrays."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING

import mpmath

from symflex.api.root import Root, radius_of
from symflex.balls import precision, to_complex_mpmath
from symflex.errors import Diagnostic, UsageError
from symflex.print.latex import width_of

if TYPE_CHECKING:
    import numpy as np
    from flint import acb
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike, NDArray

    from symflex import model as model_layer
    from symflex.analysis import modes as modes_layer
    from symflex.figures import AxesGiven

END_TOLERANCE = 1e-12  # relative distance by which rounding may put a place beyond the end of a beam


@dataclass(frozen=True)
class ModeShape:
    """The motion of the model at one pole, up to a common factor; the largest displacement found is 1.

    Displacements are those of nodes in translation, along beams, rods and strings, and of each field's first
    unknown [m]. If none of them moves, the largest angle is 1, else the largest voltage. At an undamped
    pole, a shape is real if all that moves depends on s^2 alone.

    Parameters
    ----------
    enclosed : symflex.analysis.modes.EnclosedModeShape
        With a ball around every amplitude.
    model : symflex.model.Model
        The model that moves.

    Examples
    --------
    >>> from symflex import Model
    >>> bar = {"type": "rod", "between": ["ground", "x"], "E": 1, "A": 1, "rho": 1, "l": 1}
    >>> model = Model(elements={"bar": bar}, inputs={"F": {"force": "x"}}, outputs={"X": "x"})
    >>> shape = model.transfer_function("X", "F").bind().mode_shape(1)  # sin(pi x/2)
    >>> shape.names, shape.along("bar", [0, 0.5, 1]).round(6)
    (('x', 'bar.f_a', 'bar.f'), array([0.      , 0.707107, 1.      ]))
    """

    enclosed: modes_layer.EnclosedModeShape
    model: model_layer.Model = field(repr=False)

    @property
    def pole(self) -> Root:
        """The pole."""
        return Root(self.enclosed.pole)

    @property
    def frequency_hz(self) -> float:
        """Natural frequency [Hz]."""
        return self.enclosed.pole.frequency_hz()

    @property
    def damping_ratio(self) -> float | None:
        """``-re/abs(s)`` of the pole, None at the origin."""
        return self.enclosed.pole.damping_ratio()

    @property
    def certified(self) -> bool:
        """True when the pole is certified and has one shape: every amplitude lies within its radius."""
        return self.enclosed.certified

    @property
    def reference(self) -> str:
        """The place with amplitude 1: a node, or a point along an element or field, ``beam(0.3)``."""
        return self.enclosed.reference

    @property
    def is_real(self) -> bool:
        """True when the pole is undamped and everything moves in phase."""
        return self.enclosed.is_real

    @property
    def names(self) -> tuple[str, ...]:
        """The nodes, element quantities and signals that have an amplitude."""
        return tuple(motion.name for motion in self.enclosed.motions)

    def __getitem__(self, name: str) -> mpmath.mpc:
        """Return the amplitude of a node, element quantity or signal; a planar node's is its deflection.

        Raises
        ------
        UsageError
            SF902 when there is none of that name.
        """
        return to_complex_mpmath(self.enclosed.motion(name).value)

    def radius(self, name: str) -> mpmath.mpf:
        """Return a bound on the distance from ``shape[name]`` to the amplitude; an estimate if unproved."""
        return radius_of(self.enclosed.motion(name).value)

    @property
    def distributed(self) -> tuple[str, ...]:
        """The beams, rods, shafts, strings and fields."""
        return tuple(part.name for part in self.enclosed.distributed)

    def quantities(self, part: str) -> tuple[str, ...]:
        """Return the quantities along a part: ``y theta f tau`` of a beam, ``w w' w'' w'''`` of a field."""
        return self.enclosed.along(part).states

    def domain(self, part: str) -> tuple[float, float]:
        """Return the ends of a part along x [m]; an element begins at 0."""
        part_along = self.enclosed.along(part)
        with precision(part_along.bits):
            return float(part_along.start.mid()), float((part_along.start + part_along.length).mid())

    def along(
        self, part: str, x: ArrayLike, quantity: str | None = None
    ) -> NDArray[np.float64] | NDArray[np.complex128]:
        """Return a quantity of a distributed part at x [m]; real when the shape is.

        Parameters
        ----------
        part : str
            A distributed element or a field.
        x : array_like
            Places within :meth:`domain`.
        quantity : str, optional
            One of :meth:`quantities`; the first one, a displacement, by default. ``theta`` is a beam's slope
            (in the Timoshenko theory the rotation of its section), ``f`` and ``tau`` are the force and moment
            that the part beyond x exerts on the part before it.

        Raises
        ------
        UsageError
            SF902 no such part or quantity; SF240 a place outside the domain.
        """
        import numpy as np

        places = np.asarray(x, dtype=float)
        balls = self._balls(part, places, quantity)
        values = np.array([complex(float(b.real.mid()), float(b.imag.mid())) for b in balls], dtype=complex)
        values = values.reshape(places.shape)
        return values.real if self.is_real else values

    def radius_along(self, part: str, x: ArrayLike, quantity: str | None = None) -> NDArray[np.float64]:
        """Return bounds on the error of :meth:`along`, without that of rounding to double precision."""
        import numpy as np

        places = np.asarray(x, dtype=float)
        radii = [float(radius_of(ball)) for ball in self._balls(part, places, quantity)]
        return np.array(radii, dtype=float).reshape(places.shape)

    def plot(
        self, *, width: float | str | None = None, font: str | None = None, ax: AxesGiven | None = None
    ) -> Figure:
        """Return a figure of displacements along distributed parts, and of nodes side by side.

        Motion in phase with the largest displacement is drawn as full lines, motion in quadrature as dashed
        lines.

        Parameters
        ----------
        width, font, ax : optional
            As for :meth:`BoundTransferFunction.bode`; as many axes as there are panels.

        Raises
        ------
        ModelError
            SF402 when nothing moves that could be drawn.
        UsageError
            SF902 for too many axes or too few.

        Examples
        --------
        >>> from symflex import Model
        >>> bar = {"type": "rod", "between": ["ground", "x"], "E": 1, "A": 1, "rho": 1, "l": 1}
        >>> model = Model(elements={"bar": bar}, inputs={"F": {"force": "x"}}, outputs={"X": "x"})
        >>> figure = model.transfer_function("X", "F").bind().mode_shape(1).plot()
        >>> figure.axes[0].get_title(loc="left"), figure.axes[0].get_xlabel()  # (pi/2)/(2 pi) Hz
        ('$0.2500$ Hz', '$x$ [m]')
        """
        from symflex.figures import DEFAULT_FONT, draw_shape  # imports matplotlib

        return draw_shape(
            self.model, self.enclosed, width_mm=width_of(width), font=font or DEFAULT_FONT, ax=ax
        )

    def _balls(self, part: str, places: NDArray[np.float64], quantity: str | None) -> list[acb]:
        part_along = self.enclosed.along(part)
        position = part_along.position(quantity)
        start, end = self.domain(part)
        slack = END_TOLERANCE * (end - start)
        for at in places.ravel():
            if not start - slack <= at <= end + slack:
                message = f"x = {at:g} lies outside '{part}', which reaches from {start:g} to {end:g}"
                raise UsageError(Diagnostic("SF240", message))
        return [part_along.at(Fraction(float(at)))[position] for at in places.ravel()]

    def _repr_png_(self) -> tuple[bytes, dict[str, int]] | None:
        from symflex.figures import picture_of_shape  # only notebooks ask

        return picture_of_shape(self.model, self.enclosed)

    def __repr__(self) -> str:
        damping, factor = self.damping_ratio, self.enclosed.pole.loss_factor()
        damped = f", damping ratio {damping:.4g}" if damping else ""
        damped = damped if factor is None else f", loss factor {float(factor.mid()):.4g}"
        return f"<ModeShape at {self.frequency_hz:.6g} Hz{damped}, {self.reference} = 1>"
