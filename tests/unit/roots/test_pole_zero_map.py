"""Poles, zeros and their certificate."""

from fractions import Fraction

import pytest
from flint import arb

from symflex.errors import BudgetError
from symflex.roots import Band, Modes, find_pole_zero_map, pole_zero_map
from symflex.roots.pole_zero_map import ON_AXIS, Certificate, Exclusion, PoleZeroMap, judge
from symflex.roots.region import Everything
from symflex.roots.root import Root
from tests.unit.roots.root_problems import problem

POLES = problem(0, 0, 9, 0, 1)  # s^2 (s^2 + 9)
ZEROS = problem(4, 0, 1)


def test_hidden_modes_in_the_region_are_reported_with_their_cause():
    hidden = ((problem(25, 0, 1), "unobservable"),)
    found = find_pole_zero_map("x/F", POLES, ZEROS, Modes(1), 3, hidden)
    assert [(h.root.decimal(3).im, h.cause) for h in found.hidden] == [
        ("5.00", "unobservable"),
        ("-5.00", "unobservable"),
    ]
    assert found.certificate.counted == 8
    assert find_pole_zero_map("x/F", POLES, ZEROS, Band(Fraction(2), Fraction(9)), 3, hidden).hidden == ()


# ------------------------------------------------------- what is said of roots that a stand-in has found


def real(*places, certified=True):
    """Return roots on the real axis, of a width in the last place where that is not 0."""
    return tuple(
        Root(arb(place, width), arb(0), 1, on_imaginary_axis=False, is_real=True, certified=certified)
        for place, width in ((p if isinstance(p, tuple) else (p, 0)) for p in places)
    )


class StandIn:
    """Returns, for one problem after the other, what it was given, or raises it."""

    def __init__(self, *answers):
        self.answers = list(answers)
        self.digits = []

    def __call__(self, problem, digits):
        self.digits.append(digits)
        answer = self.answers.pop(0)
        if isinstance(answer, BudgetError):
            raise answer
        return answer


def mapped(*answers, degrees=(2, 1), hidden=(), region=None):
    poles, zeros, *others = (problem(*([1] * (n + 1))) for n in (*degrees, *hidden))
    finder = StandIn(*answers)
    causes = [(each, f"cause {i}") for i, each in enumerate(others)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pole_zero_map, "find_polynomial_roots", finder)
        shown = find_pole_zero_map("x/F", poles, zeros, region, 10, causes)
    return shown, finder


def test_a_passive_system_with_a_pole_that_may_lie_on_the_axis_is_not_called_stable():
    near = real((0, "1e-20"))
    assert judge(near, "", "passive").sentence == f"stable or marginal: passive; {ON_AXIS}"
    assert judge(real((-1, "1e-20")), "", "passive").word == "stable"


def test_a_root_that_is_missing_or_not_told_apart_is_no_certificate():
    for which in (0, 1):
        answers = [real(-1, -2), real(-3)]
        blurred = list(answers)
        blurred[which] = real(*(root.re for root in answers[which]), certified=False)
        answers[which] = answers[which][1:]
        shown, _ = mapped(*answers)
        why = "3 roots exist, 2 were found"
        assert shown.certificate == Certificate("polynomial", 3, 2, why), which
        assert shown.verdict.reason == why, which
        found = mapped(*blurred)[0].certificate
        why = "some roots could not be separated"
        assert (found.certified, found.counted, found.found, found.reason) == (False, 3, 3, why), which


def test_all_of_a_map_is_in_its_data():
    hole = Exclusion(-2.0, 0.0, 0.5, "poles accumulate")
    certificate = Certificate("e", 3, 1, "too many", code="SF505")
    data = PoleZeroMap(
        "x/F", Everything(), real(-1), real(-2), (), certificate, 5, (hole,), unstable=real(4)
    ).to_json_dict()
    assert data["excluded"] == [{"re": -2.0, "im": 0.0, "radius": 0.5, "reason": "poles accumulate"}]
    assert data["hides_more"] is False
    assert data["certificate"] == {
        "engine": "e",
        "counted": 3,
        "found": 1,
        "reason": "too many",
        "budget_exceeded": True,
    }
    shown = [[root["re"] for root in data[key]] for key in ("poles", "zeros", "right_half_plane")]
    assert shown == [["-1.0000"], ["-2.0000"], ["4.0000"]]
    assert data["poles"][0] == {
        "re": "-1.0000",
        "im": "0",
        "radius": "0",
        "multiplicity": 1,
        "frequency_hz": pytest.approx(0.5 / 3.141592653589793),
        "damping_ratio": 1.0,
        "on_imaginary_axis": False,
        "is_real": True,
        "certified": True,
        "boundary": False,
    }
    assert (data["hidden"], data["certified"], data["stability"]["verdict"]) == ([], False, "unknown")


def test_an_exceeded_budget_is_an_error_that_holds_the_map():
    certificate = Certificate("e", 3, 1, "too many", code="SF505")
    shown = PoleZeroMap("x/F", Everything(), (), (), (), certificate)
    with pytest.raises(BudgetError) as failed:
        shown.complete()
    (diagnostic,) = failed.value.diagnostics
    assert (diagnostic.message, diagnostic.code) == ("too many", "SF505")
    assert diagnostic.hint == "the attribute 'found' of this error has what was proved until then"
    assert failed.value.found is shown
