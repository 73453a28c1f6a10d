"""Targets of ``symflex export``. A new target is one line in ``EXPORTERS`` and what prints it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.codegen.c.module import C99
from symflex.codegen.javascript import JAVASCRIPT
from symflex.codegen.julia import JULIA
from symflex.codegen.latex import LatexExporter
from symflex.codegen.matlab import MATLAB
from symflex.codegen.python.module import ARRAY_API, JAX, NUMPY
from symflex.codegen.state_space import StateSpaceExporter

if TYPE_CHECKING:
    from symflex.codegen.export import Exporter

EXPORTERS: dict[str, Exporter] = {
    "numpy": NUMPY,
    "array-api": ARRAY_API,
    "jax": JAX,
    "c": C99,
    "matlab": MATLAB,
    "julia": JULIA,
    "js": JAVASCRIPT,
    "state-space": StateSpaceExporter(),
    "latex": LatexExporter(),
}
"""``symflex export``."""
