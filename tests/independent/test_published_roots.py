"""Poles and zeros against values that others published, each string of digits checked by mpmath as well."""

import functools
import itertools

import pytest
from mpmath import cos, cosh, findroot, mp, mpf, pi, sin, sqrt, tanh

import symflex
from tests.independent.published_roots import (
    CANTILEVER_WITH_ITS_OWN_MASS,
    COS_COSH_MINUS_ONE,
    COS_COSH_ONE,
    DEEP_BEAM_EXTENSION,
    DEEP_BEAM_FLEXURE,
    EXPANSIONS,
    LOADED_STRING,
    TAN_MINUS,
    TAN_TANH,
    WAVENUMBERS,
)

DIGITS = 100
WORKING = 130

EQUATIONS = {
    COS_COSH_ONE: lambda x: cos(x) - 1 / cosh(x),
    COS_COSH_MINUS_ONE: lambda x: cos(x) + 1 / cosh(x),
    TAN_TANH: lambda x: sin(x) - cos(x) * tanh(x),
    TAN_MINUS: lambda x: sin(x) + x * cos(x),
}

# What each end is held by, driven by u where it is the first, and what moves there in turn.
ENDS = {
    "clamped": ("w({x}) = {u}", "w'({x}) = 0", "E*I*w'''(0)"),
    "pinned": ("w({x}) = {u}", "E*I*w''({x}) = 0", "E*I*w'''(0)"),
    "sliding": ("w'({x}) = 0", "E*I*w'''({x}) = {u}", "w(0)"),
    "free": ("E*I*w''({x}) = 0", "E*I*w'''({x}) = {u}", "w(0)"),
}
# With the driven quantity's partner held at zero in its place, the first end is of the other kind.
PARTNER = {"clamped": "sliding", "sliding": "clamped", "pinned": "free", "free": "pinned"}

# E I = rho A = l = 1: omega = x^2.
BAR = 'type = "beam", E = "E", I = "I", rho = "rho", A = "A", l = "l"'
UNITY = 'E = "1 Pa"\nI = "1 m^4"\nrho = "1 kg/m^3"\nA = "1 m^2"\nl = "1 m"\n'


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(WORKING):
        yield


def beam_between(first, second):
    """Return a specification of a beam as a field, driven and observed at its first end."""
    conditions = [c.format(x="0", u="u") for c in ENDS[first][:2]]
    conditions += [c.format(x="l", u="0") for c in ENDS[second][:2]]
    listed = ", ".join(f'"{c}"' for c in conditions)
    return (
        f"symflex = 1\n[parameters]\n{UNITY}\n[fields.w]\ndomain = ['0', 'l']\n"
        f"equation = \"E*I*w'''' + rho*A*s^2*w = 0\"\nconditions = [{listed}]\n"
        f'[inputs]\nu = {{}}\n[outputs]\nout = "{ENDS[first][2]}"\n'
    )


@functools.cache
def bound(text, tf="out/u"):
    return symflex.loads(text).transfer_function(*tf.split("/")).bind()


def frequencies(roots):
    """Return the positive omega of roots that are on the imaginary axis."""
    assert all(root.on_imaginary_axis for root in roots)
    return [root.im for root in roots if root.im > 0]


def spec(elements, output, source, parameters=UNITY):
    return (
        f"symflex = 1\n[parameters]\n{parameters}\n[elements]\n{elements}\n"
        f"[inputs]\nF = {source}\n[outputs]\nout = {output}\n"
    )


def natural(text, modes, digits=30):
    return frequencies(bound(text, "out/F").poles(modes=modes, digits=digits))


# ------------------------------------------------------------------------------------------- the sequences


@pytest.mark.slow
def test_the_published_digits_solve_their_equation_and_are_the_root_of_their_number():
    for expansion in EXPANSIONS:
        equation, last = EQUATIONS[expansion.equation], mpf(expansion.digits)
        places = len(expansion.digits.partition(".")[2])
        assert places >= DIGITS - 1, expansion
        assert abs(findroot(equation, mpf(expansion.digits[:15])) - last) < mpf(10) ** -(places - 1), (
            expansion
        )
        grid = [last * k / 1000 for k in range(50, 1000)]  # none of these equations has a root near zero
        signs = [equation(x) > 0 for x in grid]
        assert sum(a != b for a, b in itertools.pairwise(signs)) == expansion.index - 1, expansion


BEAMS = (
    ("poles", ("clamped", "clamped"), COS_COSH_ONE),
    ("poles", ("free", "clamped"), COS_COSH_MINUS_ONE),
    ("poles", ("pinned", "free"), TAN_TANH),
    ("zeros", ("sliding", "clamped"), COS_COSH_ONE),
    ("zeros", ("pinned", "pinned"), TAN_TANH),
)


def test_a_hundred_digits_of_a_beam_are_the_published_ones():
    for what, ends, equation in BEAMS:
        expected = [mpf(e.digits) for e in EXPANSIONS if e.equation == equation]
        found = frequencies(getattr(bound(beam_between(*ends)), what)(modes=3, digits=DIGITS))
        assert len(found) == len(expected) == 3
        for omega, x in zip(found, expected, strict=True):
            assert abs(omega - x**2) <= mpf(10) ** -(DIGITS - 1) * x**2, (what, ends)


def test_a_string_on_a_spring_has_the_published_root_of_tan_x_equals_minus_x():
    # N w'(l) = -k w(l) with k = N/l.
    text = spec(
        'line = { type = "string", between = ["ground", "x"], N = "1 N", rho = "rho", A = "A", l = "l" }\n'
        'support = { type = "spring", between = ["x", "ground"], k = "1 N/m" }\n',
        '"x"',
        '{ force = "x" }',
        'rho = "1 kg/m^3"\nA = "1 m^2"\nl = "1 m"\n',
    )
    (expected,) = (mpf(e.digits) for e in EXPANSIONS if e.equation == TAN_MINUS)
    (omega,) = natural(text, 1, DIGITS)
    assert abs(omega - expected) <= mpf(10) ** -(DIGITS - 1) * expected


# ------------------------------------------------------------------------------------------------- tables


def printed(entry):
    """Return a wavenumber as the table prints it, and one unit of its last digit."""
    number, _, factor = entry.partition(" ")
    if factor:
        return mpf(number) * pi / 2, mpf(10) ** -40
    return mpf(entry), mpf(10) ** -len(entry.partition(".")[2])


def differing(roots, entries):
    found = frequencies(roots)
    assert len(found) == len(entries)
    pairs = [(sqrt(omega), *printed(entry)) for omega, entry in zip(found, entries, strict=True)]
    return [x for x, wanted, unit in pairs if abs(x - wanted) > unit]


@pytest.mark.slow
def test_wavenumbers_of_a_beam_are_those_of_the_textbook():
    wrong = {
        ends: differing(bound(beam_between(*ends)).poles(modes=5, digits=50), entries)
        for ends, entries in WAVENUMBERS.items()
    }
    assert not any(wrong.values()), wrong


@pytest.mark.slow
def test_zeros_at_the_driven_end_are_wavenumbers_of_the_beam_with_that_end_held_the_other_way():
    held = {
        ends: (first, second)
        for first, second in WAVENUMBERS
        for ends in ((PARTNER[first], second), (PARTNER[second], first))
    }
    wrong = {
        ends: differing(bound(beam_between(*ends)).zeros(modes=5, digits=50), WAVENUMBERS[other])
        for ends, other in held.items()
    }
    assert not any(wrong.values()), wrong


def test_a_cantilever_with_a_mass_like_its_own_has_the_published_frequencies():
    text = spec(
        f'bar = {{ {BAR}, between = ["ground", "x"] }}\ntip = {{ type = "mass", at = "x", m = "1 kg" }}\n',
        '"x"',
        '{ force = "x" }',
    )
    for omega, entry in zip(natural(text, 5), CANTILEVER_WITH_ITS_OWN_MASS, strict=True):
        x, unit = printed(entry)
        assert abs(omega - x) <= unit


DEEP = (
    'E = "200 GPa"\nnu = "0.3"\nG = "76923076923.0769230769230769 Pa"\nrho = "8000 kg/m^3"\n'
    'A = "4 m^2"\nI = "1.33333333333333333333333333 m^4"\nl = "10 m"\n'
)


def test_a_deep_beam_bends_at_the_frequencies_of_the_benchmark():
    text = spec(
        'bar = { type = "beam", theory = "timoshenko", between = ["p", "q"], E = "E", I = "I", rho = "rho", '
        'A = "A", l = "l", G = "G", kappa = "0.85" }\n'
        'near = { type = "pin", at = "p" }\nfar = { type = "pin", at = "q" }\n',
        '"p.theta"',
        '{ torque = "p.theta" }',
        DEEP,
    )
    for omega, entry in zip(natural(text, 3), DEEP_BEAM_FLEXURE, strict=True):
        assert abs(omega / (2 * pi) / mpf(entry) - 1) < mpf("1.2e-4")


def test_a_rod_with_one_end_held_stretches_at_the_frequency_of_the_benchmark():
    text = spec(
        'bar = { type = "rod", between = ["ground", "x"], E = "E", rho = "rho", A = "A", l = "l" }\n',
        '"x"',
        '{ force = "x" }',
        DEEP,
    )
    for k, omega in enumerate(natural(text, 4)):
        assert abs(omega / (2 * pi) - (2 * k + 1) * mpf(DEEP_BEAM_EXTENSION)) < mpf(10) ** -25


# -------------------------------------------------------------------------------------- the loaded string


def finite_elements(count):
    """Return the discretised string as a chain.

    A linear element's matrices N/h [[1, -1], [-1, 1]] and rho A h/6 [[2, 1], [1, 2]] are those of half its
    mass at either end and, between them, of a spring N/h - rho A h s^2/6.
    """
    entries = []
    for k in range(1, count + 1):
        before = f"x_{k - 1}" if k > 1 else "ground"
        entries.append(
            f'span_{k} = {{ type = "spring", between = ["{before}", "x_{k}"], k = "N/h - r*h*s^2/6" }}'
        )
        entries.append(
            f'node_{k} = {{ type = "mass", at = "x_{k}", m = "{"r*h" if k < count else "r*h/2"}" }}'
        )
    entries.append(f'hanger = {{ type = "spring", between = ["x_{count}", "load"], k = "1 N/m" }}')
    entries.append('load = { type = "mass", at = "load", m = "1 kg" }')
    return spec(
        "\n".join(entries), '"load"', '{ force = "load" }', f'N = "1 N"\nr = "1 kg/m"\nh = "{1 / count} m"\n'
    )


@pytest.mark.slow
def test_the_discretised_loaded_string_has_the_published_eigenvalues():
    count = min(LOADED_STRING)
    found = [omega**2 for omega in natural(finite_elements(count), 6, 20)]
    assert found[0] < 1  # below K/M, where the table begins
    for value, entry in zip(found[1:], LOADED_STRING[count], strict=True):
        x, unit = printed(entry)
        assert abs(value - x) <= unit


LOADED = spec(
    'line = { type = "string", between = ["ground", "x"], N = "1 N", rho = "rho", A = "A", l = "l" }\n'
    'hanger = { type = "spring", between = ["x", "load"], k = "1 N/m" }\n'
    'load = { type = "mass", at = "load", m = "1 kg" }\n',
    '"load"',
    '{ force = "load" }',
)


def test_the_loaded_string_itself_is_the_limit_of_the_published_eigenvalues():
    # The elements' error is c h^2 + O(h^4): (16 of h/4 - of h)/15 leaves the fourth order.
    found = [omega**2 for omega in natural(LOADED, 6)]
    for value, *entries in zip(found[1:], *LOADED_STRING.values(), strict=True):
        coarse, fine = map(mpf, entries)
        limit = (16 * fine - coarse) / 15
        assert abs(value - limit) < mpf("2e-9") * limit + value**3 * mpf(10) ** -11


def test_the_loaded_string_solves_its_rational_equation():
    # -u'(1) = lambda/(lambda - 1) u(1), u = sin(sqrt(lambda) x) (Solov'ev 2006).
    for omega in natural(LOADED, 6, 50):
        value = omega * cos(omega) * (omega**2 - 1) + omega**2 * sin(omega)
        assert abs(value) < mpf(10) ** -46 * omega**3


# ------------------------------------------------------------------------------------------ closed forms


def test_a_beam_on_a_hub_solves_the_equation_of_a_pinned_free_beam_with_inertia():
    # w = w'' + J omega^2 w' = 0 at x = 0 and w'' = w''' = 0 at x = 1 with E I = rho A = 1, by hand:
    # sin x cosh x - cos x sinh x + J x^3 (1 + cos x cosh x) = 0; J = 0 pinned-free, J = oo clamped-free.
    for inertia in ("0.01", "1", "100"):
        text = spec(
            f'bar = {{ {BAR}, between = ["p", "q"] }}\n'
            'bearing = { type = "pin", at = "p" }\n'
            f'hub = {{ type = "inertia", at = "p.theta", J = "{inertia} kg*m^2" }}\n',
            '"p.theta"',
            '{ torque = "p.theta" }',
        )
        ratio = mpf(inertia)
        found = natural(text, 5, 50)
        assert len(found) == 5
        for omega in found:
            x = sqrt(omega)
            value = sin(x) - cos(x) * tanh(x) + ratio * x**3 * (1 / cosh(x) + cos(x))
            assert abs(value) < mpf(10) ** -46 * (1 + ratio * x**3), inertia
