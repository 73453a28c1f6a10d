"""What a fit writes is a specification that every command takes."""

from __future__ import annotations

import numpy as np
import pytest

import symflex
from symflex.data.fitting import fit_resonances
from symflex.data.fitting.specification import fit_specification
from symflex.data.fitting.text import fit_passages
from symflex.data.measurement import MeasuredResponse
from symflex.errors import FitError
from symflex.options import FitOptions
from symflex.print.text import passages_text

FREQUENCY = np.arange(2.0, 60.0, 0.25)
S = 2j * np.pi * FREQUENCY
DELAYED = """
symflex = 1
[parameters]
m = "2 kg"
b = "30 N*s/m"
T = "2 ms"
R_1 = 3
[blocks]
D = { type = "delay", T = "T" }
[elements]
car = { type = "mass", at = "x", m = "m" }
road = { type = "damper", between = ["x", "ground"], b = "b" }
drive = { type = "force_source", at = "x", f = "R_1*D*r" }
[inputs]
r = {}
other = { force = "x" }
[outputs]
X = "x"
V = "s*x"
"""
ROD = """
symflex = 1
[parameters]
E = "1 GPa"
A = "1e-3 m^2"
rho = "1000 kg/m^3"
l = "0.5 m"
[elements]
bar = { type = "rod", between = ["x", "ground"], E = "E", A = "A", rho = "rho", l = "l" }
[inputs]
F = { force = "x" }
[outputs]
X = { expr = "x", latex = 'X_1' }
"""


def resonance():
    x, y = S / (2j * np.pi * 25), S / (2j * np.pi * 20)
    return (1 + 2 * 0.01 * 1j * x - x**2) / (1 + 2 * 0.02 * 1j * y - y**2)


def noisy(values, seed=1):
    random = np.random.default_rng(seed)
    error = random.standard_normal(S.size) + 1j * random.standard_normal(S.size)
    return MeasuredResponse("X/r", FREQUENCY, values * (1 + 0.01 * error))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "delayed.toml").write_text(DELAYED)
    (tmp_path / "rod.toml").write_text(ROD)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def written(fit, folder, name="fitted.toml"):
    (folder / name).write_text(fit.specification(folder))
    return symflex.load(folder / name)


def test_a_base_with_a_delay_is_copied_into_a_file_that_derives(folder):
    base = 3 * np.exp(-S * 2e-3) / (2 * S**2 + 30 * S)
    fit = symflex.fit(noisy(base * resonance()), "delayed.toml", "X/r", modes=1)
    (folder / "below").mkdir()
    for place in (folder, folder / "below"):  # the base beside the file, and outside of its folder
        model = written(fit, place)
        assert (model.inputs, model.outputs) == (("r",), ("X",))
        assert model.transfer_function("X", "r").bind()(S[40]) == pytest.approx(fit.values()[40], rel=1e-6)


def test_a_base_with_a_beam_or_rod_is_copied_too(folder):
    q = S * np.sqrt(1.0 / 1e6)
    base = np.tanh(q * 0.5) / (1e6 * q)
    fit = symflex.fit(noisy(base * resonance()), "rod.toml", "X/F", modes=1)
    model = written(fit, folder)
    assert model.transfer_function("X", "F").bind()(S[40]) == pytest.approx(fit.values()[40], rel=1e-6)


@pytest.mark.slow
def test_a_delay_is_found_and_written_as_a_delay_block(folder):
    fit = symflex.fit(noisy(2.5 * resonance() * np.exp(-S * 4e-3)), modes=1, delay=True)
    assert fit.resonances.delay[0] == pytest.approx(4e-3, abs=4 * fit.standard_errors.delay[0])
    assert fit.standard_errors.delay[0] < 1e-4
    assert 'type = "delay"' in fit.specification()
    function = written(fit, folder).transfer_function("X", "r").bind()
    assert function(S[40]) == pytest.approx(fit.values()[40], rel=1e-6)


@pytest.mark.slow
def test_a_fit_has_an_input_shaper_for_the_resonance_that_was_measured(folder):
    fit = symflex.fit(noisy(2.5 * resonance()), modes=1, slope=0)
    shaper = fit.input_shaper()
    # Half a damped period, and exp(-zeta pi/sqrt(1 - zeta^2)) between both (Singer and Seering 1990).
    zeta, omega = 0.02, 2 * np.pi * 20
    late = np.pi / (omega * np.sqrt(1 - zeta**2))
    assert shaper.times[1] == pytest.approx(late, rel=4 * fit.standard_errors.omega_p[0] / omega)
    ratio = np.exp(-zeta * omega * late)
    assert shaper.amplitudes[1] / shaper.amplitudes[0] == pytest.approx(
        ratio, rel=4 * np.pi * fit.standard_errors.zeta_p[0]
    )


@pytest.mark.slow
def test_a_delay_and_a_lag_are_not_negative_unless_asked(folder):
    lead = noisy(2.5 * resonance() * np.exp(S * 1e-3))
    assert symflex.fit(lead, modes=1, slope=0, delay=True).resonances.delay[0] >= 0
    lead = noisy(2.5 * resonance() * (1 + S * 4e-4))
    assert symflex.fit(lead, modes=1, slope=0, lag=True).resonances.lag[0] >= 0
    signed = symflex.fit(lead, modes=1, slope=0, lag="signed")
    assert signed.resonances.lag[0] < 0
    function = written(signed, folder).transfer_function("X", "r").bind()
    assert function(S[40]) == pytest.approx(signed.values()[40], rel=1e-6)


def test_resonances_without_zeros_and_real_zeros_are_written(folder):
    # With zeros at +-190 rad/s, and with none.
    without = 2.5 / (1 + 0.04 * S / 125 + (S / 125) ** 2)
    for above, count in ((1.0, 0), (1 - (S / 190) ** 2, 1)):
        fit = symflex.fit(noisy(without * above / (1 + 0.04 * S / 220 + (S / 220) ** 2)), modes=2)
        assert np.sum(fit.resonances.omega_z < 0) == count
        assert np.sum(fit.resonances.has_zeros) == count
        model = written(fit, folder)
        assert model.warnings == ()
        function = model.transfer_function("X", "r").bind()
        assert function(S[40]) == pytest.approx(fit.values()[40], rel=1e-6)


def test_what_cannot_be_written_is_an_error_and_no_text(folder):
    fit = symflex.fit(noisy(resonance() / (2 * S**2 + 30 * S)), "delayed.toml", "X/other", modes=1)
    (folder / "delayed.toml").write_text(DELAYED.replace("D*r", "D*s*r*r"))
    with pytest.raises(FitError) as caught:
        fit.specification(folder / "below")
    assert caught.value.diagnostics[0].code == "SF617"


def test_a_report_has_the_digits_that_errors_allow_and_the_unit_of_the_gain(tmp_path):
    frequency = np.linspace(10270325.0, 10299976.0, 150)
    s, w = 2j * np.pi * frequency, 2 * np.pi * 10293933.7
    random = np.random.default_rng(1)
    noise = 1 + 0.005 * (random.standard_normal(150) + 1j * random.standard_normal(150))
    values = 1e5 * noise * w**2 / (s**2 + 2 * 2e-5 * w * s + w**2)
    made = fit_resonances([MeasuredResponse("Z", frequency, values, unit="Ohm")], None, FitOptions(slope=0))
    text = passages_text(fit_passages(made, None), 80)
    (row,) = (line.split() for line in text.splitlines() if line.startswith("    1 "))
    assert len(row[1].partition(".")[2]) >= 1  # a tenth of a Hz or less, as its error
    assert abs(float(row[1]) - 10293933.7) < 4 * float(row[2])
    assert "from 10270320 to 10299980 Hz" in text
    assert any(line.startswith("  gain ") and " Ohm, standard error" in line for line in text.splitlines())
    assert 'band = ["10270325 Hz"' in fit_specification(made, tmp_path)
