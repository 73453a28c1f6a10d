"""The element library. A new element is one file and one line in ``ELEMENTS``."""

from symflex.library.elements.axial import Rod, Shaft, String
from symflex.library.elements.beam import Beam, MasslessBeam
from symflex.library.elements.coupling import Gyrator, Transformer
from symflex.library.elements.electrical import Capacitor, Inductor, Resistor
from symflex.library.elements.element import (
    ACROSS_UNIT,
    COMPONENT_UNIT,
    THROUGH_NAME,
    THROUGH_UNIT,
    Admittance,
    Choice,
    Domain,
    Element,
    ElementUse,
    EquationRow,
    Injection,
    LinearForm,
    Placing,
    Port,
    PortTerminal,
    Stamp,
    Variable,
)
from symflex.library.elements.line import LineElement
from symflex.library.elements.rigid import Fixed, Pin, RigidBody, RigidLink, Slider
from symflex.library.elements.rotation import Inertia, RotaryDamper, TorsionSpring
from symflex.library.elements.source import CurrentSource, ForceSource, TorqueSource, VoltageSource
from symflex.library.elements.transducers import DcMotor, Piezo
from symflex.library.elements.translation import Damper, Mass, Spring
from symflex.library.parameter import ParameterPort, Sign

ELEMENTS: dict[str, Element] = {
    element.type_name: element
    for element in (
        Mass(),
        Spring(),
        Damper(),
        ForceSource(),
        Inertia(),
        TorsionSpring(),
        RotaryDamper(),
        TorqueSource(),
        RigidBody(),
        RigidLink(),
        MasslessBeam(),
        Beam(),
        Rod(),
        Shaft(),
        String(),
        Fixed(),
        Slider(),
        Pin(),
        Resistor(),
        Inductor(),
        Capacitor(),
        VoltageSource(),
        CurrentSource(),
        DcMotor(),
        Piezo(),
        Transformer(),
        Gyrator(),
    )
}

__all__ = [
    "ACROSS_UNIT",
    "COMPONENT_UNIT",
    "ELEMENTS",
    "THROUGH_NAME",
    "THROUGH_UNIT",
    "Admittance",
    "Choice",
    "Domain",
    "Element",
    "ElementUse",
    "EquationRow",
    "Injection",
    "LineElement",
    "LinearForm",
    "ParameterPort",
    "Placing",
    "Port",
    "PortTerminal",
    "Sign",
    "Stamp",
    "Variable",
]
