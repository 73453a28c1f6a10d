"""A model and the roots that a book, a closed identity or mpmath says it has, and how they are compared."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import count, islice
from typing import TYPE_CHECKING

import mpmath
import pytest
from mpmath import findroot, mp, mpc, mpf, pi, sqrt

from symflex.roots import Band, Mode, Modes, Rectangle
from symflex.roots.locate import locate
from tests.unit.roots.distributed_models import bound

if TYPE_CHECKING:
    from collections.abc import Callable

    from symflex.roots import Region

UNIT = "E = 1, rho = 1, A = 1, l = 1"
BENDS = f"{UNIT}, I = 1"


THREE = Modes(3)
MOST = 70
"""Roots of a formula, enough for any band or rectangle here."""


@dataclass(frozen=True)
class Case:
    """A function of s and its roots: numbers, or pairs of a number and a multiplicity.

    Those of the upper half-plane and the real axis count, without 0, in the order of their distance from it.
    In a band or a rectangle there may be more than lie in it; of modes there are as many as were found.
    """

    text: str
    poles: Callable | None = None
    zeros: Callable | None = None
    at_zero: int = 0  # poles
    word: str | None = None  # of the verdict
    region: Region | None = THREE
    digits: int = 25
    hidden: Callable = lambda: ()  # like poles, all of them, those at 0 too
    among: Callable = lambda: ()  # some of the poles
    absent: Callable = lambda: ()  # where no root of any kind is
    equation: Callable | None = None  # that poles solve
    on_boundary: int = 0  # poles, conjugates too
    lossless: bool = False
    slow: bool = False
    output: int = 0

    def located(self):
        return locate(bound(self.text, self.output), self.region, self.digits)


def cases(table):
    return [pytest.param(case, id=name, marks=[pytest.mark.slow] * case.slow) for name, case in table.items()]


def upper(roots, digits):
    """Return the roots with im >= 0, without those at 0, with their multiplicities."""
    shown = [(root.decimal(digits), root.multiplicity) for root in roots if not root.is_zero]
    return [(mpc(p.re, p.im), times) for p, times in shown if not p.im.startswith("-")]


def in_order(pairs, digits):
    """Return roots by size, those of one size by their angle."""
    return sorted(pairs, key=lambda pair: (mpf(mp.nstr(abs(pair[0]), digits)), mpmath.arg(pair[0])))


def is_in(s, region):
    """Tell whether a root lies in a band or a rectangle, on its limits too."""
    least = mpf(10) ** -(mp.dps - 5)
    if isinstance(region, Band):
        low, high = (2 * pi * mpf(x.numerator) / x.denominator for x in (region.low, region.high))
        return low - least <= abs(s) <= high + least
    sides = (region.re_low, s.real, region.re_high), (region.im_low, s.imag, region.im_high)
    return all(float(low) - least <= x <= float(high) + least for low, x, high in sides)


def expected(given, region, found):
    """Return those roots of a formula that have to be there."""
    most = {Modes: len(found), Mode: getattr(region, "number", 0)}.get(type(region), MOST)
    every = [each if isinstance(each, tuple) else (each, 1) for each in islice(given(), most)]
    every = [(mpc(s), times) for s, times in every]
    if isinstance(region, Mode):
        return every[region.number - 1 :]
    return [
        (s, times) for s, times in every if region is None or isinstance(region, Modes) or is_in(s, region)
    ]


def assert_are(found, wanted, digits):
    """Assert that the roots found in the upper half-plane are just those, and each is certified."""
    numbers = upper(found, digits)
    assert all(root.certified for root in found)
    both = (in_order(pairs, min(15, digits - 3)) for pairs in (numbers, wanted))
    for (one, times), (other, often) in zip(*both, strict=True):
        assert abs(one - other) <= mpf(10) ** (1 - digits) * abs(other), (one, other)
        # A part that is 0 is printed as 0 where it is known to be.
        assert [x == 0 for x in (one.real, one.imag)] == [x == 0 for x in (other.real, other.imag)], one
        assert times == often, (one, other)


def check(case):
    """Assert that poles, zeros, hidden modes, certificate and verdict are those of a case."""
    with mp.workdps(case.digits + 40):
        shown = case.located()
        told = shown.certificate
        assert (told.certified, told.reason, told.counted) == (True, None, told.found)
        assert sum(r.multiplicity for r in shown.poles if r.is_zero) == case.at_zero
        holes = [(sign * 1j * p.im + p.re, p.radius) for p in shown.excluded for sign in (1, -1)]

        def outside(pairs):
            return [(s, n) for s, n in pairs if all(abs(s - z) > r for z, r in holes)]

        for every, given in ((shown.poles, case.poles), (shown.zeros, case.zeros)):
            if given is not None:
                roots = [r for r in every if outside([(complex(r), 1)])]
                wanted = outside(expected(given, case.region, upper(roots, case.digits)))
                assert_are(roots, wanted, case.digits)
                if isinstance(case.region, Modes):
                    least = expected(given, case.region, range(case.region.count))
                    assert sum(n for _, n in wanted) >= min(sum(n for _, n in least), case.region.count)
        for s, _ in upper(shown.poles, case.digits) if case.equation else ():
            assert abs(findroot(case.equation, s * (1 + mpf(10) ** -6)) - s) < mpf(10) ** -9 * abs(s), s
        hidden = [h.root for h in shown.hidden]
        wanted = [each if isinstance(each, tuple) else (each, 1) for each in case.hidden()]
        assert_are([r for r in hidden if not r.is_zero], [(mpc(s), n) for s, n in wanted if s], case.digits)
        assert [r.multiplicity for r in hidden if r.is_zero] == [n for s, n in wanted if not s]
        every = upper([*shown.poles, *shown.zeros, *hidden], case.digits)
        assert not any(abs(s - place) < 1e-3 for s, _ in every for place in case.absent())
        for place in case.among():
            least = mpf(10) ** (1 - case.digits) * abs(place)
            assert any(abs(s - place) <= least for s, _ in upper(shown.poles, case.digits)), place
        if isinstance(case.region, Band | Rectangle):
            assert sum(root.on_boundary for root in shown.poles) == case.on_boundary
        if case.word is not None:
            assert shown.verdict.word == case.word, shown.verdict
        return shown


# ------------------------------------------------------------------------------------ models in a few words


def member(kind, values, between='"ground", "x"', more="", output="x"):
    inputs = "torque" if kind == "shaft" else "force"
    return (
        f'symflex = 1\ninputs.F = {{ {inputs} = "x" }}\noutputs.Y = "{output}"\n[elements]\n'
        f'member = {{ type = "{kind}", between = [{between}], {values} }}\n{more}'
    )


def elements(lines, inputs='F = { force = "x" }', output="x", more=""):
    return f'symflex = 1\n{more}\ninputs.{inputs}\noutputs.Y = "{output}"\n[elements]\n{lines}\n'


PINS = 'left = { type = "pin", at = "p" }\nright = { type = "pin", at = "q" }\n'


def hinged(values):
    """Return a beam of EI = rho A = l = 1 between two pins, driven and seen as the angle at one of them."""
    arm = f'arm = {{ type = "beam", between = ["p", "q"], {BENDS}{values} }}\n{PINS}'
    return elements(arm, 'M = { torque = "p.theta" }', "p.theta")


def along(equation, *conditions, output="w(1)", more=""):
    """Return a field on 0 <= x <= 1."""
    listed = ", ".join(f'"{each}"' for each in conditions)
    return (
        f'symflex = 1\n{more}\ninputs.F = {{}}\noutputs.Y = "{output}"\n[fields.w]\n'
        f'domain = ["0", "1"]\nequation = "{equation}"\nconditions = [{listed}]\n'
    )


def late(expression, delay=1, more=""):
    """Return a quotient of s and of a delay D."""
    return (
        f'symflex = 1\nblocks.D = {{ type = "delay", T = {delay} }}\n{more}\ninputs.u = {{}}\n'
        f'outputs.Y = "{expression}"\n'
    )


# --------------------------------------------------------------------------------------- roots by formulas


def on_axis(omega, first=1, times=1):
    """Return the poles of a formula for the frequency of mode n."""
    return lambda: ((mpc(0, omega(n)), times) for n in count(first))


def solved(equation, guess, power=1, times=1):
    """Return frequencies that an equation gives, one beside each guess."""
    return on_axis(lambda n: findroot(equation, guess(n)) ** power, times=times)


def quadratic(omega, damping):
    """Return the upper root of ``s^2 + damping s + omega^2`` for every mode, or both where they are real."""

    def roots():
        for n in count(1):
            c, k = damping(n), omega(n) ** 2
            root = sqrt(mpc(c * c / 4 - k))
            yield from [-c / 2 + root] if root.imag else [-c / 2 + root, -c / 2 - root]

    return roots


def lambert(argument, scale=1, times=1):
    """Return the branches of Lambert's function in the upper half-plane in the order of their size."""

    def roots():
        every = sorted((scale * mpmath.lambertw(argument, k) for k in range(-31, 32)), key=abs)
        return iter([(s, times) for s in every if s.imag > -1e-20])

    return roots


def known(*values):
    return lambda: iter(sorted(values, key=lambda v: abs(v[0] if isinstance(v, tuple) else v)))
