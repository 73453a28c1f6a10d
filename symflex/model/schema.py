"""The language as JSON Schema (draft 7), for editors that complete and check TOML.

Input: the registries of elements, blocks, inputs and sections.
Output: a dictionary that ``json.dumps`` writes. An editor that knows it offers keys, explains them and
underlines what no specification may say; what needs names, units or equations is left to ``symflex check``.

    schema = json_schema()
    schema["properties"]["elements"]["additionalProperties"]["oneOf"][0]["title"]    "mass"

There is one branch for every type, each with its own properties and no others: conditions (``if``, ``then``)
would leave an editor without the keys of a type.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from symflex.library import ParameterPort
from symflex.library.blocks import BLOCKS, MODEL_BLOCK, Block
from symflex.library.elements import COMPONENT_DOMAIN, ELEMENTS, Element, Port
from symflex.model.analysis import (
    ANALYSIS_KEYS,
    DIGITS_LIMIT,
    FIGURE_KEYS,
    FIGURE_KINDS,
    FORM_NAMES,
    MODES_LIMIT,
)
from symflex.model.declarations import ASSUMPTIONS
from symflex.model.headings import FORMAT_VERSION, NEEDED
from symflex.model.model import INPUT_KINDS, ROOT_QUANTITIES, TRANSFORMER_SYMBOLS
from symflex.model.ports import DELIVERED, FOLLOWED
from symflex.model.reading import NAME
from symflex.model.sampled import HOLD, RULES
from symflex.model.scope import RESERVED
from symflex.papers.labels import LABEL_LIMIT

Schema = dict[str, Any]

SCHEMA = "http://json-schema.org/draft-07/schema#"
TEXT: Schema = {"type": "string"}
WORD = NAME.pattern.removesuffix("\\Z")
NAMES: Schema = {"pattern": f"^{WORD}$"}
FREE_NAMES: Schema = {**NAMES, "not": {"enum": list(RESERVED)}}  # names that have no meaning of their own
NODE: Schema = {"type": "string", "pattern": rf"^{WORD}(\.({'|'.join(COMPONENT_DOMAIN)}))?$"}
VALUE: Schema = {"type": ["string", "number"], "pattern": "\\S"}
"""A number, a quantity such as "20 kN/m", or an expression."""
RANGE: Schema = {"type": "array", "items": VALUE, "minItems": 2, "maxItems": 2}


def json_schema() -> Schema:
    """Return the schema of a specification."""
    sections = {
        "symflex": {"const": FORMAT_VERSION, "description": "version of the format"},
        "title": _said(TEXT, "what the model is"),
        "source": _said(TEXT, "publication that the model is from"),
        "doc": _said(TEXT, "remarks"),
        "parameters": _table(_parameter(), "values, units and descriptions of symbols", FREE_NAMES),
        "definitions": _table(_expression(), "names of expressions, kept in formulas", FREE_NAMES),
        "elements": _table({"oneOf": [_element(e) for e in ELEMENTS.values()]}, "masses, springs, beams ..."),
        "inputs": _table({"oneOf": _inputs()}, "what acts on the model", FREE_NAMES),
        "outputs": _table(_expression(), "what is observed"),
        "signals": _table(_expression(), "names of expressions of nodes, inputs and signals"),
        "equations": _equations(),
        "operating_point": {
            "type": "object",
            "description": "values at equilibrium of what equations and energies contain",
            "properties": {"solve": _said({"type": "array", "items": TEXT}, "parameters that follow")},
            "additionalProperties": VALUE,
        },
        "energy": _energy(),
        "blocks": _table(_block(), "transfer functions that are factors in expressions", FREE_NAMES),
        "sampled": _sampled(),
        "fields": _table(_field(), "boundary-value problems"),
        "ports": _table(_contact_port(), "where the machine is touched"),
        "published": {
            "type": "object",
            "description": "printed formulas",
            "additionalProperties": _printed(),
        },
        "notation": {
            "type": "object",
            "description": "names of the symbols that a paper uses",
            "additionalProperties": TEXT,
        },
        "tables": {
            "type": "object",
            "description": "printed poles and zeros",
            "additionalProperties": _printed_table(),
        },
        "analysis": _analysis(),
        "figures": _table(_figure(), "figures of reports"),
        "drawing": _drawing(),
    }
    needed = ["symflex", *NEEDED]
    return {"$schema": SCHEMA, "title": "symflex specification", **_closed(sections, needed)}


def _said(schema: Schema, description: str) -> Schema:
    return {**schema, "description": description.removeprefix("a ").removeprefix("an ")}


def _closed(properties: Mapping[str, Schema], required: Iterable[str] = ()) -> Schema:
    """Return the schema of a table that has these keys and no others."""
    closed: Schema = {"type": "object", "properties": dict(properties), "additionalProperties": False}
    return {**closed, "required": list(required)} if required else closed


def _table(entry: Schema, description: str, names: Schema = NAMES) -> Schema:
    """Return the schema of a section whose keys are names."""
    return {
        "type": "object",
        "description": description,
        "propertyNames": names,
        "additionalProperties": entry,
    }


def _labelled(properties: Mapping[str, Schema]) -> Schema:
    label = {"type": "string", "minLength": 1, "maxLength": LABEL_LIMIT}
    labels = {"latex": _said(label, "how it is set in LaTeX"), "doc": _said(TEXT, "what it is")}
    return {**properties, **labels}


def _parameter() -> Schema:
    value = _said(VALUE, 'number with unit, such as "20 kN/m", or a formula of other parameters')
    keys = {
        "value": value,
        "unit": _said(TEXT, "SI or other unit of the value"),
        "range": _said(RANGE, "ends of its slider in symflex live"),
        "spread": _said(VALUE, 'how far it may be off to either side: "10 %", or in its unit "0.5 mm"'),
        "assume": {"enum": list(ASSUMPTIONS), "description": "what its sign is; positive by default"},
    }
    return {"anyOf": [value, _closed(_labelled(keys))]}


def _sampled() -> Schema:
    keys = {
        "period": _said(VALUE, "time from sample to sample"),
        "hold": {"enum": [HOLD], "description": "what the output does between samples"},
        "delay": _said(VALUE, "time from a sample to the output that follows from it; 0 by default"),
        "blocks": _said({"type": "array", "items": TEXT}, "which blocks are sampled; those written in z"),
        "by": {"enum": list(RULES), "description": "how s becomes z in blocks that are written in s"},
        "doc": _said(TEXT, "remarks"),
    }
    return {**_closed(keys, ["period"]), "description": "controllers that a computer works out"}


def _expression() -> Schema:
    value = _said(VALUE, "expression of parameters, nodes, inputs and s")
    return {"anyOf": [value, _closed(_labelled({"expr": value}), ["expr"])]}


def _element(element: Element) -> Schema:
    properties: dict[str, Schema] = {"type": {"const": element.type_name, "description": element.summary}}
    for port in element.ports:
        properties[port.name] = _port(port)
        if port.pair:
            properties[port.pair] = {**_several(2, 2), "description": f"{port.doc}, and that of its reaction"}
    properties |= {p.name: _value_of(p) for p in element.parameters}
    properties |= {
        choice.name: _said({"type": "boolean"}, choice.doc)
        if choice.is_flag
        else _said({"enum": list(choice.values)}, f"{choice.doc}; {choice.default} by default")
        for choice in element.choices
    }
    taken_by = {factor for p in element.parameters for factor in p.of}
    required = ["type", *(p.name for p in element.ports if p.default is None and not p.pair)]
    required += [
        p.name
        for p in element.parameters
        if p.default is None and not p.only and not p.of and p.name not in taken_by
    ]
    return {"title": element.type_name, **_closed(_labelled(properties), required)}


def _port(port: Port) -> Schema:
    if port.terminals > 1:
        return {**_several(port.terminals, port.terminals), "description": port.doc}
    one = _said(NODE, port.doc)
    return {"anyOf": [one, _several(1, 2)], "description": port.doc} if port.reacts or port.pair else one


def _several(least: int, most: int) -> Schema:
    return {"type": "array", "items": NODE, "minItems": least, "maxItems": most}


def _value_of(parameter: ParameterPort) -> Schema:
    unit = f" [{parameter.unit}]" if parameter.unit else ""
    default = f"; {parameter.default} by default" if parameter.default is not None else ""
    product = f", in place of {', '.join(parameter.of)}" if parameter.of else ""
    return _said(VALUE, f"{parameter.doc}{unit}{product}{default}")


def _inputs() -> list[Schema]:
    """Return a branch for every kind of input, and one for a free signal."""
    places = {"anyOf": [NODE, _several(1, 2)]}
    plain = _labelled({"unit": _said(TEXT, "SI unit")})
    branches: list[Schema] = [{"title": "signal", **_closed(plain)}]
    for kind, law in INPUT_KINDS.items():
        what = "imposed on" if law.is_imposed else "acting on"
        node = _said(places, f"{kind.replace('_', ' ')} [{law.unit}] {what} this node, or on it and a second")
        branches.append({"title": kind, **_closed({kind: node, **plain}, [kind])})
    return branches


def _block() -> Schema:
    formula = _said(TEXT, "transfer function in s")
    of_model = {
        "type": {"const": MODEL_BLOCK, "description": "a transfer function of another specification"},
        "spec": _said(TEXT, "path of the specification"),
        "tf": _said(TEXT, "OUT/IN"),
        "doc": TEXT,
    }
    tables = [_block_type(block) for block in BLOCKS.values()]
    model = {"title": MODEL_BLOCK, **_closed(of_model, ["type", "spec", "tf"])}
    return {"oneOf": [formula, *tables, model]}


def _block_type(block: Block) -> Schema:
    is_list = block.type_name in ("tf", "ss")
    properties: dict[str, Schema] = {
        "type": {"const": block.type_name, "description": block.summary},
        "doc": TEXT,
    }
    for parameter in block.parameters:
        value = _value_of(parameter)
        several = {"type": ["string", "number", "array"], "minItems": 1}
        properties[parameter.name] = {**value, **several} if is_list else value
    if block.type_name == "ss":
        ports = (("from", "inputs"), ("to", "signals of the outputs"), ("states", "names of the states"))
        properties |= {key: _said({"type": ["string", "array"], "minItems": 1}, doc) for key, doc in ports}
    required = [p.name for p in block.parameters if p.default is None]
    required += [] if block.type_name == "tf" else ["type"]
    return {"title": block.type_name, **_closed(properties, required)}


def _equations() -> Schema:
    keys = {
        "unknowns": _said({"type": "array", "items": TEXT}, "names of unknowns"),
        "equations": _said({"type": "array", "items": TEXT}, "one for each unknown: m*s^2*x + k*x = F"),
        "doc": TEXT,
    }
    return {**_closed(keys, ["unknowns", "equations"]), "description": "equations of motion"}


def _energy() -> Schema:
    keys = {
        "coordinates": _said({"type": "array", "items": TEXT, "minItems": 1}, "generalised coordinates"),
        "kinetic": _said(TEXT, "kinetic energy: m*x'^2/2"),
        "potential": _said(TEXT, "potential energy: k*x^2/2"),
        "dissipation": _said(TEXT, "half of the power lost: b*x'^2/2"),
        "forces": _said({"type": "object", "additionalProperties": VALUE}, "generalised forces"),
        "constraints": _said({"type": ["string", "array"]}, "holonomic: x^2 + y^2 = l^2"),
        "doc": TEXT,
    }
    return {**_closed(keys, ["coordinates"]), "description": "energies, for Lagrange's equations"}


def _field() -> Schema:
    texts: Schema = {"type": "array", "items": TEXT, "minItems": 1}
    keys = {
        "domain": {"type": "array", "items": VALUE, "minItems": 2, "maxItems": 2, "description": "ends of x"},
        "unknowns": _said(texts, "functions of x; by default the field's name"),
        "equation": _said(TEXT, "E*A*u'' = rho*A*s^2*u"),
        "equations": _said(texts, "one for each unknown"),
        "conditions": _said(texts, "as many as the order in x: u(0) = 0, E*A*u'(l) = F"),
    }
    either = [{"required": ["equation"]}, {"required": ["equations"]}]
    return {**_closed(_labelled(keys), ["domain", "conditions"]), "oneOf": either}


def _contact_port() -> Schema:
    at = {"anyOf": [NODE, _several(1, 2)]}
    keys = {"at": _said(at, "node that is touched, or two, the second for the reaction")}
    keys |= {name: _said(TEXT, f"input that is a {name}, of equations or fields") for name in DELIVERED}
    keys |= {name: _said(TEXT, f"output that is a {name.replace('_', ' ')}") for name in FOLLOWED}
    return _closed({**keys, "doc": TEXT})


def _printed() -> Schema:
    keys = {
        "expr": _said(VALUE, "formula as printed"),
        "latex": _said(TEXT, "formula as the paper types it, in place of expr"),
        "where": _said({"type": "object", "additionalProperties": VALUE}, "abbreviations in it"),
        "scale": _said(VALUE, "factor between it and the derived one"),
        "source": _said(TEXT, "where it is printed"),
        "doc": TEXT,
    }
    return {**_closed(keys), "oneOf": [{"required": ["expr"]}, {"required": ["latex"]}]}


def _printed_table() -> Schema:
    values = {"type": "array", "items": VALUE, "minItems": 1, "description": "digits as printed, - for a gap"}
    row = _closed({"set": {"type": "object", "additionalProperties": VALUE}, "values": values}, ["values"])
    rows = {"type": "array", "items": {"anyOf": [row, values]}, "description": "rows of the table"}
    keys = {
        "of": {"enum": ["poles", "zeros"], "description": "what is printed"},
        "tf": _said(TEXT, "whose they are, as OUT/IN"),
        "prints": _said(VALUE, "what is printed of a root: " + ", ".join(ROOT_QUANTITIES)),
        "rows": rows,
        "values": _said(values, "the only row"),
        "latex": _said(TEXT, "the tabular as it is typed, in place of rows"),
        "source": _said(TEXT, "where it is printed"),
        "doc": TEXT,
    }
    return _closed(keys)


def _count(most: int, description: str) -> Schema:
    return {"type": "integer", "minimum": 1, "maximum": most, "description": description}


def _analysis() -> Schema:
    own_keys: dict[str, Schema] = {
        "band": _said(RANGE, "frequencies of interest [Hz]"),
        "data_end": _said(VALUE, "frequency at which the data end that the model was fitted to [Hz]"),
        "modes": _count(MODES_LIMIT, "how many modes are computed"),
        "digits": _count(DIGITS_LIMIT, "digits of results"),
        "print": _said({"type": "object", "additionalProperties": VALUE}, "names formulas are printed in"),
        "form": _said({"enum": [*FORM_NAMES]}, "form in which transfer functions that have it are printed"),
        "prefer": _said({"type": "array", "items": TEXT}, "dimensionless groups to write functions in"),
    }
    keys = {key: own_keys.get(key, {}) for key in ANALYSIS_KEYS}
    return {**_closed(keys), "description": "defaults of the commands"}


def _figure() -> Schema:
    texts = {"anyOf": [TEXT, {"type": "array", "items": TEXT}]}
    keys: dict[str, Schema] = {
        "kind": {"enum": list(FIGURE_KINDS), "description": "what is drawn"},
        "of": _said(texts, "transfer functions, OUT/IN"),
        "gain": _said(TEXT, "parameter that is the loop's gain"),
        "over": _said(texts, "one or two parameters over which stability is drawn"),
        "range": _said(RANGE, "first and last gain of a locus"),
        "band": _said(RANGE, "frequencies shown [Hz]"),
        "until": _said(VALUE, "last time shown [s]"),
        "at": _said({"anyOf": [VALUE, {"type": "array", "items": VALUE}]}, "frequencies of deflections [Hz]"),
        "data": {"type": "boolean", "description": "whether measured data are drawn under it"},
        "title": TEXT,
        "doc": TEXT,
    }
    return _closed({key: keys.get(key, {}) for key in FIGURE_KEYS}, ["kind"])


def _drawing() -> Schema:
    symbols = {"type": "object", "additionalProperties": {"enum": list(TRANSFORMER_SYMBOLS)}}
    keys = {
        "order": _said({"type": "array", "items": TEXT}, "nodes from left to right"),
        "symbols": _said(symbols, "how transformers are drawn"),
        "rollers": {"type": "boolean", "description": "whether masses stand on rollers"},
        "up": {"type": "boolean", "description": "whether what moves in translation moves upwards"},
    }
    return {**_closed(keys), "description": "how the model is drawn"}
