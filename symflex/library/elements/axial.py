"""Line elements with one motion along x: rods in tension, shafts in torsion and stretched strings."""

from __future__ import annotations

from symflex.library.elements.element import Passivity, Port
from symflex.library.elements.line import LineElement
from symflex.library.parameter import ParameterPort


class Rod(LineElement):
    """A uniform rod of length l [m] and cross-section A [m^2] in tension and compression.

    ``f`` [N] is the force the rod delivers at its second end. ``eta`` [s] is Kelvin-Voigt damping,
    ``c_f`` and ``k_f`` a viscous and an elastic foundation per length.
    Source: Timoshenko, Young & Weaver 1974, Vibration Problems in Engineering, chapter 5.
    """

    type_name = "rod"
    summary = "Uniform rod in tension and compression"
    ports = (Port("between", 2, "translation", "the two ends, the second one l further along x"),)
    parameters = (
        ParameterPort("E", "Pa", "a modulus of elasticity", sign="positive"),
        ParameterPort("A", "m^2", "a cross-section", sign="positive"),
        ParameterPort("rho", "kg/m^3", "a density", sign="nonnegative"),
        ParameterPort("l", "m", "a length"),
        ParameterPort("eta", "s", "a Kelvin-Voigt loss time", "0", sign="nonnegative"),
        ParameterPort("c_f", "N*s/m^2", "a viscous foundation", "0"),
        ParameterPort("k_f", "N/m^2", "an elastic foundation", "0"),
    )
    through = ("f",)
    ends = ("across",)
    passive = Passivity()
    compliance = "stretching"


class Shaft(LineElement):
    """A uniform shaft of length l [m] and polar second moment of area J [m^4] in torsion.

    ``tau`` [N m] is the torque the shaft delivers at its second end. ``eta`` [s] is Kelvin-Voigt damping,
    ``c_f`` and ``k_f`` a viscous and an elastic foundation per length. For a section that is not circular, G
    stands for G times the torsion constant over J.
    Source: Timoshenko, Young & Weaver 1974, Vibration Problems in Engineering, chapter 5.
    """

    type_name = "shaft"
    summary = "Uniform shaft in torsion"
    ports = (Port("between", 2, "rotation", "the two ends, the second one l further along x"),)
    parameters = (
        ParameterPort("G", "Pa", "a shear modulus", sign="positive"),
        ParameterPort("J", "m^4", "a polar second moment of area", sign="positive"),
        ParameterPort("rho", "kg/m^3", "a density", sign="nonnegative"),
        ParameterPort("l", "m", "a length"),
        ParameterPort("eta", "s", "a Kelvin-Voigt loss time", "0", sign="nonnegative"),
        ParameterPort("c_f", "N*m*s/m", "a viscous foundation", "0"),
        ParameterPort("k_f", "N*m/m", "an elastic foundation", "0"),
    )
    through = ("tau",)
    ends = ("across",)
    passive = Passivity()
    compliance = "stretching"


class String(LineElement):
    """A string of length l [m], cross-section A [m^2] and tension N [N], deflected across its length.

    ``f`` [N] is the transverse force the string delivers at its second end. ``c_f`` and ``k_f`` are a
    viscous and an elastic foundation per length.
    Source: Timoshenko, Young & Weaver 1974, Vibration Problems in Engineering, chapter 5.
    """

    type_name = "string"
    summary = "Stretched string, deflected across its length"
    ports = (Port("between", 2, "translation", "the two ends, the second one l further along x"),)
    parameters = (
        ParameterPort("N", "N", "a tension", sign="positive"),
        ParameterPort("rho", "kg/m^3", "a density", sign="nonnegative"),
        ParameterPort("A", "m^2", "a cross-section", sign="nonnegative"),
        ParameterPort("l", "m", "a length"),
        ParameterPort("c_f", "N*s/m^2", "a viscous foundation", "0"),
        ParameterPort("k_f", "N/m^2", "an elastic foundation", "0"),
    )
    through = ("f",)
    ends = ("across",)
    passive = Passivity()
    compliance = "stretching"
