"""The sections of a model's chapter. A new one is a function here and a line in :data:`SECTIONS`.

It returns None where a model gives no cause for it, and raises SymflexError when what it needs cannot be
computed; the report gives the reason in its place.
"""

from collections.abc import Callable

from symflex.report.document import ChapterPart
from symflex.report.sections import contact, files, formulas, roots, symbolic
from symflex.report.study import Study

SECTIONS: dict[str, Callable[[Study], ChapterPart | None]] = {  # sections in the order of the page
    "drawing": files.drawing_section,
    "parameters": formulas.parameter_section,
    "motion": formulas.motion_section,
    "equations": formulas.equation_section,
    "printed": formulas.audit_section,
    "figures": files.figure_section,
    "data": files.data_section,
    "roots": roots.root_section,
    "sampled": roots.sampled_section,
    "letters": symbolic.symbolic_section,
    "loops": roots.loop_section,
    "contact": contact.contact_section,
    "files": files.export_section,
    "specification": formulas.specification_section,
}
OF_CONTINUOUS = ("equations", "printed", "figures", "data", "roots", "letters", "loops", "files")
"""Sections that a model with a sampled controller does not have."""
