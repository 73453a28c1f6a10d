"""Elements of one law that meet are one element: the same function, of a far smaller determinant."""

from __future__ import annotations

import pytest

from symflex import pipeline, transfer
from symflex.algebra import Factored, Ring
from symflex.equations import assemble
from symflex.equations.distributed import _links

BEAM = 'type = "beam", E = 7e10, I = 1.2e-9, rho = 2700, A = 1.5e-4, k_f = 1e4, c_f = 3'
KINDS = {
    "beam": BEAM,
    "beam under tension": BEAM + ", N = 50",
    "rod": 'type = "rod", E = 7e10, rho = 2700, A = 1.5e-4, eta = 1e-5',
}
POINTS = (3 + 40j, -2 + 900j, 150j)


def chain(kind, *lengths, more="", turned=()):
    """Elements from node n_0 on, driven at n_1, seen at the last but one node; n_0 is held by a spring."""
    rows = ['hold = { type = "spring", between = ["n_0", "ground"], k = 2000 }']
    for i, length in enumerate(lengths):
        ends = (f"n_{i}", f"n_{i + 1}")
        a, b = ends[::-1] if i in turned else ends
        rows.append(f'e_{i} = {{ {KINDS[kind]}, between = ["{a}", "{b}"], l = {length} }}')
    return pipeline.loads(
        "symflex = 1\n[elements]\n" + "\n".join(rows) + f"\n{more}\n[inputs]\n"
        f'F = {{ force = "n_1" }}\n[outputs]\nY = "n_{len(lengths) - 1}"\nS = "e_1.f"\n'
    )


def values(equations, pairs):
    found = [transfer.bind(tf) for tf in transfer.derive_all(equations, pairs)]
    return [bound(s) for bound in found for s in POINTS]


@pytest.mark.parametrize("kind", [pytest.param("beam under tension", marks=pytest.mark.slow), "beam", "rod"])
def test_a_chain_taken_as_one_element_has_the_response_of_its_parts(kind):
    model = chain(kind, 0.3, 0.5)
    apart, joined = (assemble(model, is_joined=is_joined) for is_joined in (False, True))
    assert (apart.is_joined, joined.is_joined) == (False, True)
    pairs = model.transfer_functions
    assert values(joined, pairs) == pytest.approx(values(apart, pairs), rel=1e-9)


def test_elements_with_an_input_between_have_the_response_of_their_parts():
    model = chain("rod", 0.2, 0.3, 0.1, 0.15)
    pairs = model.transfer_functions
    apart, joined = (assemble(model, is_joined=is_joined) for is_joined in (False, True))
    assert values(joined, pairs) == pytest.approx(values(apart, pairs), rel=1e-9)


def test_elements_are_not_one_where_anything_parts_them():
    for model in [
        chain("beam", 0.3, 0.5, more='m = { type = "mass", at = "n_1", m = 1 }'),
        chain("beam", 0.3, 0.5, turned=(1,)),
        chain("rod", 0.3, 0.5, turned=(0,)),
        pipeline.loads(
            "symflex = 1\n[elements]\n"
            f'a = {{ {KINDS["rod"]}, between = ["x", "ground"], l = 1 }}\n'
            f'b = {{ {KINDS["rod"]}, between = ["ground", "y"], l = 1 }}\n'
            '[inputs]\nF = { force = "x" }\n[outputs]\nX = "x"\n'
        ),
        pipeline.loads(
            "symflex = 1\n[elements]\n"
            f'a = {{ {BEAM}, between = ["ground", "x"], l = 1 }}\n'
            f'b = {{ {BEAM}, N = 10, between = ["x", "y"], l = 1 }}\n'
            '[inputs]\nF = { force = "x" }\n[outputs]\nY = "y"\n'
        ),
    ]:
        assert not assemble(model, is_joined=True).is_joined, model


def test_elements_are_one_only_where_that_is_asked_for():
    assert not assemble(chain("rod", 0.3, 0.5)).is_joined


THICK = """
symflex = 1
parameters = { E = "70 GPa", G = "26 GPa", kappa = 0.85, I = "1.2e-9 m^4", rho = "2700 kg/m^3",
               A = "1.5e-4 m^2", k_f = "1e4 N/m^2", a = "0.2 m", b = "0.3 m", c = "0.5 m" }
inputs.F = { force = "n_1" }
outputs.Y = "n_2"
elements.hold = { type = "pin", at = "n_0" }
""".replace("\n               ", " ")
PART = """
[elements.e_{i}]
type = "beam"
theory = "timoshenko"
between = ["n_{i}", "n_{j}"]
E = "E"
G = "G"
kappa = "kappa"
I = "I"
rho = "rho"
A = "A"
k_f = "k_f"
l = "{l}"
"""


@pytest.mark.slow
def test_three_thick_beams_of_other_lengths_on_a_foundation_have_a_closed_form():
    model = pipeline.loads(THICK + "".join(PART.format(i=i, j=i + 1, l="abc"[i]) for i in range(3)))
    (tf,) = pipeline.derive_all(model)
    # By reciprocity it is the response at n_1 to a force at n_2.
    swapped = pipeline.loads(
        (THICK + "".join(PART.format(i=i, j=i + 1, l="abc"[i]) for i in range(3)))
        .replace('force = "n_1"', 'force = "n_2"')
        .replace('outputs.Y = "n_2"', 'outputs.Y = "n_1"')
    )
    (other,) = pipeline.derive_all(swapped)
    one, two = transfer.bind(tf), transfer.bind(other)
    assert [one(s) for s in POINTS] == pytest.approx([two(s) for s in POINTS], rel=1e-12)


def test_every_element_after_the_first_follows_from_the_start_of_the_chain():
    ring = Ring(("s", "a", "b", "c"))
    a, b, c = (Factored.generator(ring, n) for n in "abc")
    found = _links(["A", "B", "C"], [a, b, c], [False, True, True])
    read = [(k.name, k.first, str(k.length), [(x, y, str(d)) for x, y, d in k.entries]) for k in found]
    assert read == [
        ("C", "A", "(a + b + c)", [("A", "B", "(b + c)"), ("B", "C", "c")]),
        ("B", "A", "(a + b)", [("A", "B", "b")]),
    ]
