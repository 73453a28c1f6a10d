"""A transfer function with numbers: its values, and everything found at its poles and zeros."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.analysis.explanation import explain_zeros
from symflex.analysis.sensitivity.sensitivity import sensitivities
from symflex.api.analyses import Analyses
from symflex.api.face import face_of
from symflex.api.response import TimeResponse
from symflex.api.root import Sensitivity, SensitivityTable
from symflex.api.toolboxes import Toolboxes
from symflex.model.loss_factors import check_causal
from symflex.options import RootsOptions

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from symflex import transfer as transfer_room
    from symflex.analysis.explanation import ZeroExplanation
    from symflex.analysis.input_shaping import InputShaper


@dataclass(frozen=True)
class BoundTransferFunction(Toolboxes, Analyses):
    """A transfer function with numbers: evaluates, and finds its poles and zeros.

    Each is proved. A distributed system has infinitely many; they are found in a region.
    """

    bound: transfer_room.BoundTransferFunction

    @property
    def name(self) -> str:
        """``OUT/IN``."""
        return self.bound.name

    @property
    def is_distributed(self) -> bool:
        """True when the function is transcendental."""
        return self.bound.is_distributed

    @property
    def _expanded(self) -> transfer_room.BoundTransferFunction:
        return self.bound

    def __repr__(self) -> str:
        return f"<BoundTransferFunction {self.name}>"

    def _repr_html_(self) -> str:
        from symflex.print.html import bound_html  # only notebooks ask

        return bound_html(self.bound)

    def __call__(self, s: ArrayLike) -> complex | NDArray[np.complex128]:
        """Return the value at s [rad/s], a number or an array, to double precision."""
        import numpy as np

        points = np.asarray(s, dtype=complex)
        if not ((points.real == 0) & (points.imag > 0)).all():
            check_causal(self.bound.source.model, "a value at another s")
        if points.ndim == 0:
            return self.bound(complex(points))
        values = np.array([self.bound(complex(p)) for p in points.ravel()], dtype=complex)
        return values.reshape(points.shape)

    def forced_response(
        self, times: ArrayLike, u: ArrayLike, digits: int = 12, shaper: InputShaper | None = None
    ) -> TimeResponse:
        r"""Return the response, from rest, to an input that is a straight line between samples.

        Parameters
        ----------
        times : array_like of float, shape (n,)
            Increasing times [s] of the samples, at which the response is given too. Those that are evenly
            spaced but for rounding count as even.
        u : array_like of float, shape (n,)
            The input at these times. It is 0 before the first; where it does not begin with 0, it jumps.
        digits : int
            As for :meth:`step_response`.
        shaper : InputShaper, optional
            Convolves the input by its impulses.

        Raises
        ------
        UsageError
            SF811 for times that do not increase, or values that are no numbers or not as many.
        UncertifiedError
            SF810 as for :meth:`step_response`, and where the transfer function differentiates its input.

        Examples
        --------
        >>> from symflex import loads
        >>> integrator = loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/s"').transfer_function("y", "u")
        >>> integrator.bind().forced_response([0.0, 1.0, 3.0], [0.0, 2.0, 2.0]).values.tolist()
        [0.0, 1.0, 5.0]
        """
        from symflex.analysis.time_response import SampleTimes, exact_values, forced_response

        instants = SampleTimes.of(times)
        exactly = instants.exactly()
        given = exact_values(u, len(exactly))
        found = forced_response(self.bound, exactly, given, exactly, digits, shaper)
        return face_of(TimeResponse, found)

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
        """Return how poles, and then zeros, move with parameters.

        Parameters
        ----------
        modes, mode, band, budget : optional
            As for :meth:`poles`; the budget is for the search for the roots.
        parameters : sequence of str
            All on which the function depends when none is given.
        digits : int
            Correct significant digits of every derivative.

        Raises
        ------
        UsageError
            SF902 for an unknown parameter.
        BudgetError
            As for :meth:`poles`.
        """
        found = self._found(RootsOptions(None, modes, mode, band, digits=digits), budget)
        model = self.bound.source.model
        return SensitivityTable(
            Sensitivity(m) for m in sensitivities(model, self.bound, found, parameters, digits)
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
        """Return what the zeros are the poles of; print it to read it.

        Parameters and errors are those of :meth:`zeros`: which zeros are spoken of one by one.
        """
        found = self._found(RootsOptions(None, modes, mode, band, digits=digits), budget)
        return explain_zeros(self.bound.source.model, self.bound, found)
