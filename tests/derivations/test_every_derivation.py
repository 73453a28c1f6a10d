"""Every specification in derivations/ derives all its transfer functions."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

import symflex
from tests.house.repository import specifications

FOLDER = Path(__file__).parents[2] / "derivations"
PATHS = specifications(FOLDER, "**/*.toml")


def cases():
    for path in PATHS:
        entries = tomllib.loads(path.read_text("utf-8"))
        for output in entries["outputs"]:
            for source in entries["inputs"]:
                name = f"{path.relative_to(FOLDER).with_suffix('')}:{output}/{source}"
                yield pytest.param(path, output, source, id=name)


def test_there_are_derivations():
    assert PATHS


@pytest.mark.parametrize(("path", "output", "source"), tuple(cases()))
def test_the_transfer_function_is_derived(path, output, source):
    G = symflex.load(path).transfer_function(output, source)
    assert G.num != 0


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_the_specification_says_where_it_comes_from(path):
    assert tomllib.loads(path.read_text("utf-8")).get("source")
