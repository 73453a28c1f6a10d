"""Fits to data of every kind, judged by what is true of them."""

import numpy as np
import pytest

import symflex
from symflex.errors import UsageError
from tests.unit.data.kinds import KINDS, complex_noise, of_lines, study, table


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_errors_are_those_that_a_fit_says_and_resonances_are_there(kind):
    off, wrong, phantoms = study(kind, 24, seed=3)
    # The rms of 96 errors, all as they are said, is between these limits in 99 of 100 studies.
    assert 0.8 < np.sqrt(np.mean(off**2)) < 1.25
    assert len(wrong) <= 1 and not phantoms


def fitted(folder, text, columns=None, **options):
    (folder / "data.csv").write_text(text, encoding="utf-8")
    return symflex.fit(folder / "data.csv", columns=columns, **options)


def test_a_magnitude_alone_is_fitted_as_such(tmp_path):
    text, ((omega, _),) = of_lines(np.random.default_rng(1), 0, "magnitude")
    fit = fitted(tmp_path, text, "f,mag_db")
    assert fit.resonances.omega_p == pytest.approx([omega], rel=2e-3)
    assert np.all(fit.resonances.zeta_z >= 0) and fit.resonances.gain[0] > 0
    assert "magnitude only: minimum phase is assumed" in str(fit) and "measured phase" not in str(fit)
    assert fit.to_json_dict()["responses"][0]["residual_degrees"] is None
    with pytest.raises(UsageError, match="SF902"):
        fitted(tmp_path, text, "f,mag_db", delay=True)


CIRCUITS = {
    "first": (lambda s: 1 / (1 + s / 21), (0.3, 300), 1),
    "first, far": (lambda s: 1 / (1 + s / 21), (30, 300), 1),
    "PI": (lambda s: 2 + 40 / s, (0.1, 100), 0),
    "lead, lag": (lambda s: (1 + s / 60) * (1 + s / 6) / (1 + s / 600) / (1 + s / 0.6), (0.01, 1000), 2),
    "notch": (lambda s: (1e4 + 0.2 * s + s * s) / (1e4 + 100 * s + s * s), (2, 200), 2),
    "tight": (lambda s: 3e4 / (1e4 + 20 * s + s * s), (15.5, 16.5), 2),
    "four poles": (lambda s: 1 / (1 + s / 6e4) / (1 + s / 2e5) / (1 + s / 2e6 + s * s / 2e10), (1e2, 1e5), 4),
    "delay": (lambda s: np.exp(-2e-3 * s) / (1 + s / 120), (1, 200), 1),
}


@pytest.mark.parametrize("digits", [6, 10, 15])
@pytest.mark.parametrize("name", CIRCUITS)
def test_exact_data_have_the_order_of_their_circuit_and_its_digits(tmp_path, name, digits):
    function, band, order = CIRCUITS[name]
    f = np.array([float(f"{x:.{digits}g}") for x in np.geomspace(*band, 101)])
    h = function(2j * np.pi * f)
    fit = fitted(tmp_path, table("f_hz,re,im", f, h.real, h.imag, digits=digits), delay=name == "delay")
    assert (fit.resonances.order, fit.poor) == (order, ())
    assert np.max(np.abs(fit.found.values(0) - h) / np.abs(h)) < 2000 * 10.0**-digits
    assert "decade" not in str(fit)


def test_coherence_that_the_scatter_contradicts_is_said_and_not_used(tmp_path):
    random, f = np.random.default_rng(4), np.linspace(5, 15, 300)
    h = (1 + 0.02 * complex_noise(random, f.size)) / (1 + 0.04j * f / 10 - (f / 10) ** 2)
    head = "frequency_hz,re,im,coherence"
    for shares in (random.uniform(0.05, 0.6, f.size), np.where(random.random(f.size) < 0.3, 1.2, 0.8)):
        fit = fitted(tmp_path, table(head, f, h.real, h.imag, shares))
        assert "weighed by their scatter" in str(fit) + str(fit.found.measured[0].guesses)
        assert fit.frequencies_hz == pytest.approx([10], rel=4e-4) and not fit.poor


def test_a_narrow_band_is_no_reason_to_call_a_fit_poor(tmp_path):
    f = np.linspace(999, 1001, 200)
    h = (
        1
        / (1 + 1e-3j * f / 1000 - (f / 1000) ** 2)
        * (1 + 0.01 * complex_noise(np.random.default_rng(2), 200))
    )
    fit = fitted(tmp_path, table("frequency_hz,re,im", f, h.real, h.imag))
    assert fit.frequencies_hz == pytest.approx([1000], rel=1e-5)
    assert fit.poor == () and "too narrow to tell the power of s" in str(fit)
