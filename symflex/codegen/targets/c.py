"""The C target."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.codegen.c import c_files
from symflex.codegen.export import Export, shortfalls

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.model import Model
    from symflex.transfer import AnyTransferFunction


class CExporter:
    """A C99 source file and its header."""

    suffix = ".c"
    summary = "C99 source and header, values at s and arrays of frequencies, verified likewise"

    def export(
        self, model: Model, tfs: Sequence[AnyTransferFunction], stem: str = "", *, is_alone: bool = True
    ) -> Export:
        """Return the source, with the header as its companion; accuracy that was not reached is a warning."""
        made = c_files(tfs, model, model.analysis.band, name=None if is_alone else stem)
        companions = {".h": made.header} if made.header else {}
        return Export(made.source, shortfalls(made.verified), companions)
