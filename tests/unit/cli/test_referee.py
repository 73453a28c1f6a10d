"""The commands that read papers: ``referee``, ``audit --latex`` and ``new --from FILE.tex``."""

import pytest

from tests.unit.cli.commands import OSCILLATOR

PAPER = r"""
\begin{align} \frac{X(s)}{F(s)} &= \frac{1}{ms^2 + k} \label{one} \\
\frac{V(s)}{F(s)} &= \frac{s}{ms^2 + 2k} \label{two} \end{align}
\[ m\ddot x + kx = F(t) \]
"""


@pytest.fixture
def files(tmp_path):
    (tmp_path / "model.toml").write_text(OSCILLATOR)
    (tmp_path / "paper.tex").write_text(PAPER)
    return tmp_path


def test_a_paper_is_judged_with_a_page_and_a_list_of_errata(shell, files):
    page, errata = files / "page.html", files / "errata.tex"
    command = ("referee", str(files / "paper.tex"), "--model", str(files / "model.toml"))
    done = shell(*command, "-o", str(page), "--errata", str(errata), "--json")
    assert done.code == 0
    assert done.json["schema"] == "symflex.referee/1"
    assert [(f["label"], f["verdict"]) for f in done.json["formulas"][:2]] == [
        ("one", "equal"),
        ("two", "different"),
    ]
    assert done.json["formulas"][1]["slip"] == "denominator: 2*k should be k"
    assert "DIFFERS" in page.read_text()
    assert r"\eqref{two}: for $2 k$ read $k$" in errata.read_text()
    assert shell(*command, "--strict").code == 4


def test_one_formula_of_a_paper_is_audited(shell, files):
    command = ("audit", str(files / "model.toml"), "--latex", str(files / "paper.tex"), "--equation")
    done = shell(*command, "two")
    assert "V/F   DIFFERS from the derived function: proved" in done.out
    assert "X/F" not in done.out
    assert shell(*command, "three").code == 2
    assert shell("audit", str(files / "model.toml"), "--equation", "two").code == 2


def test_equations_of_motion_become_a_specification(shell, files):
    done = shell("new", "--from", str(files / "paper.tex"), "-o", str(files / "made.toml"))
    assert done.code == 0
    assert shell("derive", str(files / "made.toml"), "--tf", "X/F").out.endswith("m*s^2 + k\n")


def test_a_paper_that_reads_files_elsewhere_is_refused_at_its_place(shell, files):
    (files / "paper.tex").write_text("\n\\input{../secret}")
    done = shell("referee", str(files / "paper.tex"), "--model", str(files / "model.toml"))
    assert done.code == 3
    assert "paper.tex:2:1: error[SF115]: '../secret' lies outside the folder of the paper" in done.err
