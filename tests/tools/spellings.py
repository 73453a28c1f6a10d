"""The same physics in other words: one specification in at least twelve spellings, and what has to stay.

Values at points, certificates, verdicts of stability, poles, zeros, hidden modes and the words for them are
the same in every spelling; where nothing else is a name, so is the length of the print.
"""

from __future__ import annotations

import json
import re
import tomllib
from dataclasses import dataclass
from decimal import Context, Decimal
from fractions import Fraction
from time import process_time
from typing import TYPE_CHECKING

from symflex import pipeline
from symflex.budget import Budget
from symflex.errors import SymflexError, Text
from symflex.quantities import looks_like_quantity, parse_quantity
from symflex.transfer import NestedTransferFunction
from symflex.transfer.nested_form import bind_any

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from symflex.model import Model
    from symflex.roots.pole_zero_map import PoleZeroMap

    Data = dict[str, object]
    Change = Callable[[str, bool], object]

SECTIONS = ("parameters", "definitions", "elements", "blocks", "signals", "fields", "inputs", "outputs")
NO_VALUES = frozenset(
    "type between at terminals from to shaft mover inputs out theory latex doc model tf unknowns".split()
)
WORD = re.compile(r"(?<![\w.])(?<!\d )([A-Za-z]\w*)(?![\w.'])")
PLAIN = re.compile(r"([-+]?[\d.]+(?:[eE][-+]?\d+)?)(?:\s+(.*))?\Z")
EXACT = Context(prec=100)
OTHER_UNITS = {
    "Pa": ("kPa", -3), "GPa": ("MPa", 3), "m": ("mm", 3), "mm": ("um", 3), "m^2": ("mm^2", 6),
    "m^4": ("mm^4", 12), "kg": ("g", 3), "kg/m^3": ("g/cm^3", -3), "N/m": ("kN/m", -3), "kN/m": ("N/m", 3),
    "N*m/rad": ("mN*m/rad", 3), "N*s/m": ("kN*s/m", -3), "s": ("ms", 3), "ms": ("s", -3), "ohm": ("mOhm", 3),
    "H": ("mH", 3), "F": ("uF", 6),
}  # fmt: skip
"""Units, others for the same, and by which power of ten the number changes."""


# ------------------------------------------------------------------------------------- reading and writing


def _read(text: str) -> Data:
    data = tomllib.loads(text, parse_float=Decimal)
    return {key: value for key, value in data.items() if key == "symflex" or key in SECTIONS}


def _written(value: object) -> str:
    match value:
        case bool():
            return str(value).lower()
        case str():
            return json.dumps(value, ensure_ascii=False)
        case list():
            return f"[{', '.join(map(_written, value))}]"
        case dict():
            return f"{{ {', '.join(f'{k} = {_written(v)}' for k, v in value.items())} }}"
    return str(value)


def _text(data: Data) -> str:
    sections = [key for key in SECTIONS if data.get(key)]
    lines = [f"symflex = {data['symflex']}"]
    for section in sections:
        lines += [f"[{section}]", *(f"{k} = {_written(v)}" for k, v in data[section].items())]
    return "\n".join(lines) + "\n"


def _mapped(data: Data, change: Change) -> Data:
    """Return a specification with every expression changed; a value of an element may be a quantity."""

    def inside(value: object, *, is_value: bool) -> object:
        match value:
            case dict():
                return {k: v if k in NO_VALUES else inside(v, is_value=is_value) for k, v in value.items()}
            case list():
                return [inside(v, is_value=False) for v in value]
            case str() | int() | Decimal() if not isinstance(value, bool):
                return change(str(value), is_value) if isinstance(value, str) or is_value else value
        return value

    found = dict(data)
    for section in ("definitions", "elements", "blocks", "signals", "fields", "outputs"):
        if section in data:
            is_value = section in ("elements", "blocks")
            found[section] = {k: inside(v, is_value=is_value) for k, v in data[section].items()}
    return found


def _put(images: Mapping[str, str]) -> Change:
    """Return what puts other words in place of names."""

    def change(text: str, _: bool) -> str:
        if looks_like_quantity(text):
            return text
        return images.get(text.strip()) or WORD.sub(
            lambda m: f"({images[m[1]]})" if m[1] in images else m[1], text
        )

    return change


def _parameters(data: Data) -> dict[str, dict]:
    """Return the parameters as tables; values are texts."""
    given = data.get("parameters", {})
    tables = {k: dict(v) if isinstance(v, dict) else {"value": v} for k, v in given.items()}
    return {k: v | ({"value": str(v["value"])} if "value" in v else {}) for k, v in tables.items()}


def _with(data: Data, parameters: Mapping[str, dict], change: Change | None = None) -> Data:
    """Return a specification with other parameters, and other words for them."""
    found = data if change is None else _mapped(data, change)
    numbers = {
        name: entry | {"value": Decimal(entry["value"])}
        if "value" in entry and _unit(entry) is not None and not PLAIN.match(entry["value"])[2]
        else entry
        for name, entry in parameters.items()
    }
    return found | {"parameters": numbers}


def _unit(entry: Mapping[str, str]) -> str | None:
    """Return the unit of a plain number, None of what is none."""
    found = PLAIN.match(entry.get("value", ""))
    return None if found is None else found[2] or ""


def _times(entry: Mapping[str, str], factor: str) -> dict:
    """Return a parameter of a plain number times another."""
    number, unit = PLAIN.match(entry["value"]).groups()
    product = EXACT.multiply(Decimal(number), Decimal(factor))
    return entry | {"value": f"{product} {unit}" if unit else str(product)}


def _split(data: Data) -> tuple[dict[str, dict], dict[str, dict]]:
    """Return the parameters whose values are plain numbers, and the others."""
    found = _parameters(data)
    plain = {k: v for k, v in found.items() if _unit(v) is not None}
    return plain, {k: v for k, v in found.items() if k not in plain}


# ----------------------------------------------------------------------------------------------- spellings


def _inlined(data: Data, every: int = 1) -> Data:
    """Put numbers in place of parameters: quantities where one stands alone, plain numbers in formulas."""
    plain, _ = _split(data)
    chosen = {k: v for i, (k, v) in enumerate(plain.items()) if i % every == 0 and "unit" not in v}
    bare = {k: v["value"] for k, v in chosen.items() if not _unit(v)}
    formulas = _put(bare)

    def change(text: str, is_value: bool) -> str:
        if is_value and text.strip() in chosen:
            return chosen[text.strip()]["value"]
        return formulas(text, is_value)

    found = _mapped(data, change)
    used = set(WORD.findall(_text(found | {"parameters": {}})))
    kept = {k: v for k, v in _parameters(data).items() if k in used or k not in chosen}
    return _with(found, kept)


def _in_formulas(data: Data) -> Data:
    """Put numbers in SI units in place of parameters everywhere, which units do not always allow."""
    plain, others = _split(data)
    known = {k: parse_quantity(Text.alone("", v["value"])) for k, v in plain.items() if "unit" not in v}
    images = {
        k: str(q.magnitude) for k, q in known.items() if not (q.cycles or q.pi_power) and q.magnitude >= 0
    }
    return _with(data, {k: v for k, v in (others | plain).items() if k not in images}, _put(images))


def _named(data: Data) -> Data:
    """Make a parameter of every number and quantity that is the value of an element or block."""
    parameters = _parameters(data)

    def change(text: str, is_value: bool) -> str:
        if (
            not is_value
            or not looks_like_quantity(text)
            or Decimal(text.split(maxsplit=1)[0].split("*", maxsplit=1)[0]) == 0
        ):
            return text
        name = f"value_{len(parameters)}"
        parameters[name] = {"value": text, "assume": "real"}
        return name

    return _with(_mapped(data, change), parameters)


def _in_other_units(data: Data) -> Data:
    parameters = _parameters(data)
    for name, entry in parameters.items():
        unit, power = OTHER_UNITS.get(_unit(entry) or "", ("", 0))
        if unit:
            number, _ = PLAIN.match(entry["value"]).groups()
            parameters[name] = entry | {"value": f"{number}e{power} {unit}".replace("e-3e", "e")}
            if "e" in number.lower():
                parameters[name] = entry | {"value": f"{Decimal(number).scaleb(power)} {unit}"}
    return _with(data, parameters)


def _sums(data: Data) -> Data:
    plain, others = _split(data)
    parts = {
        f"{k}_part_{n}": _times(v, x) for k, v in plain.items() for n, x in (("a", "0.25"), ("b", "0.75"))
    }
    return _with(data, others | parts, _put({k: f"{k}_part_a + {k}_part_b" for k in plain}))


def _products(data: Data) -> Data:
    plain, others = _split(data)
    parts = {f"{k}_v": _times(v, "0.25") for k, v in plain.items()}
    parts |= {f"{k}_n": {"value": "4"} for k in plain}
    return _with(data, others | parts, _put({k: f"{k}_n*{k}_v" for k in plain}))


def _defined(data: Data, depth: int = 1) -> Data:
    plain, others = _split(data)
    definitions: dict[str, object] = {}
    for name in plain:
        last = f"{name}_own"
        for n in range(1, depth):
            definitions[f"{name}_def{n}"] = f"{last}*{n + 1}/{n}" if n < depth - 1 else f"{last}/{depth - 1}"
            last = f"{name}_def{n}"
        definitions[name] = last
    renamed = {f"{k}_own": v for k, v in plain.items()}
    found = _with(data, others | renamed)
    return found | {"definitions": definitions | dict(data.get("definitions", {}))}


def _in_the_middle(data: Data) -> Data:
    plain, _ = _split(data)
    return _mapped(data, _put({k: f"4*{k}/2*0.5" for k in plain}))


def _composed(data: Data, *, is_defined: bool) -> Data:
    """Write densities, moduli and sections of line elements as people do, by other quantities."""
    data = _named(data)
    parameters, definitions = _parameters(data), dict(data.get("definitions", {}))
    elements = dict(data.get("elements", {}))

    def value(text: object) -> Fraction | None:
        entry = parameters.get(str(text), {})
        if _unit(entry) in (None, "") or "unit" in entry:
            return None
        return Fraction(parse_quantity(Text.alone("", entry["value"])).magnitude)

    for i, (name, element) in enumerate(elements.items()):
        known = {k: v for k in ("rho", "A", "E", "G", "I") if (v := value(element.get(k))) and v > 0}
        new: dict[str, tuple[str, dict[str, str]]] = {}
        if element.get("type") not in ("beam", "rod", "string", "frame"):
            continue
        if {"rho", "A"} <= known.keys():
            new["rho"] = f"mu_{i}/{element['A']}", {f"mu_{i}": f"{known['rho'] * known['A']} kg/m"}
        if {"E", "A"} <= known.keys() and element["type"] == "rod":
            new["E"] = f"S_{i}/{element['A']}", {f"S_{i}": f"{known['E'] * known['A']} N"}
        if "I" in known and element["type"] == "beam":
            width = {f"b_{i}": f"{known['I'] * 12 * 10**6} m", f"h_{i}": "10 mm"}
            new["I"] = f"b_{i}*h_{i}^3/12", width
        if {"E", "G"} <= known.keys():
            ratio = {f"nu_{i}": f"{100 * (known['E'] / known['G'] / 2 - 1)} %"}
            new["G"] = f"{element['E']}/(2*(1 + nu_{i}))", ratio
        for key, (text, more) in new.items():
            parameters |= {k: {"value": v, "assume": "real"} for k, v in more.items()}
            if is_defined:
                definitions[f"{key}_of_{name}"] = text
        elements[name] = element | {k: f"{k}_of_{name}" if is_defined else t for k, (t, _) in new.items()}
    return _with(data | {"elements": elements, "definitions": definitions}, parameters)


def _reversed(data: Data, section: str) -> Data:
    return data | {section: dict(reversed(data.get(section, {}).items()))}


def _renamed(data: Data) -> Data:
    parameters = _parameters(data)
    images = {k: f"z_{len(parameters) - i}" for i, k in enumerate(parameters)}
    change = _put({k: images[k] for k in parameters})
    return _with(data, {images[k]: v for k, v in parameters.items()}, change)


def _without_values(data: Data) -> Data:
    plain, others = _split(data)
    free = {
        k: {key: x for key, x in v.items() if key != "value"} | ({"unit": u} if (u := _unit(v)) else {})
        for k, v in plain.items()
    }
    return _with(data, others | free)


LINES = dict.fromkeys(("beam", "frame", "rod", "shaft", "string"), "l")
LUMPS = {
    "spring": "k",
    "torsion_spring": "k",
    "damper": "b",
    "rotary_damper": "b",
    "mass": "m",
    "inertia": "J",
}
SOURCES = {
    "spring": ("force", "f", ""),
    "torsion_spring": ("torque", "tau", ""),
    "damper": ("force", "f", "*s"),
}


def _exchanged(data: Data, change: Callable[[str, dict, Data], Mapping[str, dict] | None]) -> Data:
    """Put other elements in place of those of which nothing is asked by name; ``change`` may add signals."""
    data = _named(data)
    asked = _text({k: v for k, v in data.items() if k not in ("elements", "parameters")})
    found: Data = data | {"signals": dict(data.get("signals", {})), "elements": {}}
    for name, element in data.get("elements", {}).items():
        others = None if f"{name}." in asked else change(name, element, found)
        found["elements"] |= {name: element} if others is None else others
    return found


def _halves(name: str, element: dict, _: Data) -> Mapping[str, dict] | None:
    """Return two elements of half the value in parallel, or two lengths of a uniform member in a row."""
    key = (LUMPS | LINES).get(element["type"])
    if key is None or any("x" in WORD.findall(str(value)) for value in element.values()):
        return None
    both = [element | {key: f"({element[key]})/2"} for _ in range(2)]
    if key == "l":
        start, end = element["between"]
        both[0]["between"], both[1]["between"] = [start, f"{name}_mid"], [f"{name}_mid", end]
    return {f"{name}_{n}": half for n, half in enumerate(both)}


def _followed(name: str, element: dict, data: Data) -> Mapping[str, dict] | None:
    """Return sources that follow a signal in place of a spring or damper."""
    if element["type"] not in SOURCES or "eta_s" in element:
        return None
    (kind, key, rate), value = SOURCES[element["type"]], element[LUMPS[element["type"]]]
    start, end = (None if node == "ground" else node for node in element["between"])
    across = f"{start} - {end}" if start and end else start or f"-{end}"
    data["signals"][f"{name}_by"] = f"({value}){rate}*({across})"
    ends = {"a": (start, "-"), "b": (end, "")}
    return {
        f"{name}_{n}": {"type": f"{kind}_source", "at": node, key: f"{sign}{name}_by"}
        for n, (node, sign) in ends.items()
        if node
    }


def _levers(name: str, element: dict, _: Data) -> Mapping[str, dict] | None:
    """Return a mass or an inertia of a quarter that a lever moves twice as far."""
    if element["type"] not in ("mass", "inertia"):
        return None
    lever = {"type": "transformer", "from": element["at"], "to": f"{name}_end", "ratio": Decimal(2)}
    key = LUMPS[element["type"]]
    moved = element | {"at": f"{name}_end", key: f"({element[key]})/4"}
    return {name: moved, f"{name}_lever": lever}


def _as_frames(data: Data) -> Data:
    """Make members of a plane frame, along x, of uniform beams."""
    elements = data.get("elements", {})
    beams = {name: element for name, element in elements.items() if element["type"] == "beam"}
    planar = {node for beam in beams.values() for node in beam["between"]} - {"ground"}
    if not planar or any("x" in WORD.findall(_written(beam)) for beam in beams.values()):
        return data
    node = re.compile(rf"(?<![\w.])({'|'.join(planar)})(?![\w.(])")

    def along_y(value: object) -> object:
        text = _written(value)
        return value if "torque" in text else tomllib.loads("x = " + node.sub(r"\1.y", text))["x"]

    kinds = ("mass", "spring", "damper", "force_source", "transformer")
    found = {
        name: element | {"type": "frame"}
        if name in beams
        else along_y(element)
        if element["type"] in kinds
        else element
        for name, element in elements.items()
    }
    shown = {k: {n: along_y(v) for n, v in data.get(k, {}).items()} for k in ("inputs", "outputs", "signals")}
    return data | shown | {"elements": found}


PHYSICS: dict[str, Callable[[Data], Data]] = {
    "halves": lambda data: _exchanged(data, _halves),
    "quarters": lambda data: _exchanged(_exchanged(data, _halves), _halves),
    "signals": lambda data: _exchanged(data, _followed),
    "levers": lambda data: _exchanged(data, _levers),
    "frames": _as_frames,
}
"""Spellings by other elements: they have other nodes, and where a beam may slide its frame may, too."""

SPELLINGS: dict[str, Callable[[Data], Data]] = {
    "inlined": _inlined,
    "inlined in formulas": _in_formulas,
    "every second inlined": lambda data: _inlined(data, 2),
    "numbers named": _named,
    "other units": lambda data: _in_other_units(_named(data)),
    "sums": lambda data: _sums(_named(data)),
    "products": lambda data: _products(_named(data)),
    "definitions": lambda data: _defined(_named(data)),
    "nested definitions": lambda data: _defined(_named(data), 3),
    "composed": lambda data: _composed(data, is_defined=False),
    "composed definitions": lambda data: _composed(data, is_defined=True),
    "parameters reversed": lambda data: _reversed(_named(data), "parameters"),
    "elements reversed": lambda data: _reversed(data, "elements"),
    "renamed": lambda data: _renamed(_named(data)),
    "without values": _without_values,
    "a literal in the middle": lambda data: _in_the_middle(_named(data)),
}
NOT_EVERYWHERE = frozenset({"inlined in formulas", "without values"})
"""Spellings that a specification may refuse, as numbers have no units and points along x need values."""
EQUALLY_LONG = {name: "numbers named" for name in ("other units", "renamed", "parameters reversed")}
"""Spellings in which the print has to be as long as in others."""


def spellings(text: str, ways: Mapping[str, Callable[[Data], Data]] = SPELLINGS) -> list[tuple[str, str]]:
    """Return a specification in other words, each with a name, where they are others.

    Examples
    --------
    >>> text = '''
    ... symflex = 1
    ... parameters = { k = "2 N/m" }
    ... elements.body = { type = "mass", at = "x", m = "3 kg" }
    ... elements.spring = { type = "spring", between = ["x", "ground"], k = "k" }
    ... inputs.F = { force = "x" }
    ... outputs.X = "x"
    ... '''
    >>> found = dict(spellings(text))
    >>> len(found) > 12
    True
    >>> print(found["products"].partition("[elements]")[0])  # doctest: +NORMALIZE_WHITESPACE
    symflex = 1
    [parameters]
    k_v = { value = "0.50 N/m" }
    value_1_v = { value = "0.75 kg", assume = "real" }
    k_n = { value = 4 }
    value_1_n = { value = 4 }
    """
    data = _read(text)
    found = ((name, _text(respelt(data))) for name, respelt in ways.items())
    same = (_text(data), _text(_named(data)))
    return [("plain", same[0]), *(x for x in found if x[0] not in PHYSICS or x[1] not in same)]


# ------------------------------------------------------------------------------------------------ answers

POINTS = (0.05 + 0.7j, 0.9 + 13.3j, 21 + 317j)
SECONDS = 20.0
SAID = ("re", "im", "multiplicity", "on_imaginary_axis", "is_real", "certified", "cause")


@dataclass(frozen=True)
class Answers:
    """What the program prints for a specification."""

    values: tuple[complex, ...] = ()  # of all transfer functions at :data:`POINTS`
    said: Mapping[str, object] | None = (
        None  # of poles and zeros, as JSON; None where they were not asked for
    )
    length: int = 0  # terms of the print
    refused: str = ""  # the codes with which it was


def answers(text: str, given: Mapping[str, str] | None = None, *, asks_roots: bool = True) -> Answers:
    """Return what the program prints; ``given`` are values of parameters that have none."""
    try:
        model = pipeline.loads(text)
    except SymflexError as error:
        return Answers(refused="at loading: " + " ".join(d.code for d in error.diagnostics))
    try:
        with Budget(SECONDS, clock=process_time).entered():
            return _answers(model, given or {}, asks_roots=asks_roots)
    except SymflexError as error:
        return Answers(refused=" ".join(d.code for d in error.diagnostics))
    except (ArithmeticError, AssertionError, LookupError, TypeError, ValueError) as error:
        return Answers(refused=type(error).__name__)


def _answers(model: Model, given: Mapping[str, str], *, asks_roots: bool) -> Answers:
    found, _ = pipeline.derive_as(model, model.transfer_functions)
    free = {p.name: given[p.name] for p in model.parameters if p.value is None}
    values, length = [], 0
    for tf in found:
        bound = bind_any(tf, free)
        values += [bound(s) for s in POINTS]
        length += (
            0
            if isinstance(tf, NestedTransferFunction)
            else sum(len(f) * abs(e) for v in (tf.num, tf.den) for f, e in v.factors)
        )
    if free or not asks_roots:
        return Answers(tuple(values), length=length)
    (bound,) = pipeline.derive_for_roots(model, model.transfer_functions[:1])
    return Answers(tuple(values), _said(pipeline.roots(bound)), length)


def _said(found: PoleZeroMap) -> dict[str, object]:
    """Return what is said of roots, but for the engine, radii, and the names of what moves unseen."""
    data = found.to_json_dict()
    verdict, certificate = data["stability"], data["certificate"]
    hidden_motion = verdict["hidden_motion"].partition(":")[0]
    return {
        "verdict": verdict | {"hidden_motion": hidden_motion},
        "certificate": certificate | {"engine": ""},
    } | {
        side: [{key: root.get(key) for key in SAID} for root in data[side]]
        for side in ("poles", "zeros", "hidden", "right_half_plane")
    }


def values_of(text: str) -> dict[str, str]:
    """Return the values of a specification's parameters."""
    return {k: v["value"] for k, v in _parameters(_read(text)).items() if "value" in v}


def difference(name: str, found: Answers, expected: Answers) -> str:
    """Return in which way a spelling's answers differ from others, nothing where they do not."""
    if found.refused or expected.refused:
        return "" if found.refused == expected.refused else f"refused: {found.refused or 'no more'}"
    if not _agree(found.values, expected.values, 1e-9):
        return "values"
    if found.said is not None and expected.said is not None:
        other = {k: (v, expected.said[k]) for k, v in found.said.items() if v != expected.said[k]}
        if other:
            return "; ".join(f"{k}: {a}, not {b}" for k, (a, b) in other.items())
    if name in EQUALLY_LONG and found.length != expected.length:
        return f"{found.length} terms, not {expected.length}"
    return ""


def _agree(found: Sequence[complex], expected: Sequence[complex], share: float) -> bool:
    pairs = zip(found, expected, strict=False)
    size = max(map(abs, expected), default=0.0) * 1e-300
    return len(found) == len(expected) and all(abs(a - b) <= share * abs(b) + size for a, b in pairs)


def compared(
    text: str, ways: Mapping[str, Callable[[Data], Data]] = SPELLINGS, *, asks_roots: bool = True
) -> dict[str, str]:
    """Return per spelling in which way its answers differ from those of the plain one."""
    (_, plain), *others = spellings(text, ways)
    given, known = values_of(plain), {"plain": answers(plain, asks_roots=asks_roots)}
    told: dict[str, str] = {}
    if known["plain"].refused.startswith("at loading"):
        return told  # units that are not checked in other words
    for name, other in others:
        known[name] = answers(other, given, asks_roots=asks_roots)
        if name in NOT_EVERYWHERE and known[name].refused.startswith("at loading"):
            continue
        told[name] = difference(name, known[name], known[EQUALLY_LONG.get(name, "plain")])
    return told
