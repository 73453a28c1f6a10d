"""SPICE netlists as specifications, as a person would have written them.

Input: the text of a netlist (.cir, .net, .sp), and how files beside it are read. Output: the text of a
specification: component values with units, nodes by name, sources of small signals as inputs, what is printed
or probed as outputs.

    RC low-pass                         title      = "RC low-pass"
    V1 in 0 AC 1                        parameters = { R1 = "10 kOhm", C1 = "4.7 nF" }
    R1 in out 10k                       inputs     = { V1 = { voltage = "in" } }
    C1 out 0 4.7n                       outputs    = { V_out = "out" }
    .print ac V(out)                    ...

The conventions are those of Berkeley SPICE 3 (Quarles et al. 1993, User's Manual): the first line is the
title, M is milli and MEG is mega, letters after a suffix are ignored, upper and lower case are alike, and a
positive current flows into the first node of a source. A source without an AC value rests: a voltage is a
short circuit, a current is open. 4k7 is 4.7k, as LTspice reads it; Berkeley's reads 4k.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from itertools import pairwise
from typing import Final

from symflex.errors import Diagnostic, Source, Span, SpecError, nearest

SUFFIXES: Final = {
    "meg": "e6", "mil": "*25.4e-6", "t": "e12", "g": "e9", "k": "e3", "m": "e-3", "u": "e-6", "µ": "e-6",
    "μ": "e-6", "n": "e-9", "p": "e-12", "f": "e-15",
}  # fmt: skip
PREFIXES: Final = {"e9": "G", "e6": "M", "e3": "k", "e-3": "m", "e-6": "u", "e-9": "n", "e-12": "p"}
NUMBER: Final = re.compile(
    r"([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d{1,3})?)(meg|mil|[tgkmunpfµμ])?([a-zµμ\u2126]*)", re.I
)
INNER: Final = re.compile(r"(\d+)(meg|[kmunpr])(\d+)", re.I)  # values such as 4k7
IN_EXPRESSION: Final = re.compile(
    r"(?<![\w.])((?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)(meg|mil|[tgkmunpfµ])?\b", re.I
)
EXPRESSION: Final = re.compile(r"[\w\s.+\-*/^()µ]*")
POWER: Final = re.compile(r"\bpow\(\s*([\w.]+)\s*,\s*(\w+)\s*\)", re.I)
BRACKETS: Final = r"\((?:[^()]|\([^()]*\))*\)"
LOG10: Final = re.compile(rf"\blog10\s*({BRACKETS})", re.I)
TOKEN: Final = re.compile(rf"{{[^}}]*}}|'[^']*'|\"[^\"]*\"|[\w/]+-?\s*{BRACKETS}|[^\s,=()]+|=")
"""Words; brackets belong to one, as in V(out) and in KiCad's Net-(R1-Pad1)."""
UNITS: Final = {"R": "Ohm", "L": "H", "C": "F"}
TYPES: Final = {"R": ("resistor", "R"), "L": ("inductor", "L"), "C": ("capacitor", "C")}
IGNORED: Final = frozenset(
    "end ends op tran dc options option temp backanno lib model ic nodeset save control endc noise meas "
    "measure width four sens pz disto step csparam title fft wave".split()
)
FIRST, LAST = (".param", ".params", ".global"), (".print", ".plot", ".probe", ".tf", ".detector")
HARMLESS: Final = frozenset(
    "ic tc tc1 tc2 noisy noiseless noisetemp noiseflow dcvar dcvarlot vinit iinit "
    "tol pwr irms ipk mfg pn type v".split()
)
"""What may stand behind the value of a component without changing its small signals."""
APART: Final = "write what it stands for as components of their own"
TAKEN: Final = frozenset(("s", "pi", "j", "ground"))
REPLACED: Final = {
    "D": ("a diode", "a resistor of U_T/I_D, 26 mV over its current"),
    "Q": ("a bipolar transistor", "G out 0 in 0 {I_C/26m} with a resistor beta*26m/I_C from base to emitter"),
    **dict.fromkeys("MJZ", ("a FET", "G drain source gate source {g_m} with a resistor r_o")),
    **dict.fromkeys("SW", ("a switch", "a resistor of the state it is in, or nothing")),
    **dict.fromkeys("TOU", ("a transmission line", "a specification with the line as [fields], x along it")),
    "B": ("a source of an arbitrary function", "E, F, G or H with its slope at the operating point"),
    "A": ("a digital or special function", "E with its gain"),
}
OP_AMPS: Final = {4: re.compile(r"universalopamp\w*|level\.?[12]\w*"), 2: re.compile("opamp")}
"""The op-amps of LTspice, by the place of their output among their nodes; level 3 has a second pole."""
MOST_DEPTH: Final = 20
MOST_LINES: Final = 20_000


@dataclass(frozen=True)
class Card:
    """One statement, with its place."""

    words: tuple[str, ...]
    span: Span
    comment: str

    def refuse(self, message: str, hint: str | None = None) -> SpecError:
        """Return the error that says what is wrong with it."""
        return SpecError(Diagnostic("SF105", message, self.span, hint))


@dataclass
class Circuit:
    """What has been read."""

    parameters: dict[str, str] = field(default_factory=dict)
    definitions: dict[str, str] = field(default_factory=dict)
    elements: list[tuple[str, str, str]] = field(default_factory=list)  # name, table, comment
    inputs: dict[str, str] = field(default_factory=dict)
    outputs: dict[str, str] = field(default_factory=dict)
    sources: list[tuple[str, str, tuple[str, str], str]] = field(default_factory=list)  # nodes, "ac"
    nodes: dict[str, str] = field(default_factory=dict)
    band: str = ""
    comments: list[str] = field(default_factory=list)


def specification_of(source: Source, read: Callable[[str], Source]) -> str:
    """Return the text of a specification; SF105 for a line that cannot be read. ``read`` reads others."""
    title, lines, comments = _statements(source)
    reader = _Netlist(read, {})
    reader.circuit.comments = comments
    body = reader.without_subcircuits(lines, 0)
    scope = _Scope("", {}, {})
    assigned = [w for x in body if x.words[0].lower() in (".param", ".params") for w in pairwise(x.words)]
    reader.given = {w.lower(): w + "_" * (w in TAKEN) for w, after in assigned if after == "="}
    named = {re.sub(r"\W", "_", w) for line in body if (w := line.words[0])[0].upper() in "RLCEFGH"}
    reader.names = named | set(reader.given.values())
    for line in sorted(body, key=lambda x: (x.words[0].lower() in LAST) - (x.words[0].lower() in FIRST)):
        reader.statement(line, scope, 0)
    reader.couple()
    return _written(title, reader.finished(lines))


def _statements(source: Source) -> tuple[str, list[Card], list[str]]:
    """Return the title, the statements with continuations joined, and comments that stand alone."""
    statements: list[tuple[str, int, int, str]] = []
    comments: list[str] = []
    title, offset, in_control = "", 0, False
    for number, whole in enumerate(source.text.splitlines(keepends=True)):
        start, offset = offset, offset + len(whole)
        text = whole.strip()
        if number == 0:
            title = text.lstrip("*").strip()
            words = text.split()
            if len(words) > 3 and re.fullmatch(r"[RLC]\w*", words[0], re.I) and NUMBER.fullmatch(words[3]):  # noqa: PLR2004
                hint = "SPICE takes the first line for the title: begin with one, or with a line '*'"
                message = "the first line looks like a component and would be left out"
                raise SpecError(Diagnostic("SF105", message, Span(source, start, start + len(text)), hint))
            continue
        if number > MOST_LINES:
            hint = "leave out what is not needed, or split the circuit"
            raise SpecError(Diagnostic("SF103", f"a netlist has at most {MOST_LINES} lines", None, hint))
        if re.match(r"\.end\b", text, re.I):
            break
        if re.match(r"\.control\b", text, re.I):
            in_control = True
        if text.startswith("*") or not text or in_control:
            if text.startswith("*") and text.strip("* "):
                comments.append(text.strip("* "))
            in_control = in_control and not re.match(r"\.endc\b", text, re.I)
            continue
        code, _, comment = (*re.split(r"(;|\s\$\s|//)", text, maxsplit=1), "", "")[:3]
        if code[:1].upper() in "EFGH":  # nodes may be in brackets
            code = re.sub(r"(?<=\s)\(([^(){}'=]*)\)", r" \1 ", code)
        if code.startswith("+") and statements:
            before, first, _, remark = statements[-1]
            statements[-1] = (f"{before} {code[1:]}", first, start + len(text), remark or comment.strip())
        elif code.strip():
            first = start + len(whole) - len(whole.lstrip())
            statements.append((code.strip(), first, first + len(code.strip()), comment.strip()))
    lines = [Card(tuple(TOKEN.findall(code)), Span(source, a, b), c) for code, a, b, c in statements]
    return title, [line for line in lines if line.words], comments


@dataclass(frozen=True)
class _Scope:
    """A subcircuit's instance: what its names begin with, its nodes, and its own parameters."""

    prefix: str
    nodes: Mapping[str, str]
    parameters: Mapping[str, str]


class _Netlist:
    def __init__(
        self, read: Callable[[str], Source], subcircuits: dict[str, tuple[Card, list[Card]]]
    ) -> None:
        self.read, self.subcircuits = read, subcircuits
        self.circuit = Circuit()
        self.windings: dict[str, tuple[str, tuple[str, str], str]] = {}  # by name: nodes and value
        self.couplings: list[tuple[Card, str, tuple[str, str], str]] = []
        self.sensed: dict[str, str] = {}
        self.names: set[str] = set()  # which nodes do not take: those of parameters and values
        self.given: dict[str, str] = {}  # names of .param, by those in small letters
        self.shared: set[str] = set()  # nodes of .global

    def without_subcircuits(self, lines: Sequence[Card], depth: int) -> list[Card]:
        """Return the statements outside of subcircuits, which are kept by name, with included files."""
        body: list[Card] = []
        inner: list[Card] = []
        head: Card | None = None
        level = 0
        for line in lines:
            word = line.words[0].lower()
            if word == ".subckt":
                level += 1
                if level == 1:
                    head, inner = line, []
                    continue
            if word == ".ends" and level:
                level -= 1
                if level == 0 and head is not None and len(head.words) > 1:
                    self.subcircuits[head.words[1].lower()] = (head, inner)
                    continue
            if level:
                inner.append(line)
            elif word in (".include", ".inc"):
                body += self._included(line, depth)
            else:
                body.append(line)
        if level and head is not None:
            raise head.refuse("this subcircuit has no .ends", "close it with a line .ends")
        return body

    def _included(self, line: Card, depth: int) -> list[Card]:
        if depth >= MOST_DEPTH or len(line.words) < 2:  # noqa: PLR2004
            raise line.refuse("files include each other" if depth else "a file's name is missing")
        name = line.words[1].strip("\"'")
        try:
            source = self.read(name)
        except SpecError as error:
            raise line.refuse(f"'{name[:80]}' is not included: {error.diagnostics[0].message}") from None
        _, lines, _ = _statements(Source(source.name, "\n" + source.text))
        return self.without_subcircuits(lines, depth + 1)

    def statement(self, line: Card, scope: _Scope, depth: int) -> None:
        """Take one statement."""
        word = line.words[0]
        if word.startswith("."):
            self._directive(line, scope)
            return
        letter = word[0].upper()
        if letter in REPLACED:
            what, hint = REPLACED[letter]
            raise line.refuse(
                f"'{word[:40]}' is {what}: it is not linear, or has no formula", f"replace it by {hint}"
            )
        if letter == "X":
            self._instance(line, scope, depth)
        elif letter == "K":
            self._coupling(line, scope)
        elif letter in "RLC":
            kind, key = TYPES[letter]
            name, ends = self._name(line.words[0], scope), self._nodes(line, scope, 1, 2)
            value = self._valued(line, name, self._last(line, 3, letter), scope, UNITS[letter])
            if letter == "L":
                self.windings[name.lower()] = (name, (ends[0], ends[1]), value)
            self._add(name, f'type = "{kind}", between = {_texts(ends)}, {key} = "{value}"', line)
        elif letter in "VI":
            self._source(line, scope, letter)
        elif letter in "EFGHN":
            self._controlled(line, scope, letter)
        else:
            raise line.refuse(
                f"'{word[:40]}' is not a SPICE component",
                "a name begins with R, L, C, V, I, E, F, G, H, K or X",
            )

    def _name(self, word: str, scope: _Scope) -> str:
        return scope.prefix + re.sub(r"\W", "_", word)

    def _node(self, word: str, scope: _Scope) -> str:
        key = word.lower()
        if key in ("0", "gnd"):
            return "ground"
        if key in scope.nodes:
            return scope.nodes[key]
        prefix = "" if key in self.shared or key.startswith("$g_") else scope.prefix
        key = prefix.lower() + key
        if key not in self.circuit.nodes:
            name = re.sub(r"\W", "_", prefix + word)
            name = f"n{name}" if not name[0].isalpha() else name
            taken = {*self.circuit.nodes.values(), *TAKEN}
            while name in taken or name in self.names:
                name += "_"
            self.circuit.nodes[key] = name
        return self.circuit.nodes[key]

    def _nodes(self, line: Card, scope: _Scope, first: int, count: int) -> tuple[str, ...]:
        words = line.words[first : first + count]
        if len(words) < count or any("=" in w for w in words):
            raise line.refuse(f"'{line.words[0][:40]}' needs {count} nodes")
        return tuple(self._node(w, scope) for w in words)

    def _value(self, line: Card, text: str, scope: _Scope, unit: str = "") -> str:
        """Return a value as a quantity or an expression of parameters."""
        text = text.strip()
        if text[:1] in "{'\"":
            return self._expression(line, text[1:-1], scope)
        if inner := INNER.fullmatch(text):
            text = f"{inner[1]}.{inner[3]}{'' if inner[2].lower() == 'r' else inner[2]}"
        match = NUMBER.fullmatch(text)
        if match is None:
            if re.fullmatch(r"[A-Za-z_]\w*", text):
                return self._expression(line, text, scope)
            hint = "write a number with a suffix, 4.7k or 10meg, or an expression in braces, {2*R}"
            raise line.refuse(f"'{text[:60]}' is not a value", hint)
        return _quantity(match[1], (match[2] or "").lower(), unit)

    def _expression(self, line: Card, text: str, scope: _Scope) -> str:
        text = POWER.sub(r"(\1^\2)", text.replace("**", "^").strip())
        if not EXPRESSION.fullmatch(text) or not text:
            hint = "expressions have numbers, parameters, + - * / ^ and functions of one argument"
            raise line.refuse(f"'{text[:60]}' is not an expression that can be read", hint)
        text = IN_EXPRESSION.sub(lambda m: m[1] + SUFFIXES.get((m[2] or "").lower(), ""), text)
        text = re.sub(r"\bln\s*\(", "log(", LOG10.sub(r"(log\1/log(10))", text), flags=re.I)

        def named(match: re.Match[str]) -> str:
            if (name := match[0]).lower() not in {*scope.parameters, *self.given, "pi"}:
                hint = nearest(name, self.given) or f"define it: .param {name[:40]}=1k"
                raise line.refuse(f"unknown parameter '{name[:40]}'", hint)
            return scope.parameters.get(name.lower(), self._known(name))

        return re.sub(r"(?<![\w.])[A-Za-z_]\w*(?!\s*\()(?![\w.])", named, text)

    def _known(self, name: str) -> str:
        """Return a parameter's name as it was first written."""
        return self.given.get(name.lower(), "pi" if name.lower() == "pi" else name)

    def _valued(self, line: Card, name: str, text: str, scope: _Scope, unit: str) -> str:
        """Return a parameter of the component's name for a number, or the expression that is its value."""
        value = self._value(line, text, scope, unit)
        if NUMBER.fullmatch(text) or INNER.fullmatch(text):
            while name.lower() in self.given:
                name += "_"
            self.circuit.parameters[name] = value
            return name
        return value

    def _last(self, line: Card, at: int, letter: str) -> str:
        """Return the value from this word on, as in ``R=1k``; refuse what would change it."""
        rest = list(line.words[at:])
        while rest and (rest[0] == "=" or rest[0].upper() in (letter, "VALUE")):
            rest = rest[1:]
        if not rest:
            raise line.refuse(f"'{line.words[0][:40]}' has no value", "write the nodes, then the value")
        absent = {k for k, v in _assigned(["", *rest]).items() if k[0] in "rlc" and not v.strip("0.")}
        has_tc = "tc" in (low := [w.lower() for w in rest])
        for before, word in pairwise(low):
            is_read = "=" in (before, word) or (has_tc and NUMBER.fullmatch(word))
            extra = before if word == "=" else word
            if (not is_read or word == "=") and extra not in HARMLESS | absent:
                hint = "write the nodes, then one value, with a decimal point"
                hint = APART if extra[0].isalpha() else hint
                raise line.refuse(f"'{extra[:40]}' of '{line.words[0][:40]}' is not read", hint)
        return rest[0]

    def _add(self, name: str, table: str, line: Card) -> None:
        if any(n.lower() == name.lower() for n, _, _ in self.circuit.elements):
            raise line.refuse(f"there are two components '{name}'")
        self.circuit.elements.append((name, table, line.comment))

    def _source(self, line: Card, scope: _Scope, letter: str) -> None:
        name, ends = self._name(line.words[0], scope), self._nodes(line, scope, 1, 2)
        rest = [w.lower() for w in line.words[3:]]
        if extra := {"rser", "cpar", "z0", "portnum"}.intersection(rest):
            raise line.refuse(f"'{min(extra)}' of '{line.words[0][:40]}' is not read", APART)
        is_ac = any(w == "ac" or w.startswith("ac(") for w in rest)
        moves = any(re.match(r"(sin|sine|pulse|pwl|exp|sffm|wave\w*)\b", w) for w in rest)
        pair = (ends[0], ends[1])
        self.circuit.sources.append((name, letter, pair, "ac" if is_ac else "moves" if moves else "rests"))

    def _control(self, line: Card, scope: _Scope, word: str) -> str:
        """Return the current through a voltage source, into its first node, as SPICE counts it."""
        name = self._name(word, scope)
        self.sensed[name.lower()] = word
        return f"(-{name}.i)"

    def _controlled(self, line: Card, scope: _Scope, letter: str) -> None:
        name, words = self._name(line.words[0], scope), line.words
        ends = self._nodes(line, scope, 1, 2)
        rest = words[3:]
        low = [w.lower() for w in rest]
        if letter == "N" or (low and low[0] == "opamp"):
            at = 3 + (letter != "N")
            plus, minus = self._nodes(line, scope, at, 2)
            gain = self._last(line, at + 2, letter) if words[at + 2 :] not in ((), ("N",)) else ""
            self._op_amp(line, name, (plus, minus), ends, self._value(line, gain, scope) if gain else "")
            return
        odd = re.match(r"(poly|table|value|laplace|freq)\b.*", low[0]) if low else None
        named = [w for w, after in pairwise(low) if after == "=" and w in ("laplace", "vol", "cur", "v", "i")]
        if odd or named:
            what = named[0] if named else low[0][:40]
            hint = "write a constant gain; a block may replace it in the file of 'symflex new --from'"
            raise line.refuse(f"'{words[0][:40]}' has a function that is not read: {what}", hint)
        inputs: tuple[str, ...] = ()
        current, at = "", 5
        if letter in "EG":
            inputs = self._nodes(line, scope, 3, 2)
        elif rest:
            current, at = self._control(line, scope, rest[0]), 4
        unit = {"E": "", "F": "", "G": "A/V", "H": "Ohm"}[letter]
        gain = self._valued(line, name, self._last(line, at, letter), scope, unit)
        factor = _grouped(gain)
        back = (ends[1], ends[0])  # a positive current flows from the first node through the source
        match letter:
            case "E":
                table = f'type = "vcvs", inputs = {_texts(inputs)}, terminals = {_texts(ends)}, mu = "{gain}"'
            case "G":
                table = f'type = "vccs", inputs = {_texts(inputs)}, terminals = {_texts(back)}, g = "{gain}"'
            case "F":
                table = f'type = "current_source", between = {_texts(back)}, i = "{factor}*{current}"'
            case _:
                table = f'type = "voltage_source", between = {_texts(ends)}, v = "{factor}*{current}"'
        self._add(name, table, line)

    def _op_amp(
        self, line: Card, name: str, inputs: tuple[str, str], ends: Sequence[str], gain: str, more: str = ""
    ) -> None:
        if ends[1] != "ground":
            raise line.refuse(f"the output of '{name}' is not against ground", "write its second node as 0")
        a = f', A = "{gain}"' if gain else ""
        self._add(name, f'type = "op_amp", inputs = {_texts(inputs)}, out = "{ends[0]}"{a}{more}', line)

    def _coupling(self, line: Card, scope: _Scope) -> None:
        if len(line.words) < 4 or line.words[3][:1] in "Ll":  # noqa: PLR2004
            raise line.refuse("a coupling names two inductors and its factor: K1 L1 L2 0.98")
        one, two = (self._name(w, scope) for w in line.words[1:3])
        factor = self._value(line, self._last(line, 3, "K"), scope)
        self.couplings.append((line, self._name(line.words[0], scope), (one, two), factor))

    def couple(self) -> None:
        """Replace coupled inductors by pairs of windings."""
        coupled: set[str] = set()
        for line, name, pair, factor in self.couplings:
            if any(p.lower() not in self.windings for p in pair):
                missing = next(p for p in pair if p.lower() not in self.windings)
                raise line.refuse(
                    f"there is no inductor '{missing}'",
                    nearest(missing, [w for w, _, _ in self.windings.values()]),
                )
            if coupled & {p.lower() for p in pair}:
                raise line.refuse("three windings on one core are not read", "couple inductors in pairs")
            coupled |= {p.lower() for p in pair}
            (first, a, l_1), (second, b, l_2) = (self.windings[p.lower()] for p in pair)
            self.circuit.elements = [e for e in self.circuit.elements if e[0] not in (first, second)]
            is_number = [x not in self.circuit.parameters for x in (l_1, l_2)]
            if any(is_number):  # an expression has no unit
                self.circuit.parameters["one_H"] = "1 H"
            both = [_grouped(x) + "*one_H" * bare for x, bare in zip((l_1, l_2), is_number, strict=True)]
            mutual = f"{_grouped(factor)}*sqrt({'*'.join(both)})"
            table = f'type = "coupled_inductors", terminals = {_texts((*a, *b))}, '
            self._add(name, table + f'L_1 = "{l_1}", L_2 = "{l_2}", M = "{mutual}"', line)

    def _instance(self, line: Card, scope: _Scope, depth: int) -> None:
        if depth >= MOST_DEPTH:
            raise line.refuse("subcircuits contain each other")
        words = list(line.words)
        given = _assigned(words)
        words = [w for w in _before_assignments(words) if w.lower() not in ("params:", "param:")]
        if len(words) < 2:  # noqa: PLR2004
            raise line.refuse(f"'{line.words[0][:40]}' names no subcircuit")
        kind = words[-1].lower()
        name = self._name(words[0], scope)
        if kind not in self.subcircuits:
            if any(len(words) == at + 3 and names.fullmatch(kind) for at, names in OP_AMPS.items()):
                self._library_op_amp(line, words, name, scope, given)
                return
            hint = (
                nearest(kind, self.subcircuits) or "write its .subckt into the netlist, or include its file"
            )
            raise line.refuse(f"the subcircuit '{words[-1][:60]}' is not in the netlist", hint)
        head, inner = self.subcircuits[kind]
        if "m" in given and "m" not in _assigned(list(head.words)):
            raise line.refuse(f"m copies of '{words[0][:40]}' are not read", "write each of them")
        pins = [
            w for w in _before_assignments(list(head.words))[2:] if w.lower() not in ("params:", "param:")
        ]
        outer = words[1:-1]
        if len(pins) != len(outer):
            raise line.refuse(f"'{words[-1][:60]}' has {len(pins)} pins, and {len(outer)} nodes are given")
        nodes = {p.lower(): self._node(w, scope) for p, w in zip(pins, outer, strict=True)}
        local: dict[str, str] = {}
        for key, text in {**_assigned(list(head.words)), **given}.items():
            own = scope if key in given else _Scope("", {}, local)
            local[key] = _grouped(self._value(line, text, own))
        inside = _Scope(f"{name}_", nodes, {**scope.parameters, **local})
        outside = dict(self.subcircuits)
        body = self.without_subcircuits(inner, depth + 1)
        for each in body:
            if each.words[0].lower() in (".param", ".params"):
                for key, text in _assigned(list(each.words)).items():
                    local[key] = _grouped(self._value(each, text, inside))
                inside = _Scope(f"{name}_", nodes, {**scope.parameters, **local})
        for each in body:
            if not each.words[0].lower().startswith(".param"):
                self.statement(each, inside, depth + 1)
        self.subcircuits = outside

    def _library_op_amp(
        self, line: Card, words: Sequence[str], name: str, scope: _Scope, given: Mapping[str, str]
    ) -> None:
        """Take an op-amp of LTspice's library: with supplies in+, in-, V+, V-, out; without in-, in+, out."""
        known = "avol aol gbw rin rout slew ilimit rail vos phimargin en enk in ink"  # from slew on nonlinear
        if odd := given.keys() - known.split():
            raise line.refuse(f"'{min(odd)[:40]}' of '{words[0][:40]}' is not read", APART)
        plus, minus, last = (1, 2, 5) if len(words) == 7 else (2, 1, 3)  # noqa: PLR2004 (name, 5 nodes, type)
        inputs = (self._node(words[plus], scope), self._node(words[minus], scope))
        out = self._node(words[last], scope)
        inner = self._node(f"{words[0]} out", scope) if "rout" in given else out
        for key, part, ends in (("rin", f"{name}_rin", inputs), ("rout", f"{name}_rout", (inner, out))):
            if key in given:
                value = self._valued(line, part, given[key], scope, "Ohm")
                self._add(part, f'type = "resistor", between = {_texts(ends)}, R = "{value}"', line)
        text, band = given.get("avol", given.get("aol", "")), given.get("gbw", "")
        gain = self._value(line, text, scope) if text else ""
        more = f', f_u = "{self._value(line, band, scope, "Hz")}"' if band else ""
        self._op_amp(line, name, inputs, (inner, "ground"), gain, more)

    def _directive(self, line: Card, scope: _Scope) -> None:
        word = line.words[0][1:].lower()
        if word in ("param", "params"):
            for key, text in _assigned(list(line.words)).items():
                value = self._value(line, text, scope)
                name = self.given.get(key, key)
                is_number = re.fullmatch(r"[-+.\de]+", value, re.I) is not None
                (self.circuit.parameters if is_number else self.circuit.definitions)[name] = value
        elif word == "global":
            self.shared |= {w.lower() for w in line.words[1:]}
        elif word == "source":  # SLiCAP
            self.sensed.setdefault("", line.words[-1])
        elif word == "ac":
            ends = [self._value(line, w, scope, "Hz") for w in line.words[3:5] if NUMBER.fullmatch(w)]
            if len(set(ends)) == 2:  # noqa: PLR2004
                self.circuit.band = f"band = {_texts(ends)}"
        elif f".{word}" in LAST:
            asked = line.words[1:] if word != "tf" else line.words[1:2]
            for w in asked:
                self._output(line, w, scope)
            if word == "tf" and len(line.words) > 2:  # noqa: PLR2004
                self.sensed.setdefault("", line.words[2])
        elif word not in IGNORED:
            hint = nearest(word, [*IGNORED, "param", "ac", "print", "tf", "include", "subckt"])
            hint = "write the expression where it is used" if word == "func" else hint
            raise line.refuse(f"'.{word[:40]}' is not a directive that is read", hint)

    def _output(self, line: Card, word: str, scope: _Scope) -> None:
        word = re.sub(r"^([VI])_(\w+)$", r"\1(\2)", word)  # as SLiCAP names them
        match = re.fullmatch(r"(v|vm|vdb|vp|i|im)\s*\((.*)\)", word, re.I)
        if match is None:
            return
        names = [w for w in re.split(r"[\s,]+", match[2].strip()) if w]
        if match[1][0].lower() == "v" and len(names) in (1, 2):
            if lost := next((w for w in names if w.lower() not in {*self.circuit.nodes, "0", "gnd"}), ""):
                raise line.refuse(f"no component touches '{lost[:40]}'", nearest(lost, self.circuit.nodes))
            nodes = [self._node(w, scope) for w in names]
            shown = [n for n in nodes if n != "ground"]
            sign = "-" if nodes[0] == "ground" else ""
            if shown:
                self.circuit.outputs["V_" + "_".join(shown)] = sign + " - ".join(shown)
        elif len(names) == 1:
            self.circuit.outputs[f"I_{self._name(names[0], scope)}"] = f"{self._name(names[0], scope)}.i"

    def finished(self, lines: Sequence[Card]) -> Circuit:
        """Return the circuit with its sources as inputs, or at rest, and with outputs."""
        circuit = self.circuit
        wanted = self.sensed.get("", "").lower()
        acting = [x for x in circuit.sources if x[0].lower() == wanted] if wanted else []
        acting = acting or [x for x in circuit.sources if x[3] == "ac"]
        acting = acting or [x for x in circuit.sources if x[3] == "moves"] or circuit.sources
        if not acting:
            where = lines[0] if lines else None
            message = "a netlist needs a source, V or I, for its input, such as V1 in 0 AC 1"
            raise SpecError(Diagnostic("SF105", message, where.span if where else None))
        known = {x[0].lower() for x in circuit.sources}
        for key, word in self.sensed.items():
            if key and key not in known:
                raise SpecError(
                    Diagnostic("SF105", f"no voltage source '{word}' measures a current", lines[0].span)
                )
        kinds = {x[0]: x[1] for x in circuit.sources}
        for name, letter, (a, b), _ in circuit.sources:
            ends = f'"{a}"' if b == "ground" else _texts((a, b))
            if any(name == x[0] for x in acting):
                back = f'{{ current = "{b}" }}' if a == "ground" else f"{{ current = {_texts((b, a))} }}"
                circuit.inputs[name] = f"{{ voltage = {ends} }}" if letter == "V" else back
            elif letter == "V":
                key = "at" if b == "ground" else "between"
                circuit.elements.append((name, f'type = "voltage_source", {key} = {ends}, v = 0', "at rest"))
        for key, text in list(circuit.outputs.items()):
            name = text.removesuffix(".i")
            if text.endswith(".i") and kinds.get(name) == "V":
                circuit.outputs[key] = f"-{text}"  # SPICE counts it into the first node
        if not circuit.outputs:
            driven = {x[2][0] for x in circuit.sources if x[1] == "V"}
            circuit.outputs = {f"V_{n}": n for n in circuit.nodes.values() if n not in driven}
        return circuit


def _grouped(value: str) -> str:
    """Return a value that may stand in a product."""
    return value if re.fullmatch(r"[\w.]+", value) else f"({value})"


def _assigned(words: Sequence[str]) -> dict[str, str]:
    """Return what is assigned in ``A=1 B = {2*A}``, by the names in small letters."""
    found = {}
    for i, word in enumerate(words[1:-1], 1):
        if word == "=":
            found[words[i - 1].lower()] = words[i + 1]
    return found


def _before_assignments(words: Sequence[str]) -> list[str]:
    return list(words[: words.index("=") - 1] if "=" in words else words)


def _quantity(digits: str, suffix: str, unit: str) -> str:
    """Return a number with its suffix as a quantity with a prefixed unit, exactly."""
    power = SUFFIXES.get(suffix, "")
    digits = digits.lstrip("+")
    if ("e" in digits.lower() and power) or power.startswith("*"):
        factor = power.removeprefix("*") if "*" in power else "1" + (power or "e0")
        digits, power = str(Decimal(digits) * Decimal(factor)), ""
    if not unit:
        return f"{digits}{power}"
    prefix = PREFIXES.get(power, "")
    return f"{digits} {prefix}{unit}" if prefix or not power else f"{digits}{power} {unit}"


def _texts(words: Sequence[str]) -> str:
    return "[" + ", ".join(f'"{w}"' for w in words) + "]"


def _written(title: str, circuit: Circuit) -> str:
    """Return the specification."""
    lines = [f"# {c}" for c in circuit.comments]
    lines += ["symflex = 1", f"title   = {_quoted(title or 'circuit')}"]

    def section(name: str, entries: Iterator[tuple[str, str]]) -> None:
        rows = list(entries)
        if rows:
            width = max(len(key) for key, _ in rows)
            lines.extend(["", f"[{name}]", *(f"{key.ljust(width)} = {text}" for key, text in rows)])

    quoted = ((n, f'"{v}"' if " " in v else v) for n, v in circuit.parameters.items())
    real = ', assume = "real" }'  # what is negative, or zero
    section(
        "parameters", ((n, f"{{ value = {v}{real}" if re.match('"?-|[^1-9]*$', v) else v) for n, v in quoted)
    )
    section("definitions", ((n, f'"{v}"') for n, v in circuit.definitions.items()))
    section(
        "elements", ((n, f"{{ {t} }}" + (f"  # {_plain(c)}" if c else "")) for n, t, c in circuit.elements)
    )
    section("inputs", iter(circuit.inputs.items()))
    section("outputs", ((n, f'"{e}"') for n, e in circuit.outputs.items()))
    if circuit.band:
        lines += ["", "[analysis]", circuit.band]
    return "\n".join(lines) + "\n"


def _plain(text: str) -> str:
    return "".join(c for c in text if c.isprintable())


def _quoted(text: str) -> str:
    return '"' + _plain(text).replace("\\", "\\\\").replace('"', '\\"') + '"'
