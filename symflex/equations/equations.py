"""The linear equations of a model, with the names of everything in them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from symflex.algebra import Factored, Propagation, Ring
    from symflex.expressions import Call
    from symflex.library.elements import EquationRow, LinearForm, Variable
    from symflex.library.fields import FieldSystem
    from symflex.model import Model


@dataclass(frozen=True, slots=True)
class ConstantFunction:
    """A generator that stands for an elementary function of constants.

    ``generator`` is its name in the ring, the expression's own text: ``sqrt(k*m)``.
    """

    generator: str
    expression: Call


@dataclass(frozen=True, slots=True)
class OutputRow:
    """An output ``y = form / divisor``; the divisor contains s when the output is filtered."""

    name: str
    form: LinearForm
    divisor: Factored


@dataclass(frozen=True, slots=True, eq=False)
class Continuum:
    """One distributed part, for what goes on inside it: ``dz/dx = matrix z + load u`` from its start on.

    Parameters
    ----------
    name : str
        The element's or field's.
    kind : str
        The element's type, or ``field``.
    system : FieldSystem
        Over the ring without kernels.
    start, length : Factored
        Where x begins, and how far it reaches; over the same ring.
    initial : tuple of Variable or None
        Per state, the unknown it equals at the start; None where it is zero there.
    loads : tuple of Variable
        What acts all along it, per column of ``system.loads``.
    """

    name: str
    kind: str
    system: FieldSystem
    start: Factored
    length: Factored
    initial: tuple[Variable | None, ...]
    loads: tuple[Variable, ...] = ()


@dataclass(frozen=True)
class Equations:
    """``A(s) x + B u = 0``, ``y = C x + D u``, over an exact ring.

    Parameters
    ----------
    model : Model
        Where they come from.
    ring : Ring
        Generators: s, parameters, closed definitions, pi, functions of constants.
    definitions : tuple of (str, Factored)
        Each closed definition in terms of the generators before it.
    constants : tuple of ConstantFunction
        What the function generators stand for.
    unknowns, inputs : tuple of Variable
        The names of x and u.
    rows : tuple of EquationRow
        As many as unknowns; polynomial but over a sparse ring.
    outputs : tuple of OutputRow
        The names of y and their forms.
    propagation : Propagation or None
        What the generators of distributed parts are; ``ring`` is its ring then.
    continua : tuple of Continuum
        The distributed parts.
    is_joined : bool
        Elements of one law that meet were taken as one.
    """

    model: Model
    ring: Ring
    definitions: tuple[tuple[str, Factored], ...]
    constants: tuple[ConstantFunction, ...]
    unknowns: tuple[Variable, ...]
    inputs: tuple[Variable, ...]
    rows: tuple[EquationRow, ...]
    outputs: tuple[OutputRow, ...]
    propagation: Propagation | None = None
    cleared: Factored | None = None
    continua: tuple[Continuum, ...] = ()
    is_joined: bool = False
