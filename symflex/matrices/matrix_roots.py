"""Poles and zeros of a transfer matrix as results: JSON, and text for a terminal.

Input: roots, and the system matrix they were found with.
Output: :class:`MatrixRoots`, a :class:`~symflex.roots.PoleZeroMap` with what only matrices have.

Example: ``G = [1/(s+1), 2/(s+3); 1/(s+1), 1/(s+1)]`` at its zero s = 1 is [1/2, 1/2; 1/2, 1/2]. Inputs
``u_1 = exp(t)``, ``u_2 = -exp(t)`` move no output, and no input moves ``y_1 - y_2``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import acb

from symflex.balls import opposite, precision
from symflex.matrices.system_matrix import SystemMatrix, null_vector
from symflex.print.roots import SHORT_DIGITS, one_of_each_pair, roots_text
from symflex.print.text import INDENT, WIDTH, aligned, broken
from symflex.roots import PoleZeroMap, Root
from symflex.roots.pole_zero_map import root_json
from symflex.roots.root import NEARLY_ZERO, count_roots, decimals, figure


@dataclass(frozen=True, slots=True)
class DecouplingZero:
    """A hidden mode of the whole matrix, and how often it is one for which reason."""

    root: Root
    inputs: int  # how often it is an input-decoupling zero: no input moves it
    outputs: int  # how often it is an output-decoupling zero: no output shows it
    both: int  # how often it is both at once
    how: str = "cancelled"  # as of a :class:`HiddenRoot`
    is_exact: bool = True  # numbers follow from exact polynomials, not from what is not excluded in balls

    @property
    def cause(self) -> str:
        """What it is, in words."""
        words = [w for w, n in (("input", self.inputs), ("output", self.outputs)) if n]
        return " and ".join(words)

    def to_json_dict(self, digits: int) -> dict[str, object]:
        """Return it as JSON data."""
        counts = {"input_decoupling": self.inputs, "output_decoupling": self.outputs, "both": self.both}
        return {**root_json(self.root, digits), **counts, "exact": self.is_exact}


@dataclass(frozen=True, slots=True)
class ZeroDirection:
    """What goes in at a zero without any output moving, and the sum of outputs that nothing moves there.

    The largest entry of each is 1; nothing where it is not unique.
    """

    zero: Root
    inputs: tuple[acb, ...]
    outputs: tuple[acb, ...]

    def to_json_dict(self, digits: int) -> dict[str, object]:
        """Return it as JSON data."""
        sides = {"input": self.inputs, "output": self.outputs}
        shown = root_json(self.zero, digits)
        return {
            "zero": {"re": shown["re"], "im": shown["im"]},
            **{name: [_number_json(x, digits) for x in vector] or None for name, vector in sides.items()},
        }


def _number_json(value: acb, digits: int) -> dict[str, str]:
    printed = decimals(value.real, value.imag, digits)
    return {"re": printed.re, "im": printed.im, "radius": printed.radius}


@dataclass(frozen=True, slots=True)
class MatrixRoots:
    """Poles and zeros of a transfer matrix in a region of the s plane."""

    located: PoleZeroMap  # poles as of McMillan, transmission zeros, hidden modes of the whole matrix
    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    normal_rank: int
    invariant_zeros: tuple[Root, ...]
    decoupling_zeros: tuple[DecouplingZero, ...]
    directions: tuple[ZeroDirection, ...]

    def __str__(self) -> str:
        return matrix_roots_text(self)

    def __repr__(self) -> str:
        return f"<MatrixRoots {repr(self.located).removeprefix('<PoleZeroMap ')}"

    @property
    def has_full_rank(self) -> bool:
        """Whether the normal rank is as large as it can be."""
        return self.normal_rank == min(len(self.outputs), len(self.inputs))

    def to_json_dict(self) -> dict[str, object]:
        """Return the roots in the schema ``symflex.roots/1``, with what only matrices have."""
        digits = self.located.digits
        return {
            **self.located.to_json_dict(),
            "matrix": {
                "outputs": list(self.outputs),
                "inputs": list(self.inputs),
                "normal_rank": self.normal_rank,
                "invariant_zeros": [root_json(root, digits) for root in self.invariant_zeros],
                "decoupling_zeros": [each.to_json_dict(digits) for each in self.decoupling_zeros],
                "directions": [each.to_json_dict(digits) for each in self.directions],
            },
        }


def matrix_name(outputs: Sequence[str], inputs: Sequence[str]) -> str:
    """Return what stands above poles and zeros of a matrix: ``Y_1,Y_2/F_1,F_2``."""
    return f"{','.join(outputs)}/{','.join(inputs)}"


def directions(matrix: SystemMatrix, rank: int, zeros: Sequence[Root]) -> tuple[ZeroDirection, ...]:
    """Return the directions of zeros where they are unique: inputs of a matrix with as many as its rank."""
    found: list[ZeroDirection] = []
    is_real = matrix.is_real
    for zero in (zero for zero in zeros if zero.certified):
        above = next((each for each in found if is_real and is_conjugate(each.zero, zero)), None)
        if above is not None:
            vectors = [tuple(x.conjugate() for x in vector) for vector in (above.inputs, above.outputs)]
        else:
            vectors = _vectors(matrix, rank, zero)
        if any(vectors):
            found.append(ZeroDirection(zero, *vectors))
    return tuple(found)


def is_conjugate(one: Root, other: Root) -> bool:
    """Tell whether two roots of a pair are seen as conjugate."""
    return bool(one.im * other.im < 0) and one.re.overlaps(other.re) and opposite(one.im).overlaps(other.im)


def _vectors(matrix: SystemMatrix, rank: int, zero: Root) -> list[tuple[acb, ...]]:
    """Return the direction of inputs, and of outputs; nothing where one is not unique."""
    with precision(2 * zero.working_bits()):
        rows = matrix.on(zero.enclosure()).squared(rank)
        columns: list[dict[int, acb]] = [{} for _ in rows]
        for i, row in enumerate(rows):
            for j, x in row.items():
                columns[j][i] = x
        found = []
        for sides, count in ((rows, matrix.inputs), (columns, len(matrix.lower))):
            vector = null_vector(sides) if rank == count else None
            entries = (vector or [])[len(matrix.upper) :]
            largest = max(entries, key=lambda x: float(abs(x).mid()), default=acb(0))
            is_known = not largest.contains(0)
            found.append(tuple(acb(1) if x is largest else x / largest for x in entries) if is_known else ())
        return found


DIRECTION_DIGITS = 4  # of entries of directions in a terminal


def matrix_roots_text(found: MatrixRoots, digits: int = SHORT_DIGITS, width: int = WIDTH) -> str:
    """Return poles and zeros as tables, and what only matrices have, in lines of at most so many columns."""
    said = f"normal rank {found.normal_rank} of a {len(found.outputs)} x {len(found.inputs)} matrix"
    if not found.has_full_rank:
        said += ": outputs, or inputs, depend on each other at every s"
    lines = [roots_text(found.located, digits, width), "", *broken(INDENT + said, width)]
    if found.decoupling_zeros:
        lines += _decoupling_lines(found.decoupling_zeros, digits)
    count = count_roots(found.invariant_zeros)
    if count != count_roots(found.located.zeros):
        places = ", ".join(s + _times(root) for root, s in _printed(found.invariant_zeros, digits))
        lines += [
            "",
            *broken(f"{INDENT}invariant zeros: {count or 'none'}" + f", at {places}" * (count > 0), width),
        ]
    of_zero = {id(each.zero): each for each in found.directions}
    printed = _printed([each.zero for each in found.directions], digits)
    if printed:
        lines += [
            "",
            f"{INDENT}directions: inputs that move no output at s; a sum of outputs that none moves",
        ]
    for zero, s in printed:
        each = of_zero[id(zero)]
        sides = (("inputs", found.inputs, each.inputs), ("outputs", found.outputs, each.outputs))
        told = [f"{side} {_vector_text(names, vector)}" for side, names, vector in sides if vector]
        lines += broken(f"{2 * INDENT}s = {s}: {'; '.join(told)}", width)
    return "\n".join(lines)


def _decoupling_lines(zeros: Sequence[DecouplingZero], digits: int) -> list[str]:
    count = count_roots(each.root for each in zeros)
    table: list[tuple[str, ...]] = [
        ("", "", "no input", "no output", ""),
        ("", "s [rad/s]", "moves", "shows", "both"),
    ]
    of_root = {id(each.root): each for each in zeros}
    for root, s in _printed([each.root for each in zeros], digits):
        each = of_root[id(root)]
        counts = (str(n) if n else "-" for n in (each.inputs, each.outputs, each.both))
        table.append((_times(root).strip() + "?" * (not each.is_exact), s, *counts))
    return ["", f"{INDENT}decoupling zeros: {count}, modes that the matrix does not have", *aligned(table)]


def _times(root: Root) -> str:
    return f" x{root.multiplicity}" if root.multiplicity > 1 else ""


def _printed(roots: Sequence[Root], digits: int) -> list[tuple[Root, str]]:
    """Return each root, one of a conjugate pair, with its value as text."""
    found = []
    for each in one_of_each_pair(roots):
        printed = each.root.decimal(digits).readable
        sign = "+-" if each.is_pair else "-" if printed.im.startswith("-") else "+"
        parts = [printed.re] if printed.re != "0" or printed.im == "0" else []
        parts += [f"{sign}{printed.im.lstrip('-')} j"] if printed.im != "0" else []
        found.append((each.root, " ".join(parts)))
    return found


def _vector_text(names: Sequence[str], vector: Sequence[acb]) -> str:
    return ", ".join(f"{name} {_short(x)}" for name, x in zip(names, vector, strict=True))


def _short(value: acb) -> str:
    """Return an entry of a direction; a part that may be zero is not told."""
    if value.is_zero():
        return "0"
    parts = (value.real, value.imag)
    re, im = ("" if x.contains(0) else figure(x, DIRECTION_DIGITS, trimmed=True) for x in parts)
    if im:
        return f"{re} {'-' if im.startswith('-') else '+'} {im.lstrip('-')} j".strip()
    return re or NEARLY_ZERO
