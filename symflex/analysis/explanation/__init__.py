"""Why zeros are where they are: the constrained systems whose poles they are, with proof."""

from symflex.analysis.explanation.parts import ConstrainedPart
from symflex.analysis.explanation.text import explanation_json, explanation_paragraphs, explanation_text
from symflex.analysis.explanation.zeros import ZeroExplanation, explain_zeros
