"""What a section of a report hands over: its blocks, and the files that belong to it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

from symflex.errors import UncertifiedError
from symflex.figures import render
from symflex.report.document import PageFigure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from symflex.errors import SymflexError
    from symflex.report.document import Block
    from symflex.report.study import Study


@dataclass(frozen=True, slots=True)
class ChapterPart:
    """One section of the chapter about a model."""

    title: str  # plain text
    blocks: tuple[Block, ...]  # what it says
    files: Mapping[str, bytes] = field(default_factory=dict)  # content by path inside the report's folder
    warnings: tuple[str, ...] = ()  # what the user should be told on the terminal as well
    code: int = 0  # exit code: not 0 when something is missing that the specification asks for


def code_of(error: SymflexError) -> int:
    """Return the exit code for what a report lacks: 4 not certified, 5 a budget; 0 where it is not to be had.

    Examples
    --------
    >>> from symflex.errors import BudgetError, ModelError
    >>> code_of(BudgetError()), code_of(ModelError())
    (5, 0)
    """
    return error.exit_code if error.exit_code >= UncertifiedError.exit_code else 0


def picture(stem: str, drawn: Figure, caption: str, files: dict[str, bytes]) -> PageFigure:
    """Return a figure as a block: its SVG stands on the page, and beside its PDF in ``files`` for papers."""
    svg = render(drawn, "svg")
    files[f"figures/{stem}.svg"] = svg
    files[f"figures/{stem}.pdf"] = render(drawn, "pdf")
    return PageFigure(stem, svg.decode(), caption)


class SectionMaker(Protocol):
    """A function that writes one section; a key of :data:`symflex.report.sections.SECTIONS` names it."""

    def __call__(self, study: Study) -> ChapterPart | None:
        """Return the section, None where a model gives no cause for it.

        Raises SymflexError when what it needs cannot be computed; the report says so in its place.
        """
        ...
