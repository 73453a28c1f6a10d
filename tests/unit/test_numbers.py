"""Deriving with numbers in place of parameters gives the poles and zeros of the symbolic derivation."""

import math
from pathlib import Path

import pytest

from symflex import pipeline
from symflex.errors import ModelError

MODELS = ("eppinger1988/two_mass", "classics/quarter_car", "classics/rod_tip_mass")


def place(root):
    printed = root.decimal(20)
    return printed.re, printed.im, root.multiplicity


def roots(found):
    shown = [place(r) for group in (found.poles, found.zeros) for r in group]
    return shown + sorted(place(h.root) for h in found.hidden)


@pytest.mark.parametrize("name", MODELS)
def test_the_roots_are_those_of_the_symbolic_derivation(name):
    model = pipeline.load(Path(__file__).parents[2] / "derivations" / f"{name}.toml")
    symbolic = [pipeline.bind(tf) for tf in pipeline.derive_all(model)]
    numeric = pipeline.derive_bound(model, model.transfer_functions)
    for one, other in zip(symbolic, numeric, strict=True):
        assert roots(pipeline.roots(one, None, 25)) == roots(pipeline.roots(other, None, 25))


def test_a_parameter_without_value_is_missed_only_where_it_occurs():
    model = pipeline.loads("""symflex = 1
parameters = { m = "2 kg", c = {} }
inputs = { F = { force = "x" }, u = {} }
outputs = { X = "x", Y = "c*u" }
elements.body = { type = "mass", at = "x", m = "m" }
""")
    assert pipeline.derive_bound(model, [("X", "F")])[0](2.0) == pytest.approx(1 / 8)
    with pytest.raises(ModelError, match="SF229"):
        pipeline.derive_bound(model, [("Y", "u")])


def test_a_chain_of_sixty_equal_masses_has_the_textbook_frequencies():
    # Free-free chain: omega_k = 2 sqrt(k/m) sin(k pi/(2 N)), k = 0 .. N-1 (Meirovitch 1986, section 4.8).
    n = 60
    parts = [f'm{i} = {{ type = "mass", at = "x{i}", m = "m" }}' for i in range(n)]
    parts += [f'k{i} = {{ type = "spring", between = ["x{i}", "x{i + 1}"], k = "k" }}' for i in range(n - 1)]
    head = 'symflex = 1\nparameters = { m = "2 kg", k = "50 N/m" }\ninputs = { F = { force = "x0" } }\n'
    model = pipeline.loads(head + 'outputs = { X = "x0" }\n[elements]\n' + "\n".join(parts))
    (bound,) = pipeline.derive_bound(model, [("X", "F")])
    found = sorted(float(p.im.mid()) for p in pipeline.roots(bound, None, 20).poles if p.im > 0)
    expected = [2 * math.sqrt(50 / 2) * math.sin(k * math.pi / (2 * n)) for k in range(1, n)]
    assert found == pytest.approx(expected, rel=1e-14)


def test_the_square_of_a_square_root_cancels_by_value():
    # A notch at the resonance: the zeros at +-j sqrt(k/m) meet the poles there.
    model = pipeline.loads("""symflex = 1
parameters = { m = "2 kg", k = "8 kN/m" }
definitions = { w_n = "sqrt(k/m)" }
inputs = { u = {} }
outputs = { x = "x" }
blocks.N = { type = "resonance", omega_p = "2*w_n", zeta_p = 1, omega_z = "w_n", zeta_z = 0 }
[elements]
M = { type = "mass", at = "x", m = "m" }
K = { type = "spring", between = ["x", "ground"], k = "k" }
f = { type = "force_source", at = "x", f = "N*u" }
""")
    for bound in (
        pipeline.bind(pipeline.derive_all(model)[0]),
        pipeline.derive_bound(model, [("x", "u")])[0],
    ):
        found = pipeline.roots(bound, None, 12)
        assert found.certificate.certified
        assert [(round(float(p.re.mid()), 6), p.multiplicity) for p in found.poles] == [(-126.491106, 2)]
        assert not found.zeros
        assert sorted(round(float(h.root.im.mid()), 6) for h in found.hidden) == [-63.245553, 63.245553]


def test_a_coefficient_list_takes_quantities():
    model = pipeline.loads("""symflex = 1
inputs = { u = {} }
outputs = { y = "B*u" }
blocks.B = { type = "tf", num = 1, den = [1, "2 1/s"] }
""")
    assert pipeline.derive_bound(model, [("y", "u")])[0](0.0) == pytest.approx(0.5)
