"""What is called even or odd in s is so at points, and both parts of roots in discs are right."""

from flint import acb
from mpmath import mp

from symflex import pipeline
from symflex.model import with_numbers
from symflex.roots.networks.cramer import CramerEquations
from symflex.roots.networks.parity import mirrored
from symflex.transfer.nested_form import bind_nested
from tests.random_models import random_members, to_toml
from tests.tools.ways import FOLDERS

POINT = acb(3.7, 11.3)


def proved_and_seen(text):
    model = pipeline.loads(text)
    pair = model.transfer_functions[0]
    cramer = CramerEquations.of(pipeline.assemble_sparse(with_numbers(model, in_kernels=True)), *pair)
    values = [cramer.at(s, 128) for s in (POINT, -POINT)]
    sides = [[getattr(v, side) for v in values] for side in ("den", "num")]
    return mirrored(cramer), tuple(a.overlaps(b) or a.overlaps(-b) for a, b in sides)


def test_sides_called_even_or_odd_are_so_at_points_and_most_that_are_so_are_called_it():
    found = [proved_and_seen(to_toml(random_members(seed, 3))) for seed in range(24)]
    pairs = [pair for proved, seen in found for pair in zip(proved, seen, strict=True)]
    assert (True, False) not in pairs
    assert pairs.count((True, True)) > 10 * pairs.count((False, True))
    assert (False, False) in pairs


def test_poles_of_a_field_without_losses_lie_on_the_axis_by_its_equations():
    path = FOLDERS[0] / "classics" / "clamped_free.toml"
    model = pipeline.load(path)
    (tf,) = pipeline.derive_nested(model, model.transfer_functions[:1])
    found = pipeline.roots(bind_nested(tf))
    assert found.verdict.word == "marginal"
    assert all(pole.on_imaginary_axis for pole in found.poles)


def test_a_small_real_part_has_its_digits_too():
    # A rod with a weak damper at its free end: e^(2 s) = -(1 - b)/(1 + b).
    text = """symflex = 1
[elements]
rod = { type = "rod", between = ["ground", "x"], E = 1, A = 1, rho = 1, l = 1 }
loss = { type = "damper", between = ["x", "ground"], b = 1e-8 }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
"""
    (tf,) = pipeline.derive_nested(pipeline.loads(text))
    pole = next(p for p in pipeline.roots(bind_nested(tf)).poles if p.im > 0)
    with mp.workdps(40):
        expected = mp.log((1 - mp.mpf("1e-8")) / (1 + mp.mpf("1e-8"))) / 2
        assert pole.decimal(15).re == mp.nstr(expected, 15, strip_zeros=False).replace("e-0", "e-")
