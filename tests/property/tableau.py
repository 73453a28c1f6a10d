"""The transfer functions of a network at one complex s, by a dense tableau.

Unknowns are all coordinates, one through variable for every branch of every element, and all signals; the
rows are one balance for each coordinate and one law for each branch or signal, written here from the
definitions of the elements. symflex assembles something else and solves it otherwise.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field

import numpy as np

from tests.independent import dense
from tests.random_models import GROUND, SOURCES, TWO_TERMINAL, Element, Network, Term

AXES = {"translation": "y", "rotation": "theta"}


@dataclass(frozen=True, slots=True)
class Response:
    """A value of a transfer function, and the size of what it was computed from."""

    value: complex
    scale: float


def respond(network: Network, output: str, input_name: str, s: complex) -> Response:
    """Return ``output/input_name`` at ``s``.

    Raises
    ------
    numpy.linalg.LinAlgError
        When s is a pole.
    """
    tableau = _Tableau(network, np.clongdouble(s), input_name)
    for element in network.elements:
        tableau.add_element(element)
    for name, terms in network.signals:
        tableau.law(((name, 1), *tableau.negative(terms)))
    tableau.add_inputs()
    motion = tableau.solve()
    terms = dict(network.outputs)[output]
    parts = [tableau.coefficient(term) * motion[term.quantity] for term in terms]
    size = max(abs(value) for value in motion.values())
    weight = sum(abs(tableau.coefficient(term)) for term in terms)
    return Response(complex(sum(parts)), float(weight * size))


def block_value(block: Element, s: np.clongdouble) -> np.clongdouble:
    """Return a block's transfer function at ``s``."""
    v = block.value
    if block.kind == "resonance":
        zeros = s**2 + 2 * v("zeta_z") * v("omega_z") * s + v("omega_z") ** 2
        poles = s**2 + 2 * v("zeta_p") * v("omega_p") * s + v("omega_p") ** 2
        return v("omega_p") ** 2 / v("omega_z") ** 2 * zeros / poles
    if block.kind in ("notch", "low_pass"):
        omega, zeta = v("omega"), v("zeta_p" if block.kind == "notch" else "zeta")
        above = (
            s**2 + 2 * v("zeta_z") * omega * s + omega**2 if block.kind == "notch" else v("k", 1) * omega**2
        )
        return above / (s**2 + 2 * zeta * omega * s + omega**2)
    if block.kind == "tf":
        return (1 + v("T_1") * s) / ((1 + v("T_2") * s) * (1 + v("T_3") * s))
    if block.kind == "integrator":
        return v("k", 1) / s
    if block.kind == "lead_lag":
        return v("k", 1) * (1 + v("T_1") * s) / (1 + v("T_2") * s)
    return v("k_p") + v("k_i") / s + v("k_d") * s / (1 + v("T_f") * s)


@dataclass
class _Tableau:
    """Rows under construction; each is a mapping from unknowns to coefficients, the key "" for the input."""

    network: Network
    s: np.clongdouble
    driven: str
    rows: list[dict] = field(default_factory=list)
    balances: dict[str, dict] = field(default_factory=lambda: defaultdict(dict))

    def law(self, entries: tuple) -> None:
        """Add the row ``sum of coefficient * unknown = 0``; ground drops out."""
        row: dict = defaultdict(lambda: np.clongdouble(0))
        inputs = {entry.name for entry in self.network.inputs}
        for quantity, coefficient in entries:
            if quantity in inputs:
                row[""] += coefficient if quantity == self.driven else 0
            elif quantity != GROUND:
                row[quantity] += coefficient
        self.rows.append(row)

    def deliver(self, coordinate: str, unknown: str, coefficient: complex = 1) -> None:
        """Let a through variable push on a coordinate (flow into a node)."""
        if coordinate != GROUND:
            balance = self.balances[coordinate]
            balance[unknown] = balance.get(unknown, 0) + coefficient

    def coefficient(self, term: Term) -> np.clongdouble:
        """Return what a term multiplies its quantity by."""
        blocks = {block.name: block for block in self.network.blocks}
        value = term.sign * self.s**term.power
        for gain in term.gains:
            value = value * gain.value
        for name in term.blocks:
            value = value * block_value(blocks[name], self.s)
        return value

    def negative(self, terms: tuple[Term, ...]) -> tuple:
        return tuple((term.quantity, -self.coefficient(term)) for term in terms)

    def axis(self, node: str, domain: str) -> str:
        """Return the coordinate a port means: y or theta of a planar node, by the domain."""
        planar = f"{node}.y" in dict(self.network.coordinates)
        return f"{node}.{AXES[domain]}" if planar else node

    # -- the laws of the elements

    def add_element(self, element: Element) -> None:
        if element.kind in TWO_TERMINAL:
            self.add_two_terminal(element)
        elif element.kind.endswith("_source"):
            self.add_source(element)
        else:
            getattr(self, f"add_{element.kind}")(element)

    def add_two_terminal(self, element: Element) -> None:
        domain, key, _, quantity = TWO_TERMINAL[element.kind]
        a, b = (self.axis(node, domain) for node in element.port("between"))
        value, through = element.value(key), f"{element.name}.{quantity}"
        admittance, impedance = {
            "spring": (value, 1),
            "torsion_spring": (value, 1),
            "damper": (value * self.s, 1),
            "rotary_damper": (value * self.s, 1),
            "capacitor": (value * self.s, 1),
            "resistor": (1, value),
            "inductor": (1, value * self.s),
            "acoustic_resistance": (1, value),
            "acoustic_mass": (1, value * self.s),
        }[element.kind]
        self.law(((through, impedance), (a, -admittance), (b, admittance)))
        self.deliver(a, through, -1)
        self.deliver(b, through, 1)

    def add_source(self, element: Element) -> None:
        domain, _, _ = SOURCES[element.kind]
        node, through = self.axis(element.port("at")[0], domain), f"{element.name}.given"
        given = node if element.kind in ("voltage_source", "pressure_source") else through
        self.law(((given, 1), *self.negative(element.source)))
        self.deliver(node, through, 1)

    def add_mass(self, element: Element) -> None:
        node, force = self.axis(element.port("at")[0], "translation"), f"{element.name}.f"
        self.law(((force, 1), (node, -element.value("m") * self.s**2)))
        self.deliver(node, force, -1)

    def add_inertia(self, element: Element) -> None:
        node, torque = self.axis(element.port("at")[0], "rotation"), f"{element.name}.tau"
        self.law(((torque, 1), (node, -element.value("J") * self.s**2)))
        self.deliver(node, torque, -1)

    def add_acoustic_compliance(self, element: Element) -> None:
        (node,), flow = element.port("at"), f"{element.name}.q"
        self.law(((flow, 1), (node, -element.value("C") * self.s)))
        self.deliver(node, flow, -1)

    def add_rigid_body(self, element: Element) -> None:
        (node,), cg = element.port("at"), element.value("cg")
        y, theta, force, moment = f"{node}.y", f"{node}.theta", f"{element.name}.f", f"{element.name}.tau"
        m, inertia = element.value("m") * self.s**2, element.value("J") * self.s**2
        self.law(((force, 1), (y, -m), (theta, -m * cg)))  # Newton, at the mass centre
        self.law(((moment, 1), (theta, -inertia), (force, -cg)))  # Euler, moment about the node
        self.deliver(y, force, -1)
        self.deliver(theta, moment, -1)

    def add_flexible_link(self, element: Element, length: np.longdouble, flexibility: tuple) -> None:
        """Add a massless cantilever from a whose end b carries the force V and the moment M.

        ``flexibility`` is (l^3/3EI, l^2/2EI, l/EI); zeros make the link rigid.
        """
        a, b = element.port("between")
        force, moment = f"{element.name}.V", f"{element.name}.M"
        yv, ym, tm = flexibility
        self.law(((f"{b}.y", 1), (f"{a}.y", -1), (f"{a}.theta", -length), (force, -yv), (moment, -ym)))
        self.law(((f"{b}.theta", 1), (f"{a}.theta", -1), (force, -ym), (moment, -tm)))
        self.deliver(f"{b}.y", force, -1)
        self.deliver(f"{b}.theta", moment, -1)
        self.deliver(f"{a}.y", force, 1)
        self.deliver(f"{a}.theta", moment, 1)
        self.deliver(f"{a}.theta", force, length)

    def add_rigid_link(self, element: Element) -> None:
        self.add_flexible_link(element, element.value("length"), (0, 0, 0))

    def add_massless_beam(self, element: Element) -> None:
        length, stiffness = element.value("l"), element.value("EI")
        flexibility = (length**3 / (3 * stiffness), length**2 / (2 * stiffness), length / stiffness)
        self.add_flexible_link(element, length, flexibility)

    def side(self, nodes: tuple[str, ...], factor: complex = 1) -> tuple:
        """Return the terms of what the first node is over the second, or over ground."""
        return tuple((node, sign * factor) for node, sign in zip(nodes, (1, -1), strict=False))

    def push(self, nodes: tuple[str, ...], unknown: str, coefficient: complex = 1) -> None:
        """Deliver into the first node, and out of the second where there is one."""
        for node, sign in zip(nodes, (1, -1), strict=False):
            self.deliver(node, unknown, sign * coefficient)

    def add_winding(self, element: Element, moved: str, constant: str) -> None:
        current, force = f"{element.name}.i", element.value(constant)
        impedance = element.value("L") * self.s + element.value("R")
        moving = self.side(element.port(moved), (element.value("k_e") or force) * self.s)
        self.law(((current, impedance), *moving, *self.side(element.port("terminals"), -1)))
        self.push(element.port("terminals"), current, -1)
        self.push(element.port(moved), current, force)

    def add_dc_motor(self, element: Element) -> None:
        self.add_winding(element, "shaft", "k_t")

    def add_voice_coil(self, element: Element) -> None:
        self.add_winding(element, "mover", "k_f")

    def add_piston(self, element: Element) -> None:
        flow, force, area = f"{element.name}.q", f"{element.name}.f", element.value("A")
        mover, chamber = element.port("mover"), element.port("chamber")
        self.law(((flow, 1), *self.side(mover, -area * self.s)))
        self.law(((force, 1), *self.side(chamber, area)))
        self.push(chamber, flow)
        self.push(mover, force)

    def add_planetary_gear(self, element: Element) -> None:
        rho, torque = element.value("rho"), f"{element.name}.tau"
        teeth = zip(("sun", "ring", "carrier"), (1, rho, -1 - rho), strict=True)
        shares = [(element.port(key)[0], share) for key, share in teeth]
        self.law(tuple(shares))
        for node, share in shares:
            self.deliver(node, torque, share)

    def add_coupled_inductors(self, element: Element) -> None:
        a, b, c, d = element.port("terminals")
        mutual = element.value("M") * self.s
        for k, (start, end) in enumerate(((a, b), (c, d)), 1):
            own, other = f"{element.name}.i_{k}", f"{element.name}.i_{3 - k}"
            self.law(((own, element.value(f"L_{k}") * self.s), (other, mutual), (start, -1), (end, 1)))
            self.push((start, end), own, -1)

    def add_op_amp(self, element: Element) -> None:
        (out,), current = element.port("out"), f"{element.name}.i"
        needed = 1 / element.value("A")
        if element.value("f_u"):
            needed += self.s / element.value("f_u")
        self.law(((out, needed), *self.side(element.port("inputs"), -1)))
        self.deliver(out, current)

    def add_controlled(self, element: Element, key: str, *, is_voltage: bool, by_current: bool) -> None:
        gain, given, felt = element.value(key), f"{element.name}.i", f"{element.name}.felt"
        inputs, ends = element.port("inputs"), element.port("terminals")
        control = ((felt, -gain),) if by_current else self.side(inputs, -gain)
        if by_current:
            self.law(self.side(inputs))
            self.push(inputs, felt, -1)
        self.law((*(self.side(ends) if is_voltage else ((given, 1),)), *control))
        self.push(ends, given)

    def add_vcvs(self, element: Element) -> None:
        self.add_controlled(element, "mu", is_voltage=True, by_current=False)

    def add_vccs(self, element: Element) -> None:
        self.add_controlled(element, "g", is_voltage=False, by_current=False)

    def add_ccvs(self, element: Element) -> None:
        self.add_controlled(element, "r", is_voltage=True, by_current=True)

    def add_cccs(self, element: Element) -> None:
        self.add_controlled(element, "beta", is_voltage=False, by_current=True)

    def add_transformer(self, element: Element) -> None:
        source, target = element.port("from"), element.port("to")
        ratio, through = element.value("ratio"), f"{element.name}.f"
        self.law((*self.side(target), *self.side(source, -ratio)))
        self.push(target, through)
        self.push(source, through, -ratio)

    def add_gyrator(self, element: Element) -> None:
        (source,), (target,) = element.port("from"), element.port("to")
        ratio, drawn, given = element.value("ratio"), f"{element.name}.drawn", f"{element.name}.given"
        effort_from, flow_from = self.port_variables(source, drawn)
        effort_to, flow_to = self.port_variables(target, given)
        self.law(((effort_from, 1), (flow_to[0], -ratio * flow_to[1])))
        self.law(((effort_to, 1), (flow_from[0], -ratio * flow_from[1])))
        self.deliver(source, drawn, -1)
        self.deliver(target, given, 1)

    def port_variables(self, node: str, through: str) -> tuple:
        """Return a gyrator port's effort, and its flow as (unknown, factor)."""
        if dict(self.network.coordinates)[node] in ("electrical", "acoustic"):
            return node, (through, 1)
        return through, (node, self.s)

    def hold(self, element: Element, coordinates: tuple[str, ...]) -> None:
        for coordinate in coordinates:
            reaction = f"{element.name}.{coordinate}"
            self.law(((coordinate, 1),))
            self.deliver(coordinate, reaction, 1)

    def add_fixed(self, element: Element) -> None:
        (node,) = element.port("at")
        self.hold(element, tuple(dict.fromkeys(self.axis(node, domain) for domain in AXES)))

    def add_slider(self, element: Element) -> None:
        self.hold(element, (f"{element.port('at')[0]}.theta",))

    def add_pin(self, element: Element) -> None:
        self.hold(element, (f"{element.port('at')[0]}.y",))

    # -- inputs and solution

    def add_inputs(self) -> None:
        for entry in self.network.inputs:
            if not entry.key:
                continue
            domain = "rotation" if entry.key == "torque" else "translation"
            nodes, through = [self.axis(node, domain) for node in entry.nodes], f"{entry.name}.given"
            self.law(((nodes[0] if entry.key in ("voltage", "pressure") else through, 1), (entry.name, -1)))
            for node, sign in zip(nodes, (1, -1), strict=False):
                self.deliver(node, through, sign)

    def solve(self) -> dict[str, np.clongdouble]:
        rows = [*self.rows, *(self.balances[name] for name, _ in self.network.coordinates)]
        unknowns = list(dict.fromkeys(key for row in rows for key in row if key))
        column = {name: i for i, name in enumerate(unknowns)}
        matrix = np.zeros((len(rows), len(unknowns)), dtype=np.clongdouble)
        right_side = np.zeros(len(rows), dtype=np.clongdouble)
        for i, row in enumerate(rows):
            for key, coefficient in row.items():
                if key:
                    matrix[i, column[key]] = coefficient
                else:
                    right_side[i] = -coefficient
        return dict(zip(unknowns, dense.solve(matrix, right_side), strict=True))
