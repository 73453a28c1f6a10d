# What generated code for any library of arrays calls: parts, each under a line that says what
# it defines. The library is the argument xp.

import cmath
import importlib
import sys
from typing import Any


#: _namespace _place _numbers _shape _shaped
def _namespace(arguments):
    """Return the library that arrays belong to: numpy where there are numbers alone."""
    found = {}
    for value in arguments:
        if isinstance(value, (int, float, complex)):
            continue
        root = type(value).__module__.partition(".")[0]
        if root in ("numpy", "torch"):
            space = sys.modules[root]
        elif hasattr(value, "__array_namespace__"):
            space = value.__array_namespace__()
        else:
            message = f"numbers or arrays are wanted, not {type(value).__name__}"
            raise TypeError(message)
        found[space.__name__] = space
    if len(found) > 1:
        # Other libraries take numpy's arrays for their own.
        found.pop("numpy", None)
    if len(found) > 1:
        message = f"arrays of {' and '.join(found)} together"
        raise TypeError(message)
    return next(iter(found.values())) if found else importlib.import_module("numpy")


def _place(xp, arguments):
    """Return on which device numbers become arrays, as a keyword; none where libraries know."""
    if xp.__name__.partition(".")[0] not in ("numpy", "cupy", "jax"):
        for value in arguments:
            if type(value).__module__.partition(".")[0] != "numpy" and hasattr(value, "device"):
                return {"device": value.device}
    return {}


def _numbers(xp, *arguments):
    """Return the library, s as complex and every parameter as real or complex numbers."""
    xp = _namespace(arguments) if xp is None else xp
    place = _place(xp, arguments)
    arrays = []
    for i, value in enumerate(arguments):
        if isinstance(value, (int, float, complex)):
            is_complex = isinstance(value, complex)
            device = place
        elif hasattr(value, "dtype"):
            value = xp.asarray(value)
            is_complex = value.dtype in (xp.complex64, xp.complex128)
            device = {}
        else:
            message = f"numbers or arrays are wanted, not {type(value).__name__}"
            raise TypeError(message)
        dtype = xp.complex128 if is_complex or i == 0 else xp.float64
        arrays.append(xp.asarray(value, dtype=dtype, **device))
    return xp, arrays


def _shape(arguments):
    """Return the shape of all arguments together."""
    shapes = [tuple(argument.shape) for argument in arguments]
    together = []
    for sizes in zip(*((1,) * (max(map(len, shapes)) - len(x)) + x for x in shapes)):
        others = {size for size in sizes if size != 1}
        if len(others) > 1:
            message = f"shapes {', '.join(map(str, shapes))} do not go together"
            raise ValueError(message)
        together.append(others.pop() if others else 1)
    return tuple(together)


def _shaped(xp, value, arguments):
    """Return a value in the shape of all arguments together; a number of numpy's as one of Python's."""
    shape = _shape(arguments)
    if tuple(value.shape) != shape:
        value = xp.broadcast_to(value, shape)
    return complex(value) if not shape and xp.__name__ == "numpy" else value


#: _stacked
def _stacked(xp, values, rows, columns):
    """Return values of single functions as a matrix, whose axes come first."""
    xp = _namespace(values) if xp is None else xp
    place = _place(xp, values)
    arrays = [xp.asarray(value, dtype=xp.complex128, **place) for value in values]
    shape = _shape(arrays)
    wide = [array + xp.zeros(shape, dtype=xp.complex128, **place) for array in arrays]
    return xp.reshape(xp.stack(wide), (rows, columns, *shape))


#: _real_numbers
def _real_numbers(xp, *arguments):
    """Return what _numbers does, of real numbers alone."""
    xp, arrays = _numbers(xp, 0.0, *arguments)
    if any(array.dtype in (xp.complex64, xp.complex128) for array in arrays[1:]):
        message = "real numbers or arrays of them are wanted"
        raise TypeError(message)
    return xp, arrays[1:]


#: _in_pieces _serves
def _in_pieces(xp, tests, pieces, arguments):
    """Return the value of the piece that serves, element by element.

    A piece comes with a place where it is regular and with the results of tests under
    which it serves. Elsewhere it is evaluated at its place, so that neither its value
    nor its derivatives spoil anything.
    """
    s, *parameters = arguments
    held = tests(xp, s, *parameters)
    value = None
    for piece, place, cases in pieces:
        serves = _serves(held, cases)
        if _is_idle(xp, serves):
            continue
        safe = xp.where(serves, s, xp.full_like(s, place))
        found = _found(xp, piece, serves, [safe, *parameters])
        value = found if value is None else xp.where(serves, found, value)
    return (1+0j) * s if value is None else value


def _serves(held, cases):
    """Tell where tests have the results of one of some cases."""
    serves = None
    for case in cases:
        own = None
        for test, result in case:
            part = held[test] if result else ~held[test]
            own = part if own is None else own & part
        serves = own if serves is None else serves | own
    return serves


#: _is_idle _found
def _is_idle(xp, serves):
    """Tell that a piece serves no element; False where values are not known yet."""
    try:
        return not bool(xp.any(serves))
    except (TypeError, RuntimeError):
        # A function that is being traced: its arrays have no values.
        return False


def _found(xp, piece, serves, arguments):
    """Return what a piece computes."""
    return piece(xp, *arguments)


#: _series_solutions _is_zero
def _series_solutions(coefficients, terms):
    """Return the solutions of a linear differential equation at 1, by Taylor series.

    The equation is y^(n) + c_(n-1) y^(n-1) + ... + c_0 y = 0; solution k starts from
    y^(k)(0) = 1 and zeros for the other derivatives below n.
    """
    n = len(coefficients)
    used = [i for i in range(n) if not _is_zero(coefficients[i])]
    found = []
    first = 1.0
    for k in range(n):
        derivatives = [1.0 if i == k else 0.0 for i in range(n)]
        total = 1.0 / first
        first *= k + 1
        factorial = 1.0
        for m in range(1, terms):
            factorial *= m
            if m >= n:
                following = 0.0
                for i in used:
                    if not _is_zero(derivatives[i]):
                        following = following - coefficients[i] * derivatives[i]
                derivatives = [*derivatives[1:], following]
                if not _is_zero(following):
                    total = total + following / factorial
        found.append(total)
    return found


def _is_zero(x):
    """Tell that a value is the number zero whatever the arguments are."""
    return isinstance(x, float) and x == 0.0


#: _mean_over_circle
def _mean_over_circle(xp, parts, arguments, points):
    """Return numerator over denominator, each the mean of its values on a circle.

    Both are analytic, so the mean is the value at the center s, where the formula
    itself cancels. parts returns numerator, denominator, the logarithm of what both
    were divided by, and the radius.
    """
    s, *parameters = arguments
    s = xp.broadcast_to(s, _shape(arguments))
    _, _, center, radius = parts(xp, s, *parameters)
    turns = [cmath.exp(2j * cmath.pi * (k + 0.5) / points) for k in range(points)]
    circle = _in_front(xp, turns, s)
    num, den, growth, _ = parts(xp, s + radius * circle, *parameters)
    scale = xp.exp(growth - center)
    return xp.sum(num * scale, axis=0) / xp.sum(den * scale, axis=0)


#: _in_front
def _in_front(xp, values, array):
    """Return numbers along an axis in front of those of an array."""
    made = xp.asarray(values, dtype=xp.complex128, **_place(xp, [array]))
    return xp.reshape(made, (len(values), *(1 for _ in array.shape)))


#: _size
def _size(xp, x):
    """Return the magnitude."""
    return xp.abs(x)


#: _larger
def _larger(xp, middle, product):
    """Return the larger root of x^2 - 2 middle x + product, without cancellation."""
    root = xp.sqrt(middle * middle - product)
    is_opposite = xp.real(root * xp.conj(middle)) < 0.0
    return middle + xp.where(is_opposite, -root, root)
