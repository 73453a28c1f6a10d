"""Files of drawings of all kinds, opened by the programs that readers open them with."""

import json
import re
import subprocess
from html import unescape
from itertools import combinations

import pytest

from symflex import pipeline
from symflex.drawing import drawing_of, render_drawing
from symflex.drawing.geometry import Extent
from tests.house.repository import ROOT
from tests.unit.drawing.test_diagrams import WORKED

MODELS = [ROOT / f"derivations/{name}.toml" for name in WORKED]
PX = 96 / 72
"""Pixels of a browser to a point."""
MEASURE = """
const pen = document.createElement("canvas").getContext("2d"), found = {};
for (const svg of document.querySelectorAll("svg")) {
  const page = svg.getBoundingClientRect(), boxes = [];
  for (const group of svg.querySelectorAll("g[id^=text], g[id*='put.']")) {
    if (!group.querySelector("text")) continue;
    const ink = [Infinity, Infinity, -Infinity, -Infinity];
    for (const one of group.querySelectorAll("tspan, text")) {
      if (one.children.length || !one.textContent.trim()) continue;
      const style = getComputedStyle(one), on_page = one.getScreenCTM();
      pen.font = `${style.fontStyle} ${style.fontWeight} ${style.fontSize} ${style.fontFamily}`;
      [...one.textContent].forEach((letter, i) => {
        const size = pen.measureText(letter), at = one.getStartPositionOfChar(i).matrixTransform(on_page);
        ink[0] = Math.min(ink[0], at.x - size.actualBoundingBoxLeft * on_page.a);
        ink[1] = Math.min(ink[1], at.y - size.actualBoundingBoxAscent * on_page.a);
        ink[2] = Math.max(ink[2], at.x + size.actualBoundingBoxRight * on_page.a);
        ink[3] = Math.max(ink[3], at.y + size.actualBoundingBoxDescent * on_page.a);
      });
    }
    boxes.push([group.textContent, ink.map((v, i) => v - (i % 2 ? page.top : page.left))]);
  }
  found[svg.parentElement.id] = {page: [page.width, page.height], boxes};
}
document.body.innerHTML = "";
document.body.textContent = JSON.stringify(found);
"""


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    """What a browser says of the texts of all pictures, on one page."""
    folder = tmp_path_factory.mktemp("browser")
    pictures = []
    for path in MODELS:
        svg = render_drawing(drawing_of(pipeline.load(path)), "svg").decode()
        # Each as if it were alone: its style is its own, and so are the names of its parts.
        pictures.append(f'<div id="{path.parent.name}/{path.stem}">{svg[svg.index("<svg") :]}</div>')
    page = folder / "page.html"
    page.write_text(
        f"<!doctype html><meta charset='utf-8'><body>{''.join(pictures)}<script>{MEASURE}</script>", "utf-8"
    )
    command = [
        "chromium", "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
        "--disable-background-networking", "--disable-component-update", "--disable-sync",
        f"--user-data-dir={folder / 'profile'}", "--dump-dom", page.as_uri(),
    ]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    return json.loads(unescape(re.search(r"<body>(.*)</body>", done.stdout, re.DOTALL)[1]))


@pytest.mark.slow
@pytest.mark.needs_tool("chromium")
def test_in_a_browser_texts_keep_apart_and_within_the_page(measured):
    wrong = []
    for name, found in measured.items():
        texts = [(shown.strip(), Extent(*box)) for shown, box in found["boxes"]]
        wide, tall = found["page"]
        wrong += [(name, shown) for shown, b in texts if b.x0 < 0 or b.y0 < 0 or b.x1 > wide or b.y1 > tall]
        wrong += [
            (name, one, other)
            for (one, a), (other, b) in combinations(texts, 2)
            if a.overlaps(b.grown(-0.4 * PX))
        ]
    assert not wrong, "\n".join(" ".join("".join(w.split()) for w in one) for one in wrong)


@pytest.mark.slow
@pytest.mark.needs_tool("chromium")
def test_a_browser_shows_every_text_of_every_drawing(measured):
    assert len(measured) == len(MODELS)
    for path in MODELS:
        drawing = drawing_of(pipeline.load(path))
        found = measured[f"{path.parent.name}/{path.stem}"]
        assert len(found["boxes"]) == sum(len(i.texts) for i in drawing.items)
        assert found["page"] == pytest.approx([drawing.width * PX, drawing.height * PX], abs=0.1)


@pytest.mark.slow
@pytest.mark.needs_tool("pdflatex")
def test_tex_sets_every_drawing_in_a_column_without_a_complaint(tmp_path):
    pages = []
    for i, path in enumerate(MODELS):
        drawing = drawing_of(pipeline.load(path))
        for format in ("pgf", "pdf"):
            (tmp_path / f"d{i}.{format}").write_bytes(render_drawing(drawing, format))
        pages.append(rf"\input{{d{i}.pgf}}\par\includegraphics{{d{i}.pdf}}\newpage")
    text = "\n".join(
        (
            r"\documentclass{article}\usepackage{amsmath,pgf,graphicx}\usepackage[paperwidth=100mm,paperheight=200mm,margin=5mm]{geometry}",
            r"\parindent0pt\pagestyle{empty}\begin{document}",
            *pages,
            r"\end{document}",
        )
    )
    (tmp_path / "all.tex").write_text(text, "utf-8")
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "all.tex"]
    subprocess.run(command, cwd=tmp_path, capture_output=True, check=True, timeout=120)
    log = (tmp_path / "all.log").read_text("latin-1")
    assert re.findall(r"^.*(?:Warning|Overfull|Missing).*$", log, re.MULTILINE) == []
    assert f"({len(MODELS)} pages" in log
