"""The element library. A new element is one file and one line in ``ELEMENTS``."""

from symflex.elements.capacitor import Capacitor
from symflex.elements.constraint import Fixed, Pin, Slider
from symflex.elements.coupling import Gyrator, Transformer
from symflex.elements.damper import Damper
from symflex.elements.dc_motor import DcMotor
from symflex.elements.element import (
    ACROSS_UNIT,
    THROUGH_NAME,
    THROUGH_UNIT,
    Branch,
    Domain,
    Element,
    ElementUse,
    Injection,
    LinearForm,
    ParameterPort,
    Placing,
    Port,
    Row,
    Stamp,
    Terminal,
    Variable,
)
from symflex.elements.impedance import Inductor, Resistor
from symflex.elements.inertia import Inertia
from symflex.elements.mass import Mass
from symflex.elements.massless_beam import MasslessBeam
from symflex.elements.rigid import RigidBody, RigidLink
from symflex.elements.rotary_damper import RotaryDamper
from symflex.elements.source import CurrentSource, ForceSource, TorqueSource, VoltageSource
from symflex.elements.spring import Spring
from symflex.elements.torsion_spring import TorsionSpring

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
        Fixed(),
        Slider(),
        Pin(),
        Resistor(),
        Inductor(),
        Capacitor(),
        VoltageSource(),
        CurrentSource(),
        DcMotor(),
        Transformer(),
        Gyrator(),
    )
}

ANNOUNCED = ("beam", "rod", "shaft", "string")
"""Element types of the specification language that a later version will bring."""

__all__ = [
    "ACROSS_UNIT",
    "ANNOUNCED",
    "ELEMENTS",
    "THROUGH_NAME",
    "THROUGH_UNIT",
    "Branch",
    "Domain",
    "Element",
    "ElementUse",
    "Injection",
    "LinearForm",
    "ParameterPort",
    "Placing",
    "Port",
    "Row",
    "Stamp",
    "Terminal",
    "Variable",
]
