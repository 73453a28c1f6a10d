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


#: _real_numbers
def _real_numbers(xp, *arguments):
    """Return the library, and real numbers."""
    xp, arrays = _numbers(xp, 0.0, *arguments)
    if any(array.dtype == xp.complex128 for array in arrays[1:]):
        message = "real numbers or arrays of them are wanted"
        raise TypeError(message)
    return xp, arrays[1:]


#: _in_real_pieces
def _in_real_pieces(xp, tests, pieces, arguments):
    """Return the response at angular frequencies of any sign: conjugate at negative ones."""
    omega, *parameters = arguments
    is_negative = omega < 0.0
    positive = xp.where(is_negative, -omega, omega)
    value = _in_pieces(xp, tests, pieces, [positive, *parameters])
    return xp.where(is_negative, xp.conj(value), value)


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


#: _stacked
def _stacked(xp, values):
    """Return numbers and arrays as one array, along a new axis in front."""
    place = _place(xp, [value for value in values if hasattr(value, "dtype")])
    arrays = [xp.asarray(value, dtype=xp.complex128, **place) for value in values]
    shape = _shape(arrays)
    return xp.stack([xp.broadcast_to(array, shape) for array in arrays])


#: _largest _largest_root
def _largest(xp, values):
    """Return the largest of some real arrays, element by element."""
    found = values[0]
    for value in values[1:]:
        found = xp.where(value > found, value, found)
    return found


def _largest_root(xp, rows):
    """Return about the largest root of x^n + c_(n-1) x^(n-1) + ... + c_0."""
    n = rows.shape[0]
    sizes = [_size(xp, rows[i, ...]) ** (1.0 / (n - i)) for i in range(n)]
    found = _largest(xp, [xp.full_like(sizes[0], 1e-30), *sizes])
    return xp.where(xp.isfinite(sum(sizes)), found, xp.full_like(found, cmath.nan))


#: _propagated _matrix_product _squared
def _propagated(xp, coefficients):
    """Return h, h', ..., h^(n-1) at 1 for coefficients of any size.

    h solves h^(n) + c_(n-1) h^(n-1) + ... + c_0 h = 0 and starts from h^(n-1)(0) = 1 and
    zeros. The exponential of the companion matrix, by scaling and squaring: its first
    two axes are those of the matrix.
    """
    n = len(coefficients)
    rows = _stacked(xp, coefficients)
    size = _largest_root(xp, rows)
    one = xp.ones_like(rows[0, ...])
    companion = [[one * 0.0 for _ in range(n)] for _ in range(n)]
    for i in range(n - 1):
        companion[i][i + 1] = one * size
    companion[n - 1] = [-rows[i, ...] / size ** (n - 1 - i) for i in range(n)]
    # Each element has its own number of halvings: what others are must not matter.
    above_one = _largest(xp, [xp.ones_like(size), size])
    halvings = xp.ceil(xp.log2(above_one)) + 3.0
    halvings = xp.where(xp.isfinite(halvings), halvings, xp.full_like(halvings, 3.0))
    share = 2.0**-halvings
    small = xp.stack([xp.stack([x * share for x in row]) for row in companion])
    diagonal = [[one * float(i == k) for k in range(n)] for i in range(n)]
    identity = xp.stack([xp.stack(row) for row in diagonal])
    grown = _grown(xp, small, identity, halvings)
    one = xp.ones_like(size)
    known = xp.where(halvings > _MOST_HALVINGS, one * cmath.nan, one)
    return [grown[k, n - 1, ...] * size ** (k - n + 1.0) * known for k in range(n)]


_MOST_HALVINGS = 32
"""Of a matrix before its exponential is a series: exponents are below 2**29 then."""


def _matrix_product(xp, left, right):
    """Return the product of matrices whose rows and columns are the first two axes."""
    total = 0.0
    for k in range(left.shape[1]):
        total = total + left[:, k, None, ...] * right[k, None, :, ...]
    return total


def _squared(xp, matrix, is_wanted):
    """Return squares of matrices where they are wanted."""
    safe = xp.where(is_wanted, matrix, xp.zeros_like(matrix))
    return xp.where(is_wanted, _matrix_product(xp, safe, safe), matrix)


#: _grown
def _grown(xp, small, identity, halvings):
    """Return the exponential of a small matrix, squared as often as each element needs."""
    grown = identity
    for m in range(18, 0, -1):
        grown = identity + _matrix_product(xp, small, grown) / m
    for k in range(_MOST_HALVINGS):
        if _is_idle(xp, halvings > k):
            break
        grown = _squared(xp, grown, halvings > k)
    return grown


#: _characteristic_roots _first_roots _root_steps _shortened
def _characteristic_roots(xp, coefficients):
    """Return the roots of x^n + c_(n-1) x^(n-1) + ... + c_0, and the least distance of two.

    Steps of Aberth and Ehrlich from where the sizes of the coefficients say that roots
    are (Bini 1996). The last two steps give roots their derivatives.
    """
    n = len(coefficients)
    rows = _stacked(xp, coefficients)
    size = _largest_root(xp, rows)
    if n == 1:
        return [-rows[0, ...], size + cmath.inf]
    scaled = [rows[i, ...] / size ** (n - i) for i in range(n)]
    x = _settled(xp, scaled, _first_roots(xp, scaled))
    for _ in range(2):
        step = _root_steps(xp, scaled, x)
        x = x - xp.where(_size(xp, step) < 0.01, step, xp.zeros_like(step))
    found = [x[i, ...] * size for i in range(n)]
    apart = [-_size(xp, found[i] - found[k]) for i in range(n) for k in range(i)]
    return [*found, -_largest(xp, apart)]


def _first_roots(xp, scaled):
    """Return points of about the sizes of the roots, which Newton's polygon tells."""
    n = len(scaled)
    heights = [xp.log(_size(xp, c) + 1e-300) for c in scaled]
    heights.append(xp.zeros_like(heights[0]))
    found = []
    for j in range(1, n + 1):
        # The slope of the least concave curve above the points (i, heights[i]).
        slopes = [
            _largest(xp, [(heights[b] - heights[a]) / (b - a) for b in range(j, n + 1)])
            for a in range(j)
        ]
        radius = xp.exp(_largest(xp, [-slope for slope in slopes]))
        # By the golden angle points of a circle lie apart however many they are.
        turn = cmath.exp(1j * (2.399963229728653 * j + 0.7))
        found.append(xp.ones_like(scaled[0]) * turn * (radius + 1e-30))
    return xp.stack(found)


def _root_steps(xp, scaled, x):
    """Return how far roots are off, by the method of Aberth and Ehrlich."""
    value, slope = xp.ones_like(x), xp.zeros_like(x)
    for c in reversed(scaled):
        slope = slope * x + value
        value = value * x + c[None, ...]
    apart = x[:, None, ...] - x[None, ...]
    is_same = apart == 0.0
    one = xp.ones_like(apart)
    away = xp.where(is_same, xp.zeros_like(one), one / xp.where(is_same, one, apart))
    below = slope - value * xp.sum(away, axis=1)
    is_flat = below == 0.0
    one = xp.ones_like(below)
    step = value / xp.where(is_flat, one, below)
    return xp.where(is_flat | ~xp.isfinite(step), xp.zeros_like(step), step)


def _shortened(xp, step):
    """Return steps of a size of one at most."""
    size = _size(xp, step)
    return xp.where(size > 1.0, step / xp.where(size > 1.0, size, xp.ones_like(size)), step)


#: _settled
def _settled(xp, scaled, x):
    """Return roots after as many steps as each element needs."""
    moves = xp.ones_like(xp.real(x[0, ...])) > 0.0
    for _ in range(60):
        step = _shortened(xp, _root_steps(xp, scaled, x))
        x = xp.where(moves, x - step, x)
        shares = _size(xp, step) - 1e-9 * _size(xp, x)
        moves = moves & (_largest(xp, [shares[i, ...] for i in range(len(scaled))]) > 0.0)
        if _is_idle(xp, moves):
            break
    return x


#: copies


#: _modal_value
def _modal_value(xp, modes, coefficients, frames):
    """Return a sum of exponentials over the largest one, and the logarithm of that."""
    found = _modal_amplitudes(modes, coefficients, frames)
    growth = _largest(xp, [xp.real(exponent) for _, exponent in found])
    total = 0.0
    for amplitude, exponent in found:
        total = total + amplitude * xp.exp(exponent - growth)
    return [total, growth]


#: _larger
def _larger(xp, middle, product):
    """Return the larger root of x^2 - 2 middle x + product, without cancellation."""
    root = xp.sqrt(middle * middle - product)
    is_opposite = xp.real(root * xp.conj(middle)) < 0.0
    return middle + xp.where(is_opposite, -root, root)
