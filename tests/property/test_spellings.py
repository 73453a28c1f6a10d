"""One specification has the same answers in all its spellings."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from random import Random

import pytest

from tests import random_models as made
from tests.tools.spellings import PHYSICS, compared

DERIVATIONS = Path(__file__).parents[2] / "derivations"
CLASSICS = (
    "clamped_free",
    "kelvin_voigt_cantilever",
    "one_link_arm",
    "quarter_car",
    "rod_tip_mass",
    "shaft_discs",
)
"""One of each kind: other ends of the same beam are no other spelling, and a Timoshenko beam is below."""
BEAM = """symflex = 1
[parameters]
E = "70 GPa"
nu = 0.33
[definitions]
kappa = "10*(1 + nu)/(12 + 11*nu)"
[elements.arm]
type = "beam"
theory = "timoshenko"
between = ["ground", "tip"]
rho = "9 kg/m^3"
l = "1 m"
VALUES
[inputs]
F = { force = "tip" }
[outputs]
Y = "tip"
"""
SECTIONS = (
    'E = "E", G = "E/(2*(1 + nu))", kappa = "kappa", I = "1e-8 m^4", A = "1e-4 m^2"',
    'E = "70 GPa", G = "26 GPa", kappa = "5/6", I = "1e-8 m^4", A = "1e-4 m^2"',
)


def beam(values: str) -> str:
    return BEAM.replace("VALUES", values.replace(", ", "\n"))


def members(seed: int) -> str:
    """Return a member clamped at one end, with lumped elements at the other."""
    random, kind = Random(seed), made.CARRIED[seed % 3]
    parts = [made._member(random, kind, (made.GROUND, "n"))]
    parts += [made._lump(random, kind, "n") for _ in range(random.randint(0, 2))]
    key, domain = ("torque", "rotation") if kind == "shaft" else ("force", "translation")
    named = tuple(replace(p, name=f"part_{i}") for i, p in enumerate(parts))
    source, output = made.Input("F", key, ("n",)), ("X", (made.Term("n"),))
    return made.to_toml(made.Network((("n", domain),), named, (source,), (output,)))


def differences(texts, **options):
    found = {name: {k: v for k, v in compared(t, **options).items() if v} for name, t in texts}
    return {name: told for name, told in found.items() if told}


def test_a_network_has_the_same_answers_in_all_spellings():
    assert not differences([("1", made.to_toml(made.networks(Random(1))))])


@pytest.mark.slow
def test_many_networks_have_the_same_answers_in_all_spellings():
    assert not differences([(n, made.to_toml(made.networks(Random(n)))) for n in range(8)])


@pytest.mark.slow
def test_members_have_the_same_values_in_all_spellings():
    texts = [(n, members(n)) for n in range(1, 10)]
    texts += [(values, beam(values)) for values in SECTIONS]
    assert not differences(texts, asks_roots=False)


@pytest.mark.slow
def test_worked_models_have_the_same_values_in_all_spellings():
    texts = [(name, (DERIVATIONS / "classics" / f"{name}.toml").read_text("utf-8")) for name in CLASSICS]
    assert not differences(texts, asks_roots=False)


@pytest.mark.slow
def test_a_beam_has_the_same_roots_and_verdict_in_all_spellings():
    assert not differences([(SECTIONS[0], beam(SECTIONS[0]))])


BY_OTHER_ELEMENTS = {
    "classics": (
        "free_free kelvin_voigt_cantilever one_link_arm pinned_pinned quarter_car rod_tip_mass shaft_discs"
    ),
    "frames": "l_frame portal_frame two_link_arm",
    "eppinger1988": "lumped_bending_beam robot_axis six_mass two_mass",
    "eppinger1988/loops": "base_flexure_position sliding_free_beam_force two_mass_force",
    "../symflex/templates": "motor_loop servo",
}
SLIDES = {"free_free", "robot_axis", "sliding_free_beam_force"}
"""Beams that may slide; a frame in their place may move along x, too."""


@pytest.mark.slow
def test_models_of_other_elements_have_the_same_certificates_verdicts_and_words():
    count, found = 0, {}
    for folder, names in BY_OTHER_ELEMENTS.items():
        for name in names.split():
            ways = {k: v for k, v in PHYSICS.items() if k != "frames" or name not in SLIDES}
            told = compared((DERIVATIONS / folder / f"{name}.toml").read_text("utf-8"), ways)
            count, found = count + len(told), found | {(name, k): v for k, v in told.items() if v}
    assert not found
    assert count >= 60
