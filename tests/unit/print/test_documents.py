"""Typst and Office Math: what they say has the function's values, and compiles."""

import cmath
from xml.etree import ElementTree

import pytest

import symflex
from symflex import pipeline
from symflex.codegen.exporters import EXPORTERS
from symflex.print.documents import omml, typst
from symflex.print.forms import print_forms
from tests.house.repository import ROOT

M = "{http://schemas.openxmlformats.org/officeDocument/2006/math}"
MODELS = (
    "eppinger1988/two_mass",
    "classics/clamped_free",
    "classics/rod_tip_mass",
    "classics/quarter_car",
    "eppinger1988/loops/two_mass_force",
    "nonlinear/magnetic_levitation",
)
GREEK = {
    "μ": "mu",
    "ρ": "rho",
    "ω": "omega",
    "ζ": "zeta",
    "γ": "gamma",
    "β": "beta",
    "τ": "tau",
    "λ": "lambda",
}
S = 0.3 + 1.7j


def printed(name):
    model = symflex.load(ROOT / "derivations" / f"{name}.toml").resolved
    derived, _ = pipeline.derive_as(model, model.transfer_functions, is_read=True)
    return model, derived[0], print_forms(derived)[0][0]


class Reader:
    """Evaluates Office Math as a person reads it: factors side by side, functions before arguments."""

    def __init__(self, values):
        self.values = values

    def all_of(self, nodes):
        """Return a sum of signed products."""
        total, sign, factor, function, power = 0, 1, None, None, 1
        divides = False
        for node in nodes:
            text = "".join(t.text or "" for t in node.iter(f"{M}t")) if node.tag == f"{M}r" else None
            if text in ("+", "−"):
                if factor is not None:
                    total += sign * factor
                sign, factor = (1 if text == "+" else -1), None
                continue
            if text == "⋅":
                continue
            if text == "/":
                divides = True
                continue
            head = (
                node if node.tag == f"{M}r" else node.find(f"{M}e/{M}r") if node.tag == f"{M}sSup" else None
            )
            name = "".join(t.text or "" for t in head.iter(f"{M}t")) if head is not None else ""
            if name in ("cosh", "sinh", "cos", "sin", "tan", "exp"):
                function = getattr(cmath, name)
                power = self.all_of(node.find(f"{M}sup")) if node.tag == f"{M}sSup" else 1
                continue
            value = self.value(node)
            if function is not None:
                value, function, power = function(value) ** power, None, 1
            factor = value if factor is None else factor / value if divides else factor * value
            divides = False
        return total + sign * (1 if factor is None else factor)

    def value(self, node):
        part = lambda name: self.all_of(node.find(f"{M}{name}"))  # noqa: E731
        match node.tag.removeprefix(M):
            case "r":
                text = "".join(t.text for t in node.iter(f"{M}t"))
                return float(text) if text[0].isdigit() else self.values[GREEK.get(text, text)]
            case "f":
                return part("num") / part("den")
            case "rad":
                return cmath.sqrt(part("e"))
            case "sSup":
                return part("e") ** part("sup")
            case "sSub":
                return self.values[self.name(node)]
            case "sSubSup":
                return self.values[self.name(node)] ** part("sup")
            case "d":
                return self.all_of(node.find(f"{M}e"))
        raise AssertionError(node.tag)

    def name(self, node):
        texts = ["".join(t.text for t in node.find(f"{M}{k}").iter(f"{M}t")) for k in ("e", "sub")]
        return "_".join(GREEK.get(t, t) for t in texts)


@pytest.mark.parametrize("name", MODELS)
def test_office_math_reads_as_the_function(name):
    model, tf, form = printed(name)
    rows = list(ElementTree.fromstring(omml(tf, form)))
    values = {p.name: float(p.value.nearly) for p in model.parameters if p.value} | {"s": S, "π": cmath.pi}
    reader = Reader(values)
    for row in reversed(rows):
        nodes = list(row)
        place = next(i for i, n in enumerate(nodes) if "".join(t.text or "" for t in n.iter(f"{M}t")) == "=")
        result = reader.all_of(nodes[place + 1 :])
        if row is not rows[0]:
            head = nodes[0]
            own = head.tag == f"{M}sSub"
            text = "".join(t.text or "" for t in head.iter(f"{M}t"))
            if head.tag == f"{M}sSup":  # beta^4 = ...
                result, text = result**0.25, text.removesuffix("4")
            values[reader.name(head) if own else GREEK.get(text, text)] = result
    bound = symflex.load(ROOT / "derivations" / f"{name}.toml").transfer_function(tf.name).bind()
    assert result == pytest.approx(complex(bound(S)), rel=1e-9)


def test_typst_breaks_long_lines_and_says_where_names_come_from():
    _, tf, form = printed("eppinger1988/robot_axis")
    formula, below = typst(tf, form).split("\nwhere\n")
    assert formula.startswith('$ frac(V_(upright("act")) (s), V_(upright("cmd")) (s)) &= ')
    assert " \\\n  & quad quad + " in formula
    assert "q &= β l \\\n" in below
    assert "β^(4) &= - frac(ρ A s^(2), E I (η s + 1)) $" in below


@pytest.mark.slow
@pytest.mark.needs_module("typst")
@pytest.mark.parametrize("path", sorted((ROOT / "derivations").glob("[cn]*/*.toml")), ids=lambda p: p.stem)
def test_every_typst_document_compiles(path, tmp_path):
    import typst as compiler

    model = symflex.load(path).resolved
    derived, _ = pipeline.derive_as(model, model.transfer_functions, is_read=True)
    file = tmp_path / "model.typ"
    file.write_text(EXPORTERS["typst"].export(model, derived).text, encoding="utf-8")
    assert compiler.compile(str(file)).startswith(b"%PDF")


def test_texts_of_a_model_stay_texts_in_both():
    title = '"] #panic() $'.replace('"', '\\"')
    model = symflex.loads(f'symflex = 1\ntitle = "{title}"\ninputs.u = {{}}\noutputs.y = "u/(s + 1)"')
    derived, _ = pipeline.derive_as(model.resolved, model.resolved.transfer_functions, is_read=True)
    text = EXPORTERS["typst"].export(model.resolved, derived).text
    assert '[#"\\"] #panic() $"]' in text
