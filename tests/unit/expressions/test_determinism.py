import os
import subprocess
import sys

import pytest

CODE = """
from symflex.errors import Source, Span, SpecError, Text
from symflex.expressions import format_expression, parse
for value in ("2x", "a +", "(a", "a b)", "motor.5", "b*sin(a) - w''(l)^2/3"):
    try:
        print(format_expression(parse(Text(value, Span(Source("a", value), 0, len(value))))))
    except SpecError as error:
        print(error)
"""


def output(seed):
    environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run([sys.executable, "-c", CODE], env=environment, capture_output=True, check=True)
    return done.stdout


@pytest.mark.slow
def test_trees_and_messages_do_not_depend_on_the_hash_seed():
    assert output("1") == output("2025")
