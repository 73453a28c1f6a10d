"""The examples that come with symflex: the models of the folder ``derivations``.

Input: the name of an example, ``eppinger1988`` or ``classics/quarter_car``, or the last part of one.
Output: its path. An installed package contains the folder; in a clone it stands beside the package.

Names are looked up in what the folder holds, and never joined to a path: ``../x`` is no example.
"""

from __future__ import annotations

import os
import tomllib
from pathlib import Path
from typing import Final

from symflex.errors import Diagnostic, UsageError, nearest, refused

FOLDERS: Final[dict[str, str]] = {
    "classics": "Beams, rods, shafts and a car of the textbooks",
    "mechatronics": "Drives, joints, cranes and contact, of control and robotics",
    "transducers": "Loudspeakers, an accelerometer, a galvanometer, a piezo stack",
    "distributed": "Lines, pipes, ducts and rods, by their wave equations",
    "nonlinear": "Nonlinear equations and energies, about an operating point",
    "eppinger1988": "Models of a paper on robot flexibility, and its claims",
    "eppinger1988/loops": "Position and force loops around these models",
    "frames": "Plane frames, whose members bend and stretch",
    "measured": "Machines whose parameters are fitted to measured responses",
    "tapers": "Sections, tensions and coefficients that vary along x",
}  # what each folder holds; ``claims.toml`` is no model, see ``symflex.report.claims``
CLAIMS: Final = "claims.toml"
LISTED: Final = "'symflex examples' lists them"
_PACKAGE: Final = Path(__file__).parents[1]


def examples() -> dict[str, Path]:
    """Return the paths of all examples by their names, each folder before the models in it."""
    top = next(p / "derivations" for p in (_PACKAGE, _PACKAGE.parent) if (p / "derivations").is_dir())
    by_name: dict[str, Path] = {}
    for name in FOLDERS:
        models = sorted(p for p in (top / name).glob("*.toml") if p.name != CLAIMS)
        by_name |= {name: top / name, **{f"{name}/{p.stem}": p for p in models}}
    return by_name


def title_of(name: str, path: Path) -> str:
    """Return what an example is, in one line."""
    if name in FOLDERS:
        return FOLDERS[name]
    return str(tomllib.loads(path.read_text(encoding="utf-8")).get("title", path.stem))


def example_of(path: str) -> str | None:
    """Return the name of the example whose file a path seems to mean; ``None`` if there is none.

    >>> example_of("derivations/classics/quarter_car.toml"), example_of("my_car.toml")
    ('quarter_car', None)
    """
    name = Path(path).stem
    return name if any(known.rpartition("/")[2] == name for known in examples()) else None


def find_example(name: str) -> Path:
    """Return the path of an example by its name, or by the last part of it; SF902 when there is none.

    >>> find_example("classics/quarter_car") == find_example("quarter_car")
    True
    >>> find_example("quarter_cart")
    Traceback (most recent call last):
    symflex.errors.exceptions.UsageError: error[SF902]: there is no example 'quarter_cart'
      hint: did you mean 'quarter_car'?
    """
    paths = examples()
    paths |= {name.rpartition("/")[2]: path for name, path in paths.items()}
    try:
        return paths[name.rstrip("/")]
    except KeyError:
        raise refused(f"there is no example '{name[:64]}'", nearest(name, paths) or LISTED) from None


def file_or_example(given: str | Path) -> Path:
    """Return the path that is given, or else the example of that name; SF901 when it is neither."""
    path = Path(given)
    if os.path.lexists(path) or path.suffix:
        return path
    try:
        return find_example(str(given))
    except UsageError as problem:
        message = f"there is no file, folder or example '{str(given)[:64]}'"
        raise UsageError(Diagnostic("SF901", message, None, problem.diagnostics[0].hint)) from None
