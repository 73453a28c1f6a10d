"""Printed formulas against derived functions: proved equal, or where they differ.

Input: a derived :class:`~symflex.transfer.TransferFunction` and a :class:`~symflex.model.Published` formula.
Output: an :class:`Audit`.
"""

from symflex.audit.judge import Audit, audit, check_published, judge
