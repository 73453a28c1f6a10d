"""Fundamental matrices of equations whose solutions have names of their own."""

from __future__ import annotations

from dataclasses import dataclass, field

import pytest
from flint import acb, arb, arb_poly, ctx

from symflex.along.fundamental_matrix import expand
from symflex.along.growth import SingularCoefficientError
from symflex.along.system import RationalPart, SingularBeginning


@dataclass
class Equation:
    """``y'' = (constant + u*moving) y``, both polynomials in x, from ``start`` to ``end``."""

    constant: tuple[float, ...]
    moving: tuple[float, ...]
    start: float = 0.0
    end: float = 1.0
    size: int = field(default=2, init=False)
    beginning: SingularBeginning | None = field(default=None, init=False)

    def ends(self):
        return arb(self.start), arb(self.end)

    def series(self, x, terms):
        shift = arb_poly([x, 1])
        first = {(0, 1): arb_poly([1])}
        if self.constant:
            first[1, 0] = arb_poly(list(self.constant))(shift)
        return [first, {(1, 0): arb_poly(list(self.moving))(shift)}]

    def parts(self, x):
        entries = self.series(x, 0)
        return [
            RationalPart(place, polynomial, (), ((order, arb(1)),))
            for order, coefficients in enumerate(entries)
            for place, polynomial in coefficients.items()
        ]

    def bounds(self, x, largest):
        def size(coefficients):
            return sum((abs(acb(c)) * abs(x) ** k for k, c in enumerate(coefficients)), arb(0)).abs_upper()

        return {(0, 1): arb(1), (1, 0): size(self.constant) + size(self.moving) * largest}


@pytest.fixture(autouse=True, params=["recurrence", "quadrature"])
def way(request, monkeypatch):
    """Steps by recurrences, where coefficients are rational in x, and by power series of any."""
    if request.param == "quadrature":
        monkeypatch.setattr(Equation, "parts", lambda _, __: None)


def at(equation, row, column, u, bits=150):
    made = expand(equation, arb(abs(u) + 1).upper(), bits)
    with ctx.workprec(bits):
        return made.series((row,), (column,), acb(u), 2)


def test_constant_coefficients_make_cosh():
    for u in [3.0, -200.0, 40 - 30j]:
        with ctx.workprec(150):
            root = acb(u).sqrt()
            cosh, slope = at(Equation((), (1.0,)), 0, 0, u)
            assert cosh.overlaps(root.cosh()), u
            assert cosh.rel_accuracy_bits() > 100, u
            assert slope.overlaps(root.sinh() / (2 * root)), u


def test_a_coefficient_that_grows_with_x_makes_airy_functions():
    for u in [5.0, -300.0, 2 + 50j]:
        # y'' = u x y is solved by Ai(k x) and Bi(k x), k^3 = u; Ai'Bi - Ai Bi' is -1/pi.
        with ctx.workprec(150):
            k = acb(u) ** (acb(1) / 3)
            ai, _, bi, _ = k.airy()
            _, aip0, _, bip0 = acb(0).airy()
            expected = (bip0 * ai - aip0 * bi) * acb.pi()
            value, _ = at(Equation((), (0.0, 1.0)), 0, 0, u)
            assert value.overlaps(expected), u
            assert value.rel_accuracy_bits() > 100, u


def test_equations_that_go_in_circles_at_u_zero_are_solved_too():
    # y'' = (1 + x^2) y has the solution exp(x^2/2), from (1, 0) on.
    value, _ = at(Equation((1.0, 0.0, 1.0), (1.0,)), 0, 0, 0.0)
    with ctx.workprec(150):
        assert value.overlaps(acb(arb(1) / 2).exp())
        assert value.rel_accuracy_bits() > 100


def test_the_wronskian_is_one():
    for u in [-60.0, 9j]:
        made = expand(Equation((), (1.0, -0.5)), arb(60), 120)
        with ctx.workprec(120):
            (value,) = made.series((0, 1), (0, 1), acb(u))
            assert value.overlaps(acb(1)), u
            assert value.rel_accuracy_bits() > 80, u


def test_a_ball_of_u_holds_the_values_at_its_points():
    made = expand(Equation((), (1.0, 1.0)), arb(100), 120)
    with ctx.workprec(120):
        (wide,) = made.series((0,), (0,), acb(arb(-50, 5), arb(0, 5)))
        for point in (-50, -46, -54 + 3j, -48 - 4j):
            (value,) = made.series((0,), (0,), acb(point))
            assert wide.contains(value)


def test_on_a_wide_ball_a_minor_and_its_slopes_are_told_from_the_middle():
    for middle in [-700.0, -500 + 300j]:
        # cosh(sqrt(u)), whose series alternates: terms of 1e10 sum up to less than 1.
        made = expand(Equation((), (1.0,)), arb(1200), 120)
        ball = acb(middle) + acb(arb(0, 2), arb(0, 2))
        with ctx.workprec(120):
            wide = made.series((0,), (0,), ball, 3)
            for way in (0, 2, -2 + 2j, 1 - 2j):
                root = (acb(middle) + way).sqrt()
                slope = root.sinh() / (2 * root)
                curved = (root.cosh() / root**2 - root.sinh() / root**3) / 8
                for found, expected in zip(wide, (root.cosh(), slope, curved), strict=True):
                    assert found.contains(expected), middle
            assert wide[0].rad() < 10 * abs(wide[1]).upper(), middle


def test_what_a_step_leaves_out_is_bounded_at_every_order_that_is_kept():
    # Most orders of a short step lie below what matters; of u^0 an entry below the diagonal has none.
    made = expand(Equation((), (1.0, -0.9)), arb(10000), 60)
    assert len(made.legs) > 3
    for step in made._steps:
        for (row, column), polynomial in step.items():
            coefficients = polynomial.coeffs()
            assert len(coefficients) == made.terms
            assert all(c.rad() > 0 for c in coefficients[int(row > column) :])


def test_a_pole_is_met():
    class Pole(Equation):
        def bounds(self, x, largest):
            return {(0, 1): arb(1), (1, 0): abs(1 / (x - acb(0.5))) * largest}

    with pytest.raises(SingularCoefficientError) as caught:
        expand(Pole((), (1.0,)), arb(1), 60)
    assert 0.3 < caught.value.place <= 0.5


@dataclass
class Entries:
    """Entries that are polynomials in x, per power of u."""

    orders: tuple[dict[tuple[int, int], tuple[float, ...]], ...]
    size: int = field(default=2, init=False)

    def series(self, x, terms):
        return [
            {place: arb_poly(list(c))(arb_poly([x, 1])) for place, c in each.items()} for each in self.orders
        ]

    def bounds(self, x, largest):
        found = {}
        for q, each in enumerate(self.orders):
            for place, c in each.items():
                size = sum((abs(acb(a)) * abs(x) ** k for k, a in enumerate(c)), arb(0)) * largest**q
                found[place] = found.get(place, arb(0)) + size.abs_upper()
        return found


def test_what_is_finite_where_a_coefficient_has_a_pole_is_a_bessel_function():
    # w' = f/x and f' = u w: I_0(2 sqrt(u x)) is finite at 0, and f there is x times its slope.
    for u, end in ((7.0, 1.0), (-300.0, 1.0), (20 + 50j, 1.0), (-300.0, 0.015625)):
        tip = Equation((), (1.0,), 0.0, end)
        values = Entries(({(0, 0): (1.0,)},))
        tip.beginning = SingularBeginning((0, 0), Entries(({(0, 1): (1.0,)}, {(1, 0): (0.0, 1.0)})), values)
        made = expand(tip, arb(abs(u) + 1).upper(), 150)
        with ctx.workprec(150):
            root = acb(u * end).sqrt()
            for row, expected in ((0, (2 * root).bessel_i(0)), (1, root * (2 * root).bessel_i(1))):
                (value,) = made.series((row,), (0,), acb(u))
                assert value.overlaps(expected), (u, end)
                assert value.rel_accuracy_bits() > 100, (u, end)
