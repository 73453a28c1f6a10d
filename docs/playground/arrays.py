"""Arrays as symflex needs them where numpy does not run: what numpy does, in Python alone.

The page imports this file as ``numpy`` if no wheel of numpy lies beside it. Doubles in arrays guess where
roots are, and measure the accuracy of code; proofs are in balls, and the same with either. What is missing
here raises the error of a library that is not installed, which commands report.

    array([1.0, 0.0]) / 0.0    [inf, nan], without a word
    x[1:][0] = 2.0             changes x, since a slice shows what it was cut from
"""

import cmath
import contextlib
import math
import sys
from itertools import accumulate, product
from itertools import repeat as endless
from operator import mul
from types import ModuleType

nan, inf, pi, newaxis = math.nan, math.inf, math.pi, None
RANKS = "bifc"  # of kinds: truth values, integers, doubles, complex numbers
TINY, EPSILON = 2.2250738585072014e-308, 2.0**-52


def __getattr__(name):
    if name in AS_IN_PYTHON:
        return AS_IN_PYTHON[name]
    if name.startswith("__"):
        raise AttributeError(name)
    raise ModuleNotFoundError(f"No module named 'numpy.{name}'", name="numpy")


class _Type:
    """A type of numbers: what converts to it, and its kind."""

    def __init__(self, name, kind, convert, itemsize):
        self.name, self.kind, self.convert, self.itemsize = name, kind, convert, itemsize

    def __call__(self, value=0):
        return asarray(value, self)

    def __eq__(self, other):
        return self.kind == _kind_of(other)

    def __hash__(self):
        return hash(self.kind)


bool_ = _Type("bool", "b", bool, 1)
int64 = int32 = int16 = intp = _Type("int64", "i", int, 8)
float64 = float32 = _Type("float64", "f", float, 8)
complex128 = _Type("complex128", "c", complex, 16)
TYPES = {"b": bool_, "i": int64, "f": float64, "c": complex128}
_OF_PYTHON = {bool: "b", int: "i", float: "f", complex: "c", object: "f"}  # of objects, only none of them


def _kind_of(dtype):
    return dtype.kind if isinstance(dtype, _Type) else _OF_PYTHON[dtype]


def _shape(given):
    return tuple(map(int, given)) if isinstance(given, (tuple, list)) else (int(given),)


def _size(shape):
    return math.prod(shape)


class ndarray:
    """Numbers of one kind in a shape; ``at`` says where in ``base`` they are."""

    __slots__ = ("at", "base", "kind", "shape")

    def __init__(self, base, shape, kind, at=None):
        self.base, self.shape, self.kind = base, shape, kind
        self.at = range(len(base)) if at is None else at

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        raise ModuleNotFoundError(f"No module named 'numpy.{name}'", name="numpy")

    # ------------------------------------------------------------------------------------------- facts

    @property
    def flat(self):
        base = self.base
        return base if self.at == range(len(base)) else [base[i] for i in self.at]

    @property
    def dtype(self):
        return TYPES[self.kind]

    @property
    def ndim(self):
        return len(self.shape)

    @property
    def size(self):
        return len(self.at)

    @property
    def T(self):
        if self.ndim < 2:
            return self
        rows, columns = self.shape
        at = self.at
        return ndarray(
            self.base,
            (columns, rows),
            self.kind,
            [at[i * columns + j] for j in range(columns) for i in range(rows)],
        )

    @property
    def real(self):
        return self if self.kind != "c" else ndarray([z.real for z in self.flat], self.shape, "f")

    @real.setter
    def real(self, value):
        parts = broadcast_to(value, self.shape).flat
        for i, x in zip(self.at, parts, strict=True):
            self.base[i] = complex(x, self.base[i].imag)

    @property
    def imag(self):
        return ndarray(
            [z.imag for z in self.flat] if self.kind == "c" else [0.0] * self.size, self.shape, "f"
        )

    @imag.setter
    def imag(self, value):
        parts = broadcast_to(value, self.shape).flat
        for i, y in zip(self.at, parts, strict=True):
            self.base[i] = complex(self.base[i].real, y)

    def _one(self):
        if len(self.at) != 1:
            raise ValueError("the truth value or number of an array with several elements is ambiguous")
        return self.base[self.at[0]]

    def __float__(self):
        return float(self._one())

    def __complex__(self):
        return complex(self._one())

    def __int__(self):
        return int(self._one())

    def __index__(self):
        return self._one().__index__()

    def __bool__(self):
        return bool(self._one())

    def __hash__(self):
        return hash(self._one())

    def __format__(self, form):
        return format(self._one() if not self.shape else str(self), form)

    def __repr__(self):
        return repr(self.tolist())

    def __len__(self):
        return self.shape[0]

    def __iter__(self):
        return (self[i] for i in range(self.shape[0]))

    def __round__(self, digits=None):
        return round(self._one(), digits)

    def item(self):
        return self._one()

    def tolist(self):
        if not self.shape:
            return self._one()
        if len(self.shape) == 1:
            return list(self.flat)
        return [each.tolist() for each in self]

    def tobytes(self):
        return repr((self.shape, self.flat)).encode()

    def copy(self):
        return ndarray(list(self.flat), self.shape, self.kind)

    def astype(self, dtype):
        kind = _kind_of(dtype)
        return ndarray(list(map(TYPES[kind].convert, self.flat)), self.shape, kind)

    # ---------------------------------------------------------------------------------------- places

    def _places(self, key):
        """Return places in ``base``, the shape that a key selects, and whether it shows the same numbers."""
        if isinstance(key, ndarray) and key.kind == "b" and key.shape:
            inner = _size(self.shape[key.ndim :])
            rows = [i for i, x in enumerate(key.flat) if x]
            at = [self.at[i * inner + j] for i in rows for j in range(inner)]
            return at, (len(rows), *self.shape[key.ndim :]), False
        key = key if isinstance(key, tuple) else (key,)
        given = sum(k is not None and k is not Ellipsis for k in key)
        if not any(k is Ellipsis for k in key):
            key = (*key, Ellipsis)
        steps = [_size(self.shape[i + 1 :]) for i in range(self.ndim)]
        axes, shape, is_view, axis, fancy = [], [], True, 0, []
        for k in key:
            if k is None:
                shape.append(1)
            elif k is Ellipsis:
                for _ in range(self.ndim - given):
                    axes.append([i * steps[axis] for i in range(self.shape[axis])])
                    shape.append(self.shape[axis])
                    axis += 1
            elif isinstance(k, slice):
                chosen = range(*k.indices(self.shape[axis]))
                axes.append([i * steps[axis] for i in chosen])
                shape.append(len(chosen))
                axis += 1
            elif isinstance(k, int) or (isinstance(k, ndarray) and not k.shape):
                i = k.__index__()
                length = self.shape[axis]
                if not -length <= i < length:
                    raise IndexError(f"index {i} is out of bounds for {length}")
                axes.append([(i % length) * steps[axis]])
                axis += 1
            else:
                many = asarray(k)
                many = nonzero(many)[0] if many.kind == "b" else many
                fancy.append((len(axes), many, steps[axis], self.shape[axis], len(shape)))
                axes.append([0])
                axis += 1
                is_view = False
        if not fancy:
            offsets = [sum(o) for o in product(*axes)] if len(axes) != 1 else axes[0]
            return [self.at[i] for i in offsets], tuple(shape), is_view
        common = broadcast_shapes(*(k.shape for _, k, *_ in fancy))
        along = [0] * _size(common)
        for _, k, step, length, _ in fancy:
            along = [
                a + (i % length) * step for a, i in zip(along, broadcast_to(k, common).flat, strict=True)
            ]
        axes[fancy[0][0]] = along
        shape[fancy[0][4] : fancy[0][4]] = common
        return [self.at[sum(o)] for o in product(*axes)], tuple(shape), False

    def __getitem__(self, key):
        if isinstance(key, int) and len(self.shape) == 1:
            length = self.shape[0]
            if not -length <= key < length:
                raise IndexError(f"index {key} is out of bounds for {length}")
            return ndarray([self.base[self.at[key]]], (), self.kind)
        at, shape, is_view = self._places(key)
        if is_view and shape:
            return ndarray(self.base, shape, self.kind, at)
        return ndarray([self.base[i] for i in at], shape, self.kind)

    def __setitem__(self, key, value):
        at, shape, _ = self._places(key)
        given = asarray(value)
        convert = TYPES[self.kind].convert
        numbers = given.flat if given.shape == shape else broadcast_to(given, shape).flat
        for i, x in zip(at, numbers, strict=True):
            self.base[i] = convert(x)

    def reshape(self, *shape):
        shape = _shape(shape[0] if isinstance(shape[0], (tuple, list)) else shape)
        if -1 in shape:
            known = -_size(shape)
            shape = tuple(self.size // known if n == -1 else n for n in shape)
        return ndarray(self.base, shape, self.kind, self.at)

    def ravel(self):
        return self.reshape(-1)

    # -------------------------------------------------------------------------------------- reductions

    def _reduced(self, function, axis, kind):
        if axis is None:
            return ndarray([function(list(self.flat))], (), kind)
        axis %= self.ndim
        before, length, after = self.shape[:axis], self.shape[axis], self.shape[axis + 1 :]
        inner, flat = _size(after), self.flat
        made = [
            function([flat[(i * length + k) * inner + j] for k in range(length)])
            for i in range(_size(before))
            for j in range(inner)
        ]
        return ndarray(made, before + after, kind)

    def any(self, axis=None):
        return self._reduced(any, axis, "b")

    def all(self, axis=None):
        return self._reduced(all, axis, "b")

    def sum(self, axis=None):
        start = TYPES["i" if self.kind == "b" else self.kind].convert(0)
        return self._reduced(lambda x: sum(x, start), axis, "i" if self.kind == "b" else self.kind)

    def prod(self, axis=None):
        return self._reduced(math.prod, axis, "i" if self.kind == "b" else self.kind)

    def mean(self, axis=None):
        return self.sum(axis) / (self.size if axis is None else self.shape[axis])

    def max(self, axis=None, initial=None):
        start = [] if initial is None else [initial]
        return self._reduced(lambda x: _extreme(max, start + x), axis, self.kind)

    def min(self, axis=None):
        return self._reduced(lambda x: _extreme(min, x), axis, self.kind)

    def argmax(self, axis=None):
        return self._reduced(lambda x: max(range(len(x)), key=lambda i: (x[i] != x[i], x[i], -i)), axis, "i")

    def clip(self, min=None, max=None):
        found = self if min is None else maximum(self, min)
        return found if max is None else minimum(found, max)

    def conj(self):
        return conj(self)

    # -------------------------------------------------------------------------------------- arithmetic

    def __neg__(self):
        return ndarray([-x for x in self.flat], self.shape, self.kind)

    def __pos__(self):
        return self

    def __matmul__(self, other):
        other = asarray(other)
        columns = 1 if other.ndim == 1 else other.shape[1]
        kind = max(self.kind, other.kind, "i", key=RANKS.index)
        size, left, right = self.shape[-1], self.flat, other.flat
        start = TYPES[kind].convert(0)
        made = [
            sum(map(mul, left[i * size : (i + 1) * size], right[j::columns]), start)
            for i in range(_size(self.shape[:-1]))
            for j in range(columns)
        ]
        return ndarray(made, self.shape[:-1] + other.shape[1:], kind)

    def __abs__(self):
        return absolute(self)

    def __invert__(self):
        return ndarray([not x if self.kind == "b" else ~x for x in self.flat], self.shape, self.kind)


def _extreme(of, values):
    return next((x for x in values if x != x), None) or of(values)


def _quotient(a, b):
    try:
        return a / b
    except ZeroDivisionError:
        if isinstance(a, complex) or isinstance(b, complex):
            a = complex(a)
            b = math.copysign(0.0, complex(b).real)
            return complex(_quotient(a.real, b), _quotient(a.imag, b))
        if a == 0 or a != a:
            return nan
        return math.copysign(inf, a) * math.copysign(1.0, b)
    except OverflowError:
        return complex(nan, nan)


def _power(a, b):
    try:
        if isinstance(a, float) and a < 0 and isinstance(b, float) and b != int(b):
            return nan
        return a**b
    except ZeroDivisionError:
        return complex(nan, nan) if isinstance(a, complex) else inf
    except OverflowError:
        return complex(nan, nan) if isinstance(a, complex) else inf


def _remainder(a, b):
    return a % b if b else nan


BINARY = {  # what operators do, and the kind of what they give
    "add": (lambda a, b: a + b, None),
    "sub": (lambda a, b: a - b, None),
    "mul": (lambda a, b: a * b, None),
    "truediv": (_quotient, "f"),
    "pow": (_power, None),
    "floordiv": (lambda a, b: a // b, None),
    "mod": (_remainder, None),
    "and": (lambda a, b: a & b, None),
    "or": (lambda a, b: a | b, None),
    "xor": (lambda a, b: a ^ b, None),
}
COMPARED = {
    "lt": lambda a, b: a < b,
    "le": lambda a, b: a <= b,
    "gt": lambda a, b: a > b,
    "ge": lambda a, b: a >= b,
    "eq": lambda a, b: a == b,
    "ne": lambda a, b: a != b,
}


def _paired(function, a, b, kind=None, least=""):
    """Return a function of the elements of two arrays side by side."""
    a, b = asarray(a), asarray(b)
    if kind is None:
        kind = max(a.kind, b.kind, least or "b", key=RANKS.index)
        kind = "i" if kind == "b" and least != "b" else kind
    x, y = a.flat, b.flat
    if a.shape == b.shape:
        return ndarray(list(map(function, x, y)), a.shape, kind)
    if not b.shape:
        other = y[0]
        return ndarray([function(u, other) for u in x], a.shape, kind)
    if not a.shape:
        other = x[0]
        return ndarray([function(other, v) for v in y], b.shape, kind)
    shape = broadcast_shapes(a.shape, b.shape)
    return ndarray(list(map(function, broadcast_to(a, shape).flat, broadcast_to(b, shape).flat)), shape, kind)


def _define(name, function, least):
    logical = "b" if name in ("and", "or", "xor") else (least or "")

    def forward(self, other):
        if not _is_number(other):
            return NotImplemented
        return _typed(_paired(function, self, other, None, logical))

    def backward(self, other):
        if not _is_number(other):
            return NotImplemented
        return _typed(_paired(function, other, self, None, logical))

    def into(self, other):
        if not self.shape:
            return forward(self, other)
        self[...] = forward(self, other)
        return self

    setattr(ndarray, f"__{name}__", forward)
    setattr(ndarray, f"__r{name}__", backward)
    setattr(ndarray, f"__i{name}__", into)


def _is_number(value):
    return isinstance(value, (ndarray, int, float, complex, list, tuple))


def _typed(made):
    """Return an array whose numbers have the type of its kind."""
    wanted = {"f": float, "c": complex}.get(made.kind)
    if wanted and any(type(x) is not wanted for x in made.base):
        made.base[:] = [complex(x) if wanted is complex else _real(x) for x in made.base]
    return made


def _real(x):
    return x.real if isinstance(x, complex) else float(x)


for _name, (_function, _least) in BINARY.items():
    _define(_name, _function, _least)
for _name, _function in COMPARED.items():

    def _compared(self, other, function=_function):
        return _paired(function, self, other, "b") if _is_number(other) else NotImplemented

    setattr(ndarray, f"__{_name}__", _compared)


# ------------------------------------------------------------------------------------------- making arrays


def asarray(value, dtype=None):
    """Return numbers, lists of them, or an array, as an array."""
    if isinstance(value, ndarray):
        return value if dtype is None or _kind_of(dtype) == value.kind else value.astype(dtype)
    return array(value, dtype)


def array(value, dtype=None):
    """Return a new array."""
    if isinstance(value, ndarray):
        return value.copy() if dtype is None else value.astype(dtype)
    if isinstance(value, (bool, int, float, complex)):
        made = ndarray([value], (), _OF_PYTHON[type(value)])
    elif not isinstance(value, (list, tuple, range)):
        made = ndarray([float(value)], (), "f")
    else:
        items = list(value)
        if all(type(x) in _OF_PYTHON for x in items):
            parts = None
            base, shape = items, (len(items),)
            kinds = {_OF_PYTHON[type(x)] for x in items}
        else:
            parts = [asarray(x) for x in items]
            shape = (len(items), *(parts[0].shape if parts else ()))
            if any(p.shape != shape[1:] for p in parts):
                raise ValueError("the rows of an array have different shapes")
            base = [x for p in parts for x in p.flat]
            kinds = {p.kind for p in parts}
        kind = max(kinds, key=RANKS.index, default="f")
        convert = TYPES[kind].convert
        made = ndarray([x if type(x) is convert else convert(x) for x in base], shape, kind)
    return made if dtype is None or made.kind == _kind_of(dtype) else made.astype(dtype)


def full(shape, value, dtype=None):
    """Return an array of one number."""
    one = asarray(value, dtype)
    shape = _shape(shape)
    return ndarray([one.item()] * _size(shape), shape, one.kind)


def zeros(shape, dtype=float):
    """Return an array of zeros."""
    return full(shape, TYPES[_kind_of(dtype)].convert(0))


empty = zeros


def ones(shape, dtype=float):
    """Return an array of ones."""
    return full(shape, TYPES[_kind_of(dtype)].convert(1))


def zeros_like(like, dtype=None):
    """Return an array of zeros in the shape of another."""
    like = asarray(like)
    return zeros(like.shape, dtype or TYPES[like.kind])


empty_like = zeros_like


def eye(count):
    """Return a unit matrix."""
    return ndarray([float(i == j) for i in range(count) for j in range(count)], (count, count), "f")


def arange(*ends):
    """Return numbers a step apart."""
    if all(isinstance(x, int) for x in ends):
        return array(list(range(*ends)), int)
    low, high, step = (0.0, *ends, 1.0) if len(ends) == 1 else (*ends, 1.0)[:3]
    return array([low + i * step for i in range(math.ceil((high - low) / step))], float)


def linspace(low, high, count=50):
    """Return numbers at equal distances, along a first axis between arrays."""
    low, high = asarray(low, float), asarray(high, float)
    step = (high - low) / (count - 1)
    rows = [low + i * step for i in range(count - 1)]
    return stack([*rows, high + 0.0 * low])


def geomspace(low, high, count=50):
    """Return numbers in equal ratios."""
    first, last = math.log10(low), math.log10(high)
    inside = [10.0 ** (first + (last - first) * i / (count - 1)) for i in range(1, count - 1)]
    return array([float(low), *inside, float(high)])


def logspace(first, last, count=50):
    """Return powers of ten at equal distances of the exponent."""
    return array([10.0 ** (first + i * ((last - first) / (count - 1))) for i in range(count)])


def concatenate(parts, axis=0):
    """Return arrays one after the other along their first axis."""
    parts = [asarray(p) for p in parts]
    if axis:
        raise ModuleNotFoundError("No module named 'numpy.concatenate'", name="numpy")
    kind = max((p.kind for p in parts), key=RANKS.index)
    base = [TYPES[kind].convert(x) for p in parts for x in p.flat]
    return ndarray(base, (sum(p.shape[0] for p in parts), *parts[0].shape[1:]), kind)


def stack(parts, axis=0):
    """Return arrays side by side along a new axis."""
    made = array([asarray(p) for p in parts])
    return made if axis == 0 else made.T


def insert(values, place, value):
    """Return an array with one more element."""
    values = asarray(values)
    base = list(values.flat)
    base.insert(place, TYPES[values.kind].convert(value))
    return ndarray(base, (len(base),), values.kind)


def broadcast_shapes(*shapes):
    """Return the shape that arrays of these have together."""
    rank = max(map(len, shapes), default=0)
    padded = [(1,) * (rank - len(s)) + tuple(s) for s in shapes]
    result = []
    for sizes in zip(*padded, strict=True):
        others = {n for n in sizes if n != 1}
        if len(others) > 1:
            raise ValueError(f"shapes do not match: {shapes}")
        result.append(others.pop() if others else 1)
    return tuple(result)


def broadcast_to(value, shape):
    """Return an array repeated along axes of length one."""
    value = asarray(value)
    shape = _shape(shape)
    if value.shape == shape:
        return value
    padded = (1,) * (len(shape) - value.ndim) + value.shape
    if broadcast_shapes(padded, shape) != shape:
        raise ValueError(f"shape {value.shape} does not fit {shape}")
    if value.size == 1:
        return ndarray(value.base, shape, value.kind, [value.at[0]] * _size(shape))
    steps = [0 if n == 1 else _size(padded[i + 1 :]) for i, n in enumerate(padded)]
    axes = [[i * step for i in range(n)] for n, step in zip(shape, steps, strict=True)]
    return ndarray(value.base, shape, value.kind, [value.at[sum(o)] for o in product(*axes)])


def broadcast_arrays(*values):
    """Return arrays in the shape that they have together."""
    common = broadcast_shapes(*(shape(v) for v in values))
    return [broadcast_to(v, common) for v in values]


def atleast_1d(value):
    """Return an array with an axis."""
    value = asarray(value)
    return value if value.shape else value.reshape(1)


def shape(value):
    """Return the shape of numbers."""
    return asarray(value).shape


def ndim(value):
    """Return how many axes numbers have."""
    return len(shape(value))


def size(value):
    """Return how many numbers there are."""
    return asarray(value).size


# -------------------------------------------------------------------------------------- functions of elements


def _each(function, kinds):
    """Return a function of arrays; ``kinds`` maps kinds of arguments to those of values."""

    def of(value, *, dtype=None):
        value = asarray(value)
        kind = kinds.get(value.kind, value.kind)
        return ndarray([function(x) for x in value.flat], value.shape, kind)

    return of


def _elementary(of_real, of_complex, beyond):
    """Return a function whose value beyond doubles, or where it has none, is known."""

    def of(x):
        try:
            if isinstance(x, complex):
                return of_complex(x)
            return of_real(x)
        except (OverflowError, ValueError, ZeroDivisionError):
            found = beyond(x.real if isinstance(x, complex) else x)
            return complex(found, nan) if isinstance(x, complex) else found

    return _each(of, {"b": "f", "i": "f"})


def _log_beyond(x):
    return -inf if x == 0 else nan


exp = _elementary(math.exp, cmath.exp, lambda x: inf if x > 0 else nan)
log = _elementary(math.log, cmath.log, _log_beyond)
log2 = _elementary(math.log2, lambda z: cmath.log(z) / math.log(2), _log_beyond)
log10 = _elementary(math.log10, cmath.log10, _log_beyond)
exp2 = _elementary(lambda x: 2.0**x, lambda z: 2.0**z, lambda x: inf if x > 0 else nan)
sqrt = _elementary(math.sqrt, cmath.sqrt, lambda x: nan)
sin = _elementary(math.sin, cmath.sin, lambda x: nan)
cos = _elementary(math.cos, cmath.cos, lambda x: nan)
tan = _elementary(math.tan, cmath.tan, lambda x: nan)
sinh = _elementary(math.sinh, cmath.sinh, lambda x: math.copysign(inf, x))
cosh = _elementary(math.cosh, cmath.cosh, lambda x: inf)
tanh = _elementary(math.tanh, cmath.tanh, lambda x: nan)
atan = arctan = _elementary(math.atan, cmath.atan, lambda x: nan)
arccos = _elementary(math.acos, cmath.acos, lambda x: nan)


def _magnitude(x):
    try:
        return abs(x)
    except OverflowError:
        return inf


absolute = _each(_magnitude, {"c": "f"})
isfinite = _each(cmath.isfinite, dict.fromkeys(RANKS, "b"))
isnan = _each(cmath.isnan, dict.fromkeys(RANKS, "b"))
signbit = _each(lambda x: math.copysign(1.0, x) < 0, dict.fromkeys(RANKS, "b"))
sign = _each(lambda x: float((x > 0) - (x < 0)), {})
conj = _each(lambda x: x.conjugate(), {})
ceil = _each(lambda x: float(math.ceil(x)) if math.isfinite(x) else x, {})
rint = _each(lambda x: float(round(x)) if math.isfinite(x) else x, {})
iscomplexobj = lambda value: asarray(value).kind == "c"


def real(value):
    """Return real parts."""
    return asarray(value).real


def imag(value):
    """Return imaginary parts."""
    return asarray(value).imag


def nan_to_num(value, nan=0.0, posinf=1.7976931348623157e308, neginf=-1.7976931348623157e308):
    """Return an array with numbers in place of what is none."""
    stand_ins = {inf: posinf, -inf: neginf}
    return _each(lambda x: nan if x != x else stand_ins.get(x, x), {})(value)


def divide(a, b):
    """Return quotients."""
    return asarray(a) / b


def less(a, b):
    """Tell where one is less than the other."""
    return asarray(a) < b


def less_equal(a, b):
    """Tell where one is at most the other."""
    return asarray(a) <= b


def hypot(a, b):
    """Return lengths."""
    return _paired(math.hypot, a, b, "f")


class _Part:
    """A part of numpy of which something is here."""

    def __getattr__(self, name):
        raise ModuleNotFoundError(f"No module named 'numpy.{name}'", name="numpy")


class _Extreme(_Part):
    """The larger or the smaller of two, nan if one is."""

    def __init__(self, of):
        self.of = of

    def __call__(self, a, b):
        return _paired(lambda x, y: x if x != x else y if y != y else self.of(x, y), a, b, None, "i")

    def at(self, values, places, others):
        flat = values.flat
        for i, x in zip(asarray(places).flat, asarray(others).flat, strict=True):
            flat[i] = self.of(flat[i], x)
        values[...] = flat

    def reduce(self, parts):
        first, *others = parts
        for other in others:
            first = self(first, other)
        return first


maximum, minimum = _Extreme(max), _Extreme(min)


class _Add(_Part):
    """Sums of all pairs."""

    @staticmethod
    def outer(a, b):
        return asarray(a)[:, None] + asarray(b)[None, :]


add = _Add()


def where(condition, *values):
    """Return elements of one array where a condition holds, else those of another."""
    condition = asarray(condition)
    if not values:
        return nonzero(condition)
    a, b = map(asarray, values)
    common = broadcast_shapes(condition.shape, a.shape, b.shape)
    kind = max(a.kind, b.kind, key=RANKS.index)
    convert = TYPES[kind].convert
    rows = zip(*(broadcast_to(x, common).flat for x in (condition, a, b)), strict=True)
    return ndarray([convert(x if c else y) for c, x, y in rows], common, kind)


def nonzero(value):
    """Return the places of what is not zero, an array for each axis."""
    value = asarray(value)
    places = [i for i, x in enumerate(value.flat) if x]
    found = []
    for axis in range(value.ndim):
        inner = _size(value.shape[axis + 1 :])
        found.append(array([i // inner % value.shape[axis] for i in places], int))
    return tuple(found)


def flatnonzero(value):
    """Return the places of what is not zero, counted through."""
    return array([i for i, x in enumerate(asarray(value).flat) if x], int)


def unique(value):
    """Return the numbers that occur, ascending."""
    value = asarray(value)
    return ndarray(sorted(set(value.flat)), (len(set(value.flat)),), value.kind)


def sort(value):
    """Return numbers in their order."""
    value = asarray(value)
    return ndarray(sorted(value.flat), value.shape, value.kind)


def argsort(value, axis=-1, kind=None):
    """Return places in the order of the numbers at them."""
    flat = asarray(value).flat
    return array(sorted(range(len(flat)), key=flat.__getitem__), int)


def cumsum(value):
    """Return running sums."""
    value = asarray(value)
    return ndarray(list(accumulate(value.flat)), value.shape, value.kind)


def diff(value):
    """Return differences of neighbours."""
    value = asarray(value)
    return value[1:] - value[:-1]


def bincount(places, weights=None, minlength=0):
    """Return how often each number occurs, or the sum of weights at it."""
    places = asarray(places).flat
    found = [0 if weights is None else 0.0] * max([minlength, *(i + 1 for i in places)])
    for i, w in zip(places, endless(1) if weights is None else asarray(weights).flat, strict=False):
        found[i] += w
    return array(found, int if weights is None else float)


def any_of(value, axis=None):
    """Tell whether something is true."""
    return asarray(value).any(axis)


def all_of(value, axis=None):
    """Tell whether everything is true."""
    return asarray(value).all(axis)


def sum_of(value, axis=None):
    """Return a sum."""
    return asarray(value).sum(axis)


def prod(value, axis=None, dtype=None):
    """Return a product."""
    return asarray(value).prod(axis).astype(dtype) if dtype else asarray(value).prod(axis)


def mean(value, axis=None):
    """Return a mean."""
    return asarray(value).mean(axis)


def max_of(value, axis=None, initial=None):
    """Return the largest number."""
    return asarray(value).max(axis, initial)


def min_of(value, axis=None):
    """Return the least number."""
    return asarray(value).min(axis)


def argmax(value, axis=None):
    """Return the place of the largest number."""
    return asarray(value).argmax(axis)


AS_IN_PYTHON = {"abs": absolute, "any": any_of, "all": all_of, "sum": sum_of, "max": max_of, "min": min_of}
"""What is called as functions of Python are, which this file uses too."""


def roots(coefficients):
    """Return the roots of a polynomial, highest power first, by simultaneous steps (Aberth 1973)."""
    given = [complex(c) for c in asarray(coefficients).flat]
    while given and given[0] == 0:
        given.pop(0)
    zeros_at_0 = 0
    while given and given[-1] == 0:
        given.pop()
        zeros_at_0 += 1
    degree = len(given) - 1
    if degree < 1:
        return array([0j] * zeros_at_0, complex)
    monic = [c / given[0] for c in given]
    slope = [c * (degree - i) for i, c in enumerate(monic[:-1])]
    size = (abs(monic[-1]) ** (1 / degree)) or 1.0
    guess = [size * cmath.exp(1j * (2 * pi * k / degree + 0.4)) for k in range(degree)]
    for _ in range(200):
        largest = 0.0
        for k, z in enumerate(guess):
            value = derivative = 0j
            for c in monic:
                value = value * z + c
            for c in slope:
                derivative = derivative * z + c
            if value == 0:
                continue
            newton = _quotient(derivative, value)
            near = 0j
            for j, w in enumerate(guess):
                if j != k and w != z:
                    near += 1 / (z - w)
            step = _quotient(1.0, newton - near)
            if not cmath.isfinite(step):
                step = size * EPSILON**0.5
            guess[k] = z - step
            largest = max(largest, abs(step) / (abs(guess[k]) or 1.0))
        if largest < 4 * EPSILON:
            break
    return array([*guess, *([0j] * zeros_at_0)], complex)


class errstate(contextlib.ContextDecorator):
    """Says nothing in any case."""

    def __init__(self, **_):
        pass

    def __enter__(self):
        return self

    def __exit__(self, *_):
        return False


class finfo:
    """Limits of doubles."""

    tiny, eps, max = TINY, EPSILON, 1.7976931348623157e308

    def __init__(self, _=None):
        pass


class _Fourier(_Part):
    """Discrete Fourier transforms of a few samples."""

    @staticmethod
    def fft(value, axis=-1):
        value = asarray(value)
        count = value.shape[-1]
        turns = [cmath.exp(-2j * pi * k / count) for k in range(count)]
        flat, made = value.flat, []
        for row in range(value.size // count):
            part = flat[row * count : (row + 1) * count]
            made += [_plain_sum(x * turns[j * k % count] for j, x in enumerate(part)) for k in range(count)]
        return ndarray(made, value.shape, "c")


fft = _Fourier()


def _plain_sum(values):
    total = 0j
    for value in values:
        total += value
    return total


class NDArray:
    """What annotations name."""

    def __class_getitem__(cls, _):
        return cls


if __name__ == "numpy":
    typing = ModuleType("numpy.typing")
    typing.NDArray, typing.ArrayLike = NDArray, object
    sys.modules["numpy.typing"] = typing
