"""Rectangles of poles and zeros for every combination, against roots that numpy finds."""

from random import Random

import numpy as np

from symflex import Model, pipeline
from symflex.loops.clouds import root_clouds


def test_rectangles_hold_the_roots_of_random_combinations() -> None:
    p = {"a": 0.3, "b": 0.8, "c": 40.0, "d": 5.0, "K": 6.0}
    model = Model(
        parameters=p,
        signals={"y": "K*(s + d)/((a*s + 1)*(s^2 + b*s + c))*(r - y)"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    ).resolved
    pair = model.transfer_functions[0]
    (bound,) = pipeline.derive_for_roots(model, [pair])
    random = Random(3)
    for share in (0.02, 0.1):
        clouds = root_clouds(bound, pipeline.roots(bound), share, model)
        assert [each.kind for each in clouds] == ["pole", "pole", "zero"]
        assert all(each.count == 1 for each in clouds)
        for _ in range(200):
            a, b, c, d, gain = (
                x * (1 + share * random.choice((-1, 1, random.uniform(-1, 1)))) for x in p.values()
            )
            roots = {"pole": np.roots([a, a * b + 1, a * c + b + gain, c + gain * d]), "zero": np.array([-d])}
            for each in clouds:
                left, right, low, high = each.sides
                own = [s for s in roots[each.kind] if left <= s.real <= right and low <= s.imag <= high]
                assert len(own) == 1
                (least, most), (ratio, other) = each.ranges
                assert least <= abs(own[0]) <= most
                assert ratio <= -own[0].real / abs(own[0]) <= other


def test_rectangles_that_overlap_are_one_with_the_sum_of_their_roots() -> None:
    model = Model(
        parameters={"a": 1, "b": 1.1}, inputs={"u": {}}, outputs={"y": "u/((s + a)*(s + b))"}
    ).resolved
    pair = model.transfer_functions[0]
    (bound,) = pipeline.derive_for_roots(model, [pair])
    (cloud,) = root_clouds(bound, pipeline.roots(bound), "10 %", model)
    assert (cloud.kind, cloud.count) == ("pole", 2)
    assert cloud.sides[0] <= -1.21
    assert cloud.sides[1] >= -0.9


def test_a_pole_zero_plot_shades_what_is_proved_and_dashes_what_is_not() -> None:
    # (s + z)/(s^2 + 2 s + k), k = 200 in place of 100: poles -1 +- j sqrt(k - 1).
    model = Model(parameters={"k": 100, "z": 3}, inputs={"u": {}}, outputs={"y": "u*(s + z)/(s^2 + 2*s + k)"})
    bound = model.transfer_function("y", "u").bind(k=200)
    pole, zero = bound.root_clouds("10 %")
    assert pole.sides[2] <= 179**0.5 < 219**0.5 <= pole.sides[3]
    assert zero.sides[0] <= -3.3 < -2.7 <= zero.sides[1]
    (axes,) = bound.pole_zero_plot(spread="10 %").axes
    drawn = [(*box.get_xy(), box.get_width(), box.get_height()) for box in axes.patches]
    left, right, low, high = pole.sides
    assert (left, low, right - left, high - low) in drawn
    assert (left, -high, right - left, high - low) in drawn
    assert len(drawn) == 3
    assert [box.get_fill() for box in axes.patches] == [True] * 3
    assert axes.get_ylim()[1] > high
    text = {"y": "u/((m*s^2 + k)*(m*s^2 + 2*k) - k^2)"}
    undamped = Model(parameters={"m": 2, "k": 4}, inputs={"u": {}}, outputs=text)
    (axes,) = undamped.transfer_function("y", "u").bind().pole_zero_plot(spread=0.9).axes
    assert not any(box.get_fill() for box in axes.patches)
    assert axes.patches
    assert not bound.pole_zero_plot().axes[0].patches
