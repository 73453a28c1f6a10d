"""What the page asks of symflex: every answer is data for JSON.

Input: a question by its name, and what it is asked of, as JSON. Output: JSON. Commands run as in a terminal,
so that the page shows what they print. A second question about a text parses nothing.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import sys
from math import tau
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final
from xml.etree import ElementTree

import letters

from symflex import pipeline
from symflex.cli import run
from symflex.cli.reporting import diagnostic_json
from symflex.editor import OpenDocument, completions, examined
from symflex.errors import Source, SymflexError
from symflex.print.forms import print_form, with_hidden
from symflex.print.mathml import transfer_function_mathml

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from symflex.model import Model

FILE: Final = "model.toml"
"""What commands read, and what their messages name."""
FOLDER: Final = Path("/model")
SECONDS: Final = "120"
"""After which a command gives up; the stop button waits for nothing."""
_open: dict[str, OpenDocument] = {}
"""The text that was asked about last."""


def answer(question: str, given: str) -> str:
    """Return the answer to a question."""
    return json.dumps(QUESTIONS[question](**json.loads(given)))


def opened(text: str) -> OpenDocument:
    """Return the document of a text, examined once."""
    if text not in _open:
        FOLDER.mkdir(exist_ok=True)
        os.chdir(FOLDER)
        Path(FILE).write_text(text, encoding="utf-8", newline="")
        _open.clear()
        _open[text] = examined(text, FILE)
    return _open[text]


def examine(text: str) -> dict[str, Any]:
    """Return problems with their places, and what a model can be asked."""
    document = opened(text)
    problems = [{**diagnostic_json(d), "severity": d.severity} for d in document.problems]
    model = document.model
    if model is None:
        return {"problems": problems, "functions": None}
    gains = [figure.gain for figure in model.figures if figure.gain]
    return {
        "problems": problems,
        "functions": ["/".join(pair) for pair in model.transfer_functions],
        "parameters": [p.name for p in model.settable if p.value is not None],
        "gain": gains[0] if gains else None,
        "band": [float(f) for f in model.analysis.band or ()],
    }


def complete(text: str, offset: int) -> list[dict[str, str]]:
    """Return what may stand at a place and begins as what is there."""
    document = _open.get(text) or OpenDocument(Source(FILE, text), None, ())
    return [{"text": c.text, "kind": c.kind, "says": c.says} for c in completions(document, offset)]


def command(text: str, arguments: Sequence[str]) -> dict[str, Any]:
    """Return exit code, output and messages of a command on the model."""
    opened(text)
    name, *options = arguments
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = run([name, FILE, *options, "--budget", SECONDS])
    return {"code": code, "out": out.getvalue(), "err": err.getvalue()}


def formula(text: str, pair: Sequence[str]) -> dict[str, Any]:
    """Return a transfer function as rows of mathematics, None if it is long."""

    def typeset(model: Model) -> object:
        (tf,), _ = pipeline.derive_as(model, [(pair[0], pair[1])])
        form, _ = with_hidden(tf, print_form(tf))
        rows = transfer_function_mathml(tf, form)
        return rows and [{"where": r.is_where, "math": tree(f"<p>{r.elements}</p>")} for r in rows]

    return _asked(text, typeset)


def tree(markup: str) -> list[Any]:
    """Return markup as nested lists: name, attributes, and children or texts."""

    def listed(node: ElementTree.Element) -> list[Any]:
        children: list[Any] = [node.text or ""]
        for child in node:
            children += [listed(child), child.tail or ""]
        return [node.tag, node.attrib, [c for c in children if c]]

    return listed(ElementTree.fromstring(markup))


def drawing(text: str) -> dict[str, Any]:
    """Return lines and runs of letters of a model's drawing, None if it is large."""

    def drawn(model: Model) -> object:
        if "matplotlib" not in sys.modules:
            letters.stand_in()
        from symflex.drawing import LARGEST_DRAWING, drawing_of  # imports what stands in for matplotlib

        if len(model.elements) > LARGEST_DRAWING:
            return None
        made = drawing_of(model)
        parts = []
        for item in made.items:
            strokes = [[s.points, s.width, s.fill, s.is_dashed] for s in item.strokes]
            texts = [
                [
                    [
                        r.text,
                        t.x + t.size * r.x,
                        t.y + t.size * r.y,
                        t.size * r.width,
                        t.size * r.size,
                        r.face,
                    ]
                    for r in letters.set_line(t.markup).runs
                ]
                for t in item.texts
            ]
            parts.append({"kind": item.kind, "name": item.name, "strokes": strokes, "texts": texts})
        return {"width": made.width, "height": made.height, "parts": parts}

    return _asked(text, drawn)


def response(text: str, pair: Sequence[str], frequencies: Sequence[float]) -> dict[str, Any]:
    """Return real and imaginary parts at frequencies in Hz, rounded from what balls enclose."""

    def values(model: Model) -> object:
        (bound,) = pipeline.derive_for_roots(model, [(pair[0], pair[1])])
        return [[z.real, z.imag] for z in bound.each([complex(0.0, tau * f) for f in frequencies])]

    return _asked(text, values)


def _asked(text: str, question: Callable[[Model], object]) -> dict[str, Any]:
    """Return what is found, or the message that says why not."""
    model = opened(text).model
    if model is None:
        return {"found": None, "err": "the model has problems"}
    try:
        return {"found": question(model), "err": ""}
    except ImportError as error:
        return {"found": None, "err": f"this needs the library {error.name}, which does not run in this page"}
    except SymflexError as error:
        return {"found": None, "err": error.diagnostics[0].message}


QUESTIONS: Final = {f.__name__: f for f in (examine, complete, command, formula, drawing, response)}
