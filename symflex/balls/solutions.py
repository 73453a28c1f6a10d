"""Solutions of n equations f(x) = 0: the one that a start leads to, and others.

Input: what encloses f and its slopes J on a box, and a start. Output: a box with exactly one solution in it.

What is left over at the start is taken off bit by bit, ``f(x(t)) = (1 - t) f(x(0))`` (Davidenko 1953). A step
from x(t) to x(t') counts where no matrix in J(X) is singular, X being the box that spans both: there f takes
every value at most once, so X contains one x(t') only (Moore 1966). Folds, poles and ends of the domain stop
it: what is beyond belongs to another start.

    x^2 = 2     1 leads to 1.414, and -0.1 to -1.414
    x^3 = 3*x   0.5 leads to 0; 1.1 to 1.732; nothing does from 1, where the slope vanishes
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, arb_mat

from symflex.balls.interval_newton import stays_inside

ITERATIONS = 20  # of Newton's method, which doubles the digits once it is near
STEPS = 400  # of a path; each takes off at most what is left
SHORTEST = Fraction(1, 1 << 16)  # share of what is left that a step takes off at least
HALVINGS = 8  # of an interval on which a slope is looked at
DIGITS = 40  # to which a solution is enclosed


@dataclass(frozen=True)
class EquationSystem:
    """As many equations as unknowns: left-hand sides, and their slopes row by row, on a box.

    >>> from symflex.balls import precision
    >>> system = EquationSystem(lambda x: [x[0] ** 2 - 2], lambda x: [2 * x[0]])
    >>> with precision(256):
    ...     [solution] = system.followed([arb(1)])
    ...     float(solution), system.followed([arb(0)])
    (1.4142135623730951, None)
    """

    values: Callable[[Sequence[arb]], Sequence[arb]]
    slopes: Callable[[Sequence[arb]], Sequence[arb]]

    def followed(self, start: Sequence[arb]) -> list[arb] | None:
        """Return the solution that a start leads to, None if nothing proves that there is one."""
        here, first = [x.mid() for x in start], self.values(start)
        if not all(x.is_finite() for x in first):
            return None
        left = share = Fraction(1)  # what is left of f at the start, and what a step takes off of that
        for _ in range(STEPS):
            goal = left * (1 - share)
            there = self.enclosed(here, [y * goal.numerator / goal.denominator for y in first], start)
            if there is not None and self.is_one_to_one(
                [a.union(b) for a, b in zip(here, there, strict=True)]
            ):
                if not goal:
                    return there
                here, left, share = there, goal, min(2 * share, Fraction(1))
            else:
                share /= 2
            if share < SHORTEST:
                return None
        return None

    def is_one_to_one(self, box: Sequence[arb]) -> bool:
        """Tell whether no matrix that the slopes may form on a box is singular."""
        if len(box) == 1:
            return self._is_monotone(box[0])
        n = len(box)
        slopes = arb_mat(n, n, list(self.slopes(box)))
        try:
            near = arb_mat(n, n, list(self.slopes([x.mid() for x in box]))).inv()
        except ZeroDivisionError:
            return False
        determinant = (near * slopes).det()
        return determinant.is_finite() and not determinant.contains(0)

    def _is_monotone(self, whole: arb) -> bool:
        """Tell whether one slope vanishes nowhere on an interval, which is halved where that is not seen."""
        pending = [(whole, 0)]
        while pending:
            x, depth = pending.pop()
            (slope,) = self.slopes([x])
            if slope.is_finite() and not slope.contains(0):
                continue
            if depth == HALVINGS or not whole.rad() > 0:
                return False
            half = x.rad() / 2
            pending += [(arb(x.mid() - half, half), depth + 1), (arb(x.mid() + half, half), depth + 1)]
        return True

    def enclosed(self, guess: Sequence[arb], values: Sequence[arb], scale: Sequence[arb]) -> list[arb] | None:
        """Return a box about what Newton's method finds, if it is proved to contain one solution.

        Its sides are 1e-40 of the unknowns, or of ``scale`` if an unknown is as good as 0 beside that.
        """
        x = [a.mid() for a in guess]
        for _ in range(ITERATIONS):
            step = self._newton(x, x, values)
            if step is None:
                return None
            x = [(a - b).mid() for a, b in zip(x, step, strict=True)]
            reach = [_reach(a, b) for a, b in zip(x, scale, strict=True)]
            if all(bool(abs(b) < r) for b, r in zip(step, reach, strict=True)):
                break
        box = [arb(a, r) for a, r in zip(x, reach, strict=True)]
        step = self._newton(x, box, values)
        return box if step is not None and all(map(stays_inside, step, reach)) else None

    def _newton(self, middle: Sequence[arb], box: Sequence[arb], values: Sequence[arb]) -> list[arb] | None:
        """Return what Newton's operator subtracts from the middle of a box."""
        n = len(box)
        left = [[a - b] for a, b in zip(self.values(middle), values, strict=True)]
        try:
            step = arb_mat(n, n, list(self.slopes(box))).solve(arb_mat(left))
        except ZeroDivisionError:
            return None
        steps = list(step.entries())
        return steps if all(b.is_finite() for b in steps) else None

    def near(self, guesses: Iterable[Sequence[arb]], scale: Sequence[arb]) -> Iterator[list[arb]]:
        """Yield the solutions that Newton's method finds from guesses, each once."""
        zero, known = [arb(0)] * len(scale), list[list[arb]]()
        for guess in guesses:
            found = self.enclosed(guess, zero, scale)
            if found and not any(all(map(arb.overlaps, found, other)) for other in known):
                known.append(found)
                yield found


def _reach(x: arb, scale: arb) -> arb:
    """Return half the side of a box about x."""
    tiny = arb(10) ** -DIGITS
    size = next((a for a in (x, scale) if abs(a) > tiny.sqrt() * abs(scale)), arb(1))
    return (abs(size) * tiny).mid()
