"""Printed formulas against derived functions: proved equal, or where they differ.

Input: a derived :class:`~symflex.transfer.TransferFunction` and a :class:`~symflex.model.Published` formula,
or a :class:`~symflex.model.PrintedTable` of roots. Output: an :class:`Audit`, or a
:class:`~symflex.audit.tables.TableAudit`. ``tables`` and ``slips`` need roots, and are imported where a model
has tables.
"""

from symflex.audit.judge import Audit, audit, check_published, judge
