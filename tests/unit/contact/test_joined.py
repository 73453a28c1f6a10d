"""A machine of another file at a port, against the same machine written as one."""

import pytest

from symflex import loads
from symflex.contact.joined import joined
from symflex.errors import SymflexError, UsageError
from symflex.loops.over import seen_pair
from symflex.model.ports import port_named
from symflex.roots.locate import locate
from symflex.transfer.of_model import derive_bound
from tests.unit.contact.test_coupled import FORCE_LOOP, unstable

TOOL = """
symflex = 1
parameters = { k = "30 kN/m", b = "2 N*s/m", x = "2 kg" }
definitions = { double = "2*b" }
signals = { push = "-double*s*x_touch/2" }
inputs = { F = { force = "x_touch" } }
outputs = { X = "x_touch" }
[elements]
spring = { type = "spring", between = ["x_touch", "ground"], k = "k" }
mass   = { type = "mass", at = "x_touch", m = "x" }
rub    = { type = "force_source", at = "x_touch", f = "push" }
[ports]
end = { at = "x_touch" }
"""


@pytest.fixture
def tool(tmp_path, monkeypatch):
    (tmp_path / "tool.toml").write_text(TOOL, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("K", [1.2, 8])
def test_a_machine_of_a_file_is_joined_node_to_node(tool, K):
    found = loads(FORCE_LOOP).contact("touch", "tool.toml:end", K=K)
    assert (found.answer.verdict.right or 0) == unstable(K, (30e3, 2, 2))


def test_its_names_end_in_e_and_are_set_and_searched(tool):
    by_file = loads(FORCE_LOOP).contact(
        "touch", "tool.toml", over="k_e", ranges={"k_e": (1e3, 1e5)}, b_e=1, x_e=1
    )
    by_law = loads(FORCE_LOOP).contact(
        "touch", "k_e + b_e*s + m_e*s^2", over="k_e", ranges={"k_e": (1e3, 1e5)}, b_e=1, m_e=1
    )
    ends = [[float(b.gain.mid()) for b in each.answer.boundaries] for each in (by_file, by_law)]
    assert ends[0] == pytest.approx(ends[1], rel=1e-12)


def test_poles_are_those_of_both():
    machine, tool = loads(FORCE_LOOP).resolved, loads(TOOL).resolved
    model = joined(machine, port_named(machine, "touch"), tool, port_named(tool, "end"))
    assert {"k", "k_e", "b_e", "x_e"} <= {p.name for p in model.parameters}
    (bound,) = derive_bound(model, [seen_pair(model)])
    assert len(locate(bound, with_zeros=False).all_poles) == 6


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (('at = "x_touch" }\n', 'at = "nowhere" }\n'), "nowhere"),
        (("[ports]\nend", "[ports]\nother = { at = ['x_touch', 'ground'] }\nend"), "name the port"),
    ],
)
def test_a_file_without_a_port_to_join_is_refused(tool, change, said):
    (tool / "tool.toml").write_text(TOOL.replace(*change), encoding="utf-8")
    with pytest.raises(SymflexError, match=said):
        loads(FORCE_LOOP).contact("touch", "tool.toml")


def test_a_machine_whose_force_follows_a_point_of_a_member_is_refused(tool):
    stay = (
        'stay = { type = "string", between = ["x_touch", "ground"], N = "9 N", rhoA = "1 g/m", l = "0.5 m" }'
    )
    text = TOOL.replace("[elements]", f"[elements]\n{stay}").replace(
        "double*s*x_touch", "double*s*stay.y(0.2)"
    )
    (tool / "tool.toml").write_text(text, encoding="utf-8")
    with pytest.raises(UsageError, match="quantities at points of members"):
        loads(FORCE_LOOP).contact("touch", "tool.toml")


def test_ports_that_move_differently_are_refused(tool):
    turning = TOOL.replace('"spring", between', '"torsion_spring", between').replace('"mass"', '"inertia"')
    turning = (
        turning.replace("m = ", "J = ").replace("force_source", "torque_source").replace("f = ", "tau = ")
    )
    turning = turning.replace("force =", "torque =").replace('"30 kN/m"', "3").replace('"2 N*s/m"', "2")
    (tool / "tool.toml").write_text(turning.replace('"2 kg"', "2"), encoding="utf-8")
    with pytest.raises(UsageError, match="in translation, and 'end' in rotation"):
        loads(FORCE_LOOP).contact("touch", "tool.toml")


@pytest.mark.parametrize("name", ["s", "pi", "ground"])
def test_elements_of_the_other_may_have_names_that_mean_something_else(tool, name):
    (tool / "tool.toml").write_text(TOOL.replace("mass   =", f"{name} ="), encoding="utf-8")
    found = loads(FORCE_LOOP).contact("touch", "tool.toml", K=8)
    assert (found.answer.verdict.right or 0) == unstable(8, (30e3, 2, 2))
