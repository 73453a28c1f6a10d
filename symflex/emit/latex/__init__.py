"""LaTeX: expressions, equations that fit the column, tables, documents that compile without warnings."""

from symflex.emit.latex.document import TEXT_WIDTH_MM, latex_document, latex_fragment
from symflex.emit.latex.equation import equation_label, inline_latex, model_labels, transfer_function_latex
from symflex.emit.latex.expression import latex_expression
from symflex.emit.latex.label import label_of
from symflex.emit.latex.table import parameter_table, pole_zero_table
from symflex.emit.latex.text import escape_text

__all__ = [
    "TEXT_WIDTH_MM",
    "equation_label",
    "escape_text",
    "inline_latex",
    "label_of",
    "latex_document",
    "latex_expression",
    "latex_fragment",
    "model_labels",
    "parameter_table",
    "pole_zero_table",
    "transfer_function_latex",
]
