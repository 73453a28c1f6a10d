"""What couples ports: gears, levers and gyrators of any domains, motors, pistons, transducers.

Coupled inductors, operational amplifiers and controlled sources couple those of a circuit.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from symflex.library import ParameterPort
from symflex.library.elements.element import (
    ACROSS_UNIT,
    CIRCUITS,
    DOMAINS,
    THROUGH_NAME,
    THROUGH_UNIT,
    Element,
    ElementUse,
    EquationRow,
    Injection,
    LinearForm,
    Passivity,
    Port,
    Stamp,
    delivered,
    determined,
    difference,
)

if TYPE_CHECKING:
    from symflex.algebra import Factored
    from symflex.library.elements.element import Placing, Variable


PER_FLOW: dict[str, str] = dict(zip(DOMAINS, ("*s/m", "*s/rad", "/A", "*s/m^3", "/W"), strict=True))
"""One over the unit of what flows: a velocity, a current, a volume or heat flow."""


class TwoPort(Element):
    """Base of what joins two nodes of any domains, and is named after what it delivers at ``to``."""

    ports = (
        Port("from", 1, "any", "node of the driving side", reacts=True),
        Port("to", 1, "any", "node of the driven side", reacts=True),
    )
    through = tuple(THROUGH_NAME.values())

    def quantities(self, domains: Mapping[str, Placing]) -> tuple[str, ...]:
        """Return the quantity delivered at ``to``."""
        return (THROUGH_NAME[domains["to"]],)


class Transformer(TwoPort):
    """A gear, rack, screw, lever or electrical transformer: ``to = ratio * from``.

    Each side is a node, or a pair of nodes, of which the first is taken relative to the second. The ratio
    holds between displacements [m], angles [rad] or voltages [V]. ``f``, ``tau`` or ``i``, depending on the
    domain of ``to``, is delivered at ``to``; ``ratio`` times as much is drawn at ``from``. No power is lost
    between two motions, nor between voltages or pressures.
    """

    type_name = "transformer"
    summary = "Gear, rack, screw, lever or electrical transformer: to = ratio * from"
    parameters = (ParameterPort("ratio", "", "a transformer ratio"),)
    passive = Passivity(of_any_sign=("ratio",), is_alike=True)
    moves_as_one = True

    def unit_of(self, quantity: str, domains: Mapping[str, Placing]) -> str:
        """Return the ratio's unit, that of ``to`` over that of ``from``."""
        if quantity == "ratio":
            target, source = ACROSS_UNIT[domains["to"]], ACROSS_UNIT[domains["from"]]
            return "1" if target == source else f"{target}/{source}"
        return super().unit_of(quantity, domains)

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the through variable at ``to`` and the row ``to - ratio*from = 0``."""
        quantity = THROUGH_NAME[use.domains["to"]]
        through = use.unknown(quantity)
        ratio = use.values["ratio"]
        denominator, numerator = ratio.denominator(), ratio * ratio.denominator()
        # The unknown is the through variable over the ratio's denominator: both sides stay polynomial.
        law = difference(use, "to", denominator) + difference(use, "from", -numerator)
        given, drawn = LinearForm.of((through, denominator)), LinearForm.of((through, -numerator))
        return Stamp(
            unknowns=(through,),
            rows=(EquationRow(through, law, "constraint"),),
            injections=(*delivered(use, "to", given), *delivered(use, "from", drawn)),
            through=((quantity, given),),
        )


class Gyrator(TwoPort):
    """A lossless coupling: ``effort_from = ratio*flow_to``, ``effort_to = ratio*flow_from``.

    Effort is force [N], torque [N m] or voltage [V]; flow is velocity [m/s, rad/s] or current [A]. Power
    drawn at ``from`` is delivered at ``to``. ``f``, ``tau`` or ``i``, depending on the domain of ``to``, is
    delivered there.
    """

    type_name = "gyrator"
    summary = "Gyrator: effort at one port proportional to flow at the other"
    parameters = (ParameterPort("ratio", "", "a gyrator ratio"),)
    passive = Passivity(of_any_sign=("ratio",))
    moves_as_one = True

    def unit_of(self, quantity: str, domains: Mapping[str, Placing]) -> str:
        """Return the ratio's unit, effort at ``from`` over flow at ``to``."""
        if quantity == "ratio":
            source, target = domains["from"], domains["to"]
            effort = ACROSS_UNIT[source] if source in CIRCUITS else THROUGH_UNIT[source]
            return effort + PER_FLOW[target]
        return super().unit_of(quantity, domains)

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the through variables of both ports and the two crossing rows."""
        ratio = use.values["ratio"]
        denominator, numerator = ratio.denominator(), ratio * ratio.denominator()
        quantity = THROUGH_NAME[use.domains["to"]]
        drawn, given = use.unknown("drawn"), use.unknown(quantity)
        crossed = (("from", drawn, "to", given), ("to", given, "from", drawn))
        rows = tuple(
            EquationRow(
                driven,
                self._effort(use, port, driven, denominator) + self._flow(use, other, through, -numerator),
                "constraint",
            )
            for port, driven, other, through in crossed
        )
        into, out_of = LinearForm.of((given, use.one)), LinearForm.of((drawn, -use.one))
        return Stamp(
            unknowns=(drawn, given),
            rows=rows,
            injections=(*delivered(use, "from", out_of), *delivered(use, "to", into)),
            through=((quantity, into),),
        )

    @staticmethod
    def _effort(use: ElementUse, port: str, through: Variable, scale: Factored) -> LinearForm:
        if use.domains[port] in CIRCUITS:
            return difference(use, port, scale)
        return LinearForm.of((through, scale))

    @staticmethod
    def _flow(use: ElementUse, port: str, through: Variable, scale: Factored) -> LinearForm:
        if use.domains[port] in CIRCUITS:
            return LinearForm.of((through, scale))
        return difference(use, port, scale * use.s)


class ElectricMotor(Element):
    """Base of motors: a winding whose current pushes what moves, and is pushed against by its motion."""

    constants: ClassVar[tuple[str, str]]  # the force or torque per current, and the voltage per velocity
    moves_as_one = True

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the winding current, its row, and what it delivers."""
        moved, quantity = self.ports[1].name, self.through[1]
        effort, voltage = (use.values[name] for name in self.constants)
        current = use.unknown("i")
        winding = use.values["L"] * use.s + use.values["R"]
        law = LinearForm.of((current, winding)) + difference(use, moved, voltage * use.s)
        law += difference(use, "terminals", -use.one)
        flow, pushed = LinearForm.of((current, use.one)), LinearForm.of((current, effort))
        return Stamp(
            unknowns=(current,),
            rows=(EquationRow(current, law),),
            injections=(*delivered(use, "terminals", flow * (-use.one)), *delivered(use, moved, pushed)),
            through=(("i", flow), (quantity, pushed)),
        )


class DcMotor(ElectricMotor):
    """A dc motor: ``(L*s + R)*i + k_e*s*theta = v_a - v_b`` and torque ``k_t*i`` on the shaft.

    ``i`` [A] flows from the first terminal to the second; ``tau`` [N m] is the torque delivered
    to the shaft. k_e [V s/rad] defaults to k_t [N m/A], to which it is equal in SI units. A second node of
    the shaft is the stator: it takes the reaction, and theta is the rotor's angle relative to it.
    """

    type_name = "dc_motor"
    summary = "Direct-current motor with winding resistance and inductance"
    ports = (
        Port("terminals", 2, "electrical", "the two electrical terminals"),
        Port("shaft", 1, "rotation", "node of the shaft's angle", reacts=True),
    )
    parameters = (
        ParameterPort("L", "H", "an inductance", "0"),
        ParameterPort("R", "Ohm", "a resistance", "0"),
        ParameterPort("k_t", "N*m/A", "a torque constant"),
        ParameterPort("k_e", "V*s/rad", "a back-emf constant", "k_t"),
    )
    through = ("i", "tau")
    constants = ("k_t", "k_e")
    passive = Passivity(of_any_sign=constants, equal=constants)


class VoiceCoil(ElectricMotor):
    """A voice coil or linear motor: ``(L*s + R)*i + k_e*s*x = v_a - v_b`` and force ``k_f*i`` on the mover.

    ``i`` [A] flows from the first terminal to the second; ``f`` [N] is the force delivered to the mover.
    k_e [V s/m] defaults to k_f [N/A], to which it is equal in SI units. A second node of the mover carries
    the magnet: it takes the reaction, and x is the motion relative to it.
    """

    type_name = "voice_coil"
    summary = "Voice coil or linear motor with resistance and inductance"
    ports = (
        Port("terminals", 2, "electrical", "the two electrical terminals"),
        Port("mover", 1, "translation", "node that moves with the coil", reacts=True),
    )
    parameters = (
        ParameterPort("L", "H", "an inductance", "0"),
        ParameterPort("R", "Ohm", "a resistance", "0"),
        ParameterPort("k_f", "N/A", "a force constant"),
        ParameterPort("k_e", "V*s/m", "a back-emf constant", "k_f"),
    )
    through = ("i", "f")
    constants = ("k_f", "k_e")
    passive = Passivity(of_any_sign=constants, equal=constants)


class PlanetaryGear(Element):
    """An ideal planetary gear: ``sun + rho*ring = (1 + rho)*carrier``, of the three angles [rad].

    rho is the number of teeth of the ring over that of the sun; ``tau`` [N m] is the torque delivered to
    the sun, while the ring gets ``rho*tau`` and the carrier ``-(1 + rho)*tau``. With one of the three at
    ``"ground"``, it is a gear with a fixed ratio. Source: Willis 1841, Principles of Mechanism.
    """

    type_name = "planetary_gear"
    summary = "Planetary gear of sun, ring and carrier"
    ports = (
        Port("sun", 1, "rotation", "node of the sun's angle"),
        Port("ring", 1, "rotation", "node of the ring's angle"),
        Port("carrier", 1, "rotation", "node of the carrier's angle"),
    )
    parameters = (ParameterPort("rho", "1", "a ratio of teeth, ring over sun"),)
    through = ("tau",)
    passive = Passivity(of_any_sign=("rho",))

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the torque on the sun, and Willis' equation."""
        rho, torque = use.values["rho"], use.unknown("tau")
        denominator = rho.denominator()
        shares = (denominator, rho * denominator, -(denominator + rho * denominator))
        nodes = [use.across(port.name)[0] for port in self.ports]
        law = LinearForm.of(*zip(nodes, shares, strict=True))
        given = LinearForm.of((torque, use.one))
        return Stamp(
            unknowns=(torque,),
            rows=(EquationRow(torque, law, "constraint"),),
            injections=tuple(Injection(n, given * c) for n, c in zip(nodes, shares, strict=True)),
            through=(("tau", given * denominator),),
        )


class Piston(Element):
    """A piston or diaphragm of area A [m^2]: it moves air or liquid, and the pressure acts on it.

    When the mover moves along x, ``q = A*s*x`` [m^3/s] flows into the first node of ``chamber`` and, if
    there is a second, out of that. The force on the mover is ``f = -A*(p_1 - p_2)`` [N]. Source: Beranek
    1954, Acoustics, chapter 3.
    """

    type_name = "piston"
    summary = "Piston, diaphragm or cylinder between motion and pressure"
    ports = (
        Port("mover", 1, "translation", "node that moves with the piston", reacts=True),
        Port("chamber", 1, "acoustic", "node of the pressure in front of it", reacts=True),
    )
    parameters = (ParameterPort("A", "m^2", "an area"),)
    through = ("f", "q")
    passive = Passivity(of_any_sign=("A",))

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the flow and the force, which need no unknowns."""
        area = use.values["A"]
        flow, force = difference(use, "mover", area * use.s), difference(use, "chamber", -area)
        return Stamp(
            injections=(*delivered(use, "chamber", flow), *delivered(use, "mover", force)),
            through=(("f", force), ("q", flow)),
        )


class Piezo(Element):
    """A piezoelectric stack, linear: a voltage pushes its ends apart, and their motion drives a charge.

    With v the voltage of the first terminal relative to the second, and x_a, x_b the displacements of the
    ends, ``f = alpha*v + k*(x_a - x_b)`` [N] pushes the second end, with its reaction on the first, and
    ``i = C*s*v - alpha*s*(x_a - x_b)`` [A] flows from the first terminal to the second. alpha [N/V] equals
    C/m, or A*s/m; C [F] is the capacitance with the ends held, k [N/m] the stiffness with the terminals
    short-circuited. Charge sensitivity d [m/V] is alpha/k, and the open-circuit voltage per extension alpha/C
    [V/m]. Source: Preumont 2006, Mechatronics, chapter 4.
    """

    type_name = "piezo"
    summary = "Piezoelectric transducer between electrical terminals and two ends"
    ports = (
        Port("terminals", 2, "electrical", "the two electrical terminals"),
        Port("between", 2, "translation", "the two ends, the second one further along x"),
    )
    parameters = (
        ParameterPort("alpha", "N/V", "a transduction coefficient"),
        ParameterPort("C", "F", "a capacitance", "0"),
        ParameterPort("k", "N/m", "a stiffness", "0"),
    )
    through = ("f", "i")
    passive = Passivity(of_any_sign=("alpha",))

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the force and the current, and their rows."""
        (p, q), (a, b) = use.across("terminals"), use.across("between")
        alpha, one = use.values["alpha"], use.one
        force, current = use.unknown("f"), use.unknown("i")
        laws = ((force, alpha, use.values["k"]), (current, use.values["C"] * use.s, alpha * use.s * -1))
        rows = tuple(
            EquationRow(
                out, LinearForm.of((out, one), (p, -per_volt), (q, per_volt), (a, -per_metre), (b, per_metre))
            )
            for out, per_volt, per_metre in laws
        )
        delivered = ((a, force, -one), (b, force, one), (p, current, -one), (q, current, one))
        return Stamp(
            unknowns=(force, current),
            rows=rows,
            injections=tuple(Injection(node, LinearForm.of((v, sign))) for node, v, sign in delivered),
            through=tuple((v.component, LinearForm.of((v, one))) for v in (force, current)),
        )


class CoupledInductors(Element):
    """Two windings on one core: ``v_1 = s*(L_1*i_1 + M*i_2)`` and ``v_2 = s*(M*i_1 + L_2*i_2)``.

    Terminals one and two belong to the first winding, three and four to the second; the dots are at
    terminals one and three. ``i_1`` and ``i_2`` [A] flow in at the dots. Real windings have
    ``M^2 <= L_1*L_2``. An ideal transformer is a ``transformer``.
    """

    type_name = "coupled_inductors"
    summary = "Two windings on one core"
    ports = (Port("terminals", 4, "electrical", "both ends of the first winding, then of the second"),)
    parameters = (
        ParameterPort("L_1", "H", "an inductance"),
        ParameterPort("L_2", "H", "an inductance"),
        ParameterPort("M", "H", "a mutual inductance"),
    )
    through = ("i_1", "i_2")
    passive = Passivity(of_any_sign=("M",), definite=("L_1", "L_2", "M"))

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute both currents and the rows of both windings."""
        a, b, c, d = use.across("terminals")
        mutual, one = use.values["M"] * use.s, use.one
        first, second = (use.unknown(quantity) for quantity in self.through)
        windings = (
            (first, second, use.values["L_1"] * use.s, a, b),
            (second, first, use.values["L_2"] * use.s, c, d),
        )
        rows, injections = [], []
        for current, other, inductance, start, end in windings:
            law = LinearForm.of((current, inductance), (other, mutual), (start, -one), (end, one))
            rows.append(EquationRow(current, law))
            injections += [Injection(n, LinearForm.of((current, c))) for n, c in ((start, -one), (end, one))]
        return Stamp(
            unknowns=(first, second),
            rows=tuple(rows),
            injections=tuple(injections),
            through=tuple((v.component, LinearForm.of((v, one))) for v in (first, second)),
        )


class OpAmp(Element):
    """An operational amplifier: ``out = A(s)*(p - n)``, with no input current and no output resistance.

    Without ``A`` and ``f_u`` it is ideal: feedback keeps both inputs at the same voltage. With a DC gain A
    and a unity-gain frequency f_u, ``1/A(s) = 1/A + s/(2 pi f_u)``; the term of a parameter that is
    not given is zero. ``i`` [A] is delivered at the output. Source: Sedra & Smith 2004, Microelectronic
    Circuits, chapter 2.
    """

    type_name = "op_amp"
    summary = "Operational amplifier, ideal or of a gain and a bandwidth"
    ports = (
        Port("inputs", 2, "electrical", "the noninverting input, and the inverting one"),
        Port("out", 1, "electrical", "node of the output"),
    )
    parameters = (
        ParameterPort("A", "1", "an open-loop gain, infinite if 0", "0"),
        ParameterPort("f_u", "rad/s", "a unity-gain frequency, infinite if 0", "0"),
    )
    through = ("i",)

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the current at the output, and the row ``p - n = out/A(s)``."""
        one, needed = use.one, use.one * 0
        for value, share in ((use.values["A"], one), (use.values["f_u"], use.s)):
            if not value.is_zero:
                needed += share / value
        common = needed.denominator()
        law = difference(use, "inputs", -common) + difference(use, "out", needed * common)
        return determined(use, "out", "i", law, one, "constraint")


class ControlledSource(Element):
    """Base of the four controlled sources: a voltage or a current, by a voltage or a current."""

    is_voltage: ClassVar[bool]  # whether the value is a voltage
    by_current: ClassVar[bool]  # it follows the current from first to second input, then one node
    through = ("i",)

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the current delivered, with the one that controls it, and their rows."""
        gain, one = use.values[self.parameters[0].name], use.one
        common, current = gain.denominator(), use.unknown("i")
        control, unknowns = difference(use, "inputs", one), [current]
        rows: list[EquationRow] = []
        injections: list[Injection] = []
        if self.by_current:
            felt = use.unknown("felt")
            rows.append(EquationRow(felt, control, "constraint"))
            control = LinearForm.of((felt, one))
            injections += delivered(use, "inputs", control * (-one))
            unknowns.append(felt)
        effort = difference(use, "terminals", common) if self.is_voltage else LinearForm.of((current, common))
        law = effort + control * (-gain * common)
        rows.append(EquationRow(current, law, "constraint" if self.is_voltage else "law"))
        flow = LinearForm.of((current, one))
        return Stamp(
            unknowns=tuple(unknowns),
            rows=tuple(rows),
            injections=(*injections, *delivered(use, "terminals", flow)),
            through=(("i", flow),),
        )


SENSED: tuple[Port, Port] = (
    Port("inputs", 2, "electrical", "the two nodes whose voltage controls it"),
    Port("terminals", 2, "electrical", "the two terminals of the source"),
)
FELT: tuple[Port, Port] = (
    Port("inputs", 2, "electrical", "the two nodes between which the controlling current flows"),
    SENSED[1],
)


class Vcvs(ControlledSource):
    """A voltage-controlled voltage source: ``v_1 - v_2 = mu*(in_1 - in_2)``.

    ``i`` [A] is delivered into the first terminal.
    """

    type_name = "vcvs"
    summary = "Voltage source controlled by a voltage"
    ports = SENSED
    parameters = (ParameterPort("mu", "1", "a voltage gain"),)
    is_voltage, by_current = True, False


class Vccs(ControlledSource):
    """A voltage-controlled current source: ``i = g*(in_1 - in_2)`` [A].

    It is delivered into the first terminal, and drawn from the second.
    """

    type_name = "vccs"
    summary = "Current source controlled by a voltage"
    ports = SENSED
    parameters = (ParameterPort("g", "A/V", "a transconductance"),)
    is_voltage, by_current = False, False


class Ccvs(ControlledSource):
    """A current-controlled voltage source: ``v_1 - v_2 = r*i_in``; ``i_in`` flows from in_1 to in_2.

    ``i`` [A] is delivered into the first terminal.
    """

    type_name = "ccvs"
    summary = "Voltage source controlled by a current"
    ports = FELT
    parameters = (ParameterPort("r", "Ohm", "a transresistance"),)
    is_voltage, by_current = True, True


class Cccs(ControlledSource):
    """A current-controlled current source: ``i = beta*i_in`` [A]; ``i_in`` flows from in_1 to in_2.

    It is delivered into the first terminal, and drawn from the second.
    """

    type_name = "cccs"
    summary = "Current source controlled by a current"
    ports = FELT
    parameters = (ParameterPort("beta", "1", "a current gain"),)
    is_voltage, by_current = False, True
