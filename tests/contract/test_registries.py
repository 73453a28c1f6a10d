"""What every block, form, exporter, root finder and function of the registries promises."""

from __future__ import annotations

import ast
import contextlib

import mpmath
import pytest
from flint import arb, ctx

from symflex import pipeline
from symflex.algebra import FUNCTIONS, Factored, Ring
from symflex.cli import run
from symflex.codegen.exporters import EXPORTERS
from symflex.errors import UsageError
from symflex.expressions import PROGRAM_LIMITS, format_expression
from symflex.library.blocks import BLOCKS, MODEL_BLOCK
from symflex.print.forms import CANDIDATES, FORMS, print_form
from symflex.quantities import unit_of
from symflex.roots import ROOT_FINDERS
from tests.contract.exact import read
from tests.contract.smallest import BLOCK_VALUES, block_model, element_model
from tests.independent.spec_expressions import evaluate

RING = Ring(("s", "p", "q"))


def generator(name):
    return Factored.generator(RING, name)


# ---------------------------------------------------------------------------------------------- blocks


@pytest.mark.parametrize("kind", BLOCKS)
def test_a_block_s_key_is_its_own_name(kind):
    assert BLOCKS[kind].type_name == kind


@pytest.mark.parametrize("kind", BLOCKS)
def test_a_block_is_documented(kind):
    block = BLOCKS[kind]
    assert type(block).__doc__.strip()
    assert block.summary.strip()
    assert all(p.doc.startswith(("a ", "an ")) for p in block.parameters)


@pytest.mark.parametrize("kind", BLOCKS)
def test_the_units_of_a_block_parse(kind):
    assert all(unit_of(p.unit).scale == 1 for p in BLOCKS[kind].parameters if p.unit)


@pytest.mark.parametrize("kind", BLOCKS)
def test_the_defaults_of_a_block_are_numbers(kind):
    assert all(float(p.default) in (0, 1) for p in BLOCKS[kind].parameters if p.default is not None)


@pytest.mark.parametrize("kind", BLOCKS)
def test_a_block_s_transfer_function_is_pure(kind):
    block = BLOCKS[kind]
    values = {p.name: generator("p") + i for i, p in enumerate(block.parameters)}
    before = {n: str(v) for n, v in values.items()}
    first = str(block.transfer(generator("s"), values))
    assert str(block.transfer(generator("s"), values)) == first
    assert {n: str(v) for n, v in values.items()} == before


@pytest.mark.parametrize("kind", BLOCKS)
def test_a_block_is_derivable_in_a_smallest_model(kind):
    (tf,) = pipeline.derive_all(pipeline.loads(block_model(kind)))
    assert pipeline.bind(tf)(1.7j) is not None


@pytest.mark.parametrize("kind", BLOCKS)
def test_the_command_line_describes_a_block(kind, capsys):
    assert run(["elements", kind]) == 0
    described = capsys.readouterr().out
    assert all(p.name in described for p in BLOCKS[kind].parameters)


def test_every_block_has_a_smallest_model():
    assert set(BLOCK_VALUES) == set(BLOCKS)


def test_the_model_block_is_no_block_of_the_registry():
    assert MODEL_BLOCK not in BLOCKS


@pytest.mark.parametrize("kind", BLOCKS)
def test_the_time_of_a_delay_is_one_of_its_parameters_in_seconds(kind):
    block = BLOCKS[kind]
    times = {p.name: p.unit for p in block.parameters}
    assert not block.kernel_time or times[block.kernel_time] == "s"


# ----------------------------------------------------------------------------------------------- forms


def damped_mass():
    text = """symflex = 1
[parameters]
m = "2 kg"
b = "1 N*s/m"
k = "8 N/m"
[elements]
mass = { type = "mass", at = "x", m = "m" }
loss = { type = "damper", between = ["x", "ground"], b = "b" }
hold = { type = "spring", between = ["x", "ground"], k = "k" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
"""
    return pipeline.derive_all(pipeline.loads(text))[0]


def clamped_rod():
    text = """symflex = 1
[parameters]
E = "2 Pa"
A = "3 m^2"
rho = "5 kg/m^3"
l = "0.5 m"
[elements]
rod = { type = "rod", between = ["ground", "q"], E = "E", A = "A", rho = "rho", l = "l" }
[inputs]
F = { force = "q" }
[outputs]
X = "q"
"""
    return pipeline.derive_all(pipeline.loads(text))[0]


def law_of_the_mass(s):
    return 1 / (2 * s**2 + s + 8)


def law_of_the_rod(s):
    gamma = s * mpmath.sqrt(mpmath.mpf(5) / 2)
    return mpmath.tanh(gamma / 2) / (6 * gamma)


SAMPLES = (
    (damped_mass, {"m": 2, "b": 1, "k": 8}, law_of_the_mass),
    (clamped_rod, {"E": 2, "A": 3, "rho": 5, "l": mpmath.mpf("0.5")}, law_of_the_rod),
)


def printed(name, digits=6):
    """A form of each sample that has it, with what its numbers are and its law."""
    found = []
    for make, values, law in SAMPLES:
        with contextlib.suppress(UsageError):
            found.append((make(), print_form(make(), name, digits), values, law))
    return found


@pytest.mark.parametrize("name", FORMS)
def test_a_form_bears_its_key_as_name_and_some_function_has_it(name):
    assert {form.name for _, form, _, _ in printed(name)} == {name}


@pytest.mark.parametrize("name", FORMS)
def test_a_form_is_documented(name):
    assert FORMS[name].__doc__.strip()


@pytest.mark.parametrize("name", FORMS)
def test_a_form_of_a_damped_mass_or_a_rod_is_its_law(name):
    for _, form, values, law in printed(name, 12):
        s = mpmath.mpc("0.3", "1.1")
        where = [(n, format_expression(e)) for n, e in form.where]
        num, den = (evaluate(format_expression(e), values | {"s": s}, where) for e in (form.num, form.den))
        assert abs(num / den / law(s) - 1) < 1e-11


@pytest.mark.parametrize("name", FORMS)
def test_a_form_is_the_same_each_time(name):
    for tf, one, _, _ in printed(name):
        other = print_form(tf, name)
        assert (one.num, one.den, one.where) == (other.num, other.den, other.where)


def test_the_candidates_for_the_default_are_forms():
    assert set(CANDIDATES) <= set(FORMS)


def test_an_unknown_form_is_a_usage_error_with_a_suggestion():
    with pytest.raises(UsageError) as caught:
        print_form(damped_mass(), "polynomail")
    (problem,) = caught.value.diagnostics
    assert (problem.code, problem.hint) == ("SF902", "did you mean 'polynomial'?")


@pytest.mark.parametrize("name", FORMS)
def test_a_printed_form_stays_within_the_program_s_limits(name):
    for _, form, _, _ in printed(name, 40):
        for part in (form.num, form.den):
            text = format_expression(part)
            assert len(text) < PROGRAM_LIMITS.characters
            assert read(text) == part


# ------------------------------------------------------------------------------------------- exporters


@pytest.mark.parametrize("name", EXPORTERS)
def test_an_exporter_names_its_suffix_and_what_it_makes(name):
    assert EXPORTERS[name].suffix.startswith(".")
    assert EXPORTERS[name].summary.strip()


@pytest.mark.parametrize("name", EXPORTERS)
def test_an_export_is_the_same_each_time_and_ends_with_one_newline(name):
    model = pipeline.loads(element_model("spring"))
    tfs = pipeline.derive_all(model)
    one, other = (EXPORTERS[name].export(model, tfs).text for _ in range(2))
    assert one == other
    assert one.endswith("\n")
    assert not one.endswith("\n\n")


def test_the_numpy_export_is_python():
    model = pipeline.loads(element_model("spring"))
    ast.parse(EXPORTERS["numpy"].export(model, pipeline.derive_all(model)).text)


# ---------------------------------------------------------------------------------------- root finders


@pytest.mark.parametrize("name", ROOT_FINDERS)
def test_a_root_finder_is_documented(name):
    assert (ROOT_FINDERS[name].__doc__ or type(ROOT_FINDERS[name]).__doc__).strip()


# ------------------------------------------------------------------------------------------- functions


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_can_be_written_in_a_model_and_binds_to_its_value(name):
    text = f'symflex = 1\n[parameters]\np = "0.5"\n[inputs]\nU = {{}}\n[outputs]\nX = "{name}(p)*U"\n'
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    assert pipeline.bind(tf)(0j) == complex(float(getattr(mpmath, name)(mpmath.mpf("0.5"))))


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_s_derivative_is_its_slope(name):
    with ctx.workprec(160), mpmath.workdps(40):
        slope = mpmath.diff(getattr(mpmath, name), mpmath.mpf("0.375"))
        assert FUNCTIONS[name].derivative(arb(3) / 8).str(30, radius=False) == arb(str(slope)).str(
            30, radius=False
        )


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_s_key_is_its_own_name(name):
    assert FUNCTIONS[name].name == name
    assert FUNCTIONS[name].latex.startswith("\\")
