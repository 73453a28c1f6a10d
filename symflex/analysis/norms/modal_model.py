"""State equations of a few modes and a static correction, in doubles, and what fractions they are exactly.

Input: principal parts of a matrix of transfer functions. Output: :class:`ModalModel`.

Example: ``2/(s^2 + 0.2 s + 4)`` has the residue ``-0.5025j`` at ``-0.1 + 1.995j``; its block is

    A = [-0.1, -1.995; 1.995, -0.1]    B = [0.7089; 0]    C = [0, 1.4178]

where B and C share the size of the residue, so that each mode alone is balanced (Moore 1981). A residue of
rank r has r blocks. Poles of higher order have a chain for each input.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from flint import acb, arb

from symflex.analysis.norms.axis import ModalTerm
from symflex.roots import Root
from symflex.state_space.numeric import Arrays

RANK = 1e-12  # least singular value of a residue over its largest, rows and columns scaled

Residues = Mapping[int, npt.NDArray[np.complex128]]  # by the power of ``1/(s - p)``


@dataclass(frozen=True, eq=False)
class ModalModel:
    """``w' = A w + B u, y = C w + D u``, block by block."""

    arrays: Arrays
    terms: tuple[ModalTerm, ...]  # exactly what A, B and C are
    poles: tuple[complex, ...]  # of each block, one of a pair


class _Blocks:
    """Collects blocks of state equations and their fractions."""

    def __init__(self, shape: tuple[int, int]) -> None:
        self.shape = shape
        self.a: list[npt.NDArray[np.float64]] = []
        self.b: list[npt.NDArray[np.float64]] = []
        self.c: list[npt.NDArray[np.float64]] = []
        self.terms: list[ModalTerm] = []
        self.poles: list[complex] = []

    def add(
        self,
        pole: complex,
        chain: int,
        b: npt.NDArray[np.complex128],
        c: Sequence[npt.NDArray[np.complex128]],
    ) -> None:
        """Add a chain of states, ``z_1' = p z_1 + b u`` and ``z_k' = p z_k + z_(k - 1)``; y is ``c z``."""
        is_pair = pole.imag != 0
        size = 2 if is_pair else 1
        block = np.kron(np.eye(chain), _real(pole) if is_pair else np.array([[pole.real]]))
        block += np.kron(np.eye(chain, k=-1), np.eye(size))
        into = np.zeros((chain * size, self.shape[1]))
        into[:size] = np.vstack([b.real, b.imag]) if is_pair else b.real[None, :]
        out = [np.column_stack([2 * x.real, -2 * x.imag]) if is_pair else x.real[:, None] for x in c]
        self.a.append(block)
        self.b.append(into)
        self.c.append(np.hstack(out))
        self.poles.append(pole)
        for power, x in enumerate(c, 1):
            weights = {
                (i, j): _exact(x[i], is_pair) * _exact(b[j], is_pair)
                for i in range(self.shape[0])
                for j in range(self.shape[1])
                if x[i] and b[j]
            }
            self.terms.append(ModalTerm(_exact(pole, is_pair), power, weights))
            if is_pair:
                mirrored = {at: value.conjugate() for at, value in weights.items()}
                self.terms.append(ModalTerm(_exact(pole.conjugate(), is_pair), power, mirrored))


def _exact(number: complex, is_pair: bool) -> acb:
    return acb(number.real, number.imag if is_pair else 0)


def _real(pole: complex) -> npt.NDArray[np.float64]:
    return np.array([[pole.real, -pole.imag], [pole.imag, pole.real]])


def modal_model(
    residues: Sequence[tuple[Root, acb, Residues]], constant: Sequence[Sequence[arb]]
) -> ModalModel:
    """Return the equations of residues at poles, of each pair the one in the upper half-plane."""
    d = np.array([[float(x.mid()) for x in row] for row in constant])
    blocks = _Blocks(d.shape)
    for root, enclosure, by_power in residues:
        middle = complex(enclosure.mid())
        pole = complex(0.0 if root.on_imaginary_axis else middle.real, 0.0 if root.is_real else middle.imag)
        if max(by_power) == 1:
            for b, c in _ranks(by_power[1]):
                blocks.add(pole, 1, b, [c])
            continue
        for j in range(d.shape[1]):
            columns = [by_power[k][:, j] for k in range(1, max(by_power) + 1)]
            if any(column.any() for column in columns):
                blocks.add(pole, len(columns), np.eye(d.shape[1], dtype=complex)[j], columns)
    n = sum(len(a) for a in blocks.a)
    a = np.zeros((n, n))
    at = 0
    for block in blocks.a:
        a[at : at + len(block), at : at + len(block)] = block
        at += len(block)
    into = np.vstack(blocks.b) if n else np.zeros((0, d.shape[1]))
    out = np.hstack(blocks.c) if n else np.zeros((d.shape[0], 0))
    return ModalModel(Arrays(a, into, out, d), tuple(blocks.terms), tuple(blocks.poles))


def _ranks(
    residue: npt.NDArray[np.complex128],
) -> list[tuple[npt.NDArray[np.complex128], npt.NDArray[np.complex128]]]:
    """Return rows b and columns c whose products add up to a residue, as few as there need be."""
    rows, columns = (np.sqrt(np.abs(residue).max(axis=axis)) for axis in (1, 0))
    rows, columns = (np.where(x > 0, x, 1.0) for x in (rows, columns))
    u, sizes, v = np.linalg.svd(residue / rows[:, None] / columns[None, :], full_matrices=False)
    kept = [k for k, size in enumerate(sizes) if size > RANK * sizes[0]]
    parts = []
    for k in kept:
        b, c = np.sqrt(sizes[k]) * v[k] * columns, np.sqrt(sizes[k]) * u[:, k] * rows
        # Turned so that b begins with a real number, and both are as large.
        turn = b[np.argmax(np.abs(b))]
        turn = turn / abs(turn) * np.sqrt(np.linalg.norm(b) / np.linalg.norm(c))
        parts.append((b / turn, c * turn))
    return parts
