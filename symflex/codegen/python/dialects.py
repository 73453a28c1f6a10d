"""Python for numpy, for any library of arrays, and for jax: what the modules written for them differ in.

A dialect names its library's functions, the annotations of arguments and results, and the files of
``codegen/sources`` whose functions its modules get copies of.
"""

from __future__ import annotations

import inspect
import keyword
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

from symflex.algebra import line_networks
from symflex.along import doubles
from symflex.codegen.export import called_parts, parts_of
from symflex.codegen.program import evaluate

COPIED = (  # functions with which programs are measured; modules get copies where they have no others
    evaluate.complex_exp,
    evaluate.series_solutions,
    doubles.fundamental_minors,
    doubles.minors_by_octaves,
    doubles.polynomials_along,
    doubles.begun_along,
    doubles.edges_along,
    doubles.parts_at,
    doubles.minors_through,
    doubles.lines_of,
    doubles.compound,
    doubles.chebyshev_points,
    line_networks.network_value,
    line_networks.solved_network,
    line_networks.size_of,
    line_networks.element_relations,
    line_networks.series_exponential,
    line_networks.doubled_relation,
    line_networks.equilibrated,
    line_networks.solved_value,
    line_networks.eliminated,
    line_networks.substituted,
    evaluate.scaled_sum,
    evaluate.mean_over_circle,
)
_COPIES = ("copies",)
_OWN = "|".join(f.__name__ for f in COPIED)  # names of functions that call each other


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
        parts: dict[tuple[str, ...], str] = {}
        for names, text in parts_of(*self.sources).items():
            if names != _COPIES:
                parts[names] = text
                continue
            for function in COPIED:
                parts[f"_{function.__name__}",] = private_copy(function)
        texts = called_parts(code, parts, ("_numbers", "BLOCK"))
        return texts if self.is_argument else [for_one_library(text, self.space) for text in texts]


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
    ("array of complex", "Of the same library; a number if all arguments are numbers. Not finite at poles."),
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
Accuracy holds in double precision. Switch it on in jax before anything else:

    jax.config.update("jax_enable_x64", True)
""",
)


@cache
def private_copy(function: Callable[..., object]) -> str:
    """Return the text of a run-time function of this package as a private one, without annotations."""
    text = inspect.getsource(function)
    signature = re.compile(r"def (\w+)\((.*?)\) -> .*?:(?:  # noqa[^\n]*)?\n", re.DOTALL)
    head = signature.match(text)
    assert head is not None
    names = re.findall(r"(\w+): ", head.group(2))
    body = re.sub(r"(\w): Any = ", r"\1 = ", text[head.end() :])
    body = re.sub(rf"(?<!\.)\b({_OWN})\(", r"_\1(", body)
    return f"def _{head.group(1)}({', '.join(names)}):\n{body}"


def for_one_library(text: str, name: str) -> str:
    """Return the text of functions with the argument ``xp`` replaced by a library's name."""
    return re.sub(r"\bxp\.", f"{name}.", re.sub(r"\bxp, ", "", text))
