"""Functions of beams in the kernels of books: of ``beta*l``, real at every frequency of an undamped beam.

Input: a transfer function in kernels of ``mu``, ``4 mu^4 = c_0``, whose exponents are ``mu*(+-1 +-j)``.
Output: the same in kernels of ``beta``, ``beta^4 = -c_0``, whose exponents are ``+-beta`` and ``+-j*beta``:

    cosh(mu*l)^2 + cos(mu*l)^2        1 + cosh(beta*l)*cos(beta*l)
    cosh(mu*l)^2 - cos(mu*l)^2        sinh(beta*l)*sin(beta*l)

Both are written in Krylov-Duncan functions, which depend on ``c_0`` alone (Krylov 1931): ``K_0 = (cosh(q) +
cos(q))/2``, ``K_1 = (sinh(q) + sin(q))/(2*beta)``, ... of ``q = beta*l``.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Final

from flint import fmpz_mpoly

from symflex.algebra import Dispersion, Factored, KernelTable, Ring
from symflex.algebra.normal_form import NormalForm
from symflex.print.forms.economical import apart, economical
from symflex.print.forms.invariants import Invariants, in_krylov_functions, krylov_name
from symflex.print.forms.naming import BETA
from symflex.transfer import TransferFunction

FOURTH: Final = Fraction(-1, 4)  # what mu^4 is of beta^4


def as_in_books(tf: TransferFunction) -> TransferFunction:
    """Return a function in kernels of beta where it can be, of lengths apart where it is shorter so."""
    return apart(in_beta(apart(tf)) or in_beta(tf) or tf)


def in_beta(tf: TransferFunction) -> TransferFunction | None:
    """Return a function in kernels of beta and whole lengths, None if it is not seen to be one."""
    bending = [
        d
        for d in tf.kernels.dispersions
        if d.kind == "bending" and d.shift.is_zero and not d.wavenumbers[0].startswith(BETA)
    ]
    kernels = tuple(k for k in tf.kernels.kernels if k.dispersion in bending)
    if not bending:
        return tf
    table = KernelTable(tuple(bending), kernels)
    converted = in_krylov_functions(tf.ratio.ring, table, tf.ratio)
    if converted is None:
        return None
    change, value = converted
    names = {d.wavenumbers[0]: f"{BETA}[{i}]" for i, d in enumerate(bending)}
    ring = Ring(tuple(names.get(n, n) for n in tf.ratio.ring.names))
    laws = {d: _law(d, names[d.wavenumbers[0]]) if d in bending else d for d in tf.kernels.dispersions}
    own = {k.generator: k for k in change.table.kernels}
    merged = (own.get(k.generator, k) for k in tf.kernels.kernels)
    kernels = tuple(
        replace(k, dispersion=laws[k.dispersion], wavenumber=names.get(k.wavenumber, k.wavenumber))
        for k in merged
    )
    plain = KernelTable(tuple(laws.values()), kernels)
    normal = NormalForm(ring, plain.embedded([(v, v.over(ring)) for v in plain.values]))
    image = Factored.number(ring, value.unit)
    waves = [(change.ring.generator(w), Factored.generator(ring, beta)) for w, beta in names.items()]
    for factor, n in value.factors:
        beta = next((beta for wave, beta in waves if wave == factor), None)
        if beta is not None and n % 4:
            return None
        part = _image(change, ring, names, factor) ** n if beta is None else beta**n * FOURTH ** (n // 4)
        image = image * part
    return economical(replace(tf, reduced=normal.reduce_factored(image), kernels=normal.table, parts=None))


def krylov_of_beta(
    tf: TransferFunction, change: Invariants, value: Factored
) -> tuple[TransferFunction, Invariants, Factored]:
    """Return a value in Krylov-Duncan functions as one of beta, with its change, and 1 as such a function."""
    bending = [d for d in change.table.dispersions if d.kind == "bending"]
    names = {d.wavenumbers[0]: f"{BETA}[{i}]" for i, d in enumerate(bending)}
    base, ring = (Ring(tuple(names.get(n, n) for n in r.names)) for r in (tf.ratio.ring, change.ring))
    waves = [change.ring.index[w] for w in names]

    def renamed(factor: fmpz_mpoly) -> Factored:
        terms = [([int(e) for e in m], int(c)) for m, c in factor.terms()]
        values = {tuple(m): c * FOURTH ** (sum(m[w] for w in waves) // 4) for m, c in terms}
        below = max(x.denominator for x in values.values())
        whole = ring.context.from_dict({m: int(x * below) for m, x in values.items()})
        return Factored.polynomial(ring, whole) / Factored.number(ring, below)

    # A factor that is a power of mu is one of its fourth power.
    made = Factored.number(ring, value.unit)
    for factor, n in value.factors:
        is_wave = any(factor == change.ring.generator(w) for w in names)
        made = made * renamed(factor) ** n * (FOURTH ** (n // 4) if is_wave else 1)
    laws = {d: _law(d, names[d.wavenumbers[0]]) if d in bending else d for d in tf.kernels.dispersions}
    plain = KernelTable(
        tuple(laws.values()),
        tuple(
            replace(k, dispersion=laws[k.dispersion], wavenumber=names.get(k.wavenumber, k.wavenumber))
            for k in change.table.kernels
        ),
    )
    table = plain.embedded([(v, v.over(base)) for v in plain.values])
    own = replace(tf, reduced=Factored.number(base, 1), kernels=table, parts=None)
    return own, Invariants(base, table), made


def _law(law: Dispersion, name: str) -> Dispersion:
    """Return a law whose ``4 mu^4 = c_0`` is ``beta^4 = -c_0`` of a beam."""
    return replace(law, wavenumbers=(name,), characteristic=tuple(c * -4 for c in law.characteristic))


def _image(change: Invariants, ring: Ring, names: dict[str, str], factor: fmpz_mpoly) -> Factored:
    """Return a polynomial in Krylov-Duncan functions and ``mu^4`` over the ring of beta."""
    source = change.ring
    waves = [source.index[w] for w in names]
    owner = [
        (source.index[krylov_name(i, order)], order, source.index[group[0].wavenumber])
        for i, group in enumerate(change.angles)
        for order in range(4)
    ]
    images = {n: ring.generator(names.get(n, n)) for n in change.source.names}
    for i, (angle,) in enumerate(change.angles):
        ch, sh, co, si = (ring.generator(angle.kernels[f]) for f in ("cosh", "sinh", "cos", "sin"))
        for order, twice in enumerate((ch + co, sh + si, ch - co, sh - si)):
            images[krylov_name(i, order)] = twice
    # Powers of beta are divided out: those that K_m are divided by, and mu^4 = -beta^4/4.
    terms = []
    for monomial, coefficient in factor.terms():
        m, value = [int(e) for e in monomial], Fraction(int(coefficient))
        for w in waves:
            value *= FOURTH ** (m[w] // 4)
        for k, order, w in owner:
            value /= 2 ** m[k]
            m[w] -= order * m[k]
        terms.append((m, value))
    least = {w: min(m[w] for m, _ in terms) for w in waves}
    below = max(value.denominator for _, value in terms)
    lowered = {tuple(e - least.get(i, 0) for i, e in enumerate(m)): int(value * below) for m, value in terms}
    zero = ring.constant(0)
    work = source.context.from_dict(lowered).compose(
        *(images.get(n, zero) for n in source.names), ctx=ring.context
    )
    result = Factored.polynomial(ring, work) / Factored.number(ring, below)
    for w in waves:
        result = result * Factored.generator(ring, names[source.names[w]]) ** least[w]
    return result
