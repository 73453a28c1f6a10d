"""The element library. A new element is one file and one line in ``ELEMENTS``."""

from symflex.library import ParameterPort, Sign
from symflex.library.elements.coupling import DcMotor, Gyrator, Piezo, Transformer
from symflex.library.elements.element import (
    ACROSS_UNIT,
    COMPONENT_DOMAIN,
    COMPONENT_UNIT,
    COMPONENTS,
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
from symflex.library.elements.frame import FrameMember
from symflex.library.elements.line import Beam, LineElement, Rod, Shaft, String
from symflex.library.elements.lumped import (
    Capacitor,
    CurrentSource,
    Damper,
    ForceSource,
    Inductor,
    Inertia,
    Mass,
    Resistor,
    RotaryDamper,
    Spring,
    TorqueSource,
    TorsionSpring,
    VoltageSource,
)
from symflex.library.elements.rigid import Fixed, MasslessBeam, Pin, RigidBody, RigidLink, Slider

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
        FrameMember(),
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
    "COMPONENTS",
    "COMPONENT_DOMAIN",
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
