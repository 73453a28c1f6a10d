"""What a whole search says of poles, zeros and hidden modes, with sides whose roots are known beforehand."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import exp, inf, log, pi

import pytest

from symflex.algebra import Factored
from symflex.budget import Budget
from symflex.errors import BudgetError, Diagnostic, UncertifiedError
from symflex.roots import Band, Everything, Mode, Modes, Rectangle
from symflex.roots import locate as room
from symflex.roots.counting.winding import Cell
from symflex.roots.distributed.proof import Proof
from symflex.roots.distributed.right_half_plane import DEGENERATE, PASSIVE, RightHalfPlane
from symflex.roots.engines import LOSSLESS, POLYNOMIAL
from symflex.roots.locate import _Searched, degenerate_points, locate_distributed
from symflex.roots.plane.search import HIGHEST
from symflex.roots.pole_zero_map import NONE_ON_AXIS, HiddenRoot
from symflex.transfer import HiddenFactor
from tests.unit.roots.distributed_models import DELAY_LOOP, LINE, ON_A_FOUNDATION, ROD, bound
from tests.unit.roots.stand_ins import OVER, places, root

ALL_THERE = Proof(0, 0)
BAND = Band(Fraction(0), Fraction(5))


def pair(re, im, times=1):
    return [root(re, im, times), root(re, -im, times)]


@dataclass
class Known:
    """A side whose roots are these, and whose proof is this."""

    roots: list
    proof: Proof | BudgetError = ALL_THERE
    reached: float = 3.0
    missing: int = 0
    engine: str = "one"
    engine_after: str = ""
    is_finite: bool = False
    holes: tuple = ()
    fails: BudgetError | None = None
    modes: int = 9
    asked: list = field(default_factory=list)
    restored: list | None = None
    most: list | None = None

    @property
    def all_roots(self):
        return self.roots

    def _ask(self, *given):
        self.asked.append(given)
        if self.fails:
            raise self.fails

    def search(self, region):
        self._ask("search", region)

    def extend(self, modes, radius=-inf):
        self._ask("extend", modes, radius)

    def numbered(self, number):
        self._ask("numbered", number)

    def prove(self, region):
        self.asked.append(("prove", region))
        if isinstance(self.proof, BudgetError):
            raise self.proof
        self.engine = self.engine_after or self.engine
        return self.proof

    def recall(self):
        self.roots = self.roots if self.most is None else list(self.most)

    def restore(self):
        if self.restored is not None:
            self.roots = list(self.restored)

    def refined(self, given):
        return given

    def excluded(self):
        return self.holes


class Told:
    def __init__(self):
        self.said = []

    def report(self, done, text):
        self.said.append((done, text))


@pytest.fixture
def world(monkeypatch):
    """Let sides be what a test says, and nothing be found to the right but what it says."""

    class World:
        def __init__(self):
            self.made, self.judged = [], []
            self.sides = {"poles": Known([]), "zeros": Known([]), "hidden": Known([], is_finite=True)}
            self.beyond = {"poles": RightHalfPlane(()), "hidden": RightHalfPlane(())}
            self.last = None  # on the axis

        def side(self, source, part, digits, *, is_hidden=False):
            name = "hidden" if is_hidden else "poles" if part is source.den else "zeros"
            self.made.append((name, part, digits))
            return self.sides[name]

        def search_right(self, source, part, side, known, reached, digits, limit=None):
            name = "hidden" if side is self.sides["hidden"] else "poles"
            self.judged.append((name, places(known), reached, digits))
            result = self.beyond[name]
            if isinstance(result, Exception):
                raise result
            return replace(result, roots=(*known, *result.roots))

        def locate(self, text=DELAY_LOOP, region=BAND):
            source = text if not isinstance(text, str) else bound(text)
            return locate_distributed(source, region, 15)

    made = World()
    monkeypatch.setattr(room, "Side", made.side)
    monkeypatch.setattr(room, "search_right", made.search_right)
    monkeypatch.setattr(room, "last_on_axis", lambda *_: made.last)
    return made


# ------------------------------------------------------------ all went well


def test_everything_found_is_told_and_certified(world):
    world.sides["poles"] = Known([*pair(-1, 9), root(-2, 0, 2)], engine="two")
    world.sides["zeros"] = Known(pair(0, 4), engine="one")
    shown = world.locate()
    assert places(shown.poles) == [(-2, 0, 2), (-1, 9, 1), (-1, -9, 1)]
    assert places(shown.zeros) == [(0, 4, 1), (0, -4, 1)]
    assert (shown.tf, shown.region, shown.digits) == (bound(DELAY_LOOP).name, BAND, 15)
    assert (shown.hidden, shown.unstable, shown.excluded) == ((), (), ())
    assert shown.is_infinite
    assert not shown.is_default_region
    told = shown.certificate
    assert (told.engine, told.certified, told.counted, told.found) == ("one, two", True, 6, 6)
    assert (told.reason, told.is_exceeded, told.code) == (None, False, None)
    assert shown.verdict.word == "stable"


def test_all_sides_are_searched_and_proved_in_the_region_and_with_the_digits_asked_for(world):
    told = Told()
    with Budget(progress=told).entered():
        world.locate()
    assert [(name, digits) for name, _, digits in world.made] == [
        (name, 15) for name in ("poles", "zeros", "hidden")
    ]
    assert all(side.asked == [("search", BAND), ("prove", BAND)] for side in world.sides.values())
    assert told.said == [(k / 3, "proving that no root is missing") for k in range(3)]


def test_what_cancelled_is_searched_for_with_its_multiplicity(world):
    source = bound(DELAY_LOOP)
    s = source.ratio.ring.context.gen(0)
    world.sides["hidden"] = Known([root(-1, 0, 2), root(-1, 50)])
    shown = world.locate(replace(source, hidden=(HiddenFactor(s + 1, 2),)))
    (part,) = (part for name, part, *_ in world.made if name == "hidden")
    assert part.factors == ((s + 1, 2),)
    # 50 rad/s is beyond 5 Hz.
    assert [(places([h.root]), h.cause) for h in shown.hidden] == [([(-1, 0, 2)], "cancelled")]
    assert (shown.certificate.counted, shown.certificate.found) == (2, 2)


def test_what_poles_and_zeros_share_is_hidden_and_said_once(world):
    world.sides["poles"] = Known([*pair(-1, 9), root(-2, 0)])
    world.sides["zeros"] = Known(pair(-1, 9))
    shown = world.locate()
    assert (places(shown.poles), shown.zeros) == ([(-2, 0, 1)], ())
    assert [(places([h.root])[0], h.cause) for h in shown.hidden] == [
        ((-1, 9, 1), "coincident"),
        ((-1, -9, 1), "coincident"),
    ]
    world.sides["poles"], world.sides["zeros"] = Known(pair(-1, 9)), Known(pair(-1, 9))
    world.sides["hidden"] = Known(pair(-1, 9))
    assert [h.cause for h in world.locate().hidden] == ["cancelled", "cancelled"]


def test_where_wavenumbers_meet_or_vanish_nothing_is_hidden_but_at_0(world):
    # The wavenumber of the string is zero at +-j.
    world.sides["poles"], world.sides["zeros"] = Known(pair(0, 1)), Known(pair(0, 1))
    world.sides["hidden"] = Known([*pair(0, 1), root(0, 0), *pair(0, 2)])
    shown = world.locate(ON_A_FOUNDATION)
    assert places(h.root for h in shown.hidden) == [(0, 0, 1), (0, 2, 1), (0, -2, 1)]
    world.sides["hidden"] = Known([])
    assert world.locate(ON_A_FOUNDATION).hidden == ()


def test_what_cancelled_belongs_to_modes_up_to_the_highest_pole_or_has_its_own(world):
    world.sides["poles"] = Known([*pair(0, 9), *pair(0, 20), *pair(0, 30)])
    world.sides["hidden"] = Known([*pair(0, 15), *pair(0, 25)])
    shown = world.locate(region=Modes(2))
    assert places(shown.poles) == [(0, 9, 1), (0, -9, 1), (0, 20, 1), (0, -20, 1)]
    assert places(h.root for h in shown.hidden) == [(0, 15, 1), (0, -15, 1)]
    (search, prove) = world.sides["hidden"].asked
    assert search[1] == prove[1]
    assert search[1].low == 0
    assert float(search[1].high) == pytest.approx(20 / (2 * pi))
    # Poles and zeros are counted where they were searched.
    assert world.sides["poles"].asked[-1] == ("prove", Modes(2))
    world.sides["poles"] = Known([root(0, 0)])
    world.sides["hidden"] = Known([*pair(0, 15), *pair(0, 25)])
    shown = world.locate(region=Modes(1))
    assert places(h.root for h in shown.hidden) == [(0, 15, 1), (0, -15, 1)]
    assert world.sides["hidden"].asked[-1] == ("prove", Modes(1))


def test_a_function_that_is_zero_has_hidden_modes_only(world):
    source = bound(DELAY_LOOP)
    world.sides["hidden"] = Known([*pair(-1, 9), root(3, 0)])
    shown = world.locate(replace(source, ratio=Factored.number(source.ratio.ring, 0)))
    assert [name for name, *_ in world.made] == ["hidden"]
    assert (shown.poles, shown.zeros) == ((), ())
    assert places(h.root for h in shown.hidden) == [(3, 0, 1), (-1, 9, 1), (-1, -9, 1)]
    assert shown.certificate.found == 3
    assert shown.verdict.word == "unstable"


def test_neighbourhoods_left_out_are_told_once_and_a_search_of_polynomials_only_says_so(world):
    near, far = Cell(log(2) - 0.1, log(2) + 0.1, 3.0, 3.3), Cell(log(8) - 0.1, log(8) + 0.1, 3.0, 3.3)
    world.sides["poles"] = Known([], holes=(far, near))
    world.sides["zeros"] = Known([], holes=(far,))
    shown = world.locate()
    assert [round(hole.re) for hole in shown.excluded] == [-2, -8]
    for side in world.sides.values():
        side.is_finite = True
    assert world.locate().certificate.engine == POLYNOMIAL


# ------------------------------------------------------------ what was not proved


def test_why_it_is_not_proved_is_said_once(world):
    for proofs, reason in [
        ([Proof(5, 3), Proof(0, 0), Proof(0, 0)], "2 roots were counted but not found"),
        ([Proof(0, 0), Proof(3, 5), Proof(0, 0)], "2 roots were counted but not found"),
        ([Proof(0, 0), Proof(4, 4, "why"), Proof(1, 1, "how")], "why; how"),
        ([Proof(0, 0, "why"), Proof(0, 0), Proof(0, 0, "why")], "why"),
    ]:
        for side, proof in zip(world.sides.values(), proofs, strict=True):
            side.proof = proof
        told = world.locate().certificate
        assert (told.certified, told.reason) == (False, reason), proofs
        assert (told.is_exceeded, told.code) == (False, None), proofs


def test_roots_missing_are_counted(world):
    world.sides["poles"] = Known(pair(-1, 9), missing=2)
    world.sides["zeros"] = Known([], missing=1)
    told = world.locate().certificate
    assert (told.counted, told.found) == (5, 2)


def test_roots_that_are_not_told_apart_are_no_certificate(world):
    for name in ["poles", "zeros", "hidden"]:
        before = world.sides[name]
        world.sides[name] = Known([root(-1, 9, 2, 0.1, certified=False), root(-2, 0)])
        told = world.locate().certificate
        world.sides[name] = before
        assert (told.certified, told.reason) == (False, "some roots could not be told apart"), name


def test_after_a_search_repeated_with_proof_what_is_shared_is_taken_out_anew(world):
    both = [*pair(-1, 9), root(-2, 0)]
    world.sides["poles"] = Known(both, restored=both, engine_after="subdivision")
    world.sides["zeros"] = Known(pair(-1, 9), restored=[*pair(-1, 9), root(-4, 0)])
    shown = world.locate()
    assert (places(shown.poles), places(shown.zeros)) == ([(-2, 0, 1)], [(-4, 0, 1)])
    assert [h.cause for h in shown.hidden] == ["coincident"] * 2
    assert shown.certificate.certified
    assert shown.certificate.engine == "one, subdivision"


def test_a_repeated_search_does_not_hide_what_is_not_proved(world):
    world.sides["poles"] = Known([], engine_after="subdivision", proof=Proof(1, 0, "why"))
    assert world.locate().certificate.reason == "why"


def test_too_few_modes_left_after_a_repeated_search_are_said(world):
    for modes, reason in [(1, True), (2, None)]:
        world.sides["poles"] = Known([], modes=modes, engine_after="subdivision")
        told = world.locate(region=Modes(2)).certificate
        assert told.reason == (reason and "too many poles and zeros coincide to identify the modes"), modes


# ------------------------------------------------------------ one mode by its number


def test_a_mode_by_its_number_is_asked_of_poles_and_zeros(world):
    world.sides["poles"], world.sides["zeros"] = Known(pair(-1, 9)), Known(pair(-1, 8))
    shown = world.locate(region=Mode(3))
    assert (places(shown.poles), len(shown.zeros)) == ([(-1, 9, 1), (-1, -9, 1)], 2)
    for name in ("poles", "zeros"):
        assert world.sides[name].asked == [("numbered", 3), ("prove", Modes(3))]
    # What cancelled is only asked whether it is stable.
    assert world.sides["hidden"].asked == []
    assert [name for name, *_ in world.judged] == ["poles", "hidden"]
    assert shown.certificate.certified


def test_whether_what_cancelled_is_stable_is_searched_as_all_else(world):
    source = bound(DELAY_LOOP)
    s = source.ratio.ring.context.gen(0)
    world.locate(replace(source, hidden=(HiddenFactor(s + 1, 2),)), Mode(3))
    name, part, digits = world.made[-1]
    assert (name, part.factors, digits) == ("hidden", ((s + 1, 2),), 15)


def test_the_number_of_a_lossless_mode_needs_no_other_proof(world):
    for name in ("poles", "zeros"):
        world.sides[name] = Known(pair(0, 9), engine=LOSSLESS, proof=Proof(3, 1))
    assert world.locate(region=Mode(3)).certificate.certified
    assert all(("prove", Modes(3)) not in side.asked for side in world.sides.values())


def test_the_number_of_a_mode_that_is_not_proved_is_said_once(world):
    for proof, reason in [(Proof(3, 1), "roots were counted but not found"), (Proof(1, 1, "why"), "why")]:
        for name in ("poles", "zeros"):
            world.sides[name].proof = proof
        assert world.locate(region=Mode(3)).certificate.reason == reason, proof


# ------------------------------------------------------------ searches broken off


def test_a_search_broken_off_says_how_far_it_came(world):
    for modes, said in [(1, "1 mode was found up to 2 Hz"), (4, "4 modes were found up to 2 Hz")]:
        world.sides["poles"] = Known(pair(-1, 9), modes=modes, reached=log(4 * pi), fails=OVER)
        shown = world.locate(region=Modes(9))
        told = shown.certificate
        assert told.reason == f"the time budget is used up; {said}", modes
        assert (told.certified, told.is_exceeded, told.code) == (False, True, "SF506"), modes
        assert len(shown.poles) == 2, modes
        assert shown.verdict.reason == told.reason, modes


def test_poles_and_zeros_are_each_said_as_far_as_they_came(world):
    world.sides["poles"] = Known(pair(-1, 9), modes=4, reached=log(4 * pi), proof=OVER)
    for modes, reached, said in [
        (2, log(2 * pi), ", zeros up to 1 Hz"),
        (0, -9, ", no zeros yet"),
        (9, 3, ""),
    ]:
        world.sides["zeros"] = Known([], modes=modes, reached=reached)
        told = world.locate(region=Modes(9)).certificate.reason
        assert told == f"the time budget is used up; 4 modes were found up to 2 Hz{said}", modes
    world.sides["poles"] = Known([], modes=0, reached=-25, fails=OVER)
    world.sides["zeros"] = Known(pair(-1, 9))
    told = world.locate(region=Modes(9)).certificate.reason
    assert told == "the time budget is used up; no modes were found"


def test_a_search_anew_that_is_broken_off_leaves_what_was_found_before(world):
    world.sides["poles"] = Known([], most=pair(-1, 9), proof=OVER)
    assert places(world.locate(region=Modes(9)).poles) == [(-1, 9, 1), (-1, -9, 1)]


def test_how_far_is_not_said_of_a_band_or_where_it_came_nowhere(world):
    for reached in [-inf, inf]:
        world.sides["poles"] = Known(pair(-1, 9), reached=reached, fails=OVER)
        assert world.locate(region=Modes(9)).certificate.reason == "the time budget is used up", reached
    world.sides["poles"] = Known(pair(-1, 9), fails=OVER)
    assert world.locate().certificate.reason == "the time budget is used up"


def test_a_search_that_found_nothing_but_the_origin_fails_and_zeros_alone_are_something(world):
    for known in [[], [root(0, 0, 2)]]:
        world.sides["poles"] = Known(known, fails=OVER)
        with pytest.raises(BudgetError, match="SF506"):
            world.locate()
    world.sides["poles"], world.sides["zeros"] = Known([]), Known(pair(-1, 9), fails=OVER)
    assert len(world.locate().zeros) == 2


def test_proofs_or_searches_broken_off_put_back_what_was_found_but_of_no_numbered_mode(world):
    both = [*pair(-1, 9), root(-2, 0)]
    world.sides["poles"] = Known(both, restored=both, proof=OVER)
    world.sides["zeros"] = Known(pair(-1, 9), restored=pair(-1, 9))
    shown = world.locate()
    assert (places(shown.poles), shown.zeros) == ([(-2, 0, 1)], ())
    assert [h.cause for h in shown.hidden] == ["coincident"] * 2
    world.sides["poles"] = Known(pair(-1, 9), restored=pair(-1, 8), proof=OVER)
    world.sides["zeros"] = Known([])
    assert places(world.locate(region=Mode(2)).poles) == [(-1, 9, 1), (-1, -9, 1)]


def test_where_wavenumbers_vanish_a_root_counts_only_if_the_other_side_was_searched_there(world):
    for reached, is_finite, kept in [(-1.0, False, False), (0.5, False, True), (-1.0, True, True)]:
        # +-j, at ln(1) = 0; what is elsewhere or at 0 stays.
        mine = [*pair(0, 1), *pair(0, 3), root(0, 0)]
        world.sides["poles"] = Known(mine, restored=mine, proof=OVER, reached=9.0)
        world.sides["zeros"] = Known([], reached=reached, is_finite=is_finite)
        shown = world.locate(ON_A_FOUNDATION)
        assert ((0, 1, 1) in places(shown.poles)) is kept, (reached, is_finite)
        assert {(0, 3, 1), (0, 0, 1)} <= set(places(shown.poles)), (reached, is_finite)
    for reached, kept in [(-1.0, False), (0.5, True)]:
        mine = [*pair(0, 1), *pair(0, 3)]
        world.sides["poles"] = Known(pair(0, 5), restored=pair(0, 5), proof=OVER, reached=reached)
        world.sides["zeros"] = Known(mine, restored=mine, reached=9.0)
        assert ((0, 1, 1) in places(world.locate(ON_A_FOUNDATION).zeros)) is kept, reached


def test_all_that_was_exceeded_is_said(world):
    both = BudgetError(*OVER.diagnostics, Diagnostic("SF504", "the memory is used up"))
    world.sides["poles"] = Known(pair(-1, 9), fails=both)
    told = world.locate().certificate
    assert (told.reason, told.code) == ("the time budget is used up; the memory is used up", "SF506")


def test_an_unstable_pole_of_a_search_broken_off_is_no_hidden_mode(world):
    world.sides["poles"] = Known([root(2, 0)], proof=OVER)
    shown = world.locate()
    assert (places(shown.poles), shown.hidden, shown.unstable) == ([(2, 0, 1)], (), ())
    assert (shown.verdict.word, shown.verdict.right, shown.verdict.found) == ("unstable", None, 1)
    assert world.judged == []


def test_a_budget_that_ends_on_the_right_leaves_what_is_proved_of_the_region(world):
    world.sides["poles"] = Known([*pair(-1, 9), root(2, 0)])
    world.beyond["poles"] = OVER
    shown = world.locate()
    assert shown.certificate.certified
    assert not shown.certificate.is_exceeded
    assert shown.verdict.word == "unknown"
    assert shown.verdict.reason == "the time budget is used up"


# ------------------------------------------------------------ the right half plane


def test_poles_to_the_right_of_a_band_are_a_part_of_their_own(world):
    world.sides["poles"] = Known([*pair(-1, 9), root(3, 0)])
    world.beyond["poles"] = RightHalfPlane((*pair(2, 90, 2), root(-5, 0)))
    world.beyond["hidden"] = RightHalfPlane((root(4, 0, 3),))
    shown = world.locate()
    assert places(shown.poles) == [(3, 0, 1), (-1, 9, 1), (-1, -9, 1)]
    assert places(shown.unstable) == [(2, 90, 2), (2, -90, 2)]
    assert [(places([h.root])[0], h.cause) for h in shown.hidden] == [((4, 0, 3), "cancelled")]
    assert (shown.certificate.counted, shown.certificate.found) == (3 + 4 + 3, 3 + 4 + 3)
    assert (shown.verdict.word, shown.verdict.right) == ("unstable", 1 + 4 + 3)


def test_where_nothing_was_asked_for_they_are_among_the_poles(world):
    for region in [None, Everything()]:
        world.sides["poles"] = Known(pair(-1, 9))
        world.beyond["poles"] = RightHalfPlane((root(2, 0),))
        shown = world.locate(region=region)
        assert (places(shown.poles)[-1], shown.unstable) == ((2, 0, 1), ()), region
        assert (shown.region, shown.is_default_region) == (Modes(5), True), region


def test_modes_or_a_band_that_were_asked_for_have_no_others_among_them(world):
    world.beyond["poles"] = RightHalfPlane((root(2, 0),))
    shown = world.locate(region=Modes(5))
    assert (shown.poles, places(shown.unstable)) == ((), [(2, 0, 1)])
    world.beyond["poles"] = RightHalfPlane((root(2, 0),))
    shown = world.locate(bound(DELAY_LOOP + '[analysis]\nband = ["1 Hz", "2 Hz"]\n'), region=None)
    assert (shown.poles, places(shown.unstable), shown.is_default_region) == ((), [(2, 0, 1)], True)


def test_what_coincides_is_known_as_a_pole(world):
    world.sides["poles"], world.sides["zeros"] = Known([root(-1, 0), root(-2, 0)]), Known([root(-1, 0)])
    world.sides["hidden"] = Known([root(-3, 0)])
    world.locate()
    assert [known for _, known, *_ in world.judged] == [[(-2, 0, 1), (-1, 0, 1)], [(-3, 0, 1)]]


def test_up_to_where_all_poles_are_known_is_told(world):
    for region, reached in [
        (BAND, 10 * pi),
        (Band(Fraction(1), Fraction(5)), 0),
        (Rectangle(Fraction(-1), Fraction(1), Fraction(0), Fraction(2)), 0),
        (Modes(2), exp(3.0)),
        (Mode(1), 0),
    ]:
        world.judged.clear()
        world.locate(region=region)
        assert [given for _, _, given, _ in world.judged] == pytest.approx([reached] * 2), region
        assert {digits for *_, digits in world.judged} == {15}, region


def test_without_proof_nothing_is_known_up_to_anywhere_and_else_as_far_as_doubles_go(world):
    world.sides["poles"].reached = inf
    world.locate(region=Modes(2))
    assert world.judged[0][2] == exp(HIGHEST)
    world.judged.clear()
    world.sides["poles"].proof = Proof(2, 1)
    world.locate()
    assert [given for _, _, given, _ in world.judged] == [0, 0]


def test_why_poles_to_the_right_are_not_known_is_said(world):
    world.beyond = {"poles": RightHalfPlane((), "why"), "hidden": RightHalfPlane((), "how")}
    assert world.locate().verdict.reason == "why; how"
    world.beyond = {"poles": RightHalfPlane((), "why"), "hidden": RightHalfPlane((), "why")}
    assert world.locate().verdict.reason == "why"


def test_where_the_poles_to_the_right_cannot_be_searched_the_hidden_modes_are(world):
    world.beyond["poles"] = UncertifiedError(Diagnostic("SF404", "why"))
    world.sides["hidden"] = Known([root(3, 0)])
    shown = world.locate()
    assert (shown.verdict.word, shown.verdict.right, shown.verdict.reason) == ("unstable", None, "why")
    assert places(h.root for h in shown.hidden) == [(3, 0, 1)]


def test_a_passive_model_is_stable_without_a_search_unless_it_is_another_function(world):
    world.sides["poles"] = Known(pair(0, 9))
    shown = world.locate(ROD)
    assert world.judged == []
    assert (shown.verdict.word, shown.verdict.right) == ("marginal", 0)
    assert PASSIVE in shown.verdict.reason
    world.sides["poles"] = Known(pair(-1, 9))
    shown = world.locate(ROD)
    assert (shown.verdict.word, shown.verdict.right) == ("unknown", 0)
    assert shown.verdict.reason == f"{PASSIVE}; {NONE_ON_AXIS}"
    world.locate(replace(bound(ROD), is_of_model=False))
    assert [name for name, *_ in world.judged] == ["poles", "hidden"]


def test_where_a_passive_model_has_no_pole_far_up_the_axis_those_below_decide(world):
    world.last, world.sides["poles"] = 100.0, Known(pair(-1, 9))
    assert world.locate(ROD).verdict.word == "stable"
    assert [name for name, *_ in world.judged] == ["poles"]
    for beyond, word in [
        (RightHalfPlane(tuple(pair(0, 50))), "marginal"),
        (RightHalfPlane((), "not counted"), "unknown"),
        (UncertifiedError(Diagnostic("SF404", "why")), "unknown"),
    ]:
        world.beyond["poles"] = beyond
        assert world.locate(ROD).verdict.word == word
    # Where wavenumbers vanish, a root on the axis that was not met before may be a pole or none.
    world.sides["poles"], world.beyond["poles"] = Known(pair(-1, 9)), RightHalfPlane(tuple(pair(0, 1)))
    assert world.locate(ON_A_FOUNDATION).verdict.word == "unknown"


def test_to_the_right_where_wavenumbers_meet_there_may_be_no_pole(world, monkeypatch):
    monkeypatch.setattr(room, "degenerate_points", lambda _: [root(2, 0), root(0, 0)])
    world.beyond["poles"] = RightHalfPlane((root(2, 0), root(3, 0), root(0, 0)))
    shown = world.locate()
    assert places(shown.unstable) == [(3, 0, 1)]
    assert (shown.verdict.found, shown.verdict.right, shown.verdict.reason) == (1, None, DEGENERATE)
    # To the left nothing depends on it.
    monkeypatch.setattr(room, "degenerate_points", lambda _: [root(-2, 0)])
    world.beyond["poles"] = RightHalfPlane((root(-2, 0),))
    assert world.locate().verdict.word == "stable"


def test_hidden_modes_known_are_not_told_again_for_being_unstable(world):
    world.sides["hidden"] = Known([root(3, 0)])
    shown = world.locate()
    assert shown.hidden == (HiddenRoot(world.sides["hidden"].roots[0]),)


def test_wavenumbers_of_one_or_two_waves_vanish_or_meet():
    # gamma^2 = (s + 1)(s + 3)
    assert sorted(places(degenerate_points(bound(LINE)))) == [(-3, 0, 1), (-1, 0, 1)]
    # q^4 - (s + 5) q^2 + s + 2: none at -2, opposite at -5, and both the same where (s + 3)^2 = -8.
    text = """
symflex = 1
[fields.w]
domain = ["0", "l"]
equation = "l^4*w'''' = (s*T + 5)*l^2*w'' - (s*T + 2)*w"
conditions = ["w(0) = 0", "w''(0) = 0", "w(l) = 0", "w'(l) = u"]
[parameters]
T = "1 s"
l = "1 m"
[inputs]
u = { }
[outputs]
y = "w(l/2)"
"""
    found = [(round(re), round(im, 3), times) for re, im, times in places(degenerate_points(bound(text)))]
    assert sorted(found) == [(-5, 0, 1), (-3, -2.828, 1), (-3, 2.828, 1), (-2, 0, 1)]
    # (q^2 - 1)(q^2 - s - 4): none at -4, and both the same at -3.
    found = places(degenerate_points(bound(text.replace("s*T + 2", "s*T + 4"))))
    assert {(round(re), im) for re, im, _ in found} == {(-4, 0), (-3, 0)}


def test_before_a_search_it_came_nowhere():
    assert _Searched(bound(DELAY_LOOP), Modes(2), 15).extent() == ""
