"""Functional mock-up units: valid by FMPy, and simulated by it as the certified response is."""

import zipfile

import numpy as np
import pytest

import symflex
from symflex import pipeline
from symflex.codegen.exporters import SAMPLED
from symflex.codegen.sampled import DifferenceExporter
from symflex.state_space.sampled import sampling_of

pytestmark = pytest.mark.needs_tool("cc")

MODELS = {
    "lag": ("u/(s + 2)", "y"),
    "feedthrough": ("u*(3*s + 1)/(s + 2)", "y"),
    "resonance": ("9*u/(s^2 + 0.6*s + 9)", "y"),
    "undamped": ("4*u/(s^2 + 4)", "y"),
    "delayed": ("exp(-0.3*s)*u/(s + 1)", "y"),
    "delayed by half a sample": ("exp(-0.25*s)*u/(s + 1)", "y"),
    "double integrator": ("u/s^2", "y"),
    "five poles": ("u/((s + 1)*(s + 2)*(s^2 + s + 9)*(s + 4))", "y"),
    "a gain": ("7*u", "y"),
}


def unit(model, folder, sample="0.1 s"):
    sampling = sampling_of(sample, "zoh", None, "a sampling time")
    derived, _ = pipeline.derive_as(model, model.transfer_functions, solves=False)
    made = DifferenceExporter(SAMPLED["fmu"], sampling).export(model, derived, "unit", is_alone=False)
    path = folder / "unit.fmu"
    path.write_bytes(made.archive)
    return str(path)


@pytest.mark.slow
@pytest.mark.needs_module("fmpy")
@pytest.mark.parametrize("name", MODELS)
def test_a_unit_takes_the_steps_of_the_certified_response(name, tmp_path):
    from fmpy import simulate_fmu
    from fmpy.validation import validate_fmu

    text, _ = MODELS[name]
    model = symflex.loads(f'symflex = 1\ninputs.u = {{}}\noutputs.y = "{text}"')
    path = unit(model.resolved, tmp_path)
    assert validate_fmu(path) == []
    run = simulate_fmu(path, stop_time=3.0, output_interval=0.1, start_values={"u": 1.0}, output=["y"])
    times = run["time"]
    expected = model.transfer_function("y/u").bind().step_response(np.arange(len(times)) * 0.1).values
    assert np.allclose(times, np.arange(len(times)) * 0.1)
    assert np.max(abs(run["y"] - expected)) < 1e-12 * max(1.0, np.max(abs(expected)))


@pytest.mark.slow
@pytest.mark.needs_module("fmpy")
def test_a_unit_of_a_model_with_an_input_called_time_is_valid(tmp_path):
    from fmpy import read_model_description
    from fmpy.validation import validate_fmu

    text = 'symflex = 1\ninputs = { time = {}, u = {} }\noutputs = { u = "time/(s + 1)", time = "u/s" }'
    path = unit(symflex.loads(text).resolved, tmp_path)
    assert validate_fmu(path) == []
    names = [v.name for v in read_model_description(path, validate=True).modelVariables]
    assert names == ["time", "time_", "u", "u_", "time_2"]


@pytest.mark.slow
@pytest.mark.needs_module("fmpy")
def test_two_inputs_add_up_and_states_can_be_restored(tmp_path):
    from fmpy import extract, read_model_description
    from fmpy.fmi3 import FMU3Slave

    text = 'symflex = 1\ninputs = { u = {}, v = {} }\noutputs = { y = "u/(s + 1) - 2*v/(s + 3)", z = "v/s" }'
    path = unit(symflex.loads(text).resolved, tmp_path)
    described = read_model_description(path)
    assert [v.name for v in described.modelVariables] == ["time", "u", "v", "y", "z"]
    slave = FMU3Slave(
        guid=described.instantiationToken,
        unzipDirectory=extract(path, str(tmp_path / "unzipped")),
        modelIdentifier=described.coSimulation.modelIdentifier,
        instanceName="one",
    )
    slave.instantiate()
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    slave.setFloat64([1, 2], [1.0, 0.5])
    slave.doStep(0.0, 0.1)
    kept = slave.getFMUState()
    first = slave.getFloat64([3, 4])
    slave.doStep(0.1, 0.2)
    slave.setFMUState(kept)
    assert slave.getFloat64([3, 4]) == first
    assert first == pytest.approx([1 - np.exp(-0.1) - (1 - np.exp(-0.3)) / 3, 0.05], rel=1e-12)
    with pytest.raises(Exception, match="fmi3DoStep"):
        slave.doStep(0.1, 0.07)  # no whole number of samples
    slave.terminate()
    slave.freeInstance()


def test_the_same_model_makes_the_same_unit_without_paths_of_a_machine(tmp_path):
    model = symflex.loads('symflex = 1\ntitle = "<&>"\ninputs.u = {}\noutputs.y = "u/(s + 2)"').resolved
    one, two = (zipfile.ZipFile(unit(model, tmp_path)) for _ in range(2))
    assert one.namelist() == two.namelist()
    assert one.read("sources/fmu.c") == two.read("sources/fmu.c")
    assert 'modelName="&lt;&amp;&gt;"' in one.read("modelDescription.xml").decode()
