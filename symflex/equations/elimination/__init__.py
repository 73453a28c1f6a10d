"""Exact elimination: closed sub-impedances, unit pivots, memoised minors, and singular systems explained."""

from symflex.equations.elimination.closing import ClosedSystem, Closure, close
from symflex.equations.elimination.determinants import Determinants
from symflex.equations.elimination.expanded_size import expanded_terms
from symflex.equations.elimination.minors import Minors, expansion_order
from symflex.equations.elimination.reach import unreached
from symflex.equations.elimination.singular import explain_singular, is_singular
from symflex.equations.elimination.star_mesh import Elimination, eliminate
from symflex.equations.elimination.straight_line import ONE, Step, StraightLine, Workbench
from symflex.equations.elimination.unit_pivots import Reduced, eliminate_unit_pivots

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
