"""Field theories and boundary-value problems: first-order systems in x and their transfer matrices.

A new theory is one function and one line in :data:`FIELDS`.
"""

from symflex.fields.axial import rod, shaft, string
from symflex.fields.characteristic import Component, components
from symflex.fields.euler_bernoulli import euler_bernoulli, rayleigh
from symflex.fields.reduction import FieldEquation, first_order
from symflex.fields.system import FieldSystem, FieldTheory, Matrix
from symflex.fields.timoshenko import timoshenko

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
