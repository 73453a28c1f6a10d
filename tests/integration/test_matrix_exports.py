"""Functions of whole matrices in Octave, Node, C and Julia, against the inverse of the dynamic stiffness."""

from __future__ import annotations

import ctypes
import subprocess
from dataclasses import replace

import numpy as np
import pytest

from symflex.codegen.c.module import C99
from symflex.codegen.javascript import JAVASCRIPT
from symflex.codegen.julia import JULIA
from symflex.codegen.matlab import MATLAB
from symflex.matrices.transfer_matrix import derive_matrix
from tests.integration.julia_in_python import functions_of
from tests.integration.node import Node
from tests.integration.octave import Octave
from tests.unit.codegen.test_c_files import STRICT, pointer
from tests.unit.matrices.models import model_of

ENDS = '[inputs]\nF = { force = "x_0" }\nR = { force = "x_2" }\n[outputs]\nX = "x_0"\nY = "x_2"\nZ = "x_3"\n'
ROWS = tuple(tuple(f"{y}/{u}" for u in "FR") for y in "XYZ")
OMEGA = np.array([0.1, 3.0, 41.0, 700.0, 1e6])


def chain(count):
    """Return masses on springs and dampers, and their matrix at j omega by hand."""
    lines = ["symflex = 1", "[elements]"]
    stiffness = np.zeros((count, count))
    for i in range(count):
        lines.append(f'm_{i} = {{ type = "mass", at = "x_{i}", m = {i + 1} }}')
        to = "ground" if i == count - 1 else f"x_{i + 1}"
        lines.append(f'k_{i} = {{ type = "spring", between = ["x_{i}", "{to}"], k = {1000 + 100 * i} }}')
        lines.append(f'd_{i} = {{ type = "damper", between = ["x_{i}", "{to}"], b = {10 + i} }}')
        ends = np.zeros(count)
        ends[i : i + 2] = [1, -1][: count - i]
        stiffness = stiffness + np.outer(ends, ends) * (1000 + 100 * i)
    damping = sum((10 + i) * np.outer(e, e) for i, e in enumerate(np.eye(count) - np.eye(count, k=1)))
    mass = np.diag(np.arange(count) + 1.0)
    values = [np.linalg.inv(stiffness + 1j * w * damping - w**2 * mass)[[0, 2, 3]][:, [0, 2]] for w in OMEGA]
    return "\n".join([*lines, ENDS]), np.moveaxis(np.array(values), 0, -1)


def exported(language, text):
    model = model_of(text)
    matrix = derive_matrix(model)
    return replace(language, rows=ROWS).export(model, matrix.each, "plant", samples=20)


def agrees(values, expected):
    return np.max(np.abs(values / expected - 1)) < 1e-12


@pytest.mark.slow
@pytest.mark.needs_tool("octave")
@pytest.mark.parametrize("count", [4, 8])
def test_a_matrix_in_octave_has_the_inverse_of_the_stiffness(tmp_path, count):
    text, expected = chain(count)
    octave = Octave(tmp_path)
    code = exported(MATLAB, text).text
    assert ("replaced(" in code) == (count == 8)  # values far out are another branch
    octave.write("plant", code)
    octave.do("G = plant();")
    key = octave.keep(f"G.transfer_matrix({octave.points(1j * OMEGA)})")
    size = octave.keep("size(G.transfer_matrix([1i 2i; 3i 4i; 5i 6i]))")
    octave.run()
    assert octave.value(size).tolist() == [3, 2, 3, 2]
    assert agrees(octave.value(key).reshape((3, 2, 5), order="F"), expected)


@pytest.mark.slow
@pytest.mark.needs_tool("node")
@pytest.mark.parametrize("count", [4, 8])
def test_a_matrix_in_node_has_the_inverse_of_the_stiffness(tmp_path, count):
    text, expected = chain(count)
    node = Node(tmp_path)
    module = node.write("plant", exported(JAVASCRIPT, text).text)
    arrays = f"[new Float64Array(5), Float64Array.from({OMEGA.tolist()})]"
    node.keep(f"{module}.transfer_matrix({arrays}).map((r) => r.map((z) => z.map((x) => Array.from(x))))")
    node.keep(f"{module}.transfer_matrix([0.0, 3.0])")
    node.run()
    many, one = (np.array(x) for x in node.values)
    assert agrees(many[:, :, 0] + 1j * many[:, :, 1], expected)
    assert agrees(one[:, :, 0] + 1j * one[:, :, 1], expected[:, :, 1])


@pytest.mark.slow
@pytest.mark.needs_tool("gcc")
@pytest.mark.parametrize("count", [4, 8])
def test_a_matrix_in_c_has_the_inverse_of_the_stiffness(tmp_path, count):
    text, expected = chain(count)
    (tmp_path / "plant.c").write_text(exported(C99, text).text)
    command = ["gcc", *STRICT, "-Wshadow", "-O1", "-shared", "-fPIC", "-o", "plant.so", "plant.c", "-lm"]
    subprocess.run(command, cwd=tmp_path, check=True, timeout=60)
    library = ctypes.CDLL(str(tmp_path / "plant.so"))
    real, imag = np.zeros(30), np.zeros(30)
    defaults = ctypes.byref(ctypes.c_char.in_dll(library, "model_defaults"))
    library.model_transfer_matrix_freq(*map(pointer, (OMEGA, real, imag)), ctypes.c_size_t(5), defaults)
    assert agrees((real + 1j * imag).reshape(3, 2, 5), expected)


@pytest.mark.parametrize("count", [4, 8])
def test_a_matrix_in_julia_has_the_inverse_of_the_stiffness(count):
    text, expected = chain(count)
    code = exported(JULIA, text).text
    assert "values = [complex(x) for x in _value_of_transfer_matrix(complex(float(s)))]" in code
    function = functions_of(code)["_value_of_transfer_matrix"]
    values = np.array([function(1j * w) for w in OMEGA]).T.reshape(3, 2, 5)
    assert agrees(values, expected)
