"""The report on the paper's models: what the paper states is computed, and the report opens and prints."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from symflex.budget import Silent
from symflex.report.article import report_article
from symflex.report.claims.read import read_claims
from symflex.report.facts import DataFact, ModelFacts
from symflex.report.page import report_page
from symflex.report.report import (
    compose,
    find_claims,
    find_measurements,
    find_specifications,
    name_specifications,
    write_chapters,
)
from tests.house.repository import specifications
from tests.independent import eppinger1988
from tests.unit.report.pages import Page

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "derivations" / "eppinger1988"
PUBLICATION = read_claims(FOLDER / "claims.toml")
DAY = "2001-02-03"

# Read off the paper: counts where it gives them, and figures by their numbers.
FIGURES = {
    "fig5": "rigid_body", "fig6": "polynomial_resonance", "fig7": "polynomial_resonance",
    "fig10": "sliding_free_beam", "fig11": "sliding_free_beam", "fig13": "lumped_bending_beam",
}  # fmt: skip
HOLD = (
    "modes second-order fitted-array too-few-zeros base-only-colocated infinity alternating same-poles "
    "real-zeros no-phase not-in-lumped lumped-colocated right-numbers two-and-two base-two-zeros "
    "printed-rigid-body printed-noncolocated high-gain base-against-link"
).split()
CONDITION = (
    "one-zero-per-mode two-zeros-three-poles bending lumped-noncolocated lumped-pair pair-and-one-zero "
    "same-character equal-frequencies dynamically-colocated"
).split()
FAIL = ["printed-colocated", "fifth-mode"]


pytestmark = pytest.mark.slow


def reported(paths):
    named = name_specifications(find_specifications(paths))
    measured, _ = find_measurements(paths)
    return compose(write_chapters(named, 2, Silent(), measured), DAY, find_claims(named.values()))


@pytest.fixture(scope="module")
def report():
    return reported([FOLDER])


@pytest.fixture(scope="module")
def claims(report):
    return {c["key"]: c for c in json.loads(report.files["data/claims.json"])["claims"]}


@pytest.fixture(scope="module")
def facts(report):
    found = {}
    for path in specifications(FOLDER, "*.toml"):
        document = json.loads(report.files[f"data/{path.stem}_facts.json"])
        found[path.stem] = {f["tf"]: f for f in document["transfer_functions"]}
    return found


def roots(report, stem, tf, kind):
    document = json.loads(report.files[f"data/{stem}_roots.json"])
    (found,) = (r for r in document["roots"] if r["tf"] == tf)
    return [complex(float(r["re"]), float(r["im"])) for r in found[kind] for _ in range(r["multiplicity"])]


def test_everything_is_certified(report):
    assert report.code == 0
    assert report.warnings == ()


@pytest.mark.parametrize("name", FIGURES)
def test_every_figure_of_the_paper_is_drawn(name, report):
    stem = FIGURES[name]
    number = name.removeprefix("fig")
    assert report.files[f"figures/{stem}_{name}.pdf"].startswith(b"%PDF")
    assert f"Figure {number}:" in report_page(report)


@pytest.mark.parametrize(("stem", "tf"), [("polynomial_resonance", "A_tip/V_cmd"), ("six_mass", "X_tip/F")])
def test_the_measured_modes_are_in_the_report(stem, tf, report):
    found = sorted(abs(s) for s in roots(report, stem, tf, "poles") if s.imag > 0)
    expected = [eppinger1988.radians_per_second(f) for f in eppinger1988.MODES_HZ]
    assert found == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize(
    ("stem", "tf", "zeros", "poles"),
    [
        ("rigid_body", "V_tip/V_cmd", 0, 2),  # "a second-order transfer function"
        ("polynomial_resonance", "A_tip/V_cmd", 11, 12),  # "five pairs of poles and five pairs of zeros"
        ("base_flexure", "V_tip/F", 2, 3),  # "two zeros and three poles"
        ("base_flexure", "V_motor/F", 2, 3),
        ("lumped_bending_beam", "X_tip/F", 2, 6),  # 'a "pair" of real zeros'
    ],
)
def test_the_counts_are_the_paper_s(stem, tf, zeros, poles, facts):
    found = facts[stem][tf]
    assert (found["zeros"], found["poles"]) == (zeros, poles)


@pytest.mark.parametrize(
    ("stem", "tf", "zeros", "poles"),
    [
        ("two_mass", "X_tip/F", 1, 2),  # "two poles are added while only one zero is added"
        ("six_mass", "X_tip/F", 5, 10),
        ("base_flexure", "V_tip/F", 2, 2),  # "two poles and two zeros have now been added"
        ("polynomial_resonance", "A_tip/V_cmd", 10, 10),  # "two poles and two zeros for each flexible mode"
    ],
)
def test_what_modes_add_is_the_paper_s(stem, tf, zeros, poles, facts):
    found = facts[stem][tf]
    assert (found["zeros_added"], found["poles_added"]) == (zeros, poles)


def test_the_beam_s_zeros_are_arranged_as_in_figure_11(report, facts):
    colocated, tip = (facts["sliding_free_beam"][tf] for tf in ("V_act/F", "V_tip/F"))
    assert colocated["alternates"]
    assert tip["mirrored_real_zeros"]
    on_axis = roots(report, "sliding_free_beam", "V_act/F", "zeros")
    real = roots(report, "sliding_free_beam", "V_tip/F", "zeros")
    assert all(z.real == 0 for z in on_axis)
    assert all(z.imag == 0 for z in real)
    assert sorted(z.real for z in real) == sorted(-z.real for z in real)


@pytest.mark.parametrize(
    ("key", "verdict"),
    [
        *((key, "holds") for key in HOLD),
        *((key, "holds with a condition") for key in CONDITION),
        *((key, "does not hold") for key in FAIL),
    ],
)
def test_claims_are_judged(key, verdict, claims):
    assert claims[key]["verdict"] == verdict
    assert claims[key]["evidence"]


def test_every_claim_is_expected_here_or_not_examined(claims):
    rest = set(claims) - {*HOLD, *CONDITION, *FAIL}
    assert all(claims[key]["verdict"] == "not examined" for key in rest)


def told(stem, decibels, *, is_synthetic=False):
    """Return facts as they would be beside data; nothing here is measured."""
    fact = DataFact("A_tip/V_cmd", decibels, 5.0, is_synthetic)
    return ModelFacts(stem, "", "", (), False, False, (), (), data=(fact,))


@pytest.mark.parametrize("key", ["rigid-matches", "only-fit"])
def test_claims_about_the_experiment_are_not_judged_by_the_synthetic_stand_in(key):
    (claim,) = [c for c in PUBLICATION.claims if c.key == key]
    models = [told(stem, 0.1, is_synthetic=True) for stem in ("polynomial_resonance", "rigid_body")]
    found = claim.judge({m.stem: m for m in models})
    assert found.verdict == "not examined"
    assert "synthetic and was computed from polynomial_resonance" in "".join(map(str, found.evidence))


def test_only_the_model_fitted_by_hand_is_said_to_match_measured_data():
    (claim,) = [c for c in PUBLICATION.claims if c.key == "only-fit"]
    good, bad = told("polynomial_resonance", 1.0), told("rigid_body", 9.0)
    assert claim.judge({m.stem: m for m in (good, bad)}).verdict == "holds"
    assert claim.judge({m.stem: m for m in (good, told("rigid_body", 1.0))}).verdict == "does not hold"
    synthetic = told("polynomial_resonance", 0.1, is_synthetic=True)
    assert claim.judge({synthetic.stem: synthetic}).verdict == "not examined"


@pytest.mark.parametrize(
    ("stem", "hertz"),
    [("two_mass_force", 4.7585), ("base_flexure_force", 6.9054), ("rigid_body_force", None)],
)
def test_the_bandwidth_of_each_loop_is_that_of_the_loops_readme(stem, hertz, report):
    (loop,) = json.loads(report.files[f"data/{stem}_facts.json"])["loops"]
    assert loop["is_bandwidth_unlimited"] is (hertz is None)
    assert loop["bandwidth_hz"] == (None if hertz is None else pytest.approx(hertz, rel=1e-4))


def test_stable_gains_are_those_of_the_loops_readme(report):
    # tests/derivations/test_loops.py and tests/independent/test_stability_boundaries.py judge the numbers.
    for stem, end in (
        ("two_mass_force", 5.4510),
        ("lumped_bending_beam_force", 4.7665),
        ("rigid_body_force", None),
    ):
        (loop,) = json.loads(report.files[f"data/{stem}_facts.json"])["loops"]
        ((low, high),) = loop["stable"]
        assert low == 0
        assert high is None if end is None else high == pytest.approx(end, rel=1e-4)
        assert report.files[f"figures/{stem}_locus.pdf"].startswith(b"%PDF")


def test_quotations_are_short_and_keys_unique():
    keys = [claim.key for claim in PUBLICATION.claims]
    assert len(keys) == len(set(keys))
    assert all(re.fullmatch(r"[a-z-]+", key) for key in keys)


def test_a_claim_is_refuted_where_the_model_is_another(tmp_path):
    # With the tip at the joint, Newton's law on the body puts the zeros on the imaginary axis.
    text = (FOLDER / "lumped_bending_beam.toml").read_text("utf-8")
    (tmp_path / "lumped_bending_beam.toml").write_text(text.replace('"150 mm"', '"1 mm"'), encoding="utf-8")
    named = name_specifications([tmp_path / "lumped_bending_beam.toml"])
    files = compose(write_chapters(named, 1, Silent()), "", [PUBLICATION]).files
    judged = {c["key"]: c["verdict"] for c in json.loads(files["data/claims.json"])["claims"]}
    assert judged["lumped-noncolocated"] == "does not hold"
    assert judged["lumped-pair"] == "does not hold"
    assert judged["lumped-colocated"] == "holds"
    assert judged["modes"] == "not examined"


def test_the_page_is_sound(report):
    page = Page(report_page(report))
    assert "script" not in page.elements
    assert len(page.ids) == len(set(page.ids))
    assert {a[1:] for a in page.addresses if a.startswith("#")} <= set(page.ids)
    assert {a for a in page.addresses if not a.startswith("#")} <= set(report.files)


# ------------------------------------------------------------------------------------ browser and paper


def all_files(report):
    return {
        **report.files,
        "report.tex": report_article(report).encode(),
        "index.html": report_page(report).encode(),
    }


@pytest.fixture(scope="module")
def written(report, tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    for name, content in all_files(report).items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)
    return folder


@pytest.mark.needs_tool("pdflatex")
def test_the_command_line_writes_the_same_bytes_under_another_hash_seed(tmp_path):
    paths = [FOLDER / f"{stem}.toml" for stem in ("rigid_body", "two_mass")]
    command = [sys.executable, "-m", "symflex", "report", *paths, "-o", tmp_path, "-j", "2", "--date", DAY]
    environment = {**os.environ, "PYTHONHASHSEED": "2025"}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == f"open {tmp_path / 'index.html'}"
    found = {str(p.relative_to(tmp_path)): p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()}
    assert found.pop("report.pdf").startswith(b"%PDF")
    expected = all_files(reported(paths))
    assert found.keys() == expected.keys()
    assert [name for name in expected if expected[name] != found[name]] == []


@pytest.mark.needs_tool("chromium")
@pytest.mark.parametrize("width", [390, 1200])
def test_a_browser_shows_the_page_without_a_complaint(width, written, tmp_path):
    shot = tmp_path / "shot.png"
    log = tmp_path / "net.json"
    command = [
        "chromium", "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={tmp_path / 'profile'}",
        "--disable-component-update", "--disable-background-networking", "--no-first-run", "--disable-sync",
        "--enable-logging=stderr", "--v=0", f"--log-net-log={log}", f"--window-size={width},1000",
        f"--screenshot={shot}", (written / "index.html").as_uri(),
    ]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    assert shot.stat().st_size > 10_000
    assert "CONSOLE" not in done.stderr
    # A browser asks for things of its own; the page must be the reason for none.
    asked = re.findall(r'"url":"(https?:[^"]*)"', log.read_text("utf-8"))
    own = re.compile(r"https?://[\w.-]*(google|gstatic|googleapis|chromium|gvt1)[\w.-]*/")
    assert [url for url in asked if not own.match(url)] == []


@pytest.mark.needs_tool("pdflatex")
def test_the_article_compiles_without_a_warning(written, tmp_path):
    for name in ("report.tex", "figures"):
        (tmp_path / name).symlink_to(written / name)
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "report.tex"]
    for _ in range(3):
        subprocess.run(command, cwd=tmp_path, capture_output=True, check=True, timeout=120)
    log = (tmp_path / "report.log").read_text("latin-1")
    assert re.findall(r"^.*(?:Warning|Overfull|Underfull).*$", log, re.MULTILINE) == []
