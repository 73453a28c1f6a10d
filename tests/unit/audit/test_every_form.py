"""Every form in which the program prints a distributed system, read as if a paper had printed it.

The audit reads expressions and knows nothing of forms, so that each is proved against the derivation from
outside.
"""

import pytest

from symflex.audit import judge
from symflex.errors import UsageError
from symflex.expressions import quotient
from symflex.model import Published
from symflex.print.forms import FORMS, print_form
from tests.unit.codegen.models_with_kernels import derived

SYMBOLIC = [name for name in FORMS if name != "zpk"]
NESTED = ("timoshenko_cantilever", "frequency")
"""Roots in roots of negative numbers, which are compared at points."""


@pytest.mark.parametrize(
    "name",
    ["sliding_free_beam", "timoshenko_cantilever", "rod_tip_mass", "kelvin_voigt_cantilever", "quarter_car"],
)
@pytest.mark.slow
def test_every_form_is_proved_equal_to_the_derivation(name):
    tf = derived(name)[-1]
    verdicts = {}
    for form in SYMBOLIC:
        try:
            printed = print_form(tf, form)
        except UsageError:
            continue  # the form does not suit this function
        published = Published(
            (tf.output.name, tf.input.name), quotient(printed.num, printed.den), tuple(printed.where)
        )
        verdicts[form] = judge(tf, published).verdict
    assert verdicts == {form: "agrees" if (name, form) == NESTED else "equal" for form in verdicts}
    assert len(verdicts) >= 5
