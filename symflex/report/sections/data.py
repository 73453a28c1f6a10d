"""Measured responses with the model over them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.figures import draw_measured
from symflex.report.document import Code, text
from symflex.report.part import ChapterPart, picture

if TYPE_CHECKING:
    from symflex.report.data_comparison import DataComparison
    from symflex.report.document import Block
    from symflex.report.study import Study


def data_section(study: Study) -> ChapterPart | None:
    """Return every measured response that a transfer function of the model is named like."""
    blocks: list[Block] = []
    files: dict[str, bytes] = {}
    shown = {"/".join(pair) for figure in study.model.figures if figure.has_data for pair in figure.of}
    for i, found in enumerate(study.comparisons):
        measured = found.measured
        if measured.name not in shown:
            drawn = draw_measured(measured, found.model, found.unit)
            kind = "SYNTHETIC data, computed and not measured," if measured.is_synthetic else "measured data"
            caption = f"{measured.name}: the model over {kind} of {measured.values.size} lines."
            blocks.append(picture(f"{study.stem}_data_{i + 1}", drawn, caption, files))
        band = f"{measured.frequency_hz[0]:.4g} to {measured.frequency_hz[-1]:.4g} Hz"
        misfit = f"{found.decibels:.3g} dB and {found.degrees:.3g} degrees rms"
        blocks.append(
            text(
                "From ",
                band,
                ", ",
                Code(measured.name),
                f" is off {_kind(found)} by {misfit}, all lines alike.",
            )
        )
    return ChapterPart("Data", tuple(blocks), files) if blocks else None


def _kind(found: DataComparison) -> str:
    return "the synthetic data" if found.measured.is_synthetic else "the measured data"
