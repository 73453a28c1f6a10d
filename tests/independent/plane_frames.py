"""Plane frames by exact dynamic stiffness in numbers, after textbooks; nothing of symflex is used.

A member's stiffness for ends moving as ``e^(st)`` is that of Kolousek's functions (V. Kolousek, Dynamics in
Engineering Structures, 1973; Clough & Penzien, Dynamics of Structures, 1993, section 17), with
``lambda^4 = -rho A s^2 l^4/(EI)`` for bending and ``gamma^2 = -rho s^2 l^2/E`` for stretching.
"""

from __future__ import annotations

from dataclasses import dataclass

from mpmath import mp, mpc

DIGITS = 40
AXES = ("x", "y", "theta")


@dataclass(frozen=True)
class Member:
    """A uniform member between two named joints, at an angle [rad] from x."""

    first: str
    second: str
    E: object
    I: object  # noqa: E741 (the field's own name)
    A: object
    rho: object
    l: object  # noqa: E741
    angle: object = 0

    def stiffness(self, s):
        """Return the 6 x 6 dynamic stiffness of (x, y, theta) at both ends, in global axes."""
        EI, EA, m = self.E * self.I, self.E * self.A, self.rho * self.A
        lam = mp.root(-m * s**2 * self.l**4 / EI, 4)
        gamma = mp.sqrt(-m * s**2 * self.l**2 / EA)
        c, si, ch, sh = mp.cos(lam), mp.sin(lam), mp.cosh(lam), mp.sinh(lam)
        below = 1 - c * ch
        scale = EI * lam / self.l / below
        across, mixed = scale * (lam / self.l) ** 2, scale * lam / self.l
        vv, vt, tt = across * (si * ch + c * sh), mixed * si * sh, scale * (si * ch - c * sh)
        vv_far, vt_far, tt_far = -across * (si + sh), mixed * (ch - c), scale * (sh - si)
        uu, uu_far = EA / self.l * gamma * mp.cot(gamma), -EA / self.l * gamma * mp.csc(gamma)
        local = mp.matrix(
            [
                [uu, 0, 0, uu_far, 0, 0],
                [0, vv, vt, 0, vv_far, vt_far],
                [0, vt, tt, 0, -vt_far, tt_far],
                [uu_far, 0, 0, uu, 0, 0],
                [0, vv_far, -vt_far, 0, vv, -vt],
                [0, vt_far, tt_far, 0, -vt, tt],
            ]
        )
        cos, sin = mp.cos(self.angle), mp.sin(self.angle)
        turn = mp.matrix(6, 6)
        for k in (0, 3):
            turn[k, k], turn[k, k + 1], turn[k + 1, k], turn[k + 1, k + 1] = cos, sin, -sin, cos
            turn[k + 2, k + 2] = 1
        return turn.T * local * turn


def freedoms(members):
    """Return the components of all joints in order; a hinge ``b'`` shares the translations of ``b``."""
    joints = dict.fromkeys(j for m in members for j in (m.first, m.second))
    found = [(joint, c) for joint in joints for c in AXES]
    return list(dict.fromkeys(_shared(f) for f in found))


def _shared(freedom):
    joint, component = freedom
    return freedom if component == "theta" else (joint.rstrip("'"), component)


def stiffness(members, s, added=()):
    """Return the dynamic stiffness of the whole, with ``added`` {(freedom, freedom): stiffness at s}."""
    order = freedoms(members)
    place = {(j, c): order.index(_shared((j, c))) for m in members for j in (m.first, m.second) for c in AXES}
    whole = mp.matrix(len(order), len(order))
    for member in members:
        at = [place[j, c] for j in (member.first, member.second) for c in AXES]
        part = member.stiffness(s)
        for i, row in enumerate(at):
            for j, column in enumerate(at):
                whole[row, column] += part[i, j]
    for (row, column), value in dict(added).items():
        whole[place[row], place[column]] += value
    return whole


def response(members, held, load, shown, s, added=()):
    """Return what one freedom does per unit force or moment on another, with those in ``held`` at rest."""
    with mp.workdps(DIGITS):
        s = mpc(s)
        whole = stiffness(members, s, added)
        order = freedoms(members)
        kept = [i for i, freedom in enumerate(order) if freedom not in held]
        matrix = mp.matrix([[whole[i, j] for j in kept] for i in kept])
        right = mp.matrix([1 if order[i] == load else 0 for i in kept])
        found = mp.lu_solve(matrix, right)
        return complex(found[[order[i] for i in kept].index(shown)])


def determinant(members, held, omega, added=()):
    """Return the determinant of the dynamic stiffness at s = j omega, real but for its rounding."""
    with mp.workdps(DIGITS):
        whole = stiffness(members, mpc(0, omega), added)
        kept = [i for i, freedom in enumerate(freedoms(members)) if freedom not in held]
        return mp.re(mp.det(mp.matrix([[whole[i, j] for j in kept] for i in kept])))


def clamped(*joints):
    """Return all freedoms of some joints."""
    return {(joint, c) for joint in joints for c in AXES}


def pinned(*joints):
    """Return the translations of some joints."""
    return {(joint, c) for joint in joints for c in ("x", "y")}
