r"""Mathematics in one line, set for drawings where matplotlib does not run.

Input: a text between dollar signs, as drawings write it. Output: its width, height and depth, and runs of
letters, each with its place and size. The page imports the names that drawings take from matplotlib from here
if no wheel of it lies beside the page; widths are those of its fonts, which the build measures.

    $m_{1}$    m in italics at 0, 1 upright, in 70 % of the size, a fifth of the size lower
"""

from __future__ import annotations

import contextlib
import json
import re
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType
from typing import Any, Final, NoReturn

SMALLER: Final = 0.7  # size of indices and exponents
RAISED, LOWERED = 0.38, 0.2  # of exponents and indices, as shares of the size
SPACES: Final = {
    r"\,": 0.17, r"\:": 0.22, r"\;": 0.28, r"\ ": 0.25, r"\!": -0.17, r"\quad": 1.0, "~": 0.25, " ": 0.0,
}  # fmt: skip
SIGNS: Final = {
    "cdot": "\u22c5", "times": "\u00d7", "ldots": "\u2026", "dots": "\u2026", "pm": "\u00b1",
    "infty": "\u221e",
    "partial": "\u2202", "circ": "\u2218", "degree": "\u00b0", "prime": "\u2032", "%": "%", "_": "_",
    "&": "&", "#": "#", "$": "$", "{": "{", "}": "}", "le": "\u2264", "ge": "\u2265", "approx": "\u2248",
    "to": "\u2192",
    "alpha": "\u03b1", "beta": "\u03b2", "gamma": "\u03b3", "delta": "\u03b4", "epsilon": "\u03f5",
    "varepsilon": "\u03b5", "zeta": "\u03b6", "eta": "\u03b7", "theta": "\u03b8", "vartheta": "\u03d1",
    "iota": "\u03b9", "kappa": "\u03ba", "lambda": "\u03bb", "mu": "\u03bc", "nu": "\u03bd", "xi": "\u03be",
    "pi": "\u03c0", "rho": "\u03c1", "sigma": "\u03c3", "tau": "\u03c4", "upsilon": "\u03c5", "phi": "\u03d5",
    "varphi": "\u03c6", "chi": "\u03c7", "psi": "\u03c8", "omega": "\u03c9", "Gamma": "\u0393",
    "Delta": "\u0394", "Theta": "\u0398", "Lambda": "\u039b", "Xi": "\u039e", "Pi": "\u03a0",
    "Sigma": "\u03a3", "Phi": "\u03a6", "Psi": "\u03a8", "Omega": "\u03a9", "ell": "\u2113",
}  # fmt: skip
FUNCTIONS: Final = frozenset("sin cos tan sinh cosh tanh exp log ln atan arctan min max sgn".split())
FACES: Final = {
    "mathrm": "upright", "mathit": "italic", "mathbf": "bold", "mathcal": "italic", "text": "upright",
    "operatorname": "upright", "mathsf": "upright", "mathtt": "upright", "mathregular": "upright",
}  # fmt: skip
AFTER: Final = 0.07  # space behind an index or exponent
TOUCHING: Final = 1e-9
OPERATORS: Final = "=+\u2212\u2264\u2265\u2248\u00b1\u2192\u00d7\u22c5"
_TOKEN: Final = re.compile(r"\\(?:[A-Za-z]+|.)|[^\\]", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Run:
    """Letters at a place, or a line without letters; lengths are multiples of the size, y upwards."""

    text: str
    x: float
    y: float
    width: float
    size: float
    face: str


@dataclass(frozen=True, slots=True)
class Box:
    """A text that is set."""

    runs: tuple[Run, ...]
    width: float
    height: float
    depth: float

    def moved(self, dx: float, dy: float, scale: float = 1.0) -> Box:
        """Return it elsewhere, and in another size."""
        runs = tuple(
            replace(r, x=dx + scale * r.x, y=dy + scale * r.y, width=scale * r.width, size=scale * r.size)
            for r in self.runs
        )
        return Box(runs, scale * self.width, scale * self.height + dy, scale * self.depth - dy)


EMPTY: Final = Box((), 0.0, 0.0, 0.0)


def set_line(markup: str) -> Box:
    """Return a text as it is set in size one; a ValueError if it has what is not known here."""
    tokens = _TOKEN.findall(markup.strip("$"))
    box, at = _group(tokens, 0, "", end="")
    if at != len(tokens):
        raise ValueError(markup)
    return box


def _joined(boxes: list[Box]) -> Box:
    x = 0.0
    runs: list[Run] = []
    for box in boxes:
        runs += box.moved(x, 0.0).runs
        x += box.width
    # Letters of one face that touch are one run.
    merged: list[Run] = []
    for run in runs:
        last = merged[-1] if merged else None
        if last and run.text and last.text and (last.face, last.size, last.y) == (run.face, run.size, run.y) \
                and abs(last.x + last.width - run.x) < TOUCHING:  # fmt: skip
            merged[-1] = replace(last, text=last.text + run.text, width=last.width + run.width)
        else:
            merged.append(run)
    return Box(
        tuple(merged), x, max((b.height for b in boxes), default=0), max((b.depth for b in boxes), default=0)
    )


def _group(tokens: list[str], at: int, face: str, end: str) -> tuple[Box, int]:
    boxes: list[Box] = []
    while at < len(tokens) and tokens[at] != end:
        token = tokens[at]
        if token in "_^":
            script, at = _argument(tokens, at + 1, face)
            small = script.moved(0.0, RAISED if token == "^" else -LOWERED, SMALLER)
            if at < len(tokens) and tokens[at] in "_^" and tokens[at] != token:
                other, at = _argument(tokens, at + 1, face)
                both = other.moved(0.0, -LOWERED if token == "^" else RAISED, SMALLER)
                small = Box(
                    (*small.runs, *both.runs), max(small.width, both.width),
                    max(small.height, both.height), max(small.depth, both.depth),
                )  # fmt: skip
            boxes.append(replace(small, width=small.width + AFTER))
            continue
        before = next((t for t in reversed(tokens[:at]) if t != " "), "(")
        is_sign = token in "+-" and before in "=([{"
        box, at = (_letter(_minus(token), "upright"), at + 1) if is_sign else _argument(tokens, at, face)
        boxes.append(box)
    if end and at >= len(tokens):
        raise ValueError("a brace is open")
    return _joined(boxes), at + bool(end)


def _argument(tokens: list[str], at: int, face: str) -> tuple[Box, int]:
    """Return one letter, command or group."""
    token = tokens[at]
    at += 1
    if token == "{":
        return _group(tokens, at, face, "}")
    if token in SPACES:
        blank = 0.25 if token == " " and face == "upright" else SPACES[token]
        return Box((), blank, 0.0, 0.0), at
    if token == "}":
        raise ValueError("a brace is not open")
    name = token[1:]
    if token[0] != "\\":
        return _letter(_minus(token) if face != "upright" else token, face), at
    if name in FACES:
        return _argument(tokens, at, FACES[name])
    if name in SIGNS:
        return _letter(SIGNS[name], face), at
    if name in FUNCTIONS:
        return _joined([_letter(c, "upright") for c in name]), at
    if name in ("left", "right", "displaystyle", "textstyle", "mathopen", "mathclose"):
        return EMPTY, at
    if name in ("frac", "dfrac", "tfrac"):
        return _fraction(tokens, at, face)
    if name == "sqrt":
        inner, at = _argument(tokens, at, face)
        sign = _letter("\u221a", "upright")
        rule = Run("", sign.width, inner.height + 0.06, inner.width, 1.0, "")
        joined = _joined([sign, inner])
        return Box((*joined.runs, rule), joined.width, joined.height + 0.1, joined.depth), at
    if name in ("dot", "ddot", "hat", "bar", "tilde", "vec"):
        return _argument(tokens, at, face)
    raise ValueError(token)


def _minus(token: str) -> str:
    return token.replace("-", "\u2212")


def _fraction(tokens: list[str], at: int, face: str) -> tuple[Box, int]:
    above, at = _argument(tokens, at, face)
    below, at = _argument(tokens, at, face)
    above, below = above.moved(0, 0, 0.85), below.moved(0, 0, 0.85)
    width = max(above.width, below.width) + 0.1
    up, down = 0.38 + above.depth, 0.15 - 0.28 + below.height + 0.05
    top = above.moved((width - above.width) / 2, up)
    bottom = below.moved((width - below.width) / 2, -down)
    runs = (*top.runs, Run("", 0.0, 0.27, width, 1.0, ""), *bottom.runs)
    return Box(runs, width, up + above.height, down + below.depth), at


def _letter(sign: str, face: str) -> Box:
    is_slanted = face in ("", "italic") and (sign.isalpha() and (sign.isascii() or sign.islower()))
    kind = face if face in ("upright", "bold") else "italic" if is_slanted else "upright"
    width = METRICS.get(kind, {}).get(sign, 0.5)
    beside = 0.2 if face != "upright" and sign in OPERATORS else 0.05 if sign == "," else 0.0
    height = (
        0.68
        if sign.isupper() or sign.isdigit() or sign in "bdfhklt()[]/\u03b2\u03b4\u03b8\u03bb\u221a"
        else 0.47
    )
    depth = 0.22 if sign in "gjpqy()[]/,\u03b2\u03b3\u03b7\u03bc\u03c1\u03c6\u03c7\u03c8\u03d5" else 0.01
    return Box(
        (Run(sign, beside, 0.0, width, 1.0, kind),),
        width + (1 if sign == "," else 2) * beside,
        height,
        depth,
    )


def _metrics() -> dict[str, dict[str, float]]:
    """Return the widths that the build measured, by face and letter."""
    file = Path(__file__).with_name("letters.json")
    return json.loads(file.read_text("utf-8")) if file.exists() else {}


METRICS: Final = _metrics()


# ---------------------------------------------------------------------------------------- as matplotlib


class FontProperties:
    """A size."""

    def __init__(self, *, size: float = 8.0, **_: object) -> None:
        self.size = size

    def get_size_in_points(self) -> float:
        """Return it."""
        return self.size


class MathTextParser:
    """Measures lines."""

    def __init__(self, _: str) -> None:
        pass

    def parse(self, markup: str, dpi: float = 72, prop: FontProperties | None = None) -> tuple[float, ...]:
        """Return width, height with depth, and depth, in dots."""
        box, scale = set_line(markup), (prop.size if prop else 8.0) * dpi / 72
        return box.width * scale, (box.height + box.depth) * scale, box.depth * scale


class _Lacking(ModuleType):
    """A part of matplotlib: what is asked for is there, and refuses to be used."""

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401 (of any type)
        if name.startswith("__"):
            raise AttributeError(name)
        return type(name, (), {"__init__": _refuse})


def _refuse(*_: object, **__: object) -> NoReturn:
    raise ModuleNotFoundError("No module named 'matplotlib'", name="matplotlib")


PARTS: Final = (
    "figure patches path axes artist lines ticker text transforms collections backend_bases backends gridspec"
)


def stand_in() -> None:
    """Put what is here in the place of matplotlib."""
    made = {name: _Lacking(name) for name in ["matplotlib", *(f"matplotlib.{p}" for p in PARTS.split())]}
    made["matplotlib.backends.backend_agg"] = _Lacking("matplotlib.backends.backend_agg")
    top = made["matplotlib"]
    top.__dict__.update(__path__=[], rcParams={"mathtext.fontset": "stix"}, rc_context=contextlib.nullcontext)
    for name, names in (
        ("style", {"context": lambda _: contextlib.nullcontext()}),
        ("font_manager", {"FontProperties": FontProperties}),
        ("mathtext", {"MathTextParser": MathTextParser}),
    ):
        made[f"matplotlib.{name}"] = _Lacking(name)
        made[f"matplotlib.{name}"].__dict__.update(names)
    for name, module in made.items():
        if name.count(".") == 1:
            setattr(top, name.partition(".")[2], module)
    sys.modules.update(made)
