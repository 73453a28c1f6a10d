"""Generated code at work: Python modules imported, C compiled and loaded."""

from __future__ import annotations

import ctypes
import importlib.util
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

FLAGS = {"-O2": ("-std=c99", "-O2"), "-O2 -march=native": ("-std=c99", "-O2", "-march=native")}
"""C is compiled once for any processor, and once for this one."""


def imported(text: str, name: str) -> Any:  # noqa: ANN401
    """Return the module of some Python code.

    Raises
    ------
    RuntimeError
        When it cannot be imported.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{name}.py"
        path.write_text(text, encoding="utf-8")
        spec = importlib.util.spec_from_file_location(name, path)
        if spec is None or spec.loader is None:
            message = f"the exported module {name} cannot be imported"
            raise RuntimeError(message)
        module = importlib.util.module_from_spec(spec)
        sys.modules[spec.name] = module
        spec.loader.exec_module(module)
    return module


def loaded(files: Mapping[str, str], flags: Sequence[str]) -> ctypes.CDLL:
    """Return the library that ``cc`` makes of some files, by their names."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        sources = [name for name in files if name.endswith(".c")]
        subprocess.run(
            ["cc", *flags, "-shared", "-fPIC", "-o", "library.so", *sources, "-lm"], cwd=folder, check=True
        )
        return ctypes.CDLL(str(Path(folder) / "library.so"))


def responding(
    library: ctypes.CDLL, stem: str, pair: str, omega: NDArray[Any], part: int
) -> Callable[[], NDArray[Any]]:
    """Return what computes the frequency response of a function in exported C: part 0 real, 1 imaginary."""
    found = np.empty((2, omega.size))
    defaults = ctypes.c_double.in_dll(library, f"{stem}_defaults")
    compute = getattr(library, f"{stem}_{pair}_freq")
    arguments = (*map(pointer, (omega, *found)), ctypes.c_size_t(omega.size), ctypes.byref(defaults))

    def run() -> NDArray[Any]:
        compute(*arguments)
        values: NDArray[Any] = found[part]
        return values

    return run


def pointer(array: NDArray[Any]) -> Any:  # noqa: ANN401
    """Return a pointer to an array of doubles."""
    return array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
