"""A Typst document of a model: its title, and its transfer functions as displays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from symflex.codegen.export import Export
from symflex.model import Model
from symflex.print.documents import typst_document
from symflex.print.forms import print_forms, with_shared_denominators
from symflex.transfer import AnyTransferFunction


@dataclass(frozen=True, slots=True)
class TypstExporter:
    """Transfer functions as a Typst document."""

    suffix = ".typ"
    summary = "Typst document of the transfer functions"
    solves = False

    def export(
        self, model: Model, tfs: Sequence[AnyTransferFunction], stem: str = "", *, is_alone: bool = True
    ) -> Export:
        """Return the document."""
        forms, warnings = print_forms(tfs)
        entries = list(zip(tfs, with_shared_denominators(tfs, forms), strict=True))
        return Export(typst_document(model.title or stem, entries), tuple(warnings))
