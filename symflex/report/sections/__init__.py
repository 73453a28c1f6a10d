"""The sections of a model's chapter. A new one is a function here and a line in :data:`SECTIONS`."""

from symflex.report.document import SectionMaker
from symflex.report.sections import files, formulas, roots

SECTIONS: dict[str, SectionMaker] = {
    "drawing": files.drawing_section,
    "parameters": formulas.parameter_section,
    "equations": formulas.equation_section,
    "printed": formulas.audit_section,
    "figures": files.figure_section,
    "data": files.data_section,
    "roots": roots.root_section,
    "loops": roots.loop_section,
    "files": files.export_section,
    "specification": formulas.specification_section,
}
"""In the order of the page."""
