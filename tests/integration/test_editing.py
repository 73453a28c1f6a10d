"""Twenty files edited through the language server: problems as those of a check, names, and fixes."""

import io
import json
import random
import re
import statistics
import time
from contextlib import redirect_stdout
from itertools import islice
from pathlib import Path

import pytest

from symflex.cli import run
from symflex.editor import examined, fixes, renamed
from tests.house.repository import ROOT
from tests.unit.editor.test_server import Editor, position

FILES = (
    "classics/quarter_car", "classics/rod_tip_mass", "classics/one_link_arm", "classics/clamped_free",
    "classics/shaft_discs", "distributed/heated_rod", "eppinger1988/two_mass", "eppinger1988/six_mass",
    "eppinger1988/rigid_body", "eppinger1988/loops/two_mass_position", "eppinger1988/polynomial_resonance",
    "frames/l_frame", "mechatronics/acc_benchmark", "mechatronics/elastic_joint",
    "mechatronics/quadruple_tank", "nonlinear/buck_converter", "nonlinear/furuta_pendulum",
    "nonlinear/magnetic_levitation", "transducers/galvanometer", "transducers/loudspeaker_closed_box",
)  # fmt: skip
EDITS = 16  # of each file, half of them back: 320 in all
MEDIAN = 0.1  # seconds of the processor a keystroke; twice what is asked, as other tests run beside it

pytestmark = pytest.mark.slow


def text_of(name):
    return (ROOT / "derivations" / f"{name}.toml").read_text(encoding="utf-8")


def edits(text, seed):
    """Return changes as an author makes them: (start, end, what stands there instead)."""
    draw = random.Random(seed)
    while True:
        at = draw.randrange(len(text) - 1)
        line = text.rfind("\n", 0, at) + 1
        end = text.find("\n", at)
        yield draw.choice([
            (at, at + 1, ""),
            (at, at, draw.choice('x=" ]}#.0é\U0001d714\n')),
            (at, at + draw.randrange(1, 12), ""),
            (line, end + 1, ""),
            (line, line, text[line : end + 1]),
            (line, line, "[elements]\n"),
        ])  # fmt: skip


@pytest.fixture(scope="module")
def editor():
    client = Editor()
    client.end.cancel()
    with client.process:
        yield client
        client.process.kill()


def checked(path):
    """Return the problems of ``check --json`` with their places."""
    out = io.StringIO()
    with redirect_stdout(out):
        run(["check", str(path), "--json"])
    said = json.loads(out.getvalue())
    return said["problems"] or said["warnings"]


def offset_of(text, line, column):
    """Return the offset of a line and a column that count from 1."""
    return sum(len(each) + 1 for each in text.split("\n")[: line - 1]) + column - 1


def as_editor(text, problem):
    """Return a problem as an editor gets it; one without extent has its next character."""
    start = offset_of(text, problem["line"], problem["column"])
    end = offset_of(text, problem["end_line"], problem["end_column"])
    message = problem["message"] + (f"\n{problem['hint']}" if problem["hint"] else "")
    return problem["code"], message, position(text, start), position(text, max(end, start + 1))


@pytest.mark.parametrize("name", FILES)
def test_problems_after_each_edit_are_those_of_a_check(editor, tmp_path, name):
    for beside in (ROOT / "derivations" / name).parent.glob("*.toml"):
        (tmp_path / beside.name).write_bytes(beside.read_bytes())
    path = tmp_path / f"{Path(name).name}.toml"
    document, text = {"uri": path.as_uri(), "version": 1}, text_of(name)
    editor.tell("textDocument/didOpen", textDocument={**document, "languageId": "toml", "text": text})
    assert editor.problems() == []
    changes = []
    for start, end, new in islice(edits(text, name), EDITS // 2):
        changes += [(start, end, new), (start, start + len(new), text[start:end])]  # and back
    for start, end, new in changes:
        where = {"start": position(text, start), "end": position(text, end)}
        document["version"] += 1
        editor.tell(
            "textDocument/didChange", textDocument=document, contentChanges=[{"range": where, "text": new}]
        )
        text = text[:start] + new + text[end:]
        path.write_text(text, encoding="utf-8", newline="")
        shown = [(d["code"], d["message"], d["range"]["start"], d["range"]["end"]) for d in editor.problems()]
        assert shown == [as_editor(text, problem) for problem in checked(path)]


@pytest.mark.parametrize("name", FILES)
def test_every_name_of_a_file_changes_and_changes_back(name):
    file, text = str(ROOT / "derivations" / f"{name}.toml"), text_of(name)
    document = examined(text, file)
    defined = {each.name for each in document.names if each.is_definition}
    assert defined
    for old in defined:
        changed = examined(renamed(document, old, "new_name"), file)
        assert changed.model is not None and changed.problems == document.problems == ()
        assert old not in {each.name for each in changed.names}
        assert renamed(changed, "new_name", old) == text


@pytest.mark.parametrize("name", FILES)
def test_a_fix_of_a_slip_leaves_a_file_that_checks(name):
    file, text = str(ROOT / "derivations" / f"{name}.toml"), text_of(name)
    words = re.findall(r'(?:type|at|between|force|unit) = \[?"([A-Za-z_]{4,})"', text)
    slips = [(f'"{word}"', f'"{word[:-2]}{word[-1]}"') for word in dict.fromkeys(words)]
    slips += [
        ("symflex = 1\n", ""),
        ("[outputs]", "[ouputs]"),
        ("[inputs]", "[input]"),
        ("[parameters]", "[paramters]"),
    ]
    offered = 0
    for right, wrong in slips:
        document = examined(text.replace(right, wrong, 1), file)
        for problem in document.problems[:1]:
            for fix in fixes(document, problem):
                offered += 1
                after = examined(fix.applied(document.source.text), file)
                assert len(after.problems) < len(document.problems)
                assert after.model is not None or len(document.problems) > 1
    assert offered >= 3


def test_a_keystroke_in_a_file_of_300_lines_is_answered_at_once():
    masses = range(74)
    lines = ["symflex = 1", "[elements]"]
    for i in masses:
        lines += [
            f'm{i} = {{ type = "mass", at = "x{i}", m = "m_{i}" }}',
            f'k{i} = {{ type = "spring", between = ["x{i}", "x{i + 1}"], k = "k_{i}" }}',
        ]
    lines += ["[inputs]", 'F = { force = "x0" }', "[outputs]", 'X = "x0"', "[parameters]"]
    lines += [f'm_{i} = "1 kg"\nk_{i} = "{i + 3} N/m"' for i in masses]
    text, times = "\n".join(lines), []
    for start, end, new in islice(edits(text, 1), 25):
        changed = text[:start] + new + text[end:]
        began = time.process_time()
        examined(changed, "a.toml")
        times.append(time.process_time() - began)
    assert statistics.median(times) < MEDIAN
