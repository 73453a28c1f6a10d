"""Counts of roots that owe nothing to the program: turns of a determinant, Wittrick and Williams' count.

Both return integers that must come out the same as the number of poles or zeros found, with multiplicity.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from mpmath import arg, mpc, mpf, pi

from tests.independent.boundary_value import Number, Problem, power_of_two

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

FIRST_STEPS = 24
"""Pieces of each side to begin with."""
PARTS = (mpf(0), mpf(5) / 16, mpf(9) / 16, mpf(1))
"""Where a piece is looked at: unevenly, or a turn between equal steps would go unseen."""
DEEPEST = 40
"""Halvings of a piece before a root is taken to lie on the contour."""


class OnTheContourError(ArithmeticError):
    """The argument jumps however short the step."""


# ------------------------------------------------------------------------------------------------ windings


def count_inside(
    function: Callable[[Number], Number], low: complex, high: complex, first_steps: int = FIRST_STEPS
) -> int:
    """Return how many zeros a function without poles has in a rectangle, by tracking its argument.

    A step is taken when the argument changes by less than an eighth of a turn over each of its uneven parts.

    Parameters
    ----------
    function : callable
        Up to a positive factor that may change from point to point.
    low, high : complex
        Opposite corners.
    first_steps : int
        Pieces of each side to begin with.

    Raises
    ------
    OnTheContourError
        When a zero is on the contour, or too near to it.

    Examples
    --------
    >>> count_inside(lambda s: (s - 1) ** 2 * (s + 3), -2 - 1j, 2 + 1j)
    2
    """
    corners = [mpc(low), mpc(high.real, low.imag), mpc(high), mpc(low.real, high.imag)]
    known: dict[Number, Number] = {}

    def at(s: Number) -> Number:
        if s not in known:
            value = function(s)
            if value == 0:
                message = f"a zero at {s}"
                raise OnTheContourError(message)
            known[s] = value
        return known[s]

    turns = mpf(0)
    for a, b in zip(corners, [*corners[1:], corners[0]], strict=True):
        points = [a + (b - a) * k / first_steps for k in range(first_steps + 1)]
        turns += sum(_turning(at, p, q, 0) for p, q in itertools.pairwise(points))
    number = turns / (2 * pi)
    if abs(number - round(number)) > 1e-6:
        message = f"{number} turns"
        raise OnTheContourError(message)
    return round(number)


def _turning(at: Callable[[Number], Number], a: Number, b: Number, depth: int) -> Number:
    if depth > DEEPEST:
        message = f"the argument jumps at {a}"
        raise OnTheContourError(message)
    points = [a + (b - a) * part for part in PARTS]
    changes = [arg(at(q) / at(p)) for p, q in itertools.pairwise(points)]
    if max(map(abs, changes)) < pi / 4:
        return sum(changes)
    return _turning(at, a, points[2], depth + 1) + _turning(at, points[2], b, depth + 1)


def determinant(problem: Problem) -> Number:
    """Return the determinant of the conditions of a boundary-value problem, up to a positive factor.

    Of the homogeneous problem it vanishes at all poles, hidden ones too; with the condition that bears the
    load replaced by "the output vanishes", at all zeros and what is hidden. Conditions are scaled.
    """
    rows = []
    for form in problem.conditions:
        row = [form.coefficients.get(unknown, mpf(0)) for unknown in range(problem.count)]
        largest = power_of_two(max(map(abs, row)))
        rows.append([c / largest for c in row])
    product = mpc(1)
    for i in range(len(rows)):
        pivot = max(range(i, len(rows)), key=lambda k: abs(rows[k][i]))
        if not rows[pivot][i]:
            return mpc(0)
        if pivot != i:
            rows[i], rows[pivot] = rows[pivot], rows[i]
            product = -product
        product *= rows[i][i]
        for k in range(i + 1, len(rows)):
            if rows[k][i]:
                factor = rows[k][i] / rows[i][i]
                rows[k] = [c - factor * d for c, d in zip(rows[k], rows[i], strict=True)]
    return product


# --------------------------------------------------------------------------- Wittrick and Williams' count


@dataclass(frozen=True)
class Member:
    """A uniform Euler-Bernoulli beam between two joints of a straight frame."""

    first: int
    second: int
    stiffness: float
    mass_per_length: float
    length: float

    def wave(self, omega: float) -> float:
        """Return lambda = l (rho A omega^2/(E I))^(1/4)."""
        return self.length * (self.mass_per_length * omega**2 / self.stiffness) ** 0.25

    def dynamic_stiffness(self, omega: float) -> np.ndarray:
        """Return the forces and moments on the ends per unit of (y_1, theta_1, y_2, theta_2).

        Clough & Penzien 1993, section 20; numerators and denominator are divided by cosh lambda.
        """
        x, length = self.wave(omega), self.length
        sine, cosine = math.sin(x), math.cos(x)
        tanh, sech = math.tanh(x), 1 / math.cosh(x)
        d = sech - cosine
        a = x**3 * (sine + cosine * tanh) / d
        b = x**2 * sine * tanh / d
        c = x * (sine - cosine * tanh) / d
        e = x**3 * (sine * sech + tanh) / d
        f = x**2 * (1 - cosine * sech) / d
        g = x * (tanh - sine * sech) / d
        return (
            self.stiffness
            / length**3
            * np.array(
                [
                    [a, b * length, -e, f * length],
                    [b * length, c * length**2, -f * length, g * length**2],
                    [-e, -f * length, a, -b * length],
                    [f * length, g * length**2, -b * length, c * length**2],
                ]
            )
        )

    def clamped_count(self, omega: float) -> int:
        """Return how many natural frequencies lie below omega with both ends clamped.

        j = i - (1 - (-1)^i sign(1 - cos lambda cosh lambda))/2, i = floor(lambda/pi)
        (Williams & Wittrick 1970).
        """
        x = self.wave(omega)
        whole = math.floor(x / math.pi)
        sign = 1 if 1 / math.cosh(x) - math.cos(x) > 0 else -1
        return whole - (1 - (-1) ** whole * sign) // 2


@dataclass(frozen=True)
class Frame:
    """Beams on one line with masses, springs and supports: coordinates are ("y", joint) and ("theta", joint).

    Parameters
    ----------
    members : sequence of Member
        The beams.
    masses, supports : sequence of (coordinate, value)
        Masses and moments of inertia; springs to ground.
    links : sequence of (coordinate, coordinate, value)
        Springs between coordinates; a coordinate of a new name is a point of its own.
    held : set of coordinate
        What does not move.

    Examples
    --------
    A cantilever has omega = 3.52 and 22.0 (Blevins 1979, table 8-1).

    >>> cantilever = Frame([Member(0, 1, 1.0, 1.0, 1.0)], held={("y", 0), ("theta", 0)})
    >>> [cantilever.count(omega) for omega in (3.51, 3.52, 22.0, 22.04)]
    [0, 1, 1, 2]
    """

    members: Sequence[Member] = ()
    masses: Sequence[tuple[tuple[str, int], float]] = ()
    supports: Sequence[tuple[tuple[str, int], float]] = ()
    links: Sequence[tuple[tuple[str, int], tuple[str, int], float]] = ()
    held: frozenset[tuple[str, int]] | set[tuple[str, int]] = field(default_factory=set)

    def with_held(self, coordinate: tuple[str, int]) -> Frame:
        """Return the frame with one coordinate more that does not move."""
        return Frame(self.members, self.masses, self.supports, self.links, {*self.held, coordinate})

    def dynamic_stiffness(self, omega: float) -> np.ndarray:
        """Return the stiffness matrix at a frequency, of the coordinates that move."""
        names = [(kind, j) for m in self.members for j in (m.first, m.second) for kind in ("y", "theta")]
        names += [c for c, _ in (*self.masses, *self.supports)] + [
            c for a, b, _ in self.links for c in (a, b)
        ]
        index = {name: i for i, name in enumerate(n for n in dict.fromkeys(names) if n not in self.held)}
        matrix_ = np.zeros((len(index), len(index)))

        def add(block: np.ndarray, at: Sequence[tuple[str, int]]) -> None:
            for i, row in enumerate(at):
                for j, column in enumerate(at):
                    if row in index and column in index:
                        matrix_[index[row], index[column]] += block[i, j]

        for m in self.members:
            at = [("y", m.first), ("theta", m.first), ("y", m.second), ("theta", m.second)]
            add(m.dynamic_stiffness(omega), at)
        for coordinate, mass in self.masses:
            add(np.array([[-mass * omega**2]]), [coordinate])
        for coordinate, spring in self.supports:
            add(np.array([[spring]]), [coordinate])
        for a, b, spring in self.links:
            add(spring * np.array([[1.0, -1.0], [-1.0, 1.0]]), [a, b])
        return matrix_

    def count(self, omega: float) -> int:
        """Return how many natural frequencies lie below omega, those at zero too: J = J_0 + s{K}.

        Wittrick & Williams 1971, A general algorithm for computing natural frequencies of elastic structures.
        """
        negative = 0
        stiffness = self.dynamic_stiffness(omega)
        if stiffness.size:
            scale = 1 / np.sqrt(np.abs(np.diag(stiffness)) + np.abs(stiffness).max() * 1e-30)
            negative = int((np.linalg.eigvalsh(stiffness * scale[:, None] * scale) < 0).sum())
        return negative + sum(m.clamped_count(omega) for m in self.members)
