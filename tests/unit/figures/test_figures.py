import hashlib
import os
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import matplotlib
import numpy as np
import pytest

from symflex import pipeline
from symflex.data.fitting import fit_resonances
from symflex.data.measurement import MeasuredResponse
from symflex.errors import ModelError, UsageError
from symflex.figures import FIGURES, FORMATS, LOOP_FIGURES, AxisLimits, draw, render, save
from symflex.figures.fitted import draw_fit
from symflex.figures.s_plane import RootMark, choose_view, leaving
from symflex.figures.style import label_of, label_of_name, label_of_tf, label_of_unit
from symflex.model import Output
from symflex.model.analysis import FIGURE_KINDS
from symflex.options import FitOptions
from symflex.papers.labels import ACCENTS, FONTS, GREEK, SYMBOLS
from symflex.transfer import bind
from tests.unit.analysis.systems import derived, rational
from tests.unit.refusals import refusal

ROOT = Path(__file__).parents[3]
TWO_MASSES = """
title = "Two masses"
elements.a = { type = "mass", at = "x", m = "1 kg" }
elements.b = { type = "mass", at = "y", m = "1 kg" }
elements.k = { type = "spring", between = ["x", "y"], k = "50 N/m" }
elements.d = { type = "damper", between = ["x", "y"], b = "DAMPING N*s/m" }
inputs.F = { force = "x" }
outputs.X_tip = "y"
outputs.V_act = "s*x"
analysis.band = ["0.2 Hz", "5 Hz"]
"""
DRAW_ALL = """
import sys
from tests.unit.figures.test_figures import DAMPED, hashes
print(hashes(), "matplotlib.pyplot" in sys.modules)
"""
DAMPED = TWO_MASSES.replace("DAMPING", "0.1")


@pytest.fixture(scope="module")
def tfs():
    return derived(DAMPED)


@pytest.fixture(scope="module")
def undamped():
    return derived(TWO_MASSES.replace('"DAMPING N*s/m"', '"0*1"'))


def drawn(kind, tfs, **asked):
    return draw(kind, [bind(tf) for tf in tfs], **{"frame": AxisLimits(at=(Fraction(1),)), **asked})


def drawn_rational(kind, expression, **asked):
    bound = rational(expression)
    return draw(kind, [bound], **asked)


def texts(axes):
    return [text.get_text() for text in axes.texts]


def hashes():
    """Return what tells the files of every kind of figure apart, and those of every format."""
    tfs = derived(DAMPED)[:1]
    figures = {kind: drawn(kind, tfs, title="a title") for kind in FIGURES}
    files = [*((kind, "svg") for kind in FIGURES), ("poles_zeros", "pdf"), ("poles_zeros", "pgf")]
    return {file: hashlib.sha256(render(figures[file[0]], file[1])).hexdigest() for file in files}


# ------------------------------------------------------------------------------------------ every kind


def test_every_kind_of_the_language_is_drawn():
    of_ports = {"passivity"}  # drawn at a port, which only the command line names
    assert set(FIGURE_KINDS) == (set(FIGURES) - of_ports) | set(LOOP_FIGURES) | {"stability"}


def test_an_unknown_kind_names_the_nearest(tfs):
    with pytest.raises(UsageError, match=r"(?s)SF208.*did you mean 'bode'"):
        drawn("bodee", tfs)


def test_a_figure_of_nothing_is_refused():
    for kind in FIGURES:
        with pytest.raises(ValueError, match="needs a transfer function"):
            draw(kind, [])


def test_a_function_that_is_zero_has_no_figure():
    assert {kind: refusal(drawn_rational, kind, "s - s") for kind in FIGURES} == dict.fromkeys(
        FIGURES, "ModelError SF402"
    )


def test_a_figure_of_one_function_is_a_column_wide(tfs):
    for kind in FIGURES:
        assert drawn(kind, tfs[:1]).get_size_inches()[0] == 3.5, kind


@pytest.mark.slow
def test_two_drawings_have_the_same_bytes(tfs):
    kinds = {f: "modes" if f == "gif" else "poles_zeros" for f in FORMATS}
    one, other = ({kind: drawn(kind, tfs[:1]) for kind in kinds.values()} for _ in range(2))
    assert [f for f, kind in kinds.items() if render(one[kind], f) != render(other[kind], f)] == []


@pytest.mark.slow
def test_bytes_do_not_depend_on_the_hash_seed_and_pyplot_is_never_imported():
    seed = "2" if os.environ.get("PYTHONHASHSEED") != "2" else "1"
    environment = {**os.environ, "PYTHONHASHSEED": seed}
    command = [sys.executable, "-c", DRAW_ALL]
    done = subprocess.run(command, env=environment, cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout == f"{hashes()} False\n"


@pytest.mark.slow
def test_the_user_s_own_settings_do_not_matter_and_are_left_as_they_were(tfs):
    """One context sets the style of all kinds."""
    expected = render(drawn("poles_zeros", tfs), "svg")
    with matplotlib.rc_context(
        {"font.size": 20, "axes.grid": True, "lines.linewidth": 9, "svg.fonttype": "none"}
    ):
        before = dict(matplotlib.rcParams)
        assert render(drawn("poles_zeros", tfs), "svg") == expected
        assert dict(matplotlib.rcParams) == before


@pytest.mark.slow
def test_a_title_is_printed_as_it_is(tfs):
    title = "Costs $5 or $\\frac{x$ & <b>"
    for kind in FIGURES:
        figure = drawn(kind, tfs[:1] if kind == "rga" else tfs, title=title)  # that of a square matrix
        texts_of_it = figure.findobj(matplotlib.text.Text)
        found = [text for text in texts_of_it if title in text.get_text().splitlines()]
        assert [text.get_parse_math() for text in found] == [False], kind


def test_control_characters_of_a_title_do_not_reach_the_file(tfs):
    assert b"\x1b" not in render(drawn("poles_zeros", tfs, title="a\x1b[31m\ud800b"), "svg")


@pytest.fixture(scope="module")
def sketch(tfs):
    """A figure to be written."""
    return drawn("poles_zeros", tfs[:1])


def test_an_unknown_format_is_refused(sketch):
    with pytest.raises(UsageError, match="SF208"):
        render(sketch, "jpg")


@pytest.mark.slow
def test_save_writes_the_format_asked_for_without_a_date(sketch, tmp_path):
    for format, start in (("pdf", b"%PDF-"), ("png", b"\x89PNG"), ("svg", b"<?xml")):
        save(sketch, tmp_path / "figure", format)
        content = (tmp_path / "figure").read_bytes()
        assert content.startswith(start), format
        assert b"CreationDate" not in content, format
        assert b"<dc:date>" not in content, format


def test_the_name_of_the_file_tells_the_format(sketch, tmp_path):
    save(sketch, tmp_path / "figure.PNG")
    assert (tmp_path / "figure.PNG").read_bytes().startswith(b"\x89PNG")


def test_a_name_that_tells_no_format_is_refused(sketch, tmp_path):
    with pytest.raises(UsageError, match="SF208"):
        save(sketch, tmp_path / "figure")


def test_save_does_not_write_through_a_link(sketch, tmp_path):
    (tmp_path / "a.svg").symlink_to(tmp_path / "b.svg")
    with pytest.raises(UsageError, match="SF903"):
        save(sketch, tmp_path / "a.svg", "svg")


# ---------------------------------------------------------------------------------------------- labels


def test_a_name_becomes_a_label():
    for name, label in (
        ("F", "F"),
        ("X_tip", r"X_{\mathrm{tip}}"),
        ("theta_1", r"\theta_{1}"),
        ("x2", "x_{2}"),
        ("speed", r"\mathrm{speed}"),
        ("a_b_max", r"a_{b,\mathrm{max}}"),
        ("L_", r"\mathtt{L\_}"),
    ):
        assert label_of_name(name) == label, (name, label)


@pytest.mark.slow
def test_every_command_a_label_may_use_is_drawn():
    figure = matplotlib.figure.Figure()
    for command in sorted({*GREEK, *ACCENTS, *FONTS, *SYMBOLS}):
        argument = "{x}" if command in ACCENTS or command in FONTS else ""
        output = Output("y", None, latex=f"\\{command}{argument}")
        figure.text(0, 0, f"${label_of(output)}$")
    figure.savefig(os.devnull, format="svg")


def test_the_model_s_own_label_comes_first():
    assert label_of(Output("X_tip", None, latex=r"\hat{x}")) == r"{\hat{x}}"


def test_a_label_that_cannot_be_set_gives_way_to_the_name():
    for latex in ("$", "{", r"\nonsense", "a^{b}^{c}"):
        assert label_of(Output("X_tip", None, latex=latex)) == r"X_{\mathrm{tip}}", latex


def test_a_transfer_function_is_labelled_output_over_input(tfs):
    assert label_of_tf(tfs[0]) == r"$X_{\mathrm{tip}}/F$"


def test_a_unit_becomes_a_label():
    for unit, label in (
        ("", ""),
        ("1", ""),
        ("m/N", r"$\mathrm{m/N}$"),
        ("1/(N*m*s^2)", r"$\mathrm{1/(N\,m\,s^{2})}$"),
        ("kg^(1/2)*Ohm", r"$\mathrm{kg^{1/2}\,\Omega}$"),
    ):
        assert label_of_unit(unit) == label, (unit, label)


# ------------------------------------------------------------------------------------------------ bode


def test_the_level_is_relative_to_the_unit_and_each_unit_has_a_panel(tfs):
    assert drawn("bode", tfs[:1]).axes[0].get_ylabel() == r"Magnitude [dB, 0 dB = 1 $\mathrm{m/N}$]"
    panels = drawn("bode", tfs).axes
    said = [r"dB re $\mathrm{m/N}$", r"dB re $\mathrm{m/(N\,s)}$", "Phase [deg]"]
    assert [panel.get_ylabel() for panel in panels] == said
    labels = [text.get_text() for text in panels[0].get_legend().get_texts()]
    assert labels == [r"$X_{\mathrm{tip}}/F$", r"$V_{\mathrm{act}}/F$"]


@pytest.mark.slow
def test_the_band_is_the_model_s_or_the_one_asked_for_in_any_numbers(tfs):
    for asked, band in ((None, (0.2, 5)), ((1, 3), (1, 3)), ((Fraction(1, 2), Fraction(3)), (0.5, 3))):
        assert drawn("bode", tfs, band_hz=asked).axes[0].get_xlim() == pytest.approx(band), asked


def test_a_band_that_is_none_is_refused(tfs):
    for band in ((3, 1), (2, 2), (-1, 2), (np.nan, 2), (1, np.nan), (1, np.inf)):
        for kind in FIGURES:
            assert refusal(drawn, kind, tfs, band_hz=band) == "UsageError SF227", (kind, band)


def test_limits_of_an_axis_that_are_none_are_refused():
    for ends in (
        (1, 0), (2, 2), (np.nan, 1), (0, np.nan), (-np.inf, 0), (0, np.inf), (-1e300, 1e300), (1, 1 + 1e-12),
    ):  # fmt: skip
        for axis in ("x", "y", "phase"):
            assert refusal(AxisLimits, **{axis: ends}) == "UsageError SF902", (axis, ends)


def test_a_bode_plot_has_the_limits_asked_for(undamped):
    frame = AxisLimits(y=(-60.0, 40.0), phase=(-200.0, 20.0))
    top, _, bottom = drawn("bode", undamped, frame=frame).axes
    assert top.get_ylim() == (-60, 40)
    assert bottom.get_ylim() == (-200, 20)
    # An undamped peak still runs to the frame.
    assert max(line.get_ydata().max() for line in top.lines) > 40


@pytest.mark.slow
def test_phases_have_a_few_ticks_whatever_their_limits_are(tfs):
    for ends in ((-1.0, 1.0), (0.0, 1e-9), (-1e30, 1e30), (-400.0, 0.0)):
        figure = drawn("bode", tfs[:1], frame=AxisLimits(phase=ends))
        assert 2 <= len(figure.axes[1].get_yticks()) <= 12, ends


def test_a_plane_has_the_limits_asked_for(tfs):
    for kind in ("nyquist", "poles_zeros"):
        for axes in drawn(kind, tfs, frame=AxisLimits(x=(-3.0, 1.0), y=(0.0, 2.0))).axes:
            assert (axes.get_xlim(), axes.get_ylim()) == ((-3, 1), (0, 2)), kind


def test_one_axis_may_be_left_as_it_is(tfs):
    free, asked = (drawn("poles_zeros", tfs, frame=f).axes[0] for f in (AxisLimits(), AxisLimits(x=(-9, 1))))
    assert asked.get_ylim() == free.get_ylim()
    assert asked.get_xlim() == (-9, 1)


def test_roots_outside_the_limits_asked_for_are_counted():
    # (s - 30) is unstable and outside: the title says both.
    frame = AxisLimits(x=(-2, 1), has_verdict=True)
    figure = drawn_rational("poles_zeros", "(s + 5)/((s^2 + 1*s + 1)*(s - 30))", frame=frame)
    said = [text.get_text() for text in figure.texts]
    assert "unstable: 1 pole in the right half-plane" in said
    assert any(text.endswith(": 1 pole and 1 zero outside") for text in said)


def test_a_bode_plot_with_loss_factors_says_nothing_of_stability():
    model = pipeline.loads("""symflex = 1
parameters = { m = "1 kg", k = "1 kN/m" }
elements.a = { type = "mass", at = "x", m = "m" }
elements.b = { type = "spring", between = ["x", "ground"], k = "k", eta_s = 0.1 }
inputs.F = { force = "x" }
outputs.X = "x"
""")
    texts = drawn("bode", pipeline.derive_all(model)).findobj(matplotlib.text.Text)
    assert not any("stability" in text.get_text() for text in texts)


def test_limits_of_an_axis_that_a_figure_has_not_are_refused(tfs):
    for kind, limits, said in (
        ("nyquist", {"phase": (0, 1)}, "for 'bode'"),
        ("poles_zeros", {"phase": (0, 1)}, "for 'bode'"),
        ("bode", {"x": (0, 1)}, "its band"),
        ("modes", {"y": (0, 1)}, "largest displacement"),
    ):
        with pytest.raises(UsageError, match=f"SF902.*{said}"):
            drawn(kind, tfs, frame=AxisLimits(**limits))


def test_a_band_chooses_among_all_modes():
    # A free chain of two equal masses: one mode, at sqrt(100) rad/s.
    tfs = derived(TWO_MASSES.replace("DAMPING", "0"))
    titles = [axes.get_title(loc="left") for axes in drawn("modes", tfs, band_hz=(1.5, 1.7)).axes]
    assert titles == ["$1.592$ Hz"]
    with pytest.raises(ModelError, match=r"SF402.*between 1\.7 and 2 Hz"):
        drawn("modes", tfs, band_hz=(1.7, 2))


@pytest.mark.slow
def test_a_narrow_band_has_frequencies_that_differ_below_it(tfs):
    for band in ((9, 11), (2e6, 2.1e6), (1000, 1000.01), (0.001, 0.0012)):
        figure = drawn("bode", tfs[:1], band_hz=band)
        figure.canvas.draw()
        labels = [t.get_text() for t in figure.axes[1].get_xticklabels() if t.get_text()]
        assert len(set(labels)) == len(labels) >= 3, band


def test_a_nyquist_plot_of_a_band_ends_with_it():
    # 1/(s + 1) at 1/(2 pi) Hz is (1 - j)/2.
    turn = 1 / (2 * np.pi)
    figure = drawn_rational("nyquist", "1/(s + 1)", band_hz=(turn / 1e4, turn))
    (curve,) = (line for line in figure.axes[0].lines if line.get_label() == "$y/u$")
    assert (curve.get_xdata()[-1], curve.get_ydata()[-1]) == pytest.approx((0.5, -0.5))


def test_frequencies_stand_beside_a_nyquist_plot_where_its_values_are():
    (axes,) = drawn_rational("nyquist", "1/(s + 1)").axes
    marks = {note.get_text(): complex(*note.xy) for note in axes.texts if note.get_text().endswith("Hz")}
    assert len(marks) > 2
    for text, at in marks.items():
        # The curve is drawn between points that are closer than a line is wide.
        assert at == pytest.approx(1 / (1 + 2j * np.pi * float(text.removesuffix(" Hz"))), abs=2e-3)


def test_without_a_band_all_poles_and_zeros_are_shown():
    low, high = drawn_rational("bode", "1/((s + 1)*(s + 50))").axes[0].get_xlim()
    assert (2 * np.pi * low, 2 * np.pi * high) == pytest.approx((0.1, 500))


def test_the_curve_shows_the_peak_of_the_resonance():
    figure = drawn_rational("bode", "1/(s^2 + 0.0002*s + 1)")
    level = figure.axes[0].lines[0].get_ydata()
    assert level.max() == pytest.approx(20 * np.log10(1 / 0.0002), abs=0.01)


def test_an_undamped_peak_runs_to_the_frame_which_is_near_what_surrounds_it():
    top, bottom = drawn_rational("bode", "1/(s^2 + 1)").axes
    # 1 % from the pole the level is 20 log10(1/0.02) = 34 dB; the peak itself has no end.
    assert 34 < top.get_ylim()[1] < 60
    assert top.lines[0].get_ydata().max() > top.get_ylim()[1]
    assert sorted(set(bottom.lines[0].get_ydata())) == [-180, 0]
    trough = drawn_rational("bode", "s^2 + 1").axes[0]
    assert trough.lines[0].get_ydata().min() < trough.get_ylim()[0]


def test_phase_ticks_are_multiples_of_45_degrees():
    for expression in ("1/(s + 1)", "1/(s + 1)^4", "1/(s + 1)^30", "7"):
        axes = drawn_rational("bode", expression).axes[1]
        low, high = axes.get_ylim()
        ticks = [tick for tick in axes.get_yticks() if low <= tick <= high]
        assert 2 <= len(ticks) <= 9, expression
        assert all(tick % 45 == 0 for tick in ticks), expression


def test_curves_differ_in_colour_and_in_dashes(undamped):
    first, second = (line for axes in drawn("bode", undamped).axes[:2] for line in axes.lines)
    assert first.get_color() != second.get_color()
    assert first.get_linestyle() != second.get_linestyle()


# ----------------------------------------------------------------------------------------- poles and zeros


def test_panels_one_per_function_show_the_same_part_of_the_plane_in_the_same_scale(tfs):
    first, second = drawn("poles_zeros", tfs).axes
    assert (first.get_xlim(), first.get_ylim()) == (second.get_xlim(), second.get_ylim())
    for axes in (first, second):
        box = axes.get_window_extent()
        per_pixel = np.diff(axes.get_xlim())[0] / box.width, np.diff(axes.get_ylim())[0] / box.height
        assert per_pixel[0] == pytest.approx(per_pixel[1], rel=1e-9)
        assert axes.get_aspect() == 1


def test_poles_are_crosses_and_zeros_circles_where_they_are():
    axes = drawn_rational("poles_zeros", "(s + 2)/(s^2 + 2*s + 10)").axes[0]
    found = {line.get_marker(): sorted(zip(*line.get_data(), strict=True)) for line in axes.lines}
    assert (found["x"], found["o"]) == ([(-1, -3), (-1, 3)], [(-2, 0)])


DISTANT = "1/((s + 5000)*(s^2 + 4*s + 4900))"


def test_a_root_that_is_multiple_or_far_away_is_named():
    said = {e: texts(drawn_rational("poles_zeros", e).axes[0]) for e in ("7", "1/(s + 1)^3", DISTANT)}
    assert (said["7"], said["1/(s + 1)^3"]) == ([], ["3"])
    assert r"$\times$ $-5000$" in said[DISTANT]


@pytest.mark.slow
def test_many_functions_take_the_page_and_several_rows(tfs):
    figure = drawn("poles_zeros", tfs * 3)
    assert figure.get_size_inches()[0] == 7.16
    assert len({round(axes.get_position().y0, 6) for axes in figure.axes}) == 2


RESONANT = [RootMark("pole", complex(-2, y)) for y in (70, -70, 240, -240)]


def seen(marks, high_hz=None):
    view = choose_view(marks, high_hz, (0.6, 1.25))
    return [mark.s for mark in marks if view.shows(mark)]


FAR = [RootMark("pole", 20000j), RootMark("pole", -20000j)]


def test_neighbouring_resonances_are_shown_and_not_squashed_by_what_is_far():
    near = [mark.s for mark in RESONANT]
    assert seen(RESONANT) == near
    assert seen([*RESONANT, RootMark("pole", -5000 + 0j)]) == near
    assert seen([*RESONANT, RootMark("zero", 400 + 0j)]) == [*near, 400]
    assert seen([*RESONANT, *FAR]) == near
    assert seen([*RESONANT, RootMark("pole", 6000j)]) == [*near, 6000j]  # within two decades of 70
    assert seen([*RESONANT, *FAR], high_hz=5000) == [*near, *(mark.s for mark in FAR)]
    # Real roots alone are shown from the lowest.
    assert seen([RootMark("pole", complex(s)) for s in (-50, -4000, -9000)]) == [-50, -4000]


def test_the_view_has_the_shape_asked_for():
    for marks in (RESONANT, [RootMark("pole", -50 + 0j)], []):
        assert 0.6 <= choose_view(marks, None, (0.6, 1.25)).ratio * (1 + 1e-12)
        assert choose_view(marks, None, (0.6, 1.25)).ratio <= 1.25 * (1 + 1e-12)


def test_the_border_lies_on_the_ray_from_the_origin():
    view = choose_view(RESONANT, None, (0.6, 1.25))
    edge = view.border(complex(-3000, 4000))
    assert edge.imag / edge.real == pytest.approx(-4 / 3)
    assert edge.real == pytest.approx(view.re[0]) or edge.imag == pytest.approx(view.im[1])


def test_roots_outside_in_one_direction_share_an_arrow():
    marks = [
        *RESONANT,
        RootMark("zero", -9000 + 0j),
        RootMark("pole", -5000 + 0j),
        RootMark("pole", 5000 + 0j),
    ]
    groups = leaving(marks, choose_view(marks, None, (0.6, 1.25)))
    assert [[mark.s for mark in group] for group in groups] == [[-5000, -9000], [5000]]


def two_close_modes():
    """Return a response with modes at 77.75 and 78.94 Hz on lines 1 Hz apart, and its fit."""
    frequency = np.linspace(20.0, 140.0, 121)
    s = 2j * np.pi * frequency
    poles = [(2 * np.pi * f, zeta) for f, zeta in ((30.0, 0.01), (77.75, 0.004), (78.94, 0.004))]
    values = sum(w**2 / (s**2 + 2 * zeta * w * s + w**2) for w, zeta in poles)
    random = np.random.default_rng(1)
    noise = 1 + 0.003 * (random.standard_normal(121) + 1j * random.standard_normal(121))
    data = MeasuredResponse("a/u", frequency, values * noise / s)
    return fit_resonances([data], None, FitOptions(modes=3, slope=-1))


def test_names_of_close_modes_do_not_overprint_and_curves_are_smooth():
    fit = two_close_modes()
    frequency = fit.measured[0].frequency_hz
    assert fit.curve(0, frequency) == pytest.approx(fit.values(0))
    page = draw_fit(fit)
    page.canvas.draw()
    top, *_ = page.subfigs[0].axes
    boxes = [text.get_window_extent() for text in top.texts]
    assert [text.get_text().split(": ")[1] for text in top.texts] == ["30 Hz", "77.75 Hz", "78.94 Hz"]
    assert not any(a.overlaps(b) for i, a in enumerate(boxes) for b in boxes[:i])
    curve = next(line for line in top.lines if line.get_label().startswith("fit"))
    x, y = curve.get_data()
    peak = np.max(y[(x > 77) & (x < 78.3)])  # half way between two lines
    assert peak == pytest.approx(
        np.max(20 * np.log10(abs(fit.curve(0, np.linspace(77, 78.3, 4000))))), abs=0.02
    )
    shown = {text.get_text() for text in top.get_legend().get_texts()}
    assert shown == {"measured", "start", "fit, 3 resonances", "expected noise"}


def test_the_legend_of_a_page_names_what_any_of_its_responses_shows():
    random = np.random.default_rng(1)
    frequency = np.linspace(5.0, 60.0, 120)
    s = 2j * np.pi * frequency
    pole = 1 + 0.02 * s / (2 * np.pi * 20) + (s / (2 * np.pi * 20)) ** 2
    noise = 1 + 0.01 * (random.standard_normal((2, 120)) + 1j * random.standard_normal((2, 120)))
    values = noise * [1 / pole, (1 - s / 100) / pole]  # the zero of the second one is on the right
    data = [MeasuredResponse(name, frequency, one) for name, one in zip(("a/u", "b/u"), values, strict=True)]
    page = draw_fit(fit_resonances(data, None, FitOptions(modes=1, slope=0)))
    shown = {text.get_text() for legend in page.legends for text in legend.get_texts()}
    assert shown == {"measured", "fit", "expected noise", "phase from magnitude"}
