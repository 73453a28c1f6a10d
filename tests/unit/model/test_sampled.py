"""Sampled blocks: what ``[sampled]`` says, and where a loop is opened."""

import pytest

from symflex import pipeline
from symflex.errors import ModelError, SpecError
from symflex.expressions import format_expression
from symflex.model.sampled import opened

HANDLE = """symflex = 1
parameters = { m = "2 kg", b = "3 N*s/m", K = "400 N/m", B = "5 N*s/m", T = "5 ms", f_s = "200 Hz" }
inputs     = { F = { unit = "N" } }
outputs    = { X = "x" }
"""
CLOSED = 'x = "(F - C*x)/(s*(m*s + b))"'
IN_Z = 'C = "K + B*(z - 1)/(T*z)"'


def written(signal=CLOSED, blocks=IN_Z, sampled='period = "T"', more=""):
    return f"{HANDLE}[signals]\n{signal}\n[blocks]\n{blocks}\n[sampled]\n{sampled}\n{more}"


def seen(**given):
    """Return what each channel samples, and its controller."""
    loop = opened(pipeline.loads(written(**given)))
    outputs = {o.name: format_expression(o.expression) for o in loop.model.outputs}
    return [(outputs[c.seen], format_expression(c.controller)) for c in loop.channels]


def refusal(**given):
    with pytest.raises(SpecError) as caught:
        pipeline.loads(written(**given))
    return [(d.code, d.message) for d in caught.value.diagnostics]


def test_the_factor_to_the_right_of_a_sampled_block_is_what_it_samples():
    assert [what for what, _ in seen()] == ["x"]
    assert [what for what, _ in seen(signal='x = "(F - C*s*x)/(s*(m*s + b))"', blocks='C = "B*z/z"')] == [
        "s*x"
    ]


def test_the_only_factor_that_varies_is_sampled_where_it_stands_to_the_left():
    signal = 'e = "F/K - x"\nx = "(F + e*C)/(s*(m*s + b))"'
    assert [what for what, _ in seen(signal=signal)] == ["e"]


def test_a_sum_of_sampled_blocks_is_one_controller_and_a_spring_beside_it_is_none():
    blocks = 'P = "K*z/z"\nD = "B*(z - 1)/(T*z)"'
    both = seen(signal='x = "(F - (P + D)*x)/(s*(m*s + b))"', blocks=blocks)
    assert [what for what, _ in both] == ["x"]
    beside = seen(signal='x = "(F - (C + K)*x)/(s*(m*s + b))"')
    assert [what for what, _ in beside] == ["x"]


def test_a_controller_may_be_named_in_definitions():
    ((what, controller),) = seen(signal='x = "(F - G*x)/(s*(m*s + b))"', more='[definitions]\nG = "2*C"')
    assert (what, "z" in controller) == ("x", True)


def test_two_uses_of_one_controller_on_one_signal_are_one_channel():
    loop = opened(pipeline.loads(written().replace('X = "x"', 'X = "x", U = "C*x"')))
    assert len(loop.channels) == 1


def test_equations_of_motion_are_opened_too():
    text = f"{HANDLE}[blocks]\n{IN_Z}\n[sampled]\nperiod = 'T'\n[equations]\nunknowns = ['x']\n"
    loop = opened(pipeline.loads(text + "equations = ['m*s^2*x + (b*s + C)*x = F']"))
    assert [c.held for c in loop.channels] == ["held_1"]


def test_blocks_in_s_are_sampled_by_a_rule():
    # s = (z - 1)/(T z) makes K + B s what is written in z
    ((_, controller),) = seen(blocks='C = "K + B*s"', sampled='period = "T"\nby = "backward"')
    assert controller == "K + B*((z - 1)/(T*z))"


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"blocks": 'C = "K + B*s"'}, "block 'C' is sampled, but is written in s"),
        ({"blocks": 'C = "K + B*s*z"'}, "block 'C' is sampled and contains both s and z"),
        ({"sampled": 'period = "T"\nblocks = ["D"]'}, "there is no block 'D' to sample"),
        ({"sampled": 'period = "T"\nhold = "first-order"'}, "the hold 'first-order' is not known"),
        ({"sampled": 'period = "T"\nby = "tustn"'}, "'tustn' does not make a function of z"),
        ({"sampled": 'period = "1/f_s"'}, "a time of [sampled] is no time"),
        ({"signal": 'x = "(z*F - C*x)/(s*(m*s + b))"'}, "z stands in '(z*F - C*x)/(s*(m*s + b))', which is"),
    ],
)
def test_what_cannot_be_sampled_is_refused(given, message):
    assert any(code == "SF260" and said.startswith(message) for code, said in refusal(**given))


def test_a_period_in_another_unit_is_refused():
    assert refusal(sampled='period = "3 mm"')[0][0] == "SF203"


def test_a_period_is_needed():
    missing = ("SF214", "[sampled] lacks period, the time from sample to sample")
    assert refusal(sampled='delay = "1 ms"') == [missing]


@pytest.mark.parametrize(
    "signal",
    [
        'x = "(F - x*s*C)/(s*(m*s + b))"',
        'x = "(F - x/C)/(s*(m*s + b))"',
        'x = "(F - (s*C)^2*x)/(s*(m*s + b))"',
    ],
)
def test_a_place_that_does_not_say_what_is_sampled_is_refused(signal):
    with pytest.raises(ModelError) as caught:
        opened(pipeline.loads(written(signal=signal)))
    assert caught.value.diagnostics[0].code == "SF260"


def test_what_takes_a_model_as_continuous_is_refused_with_one_code():
    model = pipeline.loads(written())
    with pytest.raises(ModelError) as caught:
        pipeline.derive_all(model)
    assert caught.value.diagnostics[0].code == "SF261"
    assert pipeline.assemble_for_checks(model).unknowns


def test_z_is_no_parameter_to_set():
    assert [p.name for p in pipeline.loads(written()).settable] == ["m", "b", "K", "B", "T", "f_s"]
