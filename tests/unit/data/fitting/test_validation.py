"""Second halves of records over their prediction; what is true is simulated by code that the fit lacks."""

import numpy as np
import pytest

import symflex
from symflex.data.fitting.record_search import Settings
from symflex.data.fitting.validation import validated
from symflex.data.measurement.measured_response import Samples
from symflex.errors import UsageError
from tests.unit.data.records import response, written

MODE = (2 * np.pi * 10, 0.02, (2 * np.pi * 10) ** 2, 0.0)
STEP, SIZE, NOISE = 0.005, 600, 0.02


def record(path, *, changed=1.0, seed=1):
    """Write a record of a mode whose frequency changes at half time; return the output without noise."""
    random = np.random.default_rng(seed)
    u = random.standard_normal(SIZE)
    omega = changed * MODE[0]
    other = (omega, *MODE[1:2], omega**2, 0.0)
    y = np.where(
        np.arange(SIZE) < SIZE // 2, response([MODE], u, STEP, False), response([other], u, STEP, False)
    )
    written(path, STEP * np.arange(SIZE), u, y + NOISE * random.standard_normal(SIZE))
    return y


def test_the_second_half_is_predicted_from_the_first_as_it_was_without_noise(tmp_path):
    true = record(tmp_path / "record.csv")
    fit = symflex.fit(tmp_path / "record.csv", validate=True)
    found = fit.found.validation
    size = found.predicted[0].size
    assert found.modes == 1 and abs(size - SIZE // 2) <= 2
    assert np.allclose(found.times_s[0][-1], STEP * (SIZE - 1))
    # The prediction has no part of the noise but the error of the poles: it is closer than one sample is.
    assert np.std(found.predicted[0] - true[-size:]) < NOISE / 2
    assert abs(found.error[0] / NOISE - 1) < 0.2 and abs(found.noise[0] / NOISE - 1) < 0.2
    assert not any("second half" in said for said in fit.warnings)
    assert f"{found.error[0]:.3g} rms" in str(fit)
    assert fit.to_json_dict()["validation"]["modes"] == 1
    assert [axes.get_xlabel() for axes in fit.plot().axes].count("Time [s]") == 1


def test_a_machine_that_changes_is_not_as_its_first_half(tmp_path):
    record(tmp_path / "record.csv", changed=1.05)
    t, u, y = np.loadtxt(tmp_path / "record.csv", delimiter=",", skiprows=1).T
    said = validated([[Samples(t[1], y, u)]], Settings()).warnings
    assert any(one.startswith("the second half is not as the first one predicts it") for one in said)


def test_lost_samples_are_no_errors_of_a_prediction(tmp_path):
    record(tmp_path / "whole.csv")
    lines = (tmp_path / "whole.csv").read_text(encoding="utf-8").splitlines()
    kept = [line for i, line in enumerate(lines) if i not in (130, 420, 421, 500)]
    (tmp_path / "record.csv").write_text("\n".join(kept), encoding="utf-8")
    found = symflex.fit(tmp_path / "record.csv", validate=True).found.validation
    assert found.error[0] < 2 * NOISE


@pytest.mark.parametrize(
    ("options", "why"),
    [({"segments": 4}, "fitted in time"), ({"lag": True}, "fitted in time"), ({}, "64 samples")],
)
def test_what_cannot_be_validated_is_refused(tmp_path, options, why):
    record(tmp_path / "record.csv")
    if not options:
        lines = (tmp_path / "record.csv").read_text(encoding="utf-8").splitlines()
        (tmp_path / "record.csv").write_text("\n".join(lines[:61]), encoding="utf-8")
    with pytest.raises(UsageError, match=why):
        symflex.fit(tmp_path / "record.csv", validate=True, **options)
