"""Printed formulas against derived functions: proved equal, or where they differ.

Input: a derived :class:`~symflex.transfer.TransferFunction` and a :class:`~symflex.model.Published` formula,
or a :class:`~symflex.model.PrintedTable` of roots. Output: an :class:`Audit`, or a :class:`TableAudit`.
"""

from symflex.audit.judge import Audit, audit, check_published, judge
from symflex.audit.slips import audit_tables, explained_by_print
from symflex.audit.tables import TableAudit, judge_array
