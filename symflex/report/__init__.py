"""A report on one or several models: a page, an article, figures, code and data in one folder.

Input: specifications.
Output: a :class:`Report`, which :func:`report_page` and :func:`report_article` print.

What a report says about each model is in :data:`symflex.report.sections.SECTIONS`, how models are compared in
:data:`symflex.report.comparison.COLUMNS`, and what can be claimed of them in
:data:`symflex.report.claims.PREDICATES`.
"""

from symflex.report.article import report_article
from symflex.report.page import report_page
from symflex.report.published import written
from symflex.report.report import (
    Report,
    compose,
    find_claims,
    find_measurements,
    find_specifications,
    name_specifications,
    write_chapters,
)

__all__ = [
    "Report",
    "compose",
    "find_claims",
    "find_measurements",
    "find_specifications",
    "name_specifications",
    "report_article",
    "report_page",
    "write_chapters",
    "written",
]
