"""What the live page proves, in Node: its discs, and its roots and counts against those in balls."""

from __future__ import annotations

import cmath
import json
import math
import random
from fractions import Fraction
from importlib import resources
from itertools import pairwise

import numpy as np
import pytest
from flint import acb, ctx

from symflex import pipeline
from symflex.budget import Silent
from symflex.live.page import live_page
from symflex.live.tape import tape_of
from symflex.roots import Band, Everything
from symflex.roots.functions.kernel_function import KernelFunction
from symflex.roots.locate import locate
from symflex.transfer import bind
from tests.house.repository import ROOT
from tests.integration.node import Node
from tests.unit.codegen.exportable import derived

pytestmark = pytest.mark.needs_tool("node")

KERNEL = "\n".join(
    resources.files("symflex.live").joinpath(name).read_text(encoding="utf-8")
    for name in ("discs.js", "roots.js")
)

WALK = """
export const walked = (tape, start, positions) => {
    const prover = proverOf(tape);
    let state = prover.begin(start);
    return positions.map((values) => {
        state = prover.moved(state, values);
        const { poles, zeros, certified, reach, stability, isPassive } = state;
        const ends = { poles: String(reach.poles), zeros: String(reach.zeros) };
        return { poles, zeros, certified, stability, isPassive, reach: ends };
    });
};
export const computed = (name, given) => {
    const m = discs(3), run = { sum, product, inverse, root, exponent }[name];
    given.forEach((disc, i) => put(m, i, ...disc));
    run(m, 2, 0, 1, 1.0);
    return [m.x[2], m.y[2], m.r[2]];
};
export const evaluated = (read, write) => {
    const numbers = (name) => new Float64Array(new Uint8Array(read(name)).buffer);
    const angles = numbers("angles.bin"), sines = new Float64Array(angles.length);
    write("exp.bin", numbers("exponents.bin").map(exponential));
    write("cos.bin", angles.map((x, i) => { const c = cosine(x); sines[i] = sine; return c; }));
    write("sin.bin", sines);
    return null;
};
export const isolated = (tape, z) => {
    const f = factorOf(tape);
    f.bind([]);
    return enclosed(f, z);
};
export const unsure = (radius) => {
    const m = discs(2);
    const at = (_, x, y, r) => { put(m, 0, x, y, r); put(m, 1, 0.0, 0.0, radius); };
    return counted({ m, at, value: 0, growth: [1], divisors: [] }, 1.0);
};
export const chords = (tape, radius) => {
    const f = factorOf(tape), discs = [];
    f.bind([]);
    const count = counted({ ...f, at(list, ...disc) { discs.push(disc); f.at(list, ...disc); } }, radius);
    return { count, discs };
};
"""

DAMPED = """
symflex = 1
parameters = { m = "1 kg", k = "100 N/m", b = "0.3 N*s/m", a = "0.3 rad", h = "2" }
definitions.k_s = "k*(sin(a)^2 + cos(a)^2)*(cosh(h)^2 - sinh(h)^2)"
elements.body   = { type = "mass", at = "x", m = "m" }
elements.spring = { type = "spring", between = ["x", "ground"], k = "k_s" }
elements.damper = { type = "damper", between = ["x", "ground"], b = "b" }
inputs.F = { force = "x" }
outputs.X = "x"
"""

CANCELLING = """
symflex = 1
parameters = { a = "2 s", b = "2.5 s", c = "0.5 s" }
signals.y = "(a*s + 1)/(b*s + 1)/(c*s + 1)*u"
inputs.u = {}
outputs.Y = "y"
"""

BETWEEN = """
symflex = 1
signals.y = "u/(s + 9007199254740993)"
inputs.u = {}
outputs.Y = "y"
"""


@pytest.fixture
def node(tmp_path):
    (tmp_path / "live.mjs").write_text(KERNEL + WALK, encoding="utf-8")
    node = Node(tmp_path)
    node.lines.insert(
        0, 'import { walked, computed, evaluated, isolated, chords, unsure } from "./live.mjs";'
    )
    return node


def walks(node, name, count, decades):
    """Ask for random positions of all sliders, one after another; return functions, positions and keys."""
    draw, rows = random.Random(name), []
    for tf in derived(name)[1]:
        start = {p.name: float(p.value.nearly) for p in tf.parameters}
        positions = [
            {k: v * 10 ** draw.uniform(-decades, decades) for k, v in start.items()} for _ in range(count)
        ]
        given = map(json.dumps, (tape_of(tf, {name: name for name in start})[0], start, positions))
        rows.append((tf, positions, node.keep(f"walked({', '.join(given)})")))
    return rows


def step_in_balls(bound, part, z):
    """Return the length of Newton's step at a point, in balls."""
    with ctx.workprec(200):
        factors = KernelFunction(bound, part).enclosed(acb(z.real, z.imag), 200)
        return abs(1 / sum((d / f * e for f, d, e in factors), acb(0))).upper()


def refuted(tf, values, state):
    """Yield what balls say against a state: certified roots that are none, and counts that are wrong."""
    bound = bind(tf, {name: Fraction(value) for name, value in values.items()})
    for kind, part in (("poles", bound.den), ("zeros", bound.num)):
        reach = float(state["reach"][kind].replace("Infinity", "inf"))
        region = Band(Fraction(0), Fraction(reach / (2 * math.pi))) if math.isfinite(reach) else Everything()
        found = locate(bound, region, 25, with_zeros=kind == "zeros")
        theirs = [(complex(r), r.multiplicity) for r in getattr(found, kind)]
        ours = []
        for z in state[kind]:
            centre = complex(z["re"], z["im"])
            ours.append((centre, z["multiplicity"] * (1 + (z["im"] > 0))))
            if z["proved"] and centre:
                near = sum(abs(p - centre) <= z["radius"] + 1e-15 * abs(centre) for p, _ in theirs)
                # Balls look for none near points where roots accumulate.
                is_right = near == 1 or step_in_balls(bound, part, centre) < 2 * z["radius"]
                if not is_right or z["radius"] > 1e-8 * abs(centre):
                    yield tf.name, kind, z
        holes = [(complex(e.re, e.im), e.radius) for e in found.excluded]
        counts = {
            sum(n for p, n in each if 0 < abs(p) < reach and all(abs(p - c) > r for c, r in holes))
            for each in (ours, theirs)
        }
        if state["certified"][kind] and found.certificate.certified and len(counts) > 1:
            yield tf.name, kind, counts, ours


def check(node, rows, least):
    """Confirm all that is proved; at least such a share of the positions is."""
    node.run()
    for tf, positions, key in rows:
        states = node.values[key]
        wrong = [x for both in zip(positions, states, strict=True) for x in refuted(tf, *both)]
        assert not wrong, wrong[:3]
        assert sum(all(s["certified"].values()) for s in states) >= least * len(states), tf.name


def test_roots_of_a_lumped_and_of_a_distributed_model_are_proved_and_right_wherever_sliders_are(node):
    rows = [row for name in ("two_mass", "rod_tip_mass") for row in walks(node, name, 3, 1.0)]
    check(node, rows, 1.0)
    assert all(state["isPassive"] for *_, key in rows for state in node.values[key])  # masses, springs, rods


def test_only_positive_values_are_passive(node):
    ((tf, _, key), *_) = walks(node, "two_mass", 1, 0.0)
    at = {p.name: -float(p.value.nearly) for p in tf.parameters}
    tape = json.dumps(tape_of(tf, {name: name for name in at})[0])
    key = node.keep(f"walked({tape}, {json.dumps(at)}, [{json.dumps(at)}])[0].isPassive")
    node.run()
    assert node.values[key] is False


LUMPED = "quarter_car six_mass lumped_bending_beam two_mass_force base_flexure_position"
BEAMS = "clamped_free sliding_free_beam one_link_arm shaft_discs timoshenko_cantilever tension"
OTHERS = "delayed two_beams l_frame robot_axis kelvin_voigt_cantilever sliding_free_beam_force"


@pytest.mark.slow
@pytest.mark.parametrize("name", f"{LUMPED} {BEAMS} {OTHERS}".split())
def test_proved_roots_and_counts_are_those_in_balls_at_random_positions(node, name):
    check(node, walks(node, name, 4, 1.0), 0.75)


def test_a_pole_that_crosses_the_axis_turns_the_verdict(node):
    # s^2 + b s/m + k/m: damped, growing, overdamped; b^2 = 4 m k has one double pole, which no disc tells.
    (tf,) = pipeline.derive_all(pipeline.loads(DAMPED))
    at = [
        {"m": 1.0, "k": 100.0, "b": b, "a": 0.3, "h": 2.0} for b in (0.3, -0.3, 30.0, 20.0)
    ]  # sin^2 + cos^2 = 1
    tape = tape_of(tf, {p.name: p.name for p in tf.parameters})[0]
    key, other = (
        node.keep(f"walked({json.dumps(tape)}, {json.dumps(at[n])}, {json.dumps(at)})") for n in (0, 3)
    )
    node.run()
    states = node.values[key]
    assert [state["stability"] for state in node.values[other]] == [state["stability"] for state in states]
    assert [state["stability"] for state in states] == ["stable", "unstable", "stable", "unknown"]
    assert [state["certified"]["poles"] for state in states] == [True, True, True, False]
    assert [len(state["poles"]) for state in states[:3]] == [1, 1, 2]
    assert (
        abs(complex(states[0]["poles"][0]["re"] + 0.15, states[0]["poles"][0]["im"] - math.sqrt(99.9775)))
        < 1e-10
    )


def test_a_pole_that_a_zero_cancels_at_these_values_is_not_proved(node):
    # (a s + 1)/(b s + 1)/(c s + 1): where a is b, one pole is left.
    (tf,) = pipeline.derive_all(pipeline.loads(CANCELLING))
    at = [{"a": 2.0, "b": 2.0, "c": 0.5}, {"a": 2.0, "b": 2.5, "c": 0.5}]
    tape = tape_of(tf, {p.name: p.name for p in tf.parameters})[0]
    key = node.keep(f"walked({json.dumps(tape)}, {json.dumps(at[1])}, {json.dumps(at)})")
    node.run()
    proved = [sorted(round(z["re"], 9) for z in state["poles"] if z["proved"]) for state in node.values[key]]
    assert proved == [[-2.0], [-2.0, -0.4]]
    assert [state["certified"]["poles"] for state in node.values[key]] == [False, True]


def test_a_newton_step_that_leaves_its_disc_proves_no_root(node):
    # a + g s + c s^2 with g anywhere within a radius of 1. Steps are a/least, discs 4 a: least has to exceed
    # 1/4. For g = 0.2 the roots -(g +- sqrt(g^2 - 4 a c))/(2 c) are 9.95 a from 0, and a/(0.2 - 8 a c) 8.4 a.
    size, bent = 2.0**-20, 0.0101
    keys = []
    for radius in (0.8, 0.67, 0.668):  # least is 0.119, 0.249 and 0.251
        rows = [["s"], ["#", 1, 0, radius], ["#", bent / size, 0, 0], ["#", size, 0, 0], ["*", 2, 0]]
        rows += [["+", 1, 4], ["*", 5, 0], ["+", 6, 3], ["+", 5, 4]]
        part = {"tape": rows, "value": 7, "slope": 8, "growth": [], "divisors": []}
        keys.append(node.keep(f"String(isolated({json.dumps(part)}, [0, 0]))"))
    node.run()
    *outside, inside = (float(node.values[key].replace("Infinity", "inf")) for key in keys)
    roots = [abs(z) for z in np.roots([bent / size, 0.2, size])]
    assert min(roots) > size / (0.2 - 8 * bent)
    assert outside == [math.inf, math.inf]
    assert min(abs(z) for z in np.roots([bent / size, 1 - 0.668, size])) < inside < 4 * size


def test_the_discs_of_a_count_reach_from_corner_to_corner_and_no_farther(node):
    # s + 3 has a root within 4 and more: sixteen chords of half a polygon decide all. Corners
    # are rounded, by their size and not by a chord's, so discs are larger by 1e-15 of it.
    radii = (1, 4, 1e6, 1e-6)
    rows = [["s"], ["#", 3, 0, 0], ["+", 0, 1], ["#", 0, 0, 0]]
    part = {"tape": rows, "value": 2, "slope": 3, "growth": [3], "divisors": []}
    keys = [node.keep(f"chords({json.dumps(part)}, {radius})") for radius in radii]
    node.run()
    for key, radius, count in zip(keys, radii, (0, 1, 1, 0), strict=True):
        assert node.values[key]["count"] == count
        discs = [(complex(x, y), r) for x, y, r, *_ in node.values[key]["discs"][1:] if r]
        corners = [radius * cmath.exp(1j * math.pi * k / 16) for k in range(17)]
        # The last chord comes first.
        for (centre, r), ends in zip(discs[::-1], pairwise(corners), strict=True):
            assert all(0.7e-15 * radius < r - abs(end - centre) < 1e-12 * radius for end in ends)


def test_what_both_ends_of_every_chord_are_unsure_of_adds_up_to_less_than_half_a_root(node):
    # s itself turns by pi about half a polygon, on 16 chords: 16 (2 r + 4e-5) is below 1/2 for r < 0.015605.
    keys = [node.keep(f"unsure({radius})") for radius in (0.0, 0.0156, 0.01561)]
    node.run()
    assert [node.values[key] for key in keys] == [1, 1, -1]


def test_a_window_with_a_pole_of_a_wavenumber_is_not_counted(node):
    # s + 3 in a law that divides by s + 2: within 1 there is no root, within 4 nothing is said.
    rows = [["s"], ["#", 3, 0, 0], ["+", 0, 1], ["#", 0, 0, 0], ["#", 2, 0, 0], ["+", 0, 4]]
    part = {"tape": rows, "value": 2, "slope": 3, "growth": [3], "divisors": [5]}
    keys = [node.keep(f"chords({json.dumps(part)}, {radius}).count") for radius in (1, 1.99, 2, 4)]
    node.run()
    assert [node.values[key] for key in keys] == [0, 0, -1, -1]


def test_numbers_that_are_no_doubles_have_a_radius_that_reaches_them():
    # 2^53 + 1 lies between the doubles 2^53 and 2^53 + 2, as far from both as a number can be.
    (tf,) = pipeline.derive_all(pipeline.loads(BETWEEN))
    rows = tape_of(tf, {})[0]["poles"][0]["tape"]
    _, x, _, radius = max(row for row in rows if row[0] == "#")
    assert abs(2**53 + 1 - int(x)) <= radius <= 4


def test_functions_whose_parameters_are_fixed_are_refused_with_a_reason():
    (tf,) = derived("wedge")[1]
    assert "parameters are fixed" in tape_of(tf, {p.name: p.name for p in tf.parameters})[0]["refused"]


# ------------------------------------------------------------------------------------------- arithmetic


def test_discs_hold_what_their_members_become(node):
    draw = random.Random(7)
    operations = {
        "sum": lambda a, b: a + b,
        "product": lambda a, b: a * b,
        "inverse": lambda a, _: 1 / a,
        "root": lambda a, _: a.sqrt(),
        "exponent": lambda a, _: a.exp(),
    }
    cases, wrong, known = [], [], 0
    for name in list(operations) * 300:
        size = 10.0 ** draw.uniform(-6, 2 if name == "exponent" else 6)
        centres = [complex(draw.gauss(0, size), draw.gauss(0, size)) for _ in range(2)]
        radii = [draw.choice((0.0, 1e-15, 1e-6, 0.1, 0.7)) * abs(c) for c in centres]
        cases.append((name, [[c.real, c.imag, r] for c, r in zip(centres, radii, strict=True)]))
    key = node.keep(f"{json.dumps(cases)}.map(([name, discs]) => computed(name, discs))")
    node.run()
    with ctx.workprec(200):
        for (name, given), (x, y, r) in zip(cases, node.values[key], strict=True):
            # In the directions of the centre, where a disc is nearest to 0 and farthest, and across.
            ways = [
                [c + c / abs(c) * k * d[2] for k in (0, 1, acb(0, 1), -1)]
                for d in given
                for c in [acb(*d[:2])]
            ]
            values = [operations[name](a, b) for a in ways[0] for b in ways[1]]
            signs = (1, -1) if name == "root" else (1,)  # the branch that is continuous
            off = [min(float(abs(v * k - acb(x, y)).upper()) for k in signs) for v in values]
            known += r is not None  # in JSON infinity is null
            if r is not None and max(off) > r * (1 + 1e-15):
                wrong.append((name, given, x, y, r))
    assert not wrong, wrong[:3]
    assert known > 0.95 * len(cases)


def errors(node, exponents, angles):
    """Return the relative errors of exp, and the errors of cos and sin, over 2^-50."""
    for name, values in (("exponents", exponents), ("angles", angles)):
        values.tofile(node.folder / f"{name}.bin")
    node.keep("evaluated(readFileSync, writeFileSync)")
    node.lines.insert(0, 'import { readFileSync } from "node:fs";')
    node.run()
    exp, cos, sin = (np.fromfile(node.folder / f"{name}.bin") for name in ("exp", "cos", "sin"))
    # 64 bits of mantissa: what libm does there errs by 2^-63.
    x, z = exponents.astype(np.longdouble), angles.astype(np.longdouble)
    wrong = (exp / np.exp(x) - 1, cos - np.cos(z), sin - np.sin(z))
    return [float(np.max(np.abs(e))) * 2.0**50 for e in wrong]


def points(count):
    """Return exponents and angles: anywhere, where reduction is hardest, and small ones."""
    draw = np.random.default_rng(1)
    small = draw.choice([-1.0, 1.0], count) * 10.0 ** draw.uniform(-12, 2, count)
    sets = []
    for limit, step in ((700, np.log(2) / 2), (1e6, np.pi / 2)):
        near = (
            step
            * np.round(draw.uniform(-limit, limit, count) / step)
            * (1 + 1e-11 * draw.standard_normal(count))
        )
        sets.append(np.concatenate([draw.uniform(-limit, limit, count), near[abs(near) < limit], small]))
    return sets


def test_exp_cos_and_sin_keep_their_bounds_at_thirty_thousand_points(node):
    assert max(errors(node, *points(10_000))) < 1.0


@pytest.mark.slow
def test_exp_cos_and_sin_keep_their_bounds_at_ten_million_points(node):
    assert max(errors(node, *points(3_400_000))) < 1.0


def test_a_page_locates_the_roots_of_a_function_once(monkeypatch):
    model, calls = pipeline.load(ROOT / "symflex/templates/two_mass.toml"), []

    def counted(*given, **options):
        calls.append(given)
        return locate(*given, **options)

    monkeypatch.setattr("symflex.live.tape.locate", counted)
    monkeypatch.setattr("symflex.roots.locate.locate", counted)
    page = live_page([(model, [("X_tip", "F")])], Silent())
    assert (len(calls), "X_tip/F" in page) == (1, True)
