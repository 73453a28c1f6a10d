"""The JSON Schema of the language accepts what symflex accepts, and refuses what it can know to be wrong."""

import json
import subprocess
import tomllib

import pytest
from jsonschema import Draft7Validator

from symflex import pipeline
from symflex.errors import SymflexError
from symflex.library.blocks import BLOCKS
from symflex.library.elements import ELEMENTS
from symflex.model.schema import json_schema
from tests.house.repository import ROOT, blocks, specifications

SCHEMA = json_schema()
VALID = Draft7Validator(SCHEMA)
WORKED = [*specifications(ROOT / "derivations", "**/*.toml"), *(ROOT / "symflex/templates").glob("*.toml")]
BROKEN = sorted((ROOT / "tests/golden/broken").glob("*.toml"))
HEADER = 'symflex = 1\ninputs.F = {}\noutputs.X = "x"\n'


def read(text):
    """Return what TOML says, ``None`` where it cannot be read."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        return None


def test_it_is_a_schema_with_a_branch_for_every_type():
    Draft7Validator.check_schema(SCHEMA)
    sections = SCHEMA["properties"]
    branches = sections["elements"]["additionalProperties"]["oneOf"]
    assert [branch["title"] for branch in branches] == [*ELEMENTS]
    assert all(branch["additionalProperties"] is False for branch in branches)
    titles = [b.get("title") for b in sections["blocks"]["additionalProperties"]["oneOf"]]
    assert titles[1:] == [*BLOCKS, "model"]


def test_it_accepts_every_worked_model_template_and_whole_example_of_the_pages():
    texts = {str(path): path.read_text(encoding="utf-8") for path in WORKED}
    for page in [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]:
        texts |= {str(b): b.text for b in blocks(page) if b.language == "toml" and "[outputs]" in b.text}
    whole = {name: read(text) for name, text in texts.items() if "symflex = 1" in text}
    assert len(whole) > 60
    refused = {name: e.message for name, text in whole.items() if text for e in VALID.iter_errors(text)}
    assert refused == {}


def test_it_accepts_whatever_the_program_reads_among_specifications_that_fail_elsewhere():
    refused = []
    for path in BROKEN:
        try:
            pipeline.load(path)
        except SymflexError:
            continue
        if not VALID.is_valid(read(path.read_text(encoding="utf-8"))):
            refused.append(path.name)
    assert refused == []


@pytest.mark.parametrize(
    "wrong",
    [
        'elements.a = { type = "mass", at = "x" }',
        'elements.a = { type = "mass", at = "x", M = "m" }',
        'elements.a = { type = "mas", at = "x", m = "m" }',
        'elements.a = { type = "mass", at = ["x", "y"], m = "m" }',
        'elements.a = { type = "spring", between = "x", k = "k" }',
        'elements.a = { type = "spring", between = ["x", "left wall"], k = "k" }',
        'elements.a = { type = "beam", between = ["x", "y"], theory = "bernoulli", l = "l" }',
        'inputs.G = { force = "x", torque = "x" }',
        'inputs.G = { force = ["x", "y", "z"] }',
        'parameters.k = { value = "3 N/m", assume = "negative" }',
        'parameters.pi = "3 N/m"',
        'parameters."k-1" = "3 N/m"',
        'blocks.C = { type = "pd", k_p = 1 }',
        'blocks.C = { type = "lag" }',
        'fields.w = { domain = ["0", "l"], conditions = ["w(0) = 0"] }',
        'equations = { unknowns = ["x"] }',
        "analysis = { modes = 0 }",
        'figures.a = { kind = "bod" }',
        "element = {}",
    ],
)
def test_it_refuses_what_no_specification_says(wrong):
    whole = tomllib.loads(HEADER + wrong)
    assert VALID.is_valid(tomllib.loads(HEADER))
    assert not VALID.is_valid(whole)


def test_it_refuses_the_broken_specifications_of_which_no_name_unit_or_equation_is_wrong():
    known = {path.stem for path in BROKEN if (text := read(path.read_text())) and not VALID.is_valid(text)}
    expected = """
    analysis_keys_unknown beam_theory_unknown block_type_misspelt definition_is_a_list element_is_text
    element_parameter_misspelt element_type_misspelt equations_key_misspelt field_domain_missing figure_keys
    input_key_misspelt input_of_two_kinds name_too_long no_inputs no_outputs output_empty port_missing
    reserved_names section_name_misspelt three_nodes_for_a_spring unknown_assumption version_of_the_future
    """
    assert set(expected.split()) <= known


@pytest.mark.slow
def test_two_language_servers_accept_the_worked_models_and_refuse_a_misspelt_key(tmp_path):
    (tmp_path / "schema.json").write_text(json.dumps(SCHEMA), encoding="utf-8")
    for i, path in enumerate(WORKED):
        first, _, text = path.read_text(encoding="utf-8").partition("\n")
        assert first.startswith("#:schema "), path
        (tmp_path / f"{i}.toml").write_text(f"#:schema schema.json\n{text}", encoding="utf-8")
    files = [path.name for path in tmp_path.glob("*.toml")]
    commands = (
        ["tombi", "lint", "--offline", "--error-on-warnings"],
        ["taplo", "lint", "--schema", (tmp_path / "schema.json").as_uri()],
    )
    for command in commands:
        done = subprocess.run([*command, *files], cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    broken = (ROOT / "tests/golden/broken/element_parameter_misspelt.toml").read_text(encoding="utf-8")
    (tmp_path / "broken.toml").write_text(f"#:schema schema.json\n{broken}", encoding="utf-8")
    for command in commands:
        given = [*command, "broken.toml"]
        assert subprocess.run(given, cwd=tmp_path, capture_output=True, check=False).returncode != 0, command
