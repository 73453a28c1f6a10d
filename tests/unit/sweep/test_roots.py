import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf

import symflex
from symflex import pipeline
from symflex.errors import UsageError
from symflex.roots import Modes
from symflex.sweep.follow import NameOrigin
from symflex.sweep.points import PointStatus, RootSolver, RootStatus
from symflex.transfer.bind import read_values
from tests.unit.analysis.systems import words
from tests.unit.sweep.models import ALGEBRAIC, BEAM, SLIDING_FREE, TWO_RESONANCES, oscillator


def test_poles_of_an_oscillator_lie_in_their_discs():
    sweep = oscillator().sweep({"k": "1:100:log:7", "b": [0.1, 0.7]})
    assert sweep["re"].shape == (7, 2, 1)
    assert sweep.is_certified
    with mp.workdps(40):
        for i, k in enumerate(sweep["k"]):
            for j, b in enumerate(("0.1", "0.7")):
                exact = mpmath.mpc(-mpf(b) / 2, mpmath.sqrt(mpf(repr(float(k))) - mpf(b) ** 2 / 4))
                error = abs(mpmath.mpc(sweep["re"][i, j, 0], sweep["im"][i, j, 0]) - exact)
                assert error <= sweep["radius"][i, j, 0] <= 2e-16 * float(abs(exact))


def wavenumbers(count):
    """x of the sliding-free beam: tan x + tanh x = 0."""
    equation = lambda x: mpmath.sin(x) * mpmath.cosh(x) + mpmath.cos(x) * mpmath.sinh(x)  # noqa: E731
    return [mpmath.findroot(equation, (n - mpf("0.25")) * mpmath.pi) for n in range(1, count + 1)]


def test_poles_of_a_beam_lie_in_their_discs():
    sweep = symflex.loads(SLIDING_FREE).sweep({"E": "+-5%", "l": "0.5:2"}, draws=12, modes=6)
    assert sweep.is_certified
    assert sweep["status"].shape == (12, 6)
    assert (sweep["re"] == 0).all()
    # The function of the wavenumber is free of parameters.
    assert set(sweep["link"].ravel()) == {NameOrigin.START, NameOrigin.SIMILAR}
    with mp.workdps(40):
        known = wavenumbers(6)
        for i in range(12):
            modulus, length = (mpf(repr(float(sweep[name][i]))) for name in ("E", "l"))
            unit = mpmath.sqrt(modulus * mpf("4e-9") / (7850 * mpf("480e-6"))) / length**2
            for k, x in enumerate(known):
                assert abs(sweep["im"][i, k] - unit * x**2) <= sweep["radius"][i, k]
                assert sweep["radius"][i, k] < 1e-15 * unit * x**2


def tip_mass_residual(values, omega):
    """The characteristic equation of a sliding beam with a mass at its tip, from the textbook solution."""
    stiffness, mass, length, tip = (mpf(str(values[name])) for name in ("EI", "rhoA", "l", "m"))
    beta = mpmath.sqrt(omega * mpmath.sqrt(mass / stiffness))
    x = beta * length
    # w = a cos(bx) + c cosh(bx): w'(0) = 0, w'''(0) = 0; w''(l) = 0; E I w'''(l) = -m omega^2 w(l).
    rows = mpmath.matrix(
        [
            [-mpmath.cos(x), mpmath.cosh(x)],
            [
                stiffness * beta**3 * mpmath.sin(x) + tip * omega**2 * mpmath.cos(x),
                stiffness * beta**3 * mpmath.sinh(x) + tip * omega**2 * mpmath.cosh(x),
            ],
        ]
    )
    return mpmath.det(rows) / (mpmath.cosh(x) * stiffness * beta**3)


def test_poles_change_sign_of_the_textbook_equation():
    sweep = symflex.loads(BEAM).sweep({"m": [0.5, 1, 2]}, modes=4)
    assert sweep.is_certified
    known = {"EI": "800", "rhoA": "3.768", "l": "1.086"}
    with mp.workdps(40):
        for i, m in enumerate((0.5, 1, 2)):
            for k in range(4):
                ends = [
                    tip_mass_residual({**known, "m": m}, mpf(sweep["im"][i, k]) + d)
                    for d in (-mpf(sweep["radius"][i, k]), mpf(sweep["radius"][i, k]))
                ]
                assert ends[0] * ends[1] < 0


def test_names_pass_through_a_crossing():
    sweep = symflex.loads(TWO_RESONANCES).sweep({"k_1": "1:9:lin:12"})
    moving, still = sweep["im"][:, 0], sweep["im"][:, 1]
    assert np.allclose(moving, np.sqrt(np.linspace(1, 9, 12)), rtol=1e-12)
    assert (still == 2).all()
    crossing = int(np.argmax(moving > 2))
    assert sweep["link"][crossing].tolist() == [NameOrigin.DOUBTFUL, NameOrigin.DOUBTFUL]
    assert (sweep["link"][crossing + 2 :] == NameOrigin.CLEAR).all()


def test_a_mode_that_cancels_is_absent():
    sweep = symflex.loads(TWO_RESONANCES).sweep({"k_1": [3, 3.5, 4, 4.5]})
    assert np.sum(sweep["status"], axis=1).tolist() == [2, 2, 1, 2]
    assert sweep.is_certified


def test_a_pair_that_meets_the_real_axis():
    sweep = oscillator().sweep({"b": "0.5:3.5:lin:7"})
    b = np.linspace(0.5, 3.5, 7)
    pair = b < 2
    assert sweep["multiplicity"][3].tolist() == [2, 0]
    assert np.allclose(sweep["re"][pair, 0], -b[pair] / 2)
    real = b > 2
    roots = np.sort([sweep["re"][real, 0], sweep["re"][real, 1]], axis=0)
    half = np.sqrt(b[real] ** 2 / 4 - 1)
    assert np.allclose(roots, [-b[real] / 2 - half, -b[real] / 2 + half])
    assert (sweep["im"][real] == 0).all()
    assert sweep["link"][3, 0] == NameOrigin.REAL_AXIS
    assert sweep["link"][4, 1] == NameOrigin.APPEARS


def test_a_rigid_body_is_counted_at_zero():
    sweep = oscillator().sweep({"k": [1], "b": [0, 1]})
    assert sweep["at_zero"].tolist() == [[0, 0]]
    free = symflex.loads(SLIDING_FREE).sweep({"l": [1, 2]}, modes=1)
    assert free["at_zero"].tolist() == [1, 1]  # V/F of a free mass is 1/(m s)


def test_a_point_without_a_solution_is_said_to_fail():
    sweep = symflex.loads(ALGEBRAIC).sweep({"c": [1, 0]})
    assert sweep["point_status"].tolist() == [PointStatus.FAILED, PointStatus.CERTIFIED]
    assert sweep["code"][0].startswith("SF")
    assert sweep["status"][:, 0].tolist() == [RootStatus.ABSENT, RootStatus.CERTIFIED]
    assert sweep["re"][1, 0] == -1
    assert not sweep.is_certified


def test_zeros_are_swept_likewise():
    zeros = symflex.loads(TWO_RESONANCES).sweep({"k_2": [4, 7]}, of="zeros")
    # 1/(s^2 + 1) + 1/(s^2 + k) is zero where s^2 = -(1 + k)/2.
    assert np.allclose(zeros["im"][:, 0], np.sqrt([2.5, 4.0]), rtol=1e-15)


def test_a_band_holds_what_is_in_it():
    sweep = symflex.loads(SLIDING_FREE).sweep({"l": [1, 1.1]}, band=(1, 100))
    every = symflex.loads(SLIDING_FREE).sweep({"l": [1, 1.1]}, modes=6)
    inside = every["frequency_hz"] <= 100
    assert np.sum(sweep["status"] > 0, axis=1).tolist() == np.sum(inside, axis=1).tolist()


def test_how_a_point_is_solved_does_not_show():
    """Roots scaled from a similar model, and those searched at the point itself, are the same doubles."""
    model = symflex.loads(BEAM)
    points = [{"l": length, "m": length} for length in ("0.9", "1.086", "1.3")]  # the ratio of masses stays
    names = tuple(points[0])
    known = {p.name: p for p in model.parameters}
    exact = [tuple(read_values((known[n],), {n: p[n]})[0][1] for n in names) for p in points]
    (tf,) = pipeline.derive_all(model.resolved, model.resolved.transfer_functions[:1])
    used = RootSolver(tf, names, "poles", Modes(4))
    together = [used(point) for point in exact]
    alone = [RootSolver(tf, names, "poles", Modes(4))(point) for point in exact]
    assert len({result.family for result in together}) == 1
    assert together == alone


def test_functions_of_other_ratios_are_not_similar():
    sweep = symflex.loads(BEAM).sweep({"m": [1, 2]}, modes=3)
    assert NameOrigin.SIMILAR not in set(sweep["link"].ravel())


def with_length(assumed):
    declared = f'l = {{ value = "1.086 m", assume = "{assumed}" }}'
    return symflex.loads(SLIDING_FREE.replace('l = "1.086 m"', declared))


def test_a_length_that_no_beam_has_is_refused():
    for assumed, values in (
        ("nonnegative", [0, 1]),
        ("real", [0, 1]),
        ("real", [1, -1, 2]),
        ("real", "-1:1:lin:5"),
    ):
        found = words(with_length(assumed).sweep, {"l": values}, modes=1)
        assert "UsageError" in found and "SF209" in found and " l of beam 'arm' is" in found, (
            assumed,
            values,
        )
    drawn = with_length("nonnegative").sweep  # from a range that begins at zero
    assert "SF209" in words(drawn, {"l": "0:1"}, modes=1, draws=3)


def test_a_length_is_refused_by_itself_and_not_for_what_it_was_declared():
    assert with_length("real").sweep({"l": [1, 2]}, modes=1).is_certified
    model = symflex.loads(SLIDING_FREE.replace('l = "l" }', 'l = "l - c" }').replace("[elements]", CUT))
    assert model.sweep({"c": [0, 1]}, modes=1).is_certified
    with pytest.raises(UsageError, match=r"with c = 2, l of beam 'arm' is negative"):
        model.sweep({"c": [0, 2]}, modes=1)
    assert model.sweep({"l": [3], "c": [2]}, modes=1).is_certified  # either alone says nothing


CUT = 'c = { value = "0.1 m", assume = "real" }\n[elements]'


def test_a_delay_may_vanish_and_not_be_negative():
    text = """
symflex = 1
[parameters]
T = { value = "1 s", assume = "real" }
[blocks]
D = { type = "delay", T = "T" }
[inputs]
u = {}
[outputs]
y = "D*u/(s + 1)"
"""
    model = symflex.loads(text)
    assert model.sweep({"T": [0, 1]}, modes=1).is_certified
    with pytest.raises(UsageError, match=r"SF209.*delay cannot look ahead"):
        model.sweep({"T": [-1, 1]}, modes=1)
