"""Every parameter at once: proofs over boxes against sampled combinations and conditions of books."""

import json
from math import pi
from random import Random

import numpy as np
import pytest

from symflex import Model
from symflex.cli import run
from symflex.errors import ModelError, UsageError
from tests.unit.loops.test_over import LAG, oscillator

SERVO = {"m": 1, "b": 3, "tau": 0.5, "K": 10}


def servo(**given: object) -> Model:
    """Return a servo that Routh finds stable for ``m (K tau - b) < b^2 tau``."""
    return Model(
        parameters={**SERVO, **given},
        signals={"y": "K/(s*(m*s + b)*(1 + tau*s))*(r - y)"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    )


def corner(share: float) -> float:
    """Return ``b^2 tau - m (K tau - b)`` where it is smallest in the box: it is monotonic in K, b and m."""
    b, m, gain = 3 * (1 - share), 1 + share, 10 * (1 + share)
    return min(b * b * tau - m * (gain * tau - b) for tau in (0.5 * (1 - share), 0.5 * (1 + share)))


def test_a_servo_is_stable_for_every_combination_up_to_the_share_that_routh_gives() -> None:
    low, high = 0.0, 0.5
    while high - low > 1e-3:
        middle = (low + high) / 2
        low, high = (middle, high) if corner(middle) > 0 else (low, middle)
    assert servo().stability(spread=f"{100 * low - 0.3} %").word == "stable"
    unstable = servo().stability(spread=high + 0.003)
    assert unstable.word == "unstable"
    m, b, tau, gain = map(float, unstable.combination)
    roots = np.roots([m * tau, m + b * tau, b, gain])
    assert unstable.unstable == sum(roots.real > 0) == 2


def test_a_lag_with_delay_is_stable_while_the_largest_product_is_below_half_of_pi() -> None:
    """Hayes 1950: ``s + a exp(-s T)`` for a T < pi/2; here a T is at most 0.7 (1 + x)^2."""
    most = (pi / 2 / 0.7) ** 0.5 - 1
    assert LAG.stability(spread=most - 1e-3, a=0.7, T=1).word == "stable"
    assert LAG.stability(spread=most + 1e-3, a=0.7, T=1).word == "unstable"


def test_only_declared_spreads_count_where_no_share_is_given() -> None:
    model = servo(K={"value": 10, "spread": "60 %"}, tau={"value": 0.5, "spread": 0.01})
    found = model.stability(spread="")
    assert set(found.names) == {"K", "tau"}
    assert (found.word, found.to_json_dict()["spread"]["K"]) == ("unstable", [4, 16])
    assert float(found.combination[found.names.index("K")]) == 16


def test_a_small_damping_is_seen_beside_a_stiffness_that_is_spread() -> None:
    """A passive oscillator with 0.1 % of damping has no right-half-plane pole for any positive values."""
    found = oscillator(0.001).stability(spread="20 %", b=0.8)
    assert (found.word, found.certified) == ("stable", True)


def test_a_model_that_is_not_stable_as_it_stands_needs_no_box() -> None:
    assert servo().stability(spread="1 %", K=40).unstable == 2
    lossless = Model(parameters={"k": 4}, inputs={"u": {}}, outputs={"y": "u/(s^2 + k)"})
    assert lossless.stability(spread="1 %").word == "marginal"


def test_what_is_not_decided_names_the_box_that_resists(monkeypatch) -> None:
    monkeypatch.setattr("symflex.loops.spread._pushed", lambda *_: None)
    monkeypatch.setattr("symflex.loops.spread.MOST_BOXES", 20)
    found = servo().stability(spread="25 %")
    document = found.to_json_dict()
    assert (found.word, found.certified, document["combination"]) == ("undecided", False, None)
    part, whole = document["box"], document["spread"]
    assert all(whole[n][0] <= part[n][0] < part[n][1] <= whole[n][1] for n in SERVO)
    assert "undecided" in str(found)


def test_random_loops_are_judged_as_their_roots_are() -> None:
    """Third-order loops whose coefficients are products; numpy finds the roots of 200 combinations each."""
    random = Random(7)
    words = set()
    for _ in range(12):
        p = {n: round(random.uniform(0.3, 3), 2) for n in ("a", "b", "c", "d", "K")}
        share = random.choice((0.02, 0.1, 0.3))
        model = Model(
            parameters=p,
            signals={"y": "K*(s + d)/((a*s + 1)*(s^2 + b*s + c))*(r - y)"},
            inputs={"r": {}},
            outputs={"Y": "y"},
        )
        found = model.stability(spread=share)
        words.add(found.word)

        def right(a: float, b: float, c: float, d: float, gain: float) -> int:
            return sum(np.roots([a, a * b + 1, a * c + b + gain, c + gain * d]).real > 0)

        sampled = [
            right(*(x * (1 + share * random.choice((-1, 1, random.uniform(-1, 1)))) for x in p.values()))
            for _ in range(200)
        ]
        if found.word == "stable":
            assert not any(sampled), (p, share)
        else:
            assert found.word == "unstable", (p, share)
            point = dict(zip(found.names, map(float, found.combination), strict=True))
            assert right(*({**p, **point}.values())) == found.unstable > 0
    assert words == {"stable", "unstable"}


def test_the_command_prints_a_combination_and_refuses_what_does_not_fit(tmp_path, capsys) -> None:
    path = tmp_path / "servo.toml"
    path.write_text(servo().to_toml(), encoding="utf-8")
    assert run(["stability", str(path), "--spread", "40%"]) == 0
    assert "certified: unstable" in capsys.readouterr().out
    assert run(["stability", str(path), "--spread", "5%", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["verdict"] == "stable"
    for more in (["--spread"], ["--spread", "100%"], ["--spread", "1%", "--gain", "K"]):
        assert run(["stability", str(path), *more]) == 2, more


def test_a_spread_that_moves_no_pole_is_refused() -> None:
    model = Model(parameters={"g": 2}, inputs={"u": {}}, outputs={"y": "g*u/(s + 1)"})
    with pytest.raises(ModelError, match="no pole of the model depends"):
        model.stability(spread=0.1)
    with pytest.raises(UsageError, match="--spread takes no"):
        servo().stability("K", spread=0.1)


def cantilever(**bending: object) -> Model:
    """Return a beam that loses energy in its material and at its tip, clamped unless it is said to slide."""
    numbers = {"E": 2e11, "I": 4e-9, "rho": 7850, "A": 4.8e-4, "l": 1, "eta": 1e-5, "b": 2}
    support = {"type": "slider" if bending else "fixed", "at": "p"}
    return Model(
        parameters=numbers,
        elements={
            "arm": {"type": "beam", "between": ["p", "q"], **{n: n for n in numbers if n != "b"}},
            "wall": support,
            "dash": {"type": "damper", "between": ["q", "ground"], "b": "b"},
        },
        inputs={"F": {"force": "q"}},
        outputs={"X": "q"},
    )


def test_what_loses_energy_wherever_it_moves_is_stable_for_all_values_of_seven_parameters() -> None:
    found = cantilever().stability(spread="60 %")
    assert found.word == "stable" and found.certified
    assert found.boxes < 100  # those on which it is looked at at rest


def test_a_beam_that_can_slide_away_is_not_stable_though_nothing_supplies_energy() -> None:
    assert cantilever(slides=True).stability(spread="60 %").word == "marginal"


def test_a_mode_that_rests_on_a_damper_for_some_values_keeps_a_machine_from_being_stable() -> None:
    # Two masses on springs on a damped one: at k_1/m_1 = k_2/m_2 one mode leaves it at rest.
    model = Model(
        parameters={"m_1": 1.2, "k_1": 1, "m_2": 1, "k_2": 1},
        elements={
            "one": {"type": "mass", "at": "x", "m": "m_1"},
            "other": {"type": "mass", "at": "y", "m": "m_2"},
            "table": {"type": "mass", "at": "z", "m": 1},
            "left": {"type": "spring", "between": ["x", "z"], "k": "k_1"},
            "right": {"type": "spring", "between": ["y", "z"], "k": "k_2"},
            "foot": {"type": "spring", "between": ["z", "ground"], "k": 1},
            "pot": {"type": "damper", "between": ["z", "ground"], "b": 1},
        },
        inputs={"F": {"force": "x"}},
        outputs={"X": "x"},
    )
    assert model.stability(spread="1 %").word == "stable"
    found = model.stability(spread="60 %", budget=0.5)
    assert found.word == "stable or marginal" and found.certified  # as nothing supplies energy
