"""Laws that every distributed model obeys, whatever its numbers."""

import functools

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import symflex

# Of each kind what it must have, and what it may have.
KINDS = {
    "euler-bernoulli": ('type = "beam"', "E I rho A", "eta c_f k_f N"),
    "rayleigh": ('type = "beam", theory = "rayleigh"', "E I rho A", "eta N"),
    "timoshenko": ('type = "beam", theory = "timoshenko"', "E G kappa I rho A", "eta"),
    "rod": ('type = "rod"', "E rho A", "eta c_f k_f"),
    "string": ('type = "string"', "N rho A", "c_f k_f"),
}
UNITS = {
    "E": "Pa", "G": "Pa", "kappa": "", "I": "m^4", "rho": "kg/m^3", "A": "m^2", "N": "N", "eta": "s",
    "c_f": "N*s/m^2", "k_f": "N/m^2", "l": "m", "m": "kg", "k": "N/m",
}  # fmt: skip
POINTS = (0.4 + 1.3j, 2.1 - 0.6j, 0.02 + 3.1j)

# Between p and q: one part with all its options, the same turned round; a plain one, and cut in two.
ARRANGEMENTS = {
    "full": [("p", "q", "l")],
    "turned": [("q", "p", "l")],
    "plain": [("p", "q", "l")],
    "cut": [("p", "half", "l/2"), ("half", "q", "l/2")],
}


def names_of(kind):
    _, needed, possible = KINDS[kind]
    return [*needed.split(), *possible.split(), "l", "m", "k"]


def element(kind, arrangement):
    head, needed, possible = KINDS[kind]
    names = needed.split() + (possible.split() if arrangement in {"full", "turned"} else [])
    return ", ".join([head, *(f'{name} = "{name}"' for name in names)])


@functools.cache
def functions(kind, arrangement):
    """Return the transfer functions between p and q, with a spring at p and a mass at q."""
    parameters = "".join(f'{name} = "1 {UNITS[name]}"\n' for name in names_of(kind))
    parts = "".join(
        f'part_{i} = {{ {element(kind, arrangement)}, between = ["{a}", "{b}"], l = "{length}" }}\n'
        for i, (a, b, length) in enumerate(ARRANGEMENTS[arrangement])
    )
    model = symflex.loads(
        f"symflex = 1\n[parameters]\n{parameters}\n[elements]\n{parts}"
        'load = { type = "mass", at = "q", m = "m" }\n'
        'spring = { type = "spring", between = ["p", "ground"], k = "k" }\n'
        '[inputs]\nF_p = { force = "p" }\nF_q = { force = "q" }\n'
        '[outputs]\np = "p"\nq = "q"\n'
    )
    return {tf.name: tf for tf in model.transfer_functions()}


def value(kind, tf, values, s, arrangement="full"):
    bound = functions(kind, arrangement)[tf]
    used = {parameter.name for parameter in bound.exact.parameters}
    return complex(bound.bind(**{name: v for name, v in values.items() if name in used})(s))


def positive():
    return st.integers(min_value=-12, max_value=12).map(lambda k: 2.0 ** (k / 6))


def numbers(kind):
    """Return values within a factor of four of one; axial forces are tensions."""
    return st.fixed_dictionaries({name: positive() for name in names_of(kind)})


def quiet(examples):
    return settings(
        max_examples=examples,
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
    )


def close(found, expected):
    return abs(found - expected) <= 1e-11 * abs(expected)


@pytest.mark.parametrize("kind", tuple(KINDS))
@given(data=st.data())
@quiet(4)
@pytest.mark.slow
def test_a_passive_part_is_reciprocal_takes_power_in_and_is_real_in_time(kind, data):
    values = data.draw(numbers(kind))
    for s in POINTS:
        across = value(kind, "q/F_p", values, s)
        assert close(value(kind, "p/F_q", values, s), across)
        assert close(value(kind, "q/F_p", values, s.conjugate()), across.conjugate())
        for tf in ("p/F_p", "q/F_q"):
            assert (s * value(kind, tf, values, s)).real > 0, tf


@pytest.mark.slow
@pytest.mark.parametrize("kind", tuple(KINDS))
@given(data=st.data())
@quiet(3)
def test_a_cut_changes_nothing_nor_does_turning_a_part_round(kind, data):
    # Of a beam, x and so every angle turn round too; displacements and forces do not.
    values = data.draw(numbers(kind))
    for tf in ("p/F_p", "q/F_p"):
        for s in POINTS:
            assert close(value(kind, tf, values, s, "cut"), value(kind, tf, values, s, "plain")), tf
            assert close(value(kind, tf, values, s, "turned"), value(kind, tf, values, s)), tf
