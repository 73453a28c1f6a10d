"""Typing errors leave loose nodes and unused names behind; models as they are meant leave none."""

import pytest

from symflex import pipeline
from symflex.model.unused import free_ends
from tests.house.repository import ROOT, specifications

PLAIN = """symflex = 1
[parameters]
m = "1 kg"
k = "2 N/m"
{parameters}
[elements]
body = {{ type = "mass", at = "x", m = "m" }}
wall = {{ type = "spring", between = ["x", "ground"], k = "k" }}
{elements}
[inputs]
F = {{ force = "x" }}
{inputs}
[outputs]
X = "x"
{outputs}
{sections}
"""


def warned_by(**parts):
    keys = ("parameters", "elements", "inputs", "outputs", "sections")
    return pipeline.warnings(pipeline.loads(PLAIN.format(**{k: parts.get(k, "") for k in keys})))


def warned(**parts):
    return [(w.code, w.span.text, w.hint) for w in warned_by(**parts)]


def told(**parts):
    return [(code, where) for code, where, _ in warned(**parts)]


LINE = 'E = "70 GPa", I = "1e-9 m^4", rho = "2700 kg/m^3", A = "1e-4 m^2", l = "1 m"'


def test_a_model_as_it_is_meant_has_no_warnings():
    assert warned() == []


def test_a_misspelt_ground_is_a_node_that_one_element_touches_or_several_leave_loose():
    spring = 'two = { type = "spring", between = ["x", "gruond"], k = "k" }'
    assert warned(elements=spring) == [("SF650", "gruond", "did you mean 'ground'?")]
    damper = 'loss = { type = "damper", between = ["x", "gruond"], b = "1 N*s/m" }'
    assert told(elements=f"{spring}\n{damper}") == [("SF650", "gruond")]


def test_a_node_at_which_two_ends_of_one_element_meet_is_not_loose():
    # Two windings in series have the inductance L_1 + L_2 + 2*M, so their node carries a current.
    for ends, is_loose in (('"a", "q", "q", "ground"', False), ('"a", "ground", "q", "a"', True)):
        coils = f'coils = {{ type = "coupled_inductors", terminals = [{ends}], L_1 = 1, L_2 = 1, M = 0 }}'
        found = told(elements=coils, inputs='u = { voltage = "a" }')
        assert (("SF650", "q") in found) == is_loose, ends


def test_a_node_that_is_read_is_not_loose():
    spring = 'two = { type = "spring", between = ["x", "y"], k = "k" }'
    assert "SF650" not in {code for code, _ in told(elements=spring, outputs='Y = "y"')}


def test_the_end_of_a_beam_is_free_unless_its_name_is_nearly_another():
    for name, is_free in [
        *((name, False) for name in ("gruond", "grond", "groun", "goround", "Ground")),
        *((name, True) for name in ("tip", "round_1", "gr", "x_ground_end")),
    ]:
        beam = f'arm = {{ type = "beam", between = ["x", "{name}"], {LINE} }}'
        found = told(elements=f'{beam}\nguide = {{ type = "slider", at = "x" }}')
        assert found == ([] if is_free else [("SF650", name)]), name


def test_a_free_end_is_warned_of_where_its_name_is_that_of_another_node_with_a_slip():
    slips = [
        *(("tip", name) for name in ("top", "tp", "ttip", "tpi", "Tip")),
        *(("gripper", name) for name in ("griper", "grippper", "gripper_")),
        *(("arm_left", name) for name in ("arm_lefft", "amr_left", "armleft", "armLeft")),
    ]
    meant = [
        ("tip", "rim"),
        ("tip_1", "tip_2"),
        ("n12", "n21"),
        ("x_left", "x_right"),
        ("fl", "fr"),
        ("a", "b"),
    ]
    for node, name in [*slips, *meant]:
        parts = f'''load = {{ type = "mass", at = "{node}", m = "m" }}
        arm = {{ type = "beam", between = ["base", "{name}"], {LINE} }}
        guide = {{ type = "slider", at = "base" }}'''
        found = [w for w in warned(elements=parts, inputs=f'G = {{ force = "{node}" }}') if w[0] == "SF650"]
        expected = [("SF650", name, f"did you mean '{node}'?")] if (node, name) in slips else []
        assert found == expected, (node, name)


def test_the_free_ends_are_the_ends_of_members_that_nothing_else_names():
    member = f'between = ["{{}}", "{{}}"], {LINE}'
    beams = "\n".join(
        f'b_{i} = {{ type = "beam", {member.format(*ends)} }}'
        for i, ends in enumerate((("x", "p"), ("x", "q"), ("r", "x"), ("x", "s"), ("s", "x")))
    )
    spring = 'two = { type = "spring", between = ["x", "loose"], k = "k" }'
    guide = 'guide = { type = "slider", at = "x" }'
    text = PLAIN.format(
        parameters="", elements=f"{beams}\n{spring}\n{guide}", inputs="", outputs='Q = "q"', sections=""
    )
    found = free_ends(pipeline.loads(text))
    assert [(use.name, node) for use, node in found] == [("b_0", "p"), ("b_2", "r")]


def test_a_name_that_nothing_uses_is_told():
    for part, line, name in [
        ("parameters", 'm_2 = "3 kg"', "m_2"),
        ("inputs", "u = {}", "u"),
        ("sections", '[signals]\ne = "2*x"', "e"),
        ("sections", '[signals]\ne = "2*x + e/3"', "e"),
        ("sections", '[blocks]\nC = { type = "integrator" }', "C"),
        ("sections", '[definitions]\nw_0 = "sqrt(k/m)"', "w_0"),
        ("sections", '[definitions]\nS = "k + 3*k"', "S"),
        ("sections", '[fields.w]\ndomain = ["0 m", "1 m"]\nequation = "w\'\' = 2*w"\n'
         'conditions = ["w(0) = 0", "w(1) = 0"]', "w"),
    ]:  # fmt: skip
        assert told(**{part: line}) == [("SF651", name)], (part, line)


def test_a_field_whose_conditions_join_it_to_another_is_used():
    # A string that is pushed where two parts meet; an output reads the first part only.
    parts = """[fields.v]
domain = ["0 m", "1 m"]
equation = "v'' = q*v"
conditions = ["v(0) = 0", "v(1) = w(1)", "w'(1) - v'(1) = k*x"]
[fields.w]
domain = ["1 m", "2 m"]
equation = "w'' = q*w"
conditions = ["w(2) = 0"]"""
    for shown in "vw":
        assert told(parameters='q = "3 1/m^2"', outputs=f'Y = "{shown}(1)"', sections=parts) == [], shown


def test_of_many_warnings_the_first_hundred_are_told_and_the_others_counted():
    found = warned_by(parameters="\n".join(f"p_{i} = {i + 1}" for i in range(130)))
    assert [w.span.text for w in found[:100]] == [f"p_{i}" for i in range(100)]
    assert [w.message for w in found[100:]] == ["30 more warnings"]


def test_a_definition_that_the_print_shows_and_a_parameter_of_a_printed_formula_are_used():
    assert told(sections='[definitions]\nZ = "m*s^2 + k"') == []  # X/F = 1/Z
    formula = '[published."X/F"]\nexpr = "1/(m*s^2 + k_p)"'
    assert told(parameters='k_p = "2 N/m"', sections=formula) == []


def nested(folder, inner, outer):
    """Return the warnings of a file, and those of a model in a block of it."""
    (folder / "inner.toml").write_text(inner, encoding="utf-8")
    (folder / "outer.toml").write_text(outer, encoding="utf-8")
    return pipeline.load(folder / "outer.toml").warnings


BLOCK = 'G = { type = "model", spec = "inner.toml", tf = "X/F" }\n'


def test_a_parameter_that_only_a_model_block_shares_is_used(tmp_path):
    inner = PLAIN.format(parameters="", elements="", inputs="", outputs="", sections="")
    head = 'symflex = 1\nparameters = { m = "1 kg" }\ninputs = { u = {} }\noutputs = { y = "G*u" }\n'
    assert nested(tmp_path, inner, f"{head}[blocks]\n{BLOCK}") == ()


def test_the_warnings_of_a_model_block_are_those_of_its_file(tmp_path):
    inner = PLAIN.format(parameters='m_2 = "1 kg"', elements="", inputs="", outputs="", sections="")
    head = 'symflex = 1\ninputs = { u = {} }\noutputs = { y = "(G + H)*u" }\n'
    (warning,) = nested(tmp_path, inner, f"{head}[blocks]\n{BLOCK}{BLOCK.replace('G', 'H')}")
    found = (warning.code, warning.span.text, warning.span.source.name)
    assert found == ("SF651", "m_2", str(tmp_path / "inner.toml"))


SHIPPED = [
    *specifications(ROOT / "derivations", "**/*.toml"),
    *sorted((ROOT / "symflex/templates").glob("*.toml")),
]


@pytest.mark.slow
def test_a_shipped_model_has_no_warnings():
    for path in SHIPPED:
        assert pipeline.warnings(pipeline.load(path)) == (), path
