"""The arrays of the playground do what numpy does."""

import importlib.util
from functools import partial

import numpy as np
import pytest

from tests.house.repository import ROOT

PATH = ROOT / "docs" / "playground" / "arrays.py"


@pytest.fixture(scope="module")
def small():
    spec = importlib.util.spec_from_file_location("arrays", PATH)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def like(made, expected):
    """Tell whether an array has the shape, the kind and the numbers of one of numpy."""
    expected = np.asarray(expected)
    if made.shape != expected.shape or made.kind != expected.dtype.kind.replace("u", "i"):
        return False
    return np.allclose(np.array(made.tolist()), expected, rtol=1e-14, atol=0, equal_nan=True)


NUMBERS = {
    "truths": [True, False, True],
    "integers": [3, -2, 0],
    "doubles": [1.5, -0.25, 0.0],
    "complex": [1 + 2j, -3j, 0.5 + 0j],
    "table": [[1.0, -2.0, 3.0], [0.5, 0.0, -7.0]],
    "column": [[2.0], [-1.0]],
    "number": 1.75,
}


@pytest.mark.parametrize("a", NUMBERS)
@pytest.mark.parametrize("b", NUMBERS)
def test_operators_give_the_same_kind_shape_and_numbers(small, a, b):
    x, y, u, v = small.array(NUMBERS[a]), small.array(NUMBERS[b]), np.array(NUMBERS[a]), np.array(NUMBERS[b])
    with np.errstate(all="ignore"):
        assert like(x + y, u + v) or {a, b} == {"truths"}
        assert like(x * y, u * v) or {a, b} == {"truths"}
        assert like(x == y, u == v)
        if "truths" not in (a, b):
            assert like(x - y, u - v)
            if "complex" not in (a, b):
                assert like(x / y, u / v)
                assert like(x < y, u < v)
                assert like(small.maximum(x, y), np.maximum(u, v))
        assert like(small.where(x, y, 0.0), np.where(u, v, 0.0))


FUNCTIONS = "exp log sqrt sin cos tan sinh cosh abs isfinite signbit nan_to_num real imag flatnonzero unique"


@pytest.mark.parametrize("name", FUNCTIONS.split())
def test_functions_of_doubles_have_the_same_values_also_where_there_is_none(small, name):
    doubles = [0.5, 2.0, -0.0, 0.0, -3.0, 800.0, -800.0, np.inf, -np.inf, np.nan]
    if name in ("unique", "sinh", "cosh", "tan", "sin", "cos"):
        doubles = doubles[:5]
    with np.errstate(all="ignore"):
        made, expected = getattr(small, name)(small.array(doubles)), getattr(np, name)(np.array(doubles))
        assert like(made, expected)
        if name in ("exp", "log", "sqrt", "sin", "cos", "abs", "real", "imag"):
            given = [1 + 2j, -2 + 0.5j, 0.25 - 3j]
            assert like(getattr(small, name)(small.array(given)), getattr(np, name)(np.array(given)))


KEYS = (
    "x[1]", "x[-1, 2]", "x[:, 1]", "x[1:, ::2]", "x[..., 0]", "x[:, None]", "x[x > 4.0]", "x[[2, 0]]",
    "x[np.array([0, 2]), np.array([1, 3])]", "x[:, [1, 1]]", "x[0][np.array([[0, 1], [2, 3]])]", "x.T[1]",
    "x.reshape(-1)[5]", "x.reshape(2, 6)", "x.any(axis=1)", "x.sum(axis=0)", "x.max()",
    "np.argmax(x, axis=0)",
    "np.argsort(x, axis=None, kind='stable')", "np.concatenate([x[0], x[1]])", "np.stack([x[0], x[1]])",
    "np.linspace(x[0], x[1], 5)", "np.geomspace(0.1, 50.0, 7)", "np.logspace(-2, 3, 6)", "np.arange(2, 9)",
    "np.add.outer(x[0], x[1])", "np.insert(x[0], 0, 9.0)", "np.nonzero(x - 1.0)[1]", "np.bincount([0, 2, 2])",
    "np.bincount([0, 2, 2], [1.5, 2.0, 1.0], 5)", "np.fft.fft(x, axis=1)", "np.cumsum(x[0])", "np.diff(x[1])",
    "np.broadcast_to(x[:, :1], (3, 5))", "np.eye(3)", "np.signbit(x[0, 1:]) != np.signbit(x[0, :-1])",
    "np.prod(x.shape, dtype=int)", "x.astype(complex).imag", "np.hypot(x[0], x[1])",
    "np.maximum.reduce([x[0], x[1], x[2]])", "np.minimum(x[0], 2.0).clip(0.0, 1.0)", "~(x > 3.0)",
    "x @ x.T", "x @ x[0]", "x[0] @ x[1]", "np.zeros((0, 4)) @ x[0]", "x.T @ np.array([1j, 2.0, 3.0])",
    "x.flat[3] * np.array([1.0, 2.0])", "np.zeros_like(x[0]) + 1", "-x[0] ** 2",
    "2.0 ** np.array([0.5, 3.0])",
)  # fmt: skip


@pytest.mark.parametrize("key", KEYS)
def test_places_reductions_and_makers_give_the_same(small, key):
    rows = [[float((3 * i + 5 * j) % 7) for j in range(4)] for i in range(3)]
    ask = partial(eval, key)  # of this file's own keys
    made, expected = (ask({"np": library, "x": library.array(rows)}) for library in (small, np))
    assert like(made, expected)


def test_a_slice_shows_what_it_was_cut_from_and_a_mask_does_not(small):
    for library in (small, np):
        x = library.zeros((2, 3))
        x[0][1] = 5.0
        x[1:][0] += 2.0
        x[x > 3.0] = 1.0
        chosen = x[[0]]
        chosen += 7.0
        z = library.zeros(2, dtype=complex)
        z.real, z.imag = library.array([1.0, 2.0]), 3.0
        assert (x.tolist(), z.tolist()) == ([[0.0, 1.0, 0.0], [2.0, 2.0, 2.0]], [1 + 3j, 2 + 3j])


def test_roots_of_polynomials_are_found(small):
    for coefficients in (
        [1.0, -6.0, 11.0, -6.0],
        [2.0, 0.0, 3.0, 1.0, 0.0],
        [1.0, 1e6, 1.0],
        [1.0, 2.0, 1.0],
    ):
        found = sorted(small.roots(coefficients).tolist(), key=lambda z: (round(z.real, 5), z.imag))
        expected = sorted(np.roots(coefficients).tolist(), key=lambda z: (round(z.real, 5), z.imag))
        assert np.allclose(found, expected, rtol=1e-6, atol=1e-9)


def test_what_is_missing_is_missed_as_a_library_is(small):
    for asked in (lambda: small.linalg, lambda: small.array([1.0]).partition):
        with pytest.raises(ModuleNotFoundError) as refusal:
            asked()
        assert refusal.value.name == "numpy"
