"""Every block is the transfer function its summary states."""

import pytest
import sympy

import symflex
from symflex.library import ParameterPort
from symflex.library.elements import ELEMENTS, by_unit, lumped
from symflex.library.elements.element import Port

s, p, q, u, v = sympy.symbols("s p q u v")
HEADER = "symflex = 1\n[parameters]\np = {}\nq = {}\nu = {}\nv = {}\n[blocks]\n"
ENDING = '\n[inputs]\nU = {}\n[outputs]\nX = "G*U"\n'

BLOCKS = {
    'type = "resonance", omega_p = "p", zeta_p = "u", omega_z = "q", zeta_z = "v"': (p / q) ** 2
    * (s**2 + 2 * v * q * s + q**2)
    / (s**2 + 2 * u * p * s + p**2),
    'type = "notch", omega = "p", zeta_p = "u", zeta_z = "v"': (s**2 + 2 * v * p * s + p**2)
    / (s**2 + 2 * u * p * s + p**2),
    'type = "notch", omega = "p", zeta_p = "u"': (s**2 + p**2) / (s**2 + 2 * u * p * s + p**2),
    'type = "low_pass", omega = "p", zeta = "u", k = "v"': v * p**2 / (s**2 + 2 * u * p * s + p**2),
    'type = "tf", num = "p*s + 1", den = "q*s^2 + u"': (p * s + 1) / (q * s**2 + u),
    'type = "tf", num = ["p", 0, 1], den = ["q", "u"]': (p * s**2 + 1) / (q * s + u),
    'type = "tf", num = [1, 1], den = [1, -1, 1, 0]': (s + 1) / (s**3 - s**2 + s),
    'type = "tf", num = "p"': p,
    'type = "tf", num = [["p", 1]], den = [[1], ["q"]]': (p * s + 1) / (s + q),
    'type = "ss", A = [[0, 1], ["-p", "-q"]], B = [[0], [1]], C = [["u", 1]], D = [["v"]]': (u + s)
    / (s**2 + q * s + p)
    + v,
    'type = "ss", A = ["p"], B = "q", C = "u"': q * u / (s - p),
    'type = "integrator"': 1 / s,
    'type = "integrator", k = "p"': p / s,
    'type = "lead_lag", T_1 = "p", T_2 = "q"': (1 + p * s) / (1 + q * s),
    'type = "lead_lag", k = "u", T_1 = "p", T_2 = "q"': u * (1 + p * s) / (1 + q * s),
    'type = "pid", k_p = "p"': p,
    'type = "pid", k_p = "p", k_i = "q", k_d = "u"': p + q / s + u * s,
    'type = "pid", k_p = "p", k_i = "q", k_d = "u", T_f = "v"': p + q / s + u * s / (1 + v * s),
}


def quotient(text):
    G = symflex.loads(text).transfer_function("X", "U")
    return (G.num / G.den).xreplace({x: sympy.Symbol(x.name) for x in (G.num / G.den).free_symbols})


def test_a_block_is_its_formula():
    for block, formula in BLOCKS.items():
        found = quotient(f"{HEADER}G = {{ {block} }}{ENDING}")
        assert sympy.cancel(found - formula) == 0, block


def test_a_resonance_has_unit_gain_at_low_frequency():
    block = 'type = "resonance", omega_p = "p", zeta_p = "u", omega_z = "q", zeta_z = "v"'
    assert quotient(f"{HEADER}G = {{ {block} }}{ENDING}").subs(s, 0) == 1


def test_a_block_may_use_one_declared_after_it():
    text = f'{HEADER}G = {{ type = "tf", num = "H" }}\nH = {{ type = "integrator" }}{ENDING}'
    assert sympy.cancel(quotient(text) - 1 / s) == 0


def test_two_types_of_one_value_in_the_same_unit_are_refused():
    class Inerter(lumped.Branch):
        type_name = "inerter"
        ports = (Port("between", 2, "translation", "the two ends"),)
        parameters = (ParameterPort("B", "kg", "an inertance"),)

    with pytest.raises(ValueError, match="'mass' and 'inerter' both have one value in kg"):
        by_unit([*ELEMENTS.values(), Inerter()])
