"""Names of columns and their units, as headings write them.

x [mm]      x in mm      x_mm      x/mm      V(out)      a row of units below the names
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from symflex.data.measurement.column_names import SECONDS
from symflex.data.measurement.measured_response import in_si
from symflex.data.measurement.text_table import COMMENTS, SIGNS, TextTable, bare, cut

_IN_BRACKETS = re.compile(r"\s*[\[(]([^\[\](){}]*(?:\([^()]*\)[^\[\]()]*)?)[\])]\s*$")
_NODE = re.compile(r"([VI])\w?\(([^()]+)\)", re.I)  # of SPICE: V(out), I(R1), Id(M1)
_LABELS = "Y_Unit_Label\t"  # of LabVIEW, above the names
_BEHIND = re.compile(r"(?<=\w)(?:\s+in\s+|,\s*)(\S+)$")
_SUFFIX = re.compile(
    r"(?<=\w)_(mm|um|nm|mV|uV|kV|mA|kN|mN|Nm|deg|rpm|rad|kPa|bar|N|V|mm_s|m_s2?|rad_s|deg_s|dps)$"
)
"""A unit behind a name: ``x in mm``, ``x, mm``, ``x_mm``."""


def units_below(table: TextTable, first: int, names: Sequence[str]) -> list[str]:
    """Return the units in the line above the first row, none if it is no row of units, or has the names."""
    above = next((line for line in reversed(table.lines[:first]) if line.strip()), "")
    text = above.strip().lstrip(SIGNS) if above.strip().startswith(COMMENTS) else above
    cells = [cell.strip("[]()<> ") for cell in cut(text, table.delimiter)]
    are_units = [cell.lower() in SECONDS or in_si(cell) is not None for cell in cells]
    is_row = 1 < len(cells) <= len(names) and cells != [name.strip("[]()<> ") for name in names]
    if is_row and 2 * sum(are_units) > len(cells):
        return cells
    labels = next((line for line in table.lines[:first] if line.startswith(_LABELS)), "")
    return ["", *cut(labels, table.delimiter)[1:]] if labels else []


def with_unit(cell: str, style: str) -> tuple[str, str]:
    """Return a name and the unit that is written behind it, as in ``x [mm]``, ``x in mm`` or ``x_mm``."""
    text = bare(cell)
    if (node := _NODE.fullmatch(text)) and (in_si(node[2]) or ("", ""))[1] not in ("V", "A"):
        return text, {"V": "V", "I": "A"}[node[1].upper()]
    if match := _IN_BRACKETS.search(text):
        return text[: match.start()].strip(), match[1].strip()
    match = _BEHIND.search(text) or _SUFFIX.search(text)
    if style and not match:
        match = re.search(rf"(?<=\w)\s*{style}\s*(\(?[^{style}()]+(?:\([^()]+\))?\)?)$", text)
    unit = re.sub(r"(?<=\w)_(?=s)", "/", match[1]) if match else ""
    return (text[: match.start()].strip(), unit) if match and in_si(unit) else (text, "")
