"""The name under which a derivation is kept: all that it depends on, hashed.

That is the content of the equations, in which every element, signal, block, field and nested model of the
resolved model has left its stamp, and every number that was put in; and the text of
the programs that derive. Positions, titles, descriptions and labels do not take part.
"""

from __future__ import annotations

import hashlib
import json
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import flint

from symflex.cache.exact import Writer

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.elements import LinearForm, Variable
    from symflex.equations import Equations
    from symflex.kernels import Propagation

FORMAT: Final = 1
"""Changes whenever what an entry or a key holds does."""
DERIVING: Final = ("kernels", "elimination", "transfer")
"""The rooms a derivation from equations runs through."""


def derivation_key(equations: Equations, pairs: Sequence[tuple[str, str]]) -> str:
    """Return the key of the transfer functions of some pairs: 64 hexadecimal digits.

    Empty where the programs' text cannot be read, and so not be told from that of another version.
    """
    programs = programs_digest()
    if not programs:
        return ""
    writer = Writer()
    content = [
        FORMAT,
        programs,
        [list(pair) for pair in pairs],
        [[p.name, p.assume] for p in equations.model.parameters],
        _equations(writer, equations),
        # After everything that adds to it.
        writer.data,
    ]
    return hashlib.sha256(json.dumps(content, separators=(",", ":")).encode()).hexdigest()


@cache
def programs_digest() -> str:
    """Return a digest of the text of all that derives, empty where it is installed without its text.

    The text, because a version does not change with every change in a checkout.
    """
    root = Path(__file__).parents[1]
    digest = hashlib.sha256(flint.__version__.encode())
    try:
        files = [path for room in DERIVING for path in sorted((root / room).glob("*.py"))]
        for path in files:
            text = path.read_bytes()
            digest.update(f"\n{path.parent.name}/{path.name} {len(text)}\n".encode() + text)
    except OSError:
        return ""
    return digest.hexdigest() if files else ""


def _equations(writer: Writer, equations: Equations) -> list[Any]:
    return [
        writer.ring(equations.ring),
        [[name, writer.value(value)] for name, value in equations.definitions],
        [constant.generator for constant in equations.constants],
        [_variable(v) for v in equations.unknowns],
        [_variable(v) for v in equations.inputs],
        [[_variable(row.about), row.role, _form(writer, row.form)] for row in equations.rows],
        [[row.name, _form(writer, row.form), writer.value(row.divisor)] for row in equations.outputs],
        None if equations.propagation is None else _propagation(writer, equations.propagation),
        None if equations.cleared is None else writer.value(equations.cleared),
    ]


def _variable(variable: Variable) -> list[str]:
    return [variable.kind, variable.owner, variable.component]


def _form(writer: Writer, form: LinearForm) -> list[Any]:
    return [[_variable(v), writer.value(c)] for v, c in form.terms]


def _propagation(writer: Writer, propagation: Propagation) -> list[Any]:
    images = [writer.polynomial(propagation.kernel_ring, p.image) for p in propagation.propagators]
    return [
        [writer.ring(r) for r in (propagation.base, propagation.ring, propagation.kernel_ring)],
        writer.table(propagation.table),
        [[writer.value(length) for length in lengths] for lengths in propagation.lengths],
        [[p.generator, p.dispersion, p.length, p.order] for p in propagation.propagators],
        images,
        propagation.coordinates,
    ]
