"""Lagrange's equations of small linear systems, from their energies.

Needs the kinetic energy T, the potential energy V, Rayleigh's dissipation function D and the virtual
work of the inputs. No elements, no nodes, no assembly.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy

s = sympy.Symbol("s")


def rate(q: sympy.Symbol) -> sympy.Symbol:
    """Return the symbol that stands for the time derivative of the coordinate ``q``.

    Examples
    --------
    >>> rate(sympy.Symbol("x"))
    x_dot
    """
    return sympy.Symbol(f"{q.name}_dot")


@dataclass(frozen=True, slots=True)
class LagrangianSystem:
    """A linear system by its energies.

    Parameters
    ----------
    coordinates : tuple of sympy.Symbol
        Generalised coordinates q.
    kinetic, potential, dissipation : sympy.Expr
        T(q_dot), V(q) and D(q_dot), quadratic; D is half the power lost.

    Examples
    --------
    >>> m, k, x = sympy.symbols("m k x")
    >>> LagrangianSystem((x,), m * rate(x) ** 2 / 2, k * x**2 / 2).receptance(x, {x: 1})
    1/(k + m*s**2)
    """

    coordinates: tuple[sympy.Symbol, ...]
    kinetic: sympy.Expr
    potential: sympy.Expr = sympy.S.Zero
    dissipation: sympy.Expr = sympy.S.Zero

    def dynamic_stiffness(self) -> sympy.Matrix:
        """Return Z(s) of Z q = Q, from d/dt dT/dq_dot + dD/dq_dot + dV/dq = Q."""
        q = self.coordinates
        rates = tuple(rate(coordinate) for coordinate in q)
        mass = sympy.hessian(self.kinetic, rates)
        damping = sympy.hessian(self.dissipation, rates)
        stiffness = sympy.hessian(self.potential, q)
        return mass * s**2 + damping * s + stiffness

    def receptance(self, output: sympy.Expr, work: dict[sympy.Symbol, object]) -> sympy.Expr:
        """Return ``output / F``, cancelled, where F does the virtual work ``sum(work[q]*dq)*F``."""
        stiffness = self.dynamic_stiffness()
        force = sympy.Matrix([work.get(q, 0) for q in self.coordinates])
        motion = stiffness.adjugate() * force / stiffness.det(method="berkowitz")
        return sympy.cancel(
            sum(sympy.diff(output, q) * x for q, x in zip(self.coordinates, motion, strict=True))
        )
