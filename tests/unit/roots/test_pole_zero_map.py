"""Poles, zeros and their certificate."""

import json
from fractions import Fraction

import pytest
from flint import arb

from symflex.budget import Budget
from symflex.errors import BudgetError, Diagnostic
from symflex.roots import Band, Mode, Modes, PolynomialInS, RootProblem, find_pole_zero_map, pole_zero_map
from symflex.roots.pole_zero_map import ON_AXIS, Certificate, Exclusion, PoleZeroMap, judge
from symflex.roots.region import Everything
from symflex.roots.root import Root
from tests.unit.roots.root_problems import problem, with_root_of_two

POLES = problem(0, 0, 9, 0, 1)  # s^2 (s^2 + 9)
ZEROS = problem(4, 0, 1)


def test_json_has_the_keys_of_the_schema_and_survives_a_round_trip():
    data = find_pole_zero_map("x_tip/F", POLES, ZEROS, Band(Fraction(0), Fraction(1)), 5).to_json_dict()
    assert {"schema", "tf", "region", "certified", "poles", "zeros", "hidden"} <= set(data)
    assert (data["schema"], data["tf"], data["certified"]) == ("symflex.roots/1", "x_tip/F", True)
    (zero, *_) = data["zeros"]
    assert {"re", "im", "radius", "multiplicity", "frequency_hz", "damping_ratio"} <= set(zero)
    assert [type(zero[key]) for key in ("re", "im", "radius")] == [str, str, str]
    assert json.loads(json.dumps(data, allow_nan=False)) == data
    # Both members of a pair are listed; the rigid body has no damping ratio.
    assert [(p["im"], p["multiplicity"], p["damping_ratio"]) for p in data["poles"]] == [
        ("0", 2, None),
        ("3.0000", 1, 0.0),
        ("-3.0000", 1, 0.0),
    ]


def test_the_certificate_counts_every_degree_and_a_numerator_without_s_has_no_zeros():
    certificate = find_pole_zero_map("x/F", POLES, ZEROS, Modes(0)).certificate
    assert (certificate.certified, certificate.counted, certificate.found) == (True, 6, 6)
    assert find_pole_zero_map("x/F", POLES, RootProblem(((PolynomialInS.from_integers([7]), 1),))).zeros == ()


def test_hidden_modes_in_the_region_are_reported_with_their_cause():
    hidden = ((problem(25, 0, 1), "unobservable"),)
    found = find_pole_zero_map("x/F", POLES, ZEROS, Modes(1), 3, hidden)
    assert [(h.root.decimal(3).im, h.cause) for h in found.hidden] == [
        ("5.00", "unobservable"),
        ("-5.00", "unobservable"),
    ]
    assert found.certificate.counted == 8
    assert find_pole_zero_map("x/F", POLES, ZEROS, Band(Fraction(2), Fraction(9)), 3, hidden).hidden == ()


def test_a_cluster_makes_the_map_uncertified_and_says_why():
    double = with_root_of_two(lambda root, one: (2 * one, -2 * root, one))
    certificate = find_pole_zero_map("x/F", RootProblem(((double, 1),)), ZEROS).certificate
    assert (certificate.certified, certificate.counted, certificate.found) == (False, 4, 4)
    assert "told apart" in certificate.reason


# ------------------------------------------------------- what is said of roots that a stand-in has found

SPENT = Diagnostic("SF505", "too many steps")
BAND, EDGE = Band(Fraction(0), Fraction(1)), 2 * 3.141592653589793


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


def test_all_found_and_apart_is_certified_and_zeros_right_of_the_axis_make_nothing_unstable():
    shown, _ = mapped(real(-1, 2), real(-3))
    assert shown.certificate == Certificate("polynomial", 3, 3)
    assert (shown.verdict.word, shown.verdict.right) == ("unstable", 1)
    assert mapped(real(-1, -2), real(3))[0].verdict.word == "stable"


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
        why = "some roots could not be told apart; each such group is enclosed as one"
        assert (found.certified, found.counted, found.found, found.reason) == (False, 3, 3, why), which


def test_hidden_factors_have_their_causes_and_count_for_stability():
    shown, _ = mapped(real(-1, -2), real(-3), real(-4), real(5, 6), hidden=(1, 2))
    assert [(float(h.root.re), h.cause) for h in shown.hidden] == [
        (-4, "cause 0"),
        (5, "cause 1"),
        (6, "cause 1"),
    ]
    assert (shown.verdict.right, shown.certificate.counted) == (2, 6)


def test_of_a_band_hidden_modes_right_of_the_axis_are_shown_wherever_they_lie():
    band = Band(Fraction(0), Fraction(1, 5))
    shown, _ = mapped(real(-1, 3), real(-2), real(-1, 7, -8), region=band, hidden=(3,))
    assert [(float(h.root.re), h.cause) for h in shown.hidden] == [(-1, "cause 0"), (7, "cause 0")]
    assert [float(r.re) for r in shown.poles] == [-1]
    assert [float(r.re) for r in shown.unstable] == [3]
    assert [float(r.re) for r in shown.all_poles] == [-1, 3]


def test_digits_are_doubled_until_every_root_has_its_side_and_an_unknown_side_is_on_the_boundary():
    wide, narrow = real((EDGE, 1e-3)), real((EDGE - 0.1, 1e-9))
    shown, finder = mapped(wide, wide, narrow, (), degrees=(1, 0), region=BAND)
    assert finder.digits == [10, 20, 40, 10]
    assert [root.on_boundary for root in shown.poles] == [False]
    shown, finder = mapped(*[wide] * 4, (), degrees=(1, 0), region=BAND)
    assert finder.digits == [10, 20, 40, 80, 10]
    assert [root.on_boundary for root in shown.poles] == [True]
    # What the first search proved outlasts a second one.
    shown, finder = mapped(wide, BudgetError(SPENT, found=()), degrees=(1, 0), region=BAND)
    assert finder.digits == [10, 20]
    assert [root.on_boundary for root in shown.poles] == [True]
    assert shown.certificate.is_exceeded


def test_what_was_proved_until_the_budget_was_spent_is_shown_with_its_code():
    failed = BudgetError(SPENT, found=real(-1))
    shown, finder = mapped(failed, hidden=(1,))
    assert [float(root.re) for root in shown.poles] == [-1]
    assert (shown.zeros, shown.hidden, finder.digits) == ((), (), [10])
    expected = Certificate("polynomial", 4, 1, "too many steps", code="SF505")
    assert shown.certificate == expected
    assert shown.verdict.reason == "too many steps"
    assert mapped(BudgetError(SPENT, found=real(-1)), region=Mode(1))[0].poles == ()
    assert mapped(BudgetError(SPENT))[0].poles == ()
    clock = iter(range(100)).__next__
    with Budget(seconds=0, clock=clock).entered():
        shown, _ = mapped(real(-1, -2))
    assert (shown.poles, shown.certificate.code) == ((), "SF506")


def test_an_exceeded_budget_is_an_error_that_holds_the_map():
    certificate = Certificate("e", 3, 1, "too many", code="SF505")
    shown = PoleZeroMap("x/F", Everything(), (), (), (), certificate)
    with pytest.raises(BudgetError) as failed:
        shown.complete()
    (diagnostic,) = failed.value.diagnostics
    assert (diagnostic.message, diagnostic.code) == ("too many", "SF505")
    assert diagnostic.hint == "the attribute 'found' of this error has what was proved until then"
    assert failed.value.found is shown


def test_all_of_a_map_is_in_its_data():
    hole = Exclusion(-2.0, 0.0, 0.5, "poles accumulate")
    certificate = Certificate("e", 3, 1, "too many", code="SF505")
    data = PoleZeroMap(
        "x/F", Everything(), real(-1), real(-2), (), certificate, 5, (hole,), unstable=real(4)
    ).to_json_dict()
    assert data["excluded"] == [{"re": -2.0, "im": 0.0, "radius": 0.5, "reason": "poles accumulate"}]
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
