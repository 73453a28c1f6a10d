"""A report on one or several models: a page, an article, figures, code and data in one folder.

Input: specifications.
Output: a :class:`~symflex.report.report.Report`, which :mod:`.page` and :mod:`.article` print, and
:func:`symflex.report.published.written` writes.

What a chapter contains is in :data:`symflex.report.sections.SECTIONS`, how models are compared in
:data:`symflex.report.comparison.COLUMNS`, and what can be claimed of them in
:data:`symflex.report.claims.predicates.PREDICATES`.
"""
