"""Propagators, normal forms, exponential coordinates and orders of vanishing, against mpmath."""

from itertools import islice, product

import mpmath as mp
import pytest

from symflex.algebra import Dispersion, Factored, Ring
from symflex.algebra.exponentials import Exponentials, lift
from symflex.algebra.normal_form import NormalForm
from symflex.algebra.propagators import propagate
from symflex.algebra.vanishing import Vanishing, primes, square_root
from symflex.errors import BudgetError
from symflex.transfer.lowest_terms import cancel

BASE = Ring(("s", "r", "p", "l", "x"))
S, R, P, L, X = (Factored.generator(BASE, name) for name in BASE.names)
ZERO = S * 0
KINDS = {
    "wave": (R * S**2 * -1 / P / 3, ZERO),
    "bending": (R * S**2 / (P + R), ZERO, ZERO, ZERO),
    "pair": (R * S**2 / P, ZERO, (P * S**2 * -1 - R) / (P + 2) / 5, ZERO),
    "general": (R * S**2, P, S, R),
}
POINT = {
    "s": mp.mpc("0.7", "1.9"),
    "r": mp.mpf("1.3"),
    "p": mp.mpf("0.6"),
    "l": mp.mpf("1.1"),
    "x": mp.mpf("0.4"),
}


def propagation(kind, lengths=(L, X, L - X)):
    return propagate(BASE, [(Dispersion("w", kind, KINDS[kind], ZERO), list(lengths))])


def embedded(found):
    """The table of a propagation over its ring of kernels."""
    ring, table = found.kernel_ring, found.table
    gens = ring.context.gens()[: len(BASE.names)]

    def over(v):
        factors = tuple((f.compose(*gens, ctx=ring.context), e) for f, e in v.factors)
        return Factored(ring, v.unit, factors)

    return table.embedded([(v, over(v)) for v in table.values])


def value(factored, values):
    total = mp.mpf(factored.unit.numerator) / factored.unit.denominator
    for polynomial, exponent in factored.factors:
        total *= polynomial_value(polynomial, factored.ring.names, values) ** exponent
    return total


def polynomial_value(polynomial, names, values):
    return mp.fsum(
        int(c) * mp.fprod(values[n] ** int(e) for n, e in zip(names, m, strict=True) if e)
        for m, c in polynomial.terms()
    )


def fundamental(kind, length):
    """h, h', ... from the exponential of the companion matrix."""
    c = [value(k, POINT) for k in KINDS[kind]]
    n = len(c)
    companion = mp.matrix(n, n)
    for i in range(n - 1):
        companion[i, i + 1] = 1
    for j in range(n):
        companion[n - 1, j] = -c[j]
    grown = mp.expm(companion * length, method="taylor")
    return [grown[i, n - 1] for i in range(n)]


def generator_values(found):
    values = dict(POINT)
    for law in found.table.dispersions:
        c = [value(k, POINT) for k in law.characteristic]
        if law.kind == "wave":
            waves = [mp.sqrt(-c[0])]
        elif law.kind == "bending":
            waves = [mp.root(c[0] / 4, 4)]
        elif law.kind == "pair":
            root = mp.sqrt(c[2] ** 2 / 4 - c[0])
            waves = [mp.sqrt(-c[2] / 2 + root), mp.sqrt(-c[2] / 2 - root)]
        else:
            waves = []
        values.update(zip(law.wavenumbers, waves, strict=True))
    for kernel in found.table.kernels:
        length = value(kernel.length, POINT)
        if kernel.function == "fundamental":
            values[kernel.generator] = fundamental("general", length)[kernel.order]
        elif kernel.function == "exp":
            values[kernel.generator] = mp.exp(-value(kernel.dispersion.shift, POINT) * length)
        else:
            values[kernel.generator] = getattr(mp, kernel.function)(values[kernel.wavenumber] * length)
    for p in found.propagators:
        values[p.generator] = polynomial_value(p.image, found.kernel_ring.names, values)
    return values


@pytest.fixture(autouse=True)
def _precision():
    with mp.workdps(40):
        yield


def test_fundamental_functions_are_those_of_the_companion_matrix():
    for kind in KINDS:
        found = propagation(kind)
        values = generator_values(found)
        for length in (L, X, L - X):
            expected = fundamental(kind, value(length, POINT))
            for h, wanted in zip(found.fundamental(0, length), expected, strict=True):
                assert mp.almosteq(value(h, values), wanted, 1e-30), (kind, str(length))
    # At length zero only the highest derivative is one.
    assert [str(h) for h in propagation("bending").fundamental(0, ZERO)] == ["0", "0", "0", "1"]


def test_normal_form_keeps_the_value():
    for kind, high in (("wave", 6), ("bending", 6), ("pair", 3)):
        found = propagation(kind, (L,))
        values = generator_values(found)
        normal = NormalForm(found.kernel_ring, embedded(found))
        gens = [found.kernel_ring.generator(g) for g in found.table.generators]
        polynomial = (gens[0] + 2 * gens[-1] ** 3 + 3 * gens[1] ** 5 - gens[-2] * gens[0] ** high) ** 2
        before = polynomial_value(polynomial, found.kernel_ring.names, values)
        assert mp.almosteq(value(normal.reduce(polynomial), values), before, 1e-28), kind


def test_what_the_relations_make_zero_is_zero():
    for kind in ["wave", "bending", "pair"]:
        found = propagation(kind, (L,))
        table = embedded(found)
        normal = NormalForm(found.kernel_ring, table)
        for kernel in found.table.kernels:
            if kernel.function not in ("cosh", "cos"):
                continue
            odd = {"cosh": "sinh", "cos": "sin"}[kernel.function]
            c = found.kernel_ring.generator(kernel.generator)
            s = found.kernel_ring.generator(kernel.generator.replace(kernel.function, odd))
            one = c * c - s * s if kernel.function == "cosh" else c * c + s * s
            assert normal.reduce(one - 1).is_zero, kind
            assert normal.reduce(one**3 - 1).is_zero, kind
        law = table.dispersions[0]
        waves = [Factored.generator(found.kernel_ring, w) for w in law.wavenumbers]
        c = law.characteristic
        if kind == "wave":
            relation = waves[0] ** 2 + c[0]
        elif kind == "bending":
            relation = waves[0] ** 4 * 4 - c[0]
        else:
            relation = waves[0] ** 4 + c[2] * waves[0] ** 2 + c[0]
        assert normal.reduce_factored(relation).is_zero, kind


def test_a_power_of_a_wavenumber_is_balanced_and_a_relation_between_two_may_be_left_unused():
    for kind, degree in [("wave", 2), ("bending", 4)]:
        for power in [-7, -1, 0, 3, 4, 10]:
            found = propagation(kind, (L,))
            wave = Factored.generator(found.kernel_ring, found.table.wavenumbers[0])
            balanced = NormalForm(found.kernel_ring, embedded(found)).balance(wave**power * 3)
            assert balanced.exponent_of(wave.expand()) == power % degree
            values = generator_values(found)
            assert mp.almosteq(value(balanced, values), value(wave**power * 3, values), 1e-30), kind
    found = propagation("pair", (L,))
    ring = found.kernel_ring
    w = ring.generator("lambda_1[0]")
    normal = NormalForm(ring, embedded(found))
    assert normal.reduce(w**6, pairs=False).expand() == w**6
    assert int(normal.reduce(w**6).numerator().expand().degrees()[ring.index["lambda_1[0]"]]) < 2


def test_a_pair_of_wavenumbers_of_too_many_terms_ends_in_a_budget(monkeypatch):
    monkeypatch.setattr("symflex.algebra.normal_form.PAIR_TERMS", 3)
    found = propagation("pair", (L,))
    ring = found.kernel_ring
    with pytest.raises(BudgetError) as caught:
        NormalForm(ring, embedded(found)).reduce(ring.generator("lambda_1[0]") ** 12)
    (problem,) = caught.value.diagnostics
    assert (problem.code, problem.hint) == (
        "SF502", "give some parameters numbers, or leave out damping, loads or lengths"
    )  # fmt: skip


def test_a_product_of_half_angles_is_found_as_a_common_factor():
    found = propagation("wave", (L,))
    change = Exponentials(found.kernel_ring, found.table)
    c, s = (found.kernel_ring.generator(k.generator) for k in found.table.kernels)
    _, common = cancel(change.transform(s).numerator(), change.transform(c - 1).numerator())
    ((half, power),) = common.factors
    assert power == 1
    assert change.parity(half) == (1,)


def test_the_order_at_a_zero_wavenumber_is_that_of_the_taylor_series():
    for function, order in [
        (lambda c, s, co, si: c * si - s * co, 3),
        (lambda c, s, co, si: c * si + s * co, 1),
        (lambda c, s, co, si: s * si, 2),
        (lambda c, s, co, si: c * co - 1, 4),
        (lambda c, s, co, si: c * co, 0),
        (lambda c, s, co, si: c**2 - s**2 + co**2 + si**2 - 2, None),
    ]:
        found = propagation("bending", (L,))
        kernels = [found.kernel_ring.generator(k.generator) for k in found.table.kernels]
        vanishing = Vanishing(found.kernel_ring, found.table, [()])
        assert vanishing.at_zero(function(*kernels), found.table.wavenumbers[0]) == order


def test_square_roots_modulo_primes_are_roots_or_do_not_exist():
    for prime, number in product(islice(primes(), 3), range(2, 40)):
        root = square_root(number, prime)
        squares = pow(number, (prime - 1) // 2, prime) == 1
        assert (root is not None) == squares
        if root is not None:
            assert root * root % prime == number


def test_what_holds_only_multiples_of_an_angle_is_rewritten_in_the_multiple():
    for kind in ["hyperbolic", "circular"]:
        for n in [2, 3, 4]:
            found = propagation("bending", (L,))
            ring = found.kernel_ring
            angle = next(a for a in Exponentials(ring, found.table).angles if a.kind == kind)
            c, s = ring.generator(angle.even.generator), ring.generator(angle.odd.generator)
            even, odd = ring.constant(1), ring.constant(0)
            sign = 1 if kind == "hyperbolic" else -1
            for _ in range(n):
                even, odd = even * c + sign * (odd * s), odd * c + even * s
            normal = NormalForm(ring, embedded(found))
            polynomial = normal.reduce(3 * even**2 - 2 * even * odd + 5 * odd + 7)
            ((plain, _),) = polynomial.factors
            lifted = lift(ring, plain, angle, n)
            assert lifted is not None, (kind, n)
            assert (lifted * polynomial.unit - normal.reduce(3 * c**2 - 2 * c * s + 5 * s + 7)).is_zero, kind
    found = propagation("wave", (L,))
    ring = found.kernel_ring
    (angle,) = Exponentials(ring, found.table).angles
    c, s = ring.generator(angle.even.generator), ring.generator(angle.odd.generator)
    assert lift(ring, c**2 + s, angle, 2) is None
    assert lift(ring, c**2 + c, angle, 3) is None
    assert lift(ring, s**2, angle, 1) is None


def test_a_shift_of_all_exponents_is_a_decay_of_every_solution():
    x = value(L - X, POINT)
    for kind, law in KINDS.items():
        found = propagate(BASE, [(Dispersion("w", kind, law, P / 2), [L, L - X])])
        values = generator_values(found)
        c = [value(k, POINT) for k in law]
        roots = [r - POINT["p"] / 2 for r in mp.polyroots([1, *reversed(c)], maxsteps=200, extraprec=200)]
        slopes = [mp.fprod(r - other for other in roots if other is not r) for r in roots]
        for k, h in enumerate(found.fundamental(0, L - X)):
            # The divided difference of lambda^k exp(lambda x) at all roots.
            wanted = mp.fsum(r**k * mp.exp(r * x) / slope for r, slope in zip(roots, slopes, strict=True))
            assert mp.almosteq(value(h, values), wanted, 1e-25), (kind, k)


def test_delays_are_products_of_powers_of_the_shortest():
    found = propagate(BASE, [(Dispersion("D", "exponential", (), S), [L + X * 2, L, X, L])])
    (both,), (one,), (other,) = (found.fundamental(0, time) for time in (L + X * 2, L, X))
    values = generator_values(found)
    assert mp.almosteq(value(both, values), mp.exp(-POINT["s"] * (POINT["l"] + 2 * POINT["x"])), 1e-30)
    assert mp.almosteq(value(one, values) * value(other, values) ** 2, value(both, values), 1e-30)
    assert [(k.function, str(k.length)) for k in found.table.kernels] == [("exp", "l"), ("exp", "x")]


def test_lengths_that_are_no_small_multiples_or_without_names_keep_kernels_of_their_own():
    kept = {n: [str(k.length) for k in propagation("wave", (L, L * n)).table.kernels] for n in (12, 13)}
    assert kept == {12: ["l", "l"], 13: ["l", "l", "13*l", "13*l"]}
    table = propagation("general", (L, L * 2)).table
    assert [(str(k.length), k.order) for k in table.kernels] == [
        (x, n) for x in ("l", "2*l") for n in range(4)
    ]


def test_a_second_dispersion_has_generators_of_its_own():
    found = propagate(BASE, [(Dispersion(n, "wave", KINDS["wave"], ZERO), [L]) for n in ("a", "b")])
    assert found.table.generators == (
        "gamma[0]", "gamma[1]", "cosh[gamma[0],0]", "sinh[gamma[0],0]", "cosh[gamma[1],0]", "sinh[gamma[1],0]"
    )  # fmt: skip
    assert found.fundamental(1, L)[1].depends_on("H1[1,0]")


def test_a_value_without_kernels_is_the_same_over_the_ring_with_them():
    found = propagation("wave", (L,))
    moved = found.embed((S + R) ** 2 / (L * 3))
    assert moved.ring == found.ring
    assert value(moved, POINT) == value((S + R) ** 2 / (L * 3), POINT)
    assert found.embed(moved) is moved


# ------------------------------------------------------------------------------------------- tables


def two_laws():
    """A delay, and waves at two lengths."""
    return propagate(
        BASE,
        [(Dispersion("D", "exponential", (), S), [L]), (Dispersion("w", "wave", KINDS["wave"], R), [L, X])],
    ).table


def test_a_restricted_table_has_whole_dispersions_of_which_something_is_named():
    for names, laws, kernels in [
        ((), "", 0),
        (("s", "l"), "", 0),
        (("exp[0,0]",), "D", 1),
        (("gamma[1]",), "w", 6),
        (("sinh[gamma[1],1]",), "w", 6),
        (("exp[1,0]", "exp[0,0]"), "Dw", 7),
    ]:
        table = two_laws().restricted(names)
        assert ("".join(d.name for d in table.dispersions), len(table.kernels)) == (laws, kernels)
        assert {k.dispersion.name for k in table.kernels} == set(laws)
        assert bool(table) == bool(laws)
    table = two_laws()
    delay, _ = table.dispersions
    assert [k.generator for k in table.kernels_of(delay)] == ["exp[0,0]"]


# ------------------------------------------------------------------------- exponentials and half angles


def in_coordinates(change, values, length=1):
    """Values of E, t and u beside those that are kept; kernels' lengths are multiplied by ``length``."""
    found = dict(values)
    for angle in change.angles:
        x = values[angle.even.wavenumber] * value(angle.even.length, POINT) * length
        if angle.kind == "hyperbolic":
            found[angle.coordinates[0]] = mp.exp(x)
        else:
            found.update(zip(angle.coordinates, (mp.sin(x / 2), mp.cos(x / 2)), strict=True))
    return found


def mixed(kind):
    """A polynomial in which kernels of two lengths occur to different degrees, and its change."""
    found = propagation(kind, (L, X))
    change = Exponentials(found.kernel_ring, found.table)
    s, *kernels = (found.kernel_ring.generator(n) for n in ("s", *(k.generator for k in found.table.kernels)))
    polynomial = s * 3 - 5 * kernels[0] ** 3 * kernels[-1] + s**2 * kernels[1] - 7 * kernels[-2] ** 2
    return found, change, polynomial


def test_in_exponentials_and_half_angles_a_polynomial_keeps_its_value_or_stays_as_it_is():
    for kind in ["wave", "bending", "pair"]:
        found, change, polynomial = mixed(kind)
        values = generator_values(found)
        before = polynomial_value(polynomial, found.kernel_ring.names, values)
        assert mp.almosteq(
            value(change.transform(polynomial), in_coordinates(change, values)), before, 1e-30
        ), kind
    found, change, _ = mixed("bending")
    assert str(change.transform(found.kernel_ring.generator("s") * 3 - 1)) == "(3*s - 1)"


def test_restored_kernels_times_what_was_divided_out_have_the_value():
    for kind in ["wave", "bending", "pair"]:
        found, change, polynomial = mixed(kind)
        values = generator_values(found)
        places = in_coordinates(change, values)
        names = change.coordinates.names
        for factor, _ in change.transform(polynomial).factors:
            if any(change.parity(factor)):
                continue
            restored, powers = change.restore(factor)
            waves = [places[a.coordinates[0]] for a in change.angles if a.kind == "hyperbolic"]
            out = mp.fprod(e**n for e, n in zip(waves, powers, strict=True))
            wanted = polynomial_value(factor, names, places)
            assert mp.almosteq(value(restored, values) * out, wanted, 1e-28), kind


def test_what_is_restored_in_half_the_length_has_the_value():
    for kind in ["wave", "bending", "pair"]:
        found, change, _ = mixed(kind)
        gens = [change.coordinates.generator(c) for a in change.angles for c in a.coordinates]
        s = change.coordinates.generator("s")
        polynomial = gens[0] ** 3 * s + 2 * gens[0] * gens[-1] ** 2 - 5 * gens[0] ** 4 * gens[-1] * gens[1]
        whole = generator_values(found)
        halves = dict(whole)
        for kernel in found.table.kernels:
            x = whole[kernel.wavenumber] * value(kernel.length, POINT) / 2
            halves[kernel.generator] = getattr(mp, kernel.function)(x)
        restored, powers = change.restore_halved(polynomial)
        places = in_coordinates(change, whole)
        waves = [places[a.coordinates[0]] for a in change.angles if a.kind == "hyperbolic"]
        out = mp.fprod(mp.sqrt(e) ** n for e, n in zip(waves, powers, strict=True))
        found_value = polynomial_value(restored, found.kernel_ring.names, halves) * out
        assert mp.almosteq(
            found_value, polynomial_value(polynomial, change.coordinates.names, places), 1e-28
        ), kind


def test_what_is_free_of_kernels_is_split_off():
    found = propagate(BASE, [(Dispersion("w", "wave", KINDS["wave"], R), [L])])
    change = Exponentials(found.kernel_ring, found.table)
    s, length, gamma, decay, e = (
        change.coordinates.generator(n) for n in ("s", "l", "gamma[0]", "exp[0,0]", "E[gamma[0],0]")
    )
    free, rest = (s + gamma) * length, (e**2 + 1) * decay + s
    assert change.split(free * rest) == (free, rest)


def test_parity_is_that_of_the_degree_in_each_angle():
    _, change, _ = mixed("bending")
    e, t, u, f, v, _ = (change.coordinates.generator(c) for a in change.angles for c in a.coordinates)
    assert change.parity(e**3 * t * u + e * u**2) == (1, 0, 0, 0)
    assert change.parity(change.coordinates.generator("s") * e**2 + e**3 + 1) == (1, 0, 0, 0)
    assert change.parity(e**2 * t + e * u) == (0, 1, 0, 0)
    assert change.parity(e**2 * f * v**3 + f) == (0, 0, 1, 1)


def test_only_the_lengths_of_the_kernels_named_are_halved():
    _, change, _ = mixed("wave")
    first, second = (a.even for a in change.angles)
    table = change.halved([second])
    assert [str(k.length) for k in table.kernels] == ["l", "l", "1/2*x", "1/2*x"]
    assert table.dispersions == change.table.dispersions
    assert change.halved([first]).kernels[2].length is second.length
