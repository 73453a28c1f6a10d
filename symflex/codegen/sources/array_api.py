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


#: _fundamental_minors _entries_along _parts_along _followed_along _keys_along _growth_along _every_minor _choices _chebyshev
def _fundamental_minors(xp, laws, start, length, bases, places, wanted, edges, limits, tip):
    """Return minors of Z(start + length) over the scales of their sizes, then the logarithms of these.

    Z' = A Z, and part k of A is laws[0](x)[k] times powers of the bases: places[k] holds its row,
    its column and these powers. The length is cut at edges, which are shares of it: between
    them functions of x are polynomials to the last digits, and waves grow little for bases up to
    their limits. Where bases are larger, or parameters make it otherwise, there is no number.
    Where a stiffness vanishes at the start, the first piece is that of a tip: see _begun_along.
    """
    n = 1 + max(max(place[:2]) for place in places)
    rule, beyond = _chebyshev(), edges[1:] if tip else edges
    parts, known = _parts_along(xp, rule, laws[0], start, length, places, beyond, limits, ())
    known = known & (_growth_along(xp, parts, places, n) < 6.0)
    followed = [_followed_along(xp, parts, places, range(n), [rule[2]] * n)]
    if tip:
        begun, is_known = _begun_along(xp, rule, laws[1], start, length * edges[1], tip, n, limits)
        followed, known = [begun, *followed], known & is_known
    reduced = [base / limit for base, limit in zip(bases, limits)]
    for base in reduced:
        known = known & (xp.abs(base) <= 1.0)
    reduced = [xp.where(known, base, xp.zeros_like(base)) for base in reduced]
    unit = xp.broadcast_to(xp.ones_like(reduced[0]), _shape([known, *reduced]))
    pieces = [_entries_along(xp, keys, total, reduced, unit, n) for keys, total in followed]
    found, scales = [None] * len(wanted), [xp.real(unit) * 0.0 for _ in range(n)]
    for order in sorted({len(rows) for rows, _ in wanted}):
        lines = _choices(n, order)
        starts = sorted({columns for rows, columns in wanted if len(rows) == order})
        state = xp.stack([xp.stack([unit * float(line == columns) for columns in starts]) for line in lines])
        for z in pieces:
            minors = _every_minor(z, order)
            zero = 0.0 * next(m for row in minors for m in row if m is not None)
            minors = [xp.stack([zero if m is None else m for m in row], axis=1) for row in minors]
            state, scales[order - 1] = _through(xp, xp.stack(minors, axis=1), state, scales[order - 1])
        for k, (rows, columns) in enumerate(wanted):
            if len(rows) == order:
                value = state[lines.index(rows), starts.index(columns), ...]
                found[k] = xp.where(known, value, xp.full_like(value, cmath.nan))
    return [*found, *scales]


def _entries_along(xp, keys, total, bases, unit, n):
    """Return the entries of Z of every piece; None stands for zero."""
    ladders = [[unit] for _ in bases]
    for ladder, base, most in zip(ladders, bases, map(max, zip(*(powers for _, _, powers in keys)))):
        for _ in range(most):
            ladder.append(ladder[-1] * base)
    found = [[None] * n for _ in range(n)]
    for i, k in sorted({key[:2] for key in keys}):
        own = [number for number, key in enumerate(keys) if key[:2] == (i, k)]
        values = xp.take(total, _table(xp, own, [total]), axis=0)
        axes = len(unit.shape) + 2 - len(values.shape)
        values = xp.reshape(values, (*values.shape[:2], *(1,) * axes, *values.shape[2:]))
        powers = [unit] * len(own)
        for base, ladder in enumerate(ladders):
            powers = [power * ladder[keys[number][2][base]] for power, number in zip(powers, own)]
        found[i][k] = xp.sum(values * xp.stack(powers)[:, None, ...], axis=0)
    return found


def _parts_along(xp, rule, along, start, length, places, edges, limits, ways):
    """Return the parts of A times the widths of pieces, and whether they are polynomials there.

    The first three axes are those of parts, points and pieces. Where parts are those of B at a tip, the
    powers of the way from there take the place of widths.
    """
    points, to_terms, _ = rule
    shares = [[a + (b - a) * p for a, b in zip(edges, edges[1:])] for p in points]
    shares = _table(xp, shares, [start, length])
    widths = _table(xp, [b - a for a, b in zip(edges, edges[1:])], [start, length])
    # Axes of parameters come last, so those of points and pieces stand before as many as any has.
    once = start + length * shares[-1, -1]
    axes = max(len(v.shape) for v in (once, *along(once)) if hasattr(v, "dtype"))
    shares = xp.reshape(shares, (*shares.shape, *(1,) * axes))
    widths = xp.reshape(widths, (*widths.shape, *(1,) * axes))
    to_terms = _table(xp, to_terms, [shares])
    to_terms = xp.reshape(to_terms, (*to_terms.shape, *(1,) * (axes + 1)))
    values = along(start + length * shares)
    parts, known = [], None
    for k, (value, (_, _, *powers)) in enumerate(zip(values, places)):
        scale = 1.0
        for limit, power in zip(limits, powers):
            scale *= limit**power
        factor = (length * shares) ** ways[k] if ways else length * widths
        parts.append(value * factor * scale + 0.0 * shares)
        spectrum = _size(xp, xp.sum(to_terms * parts[-1][None, ...], axis=1))
        terms = [spectrum[m, ...] for m in range(len(points))]
        own = _largest(xp, terms[-3:]) <= 1e-11 * _largest(xp, terms)
        known = own if known is None else known & own
    shape = _shape(parts)
    return xp.stack([xp.broadcast_to(part, shape) for part in parts]), xp.all(known, axis=0)


def _followed_along(xp, parts, places, first, integrals):
    """Return keys of what states have of the powers of the bases, and these at the end of every piece.

    A key is told by a state, the one of those ``first`` that it is followed from, and powers. Every
    row of A has integrals of its own.
    """
    keys, sources = _keys_along(places, first)
    # What is integrated alike: per part of A, of which entry it makes each, if it makes it.
    steps = []
    for own in {id(own): own for own in integrals}.values():
        made = {}
        for i, (key, pairs) in enumerate(zip(keys, sources)):
            for part, k in pairs if integrals[key[0]] is own else ():
                made.setdefault(part, {})[i] = k
        moves = []
        for part, before in made.items():
            is_made = [float(i in before) for i in range(len(keys))]
            is_made = xp.reshape(_table(xp, is_made, [parts]), (1, len(keys), *(1,) * (len(parts.shape) - 2)))
            moves.append((part, _table(xp, [before.get(i, 0) for i in range(len(keys))], [parts]), is_made))
        if moves:
            steps.append((_table(xp, own, [parts]), moves))
    nothing = 0.0 * parts[0, :, ...]
    begun = [nothing + float(i == k and not any(powers)) for i, k, powers in keys]
    return keys, _iterated(xp, parts, steps, xp.stack(begun, axis=1))


def _keys_along(places, first):
    """Return row, column and powers of the entries of Z, and what each is made of by one more factor A.

    That is a list of pairs: a part of A, and the entry before.
    """
    nothing = (0,) * (len(places[0]) - 2)
    keys = reached = [(i, i, nothing) for i in first]
    sources = {}
    for _ in range(_STEPS):
        following = []
        for part, (row, column, *powers) in enumerate(places):
            for key in reached:
                if key[0] == column:
                    made = (row, key[1], tuple(p + q for p, q in zip(key[2], powers)))
                    own = sources.setdefault(made, [])
                    if (part, key) not in own:
                        own.append((part, key))
                    if made not in following:
                        following.append(made)
        reached = following
        keys = keys + [key for key in reached if key not in keys]
    return keys, [[(part, keys.index(key)) for part, key in sources.get(made, ())] for made in keys]


def _growth_along(xp, parts, places, n):
    """Return by which power of e waves grow on a piece at most.

    Of a matrix without negative entries the largest eigenvalue is the norm, if states are
    scaled well: the growth of its powers, found by squaring.
    """
    sizes = [xp.sum(_size(xp, parts[k, ...]), axis=0) / parts.shape[1] for k in range(len(places))]
    rows = [[0.0 * sizes[0] for _ in range(n)] for _ in range(n)]
    for size, (row, column, *_) in zip(sizes, places):
        rows[row][column] = rows[row][column] + size
    matrix = xp.stack([xp.stack(row) for row in rows])
    grown, turns = 0.0, 10
    for _ in range(turns):
        most = xp.sum(xp.sum(matrix, axis=0), axis=0) + 1e-300
        grown = 2.0 * grown + xp.log(most)
        matrix = _matrix_product(xp, matrix / most, matrix / most)
    growth = xp.exp(grown / 2.0 ** (turns - 1))
    return _largest(xp, [growth[k, ...] for k in range(growth.shape[0])])


def _every_minor(z, order):
    """Return all minors of one size, expanded along their first rows; None stands for zero."""
    if order == 1:
        return z
    lines, inner = _choices(len(z), order), _choices(len(z), order - 1)
    smaller = _every_minor(z, order - 1)
    found = [[None] * len(lines) for _ in lines]
    for i, rows in enumerate(lines):
        for j, columns in enumerate(lines):
            for k, column in enumerate(columns):
                left = z[rows[0]][column]
                right = smaller[inner.index(rows[1:])][inner.index(columns[:k] + columns[k + 1 :])]
                if left is not None and right is not None:
                    term = left * right if k % 2 == 0 else -left * right
                    found[i][j] = term if found[i][j] is None else found[i][j] + term
    return found


def _choices(n, order):
    """Return all choices of so many of n lines."""
    found = [(i,) for i in range(n)]
    for _ in range(order - 1):
        found = [(*chosen, i) for chosen in found for i in range(chosen[-1] + 1, n)]
    return found


def _chebyshev():
    """Return points from 0 to 1, what makes Chebyshev's terms of values there, and their integrals."""
    order = 20
    cosine = [cmath.cos(cmath.pi * m / order).real for m in range(2 * order)]
    angles = [order - j for j in range(order + 1)]
    points = [0.5 + 0.5 * cosine[a] for a in angles]
    ends = [1.0 if 0 < j < order else 0.5 for j in range(order + 1)]
    to_terms = [
        [2.0 / order * ends[k] * e * cosine[k * a % (2 * order)] for e, a in zip(ends, angles)]
        for k in range(order + 1)
    ]

    def grown(m, a):
        above = cosine[(m + 1) * a % (2 * order)] / (2.0 * m + 2.0)
        if m < 2:
            return above * (1.0 + (m == 0))
        return above - cosine[(m - 1) * a % (2 * order)] / (2.0 * m - 2.0)

    primitives = [[grown(m, a) - grown(m, order) for m in range(order + 1)] for a in angles]
    integral = [
        [0.5 * sum(p * row[i] for p, row in zip(own, to_terms)) for i in range(order + 1)]
        for own in primitives
    ]
    return points, to_terms, integral


_STEPS = 42
"""Of Picard's iteration: terms are below 1e-18 where waves grow by e^6."""


#: _begun_along _from_tip
def _begun_along(xp, rule, along, start, way, tip, n, limits):
    """Return what _followed_along does, on the piece that begins at a tip, and whether it is known.

    With h the way from there z_i = h^powers_i v_i and h v' = B v, and along(x) holds parts of B. At h
    the state v_i is its value at the start or 0, and the integral over t from 0 to 1 of
    g_i(t h) t^(-b_i - 1), where g is B v without the diagonal b at the start.
    """
    places, powers, exponents, free = tip
    places, ways = [(i, k, *own) for i, k, _, *own in places], [place[2] for place in places]
    parts, known = _parts_along(xp, rule, along, start, way, places, (0.0, 1.0), limits, ways)
    # The mean of B is at least half of its integral over h, by which waves grow.
    known = known & (_growth_along(xp, parts, places, n) < 3.0)
    integrals = {b: _from_tip(rule, b) for b in exponents}
    keys, total = _followed_along(xp, parts, places, free, [integrals[b] for b in exponents])
    rows = [total[number, ...] * way ** powers[key[0]] for number, key in enumerate(keys)]
    return (keys, xp.stack(rows)), known


def _from_tip(rule, b):
    """Return what makes integrals over t from 0 to 1 of g(t h) t^(-b - 1) at points of values of g there.

    For b = 0 the value at the start, which vanishes, is taken away. What is integrated are polynomials,
    for which Fejer's rule is exact.
    """
    points, to_terms, _ = rule
    count = 2 * (len(points) - b)
    sums = [[0.0] * len(points) for _ in points]
    for q in range(count):
        angle = cmath.pi * (q + 0.5) / count
        cosines = [cmath.cos(2 * m * angle).real for m in range(1, count // 2)]
        weight = (1.0 - 2.0 * sum(c / (4.0 * m * m - 1.0) for m, c in enumerate(cosines, 1))) / count
        t = 0.5 - 0.5 * cmath.cos(angle).real
        for row, p in zip(sums, points):
            inside = cmath.acos(2.0 * t * p - 1.0).real
            for m in range(len(points)):
                value = cmath.cos(m * inside).real - ((-1.0) ** m if b == 0 else 0.0)
                row[m] += weight * t ** (-b - 1) * value
    return [[sum(v * own[j] for v, own in zip(row, to_terms)) for j in range(len(points))] for row in sums]


#: _table
def _table(xp, values, beside):
    """Return lists of numbers as an array where others are."""
    place = _place(xp, [value for value in beside if hasattr(value, "dtype")])
    dtype = xp.int64 if isinstance(values[0], int) else xp.float64
    return xp.asarray(values, dtype=dtype, **place)


#: _next_factor
def _next_factor(xp, parts, steps, state):
    """Return the integral from the start of every piece of A times a matrix, as points times keys."""
    following = 0.0
    for integral, moves in steps:
        slopes = 0.0
        for part, before, is_made in moves:
            slopes = slopes + parts[part, :, None, ...] * is_made * xp.take(state, before, axis=1)
        following = following + xp.tensordot(integral, slopes, axes=1)
    return following


#: _iterated
def _iterated(xp, parts, steps, first):
    """Return what entries of Z have of the powers of the bases, at the end of every piece."""
    state, total = first, first[-1, ...]
    for _ in range(_STEPS):
        state = _next_factor(xp, parts, steps, state)
        total = total + state[-1, ...]
    return total


#: _through
def _through(xp, minors, state, scale):
    """Return minors of the product of all pieces over their scale, and its logarithm."""
    for piece in range(minors.shape[0]):
        state, scale = _next_piece(xp, minors[piece, ...], state, scale)
    return state, scale


#: _next_piece
def _next_piece(xp, minors, state, scale):
    """Return minors and the logarithm of their scale after one more piece."""
    state = xp.sum(minors[:, :, None, ...] * state[None, ...], axis=1)
    size = xp.sum(xp.sum(_size(xp, state), axis=0), axis=0)
    return state / size, scale + xp.log(size)


#: copies


#: _modal_value
def _modal_value(xp, modes, coefficients, frames):
    """Return a sum of exponentials over the largest one, and the logarithm of that."""
    found = _modal_amplitudes(modes, coefficients, frames)
    return _scaled_sum(xp, [amplitude for amplitude, _ in found], [exponent for _, exponent in found])


#: _scaled_sum
def _scaled_sum(xp, amplitudes, exponents):
    """Return a sum of amplitudes times exponentials over the largest one, and the logarithm of that."""
    growth = _largest(xp, [xp.real(exponent) for exponent in exponents])
    total = 0.0
    for amplitude, exponent in zip(amplitudes, exponents):
        total = total + amplitude * xp.exp(exponent - growth)
    return [total, growth]


#: _larger
def _larger(xp, middle, product):
    """Return the larger root of x^2 - 2 middle x + product, without cancellation."""
    root = xp.sqrt(middle * middle - product)
    is_opposite = xp.real(root * xp.conj(middle)) < 0.0
    return middle + xp.where(is_opposite, -root, root)
