"""A transfer function to be computed twice, and the texts of its specification."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mpmath import mp, mpc, mpf

from tests.independent.boundary_value import Number, Values

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence


@dataclass(frozen=True)
class Case:
    """A transfer function to be computed twice.

    Parameters
    ----------
    name : str
        What it is, in a few words.
    parameters, body, output, source : dict, str, str, str
        The specification: values in SI units, all between these and the output ``out``, and its input ``u``.
    scale : float
        About the lowest natural frequency [rad/s].
    decades : tuple of float
        The range of abs(s)/scale, as powers of ten.
    respond : callable
        The value at s from the boundary-value problem, given the parameters' values.
    """

    name: str
    parameters: dict[str, str]
    body: str
    output: str
    scale: float
    decades: tuple[float, float]
    respond: Callable[[Values, Number], Number]
    source: str = "{}"

    @property
    def text(self) -> str:
        """The specification."""
        entries = "\n".join(f'{name} = "{value}"' for name, value in self.parameters.items())
        return (
            f"symflex = 1\n\n[parameters]\n{entries}\n{self.body}\n"
            f'[inputs]\nu = {self.source}\n\n[outputs]\nout = "{self.output}"\n'
        )

    def values(self) -> Values:
        """Return the parameters' values, at the working precision."""
        return {name: mpf(value.partition(" ")[0]) for name, value in self.parameters.items()}

    def reference(self, s: complex, digits: int) -> Number:
        """Return the response at s, computed with that many digits."""
        with mp.workdps(digits):
            return self.respond(self.values(), mpc(s))

    def points(self, count: int) -> list[complex]:
        """Return points on a spiral through both half-planes, many of them near the imaginary axis."""
        low, high = self.decades
        return [
            cmath.rect(self.scale * 10 ** (low + (high - low) * k / (count - 1)), math.radians(angle))
            for k, angle in zip(range(count), _angles(count), strict=True)
        ]


ANGLES = (90, 85, 100, 45, 140, 89, -60, 12, 170, 92, 90, 75, 0, 120, -91, 30, 150, 88, 93, -80)
"""Directions of s in degrees."""


def _angles(count: int) -> list[float]:
    # The second turn through the list is a few degrees on.
    return [ANGLES[k % len(ANGLES)] + 3.7 * (k // len(ANGLES)) for k in range(count)]


# ------------------------------------------------------------------------------------------ texts

BEAM = {"E": "69e9 Pa", "I": "7.2e-10 m^4", "rho": "2700 kg/m^3", "A": "2.4e-4 m^2", "l": "0.9 m"}
THICK = BEAM | {"I": "7.2e-7 m^4", "A": "2.4e-3 m^2", "l": "0.3 m", "G": "26e9 Pa", "kappa": "0.85"}
ROD = {"E": "69e9 Pa", "rho": "2700 kg/m^3", "A": "2.4e-4 m^2", "l": "0.9 m"}
SHAFT = {"G": "79e9 Pa", "J": "1.57e-8 m^4", "rho": "7850 kg/m^3", "l": "1.2 m"}
STRING = {"N": "180 N", "rho": "7850 kg/m^3", "A": "1.2e-6 m^2", "l": "0.65 m"}

SLENDER = (38.0, (-2.5, 2.5))
STOCKY = (3400.0, (-2.5, 2.2))
AXIAL = (8800.0, (-2.5, 1.3))
TORSION = (4150.0, (-2.5, 1.3))
TAUT = (670.0, (-2.5, 1.3))

BEAM_ELEMENT = 'type = "beam", E = "E", I = "I", rho = "rho", A = "A"'
THICK_ELEMENT = BEAM_ELEMENT + ', theory = "timoshenko", kappa = "kappa", G = "G"'
ROD_ELEMENT = 'type = "rod", E = "E", A = "A", rho = "rho"'
SHAFT_ELEMENT = 'type = "shaft", G = "G", J = "J", rho = "rho"'
STRING_ELEMENT = 'type = "string", N = "N", rho = "rho", A = "A"'


def ode(equation: str, *conditions: str, name: str = "w", domain: tuple[str, str] = ("0", "l")) -> str:
    """Return a field of one unknown."""
    return system((equation,), conditions, name, (name,), domain)


def system(
    equations: Sequence[str],
    conditions: Sequence[str],
    name: str,
    unknowns: Sequence[str],
    domain: tuple[str, str] = ("0", "l"),
) -> str:
    """Return a field of several unknowns."""

    def array(items: Sequence[str]) -> str:
        return "[" + ", ".join(f'"{item}"' for item in items) + "]"

    return (
        f"\n[fields.{name}]\nunknowns = {array(unknowns)}\ndomain = {array(domain)}\n"
        f"equations = {array(equations)}\nconditions = {array(conditions)}\n"
    )


def elements(**entries: str) -> str:
    """Return a table of elements."""
    lines = "\n".join(f"{name} = {{ {entry} }}" for name, entry in entries.items())
    return f"\n[elements]\n{lines}\n"


EULER = "E*I*w'''' + rho*A*s^2*w = 0"
DAMPED = "E*I*(1 + eta*s)*w'''' + (rho*A*s^2 + c_f*s)*w = 0"
LOSSES = {"eta": "2e-5 s", "c_f": "1.3 N*s/m^2"}
