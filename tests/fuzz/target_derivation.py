"""Worked models changed at random, through check, derive, roots and export.

The bytes are read as choices: a model, then changes of it (values, nodes, kinds of elements, expressions,
parts left out or repeated), each of which keeps it a specification that could be meant.
"""

import tomllib
from contextlib import suppress
from functools import cache

from symflex import pipeline
from symflex.codegen.exporters import EXPORTERS
from symflex.errors import SymflexError
from symflex.model.spec.write import write
from symflex.print.roots import roots_text
from symflex.roots import Budget
from tests.house.repository import ROOT, specifications
from tests.random_models import Bytes

ROOMS = ("symflex.model", "symflex.equations", "symflex.equations.elimination")
SECONDS = 1
SMALL_ELEMENTS = 8
NUMBERS = (
    "0",
    "1",
    "-1",
    "1e-300",
    "1e300",
    "0.1",
    "2",
    "1e9",
    "0.0123456789012345",
    "4567.89012345678",
    "1e-9",
    "1/3",
)
EXPRESSIONS = (
    "-({})",
    "({})^2",
    "1/({})",
    "({})*s",
    "({})/(s + 1)",
    "({}) + 1",
    "sqrt({})",
    "0*({})",
    "({})*exp(-s)",
)
KINDS = (
    "mass",
    "spring",
    "damper",
    "inertia",
    "rod",
    "beam",
    "shaft",
    "string",
    "force_source",
    "gear",
    "link",
)
NODES = ("ground", "x", "y", "z", "theta")


@cache
def models():
    """Return small worked models, templates and models of the test, parsed."""
    files = [
        p
        for place in ("derivations/classics", "symflex/templates")
        for p in specifications(ROOT / place, "*.toml")
    ]
    files += [
        ROOT / "derivations" / "eppinger1988" / f"{n}.toml"
        for n in ("two_mass", "rigid_body", "base_flexure")
    ]
    read = [tomllib.loads(path.read_text(encoding="utf-8")) for path in files]
    return [model for model in read if len(model.get("elements", ())) <= SMALL_ELEMENTS]


def seeds():
    """Return each model with a change."""
    return [bytes([i, 1, i, 1, 2]) for i in range(len(models()))]


def changed(data):
    """Return the text of a model that was changed as bytes say."""
    choices = Bytes(data)
    model = choices.choice(models())
    model = tomllib.loads(write(model))  # a copy
    model.pop("published", None)
    for _ in range(choices.randrange(4)):
        CHANGE[choices.randrange(len(CHANGE))](model, choices)
    return write(model)


def _section(model, choices):
    return choices.choice([s for s in model.values() if isinstance(s, dict) and s] or [{"_": 0}])


def _element(model, choices):
    return choices.choice([*(model.get("elements") or {"_": {}}).values()])


def _value(model, choices):
    """Give a parameter another number, in its unit."""
    parameters = model.get("parameters") or {"k": "1"}
    name = choices.choice([*parameters])
    old = parameters[name]
    unit = str(old.get("value", "") if isinstance(old, dict) else old).partition(" ")[2]
    parameters[name] = f"{choices.choice(NUMBERS)} {unit}".strip()


def _leave_out(model, choices):
    section = _section(model, choices)
    section.pop(choices.choice([*section]), None)


def _repeat(model, choices):
    section = _section(model, choices)
    name = choices.choice([*section])
    section[f"{name}_2"] = section[name]


def _connect(model, choices):
    """Put an element to other nodes."""
    element = _element(model, choices)
    lists = [v for e in model.get("elements", {}).values() for v in e.values() if isinstance(v, list)]
    nodes = [node for nodes in lists for node in nodes]
    for key, value in element.items() if isinstance(element, dict) else ():
        if isinstance(value, list):
            element[key] = [choices.choice([*nodes, *NODES]) for _ in value]
        elif key == "at":
            element[key] = choices.choice([*nodes, *NODES])


def _kind(model, choices):
    element = _element(model, choices)
    if isinstance(element, dict):
        element["type"] = choices.choice(KINDS)


def _expression(model, choices):
    section = _section(model, choices)
    name = choices.choice([*section])
    entry = section[name]
    if isinstance(entry, dict) and entry:
        key = choices.choice([*entry])
        if isinstance(entry[key], str) and key != "type":
            entry[key] = choices.choice(EXPRESSIONS).format(entry[key])
    elif isinstance(entry, str):
        section[name] = choices.choice(EXPRESSIONS).format(entry)


CHANGE = (_value, _leave_out, _repeat, _connect, _kind, _expression)


def run(data):
    """Check, derive, print, search for roots and export a changed model."""
    with suppress(SymflexError):
        text = changed(data)
        model = pipeline.loads(text, "/nonexistent/a.toml")
        pipeline.check_solvable(pipeline.assemble(model))
        pairs = model.transfer_functions[:1]
        with suppress(SymflexError):
            derived, _ = pipeline.derive_as(model, pairs, "auto")
            exporter = EXPORTERS[("numpy", "c", "latex", "julia", "matlab")[len(data) % 5]]
            with suppress(SymflexError):
                exporter.export(model, derived, "a", is_alone=True)
        (bound,) = pipeline.derive_bound(model, pairs)
        with Budget(SECONDS).entered():
            roots_text(pipeline.roots(bound, None, 15), 15, 80)
