"""Targets of ``symflex export``. A new target is one module in ``targets`` and one line in ``EXPORTERS``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.emit.targets.c import CExporter
from symflex.emit.targets.julia import JuliaExporter
from symflex.emit.targets.latex import LatexExporter
from symflex.emit.targets.matlab import MatlabExporter
from symflex.emit.targets.numpy import NumpyExporter
from symflex.emit.targets.state_space import StateSpaceExporter

if TYPE_CHECKING:
    from symflex.emit.export import Exporter

EXPORTERS: dict[str, Exporter] = {
    "numpy": NumpyExporter(),
    "c": CExporter(),
    "matlab": MatlabExporter(),
    "julia": JuliaExporter(),
    "state-space": StateSpaceExporter(),
    "latex": LatexExporter(),
}
"""``symflex export``."""
