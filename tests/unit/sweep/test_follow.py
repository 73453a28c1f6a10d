import numpy as np
import pytest

import symflex
from symflex.sweep import follow as module
from symflex.sweep import read_design
from symflex.sweep.follow import NameOrigin, Predecessors, follow, predecessors
from tests.unit.sweep.models import TWO_RESONANCES, oscillator

NO_FAMILY = np.zeros(2, np.int64)
ONE_STEP = Predecessors((0, 1), (-1, 0), (-1, -1), (1.0, 1.0))


def rising(share):
    """Two roots that both move far, and stay apart."""
    return np.array([1j * (1 + 2 * share), 1j * (3 + 2 * share)])


def test_a_long_step_is_in_doubt():
    s = np.array([rising(0), rising(1)])
    assert follow(s, NO_FAMILY, ONE_STEP).link[1].tolist() == [NameOrigin.DOUBTFUL, NameOrigin.DOUBTFUL]


def test_a_long_step_is_divided():
    asked = []

    def between(start, end, pieces):
        asked.append((start, end, pieces))
        return [rising(i / pieces) for i in range(1, pieces)]

    names = follow(np.array([rising(0), rising(1)]), NO_FAMILY, ONE_STEP, between)
    assert names.mode.tolist() == [[0, 1], [0, 1]]
    assert names.link[1].tolist() == [NameOrigin.CLEAR, NameOrigin.CLEAR]
    assert asked and all(each[:2] == (0, 1) for each in asked)


def test_where_nothing_can_be_asked_doubt_remains():
    names = follow(np.array([rising(0), rising(1)]), NO_FAMILY, ONE_STEP, lambda *step: None)
    assert names.link[1].tolist() == [NameOrigin.DOUBTFUL, NameOrigin.DOUBTFUL]


def test_a_root_that_is_nowhere_near_has_a_name_of_its_own():
    s = np.array([[1j, 2j], [1j, 400j]])
    names = follow(s, NO_FAMILY, ONE_STEP)
    assert names.mode[1].tolist() == [0, 2]
    assert names.link[1].tolist()[1] == NameOrigin.APPEARS


def test_a_pair_far_from_the_real_axis_is_not_taken_for_a_real_root():
    # A taut cable with a damper near its end: the lowest root is a lightly damped pair, or a real root.
    s = np.array([[-0.0102 + 1.0034j], [-0.966]])
    names = follow(s, NO_FAMILY, ONE_STEP)
    assert names.mode[1].tolist() == [1]
    assert names.link[1].tolist() == [NameOrigin.APPEARS]


def test_modes_that_swap_places_within_one_step():
    sweep = symflex.loads(TWO_RESONANCES).sweep({"k_1": "1:30:lin:4"})
    assert np.allclose(sweep["im"][:, 0], np.sqrt(np.linspace(1, 30, 4)))
    assert (sweep["im"][:, 1] == 2).all()
    assert sweep["link"][1].tolist() == [NameOrigin.DOUBTFUL, NameOrigin.DOUBTFUL]


def test_names_do_not_depend_on_the_direction():
    up = symflex.loads(TWO_RESONANCES).sweep({"k_1": "1:9:lin:7"})
    down = symflex.loads(TWO_RESONANCES).sweep({"k_1": "9:1:lin:7"})
    # Names begin with the lower mode, which is the moving one upwards and the still one downwards.
    assert np.allclose(up["im"], down["im"][::-1, ::-1])


def test_similar_functions_need_no_distances():
    s = np.array([[1j, 2j], [50j, 100j]])
    names = follow(s, np.array([7, 7]), ONE_STEP)
    assert names.link[1].tolist() == [NameOrigin.SIMILAR, NameOrigin.SIMILAR]
    assert names.mode[1].tolist() == [0, 1]


def test_everyone_but_one_comes_after_a_neighbour():
    for texts in [["k=1,2,3"], ["k=1,2", "m=1,2,3"], ["k=1,2,3,4", "m=1:2"], ["k=1:2", "m=1:3"]]:
        draws = 25 if any(text.count(":") == 1 for text in texts) else 0
        design = read_design(oscillator().parameters, texts, draws)
        steps = predecessors(design)
        assert sorted(steps.order) == list(range(design.count)), texts
        assert [i for i in range(design.count) if steps.before[i] < 0] == [steps.order[0]], texts
        place = {i: k for k, i in enumerate(steps.order)}
        assert all(place[steps.before[i]] < place[i] for i in steps.order[1:]), texts


def test_a_grid_is_walked_along_its_axes():
    design = read_design(oscillator().parameters, ["k=1,2,4", "m=1,3,9"])
    steps = predecessors(design)
    assert steps.before == (-1, 0, 1, 0, 3, 4, 3, 6, 7)
    assert steps.earlier == (-1, -1, 0, -1, -1, 3, 0, -1, 6)
    assert steps.ratio[2] == pytest.approx(1)  # by the logarithms of 1, 3, 9


def test_what_is_said_of_all_points_at_once_is_what_is_said_of_each(monkeypatch):
    """Paths that run, cross, meet the real axis, and jump: names and links are those found step by step."""
    random = np.random.default_rng(3)
    for _ in range(20):
        start = np.log(random.uniform(1, 9, 4)) + 1j * random.uniform(np.pi / 2, np.pi, 4)
        drift = random.normal(0, 0.03, (1, 4)) + 1j * random.normal(0, 0.02, (1, 4))
        paths = start + drift * np.arange(30)[:, None] + random.normal(0, 1e-3, (30, 4))
        s = np.exp(paths.real + 1j * np.clip(paths.imag, 0, np.pi))
        s = np.take_along_axis(s, np.argsort(np.abs(s), axis=1), axis=1)
        steps = Predecessors(tuple(range(30)), tuple(range(-1, 29)), (-1, -1, *range(28)), (1.0,) * 30)
        family = np.zeros(30, np.int64)
        at_once = follow(s, family, steps)
        monkeypatch.setattr(module, "_in_order", lambda logarithms, count, steps: np.zeros(len(count), bool))
        one_by_one = follow(s, family, steps)
        monkeypatch.undo()
        assert at_once.mode.tolist() == one_by_one.mode.tolist()
        assert at_once.link.tolist() == one_by_one.link.tolist()
