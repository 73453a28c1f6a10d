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
        clouds = root_clouds(model, pipeline.roots(bound), share, pair)
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
    (cloud,) = root_clouds(model, pipeline.roots(bound), "10 %", pair)
    assert (cloud.kind, cloud.count) == ("pole", 2)
    assert cloud.sides[0] <= -1.21
    assert cloud.sides[1] >= -0.9
