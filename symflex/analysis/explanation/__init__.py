"""Why zeros are where they are: the constrained systems whose poles they are, with proof."""

from symflex.analysis.explanation.text import ZeroExplanation, explanation_paragraphs, explanation_text
from symflex.analysis.explanation.zeros import explain_zeros
