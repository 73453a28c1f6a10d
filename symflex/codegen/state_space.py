"""State equations: as expressions, as lines of text, and as one Python module that imports numpy only.

Input: a :class:`symflex.state_space.StateSpace`, and the transfer functions it is measured against.
Output: an :class:`Export`, the module's text and how well its numbers agree with ball arithmetic.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property

import numpy as np
import numpy.typing as npt
from flint import fmpz_mpoly

from symflex.algebra import irreducible_factors
from symflex.codegen.export import Export, shortfalls
from symflex.codegen.module_text import WIDTH, default_value, identifiers, inert, wrapped
from symflex.codegen.program import nodes as tree
from symflex.codegen.program.build import TERM_LIMIT
from symflex.codegen.program.evaluate import evaluate
from symflex.codegen.program.verify import DEFAULT_BAND, Verification, double_of, measure_values
from symflex.codegen.python.dialects import NUMPY_DIALECT
from symflex.codegen.python.module import (
    docstring,
    literal,
    origin,
    parameter_entry,
    parameter_table,
    row_of_table,
)
from symflex.codegen.python.pieces import PythonPrinter, statement
from symflex.errors import BudgetError, Diagnostic, ModelError
from symflex.expressions import (
    Expression,
    Name,
    fold,
    format_expression,
    names,
    number,
    product_of,
    quotient,
    sum_of,
)
from symflex.library.blocks import BLOCKS
from symflex.model import Model
from symflex.model.linearity import integer_exponent
from symflex.model.loss_factors import check_causal
from symflex.print.forms.arrange import Arranger
from symflex.state_space import State, StateSpace, minimal, not_rational, realise
from symflex.state_space.numeric import Arrays, response
from symflex.state_space.popov import FieldElement, Vector
from symflex.state_space.sampled import Sampling, sampled_state_space
from symflex.transfer import AnyTransferFunction, bind
from symflex.transfer.bind import read_values


class StateEquations:
    """The equations of one exact realisation, for print: ``s*x_dot = -k/m*x - b/m*x_dot + 1/m*F``."""

    def __init__(self, system: StateSpace) -> None:
        self.system = system
        self._arranger = Arranger.plain(system.ring, {c.generator: c.expression for c in system.constants})
        self._printed: dict[tuple[str, str], Expression] = {}

    def entry(self, value: FieldElement) -> Expression:
        """Return an entry, numerator and denominator factored."""
        if value.is_zero:
            return number(0)
        key = (str(value.num), str(value.den))
        if key not in self._printed:
            self._printed[key] = quotient(*map(self._arranger.coefficient, (value.num, value.den)))
        return self._printed[key]

    def lines(self) -> list[str]:
        """Return one equation per state and per output."""
        system = self.system
        names = [*(x.name for x in system.states), *(x.name for x in system.inputs)]
        count = len(system.states)

        def right(states: Vector, inputs: Vector) -> str:
            parts = {**states, **{count + j: value for j, value in inputs.items()}}
            terms = [product_of([self.entry(value), Name(names[j])]) for j, value in sorted(parts.items())]
            return format_expression(sum_of(terms))

        derivatives = zip(system.states, system.a, system.b, strict=True)
        results = zip(system.outputs, system.c, system.d, strict=True)
        return [
            *(f"s*{state.name} = {right(a, b)}" for state, a, b in derivatives),
            *(f"{output.name} = {right(c, d)}" for output, c, d in results),
        ]

    def grid(self, rows: tuple[Vector, ...], shape: tuple[int, int]) -> list[str]:
        """Return a matrix as lines of aligned entries."""
        height, width = shape
        texts = [
            [inert(format_expression(self.entry(rows[i][j]))) if j in rows[i] else "0" for j in range(width)]
            for i in range(height)
        ]
        sizes = [max((len(texts[i][j]) for i in range(height)), default=1) for j in range(width)]
        return [
            "[" + "  ".join(t.rjust(size) for t, size in zip(row, sizes, strict=True)) + "]" for row in texts
        ]

    def meaning(self, state: State) -> Expression:
        """Return what a state is, in quantities of the model."""
        return sum_of([product_of([self.entry(value), quantity]) for quantity, value in state.terms])

    @cached_property
    def divisors(self) -> tuple[Expression, ...]:
        """What entries are divided by: the equations hold where none of it is zero."""
        system = self.system
        factors: dict[str, fmpz_mpoly] = {}
        for _, rows, _ in system.matrices:
            for row in rows:
                for value in row.values():
                    if not value.den.is_constant():
                        for factor, _ in irreducible_factors(value.den)[1]:
                            factors.setdefault(str(factor), factor)
        return tuple(self._arranger.coefficient(factor) for factor in factors.values())


EQUATION_LINES = 60  # lines of equations in the docstring
WORK, FEWEST = 400 * 12**3, 20  # frequencies times order cubed, at most, and fewest frequencies measured

IMPORTS = """\
# ruff: noqa: E501, E741, N802, N803, N806, PLR0915, RUF001, RUF002, RUF100  (names and texts are the model's)

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

"""

LETTERS = ("A", "B", "C", "D")


def state_space_module(
    system: StateSpace, tfs: Sequence[AnyTransferFunction], *, samples: int = 400
) -> Export:
    """Return a module with ``state_space(*, parameter=default, ...)`` that returns A, B, C, D, measured."""
    size = sum(v.size for _, rows, _ in system.matrices for row in rows for v in row.values())
    if size > TERM_LIMIT:
        message = f"the state equations have {size} terms; at most {TERM_LIMIT} are written"
        raise BudgetError(
            Diagnostic("SF503", message, None, "give the parameters numbers first, with bind()")
        )
    module = _Module(system)
    verified = tuple(module.measured(tf, samples) for tf in tfs)
    return Export(module.text(verified), shortfalls(verified), verified=verified)


class _Module:
    """Prints one realisation."""

    def __init__(self, system: StateSpace) -> None:
        self._system = system
        self._equations = equations = StateEquations(system)
        self._entries = {
            letter: {
                (i, j): _node(equations.entry(value))
                for i, row in enumerate(rows)
                for j, value in sorted(row.items())
            }
            for letter, rows, _ in system.matrices
        }
        values = [value for _, rows, _ in system.matrices for row in rows for value in row.values()]
        used = {n.name for v in values for n in names(equations.entry(v)) if isinstance(n, Name)}
        self._parameters = [p for p in system.model.parameters if p.name in used]
        self._names = identifiers({p.name: p.name for p in system.model.parameters}, NUMPY_DIALECT.reserved)
        taken = {*NUMPY_DIALECT.reserved, *self._names.values()}
        self._letters = identifiers({letter: letter for letter in LETTERS}, taken)

    # ------------------------------------------------------------------------------------ numbers

    def measured(self, tf: AnyTransferFunction, samples: int) -> Verification:
        """Return how well the matrices of the declared values agree with a transfer function."""
        missing = [p.name for p in self._parameters if p.value is None]
        if missing and not [p for p in tf.parameters if p.value is None]:
            band = tf.model.analysis.band or DEFAULT_BAND
            reason = "no values for " + ", ".join(missing)
            return Verification(tf.name, "state-space", None, band, 0, reason)
        row = [x.name for x in self._system.outputs].index(tf.output.name)
        column = [x.name for x in self._system.inputs].index(tf.input.name)

        given = {p.name: double_of(p.value) for p in self._parameters if p.value is not None}

        def values(s: npt.NDArray[np.complex128]) -> list[complex]:
            """Return what the matrices that the generated code makes of the declared values give."""
            arrays = []
            for letter, _, shape in self._system.matrices:
                arrays.append(np.zeros(shape))
                for index, node in self._entries[letter].items():
                    program = tree.lumped(tuple(given), tree.Straight((), (), (node,)))
                    arrays[-1][index] = float(evaluate(program, 0.0, given).real)
            return [value[row][column] for value in response(Arrays(*arrays), s.tolist())]

        count = min(samples, max(FEWEST, WORK // max(1, self._system.order) ** 3))
        return measure_values(tf, values, "state-space", count)

    # --------------------------------------------------------------------------------------- text

    def text(self, verified: Sequence[Verification]) -> str:
        """Return the module."""
        system = self._system
        states = [(x.name, x.unit, format_expression(self._equations.meaning(x))) for x in system.states]
        blocks = [parameter_table(system.model, self._names), *_tables(system, states), self._function()]
        header = docstring(self._header(verified), "")
        return f"{header}{IMPORTS}" + "\n\n".join(blocks)

    def _header(self, verified: Sequence[Verification]) -> list[str]:
        lines = ["State equations of a linear system as a function of its parameters.", ""]
        lines += origin(self._system.model, "")
        lines.append("Written by symflex. With w the states, u the inputs and y the outputs,")
        lines += ["", "    w' = A w + B u,    y = C w + D u,    y/u = C (s - A)^-1 B + D.", ""]
        kind = (
            "Every state is controllable and observable, for almost all values of the parameters."
            if self._system.is_minimal
            else "The states are all those of the model, hidden ones too."
        )
        lines += wrapped(kind, WIDTH)
        proof = (
            "Proved: substituted into the model's equations, they satisfy them identically. "
            "Measured with the values in PARAMETERS:"
        )
        lines += [*wrapped(proof, WIDTH), ""]
        for verification in verified:
            lines += wrapped(inert(f"{verification.name}: {verification.text()}"), WIDTH, "", "    ")
        return lines

    def _function(self) -> str:
        signature = ["def state_space(", *(["    *,"] if self._parameters else [])]
        for parameter in self._parameters:
            value = default_value(parameter)
            signature.append(f"    {self._names[parameter.name]}: float{f' = {value}' if value else ''},")
        floats = "NDArray[np.float64]"
        returned = f") -> tuple[{floats}, {floats}, {floats}, {floats}]:"
        lines = [*signature, returned, docstring(self._docstring(), "    ").rstrip("\n")]
        printer = PythonPrinter(self._names, {}, "s")
        for letter, _, shape in self._system.matrices:
            array = self._letters[letter]
            lines.append(f"    {array} = np.zeros({shape})")
            for (i, j), node in self._entries[letter].items():
                lines += statement(f"{array}[{i}, {j}]", printer.print(node), "    ")
        lines.append(f"    return {', '.join(self._letters[letter] for letter in LETTERS)}")
        return "\n".join(lines) + "\n"

    def _docstring(self) -> list[str]:
        system = self._system
        lines = ["Return A, B, C and D as arrays.", ""]
        equations = self._equations.lines()
        for equation in equations[:EQUATION_LINES]:
            lines += wrapped(inert(equation), WIDTH, "        ", "            ")
        if len(equations) > EQUATION_LINES:
            lines.append(f"        ... and {len(equations) - EQUATION_LINES} equations more.")
        for letter, rows, shape in system.matrices:
            grid = self._equations.grid(rows, shape)
            if grid and max(map(len, grid)) + 12 <= WIDTH:
                lines.append("")
                lines += [f"        {f'{letter} =' if i == 0 else '   '} {row}" for i, row in enumerate(grid)]
        if self._parameters:
            lines += ["", "    Parameters", "    ----------"]
        for parameter in self._parameters:
            lines += parameter_entry(parameter, self._names[parameter.name], "float")
        n, m, p = len(system.states), len(system.inputs), len(system.outputs)
        lines += ["", "    Returns", "    -------"]
        shapes = zip(LETTERS, ((n, n), (n, m), (p, n), (p, m)), strict=True)
        lines += [f"    {letter} : ndarray of float, shape {shape}" for letter, shape in shapes]
        divisors = [format_expression(d) for d in self._equations.divisors]
        if divisors:
            lines += ["", "    Notes", "    -----"]
            lines += wrapped(inert(f"None of these may be zero: {', '.join(divisors)}."), WIDTH, "    ")
        return lines


def _tables(system: StateSpace, states: Sequence[tuple[str, str, str]]) -> list[str]:
    """Return tuples of dictionaries: of states, by name, unit and meaning, and of inputs and outputs."""
    ends = [[(x.name, x.unit, "") for x in group] for group in (system.inputs, system.outputs)]
    blocks = []
    for table, rows in zip(("STATES", "INPUTS", "OUTPUTS"), (states, *ends), strict=True):
        lines = [f"{table}: tuple[dict[str, str], ...] = ("]
        for label, unit, meaning in rows:
            entries = [f'"name": {literal(label)}', f'"unit": {literal(unit)}']
            lines += row_of_table("", [*entries, *([f'"meaning": {literal(meaning)}'] if meaning else [])])
        blocks.append("\n".join([*lines, ")", ""]))
    return blocks


def _node(expression: Expression) -> tree.CodeNode:
    """Return an expression of constants as a program's node."""

    def exact(value: Fraction) -> tree.CodeNode:
        above, below = (tree.RealNumber(Fraction(abs(n))) for n in value.as_integer_ratio())
        size = above if value.denominator == 1 else tree.Divide(above, below)
        return minus(size) if value < 0 else size

    def minus(node: tree.CodeNode) -> tree.CodeNode:
        if isinstance(node, tree.Divide):
            return tree.Divide(tree.Negate(node.numerator), node.denominator)
        return tree.Negate(node)

    def power(base: tree.CodeNode, exponent: Expression) -> tree.CodeNode:
        order = integer_exponent(exponent) or 0
        raised = base if abs(order) == 1 else tree.IntegerPower(base, abs(order))
        return raised if order > 0 else tree.Divide(tree.ONE, raised)

    return fold(
        expression,
        number=exact,
        name=lambda name: tree.RealNumber(Fraction(1), 1) if name == "pi" else tree.ParameterValue(name),
        power=power,
        call=lambda call, argument: tree.Apply(call.name, argument),
        negative=minus,
        total=lambda terms: tree.Add(tuple(terms)),
        product=lambda factors: tree.Multiply(tuple(factors)),
        quotient=tree.Divide,
    )


@dataclass(frozen=True, slots=True)
class StateSpaceExporter:
    """State equations as a function of the parameters, in one numpy module."""

    is_minimal: bool = False  # leave out what no input reaches or no output shows
    sampling: Sampling | None = None  # of a module of one step, with numbers

    suffix = ".py"
    summary = "numpy module with A, B, C, D as a function of the parameters, states named"
    solves = False

    def export(
        self, model: Model, tfs: Sequence[AnyTransferFunction], stem: str = "", *, is_alone: bool = True
    ) -> Export:
        """Return the module; accuracy that was not reached is a warning."""
        check_causal(model, "a state-space model")
        plain, delay = model, Fraction(0)
        if self.sampling is not None and model.is_distributed:
            plain, delay = _without_delays(model, tfs, self.sampling)
        system = realise(plain, [(tf.output.name, tf.input.name) for tf in tfs])
        system = minimal(system) if self.is_minimal else system
        if self.sampling is not None:
            return Export(sampled_module(system, self.sampling, delay), ())
        return state_space_module(system, tfs)


def _without_delays(
    model: Model, tfs: Sequence[AnyTransferFunction], sampling: Sampling
) -> tuple[Model, Fraction]:
    """Return the model with 1 in place of every delay, and the delay its functions have in common [s]."""
    from symflex.analysis.sampling import delay_of  # only sampled modules ask

    delays = {}
    for tf in tfs:
        if not tf.is_reduced:
            raise not_rational(tf.name)
        delays[delay_of(bind(tf), sampling)] = tf.name
    if len(delays) > 1:
        (one, first), (other, second), *_ = delays.items()
        message = f"{first} has a delay of {float(one):g} s, {second} one of {float(other):g} s"
        raise ModelError(
            Diagnostic("SF235", message, None, "use --tf to choose functions with the same delay")
        )
    unity = (("num", number(1)), ("den", number(1)))
    blocks = tuple(
        replace(b, block=BLOCKS["tf"], values=unity) if b.block is not None and b.block.kernel_time else b
        for b in model.blocks
    )
    return replace(model, blocks=blocks), next(iter(delays), Fraction(0))


def sampled_module(system: StateSpace, sampling: Sampling, delay: Fraction) -> str:
    """Return a module with the matrices of one sampling time, the inputs held from sample to sample."""
    valued = tuple(p for p in system.model.parameters if p.value is not None)
    stepped = sampled_state_space(system, dict(read_values(valued, {})), sampling, delay)
    lines = ["One step of a linear system from a sample to the next, with its inputs held in between.", ""]
    lines += origin(system.model, "")
    lines += ["Written by symflex. With w the states, u the inputs and y the outputs, in every step", ""]
    lines += ["    w[k + 1] = A w[k] + B u[k],    y[k] = C w[k] + D u[k].", ""]
    exact = "entry is the double nearest to its exact value"
    held = f"Every {exact}, a matrix exponential."
    moved = f"By the bilinear transformation; every {exact}."
    lines += wrapped(held if sampling.method == "zoh" else moved, WIDTH)
    if delay:
        said = f"The inputs act {float(delay)!r} s late: past inputs are states, the oldest first."
        lines += wrapped(said, WIDTH)
    if valued:
        given = ", ".join(f"{p.name} = {default_value(p)}" for p in valued)
        lines += ["", *wrapped(inert(f"Values: {given}."), WIDTH)]
    header = docstring(lines, "")
    units = {x.name: x.unit for x in system.states}
    blocks = [
        f"SAMPLE_TIME = {stepped.dt!r}  # [s]\n",
        *_tables(system, [(name, units.get(name, ""), "") for name in stepped.states]),
    ]
    for letter, array in zip(LETTERS, (stepped.A, stepped.B, stepped.C, stepped.D), strict=True):
        rows = [f"    [{', '.join(map(repr, row))}]," for row in array.tolist()]
        shape = f".reshape({array.shape})"
        blocks.append("\n".join([f"{letter}: NDArray[np.float64] = np.array([", *rows, f"]){shape}"]) + "\n")
    return f"{header}{IMPORTS}" + "\n\n".join(blocks)
