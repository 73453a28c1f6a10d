"""Symbolic answers in a report are set as mathematics, with their conditions."""

from symflex.report.document import Mathematics
from symflex.report.sections.symbolic import symbolic_section
from symflex.report.study import Study

OSCILLATOR = """symflex = 1
parameters = { m = "1 kg", b = "2 N*s/m", k = "50 N/m" }
inputs.F = {}
outputs.X = "F/(m*s^2 + b*s + k)"
"""


def test_conditions_on_roots_are_sentences_with_mathematics(tmp_path):
    (tmp_path / "a.toml").write_text(OSCILLATOR, encoding="utf-8")
    section = symbolic_section(Study.of(tmp_path / "a.toml", "a"))
    runs = [run for block in section.blocks for run in getattr(block, "runs", ())]
    said = "".join(run.latex if isinstance(run, Mathematics) else str(run) for run in runs)
    # The discriminant b^2 - 4*m*k is negative at the declared values: 4 < 200.
    assert "A complex pair if 4 m k > b^{2}, as here. Two real roots if b^{2} > 4 m k. " in said
