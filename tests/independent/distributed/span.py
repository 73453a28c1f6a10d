"""One uniform part, its ends held, loaded or free: the boundary-value problem."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from tests.independent.boundary_value import Form, Line, Number, Problem, Rows, Values, bending

End = Callable[..., Sequence[Form]]
"""The conditions at an end, given the components of its state, the values and s."""


def clamped(w: Form, slope: Form, moment: Form, shear: Form, *_: Number) -> tuple[Form, Form]:
    """Neither moves nor turns."""
    return w, slope


def pinned(w: Form, slope: Form, moment: Form, shear: Form, *_: Number) -> tuple[Form, Form]:
    """Turns only."""
    return w, moment


def sliding(w: Form, slope: Form, moment: Form, shear: Form, *_: Number) -> tuple[Form, Form]:
    """Moves only."""
    return slope, shear


def free(w: Form, slope: Form, moment: Form, shear: Form, *_: Number) -> tuple[Form, Form]:
    """Bears no load."""
    return moment, shear


def span(
    first: End,
    second: End,
    output: Callable[[Line, Values], Form],
    rows: Callable[..., Rows] = bending,
    **options: object,
) -> Callable[[Values, Number], Number]:
    """Return the response of one uniform part of length l under conditions at its ends."""

    def respond(v: Values, s: Number) -> Number:
        problem = Problem()
        line = problem.line(rows(v, s, **options))
        problem.require(*first(*line.start, v, s), *second(*line.at(v["l"]), v, s))
        return problem.solve()(output(line, v))

    return respond


def first_end(component: int) -> Callable[[Line, Values], Form]:
    """Return the output that is a component of the state at x = 0."""
    return lambda line, v: line.start[component]


def second_end(component: int) -> Callable[[Line, Values], Form]:
    """Return the output that is a component of the state at x = l."""
    return lambda line, v: line.at(v["l"])[component]


def inside(component: int, name: str) -> Callable[[Line, Values], Form]:
    """Return the output that is a component of the state at the parameter ``name``."""
    return lambda line, v: line.at(v[name])[component]


def free_with_force(w, slope, moment, shear, v, s):
    """Upward unit force on the second end: -V = 1."""
    return moment, shear + 1


def sliding_with_force(w, slope, moment, shear, v, s):
    """Upward unit force on the first end, which does not turn: V = 1."""
    return slope, shear - 1


def beam_with_load(v: Values, s: Number) -> Rows:
    """Return the beam under a unit load per length."""
    return bending(v, s, load=1)


def rayleigh(v: Values, s: Number) -> Rows:
    """Return the beam with rotary inertia."""
    return bending(v, s, rotary=True)


def tip_mass_and_dashpot(w, slope, moment, shear, v, s):
    """A mass, a dashpot and a unit force at the second end: m s^2 w + b s w = 1 - (-V)."""
    return moment, shear + 1 - (v["m"] * s**2 + v["b"] * s) * w
