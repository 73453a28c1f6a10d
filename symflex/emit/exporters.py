"""Targets of ``symflex export``. A new target is one file and one line in ``EXPORTERS``."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Protocol

from symflex.emit.forms import print_forms
from symflex.emit.latex import TEXT_WIDTH_MM, latex_document, latex_files
from symflex.emit.numpy_module import numpy_module
from symflex.emit.state_space_module import state_space_module
from symflex.errors import ModelError, SymflexError
from symflex.roots.locate import locate
from symflex.state_space import minimal, realise
from symflex.transfer import bind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.emit.forms import PrintedForm
    from symflex.emit.program import Verification
    from symflex.model import Model
    from symflex.roots import PoleZeroMap
    from symflex.transfer import TransferFunction


ACCURACY = 1e-13
"""Relative error of exported code above which the user is warned."""

ROOT_DIGITS = 15
"""Digits to which roots are found for a table; it prints fewer."""


@dataclass(frozen=True, slots=True)
class Export:
    """What an exporter made.

    Parameters
    ----------
    text : str
        The file's content.
    warnings : tuple of str
        What the user should know, for instance an accuracy that was not reached.
    """

    text: str
    warnings: tuple[str, ...] = ()


class Exporter(Protocol):
    """Turns the transfer functions of a model into a file of some language."""

    suffix: str
    summary: str

    def export(self, model: Model, tfs: Sequence[TransferFunction]) -> Export:
        """Return the file."""
        ...


class NumpyExporter:
    """One self-contained numpy module."""

    suffix = ".py"
    summary = "numpy module, one function per transfer function, verified against ball arithmetic"

    def export(self, model: Model, tfs: Sequence[TransferFunction]) -> Export:
        """Return the module; accuracy that was not reached is a warning."""
        made = numpy_module(tfs, model, model.analysis.band)
        # A function and its frequency response in real arithmetic: the worse one is told of, once.
        worst: dict[str, Verification] = {}
        for v in made.verified:
            if v.name not in worst or (v.error or 0.0) > (worst[v.name].error or 0.0):
                worst[v.name] = v
        return Export(made.text, tuple(w for v in worst.values() if (w := _shortfall(v))))


def _shortfall(verification: Verification) -> str:
    """Return what the user should know about an accuracy, empty when it is as it should be."""
    name, error = verification.name, verification.error
    if error is None:
        return f"{name} is not verified: {verification.reason}"
    if error <= ACCURACY:
        return ""
    low, high = (float(f) for f in verification.band)
    if not isfinite(error):
        return f"{name} overflows somewhere over {low:g} Hz to {high:g} Hz"
    return f"{name} is accurate to {error:.1e} only, over {low:g} Hz to {high:g} Hz"


class StateSpaceExporter:
    """State equations as a function of the parameters, in one numpy module.

    Parameters
    ----------
    is_minimal : bool
        Leave out what no input reaches or no output shows.
    """

    suffix = ".py"
    summary = "numpy module with A, B, C, D as a function of the parameters, states named"

    def __init__(self, *, is_minimal: bool = False) -> None:
        self.is_minimal = is_minimal

    def export(self, model: Model, tfs: Sequence[TransferFunction]) -> Export:
        """Return the module; accuracy that was not reached is a warning."""
        system = realise(model, [(tf.output.name, tf.input.name) for tf in tfs])
        made = state_space_module(minimal(system) if self.is_minimal else system, tfs, model.analysis.band)
        return Export(made.text, tuple(w for v in made.verified if (w := _shortfall(v))))


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

    def export(self, model: Model, tfs: Sequence[TransferFunction]) -> Export:
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


EXPORTERS: dict[str, Exporter] = {
    "numpy": NumpyExporter(),
    "latex": LatexExporter(),
    "state-space": StateSpaceExporter(),
}
