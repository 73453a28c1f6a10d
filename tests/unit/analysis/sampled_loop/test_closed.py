"""Characteristic functions of sampled loops."""

import pytest

from symflex import pipeline
from symflex.analysis.sampled_loop import sampled_loop
from symflex.analysis.sampled_loop.closed import described, located_in_w
from symflex.errors import ModelError


def model(signals, blocks='C = "K*z/z"', sampled='period = "0.5 s"', parameters="K = 1"):
    return pipeline.loads(f"""symflex = 1
parameters = {{ {parameters} }}
blocks     = {{ {blocks} }}
sampled    = {{ {sampled} }}
signals    = {{ {signals} }}
inputs     = {{ r = {{}} }}
outputs    = {{ Y = "y" }}
""")


def test_an_integrator_with_a_gain_has_one_pole():
    # z = 1 - K T, so w = (z - 1)/(z + 1) = -1/3
    located = located_in_w(sampled_loop(model('y = "C*(r - y)/s"')).tf, {})
    assert [complex(root) for root in located.poles] == [pytest.approx(-1 / 3)]


def test_a_mode_of_the_machine_that_no_controller_sees_counts():
    unseen = 'y = "C*(r - y)/s + (s - 1)/(s - 1)*0*r", x = "(r + x)/s"'
    assert sampled_loop(model(unseen)).apart.word == "unstable"


def test_what_is_sampled_is_said_in_words():
    late = model('y = "C*(r - y)/s"', sampled='period = "0.5 s", delay = "0.1 s"')
    assert described(sampled_loop(late)) == "C: sampled every 0.5 s, the output held, late by 0.1 s"


@pytest.mark.parametrize(
    ("given", "code"),
    [
        ({"signals": 'y = "C*(r - y)*s"'}, "SF236"),
        ({"signals": 'y = "s*(C*(r - y))"'}, "SF236"),
        ({"signals": 'y = "C*(r - y)/s", x = "C*(y - x)/s"'}, "SF260"),
        ({"signals": 'y = "C*(r - y)/s"', "sampled": 'period = "0 s"'}, "SF260"),
        (
            {
                "signals": 'y = "(C*(r - y) - exp(-0.3*s)*y)/s"',
                "sampled": 'period = "T", blocks = ["C"]',
                "parameters": "K = 1, T = 0.5",
            },
            "SF235",
        ),
        ({"signals": 'y = "C*(r - y)/s"', "sampled": 'period = "T"', "parameters": "K = 1, T = {}"}, "SF229"),
    ],
)
def test_what_is_no_loop_is_refused(given, code):
    with pytest.raises(ModelError) as caught:
        sampled_loop(model(**given))
    assert caught.value.diagnostics[0].code == code


@pytest.mark.parametrize(
    ("block", "says"),
    [
        ('C = "K*z"', "z^1"),
        ('C = "K*z^3/(z - 0.5)"', "z^2"),
        ('C = "0*K/z"', "is zero"),
        ('C = "(1 - K)/z"', "is zero"),
    ],
)
def test_a_controller_that_is_zero_or_knows_the_future_is_refused_at_its_block(block, says):
    with pytest.raises(ModelError) as caught:
        sampled_loop(model('y = "C*(r - y)/s"', blocks=block))
    (problem,) = caught.value.diagnostics
    assert problem.code == "SF260" and problem.span.line == 3 and says in problem.message


def test_a_delay_of_a_period_makes_up_for_one_sample():
    late = model('y = "C*(r - y)/s"', blocks='C = "K*z"', sampled='period = "0.5 s", delay = "0.5 s"')
    assert [complex(root) for root in located_in_w(sampled_loop(late).tf, {}).poles] == [
        pytest.approx(-1 / 3)
    ]
