"""The LaTeX target."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from symflex.budget import spend
from symflex.codegen.export import Export
from symflex.errors import ModelError, SymflexError
from symflex.model import Model
from symflex.model.model import Figure as Asked
from symflex.print.forms import PrintedForm, print_forms
from symflex.print.latex import TEXT_WIDTH_MM, Picture, latex_document, latex_files
from symflex.roots import PoleZeroMap
from symflex.roots.locate import locate
from symflex.transfer import AnyBoundFunction, AnyTransferFunction, bind_any

ROOT_DIGITS = 15  # digits to which roots are found for a table; it prints fewer

LOOP_TITLES = {
    "locus": "Root locus",
    "nichols": "Nichols chart of the loop gain",
    "nyquist": "Nyquist plot of the loop gain",
    "sensitivity": "Sensitivities of the loop",
}

DEFAULT_FIGURES = {"bode": "Frequency responses", "poles_zeros": "Poles and zeros", "modes": "Lowest modes"}
"""Figures of kinds that the model asks for none of."""
MOST_IN_A_FIGURE, TALLEST_MM = 6, 225.0
"""Functions that a figure holds which the model did not ask for, and its height on a page, with its words."""


@dataclass(frozen=True, slots=True)
class LatexExporter:
    """A standalone LaTeX document, or the files it is made of."""

    width_mm: float = TEXT_WIDTH_MM  # width of the column
    form: str | None = None  # of the transfer functions; the shortest symbolic one by default
    has_figures: bool = True  # the files contain figures; a document in one file has none

    suffix = ".tex"
    summary = "standalone LaTeX document: parameters, transfer functions, poles, zeros, modes"
    solves = False

    def export(
        self, model: Model, tfs: Sequence[AnyTransferFunction], stem: str = "", *, is_alone: bool = True
    ) -> Export:
        """Return the document."""
        forms, maps, warnings = self._parts(tfs)
        text = latex_document(model, tfs, forms, pole_zero_maps=maps, width_mm=self.width_mm)
        return Export(text, warnings)

    def export_files(
        self, model: Model, tfs: Sequence[AnyTransferFunction]
    ) -> tuple[dict[str, str], tuple[str, ...]]:
        """Return the files by name, to be written into one folder, and the warnings."""
        forms, maps, warnings = self._parts(tfs)
        pictures, more = self._pictures(model, tfs) if self.has_figures else ([], [])
        files = latex_files(model, tfs, forms, pole_zero_maps=maps, pictures=pictures, width_mm=self.width_mm)
        return files, (*warnings, *more)

    def _pictures(self, model: Model, tfs: Sequence[AnyTransferFunction]) -> tuple[list[Picture], list[str]]:
        """Return the model's figures, one of each kind besides, and why others are left out."""
        bounds = [bound for bound in map(_bound, tfs) if bound is not None and not bound.is_zero]
        pictures: list[Picture] = []
        warnings: list[str] = []
        titles = {**DEFAULT_FIGURES, **LOOP_TITLES, "deflection": "Deflection shapes"}
        for figure in model.figures:
            names = {"/".join(pair) for pair in figure.of}
            if of := [bound for bound in bounds if not names or bound.name in names]:
                title = figure.title or titles.get(figure.kind, figure.kind)
                self._add(pictures, warnings, figure, of, title)
        asked = {figure.kind for figure in model.figures}
        for kind, title in DEFAULT_FIGURES.items():
            if kind not in asked and bounds:
                self._add(pictures, warnings, Asked(kind, kind, ()), bounds[:MOST_IN_A_FIGURE], title)
        return pictures, warnings

    def _add(
        self,
        pictures: list[Picture],
        warnings: list[str],
        asked: Asked,
        bounds: Sequence[AnyBoundFunction],
        title: str,
    ) -> None:
        """Draw one figure, without its title, which stands below it."""
        from symflex.figures import LOOP_FIGURES, AxisLimits, draw, render  # imports matplotlib
        from symflex.figures.style import MM_PER_INCH
        from symflex.loops.of_model import characteristic_loop

        name, kind = asked.name, asked.kind
        of = bounds[:1] if kind == "modes" else bounds  # all functions of a model have the same modes
        look = partial(draw, kind, band_hz=asked.band, frame=AxisLimits(at=asked.at), font="latex")
        try:
            if asked.gain and kind in LOOP_FIGURES:
                loop = characteristic_loop(of[0].source.model, asked.gain)
                figure = look(loop, width_mm=self.width_mm)
            else:
                figure = look(of, width_mm=self.width_mm)
        except SymflexError as error:
            spend()
            is_without_modes = kind == "modes" and error.diagnostics[0].code == "SF402"
            if not is_without_modes:
                warnings.append(f"the figure {name} is left out: {error.diagnostics[0].message}")
            return
        height = MM_PER_INCH * figure.get_figheight()
        if height > TALLEST_MM:
            warnings.append(f"the figure {name} is left out: it is {height:.0f} mm high")
            return
        says_whose = kind == "modes" or bool(asked.gain) or title not in DEFAULT_FIGURES.values()
        shown = () if says_whose else tuple(bound.source for bound in of)
        pictures.append(Picture(name, render(figure, "pgf", font="latex").decode("ascii"), title, shown))

    def _parts(
        self, tfs: Sequence[AnyTransferFunction]
    ) -> tuple[tuple[PrintedForm, ...], list[PoleZeroMap], tuple[str, ...]]:
        """Return forms, poles and zeros of functions whose parameters all have values, and warnings."""
        forms, sentences = print_forms(tfs, self.form)
        maps, warnings = [], list(sentences)
        for tf in tfs:
            if tf.is_rational and not tf.is_reduced:
                warnings.append(f"poles and zeros of {tf.name} are left out: it is in nested form")
            bound = _bound(tf)
            if bound is None:
                continue
            try:
                maps.append(locate(bound, digits=ROOT_DIGITS))
            except SymflexError as error:
                spend()
                warnings.append(f"poles and zeros of {tf.name} are left out: {error.diagnostics[0].message}")
        return forms, maps, tuple(warnings)


def _bound(tf: AnyTransferFunction) -> AnyBoundFunction | None:
    """Return a function with numbers, ``None`` if it is symbolic or nested, whose roots take too long."""
    if tf.is_rational and not tf.is_reduced:
        return None
    try:
        return bind_any(tf)
    except ModelError:
        return None  # symbolic, which is not a fault
