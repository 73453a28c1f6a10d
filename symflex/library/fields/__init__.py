"""Field theories and boundary-value problems: first-order systems in x and their transfer matrices.

A new theory is one function and one line in :data:`FIELDS`.
"""

from symflex.library.fields.characteristic import Component, components
from symflex.library.fields.system import FieldEquation, FieldSystem, FieldTheory, Matrix, first_order
from symflex.library.fields.theories import euler_bernoulli, rayleigh, rod, shaft, string, timoshenko

FIELDS: dict[str, FieldTheory] = {
    "euler-bernoulli": euler_bernoulli,
    "rayleigh": rayleigh,
    "timoshenko": timoshenko,
    "rod": rod,
    "shaft": shaft,
    "string": string,
}

__all__ = [
    "FIELDS",
    "Component",
    "FieldEquation",
    "FieldSystem",
    "FieldTheory",
    "Matrix",
    "components",
    "first_order",
]
