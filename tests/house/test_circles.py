"""No two files import each other, straight or through others, imports for types and in functions included."""

import re
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

PACKAGE = Path(__file__).parents[2] / "symflex"


_IMPORT = re.compile(r"^ *(?:from (symflex[\w.]*) import (?:\(([^)]*)\)|(.*))|import (symflex[\w.]*))", re.M)


def _imported(file: Path, modules: dict[str, Path]) -> set[Path]:
    """Return the files a file imports names from; a package's ``__init__`` only hands names on."""
    files = set()
    text = re.sub(" *#.*", "", file.read_text(encoding="utf-8"))
    for package, several, one, module in _IMPORT.findall(text):
        names = [package or module, *(f"{package}.{name}" for name in re.findall(r"\w+", several or one))]
        files |= {modules[name] for name in names if name in modules}
    return {each for each in files if each.name != "__init__.py"}


def test_no_files_import_each_other() -> None:
    modules = {
        ".".join(("symflex", *file.relative_to(PACKAGE).with_suffix("").parts)): file
        for file in PACKAGE.rglob("*.py")
    }
    graph = {file: _imported(file, modules) for file in modules.values() if file.name != "__init__.py"}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        circle = " -> ".join(str(file.relative_to(PACKAGE)) for file in error.args[1])
        raise AssertionError(circle) from None
