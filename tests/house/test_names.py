"""The name of a class means one thing in the whole package, and a module that a page names is there."""

from __future__ import annotations

import re
from collections import defaultdict

from tests.house.repository import ROOT

CLASS = re.compile(r"^ *class (\w+)[(:]", re.MULTILINE)
MODULE = re.compile(r"`(\w+(?:/\w+)+(?:\.py)?)`")
"""A module as pages write it, by its room: ``roots/locate``."""
ONE_IDEA = {
    "BoundTransferFunction",
    "Model",
    "NestedTransferFunction",
    "PoleZeroMap",
    "Root",
    "StateSpace",
    "Sweep",
    "TransferFunction",
}
"""What a Python user holds bears the name of what the pipeline makes, which it wraps."""


def test_every_module_that_a_page_names_is_there():
    rooms = {path.name for path in (ROOT / "symflex").iterdir() if path.is_dir()}
    pages = [*sorted((ROOT / "docs").glob("*.md")), ROOT / "CONTRIBUTING.md", ROOT / "README.md"]
    found, missing = 0, []
    for page in pages:
        for name in MODULE.findall(page.read_text(encoding="utf-8")):
            if name.split("/")[0] not in rooms:
                continue
            places = [f"{folder}{name}{end}" for folder in ("symflex/", "tests/unit/") for end in ("", ".py")]
            found += 1
            if not any((ROOT / place).exists() for place in places):
                missing.append(f"{page.name}: {name}")
    assert not missing
    assert found > 200


def test_no_two_classes_have_the_same_name():
    places = defaultdict(list)
    for path in sorted((ROOT / "symflex").rglob("*.py")):
        for name in CLASS.findall(path.read_text(encoding="utf-8")):
            places[name].append(str(path.relative_to(ROOT)))
    wrapped = {name for name, found in places.items() if len(found) == 2 and "symflex/api/" in found[0]}
    assert wrapped == ONE_IDEA
    assert not {name: found for name, found in places.items() if len(found) > 1 and name not in wrapped}
