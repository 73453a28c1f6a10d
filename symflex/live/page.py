"""The interactive page: drawing, formula, sliders, plots and modes of models in one HTML file.

Input: models, and which of their transfer functions are shown.
Output: the file's text. It holds one script and one style sheet, and allows nothing else by their hashes::

    default-src 'none'; script-src 'sha256-...'; style-src 'sha256-...'

The script is the JavaScript export of every model, the files ``*.js`` beside this one, and the data that
:func:`_data` makes: parameters, bands, certified roots at the declared values, and the specification cut
where values stand, so that the page can write it anew. What a user wrote reaches the page as escaped text and
as JSON strings that end no script.
"""

from __future__ import annotations

import json
import re
from base64 import b64encode
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from hashlib import sha256
from importlib import resources
from math import tau
from typing import Any, Final

from symflex import pipeline
from symflex.codegen.export import Contents, Member
from symflex.codegen.javascript import JAVASCRIPT, RESERVED, javascript_module
from symflex.codegen.program.evaluate import nearest_double
from symflex.drawing import LARGEST_DRAWING, drawing_of, render_drawing
from symflex.errors import SymflexError
from symflex.expressions import Name, names_in
from symflex.figures.files import inline_svg
from symflex.live.tape import FIXED, MODES, tape_of
from symflex.model import Model, ModelParameter
from symflex.model.spec import TableValue, parse
from symflex.print.forms import print_form, with_hidden
from symflex.print.html import escape_html
from symflex.print.latex import model_labels
from symflex.print.mathml import label_mathml, math_element, transfer_function_mathml
from symflex.roots import Everything, Modes, PoleZeroMap, Progress, Root
from symflex.roots.pole_zero_map import chosen, right_beyond
from symflex.symbolic.routh import Signs

SCRIPTS: Final = ("discs.js", "roots.js", "page.js")  # files of the script, in their order
FACTOR: Final = 10
"""A slider without a ``range`` goes from the declared value over this to the declared value times this."""
LONGEST_FORMULA: Final = 60_000  # characters of MathML that a page shows: some forty lines
SHOWN: Final = 0.6  # how large a drawing is beside the formula, as a share of its size in a report
MAX_WIDTH: Final = re.compile(r' style="max-width:([0-9.]+)in"')
STYLE_ATTRIBUTE: Final = re.compile(r' style="([^"]*)"')


def live_page(models: Sequence[tuple[Model, Sequence[tuple[str, str]]]], progress: Progress) -> str:
    """Return the page of models, each with the pairs (output, input) that are shown."""
    package = resources.files("symflex.live")
    style = package.joinpath("page.css").read_text(encoding="utf-8")
    parts = []
    for i, (model, pairs) in enumerate(models):
        progress.report(i / len(models), model.title or f"model {i + 1}")
        parts.append(_part(i, model, pairs))
    exported = ",\n".join(script for _, script in parts)
    sources = "\n".join(package.joinpath(name).read_text(encoding="utf-8") for name in SCRIPTS)
    script = f'"use strict";\n(() => {{\n{sources}\nlive([\n{exported}\n]);\n}})();\n'
    title = models[0][0].title or "Transfer functions" if len(models) == 1 else f"{len(models)} models"
    policy = f"default-src 'none'; script-src {_hash(script)}; style-src {_hash(style)}; img-src blob:"
    lines = [
        "<!DOCTYPE html>",
        '<html lang="en"><head><meta charset="utf-8">',
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        '<meta name="color-scheme" content="light dark">',
        f"<title>{escape_html(title)}</title>",
        f"<style>{style}</style></head><body>",
        *_chooser(models),
        *(markup for markup, _ in parts),
        f"<script>{script}</script></body></html>",
    ]
    return "\n".join(lines) + "\n"


def _hash(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode('ascii')}'"


def _chooser(models: Sequence[tuple[Model, object]]) -> Iterable[str]:
    if len(models) > 1:
        titles = (escape_html(model.title or f"Model {i + 1}") for i, (model, _) in enumerate(models))
        options = "".join(f"<option>{title}</option>" for title in titles)
        yield f'<nav><label>Model <select id="model">{options}</select></label></nav>'


def _part(number: int, model: Model, pairs: Sequence[tuple[str, str]]) -> tuple[str, str]:
    """Return the markup of a model, and an expression of the script: its data, parameters and functions."""
    derived, _ = pipeline.derive_as(model, pairs)
    every = JAVASCRIPT.contents(model, derived)
    contents = replace(every, members=tuple(m for m in every.members if not m.is_response))
    module = "\n".join(map(_packed, javascript_module(contents).text.splitlines()))
    data = _data(contents, contents.names(RESERVED)[1], pairs)
    script = json.dumps(data, allow_nan=False).replace("<", "\\u003c")
    returned = f"return {{ PARAMETERS, TRANSFER_FUNCTIONS, data: {script} }};"
    return _markup(number, contents, data), f"(() => {{\n{module}\n{returned}\n}})()"


def _packed(line: str) -> str:
    """Return a line of the export without ``export``, indentation and blanks around most operators."""
    bare = line.lstrip().removeprefix("export ")
    return bare if re.search(r"[\"'`]|^[/*]", bare) else re.sub(r" ([*/+=]) |(,) ", r"\1\2", bare)


# ---------------------------------------------------------------------------------------------------- data


def _located(model: Model, pair: tuple[str, str]) -> PoleZeroMap | str:
    """Return the roots of a function without tapes at the declared values, or why there are none."""
    region = None if model.analysis.modes or not model.is_distributed else Modes(MODES)
    try:
        (bound,) = pipeline.derive_for_roots(model, [pair])
        return pipeline.roots(bound, region)
    except SymflexError as error:
        return error.diagnostics[0].message


def _data(contents: Contents, names: Mapping[str, str], pairs: Sequence[tuple[str, str]]) -> dict[str, Any]:
    model = contents.model
    moving = {p.name for m in contents.members for p in m.parameters}
    used = [p for p in model.settable if p.value is not None or p.name in moving]
    drive = _in_loops(model)
    functions = []
    for member, pair in zip(contents.members, pairs, strict=True):
        tape, located = ({"refused": FIXED}, None) if member.is_fixed else tape_of(member.tf, names)
        gains = [i for i, p in enumerate(used) if p.name in moving & drive and p.value]
        functions.append(
            {**_function(member, located or _located(model, pair)), "tape": tape, "gains": gains}
        )
    # frequencies [Hz] around the roots, or the default of a frequency response
    sizes = [abs(complex(x, y)) / tau for f in functions for x, y, _ in f["poles"] + f["zeros"] if x or y]
    around = [min(sizes) / 30, max(sizes) * 3] if sizes else [0.1, 100.0]
    return {
        "title": model.title,
        "parameters": [_parameter(p, names[p.name], p.name in moving and not p.is_solved_with) for p in used],
        "functions": functions,
        "band": [float(f) for f in model.analysis.band or ()] or around,
        "specification": _pieces(model, [p.name for p in used]),
    }


def _in_loops(model: Model) -> set[str]:
    """Return the names that drive: in signals, in blocks, and in what sources deliver."""
    driven = [x.expression for x in model.signals]
    driven += [e for b in model.blocks for _, e in b.values]
    for use in model.elements:
        of_sources = {p.name for p in use.element.parameters if p.signal}
        driven += [e for name, e in use.values if name in of_sources]
    return {n.name for e in driven for n in names_in(e) if isinstance(n, Name)}


def _parameter(p: ModelParameter, identifier: str, is_moving: bool) -> dict[str, Any]:
    """Return what the page knows of a parameter: values in SI units, ends of its slider in those written."""
    written, unit = p.as_written()
    value, shown = (None if x is None else nearest_double(x.rational, x.pi_power) for x in (p.value, written))
    ends = [p.as_written(end)[0] for end in p.limits or ()]
    low, high = [nearest_double(x.rational, x.pi_power) for x in ends if x] or _ends(shown, p)
    scale = nearest_double(p.scale.rational, p.scale.pi_power) if p.written_unit else 1.0
    return {
        "name": p.name, "id": identifier, "unit": "" if unit == "1" else unit, "scale": scale, "value": value,
        "low": low, "high": high, "assume": p.assume, "moves": is_moving,
    }  # fmt: skip


def _ends(value: float | None, p: ModelParameter) -> tuple[float, float]:
    """Return where a slider goes, in the unit that was written."""
    if value:
        ends = (value / FACTOR, value * FACTOR)
        return (min(ends), max(ends))
    return (-1.0 if p.assume == "real" else 0.0, 1.0) if value is not None else (0.1, 10.0)


def _function(member: Member, located: PoleZeroMap | str) -> dict[str, Any]:
    tf, accuracy = member.tf, member.verification.text()
    data = {"name": tf.name, "unit": tf.unit or "", "fixed": member.is_fixed, "accuracy": accuracy}
    if tf.is_reduced:
        sign, rows = Signs.of(tf).of_polynomial, [tf.ring.coefficients(h.polynomial) for h in tf.hidden]
        # Up to the second degree, coefficients of one sign keep hidden poles out of the right half-plane.
        may_grow = (r[3:] or {sign(c) for c in r if not c.is_zero()} not in ({1}, {-1}) for r in rows)
        data["hides"] = tf.with_waves is not None or any(may_grow)
    if isinstance(located, str):
        return {**data, "why": located, "poles": [], "zeros": [], "infinite": not tf.is_rational}
    data |= {"why": "", "infinite": located.is_infinite, "certified": located.certificate.certified}
    verdict = {"sentence": located.verdict.sentence, "word": located.verdict.word}
    shown = Modes(tf.model.analysis.modes or MODES) if tf.model.is_distributed else Everything()
    lowest = chosen(located.poles, shown)
    poles = (*lowest, *right_beyond(located.all_poles, lowest))
    roots = {"poles": _upper(poles), "zeros": _upper(chosen(located.zeros, shown))}
    return {**data, **roots, "verdict": verdict if located.verdict.certified else None}


def _upper(roots: Iterable[Root]) -> list[list[float]]:
    """Return real and imaginary parts and multiplicities of roots of the closed upper half-plane."""
    points = ((complex(root), root) for root in roots)
    return [
        [0.0 if r.on_imaginary_axis else z.real, 0.0 if r.is_real else z.imag, r.multiplicity]
        for z, r in points
        if r.is_real or z.imag > 0
    ]


def _pieces(model: Model, shown: Sequence[str]) -> list[str | list[Any]]:
    """Return the text, cut where values stand: a place is a parameter's number, its unit, and its text."""
    source = next((o.span.source for o in model.outputs if o.span), None)
    if source is None:
        return []
    section = parse(source).root.get("parameters")
    table = section.value if section and isinstance(section.value, TableValue) else None
    units = {p.name: p.written_unit for p in model.parameters}
    places: list[tuple[int, int, list[Any]]] = []
    for entry in table.entries if table else ():
        if entry.key not in shown:
            continue
        inner, declared = entry, entry.value if isinstance(entry.value, TableValue) else None
        slot = [shown.index(entry.key), "" if declared and declared.get("unit") else units[entry.key]]
        if declared and (value := declared.get("value")):
            inner = value
        elif declared:
            first = next((e.key_span.start for e in declared.entries), 0)
            if first and source.text[first - 1] != ".":
                separator = "\n" if declared.span.text.startswith("[") else ", "
                places.append((first, first, [*slot, "", separator]))
            continue
        span = inner.value.span
        places.append((span.start, span.end, [*slot, span.text]))
    pieces: list[str | list[Any]] = []
    last = 0
    for start, end, slot in sorted(places):
        pieces += [source.text[last:start], slot]
        last = end
    return [*pieces, source.text[last:]]


# -------------------------------------------------------------------------------------------------- markup


def _markup(number: int, contents: Contents, data: dict[str, Any]) -> str:
    model = contents.model
    frame = resources.files("symflex.live").joinpath("page.html").read_text(encoding="utf-8")
    labels = model_labels(model)
    rows = [_slider(number, i, p, labels, model) for i, p in enumerate(data["parameters"])]
    names = [escape_html(m.tf.name) for m in contents.members]
    filled = {
        "title": escape_html(model.title or "Transfer functions"),
        "source": escape_html(model.source),
        "drawing": _drawing(model, number),
        "parameters": "\n".join(rows) or "<p>The model has no parameters.</p>",
        "options": "".join(f"<option>{name}</option>" for name in names),
        "checks": "".join(f'<label><input type="checkbox">{name}</label>' for name in names),
        "formulas": "\n".join(_formula(m) for m in contents.members),
        "n": str(number),
    }
    return re.sub(r"\{\{(\w+)\}\}", lambda m: filled[m[1]], frame)


def _slider(number: int, i: int, p: dict[str, Any], labels: Mapping[str, str], model: Model) -> str:
    doc = next(q.doc for q in model.parameters if q.name == p["name"])
    label, name = math_element(label_mathml(p["name"], labels)), f"p{number}-{i}"
    return (
        f'<div class="parameter"><label id="{name}">{label} <span>{escape_html(doc)}</span></label>'
        f'<input type="range" min="0" max="400" step="1" aria-labelledby="{name}">'
        f'<input type="number" step="any" aria-labelledby="{name}">'
        f"<span>{escape_html(p['unit'])}</span>"
        '<details><summary>range</summary><input type="number" step="any" class="low" aria-label="lower end">'
        '<input type="number" step="any" class="high" aria-label="upper end">'
        '<label><input type="checkbox" class="linear"> linear</label></details></div>'
    )


def _drawing(model: Model, number: int) -> str:
    if len(model.elements) > LARGEST_DRAWING:
        return ""
    try:
        svg = render_drawing(drawing_of(model), "svg").decode()
    except SymflexError:
        return ""
    drawn = inline_svg(svg, f"d{number}", f"{model.title or 'The model'}, drawn")
    drawn = MAX_WIDTH.sub(lambda m: f' width="{SHOWN * float(m[1]):.2f}in"', drawn, count=1)
    return STYLE_ATTRIBUTE.sub(_as_attributes, drawn)


def _as_attributes(found: re.Match[str]) -> str:
    """Return properties as attributes of SVG; the policy of the page allows no style attributes."""
    properties = (entry.partition(":")[::2] for entry in found[1].split(";") if entry.strip())
    return "".join(f' {key.strip()}="{value.strip()}"' for key, value in properties)


def _formula(member: Member) -> str:
    """Return a transfer function in its shortest form, or a sentence where it would be long."""
    tf, rows = member.tf, None
    if not member.is_fixed:
        form, _ = with_hidden(tf, print_form(tf, is_read=True))
        rows = transfer_function_mathml(tf, form)
    size = sum(len(r.left) + sum(map(len, r.pieces)) for r in rows or ())
    if not rows or size > LONGEST_FORMULA:
        return f"<p>The formula of {escape_html(tf.name)} is long: symflex derive prints it.</p>"
    lines = ['<div class="formula" tabindex="0" role="group">']
    for row in rows:
        lines.append(f'<div class="row{" where" if row.is_where else ""}">{row.elements}</div>')
    return "\n".join((*lines, "</div>"))
