"""Stable gains of loops about many beams, against the written-out form and finite elements."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import pi

import numpy as np
import pytest
from flint import acb

from symflex import pipeline
from symflex.budget import Budget
from symflex.errors import BudgetError, Diagnostic, ModelError
from symflex.figures import draw
from symflex.loops import NetworkLoop, loop_gain, of_model, trace_locus
from symflex.loops.of_model import stability
from symflex.options import StabilityOptions
from symflex.roots import Modes
from tests.unit.refusals import refusal

BENDING, MASS, SPRING, LOSS = 70e9 * 2e-9, 2700.0 * 150e-6, 1e3, 0.5
"""Of aluminium strips [N*m^2, kg/m], on springs and dampers [N/m, N*s/m]."""


LAW = 'E = "E", I = "I", A = "A", rho = "rho"'


def lengths(count):
    return [0.2 + 0.03 * i for i in range(count)]


def chain(count, *, loss='"0.5 N*s/m"', law="K*(r - v)"):
    """Return a clamped chain; its tip's velocity drives its first joint."""
    rows = []
    for i, length in enumerate(lengths(count)):
        ends = f'between = ["n_{i}", "n_{i + 1}"]'
        rows.append(f'b_{i} = {{ type = "beam", {ends}, {LAW}, l = "{length:.2f} m" }}')
        rows.append(f's_{i} = {{ type = "spring", between = ["n_{i + 1}.y", "ground"], k = "k" }}')
        rows.append(f'd_{i} = {{ type = "damper", between = ["n_{i + 1}.y", "ground"], b = "b" }}')
    elements = "\n".join(rows)
    return f"""
        symflex = 1
        [parameters]
        E = "70 GPa"
        I = "2000 mm^4"
        A = "150 mm^2"
        rho = "2700 kg/m^3"
        k = "1 kN/m"
        b = {loss}
        K = "1 N*s/m"
        t = "1 s"
        [elements]
        clamp = {{ type = "fixed", at = "n_0" }}
        {elements}
        drive = {{ type = "force_source", at = "n_1.y", f = "u" }}
        [signals]
        v = "s*n_{count}.y"
        u = "{law}"
        [inputs]
        r = {{ unit = "m/s" }}
        [outputs]
        Y = "n_{count}.y"
        """.replace("\n        ", "\n")


def found(text, up_to="300 Hz", limits=("0", "100")):
    given = StabilityOptions(gain="K", limits=limits, up_to=up_to)
    return stability(pipeline.loads(text), given)


def unstable(count, gain, up_to):
    """Return how many poles finite elements have in the right half-plane, up to a frequency [rad/s]."""
    pieces = 6
    size = 2 * (pieces * count + 1)
    mass, stiff, loss = (np.zeros((size, size)) for _ in range(3))
    joints = [2 * pieces * (i + 1) for i in range(count)]
    for i, length in enumerate(lengths(count)):
        h = length / pieces
        # Hermite's element (Przemieniecki 1968): stiffness and mass.
        bent = [[12, 6 * h, -12, 6 * h], [6 * h, 4 * h * h, -6 * h, 2 * h * h]]
        bent += [[-x for x in bent[0]], [6 * h, 2 * h * h, -6 * h, 4 * h * h]]
        moved = [[156, 22 * h, 54, -13 * h], [22 * h, 4 * h * h, 13 * h, -3 * h * h]]
        moved += [[54, 13 * h, 156, -22 * h], [-13 * h, -3 * h * h, -22 * h, 4 * h * h]]
        k, m = BENDING / h**3 * np.array(bent), MASS * h / 420 * np.array(moved)
        for j in range(pieces):
            at = np.ix_(*2 * [range(2 * (i * pieces + j), 2 * (i * pieces + j) + 4)])
            stiff[at] += k
            mass[at] += m
    for joint in joints:
        stiff[joint, joint] += SPRING
        loss[joint, joint] += LOSS
    loss[joints[0], joints[-1]] += gain
    free = slice(2, None)
    inverse = np.linalg.inv(mass[free, free])
    n = size - 2
    state = np.block(
        [[np.zeros((n, n)), np.eye(n)], [-inverse @ stiff[free, free], -inverse @ loss[free, free]]]
    )
    poles = np.linalg.eigvals(state)
    return int(np.sum((poles.real > 0) & (abs(poles) < up_to)))


@pytest.mark.slow
def test_stable_gains_of_a_network_are_those_of_finite_elements_up_to_a_frequency():
    network = found(chain(6))
    assert [len(b.crossings) for b in network.boundaries] == [1, 1]
    for interval in network.intervals:
        gain = (float(interval.low.mid()) + float(interval.high.mid())) / 2
        assert unstable(6, gain, 2 * pi * 300) == interval.poles.right
    # Just beside a boundary, too, which finite elements know to a thousandth.
    for boundary, before, after in zip(network.boundaries, (0, 2), (2, 4), strict=True):
        gain = float(boundary.gain.mid())
        assert [unstable(6, x * gain, 2 * pi * 300) for x in (0.998, 1.002)] == [before, after]
    assert not network.certified and network.counted_up_to == pytest.approx(2 * pi * 300)
    assert "poles are counted up to there" in str(network)
    assert network.gain_margins[0].factor.overlaps(network.boundaries[0].gain)  # of K = 1


@pytest.mark.slow
def test_a_passive_loop_of_a_network_is_stable_for_all_gains():
    text = chain(6, law="-K*s*n_1.y")
    network = found(text.replace('r = { unit = "m/s" }', 'F = { force = "n_6.y" }'))
    assert network.certified and not network.boundaries
    assert [interval.poles.is_stable for interval in network.intervals] == [True]


@pytest.mark.slow
def test_a_loop_whose_formula_takes_too_long_is_answered_from_its_equations(monkeypatch):
    def refuse(*_):
        raise BudgetError(Diagnostic("SF505", "the search takes too long"))

    monkeypatch.setattr(of_model, "characteristic_loop", refuse)
    network = found(chain(3), "200 Hz")
    assert network.intervals
    for interval in network.intervals:
        gain = (float(interval.low.mid()) + float(interval.high.mid())) / 2
        assert unstable(3, gain, 2 * pi * 200) == interval.poles.right


def test_a_locus_of_a_search_whose_time_is_over_is_refused(monkeypatch):
    monkeypatch.setattr(of_model, "is_large_network", lambda *_: True)
    loop = of_model.characteristic_loop(pipeline.loads(chain(1)), "K")
    found = replace(loop.located(Fraction(0), Modes(1)), poles=(), unstable=(), hidden=())

    def nothing(self, gain, region):
        return found

    monkeypatch.setattr(NetworkLoop, "located", nothing)
    assert refusal(trace_locus, loop, (Fraction(0), Fraction(20)), 1) == "UncertifiedError SF807"
    with Budget(1, clock=iter(range(0, 1000, 10)).__next__).entered():
        assert refusal(trace_locus, loop, (Fraction(0), Fraction(20)), 1) == "BudgetError SF506"


@pytest.mark.slow
def test_a_locus_is_that_of_the_formula(monkeypatch):
    model, limits = pipeline.loads(chain(1)), (Fraction(0), Fraction(20))
    written = trace_locus(of_model.characteristic_loop(model, "K"), limits, modes=2)
    monkeypatch.setattr(of_model, "is_large_network", lambda *_: True)
    network = trace_locus(of_model.characteristic_loop(model, "K"), limits, modes=2)
    for a, b in ((network.start, written.start), (network.end, written.end)):
        assert [complex(r.re, r.im) for r in a.all_poles] == pytest.approx(
            [complex(r.re, r.im) for r in b.all_poles], rel=1e-13
        )
    assert network.arrived and len(network.branches) == len(written.branches) == 4
    for one, other in zip(network.branches, written.branches, strict=True):
        assert [one[0], one[-1]] == pytest.approx([other[0], other[-1]], rel=1e-9)


def test_a_loop_gain_is_that_of_the_formula(monkeypatch):
    model = pipeline.loads(chain(1))
    written = loop_gain(of_model.characteristic_loop(model, "K"), Fraction(3))
    monkeypatch.setattr(of_model, "is_large_network", lambda *_: True)
    network = of_model.characteristic_loop(model, "K").gains(Fraction(3), [50.0])
    assert network == pytest.approx([complex(written.enclosed(96)(acb(0, 50)).mid())], rel=1e-12)


@pytest.mark.slow
def test_a_nyquist_plot_says_that_poles_of_a_network_are_known_in_a_disc():
    loop = of_model.characteristic_loop(pipeline.loads(chain(6)), "K")
    figure = draw("nyquist", loop, band_hz=(1, 40))
    assert figure.legends[0].get_texts()[0].get_text().endswith(", $P$ not known")


def test_what_is_no_gain_of_a_network_is_followed_by_value():
    model = pipeline.loads(chain(6))
    for name, message in (("k", "'k' occurs in several places of a network"), ("rho", "'rho' is part of")):
        with pytest.raises(ModelError, match=message) as caught:
            of_model.characteristic_loop(model, name)
        assert "symflex sweep FILE --over" in caught.value.diagnostics[0].hint


def test_a_gain_that_closes_no_loop_is_refused():
    with pytest.raises(ModelError, match="no pole of the model depends on 'K'"):
        found(chain(6, law="K*r"))


@pytest.mark.slow
@pytest.mark.parametrize("outputs", ["Z", "XZ", "ZX"])
def test_a_filter_of_an_output_counts_for_the_stability_of_a_network(outputs):
    # 1/(s - a) grows, and 1/(s + a) does not.
    rows = {"X": 'X = "n_4.y"', "Z": 'Z = "n_3.y/(s - a)"'}
    text = chain(4, law="K*(r - s*n_1.y)").replace('Y = "n_4.y"', "\n".join(rows[o] for o in outputs))
    text = text.replace("[parameters]", '[parameters]\na = "1 1/s"')
    growing = stability(pipeline.loads(text), StabilityOptions("K"))
    assert (growing.verdict.word, growing.stable) == ("unstable", ())
    assert stability(pipeline.loads(text.replace("s - a", "s + a")), StabilityOptions("K")).is_stable
