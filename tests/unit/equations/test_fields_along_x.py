"""Fields of every kind of dispersion, loaded all along and at an end, against matrix exponentials."""

import mpmath as mp
import pytest

from symflex import pipeline, transfer
from symflex.equations import assemble
from symflex.errors import ModelError

S = complex(0.7, 1.9)
START, LENGTH = 0.25, 1.5
# Written in several ways: the coefficients c_0, c_1, ... of the monic equation and what the loads p and q are
# multiplied by.
EQUATIONS = {
    "w' + s*w = p": ([S], 1, 0),
    "2*(w'' - s*(s*w/8 - 3*q)) = -p": ([-(S**2) / 8, 0], -0.5, -3 * S),
    "-w''/k = -(p - 4*w)*s": ([4 * S * 3, 0], 3 * S, 0),
    "w'' + 2*s*w' = -5*w + p": ([5, 2 * S], 1, 0),
    "2*w'''' + s^2*w = p/5 - q": ([S**2 / 2, 0, 0, 0], 0.1, -0.5),
    "w'''' + 2*s^2*w/k^2 = 3*s*w'' + p": ([2 * S**2 / 9, 0, -3 * S, 0], 1, 0),
    "w''' + k*w'' - s*w = p + q": ([-S, 0, 3], 1, 1),
    "w'' = (p + p)/k - q*s*0": ([0, 0], 2 / 3, 0),
    "w'''' = s*p": ([0, 0, 0, 0], S, 0),
}


def derivatives(order):
    """Return the orders of the derivatives that are read: of the state, of the equation and after it."""
    return sorted({0, 1, order - 1, order, order + 2})


def read(equation, order):
    """A field clamped as far as its order goes, with derivatives at three places."""
    primes = ["'" * k for k in range(order + 3)]
    ends = [f"w{primes[k]}(a) = {'F' if k == 0 else '0'}" for k in range((order + 1) // 2)]
    ends += [f"w{primes[k]}(a + l) = 0" for k in range(order // 2)]
    listed = ", ".join(f'"{c}"' for c in ends)
    outputs = "\n".join(
        f'{name}{k} = "w{primes[k]}({at})"'
        for name, at in (("first", "a"), ("middle", "a + l/3"), ("last", "a + l"))
        for k in derivatives(order)
    )
    return pipeline.loads(
        f"symflex = 1\n[parameters]\nk = 3\na = {START}\nl = {LENGTH}\n[fields.w]\n"
        f'domain = ["a", "a + l"]\nequation = "{equation}"\nconditions = [{listed}]\n'
        f"[inputs]\np = {{}}\nq = {{}}\nF = {{}}\n[outputs]\n{outputs}\n"
    )


def solved(c, p, q):
    """Return every derivative at the three places per input, from z' = A z + b with constant b."""
    n = len(c)
    half = (n + 1) // 2
    augmented = mp.matrix(n + 1, n + 1)
    for i in range(n - 1):
        augmented[i, i + 1] = 1
    for j in range(n):
        augmented[n - 1, j] = -mp.mpmathify(c[j])
    found = {}
    for source, load in (("p", p), ("q", q), ("F", 0)):
        augmented[n - 1, n] = mp.mpmathify(load)
        grown = {x: mp.expm(augmented * x, method="taylor") for x in (0, LENGTH / 3, LENGTH)}
        # z_0 and 1 for the load; conditions at both ends.
        rows, right = mp.matrix(n, n), mp.matrix(n, 1)
        for k in range(half):
            rows[k, k] = 1
            right[k] = int(source == "F" and k == 0)
        for k in range(n // 2):
            for j in range(n):
                rows[half + k, j] = grown[LENGTH][k, j]
            right[half + k] = -grown[LENGTH][k, n]
        z = [*mp.lu_solve(rows, right), 1]
        for name, x in (("first", 0), ("middle", LENGTH / 3), ("last", LENGTH)):
            state = [mp.fsum(grown[x][i, j] * z[j] for j in range(n + 1)) for i in range(n)]
            for _ in range(3):  # the equation and its derivatives
                forced = load if len(state) == n else 0
                state.append(forced - mp.fsum(a * b for a, b in zip(c, state[-n:], strict=True)))
            found |= {(f"{name}{k}", source): complex(state[k]) for k in derivatives(n)}
    return found


NAMELESS = "-w''/k = -(p - 4*w)*s"
LONG = "w'''' + 2*s^2*w/k^2 = 3*s*w'' + p"  # takes seconds: a quartic without symmetry


@pytest.mark.parametrize(
    ("equation", "is_nameless"),
    [
        *(pytest.param(e, False, marks=pytest.mark.slow if e == LONG else ()) for e in EQUATIONS),
        (NAMELESS, True),
    ],
)
def test_a_field_has_the_values_and_derivatives_that_its_equation_and_ends_give_it(equation, is_nameless):
    c, p, q = EQUATIONS[equation]
    model = read(equation, len(c))
    with mp.workdps(30):
        wanted = solved(c, p, q)
    equations = assemble(model, is_nameless=is_nameless)
    asked = {"f": "p", "m": "pqF", "l": "F"}  # what acts on the first place, the middle and the last
    pairs = [(n, s) for n, s in wanted if s in asked[n[0]] and (s != "q" or q)]
    found = {
        pair: transfer.bind(tf)(S) if tf.num != 0 else 0
        for pair, tf in zip(pairs, transfer.derive_all(equations, pairs), strict=True)
    }
    assert found == pytest.approx({pair: wanted[pair] for pair in pairs}, rel=1e-9, abs=1e-12)


# A line of resistance R and leakage G with a source of voltage e all along: v' = -R i + e, i' = -G v.
COUPLED = """symflex = 1
parameters = { R = 2, G = 0.5, l = 1.5 }
inputs = { e = {}, V = {} }
outputs = { i = "i(0)", v = "v(l/3)", slope = "v'(l)", bend = "i''(l)" }
[fields.line]
unknowns = ["v", "i"]
domain = ["0", "l"]
equations = ["v' + R*i = e", "i' = -G*v"]
conditions = ["v(0) = V", "i(l) = 0"]
"""


def test_two_coupled_unknowns_are_those_of_a_leaking_line():
    functions = {tf.name: transfer.bind(tf) for tf in pipeline.derive_all(pipeline.loads(COUPLED))}
    # R G = 1, so v = cosh(l - x)/cosh(l) and i = sinh(l - x)/(2 cosh(l)) of V; of e it is v'' = v with
    # v(0) = 0 and v'(l) = 1, so v = sinh(x)/cosh(l) and i = (1 - v')/2.
    for source, wanted in {
        "V": [mp.tanh(1.5) / 2, mp.cosh(1) / mp.cosh(1.5), 0, 0],
        "e": [(1 - 1 / mp.cosh(1.5)) / 2, mp.sinh(0.5) / mp.cosh(1.5), 1, -0.5],
    }.items():
        found = [functions[f"{output}/{source}"](1j).real for output in ("i", "v", "slope", "bend")]
        assert found == pytest.approx([float(x) for x in wanted], abs=1e-12), source


def test_a_uniform_load_where_a_constant_solves_the_equation_is_refused():
    with pytest.raises(ModelError) as caught:
        assemble(read("w''' = s^2*w' + p", 3))
    (problem,) = caught.value.diagnostics
    message = "field 'w' has a solution that is constant in x, so a uniform load on it is not available"
    assert (problem.code, problem.message, problem.span.text) == ("SF910", message, "w")
    assert problem.hint == "put the load into the conditions"


def test_a_line_without_stiffness_is_refused_at_its_place():
    zero = "(k + m)^2 - k^2 - 2*k*m - m^2"
    rod = f'{{ type = "rod", between = ["x", "ground"], E = "{zero}", A = 1, rho = 1, l = 1 }}'
    text = (
        f"symflex = 1\nparameters = {{ k = {{}}, m = {{}} }}\nelements.a = {rod}\n"
        'inputs.F = { force = "x" }\noutputs.X = "x"\n'
    )
    with pytest.raises(ModelError) as caught:
        assemble(pipeline.loads(text))
    (problem,) = caught.value.diagnostics
    assert (problem.code, problem.message) == ("SF224", "a stiffness of rod 'a' is zero")
    assert problem.span.text == "a"
