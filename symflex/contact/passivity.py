"""Is a machine passive where it is touched: proved for all frequencies, or where not and by how much.

Input: a model with numbers and a port. Output: a :class:`PortPassivity`.

A machine is passive at a port where its driving-point function Y is positive real: no pole in the open right
half-plane, poles on the axis simple with positive residues, ``Re Y(j omega) >= 0`` at all frequencies, and Y
growing at infinity no faster than s (Brune 1931; Anderson & Vongpanitlerd 1973). Then whatever passive thing
it touches, the whole is stable (Colgate & Hogan 1988); else there is a passive thing with which it is not.

    mass 1 kg under proportional control, 100 N/m, delayed by 1 ms    Y = s/(s^2 + 100 exp(-s/1000))
    Re Z = -100 sin(omega T)/omega is -0.1 N s/m at 0: a damper of 0.1 N s/m repairs it
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

from flint import acb_poly, arb

from symflex.algebra import Factored
from symflex.balls import precision
from symflex.contact.environment import Example, destabilising
from symflex.contact.lossless import without_ladder, without_storage
from symflex.contact.one_place import PROOF, at_one_place
from symflex.contact.port import at_port
from symflex.contact.real_part import ActiveBand, LeastPart, RealPart, least_part, real_part
from symflex.contact.repair import Repair, repairs
from symflex.errors import BudgetError, Diagnostic, ModelError, SymflexError, UsageError
from symflex.loops.loop_function import LoopFunction
from symflex.model import ContactPort, Model, with_numbers
from symflex.model.loss_factors import check_causal
from symflex.model.ports import port_named
from symflex.print.notebook import Printed
from symflex.print.text import Passage
from symflex.roots.distributed.far_out import SECTORS, FunctionFarOut
from symflex.roots.functions.kernel_function import KernelFunction
from symflex.roots.locate import locate
from symflex.roots.passivity import energy_proof
from symflex.roots.pole_zero_map import is_right
from symflex.roots.problem import polynomial_in_s
from symflex.roots.root import figure, hertz, real_json, short_hertz
from symflex.transfer.of_model import derive_bound, is_large_network

if TYPE_CHECKING:
    from symflex.roots import PoleZeroMap, Root
    from symflex.transfer import BoundTransferFunction

BITS = 160
WIDER, FURTHER = 4.0, 24  # steps, and how many, in which a radius is sought from which on a size is known
NOT_WRITTEN = "the driving-point function of so large a network is not written out"
UNSTABLE = "the machine alone is not stable"
DOUBLE = "a pole on the imaginary axis is not simple"
NEGATIVE_RESIDUE = "a pole on the imaginary axis has a residue that is not positive"
NO_EXAMPLE = "what it is unstable with: no simple example was found"
IMPROPER = "the function grows faster than s, or with a negative factor, as s grows"


@dataclass(frozen=True)
class PortPassivity(Printed):
    """Whether a machine is passive at a port."""

    port: ContactPort
    function: str  # whose real part it is: velocity over force, voltage over current
    unit: str
    digits: int
    passive: bool | None
    proof: str = ""  # what proves it, where that is not the real part at all frequencies
    active: tuple[ActiveBand, ...] = ()
    least: LeastPart | None = None
    is_lossless: bool = False  # the real part is zero at all frequencies
    faults: tuple[str, ...] = ()  # what is wrong with poles, where that is why it is not passive
    reasons: tuple[str, ...] = ()  # what is not proved
    repair: Repair | None = None
    example: Example | None = None

    def to_json_dict(self) -> dict[str, object]:
        """Return the result in the schema ``symflex.passivity/1``, ready for :func:`json.dumps`."""
        least = self.least
        shown = None if least is None else real_json(least.value, self.digits)
        omega = None if least is None else least.omega
        return {
            "schema": "symflex.passivity/1",
            "port": self.port.name,
            "function": self.function,
            "unit": self.unit,
            "passive": self.passive,
            "lossless": self.is_lossless,
            "proof": self.proof,
            "active": [band.to_json_dict() for band in self.active],
            "edges": [
                [real_json(band.low, self.digits), real_json(band.high, self.digits)] for band in self.active
            ],
            "least": least
            and {
                "value": shown and shown["value"],
                "radius": shown and shown["radius"],
                "frequency_hz": None if omega is None else float(hertz(omega).mid()),
                "infinite": shown is None,
            },
            "faults": list(self.faults),
            "reasons": list(self.reasons),
            "repair": {} if self.repair is None else self.repair.to_json_dict(self.digits),
            "example": self.example and self.example.to_json_dict(self.digits),
        }

    def passages(self) -> list[Passage]:
        """Return the verdict, the bands, what repairs the machine, and what it is unstable with."""
        word = {True: "PASSIVE, proved", False: "ACTIVE, proved", None: "NOT DECIDED"}[self.passive]
        lines = [f"port {self.port.name}, {self.function}{self.unit and f' [{self.unit}]'}   {word}"]
        lines += [f"  {self.proof}"] if self.proof else []
        lines += ["  the real part is zero at all frequencies: nothing is lost"] if self.is_lossless else []
        lines += [f"  {fault}" for fault in self.faults]
        for band in self.active:
            end = "on" if band.high is None else f"to {short_hertz(band.high)} Hz"
            lines.append(f"  real part negative from {short_hertz(band.low)} Hz {end}")
        if self.least is not None and not self.is_lossless:
            value = figure(self.least.value, self.digits) if self.least.value.is_finite() else "-infinity"
            omega = self.least.omega
            at = "as the frequency grows" if omega is None else f"at {short_hertz(omega)} Hz"
            lines.append(f"  least real part {value}, {at}")
        lines += [f"  not proved: {reason}" for reason in self.reasons]
        passages = [Passage(lines)]
        if self.repair is not None:
            passages.append(
                Passage(["what makes it passive", *(f"  {x}" for x in self.repair.lines(self.digits))])
            )
        if self.example is not None:
            passages.append(Passage(["what it is unstable with", *(f"  {x}" for x in self.example.lines())]))
        elif self.repair is not None:
            passages.append(Passage([NO_EXAMPLE]))
        return passages


def find_passivity(
    model: Model, port: str | ContactPort | None, digits: int = 12, *, is_explained: bool = True
) -> PortPassivity:
    """Return whether a machine is passive at a port, a declared one or a node.

    With ``is_explained`` an active one comes with what repairs it and with what it is unstable.

    Raises
    ------
    UsageError
        SF2xx for a port that is not there or cannot be touched, SF218 for a node that does not move.
    ModelError
        SF229 for a parameter without value, SF251 with loss factors, SF910 with roots of s.
    """
    return _Machine.of(model, port, digits).verdict(is_explained=is_explained)


def passive_by_parts(model: Model, digits: int) -> str:
    """Return why a machine is passive whose sources act at one place; empty if that is not proved."""
    parts = at_one_place(model)
    if parts is None:
        return ""
    part, place, rest = parts
    if not energy_proof(rest).is_passive:
        return ""
    is_passive = _Machine.of(part, place, digits).verdict(is_explained=False, is_part=True).passive
    return PROOF.format(place.name) if is_passive else ""


def driving_function(model: Model, port: str | None) -> BoundTransferFunction:
    """Return the driving-point function of a machine at a port; SF502 where it is not written out."""
    bound = _Machine.of(model, port, 12).bound
    if bound is None:
        hint = "'symflex passivity' still judges it by its energy; only the picture needs the function"
        raise BudgetError(Diagnostic("SF502", NOT_WRITTEN, None, hint))
    return bound


@dataclass(frozen=True)
class _Machine:
    """A machine that is driven at a port."""

    model: Model
    port: ContactPort
    driven: Model
    pair: tuple[str, str]
    digits: int

    @classmethod
    def of(cls, model: Model, port: str | ContactPort | None, digits: int) -> _Machine:
        """Return the machine at a port, a declared one or a node."""
        chosen = port if isinstance(port, ContactPort) else port_named(model, port)
        check_causal(with_numbers(model), "passivity")
        return cls(model, chosen, *at_port(model, chosen), digits)

    @cached_property
    def bound(self) -> BoundTransferFunction | None:
        """The driving-point function; None where it is not written out."""
        if is_large_network(self.driven):
            return None
        try:
            (bound,) = derive_bound(self.driven, [self.pair])
        except BudgetError as error:
            if error.diagnostics[0].code not in ("SF501", "SF502"):
                raise
            return None
        if bound.is_zero:
            message = (
                f"port '{self.port.name}': '{self.port.nodes[0].node}' does not move, whatever acts on it"
            )
            raise UsageError(Diagnostic("SF218", message, self.port.span, "name a node that can be moved"))
        return bound

    @cached_property
    def located(self) -> PoleZeroMap:
        """The poles."""
        assert self.bound is not None
        return locate(self.bound, digits=self.digits + 10, with_zeros=False)

    def verdict(self, *, is_explained: bool, is_part: bool = False) -> PortPassivity:
        """Return whether it is passive."""
        energy = energy_proof(self.driven)
        bound = self.bound
        function, unit = "/".join(self.pair), "" if bound is None else bound.source.unit
        asked = PortPassivity(self.port, function, unit, self.digits, None)
        if energy.is_passive:
            proved = replace(asked, passive=True, proof=energy.reason)
            if bound is None or not bound.is_rational:
                return proved
            real = real_part(bound, self.digits)
            return replace(proved, least=least_part(bound, (), self.digits), is_lossless=real.is_zero)
        if not is_part and (proof := passive_by_parts(self.driven, self.digits)):
            return replace(asked, passive=True, proof=proof)
        if bound is None:
            return replace(asked, reasons=(NOT_WRITTEN,))
        real = self._real_part(bound)
        faults, reasons = self._faults(bound)
        is_active = bool(real.active or faults)
        is_open = bool(reasons)
        reasons = () if is_active and not real.active else (*real.reasons, *reasons)
        found = replace(
            asked,
            passive=False if is_active else None if reasons else True,
            active=real.active,
            least=least_part(bound, real.active, self.digits),
            is_lossless=real.is_zero,
            faults=faults,
            reasons=reasons,
        )
        if not is_active or not is_explained:
            return found
        poles = (*self.located.all_poles, *(h.root for h in self.located.hidden))
        growing = next((pole for pole in poles if is_right(pole)), None)
        example = (
            Example((), growing) if growing else destabilising(self.model, self.port, bound, found.active)
        )
        check = None if is_open else self._checked
        repair = repairs(self.model, self.port, bound, real, check, has_faults=bool(faults))
        return replace(found, repair=repair, example=example)

    def _real_part(self, bound: BoundTransferFunction) -> RealPart:
        """Return the sign of the real part, with waves or delays of what stores no energy at the port."""
        if bound.is_rational:
            return real_part(bound, self.digits)
        found = real_part(without_ladder(self._without_storage or bound), self.digits)
        if not found.reasons:
            return found
        return min(found, real_part(bound, self.digits), key=lambda each: len(each.reasons))

    @property
    def _without_storage(self) -> BoundTransferFunction | None:
        """The driving-point function without what stores energy at the port; None where nothing moves."""
        bare = without_storage(self.model, self.port)
        if bare == self.model:
            return None
        driven, pair = at_port(bare, self.port)
        try:
            (alike,) = derive_bound(driven, [pair])
        except SymflexError:
            return None
        return None if alike.is_zero else alike

    def _faults(self, bound: BoundTransferFunction) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Return what is wrong with poles and at infinity, and what is not proved of that."""
        verdict = self.located.verdict
        faults = [f"{UNSTABLE}: {verdict.sentence}"] if verdict.word == "unstable" else []
        reasons = [f"the poles of the machine alone: {verdict.reason}"] if verdict.right is None else []
        for pole in (p for p in self.located.poles if p.on_imaginary_axis and not p.im < 0):
            residue = None if pole.multiplicity > 1 else residue_at(bound, pole)
            if pole.multiplicity > 1:
                faults.append(f"{DOUBLE}: {short_hertz(pole.im)} Hz")
            elif residue is not None and residue < 0:
                faults.append(f"{NEGATIVE_RESIDUE}: {short_hertz(pole.im)} Hz")
            elif residue is None or not residue > 0:
                reasons.append(f"the residue of the pole at {short_hertz(pole.im)} Hz")
        grows = _grows(bound)
        faults += [IMPROPER] if grows else []
        reasons += ["how the function grows as s grows"] if grows is None else []
        return tuple(faults), tuple(reasons)

    def _checked(self, other: Model) -> tuple[bool, bool]:
        """Tell of another machine whether it is proved passive, and whether it is proved unstable alone."""
        try:
            found = find_passivity(other, self.port, self.digits, is_explained=False)
        except ModelError:  # a mass that takes another away leaves equations without solution
            return False, False
        return found.passive is True, any(f.startswith(UNSTABLE) for f in found.faults)


def residue_at(bound: BoundTransferFunction, pole: Root) -> arb | None:
    """Return the real part of the residue at a simple pole on the axis; None where it is not known."""
    with precision(BITS):
        if bound.is_rational:
            num, den = (polynomial_in_s(bound, x.expand()).enclosure() for x in (bound.num, bound.den))
            return (acb_poly(num)(pole.enclosure()) / acb_poly(den).derivative()(pole.enclosure())).real
        s = Factored.generator(bound.ratio.ring, bound.ratio.ring.names[0])
        if pole.is_zero:
            origin = LoopFunction.of(bound, s * bound.num, bound.den).at_origin()
            gain = None if origin is None or origin.orders[0] != origin.orders[1] else origin.gain()
            return None if gain is None else -gain
        around, _ = LoopFunction.of(bound, bound.num, bound.den).around(pole.enclosure(), BITS)
        residue = around.a / around.b_slope
        return residue.real if residue.is_finite() else None


def _grows(bound: BoundTransferFunction) -> bool | None:
    """Tell whether a function grows faster than s, or as -s; None where its size far out is not known."""
    if bound.is_rational:
        num, den = (polynomial_in_s(bound, x.expand()) for x in (bound.num, bound.den))
        excess = num.degree - den.degree
        with precision(BITS):
            lead = num.enclosure()[num.degree] / den.enclosure()[den.degree]
        return excess > 1 or (excess == 1 and bool(lead < 0))
    far = FunctionFarOut.of(bound, SECTORS)
    if far is None:
        return None
    function = LoopFunction.of(bound, bound.num, bound.den)
    start = KernelFunction(bound, Factored.polynomial(bound.ratio.ring, function.b)).frequency_of(1.0)
    sizes = (far.size(start * WIDER**i) for i in range(FURTHER))
    size = next((size for size in sizes if size is not None), None)
    if size is None or size.power > 1:
        return None
    return False if size.power < 1 or size.lead.real > 0 else None
