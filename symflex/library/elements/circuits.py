"""Active and coupled parts of circuits: coupled inductors, operational amplifiers, controlled sources."""

from __future__ import annotations

from typing import ClassVar

from symflex.library import ParameterPort
from symflex.library.elements.element import (
    Element,
    ElementUse,
    EquationRow,
    Injection,
    LinearForm,
    Port,
    Stamp,
    delivered,
    difference,
)


class CoupledInductors(Element):
    """Two windings on one core: ``v_1 = s*(L_1*i_1 + M*i_2)`` and ``v_2 = s*(M*i_1 + L_2*i_2)``.

    The first two terminals are those of the first winding, with the dot at the first of them, the last two
    those of the second, with the dot at the third; ``i_1`` and ``i_2`` [A] flow in at the dots. Real windings
    have ``M^2 <= L_1*L_2``. An ideal transformer is a ``transformer``.
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
        for own, other, inductance, start, end in windings:
            law = LinearForm.of((own, inductance), (other, mutual), (start, -one), (end, one))
            rows.append(EquationRow(own, law))
            injections += [Injection(n, LinearForm.of((own, c))) for n, c in ((start, -one), (end, one))]
        return Stamp(
            unknowns=(first, second),
            rows=tuple(rows),
            injections=tuple(injections),
            through=tuple((v.component, LinearForm.of((v, one))) for v in (first, second)),
        )


class OpAmp(Element):
    """An operational amplifier: ``out = A(s)*(p - n)``, without input current and output resistance.

    Ideal where nothing is given: feedback keeps both inputs at one voltage. With the gain A at rest and the
    unity-gain frequency f_u, ``1/A(s) = 1/A + s/(2 pi f_u)``, without the term of what is left out. ``i`` [A]
    is delivered at the output. Source: Sedra & Smith 2004, Microelectronic Circuits, chapter 2.
    """

    type_name = "op_amp"
    summary = "Operational amplifier, ideal or of a gain and a bandwidth"
    ports = (
        Port("inputs", 2, "electrical", "the input that is not inverted, and the one that is"),
        Port("out", 1, "electrical", "node of the output"),
    )
    parameters = (
        ParameterPort("A", "1", "an open-loop gain, infinite where 0", "0"),
        ParameterPort("f_u", "rad/s", "a unity-gain frequency, infinite where 0", "0"),
    )
    through = ("i",)

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the current at the output, and the row ``p - n = out/A(s)``."""
        current, one = use.unknown("i"), use.one
        needed = one * 0
        for value, share in ((use.values["A"], one), (use.values["f_u"], use.s)):
            if not value.is_zero:
                needed += share / value
        common = needed.denominator()
        law = difference(use, "inputs", -common) + difference(use, "out", needed * common)
        flow = LinearForm.of((current, one))
        return Stamp(
            unknowns=(current,),
            rows=(EquationRow(current, law, "constraint"),),
            injections=delivered(use, "out", flow),
            through=(("i", flow),),
        )


class ControlledSource(Element):
    """Base of the four controlled sources: a voltage or a current, by a voltage or a current."""

    is_voltage: ClassVar[bool]
    """Whether the value is a voltage."""
    by_current: ClassVar[bool]
    """Whether it follows the current from the first input to the second, which are then one node."""
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
        own = difference(use, "terminals", common) if self.is_voltage else LinearForm.of((current, common))
        law = own + control * (-gain * common)
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
    Port("inputs", 2, "electrical", "the two nodes between which the current flows that controls it"),
    SENSED[1],
)


class Vcvs(ControlledSource):
    """A voltage source that a voltage controls: ``v_1 - v_2 = mu*(in_1 - in_2)``.

    ``i`` [A] is delivered into the first terminal.
    """

    type_name = "vcvs"
    summary = "Voltage source controlled by a voltage"
    ports = SENSED
    parameters = (ParameterPort("mu", "1", "a voltage gain"),)
    is_voltage, by_current = True, False


class Vccs(ControlledSource):
    """A current source that a voltage controls: ``i = g*(in_1 - in_2)`` [A].

    It is delivered into the first terminal, and the second gives it.
    """

    type_name = "vccs"
    summary = "Current source controlled by a voltage"
    ports = SENSED
    parameters = (ParameterPort("g", "A/V", "a transconductance"),)
    is_voltage, by_current = False, False


class Ccvs(ControlledSource):
    """A voltage source that a current controls: ``v_1 - v_2 = r*i_in``; ``i_in`` flows from in_1 to in_2.

    ``i`` [A] is delivered into the first terminal.
    """

    type_name = "ccvs"
    summary = "Voltage source controlled by a current"
    ports = FELT
    parameters = (ParameterPort("r", "Ohm", "a transresistance"),)
    is_voltage, by_current = True, True


class Cccs(ControlledSource):
    """A current source that a current controls: ``i = beta*i_in`` [A]; ``i_in`` flows from in_1 to in_2.

    It is delivered into the first terminal, and the second gives it.
    """

    type_name = "cccs"
    summary = "Current source controlled by a current"
    ports = FELT
    parameters = (ParameterPort("beta", "1", "a current gain"),)
    is_voltage, by_current = False, True
