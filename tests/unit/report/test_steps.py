"""A report shows the step of a loop that is closed and stable, and no other."""

from __future__ import annotations

import pytest

from symflex import loads
from symflex.report.sections.files import figure_section
from symflex.report.study import Study

LOOP = """
symflex = 1
parameters = { m = "1 kg", k_p = "9 N/m", k_d = "K N*s/m" }
elements.body = { type = "mass", at = "x", m = "m" }
elements.drive = { type = "force_source", at = "x", f = "u" }
inputs = { r = { unit = "m" }, d = { force = "x" } }
signals.u = "k_p*(r - x) - k_d*s*x"
outputs = { X = "x" }
"""


def drawn(folder, text):
    """Return the names of the drawings of a model."""
    (folder / "a.toml").write_text(text, encoding="utf-8")
    section = figure_section(Study.of(folder / "a.toml", "a"))
    return sorted(name for name in section.files if name.endswith(".svg"))


def test_a_stable_closed_loop_shows_the_step_of_its_reference(tmp_path):
    assert "figures/a_step.svg" in drawn(tmp_path, LOOP.replace("K N", "2 N"))


@pytest.mark.parametrize(
    "text",
    [
        LOOP.replace('"K N*s/m"', '{ value = "-2 N*s/m", assume = "real" }'),
        'symflex = 1\ninputs.u = {}\noutputs.y = "u/(s + 1)"',
        LOOP.replace("K N", "2 N") + 'figures.a = { kind = "impulse", of = ["X/r"], until = "2 s" }',
    ],
    ids=["unstable", "open", "asked for another"],
)
def test_no_step_is_shown_of_what_is_open_or_grows_or_has_its_own(tmp_path, text):
    assert not [name for name in drawn(tmp_path, text) if "step" in name]


@pytest.mark.parametrize(
    ("signals", "is_closed"),
    [
        ('u = "r - x"', True),  # by the network
        ('u = "2*v"\nsignals.v = "r - u"', True),  # by another signal
        ('u = "r"\nsignals.v = "x"', False),  # seen, and not fed back
        ('u = "2*v"\nsignals.v = "r"', False),
    ],
)
def test_a_loop_is_closed_where_a_signal_depends_on_itself(signals, is_closed):
    text = 'symflex = 1\nelements.b = { type = "mass", at = "x", m = "1 kg" }\n'
    text += 'elements.f = { type = "force_source", at = "x", f = "k*u" }\nparameters.k = "1 N"\n'
    text += f'inputs.r = {{}}\noutputs.X = "x"\nsignals.{signals}\n'
    assert loads(text.replace("r - x", 'r - x/l"\nparameters.l = "1 m')).resolved.is_closed_loop is is_closed
