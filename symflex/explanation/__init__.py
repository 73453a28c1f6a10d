"""Why zeros are where they are: the constrained systems whose poles they are, with proof."""

from symflex.explanation.parts import Part
from symflex.explanation.text import explanation_json, explanation_paragraphs, explanation_text
from symflex.explanation.zeros import EndChange, RealZero, ZeroExplanation, explain_zeros

__all__ = [
    "EndChange",
    "Part",
    "RealZero",
    "ZeroExplanation",
    "explain_zeros",
    "explanation_json",
    "explanation_paragraphs",
    "explanation_text",
]
