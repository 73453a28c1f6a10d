"""How far two functions with numbers are apart.

Input: a function and one in its place, both bound to the same values.
Output: the largest displacement of a pole and of a zero in a band, and where the magnitudes agree.

    1/(m s^2 + b s + k) with k 1 % less     the poles move by 0.5 %, the magnitude differs most beside them

On a piece of the imaginary axis about s_0 the quotient is ``Q = Q(s_0) exp((s - s_0) Q'/Q)``, with Q'/Q in
balls on the whole piece (the mean value theorem for ln Q); pieces are halved until they are decided.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from decimal import ROUND_CEILING, Context
from fractions import Fraction
from functools import cache
from itertools import combinations_with_replacement
from math import comb, factorial, inf, isfinite, isnan, log, nextafter, prod

from flint import acb, acb_poly, arb, arb_poly

from symflex.balls import covered, precision
from symflex.budget import spend
from symflex.print.forms.printed import Approximation
from symflex.roots import PoleZeroMap, Root
from symflex.roots.locate import locate
from symflex.roots.region import Band
from symflex.roots.root import modes_of
from symflex.transfer import BoundTransferFunction

Term = tuple[int, acb, Sequence[int]]  # a power of s, the rest at the values, and exponents of letters

BITS = 128
DECADE = 10  # ratio of a band's ends to the lowest and the highest root, where the model declares no band
NARROWEST = 1e-4  # shortest piece of a band whose magnitude is examined, as a share of the band's logarithm
UNCHANGED = 1e-12  # change below which the radius of a ball is all there is
LOST = 0.5  # displacement from which a root is no longer taken for the same one
DECIBELS = 1.0  # difference in magnitude that statements are about: 12 %
BESIDE = 1.05  # ratio of frequencies up to which a part of the band is joined to a resonance or to a gap
HIGHEST, MOST_PRODUCTS = 7, 200_000  # orders in changes of letters, products of these in a second
TRIES = 12  # radii about a root that are tried
SHOWN = 6  # number of parts of a band, or of roots, that a sentence lists


def percent(share: float) -> str:
    """Return a bound in percent, rounded up.

    >>> percent(0.005401), percent(0.0)
    ('0.55 %', '0 %')
    """
    shown = Context(prec=2, rounding=ROUND_CEILING).create_decimal_from_float(100 * share)
    return f"{float(shown):.10g} %" if isfinite(share) else "an unknown share"


def distance(
    before: BoundTransferFunction,
    after: BoundTransferFunction,
    roots: tuple[PoleZeroMap, PoleZeroMap],
    errors: Sequence[float] = (),
    over_box: Sequence[float | None] = (None, None),
) -> Approximation:
    """Return how far a function is from the one it stands in place of, in the band of the model.

    For each of some relative ``errors`` it says up to which frequency it is not exceeded. ``over_box``
    are displacements of poles and of zeros over a spread.
    """
    first, second = roots
    low, high = band = band_of(before, first)
    said: list[str] = []
    facts: dict[str, object] = {"band_hz": [low, high]}
    places = {}
    both = ("poles", first.poles, second.poles), ("zeros", first.zeros, second.zeros)
    for (kind, one, other), over in zip(both, over_box, strict=True):
        worst, compared, lost = _moved(one, other, high)
        how = f"moved by at most {percent(worst)}" if worst > UNCHANGED else "unchanged"
        if over:
            how += f", over the spread {f'by {percent(over)}' if isfinite(over) else 'not bounded'}"
        parts = [f"{compared} {how}"] * bool(compared) + [f"{lost} without a counterpart"] * bool(lost)
        said += [f"{kind} up to {high:.4g} Hz: {', '.join(parts)}"] if parts else []
        known = over if over is not None and isfinite(over) else None
        facts[kind] = {"displacement": worst, "spread": known, "compared": compared, "lost": lost}
        places[kind] = tuple({r.frequency_hz(): None for r in modes_of(one)})
    facts["certified"] = is_certified = first.certificate.certified and second.certificate.certified
    said += [] if is_certified else ["NOT CERTIFIED: roots may be missing"]
    quotient = _quotient(before, after)
    for error in errors:
        pieces = _proved(quotient, band, lambda q: abs(q - 1), error)
        end = next((b for a, b in pieces if a == low), None)
        facts[f"within_{100 * error:g}_percent_to_hz"] = end
        said += [f"error at most {percent(error)}: {low:.4g} to {end:.4g} Hz"] if end else []
    kept, where = alike(quotient, band)
    said.append(f"magnitude {where}")
    ends, excepted = [low, *(end for piece in kept for end in piece), high], []
    for a, b in zip(ends[::2], ends[1::2], strict=True):
        if a < b:
            inside = {k: [f for f in v if a <= BESIDE * f and f <= BESIDE * b] for k, v in places.items()}
            shown = [f"{k} at {', '.join(f'{x:.4g}' for x in v[:SHOWN])} Hz" for k, v in inside.items() if v]
            said.append(", ".join([f"except {a:.4g} to {b:.4g} Hz", *shown]))
            excepted.append({"band_hz": [a, b], **{f"{k}_hz": v for k, v in inside.items()}})
    facts |= {"within_1_db_hz": [[*piece] for piece in kept], "excepted": excepted}
    return Approximation(tuple(said), facts)


def roots_of(
    before: BoundTransferFunction, after: BoundTransferFunction, first: PoleZeroMap | None = None
) -> tuple[PoleZeroMap, PoleZeroMap]:
    """Return the roots of two functions, of distributed ones those in the band of the first."""
    band = before.source.model.analysis.band
    region = None if before.is_rational or band is None else Band(Fraction(0), band[1])
    first = first or locate(before, region, 15)
    if after is before:
        return first, first
    more = Band(Fraction(0), Fraction(band_of(before, first)[1]) * 5 / 4)
    # Nothing is known of the second from the model's energy.
    return first, locate(replace(after, is_of_model=False), None if after.is_rational else more, 15)


def band_of(bound: BoundTransferFunction, roots: PoleZeroMap) -> tuple[float, float]:
    """Return the declared band [Hz], or one that shows all roots."""
    band = bound.source.model.analysis.band
    if band is not None:
        return float(band[0]), float(band[1])
    sizes = [r.frequency_hz() for r in (*roots.poles, *roots.zeros) if not r.is_zero] or [1.0]
    poles = [r.frequency_hz() for r in roots.poles if not r.is_zero]
    # A distributed system has further poles above the last one found.
    return min(sizes) / DECADE, max(poles or sizes) * (1 if roots.is_infinite else DECADE)


def _quotient(before: BoundTransferFunction, after: BoundTransferFunction) -> Callable[[float, float], acb]:
    """Return what encloses the quotient of two functions between two frequencies [Hz]."""
    sides = [(1, after.enclosed(BITS)), (-1, before.enclosed(BITS))]
    if before.ratio.ring.names == after.ratio.ring.names and before.is_rational == after.is_rational:
        # What both have cancels.
        sides = [(1, replace(before, ratio=after.ratio / before.ratio, parts=None).enclosed(BITS))]

    def enclosed(low: float, high: float) -> acb:
        turn = 2 * arb.pi()
        piece = acb(0, (low * turn).union(high * turn))
        value, slope = acb(1), acb(0)
        for sign, each in sides:
            value *= each(piece.mid()) ** sign
            slope += sign * each.logarithmic_derivative(piece)
        return value * ((piece - piece.mid()) * slope).exp()

    return cache(enclosed)


def upper(value: arb) -> float:
    """Return a double that no number in a ball exceeds."""
    found = 0.0 if value == 0 else nextafter(float(value.upper()), inf)  # nan is neither
    return inf if isnan(found) else found


def _moved(before: Sequence[Root], after: Sequence[Root], high_hz: float) -> tuple[float, int, int]:
    """Match roots, the closest ones first, and bound how far they are apart."""
    one = [r for r in modes_of(before) if r.frequency_hz() <= high_hz]
    other = modes_of(after)
    gaps = [
        (abs(complex(a) - complex(b)) / abs(complex(a)), i, j)
        for i, a in enumerate(one)
        for j, b in enumerate(other)
    ]
    pairs: dict[int, int] = {}
    for gap, i, j in sorted(gaps):
        if gap <= LOST and i not in pairs and j not in pairs.values():
            pairs[i] = j
    balls = [(one[i].enclosure(), other[j].enclosure()) for i, j in pairs.items()]
    worst = max((upper(abs(a - b) / abs(a)) for a, b in balls), default=0.0)
    return worst, len(pairs), len(one) - len(pairs)


def moved_over(terms_before: Sequence[Term], gone: Sequence[Term], root: acb, halves: Sequence[arb]) -> float:
    """Bound how far a root moves, relative to it, where terms go and letters are ``exp(x_j)`` times theirs.

    In ``s = root y exp(a x)``, a the slopes of its logarithm, y keeps next to 1 for ``|x_j| <= halves[j]``.
    For ``|y - 1| <= R`` the slope in y has along that at 1 a real part of at least ``2 |slope| - N'(R)``,
    where N adds up by powers of y - 1 what all terms are at most, and M those that go. So a root lies within
    ``N(0)`` over it of 1, and the one without these terms within ``M(R)`` over it of that, if both together
    do not exceed R (Rouche).
    """
    weighted, without = ([(n, v * root**n, m) for n, v, m in terms] for terms in (terms_before, gone))
    every = range(len(halves))
    slope = sum((c * n for n, c, _ in weighted), acb(0))
    rates = [-sum((c * m[j] for _, c, m in weighted), acb(0)) / slope for j in every]
    # A power of each letter is taken out of all terms, so that it does not change the slope either.
    means = [sum((c * n * (m[j] + n * rates[j]) for n, c, m in weighted), acb(0)) / slope for j in every]
    cheap = (k for k in range(2, HIGHEST) if comb(len(halves) + k, k) * (30 + len(weighted)) < MOST_PRODUCTS)
    order = max(cheap, default=1)
    products = [p for k in range(order + 1) for p in combinations_with_replacement(every, k)]
    sizes = [prod((halves[i] / (k - p.index(i)) for k, i in enumerate(p, 1)), start=arb(1)) for p in products]

    def most(terms: Sequence[Term]) -> arb_poly:
        parts = [[acb(0)] * (1 + max(n for n, *_ in weighted)) for _ in (*sizes, 1)]
        for n, c, m in terms:
            along = [m[j] + n * rates[j] - means[j] for j in every]
            x = sum((abs(a) * half for a, half in zip(along, halves, strict=True)), arb(0)).abs_upper()
            for part, product in zip(parts, products, strict=False):
                part[n] += prod((along[i] for i in product), start=c)
            parts[-1][n] += abs(c) * (x.exp() - sum((x**k / factorial(k) for k in range(order + 1)), arb(0)))
        about_one = [(acb_poly(p)(acb_poly([1, 1])), x) for p, x in zip(parts, (*sizes, arb(1)), strict=True)]
        return sum((arb_poly([abs(c) * x for c in p]) for p, x in about_one), arb_poly([0]))

    near, moved, reach = most(weighted), most(without), arb(0)
    for _ in range(TRIES):
        spend()
        floor = 2 * abs(slope) - near.derivative()(reach)
        needed = (near[0] + moved(reach)) / floor
        if floor > near[0] and needed <= reach:
            return upper(moved(reach) / (floor - near[0]))
        reach = (needed * arb("1.1")).upper()
    return inf


def alike(
    quotient: Callable[[float, float], acb], band: tuple[float, float], narrowest: float = NARROWEST
) -> tuple[tuple[tuple[float, float], ...], str]:
    """Return the parts of a band [Hz] in which the magnitude of a quotient is near 1, and words for them."""
    kept = _proved(quotient, band, lambda q: abs(abs(q).log()), DECIBELS / 20 * log(10), narrowest)
    where = " and ".join(f"{a:.4g} to {b:.4g}" for a, b in kept[:SHOWN]) or "nowhere"
    return kept, f"within {DECIBELS:g} dB: {where} Hz"


def _proved(
    quotient: Callable[[float, float], acb],
    band: tuple[float, float],
    measure: Callable[[acb], arb],
    most: float,
    narrowest: float = NARROWEST,
) -> tuple[tuple[float, float], ...]:
    """Return the parts of a band [Hz] in which a measure of the quotient is proved below a bound."""

    def at(t: float) -> float:
        return band[int(t)] if t in (0, 1) else band[0] * (band[1] / band[0]) ** t

    def decide(a: float, b: float) -> bool | None:
        with precision(BITS):
            found = measure(quotient(at(a), at(b)))
            is_decided = found < most or found > most or b - a < 2 * narrowest
            return bool(found < most) if is_decided else None

    joined: list[tuple[float, float]] = []
    for a, b in sorted((at(a), at(b)) for a, b, good in covered(decide, 16, narrowest / 4) if good):
        if joined and a <= joined[-1][1]:
            joined[-1] = joined[-1][0], b
        else:
            joined.append((a, b))
    return tuple((a, b) for a, b in joined if b > BESIDE * a)
