"""Poles, zeros and verdicts by the closed form are those by the equations."""

import pytest

from tests.tools.ways import FOLDERS, compared, models


def differing(texts):
    lines = [line for name, text in texts for line in compared(name, text, seconds=30)]
    return [str(line) for line in lines if line.outcome.startswith("differs")]


def test_templates_have_the_same_roots_by_formula_and_by_equations():
    assert not differing(models(FOLDERS[1:], ()))


@pytest.mark.slow
def test_worked_models_have_the_same_roots_by_formula_and_by_equations():
    assert not differing(models([FOLDERS[0] / name for name in ("classics", "frames")], ()))


@pytest.mark.slow
def test_random_models_have_the_same_roots_by_formula_and_by_equations():
    seeds = [seed for seed in range(40) if seed % 3]  # members take long
    assert not differing(models((), seeds))
