"""From LaTeX to PDF with the pdflatex of the computer, in a folder of its own."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Final

from symflex.errors import Diagnostic, SymflexError

if TYPE_CHECKING:
    from collections.abc import Mapping

COMPILER: Final = "pdflatex"
RUNS: Final = 3
SECONDS: Final = 300
HOW_TO: Final = (
    "pdflatex comes with TeX Live and MiKTeX (Debian: apt install texlive-latex-extra texlive-science; "
    "macOS: brew install --cask mactex); then: pdflatex report.tex, three times"
)
_LAST_LINES: Final = 12
BY_HAND: Final = "report.tex is written: compile it by hand, or ask for --no-pdf"


def has_compiler() -> bool:
    """Tell whether the computer has pdflatex."""
    return shutil.which(COMPILER) is not None


def compile_pdf(tex: str, figures: Mapping[str, bytes], epoch: int | None) -> bytes:
    r"""Return a LaTeX document as PDF.

    Commands that would run programs are refused, and files outside its folder are neither read nor written;
    it includes ``figures`` by their paths beside it. ``epoch`` is the time it is given, in seconds since
    1970; equal documents then give equal bytes. Raises SymflexError: SF912 when it does not compile, with the
    last lines of the log.
    """
    environment = {**os.environ, "openout_any": "p", "openin_any": "p", "TEXMFOUTPUT": ""}
    if epoch is not None:
        environment |= {"SOURCE_DATE_EPOCH": str(epoch), "FORCE_SOURCE_DATE": "1"}
    with tempfile.TemporaryDirectory(prefix="symflex-report-") as name:
        folder = Path(name)
        (folder / "report.tex").write_text(tex, encoding="ascii")
        for path, content in figures.items():
            target = folder / path
            target.parent.mkdir(exist_ok=True)
            target.write_bytes(content)
        command = [COMPILER, "-no-shell-escape", "-interaction=nonstopmode", "-halt-on-error", "report.tex"]
        for _ in range(RUNS):
            try:
                done = subprocess.run(
                    command, cwd=folder, env=environment, capture_output=True, check=False, timeout=SECONDS
                )
            except (OSError, subprocess.TimeoutExpired) as error:
                message = f"pdflatex did not finish: {error}"
                raise SymflexError(Diagnostic("SF912", message, None, BY_HAND)) from None
            if done.returncode:
                log = done.stdout.decode(errors="replace").splitlines()[-_LAST_LINES:]
                message = "pdflatex failed: " + " / ".join(log)
                raise SymflexError(Diagnostic("SF912", message, None, BY_HAND))
        return (folder / "report.pdf").read_bytes()
