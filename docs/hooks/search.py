"""What the search of the site shows first: what a reader does, then what is looked up, then what is inside.

Input: a page of the site. Output: its weight in the search, from the section of the menu that it stands in.
Without weights, the page of the loops of Python comes before the guide of stable gains, which speaks longer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from mkdocs.structure.pages import Page

WEIGHTS: Final = {
    "Start": 3, "Guides": 3, "Language": 2, "Commands": 4, "Export": 2, "Python": 0.5, "Theory": 0.3,
}  # fmt: skip
OTHERS: Final = {
    "questions.md": 1, "cheat-sheet.md": 1, "i-have-i-want.md": 1, "error-codes.md": 0.5, "limits.md": 1,
}  # fmt: skip
"""Pages that touch everything, and would come first for every word."""
REFERENCE: Final = 2  # a page of one command
INSIDE: Final = 0.2  # development, and pages that the menu does not have


def on_page_markdown(markdown: str, page: Page, **_: object) -> str:
    """Give a page its weight."""
    section = next((e.title or "" for e in reversed([*page.ancestors])), "")
    path = page.file.src_uri
    weight = REFERENCE if path.startswith("commands/") else WEIGHTS.get(section, INSIDE)
    page.meta["search"] = {"boost": OTHERS.get(path, 3 if path == "index.md" else weight)}
    return markdown
