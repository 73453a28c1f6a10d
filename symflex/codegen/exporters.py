"""Targets of ``symflex export``. A new target is one module in ``targets`` and one line in ``EXPORTERS``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.codegen.targets.array import ARRAY_API_EXPORTER, JAX_EXPORTER
from symflex.codegen.targets.c import CExporter
from symflex.codegen.targets.julia import JuliaExporter
from symflex.codegen.targets.latex import LatexExporter
from symflex.codegen.targets.matlab import MatlabExporter
from symflex.codegen.targets.numpy import NumpyExporter
from symflex.codegen.targets.state_space import StateSpaceExporter

if TYPE_CHECKING:
    from symflex.codegen.export import Exporter

EXPORTERS: dict[str, Exporter] = {
    "numpy": NumpyExporter(),
    "array-api": ARRAY_API_EXPORTER,
    "jax": JAX_EXPORTER,
    "c": CExporter(),
    "matlab": MatlabExporter(),
    "julia": JuliaExporter(),
    "state-space": StateSpaceExporter(),
    "latex": LatexExporter(),
}
"""``symflex export``."""
