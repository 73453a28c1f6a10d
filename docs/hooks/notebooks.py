"""Notebooks as pages: each is run while the site is built, and shown with what its cells return.

Input: ``docs/notebooks/*.ipynb``, without outputs. Output: a page per notebook, whose HTML is put in after
Markdown has been read.
"""

from __future__ import annotations

import ast
import html
import json
import re
import sys
from base64 import b64encode
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from mkdocs.structure.files import File, Files

sys.path.insert(0, str(Path(__file__).parent))  # mkdocs loads each hook alone
from gallery import formula_html, kept

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig

NOTEBOOKS: Final = Path(__file__).parents[1] / "notebooks"
PLACE: Final = re.compile(r"<!-- output (\S+) -->")
OUTPUTS: Final[dict[str, str]] = {}
"""What cells return, by the places in the pages."""


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add a page for every notebook."""
    for path in sorted(NOTEBOOKS.glob("*.ipynb")):
        text = path.read_text("utf-8")
        page, outputs = kept(f"notebook {text}", partial(notebook, path.stem, text))
        OUTPUTS.update(outputs)
        files.append(File.generated(config, f"notebooks/{path.stem}.md", content=page))
    return files


def on_page_content(content: str, **_: object) -> str:
    """Put outputs in their places."""
    return PLACE.sub(lambda match: OUTPUTS[match[1]], content)


def notebook(stem: str, text: str) -> tuple[str, dict[str, str]]:
    """Return a notebook in Markdown, and its outputs by their places."""
    page = page_of(stem, json.loads(text)["cells"])
    return page, {place: shown for place, shown in OUTPUTS.items() if place.startswith(f"{stem}-")}


def page_of(stem: str, cells: list[dict[str, Any]]) -> str:
    """Return a notebook in Markdown, with a place for every output."""
    values: dict[str, object] = {"__name__": "__main__"}
    parts = []
    for i, cell in enumerate(cells):
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            parts.append(source)
            continue
        parts.append(f"```python\n{source}\n```")
        result = run(source, values)
        if result is not None:
            OUTPUTS[f"{stem}-{i}"] = f'<div class="output">{shown(result)}</div>'
            parts.append(f"<!-- output {stem}-{i} -->")
    parts.insert(1, f"[Download the notebook]({stem}.ipynb)")
    return "\n\n".join(parts)


def run(source: str, values: dict[str, object]) -> object:
    """Return the value of the last line of a cell, if that is an expression."""
    tree = ast.parse(source)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, "a cell", "exec"), values)  # noqa: S102 (the notebooks of this repository)
    if not isinstance(last, ast.Expr):
        return None
    return eval(compile(ast.Expression(last.value), "a cell", "eval"), values)  # noqa: S307 (as above)


def shown(result: object) -> str:
    """Return an object as a notebook shows it."""
    if hasattr(result, "_repr_png_") and (picture := result._repr_png_()):
        data, size = picture if isinstance(picture, tuple) else (picture, {"width": 420})
        source = b64encode(data).decode("ascii")
        return f'<img alt="Figure" width="{size["width"]}" src="data:image/png;base64,{source}">'
    if hasattr(result, "kernels") or hasattr(result, "ratio"):
        return formula_html(result)  # type: ignore[arg-type]
    if hasattr(result, "_repr_html_") and (written := result._repr_html_()):
        return str(written)
    return f"<pre><code>{html.escape(repr(result))}</code></pre>"
