"""From a figure to a file."""

from __future__ import annotations

import logging
from contextlib import contextmanager
from io import BytesIO
from typing import TYPE_CHECKING, Final

from symflex.errors import Diagnostic, UsageError
from symflex.errors.diagnostic import nearest
from symflex.figures.pgf import pgf_figure
from symflex.figures.style import DEFAULT_FONT, paper_style
from symflex.files.write import write_atomically

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from matplotlib.figure import Figure

# What would differ from run to run, or from one version of matplotlib to the next, is left out.
FORMATS: Final[dict[str, dict[str, str | None]]] = {
    "pdf": {"Creator": "symflex", "Producer": None, "CreationDate": None},
    "pgf": {},
    "png": {"Software": None},
    "svg": {"Creator": "symflex", "Date": None},
}


def render(figure: Figure, format: str, *, font: str = DEFAULT_FONT) -> bytes:
    """Return a figure as the content of a file; equal figures give equal bytes.

    ``format`` is ``pdf``, ``pgf``, ``png`` or ``svg``; ``font`` is that in which the figure was drawn. Raises
    UsageError: SF208 for any other format or font.
    """
    if format not in FORMATS:
        hint = nearest(format, FORMATS) or "formats: " + ", ".join(FORMATS)
        raise UsageError(Diagnostic("SF208", f"figures are not written as '{format[:64]}'", None, hint))
    buffer = BytesIO()
    with paper_style(font):
        if format == "pgf":
            return pgf_figure(figure).encode("ascii")
        with _quietly():
            figure.savefig(buffer, format=format, metadata=FORMATS[format])
    return buffer.getvalue()


@contextmanager
def _quietly() -> Iterator[None]:
    """Keep back what fontTools remarks on fonts that come with matplotlib."""
    logger = logging.getLogger("fontTools")
    level = logger.level
    logger.setLevel(logging.ERROR)
    try:
        yield
    finally:
        logger.setLevel(level)


def save(figure: Figure, path: Path, format: str | None = None, *, font: str = DEFAULT_FONT) -> None:
    """Write a figure to a file, as a whole or not at all.

    The format is by default what the file's name ends in. Raises UsageError: SF208 an unknown format; SF903
    the file cannot be written.
    """
    chosen = path.suffix.removeprefix(".").lower() if format is None else format
    write_atomically(path, render(figure, chosen, font=font))
