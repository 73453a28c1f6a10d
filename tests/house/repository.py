"""What the house tests read: the files of the repository and the fenced blocks of its pages."""

from __future__ import annotations

import re
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

ROOT = Path(__file__).parents[2]

_FENCE = re.compile(
    r"^(?P<indent> *)```(?P<language>\w+)(?P<options>[^\n]*)\n(?P<text>.*?)^(?P=indent)```$",
    re.MULTILINE | re.DOTALL,
)
_TITLE = re.compile(r'title="([^"]+)"')


@dataclass(frozen=True)
class Block:
    """A fenced block: its page, line, language, title (a file's name) and text."""

    page: Path
    line: int
    language: str
    title: str | None
    text: str

    def __str__(self) -> str:
        return f"{self.page.relative_to(ROOT)}:{self.line}"


def specifications(folder: Path, pattern: str) -> list[Path]:
    """Return the specifications of a folder that a pattern matches; files of claims are none."""
    return sorted(path for path in folder.glob(pattern) if path.name != "claims.toml")


def uniform(paths: Iterable[Path]) -> list[Path]:
    """Return the specifications without those of members that taper.

    These have not code in every language (SF910), and their sensitivities take long.
    """
    return [path for path in paths if path.parent.name != "tapers"]


def tracked_files() -> list[Path]:
    """Return every file that is, or would be, under version control."""
    command = [
        "git",
        "-c",
        f"safe.directory={ROOT}",
        "ls-files",
        "--cached",
        "--others",
        "--exclude-standard",
        "-z",
    ]
    try:
        listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):  # a source archive has no history
        return sorted(p for p in ROOT.rglob("*") if p.is_file() and not _is_generated(p))
    return [ROOT / name for name in listed.split("\0") if name and (ROOT / name).is_file()]


def _is_generated(path: Path) -> bool:
    parts = path.relative_to(ROOT).parts
    return any(
        part in {"__pycache__", ".hypothesis", "build", "dist", "site"} or part.endswith("_cache")
        for part in parts
    )


def pages() -> list[Path]:
    """Return the pages a reader sees."""
    return [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]


def blocks(page: Path) -> list[Block]:
    """Return the fenced blocks of a page, in order."""
    content = page.read_text(encoding="utf-8")
    found = []
    for match in _FENCE.finditer(content):
        indent = match["indent"]
        text = "".join(line.removeprefix(indent) for line in match["text"].splitlines(keepends=True))
        title = _TITLE.search(match["options"])
        line = content.count("\n", 0, match.start()) + 1
        found.append(Block(page, line, match["language"], title[1] if title else None, text))
    return found


def all_blocks(language: str) -> list[Block]:
    """Return the blocks of one language on all pages."""
    return [block for page in pages() for block in blocks(page) if block.language == language]


EACH_TIME = ("sliding_free_beam", "timoshenko_cantilever", "rod_tip_mass", "two_mass_force")
"""Of the classics and loops, the models that go through every test in every run; others do with -m slow."""


def slow_ones(values: Iterable[Any], is_slow: Callable[[Any], bool]) -> list[Any]:
    """Return the values as parameters, some of them of slow tests."""
    return [pytest.param(v, marks=pytest.mark.slow) if is_slow(v) else v for v in values]


def one_in(n: int, values: Iterable[Any]) -> list[Any]:
    """Return the values as parameters, of slow tests all but each n-th, where many go one way."""
    kept = [*values]
    quick = kept[::n]
    return slow_ones(kept, lambda value: value not in quick)


def in_turns(paths: Iterable[Path], dear: Iterable[str] = ()) -> list[Any]:
    """Return the paths as parameters; the dear, and most classics and loops, which go one way, are slow."""
    found: list[Any] = []
    for path in paths:
        is_turn = (path.parent.name == "eppinger1988" or path.stem in EACH_TIME) and path.stem not in dear
        found.append(pytest.param(path, marks=[] if is_turn else [pytest.mark.slow], id=path.stem))
    return found
