"""The program in WebAssembly, as a page runs it: what it prints is what it prints here, byte for byte.

``SYMFLEX_WEBASSEMBLY`` names a folder with Pyodide and the wheels of python-flint, click and mpmath for it,
which ``.ci/run`` fetches. There are no wheels of numpy and scipy among them: what needs these says so.
"""

import json
import os
import subprocess
import zipfile
from pathlib import Path

import pytest

from symflex.cli import run
from tests.house.repository import ROOT

RUNTIME = os.environ.get("SYMFLEX_WEBASSEMBLY")
LACKING = "error[SF902]: this needs the library numpy, which is not installed here"
FOLDER = ROOT / "derivations"
MODELS = sorted(
    str(path.relative_to(FOLDER)) for path in FOLDER.rglob("*.toml") if path.name != "claims.toml"
)

pytestmark = [
    pytest.mark.slow,
    pytest.mark.needs_tool("node"),
    pytest.mark.skipif(not RUNTIME, reason="SYMFLEX_WEBASSEMBLY names no folder with Pyodide"),
]


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    """What each command printed in WebAssembly: exit code, output and messages."""
    folder = tmp_path_factory.mktemp("webassembly")
    with zipfile.ZipFile(folder / "package.zip", "w") as packed:
        for path in (ROOT / "symflex").rglob("*"):
            if path.is_file() and "__pycache__" not in path.parts:
                packed.write(path, path.relative_to(ROOT))
    jobs = [[model, command] for model in MODELS for command in ("check", "derive")]
    jobs += [[model, "roots"] for model in MODELS if model.startswith("mechatronics/")]
    (folder / "jobs.json").write_text(json.dumps(jobs))
    script = str(Path(__file__).with_name("webassembly.mjs"))
    given = [RUNTIME, folder / "package.zip", FOLDER, folder / "jobs.json", folder / "answers.json"]
    done = subprocess.run(["node", script, *map(str, given)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    read = json.loads((folder / "answers.json").read_text())
    return {tuple(job): answer for job, answer in zip(jobs, read, strict=True)}


def test_it_prints_the_same_formulas_problems_and_roots(answers, capsys, monkeypatch):
    differ, lacking = [], []
    for (model, command), (code, out, err) in answers.items():
        if LACKING in err:
            lacking.append((model, command))
            continue
        monkeypatch.chdir((FOLDER / model).parent)
        expected = run([command, Path(model).name])
        if (code, out) != (expected, capsys.readouterr().out):
            differ.append((model, command, err[-300:]))
    assert not differ
    # Tapered members are integrated in doubles first, and roots of beams begin with samples of a function.
    assert all(command != "check" for _, command in lacking)
    not_derived = {model for model, command in lacking if command == "derive"}
    assert all(model.startswith(("tapers/", "frames/")) for model in not_derived)
