"""Targets of ``symflex export``. A new one is a file, and a line in ``EXPORTERS`` or ``SAMPLED``."""

from __future__ import annotations

from collections.abc import Mapping

from symflex.codegen.c.module import C99
from symflex.codegen.c.sampled import SAMPLED_C
from symflex.codegen.export import Exporter
from symflex.codegen.fmu import FMU
from symflex.codegen.javascript import JAVASCRIPT
from symflex.codegen.julia import JULIA
from symflex.codegen.latex import LatexExporter
from symflex.codegen.matlab import MATLAB
from symflex.codegen.modelica import ModelicaExporter
from symflex.codegen.python.module import ARRAY_API, JAX, NUMPY
from symflex.codegen.python.sampled import SAMPLED_PYTHON
from symflex.codegen.sampled import SampledLanguage
from symflex.codegen.state_space import StateSpaceExporter
from symflex.codegen.typst import TypstExporter

EXPORTERS: dict[str, Exporter] = {  # ``symflex export``
    "numpy": NUMPY,
    "array-api": ARRAY_API,
    "jax": JAX,
    "c": C99,
    "matlab": MATLAB,
    "julia": JULIA,
    "js": JAVASCRIPT,
    "state-space": StateSpaceExporter(),
    "modelica": ModelicaExporter(),
    "latex": LatexExporter(),
    "typst": TypstExporter(),
}

SAMPLED: dict[str, SampledLanguage] = {
    "c": SAMPLED_C,
    "numpy": SAMPLED_PYTHON,
    "fmu": FMU,
}  # ``symflex export --sample``, besides state-space; what is no key of ``EXPORTERS`` exists only sampled

SUMMARIES: Mapping[str, str] = {name: x.summary for name, x in EXPORTERS.items()} | {
    name: f"with --sample: {x.summary}" for name, x in SAMPLED.items() if name not in EXPORTERS
}  # what each target makes, in a line
