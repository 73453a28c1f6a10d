"""The arrows of the pipeline, one after another."""

import pytest

from symflex import pipeline
from symflex.errors import ModelError, Source, SpecError, UsageError
from symflex.model.spec import parse

TEXT = """
symflex = 1
parameters = { m = "2 kg", k = "18 N/m" }
inputs  = { F = { force = "x" }, G = { force = "x" } }
outputs = { X = "x", V = "s*x" }
[elements]
body = { type = "mass", at = "x", m = "m" }
wall = { type = "spring", between = ["x", "ground"], k = "k" }
"""


@pytest.fixture(scope="module")
def model():
    return pipeline.loads(TEXT)


def test_parse_keeps_the_place_of_everything():
    entry = parse(Source("x.toml", TEXT)).root.get("elements")
    assert str(entry.key_span) == "x.toml:6:2"


def test_load_reads_what_loads_reads(tmp_path, model):
    path = tmp_path / "x.toml"
    path.write_text(TEXT)
    assert pipeline.load(path) == model


def test_a_text_with_mistakes_is_refused_with_its_name():
    with pytest.raises(SpecError, match=r"robot\.toml:4:"):
        pipeline.loads(TEXT.replace('G = { force = "x" }', 'G = { farce = "x" }'), "robot.toml")


def test_the_arrows_lead_from_a_text_to_proved_poles(model):
    G = pipeline.derive(pipeline.assemble(model), "X", "F")
    found = pipeline.roots(pipeline.bind(G), None, 5)
    assert [p.decimal(5).im for p in found.poles] == ["3.0000", "-3.0000"]


def test_deriving_all_gives_outputs_over_inputs_in_order(model):
    assert [tf.name for tf in pipeline.derive_all(model)] == ["X/F", "X/G", "V/F", "V/G"]


def test_deriving_some_gives_those(model):
    assert [tf.name for tf in pipeline.derive_all(model, [("V", "G")])] == ["V/G"]


def test_without_names_all_pairs_are_picked(model):
    assert pipeline.pick_pairs(model, []) == model.transfer_functions


def test_pairs_are_picked_in_the_order_asked_for(model):
    assert pipeline.pick_pairs(model, ["V/F", "X/F"]) == (("V", "F"), ("X", "F"))


def test_an_unknown_pair_is_a_usage_error_with_a_hint(model):
    with pytest.raises(UsageError, match="did you mean 'X/F'"):
        pipeline.pick_pairs(model, ["x/F"])


def test_a_solvable_model_passes(model):
    pipeline.check_solvable(pipeline.assemble(model))


def test_a_floating_node_is_explained():
    text = TEXT.replace('m = "m" }', 'm = "0*m" }').replace('k = "k"', 'k = "0*k"')
    with pytest.raises(ModelError, match="SF301"):
        pipeline.check_solvable(pipeline.assemble(pipeline.loads(text)))


def test_a_model_block_is_derived_within_its_own_file(tmp_path):
    (tmp_path / "plant.toml").write_text(TEXT)
    outer = tmp_path / "outer.toml"
    outer.write_text(
        'symflex = 1\n[blocks]\nP = { type = "model", spec = "plant.toml", tf = "V/F" }\n'
        '[inputs]\nu = {}\n[outputs]\ny = "P*u"\n'
    )
    inner = pipeline.bind(pipeline.derive_all(pipeline.loads(TEXT), [("V", "F")])[0])
    whole = pipeline.bind(pipeline.derive_all(pipeline.load(outer))[0])
    # V/F = s/(m s^2 + k) at s = 2j: 2j/(18 - 8)
    assert whole(2j) == inner(2j) == pytest.approx(0.2j)
