"""Figures and short prints of what a Python user holds."""

import re
from dataclasses import replace
from io import BytesIO

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure

import symflex
from symflex import pipeline
from symflex.errors import ModelError, Source, UsageError
from symflex.loops.of_model import characteristic_loop
from symflex.model.spec import parse
from symflex.state_space import realise
from tests.house.repository import ROOT
from tests.unit.refusals import refusal
from tests.unit.test_api import TEXT

LOOP = """
symflex = 1
parameters = { K = 1 }
signals = { y = "K/(s*(s + 1)*(s + 2))*(r - y)" }
inputs = { r = {} }
outputs = { Y = "y" }
"""
PNG = b"\x89PNG"
LONGEST = 300
"""Characters of a short print: four lines of a terminal."""
LONGEST_PAGE = 30_000
"""The same of HTML, with a drawing."""


@pytest.fixture(scope="module")
def drive():
    return symflex.loads(TEXT)


@pytest.fixture(scope="module")
def tip(drive):
    return drive.transfer_function("V_tip", "F").bind()


@pytest.fixture(scope="module")
def actuator(drive):
    return drive.transfer_function("X_act", "F").bind()


@pytest.fixture(scope="module")
def loop():
    return symflex.loads(LOOP)


def own(count):
    return Figure().subplots(count, squeeze=False)[:, 0]


DRAWINGS = {
    "bode": (2, lambda m, h, ax: h.bode(ax=ax)),
    "poles and zeros": (1, lambda m, h, ax: h.pole_zero_plot(ax=ax)),
    "nyquist": (1, lambda m, h, ax: h.nyquist(ax=ax)),
    "locus": (1, lambda m, h, ax: m.locus("K", ax=ax)),
    "nyquist of a loop": (1, lambda m, h, ax: m.nyquist("K", ax=ax)),
    "nichols": (1, lambda m, h, ax: h.nichols(ax=ax)),
    "nichols of a loop": (1, lambda m, h, ax: m.nichols("K", ax=ax)),
    "sensitivities": (1, lambda m, h, ax: m.sensitivity_plot("K", ax=ax)),
    "mode shape": (1, lambda m, h, ax: h.mode_shape(1).plot(ax=ax)),
    "response": (2, lambda m, h, ax: h.frequency_response([1.0, 2.0, 90.0]).plot(ax)),
    "measurement": (2, lambda m, h, ax: symflex.MeasuredResponse("X/F", [1.0, 2.0], [1.0, -1j]).plot(ax=ax)),
}


@pytest.mark.slow
def test_a_figure_is_drawn_on_the_axes_given_in_the_user_s_style(loop, actuator):
    for kind, (count, drawing) in DRAWINGS.items():
        with matplotlib.rc_context({"lines.linewidth": 7.0, "font.size": 13.0}):
            axes = own(count)
            assert drawing(loop, actuator, axes) is axes[0].figure, kind
            assert matplotlib.rcParams["font.size"] == 13.0, kind
        assert all(panel.has_data() for panel in axes), kind
        assert axes[-1].xaxis.label.get_size() == 13.0, kind


@pytest.mark.slow
def test_a_figure_without_axes_shows_in_a_notebook(loop, actuator):
    for kind in ("poles and zeros", "locus", "mode shape", "response"):
        data, size = DRAWINGS[kind][1](loop, actuator, None)._repr_png_()
        assert data.startswith(PNG), kind
        assert 400 <= size["width"] <= 900, kind  # the column of a notebook


@pytest.mark.slow
def test_axes_in_the_wrong_number_are_refused(loop, actuator):
    for kind, (_, drawing) in DRAWINGS.items():
        assert refusal(drawing, loop, actuator, own(4)) == "UsageError SF902", kind


def test_magnitudes_alone_are_drawn_on_one_axes(actuator):
    (axes,) = own(1)
    actuator.bode(ax=axes)
    assert axes.get_xlabel() == "Frequency [Hz]"


def test_a_second_curve_on_the_same_axes_has_another_colour_and_both_are_seen(actuator, tip):
    top, bottom = own(2)
    actuator.bode(ax=(top, bottom))
    first = top.get_ylim()
    tip.bode(ax=(top, bottom))
    assert len({line.get_color() for line in top.get_lines()}) == 2
    low, high = top.get_ylim()
    assert low <= first[0]
    assert first[1] <= high


def test_functions_are_compared_in_one_figure(actuator, tip):
    assert [len(panel.get_lines()) for panel in actuator.bode(tip).axes] == [1, 1, 2]  # m/N, m/(N s); phases
    assert len(actuator.pole_zero_plot(tip).axes) == 2


def test_bands_limits_and_widths_may_have_units(actuator):
    figure = actuator.bode(band=("1 Hz", "0.1 kHz"), phase=("-360 deg", 0), width="ieee")
    assert figure.axes[0].get_xlim() == (1, 100)
    assert figure.axes[1].get_ylim() == (-360, 0)
    assert figure.get_figwidth() == pytest.approx(88.5 / 25.4)
    assert actuator.pole_zero_plot(width=150).get_figwidth() == pytest.approx(150 / 25.4)


def test_a_number_of_modes_is_shown_of_a_beam():
    beam = symflex.load(ROOT / "derivations/eppinger1988/sliding_free_beam.toml")
    bound = beam.transfer_function("V_act", "F").bind()
    poles = {root.im for root in bound.poles(2)}
    (panel,) = bound.pole_zero_plot(modes=2).axes
    crosses = next(line for line in panel.get_lines() if line.get_marker() == "x")
    assert len(crosses.get_ydata()) == len(poles)


@pytest.mark.slow
def test_values_in_place_of_declared_ones_move_the_locus(loop):
    heights = [m.axes[0].get_xlim() for m in (loop.locus("K", (0, 1)), loop.locus("K", (0, 50)))]
    assert heights[0] != heights[1]


def test_less_than_two_frequencies_are_no_figure(actuator):
    assert refusal(actuator.frequency_response([1.0]).plot) == "UsageError SF902"
    assert refusal(symflex.MeasuredResponse("X/F", [1.0], [2.0]).plot) == "UsageError SF902"


def test_measured_files_and_bands_of_them_draw_what_they_hold(tmp_path):
    file = tmp_path / "frf.csv"
    file.write_text("frequency_hz,mag_db,phase_deg\n1,20,0\n2,0,-90\n3,-20,170\n4,-40,-170\n")
    (whole,) = symflex.read_measurement(file)
    top, bottom = whole.between(2, 4).plot().axes
    assert top.get_lines()[0].get_ydata() == pytest.approx([0, -20, -40])
    assert bottom.get_lines()[0].get_ydata() == pytest.approx([-90, 170, -170])
    level = symflex.MeasuredResponse("p", [1.0, 2.0], [1.0, 10.0], is_magnitude=True).plot()
    assert not level.axes[1].get_lines()
    assert level.axes[1].texts[0].get_text() == "not measured"


def test_a_mode_in_which_nothing_is_drawn_says_so():
    still = symflex.loads('symflex = 1\ninputs.u = {}\nfields = {}\noutputs.y = "u/(s + 1)"')
    shape = still.transfer_function("y", "u").bind()
    with pytest.raises((ModelError, UsageError)):
        shape.mode_shape(1).plot()


@pytest.mark.slow
def test_a_sweep_draws_itself(drive):
    sweep = drive.sweep({"k": [80e3, 90e3, 100e3]})
    panels = own(3)
    assert sweep.plot(ax=panels) is panels[0].figure
    assert sweep.plot()._repr_png_()[0].startswith(PNG)


def test_a_figure_can_be_gone_on_with(actuator):
    figure = actuator.pole_zero_plot()
    figure.axes[0].axhline(-100)
    buffer = BytesIO()
    figure.savefig(buffer, format="svg")
    assert buffer.getvalue().startswith(b"<?xml")


@pytest.fixture(scope="module")
def everything():
    model = symflex.loads(TEXT)
    function = model.transfer_function("X_act", "F")
    bound = function.bind()
    nested = model.nested("X_act", "F")
    looped = symflex.loads(LOOP)
    stability = looped.stability("K")
    loop = characteristic_loop(looped.resolved, "K")
    rational = bound.rational()
    sweep = model.sweep({"k": [80e3, 90e3]})
    shape = bound.mode_shape(1)
    found = bound.pole_zero_map()
    return {
        "model": model,
        "resolved model": model.resolved,
        "parameters": model.parameters,
        "specification": parse(Source("<string>", TEXT)),
        "equations": pipeline.assemble(model.resolved),
        "function": function,
        "function inside": function.exact,
        "form": function.form(),
        "nested": nested,
        "nested inside": nested.exact,
        "nested with numbers": nested.bind(),
        "with numbers": bound,
        "with numbers inside": bound.bound,
        "map": found,
        "certificate": found.certificate,
        "verdict": found.verdict,
        "poles": bound.poles(),
        "residues": bound.residues(),
        "rational": rational,
        "error": rational.error,
        "explanation": bound.explain_zeros(),
        "shape": shape,
        "shape inside": shape.enclosed,
        "response": bound.frequency_response([1.0, 2.0]),
        "state space": function.state_space(),
        "state space inside": realise(model.resolved),
        "state space with numbers": bound.state_space(),
        "stability": stability,
        "boundaries": stability.boundaries,
        "stability inside": stability.proved,
        "loop": loop,
        "sweep": sweep,
        "array": sweep.parameters[0],
        "colocation": model.colocation("X_act", "X_act", "F", band=(1.0, 2.0)),
        "measurement": model.measure("V_tip", "F", (2, 40), 0.5),
        "shaper": bound.input_shaper(1, "zvd"),
        "in time": bound.step_response([0.0, 0.1]),
        "sampled": bound.discretise(1e-3),
        "step info": symflex.loads('symflex = 1\ninputs.u = {}\noutputs.y = "5*u/(s^2 + 2*s + 5)"')
        .transfer_function("y", "u")
        .bind()
        .step_info(),
    }


def test_everything_prints_short(everything):
    said = {name: repr(thing) for name, thing in everything.items()}
    assert not {name: text for name, text in said.items() if len(text) > LONGEST or "\n" in text}


def test_html_of_a_notebook_is_closed(everything):
    pages = {n: thing._repr_html_() for n, thing in everything.items() if hasattr(thing, "_repr_html_")}
    assert {"rational", "sweep", "poles", "stability", "explanation", "shaper", "step info"} < pages.keys()
    for page in pages.values():
        tags = re.findall(r"<(/?)(\w[\w:]*)[^>]*?(/?)>", page)
        assert sum(-1 if end else 1 for end, tag, alone in tags if not alone and tag != "br") == 0
        assert len(page) < LONGEST_PAGE
        assert "<pre" not in page


def test_a_root_is_typeset_and_poles_are_a_table_in_a_notebook_and_a_tuple_elsewhere(actuator):
    poles = actuator.poles()
    assert re.fullmatch(
        r"\$s = -1\.3333\d* - 79\.5710\d*\\,\\mathrm\{j\}\\ \\mathrm\{rad/s\}\$", poles[-1]._repr_latex_()
    )
    assert isinstance(poles, tuple)
    assert poles._repr_html_().count("<tr>") == len(poles) + 1
    assert ">12.66" in poles._repr_html_()  # sqrt(k (1/m_1 + 1/m_2))/(2 pi) = 12.666 Hz


def test_state_equations_are_matrices_in_a_notebook(drive):
    shown = drive.transfer_function("X_act", "F").state_space()._repr_latex_()
    assert shown.count(r"\begin{matrix}") == 4


@pytest.mark.slow
def test_a_nested_function_draws_the_curve_of_the_expanded_one():
    model = symflex.loads(
        'symflex = 1\nelements.m = { type = "mass", at = "x", m = "2 kg" }\n'
        'elements.k = { type = "spring", between = ["x", "ground"], k = "8 N/m" }\n'
        'inputs.F = { force = "x" }\noutputs.X = "x"\n'
    )
    nested, expanded = model.nested("X", "F").bind(), model.transfer_function("X", "F").bind()
    curve = nested.bode(band=(0.01, 1)).axes[0].lines[0]
    # |1/(8 - 2 omega^2)| in dB, by hand.
    omega = 2 * np.pi * np.asarray(curve.get_xdata())
    beside = abs(8 - 2 * omega**2) > 1e-3  # the pole itself is at infinity
    drawn = np.asarray(curve.get_ydata())[beside]
    assert drawn == pytest.approx(-20 * np.log10(abs(8 - 2 * omega[beside] ** 2)), abs=1e-6)
    assert len(drawn) > 50
    assert len(expanded.bode(nested).axes[0].lines) == 2
    assert len(nested.pole_zero_plot().axes) == 1
    assert [text.get_text() for text in nested.nyquist().legends[0].get_texts()] == ["$X/F$"]


def test_a_notebook_shows_residues_as_a_table():
    """1/(s^2 + 2 s + 5) has the residue -j/4 at -1 + 2j and its conjugate at the other pole."""
    two = symflex.loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/(s^2 + 2*s + 5)"')
    shown = two.transfer_function("y", "u").bind().rational(form="modal")._repr_html_()
    rows = re.findall(r"<tr>(.*?)</tr>", shown)
    cells = re.sub("<[^>]*>", " ", rows[1]).split()
    assert cells == ["\u22121", "\u00b12", "0", "\u22130.25"]


def test_a_notebook_shows_stability_as_tables():
    """K/(s (s + 1)(s + 2)) around a loop: the boundary lies at K = 6, by Routh's table."""
    shown = symflex.loads(LOOP).stability("K")._repr_html_()
    assert "<pre>" not in shown
    assert shown.count("<table>") == 4
    assert re.search(r"<td[^>]*>6</td>", shown)


def test_a_notebook_shows_charts_spreads_and_peaks_with_names_that_stay_text():
    """K e^(-s T)/s is stable where K T < pi/2; its closed loop peaks at rest while K T is small."""
    model = symflex.Model(
        parameters={"K": 1, "T": "0.1 s"},
        signals={"y": "K*exp(-s*T)/s*(r - y)"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    )
    chart = model.stability(over=("K", "T"), ranges={"K": (0, 4), "T": (0, 2)}, resolve="10 %")
    spread, peak = model.stability(spread="20 %"), model.peak("Y", "r")
    for shown, said in ((chart, "unstable by 2"), (spread, "stable for every"), (peak, "magnitude 1.0")):
        assert said in shown._repr_html_()
    for shown in (
        replace(chart, names=("<b>", "$x$")),
        replace(spread, names=("<b>", "$x$")),
        replace(peak, tf="<b>$x$"),
    ):
        page = shown._repr_html_()
        assert "<b>" not in page
        assert "$x" not in page


def test_a_figure_with_other_data_is_saved_as_pgf_without_tex(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", "")
    lag = symflex.loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/(s + 1)"').transfer_function("y", "u")
    figure = lag.bind().bode(width="ieee")
    figure.axes[0].plot([0.1, 0.2], [-3.0, -4.0], ".")
    figure.savefig(tmp_path / "lag.pgf")
    assert (tmp_path / "lag.pgf").read_text(encoding="ascii").count("\\begin{pgfpicture}") == 1


def test_a_formula_is_set_for_the_width_of_a_column():
    terms = " + ".join(f"a_{i}*s^{i}" for i in range(12))
    names = ", ".join(f"a_{i} = {{}}" for i in range(12))
    text = f'symflex = 1\nparameters = {{ {names} }}\ninputs.u = {{}}\noutputs.y = "u/({terms})"'
    tf = symflex.loads(text).transfer_function("y", "u")
    assert "\\begin" not in tf.latex()
    assert tf.latex(width="a4").startswith("\\begin{equation}")
    assert "\\begin{align}" in tf.latex(width=80.0)


def test_one_time_is_the_last_of_a_response():
    lag = (
        symflex.loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/(s + 1)"')
        .transfer_function("y", "u")
        .bind()
    )
    for given in ("200 ms", 0.2):
        found = lag.step_response(given)
        assert (found.times.size, found.times[-1]) == (201, 0.2)
