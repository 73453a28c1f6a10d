"""Fits of parameters that several tests make."""

import numpy as np
import pytest

from symflex import pipeline
from symflex.data.measurement import MeasuredResponse
from symflex.options import FitOptions

DRIVE = """
symflex = 1
[parameters]
J_1 = {J_1}
J_2 = {J_2}
k = {k}
b = {b}
[definitions]
omega_z = "sqrt(k/J_2)"
[elements]
M = {{ type = "inertia", at = "q1", J = "J_1" }}
L = {{ type = "inertia", at = "q2", J = "J_2" }}
K = {{ type = "torsion_spring", between = ["q1", "q2"], k = "k" }}
B = {{ type = "rotary_damper", between = ["q1", "q2"], b = "b" }}
[inputs]
tau = {{ torque = "q1" }}
[outputs]
theta_1 = "q1"
theta_2 = "q2"
"""
BEGUN = {"J_1": '"1.5 g*m^2"', "J_2": '"7 g*m^2"', "k": '"300 N*m/rad"', "b": '"0.05 N*m*s/rad"'}
LINES = np.geomspace(3, 300, 120)


@pytest.fixture
def fitted(tmp_path):
    def fit(
        free,
        values,
        text=DRIVE,
        tf="theta_1/tau",
        f=LINES,
        unit="",
        samples=(),
        is_magnitude=False,
        **changes,
    ):
        (tmp_path / "model.toml").write_text(text.format(**BEGUN | changes))
        response = MeasuredResponse(tf, f, values, unit=unit, samples=samples, is_magnitude=is_magnitude)
        return pipeline.fit_parameters(
            [response], FitOptions(model=tmp_path / "model.toml", free=free, tfs=(tf,))
        )

    return fit
