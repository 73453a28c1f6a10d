"""State equations with numbers, ready for simulation and control design.

Input: a :class:`StateSpace` without parameters, or poles, zeros and gain. Output: :class:`BoundStateSpace`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.errors import Diagnostic, UsageError
from symflex.expressions import format_expression
from symflex.state_space.rounding import rounded, rounding_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy.typing as npt
    from numpy import float64

    from symflex.model import ExactValue
    from symflex.state_space.rounding import Arrays
    from symflex.state_space.state_space import Channel, StateSpace


@dataclass(frozen=True, slots=True)
class BoundState:
    """One state."""

    name: str  # letters, digits and underscores
    # The quantities of the model that it is a sum of, with their coefficients; empty when it is none.
    terms: tuple[tuple[str, float], ...]
    unit: str  # SI unit, empty when unknown


@dataclass(frozen=True, slots=True, eq=False)
class BoundStateSpace:
    """``w' = A w + B u``, ``y = C w + D u`` in doubles; every entry is the nearest to the exact one."""

    name: str  # what programs for control design call it: letters, digits and underscores
    arrays: Arrays  # the matrices
    states: tuple[BoundState, ...]  # what the states are
    # inputs and outputs: their names and units.
    inputs: tuple[Channel, ...]
    outputs: tuple[Channel, ...]
    is_minimal: bool  # every state is controllable and observable

    @property
    def A(self) -> npt.NDArray[float64]:  # noqa: N802
        """Array of shape (n, n), read-only."""
        return self.arrays.a

    @property
    def B(self) -> npt.NDArray[float64]:  # noqa: N802
        """Array of shape (n, inputs), read-only."""
        return self.arrays.b

    @property
    def C(self) -> npt.NDArray[float64]:  # noqa: N802
        """Array of shape (outputs, n), read-only."""
        return self.arrays.c

    @property
    def D(self) -> npt.NDArray[float64]:  # noqa: N802
        """Array of shape (outputs, inputs), read-only."""
        return self.arrays.d

    @property
    def metadata(self) -> dict[str, object]:
        """Units of inputs, outputs and states by name, for an object that cannot hold them itself."""
        return {
            "input_units": {x.name: x.unit for x in self.inputs},
            "output_units": {x.name: x.unit for x in self.outputs},
            "state_units": {x.name: x.unit for x in self.states},
            "minimal": self.is_minimal,
        }

    def __repr__(self) -> str:
        shape = f"{len(self.states)} states, {len(self.inputs)} inputs, {len(self.outputs)} outputs"
        return f"<BoundStateSpace {self.name}: {shape}>"

    def to_control(self, facts: Mapping[str, object] | None = None) -> object:
        """Return a ``control.StateSpace`` with names; units and ``facts`` are in its attribute ``metadata``.

        SF902 when python-control is not installed.
        """
        try:
            import control
        except ImportError:
            raise not_installed("control") from None
        system = control.StateSpace(
            *(m.copy() for m in (self.A, self.B, self.C, self.D)),
            0,
            name=self.name,
            inputs=[x.name for x in self.inputs],
            outputs=[x.name for x in self.outputs],
            states=[x.name for x in self.states],
            remove_useless_states=False,
        )
        system.metadata = {**self.metadata, **(facts or {})}
        return system

    def to_scipy(self, facts: Mapping[str, object] | None = None) -> object:
        """Return a ``scipy.signal.StateSpace``; names, units and ``facts`` are in its attribute ``metadata``.

        SF902 when scipy is not installed.
        """
        try:
            from scipy.signal import StateSpace
        except ImportError:
            raise not_installed("scipy") from None
        system = StateSpace(*(m.copy() for m in (self.A, self.B, self.C, self.D)))
        system.metadata = {"name": self.name, **self.metadata, **(facts or {})}
        return system


def bound_state_space(system: StateSpace, values: Mapping[str, ExactValue] | None = None) -> BoundStateSpace:
    """Return a realisation in double precision, given values of what is left in it; errors as ``rounded``."""
    rounding = rounding_of(system, values)
    states = tuple(
        BoundState(
            state.name,
            tuple(
                (format_expression(quantity), rounding.nearest(value, f"a part of state '{state.name}'"))
                for quantity, value in state.terms
            ),
            state.unit,
        )
        for state in system.states
    )
    name = f"{'_'.join(x.name for x in system.outputs)}_over_{'_'.join(x.name for x in system.inputs)}"
    return BoundStateSpace(
        name, rounded(system, values), states, system.inputs, system.outputs, system.is_minimal
    )


PIP = {
    "control": "pip install 'symflex[control]'",
    "scipy": "pip install scipy",
    "sympy": "pip install sympy",
}


def not_installed(package: str) -> UsageError:
    """Return the error for a program that is asked for and not there."""
    return UsageError(Diagnostic("SF902", f"{package} is not installed", None, PIP[package]))
