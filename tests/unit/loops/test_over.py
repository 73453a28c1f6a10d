"""Stability over any parameter: boundaries from formulas of books, verdicts at random points of charts."""

from fractions import Fraction
from math import acos, asin, atan2, pi, sqrt
from random import Random

import numpy as np
import pytest

from symflex import Model, load, loads
from symflex.errors import ModelError, UsageError
from symflex.loops.boxes import CharacteristicFunction, OpenBox
from symflex.loops.loop import pick_gain
from symflex.loops.over import (
    ABOUT,
    characteristic,
    find_intervals,
    pair_that_crosses,
    seen_pair,
    with_values,
)
from tests.house.repository import ROOT

LAG = Model(
    parameters={"a": 1, "T": 0.1},
    signals={"y": "a/s*exp(-s*T)*(r - y)"},
    inputs={"r": {}},
    outputs={"Y": "y"},
)


RANDOM = {"K": (0.5, 20), "c": (0.05, 1), "w": (0.5, 5), "z": (0.02, 0.8), "p": (0.1, 4)}


GROUND_RESONANCE = """
symflex = 1
parameters = { Omega = "20 rad/s" }
inputs = { F = {} }
outputs = { X = "x" }
[equations]
unknowns = ["x", "y", "a", "b"]
equations = [
  "1100*s^2*x + 1000*s*x + 400000*x + 30*s^2*a = F",
  "1100*s^2*y + 1000*s*y + 400000*y + 30*s^2*b = 0",
  "60*(s^2*a + 2*Omega*s*b - Omega^2*a) + 20*(s*a + Omega*b) + 6000*a + 30*s^2*x = 0",
  "60*(s^2*b - 2*Omega*s*a - Omega^2*b) + 20*(s*b - Omega*a) + 6000*b + 30*s^2*y = 0",
]
"""


def in_boxes(model, name, limits, values=None):
    """Return what halving the values of a parameter finds, whatever it does to the equations."""
    model, ends = with_values(model, values), tuple(map(Fraction, limits))
    function = characteristic(model, (name,), (ends,))
    return find_intervals(function, ends, 15, pick_gain(model.parameters, name), None)


def oscillator(gain: float) -> Model:
    """Return a mass on a spring with a damper, whose force is fed back late: seed of delayed resonators."""
    return Model(
        parameters={"m": "8 kg", "b": "60 N*s/m", "k": "20000 N/m", "K": str(gain), "T": "2 ms"},
        elements={
            "body": {"type": "mass", "at": "x", "m": "m"},
            "wall": {"type": "spring", "between": ["x", "ground"], "k": "k"},
            "loss": {"type": "damper", "between": ["x", "ground"], "b": "b"},
            "act": {"type": "force_source", "at": "x", "f": "u"},
        },
        signals={"u": "K*k*exp(-s*T)*(r - x)"},
        inputs={"r": {"unit": "m"}},
        outputs={"X": "x"},
    )


NEAR = Fraction(1, 10**6)
WIDENED = NEAR + ABOUT * 2 * NEAR


def crossing(den, *radii, around=(Fraction(-1), Fraction(1)), low=1, high=1):
    """Return what a gap about b = 0, with roots next to frequencies, changes of the poles on the right."""
    function = characteristic(
        loads(f"""
            symflex = 1
            parameters.b = {{ value = 0.1, assume = "real" }}
            signals.y = "r/({den})"
            inputs.r = {{}}
            outputs.Y = "y"
            """).resolved,
        ("b",),
        ((Fraction(-1), Fraction(1)),),
    )
    piece = (max(Fraction(0), low - NEAR), high + NEAR)
    gaps = [OpenBox(((-NEAR, NEAR),), r, tuple((piece,) for _ in function.factors)) for r in radii or (9.0,)]
    return pair_that_crosses(function, gaps, around, 128)


def test_a_pair_crosses_in_a_gap_where_all_is_proved_and_nothing_less() -> None:
    """``s^2 + b s + 1`` has its roots to the right exactly for b < 0; each other line lacks one condition."""
    assert crossing("s^2 + b*s + 1") == -2
    assert crossing("s^2 - b*s + 1") == 2
    # The widened gap has to lie inside what has no other root on the axis, at both ends.
    assert crossing("s^2 + b*s + 1", around=(-WIDENED - NEAR / 10**6, WIDENED + NEAR / 10**6)) == -2
    assert crossing("s^2 + b*s + 1", around=(-WIDENED, Fraction(1))) == 0
    assert crossing("s^2 + b*s + 1", around=(Fraction(-1), WIDENED)) == 0
    assert crossing("(s^2 + b*s + 1)^2") == 0  # two pairs cross together
    assert crossing("(s^2 + b*s + 1)*(s^2 - b*s + 1)") == 0  # one each way
    assert crossing("s^4 + b*s^3 + 5*s^2 + 2*b*s + 4", high=2) == 0  # two of one factor, at 1 and 2 rad/s
    assert crossing("s^4 + 2*s^2 + 1 + b*s", high=1 + NEAR) == 0  # two meet at 1, off the middle of the piece
    assert crossing("s + b", low=0, high=0) == 0  # a real pole, not a pair
    assert crossing("s^2 + b*s + 1", 9.0, "how far roots lie is not known") == 0


def test_an_integrator_with_a_delay_is_stable_up_to_half_of_pi() -> None:
    """Hayes 1950: all roots of ``s + a exp(-s T)`` lie on the left exactly if 0 < a T < pi/2."""
    stable = LAG.stability(over="T", limits=(0, 3), a=0.7)
    assert stable.certified
    ((low, high),) = stable.stable
    assert low == 0
    assert abs(high - pi / 2 / 0.7) < 1e-14
    assert abs(stable.boundaries[0].frequencies_hz[0] - 0.7 / (2 * pi)) < 1e-14


def test_a_delayed_oscillator_is_stable_again_for_later_delays() -> None:
    """On the axis ``abs(k - m w^2 + j b w) = K k``, and T is the angle over w, plus whole periods."""
    m, b, k, gain = 8.0, 60.0, 20000.0, 0.2
    middle, off = (
        k / m - b * b / (2 * m * m),
        sqrt(b**4 / (4 * m**4) - b * b * k / m**3 + (gain * k / m) ** 2),
    )
    expected = []
    for omega, change in ((sqrt(middle + off), 2), (sqrt(middle - off), -2)):
        # exp(-j w T) = -(k - m w^2 + j b w)/(K k)
        first = -atan2(-b * omega, -(k - m * omega * omega)) % (2 * pi) / omega
        expected += [(first + n * 2 * pi / omega, change, omega) for n in range(9)]
    expected = sorted(x for x in expected if x[0] < 0.6)
    stable = oscillator(gain).stability(over="T", limits=(0, 0.6))
    assert stable.certified
    assert [each.entering for each in stable.boundaries] == [change for _, change, _ in expected]
    for each, (delay, _, omega) in zip(stable.boundaries, expected, strict=True):
        assert abs(each.gain - delay) < 1e-12
        assert abs(each.frequencies_hz[0] * 2 * pi - omega) < 1e-10


def test_a_mass_above_which_a_servo_is_unstable() -> None:
    """Routh: ``m tau s^3 + (m + b tau) s^2 + b s + K`` is stable for ``m (K tau - b) < b^2 tau``."""
    b, tau, gain = 3.0, 0.5, 10.0
    model = Model(
        parameters={"m": 1, "b": b, "tau": tau, "K": gain},
        signals={"y": "K/(s*(m*s + b)*(1 + tau*s))*(r - y)"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    )
    ((_, high),) = model.stability(over="m", limits=(0.5, 20)).stable
    assert abs(high - b * b * tau / (gain * tau - b)) < 1e-14


def test_a_real_pole_passes_through_infinity_where_the_highest_power_vanishes() -> None:
    """``s (1 - a K) + 1 + K`` has its root at ``(1 + K)/(a K - 1)``; ``s (1 - K) + 1 - K`` keeps it at -1."""
    model = Model(
        parameters={"K": {"value": 0.5, "assume": "real"}, "a": {"value": 0.3, "assume": "real"}},
        signals={"y": "K*(1 - a*s)*(r - y)/(s + 1)"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    )
    stable = model.stability(over="K", limits=(0, 8))
    ((low, high),) = stable.stable
    assert (low, [b.entering for b in stable.boundaries]) == (0, [1])
    assert abs(high - 1 / 0.3) < 1e-14
    kept = model.stability(over="K", limits=(-5, 8), a=-1)
    assert kept.certified
    assert [(float(a), float(b)) for a, b in kept.stable] == [(-5, -1), (-1, 8)]  # K = -1 has no solution
    halved = in_boxes(model.resolved, "K", (-5, 8), {"a": -1})
    assert [(float(i.low.mid()), float(i.high.mid())) for i in halved.stable] == [
        (-5, pytest.approx(-1)),
        (pytest.approx(-1), 8),
    ]
    assert "the highest power of s may vanish, so poles have no bound" in halved.reasons


@pytest.mark.parametrize(
    ("gain", "ends"),
    [
        ("log(1 + K^2)", [(-2, 2)]),
        ("tan(K)", [(-2, atan2(5, 1) - pi), (-pi / 4, atan2(5, 1)), (3 * pi / 4, 3)]),
        ("sqrt(K^2)", [(-2, 0), (0, 2)]),
    ],
)
def test_where_a_function_of_the_parameter_has_no_value_the_rest_is_decided(
    gain: str, ends: list[tuple[float, float]]
) -> None:
    """``s^3 + 2 s^2 + 3 s + 1 + k`` is stable for -1 < k < 5 (Routh)."""
    model = Model(
        parameters={"K": {"value": 1, "assume": "real"}},
        signals={"y": f"({gain})*(r - y)/(s^3 + 2*s^2 + 3*s + 1)"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    )
    stable = model.stability(over="K", limits=(-2, 3 if "tan" in gain else 2))
    assert [(float(a), float(b)) for a, b in stable.stable] == [pytest.approx(e, abs=1e-12) for e in ends]
    assert stable.certified == (gain == "log(1 + K^2)")
    assert stable.is_stable


def test_a_pole_that_stays_on_the_axis_is_marginal_and_boxes_leave_it_open() -> None:
    """``m s^2 + k`` has both poles on the axis for every k."""
    lossless = Model(
        parameters={"m": "1 kg", "k": "4 N/m"},
        elements={
            "body": {"type": "mass", "at": "x", "m": "m"},
            "wall": {"type": "spring", "between": ["x", "ground"], "k": "k"},
        },
        inputs={"F": {"force": "x"}},
        outputs={"X": "x"},
    )
    stable = lossless.stability(over="k")
    assert stable.certified
    assert not stable.stable
    assert [(i["right_half_plane_poles"], i["verdict"]) for i in stable.to_json_dict()["intervals"]] == [
        (0, "marginal")
    ]
    halved = in_boxes(lossless.resolved, "k", (2, 8))
    assert not halved.certified
    assert not halved.is_gain
    assert halved.reasons == ("it could not be decided whether poles meet the axis between 2 and 8",)
    assert not halved.stable


def test_a_parameter_may_be_called_x_as_the_coordinate_is() -> None:
    # 1/(s + 1)^3 is stable up to the gain 8.
    loop = {"y": "exp(x)/(s + 1)^3*(r - y)"}
    values = {"x": {"value": 1, "assume": "real"}}
    model = Model(parameters=values, signals=loop, inputs={"r": {}}, outputs={"Y": "y"})
    found = model.stability(over="x", limits=(-3, 4))
    assert [float(b.gain) for b in found.boundaries] == [pytest.approx(3 * np.log(2), rel=1e-14)]


def test_two_undamped_modes_meet_where_their_coupling_changes_its_sign() -> None:
    """``(w - 2)(w - 3) - (1 - mu)`` with w = -s^2 has a double root where ``1 + 4 (1 - mu) = 0``."""
    flutter = loads(
        """
symflex = 1
parameters = { mu = 0.3 }
inputs = { F = {} }
outputs = { X = "x" }
[equations]
unknowns = ["x", "y"]
equations = ["s^2*x + 2*x + (1 - mu)*y = F", "s^2*y + x + 3*y = 0"]
"""
    )
    found = flutter.stability(over="mu").to_json_dict()
    assert found["certified"]
    assert [(i["right_half_plane_poles"], i["verdict"]) for i in found["intervals"]] == [
        (0, "marginal"),
        (2, "unstable"),
    ]
    (boundary,) = found["boundaries"]
    assert float(boundary["gain"]["value"]) == pytest.approx(1.25, abs=1e-14)
    assert float(boundary["omega"][0]["value"]) == pytest.approx(sqrt(2.5), abs=1e-14)


def test_a_speed_that_enters_squared_has_the_boundaries_of_the_eigenvalues() -> None:
    """Ground resonance; eigenvalues of the state matrix by numpy, and scipy's brentq on their real part."""
    hub = loads(GROUND_RESONANCE)
    stable = hub.stability(over="Omega", limits=(0, 200))
    assert stable.certified
    assert [b.gain for b in stable.boundaries] == pytest.approx(
        [26.24594140045257, 33.47578766093715], rel=1e-12
    )
    assert [b.entering for b in stable.boundaries] == [2, -2]


@pytest.mark.slow
def test_what_boxes_proved_stands_where_gains_are_counted_up_to_a_frequency_only() -> None:
    """``s (1 + K exp(-s)) + 1`` has infinitely many poles on the right for K > 1 (Bellman & Cooke 1963)."""
    neutral = Model(
        parameters={"K": 0.5},
        signals={"y": "(r - (1 + K*exp(-s)*s)*y)/s"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    )
    stable = neutral.stability(over="K", limits=(0, 3))
    assert not stable.certified
    assert stable.is_stable
    ((interval,),) = ([i for i in stable.to_json_dict()["intervals"] if i["stable"]],)
    assert float(interval["high"]["value"]) - float(interval["high"]["radius"]) <= 1


def test_what_enters_rationally_is_answered_alike_as_a_gain_and_as_a_parameter() -> None:
    for law in ("K", "K^2 + K", "1/K", "K/(1 + K)"):
        model = Model(
            parameters={"K": 1},
            signals={"y": f"({law})*(2 - 0.3*s)/(s^3 + 2*s^2 + 3*s + 1)*(r - y)"},
            inputs={"r": {}},
            outputs={"Y": "y"},
        )
        gain, over = (
            model.stability(**{name: "K"}, limits=(0.1, 9)).to_json_dict() for name in ("gain", "over")
        )
        assert over["certified"]
        for key in ("intervals", "boundaries", "stable", "verdict", "range", "gain_margins"):
            assert over[key] == gain[key], (law, key)
        assert over["phase_margins"] == []  # a parameter closes no loop


def test_a_gain_in_the_value_of_a_source_is_examined_as_one_in_a_signal() -> None:
    text = """
        symflex = 1
        parameters = { m = "8 kg", b = "60 N*s/m", k = "20 kN/m", g = "7 N*s/m" }
        inputs = { F = { force = "x" } }
        outputs = { X = "x" }
        [elements]
        body = { type = "mass", at = "x", m = "m" }
        wall = { type = "spring", between = ["x", "ground"], k = "k" }
        loss = { type = "damper", between = ["x", "ground"], b = "b" }
        act = { type = "force_source", at = "x", f = "g*s*x" }
        """
    over = loads(text).stability(over="g").to_json_dict()
    assert float(over["boundaries"][0]["gain"]["value"]) == 60  # g = b, more than twice the declared value


def test_a_chart_says_at_every_point_what_holds_there() -> None:
    chart = LAG.stability(over=("a", "T"), ranges={"a": (0, 4), "T": (0, 3)}, resolve=0.02)
    assert chart.certified
    assert chart.decided > 0.98
    random, open_points = Random(5), 0
    for _ in range(200):
        a, late = random.uniform(0, 4), random.uniform(0, 3)
        said = chart.at(a, late)
        open_points += said == "undecided"
        # Poles cross where a = w and w T = pi/2 + 2 pi n.
        pairs = int((a * late - pi / 2) // (2 * pi)) + 1 if a * late > pi / 2 else 0
        assert said in ("undecided", f"unstable by {2 * pairs}" if pairs else "stable")
    assert open_points <= 10
    assert chart.at(5, 1) == "undecided"


def test_boundaries_of_a_chart_pass_through_roots_on_the_axis() -> None:
    chart = LAG.stability(over=("a", "T"), ranges={"a": (0, 4), "T": (0, 3)}, resolve=0.02)
    assert len(chart.boundaries) == 2
    for curve, turn in zip(sorted(chart.boundaries, key=lambda c: c[0][0] * c[0][1]), (0, 1), strict=True):
        assert all(abs(a * late - pi / 2 - 2 * pi * turn) < 1e-8 for a, late, _ in curve)
        assert all(abs(omega - a) < 1e-8 for a, _, omega in curve)
        assert {4.0, 3.0} <= {x for point in (curve[0], curve[-1]) for x in point}  # ends of the ranges


def test_a_real_pole_passes_the_axis_on_a_boundary_too() -> None:
    """``s^2 + (b - 1) s + K - 2`` has a root at 0 where K = 2, and a pair on the axis where b = 1."""
    model = Model(
        parameters={"K": 3, "b": 2},
        signals={"y": "(2 - K)/(s^2 + (b - 1)*s)*y + r"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    )
    chart = model.stability(over=("K", "b"), ranges={"K": (0, 4), "b": (0, 2)})
    assert chart.at(3, 1.5) == "stable"
    assert chart.at(1, 1.5) == "unstable by 1"
    assert chart.at(3, 0.5) == "unstable by 2"
    real, pair = sorted(chart.boundaries, key=lambda curve: max(omega for _, _, omega in curve))
    assert all(abs(gain - 2) < 1e-8 and omega == 0 for gain, _, omega in real)
    assert all(abs(b - 1) < 1e-8 and abs(gain - 2 - omega**2) < 1e-7 for gain, b, omega in pair)


@pytest.mark.parametrize(
    ("plant", "over", "printed", "digits"),
    [
        # MathWorks, "Assessing Gain and Phase Margins": stable for 0 < k < 2.7, exactly 96/35 by Routh.
        ("(0.5*s + 1.3)/(s^3 + 1.2*s^2 + 1.6*s)", "k", 2.7, 1),
        # MathWorks, allmargin: GainMargin 3.6000, DelayMargin 0.2847.
        ("25/(s^3 + 10*s^2 + 10*s + 10)", "k", 3.6, 4),
        ("25/(s^3 + 10*s^2 + 10*s + 10)", "T", 0.2847, 4),
    ],
)
def test_limits_of_one_parameter_and_of_charts_are_those_that_pages_print(
    plant: str, over: str, printed: float, digits: int
) -> None:
    model = Model(
        parameters={"k": 1, "T": {"value": 0, "assume": "nonnegative"}},
        signals={"y": f"k*exp(-s*T)*{plant}*(r - y)"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    )
    ((_, limit),) = model.stability(over=over, limits=(0, 4 if over == "k" else 1)).stable
    assert round(limit, digits) == printed
    chart = model.stability(over=("k", "T"), ranges={"k": (0, 4), "T": (0, 1)})
    goal = (1, limit) if over == "T" else (limit, 0)
    assert min(abs(k - goal[0]) + abs(t - goal[1]) for c in chart.boundaries for k, t, _ in c) < 0.05


def test_a_chart_across_a_pole_at_0_is_decided() -> None:
    # K = 1 takes the pole (1 - K)/a through 0, where every shorter piece of the axis holds it as well.
    plant = Model(
        parameters={"K": 3, "a": 1},
        signals={"y": "K/(a*s - 1)*(r - y)"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    )
    chart = plant.stability(over=("K", "a"), ranges={"K": (0.5, 8), "a": (0.3, 3)})
    assert chart.decided >= 0.99
    assert [chart.at(k, 1) for k in (0.7, 1.5, 7)] == ["unstable by 1", "stable", "stable"]


def test_the_largest_box_about_the_declared_values_ends_at_the_boundary() -> None:
    chart = LAG.stability(over=("a", "T"), ranges={"a": (0, 4), "T": (0, 3)})
    box = chart.largest_box()
    assert box is not None
    (_, a), (_, late) = box
    assert 0.9 * pi / 2 < a * late < pi / 2


def test_the_document_of_a_chart_holds_every_box() -> None:
    chart = LAG.stability(over=("a", "T"), ranges={"a": (0, 4), "T": (0, 3)}, resolve=0.1)
    document = chart.to_json_dict()
    assert document["schema"] == "symflex.stability_chart/1"
    area = sum(
        (high[0] - low[0]) * (high[1] - low[1])
        for name in ("boxes", "undecided_boxes")
        for low, high in ((box["low"], box["high"]) for box in document[name])
    )
    assert abs(area - 12) < 1e-9
    assert document["undecided"] <= 0.1
    assert document["at_nominal"] == "stable"


def test_the_ends_do_not_belong_to_the_range() -> None:
    """Without its mass the oscillator is of first order, with one that is small it is stable."""
    stable = oscillator(0.1).stability(over="m", limits=(0, 5))
    assert stable.certified
    ((low, high),) = stable.stable
    assert 0 <= low < 1e-15
    assert high == 5


@pytest.mark.parametrize(
    ("over", "low", "code"),
    [
        (("a", "b"), 0, "SF902"),
        (("a", "a"), 0, "SF902"),
        (("a", "T"), 3, "SF804"),
        (("a", "T"), -1, "SF804"),
        (("T", "K"), 0, "SF902"),
    ],
)
def test_what_is_no_chart_is_refused(over: tuple[str, str], low: float, code: str) -> None:
    with pytest.raises(UsageError) as error:
        LAG.stability(over=over, ranges={"a": (low, 1)})
    assert error.value.diagnostics[0].code == code


@pytest.mark.parametrize(
    ("asked", "said", "hint"),
    [
        (
            {"over": ("a", "T"), "up_to_hz": 2},
            "--up-to does not apply to this chart: all poles are counted",
            "leave it out",
        ),
        (
            {"over": "a", "limits": (-1, 1)},
            "'a' is assumed not to be negative, and its range is",
            'begin at 0, or declare assume = "real"',
        ),
        (
            {"over": "a", "limits": (3, 1)},
            "'a' needs a finite range from a smaller to a larger value",
            "give one: --range a LO HI",
        ),
        ({"over": "a", "ranges": {"T": (0, 1)}}, "a range of 'T', which is not asked for with --over", None),
    ],
)
def test_a_refusal_says_what_to_ask_for_instead(asked, said, hint) -> None:
    with pytest.raises(UsageError) as error:
        LAG.stability(**asked)
    (problem,) = error.value.diagnostics
    assert (problem.message, problem.hint) == (said, hint)


def test_members_that_taper_are_refused_where_the_parameter_is_declared() -> None:
    wedge = load(ROOT / "derivations/tapers/wedge.toml")
    with pytest.raises(ModelError, match="not available with members that taper") as error:
        wedge.stability(over="EI", limits=(1, 2))
    (problem,) = error.value.diagnostics
    (declared,) = (p.span for p in wedge.resolved.parameters if p.name == "EI")
    assert problem.span == declared
    assert problem.hint.endswith("symflex sweep FILE --over EI=FROM:TO:lin:20")


def test_an_angle_that_is_a_gain_has_margins() -> None:
    # 1/(s + 1)^3 is stable up to a gain of 8, with poles at sqrt(3) rad/s; 30 degrees are pi/6.
    model = Model(
        parameters={"psi": "30 deg"},
        signals={"y": "psi/(s + 1)^3*(r - y)"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    )
    (margin,) = model.stability(over="psi", limits=("0 deg", "900 deg")).to_json_dict()["gain_margins"]
    assert float(margin["factor"]["value"]) == pytest.approx(8 / (pi / 6))
    assert margin["frequencies_hz"] == [pytest.approx(sqrt(3) / (2 * pi))]


def test_a_range_that_nobody_gives_is_about_the_value() -> None:
    model = oscillator(0.5)
    # A gain in signals may vanish, and up to ten times its value; a part has half its value to twice.
    for name, limits in (("K", ["0", "5"]), ("m", ["4", "16"])):
        assert model.stability(over=name).to_json_dict()["range"] == limits


def test_poles_are_those_of_an_output_without_a_filter_if_there_is_one() -> None:
    plain = {"body": {"type": "mass", "at": "x", "m": "m"}}
    for outputs, seen in (({"X": "x/(T*s + 1)"}, "X"), ({"X": "x/(T*s + 1)", "V": "2*x"}, "V")):
        model = Model(
            parameters={"m": 2, "T": 1}, elements=plain, inputs={"F": {"force": "x"}}, outputs=outputs
        )
        assert seen_pair(model.resolved) == (seen, "F")


def test_a_parameter_that_moves_no_pole_is_refused() -> None:
    model = Model(
        parameters={"g": 2, "T": 0.1},
        signals={"y": "g*exp(-s*T)/(s + 1)*r"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    )
    with pytest.raises(ModelError, match="no pole of the model depends on 'g'"):
        model.stability(over="g")


@pytest.mark.slow
def test_a_beam_with_a_filtered_controller_agrees_with_its_stable_gains() -> None:
    """Boundaries of a gain by halving against those that :func:`find_stable_gains` finds along the axis."""
    model = Model(
        parameters={
            "E": "70 GPa", "I": "2e-10 m^4", "rho": "2700 kg/m^3", "A": "6e-5 m^2", "l": "0.8 m",
            "J": "0.002 kg*m^2", "m": "0.1 kg", "tau": "2e-4 s", "T_f": "2 ms", "T": "1 ms",
            "k_p": "20 N*m/rad", "k_d": "1 N*m*s/rad",
        },
        elements={
            "bearing": {"type": "pin", "at": "hub"},
            "arm": {
                "type": "beam", "between": ["hub", "tip"],
                "E": "E*(1 + tau*s)", "I": "I", "rho": "rho", "A": "A", "l": "l",
            },
            "rotor": {"type": "inertia", "at": "hub.theta", "J": "J"},
            "load": {"type": "mass", "at": "tip", "m": "m"},
            "drive": {"type": "torque_source", "at": "hub.theta", "tau": "u"},
        },
        signals={"u": "(k_p + k_d*s/(1 + T_f*s))*exp(-s*T)*(r - hub.theta)"},
        inputs={"r": {"unit": "rad"}},
        outputs={"phi": "hub.theta"},
    )  # fmt: skip
    along = model.stability("k_p", (0, 2000)).boundaries
    halved = model.stability(over="k_p", limits=(0, 2000)).boundaries
    assert len(along) == len(halved) == 1
    assert abs(along[0].gain - halved[0].gain) < along[0].radius + halved[0].radius
    assert along[0].entering == halved[0].entering == 2


@pytest.mark.slow
def test_a_chart_over_the_length_of_a_beam_agrees_with_gains_at_fixed_lengths() -> None:
    """Limits by :func:`find_stable_gains` along the axis, a length at a time."""
    model = load(ROOT / "derivations/eppinger1988/loops/sliding_free_beam_force.toml")
    chart = model.stability(over=("K", "l"), ranges={"K": (0, 6), "l": (0.8, 1.6)})
    assert chart.certified
    assert chart.decided > 0.98
    for length in (0.83, 1.01, 1.19, 1.37, 1.55):
        (limit,) = (float(b.gain) for b in model.stability("K", (0, 6), l=length).boundaries)
        assert chart.at(0.95 * limit, length) == "stable"
        assert chart.at(1.05 * limit, length) == "unstable by 2"


def test_a_kernel_alone_is_a_factor_that_may_vanish() -> None:
    """A clamped rod has the poles of cosh(gamma l), which no other factor has."""
    rod = {"type": "rod", "between": ["ground", "x"], "E": "E*(1 + tau*s)", "A": "1", "rho": "1", "l": "1"}
    model = Model(
        parameters={"E": 4, "tau": "1e-3 s"},
        elements={"rod": rod},
        inputs={"F": {"force": "x"}},
        outputs={"X": "x"},
    )
    (tf,) = model.transfer_functions()
    function = CharacteristicFunction.of(model.resolved, tf.exact, ("tau",))
    about_pi = ((Fraction(3), Fraction(33, 10)),)  # 2 pi/2: a wave has the speed 2, and a quarter is held
    box = OpenBox(((Fraction(0), Fraction(0)),), 100.0, tuple(about_pi for _ in function.factors))
    assert any(function.narrowed(box).pieces)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_charts_of_random_loops_say_what_numeric_roots_say(seed: int) -> None:
    random = Random(seed)
    values = {n: random.uniform(*ends) for n, ends in RANDOM.items()}
    over = random.sample([*RANDOM], 2)
    gain = random.choice(["K", "K^2", "K*(1 + c*s)", "K*(1 - c*s)"])
    if "c" in over and "c" not in gain:
        gain = "K*(1 - c*s)"
    model = Model(
        parameters={n: repr(x) for n, x in values.items()},
        signals={"y": f"{gain}/((s^2 + 2*z*w*s + w^2)*(s + p))*(r - y)"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    )
    ranges = {n: (values[n] / 3, 2 * values[n]) for n in over}
    chart = model.stability(over=(over[0], over[1]), ranges=ranges)
    assert chart.certified
    open_points = 0
    for _ in range(100):
        at = values | {n: random.uniform(*ranges[n]) for n in over}
        said = chart.at(*(at[n] for n in over))
        k, c, w, z, p = (at[n] for n in ("K", "c", "w", "z", "p"))
        steady = k * k if gain == "K^2" else k
        slope = {"K*(1 + c*s)": k * c, "K*(1 - c*s)": -k * c}.get(gain, 0.0)
        open_loop = np.polymul([1, 2 * z * w, w * w], [1, p])
        right = int((np.roots(np.polyadd(open_loop, [slope, steady])).real > 0).sum())
        open_points += said == "undecided"
        assert said in ("undecided", f"unstable by {right}" if right else "stable")
    assert open_points <= 5


def test_a_chart_over_poles_without_end_says_where_they_grow() -> None:
    # v = K exp(-s T) v + d: exp(s T) = K, Re s = ln(K)/T: the model is stable for K < 1 and for no other K.
    text = """symflex = 1
parameters = { K = 1, T = "0.5 s", a = "1 s" }
signals = { y = "(r - y)/(s*a)", v = "K*exp(-s*T)*v + d" }
inputs = { r = {}, d = {} }
outputs = { Y = "y", V = "v" }
"""
    chart = loads(text).stability(over=("K", "T"), ranges={"K": (0.5, 2.5), "T": (0.1, 1)}, resolve=0.2)
    assert chart.decided >= 0.8
    for k, late in ((0.6, 0.5), (0.6, 0.9), (1.6, 0.2), (2.2, 0.5), (2.4, 0.9)):
        assert chart.at(k, late) == ("stable" if k < 1 else "unstable"), (k, late)


def test_an_angle_in_degrees_is_answered_in_degrees():
    model = loads(
        """symflex = 1
        parameters = { m = "2 kg", k = "100 N/m", K = "60 N/m", b = "3 N*s/m", psi = "30 deg" }
        inputs = { F = { unit = "N" } }
        outputs = { X = "x" }
        [equations]
        unknowns = ["x", "y"]
        equations = [
          "m*s^2*x + b*s*x + k*x - K*sin(psi)*y = F",
          "m*s^2*y + b*s*y + k*y + K*cos(psi)*x = 0",
        ]
        """
    )
    found = model.stability(over="psi", limits=("0 deg", "90 deg"))
    # By hand: m s^2 + b s + k = +-j K sqrt(sin cos), on the axis where b w = K sqrt(sin cos) and w^2 = k/m.
    angle = asin(2 * (3 * sqrt(100 / 2) / 60) ** 2) / 2
    assert [float(b.gain) for b in found.boundaries] == pytest.approx([angle, pi / 2 - angle], rel=1e-13)
    lines = str(found).splitlines()
    assert lines[0].startswith("psi [deg]   certified")
    assert lines[1].split("examined: ")[1] == "0 < psi < 90"
    assert f"0 < psi < {angle * 180 / pi:.12f}"[:20] in str(found)
    assert found.verdict.word == "unstable"


@pytest.mark.slow  # 20 s
def test_a_frame_member_stands_at_any_angle():
    model = loads(
        """symflex = 1
        [parameters]
        psi = "45 deg"
        K = "1200 N"
        [elements]
        up = { type = "spring", between = ["hub.y", "ground"], k = "2 kN/m" }
        loss = { type = "damper", between = ["hub.y", "ground"], b = "20 N*s/m" }
        across = { type = "spring", between = ["hub.x", "ground"], k = "5 MN/m" }
        drag = { type = "damper", between = ["hub.x", "ground"], b = "200 N*s/m" }
        joint = { type = "torsion_spring", between = ["hub.theta", "ground"], k = "400 N*m/rad" }
        oil = { type = "rotary_damper", between = ["hub.theta", "ground"], b = "2 N*m*s/rad" }
        act = { type = "torque_source", at = "hub.theta", tau = "K*tip.y" }
        [elements.arm]
        type = "frame"
        between = ["hub", "tip"]
        E = "69 GPa"
        I = "2000 mm^4"
        A = "150 mm^2"
        rho = "2700 kg/m^3"
        l = "0.5 m"
        angle = "psi"
        eta = "50 us"
        [inputs]
        F = { force = "tip.y" }
        [outputs]
        Y = "tip.y"
        """
    )
    found = model.stability(over="psi", limits=("45 deg", "50 deg"))
    # At rest nothing bends the arm: kt theta = K l cos(psi) theta, at which the joint gives way.
    assert [float(b.gain) for b in found.boundaries] == pytest.approx([acos(400 / (1200 * 0.5))], rel=1e-12)
    assert [b.entering for b in found.boundaries] == [-1]
    assert found.certified


@pytest.mark.slow
def test_where_nothing_is_decided_a_stable_range_ends_where_it_is_proved() -> None:
    # 1 + K s exp(-s T)/(s + 1): from K = 1 on the delayed term outweighs s (Bellman and Cooke 1963).
    signals = {"y": "K*s*exp(-0.5*s)/(s + 1)*(r - y)"}
    model = Model(parameters={"K": 0.3}, signals=signals, inputs={"r": {}}, outputs={"Y": "y"})
    found = model.stability(over="K", limits=(0, 3))
    (stable,) = found.proved.intervals
    assert stable.poles.is_stable and 0.9 < float(stable.high.upper()) <= 1
