"""What the house tests read: the files of the repository and the fenced blocks of its pages."""

from __future__ import annotations

import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

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
