"""The sections of a model's chapter. A new one is a module here and a line in :data:`SECTIONS`."""

from symflex.report.part import SectionMaker
from symflex.report.sections.audits import audit_section
from symflex.report.sections.equations import equation_section
from symflex.report.sections.exports import export_section
from symflex.report.sections.figures import data_section, figure_section
from symflex.report.sections.loops import loop_section
from symflex.report.sections.roots import root_section
from symflex.report.sections.specification import parameter_section, specification_section

SECTIONS: dict[str, SectionMaker] = {
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
