import numpy as np
import pytest

import symflex
from tests.unit.cli.commands import ROOT

FOLDER = ROOT / "derivations" / "eppinger1988"
DATA = FOLDER / "data" / "synthetic_figure_3.csv"
BASE = ["--base", FOLDER / "rigid_body.toml", "--tf", "A_tip/V_cmd"]
PAPER_HZ = [11.0, 38.0, 44.0, 67.0, 77.0]


@pytest.fixture
def oscillator(shell):
    """Exact data of 3 (1 + 0.02j x - x^2)/(1 + 0.04j y - y^2), x = f/25 Hz, y = f/20 Hz."""
    f = np.arange(2.0, 60.0, 0.25)
    x, y = f / 25, f / 20
    h = 3 * (1 + 0.02j * x - x**2) / (1 + 0.04j * y - y**2)
    rows = [f"{a},{b.real!r},{b.imag!r}" for a, b in zip(f.tolist(), h.tolist(), strict=True)]
    (shell.folder / "one.csv").write_text("\n".join(["frequency_hz,re,im", *rows]) + "\n")
    return shell


def test_the_paper_s_modes_come_back_from_the_synthetic_figure(shell):
    done = shell("fit", DATA, *BASE, "--lag", "--modes", "5", "--json")
    assert done.code == 0
    poles, (response,) = done.json["poles"], done.json["responses"]
    assert [p["frequency_hz"] for p in poles] == pytest.approx(PAPER_HZ, rel=0.002)
    assert [p["damping_ratio"] for p in poles] == pytest.approx([0.05] * 5, rel=0.05)
    zeros = [z["frequency_hz"] for z in response["zeros"]]
    assert zeros == pytest.approx([1.1 * f for f in PAPER_HZ], rel=0.002)
    assert response["synthetic"]
    assert response["phase_test"]["minimum_phase"]
    # second order, 5 kHz, damping 0.7: a lag of 2 zeta/omega
    assert response["lag"]["value"] == pytest.approx(2 * 0.7 / (2 * np.pi * 5000), rel=0.15)


@pytest.mark.slow
def test_the_fitted_specification_is_the_one_in_the_repository(shell):
    assert shell("fit", DATA, *BASE, "--lag", "--modes", "5", "-o", "fitted.toml").code == 0
    fitted = symflex.load(shell.folder / "fitted.toml")
    kept = symflex.load(FOLDER / "fitted_resonances.toml")
    for new, old in zip(fitted.parameters, kept.parameters, strict=True):
        assert new.name == old.name
        assert float(new.value.rational) == pytest.approx(float(old.value.rational), rel=1e-4)
    poles = kept.transfer_function("A_tip", "V_cmd").bind().poles()
    frequencies = sorted({round(abs(complex(p)) / (2 * np.pi), 1) for p in poles if complex(p).imag > 0})
    assert frequencies == pytest.approx(PAPER_HZ, abs=0.06)


@pytest.mark.slow
def test_the_report_says_synthetic_fits_eighty_columns_and_shows_errors_and_phase_test(shell):
    out = shell("fit", DATA, *BASE, "--modes", "5", "--plot", "a.svg", "-o", "a.toml").out
    assert "SYNTHETIC" in DATA.read_text().splitlines()[0]
    assert "SYNTHETIC" in (shell.folder / "a.toml").read_text()
    assert max(map(len, out.splitlines())) <= 80
    assert all(said in out for said in ("SYNTHETIC", "std. error", "phase test: "))


@pytest.mark.slow
def test_without_a_base_its_real_poles_are_residual_terms(shell):
    done = shell("fit", DATA, "--json")
    assert done.code == 0
    assert [p["frequency_hz"] for p in done.json["poles"]] == pytest.approx(PAPER_HZ, rel=0.005)
    assert done.json["real_poles"] or done.json["residual_poles"]


@pytest.mark.slow
def test_a_fit_without_base_is_a_specification_of_its_own(oscillator):
    done = oscillator("fit", "one.csv", "--modes", "1", "-o", "one.toml")
    assert (done.code, done.err) == (0, "wrote one.toml\n")
    G = symflex.load(oscillator.folder / "one.toml").transfer_function("one", "U").bind()
    assert G(2j * np.pi * 20) == pytest.approx(3 * (1 + 0.016j - 0.64) / 0.04j, rel=1e-6)
    assert oscillator("roots", "one.toml").err == ""
    assert oscillator("export", "one.toml", "--to", "numpy").code == 0


@pytest.mark.slow
def test_a_loop_that_is_closed_in_the_file_has_the_gains_that_routh_says(shell):
    f = np.linspace(2.0, 60.0, 300)
    s = 2j * np.pi * f
    zeta, omega = 0.05, 2 * np.pi * 20
    h = 3 / (s * (1 + 2 * zeta * s / omega + (s / omega) ** 2))
    rows = [f"{a},{b.real!r},{b.imag!r}" for a, b in zip(f.tolist(), h.tolist(), strict=True)]
    (shell.folder / "axis 1.csv").write_text("\n".join(["frequency_hz,re,im", *rows]) + "\n")
    assert shell("fit", "axis 1.csv", "-o", "axis.toml", "--loop", "K").code == 0
    done = shell("stability", "axis.toml", "--gain", "K", "--json")
    assert (done.code, done.err) == (0, "")
    # s^3/omega^2 + 2 zeta s^2/omega + s + 3 K: stable up to 3 K = 2 zeta omega (Routh 1877).
    (boundary,) = done.json["boundaries"]
    assert float(boundary["gain"]["value"]) == pytest.approx(2 * zeta * omega / 3, rel=1e-5)
    assert "axis_1/r" in shell("roots", "axis.toml").out
    assert shell("fit", "axis 1.csv", "-o", "axis.toml", "--loop", "s").code == 2
    assert shell("fit", "axis 1.csv", "--loop", "K").code == 2


def test_guesses_are_printed_one_line_each_and_columns_overrules_them(oscillator):
    text = (oscillator.folder / "one.csv").read_text().replace("frequency_hz,re,im", "f;Point 1;")
    (oscillator.folder / "two.csv").write_text(text.replace("f;Point 1;\n", ""))
    asked = oscillator("fit", "two.csv", "--modes", "1")
    assert (asked.code, asked.out) == (3, "")
    assert "two.csv:1:1: error[SF602]" in asked.err
    assert "--columns f,re,im" in asked.err
    done = oscillator("fit", "two.csv", "--modes", "1", "--columns", "f,re,im", "--json")
    assert (done.code, done.err) == (0, "")
    (oscillator.folder / "three.csv").write_text("Analyser\n" + text.replace("f;Point 1;", "Freq,Real,Imag"))
    said = oscillator("fit", "three.csv", "--modes", "1", "--json")
    assert said.json["poles"] == done.json["poles"]
    assert said.err.splitlines() == [
        "three.csv: line 2 names the columns, and the numbers begin in line 3: the other lines above are "
        "skipped",
        "three.csv: 'Freq' has no unit and is read in Hz",
    ]


@pytest.mark.slow
def test_several_responses_become_several_outputs_and_one_figure(shell):
    f = np.linspace(5.0, 60.0, 300)
    s = 2j * np.pi * f
    pole = 1 + 0.02 * s / (2 * np.pi * 20) + (s / (2 * np.pi * 20)) ** 2
    for name, value in (("a", 1 / pole), ("b", (1 + s / 500) / pole)):
        rows = "".join(
            f"{x},{v.real!r},{v.imag!r}\n" for x, v in zip(f.tolist(), value.tolist(), strict=True)
        )
        (shell.folder / f"{name}.csv").write_text(f"# tf: {name}/u\nf,re,im\n{rows}")
    done = shell("fit", "a.csv", "b.csv", "-o", "ab.toml", "--plot", "ab.png", "--plot-order", "order.png")
    assert done.code == 0
    assert sorted(path.name for path in shell.folder.glob("*.png")) == ["ab.png", "order.png"]
    model = symflex.load(shell.folder / "ab.toml")
    G = model.transfer_function("b", "u").bind()
    assert G(2j * np.pi * 20) == pytest.approx((1 + 2j * np.pi * 20 / 500) / 0.02j, rel=1e-6)
    assert shell("roots", "ab.toml", "--tf", "a/u").code == 0
    assert shell("export", "ab.toml", "--to", "numpy").code == 0


@pytest.mark.slow
@pytest.mark.parametrize("modes", [1, 3, 4])
def test_driving_with_another_number_of_modes_than_there_are_ends_in_shapes(shell, modes):
    f = np.geomspace(5, 50, 60)
    s = 2j * np.pi * f
    rough = 0.02 * np.random.default_rng(4).standard_normal((2, 2, f.size))
    for k, shape in enumerate(((1.0, 1.0), (0.7, -0.5))):
        value = sum(c / (s**2 + 0.06 * w * s + w * w) for c, w in zip(shape, (94.2, 188.5), strict=True))
        value = value * (1 + rough[k, 0] + 1j * rough[k, 1])
        rows = "".join(
            f"{x},{v.real!r},{v.imag!r}\n" for x, v in zip(f.tolist(), value.tolist(), strict=True)
        )
        (shell.folder / f"{k}.csv").write_text(f"# tf: X_{k}/F\n# unit: m/N\nf,re,im\n{rows}")
    done = shell("fit", "0.csv", "1.csv", "--driving", "X_0/F", "--modes", modes, "--json")
    assert done.code == 0
    if modes > 1:
        assert done.json["mode_shapes"]["shapes"][1] == [
            pytest.approx(1, abs=0.05),
            pytest.approx(-0.5, abs=0.05),
        ]


@pytest.mark.slow
def test_a_poor_fit_says_so_first_and_strict_makes_it_exit_code_4(oscillator):
    f = np.arange(2.0, 60.0, 0.5)
    noise = np.random.default_rng(1).standard_normal((2, f.size)) * 0.02
    h = 1 / ((1 + 0.04j * f / 20 - (f / 20) ** 2) * (1 + 0.04j * f / 30 - (f / 30) ** 2))
    h = h * (1 + noise[0] + 1j * noise[1])
    rows = [f"{a},{b.real!r},{b.imag!r}" for a, b in zip(f.tolist(), h.tolist(), strict=True)]
    (oscillator.folder / "two.csv").write_text("\n".join(["f,re,im", *rows]) + "\n")
    done = oscillator("fit", "two.csv", "--modes", "1")
    assert done.code == 0
    assert done.out.startswith("POOR FIT: ")
    document = oscillator("fit", "two.csv", "--modes", "1", "--json").json
    assert document["poor"] is True
    assert document["poor_because"]
    strict = oscillator("fit", "two.csv", "--modes", "1", "--strict", "-o", "poor.toml")
    assert (strict.code, strict.out) == (4, "")
    assert "SF618" in strict.err
    assert not (oscillator.folder / "poor.toml").exists()
    assert oscillator("fit", "two.csv", "--modes", "2", "--strict").code == 0


@pytest.mark.slow
def test_a_fitted_delay_is_written_and_taken_by_check_derive_and_roots(oscillator):
    lines = (oscillator.folder / "one.csv").read_text().splitlines()
    table = np.array([[float(x) for x in line.split(",")] for line in lines[1:]])
    h = (table[:, 1] + 1j * table[:, 2]) * np.exp(-2j * np.pi * table[:, 0] * 0.003)
    rows = [f"{a},{b.real!r},{b.imag!r}" for a, b in zip(table[:, 0].tolist(), h.tolist(), strict=True)]
    (oscillator.folder / "late.csv").write_text("\n".join(["f,re,im", *rows]) + "\n")
    done = oscillator("fit", "late.csv", "--modes", "1", "--delay", "-o", "late.toml", "--json")
    assert done.code == 0
    assert done.json["delay_fitted"] is True
    assert done.json["responses"][0]["delay"]["value"] == pytest.approx(0.003, rel=1e-4)
    for command in ("check", "derive", "roots"):
        assert oscillator(command, "late.toml").code == 0


def test_json_has_the_documented_keys(oscillator):
    document = oscillator("fit", "one.csv", "--modes", "1", "--json").json
    assert document["schema"] == "symflex.fit/1"
    page = (ROOT / "docs" / "commands" / "fit.md").read_text(encoding="utf-8")
    section = page.partition("### `symflex.fit/1`")[2].partition("\n### ")[0]
    keys = {
        *document,
        *document["responses"][0],
        *document["poles"][0],
        *document["responses"][0]["phase_test"],
    }
    assert all(f"`{key}`" in section for key in keys - {"schema"})


def test_what_cannot_be_meant_has_its_exit_code_and_writes_nothing(oscillator):
    for arguments, code in (
        ("fit", 2),
        ("fit none.csv", 2),
        ("fit one.csv --tf X/F", 2),
        ("fit one.csv --base none.toml", 2),
        ("fit one.csv --base x.toml --tf X/G", 2),
        ("fit one.csv --base x.toml --tf X/F --tf V/F", 2),
        ("fit one.csv --base x.toml --slope 1", 2),
        ("fit one.csv --start peeks", 2),
        ("fit one.csv --modes 0", 2),
        ("fit one.csv --band 10 5", 2),
        ("fit one.csv --modes 1 -o one.json", 2),
        ("fit one.csv --modes 1 --plot one.jpg", 2),
        ("fit one.csv --modes 1 -o nowhere/one.toml", 2),
        ("fit one.csv --band 100 200", 3),
        ("fit one.csv --band 2 3", 3),
        ("fit x.toml", 3),
        ("fit wrong.csv", 3),
        ("fit one.csv --averages nan", 2),
        ("fit one.csv --averages inf", 2),
        ("fit one.csv --averages 1e400", 2),
        ("measure x.toml -o a.csv", 2),
        ("measure x.toml -o a.xlsx --band 1 10", 2),
        ("measure x.toml -o a.csv --band 10 1", 2),
        ("measure x.toml -o a.csv --band 1 10 --spacing 0", 2),
        ("measure x.toml -o a.csv --band 1 10 --averages 100000000", 2),
        ("measure x.toml -o a.csv --band 0.1 1", 2),  # undamped
        ("measure symbolic.toml -o a.csv --band 1 10", 3),
    ):
        (oscillator.folder / "wrong.csv").write_text("f,re,im\n1,2,nan\n")
        before = sorted(p.name for p in oscillator.folder.iterdir())
        done = oscillator(*arguments.split())
        assert (done.code, done.out) == (code, ""), (arguments, code)
        assert "Traceback" not in done.err, (arguments, code)
        assert sorted(p.name for p in oscillator.folder.iterdir()) == before, (arguments, code)


def test_measure_names_the_option_that_is_no_number(oscillator):
    for option, value, named in (
        ("--noise", "nan", "noise"),
        ("--noise", "inf", "noise"),
        ("--rolloff", "nan", "roll-off"),
    ):
        done = oscillator("measure", "x.toml", "-o", "a.csv", "--band", "1", "10", option, value)
        assert done.code == 2, (option, value, named)
        assert f"the {named} is {value}" in done.err, (option, value, named)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("power", [0, 2])
@pytest.mark.slow
def test_data_without_any_resonance_are_fitted_by_a_gain_and_a_power_of_s(shell, power):
    rows = "".join(f"{i},{float(i) ** power},0\n" for i in range(1, 61))
    (shell.folder / "flat.csv").write_text("frequency_hz,re,im\n" + rows)
    done = shell("fit", "flat.csv", "--json", "--strict")
    assert done.code == 0
    assert done.json["modes"] == 0
    assert abs(done.json["responses"][0]["slope"]) == power


@pytest.mark.slow
def test_measure_writes_what_fit_reads(shell):
    (shell.folder / "damped.toml").write_text(
        'symflex = 1\nparameters = { m = "2 kg", k = "20 kN/m", b = "10 N*s/m" }\n'
        'inputs.F = { force = "x" }\noutputs.A = "s^2*x"\n'
        'elements.body = { type = "mass", at = "x", m = "m" }\n'
        'elements.wall = { type = "spring", between = ["x", "ground"], k = "k" }\n'
        'elements.loss = { type = "damper", between = ["x", "ground"], b = "b" }\n'
    )
    done = shell("measure", "damped.toml", "-o", "a.npz", "--band", "2", "40", "--spacing", "0.25")
    assert done.code == 0
    assert "SYNTHETIC" in done.err
    fitted = shell("fit", "a.npz", "--base", "damped.toml", "--tf", "A/F", "--json")
    assert (fitted.code, fitted.json["modes"]) == (0, 0)  # nothing is left to fit


def test_responses_to_one_force_give_mass_normalised_mode_shapes(shell, tmp_path):
    # Two equal masses on equal springs: modes (1, g)/sqrt(m (1 + g^2)) and (g, -1)/..., g the golden ratio.
    f, m, k = np.arange(5.0, 60.0, 0.1), 2.0, 4e4
    s = 2j * np.pi * f
    w = k * (1 + 2e-4 * s)
    det = (m * s**2 + 2 * w) * (m * s**2 + w) - w**2
    for name, value in (("a", (m * s**2 + w) / det), ("b", w / det)):
        rows = "\n".join(
            f"{x},{v.real!r},{v.imag!r}" for x, v in zip(f.tolist(), value.tolist(), strict=True)
        )
        (tmp_path / f"{name}.csv").write_text(f"# tf: {name}/F\n# unit: m/N\nfrequency_hz,re,im\n{rows}\n")
    files = [str(tmp_path / f"{name}.csv") for name in "ab"]
    found = shell("fit", *files, "--driving", "a/F", "--modes", "2", "--json").json["mode_shapes"]
    golden = (1 + 5**0.5) / 2
    low = np.array([1, golden]) / np.sqrt(m * (1 + golden**2))
    assert found["responses"] == ["a/F", "b/F"]
    assert found["unit"] == "kg^(-1/2)"
    assert np.array(found["shapes"]) == pytest.approx(np.array([low, [low[1], -low[0]]]), rel=1e-4)
    done = shell("fit", *files, "--driving", "a/F", "--modes", "2", "-o", "driven.toml")
    assert "files and figures have all responses, fitted with the same poles" in done.err
    model = symflex.load(tmp_path / "driven.toml")
    for name, value in (("a", (m * s**2 + w) / det), ("b", w / det)):
        bound = model.transfer_function(name, "F").bind()
        assert bound(s[100]) == pytest.approx(value[100], rel=1e-3)
    text = done.out
    assert "mass-normalised mode shapes [kg^(-1/2)], driven at a/F" in text
    assert max(map(len, text.splitlines())) <= 80
    refused = shell("fit", *files, "--driving", "c/F")
    assert refused.code == 2
    assert refused.err.startswith("error[SF902]")


@pytest.mark.slow
def test_a_base_whose_values_the_data_contradict_is_said(shell):
    # the tip's mass is 3 % larger than in the base: its zero, sqrt(k/m_2), moves from 35.588 to 35.064 Hz
    base = """
symflex = 1
parameters = { m_1 = "2 kg", m_2 = "0.4 kg", k = "20 kN/m", b = "2 N*s/m" }
[equations]
unknowns = ["x", "y"]
equations = ["m_1*s^2*x + (b*s + k)*(x - y) = F", "m_2*s^2*y + (b*s + k)*(y - x) = 0"]
[inputs]
F = {}
[outputs]
X = "x"
"""
    f = np.linspace(20, 50, 150)
    s = 2j * np.pi * f
    z, m_2 = 20e3 + 2 * s, 0.412
    noise = np.random.default_rng(1).standard_normal((2, f.size))
    h = (m_2 * s**2 + z) / ((2 * s**2 + z) * (m_2 * s**2 + z) - z**2)
    h = h * (1 + 0.002 * (noise[0] + 1j * noise[1]))
    rows = [f"{a},{b.real!r},{b.imag!r}" for a, b in zip(f.tolist(), h.tolist(), strict=True)]
    (shell.folder / "base.toml").write_text(base)
    (shell.folder / "data.csv").write_text("\n".join(["# tf: X/F", "frequency_hz,re,im", *rows]) + "\n")
    done = shell("fit", "data.csv", "--base", "base.toml", "--modes", "2", "--json").json
    assert done["poor"]
    assert any("cancels a zero of the base at 35.5" in reason for reason in done["poor_because"])
    (fitted,) = shell("fit", "data.csv", "--model", "base.toml", "--free", "m_2", "--json").json["parameters"]
    assert abs(fitted["value"] - 0.412) < 3 * fitted["standard_error"]


def test_a_fitted_specification_has_values_errors_and_spreads(shell):
    example = ROOT / "derivations" / "measured"
    arguments = ("fit", example / "data" / "motor.csv", "--model", example / "motor.toml", "--free")
    assert shell(*arguments, "R,k,J", "-o", "fitted.toml").code == 0
    model = symflex.load(shell.folder / "fitted.toml")
    found = {p.name: p for p in model.parameters}
    # the first line of the data has the values
    for name, true in {"R": 1.2, "k": 0.05, "J": 3e-5}.items():
        p = found[name]
        assert abs(float(p.value.rational) - true) < 2 * float(p.spread.rational)
        assert "; fitted to SYNTHETIC data, omega/u, standard error " in p.doc
    assert found["L"].spread is None
    again = shell(*arguments, "R,L,k,J,b", "-o", "not.toml")
    assert again.code == 4
    assert "NOT IDENTIFIABLE" in again.out
    assert not (shell.folder / "not.toml").exists()


def test_a_record_of_a_start_gives_the_parameters_of_a_motor(shell):
    example = ROOT / "derivations" / "measured"
    record = example / "data" / "motor_start.csv"
    done = shell("fit", record, "--model", example / "motor.toml", "--free", "R,k,J", "--json").json
    # the first line of motor.csv has the values
    for found, true in zip(done["parameters"], (1.2, 0.05, 3e-5), strict=True):
        assert abs(found["value"] - true) < 3 * found["standard_error"] < 0.1 * true
    assert "held between samples" in done["in_time"][0]
