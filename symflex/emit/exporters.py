"""Targets of ``symflex export``. A new target is one file and one line in ``EXPORTERS``."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Protocol

from symflex.emit.array_module import ARRAY_API, JAX, Dialect, array_module
from symflex.emit.forms import print_form
from symflex.emit.latex import latex_document
from symflex.emit.numpy_module import numpy_module

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

    @property
    def suffix(self) -> str:
        """Of the file's name."""
        ...

    @property
    def summary(self) -> str:
        """What is made, in a line."""
        ...

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
        return Export(made.text, _shortfalls(made.verified))


@dataclass(frozen=True, slots=True)
class ArrayExporter:
    """One self-contained module over libraries of arrays that its arguments decide on, or over jax."""

    dialect: Dialect
    summary: str
    suffix: str = ".py"

    def export(self, model: Model, tfs: Sequence[TransferFunction]) -> Export:
        """Return the module; accuracy that was not reached is a warning."""
        made = array_module(tfs, model, self.dialect, model.analysis.band)
        return Export(made.text, _shortfalls(made.verified))


def _shortfalls(verified: Sequence[Verification]) -> tuple[str, ...]:
    """Return warnings, of a function and its response in real arithmetic about the worse one only."""
    worst: dict[str, Verification] = {}
    for v in verified:
        if v.name not in worst or (v.error or 0.0) > (worst[v.name].error or 0.0):
            worst[v.name] = v
    return tuple(w for v in worst.values() if (w := _shortfall(v)))


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


class LatexExporter:
    """A standalone LaTeX document."""

    suffix = ".tex"
    summary = "standalone LaTeX document: parameters, transfer functions, hidden modes"

    def export(self, model: Model, tfs: Sequence[TransferFunction]) -> Export:
        """Return the document."""
        return Export(latex_document(model, tfs, [print_form(tf) for tf in tfs]))


EXPORTERS: dict[str, Exporter] = {
    "numpy": NumpyExporter(),
    "array-api": ArrayExporter(
        ARRAY_API, "the same for numpy, torch, jax.numpy, cupy: whatever library the arguments are of"
    ),
    "jax": ArrayExporter(JAX, "the same for jax: jit, grad and vmap work through it"),
    "latex": LatexExporter(),
}
