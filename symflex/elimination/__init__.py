"""Exact elimination: closed sub-impedances, unit pivots, memoised minors, and singular systems explained."""

from symflex.elimination.closing import ClosedSystem, Closure, close
from symflex.elimination.determinants import Determinants
from symflex.elimination.expanded_size import expanded_terms
from symflex.elimination.minors import Minors, expansion_order
from symflex.elimination.reach import unreached
from symflex.elimination.singular import explain_singular, is_singular
from symflex.elimination.star_mesh import Elimination, eliminate
from symflex.elimination.straight_line import ONE, Step, StraightLine, Workbench
from symflex.elimination.unit_pivots import Reduced, eliminate_unit_pivots

__all__ = [
    "ONE",
    "ClosedSystem",
    "Closure",
    "Determinants",
    "Elimination",
    "Minors",
    "Reduced",
    "Step",
    "StraightLine",
    "Workbench",
    "close",
    "eliminate",
    "eliminate_unit_pivots",
    "expanded_terms",
    "expansion_order",
    "explain_singular",
    "is_singular",
    "unreached",
]
