"""Targets of ``symflex export``. A new target is one file and one line in ``EXPORTERS``."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Protocol

from symflex.emit.forms import print_form
from symflex.emit.latex import latex_document
from symflex.emit.numpy_module import numpy_module
from symflex.emit.state_space_module import state_space_module
from symflex.state_space import minimal, realise

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.emit.program import Verification
    from symflex.model import Model
    from symflex.transfer import TransferFunction


ACCURACY = 1e-13
"""Relative error of exported code above which the user is warned."""


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


class LatexExporter:
    """A standalone LaTeX document."""

    suffix = ".tex"
    summary = "standalone LaTeX document: parameters, transfer functions, hidden modes"

    def export(self, model: Model, tfs: Sequence[TransferFunction]) -> Export:
        """Return the document."""
        return Export(latex_document(model, tfs, [print_form(tf) for tf in tfs]))


EXPORTERS: dict[str, Exporter] = {
    "numpy": NumpyExporter(),
    "latex": LatexExporter(),
    "state-space": StateSpaceExporter(),
}
