"""Frames with loss factors against dense dynamic stiffness in complex numbers, and a chain against numpy."""

from __future__ import annotations

import numpy as np
import pytest
from mpmath import mp, mpc

import symflex

from .plane_frames import Member, clamped, freedoms, pinned, response, stiffness

FRAME = """symflex = 1
[parameters]
E = "70 GPa"
l = "300 mm"
m = "250 g"
a = 0.01
b = "4 %"
[elements]
lower = { type = "frame", between = ["ground", "k"], E = "E", I = "8e-10 m^4", A = "1.2 cm^2", rho = "2700 kg/m^3", l = "400 mm", angle = "35 deg", eta_s = "a" }
upper = { type = "frame", between = ["k", "t"], E = "E", I = "8e-10 m^4", A = "1.2 cm^2", rho = "2700 kg/m^3", l = "l", angle = "100 deg", eta_s = "b" }
tip = { type = "rigid_body", at = "t", m = "m" }
[inputs]
F = { force = "t.x" }
[outputs]
X = "t.x"
"""  # noqa: E501
GIVEN = {"E": "70e9", "l": "0.3", "m": "0.25", "a": "0.01", "b": "0.04"}
PROOF = 1e-12


def frame_matrix(s, *, held=(), **changed):
    """Return the dynamic stiffness of the frame without what is held; parameters may be changed."""
    given = {name: changed.get(name, mp.mpf(value)) for name, value in GIVEN.items()}
    rest = {"I": mp.mpf("8e-10"), "A": mp.mpf("1.2e-4"), "rho": mp.mpf(2700)}
    members = [
        Member("g", "k", E=given["E"] * mpc(1, given["a"]), l=mp.mpf("0.4"), angle=mp.radians(35), **rest),
        Member("k", "t", E=given["E"] * mpc(1, given["b"]), l=given["l"], angle=mp.radians(100), **rest),
    ]
    added = {(("t", c), ("t", c)): given["m"] * s**2 for c in ("x", "y")}
    whole, away = stiffness(members, s, added), {*clamped("g"), *held}
    kept = [i for i, freedom in enumerate(freedoms(members)) if freedom not in away]
    return mp.matrix([[whole[i, j] for j in kept] for i in kept])


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["pole", "zero"])
def test_roots_of_a_frame_with_two_loss_factors_and_their_slopes_are_those_of_its_dense_stiffness(kind):
    held = [("t", "x")] if kind == "zero" else []
    bound = symflex.loads(FRAME).nested("X", "F").bind()
    with mp.workdps(40):
        size = mp.mpf(10) ** -12
        for moved in bound.sensitivities(modes=2):
            if moved.kind != kind:
                continue
            root = mpc(moved.root.value)

            def determinant(s, held=held, **changed):
                return mp.det(frame_matrix(s, held=held, **changed))

            along = determinant(root * (1 + size)) - determinant(root * (1 - size))
            slope = along / (2 * root * size)
            assert abs(determinant(root) / slope) < PROOF * abs(root)
            value = mp.mpf(GIVEN[moved.parameter])
            ends = (determinant(root, **{moved.parameter: value * (1 + e)}) for e in (size, -size))
            change = (next(ends) - next(ends)) / (2 * value * size)
            assert abs(mpc(moved.derivative) + change / slope) < PROOF * abs(change / slope)


@pytest.mark.slow
def test_a_mode_shape_with_loss_factors_solves_the_dense_equations():
    shape = symflex.loads(FRAME).nested("X", "F").bind().mode_shape(2)
    moved = [complex(shape[f"{node}.{c}"]) for node in ("k", "t") for c in ("x", "y", "theta")]
    with mp.workdps(40):
        matrix = frame_matrix(mpc(shape.pole.value))
        left = matrix * mp.matrix(moved)
        sizes = [sum(abs(matrix[i, j] * moved[j]) for j in range(6)) for i in range(6)]
        assert all(abs(left[i]) < PROOF * sizes[i] for i in range(6))
    assert abs(np.imag(moved)).max() > 1e-4  # dampings differ, so not all moves in phase


def test_sensitivities_of_a_chain_with_loss_factors_follow_from_its_eigenvalues():
    n, k, eta = 12, 50.0, 0.2
    ends = ['"ground"', *(f'"x{i}"' for i in range(n))]
    springs = "\n".join(
        f's{i} = {{ type = "spring", between = [{ends[i]}, {ends[i + 1]}], k = "k", eta_s = "eta" }}\n'
        f'm{i} = {{ type = "mass", at = "x{i}", m = "1 kg" }}'
        for i in range(n)
    )
    text = (
        f'symflex = 1\nparameters = {{ k = "{k} N/m", eta = {eta} }}\n[elements]\n{springs}\n'
        f'[inputs]\nF = {{ force = "x{n - 1}" }}\n[outputs]\nX = "x{n - 1}"\n'
    )
    moved = [
        m for m in symflex.loads(text).transfer_function("X", "F").bind().sensitivities() if m.kind == "pole"
    ]
    # Fixed at one end, free at the other, masses of 1 kg: omega_r = 2 sqrt(k) sin((2 r - 1) pi/(4 n + 2)).
    for r in range(1, n + 1):
        omega = 2 * np.sqrt(k) * np.sin((2 * r - 1) * np.pi / (4 * n + 2))
        by_name = {m.parameter: m for m in moved if abs(m.root.frequency_hz * 2 * np.pi / omega - 1) < 1e-9}
        assert float(by_name["k"].frequency) == pytest.approx(omega / (4 * np.pi * k), rel=PROOF)
        assert float(by_name["eta"].loss_factor) == pytest.approx(1, rel=PROOF)
        assert abs(float(by_name["k"].loss_factor)) < PROOF
        assert abs(float(by_name["eta"].frequency)) < PROOF


GANTRY = """symflex = 1
parameters = { K = "2e5 N/m", T_d = "8 ms", T_f = "0.5 ms", T_t = "0.3 ms", eta = "20 us", h = "80 cm" }
definitions.C = "K*(1 + T_d*s)/(1 + T_f*s)"
[elements]
left  = { type = "frame", between = ["a", "p"], E = "69 GPa", I = "4.2 cm^4", A = "6 cm^2", rho = "2.7 g/cm^3", eta = "eta", l = "h", angle = "90 deg" }
right = { type = "frame", between = ["ground", "q"], E = "69 GPa", I = "4.2 cm^4", A = "6 cm^2", rho = "2.7 g/cm^3", eta = "eta", l = "h", angle = "90 deg" }
beam  = { type = "frame", between = ["p", "q"], E = "69 GPa", I = "4.2 cm^4", A = "6 cm^2", rho = "2.7 g/cm^3", eta = "eta", l = "1.2 m" }
rail  = { type = "pin", at = "a" }
head  = { type = "rigid_body", at = "p", m = "6 kg" }
motor = { type = "force_source", at = "p.x", f = "u" }
[signals]
u = "C*exp(-s*T_t)*(r - p.x)"
[inputs]
r = { unit = "m" }
[outputs]
x = "p.x"
"""  # noqa: E501


def gantry_loop(s):
    """Return the loop gain of the gantry over K, with the head's mass beside its dense stiffness."""
    with mp.workdps(40):
        s = mpc(s)
        E = mp.mpf("69e9") * (1 + mp.mpf("20e-6") * s)
        rest = {"I": mp.mpf("4.2e-8"), "A": mp.mpf("6e-4"), "rho": mp.mpf(2700)}
        posts = [Member(*ends, E=E, l=mp.mpf("0.8"), angle=mp.pi / 2, **rest) for ends in ("ap", "gq")]
        members = [*posts, Member("p", "q", E=E, l=mp.mpf("1.2"), **rest)]
        added = {(("p", c), ("p", c)): 6 * s**2 for c in ("x", "y")}
        moved = response(members, {*clamped("g"), *pinned("a")}, ("p", "x"), ("p", "x"), s, added)
        controller = (1 + mp.mpf("0.008") * s) / (1 + mp.mpf("0.0005") * s) * mp.exp(-s * mp.mpf("0.0003"))
        return complex(controller * moved)


@pytest.mark.slow
def test_a_gain_of_a_frame_with_delay_becomes_unstable_where_the_dense_loop_gain_is_minus_one():
    stable = symflex.loads(GANTRY).stability("K").proved
    (boundary,) = stable.boundaries
    gain, omega = float(boundary.gain.mid()), float(boundary.crossings[0].frequencies[0].mid())
    assert gain * gantry_loop(1j * omega) == pytest.approx(-1, rel=1e-9)
    assert [i.poles.right for i in stable.intervals] == [0, 2]
    (margin,) = stable.phase_margins
    at = 2e5 * gantry_loop(1j * float(margin.frequency.mid()))
    assert abs(at) == pytest.approx(1, rel=1e-9)
    assert np.angle(-at) == pytest.approx(float(margin.angle.mid()), rel=1e-9)
