"""Equations cut into a table of numbers: order, width, stations along x."""

from random import Random

from symflex import pipeline
from symflex.equations import assemble
from symflex.equations.line_network import line_network

ROD = 'type = "rod", E = "2 Pa", A = "1 m^2", rho = "3 kg/m^3", l = "0.5 m"'


def table(elements, output="a", node="a"):
    """Return the network of some elements with a force on node a."""
    ends = f'[inputs]\nF = {{ force = "{node}" }}\n[outputs]\nX = "{output}"\n'
    text = f"symflex = 1\n[elements]\n{elements}\n{ends}"
    return line_network(assemble(pipeline.loads(text), is_sparse=True, is_cut=True))


def test_a_chain_written_in_any_order_is_a_narrow_band():
    count = 40
    ends = [(f"n_{i - 1}" if i > 1 else "a" if i else "ground", f"n_{i}" if i else "a") for i in range(count)]
    lines = [f'r_{i} = {{ {ROD}, between = ["{a}", "{b}"] }}' for i, (a, b) in enumerate(ends)]
    Random(1).shuffle(lines)
    size, height, width, _, _ = table("\n".join(lines)).table
    assert size == 3 * count
    assert height <= 4
    assert width <= 6


def test_points_along_an_element_cut_it_in_their_order():
    cut = table(f'r = {{ {ROD}, between = ["ground", "a"] }}', "r.u(0.4 m) - r.u(0.1 m)")
    assert [float(c.length.unit) for c in cut.equations.continua] == [0.1, 0.3, 0.1]


def test_ends_of_an_element_need_no_cut():
    cut = table(f'r = {{ {ROD}, between = ["b", "a"] }}', "r.u(0.5 m) - r.u(0 m)")
    assert len(cut.equations.continua) == 1


def test_a_member_at_an_angle_is_solved_in_its_own_axes():
    frame = 'type = "frame", E = "2 Pa", A = "1 m^2", I = "1 m^4", rho = "3 kg/m^3", l = "1 m"'
    text = f'r = {{ {frame}, between = ["ground", "a"], angle = "30 deg" }}'
    *_, groups = table(text, "a.y", "a.y").table
    assert sorted(len(signs) for _, signs, _ in groups) == [2, 4]
