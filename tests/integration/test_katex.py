"""KaTeX itself, in its strict mode, sets the mathematics of notebooks and of papers.

KaTeX is found as Node finds packages: installed beside the tests, globally, or where ``NODE_PATH`` says.
"""

import json
import re
import subprocess
from pathlib import Path

import pytest

from symflex import pipeline
from symflex.errors import SymflexError
from symflex.print.forms import print_form
from symflex.print.forms.printed import forms_of
from symflex.print.latex import inline_latex, notebook_latex, transfer_function_latex
from tests.conftest import REASON
from tests.integration.test_latex_compiles import LABELS

DERIVATIONS = Path(__file__).parents[2] / "derivations"
KINDS = ("eppinger1988/rigid_body", "eppinger1988/sliding_free_beam", "classics/one_link_arm", "tapers/wedge")
"""Rational, of beams, both, and with Bessel functions."""
PROGRAM = """
const katex = require("katex");
const items = JSON.parse(require("fs").readFileSync(0));
const refused = [];
for (const [name, latex] of items) {
  try { katex.renderToString(latex, {displayMode: true, throwOnError: true, strict: "error", trust: false}); }
  catch (error) { refused.push([name, String(error)]); }
}
console.log(JSON.stringify(refused));
"""
LONGEST_INLINE = 20_000
"""KaTeX's own stack ends somewhere beyond."""
MOST_LINES = 60
"""Its count of expansions ends at so many rows."""

pytestmark = pytest.mark.needs_tool("node")


@pytest.fixture(scope="module")
def refused():
    """A function from mathematics by name to what KaTeX refuses of it."""
    found = subprocess.run(["node", "-e", "require.resolve('katex')"], capture_output=True, check=False)
    if found.returncode:
        pytest.skip(f"needs the library katex, {REASON}")

    def ask(items):
        done = subprocess.run(
            ["node", "-e", PROGRAM], input=json.dumps(items), capture_output=True, text=True, check=True
        )
        return json.loads(done.stdout)

    return ask


def mathematics_of(path):
    """Yield what notebooks and papers hold of a model, with names."""
    for tf in pipeline.derive_all(pipeline.load(path))[:2]:
        for form in (None, *forms_of(tf)):
            try:
                printed = print_form(tf, form)
            except SymflexError:
                continue  # zpk of what has no numbers
            name = f"{path.stem} {tf.name} {form}"
            if notebook := notebook_latex(tf, printed):
                yield f"{name} notebook", notebook
            if len(inline := inline_latex(tf, printed)) <= LONGEST_INLINE:
                yield f"{name} inline", inline
            latex = transfer_function_latex(tf, printed, width_mm=88.5)
            # What numbers lines and breaks pages is for papers.
            latex = re.sub(r"\\label\{[^}]*\}|\\notag|\\(?:begin|end)group|\\allowdisplaybreaks", "", latex)
            for found in re.finditer(r"\\begin\{(equation|align\*?)\}.*?\\end\{\1\}", latex, re.DOTALL):
                if found[0].count("\\\\") < MOST_LINES:
                    yield f"{name} paper", found[0]


def test_katex_sets_the_equations_of_models_of_every_kind(refused):
    items = [item for stem in KINDS for item in mathematics_of(DERIVATIONS / f"{stem}.toml")]
    assert len(items) > 20
    assert refused(items) == []
    assert refused([("broken", r"\frac{a"), ("unknown", r"\input{x}")]) != []


def test_katex_sets_labels_of_every_kind(refused):
    from symflex.print.label import read_label

    sound = [label for label in LABELS if read_label(label) is not None]
    assert sound
    assert refused([(label, label) for label in sound]) == []
