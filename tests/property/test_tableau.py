"""The tableau that judges random networks agrees with derivations by hand; the networks are well posed."""

import contextlib
import tomllib

import numpy as np
import pytest
import sympy
from hypothesis import given, settings

from tests.independent import eppinger1988
from tests.property.networks import networks, passive_networks, reciprocal_networks, to_toml
from tests.property.tableau import respond
from tests.random_models import BLOCKS, ELEMENTS, GROUND, Element, Input, Network, Parameter, Term

POINTS = (0.4 + 1.3j, 1.7 - 0.6j, 0.05 + 2.9j)


def parameters(**tenths):
    return {name: Parameter(name, f"{value / 10}") for name, value in tenths.items()}


def element(kind, name, ports, values, source=()):
    ports = {key: (nodes,) if isinstance(nodes, str) else nodes for key, nodes in ports.items()}
    return Element(kind, name, tuple(ports.items()), tuple(values.items()), source)


def value_of(expr, values, at):
    numbers = {name: sympy.Rational(p.number) for name, p in values.items()}
    return complex(expr.subs(numbers).subs("s", at))


def assert_agrees(network, output, expr, values):
    for at in POINTS:
        expected = value_of(expr, values, at)
        assert abs(respond(network, output, "F", at).value - expected) < 1e-13 * abs(expected)


def lumped_beam():
    p = parameters(m_1=31, m_2=7, J=4, c=9, h=23, EI=52, l=13)
    network = Network(
        coordinates=tuple(
            (f"{node}.{axis}", domain)
            for node in ("act", "joint", "tip")
            for axis, domain in (("y", "translation"), ("theta", "rotation"))
        ),
        elements=(
            element("mass", "actuator", {"at": "act"}, {"m": p["m_1"]}),
            element("slider", "guide", {"at": "act"}, {}),
            element("massless_beam", "beam", {"between": ("act", "joint")}, {"EI": p["EI"], "l": p["l"]}),
            element("rigid_body", "body", {"at": "joint"}, {"m": p["m_2"], "J": p["J"], "cg": p["c"]}),
            element("rigid_link", "overhang", {"between": ("joint", "tip")}, {"length": p["h"]}),
        ),
        inputs=(Input("F", "force", ("act",)),),
        outputs=(("x_act", (Term("act.y"),)), ("x_tip", (Term("tip.y"),))),
    )
    return network, p


def test_the_tableau_of_the_lumped_beam_agrees_with_its_energies():
    network, values = lumped_beam()
    for output in ("x_act", "x_tip"):
        assert_agrees(network, output, eppinger1988.lumped_bending_beam(output), values)


def test_the_tableau_of_the_flexible_base_agrees_with_its_energies():
    p = parameters(m=31, m_base=77, k_base=52, b_base=3, b=4)
    network = Network(
        coordinates=(("x_tip", "translation"), ("x_base", "translation")),
        elements=(
            element("mass", "carriage", {"at": "x_tip"}, {"m": p["m"]}),
            element("mass", "base", {"at": "x_base"}, {"m": p["m_base"]}),
            element("damper", "friction", {"between": ("x_tip", "x_base")}, {"b": p["b"]}),
            element("damper", "loss", {"between": ("x_base", GROUND)}, {"b": p["b_base"]}),
            element("spring", "foundation", {"between": ("x_base", GROUND)}, {"k": p["k_base"]}),
        ),
        inputs=(Input("F", "force", ("x_tip", "x_base")),),
        outputs=(
            ("tip", (Term("x_tip"),)),
            ("motor", (Term("x_tip"), Term("x_base", -1))),
            ("base", (Term("x_base"),)),
        ),
    )
    for output in ("tip", "motor", "base"):
        assert_agrees(network, output, eppinger1988.base_flexure(output), p)


def test_the_tableau_of_the_rigid_body_agrees_with_the_printed_formula():
    p = parameters(
        m_eff=31, b_eff=7, r=4, L=3, R=12, k_amp=50, k_preamp=9, k_tau=6, k_current=2, k_tach=3, k_bemf=5
    )
    network = Network(
        coordinates=(("terminal", "electrical"), ("shaft", "rotation"), ("x_tip", "translation")),
        elements=(
            element("voltage_source", "amplifier", {"at": "terminal"}, {}, (Term("v_m"),)),
            element(
                "dc_motor",
                "motor",
                {"terminals": ("terminal", GROUND), "shaft": "shaft"},
                {"L": p["L"], "R": p["R"], "k_t": p["k_tau"], "k_e": p["k_bemf"]},
            ),
            element("transformer", "screw", {"from": "shaft", "to": "x_tip"}, {"ratio": p["r"]}),
            element("mass", "axis", {"at": "x_tip"}, {"m": p["m_eff"]}),
            element("damper", "friction", {"between": ("x_tip", GROUND)}, {"b": p["b_eff"]}),
        ),
        inputs=(Input("F"),),
        outputs=(("V_tip", (Term("x_tip", power=1),)),),
        signals=(
            ("e_1", (Term("F", 1, (p["k_preamp"],)), Term("shaft", -1, (p["k_preamp"], p["k_tach"]), 1))),
            ("v_m", (Term("e_1", 1, (p["k_amp"],)), Term("motor.i", -1, (p["k_amp"], p["k_current"])))),
        ),
    )
    assert_agrees(network, "V_tip", eppinger1988.printed_rigid_body(), p)


def responds(network, at):
    with contextlib.suppress(np.linalg.LinAlgError):
        return respond(network, network.outputs[0][0], network.inputs[0].name, at) is not None
    return False


@pytest.mark.slow
def test_random_networks_hold_every_element_and_block_and_respond_somewhere():
    """A signal loop may have a pole at one point, but no network is singular at all of them."""
    kinds = set()

    @given(networks())
    @settings(max_examples=250)
    def draw(network):
        kinds.update(network.kinds)
        entries = tomllib.loads(to_toml(network))
        assert entries["inputs"]
        assert entries["outputs"]
        assert any(responds(network, at) for at in POINTS)

    draw()
    assert {*ELEMENTS, *BLOCKS} <= kinds


@given(passive_networks())
@settings(max_examples=60)
@pytest.mark.slow
def test_the_driving_point_of_a_passive_network_is_positive_real(network):
    for at in POINTS:
        response = respond(network, "Y_1", "U_1", at)
        is_effort = network.inputs[0].key in ("current", "flow")
        immittance = response.value * (1 if is_effort else at)
        assert immittance.real >= -1e-12 * response.scale


@given(reciprocal_networks())
@settings(max_examples=60)
@pytest.mark.slow
def test_the_tableau_of_a_passive_network_is_reciprocal(network):
    for at in POINTS:
        there, back = respond(network, "Y_2", "U_1", at), respond(network, "Y_1", "U_2", at)
        assert abs(there.value - back.value) <= 1e-11 * max(there.scale, back.scale)
