"""State equations with SymPy matrices."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Final

from symflex import state_space as state_space_layer
from symflex.codegen.state_space import StateEquations
from symflex.model import ExactValue, Model
from symflex.options import duration, finite
from symflex.print.sympy import symbols_of, to_sympy
from symflex.state_space.numeric import BoundStateSpace
from symflex.state_space.popov import Vector
from symflex.state_space.sampled import SampledStateSpace
from symflex.transfer.bind import read_values

if TYPE_CHECKING:
    import sympy


MOST_STATES: Final = 8  # whose matrices fit on a page


@dataclass(frozen=True)
class StateSpace:
    """``w' = A w + B u``, ``y = C w + D u`` with the parameters as symbols.

    The states w are quantities of the model: displacements and velocities of nodes, currents, voltages. It is
    proved that the matrices satisfy the model's equations.

    Parameters
    ----------
    exact : symflex.state_space.StateSpace
        The exact realisation.

    Examples
    --------
    >>> import symflex
    >>> model = symflex.loads('''
    ... symflex = 1
    ... parameters = { m = "2 kg", k = "8 N/m" }
    ... elements.body = { type = "mass", at = "x", m = "m" }
    ... elements.wall = { type = "spring", between = ["x", "ground"], k = "k" }
    ... inputs.F = { force = "x" }
    ... outputs.X = "x"
    ... ''')
    >>> system = model.state_space()
    >>> system.states, system.A
    (('x', 'x_dot'), Matrix([
    [   0, 1],
    [-k/m, 0]]))
    >>> system.bind(k="18 N/m").A
    array([[ 0.,  1.],
           [-9.,  0.]])
    """

    exact: state_space_layer.StateSpace

    @staticmethod
    def of(model: Model, pairs: Sequence[tuple[str, str]], *, minimal: bool) -> StateSpace:
        """Return a realisation with the outputs and inputs of the given pairs."""
        realised = state_space_layer.realise(model, pairs)
        return StateSpace(state_space_layer.minimal(realised) if minimal else realised)

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states: letters, digits and underscores."""
        return tuple(x.name for x in self.exact.states)

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs."""
        return tuple(x.name for x in self.exact.inputs)

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs."""
        return tuple(x.name for x in self.exact.outputs)

    @property
    def units(self) -> dict[str, str]:
        """SI units of states, inputs and outputs by name; empty when unknown."""
        groups = (self.exact.states, self.exact.inputs, self.exact.outputs)
        return {item.name: item.unit for group in groups for item in group}

    @property
    def is_minimal(self) -> bool:
        """True when hidden states were left out."""
        return self.exact.is_minimal

    @cached_property
    def meanings(self) -> dict[str, sympy.Expr]:
        """What each state is, in quantities of the model: ``x_dot`` is ``s*x``."""
        return {x.name: to_sympy(self._printed.meaning(x), self._symbols) for x in self.exact.states}

    @cached_property
    def _printed(self) -> StateEquations:
        return StateEquations(self.exact)

    @cached_property
    def _symbols(self) -> dict[str, sympy.Symbol]:
        return symbols_of(self.exact.model)

    def _matrix(self, rows: tuple[Vector, ...], columns: int) -> sympy.Matrix:
        import sympy

        matrix = sympy.zeros(len(rows), columns)
        for i, row in enumerate(rows):
            for j, value in row.items():
                matrix[i, j] = to_sympy(self._printed.entry(value), self._symbols)
        return matrix.as_immutable()

    @cached_property
    def A(self) -> sympy.Matrix:  # noqa: N802
        """Immutable matrix of shape (n, n)."""
        return self._matrix(self.exact.a, len(self.exact.states))

    @cached_property
    def B(self) -> sympy.Matrix:  # noqa: N802
        """Immutable matrix of shape (n, inputs)."""
        return self._matrix(self.exact.b, len(self.exact.inputs))

    @cached_property
    def C(self) -> sympy.Matrix:  # noqa: N802
        """Immutable matrix of shape (outputs, n)."""
        return self._matrix(self.exact.c, len(self.exact.states))

    @cached_property
    def D(self) -> sympy.Matrix:  # noqa: N802
        """Immutable matrix of shape (outputs, inputs)."""
        return self._matrix(self.exact.d, len(self.exact.inputs))

    def bind(self, **values: int | float | Fraction | Decimal | str) -> BoundStateSpace:
        """Return the matrices as arrays, with the declared values or the given ones.

        Every entry is the double nearest to its exact value.

        Raises
        ------
        ModelError
            SF229 when a parameter has no value, SF231 when entries divide by zero, SF233 when one does not
            fit in double precision.
        UsageError
            SF902 for an unknown parameter.
        """
        from symflex.state_space.numeric import bound_state_space  # numpy

        return bound_state_space(self.exact, self._known(values))

    def discretise(
        self,
        dt: float | Fraction | str,
        delay: float | Fraction | str = 0,
        *,
        method: str = "zoh",
        prewarp: float | Fraction | str | None = None,
        **values: int | float | Fraction | Decimal | str,
    ) -> SampledStateSpace:
        """Return the exact system between samples, with its inputs held from one to the next.

        Every entry is the double nearest to that of the matrix exponential, which is computed in balls.
        ``tustin`` is for controllers: the difference equation that the bilinear transformation makes.

        Parameters
        ----------
        dt : float, Fraction or str
            The sampling time, [s] or with a unit, ``"1 ms"``.
        delay : float, Fraction or str
            A delay of all inputs [s], of any fraction of samples: past inputs become states.
        method : str
            ``zoh`` or ``tustin``.
        prewarp : float, Fraction or str, optional
            For ``tustin``: the frequency at which it is exact in addition to 0, [Hz] or with a unit.
        **values : optional
            As for :meth:`bind`.

        Raises
        ------
        ModelError
            As for :meth:`bind`; SF233 if the system grows beyond double precision within a sample.
        UsageError
            SF902 for an unknown parameter, or a sampling time that is not positive.

        Examples
        --------
        >>> import symflex
        >>> body = {"type": "mass", "at": "x", "m": "2 kg"}
        >>> model = symflex.Model(elements={"b": body}, inputs={"F": {"force": "x"}}, outputs={"X": "x"})
        >>> step = model.state_space().discretise("100 ms")
        >>> step.A.tolist(), step.B.tolist()  # 1, h and h^2/(2 m), h/m
        ([[1.0, 0.1], [0.0, 1.0]], [[0.0025], [0.05]])
        """
        from symflex.state_space.sampled import sampled_state_space, sampling_of  # numpy

        what = "a delay"
        sampling = sampling_of(dt, method, prewarp, "a sampling time")
        late = duration(delay, what, or_zero=True) if isinstance(delay, str) else finite(delay, what)
        return sampled_state_space(self.exact, self._known(values), sampling, late)

    def _known(self, values: dict[str, int | float | Fraction | Decimal | str]) -> dict[str, ExactValue]:
        """Return the values of all parameters that have one."""
        model = self.exact.model
        # One without value may be a parameter that does not occur.
        valued = tuple(p for p in model.parameters if p.value is not None or p.name in values)
        names = {p.name for p in model.parameters}
        return dict(read_values(valued if values.keys() <= names else model.parameters, values))

    def __str__(self) -> str:
        return "\n".join(self._printed.lines())

    def _repr_latex_(self) -> str | None:
        """Return the matrices for a notebook; None if they would not fit on a page."""
        from sympy import latex

        if len(self.states) > MOST_STATES:
            return None
        pairs = ((name, getattr(self, name)) for name in "ABCD")
        return "$" + r",\quad ".join(f"{name} = {latex(matrix)}" for name, matrix in pairs) + "$"

    def __repr__(self) -> str:
        counts = f"{len(self.states)} states, {len(self.inputs)} inputs, {len(self.outputs)} outputs"
        return f"<StateSpace: {counts}>"
