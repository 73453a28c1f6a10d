"""Reports on small models: the page, the article and the files."""

import base64
import csv
import html
import io
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

import symflex
from symflex.budget import Silent
from symflex.errors import SpecError, UsageError
from symflex.figures.files import inline_svg
from symflex.report.article import report_article
from symflex.report.comparison import COLUMNS, LOOP_COLUMNS, comparison_section
from symflex.report.document import Code, Mathematics, Paragraph, Section
from symflex.report.facts import facts_of
from symflex.report.page import report_page
from symflex.report.report import (
    Report,
    compose,
    find_measurements,
    find_specifications,
    name_specifications,
    write_chapters,
)
from symflex.report.sections import SECTIONS
from symflex.report.sections.formulas import motion_section
from symflex.report.study import Study
from tests.unit.report.models import HOSTILE, PENDULUM, SMALL, SYMBOLIC
from tests.unit.report.pages import Page

FONTS = Path(symflex.__file__).parent / "report" / "fonts"


def chapters_on(folder, **texts):
    for name, text in texts.items():
        (folder / f"{name}.toml").write_text(text, encoding="utf-8")
    return write_chapters(name_specifications(find_specifications([folder])), 0, Silent())


def report_on(folder, **texts):
    return compose(chapters_on(folder, **texts), "2001-02-03")


@pytest.fixture(scope="module")
def chapters(tmp_path_factory):
    return chapters_on(tmp_path_factory.mktemp("small"), small=SMALL, symbolic=SYMBOLIC)


@pytest.fixture(scope="module")
def small(chapters):
    return compose(chapters, "2001-02-03")


@pytest.fixture(scope="module")
def hostile(tmp_path_factory):
    return report_on(tmp_path_factory.mktemp("hostile"), hostile=HOSTILE)


@pytest.mark.slow
def test_a_page_needs_nothing_but_itself_and_its_links_lead_somewhere(small, hostile):
    for report in (small, hostile):
        page = Page(report_page(report))
        assert not {"script", "link", "img", "iframe", "object", "embed", "base", "form"} & set(page.elements)
        assert page.handlers == []
        assert all(re.fullmatch(r"#[\w.-]+|(code|data|figures)/[\w.-]+", a) for a in page.addresses)
        assert len(page.ids) == len(set(page.ids))
        assert {a[1:] for a in page.addresses if a.startswith("#")} <= set(page.ids)


def test_every_linked_file_is_written_and_every_column_of_the_registry_is_in_the_comparison(small):
    page = report_page(small)
    linked = {a for a in Page(page).addresses if not a.startswith("#")}
    # What a section could not compute is not linked from another.
    assert {a for a in linked if "symbolic_roots" not in a} <= set(small.files)
    assert all(f">{head}</th>" in page for head in COLUMNS)


def test_a_report_of_a_single_model_is_not_folded(hostile):
    assert 'class="folded"' not in report_page(hostile)


def test_a_report_of_several_models_is_folded_behind_its_overview(small):
    many = report_page(small)
    assert many.count('<details class="folded">') == 3  # the comparison and two chapters
    assert many.index('id="models"') < many.index('class="folded"')
    # A folded chapter says what is in it.
    (small_model,) = re.findall("<summary>(Parameters.*poles and zeros.*)</summary>", many)
    assert small_model == (
        "Parameters, transfer functions, figures, poles and zeros, symbolic answers, "
        "dynamic colocation, code and data"
    )
    printed = many.partition("@media print")[2].partition("</style>")[0]
    assert ".folded::details-content{content-visibility:visible" in printed


def test_a_page_carries_the_font_of_its_formulas_once(small):
    page = report_page(small)
    (font,) = re.findall(r"url\(data:font/woff2;base64,([^)]*)\)", page)
    content = base64.b64decode(font, validate=True)
    assert content.startswith(b"wOF2")
    assert len(content) <= 60_000
    assert "font-src data:" in page


@pytest.mark.needs_module("brotli")
def test_the_font_of_formulas_has_every_sign_and_what_signs_grow_into():
    from fontTools.ttLib import TTFont

    font = TTFont(FONTS / "symflex-math.woff2")
    signs = font.getBestCmap()
    # What is on no key: letters of MathML Core's italic mapping, Greek, and the operators of formulas.
    for sign in "𝐴𝑧ℎ𝛼𝜔𝛺ΔΩωϕ𝒩𝒟−⋅×±√′˙^~→ˇ˘´`¯‾ℓℏ∞⋆∗∘∥⊥†∓…0189()[]{}=+/.,|":
        assert ord(sign) in signs, sign
    variants = font["MATH"].table.MathVariants
    for coverage in (variants.VertGlyphCoverage, variants.HorizGlyphCoverage):
        assert set(coverage.glyphs) <= set(font.getGlyphOrder())
    growing = set(variants.VertGlyphCoverage.glyphs)
    assert {signs[ord(sign)] for sign in "()[]{}√|"} <= growing
    assert "SIL Open Font License" in font["name"].getDebugName(13)
    assert "SIL OPEN FONT LICENSE" in (FONTS / "OFL.txt").read_text(encoding="utf-8")


def test_hostile_text_is_shown_as_text(hostile):
    shown = Page(report_page(hostile)).text()
    assert "</title><script>alert(1)</script>" in shown
    assert "<script src='//evil'></script>" in shown
    assert "<script>alert(2)</script>" in shown
    assert "\u202e" not in shown


def test_hostile_text_reaches_no_command_of_tex(hostile):
    article = report_article(hostile)
    assert article.isascii()
    assert not re.search(r"\\(input|write18|immediate|csname|include)\b", article)
    assert article.count(r"\end{document}") == 1


def test_a_title_of_five_thousand_letters_makes_no_column_wider_than_the_page(tmp_path):
    article = report_article(
        report_on(tmp_path, a=SYMBOLIC.replace("symflex = 1", f'symflex = 1\ntitle = "{"x" * 5000}"'))
    )
    widths = [float(width) for width in re.findall(r"p\{([0-9.]+)mm\}", article)]
    assert widths
    assert max(widths) < 210  # A4


def test_hostile_names_lead_to_plain_files_and_names_that_would_collide_differ():
    (stem,) = name_specifications([Path('<b> ..%2f" onx=1.toml')])
    assert re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", stem)
    found = name_specifications([Path(n) for n in ("a/x.toml", "b/X.toml", "c/x.toml", "claims.toml")])
    assert len({name.lower() for name in found}) == 4
    assert "claims" not in found


def test_the_date_stands_in_the_report_when_given_and_what_has_no_numbers_says_so(small, chapters):
    page = report_page(small)
    assert "2001-02-03" in page
    assert "2001" not in report_page(compose(chapters, ""))
    assert "no numbers" in Page(page).text()
    assert any("symbolic" in warning for warning in small.warnings)
    assert small.code == 0


def test_the_response_in_the_data_is_that_of_two_masses(small):
    rows = list(csv.DictReader(io.StringIO(small.files["data/small_Y_over_F.csv"].decode())))
    m_1, m_2, k, b = 3, 2, 24, 0.1
    for row in rows[:: len(rows) // 7]:
        s = 2j * math.pi * float(row["frequency_hz"])
        expected = (b * s + k) / (s**2 * (m_1 * m_2 * s**2 + (b * s + k) * (m_1 + m_2)))
        assert complex(float(row["re"]), float(row["im"])) == pytest.approx(expected, rel=1e-7)
        assert float(row["magnitude_db"]) == pytest.approx(20 * math.log10(abs(expected)), abs=1e-6)


def test_the_facts_in_the_data_are_those_of_two_masses(small):
    facts = json.loads(small.files["data/small_facts.json"])
    (first, last) = facts["transfer_functions"]
    assert (first["zeros_added"], first["poles_added"], first["colocated"]) == (2, 2, True)
    assert (last["zeros_added"], last["poles_added"], last["colocated"]) == (1, 2, False)


def test_a_nonlinear_model_has_its_linear_equations_before_what_follows_from_them(tmp_path):
    path = tmp_path / "pendulum.toml"
    path.write_text(PENDULUM)
    solved, rest, equation = motion_section(Study.of(path, "pendulum")).blocks
    said = "".join(r if isinstance(r, str) else r.latex for r in solved.runs)
    assert said.startswith(r"Solved at equilibrium: \tau_{0} = 1.50000 N*m (radius ")  # 3 sin 30 deg
    said = "".join(r if isinstance(r, str) else r.latex for r in rest.runs)
    below = "The names below stand for deviations from equilibrium:"
    assert said == rf"At equilibrium, \theta = q, \tau = \tau_{{0}}. {below}"
    assert equation.runs[0].latex == r"J s^{2} \theta + w \, \cos(q) \, \theta"
    assert list(SECTIONS).index("motion") < list(SECTIONS).index("equations")


def test_every_section_of_the_registry_is_in_a_full_chapter_and_a_single_model_is_not_compared(hostile):
    anchors = set(Page(report_page(hostile)).ids)
    others = ("loops", "data", "motion", "sampled")
    assert {f"hostile-{key}" for key in SECTIONS if key not in others} <= anchors
    assert "comparison" not in anchors


LOOP = """
symflex = 1
[parameters]
m = "2 kg"
b = "6 N*s/m"
k = "4 N/m"
K = { value = "3 N/(m*s)", doc = "gain" }
[elements]
body = { type = "mass", at = "x", m = "m" }
rub = { type = "damper", between = ["x", "ground"], b = "b" }
wall = { type = "spring", between = ["x", "ground"], k = "k" }
drive = { type = "force_source", at = "x", f = "v" }
[inputs]
r = {}
[signals]
i = "(r - x)/s"
v = "K*i"
[outputs]
X = "x"
[figures.locus]
kind = "locus"
gain = "K"
"""


@pytest.mark.slow
def test_the_stable_gains_of_a_loop_are_in_its_chapter_and_in_a_table_of_loops(tmp_path, chapters):
    # m s^3 + b s^2 + k s + K: Routh has 0 < K < b k/m = 12.
    report = compose((*chapters_on(tmp_path, loop=LOOP), *chapters), "")
    page = report_page(report)
    assert "loop-loops" in Page(page).ids
    (found,) = json.loads(report.files["data/loop_loops.json"])["loops"]
    assert [float(b["gain"]["value"]) for b in found["boundaries"]] == [12.0]
    assert "K &lt; 12" in page
    assert all(f">{head}</th>" in page for head in LOOP_COLUMNS)
    assert found["bandwidth"]["limited"] is True
    assert report.files["figures/loop_locus.pdf"].startswith(b"%PDF")
    # No number that a reader of figures could not hold.
    assert not re.search(rb"[0-9]{12}", report.files["figures/loop_locus.svg"])


@pytest.mark.slow
def test_a_figure_that_cannot_be_drawn_is_told_in_its_place_and_on_the_terminal(tmp_path):
    text = LOOP.replace("[outputs]", '[figures.square]\nkind = "locus"\ngain = "R"\n[outputs]')
    text = text.replace("K = ", "R = 2\nK = ").replace('"K*i"', '"K*R^2*i"')
    report = report_on(tmp_path, square=text)
    page = html.unescape(report_page(report))
    assert "square: the characteristic function is not linear in" in page
    assert any("square, figure square: the characteristic function is not" in w for w in report.warnings)


HELD = SMALL.replace("loss = {", 'wall = { type = "spring", between = ["x", "ground"], k = "k" }\nloss = {')


def test_modes_of_a_structure_that_a_spring_holds_to_ground_are_counted(tmp_path):
    # Two masses have four poles; rigid springs leave none of them, and nothing that moves.
    facts = []
    for stem, text in (("free", SMALL), ("held", HELD)):
        (tmp_path / f"{stem}.toml").write_text(text, encoding="utf-8")
        facts.append(facts_of(Study.of(tmp_path / f"{stem}.toml", stem)))
    free, held = (each.to_json_dict()["transfer_functions"] for each in facts)
    assert [(f["modes"], f["poles_added"]) for f in free] == [(1, 2), (1, 2)]
    assert [(f["modes"], f["poles"], f["poles_added"], f["zeros_added"]) for f in held] == [
        (2, 4, None, None),
        (2, 4, None, None),
    ]
    compared = Report("", "", "", (comparison_section(facts),), {}, (), 0)
    assert "no response when rigid" in report_page(compared)


@pytest.mark.slow
def test_measured_responses_in_a_folder_are_drawn_with_the_models_over_them(tmp_path):
    # Two masses of 3 and 2 kg, 24 N/m and 0.1 N s/m between; the data are 1 dB smaller and 30 degrees behind.
    frequency = np.arange(0.2, 5.0, 0.1)
    s = 2j * np.pi * frequency
    link = 0.1 * s + 24
    receptance = (2 * s**2 + link) / (s**2 * (6 * s**2 + 5 * link))
    values = receptance * 10 ** (-1 / 20) * np.exp(-1j * np.pi / 6)
    pairs = zip(frequency.tolist(), values.tolist(), strict=True)
    rows = "\n".join(f"{f},{v.real!r},{v.imag!r}" for f, v in pairs)
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "one.csv").write_text(f"# tf: X/F\n# synthetic: yes\nfrequency_hz,re,im\n{rows}\n")
    (tmp_path / "data" / "other.csv").write_text("name,price\nbolt,3\n")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "old.csv").write_text("no data")
    found, warnings = find_measurements([tmp_path], tmp_path / "out")
    assert [one.name for one in found] == ["X/F"]
    assert len(warnings) == 1
    assert "other.csv is left out" in warnings[0]
    (tmp_path / "small.toml").write_text(SMALL, encoding="utf-8")
    named = name_specifications(find_specifications([tmp_path], tmp_path / "out"))
    report = compose(write_chapters(named, 0, Silent(), found), "")
    (told,) = json.loads(report.files["data/small_facts.json"])["data"]
    assert told["decibels"] == pytest.approx(1.0)
    assert told["degrees"] == pytest.approx(30.0)
    assert told["is_synthetic"]
    assert "SYNTHETIC" in report_page(report)
    assert report.files["figures/small_data_1.pdf"].startswith(b"%PDF")
    figure = '[figures.fit]\nkind = "bode"\nof = ["X/F"]\ndata = true\ntitle = "Over data"\n'
    (tmp_path / "small.toml").write_text(SMALL + figure, encoding="utf-8")
    again = compose(write_chapters(named, 0, Silent(), found), "")
    assert "Over data. X/F over SYNTHETIC data, computed and not measured, 48 lines." in report_page(again)
    # The figure shows them, so that no other does.
    assert "figures/small_data_1.pdf" not in again.files


def test_specifications_in_the_folder_that_is_written_are_left_out(tmp_path):
    for name in ("a.toml", "below/b.toml", "report/data/a.toml"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(SMALL, encoding="utf-8")
    found = find_specifications([tmp_path], tmp_path / "report")
    assert [p.relative_to(tmp_path).as_posix() for p in found] == ["a.toml", "below/b.toml"]


def test_a_wrong_specification_is_an_error_with_its_place(tmp_path):
    with pytest.raises(SpecError, match=r"wrong\.toml:"):
        report_on(tmp_path, wrong=SMALL.replace('"24 N/m"', '"24 N"'))


def test_pages_with_sliders_stand_beside_a_report_and_no_script_in_it(tmp_path):
    folder = tmp_path / "models"
    folder.mkdir()
    (folder / "small.toml").write_text(SMALL, encoding="utf-8")
    written = symflex.write_report(folder, tmp_path / "report", pdf=False, live=True)
    assert 'href="live/small.html"' in written.page.read_text(encoding="utf-8")
    pages = (written.page, written.page.parent / "live" / "small.html")
    assert ["<script" in page.read_text(encoding="utf-8") for page in pages] == [False, True]


def test_a_folder_without_specifications_is_an_error(tmp_path):
    with pytest.raises(UsageError, match="SF902"):
        find_specifications([tmp_path])


def test_identifiers_of_figures_get_a_prefix():
    drawn = (
        '<?xml version="1.0"?><svg width="72pt" xmlns="u"><g id="a"/><use href="#a" fill="url(#a)"/></svg>'
    )
    shown = inline_svg(drawn, "f", 'x" onload="y')
    assert re.findall(r'id="([^"]*)"|href="#([^"]*)"|url\(#([^)]*)\)', shown) == [
        ("f-a", "", ""), ("", "f-a", ""), ("", "", "f-a")
    ]  # fmt: skip
    assert 'onload="' not in shown


def test_a_sentence_with_long_mathematics_scrolls_and_the_page_does_not():
    long = Mathematics("<mi>x</mi><mo>+</mo>" * 100 + "<mi>x</mi>", "x")
    sections = (Section("A", (Paragraph(("The factor ", long, " cancels.")), Paragraph(("Short.",))), "a"),)
    page = report_page(Report("", "", "", sections, {}, (), 0))
    assert '<p class="scroll" tabindex="0">The factor <math>' in page
    assert "<p>Short.</p>" in page


def test_code_in_an_article_keeps_its_blanks():
    section = Section("A", (Paragraph((Code("imaginary axis, as here"),)),), "a")
    article = report_article(Report("", "", "", (section,), {}, (), 0))
    assert re.search(r"axis,(\{\})? as here", article)
