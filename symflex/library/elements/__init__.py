"""The element library. A new element is one file and one line in ``ELEMENTS``."""

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

LUMPED: dict[str, str] = {
    e.parameters[0].unit: e.type_name
    for e in ELEMENTS.values()
    if isinstance(e, lumped.Branch | lumped.Impedance)
}
"""Elements of one value, by its unit, and no two have the same."""
