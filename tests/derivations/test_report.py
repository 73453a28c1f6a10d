"""The report on the paper's models: what the paper states is computed, and the report opens and prints."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from symflex.budget import Silent
from symflex.report.article import report_article
from symflex.report.claims.claim import claims_json, judge_all
from symflex.report.claims.read import read_claims
from symflex.report.facts import DataFact, LoopFacts, ModelFacts, facts_of
from symflex.report.page import report_page
from symflex.report.report import compose, find_measurements, name_specifications, write_chapters
from symflex.report.study import Study
from tests.independent import eppinger1988
from tests.unit.report.models import SMALL, SYMBOLIC
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


SHOWN = (
    "rigid_body",
    "polynomial_resonance",
    "sliding_free_beam",
    "lumped_bending_beam",
    "loops/two_mass_force",
)
"""The models of the report: those of the paper's figures, one of them beside data, and a loop."""
JUDGED = (
    "two_mass", "six_mass", "base_flexure", "loops/base_flexure_force", "loops/rigid_body_force",
    "loops/lumped_bending_beam_position", "loops/lumped_bending_beam_force",
)  # fmt: skip
"""What claims are about besides."""
SLIDING = {
    "sliding_free_beam_force": LoopFacts(
        "K", "", ((0.0, 2.20546),), 2, (9.67351,), True, True, 4.56668, True
    ),
    "sliding_free_beam_position": LoopFacts("K", "N/m", ((0.0, 1e5),), 0, (), True, True, 6.59133, False),
}
"""Loops about the beam, as docs/force-loop.md prints them: its sessions are run by tests/docs/."""

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def chapters():
    measured, _ = find_measurements([FOLDER])
    named = name_specifications([FOLDER / f"{name}.toml" for name in SHOWN])
    return write_chapters(named, 0, Silent(), measured)


@pytest.fixture(scope="module")
def report(chapters):
    return compose(chapters, DAY, [PUBLICATION])


@pytest.fixture(scope="module")
def models(chapters):
    """The facts about each model; chapters hold them already."""
    paths = [FOLDER / f"{name}.toml" for name in JUDGED]
    found = {c.stem: c.facts for c in chapters} | {p.stem: facts_of(Study.of(p, p.stem)) for p in paths}
    return found | {
        stem: ModelFacts(stem, source=PUBLICATION.name, loops=(loop,)) for stem, loop in SLIDING.items()
    }


def verdicts(models):
    document = claims_json(PUBLICATION, judge_all(PUBLICATION, [*models.values()]))
    return {claim["key"]: claim for claim in document["claims"]}


@pytest.fixture(scope="module")
def claims(models):
    return verdicts(models)


def function(models, stem, tf):
    return next(f for f in models[stem].functions if f.tf == tf)


def test_everything_is_certified(report, models):
    assert report.code == 0
    assert report.warnings == ()
    assert [stem for stem, facts in models.items() if not all(f.certified for f in facts.functions)] == []


def test_every_figure_of_the_paper_is_drawn(report):
    page = report_page(report)
    for name, stem in FIGURES.items():
        assert report.files[f"figures/{stem}_{name}.pdf"].startswith(b"%PDF"), name
        assert f"Figure {name.removeprefix('fig')}:" in page


def test_the_measured_modes_are_in_the_facts(models):
    expected = [eppinger1988.radians_per_second(f) for f in eppinger1988.MODES_HZ]
    for stem, tf in (("polynomial_resonance", "A_tip/V_cmd"), ("six_mass", "X_tip/F")):
        found = sorted(abs(complex(p.re, p.im)) for p in function(models, stem, tf).poles if p.im > 0)
        assert found == pytest.approx(expected, rel=2e-3), stem


def test_the_files_of_a_report_hold_the_facts_and_their_roots(report, models):
    document = json.loads(report.files["data/sliding_free_beam_facts.json"])
    assert document == json.loads(json.dumps(models["sliding_free_beam"].to_json_dict()))
    for entry in json.loads(report.files["data/sliding_free_beam_roots.json"])["roots"]:
        found = function(models, "sliding_free_beam", entry["tf"])
        for kind, roots in (("poles", found.poles), ("zeros", found.zeros)):
            # The file has fifteen digits of each.
            written = [x for r in entry[kind] for x in (float(r["re"]), float(r["im"]))]
            assert written == pytest.approx([x for r in roots for x in (r.re, r.im)], rel=1e-14)


def test_the_counts_are_the_paper_s(models):
    for stem, tf, zeros, poles in (
        ("rigid_body", "V_tip/V_cmd", 0, 2),  # "a second-order transfer function"
        ("polynomial_resonance", "A_tip/V_cmd", 11, 12),  # "five pairs of poles and five pairs of zeros"
        ("base_flexure", "V_tip/F", 2, 3),  # "two zeros and three poles"
        ("base_flexure", "V_motor/F", 2, 3),
        ("lumped_bending_beam", "X_tip/F", 2, 6),  # 'a "pair" of real zeros'
    ):
        assert function(models, stem, tf).counts == (zeros, poles), (stem, tf)


def test_what_modes_add_is_the_paper_s(models):
    for stem, tf, zeros, poles in (
        ("two_mass", "X_tip/F", 1, 2),  # "two poles are added while only one zero is added"
        ("six_mass", "X_tip/F", 5, 10),
        ("base_flexure", "V_tip/F", 2, 2),  # "two poles and two zeros have now been added"
        ("polynomial_resonance", "A_tip/V_cmd", 10, 10),  # "two poles and two zeros for each flexible mode"
    ):
        found = function(models, stem, tf).to_json_dict()
        assert (found["zeros_added"], found["poles_added"]) == (zeros, poles), (stem, tf)


def test_the_beam_s_zeros_are_arranged_as_in_figure_11(models):
    colocated, tip = (function(models, "sliding_free_beam", tf) for tf in ("V_act/F", "V_tip/F"))
    assert colocated.alternates
    assert tip.has_mirrored_real_zeros
    assert all(z.re == 0 for z in colocated.zeros)
    assert all(z.im == 0 for z in tip.zeros)
    assert sorted(z.re for z in tip.zeros) == sorted(-z.re for z in tip.zeros)


def test_claims_are_judged(claims):
    expected = dict.fromkeys(HOLD, "holds") | dict.fromkeys(CONDITION, "holds with a condition")
    expected |= dict.fromkeys(FAIL, "does not hold")
    assert {key: claims[key]["verdict"] for key in expected} == expected
    assert all(claims[key]["evidence"] for key in expected)


def test_claims_of_a_report_are_judged_by_its_models_alone(report):
    found = {c["key"]: c["verdict"] for c in json.loads(report.files["data/claims.json"])["claims"]}
    assert (found["printed-colocated"], found["lumped-pair"]) == ("does not hold", "holds with a condition")
    assert found["high-gain"] == "not examined"


def test_every_claim_is_expected_here_or_not_examined(claims):
    rest = set(claims) - {*HOLD, *CONDITION, *FAIL}
    assert all(claims[key]["verdict"] == "not examined" for key in rest)


def told(stem, decibels, *, is_synthetic=False):
    """Return facts as they would be beside data; nothing here is measured."""
    fact = DataFact("A_tip/V_cmd", decibels, 5.0, is_synthetic)
    return ModelFacts(stem, "", "", (), False, False, (), (), data=(fact,))


def test_claims_about_the_experiment_are_not_judged_by_the_synthetic_stand_in():
    models = [told(stem, 0.1, is_synthetic=True) for stem in ("polynomial_resonance", "rigid_body")]
    for key in ("rigid-matches", "only-fit"):
        (claim,) = [c for c in PUBLICATION.claims if c.key == key]
        found = claim.judge({m.stem: m for m in models})
        assert found.verdict == "not examined", key
        assert "synthetic and was computed from polynomial_resonance" in "".join(map(str, found.evidence))


def test_only_the_model_fitted_by_hand_is_said_to_match_measured_data():
    (claim,) = [c for c in PUBLICATION.claims if c.key == "only-fit"]
    good, bad = told("polynomial_resonance", 1.0), told("rigid_body", 9.0)
    assert claim.judge({m.stem: m for m in (good, bad)}).verdict == "holds"
    assert claim.judge({m.stem: m for m in (good, told("rigid_body", 1.0))}).verdict == "does not hold"
    synthetic = told("polynomial_resonance", 0.1, is_synthetic=True)
    assert claim.judge({synthetic.stem: synthetic}).verdict == "not examined"


def test_bandwidth_and_stable_gains_of_each_loop_are_those_of_the_loops_readme(models):
    # tests/derivations/test_loops.py and tests/independent/test_stability_boundaries.py judge the numbers.
    for stem, hertz in (
        ("two_mass_force", 4.7585),
        ("base_flexure_force", 6.9054),
        ("rigid_body_force", None),
    ):
        (loop,) = models[stem].to_json_dict()["loops"]
        assert loop["is_bandwidth_unlimited"] is (hertz is None), stem
        assert loop["bandwidth_hz"] == (None if hertz is None else pytest.approx(hertz, rel=1e-4)), stem
    for stem, end in (
        ("two_mass_force", 5.4510),
        ("lumped_bending_beam_force", 4.7665),
        ("rigid_body_force", None),
    ):
        (loop,) = models[stem].loops
        ((low, high),) = loop.stable
        assert low == 0, stem
        assert high is None if end is None else high == pytest.approx(end, rel=1e-4), stem


def test_quotations_are_short_and_keys_unique():
    keys = [claim.key for claim in PUBLICATION.claims]
    assert len(keys) == len(set(keys))
    assert all(re.fullmatch(r"[a-z-]+", key) for key in keys)


def test_a_claim_is_refuted_where_the_model_is_another(tmp_path):
    # With the tip at the joint, Newton's law on the body puts the zeros on the imaginary axis.
    text = (FOLDER / "lumped_bending_beam.toml").read_text("utf-8")
    (tmp_path / "lumped_bending_beam.toml").write_text(text.replace('"150 mm"', '"1 mm"'), encoding="utf-8")
    study = Study.of(tmp_path / "lumped_bending_beam.toml", "lumped_bending_beam")
    judged = {key: claim["verdict"] for key, claim in verdicts({study.stem: facts_of(study)}).items()}
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
    """Two models, each in a process of its own, against the same ones in this process."""
    paths = []
    for name, text in (("small", SMALL), ("symbolic", SYMBOLIC)):
        paths.append(tmp_path / f"{name}.toml")
        paths[-1].write_text(text, encoding="utf-8")
    out = tmp_path / "out"
    command = [sys.executable, "-m", "symflex", "report", *paths, "-o", out, "-j", "2", "--date", DAY]
    environment = {**os.environ, "PYTHONHASHSEED": "2025"}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == f"open {out / 'index.html'}"
    found = {str(p.relative_to(out)): p.read_bytes() for p in out.rglob("*") if p.is_file()}
    assert found.pop("report.pdf").startswith(b"%PDF")
    expected = all_files(compose(write_chapters(name_specifications(paths), 0, Silent()), DAY))
    assert found.keys() == expected.keys()
    assert [name for name in expected if expected[name] != found[name]] == []


@pytest.mark.needs_tool("chromium")
def test_a_browser_shows_the_page_without_a_complaint(written, tmp_path):
    shot = tmp_path / "shot.png"
    log = tmp_path / "net.json"
    command = [
        "chromium", "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={tmp_path / 'profile'}",
        "--disable-component-update", "--disable-background-networking", "--no-first-run", "--disable-sync",
        "--enable-logging=stderr", "--v=0", f"--log-net-log={log}", "--window-size=390,1000",
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
