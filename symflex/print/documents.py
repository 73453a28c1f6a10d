"""Formulas for Typst and for Word: the MathML of pages, translated element by element.

Input: transfer functions with their printed forms. Output: Typst mathematics, or Office Math (OMML).

    <mfrac><mi>k</mi><mrow><mi>m</mi>...</mrow></mfrac>    frac(k, m s^(2))    <m:f><m:num>...</m:f>

Word takes OMML in a document's XML; Typst takes the text between dollar signs. Sources: Typst 0.13 reference,
"Math"; ISO/IEC 29500-1:2016, section 22.1.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final
from xml.etree import ElementTree
from xml.etree.ElementTree import Element
from xml.sax.saxutils import escape

from symflex.print.forms import PrintedForm
from symflex.print.mathml import MathRow, transfer_function_mathml
from symflex.transfer import AnyTransferFunction

INVISIBLE: Final = ("\u2061", "\u2062")
NAMESPACE: Final = "http://schemas.openxmlformats.org/officeDocument/2006/math"
ACCENTS: Final = {
    "¯": "macron",
    "^": "hat",
    "ˆ": "hat",
    "~": "tilde",
    "˜": "tilde",
    "˙": "dot",
    "¨": "dot.double",
    "→": "arrow",
}
FUNCTIONS: Final = frozenset("cosh sinh tanh cos sin tan exp log ln coth arctan".split())
TYPST_SIGNS: Final = {
    "−": "-",
    "⋅": "dot.op",
    "/": "slash",
    ",": "\\,",
    "|": "\\|",
    "′": "prime",
    "″": "prime.double",
    "‴": "prime.triple",
}
LINE_SIGNS: Final = 60  # signs on a line of Typst, which takes some 16 cm
LONG: Final = "a formula this long is not written"


def typst(tf: AnyTransferFunction, form: PrintedForm) -> str:
    """Return a transfer function as displays of Typst: ``$ frac(y (s), u (s)) &= frac(k, s) $``, where ..."""
    return typst_rows(transfer_function_mathml(tf, form))


def typst_rows(rows: Sequence[MathRow] | None) -> str:
    """Return equations as aligned displays of Typst, in lines; None is one that is too long."""
    own = [r for r in rows or () if not r.is_where]
    displays = [_typst_display(own) if rows is not None else f"$ {_typst(_too_long())} $"]
    if below := [r for r in rows or () if r.is_where]:
        displays += ["where", _typst_display(below)]
    return "\n".join(displays)


def _typst_display(rows: Sequence[MathRow]) -> str:
    """Return equations aligned at their equals signs, further lines of long ones indented."""
    lines = []
    for row in rows:
        broken: list[list[str]] = [[]]
        for piece in row.pieces:
            if broken[-1] and _signs("".join(broken[-1])) + _signs(piece) > LINE_SIGNS:
                broken.append([])
            broken[-1].append(piece)
        first, *more = (_typst(_read("".join(line))) for line in broken)
        lines += [f"{_typst(_read(row.left))} &= {first}", *(f"& quad quad {line}" for line in more)]
    return "$ " + " \\\n  ".join(lines) + " $"


def _signs(markup: str) -> int:
    """Return about how many signs markup shows."""
    return len("".join(_read(markup).itertext()))


def omml(tf: AnyTransferFunction, form: PrintedForm) -> str:
    """Return a transfer function as a paragraph of Office Math, one ``m:oMath`` a row."""
    return omml_rows(transfer_function_mathml(tf, form))


def omml_rows(rows: Sequence[MathRow] | None) -> str:
    """Return equations as a paragraph of Office Math; None is one that is too long."""
    equals = _run("=")
    spelt = (f"<m:oMath>{left}{equals}{right}</m:oMath>" for left, right in _sides(rows, _omml))
    return f'<m:oMathPara xmlns:m="{NAMESPACE}">' + "\n".join(spelt) + "</m:oMathPara>"


def _sides(rows: Sequence[MathRow] | None, spell: Callable[[Element], str]) -> list[tuple[str, str]]:
    if rows is None:
        return [(spell(_too_long()), spell(_too_long()))]
    return [(spell(_read(row.left)), spell(_read("".join(row.pieces)))) for row in rows]


def _too_long() -> Element:
    """Return what stands for a formula that is not written."""
    return ElementTree.fromstring(f"<mtext>{LONG}</mtext>")


def _read(markup: str) -> Element:
    """Return the tree of our own markup."""
    return ElementTree.fromstring(f"<mrow>{markup}</mrow>")


def _typst(node: Element) -> str:
    text, inner = node.text or "", [_typst(child) for child in node]
    match node.tag:
        case "mi" if len(text) > 1:
            return (
                text
                if text in FUNCTIONS
                else _upright(text)
                if node.get("class") != "it"
                else f'italic("{text}")'
            )
        case "mi":
            own = f'upright("{text}")' if node.get("mathvariant") == "normal" else text
            return own
        case "mn":
            return text
        case "mtext":
            return _upright(text)
        case "mo":
            return "" if text in INVISIBLE else TYPST_SIGNS.get(text, text)
        case "mfrac":
            return f"frac({inner[0]}, {inner[1]})"
        case "msqrt":
            return f"sqrt({' '.join(filter(None, inner))})"
        case "msup":
            return f"{inner[0]}^({inner[1]})"
        case "msub":
            return f"{inner[0]}_({inner[1]})"
        case "msubsup":
            return f"{inner[0]}_({inner[1]})^({inner[2]})"
        case "mover":
            return f"accent({inner[0]}, {ACCENTS.get((node[1].text or '').strip(), 'macron')})"
        case "mtable":
            return "; ".join(", ".join(map(_typst, line)) for line in node)
    if any(child.tag == "mtable" for child in node):
        return f"mat({inner[1]})"
    return " ".join(filter(None, inner)).replace("( ", "(").replace(" )", ")")


def _upright(text: str) -> str:
    plain = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'upright("{plain}")'


def _omml(node: Element) -> str:
    inner = [_omml(child) for child in node]
    match node.tag:
        case "mi" | "mn" | "mtext" | "mo":
            text = node.text or ""
            upright = (
                node.tag == "mtext"
                or node.get("mathvariant") == "normal"
                or (node.tag == "mi" and len(text) > 1)
            )
            return "" if text in INVISIBLE else _run(text, is_upright=upright and node.get("class") != "it")
        case "mfrac":
            return f"<m:f><m:num>{inner[0]}</m:num><m:den>{inner[1]}</m:den></m:f>"
        case "msqrt":
            hidden = '<m:radPr><m:degHide m:val="1"/></m:radPr><m:deg/>'
            return f"<m:rad>{hidden}<m:e>{''.join(inner)}</m:e></m:rad>"
        case "msup":
            return f"<m:sSup><m:e>{inner[0]}</m:e><m:sup>{inner[1]}</m:sup></m:sSup>"
        case "msub":
            return f"<m:sSub><m:e>{inner[0]}</m:e><m:sub>{inner[1]}</m:sub></m:sSub>"
        case "msubsup":
            parts = zip(("e", "sub", "sup"), inner, strict=True)
            return f"<m:sSubSup>{''.join(f'<m:{k}>{part}</m:{k}>' for k, part in parts)}</m:sSubSup>"
        case "mtable":
            lines = ("".join(f"<m:e>{_omml(cell)}</m:e>" for cell in line) for line in node)
            return f"<m:m>{''.join(f'<m:mr>{line}</m:mr>' for line in lines)}</m:m>"
        case "mover":
            sign = escape((node[1].text or "").strip(), {'"': "&quot;"})
            return f'<m:acc><m:accPr><m:chr m:val="{sign}"/></m:accPr><m:e>{inner[0]}</m:e></m:acc>'
    if len(node) > 2 and node[0].get("form") == "prefix" and node[-1].get("form") == "postfix":  # noqa: PLR2004
        left, right = (escape(node[i].text or "") for i in (0, -1))
        signs = f'<m:begChr m:val="{left}"/><m:endChr m:val="{right}"/>'
        return f"<m:d><m:dPr>{signs}</m:dPr><m:e>{''.join(inner[1:-1])}</m:e></m:d>"
    return "".join(inner)


def _run(text: str, *, is_upright: bool = False) -> str:
    style = '<m:rPr><m:sty m:val="p"/></m:rPr>' if is_upright else ""
    return f"<m:r>{style}<m:t>{escape(text)}</m:t></m:r>"


def typst_document(title: str, entries: Sequence[tuple[AnyTransferFunction, PrintedForm]]) -> str:
    """Return a document that Typst compiles as it stands."""
    page = "#set page(width: auto, height: auto, margin: 1cm)"
    plain = "".join(c for c in title if c.isprintable()).replace("\\", "\\\\").replace('"', '\\"')
    head = f'{page}\n#text(size: 14pt, weight: "bold")[#"{plain}"]\n'
    return "\n".join([head, *(typst(tf, form) + "\n" for tf, form in entries)])
