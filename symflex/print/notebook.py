"""What prints as passages: text in a terminal, paragraphs and tables in a notebook."""

from __future__ import annotations

from collections.abc import Iterable

from symflex.print.text import WIDTH, Passage, passages_text


class Printed:
    """A result that prints as passages."""

    def passages(self) -> Iterable[Passage]:
        """Return what is said."""
        raise NotImplementedError

    def text(self, width: int | None = WIDTH) -> str:
        """Return the text for a terminal of this many columns; without a number, no line is broken."""
        return passages_text(self.passages(), width)

    def __str__(self) -> str:
        return self.text()

    def _repr_html_(self) -> str:
        from symflex.print.html import passages_html  # only notebooks ask

        return passages_html(self.passages())
