"""The pipeline, one function per arrow: text, model, equations, transfer functions, and what is made of them.

text --parse--> Spec --resolve--> Model --assemble--> Equations --derive--> TransferFunction
                                                                                   | bind(values)
          --roots--> PoleZeroMap                                         BoundTransferFunction
          --time_response--> EnclosedResponse                                      |
          --approximate--> RationalApproximation             <---------------------+

any of them --print, codegen--> text, JSON, LaTeX, numpy, figure

The arrows up to transfer functions with numbers and their roots are here. Each later one is a function of its
package, imported where it is used: most commands need few of them, and many of these import numpy.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from symflex.errors import Source
from symflex.model import Model, Setting, load_with
from symflex.model.spec import read
from symflex.print.warnings import warnings
from symflex.transfer import AnyBoundFunction, bind, derive
from symflex.transfer.of_model import (
    assemble,
    assemble_for_checks,
    assemble_sparse,
    check_along,
    check_solvable,
    derive_all,
    derive_as,
    derive_bound,
    derive_for_roots,
    derive_nested,
    pick_pairs,
)

if TYPE_CHECKING:
    from symflex.roots import Budget, PoleZeroMap, Region


def load(
    path: str | Path, allow_outside: Iterable[str | Path] = (), settings: Mapping[str, Setting] | None = None
) -> Model:
    """Read a specification file and resolve it, with the given values in place of declared ones.

    Its ``model`` blocks read files in its folder, in those of ``allow_outside``, and in their subfolders.

    Raises
    ------
    SpecError
        With every problem of the file, each at its place.
    UsageError
        What is wrong with a given value, as :func:`symflex.model.load_with` says.
    """
    return load_with(read(Path(path)), settings or {}, allow_outside=allow_outside)


def loads(
    text: str,
    name: str = "<string>",
    allow_outside: Iterable[str | Path] = (),
    settings: Mapping[str, Setting] | None = None,
) -> Model:
    """Resolve a specification given as text; its ``model`` blocks read files as if it stood at ``name``."""
    return load_with(Source(name, text), settings or {}, allow_outside=allow_outside)


def roots(bound: AnyBoundFunction, region: Region | None = None, digits: int = 15) -> PoleZeroMap:
    """Return poles, zeros and hidden modes, proved; see :func:`symflex.roots.locate.locate`."""
    from symflex.roots.locate import locate  # imports numpy

    return locate(bound, region, digits)
