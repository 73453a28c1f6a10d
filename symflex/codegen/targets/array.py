"""Targets for libraries of arrays: whichever the arguments are of, or jax."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from symflex.codegen.array.module import ARRAY_API, JAX, Dialect, array_module
from symflex.codegen.export import Export, shortfalls

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.model import Model
    from symflex.transfer import AnyTransferFunction


@dataclass(frozen=True, slots=True)
class ArrayExporter:
    """One self-contained module over libraries of arrays that its arguments decide on, or over jax.

    Parameters
    ----------
    dialect : Dialect
        What the module imports, and how it finds its functions.
    summary : str
        What is made, in a line.
    suffix : str
        Of the file's name.
    """

    dialect: Dialect
    summary: str
    suffix: str = ".py"

    def export(
        self, model: Model, tfs: Sequence[AnyTransferFunction], stem: str = "", *, is_alone: bool = True
    ) -> Export:
        """Return the module; accuracy that was not reached is a warning."""
        made = array_module(tfs, model, self.dialect, model.analysis.band)
        return Export(made.text, shortfalls(made.verified))


ARRAY_API_EXPORTER: Final = ArrayExporter(
    ARRAY_API, "the same for numpy, torch, jax.numpy, cupy: whatever library the arguments are of"
)
JAX_EXPORTER: Final = ArrayExporter(JAX, "the same for jax: jit, grad and vmap work through it")
