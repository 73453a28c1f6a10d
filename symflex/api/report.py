"""A report written from Python."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from tempfile import TemporaryDirectory

from symflex.api.model import Model
from symflex.budget import Silent
from symflex.options import ReportOptions


@dataclass(frozen=True, slots=True)
class WrittenReport:
    """The files of a report, and what is missing from it.

    Parameters
    ----------
    page : Path
        The page to open.
    pdf : Path or None
        The PDF; None if none was made.
    warnings : tuple of str
        What was left out or is not certified.
    is_certified : bool
        All poles and zeros are certified, and no budget was exceeded.
    """

    page: Path
    pdf: Path | None
    warnings: tuple[str, ...]
    is_certified: bool


def write_report(
    specs: str | Path | Model | Sequence[str | Path | Model],
    folder: str | Path = "report",
    *,
    pdf: bool | None = None,
    live: bool = False,
    day: date | None = None,
    jobs: int = 1,
) -> WrittenReport:
    """Write a report on models: equations, poles and zeros, figures, comparison, code.

    Parameters
    ----------
    specs : str, Path, Model or a sequence of them
        Specifications, or models; a folder means all in it and its subfolders, with measured responses.
        If there is no such file, the example of that name is taken, such as ``eppinger1988``.
    folder : str or Path
        Folder to write; files of the same name are replaced, others stay.
    pdf : bool, optional
        Whether to make a PDF; by default if pdflatex is installed.
    live : bool
        Whether to write a page with sliders for each model, which runs a script.
    day : date, optional
        Printed; without it identical specifications give identical files.
    jobs : int
        How many models are computed at once, each in a process of its own; 1 for all in this one. More than
        one needs a program that may be imported anew (``if __name__ == "__main__":``).

    Raises
    ------
    SpecError, ModelError
        With every problem of all files that are not solvable models, before anything is computed.
    UsageError
        SF901 neither a file nor an example; SF902 no specification; SF903 a file cannot be written.

    Examples
    --------
    If a parameter has no value, the report has the formulas but no numbers:

    >>> import symflex, tempfile
    >>> from pathlib import Path
    >>> text = '''symflex = 1
    ... parameters.k = { unit = "N/m" }
    ... inputs = { F = { force = "x" } }
    ... outputs = { X = "x" }
    ... elements.k = { type = "spring", between = ["x", "ground"], k = "k" }'''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     spec = Path(folder, "spring.toml")
    ...     _ = spec.write_text(text, encoding="utf-8")
    ...     written = symflex.write_report(spec, Path(folder, "report"), pdf=False)
    ...     written.page.name, written.warnings[1]
    ('index.html', "spring, roots: parameter 'k' has no value")
    """
    from symflex.report.published import written

    with TemporaryDirectory(prefix="symflex-models-") as models:
        every = [specs] if isinstance(specs, str | Path | Model) else specs
        given = ReportOptions(
            specs=[
                _file_of(x, Path(models, str(i))) if isinstance(x, Model) else x for i, x in enumerate(every)
            ],
            output=folder,
            pdf=pdf,
            live=live,
            day=None if day is None else day.isoformat(),
            jobs=jobs if jobs > 1 else 0,
        )
        published, report = written(given, Silent(), lambda _: None)
    problems = (published.problem,) if published.problem else ()
    return WrittenReport(published.page, published.pdf, (*report.warnings, *problems), report.code == 0)


def _file_of(model: Model, folder: Path) -> Path:
    """Return a file with the specification of a model, called as its title."""
    folder.mkdir()
    file = folder / f"{re.sub(r'[^A-Za-z0-9_]+', '_', model.title).strip('_')[:40] or 'model'}.toml"
    model.to_toml(file)
    return file
