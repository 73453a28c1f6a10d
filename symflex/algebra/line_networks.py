"""Transfer functions of networks of line elements in double precision, by solving at every frequency.

Eliminating one line element after the other divides by what vanishes where it vibrates between fixed ends,
and its solutions grow beyond double precision where it is long. So nothing is eliminated without a pivot, and
a line element is a relation P z(0) + Q z(l) = 0 of the states at its ends. That of a short piece, with
P = exp(A l) and Q = -1, comes from a Taylor series. Two pieces in a row become one of twice the length by
elimination of the state between them:

    P z(0) + Q z(l) = 0
    P z(l) + Q z(2l) = 0    give    P' z(0) + Q' z(2l) = 0, whose largest coefficients are made one

Relations and the rows of lumped elements are a banded matrix. It is solved with partial pivoting after rows
and unknowns have been scaled by powers of two.

These functions are copied into exported modules: they use numpy, each other, and nothing else. Arrays have
frequencies along their last axis.

A network is a table of numbers, ``(size, height, width, lumped, groups)``, and a list of entries:

* ``size`` is the number of unknowns; in elimination so many rows and columns are in use at a time;
* ``lumped``: row, column and entry of a coefficient. Output k is the row ``size + k``, input k the column
  ``size + k``;
* ``groups``: of line elements alike. Positions of the coefficients in A; signs with which unknowns are the
  state at the end; and for each element its first row, the entries of the coefficients and of the length, and
  the unknowns that are the state at the start and at the end, -1 where that is held to zero.
"""

from __future__ import annotations

from typing import Any

import numpy as np

Values = Any  # a number, an array of numbers, or a list of these: what numpy calculates with


def network_value(entries: list[Values], network: Values, output: int, source: int) -> Values:
    """Return what an output is per unit of an input, of a network with the given entries."""
    shape = np.broadcast_shapes(*(np.shape(e) for e in entries))
    given = [np.broadcast_to(e, shape).reshape(-1) if np.ndim(e) else e for e in entries]
    value = np.empty(int(np.prod(shape)), dtype=complex)
    # So many frequencies at once that intermediate values stay in the processor's cache.
    block = 512
    for start in range(0, value.size, block):
        part = value[start : start + block]
        values = np.empty((len(given), part.size), dtype=complex)
        for i, x in enumerate(given):
            values[i] = x[start : start + block] if np.ndim(x) else x
        part[:] = solved_network(values, network, output, source)
    return value.reshape(shape)[()]


def solved_network(values: Values, network: Values, output: int, source: int) -> Values:
    """Return the same for an array of entries at a few frequencies."""
    if not np.any(values.imag):
        # Without damping, on the axis: real numbers give the same digits in half the time.
        values = values.real
    size, height, _, lumped, groups = network
    places = [(row, column) for row, column, _ in lumped]
    parts = [values[[entry for _, _, entry in lumped]]]
    for positions, signs, elements in groups:
        parts.append(element_relations(values, positions, signs, elements))
        for row, _, _, start, end in elements:
            places += [(row + i, column) for i in range(len(signs)) for column in (*start, *end)]
    rows, columns = np.array(places).T
    kept = (columns >= 0) & ((rows < size) | (rows == size + output))
    kept &= (columns < size) | (columns == size + source)
    rows, columns = np.minimum(rows, size), np.minimum(columns, size)
    order = np.lexsort((columns, rows))
    order = order[kept[order]]
    rows, columns = rows[order], columns[order]
    first = np.flatnonzero(np.diff(rows * (size + 1) + columns, prepend=-1))
    coefficients = np.concatenate(parts)[order]
    if first.size < order.size:
        coefficients = np.add.reduceat(coefficients, first, axis=0)
        rows, columns = rows[first], columns[first]
    return solved_value(size, height, rows, columns, equilibrated(size, rows, columns, coefficients))


def size_of(x: Values) -> Values:
    """Return about the sizes of numbers, without roots."""
    return np.abs(x.real) + np.abs(x.imag) if np.iscomplexobj(x) else np.abs(x)


def element_relations(values: Values, positions: Values, signs: Values, elements: Values) -> Values:
    """Return the coefficients of line elements alike: of every element, row and end state, in this order."""
    n, count = len(signs), len(elements)
    length = values[[e[2] for e in elements]]
    matrix = {place: values[[e[1][k] for e in elements]] * length for k, place in enumerate(positions)}
    # States are scaled by powers of two that make rows and columns of A l alike.
    scales = np.zeros((n, *length.shape))
    sizes = {place: np.log2(size_of(x) + 1e-300) for place, x in matrix.items()}
    for _ in range(4):
        for k in range(n):
            above, below = np.full(length.shape, -40.0), np.full(length.shape, -40.0)
            for (i, j), x in sizes.items():
                if i == k != j:
                    above = np.maximum(above, x + scales[j] - scales[k])
                if j == k != i:
                    below = np.maximum(below, x + scales[k] - scales[i])
            scales[k] += 0.5 * (above - below)
    scales = np.rint(np.nan_to_num(scales, posinf=0.0, neginf=0.0))
    norm = np.zeros((n, *length.shape))
    for (i, j), x in matrix.items():
        matrix[i, j] = x * np.exp2(scales[j] - scales[i])
        norm[i] += np.abs(matrix[i, j])
    # Half the length so many times that the norm is 2 at most; what is not finite stays so.
    largest = np.nan_to_num(np.max(norm, axis=0), posinf=0.0)
    halvings = np.ceil(np.log2(np.maximum(largest, 1.0)) - 1.0).clip(0.0, 60.0)
    matrix = {place: x * np.exp2(-halvings) for place, x in matrix.items()}
    relation = np.zeros((n, 2 * n, *length.shape), dtype=values.dtype)
    for place, x in series_exponential(matrix, n).items():
        relation[place] = x
    for i in range(n):
        relation[i, n + i] = -1.0
    flat, left = relation.reshape(n, 2 * n, -1), halvings.reshape(-1)
    for k in range(int(np.max(left, initial=0.0))):
        where = np.flatnonzero(left > k)
        for start in range(0, where.size, 1024):
            some = where[start : start + 1024]
            flat[:, :, some] = doubled_relation(flat[:, :, some])
    for j in range(n):
        relation[:, j] *= np.exp2(-scales[j])
        relation[:, n + j] *= signs[j] * np.exp2(-scales[j])
    return np.moveaxis(relation, 2, 0).reshape(count * n * 2 * n, -1)


def series_exponential(matrix: Values, n: int) -> Values:
    """Return the entries, by position, of the exponential of a matrix of n rows with a norm of 2 at most."""
    power: Values = {(i, i): 1.0 for i in range(n)}
    total = dict(power)
    # 2**29 / 29! is the last bit of a double beside the fourth term, 2**3 / 3!, with which entries may begin.
    for m in range(1, 29):
        following: Values = {}
        for (i, k), x in matrix.items():
            for j in range(n):
                if (k, j) in power:
                    term = x * power[k, j]
                    following[i, j] = following[i, j] + term if (i, j) in following else term
        power = {place: x * (1.0 / m) for place, x in following.items()}
        for place, x in power.items():
            total[place] = total[place] + x if place in total else x
    return total


def doubled_relation(relation: Values) -> Values:
    """Return the relation between the ends of two elements in a row, its largest coefficients about one."""
    n, count = relation.shape[0], relation.shape[2]
    every = np.arange(count)
    rows = np.zeros((2 * n, 3 * n, count), dtype=relation.dtype)
    rows[:n, :n], rows[:n, n : 2 * n] = relation[:, n:], relation[:, :n]
    rows[n:, :n], rows[n:, 2 * n :] = relation[:, :n], relation[:, n:]
    flat = rows.reshape(-1)
    for k in range(n):
        pivot = k + np.argmax(size_of(rows[k:, k]), axis=0)
        places = (pivot * 3 * n + np.arange(k, 3 * n)[:, None]) * count + every
        top = flat[places]
        flat[places] = rows[k, k:]
        factor = rows[k + 1 :, k] * (1.0 / top[0])
        rows[k + 1 :, k + 1 :] -= factor[:, None] * top[1:]
    ends = rows[n:, n:]
    size = np.max(size_of(ends), axis=1)
    return ends * np.exp2(-np.rint(np.log2(size)))[:, None]


def equilibrated(size: int, rows: Values, columns: Values, coefficients: Values) -> Values:
    """Return coefficients times powers of two, about one but in the last row and column (Ruiz 2001)."""
    inner = (rows < size) & (columns < size)
    starts = np.flatnonzero(np.diff(rows, prepend=-1))
    by_column = np.argsort(columns, kind="stable")
    tops = np.flatnonzero(np.diff(columns[by_column], prepend=-1))
    sizes = np.log2(size_of(coefficients) + 1e-300).astype(np.float32)
    sizes[~inner] = -np.inf
    scale = np.zeros((2, size + 1, coefficients.shape[1]), dtype=np.float32)
    for _ in range(2):
        left = sizes + scale[0][rows] + scale[1][columns]
        most = np.maximum.reduceat(left, starts, axis=0), np.maximum.reduceat(left[by_column], tops, axis=0)
        scale[0][rows[starts]] -= 0.5 * np.where(np.isfinite(most[0]), most[0], 0.0)
        scale[1][columns[by_column][tops]] -= 0.5 * np.where(np.isfinite(most[1]), most[1], 0.0)
    scale = np.rint(scale)
    return coefficients * np.exp2(scale[0][rows] + scale[1][columns])


def solved_value(size: int, height: int, rows: Values, columns: Values, coefficients: Values) -> Values:
    """Return c x + d, where A x + b = 0, of ((A, b), (c, d)), with one refinement (Skeel 1980)."""
    count = coefficients.shape[1]
    starts = np.searchsorted(rows, np.arange(size + 2)).tolist()
    steps = eliminated(size, height, starts, columns, coefficients)
    solution = np.zeros((size + 1, count), dtype=coefficients.dtype)
    solution[size] = 1.0
    for _ in range(2):
        terms = coefficients * solution[columns]
        solution[:size] -= substituted(
            height, steps, np.add.reduceat(terms[: starts[size]], starts[:size], axis=0)
        )
    return np.sum(coefficients[starts[size] :] * solution[columns[starts[size] :]], axis=0)


def eliminated(size: int, height: int, starts: Values, columns: Values, coefficients: Values) -> Values:
    """Return the steps of Gauss's elimination with partial pivoting.

    Rows stand in the order of their first columns, and no more than ``height`` are in use at a time. For
    every column: the rows that begin to be used; the place of the last one in use; the pivot's, with which it
    changes place; the factors of the other rows; the pivot's inverse; and its row.
    """
    count = coefficients.shape[1]
    every = np.arange(count)
    window = np.zeros((height, size, count), dtype=coefficients.dtype)
    flat = window.reshape(-1)
    steps = []
    high = entered = end = 0
    for k in range(size):
        first = entered
        while entered < size and columns[starts[entered]] <= k:
            span = slice(starts[entered], starts[entered + 1])
            inner = columns[span] < size
            own = columns[span][inner]
            window[high, k:] = 0.0
            window[high, own] = coefficients[span][inner]
            end = max(end, int(own[-1]) + 1)
            high, entered = high + 1, entered + 1
        high -= 1
        sizes = window[: high + 1, k]
        pivot = np.argmax(size_of(sizes), axis=0)
        places = (pivot * size + np.arange(k, end)[:, None]) * count + every
        top = flat[places]
        flat[places] = window[high, k:end]
        inverse = 1.0 / top[0]
        factor = window[:high, k] * inverse
        window[:high, k + 1 : end] -= factor[:, None] * top[1:]
        steps.append((slice(first, entered), high, pivot, factor, inverse, top[1:]))
    return steps


def substituted(height: int, steps: Values, right: Values) -> Values:
    """Return the solution for a right side, from the steps of the elimination."""
    every = np.arange(right.shape[1])
    window = np.zeros((height, right.shape[1]), dtype=right.dtype)
    solution = np.empty_like(right)
    for k, (entering, high, pivot, factor, _, _) in enumerate(steps):
        window[high + 1 - (entering.stop - entering.start) : high + 1] = right[entering]
        driven = window[pivot, every]
        window[pivot, every] = window[high]
        window[:high] -= factor * driven
        solution[k] = driven
    for k in range(len(steps) - 1, -1, -1):
        inverse, top = steps[k][4:]
        solution[k] = (solution[k] - np.sum(top * solution[k + 1 : k + 1 + len(top)], axis=0)) * inverse
    return solution
