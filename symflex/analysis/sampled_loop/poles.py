"""Poles of a sampled loop: in z, inside the unit circle or not, and in s.

Input: a model with ``[sampled]``. Output: :class:`SampledPoles`.

    (z - 1)(z - r) + K (n_1 z + n_2)    for K = 1400 N/m two poles z = 0.9976 +- 0.0683 j, s = ln(z)/T

The characteristic polynomial is taken to w with ``z = (1 + w)/(1 - w)``, where the unit circle is the
imaginary axis; its roots are enclosed, on the axis exactly where they are there.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

from flint import acb, arb

from symflex.analysis.sampled_loop.closed import (
    SampledLoop,
    described,
    inside,
    located_in_w,
    roots_in_b,
    sampled_loop,
)
from symflex.balls import ball, precision
from symflex.loops.over import with_values
from symflex.model import Model
from symflex.print.notebook import Printed
from symflex.print.text import INDENT, Passage
from symflex.roots.pole_zero_map import StabilityVerdict
from symflex.roots.root import Root, decimals, figure
from symflex.transfer import Given

SCHEMA = "symflex.sampled_poles/1"
GUARD_DIGITS = 8  # of poles in w beyond those of z that are shown: near z = 1 as many may be lost
SHORT_DIGITS = 6


@dataclass(frozen=True, slots=True)
class SampledPole:
    """A pole in z, or a conjugate pair."""

    z: acb
    size: arb  # abs(z)
    s: acb | None  # ln(z)/T [rad/s]; None at z = 0
    multiplicity: int
    is_pair: bool
    side: int  # 1 outside of the unit circle, 0 on it, -1 inside

    @property
    def words(self) -> str:
        """The pole in z and in s, on one line."""
        s = "" if self.s is None else f", s = {_short(self.s, self.is_pair)} rad/s"
        return f"z = {_short(self.z, self.is_pair)}{s}"

    def to_json_dict(self) -> dict[str, object]:
        """Return the pole as a part of ``symflex.sampled_poles/1``."""
        return {
            "z": [float(self.z.real.mid()), float(self.z.imag.mid())],
            "radius": float(abs(acb(self.z.real.rad(), self.z.imag.rad())).upper()),
            "abs": float(self.size.mid()),
            "s": None if self.s is None else [float(self.s.real.mid()), float(self.s.imag.mid())],
            "multiplicity": self.multiplicity,
            "pair": self.is_pair,
            "where": ("inside", "on the circle", "outside")[self.side + 1],
        }


@dataclass(frozen=True)
class SampledPoles(Printed):
    """The poles of a sampled loop, all of them enclosed."""

    sampled: str  # which blocks take samples, how often
    period: Fraction  # [s]
    poles: tuple[SampledPole, ...]  # ascending in abs(z)
    verdict: StabilityVerdict
    digits: int
    hidden: tuple[SampledPole, ...] = ()  # of the continuous part, that the controller does not see or move
    least: arb | None = None  # abs(z) from which on poles are listed: infinitely many lie nearer to 0

    def __repr__(self) -> str:
        return f"<SampledPoles: {self.count} poles, {self.sentence}>"

    @property
    def count(self) -> int:
        """How many poles there are, with multiplicity."""
        return sum(pole.multiplicity * (1 + pole.is_pair) for pole in self.poles)

    @property
    def counted(self) -> str:
        """How many poles there are, and from where on they are counted, in words."""
        far = "" if self.least is None else f" with abs(z) above {float(self.least):.3g}"
        return f"{self.count} poles in z{far}"

    @property
    def certified(self) -> bool:
        """Whether the verdict is proved."""
        return self.verdict.certified

    @property
    def sentence(self) -> str:
        """What holds of the loop."""
        return in_z(self.verdict.sentence)

    def passages(self) -> Iterator[Passage]:
        """Return the verdict and the poles."""
        status = "certified" if self.certified else "NOT CERTIFIED"
        lines = [f"sampled loop   {status}: {self.counted}", f"{INDENT}{self.sampled}"]
        yield Passage([*lines, f"{INDENT}{self.sentence}"])
        yield Passage([f"{INDENT}poles, s = ln(z)/T"], self._rows(self.poles))
        if self.hidden:
            line = f"{INDENT}hidden poles of the continuous part, which the controller does not see or move"
            yield Passage([line], self._rows(self.hidden))

    def _rows(self, poles: Iterable[SampledPole]) -> list[tuple[str, ...]]:
        """Return the table of poles."""
        rows: list[tuple[str, ...]] = [
            ("Re z", "Im z", "radius", "abs(z)", "Re s [rad/s]", "Im s [rad/s]", "frequency [Hz]")
        ]
        for pole in poles:
            shown = decimals(pole.z.real, pole.z.imag, self.digits)
            both = "+-" if pole.is_pair else ""
            s = ("-", "-", "-")
            if pole.s is not None:
                with precision(max(64, pole.s.real.bits())):
                    hertz = abs(pole.s) / (2 * arb.pi())
                s = (
                    figure(pole.s.real, self.digits),
                    both + figure(pole.s.imag, self.digits),
                    figure(hertz, self.digits),
                )
            times = f" ({pole.multiplicity} times)" if pole.multiplicity > 1 else ""
            rows.append((shown.re + times, both + shown.im, shown.radius, figure(pole.size, self.digits), *s))
        return rows

    def to_json_dict(self) -> dict[str, object]:
        """Return the poles in the schema ``symflex.sampled_poles/1``."""
        return {
            "schema": SCHEMA,
            "sampled": self.sampled,
            "period": float(self.period),
            "count": self.count,
            "least_abs": None if self.least is None else float(self.least),
            "certified": self.certified,
            "verdict": self.sentence,
            "stable": None if self.verdict.word == "unknown" else self.verdict.word == "stable",
            "outside": self.verdict.right,
            "poles": [pole.to_json_dict() for pole in self.poles],
            "hidden": [pole.to_json_dict() for pole in self.hidden],
        }


WORDS = (
    ("poles that are not in the left half-plane", "poles that are not inside the unit circle"),
    ("all poles in the right half-plane counted", "all poles outside the unit circle counted"),
    ("in the right half-plane", "outside the unit circle"),
    ("right half-plane", "outside"),
    ("on the imaginary axis", "on the unit circle"),
    ("on the axis", "on the circle"),
    ("meet the axis", "meet the unit circle"),
    ("a pole at 0", "a pole at z = 1"),
    ("poles at 0", "poles at z = 1"),
    ("at s = 0", "at z = 1"),
)
"""What is said of the half-planes of w, and what that means in z."""


def in_z(said: str) -> str:
    """Return what is said of poles in w as it is said of poles in z."""
    for words, others in WORDS:
        said = said.replace(words, others)
    return said


def sampled_poles(
    model: Model, digits: int | None = None, values: Mapping[str, Given] | None = None
) -> SampledPoles:
    """Return the poles of the sampled loop of a model, each enclosed to so many digits."""
    digits = digits or model.analysis.digits or SHORT_DIGITS
    loop = sampled_loop(with_values(model, values))
    if loop.least is None:
        located = located_in_w(loop.tf, {}, digits + GUARD_DIGITS)
        verdict = located.verdict.beside(loop.apart)
        poles = [_pole(root, loop) for root in located.all_poles if not root.im < 0]
    else:  # nearer to 0 the function is another
        roots = roots_in_b(loop.tf, {}, digits)
        verdict = inside(roots, loop.apart)
        poles = [_pole_of_b(root, loop) for root in roots if not root.im > 0]  # z has the other sign
        poles = [pole for pole in poles if pole.size > loop.least]
    hidden = [_in_z_of(root, loop) for root in loop.unseen if not root.im < 0]
    return SampledPoles(
        described(loop), loop.period, _sorted(poles), verdict, digits, _sorted(hidden), loop.least
    )


def _sorted(poles: Iterable[SampledPole]) -> tuple[SampledPole, ...]:
    return tuple(sorted(poles, key=lambda p: float(p.size.mid())))


def _in_z_of(root: Root, loop: SampledLoop) -> SampledPole:
    """Return a pole of the continuous part at samples."""
    with precision(2 * root.working_bits() + 64):
        s = root.enclosure()
        z = (s * ball(loop.period)).exp()
        side = 0 if root.on_imaginary_axis else 1 if root.re > 0 else -1
        return SampledPole(z, abs(z) if side else arb(1), s, root.multiplicity, not root.is_real, side)


def _short(value: acb, is_pair: bool) -> str:
    real, imag = (float(part.mid()) for part in (value.real, value.imag))
    return f"{real:.9g} +- {abs(imag):.9g}j" if is_pair else f"{real:.9g}"


def _pole(root: Root, loop: SampledLoop) -> SampledPole:
    """Return the pole that a root in w is."""
    with precision(2 * root.working_bits() + 64):
        w = root.enclosure()
        side = 0 if root.on_imaginary_axis else 1 if root.re > 0 else -1
        return _at((1 + w) / (1 - w), side, root, loop)


def _pole_of_b(root: Root, loop: SampledLoop) -> SampledPole:
    """Return the pole that a root in ``b = 1/z`` is."""
    with precision(2 * root.working_bits() + 64):
        z = 1 / root.enclosure()
        return _at(z, 1 if abs(z) > 1 else -1, root, loop)


def _at(z: acb, side: int, root: Root, loop: SampledLoop) -> SampledPole:
    if root.is_real:
        z = acb(z.real)
    size = arb(1) if not side else abs(z)
    s = None if z.contains(0) else z.log() / ball(loop.period)
    if s is not None and not side:
        s = acb(arb(0), s.imag)
    if s is not None and root.is_real and z.real > 0:
        s = acb(s.real)
    return SampledPole(z, size, s, root.multiplicity, not root.is_real, side)
