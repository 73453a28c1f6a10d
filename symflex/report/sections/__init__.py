"""The sections of a model's chapter. A new one is a function here and a line in :data:`SECTIONS`."""

from symflex.report.document import SectionMaker
from symflex.report.sections.files import data_section, drawing_section, export_section, figure_section
from symflex.report.sections.formulas import (
    audit_section,
    equation_section,
    parameter_section,
    specification_section,
)
from symflex.report.sections.roots import loop_section, root_section

SECTIONS: dict[str, SectionMaker] = {
    "drawing": drawing_section,
    "parameters": parameter_section,
    "equations": equation_section,
    "printed": audit_section,
    "figures": figure_section,
    "data": data_section,
    "roots": root_section,
    "loops": loop_section,
    "files": export_section,
    "specification": specification_section,
}
"""In the order of the page."""
