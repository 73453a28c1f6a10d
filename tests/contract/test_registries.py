"""What every block, form, exporter, root finder and function of the registries promises."""

import contextlib
from functools import cache

import mpmath
import pytest
from flint import arb, ctx

from symflex import pipeline
from symflex.algebra import FUNCTIONS, Factored, Ring
from symflex.cli import run
from symflex.codegen.exporters import EXPORTERS, SAMPLED
from symflex.errors import UsageError
from symflex.expressions import PROGRAM_LIMITS, Name, format_expression, nodes
from symflex.library.blocks import BLOCKS, MODEL_BLOCK
from symflex.model import PlacedBlock
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


def test_a_block_is_documented_under_its_own_name():
    for kind, block in BLOCKS.items():
        assert block.type_name == kind
        assert type(block).__doc__.strip(), kind
        assert block.summary.strip(), kind
        assert all(p.doc.startswith(("a ", "an ")) for p in block.parameters), kind


def test_the_units_of_a_block_parse_and_its_defaults_are_numbers():
    for kind, block in BLOCKS.items():
        units = {p.name: p.unit for p in block.parameters}
        assert all(unit_of(unit).scale == 1 for unit in units.values() if unit), kind
        assert all(float(p.default) in (0, 1) for p in block.parameters if p.default is not None), kind
        assert not block.kernel_time or units[block.kernel_time] == "s", kind


def test_a_block_s_formula_is_of_s_and_all_its_parameters():
    for kind, block in BLOCKS.items():
        if formula := PlacedBlock("G", block).formula:
            used = {node.name for node in nodes(formula) if isinstance(node, Name)}
            assert used | {"s"} == {"s", *(p.name for p in block.parameters)}, kind


def test_a_block_is_derivable_in_a_smallest_model():
    for kind in BLOCKS:
        (tf,) = pipeline.derive_all(pipeline.loads(block_model(kind)))
        assert pipeline.bind(tf)(1.7j) is not None, kind


def test_the_command_line_describes_a_block(capsys):
    for kind, block in BLOCKS.items():
        assert run(["elements", kind]) == 0, kind
        described = capsys.readouterr().out
        assert all(p.name in described for p in block.parameters), kind


def test_every_block_but_that_of_a_model_is_registered_and_has_a_smallest_model():
    assert set(BLOCK_VALUES) == set(BLOCKS)
    assert MODEL_BLOCK not in BLOCKS


# ----------------------------------------------------------------------------------------------- forms


@cache
def damped_mass():
    text = """symflex = 1
parameters = { m = "2 kg", b = "1 N*s/m", k = "8 N/m" }
inputs.F = { force = "x" }
outputs.X = "x"
[elements]
mass = { type = "mass", at = "x", m = "m" }
loss = { type = "damper", between = ["x", "ground"], b = "b" }
hold = { type = "spring", between = ["x", "ground"], k = "k" }
"""
    return pipeline.derive_all(pipeline.loads(text))[0]


@cache
def clamped_rod():
    text = """symflex = 1
parameters = { E = "2 Pa", A = "3 m^2", rho = "5 kg/m^3", l = "0.5 m" }
elements.rod = { type = "rod", between = ["ground", "q"], E = "E", A = "A", rho = "rho", l = "l" }
inputs.F = { force = "q" }
outputs.X = "q"
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


@cache
def printed(name, digits=12):
    """A form of each sample that has it, with what its numbers are and its law."""
    found = []
    for make, values, law in SAMPLES:
        with contextlib.suppress(UsageError):
            found.append((make(), print_form(make(), name, digits), values, law))
    return found


def test_a_form_is_documented_bears_its_key_as_name_and_some_function_has_it():
    for name, form in FORMS.items():
        assert form.__doc__.strip(), name
        assert {form.name for _, form, _, _ in printed(name)} == {name}


def test_a_form_of_a_damped_mass_or_a_rod_is_its_law_each_time():
    s = mpmath.mpc("0.3", "1.1")
    for name in FORMS:
        for tf, form, values, law in printed(name):
            where = [(n, format_expression(e)) for n, e in form.where]
            num, den = (
                evaluate(format_expression(e), values | {"s": s}, where) for e in (form.num, form.den)
            )
            assert abs(num / den / law(s) - 1) < 1e-11, name
            other = print_form(tf, name, 12)
            assert (form.num, form.den, form.where) == (other.num, other.den, other.where), name


def test_the_candidates_for_the_default_are_forms():
    assert set(CANDIDATES) <= set(FORMS)


def test_an_unknown_form_is_a_usage_error_with_a_suggestion():
    with pytest.raises(UsageError) as caught:
        print_form(damped_mass(), "polynomail")
    (problem,) = caught.value.diagnostics
    assert (problem.code, problem.hint) == ("SF902", "did you mean 'polynomial'?")


def test_a_printed_form_stays_within_the_program_s_limits():
    for name in FORMS:
        for _, form, _, _ in printed(name, 40):
            for part in (form.num, form.den):
                text = format_expression(part)
                assert len(text) < PROGRAM_LIMITS.characters, name
                assert read(text) == part, name


# ------------------------------------------------------------------------------------------- exporters


def test_an_exporter_names_its_suffix_and_what_it_makes():
    for name, exporter in (*EXPORTERS.items(), *SAMPLED.items()):
        assert exporter.suffix.startswith("."), name
        assert exporter.summary.strip(), name


@pytest.mark.slow
def test_an_export_is_the_same_each_time_and_ends_with_one_newline():
    model = pipeline.loads(element_model("spring"))
    tfs = pipeline.derive_all(model)
    for name, exporter in EXPORTERS.items():
        one, other = (exporter.export(model, tfs).text for _ in range(2))
        assert one == other, name
        assert one.endswith("\n"), name
        assert not one.endswith("\n\n"), name


# ---------------------------------------------------------------------------------------- root finders


def test_a_root_finder_is_documented():
    for name, finder in ROOT_FINDERS.items():
        assert (finder.__doc__ or type(finder).__doc__).strip(), name


# ------------------------------------------------------------------------------------------- functions


def test_a_function_can_be_written_in_a_model_and_binds_to_its_value():
    for name in FUNCTIONS:
        text = f'symflex = 1\n[parameters]\np = "0.5"\n[inputs]\nU = {{}}\n[outputs]\nX = "{name}(p)*U"\n'
        (tf,) = pipeline.derive_all(pipeline.loads(text))
        assert pipeline.bind(tf)(0j) == complex(float(getattr(mpmath, name)(mpmath.mpf("0.5")))), name


def test_a_function_s_derivative_is_its_slope():
    for name, function in FUNCTIONS.items():
        with ctx.workprec(160), mpmath.workdps(40):
            slope = arb(str(mpmath.diff(getattr(mpmath, name), mpmath.mpf("0.375"))))
            found = function.derivative(arb(3) / 8)
            assert found.str(30, radius=False) == slope.str(30, radius=False), name


def test_a_function_s_key_is_its_own_name():
    for name, function in FUNCTIONS.items():
        assert function.name == name
        assert function.latex.startswith("\\"), name
