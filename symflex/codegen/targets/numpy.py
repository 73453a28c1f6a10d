"""The numpy target."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.codegen.export import Export, shortfalls
from symflex.codegen.numpy.module import numpy_module

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.model import Model
    from symflex.transfer import AnyTransferFunction


class NumpyExporter:
    """One self-contained numpy module."""

    suffix = ".py"
    summary = "numpy module, one function per transfer function, verified against ball arithmetic"

    def export(
        self, model: Model, tfs: Sequence[AnyTransferFunction], stem: str = "", *, is_alone: bool = True
    ) -> Export:
        """Return the module; accuracy that was not reached is a warning."""
        made = numpy_module(tfs, model, model.analysis.band)
        return Export(made.text, shortfalls(made.verified))
