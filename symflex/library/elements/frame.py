"""A member of a plane frame: a beam that stretches, at any angle."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from symflex.library import ParameterPort
from symflex.library.elements.element import Choice, Passivity, Port
from symflex.library.elements.line import AXIAL_STIFFNESS, Beam, LineElement

if TYPE_CHECKING:
    from collections.abc import Mapping


class FrameMember(LineElement):
    """A uniform member of a plane frame: bends as a beam of any theory, and stretches as a rod.

    Between nodes of the plane, the second one l [m] from the first in the direction at an angle [rad] from
    the x axis, counted from x to y. ``f_x``, ``f_y`` [N] and ``tau`` [N m] are the force and moment it
    delivers at its second end, along the axes x and y. At a point of it, ``x``, ``y`` and ``theta`` are its
    motion along these axes, ``u`` and ``v`` the same along the member and across it, to the left of its
    direction. ``f_x``, ``f_y``, ``tau`` and ``f_u``, ``f_v`` are there what the part beyond the point exerts
    on the part before it: ``f_u = EA u'`` is positive in tension, ``tau = EI v''`` and ``f_v = -EI v'''``
    after Euler and Bernoulli. ``N`` [N] is an axial force at rest, positive in tension, ``c_f`` and ``k_f`` a
    foundation per length that acts along and across, an ``inextensible`` member bends only. All else is as of
    ``beam`` and ``rod``. Valid for small motions, in which bending and stretching do not act on each other.
    Source: Clough & Penzien 1993, Dynamics of Structures, chapters 11 and 17.
    """

    type_name = "frame"
    summary = "Member of a plane frame: a beam that stretches, at an angle"
    ports = (Port("between", 2, "plane", "the two ends, the second one l further in its direction"),)
    parameters = (
        *Beam.parameters,
        replace(AXIAL_STIFFNESS, only=("extensible",)),
        ParameterPort("angle", "rad", "an angle from the x axis", "0", is_direction=True),
    )
    choices = (
        *Beam.choices,
        Choice("inextensible", ("extensible", "inextensible"), "extensible", "an axis that does not stretch"),
    )
    through = ("f_x", "f_y", "tau")
    ends = ("x", "y", "theta")
    passive = Passivity(of_any_sign=("angle",))
    compliance = "bending"

    @property
    def along(self) -> tuple[tuple[str, ...], ...]:
        """What its state is called at a point, then what it is along and across the member."""
        return tuple((name,) for name in (*self.ends, *self.through, "u", "v", "f_u", "f_v"))

    def theory(self, choices: Mapping[str, str]) -> str:
        """Return the field theory chosen."""
        kind = "" if choices["inextensible"] == "extensible" else "inextensible-"
        return f"{kind}{self.type_name}-{choices['theory']}"
