"""What known poles say of stability, and what is made of a count of those right of the axis."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import exp, pi
from types import SimpleNamespace

import pytest
from flint import acb

from symflex import pipeline
from symflex.errors import BudgetError, Diagnostic
from symflex.roots.counting.winding import RootOnPathError
from symflex.roots.distributed import right_half_plane
from symflex.roots.distributed.proof import Proof
from symflex.roots.distributed.right_half_plane import (
    ACCUMULATING,
    NOT_COUNTED,
    RightHalfPlane,
    gaps_text,
    search_right,
)
from symflex.roots.pole_zero_map import NOT_EXAMINED, ON_AXIS, StabilityVerdict, judge
from tests.unit.roots.stand_ins import root as pole

LEFT, RIGHT, TWICE = pole(-1), pole(2, 3), pole(1, times=2)
ON, ZERO, DOUBLE_ZERO, NEAR = pole(0, 5), pole(0), pole(0, times=2), pole(0, 5, size=0.1)


def test_poles_allow_this_verdict_and_no_other():
    for roots, unproved, proof, expected in [
        ([], "", "", ("stable", 0, True, "", 0)),
        ([LEFT], "", "", ("stable", 0, True, "", 0)),
        ([LEFT], "no end", "", ("unknown", None, False, "no end", 0)),
        ([LEFT], "", "passive", ("stable", 0, True, "passive", 0)),
        ([LEFT], "no end", "passive", ("unknown", 0, False, "passive; no end", 0)),
        ([LEFT, NEAR], "", "", ("unknown", None, False, ON_AXIS, 0)),
        ([LEFT, NEAR], "no end", "", ("unknown", None, False, "no end", 0)),
        ([LEFT, RIGHT, TWICE], "", "", ("unstable", 3, True, "", 3)),
        ([LEFT, RIGHT], "no end", "", ("unstable", None, True, "no end", 1)),
        ([RIGHT, NEAR], "", "", ("unstable", None, True, ON_AXIS, 1)),
        ([RIGHT, NEAR], "no end", "", ("unstable", None, True, "no end", 1)),
        ([RIGHT, ON], "", "", ("unstable", 1, True, "", 1)),
        ([LEFT, ON], "", "", ("marginal", 0, True, "poles on the imaginary axis", 0)),
        ([ON, ZERO], "", "", ("marginal", 0, True, "poles on the imaginary axis", 0)),
        ([LEFT, ZERO], "", "", ("marginal", 0, True, "a pole at 0", 0)),
        ([ZERO, DOUBLE_ZERO], "", "", ("marginal", 0, True, "3 poles at 0", 0)),
        ([ZERO], "no end", "", ("unknown", None, False, "a pole at 0; no end", 0)),
        ([ZERO], "", "passive", ("marginal", 0, True, "a pole at 0; passive", 0)),
        ([DOUBLE_ZERO], "no end", "passive", ("marginal", 0, True, "2 poles at 0; passive", 0)),
    ]:
        found = judge(roots, unproved, proof)
        assert (found.word, found.right, found.certified, found.reason, found.found) == expected, roots


def test_hidden_poles_on_the_axis_are_named_and_leave_the_word_those_on_the_right_decide():
    for seen, hidden, word, said in [
        ([LEFT], [ZERO], "stable", "a hidden pole at s = 0"),
        ([LEFT], [LEFT], "stable", ""),
        ([ZERO], [DOUBLE_ZERO, ON], "marginal", "2 hidden poles at s = 0 and 1 on the imaginary axis"),
        ([LEFT], [RIGHT], "unstable", "a hidden pole in the right half plane"),
        ([LEFT], [NEAR], "unknown", ""),
        ([RIGHT], [ON], "unstable", "a hidden pole on the imaginary axis"),
    ]:
        found = judge(seen, hidden=hidden)
        assert (found.word, found.hidden) == (word, said), (seen, hidden)


def test_hidden_motion_is_a_line_that_names_what_moves():
    for moving, said in [
        ("", ", which input and output do not see"),
        ("u", ": u may rest anywhere"),
        ("xy", ": x and y may rest anywhere"),
        ("abcde", ": a, b, c and 2 more may rest anywhere"),
    ]:
        verdict = StabilityVerdict("stable", 0, True, hidden="a hidden pole at s = 0", moving=tuple(moving))
        assert verdict.hidden_motion == f"a hidden pole at s = 0{said}"


def test_poles_of_two_parts_together_are_as_stable_as_the_worse_of_them():
    for one, other, expected in [
        (judge([LEFT]), judge([ON]), ("marginal", 0, "poles on the imaginary axis", 0)),
        (judge([ON]), judge([RIGHT]), ("unstable", 1, "", 1)),
        (judge([RIGHT]), judge([LEFT], "no end"), ("unstable", None, "no end", 1)),
        (judge([LEFT], "no end"), judge([LEFT], "no end"), ("unknown", None, "no end", 0)),
        (judge([LEFT], "no end"), judge([ON]), ("unknown", None, "no end", 0)),
    ]:
        for found in (one.beside(other), other.beside(one)):
            assert (found.word, found.right, found.reason, found.found) == expected


def test_a_verdict_is_said_in_a_sentence_a_headline_and_a_word():
    for given, sentence, headline, brief in [
        (("stable", 0, True), "stable", "stable", "stable"),
        (("stable", 0, True, "passive"), "stable: passive", "stable", "stable"),
        (
            ("marginal", 0, True, "a pole at 0"),
            "marginal, not asymptotically stable: a pole at 0",
            "marginal",
            "marginal",
        ),
        (
            ("unstable", 1, True, "", 1),
            "unstable: 1 pole in the right half plane",
            "unstable: 1 pole in the right half plane",
            "unstable",
        ),
        (
            ("unstable", None, True, "no end", 3),
            "unstable: at least 3 poles in the right half plane; no end",
            "unstable: at least 3 poles in the right half plane",
            "unstable",
        ),
        (
            ("unknown", None, False, "no end"),
            "stability not known: no end",
            "stability not known",
            "stability not known",
        ),
    ]:
        verdict = StabilityVerdict(*given)
        assert (verdict.sentence, verdict.headline, verdict.brief) == (sentence, headline, brief)


def test_a_verdict_has_these_keys_as_data():
    assert StabilityVerdict("unstable", None, True, "no end", 3).to_json_dict() == {
        "verdict": "unstable",
        "right_half_plane": None,
        "certified": True,
        "reason": "no end",
        "right_half_plane_found": 3,
        "hidden_motion": "",
    }
    assert NOT_EXAMINED.to_json_dict() == {
        "verdict": "unknown",
        "right_half_plane": None,
        "certified": False,
        "reason": "not examined",
        "right_half_plane_found": 0,
        "hidden_motion": "",
    }


def test_what_is_not_proved_or_not_counted_has_a_reason():
    for given in [("unstable", None, True), ("stable", 0, False)]:
        with pytest.raises(ValueError, match=r"^what is not proved needs a reason$"):
            StabilityVerdict(*given)


# ------------------------------------------------------------------- what is made of a count, by stand-ins

SPENT = BudgetError(Diagnostic("SF505", "the budget is spent", None, ""))


@dataclass
class Half:
    """A side that counts what it is told."""

    count: int | Exception
    is_even: bool = False
    holes: tuple = ()
    is_finite: bool = False
    exponents: tuple = (1,)
    roots: tuple = ()
    proof: Proof | Exception | None = None
    counted_to: list = field(default_factory=list)
    searched: list = field(default_factory=list)

    @property
    def function(self):
        part = SimpleNamespace(factors=[(f"factor {i}", e) for i, e in enumerate(self.exponents)])
        return SimpleNamespace(
            is_even=self.is_even, part=part, bound="bound", frequency_of=lambda waves: 3 * waves
        )

    def count_right(self, z):
        self.counted_to.append(exp(z))
        if isinstance(self.count, Exception):
            raise self.count
        return self.count

    def search(self, region):
        self.searched.append(region)

    def prove(self, region):
        if isinstance(self.proof, Exception):
            raise self.proof
        return self.proof


ENDING, ENDLESS = (7.0,), ("poles have no end",)


@pytest.fixture
def searching(monkeypatch):
    """Search right of the axis, given tails of the factors and what a search of the half plane finds."""

    def search(side, known=(), reached=0.0, tails=ENDING, again=None):
        every = iter(tails)

        def tail(bound, polynomials, numbers, start):
            # Of one factor, whole, from where the largest argument of a kernel is 1.
            assert (bound, len(polynomials), start) == ("bound", 1, 3.0)
            assert numbers == (acb(1),)
            return next(every)

        def another(*given):
            assert given == ("bound", "part", 10)
            return again

        monkeypatch.setattr(right_half_plane, "right_tail", tail)
        monkeypatch.setattr(right_half_plane, "Side", another)
        return search_right("bound", "part", side, known, reached, 10)

    return search


def test_gaps_of_several_functions_say_every_reason_once_and_how_far_all_are_known():
    found = [
        RightHalfPlane((), *gap) for gap in [("", 0.0), ("no end", 40 * pi), ("no end", 20 * pi), ("lost", 0)]
    ]
    assert gaps_text(found) == "known up to 10 Hz only: no end; lost"


def test_all_roots_of_a_polynomial_and_as_many_as_are_counted_need_no_search(searching):
    assert searching(Half(5, is_finite=True), [LEFT, RIGHT]) == RightHalfPlane((LEFT, RIGHT))
    side = Half(3)
    assert searching(side, [LEFT, RIGHT, TWICE, NEAR]) == RightHalfPlane((RIGHT, TWICE, NEAR))
    # A little beyond the end, so that the path's corners meet no root.
    assert side.counted_to == [pytest.approx(7 * 1.01)]


def test_roots_accumulate_right_of_the_axis_where_a_hole_begins_there(searching):
    for right, unproved in [(1.5, ACCUMULATING), (1.6, "")]:
        side = Half(0, holes=(SimpleNamespace(right=right),))
        assert searching(side) == RightHalfPlane((), unproved), right


def test_where_some_are_missing_the_half_disc_is_searched(searching):
    again = Half(0, roots=(LEFT, RIGHT, TWICE), proof=Proof(3, 3))
    assert searching(Half(3), [RIGHT], again=again) == RightHalfPlane((RIGHT, TWICE))
    (region,) = again.searched
    assert (region.re_low, region.re_high, region.im_low, region.im_high) == (0, 7, -7, 7)


def test_with_a_root_on_the_path_the_search_is_proved_by_itself(searching):
    for proof, unproved in [(Proof(1, 1), ""), (Proof(2, 1), NOT_COUNTED)]:
        again = Half(0, roots=(RIGHT, ON), proof=proof)
        assert searching(Half(RootOnPathError()), again=again) == RightHalfPlane((RIGHT, ON), unproved), proof


def test_a_budget_spent_by_the_count_is_said(searching):
    assert searching(Half(SPENT), [RIGHT]) == RightHalfPlane((RIGHT,), "the budget is spent")
    found = searching(Half(SPENT), [RIGHT], reached=20.0, tails=ENDLESS)
    assert found == RightHalfPlane((RIGHT,), "poles have no end", 20.0)


def test_a_budget_spent_by_the_search_is_said_with_what_was_counted(searching):
    for count, said in [
        (3, "3 are counted, but not all are found: the budget is spent"),
        (RootOnPathError(), "the budget is spent"),
    ]:
        again = Half(0, roots=(RIGHT, TWICE), proof=SPENT)
        assert searching(Half(count), [RIGHT], again=again) == RightHalfPlane((RIGHT,), said)


def test_roots_that_mirror_each_other_are_not_counted_along_the_axis_but_where_they_end(searching):
    side, again = Half(9, is_even=True), Half(0, roots=(RIGHT, ON, LEFT))
    found = searching(side, [ON], reached=20.0, tails=ENDLESS, again=again)
    assert found == RightHalfPlane((RIGHT, ON), "poles have no end", 20.0)
    assert side.counted_to == []
    assert again.searched
    found = searching(Half(9, is_even=True), [ON, LEFT], reached=31.0, tails=ENDLESS)
    assert found == RightHalfPlane((ON, LEFT), "poles have no end", 31.0)
    assert searching(Half(1, is_even=True), [RIGHT]) == RightHalfPlane((RIGHT,))


def test_a_budget_spent_beyond_what_was_asked_for_says_how_far_all_is_known(searching):
    class Spent(Half):
        def search(self, region):
            raise SPENT

    found = searching(Half(0, is_even=True), [ON], reached=20.0, tails=ENDLESS, again=Spent(0))
    assert found == RightHalfPlane((ON,), "poles have no end", 20.0)


def test_distributed_parts_that_nothing_sees_are_not_said_to_be_stable():
    text = """symflex = 1
inputs = {{ F = {{ force = "y" }} }}
outputs = {{ Y = "tip" }}
[elements.arm]
type = "beam"
between = ["ground", "tip"]
E = "2 Pa"
I = "3 m^4"
rho = "5 kg/m^3"
A = "7 m^2"
l = "1 m"
[elements]
m = {{ type = "mass", at = "y", m = "1 kg" }}
k = {{ type = "spring", between = ["y", "ground"], k = "{k} N/m" }}
"""
    words = {}
    for k in ("1", "-1"):
        model = pipeline.loads(text.format(k=k))
        (bound,) = pipeline.derive_bound(model, [("Y", "F")])
        words[k] = pipeline.roots(bound).verdict.word
    # The mass on the negative spring falls away, and the function, which is 0, holds nothing of it.
    assert words == {"1": "stable", "-1": "unknown"}
