"""Letters of drawings on the playground are as wide as matplotlib sets them."""

import importlib.util
import sys

import pytest
from matplotlib.font_manager import FontProperties
from matplotlib.mathtext import MathTextParser

from symflex.figures.style import paper_style
from tests.integration.test_playground import ROOT, hook


@pytest.fixture(scope="module")
def letters():
    path = ROOT / "docs" / "playground" / "letters.py"
    spec = importlib.util.spec_from_file_location("letters", path)
    sys.modules["letters"] = module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    module.METRICS.update(hook().widths())
    yield module
    del sys.modules["letters"]


TEXTS = (
    r"m_{1}", r"F_{\mathrm{act}}", r"\theta", r"E I \, w = -F", r"x^{2}", r"w(0) = 0", r"\frac{1}{s}",
    r"\mathrm{slope}_{\mathrm{tip}}", r"k_{a}^{2}", r"20\,\mathrm{kN}/\mathrm{m}", r"M g L + k",
)  # fmt: skip


@pytest.mark.parametrize("markup", TEXTS)
def test_a_text_has_the_size_that_matplotlib_gives_it(letters, markup):
    with paper_style():
        width, height, *_ = MathTextParser("path").parse(f"${markup}$", 720, FontProperties(size=8))
    made = letters.MathTextParser("path").parse(f"${markup}$", 720, letters.FontProperties(size=8))
    assert made[0] == pytest.approx(width, rel=0.12)
    assert made[1] == pytest.approx(height, rel=0.45)


@pytest.mark.parametrize("markup", [r"\unknown", r"\frac{1}{", r"a}", r"\input{file}"])
def test_what_is_not_known_is_refused(letters, markup):
    with pytest.raises((ValueError, IndexError)):
        letters.set_line(f"${markup}$")
