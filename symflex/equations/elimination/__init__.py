"""Exact elimination: closed sub-impedances, unit pivots, memoised minors, and singular systems explained."""

from symflex.equations.elimination.closing import Closure, close, eliminate_unit_pivots
from symflex.equations.elimination.determinants import Determinants, Minors, expanded_terms
from symflex.equations.elimination.singular import explain_singular, free_at_rest, is_singular, unreached
