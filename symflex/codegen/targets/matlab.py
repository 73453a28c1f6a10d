"""The MATLAB target."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.codegen.export import Export, shortfalls
from symflex.codegen.matlab import matlab_function_file
from symflex.codegen.program import inert

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.model import Model
    from symflex.transfer import AnyTransferFunction


LONGEST_STEM = 64
"""Characters of a file's name that a message shows."""


class MatlabExporter:
    """One function file for MATLAB and Octave."""

    suffix = ".m"
    summary = "MATLAB and Octave function file, a handle per transfer function, verified likewise"

    def export(
        self, model: Model, tfs: Sequence[AnyTransferFunction], stem: str = "", *, is_alone: bool = True
    ) -> Export:
        """Return the file; a warning says so when MATLAB cannot call a file of this name."""
        made = matlab_function_file(tfs, model, stem, model.analysis.band)
        warnings = shortfalls(made.verified)
        if stem and made.name != stem:
            shown = inert(stem[:LONGEST_STEM])
            warnings += (f"MATLAB cannot call a file '{shown}.m': name it '{made.name}.m', as its function",)
        return Export(made.text, warnings)
