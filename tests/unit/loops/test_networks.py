"""Stable gains of loops about many beams, against the written-out form and finite elements."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import pi

import numpy as np
import pytest

from symflex import pipeline
from symflex.budget import Budget
from symflex.errors import ModelError
from symflex.figures import draw_loop
from symflex.loops import Loop, NetworkLoop, of_model, trace_locus
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
    """Return how many poles finite elements have in the right half plane, up to a frequency [rad/s]."""
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
def test_a_chain_has_the_stable_gains_of_its_formula(monkeypatch):
    up_to = 100.0
    limit = f"{up_to} Hz"
    expected = found(chain(2), limit)
    assert isinstance(of_model.characteristic_loop(pipeline.loads(chain(2)), "K"), Loop)
    monkeypatch.setattr(of_model, "is_large_network", lambda model: True)
    assert isinstance(of_model.characteristic_loop(pipeline.loads(chain(2)), "K"), NetworkLoop)
    network = found(chain(2), limit)
    assert [float(b.gain.mid()) for b in network.boundaries] == pytest.approx(
        [float(b.gain.mid()) for b in expected.boundaries], rel=1e-13
    )
    assert [i.poles for i in network.intervals] == [i.poles for i in expected.intervals]
    assert not network.certified and network.radius >= 2 * pi * up_to


def test_a_locus_of_a_search_whose_time_is_over_is_refused(monkeypatch):
    monkeypatch.setattr(of_model, "is_large_network", lambda model: True)
    loop = of_model.characteristic_loop(pipeline.loads(chain(1)), "K")
    found = replace(loop.located(Fraction(0), Modes(1), Budget()), poles=(), unstable=(), hidden=())

    def nothing(self, gain, region, budget):
        return found

    monkeypatch.setattr(NetworkLoop, "located", nothing)
    assert refusal(trace_locus, loop, (Fraction(0), Fraction(20)), 1) == "UncertifiedError SF807"
    over = Budget(1, clock=iter(range(0, 1000, 10)).__next__)
    assert refusal(trace_locus, loop, (Fraction(0), Fraction(20)), 1, over) == "BudgetError SF506"


@pytest.mark.slow
def test_a_locus_is_that_of_the_formula(monkeypatch):
    model, limits = pipeline.loads(chain(1)), (Fraction(0), Fraction(20))
    written = trace_locus(of_model.characteristic_loop(model, "K"), limits, modes=2)
    monkeypatch.setattr(of_model, "is_large_network", lambda model: True)
    network = trace_locus(of_model.characteristic_loop(model, "K"), limits, modes=2)
    for a, b in ((network.start, written.start), (network.end, written.end)):
        assert [complex(r.re, r.im) for r in a.all_poles] == pytest.approx(
            [complex(r.re, r.im) for r in b.all_poles], rel=1e-13
        )
    assert network.arrived and len(network.branches) == len(written.branches) == 4
    for one, other in zip(network.branches, written.branches, strict=True):
        assert [one[0], one[-1]] == pytest.approx([other[0], other[-1]], rel=1e-9)


@pytest.mark.slow
def test_a_loop_gain_is_minus_one_at_a_closed_loops_pole(monkeypatch):
    (boundary, *_) = found(chain(6)).boundaries
    (crossing,) = boundary.crossings
    loop = of_model.characteristic_loop(pipeline.loads(chain(6)), "K")
    (value,) = loop.gains(Fraction(float(boundary.gain.mid())), [float(crossing.frequencies[0].mid())])
    assert abs(value + 1) < 1e-9


@pytest.mark.slow
def test_a_nyquist_plot_says_that_poles_of_a_network_are_known_in_a_disc():
    loop = of_model.characteristic_loop(pipeline.loads(chain(6)), "K")
    figure = draw_loop("nyquist", loop, band_hz=(1, 40))
    assert figure.legends[0].get_title().get_text().startswith("open loop: an unknown number of poles")


@pytest.mark.slow
def test_six_beams_lose_their_poles_where_finite_elements_do():
    network = found(chain(6))
    gains = [float(b.gain.mid()) for b in network.boundaries]
    samples = [(a * b) ** 0.5 for a, b in zip([0.1, *gains], [*gains, 100.0], strict=True)]
    expected = [unstable(6, gain, network.radius) for gain in samples]
    assert [i.poles.right for i in network.intervals] == expected
    assert len(gains) == 3


@pytest.mark.slow
def test_without_losses_nothing_is_claimed_of_the_axis():
    network = found(
        chain(6, loss='{ value = "0 N*s/m", assume = "nonnegative" }', law="K*(r*t - n_6.y)/t"), "40 Hz"
    )
    assert any("mirror each other" in reason for reason in network.reasons)
    assert not network.stable


def test_what_is_no_gain_of_a_network_is_followed_by_value():
    model = pipeline.loads(chain(6))
    for name, message in (("k", "'k' stands in several places of a network"), ("rho", "'rho' is part of")):
        with pytest.raises(ModelError, match=message) as caught:
            of_model.characteristic_loop(model, name)
        assert "symflex sweep FILE --over" in caught.value.diagnostics[0].hint


def test_a_gain_that_closes_no_loop_is_refused():
    with pytest.raises(ModelError, match="no pole of the model depends on 'K'"):
        found(chain(6, law="K*r"))
