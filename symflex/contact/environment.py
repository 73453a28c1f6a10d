"""Passive things that a machine touches, and those with which it is unstable.

Input: a machine that is not passive at a port, with its driving-point function Y.
Output: an :class:`Example`: elements to put at the port, and a pole of the whole that is proved to lie in the
right half-plane.

With an element of admittance y the whole has a pole where ``1 + Y y = 0``. At the end of an active band
``Y = j c``, and a spring or a mass (as c is negative or positive) puts a pole on the axis there; with a
little more or less of it, the pole is on the right. A spring k with a mass m at its end has
``1/y = s/k + 1/(m s)``. At a frequency of the band ``Y = R + jX``; with ``omega/k - 1/(m omega) = -X`` the
pole is near ``j omega - R/(1/k + 1/(m omega^2))``, on the right if k is small enough (Colgate & Hogan 1988):
so there is an example for every active machine. Of k some values are tried. Between two nodes that move, an
inerter takes the place of the mass, and a capacitor does in circuits.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import log10
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE
from symflex.contact.port import ADMITTANCES, ORDER, Kind, at_port, with_branch, with_hanging_mass
from symflex.errors import SymflexError
from symflex.expressions import Name, Power, number, product_of, quotient, sum_of
from symflex.library.elements import ELEMENTS
from symflex.model import ContactPort, Model
from symflex.roots.locate import locate
from symflex.roots.pole_zero_map import is_right
from symflex.roots.region import Rectangle
from symflex.roots.root import decimals, hertz
from symflex.transfer.of_model import derive_bound

if TYPE_CHECKING:
    from symflex.contact.real_part import ActiveBand
    from symflex.roots import Root
    from symflex.transfer import BoundTransferFunction

STEPS = (1.1, 0.9, 1.5, 0.6, 3.0, 0.2, 1.02, 0.98)  # shares of what puts a pole on the axis
SHARES = (0.3, 0.1, 0.03, 0.01, 0.003)  # of the machine's dynamic stiffness, of a spring with a mass
INSIDE = (0.5, 0.2, 0.8, 0.05, 0.95)  # where in a band a hanging mass is tuned to
LEAST = 1e-9  # real part of a pole that is proved, as a share of its size
INERTERS = {"mass": "inerter", "inertia": "rotary inerter"}  # between two nodes
SCALES = (1e-3, 1e-2, 1e-1, 1.0, 10.0, 1e2, 1e3)
SECANTS = 40
FAR = 1e12  # abs(s) at which secants are given up
FIGURES = 4  # of values that are suggested


@dataclass(frozen=True)
class Put:
    """An element that is put at a port."""

    kind: Kind
    type_name: str
    parameter: str
    value: Fraction  # in SI units
    is_hanging: bool = False  # at the end of the element before it, not at the port
    is_between: bool = False  # its other end is at the second node of the port

    @property
    def name(self) -> str:
        """Its type in words."""
        name = INERTERS.get(self.type_name, self.type_name) if self.is_between else self.type_name
        return name.replace("_", " ")

    @property
    def unit(self) -> str:
        """The unit of the value."""
        return next(p.unit for p in ELEMENTS[self.type_name].parameters if p.name == self.parameter)

    @property
    def text(self) -> str:
        """The element in words."""
        place = " in series" if self.is_between else " at its end" if self.is_hanging else ""
        return f"{self.name} {self.parameter} = {float(self.value):.10g} {self.unit}{place}"


@dataclass(frozen=True)
class Example:
    """What the machine touches when it is unstable; nothing, if it is so alone."""

    elements: tuple[Put, ...]
    root: Root  # proved to lie in the right half-plane

    def lines(self) -> list[str]:
        """Return it for people."""
        touched = " and ".join(x.text for x in self.elements) or "nothing: it is unstable alone"
        shown = decimals(self.root.re, self.root.im, 6).readable
        return [
            touched,
            f"pole at {shown.re} + {shown.im} j rad/s, {float(hertz(abs(self.root.im)).mid()):.6g} Hz",
        ]

    def to_json_dict(self, digits: int) -> dict[str, object]:
        """Return it as JSON data."""
        shown = decimals(self.root.re, self.root.im, digits)
        elements = [
            {
                "type": x.name.replace(" ", "_"),
                x.parameter: float(x.value),
                "unit": x.unit,
                "hanging": x.is_hanging,
            }
            for x in self.elements
        ]
        return {"elements": elements, "root": {"re": shown.re, "im": shown.im, "radius": shown.radius}}


def put_at(port: ContactPort, kind: Kind, admittance: float, *, is_up: bool | None = None) -> Put:
    """Return the element of an admittance a/s, a s or a, its value rounded, up or down where that is said."""
    type_name, parameter, is_reciprocal = ADMITTANCES[port.domain][kind]
    value = 1 / admittance if is_reciprocal else admittance
    up = None if is_up is None else is_up != is_reciprocal
    return Put(kind, type_name, parameter, _rounded(value, up))


def _rounded(value: float, is_up: bool | None) -> Fraction:
    scale = Fraction(10) ** (int(log10(value) // 1) - FIGURES + 1)
    share = Fraction(value) / scale
    whole = round(share) if is_up is None else -(-share // 1) if is_up else share // 1
    return whole * scale


def touched(model: Model, port: ContactPort, elements: Sequence[Put]) -> Model:
    """Return a model with elements at a port."""
    if elements[-1:] and elements[-1].is_between:
        spring, mass = elements
        inertia = product_of([number(mass.value), Power(Name(LAPLACE), number(2))])
        own = number(spring.value)
        if _is_reciprocal(spring):
            value = sum_of([own, quotient(number(1), inertia)])
        else:
            value = quotient(product_of([own, inertia]), sum_of([own, inertia]))
        return with_branch(model, port, spring.type_name, {spring.parameter: value}, "touched")
    if len(elements) > 1 and elements[1].is_hanging:
        values = [(x.type_name, {x.parameter: number(x.value)}) for x in elements]
        return with_hanging_mass(model, port, *values)
    for each in elements:
        model = with_branch(model, port, each.type_name, {each.parameter: number(each.value)}, "touched")
    return model


def destabilising(
    model: Model, port: ContactPort, bound: BoundTransferFunction, bands: Sequence[ActiveBand]
) -> Example | None:
    """Return a passive thing with which the machine is unstable, proved; None where none is found."""
    for elements, guess in _candidates(port, bound, bands):
        example = _checked(model, port, bound, elements, guess)
        if example is not None:
            return example
    return None


def _candidates(
    port: ContactPort, bound: BoundTransferFunction, bands: Sequence[ActiveBand]
) -> Iterator[tuple[tuple[Put, ...], complex]]:
    """Yield things that may do, the simplest first, with about where the pole is."""
    is_single = sum(not r.is_ground for r in port.nodes) == 1
    for band in bands:
        for edge in (band.high, band.low):
            omega = 0.0 if edge is None else float(edge.mid())
            if not omega:
                continue
            c = bound(1j * omega).imag
            kind: Kind = "inertial" if c > 0 else "elastic"
            if not c or (kind == "inertial" and not (is_single or port.domain == "electrical")):
                continue
            critical = 1 / (omega * c) if c > 0 else -omega / c
            for step in STEPS:
                yield (put_at(port, kind, critical * step),), 1j * omega
    for band in bands:
        low, high = float(band.low.mid()), None if band.high is None else float(band.high.mid())
        for share in INSIDE:
            if high is None:
                omega = 2 * low or 1.0
            else:
                omega = low ** (1 - share) * high**share if low else share * high
            admittance = bound(1j * omega)
            if not admittance.real < 0:
                continue
            for size in SHARES:
                spring = put_at(port, "elastic", size * omega / abs(admittance))
                k = _admittance(spring)
                m = 1 / (omega * (omega / k + admittance.imag))
                mass = replace(put_at(port, "inertial", m), is_hanging=True, is_between=not is_single)
                yield (spring, mass), 1j * omega - admittance.real / (1 / k + 1 / (m * omega**2))
    if not bands:
        scale = abs(bound(1j)) or 1.0
        for kind in ORDER:
            if kind == "inertial" and not (is_single or port.domain == "electrical"):
                continue
            for factor in SCALES:
                yield (put_at(port, kind, factor / scale),), 1j


def _is_reciprocal(put: Put) -> bool:
    """Tell whether the value is 1/a of the admittance a/s, a s or a."""
    laws = (law for laws in ADMITTANCES.values() for law in laws.values())
    return any(law == (put.type_name, put.parameter, True) for law in laws)


def _admittance(put: Put) -> float:
    """Return a of the admittance a/s, a s or a."""
    return float(1 / put.value if _is_reciprocal(put) else put.value)


def _checked(
    model: Model, port: ContactPort, bound: BoundTransferFunction, elements: Sequence[Put], guess: complex
) -> Example | None:
    """Return the example if a pole is proved to lie in the right half-plane."""
    region = None
    if not bound.is_rational:
        near = _root_near(bound, elements, guess)
        if near is None or near.real <= LEAST * abs(near):
            return None
        reach = near.real / 2
        ends = (near.real - reach, near.real + reach, near.imag - reach, near.imag + reach)
        region = Rectangle(*(Fraction(x) for x in ends))
    driven, pair = at_port(touched(model, port, elements), port)
    try:
        (closed,) = derive_bound(driven, [pair])
        poles = locate(closed, region, 15, with_zeros=False).all_poles
    except SymflexError:
        return None
    root = next((pole for pole in poles if pole.certified and is_right(pole)), None)
    return None if root is None else Example(tuple(elements), root)


def _root_near(bound: BoundTransferFunction, elements: Sequence[Put], start: complex) -> complex | None:
    """Return a root of ``1 + Y y`` by secants, without proof."""

    def f(s: complex) -> complex:
        values = [_admittance(x) * s ** ORDER[x.kind] for x in elements]
        y = 1 / sum(1 / v for v in values) if elements[-1].is_hanging else sum(values)
        return 1 + bound(s) * y

    last, s = start * (1 + 1e-3), start + abs(start) * 1e-3
    before, value = f(last), f(s)
    for _ in range(SECANTS):
        if value == before:
            break
        last, s, before = s, s - value * (s - last) / (value - before), value
        if not abs(s) < FAR:
            return None
        value = f(s)
        if abs(s - last) < 1e-12 * abs(s):
            return s
    return None
