"""What distinguishes Python modules over different libraries of arrays."""

from __future__ import annotations

import inspect
import keyword
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.algebra.modal_sum import modal_amplitudes, mode_values
from symflex.codegen.program import runtime
from symflex.codegen.source_parts import called_parts, parts_of

if TYPE_CHECKING:
    from collections.abc import Callable

COPIED = (
    runtime.complex_exp,
    runtime.series_solutions,
    runtime.propagated,
    runtime.characteristic_roots,
    mode_values,
    modal_amplitudes,
    runtime.modal_value,
    runtime.mean_over_circle,
)
"""Functions with which programs are measured; modules get copies where they have no others."""

_COPIES = ("copies",)


@dataclass(frozen=True, slots=True)
class Dialect:
    """Python for one library of arrays, or for any."""

    first: str  # first line of the module's docstring
    imports: str  # import statements
    # Files of ``codegen/sources`` with the functions that modules call; a second one replaces parts of the
    # first.
    sources: tuple[str, ...]
    space: str  # what functions are looked up in
    words: frozenset[str]  # names that parameters cannot have, besides Python's keywords
    # argument and result: Annotations.
    argument: str
    result: str
    array: str  # what docstrings call an argument
    returned: tuple[str, str]  # what docstrings call the value, and a sentence about it
    is_traced: bool = True  # true for functions without branches on values
    is_argument: bool = False  # true when ``space`` is an argument of every function
    has_fixed_sizes: bool = False  # true to leave magnitudes out of derivatives
    remark: str = ""  # last lines of the module's docstring

    @property
    def reserved(self) -> frozenset[str]:
        """Names a parameter cannot take in the generated code."""
        return frozenset({*keyword.kwlist, *self.words})

    def support(self, code: str) -> list[str]:
        """Return the functions that some code calls."""
        own = parts_of(*self.sources)
        defined = {name for names in own for name in names}
        parts: dict[tuple[str, ...], str] = {}
        for names, text in own.items():
            if names == _COPIES:
                wanted = (f for f in COPIED if f"_{f.__name__}" not in defined)
                parts |= {(f"_{f.__name__}",): private_copy(f) for f in wanted}
            else:
                parts[names] = text
        found = called_parts(code, parts, ("_numbers", "BLOCK"))
        return found if self.is_argument else [for_one_library(text, self.space) for text in found]


_PYTHON = frozenset({"s", "space", "arguments", "complex", "float"})
_MODULES = frozenset({"jax", "sys", "cmath", "math", "importlib", "Any", "Array", "ArrayLike"})

NUMPY_DIALECT = Dialect(
    "Transfer functions of a linear system as functions of numpy arrays.",
    "import numpy as np\nfrom numpy.typing import ArrayLike, NDArray\n",
    ("numpy.py",),
    "np",
    frozenset({"np", "s", "arguments", "complex", "ArrayLike", "NDArray"}),
    "ArrayLike",
    "complex | NDArray[np.complex128]",
    "array_like",
    ("complex or ndarray of complex", "A number when all arguments are numbers. Not finite at poles."),
    is_traced=False,
)

ARRAY_API_DIALECT = Dialect(
    "Transfer functions of a linear system over any library of arrays with the array API.",
    "import cmath\nimport importlib\nimport sys\nfrom typing import Any\n",
    ("array_api.py",),
    "xp",
    _PYTHON | _MODULES | {"xp"},
    "Any",
    "Any",
    "number or array",
    ("array of complex", "Of the same library; a number when numbers alone are given. Not finite at poles."),
    is_argument=True,
)

JAX_DIALECT = Dialect(
    "Transfer functions of a linear system as functions that jax compiles, maps and differentiates.",
    "import cmath\nimport math\n\nimport jax\nimport jax.numpy as jnp\n"
    "from jax import Array\nfrom jax.typing import ArrayLike\n",
    ("array_api.py", "jax.py"),
    "jnp",
    _PYTHON | _MODULES | {"jnp"},
    "ArrayLike",
    "Array",
    "array_like",
    ("Array of complex", "Not finite at poles."),
    has_fixed_sizes=True,
    remark="""\
Accuracy holds in double precision, which jax has to be told to use before anything else:

    jax.config.update("jax_enable_x64", True)
""",
)


def private_copy(function: Callable[..., object]) -> str:
    """Return the text of a run-time function of this package as a private one, without annotations.

    Raises
    ------
    ValueError
        When its text has no signature with a result.
    """
    text = inspect.getsource(function)
    signature = re.compile(r"def (\w+)\((.*?)\) -> .*?:(?:  # noqa[^\n]*)?\n", re.DOTALL)
    found = signature.match(text)
    if found is None:
        message = f"{function} has no signature"
        raise ValueError(message)
    names = re.findall(r"(\w+): ", found.group(2))
    body = re.sub(r"(\w): Any = ", r"\1 = ", text[found.end() :])
    body = re.sub(r"\b(complex_exp|modal_amplitudes)\(", r"_\1(", body)
    return f"def _{found.group(1)}({', '.join(names)}):\n{body}"


def for_one_library(text: str, name: str) -> str:
    """Return the text of functions with the argument ``xp`` replaced by a library's name.

    Examples
    --------
    >>> for_one_library("def _f(xp, x): return g(xp, xp.exp(x))", "jnp")
    'def _f(x): return g(jnp.exp(x))'
    """
    return re.sub(r"\bxp\.", f"{name}.", re.sub(r"\bxp, ", "", text))
