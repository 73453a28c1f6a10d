"""The target for state equations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.codegen.state_space.module import state_space_module
from symflex.state_space import minimal, realise

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.codegen.export import Export
    from symflex.model import Model
    from symflex.transfer import AnyTransferFunction


@dataclass(frozen=True, slots=True)
class StateSpaceExporter:
    """State equations as a function of the parameters, in one numpy module."""

    is_minimal: bool = False  # leave out what no input reaches or no output shows

    suffix = ".py"
    summary = "numpy module with A, B, C, D as a function of the parameters, states named"

    def export(
        self, model: Model, tfs: Sequence[AnyTransferFunction], stem: str = "", *, is_alone: bool = True
    ) -> Export:
        """Return the module; accuracy that was not reached is a warning."""
        system = realise(model, [(tf.output.name, tf.input.name) for tf in tfs])
        return state_space_module(minimal(system) if self.is_minimal else system, tfs, model.analysis.band)
