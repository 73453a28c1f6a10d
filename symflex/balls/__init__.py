"""Balls: numbers that contain what is meant, and how sharp they are. Every proof stands on this package."""

from symflex.balls.branching import Branching, Open, Part, branch, covered, halved
from symflex.balls.elimination import Eliminated, columns_of, eliminate
from symflex.balls.interval_newton import (
    NEWTON_STEPS,
    STALLED,
    Pair,
    narrowed,
    newton_box,
    status_of,
    stays_inside,
    two_steps,
)
from symflex.balls.precision import (
    UndecidedError,
    bits_for_digits,
    current_bits,
    current_terms,
    precision,
    precisions,
    series_terms,
    settled,
    to_complex_mpmath,
    to_mpmath,
)
from symflex.balls.values import (
    Arithmetic,
    EvaluationPlan,
    Value,
    at_centre,
    balancing,
    ball,
    binary_exponent,
    expansion,
    opposite,
    plan,
    raised,
    series_quotient,
    value_at,
)
