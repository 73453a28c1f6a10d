"""One side of a transfer function: what was found, and counts that notice what was tampered with."""

from math import exp, inf, log, pi
from types import SimpleNamespace

import mpmath
import pytest

from symflex import pipeline
from symflex.algebra import Factored
from symflex.algebra.vanishing import OriginSeries
from symflex.budget import Budget
from symflex.errors import BudgetError, UncertifiedError
from symflex.roots import Modes
from symflex.roots.counting.winding import Cell, RootOnPathError
from symflex.roots.distributed import proof
from symflex.roots.distributed.proof import TOUCHING, UNPROVED, Proof, roots_at_zero, turns_about_zero
from symflex.roots.distributed.side import Side, accumulation_points, require_lowest
from symflex.roots.engines import GUESS_AND_PROVE, LOSSLESS, SUBDIVISION
from symflex.roots.locate import locate
from symflex.roots.plane.search import MODES_LIMIT
from symflex.roots.root import are_apart, groups
from symflex.transfer.of_model import derive_bound
from tests.unit.refusals import refusal
from tests.unit.roots.distributed_models import FREE, KELVIN_VOIGT, ROD, bound
from tests.unit.roots.stand_ins import root, side

LUMPED = """
symflex = 1
inputs.u = {}
outputs.y = "u*(s + 7)/((s + 1)*(s + 2)^2*((s - 1/2)^2 + 100))"
"""


def rod(n):
    """Return omega_n with omega tan omega = 2."""
    return float(
        mpmath.findroot(lambda x: x * mpmath.sin(x) - 2 * mpmath.cos(x), (n - 1) * pi + 2 / (n * pi))
    )


ENGINES = [LOSSLESS, GUESS_AND_PROVE, SUBDIVISION]


def three_modes(engine):
    """Return a rod whose three lowest modes were found, and proved to be all."""
    one = side(ROD, engines=(engine,))
    one.extend(3)
    return one


def test_a_search_anew_that_is_broken_off_is_recalled_to_the_one_that_found_the_modes():
    one = side(ROD, engines=(GUESS_AND_PROVE, SUBDIVISION))
    one.extend(3)
    before = (one.modes, one.reached, one.engine)
    one._known = Proof(20, 12)
    with pytest.raises(BudgetError), Budget(seconds=0).entered():
        one.prove(Modes(3))
    assert one.engine == SUBDIVISION
    one.recall()
    assert (one.modes, one.reached, one.engine) == before


def test_a_root_taken_away_is_missed_and_one_too_many_is_noticed():
    for engine in (LOSSLESS, GUESS_AND_PROVE):
        one = three_modes(engine)
        located = list(one._located)
        for n in (0, 3, 5):
            one._located, one._known = located[:n] + located[n + 1 :], None
            assert one.counted() == Proof(6, 5), (engine, n)
            assert not one.counted().is_complete, (engine, n)
        one._located, one._known = [*located, root(-0.5, 0.5)], None
        assert one.counted() == Proof(6, 7), engine
        # One beyond the domain is none of it.
        one._located, one._known = [*located, root(0, 100)], None
        assert one.counted() == Proof(6, 6), engine


def test_a_root_on_the_circle_is_no_proof():
    one = side(ROD, engines=(LOSSLESS,))
    one.extend(3)
    edge = rod(3)
    one._located = [root(0, edge, size=1e-9)]
    one._domain = Cell(-inf, log(edge), 0.0, pi)
    one._known = None
    assert one.counted() == Proof(0, 0, "a root lies on the boundary of what was searched")
    one._located, one._known = [], None
    assert one.counted() == Proof(0, 0, UNPROVED)


def test_a_count_is_kept_until_other_roots_are_set_and_nothing_is_proved_before_a_search():
    one = side(ROD)
    one.extend(2)
    assert one.counted() is one.counted()
    one._set([])
    assert one.counted() == Proof(4, 0)
    assert side(ROD).counted() == Proof(0, 0, "nothing was searched")


def test_a_proof_is_complete_when_all_counted_are_found_and_nothing_speaks_against_it():
    for given, is_complete in [((3, 3), True), ((3, 2), False), ((3, 3, "why"), False)]:
        assert Proof(*given).is_complete is is_complete


def test_a_mode_by_number_is_that_one():
    for n, engine in [(1, LOSSLESS), (4, LOSSLESS), (2, GUESS_AND_PROVE)]:
        one = side(ROD, engines=(engine,))
        assert float(one.numbered(n).im) == pytest.approx(rod(n))
        assert [abs(float(r.im)) for r in one.roots] == pytest.approx([rod(n)] * 2)


def test_a_polynomial_has_all_its_roots_at_once():
    one = side(LUMPED)
    assert one.is_finite
    assert sorted((round(float(r.re), 9), r.multiplicity) for r in one.roots) == [
        (-2, 2),
        (-1, 1),
        (0.5, 1),
        (0.5, 1),
    ]
    assert one.prove(Modes(1)) == Proof(5, 5)
    assert (one.reached, one.modes) == (-inf, MODES_LIMIT)
    one.search(Modes(1))
    one.extend(3)
    assert len(one.roots) == 4
    one.roots = []
    one.restore()
    assert len(one.roots) == 4
    # -1, twice -2, and the pair are four modes.
    assert [round(float(abs(one.numbered(n).enclosure())), 6) for n in (1, 2, 3)] == [1, 2, 2]
    assert one.numbered(9) is None
    assert one.roots == []


def test_too_many_modes_are_not_searched():
    with pytest.raises(BudgetError, match="SF505") as failed:
        side(ROD).extend(MODES_LIMIT + 1)
    (diagnostic,) = failed.value.diagnostics
    assert diagnostic.hint == "ask for a band"
    assert diagnostic.message.endswith(f"are searched, not {MODES_LIMIT + 1}")


def test_a_root_is_refined_to_more_than_twice_its_digits():
    one = side(ROD)
    one.extend(1)
    (upper,) = (r for r in one.roots if r.im > 0)
    finer = one.refined(upper)
    assert upper.im.overlaps(finer.im)
    assert finer.im.rel_accuracy_bits() > 2 * 20 * 3.32
    (zero,) = (r for r in side(FREE).roots if r.is_zero)
    assert one.refined(zero) is zero
    blurred = root(0, 1, certified=False)
    assert one.refined(blurred) is blurred


def test_roots_right_of_the_axis_are_counted_up_to_a_radius_but_not_past_one_on_the_axis():
    for high, count in [(3.0, 2), (20.0, 2), (0.5, 0)]:
        # s + 3 exp(-s), whose roots are W_k(-3).
        text = 'symflex = 1\nblocks.D = { type = "delay", T = 1 }\ninputs.u = {}\noutputs.y = "u/(s + 3*D)"'
        right = [s for k in range(-4, 5) if (s := complex(mpmath.lambertw(-3, k))).real > 0]
        assert side(text).count_right(log(high)) == sum(abs(s) < high for s in right) == count
    with pytest.raises(RootOnPathError):
        side(ROD).count_right(log(5.0))


def test_poles_accumulate_where_a_lossy_beam_no_longer_resists():
    # E (1 + eta s) vanishes at -1/eta.
    assert accumulation_points(bound(KELVIN_VOIGT)) == (pytest.approx(-250),)
    assert accumulation_points(bound(ROD)) == ()
    (hole,) = side(KELVIN_VOIGT).holes
    assert (hole.low + hole.high) / 2 == pytest.approx(log(250))


def test_enclosures_are_apart_when_none_meets_another():
    for roots, apart in [
        ([], True),
        ([root(0, 3), root(0, 4)], True),
        ([root(0, 3), root(0, 3)], False),
        ([root(1, 3, size=1e-3), root(-1, 3, size=1e-3), root(1, -3, size=1e-3)], True),
        ([root(1, 3, size=1e-3), root(1.0015, 3, size=1e-3)], False),
        ([root(1, 3, size=1e-3), root(1.0025, 3, size=1e-3)], True),
        # as far from 0 as each other, elsewhere
        ([root(3, 4), root(4, 3), root(0, 5), root(5, 0)], True),
        # a large one holds what lies between
        ([root(3, 4, size=0.5), root(3, 3.2), root(3.1, 4.2, size=0.01)], False),
        ([root(3, 9), root(3, 4, size=0.5), root(5, 5), root(3.2, 4.4)], False),
    ]:
        assert are_apart(roots) is apart


def test_roots_that_mirror_each_other_are_one_group():
    zero, real, mirrored = root(0, 0, 2), root(3, 0), root(-3, 0)
    four = [root(re, im) for re in (-1, 1) for im in (-2, 2)]
    assert groups([zero, real, *four, mirrored, root(2, 1)]) == [[real, mirrored], four, [root(2, 1)]]
    near = root(-3 - 1e-12, 0, size=1e-10)
    assert groups([real, near, root(3.1, 0)]) == [[real, near], [root(3.1, 0)]]


def field(equation):
    text = f"""symflex = 1
[fields.w]
domain = ["0", "1"]
equation = "{equation}"
conditions = ["w(0) = 0", "w'(1) = F"]
[inputs]
F = {{}}
[outputs]
X = "w(1)"
"""
    model = pipeline.loads(text)
    return derive_bound(model, model.transfer_functions)[0]


def test_roots_that_may_accumulate_at_zero_are_refused():
    # cosh(1/sqrt(s)) = 0 at s = -4/((2 n - 1) pi)^2.
    for law in ("w'' = 1/s*w", "w'' = x/s*w", "w'' = x^3/s^2*w", "w'' = x*(s + 1)/s^3*w"):
        assert refusal(locate, field(law), Modes(1)) == "UncertifiedError SF404", law


def test_states_may_have_a_pole_at_zero_where_waves_have_none():
    # A fluid of Maxwell's: E s/(1 + s) in the modulus, and waves of wavenumber sqrt(s (1 + s)) up to x.
    require_lowest(field("(s/(1 + s)*(1 + x)*w')' = s^2*w"))


def test_values_along_a_taper_that_no_memory_holds_are_refused():
    assert refusal(locate, field("w'' = x*s^40*w"), Modes(11), 45) == "BudgetError SF504"


# ------------------------------------------------------------------- proofs that lack something, one by one


def test_a_subdivision_that_lost_roots_says_how_many():
    one = side(ROD, engines=(SUBDIVISION,))
    one.extend(2)
    one.missing = 3
    assert one.prove(Modes(2)) == Proof(7, 4, "3 roots were counted but not found")
    one.missing = 0
    one._located.append(one._located[0])
    assert one.prove(Modes(2)) == Proof(5, 5, TOUCHING)


def test_a_subdivision_that_may_have_left_roots_inside_proves_nothing():
    one = side(ROD, engines=(SUBDIVISION,))
    one.extend(2)
    assert one.prove(Modes(2)) == Proof(4, 4)
    one._innermost = (log(rod(1)) + log(rod(2))) / 2
    assert one.prove(Modes(2)) == Proof(4, 4, UNPROVED)
    # As little as where the circle meets one of them.
    one._innermost = log(rod(1))
    assert one.prove(Modes(2)) == Proof(4, 4, UNPROVED)


def test_inside_of_a_ring_no_roots_are_left_unseen():
    one = side(ROD, engines=(GUESS_AND_PROVE,))
    one.extend(3)
    one._located = [r for r in one._located if abs(float(r.im)) > rod(1) + 0.1]
    one._domain = Cell((log(rod(1)) + log(rod(2))) / 2, one._domain.high, 0.0, pi)
    one._innermost, one._known = None, None
    assert one.counted() == Proof(4, 4)
    one._innermost, one._known = one._domain.low, None
    assert one.counted() == Proof(4, 4, UNPROVED)


class Circles:
    """Counts about 0, by how far below a radius of 1 they are."""

    def __init__(self, *counts, power):
        self.counts = list(counts)
        self.function = SimpleNamespace(power=power, bound=SimpleNamespace(name="X/F"))

    def smallest(self, left, holes):
        return 0.0

    def count_within(self, z, left):
        count = self.counts.pop(0)
        if count is None:
            raise RootOnPathError
        return count


def test_the_smallest_circle_that_could_be_counted_tells_the_roots_next_to_0_or_there_is_an_error():
    for counts, power, found in [
        ((0,), 1, (-1.0, 0)),
        ((2, 2, 2, 2), 1, (-64.0, 2)),
        ((2, 1, None, None), 1, (-4.0, 1)),
        ((None, 4, 4, 4), 2, (-64.0, 2)),
        ((4, 3, 3, 3), 2, (-1.0, 2)),
        ((2, 0), 1, (-4.0, 0)),
    ]:
        assert turns_about_zero(Circles(*counts, power=power), pi / 2, ()) == found
    with pytest.raises(
        UncertifiedError, match=r"SF404.*the order of the root of \S+ at s = 0 could not be determined"
    ):
        turns_about_zero(Circles(None, 3, None, 5, power=2), pi / 2, ())


def test_roots_next_to_0_of_functions_without_a_formula_are_in_a_small_box(monkeypatch):
    one = side(ROD)
    monkeypatch.setattr(OriginSeries, "order", lambda self, part: None)
    for turns, hidden, expected in (
        (0, False, []),
        (1, False, [(1, True, True)]),
        (2, False, [(2, False, True)]),
        (2, True, []),
    ):
        monkeypatch.setattr(proof, "turns_about_zero", lambda *given, turns=turns: (-5.0, turns))
        roots, order = roots_at_zero(one._winding, bound(ROD).den, pi / 2, (), is_hidden=hidden)
        assert order == turns
        held = [(r.multiplicity, r.certified, r.re.contains(0) and r.im.contains(0)) for r in roots]
        assert held == expected, (turns, hidden)
        for each in roots:
            assert (each.is_real, each.on_imaginary_axis) == (False, False)
            assert exp(-5) <= float(each.re.rad()) == float(each.im.rad()) < 1.001 * exp(-5)
    # A power of s alone is a root at 0 whatever lies next to it.
    monkeypatch.setattr(proof, "turns_about_zero", lambda *given: (-5.0, 0))
    part = bound(ROD).den
    s = part.ring.context.gen(0)
    power = Factored.polynomial(part.ring, s**3)
    ((zero,), order) = roots_at_zero(one._winding, part * power, pi / 2, (), is_hidden=False)
    assert (zero.is_zero, zero.multiplicity, zero.certified, order) == (True, 3, True, 0)


def test_what_kernels_vanish_like_at_0_is_a_root_there():
    for engine in ENGINES:
        # cosh(s) - 1, with double roots at 0 and at every 2 pi j n.
        source = bound(ROD)
        ring = source.ratio.ring
        (cosh,) = (ring.generator(k.generator) for k in source.kernels.kernels if k.function == "cosh")
        one = Side(source, Factored.polynomial(ring, cosh - 1), 20, engines=(engine,))
        one.extend(4)
        (zero,) = (r for r in one.roots if r.is_zero)
        assert zero.multiplicity == 2, engine
        found = sorted((float(r.im), r.multiplicity) for r in one.roots if r.im > 0)[:2]
        assert found == [(pytest.approx(2 * pi), 2), (pytest.approx(4 * pi), 2)], engine
        assert one.prove(Modes(4)).is_complete, engine
