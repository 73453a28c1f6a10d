"""The element library. A new element is one file and one line in ``ELEMENTS``."""

from collections.abc import Iterable

from symflex.library import ParameterPort, Sign
from symflex.library.elements import coupling, line, lumped, rigid
from symflex.library.elements.element import (
    ACROSS_UNIT,
    CIRCUITS,
    COMPONENT_DOMAIN,
    COMPONENTS,
    DOMAINS,
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
    Terms,
    Variable,
    put_in,
)
from symflex.library.elements.line import LineElement

ELEMENTS: dict[str, Element] = {
    element.type_name: element
    for element in (
        lumped.Mass(),
        lumped.Spring(),
        lumped.Damper(),
        lumped.ForceSource(),
        lumped.Inertia(),
        lumped.TorsionSpring(),
        lumped.RotaryDamper(),
        lumped.TorqueSource(),
        rigid.RigidBody(),
        rigid.RigidLink(),
        rigid.MasslessBeam(),
        line.Beam(),
        line.FrameMember(),
        line.Rod(),
        line.Shaft(),
        line.String(),
        rigid.Fixed(),
        rigid.Slider(),
        rigid.Pin(),
        lumped.Resistor(),
        lumped.Inductor(),
        lumped.Capacitor(),
        lumped.VoltageSource(),
        lumped.CurrentSource(),
        coupling.DcMotor(),
        coupling.Piezo(),
        coupling.Transformer(),
        coupling.Gyrator(),
        coupling.VoiceCoil(),
        coupling.PlanetaryGear(),
        coupling.CoupledInductors(),
        coupling.OpAmp(),
        coupling.Vcvs(),
        coupling.Vccs(),
        coupling.Ccvs(),
        coupling.Cccs(),
        lumped.AcousticMass(),
        lumped.AcousticResistance(),
        lumped.AcousticCompliance(),
        lumped.PressureSource(),
        lumped.FlowSource(),
        lumped.ThermalResistance(),
        lumped.ThermalCapacity(),
        lumped.HeatSource(),
        lumped.TemperatureSource(),
        coupling.Piston(),
    )
}


def by_unit(elements: Iterable[Element]) -> dict[str, str]:
    """Return types of one value by its unit; ValueError if two have the same, as hints name one of them."""
    types: dict[str, str] = {}
    for element in elements:
        if isinstance(element, lumped.Branch | lumped.Impedance):
            unit = element.parameters[0].unit
            if unit in types:
                message = f"'{types[unit]}' and '{element.type_name}' both have one value in {unit}"
                raise ValueError(message + ": let the second one be no Branch or Impedance, but stamp itself")
            types[unit] = element.type_name
    return types


LUMPED = by_unit(ELEMENTS.values())
"""Elements of one value, by its unit."""
