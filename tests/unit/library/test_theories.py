"""Every theory of the registry, and the reduction of field equations to first order."""

import mpmath as mp
import pytest

from symflex.algebra import Factored, Ring
from symflex.library.fields import FIELDS, FieldEquation, components, first_order

NAMES = ("s", "E", "I", "rho", "A", "G", "J", "kappa", "eta", "c_f", "k_f", "N")
DIRECTION = ("cos", "sin", "cos_cos", "cos_sin")
RING = Ring((*NAMES, *DIRECTION))
SYMBOLS = {name: Factored.generator(RING, name) for name in RING.names}
S = SYMBOLS["s"]
ZERO = S * 0
NUMBERS = {
    "s": mp.mpc("0.8", "2.3"), "E": mp.mpf(7), "I": mp.mpf("0.3"), "rho": mp.mpf("1.7"), "A": mp.mpf("0.9"),
    "G": mp.mpf(3), "J": mp.mpf("0.5"), "kappa": mp.mpf("0.83"), "eta": mp.mpf("0.01"), "c_f": mp.mpf("0.2"),
    "k_f": mp.mpf("0.4"), "N": mp.mpf("1.1"),
}  # fmt: skip
with mp.workdps(40):  # a point of the unit circle to as many digits as are compared
    NUMBERS |= {
        "cos": mp.mpf("0.6"),
        "sin": mp.mpf("0.8"),
        "cos_cos": mp.mpf("0.36"),
        "cos_sin": mp.mpf("0.48"),
    }


def number(value):
    total = mp.mpf(value.unit.numerator) / value.unit.denominator
    for f, e in value.factors:
        total *= (
            mp.fsum(
                int(c) * mp.fprod(NUMBERS[n] ** int(k) for n, k in zip(RING.names, m, strict=True))
                for m, c in f.terms()
            )
            ** e
        )
    return total


def matrix(rows):
    return mp.matrix([[number(x) for x in row] for row in rows])


@pytest.fixture(autouse=True)
def _precision():
    with mp.workdps(40):
        yield


@pytest.mark.parametrize(
    "name", [name for name in FIELDS if name not in ("frame-rayleigh", "frame-timoshenko")]
)
def test_the_sum_over_fundamental_functions_is_the_matrix_exponential(name):
    system = FIELDS[name](S, SYMBOLS)
    length = mp.mpf("0.9")
    wanted = mp.expm(matrix(system.matrix) * length, method="taylor")
    found = mp.zeros(len(system.states))
    for part in components(system):
        c = [number(x) for x in part.coefficients]
        n = len(c)
        companion = mp.matrix(n, n)
        for i in range(n - 1):
            companion[i, i + 1] = 1
        for j in range(n):
            companion[n - 1, j] = -c[j]
        h = mp.expm(companion * length, method="taylor")
        for k, b in enumerate(part.adjugate):
            found += matrix(b) * h[k, n - 1]
    assert mp.mnorm(found - wanted) < 1e-30


def test_the_through_states_are_conjugate_to_the_across_states():
    """A conservative line conserves power: the matrix is Hamiltonian."""
    for name in list(FIELDS):
        system = FIELDS[name](S, SYMBOLS)
        a = matrix(system.matrix)
        half = len(system.states) // 2
        j = mp.zeros(2 * half)
        for i in range(half):
            j[i, half + i], j[half + i, i] = 1, -1
        assert mp.mnorm(a.T * j + j * a) < 1e-30, name


def test_theories_have_the_dispersion_relations_of_the_books():
    for name, kind in [
        ("rod", "wave"),
        ("shaft", "wave"),
        ("string", "wave"),
        ("rayleigh", "pair"),
        ("timoshenko", "pair"),
    ]:
        (part,) = components(FIELDS[name](S, SYMBOLS))
        assert part.characteristic.kind == kind, name


def test_a_member_of_a_frame_stretches_as_a_rod_and_bends_as_its_theory():
    for theory in ("euler-bernoulli", "rayleigh", "timoshenko"):
        kinds = {p.characteristic.key for p in components(FIELDS[f"frame-{theory}"](S, SYMBOLS))}
        alone = {p.characteristic.key for n in (theory, "rod") for p in components(FIELDS[n](S, SYMBOLS))}
        assert kinds == alone


def test_without_axial_force_a_slender_beam_has_four_equal_wavenumbers():
    (part,) = components(FIELDS["euler-bernoulli"](S, SYMBOLS | {"N": ZERO}))
    assert part.characteristic.kind == "bending"


def test_with_axial_force_it_has_two_pairs():
    (part,) = components(FIELDS["euler-bernoulli"](S, SYMBOLS))
    assert part.characteristic.kind == "pair"


def test_uncoupled_unknowns_are_solved_apart():
    rod, beam = SYMBOLS["rho"] * S**2 / SYMBOLS["E"], SYMBOLS["rho"] * S**2
    one = S**0
    system = first_order(
        ["u", "w"],
        [],
        [
            FieldEquation({("u", 2): one, ("u", 0): -rod}, {}),
            FieldEquation({("w", 4): one, ("w", 0): beam}, {}),
        ],
        ZERO,
    )
    assert system is not None
    assert [p.characteristic.kind for p in components(system)] == ["wave", "bending"]
    assert system.states == ("u", "u'", "w", "w'", "w''", "w'''")


def test_equations_that_leave_a_highest_derivative_open_are_refused():
    one = S**0
    equations = [
        FieldEquation({("u", 2): one, ("w", 2): one}, {}),
        FieldEquation({("u", 2): one, ("w", 2): one, ("w", 0): S}, {}),
    ]
    assert first_order(["u", "w"], [], equations, ZERO) is None


def test_a_drift_is_an_exponential_times_an_even_part():
    k, v = SYMBOLS["E"], SYMBOLS["N"]
    system = first_order(["c"], [], [FieldEquation({("c", 2): k, ("c", 1): -v, ("c", 0): -S}, {})], ZERO)
    assert system is not None
    (part,) = components(system)
    assert part.characteristic.kind == "wave"
    assert str(part.characteristic.shift) == "-1/2*N*E^-1"


def test_loads_are_columns():
    one = S**0
    system = first_order(
        ["w"], ["F"], [FieldEquation({("w", 2): SYMBOLS["N"], ("w", 0): -S}, {"F": -one})], ZERO
    )
    assert system is not None
    assert [[str(x) for x in column] for column in system.loads] == [["0", "N^-1"]]
