"""Vaughan's form: decaying exponentials, and their products with sine and cosine.

With ``E = exp(-q)``, ``S = E sin q`` and ``C = E cos q`` the hyperbolic functions are ``cosh q = (1 + E^2)/(2
E)`` and ``sinh q = (1 - E^2)/(2 E)``, where ``E^2 = S^2 + C^2``; powers of E cancel but for one at most.
Nothing in this form overflows in the right half-plane (Eppinger & Seering 1988, section "Bending Beam
Models", after Vaughan).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial

from flint import fmpz_mpoly

from symflex.algebra import LAPLACE, Dispersion, Factored, Ring
from symflex.expressions import (
    Call,
    Expression,
    Name,
    format_expression,
    negative,
    number,
    power,
    product_of,
    quotient,
    sum_of,
)
from symflex.print.forms.arrange import Arranger, Sides, length
from symflex.print.forms.arranged import Arranged
from symflex.print.forms.kept import KeptDefinitions
from symflex.print.forms.naming import Naming
from symflex.print.forms.notation import (
    Angle,
    Line,
    angles_of,
    constant_symbols,
    other_kernels,
    plain_printer,
    reachable,
    speed_squared,
    times_length,
    wave_notation,
    wave_times_length,
    wavenumber_laws,
)
from symflex.print.forms.printed import BegunForm, PrintedForm, terms_of
from symflex.transfer import TransferFunction

TRADE = 4  # characters that writing c_0 for a power of the wavenumber must save


def vaughan_draft(tf: TransferFunction, arranged: Arranged) -> BegunForm:
    """Begin the form in ``S = exp(-q)*sin(q)`` and ``C = exp(-q)*cos(q)`` of ``q = sqrt(T*p)``.

    Here ``T = l^2/2`` and ``p = s/a``; with damping p is ``sqrt(c_0)``, which then takes the place of
    ``s/a``. Rods, shafts, strings and beams with shear or axial force are written in ``D = exp(-gamma*l)``.
    """
    page = _DecayingPage(tf, arranged)
    variants = page.variants()
    return BegunForm(min(terms_of(v.body) for v in variants), partial(_shortest, page, variants))


def _shortest(page: _DecayingPage, variants: Sequence[_Variant]) -> PrintedForm:
    _, sides = min(
        (
            (variant.cost + length(*(sides := page.sides(value))), sides)
            for variant in variants
            for value in page.opened(variant)
        ),
        key=lambda candidate: candidate[0],
    )
    return PrintedForm("vaughan", *sides, reachable(sides, page.lines))


@dataclass(frozen=True, slots=True, eq=False)
class _Variant:
    """The function over the ring of decaying functions, in one way of writing powers of s and p in front."""

    body: Factored  # without these powers
    fronts: tuple[Factored, ...]  # ways of writing them in s and p
    cost: int  # how many characters it must save to be preferred


class _DecayingPage:
    """The ring of decaying functions for one transfer function, and what is printed for its generators."""

    def __init__(self, tf: TransferFunction, arranged: Arranged) -> None:
        self._tf = tf
        source = tf.ratio.ring
        used = source.used_in(f for f, _ in tf.ratio.factors)
        self._angles = angles_of(tf.kernels, used)
        self._bending = [
            d
            for d in tf.kernels.dispersions
            if d.kind == "bending"
            and (d.wavenumbers[0] in used or any(a.dispersion is d for a in self._angles))
        ]
        self._lossless = {d.wavenumbers[0] for d in self._bending if speed_squared(d) is not None}
        replaced = {g for a in angles_of(tf.kernels) for g in a.kernels.values()}
        replaced |= {d.wavenumbers[0] for d in self._bending}
        waves = [d.wavenumbers[0] for d in self._bending]
        own = [_of(part, w) for w in waves for part in ("a", "p", "sqrt(2p)", "sqrt(p/2)")]
        functions: list[str] = []
        for i, angle in enumerate(self._angles):
            parts = ("w", "S", "C", "Q") if angle.dispersion.kind == "bending" else ("D",)
            functions += [_of(part, i) for part in parts]
        self.ring = Ring((*(n for n in source.names if n not in replaced), *own, *functions))
        self.lines, symbols = self._explained(used)
        kernels = [k.generator for k in tf.kernels.kernels if k.generator not in replaced]
        closed = {_of("w", i): 0 for i, a in enumerate(self._angles) if a.dispersion.kind == "bending"}
        kept = KeptDefinitions.of(tf, self.ring)
        ring = kept.ring if kept else self.ring
        self._printer = arranged.printer(
            Arranger(ring, symbols, closed, frozenset((*kernels, *functions)), kept)
        )

    def _explained(self, used: frozenset[str]) -> tuple[tuple[Line, ...], dict[str, Expression]]:
        """Return the lines in the paper's order, and the symbols of the generators."""
        tf, naming, printer = self._tf, Naming.of(self._tf), plain_printer(self._tf)
        bent = [(i, a) for i, a in enumerate(self._angles) if a.dispersion.kind == "bending"]
        straight = [(i, a) for i, a in enumerate(self._angles) if a.dispersion.kind != "bending"]
        s_names, c_names, t_names = (naming.take(stem, len(bent)) for stem in "SCT")
        p_names = dict(zip(self._bending, naming.take("p", len(self._bending)), strict=True))
        lossless = [d for d in self._bending if speed_squared(d) is not None]
        a_names = dict(zip(lossless, naming.take("a", len(lossless)), strict=True))
        q_names, d_names = naming.take("Q", len(bent)), naming.take("D", len(straight))
        symbols = dict(constant_symbols(tf))
        lines: list[Line] = []
        for j, (i, angle) in enumerate(bent):
            argument = Call("sqrt", product_of([Name(t_names[j]), Name(p_names[angle.dispersion])]))
            decay = Call("exp", negative(argument))
            lines += [
                (s_names[j], product_of([decay, Call("sin", argument)])),
                (c_names[j], product_of([decay, Call("cos", argument)])),
                (q_names[j], decay),
            ]
            s, c = Name(s_names[j]), Name(c_names[j])
            symbols |= {_of("S", i): s, _of("C", i): c, _of("Q", i): Name(q_names[j])}
            symbols[_of("w", i)] = sum_of([power(s, 2), power(c, 2)])
        others = [
            d
            for d in tf.kernels.dispersions
            if d.kind in ("wave", "pair")
            and (any(w in used for w in d.wavenumbers) or any(a.dispersion is d for _, a in straight))
        ]
        waves = wave_notation(tf, others, naming)
        symbols |= waves.symbols
        rest = dict(waves.lines)
        for name, (i, angle) in zip(d_names, straight, strict=True):
            symbols[_of("D", i)] = Name(name)
            wave = waves.symbols[angle.wavenumber]
            alone = sum(a.wavenumber == angle.wavenumber for a in self._angles) == 1
            if alone and angle.wavenumber not in used and angle.dispersion.kind == "wave":
                exponent = times_length(printer, rest[format_expression(wave)], angle.length)
            else:
                exponent = wave_times_length(printer, wave, angle.length)
            lines.append((name, Call("exp", negative(exponent))))
        for d in self._bending:
            p = Name(p_names[d])
            square = speed_squared(d)
            if square is None:
                lines.append((p.name, printer.square_root(d.characteristic[0])))
            else:
                a = Name(a_names[d])
                symbols[_of("a", d.wavenumbers[0])] = a
                lines += [(p.name, quotient(Name(LAPLACE), a)), (a.name, printer.square_root(square))]
            two = number(2)
            symbols |= {
                _of("p", d.wavenumbers[0]): p,
                _of("sqrt(2p)", d.wavenumbers[0]): Call("sqrt", product_of([two, p])),
                _of("sqrt(p/2)", d.wavenumbers[0]): Call("sqrt", quotient(p, two)),
            }
        for j, (_, angle) in enumerate(bent):
            lines.append((t_names[j], printer.quotient(angle.length**2 / 2)))
        decays, _ = other_kernels(tf, used, naming, printer)
        return (*lines, *waves.lines), {**symbols, **decays}

    def variants(self) -> list[_Variant]:
        """Return the function over the ring, in all ways of trading powers of s for powers of p."""
        powers = [(self._tf.ratio, 0)]
        laws = wavenumber_laws(self._tf)
        for d in self._bending:
            (w,) = d.wavenumbers
            if self._tf.ratio.depends_on(w):
                powers = [(v * laws[w] ** t, c + TRADE * abs(t)) for v, c in powers for t in (0, -1, 1)]
        return [self._changed(value, cost) for value, cost in powers]

    def opened(self, variant: _Variant) -> list[Factored]:
        """Return what is printed of a variant."""
        body = self._opened(variant.body)
        return [self._merged_roots(body * front) for front in variant.fronts]

    def _changed(self, value: Factored, cost: int) -> _Variant:
        front: dict[str, int] = {}
        body = Factored.number(self.ring, value.unit)
        powers = [0] * len(self._angles)
        source = value.ring
        single = {str(source.generator(n)): n for n in (LAPLACE, *(d.wavenumbers[0] for d in self._bending))}
        for factor, exponent in value.factors:
            if (name := single.get(str(factor))) is not None:
                front[name] = exponent
                continue
            image, lowered = self._decaying(factor)
            body = body * image**exponent
            powers = [n - m * exponent for n, m in zip(powers, lowered, strict=True)]
        for i, (angle, n) in enumerate(zip(self._angles, powers, strict=True)):
            body = body * self._exponential(i, angle, n)
        return _Variant(body, tuple(self._front(front)), cost)

    def _merged_roots(self, value: Factored) -> Factored:
        """Return a value with ``sqrt(2*p)`` for ``2*sqrt(p/2)``."""
        for d in self._bending:
            small, large = (
                Factored.generator(self.ring, _of(part, d.wavenumbers[0]))
                for part in ("sqrt(p/2)", "sqrt(2p)")
            )
            for exponent, times in ((1, value.unit.numerator), (-1, value.unit.denominator)):
                if (small.factors[0][0], exponent) in value.factors and times % 2 == 0:
                    value = value * (large / small / 2) ** exponent
        return value

    def _exponential(self, i: int, angle: Angle, n: int) -> Factored:
        """Return ``exp(-q)^n``, as few times itself as there can be."""
        if angle.dispersion.kind != "bending":
            return Factored.generator(self.ring, _of("D", i)) ** n
        pairs = int(n / 2)
        w, q = (Factored.generator(self.ring, _of(part, i)) for part in "wQ")
        return w**pairs * q ** (n - 2 * pairs)

    def _front(self, powers: dict[str, int]) -> list[Factored]:
        """Return powers of s and of wavenumbers in s, and in p alone where these stand against each other."""
        j = powers.get(LAPLACE, 0)
        s = Factored.generator(self.ring, LAPLACE) ** j
        plain = s
        for d in self._bending:
            plain = plain * self._power_of_p(d, powers.get(d.wavenumbers[0], 0), 0)
        for d in self._bending:
            (w,) = d.wavenumbers
            e = powers.get(w, 0)
            if not e or not j or w not in self._lossless:
                continue
            merged = plain / s / self._power_of_p(d, e, 0) * self._power_of_p(d, e, j)
            merged = merged * Factored.generator(self.ring, _of("a", w)) ** j
            return [merged] if e * j < 0 else [plain, merged]
        return [plain]

    def _power_of_p(self, dispersion: Dispersion, e: int, j: int) -> Factored:
        """Return ``mu^e p^j`` with at most one square root, where ``mu = sqrt(p/2)``."""
        (w,) = dispersion.wavenumbers

        def of(part: str) -> Factored:
            return Factored.generator(self.ring, _of(part, w))

        if e % 2 == 0:
            return of("p") ** (e // 2 + j) * Fraction(2) ** (-e // 2)
        doubled = e + 2 * j
        if doubled < 0:
            # Not sqrt(2/p), which is minus one over sqrt(p/2) where p is negative.
            return of("p") ** ((doubled + 1) // 2) * Fraction(2) ** (-(e + 1) // 2) / of("sqrt(p/2)")
        if e > 0:
            return of("sqrt(p/2)") * of("p") ** ((doubled - 1) // 2) * Fraction(2) ** (-(e - 1) // 2)
        return of("sqrt(2p)") * of("p") ** ((doubled - 1) // 2) * Fraction(2) ** (-(e + 1) // 2)

    def _decaying(self, factor: fmpz_mpoly) -> tuple[Factored, list[int]]:
        """Return a polynomial times powers of the decaying exponentials, and these powers."""
        source, ring = self._tf.ratio.ring, self.ring
        index = source.index
        terms = [(tuple(int(e) for e in m), int(c)) for m, c in factor.terms()]
        waves = [index[d.wavenumbers[0]] for d in self._bending]
        members = [[index[g] for g in a.kernels.values()] for a in self._angles]
        degrees = [max(sum(m[i] for i in inside) for m, _ in terms) for inside in members]
        highest = [max(m[i] for m, _ in terms) for i in waves]
        images = self._images()
        groups: dict[tuple[int, ...], dict[tuple[int, ...], int]] = {}
        for m, c in terms:
            missing = [d - sum(m[i] for i in inside) for d, inside in zip(degrees, members, strict=True)]
            halves = sum(missing) + sum(h - m[i] for h, i in zip(highest, waves, strict=True))
            key = (*missing, *(m[i] for i in waves))
            rest = tuple(0 if i in waves else e for i, e in enumerate(m))
            groups.setdefault(key, {})[rest] = c * 2**halves
        total = ring.constant(0)
        for key, group in groups.items():
            part = source.context.from_dict(group).compose(*images, ctx=ring.context)
            for i, (angle, n) in enumerate(zip(self._angles, key[: len(degrees)], strict=True)):
                part = part * self._exponential(i, angle, n).expand()
            for d, e in zip(self._bending, key[len(degrees) :], strict=True):
                p, root = (ring.generator(_of(x, d.wavenumbers[0])) for x in ("p", "sqrt(2p)"))
                part = part * (2 * p) ** (e // 2) * root ** (e % 2)
            total = total + part
        return Factored.polynomial(ring, total) / 2 ** (sum(degrees) + sum(highest)), degrees

    def _images(self) -> list[fmpz_mpoly]:
        """Return what stands for every generator, twice the decaying exponential taken out of each kernel."""
        ring = self.ring
        images: dict[str, fmpz_mpoly] = {}
        for i, angle in enumerate(self._angles):
            kernels = angle.kernels
            if angle.dispersion.kind == "bending":
                w, s, c = (ring.generator(_of(part, i)) for part in "wSC")
                images |= {kernels["cos"]: 2 * c, kernels["sin"]: 2 * s}
            else:
                d = ring.generator(_of("D", i))
                w = d * d
            images |= {kernels["cosh"]: 1 + w, kernels["sinh"]: 1 - w}
        zero = ring.constant(0)
        return [
            images[n] if n in images else ring.generator(n) if n in ring.index else zero
            for n in self._tf.ratio.ring.names
        ]

    def _opened(self, value: Factored) -> Factored:
        """Return a value with single ``S^2 + C^2`` opened where no sum gets longer by that."""
        factors = []
        for factor, exponent in value.factors:
            best = factor
            for i, angle in enumerate(self._angles):
                if angle.dispersion.kind != "bending" or len(best) == 1:
                    continue
                opened = self._open(best, i)
                if length(self._printer.sum(opened)) <= length(self._printer.sum(best)):
                    best = opened
            factors.append((best, exponent))
        return Factored(self.ring, value.unit, tuple(factors))

    def _open(self, polynomial: fmpz_mpoly, i: int) -> fmpz_mpoly:
        ring = self.ring
        w = ring.index[_of("w", i)]
        s, c = (ring.generator(_of(part, i)) for part in "SC")
        places = [ring.index[_of(part, i)] for part in "SCQ"]
        kept: dict[tuple[int, ...], int] = {}
        alone: dict[tuple[int, ...], int] = {}
        for monomial, coefficient in polynomial.terms():
            m = [int(e) for e in monomial]
            if m[w] == 1 and not any(m[k] for k in places):
                m[w] = 0
                alone[tuple(m)] = int(coefficient)
            else:
                kept[tuple(m)] = int(coefficient)
        return ring.context.from_dict(kept) + ring.context.from_dict(alone) * (s * s + c * c)

    def sides(self, value: Factored) -> Sides:
        """Return numerator and denominator."""
        return self._printer.sides(value)


def _of(part: str, owner: str | int) -> str:
    return f"{part}[{owner}]"
