"""Resistors, inductors and capacitors, with temperatures and models; coupled windings; lossless lines."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import combinations, dropwhile
from typing import Final

from symflex.errors import nearest
from symflex.expressions import (
    Attribute,
    Call,
    Expression,
    Name,
    format_expression,
    is_number,
    number,
    product_of,
    sum_of,
)
from symflex.expressions.nodes import negative
from symflex.model.spec.netlist.cards import Card
from symflex.model.spec.netlist.expressions import added, divided
from symflex.model.spec.netlist.statement import APART, Build, Coil, CoupledPair, PlacedCard, difference

TYPES: Final = {
    "R": ("resistor", "R", "Ohm"), "L": ("inductor", "L", "H"), "C": ("capacitor", "C", "F"),
}  # fmt: skip
OWN_VALUE: Final = {
    "R": ("r", "resistance", "res"), "L": ("l", "inductance", "ind"), "C": ("c", "capacitance", "cap"),
}  # fmt: skip
"""Under which names a component or its .model has its value."""
WARMED: Final = frozenset(("tc", "tc1", "tc2", "temp", "dtemp"))
GEOMETRY: Final = frozenset("rsh narrow defw defl short cj cjsw w l".split())
"""What a .model says of the value, and what does not matter where the component has its own."""
MODEL_KEYS: Final = frozenset("tc1 tc2 tnom tref kf af bv_max level".split())
QUARTER: Final = Fraction(1, 4)  # length of a line in wavelengths at the frequency F, unless NL is given


def component(line: PlacedCard) -> None:
    """Take a resistor, an inductor or a capacitor."""
    card, letter = line.card, line.letter
    kind, key, unit = TYPES[letter]
    name, ends = line.element(), line.nodes(1, 2)
    plain, given = card.options(3)
    model = next((m for w in plain if (m := line.scope.model(w.lower())) is not None), None)
    plain = [w for w in plain if line.scope.model(w.lower()) is None]
    keys = (*OWN_VALUE[letter], "value")
    found = [given.pop(k)[0] for k in keys if k in given]
    if plain and plain[0].upper() in (letter, "VALUE") and (found or len(plain) > 1):
        plain = plain[1:]  # as SLiCAP writes it
    if not found:
        found, plain = plain[:1], plain[1:]
    shared = {} if model is None else _model(line, model, has_value=bool(found))
    found += [shared[k] for k in keys if k in shared]
    if not found:
        raise card.refuse(f"'{line.word}' has no value", "write the nodes, then the value")
    line.check(plain, given, WARMED)
    value = line.valued(name, found[0], unit, _factor(line, given, shared))
    if letter == "L":
        line.build.windings[line.path] = Coil(name, (ends[0], ends[1]), value)
    line.carries(Attribute(name, "i"))
    if letter != "L" and ends[0] == ends[1]:
        return  # it is shorted
    line.add(name, {"type": kind, "between": ends, key: format_expression(value)})


def _model(line: PlacedCard, model: Card, *, has_value: bool) -> dict[str, str]:
    """Return what a .model of a resistor, a capacitor or an inductor says of a component."""
    name = model.words[1][:40]
    match = re.fullmatch(r"\.model\s+\S+\s+([a-z]+)\s*\(?(.*?)\)?\s*", model.text, re.I | re.S)
    if match is None or match[1].lower() not in OWN_VALUE[line.letter]:
        raise line.card.refuse(f"the model '{name}' is not one of '{line.word}'")
    odd_words, assigned = replace(model, text=match[2]).assigned()
    if odd_words:
        raise model.refuse(f"'{odd_words[0][:40]}' of the model '{name}' is not read")
    said = {k.lower(): v for k, v in assigned}
    known = MODEL_KEYS.union(OWN_VALUE[line.letter], GEOMETRY if has_value else ())
    if odd := said.keys() - known:
        raise line.card.refuse(f"'{min(odd)[:40]}' of the model '{name}' is not read", APART)
    return said


def _factor(
    line: PlacedCard, given: Mapping[str, Sequence[str]], model: Mapping[str, str]
) -> Expression | None:
    """Return 1 + tc1*(T - T_nom) + tc2*(T - T_nom)^2, by which a value changes, ``None`` for 1."""
    pair = given.get("tc", [])
    first = given.get("tc1", pair[:1]) or [model.get("tc1", "0")]
    second = given.get("tc2", pair[1:]) or [model.get("tc2", "0")]
    tc_1, tc_2 = line.number(first[0]), line.number(second[0])
    at = line.build.values.temperature
    if "temp" in given:
        at = line.number(given["temp"][0])
    elif "dtemp" in given:
        at = added(at, line.number(given["dtemp"][0]))
    nominal = next((line.number(model[k]) for k in ("tnom", "tref") if k in model), line.build.nominal)
    above = added(at, negative(nominal))
    factor = added(number(1), product_of([tc_1, above]))
    factor = added(factor, product_of([tc_2, above, above]))
    return None if is_number(factor, 1) else factor


def coupling(line: PlacedCard) -> None:
    """Take a coupling of two inductors, or of more in pairs."""
    card = line.card
    plain, given = card.options(1)
    values = list(dropwhile(lambda w: w[0] in "Ll", plain[2:]))
    inductors = plain[: len(plain) - len(values)]
    values = [given.pop(k)[0] for k in ("k", "value") if k in given] or values
    if len(inductors) < 2 or not values:  # noqa: PLR2004
        raise card.refuse("a coupling names two inductors and its factor: K1 L1 L2 0.98")
    line.check(values[1:], given)
    name = line.element()
    factor = line.valued(name, values[0], "")
    paths = [line.scope.path + w.lower() for w in inductors]
    if len(set(paths)) < len(paths):
        raise card.refuse("an inductor is coupled to itself")
    line.build.couplings += [CoupledPair(card, name, (a, b), factor) for a, b in combinations(paths, 2)]


def couple(build: Build) -> None:
    """Replace coupled inductors: by a pair of windings, or by sources where more of them share a core."""
    windings, circuit = build.windings, build.circuit
    cores: dict[str, set[str]] = {}  # by path, every inductor that is coupled to this one
    mutual: dict[frozenset[str], Expression] = {}
    for each in build.couplings:
        if missing := next((p for p in each.pair if p not in windings), None):
            shown, known = missing.rpartition(".")[2], [p.rpartition(".")[2] for p in windings]
            raise each.card.refuse(f"there is no inductor '{shown[:40]}'", nearest(shown, known))
        if frozenset(each.pair) in mutual:
            raise each.card.refuse("these inductors are coupled already")
        both = product_of([windings[p].value for p in each.pair])
        mutual[frozenset(each.pair)] = product_of([each.factor, Call("sqrt", both)])
        core = cores.get(each.pair[0], {each.pair[0]}) | cores.get(each.pair[1], {each.pair[1]})
        cores.update(dict.fromkeys(core, core))
    coupled = {windings[p].name: p for p in cores}
    replaced = [name for name in circuit.sections["elements"] if name in coupled]
    for name in replaced:
        del circuit.sections["elements"][name]
    for each in build.couplings:
        if len(cores[each.pair[0]]) == 2:  # noqa: PLR2004
            one, two = (windings[p] for p in each.pair)
            l_1, l_2, m = map(format_expression, (one.value, two.value, mutual[frozenset(each.pair)]))
            terminals = [*one.ends, *two.ends]
            table = {"type": "coupled_inductors", "terminals": terminals, "L_1": l_1, "L_2": l_2, "M": m}
            circuit.add("elements", each.name, table, each.card)
            for n, path in enumerate(each.pair, 1):
                build.currents[path] = Attribute(each.name, f"i_{n}")
    for name in replaced:
        path = coupled[name]
        if len(cores[path]) > 2:  # noqa: PLR2004
            # v = s*(L*i + M*j + ...) of the currents that flow in, and the .i of a source flows out.
            terms = [product_of([windings[path].value, Attribute(name, "i")])]
            for other in sorted(cores[path] - {path}):
                if (m_12 := mutual.get(frozenset((path, other)))) is not None:
                    terms.append(product_of([m_12, Attribute(windings[other].name, "i")]))
            text = format_expression(negative(product_of([Name("s"), sum_of(terms)])))
            source = {"type": "voltage_source", "between": windings[path].ends, "v": text}
            circuit.add("elements", name, source, circuit.cards["elements", name])
            build.currents[path] = negative(Attribute(name, "i"))


def lossless_line(line: PlacedCard) -> None:
    """Take a lossless line as a field over its length, from 0 to 1: v' = -s*TD*Z0*i, i' = -s*TD/Z0*v."""
    card, circuit = line.card, line.build.circuit
    a, b, c, d = line.nodes(1, 4)
    name = line.element()
    plain, given = card.options(5)
    impedance = given.pop("z0", []) or given.pop("zo", [])
    delay, frequency, lengths = (given.pop(k, []) for k in ("td", "f", "nl"))
    line.check([] if "ic" in given else plain, given)  # ic=1,2,3,4 has more than one word
    if not impedance or not (delay or frequency):
        raise card.refuse(f"'{line.word}' needs Z0, and TD or F", "T1 a 0 b 0 Z0=50 TD=1n")
    z = line.valued(f"{name}_Z0", impedance[0], "Ohm")
    if delay:
        time = line.valued(f"{name}_TD", delay[0], "s")
    else:
        cycles = line.number(lengths[0]) if lengths else number(QUARTER)
        time = line.named(f"{name}_TD", divided(cycles, line.number(frequency[0])), None, "s")
    v, i = (circuit.value_name(f"{name}_{x}") for x in "vi")
    times = format_expression(negative(product_of([Name("s"), time, z])))
    over = format_expression(negative(divided(product_of([Name("s"), time]), z)))
    one, two = (format_expression(difference(pair)) for pair in ((a, b), (c, d)))
    table = {
        "unknowns": [v, i],
        "domain": ["0", "1"],
        "equations": [f"{v}' = {times}*{i}", f"{i}' = {over}*{v}"],
        "conditions": [f"{v}(0) = {one}", f"{v}(1) = {two}"],
    }
    circuit.add("fields", name, table, card)
    for suffix, ends, current in (("_1", (a, b), f"{i}(0)"), ("_2", (d, c), f"{i}(1)")):
        if ends[0] != ends[1]:  # not a short circuit, as at the end of a stub
            line.source(line.element(suffix), ends, current, is_voltage=False)
