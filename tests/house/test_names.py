"""The name of a class means one thing in the whole package."""

from __future__ import annotations

import re
from collections import defaultdict

from tests.house.repository import ROOT

CLASS = re.compile(r"^ *class (\w+)[(:]", re.MULTILINE)
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


def test_no_two_classes_have_the_same_name():
    places = defaultdict(list)
    for path in sorted((ROOT / "symflex").rglob("*.py")):
        for name in CLASS.findall(path.read_text(encoding="utf-8")):
            places[name].append(str(path.relative_to(ROOT)))
    wrapped = {name for name, found in places.items() if len(found) == 2 and "symflex/api/" in found[0]}
    assert wrapped == ONE_IDEA
    assert not {name: found for name, found in places.items() if len(found) > 1 and name not in wrapped}
