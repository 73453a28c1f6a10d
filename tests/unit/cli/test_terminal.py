"""Text from files, wherever it comes from, drives no terminal."""

import io
import unicodedata
import zipfile

import numpy as np
import pytest

from symflex.cli import run
from symflex.cli.reporting import coloured
from tests.house.repository import ROOT

# Erase the screen; set the title; the same introducers in one byte; turn the direction of writing.
DRIVING = "\x1b[2J\x1b]0;title\x07\x9b2J\x9d0;t\x9c\u202e\r\x08"
ESCAPED = "\\u001b[2J\\u001b]0;title\\u0007\\u009b2J\\u009d0;t\\u009c\\u202E\\r\\b"
SPEC = f"""
symflex = 1
title = "title {ESCAPED}"
source = "source {ESCAPED}"
doc = "doc {ESCAPED}"
[parameters]
m = {{ value = "1 kg", doc = "mass {ESCAPED}" }}
c = {{ value = "1 N*s/m", doc = "damper {ESCAPED}" }}
K = "1 N/m"
[elements]
b = {{ type = "mass", at = "x", m = "m" }}
d = {{ type = "damper", between = ["x", "ground"], b = "c" }}
a = {{ type = "force_source", at = "x", f = "K*(F - x)" }}
[inputs]
F = {{}}
[outputs]
X = "x"
[published."X/F"]
source = "published {ESCAPED}"
expr = "1/(m*s^2)"
[figures.one]
kind = "bode"
title = "figure {ESCAPED}"
[analysis]
band = ["0.01 Hz", "1 Hz"]
"""
COMMANDS = (
    "check", "derive", "roots", "roots --sensitivity", "roots --explain", "rational", "stability --gain K",
    "colocation --tf X/F --with X/F", "audit", "export --to numpy", "export --to c", "export --to julia",
    "export --to matlab", "export --to latex", "sweep --over m=1,2 --workers 1",
    "measure --tf X/F --band 0.05 0.4 -o a.csv", "check --json", "derive --json", "audit --json",
)  # fmt: skip


def driving(text):
    return {c for c in text if unicodedata.category(c) in ("Cc", "Cf") and c not in "\n\t"}


@pytest.fixture
def said(tmp_path, monkeypatch, capsys):
    """What a command prints, by its words."""
    monkeypatch.chdir(tmp_path)

    def told(*words, code=None):
        ended = run(list(words))
        printed = capsys.readouterr()
        assert code is None or ended == code, printed.err
        return printed.out + printed.err

    return told


def that_drive(said, folder, commands):
    """Return the commands whose output about the specification drives a terminal; all have to succeed."""
    (folder / "a\x07\x9b2J.toml").write_text(SPEC, encoding="utf-8")
    words = {command: command.split() for command in commands}
    found = {c: driving(said(w[0], "a\x07\x9b2J.toml", *w[1:], code=0)) for c, w in words.items()}
    return {command: driven for command, driven in found.items() if driven}


@pytest.mark.slow
def test_a_specification_drives_no_terminal(said, tmp_path):
    assert that_drive(said, tmp_path, COMMANDS) == {}
    assert "title " in said("check", "a\x07\x9b2J.toml")


@pytest.mark.slow
def test_a_specification_that_is_drawn_drives_no_terminal(said, tmp_path):
    assert that_drive(said, tmp_path, ("plot one -o a.svg", "report --no-pdf -o report -j 1")) == {}


def test_comments_of_columns_drive_no_terminal(said, tmp_path):
    values = [(f, 1 / (100 - f * f + 0.4j * f + 0.1)) for f in range(1, 40)]
    lines = [f"{f},{value.real},{value.imag}" for f, value in values]
    comment = DRIVING.replace("\r", "")
    head = f"# note {comment}\n# tf: X{comment}/F\n# synthetic: yes\n"
    (tmp_path / "a\x07.csv").write_text(head + "frequency_hz,re,im\n" + "\n".join(lines), encoding="utf-8")
    assert driving(said("fit", "a\x07.csv", "--modes", "1")) == set()
    assert driving(said("fit", "a\x07.csv", "--modes", "1", "--json")) == set()


def test_names_in_archives_drive_no_terminal(said, tmp_path):
    with zipfile.ZipFile(tmp_path / "a\x07.npz", "w") as file:
        content = io.BytesIO()
        np.save(content, np.arange(3.0))
        file.writestr(f"name {DRIVING}.npy", content.getvalue())
    printed = said("fit", "a\x07.npz")
    assert "SF602" in printed
    assert driving(printed) == set()
    assert driving(said("plot", "sweep", "a\x07.npz")) == set()


def test_usage_errors_drive_no_terminal(said):
    for words in (
        ["check", "a", "\x07\x9b2J"],
        ["\x07\x9b2J"],
        ["check", "--\x07"],
        ["plot", "a.toml", "bode", "--modes", "\x07"],
    ):
        assert driving(said(*words)) == set()


def test_commands_print_through_what_escapes():
    modules = (ROOT / "symflex" / "cli").glob("*.py")
    direct = {p.name for p in modules if "click.echo" in p.read_text(encoding="utf-8")}
    assert direct <= {"__init__.py", "reporting.py"}


def test_verdicts_are_green_yellow_or_red_on_a_terminal():
    text = coloured("X/F   certified: 2 of 2 roots enclosed; unstable\nNOT CERTIFIED: instability")
    assert text == (
        "X/F   \x1b[32m\x1b[1mcertified\x1b[0m: 2 of 2 roots enclosed; \x1b[31m\x1b[1munstable\x1b[0m\n"
        "\x1b[33m\x1b[1mNOT CERTIFIED\x1b[0m: instability"
    )
