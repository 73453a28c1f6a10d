"""What the live page proves, in Node: its discs, and its roots and counts against those in balls."""

from __future__ import annotations

import json
import math
import random
from fractions import Fraction
from importlib import resources

import pytest

from symflex.live.tape import tape_of
from symflex.roots import Band, Everything
from symflex.roots.locate import locate
from symflex.transfer import bind
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
        const { poles, zeros, certified, reach, stability } = state;
        const ends = { poles: String(reach.poles), zeros: String(reach.zeros) };
        return { poles, zeros, certified, stability, reach: ends };
    });
};
"""


@pytest.fixture
def node(tmp_path):
    (tmp_path / "live.mjs").write_text(KERNEL + WALK, encoding="utf-8")
    node = Node(tmp_path)
    node.lines.insert(0, 'import { walked } from "./live.mjs";')
    return node


def walks(node, name, count, decades):
    """Ask for random positions of all sliders, one after another; return functions, positions and keys."""
    draw, rows = random.Random(name), []
    for tf in derived(name)[1]:
        start = {p.name: float(p.value.nearly) for p in tf.parameters}
        positions = [
            {k: v * 10 ** draw.uniform(-decades, decades) for k, v in start.items()} for _ in range(count)
        ]
        given = map(json.dumps, (tape_of(tf, {name: name for name in start}), start, positions))
        rows.append((tf, positions, node.keep(f"walked({', '.join(given)})")))
    return rows


def refuted(tf, values, state):
    """Yield what balls say against a state: proved roots that are none, and counts that are wrong."""
    bound = bind(tf, {name: Fraction(value) for name, value in values.items()})
    for kind in ("poles", "zeros"):
        proved = [z for z in state[kind] if z["proved"] and (z["re"] or z["im"])]
        reach = float(state["reach"][kind].replace("Infinity", "inf"))
        end = reach if math.isfinite(reach) else 1.0
        region = Band(Fraction(0), Fraction(end / (2 * math.pi))) if tf.is_distributed else Everything()
        located = locate(bound, region, 25, with_zeros=kind == "zeros")
        points = [complex(r) for r in getattr(located, kind)]
        for z in proved:
            centre = complex(z["re"], z["im"])
            near = [p for p in points if abs(p - centre) <= z["radius"] + 1e-15 * abs(centre)]
            if len(near) != 1 or z["radius"] > 1e-8 * abs(centre):
                yield tf.name, kind, z, near
        if state["certified"][kind] and located.certificate.certified:
            count = sum(z["multiplicity"] * (1 + (z["im"] > 0)) for z in state[kind])
            if count != sum(r.multiplicity for r in getattr(located, kind) if abs(complex(r)) < reach):
                yield tf.name, kind, count, points


def check(node, rows, least):
    """Confirm all that is proved; at least such a share of the positions is."""
    node.run()
    for tf, positions, key in rows:
        states = node.values[key]
        wrong = [x for both in zip(positions, states, strict=True) for x in refuted(tf, *both)]
        assert not wrong, wrong[:3]
        assert sum(all(s["certified"].values()) for s in states) >= least * len(states), tf.name


def test_roots_of_a_lumped_and_of_a_distributed_model_are_proved_and_right_wherever_sliders_are(node):
    check(node, [row for name in ("two_mass", "rod_tip_mass") for row in walks(node, name, 3, 1.0)], 1.0)
