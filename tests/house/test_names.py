"""The name of a class means one thing in the whole package, and a module that a page names is there."""

import re
from collections import defaultdict

from tests.house.repository import ROOT

CLASS = re.compile(r"^ *class (\w+)[(:]", re.MULTILINE)
MODULE = re.compile(r"`([a-z]\w\w+(?:/\w\w+)+(?:\.py)?)`")
"""A module as pages write it, by its package: ``roots/locate``. Units and transfer functions are shorter."""
NO_MODULES = {"num/den"}
ONE_IDEA = {
    "BoundTransferFunction",
    "MeasuredResponse",
    "Model",
    "NestedTransferFunction",
    "PoleZeroMap",
    "Root",
    "StateSpace",
    "Sweep",
    "TransferFunction",
    "TransferMatrix",
}
"""What a Python user holds bears the name of what the pipeline makes, which it wraps."""


def test_every_module_that_a_page_names_is_there():
    packages = [path for path in (ROOT / "symflex").iterdir() if path.is_dir()]
    folders = [ROOT, ROOT / "symflex", ROOT / "tests" / "unit", ROOT / "derivations", *packages]
    pages = [*sorted((ROOT / "docs").glob("*.md")), ROOT / "CONTRIBUTING.md", ROOT / "README.md"]
    named = [(page, name) for page in pages for name in MODULE.findall(page.read_text(encoding="utf-8"))]
    missing = [
        f"{page.name}: {name}"
        for page, name in named
        if name not in NO_MODULES
        if not any((folder / f"{name}{end}").exists() for folder in folders for end in ("", ".py"))
    ]
    assert not missing
    assert len(named) > 200


def test_no_two_classes_have_the_same_name():
    places = defaultdict(list)
    for path in sorted((ROOT / "symflex").rglob("*.py")):
        for name in CLASS.findall(path.read_text(encoding="utf-8")):
            places[name].append(str(path.relative_to(ROOT)))
    wrapped = {name for name, found in places.items() if len(found) == 2 and "symflex/api/" in found[0]}
    assert wrapped == ONE_IDEA
    assert not {name: found for name, found in places.items() if len(found) > 1 and name not in wrapped}
