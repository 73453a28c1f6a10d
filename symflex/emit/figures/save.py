"""From a figure to a file."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING, Final

from symflex.emit.figures.style import paper_style
from symflex.emit.write import write_atomically
from symflex.errors import Diagnostic, UsageError
from symflex.errors.diagnostic import nearest

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure

# What would differ from run to run, or from one version of matplotlib to the next, is left out.
FORMATS: Final[dict[str, dict[str, str | None]]] = {
    "pdf": {"Creator": "symflex", "Producer": None, "CreationDate": None},
    "png": {"Software": None},
    "svg": {"Creator": "symflex", "Date": None},
}


def render(figure: Figure, format: str) -> bytes:
    """Return a figure as the content of a file; equal figures give equal bytes.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        As :func:`symflex.emit.figures.draw` returns it.
    format : str
        ``pdf``, ``png`` or ``svg``.

    Raises
    ------
    UsageError
        SF208 for any other format.
    """
    if format not in FORMATS:
        hint = nearest(format, FORMATS) or "formats: " + ", ".join(FORMATS)
        raise UsageError(Diagnostic("SF208", f"figures are not written as '{format[:64]}'", None, hint))
    buffer = BytesIO()
    with paper_style():
        figure.savefig(buffer, format=format, metadata=FORMATS[format])
    return buffer.getvalue()


def save(figure: Figure, path: Path, format: str | None = None) -> None:
    """Write a figure to a file, as a whole or not at all.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        As :func:`symflex.emit.figures.draw` returns it.
    path : Path
        Replaced when it exists.
    format : str, optional
        ``pdf``, ``png`` or ``svg``; by default what the file's name ends in.

    Raises
    ------
    UsageError
        SF208 an unknown format; SF903 the file cannot be written.
    """
    write_atomically(
        path, render(figure, path.suffix.removeprefix(".").lower() if format is None else format)
    )
