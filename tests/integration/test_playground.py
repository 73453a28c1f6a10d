"""The playground in Chromium: what the page shows is what the program prints here, byte for byte.

``SYMFLEX_WEBASSEMBLY`` names a folder with Pyodide and wheels for it, which ``.ci/run`` fetches.
"""

import functools
import importlib.util
import json
import os
import time
from decimal import Decimal

import pytest

from symflex.cli import run
from tests.house.repository import ROOT
from tests.integration.chromium import Chromium, serving

RUNTIME = os.environ.get("SYMFLEX_WEBASSEMBLY")
MORE = (
    "classics/pinned_pinned", "classics/shaft_discs", "eppinger1988/rigid_body", "eppinger1988/six_mass",
    "mechatronics/absorber", "mechatronics/drive_train", "nonlinear/buck_converter",
)  # fmt: skip
LOOP = "eppinger1988/loops/two_mass_position"
LONG_WORK = """symflex = 1
[elements]
{elements}
[inputs]
F = {{ force = "x0" }}
[outputs]
X = "x{last}"
"""

pytestmark = [
    pytest.mark.slow,
    pytest.mark.needs_tool("chromium"),
    pytest.mark.skipif(not RUNTIME, reason="SYMFLEX_WEBASSEMBLY names no folder with Pyodide"),
]


def hook():
    """Return the module that lays out the page."""
    spec = importlib.util.spec_from_file_location("playground", ROOT / "docs" / "hooks" / "playground.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    folder = tmp_path_factory.mktemp("site")
    hook().lay_out(folder)
    served = serving(folder)
    yield served
    served.shutdown()
    served.server_close()


@pytest.fixture(scope="module")
def browser(server, tmp_path_factory):
    chromium = Chromium(tmp_path_factory.mktemp("chromium"))
    chromium.address = f"http://127.0.0.1:{server.server_address[1]}/playground/page.html"
    chromium.open(chromium.address)
    yield chromium
    chromium.close()


def press(browser, key, code, **more):
    """Press and release a key."""
    browser.ask("Input.dispatchKeyEvent", type="keyDown", key=key, code=code, **more)
    browser.ask("Input.dispatchKeyEvent", type="keyUp", key=key, code=code)


def enter(browser, text, *, is_typed=False):
    """Type a text over what is there, or paste it at once, and wait until all is shown."""
    browser.run("document.querySelector('textarea').focus(); document.querySelector('textarea').select()")
    first, *others = text.split("\n") if is_typed else [text]
    browser.ask("Input.insertText", text=first)
    for line in others:
        press(browser, "Enter", "Enter", text="\r")
        if line:
            browser.ask("Input.insertText", text=line)
    browser.run("symflex.settled()")
    assert browser.run("document.querySelector('textarea').value") == text
    return json.loads(browser.run("JSON.stringify(symflex.results)"))


def printed(folder, monkeypatch, capsys, text, *arguments):
    """Return what a command prints here."""
    (folder / "model.toml").write_text(text, encoding="utf-8")
    monkeypatch.chdir(folder)
    capsys.readouterr()
    run([arguments[0], "model.toml", *arguments[1:]])
    return capsys.readouterr().out


def models():
    """Return the texts of twenty models."""
    laid = hook()
    return {name: laid.example(name)["text"] for name in (*laid.EXAMPLES, *MORE)}


def enclosed(response):
    """Return values of a step response with their radii."""
    return [(Decimal(v), Decimal(r)) for v, r in zip(response["value"], response["radius"], strict=True)]


@pytest.mark.parametrize("name", [*hook().EXAMPLES, *MORE])
def test_formulas_roots_and_latex_are_those_of_the_program(browser, tmp_path, monkeypatch, capsys, name):
    text = models()[name]
    native = functools.partial(printed, tmp_path, monkeypatch, capsys)
    shown = enter(browser, text, is_typed=name == LOOP)
    assert shown["text"] == text
    pair = browser.run("document.getElementById('pair').value")
    assert shown["code"]["out"] == native(text, "derive", "--tf", pair, "--format", "latex")
    asked = json.dumps({"text": text, "arguments": ["derive", "--tf", pair]})
    assert browser.run(f"symflex.ask('command', {asked}).then((x) => x.out)") == native(
        text, "derive", "--tf", pair
    )
    assert shown["roots"]["out"] == native(text, "roots", "--tf", pair, "--json")
    here, there = json.loads(native(text, *shown["step"]["options"])), json.loads(shown["step"]["out"])
    assert here["certified"] and there["time"] == here["time"]
    for value, other in zip(enclosed(here), enclosed(there), strict=True):
        assert abs(value[0] - other[0]) <= value[1] + other[1]  # words of 32 bits round balls elsewhere
    assert browser.run("document.querySelectorAll('#formula math').length") > 0
    assert browser.run("document.querySelectorAll('#bode path.curve').length") == 2
    assert browser.run("document.querySelectorAll('#drawing :is(path, text)').length") > 5
    # Half of it is a model with problems, or none.
    broken = text[: len(text) * 2 // 3]
    problems = enter(browser, broken)["problems"]
    expected = json.loads(native(broken, "check", "--json"))
    for problem in problems:
        del problem["severity"]
    assert problems == expected["problems"] + expected["warnings"]
    assert browser.run("document.querySelectorAll('#problems li').length") == len(problems)


def test_a_link_holds_the_model_and_another_window_shows_it(browser):
    text = 'symflex = 1 # \u03a9\U0001f600\nsignals.y = "u/(s + 2)"\ninputs.u = {}\noutputs.Y = "y"\n'
    enter(browser, text)
    address = browser.run(
        "import(new URL('link.js', location))"
        ".then(({ link }) => link(document.querySelector('textarea').value))"
    )
    enter(browser, "symflex = 1\n")
    browser.run(f"location.hash = {json.dumps(address)}; new Promise((r) => setTimeout(r, 300))")
    browser.run("symflex.settled()")
    assert browser.run("document.querySelector('textarea').value") == text


def test_work_is_stopped_and_the_next_model_is_answered(browser):
    size = 26
    elements = [f'm{i} = {{ type = "mass", at = "x{i}", m = "m_{i}" }}' for i in range(size)]
    elements += [
        f'k{i}_{j} = {{ type = "spring", between = ["x{i}", "x{j}"], k = "k_{i}_{j}" }}'
        for i in range(size)
        for j in range(i)
    ]
    names = [f"m_{i}" for i in range(size)] + [f"k_{i}_{j}" for i in range(size) for j in range(i)]
    text = LONG_WORK.format(elements="\n".join(elements), last=size - 1)
    text += "[parameters]\n" + "\n".join(f"{name} = {{}}" for name in names) + "\n"
    browser.run(
        f"document.querySelector('textarea').value = {json.dumps(text)};"
        "document.querySelector('textarea').dispatchEvent(new Event('input'));"
        "new Promise((r) => setTimeout(r, 2000))"
    )
    assert browser.run("document.body.classList.contains('busy')")
    browser.run("document.getElementById('stop').click()")
    shown = enter(browser, models()["eppinger1988/two_mass"])
    assert shown["roots"]["code"] == 0


def test_completions_come_from_the_schema_and_are_typed_with_keys(browser):
    text = 'symflex = 1\n[elements]\nm = { type = "ma'
    enter(browser, text)
    press(browser, " ", "Space", modifiers=2)
    is_hidden = "document.getElementById('choices').hidden"
    browser.run(f"new Promise((r) => setInterval(() => {is_hidden} || r(), 20))")
    assert browser.run("document.querySelector('#choices [aria-selected=true]').firstChild.data") == "mass"
    press(browser, "Enter", "Enter")
    assert browser.run("document.querySelector('textarea').value").endswith('type = "mass')
    assert browser.run(is_hidden)


SPOILED = (
    '<img src=x onerror="window.spoiled=1">', "<script>window.spoiled=1</script>",
    "javascript:window.spoiled=1", "__import__('os').system('touch /spoiled')", "'; window.spoiled=1; '",
    "</style><svg onload=window.spoiled=1>", "\\input{/etc/passwd}", "$(window.spoiled=1)", "{{7*7}}",
    "\u202e\u0000\ufeff",
)  # fmt: skip
PLACES = (
    'title = "%"\n', "title = '''%'''\n", '[parameters]\nm = { value = "1 kg", doc = "%" }\n',
    '[parameters]\nm = { value = "1 kg", latex = "%" }\n', '[parameters]\n"%" = "1 kg"\n',
    '[outputs]\ny = "%"\n', '[elements]\na = { type = "%", at = "x" }\n',
    '[elements]\na = { type = "mass", at = "%", m = "%" }\n', '[signals]\ny = "%"\n', "# %\n%\n",
)  # fmt: skip
REST = """[elements.e]
type = "mass"
at = "x"
m = "m_e"
[inputs]
F = { force = "x" }
[outputs.X]
value = "x"
"""


def test_nothing_of_a_hundred_hostile_texts_runs(browser):
    browser.events.clear()
    for place in PLACES:
        for text in SPOILED:
            enter(browser, "symflex = 1\n" + place.replace("%", text) + REST)
    assert browser.run("window.spoiled === undefined")
    assert browser.run("document.querySelector('main :is(img, script, style, iframe)')") is None
    said, addresses = browser.complaints()
    assert said == []
    assert {address.split("/")[2] for address in addresses if "//" in address} <= {
        browser.address.split("/")[2]
    }
    assert enter(browser, models()[LOOP])["roots"]["code"] == 0


def test_without_a_network_the_page_opens_and_computes_again(browser, server):
    kept = browser.run("fetch('parts.json').then((found) => found.json())")["kept"]
    held = "caches.open('symflex-playground').then((c) => c.keys()).then((all) => all.map((r) => r.url))"
    until = time.monotonic() + 60
    while not all(any(url.endswith(name) for url in browser.run(held)) for name in kept):
        assert time.monotonic() < until
        time.sleep(0.05)
    server.shutdown()
    server.server_close()
    browser.open(browser.address)
    shown = enter(browser, models()["classics/quarter_car"])
    assert shown["roots"]["code"] == 0
