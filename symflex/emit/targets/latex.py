"""The LaTeX target."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.emit.export import Export
from symflex.emit.forms import print_forms
from symflex.emit.latex import TEXT_WIDTH_MM, latex_document, latex_files
from symflex.errors import ModelError, SymflexError
from symflex.roots.locate import locate
from symflex.transfer import bind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.emit.forms import PrintedForm
    from symflex.model import Model
    from symflex.roots import PoleZeroMap
    from symflex.transfer import TransferFunction


ROOT_DIGITS = 15
"""Digits to which roots are found for a table; it prints fewer."""


@dataclass(frozen=True, slots=True)
class LatexExporter:
    """A standalone LaTeX document, or the files it is made of.

    Parameters
    ----------
    width_mm : float
        Width of the column.
    form : str, optional
        Of the transfer functions; the shortest symbolic one by default.
    """

    width_mm: float = TEXT_WIDTH_MM
    form: str | None = None

    suffix = ".tex"
    summary = "standalone LaTeX document: parameters, transfer functions, poles, zeros, modes"

    def export(
        self, model: Model, tfs: Sequence[TransferFunction], stem: str = "", *, is_alone: bool = True
    ) -> Export:
        """Return the document."""
        forms, maps, warnings = self._parts(tfs)
        text = latex_document(model, tfs, forms, pole_zero_maps=maps, width_mm=self.width_mm)
        return Export(text, warnings)

    def export_files(
        self, model: Model, tfs: Sequence[TransferFunction]
    ) -> tuple[dict[str, str], tuple[str, ...]]:
        """Return the files by name, to be written into one folder, and the warnings."""
        forms, maps, warnings = self._parts(tfs)
        return latex_files(model, tfs, forms, pole_zero_maps=maps, width_mm=self.width_mm), warnings

    def _parts(
        self, tfs: Sequence[TransferFunction]
    ) -> tuple[tuple[PrintedForm, ...], list[PoleZeroMap], tuple[str, ...]]:
        """Return forms, poles and zeros of functions whose parameters all have values, and warnings."""
        forms, sentences = print_forms(tfs, self.form)
        maps, warnings = [], list(sentences)
        for tf in tfs:
            try:
                bound = bind(tf)
            except ModelError:
                continue  # symbolic, which is no fault
            try:
                maps.append(locate(bound, digits=ROOT_DIGITS))
            except SymflexError as error:
                warnings.append(f"poles and zeros of {tf.name} are left out: {error.diagnostics[0].message}")
        return forms, maps, tuple(warnings)
