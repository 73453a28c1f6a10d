"""Notes and arrows of pole-zero panels keep clear of the roots."""

import pytest

from symflex import pipeline
from symflex.figures import draw
from symflex.figures.s_plane import Panel, View

SQUARE = View((-10.0, 10.0), (-10.0, 10.0), frozenset())


def panel(*roots):
    return Panel(SQUARE, 1.0, 1.0, tuple(map(complex, roots)))


def test_a_note_goes_where_fewest_roots_are():
    boxes = [(2.0, 2.0, 30.0, 30.0), (40.0, 40.0, 70.0, 70.0)]
    assert panel(-8 - 8j).clearest(boxes) == 1
    assert panel(8 + 8j).clearest(boxes) == 0
    assert panel().clearest(boxes) == 0


def test_an_arrow_ends_before_a_root_on_its_way():
    # 72 points are 20 rad/s: 2 rad/s are 7.2 points
    assert panel(7).free_length(10 + 0j, 7.2) == 7.2
    shortened = panel(8.5).free_length(10 + 0j, 7.2)
    assert 0 < shortened < 5.4
    # A root off the ray is none on the way.
    assert panel(8.5 + 3j).free_length(10 + 0j, 7.2) == 7.2


@pytest.mark.parametrize(
    ("path", "figure"),
    [("eppinger1988/sliding_free_beam", "fig11"), ("eppinger1988/lumped_bending_beam", "fig13")],
)
def test_colocated_and_noncolocated_arrays_share_their_scale_and_arrows_meet_no_root(path, figure):
    model = pipeline.load(f"derivations/{path}.toml")
    (found,) = (f for f in model.figures if f.name == figure)
    bounds = pipeline.derive_bound(model, found.of)
    drawn = draw("poles_zeros", bounds)
    left, right = drawn.axes
    assert left.get_xlim() == right.get_xlim()
    assert left.get_ylim() == right.get_ylim()
    for axes in drawn.axes:
        roots = [
            p for line in axes.lines if line.get_marker() in "xo" for p in zip(*line.get_data(), strict=True)
        ]
        size = (
            2
            / 72
            / drawn.get_figwidth()
            / axes.get_position().width
            * (axes.get_xlim()[1] - axes.get_xlim()[0])
        )
        for arrow in (t for t in axes.texts if not t.get_text()):
            (x0, x1), (y0, y1) = sorted((arrow.xy[0], arrow.xyann[0])), sorted((arrow.xy[1], arrow.xyann[1]))
            assert not any(x0 - size < x < x1 + size and y0 - size < y < y1 + size for x, y in roots), (
                "an arrow lies on a root"
            )
