"""Every form in which the program prints a distributed system, read as if a paper had printed it.

The audit reads expressions and knows nothing of forms, so that each is proved against the derivation from
outside.
"""

from __future__ import annotations

import pytest

from symflex import pipeline
from symflex.audit import judge
from symflex.errors import UsageError
from symflex.expressions import quotient
from symflex.model import Published
from symflex.print.forms import FORMS, print_form
from tests.house.repository import ROOT, in_turns

CLASSICS = sorted((ROOT / "derivations" / "classics").glob("*.toml"))
PAPER = [
    ROOT / "derivations" / "eppinger1988" / f"{name}.toml" for name in ("sliding_free_beam", "robot_axis")
]
SYMBOLIC = [name for name in FORMS if name != "zpk"]
NESTED = {("timoshenko_cantilever", "frequency")}
"""Roots in roots of negative numbers, which are compared at points."""


@pytest.mark.parametrize("path", in_turns([*CLASSICS, *PAPER], dear=("robot_axis",)))
@pytest.mark.parametrize("form", SYMBOLIC)
def test_a_form_is_proved_equal_to_the_derivation(path, form):
    for tf in pipeline.derive_all(pipeline.load(path)):
        try:
            printed = print_form(tf, form)
        except UsageError:
            continue  # the form does not suit this function
        published = Published(
            (tf.output.name, tf.input.name), quotient(printed.num, printed.den), tuple(printed.where)
        )
        expected = "agrees" if (path.stem, form) in NESTED else "equal"
        assert (tf.name, judge(tf, published).verdict) == (tf.name, expected)
