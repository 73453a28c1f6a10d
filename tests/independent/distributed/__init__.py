"""Distributed systems, each twice: as a specification, and as a boundary-value problem from the physics.

The second does not read the first, except for the numbers under [parameters].
"""

from tests.independent.distributed.case import Case
from tests.independent.distributed.elements_alone import ELEMENTS_IN_BENDING, ELEMENTS_IN_TENSION_AND_TORSION
from tests.independent.distributed.fields_in_bending import FIELDS_IN_BENDING
from tests.independent.distributed.fields_of_all_kinds import FIELDS_OF_ALL_KINDS
from tests.independent.distributed.networks import NETWORKS

CASES = (
    *FIELDS_IN_BENDING,
    *FIELDS_OF_ALL_KINDS,
    *ELEMENTS_IN_BENDING,
    *ELEMENTS_IN_TENSION_AND_TORSION,
    *NETWORKS,
)

__all__ = ["CASES", "Case"]
