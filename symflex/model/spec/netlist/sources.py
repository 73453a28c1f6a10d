"""Independent sources, sources that voltages and currents control, and op-amps."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Final

from symflex.expressions import Expression, Name, format_expression, product_of, sum_of
from symflex.model.spec.netlist.expressions import expression_of, slopes
from symflex.model.spec.netlist.scopes import Lookup
from symflex.model.spec.netlist.statement import APART, IndependentSource, PlacedCard, difference

GAIN_UNITS: Final = {"E": "", "F": "", "G": "A/V", "H": "Ohm"}
FUNCTION: Final = re.compile(r"\s(?:value|vol|cur)\s*=?\s*([{'\"].*)", re.I | re.S)
NOT_READ: Final = re.compile(r"(table|value|laplace|freq|vol|cur|vcr|vccap|pwl|delay)\b.*", re.I)
SLOPE: Final = "write E, F, G or H with the slope at the operating point"
OP_AMPS: Final = {4: re.compile(r"universalopamp\w*|level\.?[12]\w*"), 2: re.compile("opamp")}
"""The op-amps of LTspice, by the place of their output among their nodes; level 3 has a second pole."""


def independent(line: PlacedCard) -> None:
    """Take a source V or I."""
    ends = line.nodes(1, 2)
    plain, given = line.card.options(3)
    plain = [w.lower() for w in plain]
    odd = {k: v for k, v in given.items() if k in ("rser", "cpar", "m", "z0")}
    line.check([w for w in plain if w in ("rser", "cpar", "z0", "portnum")], odd)
    is_ac = "acmag" in given or "ac" in given or any(re.match(r"ac\b", w) for w in plain)
    after = [*given.get("acmag", given.get("ac", [])), *(b for a, b in pairwise(plain) if a == "ac")]
    after += [m[1] for w in plain if (m := re.match(r"ac\s*\(\s*([^\s,)]+)", w))]
    if any(line.size(w) == 0 for w in after[:1]):
        is_ac = False  # AC 0
    moves = any(re.match(r"(sin|sine|pulse|pwl|exp|sffm|wave\w*)\b", w) for w in plain)
    kind = "ac" if is_ac else "moves" if moves else "rests"
    name = line.element()
    line.build.sources.append(
        IndependentSource(name, line.path, line.letter, (ends[0], ends[1]), line.card, kind)
    )
    if line.letter == "V":
        line.carries_own(name, is_voltage=True)


def controlled(line: PlacedCard) -> None:
    """Take a source E, F, G or H: of a constant gain, of POLY, of a linear function, or an ideal op-amp."""
    card, letter = line.card, line.letter
    ends, name = line.nodes(1, 2), line.element()
    plain, given = card.options(3)
    kind = plain[0].lower() if plain else ""
    if letter == "N" or kind == "opamp":
        _simulated_op_amp(line, name, ends, given)
        return
    is_voltage = letter in "EH"
    line.carries_own(name, is_voltage=is_voltage)
    if (function := FUNCTION.search(card.text)) is not None:
        _linear(line, name, ends, function[1], is_voltage=is_voltage)
        return
    if kind in ("vcvs", "vccs", "cccs", "ccvs"):
        plain = plain[1:]
    named = next((w for w in ("laplace", "table", "vol", "cur", "v", "i", "freq") if w in given), "")
    if named or NOT_READ.match(kind):
        hint = "write a constant gain; a block may replace it in the file of 'symflex new --from'"
        raise card.refuse(f"'{line.word}' has a function that is not read: {named or kind[:40]}", hint)
    count, is_poly = 1, kind.startswith("poly")
    if is_poly:
        match = re.fullmatch(r"poly\s*\(\s*([1-9]\d?)\s*\)", kind)
        if match is None:
            raise card.refuse(f"'{kind[:40]}' is not read", "write POLY(1)")
        count, plain = int(match[1]), plain[1:]
    width = 2 if letter in "EG" else 1
    control, coefficients = plain[: width * count], plain[width * count :]
    coefficients = [given.pop(k)[0] for k in ("gain", "value") if k in given] or coefficients
    coefficients = _slopes(line, coefficients, count) if is_poly else coefficients
    if len(control) < width * count or not coefficients:
        raise card.refuse(f"'{line.word}' has no gain", "write its nodes, what controls it, and the gain")
    line.check(coefficients[count:], given)
    labels = [name if count == 1 else f"{name}_{k}" for k in range(1, count + 1)]
    gains = [line.valued(n, w, GAIN_UNITS[letter]) for n, w in zip(labels, coefficients, strict=False)]
    if width == 2 and count == 1:  # noqa: PLR2004
        kind, key = ("vcvs", "mu") if is_voltage else ("vccs", "g")
        ports = {"inputs": [line.node(w) for w in control], "terminals": ends if is_voltage else ends[::-1]}
        line.add(name, {"type": kind, **ports, key: format_expression(gains[0])})
        return
    nodes = [line.node(w) for w in control] if width == 2 else []  # noqa: PLR2004

    def finish() -> None:
        pairs = zip(nodes[::2], nodes[1::2], strict=True)
        read = [difference(p) for p in pairs] if nodes else [line.current(w) for w in control]
        value = sum_of(product_of(pair) for pair in zip(gains, read, strict=True))
        line.source(name, ends, format_expression(value), is_voltage=is_voltage)

    line.build.later.append(finish)


def _simulated_op_amp(
    line: PlacedCard, name: str, ends: Sequence[str], given: Mapping[str, Sequence[str]]
) -> None:
    """Take the ideal op-amp of a simulator: N, or E with ``opamp`` between its nodes."""
    first = 3 + (line.letter != "N")
    inputs = line.nodes(first, 2)
    gain = [w for w in line.card.words[first + 2 :] if w != "N"]
    line.check(gain[1:], given)
    _op_amp(line, name, inputs, ends, A=format_expression(line.number(gain[0])) if gain else "")


def _slopes(line: PlacedCard, words: Sequence[str], count: int) -> list[str]:
    """Return the linear coefficients of a polynomial; its constant does not act on small signals."""
    if len(words) < 1 + count:
        hint = "write the constant, then a coefficient for each"
        raise line.card.refuse(f"'{line.word}' has too few coefficients", hint)
    if any(line.size(w) != 0 for w in words[1 + count :]):
        raise line.card.refuse(f"'{line.word}' has a polynomial that is not linear", SLOPE)
    return list(words[1 : 1 + count])


@dataclass(frozen=True)
class _Readings(Lookup):
    """Voltages and currents that an expression reads, by the names that stand for them in it."""

    line: PlacedCard = field(kw_only=True)
    kinds: dict[str, str] = field(default_factory=dict)
    signals: dict[str, Expression] = field(default_factory=dict)

    def signal(self, kind: str, places: Sequence[str]) -> Expression:
        if kind == "v" and len(places) in (1, 2):
            read = difference([self.line.touched(w) for w in places])
        elif kind == "i" and len(places) == 1:
            read = self.line.current(places[0])
        else:
            raise self.line.card.refuse(f"'{kind}({','.join(places)[:40]})' is not a voltage or a current")
        name = f"#{format_expression(read)}"  # the same one for the same signal
        self.kinds[name], self.signals[name] = kind, read
        return Name(name)


def _linear(line: PlacedCard, name: str, ends: Sequence[str], text: str, *, is_voltage: bool) -> None:
    """Add a source of a linear function of voltages and currents, once all of these are known."""

    def finish() -> None:
        readings = _Readings(line.build.values, line.card, line.scope, line=line)
        value = expression_of(line.card, text, readings)
        gains = slopes(value, readings.signals)
        if gains is None:
            raise line.card.refuse(f"'{line.word}' has a function that is not linear", SLOPE)
        terms = []
        for number, (signal, gain) in enumerate(gains.items(), 1):
            label = name if len(gains) == 1 else f"{name}_{number}"
            unit = {("v", False): "A/V", ("i", True): "Ohm"}.get((readings.kinds[signal], is_voltage), "")
            terms.append(product_of([line.named(label, gain, None, unit), readings.signals[signal]]))
        line.source(name, ends, format_expression(sum_of(terms)), is_voltage=is_voltage)

    line.build.later.append(finish)


def arbitrary(line: PlacedCard) -> None:
    """Take a source B of a linear function."""
    ends, name = line.nodes(1, 2), line.element()
    given = {k.lower(): v for k, v in line.card.assigned()[1]}
    kinds = [k for k in ("v", "i") if k in given]
    if len(kinds) != 1:
        raise line.card.refuse(f"'{line.word}' has no function", "write V = 2*V(in)")
    text = given.pop(kinds[0])
    line.check((), {k: [v] for k, v in given.items()})
    is_voltage = kinds[0] == "v"
    line.carries_own(name, is_voltage=is_voltage)
    _linear(line, name, ends, text, is_voltage=is_voltage)


def _op_amp(line: PlacedCard, name: str, inputs: Sequence[str], ends: Sequence[str], **values: str) -> None:
    if ends[1] != "ground":
        raise line.card.refuse(
            f"the output of '{line.word}' is not against ground", "write its second node as 0"
        )
    given = {key: value for key, value in values.items() if value}
    line.add(name, {"type": "op_amp", "inputs": [*inputs], "out": ends[0], **given})
    line.carries_own(name, is_voltage=True)


def is_library_op_amp(words: Sequence[str]) -> bool:
    """Tell whether a line X names an op-amp of LTspice's library."""
    return any(len(words) == at + 3 and names.fullmatch(words[-1].lower()) for at, names in OP_AMPS.items())


def library_op_amp(line: PlacedCard, words: Sequence[str], given: Mapping[str, str]) -> None:
    """Take an op-amp of LTspice's library: with supplies in+, in-, V+, V-, out; without in-, in+, out."""
    known = "avol aol gbw rin rout slew ilimit rail vos phimargin en enk in ink"  # from slew on nonlinear
    if odd := given.keys() - known.split():
        raise line.card.refuse(f"'{min(odd)[:40]}' of '{line.word}' is not read", APART)
    name = line.element()
    plus, minus, last = (1, 2, 5) if len(words) == 7 else (2, 1, 3)  # noqa: PLR2004 (name, 5 nodes, type)
    inputs = [line.node(words[plus]), line.node(words[minus])]
    out = line.node(words[last])
    inner = line.node(f"{words[0]} out") if "rout" in given else out
    for key, label, ends in (("rin", "_Rin", inputs), ("rout", "_Rout", (inner, out))):
        if key in given:
            part = line.element(label)
            value = format_expression(line.valued(part, given[key], "Ohm"))
            line.add(part, {"type": "resistor", "between": [*ends], "R": value})
    text, band = given.get("avol", given.get("aol", "")), given.get("gbw", "")
    gain = format_expression(line.valued(f"{name}_Avol", text, "")) if text else ""
    f_u = format_expression(line.valued(f"{name}_GBW", band, "Hz")) if band else ""
    _op_amp(line, name, inputs, (inner, "ground"), A=gain, f_u=f_u)
