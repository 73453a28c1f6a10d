"""LaTeX: expressions, equations that fit the column, tables, documents that compile without warnings."""

from symflex.print.label import label_of
from symflex.print.latex.document import (
    DOCUMENT,
    TEXT_WIDTH_MM,
    Picture,
    latex_document,
    latex_files,
    latex_fragment,
)
from symflex.print.latex.equation import (
    equation_label,
    form_labels,
    formula_latex,
    inline_latex,
    model_labels,
    notebook_latex,
    ratio_latex,
    transfer_function_latex,
)
from symflex.print.latex.expression import latex_expression
from symflex.print.latex.page import COLUMNS_MM, column_width, width_of
from symflex.print.latex.table import mode_table, parameter_table, root_table
from symflex.print.latex.text import escape_text
