"""What known poles say of stability, and what is made of a count of those in the right half-plane."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from types import SimpleNamespace

import pytest

from symflex import pipeline
from symflex.roots.counting.winding import RootOnPathError
from symflex.roots.distributed import right_half_plane
from symflex.roots.distributed.proof import Proof
from symflex.roots.distributed.right_half_plane import RightHalfPlane, gaps_text
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
        ([LEFT], [RIGHT], "unstable", "a hidden pole in the right half-plane"),
        ([LEFT], [NEAR], "unknown", ""),
        ([RIGHT], [ON], "unstable", "a hidden pole on the imaginary axis"),
    ]:
        found = judge(seen, hidden=hidden)
        assert (found.word, found.hidden) == (word, said), (seen, hidden)


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
            "unstable: 1 pole in the right half-plane",
            "unstable: 1 pole in the right half-plane",
            "unstable",
        ),
        (
            ("unstable", None, True, "no end", 3),
            "unstable: at least 3 poles in the right half-plane; no end",
            "unstable: at least 3 poles in the right half-plane",
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


def test_gaps_of_several_functions_say_every_reason_once_and_how_far_all_are_known():
    found = [
        RightHalfPlane((), *gap) for gap in [("", 0.0), ("no end", 40 * pi), ("no end", 20 * pi), ("lost", 0)]
    ]
    assert gaps_text(found) == "known up to 10 Hz only: no end; lost"


def test_hidden_motion_is_a_line_that_names_what_moves():
    for moving, said in [
        ("", ", uncontrollable or unobservable"),
        ("u", ": u is arbitrary at equilibrium"),
        ("xy", ": x and y are arbitrary at equilibrium"),
        ("abcde", ": a, b, c and 2 others are arbitrary at equilibrium"),
    ]:
        verdict = StabilityVerdict("stable", 0, True, hidden="a hidden pole at s = 0", moving=tuple(moving))
        assert verdict.hidden_motion == f"a hidden pole at s = 0{said}"


def test_a_string_held_at_both_ends_has_hidden_poles_without_number_and_none_that_is_seen():
    # Two equal rods meet where a damper is driven: modes that leave that point at rest are sin(q l) = 0.
    rods = "".join(
        f'rod_{n} = {{ type = "rod", between = ["ground", "x"], E = 1, A = 1, rho = 1, l = 1 }}\n'
        for n in "ab"
    )
    text = (
        f'symflex = 1\n[elements]\n{rods}loss = {{ type = "damper", between = ["x", "ground"], b = 1 }}\n'
        '[inputs]\nF = { force = "x" }\n[outputs]\nX = "x"\n'
    )
    (bound,) = pipeline.derive_for_roots(pipeline.loads(text), [("X", "F")])
    found = pipeline.roots(bound)
    assert found.verdict.hidden == "hidden poles on the imaginary axis"
    assert [float(h.root.im.mid()) / pi for h in found.hidden[::2]] == pytest.approx([1, 2, 3, 4])
    assert not any(pole.on_imaginary_axis for pole in found.poles)


@dataclass
class Half:
    """A side whose count along the imaginary axis meets a root, or, searched again, its roots and proof."""

    roots: tuple = ()
    proof: Proof | None = None
    is_finite: bool = False
    holes: tuple = ()

    @property
    def function(self):
        part = SimpleNamespace(factors=[("factor", 1)])
        return SimpleNamespace(is_even=False, part=part, bound="bound", frequency_of=lambda waves: waves)

    def count_right(self, z):
        raise RootOnPathError

    def anew(self):
        return self

    def search(self, region):
        """Search nothing: the roots are there."""

    def prove(self, region):
        return self.proof


def test_with_a_root_on_the_path_the_half_plane_is_searched_and_what_that_proves_is_said(monkeypatch):
    monkeypatch.setattr(right_half_plane, "right_tail", lambda *_: 7.0)
    for proof, unproved in [(Proof(1, 1), ""), (Proof(2, 1), right_half_plane.NOT_COUNTED)]:
        found = right_half_plane.search_right(Half((RIGHT, ON), proof), (), 0.0)
        assert found == RightHalfPlane((RIGHT, ON), unproved), proof
