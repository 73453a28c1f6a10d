"""Printed formulas against derived functions: proved equal, or where they differ.

Input: a derived :class:`~symflex.transfer.TransferFunction` and a :class:`~symflex.model.Published` formula.
Output: an :class:`Audit`.
"""

from symflex.audit.corrections import Change, Correction
from symflex.audit.judge import Audit, audit, check_published, judge
from symflex.audit.laws import LawCheck
from symflex.audit.numeric import Comparison, Deviation
from symflex.audit.reading import Formula, formula_of

__all__ = [
    "Audit",
    "Change",
    "Comparison",
    "Correction",
    "Deviation",
    "Formula",
    "LawCheck",
    "audit",
    "check_published",
    "formula_of",
    "judge",
]
