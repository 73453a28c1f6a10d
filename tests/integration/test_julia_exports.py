"""Exported Julia modules against ball arithmetic: read as Python, and run where there is Julia."""

import re
import shutil

import numpy as np
import pytest

from symflex.codegen.julia import JULIA
from symflex.codegen.program.verify import doubles
from symflex.transfer import bind
from tests.integration.julia import Julia
from tests.integration.julia_in_python import functions_of
from tests.unit.codegen.against_balls import axis_points, worst_errors
from tests.unit.codegen.exportable import SPECS, derived, public_name

ACCURACY = 1e-13
# Debian has had no package of Julia since version 11, so its absence is no failure anywhere.
needs_julia = pytest.mark.skipif(shutil.which("julia") is None, reason="julia is not installed")


@pytest.fixture
def julia(tmp_path):
    return Julia(tmp_path)


def exported(name, samples=400):
    model, tfs = derived(name)
    return tfs, JULIA.export(model, tfs, name, samples=samples)


def read(function, tf, points):
    """Return values of a private function read as Python."""
    values = doubles(bind(tf))
    given = [values[p.name] for p in tf.parameters]
    return [function(p, *given) for p in points.tolist()]


@pytest.mark.parametrize("name", ["rod_tip_mass", "tension", "delayed"])
def test_what_a_program_can_hold_read_as_python_agrees(name):
    (tf, *_), made = exported(name, samples=5)
    functions = functions_of(made.text)
    w = axis_points(tf, 10)
    turned = w[::5] * np.exp(1j * np.linspace(0.3, 6.0, len(w[::5])))
    s = np.concatenate([1j * w, turned if name != "delayed" else []])
    function = f"_value_of_{public_name(tf)}"
    assert worst_errors(tf, s, read(functions[function], tf, s))[0] <= ACCURACY
    if name == "rod_tip_mass":
        assert re.search(
            rf"return \(?\s*{public_name(tf)}\(complex\(0.0, float\(omega\)\); E = E,", made.text
        )


def test_powers_that_overflow_are_taken_of_one_over_s():
    (tf,), made = exported("chain", samples=5)
    s = np.array([1e3j, 1e8j, 1e16j, 1e18 + 1e18j, 1e25, -1e30j, 2.0])
    assert worst_errors(tf, s, read(functions_of(made.text)["_value_of_X_over_F"], tf, s))[0] <= ACCURACY


@pytest.mark.slow
@needs_julia
def test_models_run_in_julia_agree_with_balls(julia):
    asked = []
    for name in ("six_mass", "sliding_free_beam", "timoshenko_cantilever", *SPECS):
        samples = 30
        tfs, made = exported(name, samples)
        julia.write(name, made.text)
        for tf in tfs:
            w = axis_points(tf, samples)
            function = f"{made.name}.{public_name(tf)}"
            keys = [julia.keep(f"{function}.({julia.points(1j * w)})")]
            if f"function {public_name(tf)}_at(" in made.text:
                keys.append(julia.keep(f"{function}_at.(real.({julia.points(w)}))"))
            asked.append((tf, w, keys))
    julia.run()
    for tf, w, keys in asked:
        assert max(worst_errors(tf, 1j * w, *(julia.value(k) for k in keys))) <= ACCURACY, tf.name


@needs_julia
def test_parameters_are_keywords_and_scalars_give_scalars(julia):
    (tf, *_), made = exported("sliding_free_beam", samples=5)
    julia.write("beam", made.text)
    function = public_name(tf)
    julia.do(f"using .{made.name}; const M = {made.name}; const G = {function}; const H = {function}_at")
    key = julia.keep("G.([3im, 400im], l = 0.8)")
    julia.do("print(typeof(G(3im, l = 1)), ' ', typeof(H(3)), ' ', H(-3) == conj(H(3)), ' ')")
    julia.do(f'print(M.PARAMETERS.l.unit, " ", M.TRANSFER_FUNCTIONS["{tf.name}"] == G, " ")')
    julia.do(f'print(occursin("verified", string(@doc {function})), " ", isfinite(H(0)))')
    printed = julia.run()
    assert printed.split() == ["Complex{Float64}", "Complex{Float64}", "true", "m", "true", "true", "false"]
    for value, s in zip(julia.value(key), (3j, 400j), strict=True):
        assert abs(value / bind(tf, {"l": 0.8})(s) - 1) < 1e-12
