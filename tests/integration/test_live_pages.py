"""Pages with sliders, opened in Chromium without a network, against the same models in Python."""

import json
import re
import sys

import numpy as np
import pytest

import symflex
from symflex import pipeline
from symflex.budget import Silent
from symflex.live.page import live_page
from symflex.roots import Modes
from tests.house.repository import ROOT
from tests.integration.chromium import Chromium
from tests.unit.codegen import hostile_names as hostile

PAGES = ("eppinger1988/two_mass", "eppinger1988/sliding_free_beam")
MORE = (
    "classics/quarter_car", "classics/one_link_arm", "classics/rod_tip_mass", "classics/shaft_discs",
    "classics/kelvin_voigt_cantilever", "eppinger1988/base_flexure", "eppinger1988/loops/two_mass_force",
    "eppinger1988/loops/sliding_free_beam_position",
    "eppinger1988/lumped_bending_beam", "eppinger1988/six_mass", "frames/l_frame", "tapers/cone",
    "../symflex/templates/servo",
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
    given = {p.name: f"{values[p.name]!r} {p.unit}" if p.cycles else values[p.name] for p in model.settable}
    moved = pipeline.load(path, (), given)
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


BODY = """
symflex = 1
title = '''</title></script><script>window.pwned = 1</script><img src=x onerror="pwned=1">'''
# A comment that stays.
[parameters]
m = { value = "2 kg", doc = "</script><!-- '\\u2028" }
b = "3 N*s/m"
k = { value = 0.05, unit = "kN/m", range = ["20 N/m", 0.4], latex = 'k_\\theta' }
[elements]
body = { type = "mass", at = "x", m = "m" }
wall = { type = "spring", between = ["x", "ground"], k = "k" }
loss = { type = "damper", between = ["x", "ground"], b = "b" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
V = "s*x"
"""
ACT = """(async () => {
const one = (s) => document.querySelector(s), frame = () => new Promise(requestAnimationFrame);
const [slider, field] = [1, 2].map((i) => one(`.parameter:nth-of-type(3) input:nth-of-type(${i})`));
const put = async (input, value) => {
    input.value = value;
    for (const kind of ['input', 'change']) input.dispatchEvent(new Event(kind, { bubbles: true }));
    await frame();
    await frame();
};
%s
})()"""


def test_the_step_of_an_oscillator_is_that_of_textbooks_and_its_poles_are_proved(browser, tmp_path):
    opened(browser, tmp_path, pipeline.loads(BODY))
    said = browser.run(
        ACT
        % "await put(field, '0.08'); return [one('svg.step desc').textContent, one('.stability').className,"
        " symflex.certified('X/F', { k: 80 })];"
    )
    assert said[1:] == ["stability stable", True]
    numbers = [float(x.replace("\u2212", "-")) for x in re.findall(r"[-\u2212\d.e]+(?= at| s)", said[0])]
    w, zeta = np.sqrt(40), 3 / (2 * np.sqrt(160))
    for y, time in zip(numbers[::2], numbers[1::2], strict=True):
        d = w * np.sqrt(1 - zeta**2) * time
        decay = np.exp(-zeta * w * time) * (np.cos(d) + zeta / np.sqrt(1 - zeta**2) * np.sin(d))
        assert y == pytest.approx((1 - decay) / 80, rel=1e-3)


def test_a_model_with_a_hidden_pole_that_may_be_unstable_is_not_called_stable(browser, tmp_path):
    for sign, classes in (("-", ["stability unstable", "stability"]), ("+", ["stability stable"] * 2)):
        body = "symflex = 1\nparameters = { a = 1, b = 9, K = 3 }\ninputs.r = {}\noutputs.X = 'x'"
        loop = f"signals.x = '(s {sign} a)/(s + b)/(s {sign} a)*K*(r - x)'"
        opened(browser, tmp_path, pipeline.loads(f"{body}\n{loop}"))
        said = "one('.stability').className"
        assert browser.run(ACT % f"const at = {said}; await put(field, 4); return [at, {said}];") == classes


def test_values_are_undone_linked_and_copied(browser, tmp_path):
    file = opened(browser, tmp_path, pipeline.loads(BODY))
    ends = "await put(slider, 0); const low = symflex.parameters.k.value; await put(slider, 400);"
    script = f"{ends} const high = symflex.parameters.k.value;"
    script += " one('.undo').click(); await put(field, 0.07);"
    got = browser.run(ACT % f"{script} return [low, high, symflex.specification(), location.hash];")
    assert got[:2] == [20, 400]
    assert "# A comment that stays." in got[2]
    values = {p.name: float(p.value.nearly) for p in pipeline.loads(got[2]).parameters}
    assert values == {"m": 2.0, "b": 3.0, "k": 70.0}
    browser.open("about:blank")
    browser.open(file.as_uri() + got[3])
    undone = (
        "const k = () => symflex.parameters.k.value, now = k(); one('.reset').click(); return [now, k()];"
    )
    assert browser.run(ACT % undone) == [70, 50]


def test_undone_values_come_back_and_an_impossible_one_takes_the_verdict_away(browser, tmp_path):
    opened(browser, tmp_path, pipeline.loads(BODY))
    k = "symflex.parameters.k.value"
    script = (
        f"await put(field, 0.07); one('.undo').click(); const undone = {k};"
        f" one('.redo').click(); const redone = {k};"
        " await put(field, -3); const { hidden } = one('.stability'), said = one('.missing').textContent;"
        f" await put(field, 0.06); return [undone, redone, hidden, said, {k}, one('.stability').hidden];"
    )
    said = "k = -3 is not possible: it is positive."
    assert browser.run(ACT % script) == [50, 70, True, said, 60, False]


def test_values_are_kept_as_curves_and_the_ends_of_a_slider_are_moved(browser, tmp_path):
    opened(browser, tmp_path, pipeline.loads(BODY))
    script = (
        "one('.hold').click(); await put(field, 0.07); one('.hold').click(); await put(field, 0.09);"
        " const count = document.querySelectorAll('svg.magnitude .curve').length;"
        " const high = one('.parameter:nth-of-type(3) .high'); high.value = 4;"
        " high.dispatchEvent(new Event('change'));"
        " await put(slider, 400); return [count, symflex.parameters.k.value];"
    )
    # The curves at 90 N/m, at 70 N/m, at 50 N/m, which are those declared, and these once more.
    assert browser.run(ACT % script) == [4, 4000]


LATE = """
symflex = 1
parameters = { K = 0.8, T = "2 s", tau = "1 s" }
inputs.r = {}
outputs.Y = "y"
signals.y = "K*exp(-T*s)/(tau*s + 1)*(r - y)"
"""


def test_the_step_of_a_delayed_loop_is_zero_until_the_delay(browser, tmp_path):
    opened(browser, tmp_path, pipeline.loads(LATE))
    said = browser.run(
        ACT.replace(
            "[slider, field] = [1, 2].map((i) => one(`.parameter:nth-of-type(3) input:nth-of-type(${i})`))",
            "until = one('.until input')",
        )
        % "const time = one('.until input'); await put(time, 1.9);"
        " const early = one('svg.step desc').textContent; await put(time, 3.5);"
        " return [early, one('svg.step desc').textContent];"
    )
    assert said[0] == "Y/r: 0 at 0.95 s, 0 at 1.9 s."
    # By steps: y = K (1 - exp(-(t - T))) from T to 2 T.
    last = float(re.findall(r"([\d.]+) at 3.5 s", said[1])[0])
    assert last == pytest.approx(0.8 * (1 - np.exp(-1.5)), rel=0.02)


def test_a_loop_has_a_nyquist_plot_with_margins_that_follow_the_gain(browser, tmp_path):
    # L = K/(s (s + 1) (s + 2)) is -K/6 at omega = sqrt(2); with K = 2 it has the magnitude 1 where
    # w^2 (w^2 + 1)(w^2 + 4) = 4, w = 0.7494, with the phase margin 90 - atan(w) - atan(w/2) = 32.6 degrees.
    loop = """symflex = 1
parameters = { K = 2, T_1 = "1 s", T_2 = "0.5 s" }
signals.y = "K/(2*s*(T_1*s + 1)*(T_2*s + 1))*(r - y)"
inputs.r = {}
outputs.Y = "y"
analysis.band = ["0.01 Hz", "10 Hz"]
"""
    opened(browser, tmp_path, pipeline.loads(loop))
    said = browser.run("document.querySelector('.margins').textContent")
    assert said.startswith("Gain margin × 3 at 0.2251 Hz, phase margin 32.6° at 0.1193 Hz")
    assert browser.run("[...document.querySelector('.gain select').options].map((o) => o.text)") == [
        "K",
        "T_1",
        "T_2",
    ]
    moved = """const field = document.querySelectorAll('.parameter > input[type=number]')[0];
field.value = '1'; field.dispatchEvent(new Event('input', { bubbles: true }));
await new Promise(requestAnimationFrame); await new Promise(requestAnimationFrame);
return document.querySelector('.margins').textContent;"""
    assert browser.run(f"(async () => {{{moved}}})()").startswith("Gain margin × 6 at 0.2251 Hz")
    opened(browser, tmp_path, pipeline.load(ROOT / "derivations" / "eppinger1988" / "two_mass.toml"))
    assert browser.run("document.querySelector('.loop').hidden")


def test_phase_is_continuous_if_asked_for_and_the_pointer_reads_the_curves(browser, tmp_path):
    opened(browser, tmp_path, pipeline.loads(LATE.replace('Y = "y"', 'Y = "exp(-9*T*s)*r"')))
    script = """
    const angles = document.querySelector('.angles'), svg = document.querySelector('svg.phase');
    angles.selectedIndex = 1; angles.dispatchEvent(new Event('change'));
    await new Promise(requestAnimationFrame); await new Promise(requestAnimationFrame);
    const { left, top, width, height } = svg.getBoundingClientRect();
    const [clientX, clientY] = [left + width - 30, top + height / 2];
    svg.dispatchEvent(new PointerEvent('pointermove', { clientX, clientY }));
    return [svg.querySelector('desc').textContent, svg.querySelector('.reading text').textContent];
    """
    described, read = browser.run(f"(async () => {{{script}}})()")
    assert float(re.findall(r"between \u2212([\d.e]+)", described)[0]) > 360
    # By hand: the magnitude is 1, and the phase -360 f 9 T.
    hertz, size, angle = re.findall(r"^([\d.e\u2212]+) Hz: ([\d.]+), \u2212([\d.e]+)", read)[0]
    assert float(size) == pytest.approx(1, rel=1e-6)
    assert float(angle) == pytest.approx(360 * 18 * float(hertz), rel=1e-3)


def test_hostile_names_and_texts_are_shown_and_run_nothing(browser, tmp_path, monkeypatch):
    names = tuple(dict.fromkeys([*hostile.JAVASCRIPT, *hostile.ODD]))
    model = hostile.with_prose(hostile.mass_on_springs(names), "</script><script>window.pwned = 1</script>")
    monkeypatch.setattr("symflex.live.page._formula", lambda tf: "<p></p>")  # no name of these can be read
    monkeypatch.setattr("symflex.live.page._pieces", lambda model, shown: [])
    monkeypatch.setattr("symflex.codegen.export.formula_of", lambda tf: (tf.name,))
    file = opened(browser, tmp_path, model, pipeline.loads(BODY))
    assert browser.run("[typeof pwned, document.querySelectorAll('script').length]") == ["undefined", 1]
    assert browser.run("document.querySelectorAll('h1')[1].textContent").startswith("</title></script>")
    assert browser.complaints() == ([], [file.as_uri()])


def test_a_page_without_values_says_which_are_missing_and_draws_when_they_are_there(browser, tmp_path):
    opened(browser, tmp_path, pipeline.loads(BODY.replace("value = 0.05, ", "")))
    script = (
        "const said = one('.missing').textContent; await put(field, 0.07); const { hidden } = one('.plots');"
    )
    *got, text = browser.run(ACT % f"{script} return [said, hidden, symflex.specification()];")
    assert got == ["The plots need values of k: type them, or move the sliders.", False]
    assert float(pipeline.loads(text).parameters[2].value.nearly) == 70


@pytest.mark.slow
@pytest.mark.needs_module("anywidget")
@pytest.mark.filterwarnings("ignore")
def test_a_notebook_shows_the_page_in_a_frame_and_a_widget_knows_its_values(monkeypatch):
    page = symflex.loads(BODY).live("X/F")
    assert "<script" not in page._repr_html_()
    assert page.widget().page == page.html
    monkeypatch.setitem(sys.modules, "anywidget", None)
    with pytest.raises(symflex.SymflexError, match=r"symflex\[notebook\]"):
        page.widget()
