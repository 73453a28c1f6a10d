"""MathML Core: expressions and transfer functions for web pages that need no script to set them."""

from symflex.print.mathml.element import label_mathml, math_element
from symflex.print.mathml.expression import (
    WIDEST_FRACTION,
    MathmlWriter,
    MathRow,
    mathml_expression,
    ratio_mathml,
    transfer_function_mathml,
)

__all__ = [
    "WIDEST_FRACTION",
    "MathRow",
    "MathmlWriter",
    "label_mathml",
    "math_element",
    "mathml_expression",
    "ratio_mathml",
    "transfer_function_mathml",
]
