"""Transfer functions as one self-contained Python module over any library of arrays, or over jax.

Input: transfer functions and the model they come from.
Output: an :class:`ArrayModule`, the module's text and how well each function agrees with ball arithmetic.

Both kinds of module are the same text but for its preamble: where functions of arrays come from, and how
arguments become arrays.
"""

from __future__ import annotations

import keyword
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.algebra import modal_amplitudes, mode_values
from symflex.codegen.array.pieces import ArrayPieces
from symflex.codegen.members import members_of, verifications
from symflex.codegen.module_text import COST, ITERATED, default_value
from symflex.codegen.numpy.expression import statement
from symflex.codegen.numpy.pieces import private_copy
from symflex.codegen.program import Piecewise, Verification, identifiers, nearest_double
from symflex.codegen.program.calls import RuntimeCalls
from symflex.codegen.program.everywhere import in_pieces
from symflex.codegen.python_text import (
    Signature,
    function_docstring,
    function_table,
    header,
    parameter_table,
    public_names,
)
from symflex.codegen.source_parts import called_parts, parts_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    from symflex.model import Model
    from symflex.transfer import AnyTransferFunction

NAMES_IN_USE = frozenset({"s", "space", "arguments", "complex", "float"})

LINTS = (
    "ANN001, ANN201, ANN202, ANN401, B905, E501, E741, N802, N803, N806, N816, PLR0912, PLR0914, PLR0915, "
    "PLR2004, PLW2901, RUF001, RUF002, RUF005, RUF100"
)

MEASURED = (
    "The error is that of the same operations in numpy; another library's rounding differs in the last digit."
)


@dataclass(frozen=True, slots=True)
class Dialect:
    """What distinguishes modules over different libraries of arrays.

    Parameters
    ----------
    name : str
        The export target.
    first : str
        First lines of the module's docstring.
    imports : str
        Import statements.
    source : tuple of str
        Files of the functions that are called.
    space : str
        What functions are looked up in.
    is_argument : bool
        True when ``space`` is an argument of every function.
    argument, result : str
        Annotations.
    array : str
        What docstrings call an argument.
    returned : tuple of str
        What docstrings call the value, and a sentence about it.
    has_fixed_sizes : bool
        True to leave magnitudes in conditions out of derivatives.
    """

    name: str
    first: str
    imports: str
    source: tuple[str, ...]
    space: str
    is_argument: bool
    argument: str
    result: str
    array: str
    returned: tuple[str, str]
    has_fixed_sizes: bool = False

    @property
    def reserved(self) -> frozenset[str]:
        """Names a parameter cannot take in the generated code."""
        modules = {"jax", "sys", "cmath", "math", "importlib", "Any", "Array", "ArrayLike"}
        return frozenset({*keyword.kwlist, *NAMES_IN_USE, *modules, self.space})

    @property
    def parts(self) -> dict[tuple[str, ...], str]:
        """What generated code calls."""
        found: dict[tuple[str, ...], str] = {}
        for names, text in parts_of(*self.source).items():
            if "_modal_value" in names:
                found |= {(f"_{f.__name__}",): private_copy(f) for f in (mode_values, modal_amplitudes)}
            found[names] = text
        return found

    def support(self, text: str) -> str:
        """Return support in the words of this dialect."""
        return text if self.is_argument else for_one_library(text, self.space)


ARRAY_API = Dialect(
    "array-api",
    "Transfer functions of a linear system over any library of arrays with the array API.",
    "import cmath\nimport importlib\nimport sys\nfrom typing import Any\n",
    ("array_api.py",),
    "xp",
    True,
    "Any",
    "Any",
    "number or array",
    ("array of complex", "Of the same library; a number when numbers alone are given. Not finite at poles."),
)

JAX = Dialect(
    "jax",
    "Transfer functions of a linear system as functions that jax compiles, maps and differentiates.",
    "import cmath\nimport math\n\nimport jax\nimport jax.numpy as jnp\n"
    "from jax import Array\nfrom jax.typing import ArrayLike\n",
    ("array_api.py", "jax.py"),
    "jnp",
    False,
    "ArrayLike",
    "Array",
    "array_like",
    ("Array of complex", "Not finite at poles."),
    has_fixed_sizes=True,
)

DOUBLE_PRECISION = """\
Accuracy holds in double precision, which jax has to be told to use before anything else:

    jax.config.update("jax_enable_x64", True)
"""


@dataclass(frozen=True, slots=True)
class ArrayModule:
    """A generated module.

    Parameters
    ----------
    text : str
        The module's source.
    verified : tuple of Verification
        One per transfer function, in the order of the module, then one per frequency response.
    """

    text: str
    verified: tuple[Verification, ...]


def array_module(
    tfs: Sequence[AnyTransferFunction],
    model: Model,
    dialect: Dialect = ARRAY_API,
    band_hz: tuple[Fraction, Fraction] | None = None,
    *,
    samples: int = 400,
    digits: int = 2,
) -> ArrayModule:
    """Return a module with one function ``OUT_over_IN(s, *, parameter=default, ...)`` per transfer function.

    Lossless distributed systems get a second one, ``OUT_over_IN_at(omega, *, ...)``: the frequency response
    in real arithmetic. Functions are those of
    :func:`~symflex.codegen.numpy.module.numpy_module`, verified in the same way,
    but without branches on values: what is not selected is evaluated where it is regular, so that
    derivatives are finite.

    Parameters
    ----------
    tfs : sequence of TransferFunction
        Of ``model``; a transfer function given twice is written once.
    model : Model
        Title, source and parameters.
    dialect : Dialect
        :data:`ARRAY_API` or :data:`JAX`.
    band_hz : tuple of Fraction, optional
        Where the error is measured [Hz]; by default the model's ``[analysis]`` band, else 0.1 Hz to 10 kHz.
    samples : int
        Number of frequencies at which it is measured, besides those around poles and zeros.
    digits : int
        Significant digits of the printed error.

    Returns
    -------
    ArrayModule
        The same text on every run. Names that cannot be Python's are altered; text of the model stands in it
        only as inert strings.

    Raises
    ------
    BudgetError
        SF503 when a function's text would be too long.
    ModelError
        SF233 when a number does not fit in double precision.

    Examples
    --------
    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... parameters = {m = "2 kg", b = "3 N*s/m"}
    ... elements.body = {type = "mass", at = "x", m = "m"}
    ... elements.loss = {type = "damper", between = ["x", "ground"], b = "b"}
    ... inputs.F = {force = "x"}
    ... outputs.V = "s*x"
    ... ''')
    >>> "def V_over_F(" in array_module(pipeline.derive_all(model), model, JAX).text
    True
    """
    members = members_of(tfs, band_hz, samples)
    reserved = dialect.reserved
    names = identifiers({p.name: p.name for p in model.parameters}, reserved)
    functions, responses = public_names(members, reserved)
    values = {
        p.name: nearest_double(p.value.rational, p.value.pi_power)
        for p in model.parameters
        if p.value is not None
    }
    printed: list[_Function] = []
    for member in members:
        public = (responses if member.program.is_real else functions)[member.tf.name]
        sentence = member.verification.text(digits)
        printed.append(
            _Function(member.tf, in_pieces(member.program), sentence, public, names, values, dialect)
        )
    code = ["\n".join(function.code()) for function in printed]
    texts = [f"{function.head()}\n\n\n{own}\n" for function, own in zip(printed, code, strict=True)]
    calls = [line for function in printed for line in function.body()]
    used = called_parts("\n".join([*calls, *code]), dialect.parts, ("_numbers",))
    blocks = [parameter_table(model, names), *texts, *(dialect.support(text) for text in used)]
    blocks.append(function_table("TRANSFER_FUNCTIONS", functions))
    if any(isinstance(member.program, Piecewise) for member in members):
        blocks.append(function_table("FREQUENCY_RESPONSES", responses))
    verified = verifications(members)
    text = header(dialect.first, model, verified[: len(functions)], digits)
    if dialect is JAX:
        text = text.rstrip().removesuffix('"""') + f'\n{DOUBLE_PRECISION}"""\n'
    lints = f"# ruff: noqa: {LINTS}  (names and texts are the model's)\n\n"
    start = f"{text}{lints}from __future__ import annotations\n\n{dialect.imports}\n"
    return ArrayModule(start + "\n\n".join(blocks), verified)


@dataclass(frozen=True)
class _Function:
    """Prints one transfer function: what a user calls, and the arithmetic behind it."""

    tf: AnyTransferFunction
    program: Piecewise
    sentence: str
    name: str
    names: Mapping[str, str]
    values: Mapping[str, float]
    dialect: Dialect

    @property
    def variable(self) -> str:
        """The first argument's name."""
        if not self.program.is_real:
            return "s"
        return "omega_" if "omega" in self.names.values() else "omega"

    def head(self) -> str:
        """Return the function that a user calls."""
        dialect = self.dialect
        parameters = [(p, self.names[p.name]) for p in self.tf.parameters]
        lines = [f"def {self.name}(", f"    {self.variable}: {dialect.argument},"]
        lines += ["    *,"] if parameters or dialect.is_argument else []
        for parameter, name in parameters:
            value = default_value(parameter)
            lines.append(f"    {name}: {dialect.argument}{f' = {value}' if value else ''},")
        lines += [f"    {dialect.space}: {dialect.argument} = None,"] if dialect.is_argument else []
        lines += [f") -> {dialect.result}:", self._docstring().rstrip("\n")]
        return "\n".join([*lines, *self.body()])

    def body(self) -> list[str]:
        """Return its statements."""
        dialect = self.dialect
        arguments = [self.variable, *(self.names[p.name] for p in self.tf.parameters)]
        converter = "_real_numbers" if self.program.is_real else "_numbers"
        given = ", ".join([*([dialect.space] if dialect.is_argument else []), *arguments])
        target = f"{dialect.space}, arguments" if dialect.is_argument else "arguments"
        lines = statement(target, f"{converter}({given})", "    ")
        leading = f"{dialect.space}, " if dialect.is_argument else ""
        return [*lines, *statement("return", f"_shaped({leading}{self._pieces.call()}, arguments)", "    ")]

    def code(self) -> list[str]:
        """Return the lines of the private functions; they hold no text of the model."""
        return self._pieces.functions()

    @property
    def _pieces(self) -> ArrayPieces:
        dialect = self.dialect
        return ArrayPieces(
            self.program,
            self.name,
            self.variable,
            self.names,
            dialect.reserved,
            self.values,
            dialect.space,
            dialect.is_argument,
            dialect.has_fixed_sizes and bool(self.program.conditions),
        )

    def _docstring(self) -> str:
        dialect = self.dialect
        more = (
            f"    {dialect.space} : module, optional",
            "        Library of arrays; by default that of the arguments.",
        )
        signature = Signature(
            self.variable,
            self.names,
            self.program.is_real,
            dialect.array,
            dialect.returned,
            more if dialect.is_argument else (),
        )
        notes = [self.sentence, MEASURED]
        if self.program.solves:
            notes.append(ITERATED if RuntimeCalls.of([self.program]).roots else COST)
        return function_docstring(self.tf, signature, notes)


def for_one_library(text: str, name: str) -> str:
    """Return the text of functions with the argument ``xp`` replaced by a library's name.

    Examples
    --------
    >>> for_one_library("def _f(xp, x): return g(xp, xp.exp(x))", "jnp")
    'def _f(x): return g(jnp.exp(x))'
    """
    return re.sub(r"\bxp\.", f"{name}.", re.sub(r"\bxp, ", "", text))
