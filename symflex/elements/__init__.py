"""The element library. A new element is one file and one line in ``ELEMENTS``."""

from symflex.elements.axial import Rod, Shaft, String
from symflex.elements.beam import Beam
from symflex.elements.constraint import Fixed, Pin, Slider
from symflex.elements.coupling import Gyrator, Transformer
from symflex.elements.dc_motor import DcMotor
from symflex.elements.electrical import Capacitor, Inductor, Resistor
from symflex.elements.element import (
    ACROSS_UNIT,
    COMPONENT_UNIT,
    THROUGH_NAME,
    THROUGH_UNIT,
    Branch,
    Choice,
    Domain,
    Element,
    ElementUse,
    Injection,
    LinearForm,
    ParameterPort,
    Placing,
    Port,
    Row,
    Sign,
    Stamp,
    Terminal,
    Variable,
)
from symflex.elements.line import LineElement
from symflex.elements.massless_beam import MasslessBeam
from symflex.elements.piezo import Piezo
from symflex.elements.rigid import RigidBody, RigidLink
from symflex.elements.rotation import Inertia, RotaryDamper, TorsionSpring
from symflex.elements.source import CurrentSource, ForceSource, TorqueSource, VoltageSource
from symflex.elements.translation import Damper, Mass, Spring

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
    "Branch",
    "Choice",
    "Domain",
    "Element",
    "ElementUse",
    "Injection",
    "LineElement",
    "LinearForm",
    "ParameterPort",
    "Placing",
    "Port",
    "Row",
    "Sign",
    "Stamp",
    "Terminal",
    "Variable",
]
