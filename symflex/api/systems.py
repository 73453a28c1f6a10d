"""Models of what other programs leave: systems of python-control and scipy, and matrices M, D, K."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from decimal import Decimal
from math import isfinite
from numbers import Integral, Real
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from symflex.api.model import Model, Table
from symflex.errors import nearest, refused
from symflex.model.reading import SHOWN
from symflex.model.scope import RESERVED

if TYPE_CHECKING:
    import sympy
    from numpy.typing import ArrayLike

Quotient = tuple[object, object]
TUPLES = {2: ("num", "den"), 3: ("zeros", "poles", "gain"), 4: "ABCD"}
"""What the members of a tuple are by their number, as scipy reads it."""


def from_control(sys: object) -> Model:
    """Return a continuous system of python-control or ``scipy.signal`` as a model.

    Parameters
    ----------
    sys : control.TransferFunction, control.StateSpace, scipy.signal.lti or tuple
        With any number of inputs and outputs. Every double is read as the shortest decimal that prints it.
        A tuple is (numerator, denominator), (zeros, poles, gain) or (A, B, C, D).

    Returns
    -------
    Model
        State equations become ``[equations]`` with the states as unknowns; transfer functions become blocks.
        Inputs, outputs and states keep their labels, with ``_`` for characters that a name cannot have:
        ``u[0]`` is ``u_0``.

    Raises
    ------
    UsageError
        SF902 for a system in discrete time, for measured responses, and for objects that are not systems.

    Examples
    --------
    >>> import control
    >>> model = from_control(control.tf([1], [1, 0.4, 4], inputs="F", outputs="x"))
    >>> print(model.transfer_function("x", "F"))
    x/F = 1/(s^2 + 0.4*s + 4)
    """
    given: Any = sys
    if isinstance(sys, tuple | list) and len(sys) in TUPLES:
        given = SimpleNamespace(**dict(zip(TUPLES[len(sys)], sys, strict=True)))
    if getattr(given, "dt", None):
        note = "symflex models continuous time; its own functions are sampled by discretise()"
        raise refused(f"the system is in discrete time, dt = {given.dt}", note)
    title = str(getattr(given, "name", None) or "")
    if all(hasattr(given, key) for key in "ABCD"):
        return _of_states(given, title)
    if hasattr(given, "zeros") and hasattr(given, "gain") and not callable(given.zeros):
        blocks: list[list[Quotient]] = [
            [(_with_roots(given.gain, given.zeros), _with_roots(1.0, given.poles))]
        ]
    elif hasattr(given, "num") and hasattr(given, "den"):
        blocks = _quotients(given)
    else:
        hint = "a tuple is (num, den), (zeros, poles, gain) or (A, B, C, D)"
        hint = "read_measurement() takes measured responses" if hasattr(given, "omega") else hint
        raise refused(
            f"a '{type(sys).__name__}' is neither a transfer function nor a state-space system", hint
        )
    names = _FreeNames()
    inputs = names.of(getattr(given, "input_labels", None), "u", len(blocks[0]))
    outputs = names.of(getattr(given, "output_labels", None), "y", len(blocks))
    tables: dict[str, object] = {}
    sums = {}
    for i, (output, row) in enumerate(zip(outputs, blocks, strict=True), 1):
        placed = {
            u: names.new(f"G_{i}_{j}" if len(row) > 1 or len(blocks) > 1 else "G")
            for j, u in enumerate(inputs, 1)
        }
        tables |= {
            name: {"type": "tf", "num": num, "den": den}
            for name, (num, den) in zip(placed.values(), row, strict=True)
        }
        sums[output] = " + ".join(f"{name}*{u}" for u, name in placed.items())
    return Model(title=title, blocks=tables, inputs={u: {} for u in inputs}, outputs=sums)


def from_matrices(
    M: ArrayLike | sympy.Matrix | None = None,
    D: ArrayLike | sympy.Matrix | None = None,
    K: ArrayLike | sympy.Matrix | None = None,
    *,
    inputs: Mapping[str, object],
    outputs: Mapping[str, object],
    unknowns: Sequence[str] = (),
    parameters: Table | None = None,
    title: str = "",
) -> Model:
    """Return ``(M s^2 + D s + K) q = b F`` as a model, with its rows as ``[equations]``.

    Parameters
    ----------
    M, D, K : array_like, scipy sparse matrix or sympy.Matrix, shape (n, n)
        Mass, damping and stiffness, in SI units; what is left out is zero. At least one is given.
    inputs : mapping of str to int, str or sequence
        Where each input acts: on which unknown, by number from 0 or by name, or its column of n entries.
    outputs : mapping of str to int, str or sequence
        What each output reads: an unknown by number, a row of n entries, or an expression, ``"s*q_1"``.
    unknowns : sequence of str
        Names, by default ``q_1`` to ``q_n``.
    parameters : mapping, optional
        Values of the symbols in the matrices. A symbol without one keeps its assumption: positive,
        nonnegative, or real.
    title : str
        What the model is.

    Raises
    ------
    UsageError
        SF902 for sizes that do not fit, numbers that are not finite or not real, and invalid names.
    SpecError
        For entries that no expression may contain, with what they are.

    Examples
    --------
    >>> model = from_matrices(
    ...     M=[[2, 0], [0, 1]], K=[[30, -10], [-10, 10]], inputs={"F": 1}, outputs={"X": 0}
    ... )
    >>> print(model.transfer_function("X", "F"))
    X/F = 5/(s^4 + 25*s^2 + 100)
    """
    matrices = {name: _rows(name, m) for name, m in (("M", M), ("D", D), ("K", K)) if m is not None}
    if not matrices:
        raise refused("there is no matrix", "give M, D or K")
    size = len(next(iter(matrices.values())))
    for name, rows in matrices.items():
        if len(rows) != size or any(len(row) != size for row in rows) or not size:
            shape = f"{len(rows)} x {len(rows[0]) if rows else 0}"
            raise refused(f"{name} is {shape}", f"every matrix must be square, here {size} x {size}")
    names = tuple(unknowns) or tuple(f"q_{i + 1}" for i in range(size))
    if len(names) != size:
        raise refused(f"{len(names)} unknowns for matrices of {size} rows", "name each of them")
    powers = {"M": "s^2*", "D": "s*", "K": ""}
    columns = {name: _along(f"input '{name}'", given, names) for name, given in inputs.items()}
    rows_read = {
        name: g if isinstance(g, str) else _along(f"output '{name}'", g, names) for name, g in outputs.items()
    }
    written = []
    for i in range(size):
        terms = [(rows[i][j], powers[m] + q) for m, rows in matrices.items() for j, q in enumerate(names)]
        written.append(f"{_combined(terms)} = {_combined([(c[i], u) for u, c in columns.items()])}")
    sums = {
        n: g if isinstance(g, str) else _combined(zip(g, names, strict=True), is_output=True)
        for n, g in rows_read.items()
    }
    entries = [e for rows in matrices.values() for row in rows for e in row]
    entries += [
        e for c in (*columns.values(), *(r for r in rows_read.values() if not isinstance(r, str))) for e in c
    ]
    return Model(
        title=title,
        parameters={**_symbols(entries), **(parameters or {})},
        equations={"unknowns": list(names), "equations": written},
        inputs={name: {} for name in inputs},
        outputs=sums,
    )


def _of_states(given: Any, title: str) -> Model:  # noqa: ANN401 (a system of either program)
    a, b, c, d = (_rows(key, getattr(given, key)) for key in "ABCD")
    names = _FreeNames()
    inputs = names.of(getattr(given, "input_labels", None), "u", len(d[0]))
    states = names.of(getattr(given, "state_labels", None), "x", len(a))
    outputs = _FreeNames().of(getattr(given, "output_labels", None), "y", len(d))
    equations = [
        f"s*{x} = {_combined([*zip(a[i], states, strict=True), *zip(b[i], inputs, strict=True)])}"
        for i, x in enumerate(states)
    ]
    sums = {
        y: _combined(
            [*zip(c[i] if states else (), states, strict=True), *zip(d[i], inputs, strict=True)],
            is_output=True,
        )
        for i, y in enumerate(outputs)
    }
    section = {"unknowns": states, "equations": equations} if states else None
    return Model(title=title, equations=section, inputs={u: {} for u in inputs}, outputs=sums)


def _quotients(given: Any) -> list[list[Quotient]]:  # noqa: ANN401 (a system of either program)
    """Return numerators and denominators, by output and input."""
    if not hasattr(given, "ninputs"):
        if len(_rows("num", given.num)) > 1:
            raise refused("the numerator has several outputs", "pass its outputs one at a time")
        return [[(_rows("num", given.num)[0], _rows("den", given.den)[0])]]
    places = range(given.ninputs)
    return [
        [(_rows("num", given.num[i][j])[0], _rows("den", given.den[i][j])[0]) for j in places]
        for i in range(given.noutputs)
    ]


def _with_roots(gain: float, roots: Sequence[complex]) -> str:
    """Return a product over roots; two that are conjugate make a square and a rest, without rounding."""
    factors = [_coefficient(gain)]
    remaining = [complex(root) for root in _rows("roots", roots)[0]]
    while remaining:
        root = remaining.pop()
        real = f"s - {_coefficient(root.real)}"
        if root.imag:
            if root.conjugate() not in remaining:
                raise refused(f"the root {root:g} has no conjugate", "a system's coefficients are real")
            remaining.remove(root.conjugate())
            real = f"({real})^2 + {_coefficient(root.imag)}^2"
        factors.append(f"({real})")
    return "*".join(factors)


def _rows(name: str, given: Any) -> list[list[Any]]:  # noqa: ANN401 (numbers or expressions of SymPy)
    """Return a matrix as lists, a vector as one row."""
    dense = given.toarray() if hasattr(given, "toarray") else given
    listed = dense.tolist() if hasattr(dense, "tolist") else dense
    if not isinstance(listed, list | tuple):
        listed = [[listed]]
    rows = [list(row) if isinstance(row, list | tuple) else row for row in listed]
    if any(isinstance(row, list) for row in rows) and not all(isinstance(row, list) for row in rows):
        raise refused(f"{name} is not a matrix: its rows differ in length", None)
    return rows if rows and isinstance(rows[0], list) else [rows]


def _along(what: str, given: object, names: Sequence[str]) -> list[object]:
    """Return one entry for each unknown, of which a number or a name picks one."""
    if isinstance(given, str):
        if given not in names:
            raise refused(
                f"{what} refers to the unknown '{given[:SHOWN]}', which does not exist",
                nearest(given, names) or "unknowns: " + ", ".join(names[:8]),
            )
        return [int(n == given) for n in names]
    if isinstance(given, Integral):
        position = int(given)
        if not -len(names) <= position < len(names):
            raise refused(f"{what} is at {position}", f"unknowns are counted from 0 to {len(names) - 1}")
        return [int(i == position % len(names)) for i in range(len(names))]
    rows = _rows(what, given)
    entries = [e for row in rows for e in row]
    if len(entries) != len(names) or len(rows) not in (1, len(names)):
        raise refused(f"{what} has {len(entries)} entries", f"give one for each of the {len(names)} unknowns")
    return entries


def _combined(terms: Any, *, is_output: bool = False) -> str:  # noqa: ANN401 (pairs of an entry and what it stands before)
    """Return a sum of products as an expression, without what is zero.

    In equations 1 is written: numbers may have any unit, bare names would have to agree in theirs.
    """
    kept = [(entry, name) for entry, name in terms if entry != 0]
    if is_output and len(kept) == 1 and kept[0][0] == 1:
        return str(kept[0][1])
    return " + ".join(f"{_coefficient(entry)}*{name}" for entry, name in kept) or "0"


def _coefficient(entry: Any) -> str:  # noqa: ANN401 (a number or an expression of SymPy)
    """Return an entry as a factor: SymPy prints what the grammar of expressions reads."""
    if hasattr(entry, "free_symbols"):
        return f"({entry})"
    if not isinstance(entry, Real | Decimal) or not isfinite(entry):
        hint = "entries must be numbers or SymPy expressions"
        raise refused(f"'{str(entry)[:SHOWN]}' is not a real number", hint)
    # A double is the shortest decimal that prints it; those of numpy are doubles, too.
    text = repr(float(entry)) if hasattr(entry, "hex") else str(entry)
    return f"({text})" if text.startswith("-") or "/" in text else text


def _symbols(entries: Sequence[Any]) -> dict[str, object]:
    """Return the symbols of entries as parameters without value."""
    symbols = {str(x): x for e in entries for x in getattr(e, "free_symbols", ())}
    free = [(name, x) for name, x in sorted(symbols.items()) if name not in RESERVED]
    return {
        name: {} if x.is_positive else {"assume": "nonnegative" if x.is_nonnegative else "real"}
        for name, x in free
    }


class _FreeNames:
    """Names for what programs label as they like, each once."""

    def __init__(self) -> None:
        self._taken = set(RESERVED)

    def of(self, labels: Sequence[str] | None, letter: str, count: int) -> list[str]:
        """Return a name for each label, or ``u``, and ``u_1`` to ``u_n``, where there are none."""
        numbered = [f"{letter}_{i + 1}" for i in range(count)]
        given = labels if labels and len(labels) == count else numbered if count > 1 else [letter] * count
        return [self.new(x) for x in given]

    def new(self, label: str) -> str:
        """Return the nearest name to a label that nothing has yet."""
        name = re.sub(r"\W+", "_", str(label), flags=re.ASCII).strip("_")[:SHOWN]
        name = name if name[:1].isalpha() else f"x_{name}"
        unique, number = name, 2
        while unique in self._taken:
            unique, number = f"{name}_{number}", number + 1
        self._taken.add(unique)
        return unique
