"""What a notebook shows: a kernel runs it, and its outputs are read back."""

import json
import math
import os
import shutil
import subprocess
import sys

import pytest

from tests.house.repository import ROOT

needs_kernel = pytest.mark.needs_module("nbclient", "ipykernel")
CELLS = (
    "import numpy as np, symflex\n"
    "model = symflex.load('derivations/eppinger1988/sliding_free_beam.toml'); model",
    "G = model.transfer_function('V_act', 'F'); G",
    "H = G.bind(); H",
    "H.pole_zero_map(modes=2)",
    "H.frequency_response(2*np.pi*np.geomspace(1, 500, 400))",
    "H.frequency_response(2*np.pi*np.geomspace(1, 500, 4001))",
    "H.frequency_response([1.0])",
)
# In a process of its own: what runs a kernel warns of much that is not ours.
RUN = """
import sys, nbclient, nbformat
for name in sys.argv[2:]:
    notebook = nbformat.read(name, as_version=4)
    where = {"metadata": {"path": sys.argv[1]}}
    nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3", resources=where).execute()
    nbformat.write(notebook, name)
"""
NOTEBOOKS = sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"))


@pytest.fixture(scope="module")
def executed(tmp_path_factory):
    """The cells of the notebook above and of those of the documentation, each run in a kernel, by name."""
    folder = tmp_path_factory.mktemp("notebooks")
    cell = {"cell_type": "code", "metadata": {}, "execution_count": None, "outputs": []}
    cells = [{**cell, "id": f"c{i}", "source": source} for i, source in enumerate(CELLS)]
    notebook = {"nbformat": 4, "nbformat_minor": 5, "metadata": {}, "cells": cells}
    (folder / "shown.ipynb").write_text(json.dumps(notebook), encoding="utf-8")
    for path in NOTEBOOKS:
        shutil.copy(path, folder)
    names = ["shown.ipynb", *(path.name for path in NOTEBOOKS)]
    own = {"PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "ignore", "IPYTHONDIR": str(folder)}
    command = [sys.executable, "-c", RUN, str(ROOT), *names]
    done = subprocess.run(
        command, cwd=folder, env={**os.environ, **own}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return {name: json.loads((folder / name).read_text(encoding="utf-8"))["cells"] for name in names}


@pytest.fixture(scope="module")
def outputs(executed):
    """The data of each cell's result, by MIME type."""
    return [
        next(o["data"] for o in cell["outputs"] if o["output_type"] == "execute_result")
        for cell in executed["shown.ipynb"]
    ]


def text(lines):
    return "".join(lines)


@pytest.mark.slow
@needs_kernel
def test_each_object_shows_in_its_own_way(outputs):
    kinds = [set(data) - {"text/plain"} for data in outputs]
    html, latex, svg, png = {"text/html"}, {"text/latex"}, {"image/svg+xml"}, {"image/png"}
    assert kinds == [html, latex, html, html, svg, png, set()]


@pytest.mark.slow
@needs_kernel
def test_a_model_shows_its_parameters(outputs):
    assert "<code>rho</code>" in text(outputs[0]["text/html"])


@pytest.mark.slow
@needs_kernel
def test_a_transfer_function_shows_as_an_equation(outputs):
    latex = text(outputs[1]["text/latex"])
    assert latex.startswith(r"$\displaystyle \begin{aligned}")
    assert r"p &= \frac{s}{a}" in latex  # Vaughan's form, which the model asks for


@pytest.mark.slow
@needs_kernel
def test_poles_and_zeros_show_as_a_table(outputs):
    html = text(outputs[3]["text/html"])
    # tan q + tanh q = 0 first at q = 2.365020372, omega = q^2 sqrt(E I/(rho A))/l^2
    first = 2.365020372**2 * math.sqrt(2e11 * 4e-9 / (7850 * 0.00048)) / 1.086**2
    assert f">&pm;{first:.6f}" in html
    assert "certified" in html


@pytest.mark.slow
@needs_kernel
def test_a_response_shows_as_a_drawing_and_a_long_one_as_a_raster(outputs):
    assert "<svg" in text(outputs[4]["image/svg+xml"])
    assert text(outputs[5]["image/png"]).startswith("iVBORw0KGgo")  # the signature of PNG in base 64
    assert text(outputs[6]["text/plain"]).startswith("<FrequencyResponse V_act/F")


@pytest.mark.slow
@needs_kernel
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_every_cell_of_a_notebook_of_the_documentation_shows_something(path, executed):
    rich = {"image/png", "image/svg+xml", "text/html", "text/latex"}
    cells = [cell for cell in executed[path.name] if "outputs" in cell]
    shown = [{kind for output in cell["outputs"] for kind in output.get("data", ())} for cell in cells]
    assert all(shown)
    plain = [text(cell["source"]) for cell, kinds in zip(cells, shown, strict=True) if not rich & kinds]
    assert all(".along(" in source for source in plain)  # an array of numpy


def test_notebooks_are_kept_without_what_they_print():
    assert len(NOTEBOOKS) == 3
    for path in NOTEBOOKS:
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        assert not any(cell.get("outputs") for cell in cells)
