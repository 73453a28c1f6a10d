# Parts that take the place of those of array_api.py where the library is jax.

import cmath
import math

import jax
import jax.numpy as jnp
from jax import Array
from jax.typing import ArrayLike


#: _numbers _shape _shaped
def _numbers(*arguments):
    """Return s as complex and every parameter as real or complex numbers."""
    arrays = [jnp.asarray(value) for value in arguments]
    kinds = [jnp.issubdtype(array.dtype, jnp.complexfloating) for array in arrays]
    kinds[0] = True
    return [
        array.astype(jnp.complex128 if is_complex else jnp.float64)
        for array, is_complex in zip(arrays, kinds)
    ]


def _shape(arguments):
    """Return the shape of all arguments together."""
    return jnp.broadcast_shapes(*(argument.shape for argument in arguments))


def _shaped(value, arguments):
    """Return a value in the shape of all arguments together."""
    return jnp.broadcast_to(value, _shape(arguments))


#: _stacked
def _stacked(values, rows, columns):
    """Return values of single functions as a matrix, whose axes come first."""
    wide = jnp.stack(jnp.broadcast_arrays(*values))
    return wide.reshape(rows, columns, *wide.shape[1:])


#: _is_idle _found _size
def _is_idle(serves):
    """Tell that a piece serves no element; False where values are not known yet."""
    return not isinstance(serves, jax.core.Tracer) and not bool(jnp.any(serves))


def _found(piece, serves, arguments):
    """Return what a piece computes; compiled, zeros where it turns out to serve nothing."""
    if not isinstance(serves, jax.core.Tracer):
        return piece(*arguments)
    shape, kind = _shape(arguments), jnp.result_type(arguments[0], jnp.complex64)

    def whole():
        return jnp.broadcast_to(piece(*arguments), shape).astype(kind)

    return jax.lax.cond(jnp.any(serves), whole, lambda: jnp.zeros(shape, kind))


def _size(x):
    """Return the magnitude of what only keeps something else from vanishing."""
    return jax.lax.stop_gradient(jnp.abs(x))


#: _series_solutions _next_term
def _series_solutions(coefficients, terms):
    """Return the solutions of a linear differential equation at 1, by Taylor series.

    The equation is y^(n) + c_(n-1) y^(n-1) + ... + c_0 y = 0; solution k starts from
    y^(k)(0) = 1 and zeros for the other derivatives below n.
    """
    n = len(coefficients)
    given = [jnp.asarray(c, dtype=jnp.complex128) for c in coefficients]
    stacked = jnp.stack(jnp.broadcast_arrays(*given))
    shape = (n, n, *stacked.shape[1:])
    identity = jnp.eye(n, dtype=jnp.complex128)
    factorials = [math.factorial(m) for m in range(terms)]
    first = jnp.asarray([1.0 / f for f in factorials[:n]], dtype=jnp.complex128)
    ones = (1,) * (len(shape) - 2)
    state = (
        jnp.broadcast_to(jnp.reshape(identity, (n, n, *ones)), shape),
        jnp.broadcast_to(jnp.reshape(first, (n, *ones)), shape[1:]),
        stacked,
    )
    later = jnp.asarray([float(f) for f in factorials[n:]], dtype=jnp.float64)
    (_, total, _), _ = jax.lax.scan(_next_term, state, later)
    return list(total)


def _next_term(state, factorial):
    """Add a term to the series of all solutions; a loop is compiled faster than its terms."""
    derivatives, total, coefficients = state
    following = -jnp.sum(coefficients[:, None] * derivatives, axis=0)
    derivatives = jnp.concatenate([derivatives[1:], following[None]])
    return (derivatives, total + following / factorial, coefficients), None


#: _in_front
def _in_front(values, array):
    """Return numbers along an axis in front of those of an array."""
    made = jnp.asarray(values, dtype=jnp.complex128)
    return jnp.reshape(made, (len(values), *(1 for _ in array.shape)))
