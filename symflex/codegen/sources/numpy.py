# What generated numpy code calls, besides program/evaluate.py: parts, each under a line
# that says what it defines.

import numpy as np
from numpy.typing import ArrayLike, NDArray


#: _numbers
def _numbers(
    s: ArrayLike, *parameters: ArrayLike
) -> tuple[NDArray[np.complex128], ...]:
    """Return s as complex and every parameter as real or complex numbers."""
    arrays = [np.asarray(value) for value in (s, *parameters)]
    for array in arrays:
        if array.dtype.kind not in "biufc":
            message = f"numbers or arrays of numbers are wanted, not {array.dtype}"
            raise TypeError(message)
    types = [complex, *(complex if a.dtype.kind == "c" else float for a in arrays[1:])]
    return tuple(
        a.astype(t, copy=False)[()] for a, t in zip(arrays, types, strict=True)
    )


#: BLOCK
BLOCK = 20480
"""Values computed at once, so that intermediate ones stay in the processor's cache."""


#: _in_blocks
def _in_blocks(function, arguments):
    """Return values in the shape of all arguments together: a number if all are."""
    shape = np.broadcast_shapes(*(np.shape(a) for a in arguments))
    if not shape:
        return complex(function(*arguments))
    value = np.empty(shape, dtype=complex)
    # Where arrays expand, what depends on one of them alone is computed once.
    expands = any(np.shape(a) not in ((), shape) for a in arguments)
    if expands or value.size <= BLOCK:
        value[...] = function(*arguments)
        return value
    flat = value.reshape(-1)
    columns = [a.reshape(-1) if np.ndim(a) else a for a in arguments]
    for start in range(0, flat.size, BLOCK):
        part = slice(start, start + BLOCK)
        flat[part] = function(*(a[part] if np.ndim(a) else a for a in columns))
    return value


#: _matrix_in_blocks
def _matrix_in_blocks(function, arguments, rows, columns):
    """Return all entries of a matrix, each in the shape of all arguments together."""
    block = BLOCK // 5  # more values are kept at once than for one entry
    shape = np.broadcast_shapes(*(np.shape(a) for a in arguments))
    value = np.empty((rows * columns, *shape), dtype=complex)
    expands = any(np.shape(a) not in ((), shape) for a in arguments)
    if expands or not shape or value[0].size <= block:
        for k, entry in enumerate(function(*arguments)):
            value[k] = entry
        return value.reshape(rows, columns, *shape)
    flat = value.reshape(rows * columns, -1)
    given = [a.reshape(-1) if np.ndim(a) else a for a in arguments]
    for start in range(0, flat.shape[1], block):
        part = slice(start, start + block)
        own = (a[part] if np.ndim(a) else a for a in given)
        for k, entry in enumerate(function(*own)):
            flat[k, part] = entry
    return value.reshape(rows, columns, *shape)


#: _stacked
def _stacked(values, rows, columns):
    """Return values of single functions as a matrix, whose axes come first."""
    value = np.array(np.broadcast_arrays(*values), dtype=complex)
    return value.reshape(rows, columns, *value.shape[1:])


#: _in_pieces
def _in_pieces(tests, pieces, arguments, unit):
    """Return the value of the piece that serves, element by element.

    Test i adds 2**i to the number of the piece where it holds. The unit, a power
    of 1j, is a factor that the pieces leave out.
    """
    shape = np.broadcast_shapes(*(np.shape(a) for a in arguments))
    if not shape:
        number = sum(2**i for i, holds in enumerate(tests(*arguments)) if holds)
        value = pieces[number](*arguments)
        if np.isfinite(value):
            is_turned = unit == 1j and np.isrealobj(value)
            return complex(0.0, value) if is_turned else complex(unit * value)
        # At a pole numbers are divided otherwise than arrays.
        given = (np.atleast_1d(arguments[0]), *arguments[1:])
        return complex(_in_pieces(tests, pieces, given, unit)[0])
    columns = [
        np.broadcast_to(a, shape).reshape(-1) if np.ndim(a) else a for a in arguments
    ]
    value = np.zeros(shape, dtype=complex)
    flat = value.reshape(-1)
    line = flat.imag if unit == 1j else flat.real
    for start in range(0, flat.size, BLOCK):
        part = flat[start : start + BLOCK]
        given = [a[start : start + BLOCK] if np.ndim(a) else a for a in columns]
        number, mixed = 0, False
        held = tests(*given)
        for i, holds in enumerate(held):
            if np.all(holds):
                number += 2**i
            elif np.any(holds):
                mixed = True
        if not mixed:
            found = pieces[number](*given)
            if np.iscomplexobj(found):
                part[:] = found if unit == 1 else unit * found
            else:
                line[start : start + BLOCK] = found
            continue
        numbers = sum(2**i * holds for i, holds in enumerate(held))
        for k in np.unique(numbers):
            where = np.broadcast_to(numbers == k, part.shape)
            found = pieces[k](*(a[where] if np.ndim(a) else a for a in given))
            if np.iscomplexobj(found):
                part[where] = unit * found
            else:
                line[start : start + BLOCK][where] = found
    return value


#: _in_array
def _in_array(tests, pieces, arguments):
    """Return what _in_pieces does, a number as part of an array.

    Minors magnify the last bit, which numbers may round differently.
    """
    shape = np.broadcast_shapes(*(np.shape(a) for a in arguments))
    given = (np.atleast_1d(arguments[0]), *arguments[1:])
    value = _in_pieces(tests, pieces, given, 1).reshape(shape)
    return value if shape else complex(value[()])


#: _in_real_pieces _real_numbers
def _in_real_pieces(tests, pieces, arguments, unit):
    """Return the response at angular frequencies of any sign.

    Pieces return values at a positive frequency, without the unit, 1 or 1j; at a
    negative one the response is conjugate.
    """
    omega, *parameters = arguments
    value = _in_pieces(tests, pieces, (np.abs(omega), *parameters), unit)
    is_negative = np.signbit(omega)
    if not np.shape(value):
        return value.conjugate() if is_negative else value
    if np.any(is_negative):
        np.negative(value.imag, out=value.imag, where=is_negative)
    return value


def _real_numbers(*arguments: ArrayLike) -> tuple[NDArray[np.float64], ...]:
    """Return real numbers."""
    arrays = [np.asarray(value) for value in arguments]
    for array in arrays:
        if array.dtype.kind not in "biuf":
            message = f"real numbers or arrays of them are wanted, not {array.dtype}"
            raise TypeError(message)
    return tuple(a.astype(float, copy=False)[()] for a in arrays)


#: _is_left
def _is_left(x, scale):
    """Tell where the real part of a product is negative."""
    if np.ndim(scale) == 0 and np.imag(scale) == 0.0 and np.real(scale) > 0.0:
        return np.real(x) < 0.0
    return np.real(scale * x) < 0.0


#: copies
