"""Pages with sliders, opened in Chromium without a network, against the same models in Python."""

import json

import numpy as np
import pytest

from symflex import pipeline
from symflex.budget import Silent
from symflex.live.page import live_page
from symflex.roots import Modes
from tests.house.repository import ROOT
from tests.integration.chromium import Chromium

PAGES = ("eppinger1988/two_mass", "eppinger1988/sliding_free_beam")
MORE = (
    "classics/quarter_car", "classics/one_link_arm", "classics/rod_tip_mass", "classics/shaft_discs",
    "classics/kelvin_voigt_cantilever", "eppinger1988/base_flexure", "eppinger1988/loops/two_mass_force",
    "eppinger1988/lumped_bending_beam", "eppinger1988/six_mass", "frames/l_frame", "tapers/cone",
)  # fmt: skip
DRAG = """
for (const [i, slider] of [...document.querySelectorAll('main input[type=range]:enabled')].entries()) {
    for (let k = 200; k <= 200 + 20 * (i %% 3 - 1) + 20; k += 5) {
        slider.value = k;
        slider.dispatchEvent(new Event('input', { bubbles: true }));
        await new Promise(requestAnimationFrame);
    }
    slider.dispatchEvent(new Event('change', { bubbles: true }));
}
const { parameters, evaluate, roots } = window.symflex;
const values = Object.fromEntries(Object.entries(parameters).map(([k, p]) => [k, p.value]));
const curves = %s.map(([tf, w]) => w.map((x) => evaluate(tf, values, x)));
const moving = document.querySelectorAll('main input[type=range]:enabled').length;
return { moving, values, curves, roots: roots(%s, values) };
"""

pytestmark = pytest.mark.needs_tool("chromium")


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    chromium = Chromium(tmp_path_factory.mktemp("chromium"))
    yield chromium
    chromium.close()


def opened(browser, folder, *models):
    file = folder / "page.html"
    file.write_text(live_page([(m, m.transfer_functions[:4]) for m in models], Silent()), encoding="utf-8")
    assert file.stat().st_size < 600_000
    browser.events.clear()
    browser.open(file.as_uri())
    return file


def compared(browser, folder, name):
    path = ROOT / "derivations" / f"{name}.toml"
    model = pipeline.load(path)
    file = opened(browser, folder, model)
    low, high = (float(f) for f in model.analysis.band or (0.1, 1000))
    w = 2 * np.pi * np.geomspace(low, high, 50)
    names = ["/".join(pair) for pair in model.transfer_functions[:4]]
    asked = json.dumps([[tf, w.tolist()] for tf in names])
    got = browser.run(f"(async () => {{{DRAG % (asked, json.dumps(names[0]))}}})()")
    assert browser.complaints() == ([], [file.as_uri()])
    values = {p.name: got["values"][p.name] for p in model.settable}
    assert values != {p.name: float(p.value.nearly) for p in model.settable} or not got["moving"]
    moved = pipeline.load(path, (), values)
    for tf, curve in zip(names, got["curves"], strict=True):
        (bound,) = pipeline.derive_for_roots(moved, pipeline.pick_pairs(moved, [tf]))
        expected = np.array([bound(1j * x) for x in w])
        shown = np.array([complex(*z) for z in curve])
        assert np.max(np.abs(shown / expected - 1)) < 1e-9, (name, tf)
    (bound,) = pipeline.derive_for_roots(moved, pipeline.pick_pairs(moved, names[:1]))
    located = pipeline.roots(bound, Modes(25) if model.is_distributed else None)
    for kind, roots in (("pole", located.all_poles), ("zero", located.zeros)):
        proved = np.array([complex(r) for r in roots])
        for r in got["roots"]:
            s = complex(r["re"], r["im"])
            if r["kind"] == kind:
                assert np.min(np.abs(proved - s)) <= 1e-8 * max(abs(s), 1e-9), (name, kind, s)


@pytest.mark.parametrize("name", PAGES)
def test_a_page_shows_what_python_computes_at_the_same_values(browser, tmp_path, name):
    compared(browser, tmp_path, name)


@pytest.mark.slow
@pytest.mark.parametrize("name", MORE)
def test_more_pages_show_what_python_computes_at_the_same_values(browser, tmp_path, name):
    compared(browser, tmp_path, name)
