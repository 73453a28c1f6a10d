"""Distributed two-ports: the state at the second end follows from the state at the first.

Rods in tension, shafts in torsion, stretched strings, beams in bending, and members of frames.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar, Final

from symflex.library import ParameterPort
from symflex.library.elements.element import (
    LOSS_FACTOR,
    Choice,
    Element,
    ElementUse,
    EquationRow,
    Injection,
    LinearForm,
    Passivity,
    Port,
    Stamp,
)

if TYPE_CHECKING:
    from symflex.algebra import Factored
    from symflex.library.elements.element import PortTerminal, Variable


AXIAL_STIFFNESS: Final = ParameterPort(
    "EA", "N", "an axial stiffness", sign="positive", varies=True, of=("E", "A")
)
MASS_PER_LENGTH: Final = ParameterPort(
    "rhoA", "kg/m", "a mass per length", sign="nonnegative", varies=True, of=("rho", "A")
)


class LineElement(Element):
    """A uniform one-dimensional element between two nodes, governed by a field theory.

    Its state along x holds the across quantities first, in the order of ``ends``, then as many through
    quantities, in the order of ``through``: what the part beyond x exerts on the part before it. So the
    element delivers the through state at x = 0 into its first node and minus the through state at x = l
    into its second. ``f`` [N] and ``tau`` [N m] are what it delivers at its second end.
    """

    length: ClassVar[str] = "l"  # the parameter that is the length
    # The across components of a terminal: ``("y", "theta")`` of a planar one, else ``("across",)``.
    ends: ClassVar[tuple[str, ...]]

    @property
    def along(self) -> tuple[tuple[str, ...], ...]:
        """What its state is called at a point, ``arm.y(l/2)``: each quantity by all its names, in order."""
        # ``f`` and ``tau`` at a point are what the part beyond it exerts on the part before it.
        domain = self.ports[0].domain
        across = {"planar": (("y",), ("theta",)), "rotation": (("theta",),)}.get(domain, (("u", "y"),))
        return (*across, *((quantity,) for quantity in self.through))

    def theory(self, choices: Mapping[str, str]) -> str:
        """Return the name of the field theory, a key of the registry of theories: the element's own."""
        del choices
        return self.type_name.replace("_", "-")

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute what is delivered at both ends and one row per state, ``z(l) = T*z(0)``, T entire in s.

        Of a beam: the unknowns ``f_a``, ``tau_a`` (delivered at the first end), ``f`` and ``tau`` (delivered
        at the second), and four rows.

        Where the law is solved otherwise ``use`` has no matrix T, and there are no rows. Where a stiffness
        vanishes at x = l they are ``z(0) = T*z(l)``, with nothing delivered there.
        """
        one = use.one
        a, b = use.terminals["between"]
        first = self._delivered_first(use)
        second = [use.unknown(quantity) for quantity in self.through]
        given = self.tip_state(use) if use.is_turned else self.initial_state(use)
        wanted = [(v, one) for v in self.initial_state(use)] if use.is_turned else self.final_state(use)
        unknowns = (*first, *second)
        rows = [
            EquationRow(about, LinearForm.of(end, *((v, -c) for v, c in zip(given, line, strict=True))))
            for about, end, line in zip(unknowns, wanted, use.transmission, strict=bool(use.transmission))
        ]
        delivered = [*zip(self._across(a), first, strict=True), *zip(self._across(b), second, strict=True)]
        return Stamp(
            unknowns=unknowns,
            rows=tuple(rows),
            injections=tuple(Injection(node, LinearForm.of((v, one))) for node, v in delivered),
            through=tuple((v.component, LinearForm.of((v, one))) for v in second),
        )

    def initial_state(self, use: ElementUse) -> tuple[Variable | None, ...]:
        """Return the unknowns that are the state at x = 0, None if it is held to zero."""
        return (*self._across(use.terminals["between"][0]), *self._delivered_first(use))

    def final_state(self, use: ElementUse) -> list[tuple[Variable | None, Factored]]:
        """Return the unknowns that are the state at x = l, each with its sign."""
        across = self._across(use.terminals["between"][1])
        return [*((v, use.one) for v in across), *((use.unknown(q), -use.one) for q in self.through)]

    def tip_state(self, use: ElementUse) -> tuple[Variable | None, ...]:
        """Return the unknowns that are the state at a tip at x = l, which carries no force."""
        return (*self._across(use.terminals["between"][1]), *(None for _ in self.through))

    def _delivered_first(self, use: ElementUse) -> list[Variable]:
        return [use.unknown(f"{quantity}_a") for quantity in self.through]

    def _across(self, terminal: PortTerminal) -> tuple[Variable | None, ...]:
        return tuple(getattr(terminal, end) for end in self.ends)


class Rod(LineElement):
    """A uniform rod of length l [m] and cross-sectional area A [m^2] in tension and compression.

    ``f`` [N] is the force the rod delivers at its second end. ``eta`` [s] is Kelvin-Voigt damping,
    ``c_f`` and ``k_f`` a viscous and an elastic foundation per length.
    Source: Timoshenko, Young & Weaver 1974, Vibration Problems in Engineering, chapter 5.
    """

    type_name = "rod"
    summary = "Rod in tension and compression, uniform or tapered"
    ports = (Port("between", 2, "translation", "the two ends, the second one l further along x"),)
    parameters = (
        ParameterPort("E", "Pa", "Young's modulus", sign="positive"),
        ParameterPort("A", "m^2", "a cross-sectional area", sign="positive", varies=True),
        ParameterPort("rho", "kg/m^3", "a density", sign="nonnegative"),
        ParameterPort("l", "m", "a length"),
        ParameterPort("eta", "s", "a Kelvin-Voigt damping time constant", "0", sign="nonnegative"),
        ParameterPort("c_f", "N*s/m^2", "a viscous foundation", "0", varies=True),
        ParameterPort("k_f", "N/m^2", "an elastic foundation", "0", varies=True),
        AXIAL_STIFFNESS,
        MASS_PER_LENGTH,
        LOSS_FACTOR,
    )
    through = ("f",)
    ends = ("across",)
    passive = Passivity()
    compliance = "stretching"


class Shaft(LineElement):
    """A uniform shaft of length l [m] and polar second moment of area J [m^4] in torsion.

    ``tau`` [N m] is the torque the shaft delivers at its second end. ``eta`` [s] is Kelvin-Voigt damping,
    ``c_f`` and ``k_f`` a viscous and an elastic foundation per length. If the section is not circular,
    multiply G by the torsion constant over J. Source: Timoshenko, Young & Weaver 1974, Vibration Problems
    in Engineering, chapter 5.
    """

    type_name = "shaft"
    summary = "Shaft in torsion, uniform or tapered"
    ports = (Port("between", 2, "rotation", "the two ends, the second one l further along x"),)
    parameters = (
        ParameterPort("G", "Pa", "a shear modulus", sign="positive"),
        ParameterPort("J", "m^4", "a polar second moment of area", sign="positive", varies=True),
        ParameterPort("rho", "kg/m^3", "a density", sign="nonnegative"),
        ParameterPort("l", "m", "a length"),
        ParameterPort("eta", "s", "a Kelvin-Voigt damping time constant", "0", sign="nonnegative"),
        ParameterPort("c_f", "N*m*s/m", "a viscous foundation", "0", varies=True),
        ParameterPort("k_f", "N*m/m", "an elastic foundation", "0", varies=True),
        ParameterPort("GJ", "N*m^2", "a torsional stiffness", sign="positive", varies=True, of=("G", "J")),
        ParameterPort(
            "rhoJ", "kg*m", "an inertia per length", sign="nonnegative", varies=True, of=("rho", "J")
        ),
        LOSS_FACTOR,
    )
    through = ("tau",)
    ends = ("across",)
    passive = Passivity()
    compliance = "stretching"


class String(LineElement):
    """A string of length l [m], cross-sectional area A [m^2] and tension N [N], in transverse motion.

    ``f`` [N] is the transverse force the string delivers at its second end. ``c_f`` and ``k_f`` are a
    viscous and an elastic foundation per length.
    Source: Timoshenko, Young & Weaver 1974, Vibration Problems in Engineering, chapter 5.
    """

    type_name = "string"
    summary = "Stretched string in transverse motion, uniform or not"
    ports = (Port("between", 2, "translation", "the two ends, the second one l further along x"),)
    parameters = (
        ParameterPort("N", "N", "a tension", sign="positive", varies=True),
        ParameterPort("rho", "kg/m^3", "a density", sign="nonnegative"),
        ParameterPort("A", "m^2", "a cross-sectional area", sign="nonnegative", varies=True),
        ParameterPort("l", "m", "a length"),
        ParameterPort("c_f", "N*s/m^2", "a viscous foundation", "0", varies=True),
        ParameterPort("k_f", "N/m^2", "an elastic foundation", "0", varies=True),
        MASS_PER_LENGTH,
    )
    through = ("f",)
    ends = ("across",)
    passive = Passivity()
    compliance = "stretching"


THEORIES = ("euler-bernoulli", "rayleigh", "timoshenko")


class Beam(LineElement):
    """A uniform beam in bending: length l [m], cross-sectional area A [m^2], second moment of area I [m^4].

    It joins planar nodes, the second one l further along x. ``f`` [N] and ``tau`` [N m] are the force and
    moment the beam delivers at its second end. ``eta`` [s] is Kelvin-Voigt damping: it multiplies E, and G
    in the Timoshenko theory, by 1 + eta*s. ``c_f`` and ``k_f`` are a viscous and an elastic foundation per
    length, ``N`` [N] is an axial force, positive in tension. For a slender beam (l/depth > 10), the
    Euler-Bernoulli theory is enough; Rayleigh adds rotary inertia, Timoshenko also shear. Source:
    Timoshenko, Young & Weaver 1974, Vibration Problems in Engineering, chapter 5.
    """

    type_name = "beam"
    summary = "Beam in bending between two planar nodes, uniform or tapered"
    ports = (Port("between", 2, "planar", "the two ends, the second one l further along x"),)
    parameters = (
        ParameterPort("E", "Pa", "Young's modulus", sign="positive"),
        ParameterPort("I", "m^4", "a second moment of area", sign="positive", varies=True),
        ParameterPort("rho", "kg/m^3", "a density", sign="nonnegative"),
        ParameterPort("A", "m^2", "a cross-sectional area", sign="nonnegative", varies=True),
        ParameterPort("l", "m", "a length"),
        ParameterPort("eta", "s", "a Kelvin-Voigt damping time constant", "0", sign="nonnegative"),
        ParameterPort("c_f", "N*s/m^2", "a viscous foundation", "0", varies=True),
        ParameterPort("k_f", "N/m^2", "an elastic foundation", "0", varies=True),
        ParameterPort("N", "N", "an axial force", "0", only=("euler-bernoulli", "rayleigh"), varies=True),
        ParameterPort("kappa", "1", "a shear coefficient", only=("timoshenko",), sign="positive"),
        ParameterPort("G", "Pa", "a shear modulus", only=("timoshenko",), sign="positive"),
        ParameterPort("EI", "N*m^2", "a bending stiffness", sign="positive", varies=True, of=("E", "I")),
        MASS_PER_LENGTH,
        ParameterPort(
            "rhoI",
            "kg*m",
            "a rotary inertia per length",
            only=("rayleigh", "timoshenko"),
            sign="nonnegative",
            varies=True,
            of=("rho", "I"),
        ),
        ParameterPort(
            "kappaGA",
            "N",
            "a shear stiffness",
            only=("timoshenko",),
            sign="positive",
            varies=True,
            of=("kappa", "G", "A"),
        ),
        LOSS_FACTOR,
    )
    choices = (Choice("theory", THEORIES, THEORIES[0], "a beam theory"),)
    through = ("f", "tau")
    ends = ("y", "theta")
    passive = Passivity()
    compliance = "bending"

    def theory(self, choices: Mapping[str, str]) -> str:
        """Return the field theory chosen."""
        return choices["theory"]


class FrameMember(LineElement):
    """A uniform member of a plane frame: it bends as a beam of any theory, and stretches as a rod.

    It joins nodes in the plane. The second one is l [m] away from the first, at an angle [rad] from the x
    axis, measured from x towards y. ``f_x``, ``f_y`` [N] and ``tau`` [N m] are the force and moment it
    delivers at its second end, along the axes x and y. At a point of the member, ``x``, ``y`` and ``theta``
    are its motion along these axes; ``u`` and ``v`` are its motion along the member and across it, to the
    left of its direction. ``f_x``, ``f_y``, ``tau``, ``f_u`` and ``f_v`` at a point are exerted by the part
    beyond it on the part before it: ``f_u = EA u'`` is positive in tension, ``tau = EI v''`` and ``f_v = -EI
    v'''`` in the Euler-Bernoulli theory. ``N`` [N] is a static axial force, positive in tension. ``c_f`` and
    ``k_f`` are a foundation per length that acts along and across the member. An ``inextensible`` member only
    bends. Everything else is as for ``beam`` and ``rod``. Valid for small motions, in which bending and
    stretching are uncoupled. Source: Clough & Penzien 1993, Dynamics of Structures, chapters 11 and 17.
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
