"""What a whole search says of poles, zeros and hidden modes, with sides whose roots are known beforehand."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import inf, log, pi

import pytest

from symflex.errors import BudgetError, Diagnostic, UncertifiedError
from symflex.roots import Band, Modes
from symflex.roots import locate as room
from symflex.roots.distributed.proof import Proof
from symflex.roots.distributed.right_half_plane import DEGENERATE, RightHalfPlane
from symflex.roots.locate import degenerate_points, locate_distributed
from symflex.roots.passivity import PASSIVE
from symflex.roots.pole_zero_map import NONE_ON_AXIS
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


def test_a_search_that_found_nothing_but_the_origin_fails_and_zeros_alone_are_something(world):
    for known in [[], [root(0, 0, 2)]]:
        world.sides["poles"] = Known(known, fails=OVER)
        with pytest.raises(BudgetError, match="SF506"):
            world.locate()
    world.sides["poles"], world.sides["zeros"] = Known([]), Known(pair(-1, 9), fails=OVER)
    assert len(world.locate().zeros) == 2


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
