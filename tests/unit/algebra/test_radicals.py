"""Square roots and the relations between them, against numbers."""

from fractions import Fraction

import mpmath
import pytest

from symflex.algebra import Factored, Radicals, Ring

NAMES = ("s", "k", "m", "p", "q", "r", "t", "u", "v")
RING = Ring(NAMES)
S, K, M, P, Q, R, T, U, V = (Factored.generator(RING, name) for name in NAMES)
# Of p, q, r, t, u and v.
RADICANDS = {3: K / M, 4: K * M, 5: K.number(RING, 2), 6: K.number(RING, 18), 7: R + 2, 8: -R + 2}
VALUES = {"s": 1.5, "k": 3, "m": 7}


def radicals(radicands=None, positive=(1, 2)):
    return Radicals.of(RING, RADICANDS if radicands is None else radicands, positive)


def number(value, radicands=None):
    """Return a value at a point, roots as mpmath takes them."""
    known = {name: mpmath.mpf(x) for name, x in VALUES.items()}

    def at(factored):
        total = mpmath.mpf(factored.unit.numerator) / factored.unit.denominator
        for polynomial, exponent in factored.factors:
            terms = [
                mpmath.mpf(int(c))
                * mpmath.fprod(known[n] ** int(e) for n, e in zip(NAMES, m, strict=True) if e)
                for m, c in polynomial.to_dict().items()
            ]
            total *= mpmath.fsum(terms) ** exponent
        return total

    for i, radicand in (radicands or RADICANDS).items():
        known[NAMES[i]] = mpmath.sqrt(at(radicand))
    return at(value)


def test_normal_forms_keep_values_and_use_relations_up():
    found = radicals()
    for value in (P**3 / Q, P * Q + R, (R + T * S) ** 2, (U * V - R) + S, (P + S) * (Q + T) / (U + V), U**-3):
        with mpmath.workdps(30):
            assert mpmath.almosteq(number(found.reduced(value)), number(value), 1e-25), str(value)
    assert not found.free
    for zero in (P * Q - K, T - R * 3, U * V - R, U**2 - R - 2, R * (P * M - Q)):
        assert found.reduced(zero).is_zero, str(zero)


def test_a_root_is_written_as_it_was_unless_its_normal_form_is_shorter():
    found = radicals()
    assert str(found.tidy(S + T)) == str(S + T)
    assert str(found.tidy(S + T - R)) == str(S + R * 2)


def test_common_factors_are_those_of_the_numbers():
    found = radicals()
    for above, below, common in [
        (S * Q + K, M * S**2 + Q * S * 2 + K, 1),
        (S**4 + K**4, S**2 + R * K * S + K**2, 2),
        (S + P, S**2 * M - K, 1),
        (S**2 + V * S * U + 1, S**2 + R * S + 1, 2),
        (S + P, S + Q, 0),
        (S**2 + R, S**2 + P, 0),
    ]:
        quotient, shared = found.in_lowest_terms(above / below)
        with mpmath.workdps(30):
            assert mpmath.almosteq(number(quotient), number(above / below), 1e-25)
        assert sum(int(f.degrees()[0]) * e for f, e in shared.factors) == common, str(above / below)


def test_what_a_point_proves_coprime_is_not_divided(monkeypatch):
    # Euclid's steps multiply by conjugates: five degrees and ten names took minutes.
    def divided(*_):
        raise AssertionError

    monkeypatch.setattr(Radicals, "_divided", divided)
    found = radicals()
    f = (M * S**3 + P * S * K + R).numerator().expand()
    assert found.gcd(f, f.derivative(0)) == 1
    with pytest.raises(AssertionError):  # p is the root of k/m: they share s + p
        found.gcd((S * M + P * M).numerator().expand(), (S**2 * M - K).numerator().expand())


def test_polynomials_are_split_by_multiplicity_and_symmetry():
    square = (M * S**2 + Q * S * 2 + K).expand()
    (parts,) = radicals().split([(square, 1)])
    assert (parts[1], int(parts[0].degrees()[0])) == (2, 1)
    # (s^2 + r)(s + r), whose roots on the imaginary axis are in a part of their own.
    found = radicals().reduced(Factored.polynomial(RING, ((S**2 + R) * (S + R)).expand()))
    ((polynomial, _),) = found.factors
    assert sorted(int(p.degrees()[0]) for p, _ in radicals().split([(polynomial, 1)])) == [1, 2]


def test_what_is_not_known_is_left_alone():
    # The sign of k is not known, so sqrt(k^2) may be k or -k.
    found = radicals({3: K**2}, ())
    assert found.free == {3}
    assert str(found.tidy(P)) == "p"
    assert str(found.tidy(P**2)) == "k^2"
    # sqrt(r + p) with sqrt(r) and sqrt(p) is in no field that is known here, but independent.
    assert not radicals({3: K, 4: M, 5: P + Q}).free


def test_points_satisfy_all_relations():
    for seed in (0, 1):
        prime, values = radicals().point(seed)
        for i, radicand in RADICANDS.items():
            if i < 7:
                continue
            assert (values[NAMES[i]] ** 2 - 2 - (1 if i == 7 else -1) * values["r"]) % prime == 0, radicand
        assert (values["p"] * values["q"] - values["k"]) % prime == 0
        assert (values["u"] * values["v"] - values["r"]) % prime == 0
        assert (values["t"] - 3 * values["r"]) % prime == 0


def test_a_denominator_that_is_zero_divides_by_zero():
    with pytest.raises(ZeroDivisionError):
        radicals().reduced(1 / (S * (P * Q - K)))
    assert radicals({}).reduced(S * Fraction(1, 2)).unit == Fraction(1, 2)
