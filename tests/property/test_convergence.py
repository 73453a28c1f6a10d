"""Theories that tend to each other do so at the order that they should."""

import functools
import itertools
import math

import pytest

import symflex

# --------------------------------------------------------------- a chain of masses and springs, and its rod

# A steel rod of 1 m and 480 mm^2: E A = 9.6e7 N and rho A l = 3.768 kg; c = sqrt(E/rho) = 5048 m/s.
STIFFNESS, MASS, SOUND = 9.6e7, 3.768, 5047.545

ROD = """
symflex = 1
parameters = { E = "200 GPa", rho = "7850 kg/m^3", A = "480 mm^2", l = "1 m" }
elements.bar = { type = "rod", between = ["x_0", "x_end"], E = "E", A = "A", rho = "rho", l = "l" }
inputs.F = { force = "x_0" }
outputs = { near = "x_0", far = "x_end" }
"""


@functools.cache
def rod(output):
    return symflex.loads(ROD).transfer_function(output, "F").bind()


@functools.cache
def chain(n, output):
    """Return the rod cut into n springs, half of each one's mass at either end of it."""
    nodes = ["x_0", *(f"x_{i}" for i in range(1, n)), "x_end"]
    lines = ["symflex = 1", "[elements]"]
    for i, node in enumerate(nodes):
        share = 0.5 if i in {0, n} else 1.0
        lines.append(f'm_{i} = {{ type = "mass", at = "{node}", m = "{share * MASS / n!r} kg" }}')
    for i in range(n):
        ends = f'["{nodes[i]}", "{nodes[i + 1]}"]'
        lines.append(f'k_{i} = {{ type = "spring", between = {ends}, k = "{STIFFNESS * n!r} N/m" }}')
    lines += ["[inputs]", 'F = { force = "x_0" }', "[outputs]", 'near = "x_0"', 'far = "x_end"']
    return symflex.loads("\n".join(lines)).transfer_function(output, "F").bind()


def error(n, output, s):
    return abs(complex(chain(n, output)(s)) / complex(rod(output)(s)) - 1)


# Up to about the first mode of the free rod, s l/c = j pi; four elements do not resolve the second.
AT = {
    "on the imaginary axis": 1.1j * SOUND,
    "decaying": (-0.4 + 0.8j) * SOUND,
    "growing": (0.9 + 0.3j) * SOUND,
    "real": 0.7 * SOUND,
}


@pytest.mark.slow
def test_a_chain_of_masses_tends_to_the_rod_at_second_order():
    for (where, s), output in itertools.product(AT.items(), ("near", "far")):
        errors = [error(n, output, s) for n in (4, 8, 16, 32)]
        assert orders(errors) == pytest.approx([2, 2, 2], abs=0.1), (where, output)
    assert error(32, "far", AT["on the imaginary axis"]) < 1e-3


# ------------------------------------------------------------------------------------------ theories of beams

# A beam ten times as long as deep.
PARAMETERS = """
symflex = 1
inputs.F = { force = "tip" }
outputs = { y = "tip", theta = "tip.theta" }
[parameters]
E = "70 GPa"
I = "67500 mm^4"
rho = "2700 kg/m^3"
A = "900 mm^2"
l = "0.3 m"
G = "26 GPa"
kappa = 0.85
[elements]
"""
SLOW = 1500.0
"""About half of the first natural frequency [rad/s]; E I = 4725 N m^2, rho A = 2.43 kg/m."""
PLACES = (SLOW * 1j, 3 * SLOW * 1j, SLOW * (2 + 1j), SLOW * (-1 + 4j))


@functools.cache
def theory(name, output):
    shear = ', kappa = "kappa", G = "G"' if name == "timoshenko" else ""
    beam = (
        f'arm = {{ type = "beam", theory = "{name}", between = ["ground", "tip"],'
        f' E = "E", I = "I", rho = "rho", A = "A", l = "l"{shear} }}'
    )
    return symflex.loads(PARAMETERS + beam).transfer_function(output, "F")


def distance(first, second, s):
    return abs(complex(first(s)) / complex(second(s)) - 1)


def orders(errors):
    return [math.log2(a / b) for a, b in itertools.pairwise(errors)]


LIMITS = {
    # E I stays; rho I falls, and kappa G A grows together with it.
    ("timoshenko", "euler-bernoulli"): lambda g: {"E": 70e9 * g, "I": 6.75e-8 / g, "G": 26e9 * g},
    ("rayleigh", "euler-bernoulli"): lambda g: {"E": 70e9 * g, "I": 6.75e-8 / g},
    ("timoshenko", "rayleigh"): lambda g: {"G": 26e9 * g},
}
"""The values for which one theory tends to another, at first order in 1/g."""


@pytest.mark.parametrize(("full", "plain"), LIMITS, ids=" to ".join)
def test_theories_of_beams_tend_to_each_other_at_first_order(full, plain):
    for output in ("y", "theta"):
        limit = theory(plain, output).bind()
        closer = [theory(full, output).bind(**LIMITS[full, plain](g)) for g in (256, 512, 1024, 2048)]
        for s in PLACES:
            errors = [distance(each, limit, s) for each in closer]
            assert orders(errors) == pytest.approx([1, 1, 1], abs=0.02), (output, s)


# -------------------------------------------------------------------------------------- a stiffened string

STRING = """
symflex = 1
inputs.F = { force = "q" }
outputs.y = "q"
[parameters]
N = "180 N"
rho = "7850 kg/m^3"
A = "1.2 mm^2"
l = "0.65 m"
E = "200 GPa"
I = "1e-6 mm^4"
[elements]
"""


def held(kind, more):
    part = f'rho = "rho", A = "A", N = "N", l = "l/2"{more}'
    return symflex.loads(
        STRING
        + f'left = {{ type = "{kind}", between = ["ground", "q"], {part} }}\n'
        + f'right = {{ type = "{kind}", between = ["q", "ground"], {part} }}\n'
    ).transfer_function("y", "F")


def test_a_beam_in_tension_tends_to_the_string_as_the_square_root_of_its_stiffness():
    # Bending matters within sqrt(E I/N) of the ends, so the error is of first order in that length.
    beam = held("beam", ', E = "E", I = "I"')
    string = held("string", "").bind()
    errors = [distance(beam.bind(I=1e-18 / 4**k), string, 500j) for k in range(4)]
    assert orders(errors) == pytest.approx([1, 1, 1], abs=0.05)
