"""JupyterLite, which runs notebooks in a browser: ``%%symflex`` shows there what it shows here.

``SYMFLEX_WEBASSEMBLY`` names a folder with Pyodide and wheels for it, which ``.ci/run`` fetches, those of
the kernel and of SymPy in ``notebook`` below it. Everything is served from this machine; as there is no
wheel of numpy, the page's own part of numpy stands in for it.
"""

import hashlib
import inspect
import json
import os
import re
import subprocess
import sys
import time
import zipfile
from pathlib import Path
from urllib.parse import quote

import pytest

import symflex
from tests.house.repository import ROOT
from tests.integration.chromium import Chromium, serving

RUNTIME = os.environ.get("SYMFLEX_WEBASSEMBLY")
PYODIDE = "pyodide.mjs pyodide.asm.mjs pyodide.asm.wasm python_stdlib.zip".split()
KERNEL = "@jupyterlite/pyodide-kernel-extension:kernel"
MODEL = (ROOT / "derivations" / "mechatronics" / "elastic_joint.toml").read_text(encoding="utf-8")
BROKEN = MODEL.replace("unknowns", "unknwons", 1)


def answers(model):
    """Return what the formulas and the roots of a model print."""
    bound = [function.bind() for function in model.transfer_functions()]
    return [[str(one), str(one.pole_zero_map())] for one in bound]


CELL = f"""
import json, piplite
await piplite.install("symflex")
get_ipython().run_line_magic("load_ext", "symflex")
get_ipython().run_cell_magic("symflex", "model", {MODEL!r})
get_ipython().run_cell_magic("symflex", "", {BROKEN!r})
{inspect.getsource(answers)}
print("BEGIN" + json.dumps(answers(model)) + "END")
"""
OUTPUT = "[...document.querySelectorAll('.jp-OutputArea-output')].map(e => e.innerText).join('\\n')"
MINUTES = 5
"""How long a loaded machine may take to start the kernel and to answer; alone it takes a quarter of one."""

pytestmark = [
    pytest.mark.slow,
    pytest.mark.needs_tool("chromium"),
    pytest.mark.needs_module("jupyterlite_core", "jupyterlite_pyodide_kernel"),
    pytest.mark.skipif(not RUNTIME, reason="SYMFLEX_WEBASSEMBLY names no folder with Pyodide"),
]


def wheel(folder, name, version, sources):
    """Write a wheel of pure Python, which is not installed anywhere but in the browser."""
    path = folder / f"{name}-{version}-py3-none-any.whl"
    info = f"{name}-{version}.dist-info"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for member, content in sources.items():
            archive.writestr(member, content)
        archive.writestr(f"{info}/METADATA", f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
        archive.writestr(f"{info}/WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
        archive.writestr(f"{info}/RECORD", "")
    return path


def locked(wheels):
    """Return the list of packages by which Pyodide loads these wheels, each with all others it needs."""
    packages = {}
    for path in wheels:
        with zipfile.ZipFile(path) as archive:
            tops = {member.split("/")[0].removesuffix(".py") for member in archive.namelist()}
            metadata = next(m for m in archive.namelist() if m.endswith(".dist-info/METADATA"))
            said = archive.read(metadata).decode()
        name = re.sub(r"[-_.]+", "-", re.search(r"^Name: (.*)$", said, re.M)[1]).lower()
        packages[name] = {
            "name": name,
            "version": re.search(r"^Version: (.*)$", said, re.M)[1],
            "file_name": path.name,
            "sha256": hashlib.sha256(path.read_bytes()).hexdigest(),
            "imports": sorted(top for top in tops if "." not in top),
            "depends": [],
            "install_dir": "site",
            "package_type": "package",
            "unvendored_tests": False,
        }
    needs = {
        "symflex": ["click", "mpmath", "numpy", "python-flint", "sympy"],
        "jedi": ["parso"],
        "ipython": [
            "asttokens", "decorator", "executing", "ipython-pygments-lexers", "matplotlib-inline",
            "prompt-toolkit", "pure-eval", "pygments", "six", "stack-data", "traitlets", "wcwidth",
        ],
    }  # fmt: skip
    for name, others in needs.items():
        packages[name]["depends"] = others
    return packages


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lite")
    served = folder / "static" / "pyodide"
    served.mkdir(parents=True)
    runtime = Path(RUNTIME)
    for name in PYODIDE:
        (served / name).write_bytes((runtime / "node_modules" / "pyodide" / name).read_bytes())
    given = [*runtime.glob("*.whl"), *(runtime / "notebook").glob("*.whl")]
    for path in given:
        (served / path.name).write_bytes(path.read_bytes())
    sources = {
        path.relative_to(ROOT).as_posix(): path.read_bytes()
        for path in sorted((ROOT / "symflex").rglob("*"))
        if path.is_file() and path.suffix != ".pyc"
    }
    stand_in = {"numpy.py": (ROOT / "docs" / "playground" / "arrays.py").read_bytes()}
    wheel(served, "symflex", symflex.__version__, sources)
    wheel(served, "numpy", "2.0.0", stand_in)
    lock = json.loads((runtime / "node_modules" / "pyodide" / "pyodide-lock.json").read_text())
    lock["packages"] = locked(sorted(served.glob("*.whl")))
    (served / "pyodide-lock.json").write_text(json.dumps(lock))
    settings = {"litePluginSettings": {KERNEL: {"disablePyPIFallback": True}}}
    (folder / "jupyter-lite.json").write_text(
        json.dumps({"jupyter-lite-schema-version": 0, "jupyter-config-data": settings})
    )
    command = [
        sys.executable,
        "-m",
        "jupyterlite_core.app",
        "build",
        "--apps",
        "repl",
        "--output-dir",
        "site",
    ]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    return folder / "site"


@pytest.fixture(scope="module")
def shown(site, tmp_path_factory):
    """What a cell that runs :data:`CELL` shows, and the addresses that were asked for."""
    server = serving(site)
    browser = Chromium(tmp_path_factory.mktemp("chromium"))
    host = f"http://127.0.0.1:{server.server_address[1]}"
    browser.ask("Page.navigate", url=f"{host}/repl/index.html?kernel=python&code={quote(CELL)}")
    until = time.monotonic() + 60 * MINUTES
    text = ""
    while not text.rstrip().endswith(("END", "Error")) and time.monotonic() < until:
        time.sleep(0.5)
        text = browser.run(OUTPUT)
    outside = [url for url in browser.complaints()[1] if not url.startswith((host, "data:", "blob:"))]
    browser.close()
    server.shutdown()
    server.server_close()
    return text, outside


def test_a_cell_shows_what_it_shows_here_and_asks_nothing_outside(shown):
    text, outside = shown
    assert outside == []
    found = re.search("BEGIN(.*)END", text, re.S)
    assert found, text[-3000:]
    assert json.loads(found[1]) == answers(symflex.loads(MODEL))


def test_a_mistake_in_a_cell_has_its_place_and_no_traceback(shown):
    text, _ = shown
    assert "Traceback" not in text
    assert re.search(r"<cell>:\d+:\d+: error\[SF\d+\]", text)
