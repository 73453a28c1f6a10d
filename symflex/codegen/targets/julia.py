"""The Julia target."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.codegen.export import Export, shortfalls
from symflex.codegen.julia import julia_module

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.model import Model
    from symflex.transfer import AnyTransferFunction


class JuliaExporter:
    """One Julia module without dependencies."""

    suffix = ".jl"
    summary = "Julia module, one function per transfer function, verified likewise"

    def export(
        self, model: Model, tfs: Sequence[AnyTransferFunction], stem: str = "", *, is_alone: bool = True
    ) -> Export:
        """Return the module; accuracy that was not reached is a warning."""
        made = julia_module(tfs, model, stem, model.analysis.band)
        return Export(made.text, shortfalls(made.verified))
