"""Series over prime fields, and the orders read off them, against what calculus says."""

from itertools import islice, pairwise, product

from flint import fmpz

from symflex.algebra import Dispersion, Factored, Ring
from symflex.algebra.propagators import propagate
from symflex.algebra.vanishing import BASE, OriginSeries, TaylorField, Vanishing, find_point, primes

RING = Ring(("s", "r", "p", "l", "x"))
S, R, P, L, X = (Factored.generator(RING, name) for name in RING.names)
ZERO = S * 0
LAWS = {
    "wave": (R * S**2 * -1, ZERO),
    "bending": (R * S**2, ZERO, ZERO, ZERO),
    "pair": (R * S**2, ZERO, P * S**2 * -1 - R, ZERO),
    "general": (R * S**2, P, S, R),
}
FIELD = TaylorField(10)


def test_the_fields_are_primes_one_above_a_multiple_of_eight():
    """There -1 and 2 have square roots, and with -1 a fourth root."""
    found = list(islice(primes(), 20))
    assert all(fmpz(p).is_prime() and p % 8 == 1 for p in found)
    assert all(a < b for a, b in pairwise(found))


def test_a_power_stands_on_its_start_and_an_order_is_that_of_the_first_term():
    assert [list(map(int, FIELD.power(*given))) for given in ((0,), (0, 4), (3, 5), (1,))] == [
        [1], [5], [5, 0, 0, 1], [0, 1]
    ]  # fmt: skip
    assert [FIELD.order(FIELD.power(n) * 3) for n in (0, 2, 9)] == [0, 2, 9]
    assert FIELD.order(FIELD.constant(FIELD.prime)) is None


def test_series_of_x_are_those_of_the_functions():
    for circular, terms in product([False, True], [8, 9, 10]):
        even, odd = TaylorField(terms).even_odd(FIELD.power(1), 1, circular=circular)
        number = 1
        for n, series in zip(range(terms), [even, odd] * 5, strict=False):
            number *= max(n, 1)
            assert (
                int(series[n]) * number % FIELD.prime == (-1 if circular and n % 4 > 1 else 1) % FIELD.prime
            ), terms
        assert not any(int(even[n]) for n in (1, 3, 5)), (circular, terms)
        assert not any(int(odd[n]) for n in (0, 2, 4)), (circular, terms)


def test_even_and_odd_functions_of_any_argument_are_each_other_s_derivatives():
    for circular, start in product([False, True], [BASE, 12345]):
        argument = FIELD.power(2) * 7 + FIELD.power(1, 4)
        even, odd = FIELD.even_odd(argument, start, circular=circular)
        slope, sign = argument.derivative(), -1 if circular else 1
        assert odd.derivative().truncate(9) == FIELD.times(slope, even).truncate(9), (circular, start)
        assert even.derivative().truncate(9) == (FIELD.times(slope, odd) * sign).truncate(9), circular


def test_the_start_is_the_exponential_of_a_constant_or_the_tangent_of_its_half():
    ch, sh = (int(f[0]) for f in FIELD.even_odd(FIELD.constant(4), 7, circular=False))
    assert ((ch + sh) % FIELD.prime, (ch * ch - sh * sh) % FIELD.prime) == (7, 1)
    co, si = (int(f[0]) for f in FIELD.even_odd(FIELD.constant(4), 7, circular=True))
    assert (7 * (1 + co) - si) % FIELD.prime == 0
    assert (co * co + si * si) % FIELD.prime == 1


def test_a_rational_function_of_series_times_its_denominator_is_its_numerator_if_that_has_a_reciprocal():
    values = {n: FIELD.power(k + 1, k + 2) for k, n in enumerate(RING.names)}
    found = FIELD.rational((S + R) ** 3 / (P - L * 2) ** 2 / 3 * 5, RING.names, values)
    below = values["p"] - values["l"] * 2
    above = values["s"] + values["r"]
    assert (
        FIELD.times(FIELD.times(below, below), found * 3) == FIELD.times(FIELD.times(above, above), above) * 5
    )
    values = {n: FIELD.power(k) for k, n in enumerate(RING.names)}
    assert FIELD.rational(1 / R, RING.names, values) is None
    assert FIELD.rational(R / S, RING.names, values) == FIELD.power(1)


def test_a_root_of_a_series_that_starts_with_a_square_has_all_terms_and_others_have_none():
    assert FIELD.root(FIELD.power(3) * 4) is None
    assert FIELD.root(FIELD.constant(0)) is None
    for series in [FIELD.power(1, 9), FIELD.power(3, 4) * 16 + FIELD.power(1)]:
        root = FIELD.root(series)
        assert FIELD.times(root, root) == series


# ------------------------------------------------------------------------------------- orders at zeros


def over(ring, v):
    """Return a value over a ring with more generators."""
    images = ring.context.gens()[: len(RING.names)]
    return Factored(ring, v.unit, tuple((f.compose(*images, ctx=ring.context), e) for f, e in v.factors))


def kernels_of(kind, shift=ZERO, lengths=(L, X)):
    """Return a ring with a dispersion's wavenumbers and kernels, its table, and its generators."""
    found = propagate(RING, [(Dispersion("w", kind, LAWS.get(kind, ()), shift), list(lengths))])
    ring = found.kernel_ring
    table = found.table.embedded([(v, over(ring, v)) for v in found.table.values])
    return ring, table, [Factored.generator(ring, n) for n in ring.names]


# Near s = 0: gamma ~ s, mu ~ sqrt(s), and of a pair one wavenumber ~ s while the other stays.
ORDERS = {
    "wave": [
        (lambda s, r, p, a, b, w, c, d, *_: w**3 * s**-1, 2),
        (lambda s, r, p, a, b, w, c, d, *_: d * s**-2, -1),
        (lambda s, r, p, a, b, w, c, d, *_: (c - 1) * d**2 / w, 3),
        (lambda s, r, p, a, b, w, c, d, e, f: (d * f * a - w * f) * (c - e), 4),
        (lambda s, r, p, a, b, w, c, d, *_: w**2 - r * s**2, None),
        (lambda s, r, p, a, b, w, c, d, *_: c**2 - d**2 - 1, None),
    ],
    "bending": [
        (lambda s, r, p, a, b, w, c, d, e, f, *_: (c * f - d * e) * w, 2),
        (lambda s, r, p, a, b, w, c, d, e, f, *_: (c * f - d * e) * w**-3, 0),
        (lambda s, r, p, a, b, w, c, d, e, f, *_: (c * e - 1) * (c * f + d * e) * w, 3),
        (lambda s, r, p, a, b, w, *_: w, None),
        (lambda s, r, p, a, b, w, *_: w**4 * 4 - r * s**2, None),
        (lambda s, r, p, a, b, w, c, d, e, f, *_: e**2 + f**2 - 1, None),
    ],
    "pair": [
        (lambda s, r, p, a, b, v, w, *_: v * w, 1),
        (lambda s, r, p, a, b, v, w, *_: v**2 + w**2 - p * s**2 - r, None),
        (lambda s, r, p, a, b, v, w, *_: v**2 * w**2 - r * s**2, None),
        (lambda s, r, p, a, b, v, w, *_: v**2 + w**2 - r, 2),
    ],
}  # fmt: skip


def test_an_order_at_the_origin_is_that_of_the_function_with_its_wavenumbers_in_s():
    for kind, function, order in [(kind, *case) for kind, cases in ORDERS.items() for case in cases]:
        ring, table, gens = kernels_of(kind)
        assert OriginSeries(ring, table).order(function(*gens)) == order


def test_decays_start_at_one_where_their_rate_is_zero():
    ring, table, (s, _, _, a, b, first, second) = kernels_of("exponential", S)
    origin = OriginSeries(ring, table)
    assert [origin.order(f) for f in (first, 1 - first, first - second, first * second - 1)] == [0, 1, 1, 1]
    assert origin.order(first - second + s * (a - b)) == 2


def test_an_order_where_something_else_vanishes_is_that_of_the_factor():
    for at, function, order in [
        (S - R, (S**2 - R**2) * S, 1),
        (S**2 - R, (S**2 - R) ** 2 / (S + 1), 2),
        (P * 2 - S, S - P * 2, 1),
        (P * 2 - S, R / (S - P * 2) ** 3, -3),
        (S * P - 3, S**2 * P**2 - 9, 1),
    ]:
        ring, table, _ = kernels_of("wave")
        assert OriginSeries(ring, table, over(ring, at).expand()).order(over(ring, function)) == order
    ring, table, (_, r, *_, w, _, d, _, _) = kernels_of("wave")
    origin = OriginSeries(ring, table, r.expand())
    assert [origin.order(f) for f in (w**2, d / w, w)] == [1, 0, None]


def test_nothing_is_said_of_a_dispersion_without_names():
    ring, table, (s, *_) = kernels_of("general")
    assert OriginSeries(ring, table).order(s) is None


def test_a_point_where_nothing_is_linear_is_a_root_in_some_field():
    ring, table, (s, r, p, *_) = kernels_of("wave")
    at = s**2 + r**2 + p**2 - 5
    origin = OriginSeries(ring, table, at.expand())
    assert [origin.order(f) for f in (s, at, at**3 * r)] == [0, 1, 3]


def test_a_point_where_all_relations_hold_has_values_beside_dispersions_without_names():
    laws = [Dispersion(kind, kind, LAWS[kind], ZERO) for kind in ("general", "wave", "pair")]
    found = propagate(RING, [(law, [L, X]) for law in laws])
    ring = found.kernel_ring
    table = found.table.embedded([(v, over(ring, v)) for v in found.table.values])
    field, values = find_point(ring, table, 1, lambda values, field: True)
    for even in (k for k in table.kernels if k.function == "cosh"):
        c, s = (Factored.generator(ring, even.generator.replace("cosh", f)) for f in ("cosh", "sinh"))
        assert field.order(field.rational(c**2 - s**2 - 1, ring.names, values)) is None
    g, v, w = (Factored.generator(ring, n) ** 2 for n in table.wavenumbers)
    _, wave, two = table.dispersions
    for zero in (g + wave.characteristic[0], v * w - two.characteristic[0], v + w + two.characteristic[2]):
        assert field.order(field.rational(zero, ring.names, values)) is None


def pair():
    """A pair of wavenumbers with its kernels at l and x, and r and p from the dispersion relation."""
    ring, table, gens = kernels_of("pair")
    s, _, _, _, _, v, w, *rest = gens
    c, d, e, f = rest[:4]
    r = v**2 * w**2 / s**2
    vanishing = Vanishing(ring, table, [(("r", r), ("p", (v**2 + w**2 - r) / s**2))])
    return vanishing, table.dispersions[0], gens[:5], (v, w, c, d, e, f), rest[4:]


def test_orders_where_two_wavenumbers_meet_or_one_is_zero_follow_the_dispersion_relation():
    vanishing, law, (s, r, p, *_), (v, w, c, d, e, f), (g, h, i, j) = pair()
    found = [
        vanishing.at_confluence(y.expand(), law)
        for y in (
            c * e, c - e, w * d - v * f, (v * d - w * f) * (c - e) ** 2,
            v - w, g - i, (g - i) * (h * v - j * w), c * g - e * i, c - g,
        )
    ]  # fmt: skip
    assert found == [0, 1, 1, 3, 1, 1, 2, 1, 0]
    # By the relation, (c_2/2)^2 = c_0 there: a double root in lambda^2.
    assert vanishing.at_confluence(((p * s**2 + r) ** 2 - r * s**2 * 4).expand(), law) == 2
    vanishing, law, (s, r, p, *_), (v, w, c, d, e, f), _ = pair()
    found = [
        vanishing.at_zero_of_pair(y.expand(), law)
        for y in (v, d * f, c - 1, r, r * d, w * e, p * s**2 - w**2)
    ]
    assert found == [1, 1, 2, 2, 3, 0, 2]
    vanishing, law, (s, r, p, *_), (v, w, *_), _ = pair()
    assert vanishing.at_confluence((v**2 + w**2 - p * s**2 - r).expand(), law) is None


def test_where_a_solution_is_infinite_the_next_one_serves():
    ring, table, (s, r, _, _, _, v, w, *_) = kernels_of("pair")
    infinite = (("r", s / (v - w)),)
    relation = v**2 * w**2 / s**2
    vanishing = Vanishing(ring, table, [infinite, (("r", relation),)])
    assert vanishing.at_confluence((r * s**2 - v**2 * w**2).expand(), table.dispersions[0]) is None
    assert vanishing.at_confluence((r - s).expand(), table.dispersions[0]) == 0
    assert Vanishing(ring, table, [infinite]).at_confluence(r.expand(), table.dispersions[0]) is None
