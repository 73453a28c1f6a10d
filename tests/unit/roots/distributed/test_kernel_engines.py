"""Engines for functions with kernels: what each accepts, that they agree, and modes by number."""

from __future__ import annotations

from fractions import Fraction

import pytest
from mpmath import findroot, mp, mpf, pi, tan, tanh

from symflex.roots import Band, Mode, Modes, Rectangle
from symflex.roots.engines import GUESS_AND_PROVE, LOSSLESS, SEARCHES
from symflex.roots.locate import locate
from tests.unit.roots.distributed_models import DELAY_LOOP, FREE, KELVIN_VOIGT, SLIDING_FREE, bound
from tests.unit.roots.stand_ins import poles_by, side

DIGITS = 40
KERNEL_ENGINES = sorted(SEARCHES)


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(DIGITS + 15):
        yield


def poles_of(text, region, engine, number=0):
    return poles_by(engine, bound(text, number), region, DIGITS)


def sliding_free(n):
    """Return omega of a mode of the sliding-free beam: s = j x^2 with tan x + tanh x = 0."""
    return findroot(lambda x: tan(x) + tanh(x), (n - mpf(1) / 4) * pi) ** 2


def agrees(root, omega):
    printed = root.decimal(DIGITS)
    return abs(mpf(printed.im) - omega) <= mpf(printed.radius) < mpf(10) ** (2 - DIGITS) * omega


@pytest.mark.parametrize("engine", KERNEL_ENGINES)
def test_every_engine_finds_the_sliding_free_beam_s_poles(engine):
    poles = [root for root in poles_of(SLIDING_FREE, Modes(3), engine) if root.im > 0]
    assert len(poles) == 3
    assert all(agrees(root, sliding_free(n)) for n, root in enumerate(poles, 1))
    assert all(root.on_imaginary_axis and root.certified for root in poles)


@pytest.mark.parametrize("engine", KERNEL_ENGINES)
def test_every_engine_finds_the_rigid_body_poles(engine):
    (zero,) = (root for root in poles_of(FREE, Modes(1), engine) if root.is_zero)
    assert zero.multiplicity == 2


@pytest.mark.parametrize("engine", KERNEL_ENGINES)
def test_every_engine_keeps_to_a_band(engine):
    # 0.89, 4.81, 11.87 Hz.
    band = Band(Fraction(1), Fraction(12))
    assert [f"{root.frequency_hz():.2f}" for root in poles_of(SLIDING_FREE, band, engine)] == [
        "4.81",
        "4.81",
        "11.88",
        "11.88",
    ]


@pytest.mark.parametrize("text", [KELVIN_VOIGT, DELAY_LOOP], ids=["loss", "delay"])
def test_what_has_losses_or_delays_is_left_to_the_next_engine(text):
    one = side(text)
    assert one.engine == GUESS_AND_PROVE
    with pytest.raises(TypeError, match=r"^not for the engine lossless$"):
        side(text, engines=(LOSSLESS,))


def test_two_hundred_modes_are_complete_and_on_the_axis():
    poles = [root for root in poles_of(SLIDING_FREE, Modes(200), "lossless") if root.im > 0]
    assert len(poles) == 200
    assert all(root.on_imaginary_axis for root in poles)
    assert all(agrees(poles[n - 1], sliding_free(n)) for n in (1, 2, 57, 199, 200))


@pytest.mark.parametrize("number", [1, 2, 3, 10, 1000, 10**6])
def test_a_mode_is_found_by_its_number(number):
    upper, lower = poles_of(SLIDING_FREE, Mode(number), "lossless")
    assert agrees(upper, sliding_free(number))
    assert lower.im < 0


def test_the_map_of_one_mode_holds_nothing_else():
    found = locate(bound(SLIDING_FREE, 0), Mode(7), 20)
    assert found.certificate.certified
    assert (len(found.poles), len(found.zeros), found.hidden) == (2, 2, ())


def test_a_mode_by_number_of_a_lossy_system_is_the_same_as_in_the_list():
    source = bound(KELVIN_VOIGT, 0)
    third = locate(source, Mode(3), 15).poles
    assert [r.decimal(12) for r in third] == [r.decimal(12) for r in locate(source, Modes(3), 15).poles[4:6]]


def test_a_mode_beyond_the_last_is_none():
    lumped = bound("symflex = 1\n[elements]\nm = { type = 'mass', at = 'x', m = '1 kg' }\n"
                   "k = { type = 'spring', between = ['x', 'ground'], k = '1 N/m' }\n"
                   "[inputs]\nF = { force = 'x' }\n[outputs]\nX = 'x'\n", 0)  # fmt: skip
    assert len(locate(lumped, Mode(1), 15).poles) == 2
    assert locate(lumped, Mode(2), 15).poles == ()


SMALL = Fraction(1, 10**6)


@pytest.mark.parametrize(
    "region",
    [
        Rectangle(-SMALL, SMALL, -SMALL, SMALL),
        Rectangle(Fraction(0), Fraction(0), Fraction(0), Fraction(0)),
        Band(Fraction(0), SMALL),
        Band(Fraction(0), Fraction(0)),
    ],
    ids=["small", "point", "narrow", "nothing"],
)
@pytest.mark.parametrize("text", [FREE, KELVIN_VOIGT], ids=["free", "loss"])
def test_a_region_about_0_holds_the_rigid_body_poles_only(text, region):
    found = locate(bound(text, 0), region, 15)
    assert found.certificate.certified
    expected = [2] if text is FREE else []
    assert [root.multiplicity for root in found.poles] == expected


@pytest.mark.slow
def test_what_lies_below_all_that_was_searched_is_not_overlooked():
    # The springs cancel only as numbers: the rod is free, and its poles at 0 are not seen in the formula.
    text = """
    symflex = 1
    [parameters]
    k_1 = { value = "8 N^2/m^2", assume = "real" }
    k_2 = { value = "2 N^2/m^2", assume = "real" }
    [elements]
    bar = { type = "rod", between = ["y", "x"], E = "1 Pa", A = "1 m^2", rho = "1 kg/m^3", l = "1 m",\
        eta = "1 s" }
    s_1 = { type = "spring", between = ["x", "ground"], k = "sqrt(k_1)" }
    s_2 = { type = "spring", between = ["x", "ground"], k = "-2*sqrt(k_2)" }
    [inputs]
    F = { force = "x" }
    [outputs]
    X = "x"
    """
    limit = Fraction(7, 10)
    found = locate(bound(text, 0), Rectangle(-limit, limit, -limit, limit), 15)
    assert not found.certificate.certified or [root.multiplicity for root in found.poles] == [2]
