"""Field theories and boundary-value problems: first-order systems in x and their transfer matrices.

A new theory is one function and one line in :data:`FIELDS`.
"""

from symflex.library.fields.axial import rod, shaft, string
from symflex.library.fields.characteristic import Component, components
from symflex.library.fields.euler_bernoulli import euler_bernoulli, rayleigh
from symflex.library.fields.reduction import FieldEquation, first_order
from symflex.library.fields.system import FieldSystem, FieldTheory, Matrix
from symflex.library.fields.timoshenko import timoshenko

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
