"""The smallest passive elements that make a machine passive where it is touched.

Input: a machine that is not passive at a port, and its driving-point function Y. Output: a :class:`Repair`.

A damper b to ground at the port makes ``Z + b`` of the impedance Z = 1/Y: the least b is ``-min Re Z``, if
no pole is left in the right half-plane then. A damper in series, between the machine and what it touches,
makes ``Y + 1/b``: the largest b is ``-1/min Re Y``, and the poles stay where they are. A spring or a mass in
parallel leaves Re Z as it is, in series Re Y: neither repairs what is negative on the axis.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import sqrt
from typing import TYPE_CHECKING

from flint import arb

from symflex.balls import precision
from symflex.contact.environment import Put, put_at, touched
from symflex.contact.port import ADMITTANCES, Kind
from symflex.contact.real_part import RealPart, least_part
from symflex.model import ContactPort, Model
from symflex.roots.root import figure, real_json

if TYPE_CHECKING:
    from symflex.transfer import BoundTransferFunction

BITS = 160
STORES = "a spring or a mass alone leaves the sign of the real part as it is"
ZEROS = "no damper in parallel: with any that is enough on the axis, poles stay in the right half-plane"
NO_BOUND = "no damper in {}: the real part falls without end"
UNSTABLE = "no damper in series: it leaves the poles where they are"
NOT_FOUND = "no damper in parallel is proved to be enough"
UNKNOWN = "no damper in series is proved to be enough, as the real part is not known at all frequencies"
STEPS = (1.0, 1.01, 1.2, 2.0, 10.0)  # times the least damper that is needed, up to one that is enough
NO_STORAGE = "no spring or mass in parallel was found to be enough"
STORING: tuple[Kind, ...] = ("elastic", "inertial")
POWERS = range(-4, 7)  # of ten, from the size of the impedance at 1 rad/s on
ALIKE = 1.0005  # how close a value that is enough is to one that is not
Check = Callable[[Model], tuple[bool, bool]]


@dataclass(frozen=True)
class Repair:
    """What makes a machine passive."""

    parallel: (
        tuple[arb, Put] | None
    )  # the smallest conductance of a damper in parallel, and one that is enough
    series: tuple[arb, Put] | None  # the largest conductance of one in series
    reasons: tuple[str, ...]  # why what is missing is not there
    # Springs and masses in parallel: one that is not enough, and next to it one that is.
    storage: tuple[tuple[Put, Put], ...] = ()

    def lines(self, digits: int) -> list[str]:
        """Return it for people."""
        found = [("in parallel", "at least", self.parallel), ("in series", "at most", self.series)]
        lines = []
        for how, word, each in found:
            if each is not None:
                limit, put = each
                name = put.type_name.replace("_", " ")
                lines.append(
                    f"{_with_article(name)} {how}: {_value(put, limit, word, digits)} ({put.text} is enough)"
                )
        for less, enough in self.storage:
            name = enough.type_name.replace("_", " ")
            unit = f"{float(less.value):.10g} {less.unit}"
            lines.append(f"{_with_article(name)} in parallel: {enough.text} is enough, {unit} is not")
        return [*lines, *self.reasons]

    def to_json_dict(self, digits: int) -> dict[str, object]:
        """Return it as JSON data."""
        data: dict[str, object] = {}
        for how, each in (("parallel", self.parallel), ("series", self.series)):
            if each is not None:
                limit, put = each
                data[how] = {
                    "type": put.type_name,
                    "limit": real_json(_own(put, limit), digits),
                    "unit": put.unit,
                    put.parameter: float(put.value),
                }
        for less, enough in self.storage:
            values = {enough.parameter: float(enough.value), "not_enough": float(less.value)}
            data[enough.kind] = {"type": enough.type_name, "unit": enough.unit} | values
        return data | {"reasons": list(self.reasons)}


def _own(put: Put, conductance: arb) -> arb:
    with precision(BITS):
        return 1 / conductance if put.parameter == "R" else conductance


def _value(put: Put, conductance: arb, word: str, digits: int) -> str:
    if put.parameter == "R":
        word = {"at least": "at most", "at most": "at least"}[word]
    return f"{put.parameter} {word} {figure(_own(put, conductance), digits)} {put.unit}"


def repairs(
    model: Model,
    port: ContactPort,
    bound: BoundTransferFunction,
    real: RealPart,
    check: Check | None,
    *,
    has_faults: bool,
) -> Repair:
    """Return the smallest dampers that make a machine passive.

    ``check`` tells of a model whether it is passive, and whether it is proved unstable alone; None where the
    poles of the machine are not known, so that those of a repaired one would not be.
    """
    reasons = [STORES] if real.active else []
    turned = replace(bound, ratio=1 / bound.ratio, parts=bound.parts and bound.parts[::-1])
    parallel = series = None
    least = least_part(turned, real.active, 12)
    if least is not None and not least.value.is_finite():
        reasons.append(NO_BOUND.format("parallel"))
    elif least is not None and least.value < 0:
        with precision(BITS):
            limit = -least.value
        steps = STEPS if check else ()
        enough = (put_at(port, "dissipative", float(limit.upper()) * step, is_up=True) for step in steps)
        for put in enough:
            assert check is not None
            is_passive, is_unstable = check(touched(model, port, [put]))
            if is_passive:
                parallel = limit, put
                break
            if is_unstable and not real.reasons:
                reasons.append(ZEROS)
                break
        else:
            reasons.append(NOT_FOUND)
    elif least is None and real.active:
        reasons.append(NOT_FOUND)
    least = least_part(bound, real.active, 12)
    if has_faults or real.reasons:
        reasons.append(UNSTABLE if has_faults else UNKNOWN)
    elif least is not None and not least.value.is_finite():
        reasons.append(NO_BOUND.format("series"))
    elif least is not None and least.value < 0:
        with precision(BITS):
            limit = -1 / least.value
        series = limit, put_at(port, "dissipative", float(limit.lower()), is_up=False)
    storage: list[tuple[Put, Put]] = []
    if bound.is_rational and has_faults and not real.active and check is not None:
        storage = [pair for kind in STORING if (pair := _storage(model, port, bound, kind, check))]
        reasons += [] if storage else [NO_STORAGE]
    return Repair(parallel, series, tuple(_of_domain(r, port) for r in reasons), tuple(storage))


def _of_domain(reason: str, port: ContactPort) -> str:
    """Return a reason in the words of a port's domain: of capacitors in place of masses, say."""
    for kind, (type_name, _, _) in ADMITTANCES[port.domain].items():
        name, old = type_name.replace("_", " "), ADMITTANCES["translation"][kind][0]
        reason = reason.replace(f"a {old}", _with_article(name)).replace(f"no {old}", f"no {name}")
        reason = reason.replace(f"or {old}", f"or {name}")
    return reason


def _with_article(name: str) -> str:
    return f"{'an' if name[0] in 'aeiou' else 'a'} {name}"


def _storage(
    model: Model, port: ContactPort, bound: BoundTransferFunction, kind: Kind, check: Check
) -> tuple[Put, Put] | None:
    """Return a spring or a mass in parallel that is not enough, and one that is; None if none was found.

    More than enough is enough, as sums of positive real functions are positive real.
    """
    if kind == "inertial" and len(port.nodes) > 1 and port.domain != "electrical":
        return None
    scale, less = 1 / (abs(bound(1j)) or 1.0), 0.0
    for power in POWERS:
        size = scale * 10.0**power
        if check(touched(model, port, [put_at(port, kind, size)]))[0]:
            break
        less = size
    else:
        return None
    while less and size > less * ALIKE:
        middle = sqrt(less * size)
        is_enough = check(touched(model, port, [put_at(port, kind, middle)]))[0]
        less, size = (less, middle) if is_enough else (middle, size)
    pair = put_at(port, kind, less or size / 2, is_up=False), put_at(port, kind, size, is_up=True)
    found = [check(touched(model, port, [put]))[0] for put in pair]
    return pair if found == [False, True] else None
