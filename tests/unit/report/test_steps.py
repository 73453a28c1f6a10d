"""A report shows the step of a loop that is closed and stable, and no other."""

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

# A figure asked for, so that those by default need not be drawn.
ROOTS = 'figures.roots = { kind = "poles_zeros" }\n'


def drawn(folder, text):
    """Return the names of the drawings of a model."""
    (folder / "a.toml").write_text(text, encoding="utf-8")
    section = figure_section(Study.of(folder / "a.toml", "a"))
    return sorted(name for name in section.files if name.endswith(".svg"))


@pytest.mark.slow
def test_a_stable_closed_loop_shows_the_step_of_its_reference(tmp_path):
    found = drawn(tmp_path, LOOP.replace("K N", "2 N") + ROOTS)
    assert found == ["figures/a_roots.svg", "figures/a_step.svg"]


@pytest.mark.slow
def test_no_step_is_shown_of_what_is_open_or_grows_or_has_its_own(tmp_path):
    unstable = LOOP.replace('"K N*s/m"', '{ value = "-2 N*s/m", assume = "real" }')
    is_open = 'symflex = 1\ninputs.u = {}\noutputs.y = "u/(s + 1)"\n'
    has_its_own = LOOP.replace("K N", "2 N") + 'figures.a = { kind = "impulse", of = ["X/r"], until = "2 s" }'
    assert drawn(tmp_path, unstable + ROOTS) == ["figures/a_roots.svg"]
    assert drawn(tmp_path, is_open) == ["figures/a_bode.svg", "figures/a_poles_zeros.svg"]
    assert drawn(tmp_path, has_its_own) == ["figures/a_a.svg"]


def test_a_loop_is_closed_where_a_signal_depends_on_itself():
    for signals, is_closed in (
        ('u = "r - x"', True),  # by the network
        ('u = "2*v"\nsignals.v = "r - u"', True),  # by another signal
        ('u = "r"\nsignals.v = "x"', False),  # seen, and not fed back
        ('u = "2*v"\nsignals.v = "r"', False),
    ):
        text = 'symflex = 1\nelements.b = { type = "mass", at = "x", m = "1 kg" }\n'
        text += 'elements.f = { type = "force_source", at = "x", f = "k*u" }\nparameters.k = "1 N"\n'
        text += f'inputs.r = {{}}\noutputs.X = "x"\nsignals.{signals}\n'
        assert (
            loads(text.replace("r - x", 'r - x/l"\nparameters.l = "1 m')).resolved.is_closed_loop is is_closed
        ), (signals, is_closed)
