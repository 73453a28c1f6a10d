"""Expressions in Python, and the private functions of one transfer function: one per piece, and the choice.

numpy computes the pieces that serve, in blocks of elements. Other libraries compute every piece for all
elements, so that no branch depends on a value: the text can be compiled and differentiated by what traces it.
So that no piece spoils a value, or a derivative, of an element it does not serve, it is evaluated there at a
place where it is regular. The names of functions are those of the Python array API standard, numpy's too.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from cmath import isfinite
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from symflex.codegen.infix import InfixPrinter, in_lines
from symflex.codegen.module_text import WIDTH, identifiers, statement_lines
from symflex.codegen.program import nodes as tree
from symflex.codegen.program.evaluate import NUMPY_FUNCTIONS, number_of, numbers_of_pieces, value_of_piece
from symflex.codegen.program.nodes import ONE, CodePiece, Piecewise

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from symflex.codegen.python.dialects import Dialect


@dataclass(frozen=True)
class PrivateText(ABC):
    """Prints the private functions behind one transfer function, whose names begin with what they are."""

    program: tree.Piecewise  # what they compute
    name: str  # identifier of the public function whose programs these are
    parameters: Mapping[str, str]  # identifiers of the parameters
    values: Mapping[str, float]  # values of the parameters that have one
    dialect: Dialect  # of Python

    @property
    def variable(self) -> str:
        """The first argument's name, ``s`` or ``omega``."""
        return self.omega if self.program.is_real else "s"

    @property
    def omega(self) -> str:
        """What an angular frequency is called."""
        return "omega_" if "omega" in self.parameters.values() else "omega"

    @property
    def leading(self) -> str:
        """First arguments of functions that look others up."""
        return f"{self.dialect.space}, " if self.dialect.is_argument else ""

    @property
    def arguments(self) -> list[str]:
        """Of the private functions."""
        return [self.variable, *(self.parameters[p] for p in self.program.parameters)]

    @abstractmethod
    def call(self) -> list[str]:
        """Return the statements that compute the value of ``arguments``."""

    def functions(self) -> list[str]:
        """Return the lines of all functions; no text of the model is in them."""
        program, (lines, printer) = self.program, self._body(self.program.tests, self.variable)
        tests = ", ".join(self._test(condition, printer) for condition in program.conditions)
        lines = [*self._head(f"_tests_of_{self.name}"), *lines, *statement("return", f"[{tests}]", "    ")]
        lines += ["", "", *self._along()]
        for i, piece in enumerate(program.code):
            lines += [*self._piece(i, piece), "", ""]
        return [*lines, *self._table()]

    def _along(self) -> list[str]:
        """Return the lines of the functions of x that members vary like."""
        return []

    @abstractmethod
    def _table(self) -> list[str]:
        """Return the lines of the table of all pieces."""

    def _head(self, name: str, arguments: Sequence[str] | None = None) -> list[str]:
        given = self.arguments if arguments is None else arguments
        given = [*([self.dialect.space] if self.dialect.is_argument else []), *given]
        line = f"def {name}({', '.join(given)}):"
        if len(line) <= WIDTH:
            return [line]
        return [f"def {name}(", *(f"    {g}," for g in given), "):"]

    @abstractmethod
    def _body(self, code: tree.Straight, variable: str) -> tuple[list[str], PythonPrinter]:
        """Return the lines of the assignments, and what prints values in their scope."""

    @abstractmethod
    def _test(self, condition: tree.Condition, printer: PythonPrinter) -> str:
        """Return the text of what tells whether a condition holds."""

    @abstractmethod
    def _mean(self, parts: str, points: int) -> str:
        """Return the text of a mean over a circle."""

    @abstractmethod
    def _value(self, piece: tree.CodePiece, lines: list[str], printer: PythonPrinter) -> list[str]:
        """Return the last lines of a piece's function."""

    def _piece(self, number: int, piece: tree.CodePiece) -> list[str]:
        name, parts = (f"_{word}_{number}_of_{self.name}" for word in ("piece", "parts"))
        if piece.circle:
            lines, printer = self._body(piece.code, self.variable)
            values = ", ".join(printer.print(v) for v in piece.code.values)
            return [
                *self._head(parts),
                *lines,
                *statement("return", values, "    "),
                "",
                "",
                *self._head(name),
                *statement("return", self._mean(parts, piece.circle), "    "),
            ]
        start, variable = self._head(name), self.variable
        if piece.is_complex:
            variable = identifiers({"s": "s"}, {*self.dialect.reserved - {"s"}, *self.arguments})["s"]
            start.append(f"    {variable} = 1j * {self.variable}")
        lines, printer = self._body(piece.code, variable)
        return [*start, *self._value(piece, lines, printer)]


@dataclass(frozen=True)
class BlockText(PrivateText):
    """Prints functions of numpy, which compute only what serves."""

    def call(self) -> list[str]:
        """Return the statements that compute the value of ``arguments``."""
        program, name = self.program, self.name
        if program.is_lumped:
            text = f"_in_blocks(_value_of_{name}, arguments)"
        elif program.is_real:
            unit = "1j" if program.turn else "1"
            text = f"_in_real_pieces(_tests_of_{name}, _pieces_of_{name}, arguments, {unit})"
        elif program.minors:
            text = f"_in_array(_tests_of_{name}, _pieces_of_{name}, arguments)"
        else:
            text = f"_in_pieces(_tests_of_{name}, _pieces_of_{name}, arguments, 1)"
        return ['    with np.errstate(all="ignore"):', *statement("return", text, "        ")]

    def functions(self) -> list[str]:
        """Return the lines of all functions; no text of the model is in them."""
        program = self.program
        if program.network is not None:
            ends = f"{program.network.output}, {program.network.source}"
            value = f"_network_value(_entries(*arguments), _NETWORK, {ends})"
            return [f"def _value_of_{self.name}(*arguments):", *statement("return", value, "    ")]
        return self._lumped(program) if program.is_lumped else super().functions()

    def _table(self) -> list[str]:
        names = [f"_piece_{i}_of_{self.name}" for i in self.program.pieces]
        comma = "," if len(names) == 1 else ""
        return statement(f"_pieces_of_{self.name}", f"({', '.join(names)}{comma})", "")

    def network(self, solve: tree.Solve) -> list[str]:
        """Return the lines of what all functions share that solve a network: its table, and its entries."""
        lines, printer = self._body(self.program.near, self.variable)
        entries = in_lines(", ".join(printer.print(e) for e in solve.entries), WIDTH - 8)
        return [
            *statement("_NETWORK", repr(solve.network), ""),
            "",
            "",
            *self._head("_entries"),
            *lines,
            "    return [",
            *(f"        {line}" for line in entries),
            "    ]",
        ]

    def _along(self) -> list[str]:
        lines: list[str] = []
        variable = identifiers({"x": "x"}, {*self.dialect.reserved, *self.arguments})["x"]
        for number, minors in enumerate(self.program.minors):
            body, printer = self._body(minors.along, variable)
            texts = ", ".join(printer.print(v) for v in minors.along.values)
            head = self._head(f"_along_{number}_of_{self.name}", [variable, *self.arguments[1:]])
            lines += [*head, *body, *statement("return", f"[{texts}]", "    "), "", ""]
        return lines

    def _lumped(self, program: tree.Piecewise) -> list[str]:
        """Return the function that computes with numbers or arrays of any shape."""
        arguments = (f"    {name}: NDArray[np.complex128]," for name in self.arguments)
        lines = [f"def _value_of_{self.name}(", *arguments, ") -> NDArray[np.complex128]:"]
        near, far = program.near, program.far
        used = {*self.dialect.reserved, *self.arguments[1:]}
        local_names = identifiers({n: n for n in ("value", "limit", "is_far", "inverse")}, used)
        used |= set(local_names.values())
        intermediates = identifiers({a.name: a.name for a in (*near.every, *program.late)}, used)
        printer = NumpyPrinter(self.parameters, intermediates, "s", local_names["inverse"])
        for assignment in near.every:
            lines += printer.assignment(assignment.name, assignment.value, "    ")
        value = printer.print(near.values[0])
        if far is None:
            return [*lines, *statement("return", value if program.varies else f"np.asarray({value})", "    ")]
        lines += statement(local_names["value"], value, "    ")
        lines.append(f"    {local_names['limit']} = {program.limit!r}")
        lines.append(f"    {local_names['is_far']} = np.abs(s) > {local_names['limit']}")
        lines.append(f"    if np.any({local_names['is_far']}):")
        lines.append(f"        {local_names['inverse']} = 1.0 / s")
        for assignment in program.late:
            lines += printer.assignment(assignment.name, assignment.value, "        ")
        selected = (
            f"np.where({local_names['is_far']}, {printer.print(far.values[0])}, {local_names['value']})"
        )
        return [
            *lines,
            *statement(local_names["value"], selected, "        "),
            f"    return {local_names['value']}",
        ]

    def matrix(self) -> list[str]:
        """Return the function that computes all entries of a matrix with arrays of any shape."""
        program, near, far = self.program, self.program.near, self.program.far
        used = {*self.dialect.reserved, *self.arguments[1:]}
        words = identifiers({n: n for n in ("values", "others", "is_far", "inverse")}, used)
        used |= set(words.values())
        intermediates = identifiers({a.name: a.name for a in (*near.every, *program.late)}, used)
        printer = NumpyPrinter(self.parameters, intermediates, "s", words["inverse"])
        lines = [f"def _value_of_{self.name}({', '.join(self.arguments)}):"]
        for assignment in near.every:
            lines += printer.assignment(assignment.name, assignment.value, "    ")

        def listed(target: str, values: Sequence[tree.CodeNode], indent: str) -> list[str]:
            opening = f"{indent}{target} [" if target == "return" else f"{indent}{target} = ["
            return [opening, *(f"{indent}    {printer.print(v)}," for v in values), f"{indent}]"]

        if far is None:
            return [*lines, *listed("return", near.values, "    ")]
        values, others, is_far, inverse = words.values()
        lines += listed(values, near.values, "    ")
        lines += [
            f"    {is_far} = np.abs(s) > {program.limit!r}",
            f"    if np.any({is_far}):",
            f"        {inverse} = 1.0 / s",
        ]
        for assignment in program.late:
            lines += printer.assignment(assignment.name, assignment.value, "        ")
        chosen = f"[np.where({is_far}, b, a) for a, b in zip({values}, {others}, strict=True)]"
        lines += [*listed(others, far.values, "        "), f"        {values} = {chosen}"]
        return [*lines, f"    return {values}"]

    def _body(self, code: tree.Straight, variable: str) -> tuple[list[str], PythonPrinter]:
        taken = {*self.dialect.reserved, *self.parameters.values(), self.variable, variable, "z"}
        names = identifiers({a.name: a.name for a in code.every}, taken)
        given = ", ".join(["_x", *self.arguments[1:]])
        follows = {
            minors.along: f"lambda _x: _along_{number}_of_{self.name}({given})"
            for number, minors in enumerate(self.program.minors)
        }
        printer = NumpyPrinter(self.parameters, names, variable, "inverse", follows=follows)
        return [line for a in code.every for line in printer.assignment(a.name, a.value, "    ")], printer

    def _test(self, condition: tree.Condition, printer: PythonPrinter) -> str:
        text, scale = printer.print(condition.quantity), printer.print(condition.scale)
        if not condition.limit:
            return f"_is_left({text}, {scale})"
        below = f" / np.abs({scale})" if scale != "1.0" else ""
        return f"np.abs({text}) < {condition.limit!r}{below}"

    def _mean(self, parts: str, points: int) -> str:
        given = ", ".join(["z", *self.arguments[1:]])
        return f"_mean_over_circle(lambda z: {parts}({given}), {self.variable}, {points})"

    def _value(self, piece: tree.CodePiece, lines: list[str], printer: PythonPrinter) -> list[str]:
        value = printer.quotient(*piece.code.values)
        if piece.is_complex and self.program.turn:
            # The factor that the real pieces leave out comes after.
            value = f"-1j * ({value})"
        return [*lines, *statement("return", value, "    ")]


@dataclass(frozen=True)
class TracedText(PrivateText):
    """Prints functions without branches on values, of programs :func:`in_pieces`."""

    def call(self) -> list[str]:
        """Return the statements that compute the value of ``arguments``."""
        text = f"_piece_0_of_{self.name}({self.leading}*arguments)"
        if self.program.conditions:
            text = f"_in_pieces({self.leading}_tests_of_{self.name}, _pieces_of_{self.name}, arguments)"
        return statement("return", f"_shaped({self.leading}{text}, arguments)", "    ")

    def functions(self) -> list[str]:
        """Return the lines of all functions; no text of the model is in them."""
        return super().functions() if self.program.conditions else self._piece(0, self.program.code[0])

    def _table(self) -> list[str]:
        program, lines = self.program, [f"_pieces_of_{self.name} = ("]
        places = places_of(program, self.values)
        for i, (cases, point) in enumerate(zip(cases_of(program), places, strict=True)):
            lines += [
                f"    (_piece_{i}_of_{self.name}, {point!r}, (",
                *(f"        {case!r}," for case in cases),
                "    )),",
            ]
        return [*lines, ")"]

    def _body(self, code: tree.Straight, variable: str) -> tuple[list[str], ArrayPrinter]:
        taken = {*self.dialect.reserved, *self.arguments, variable}
        inverse = identifiers({"inverse": "inverse"}, taken)["inverse"]
        names = identifiers({a.name: a.name for a in code.every}, {*taken, inverse})
        numbers: dict[str, Any] = {}
        for assignment in code.every:
            if (number := number_of(assignment.value, numbers)) is not None:
                numbers[assignment.name] = number
        is_fixed = self.dialect.has_fixed_sizes and bool(self.program.conditions)
        context = (self.parameters, names, variable, inverse, self.dialect.space)
        printer = ArrayPrinter(*context, numbers, is_fixed, self.leading)
        lines = [line for a in code.every for line in printer.assignment(a.name, a.value, "    ")]
        if any(inverse in line for line in lines):
            lines = [f"    {inverse} = 1.0 / {variable}", *lines]
        return lines, printer

    def _test(self, condition: tree.Condition, printer: PythonPrinter) -> str:
        quantity, scale = condition.quantity, condition.scale
        if not condition.limit:
            tested = quantity if scale == ONE else tree.Multiply((scale, quantity))
            return f"{self.dialect.space}.real({printer.print(tested)}) < 0.0"
        below = f" / {printer.print(tree.Apply('abs', scale))}" if scale != ONE else ""
        return f"{printer.print(tree.Apply('abs', quantity))} < {condition.limit!r}{below}"

    def _mean(self, parts: str, points: int) -> str:
        return f"_mean_over_circle({self.leading}{parts}, [{', '.join(self.arguments)}], {points})"

    def _value(self, piece: tree.CodePiece, lines: list[str], printer: PythonPrinter) -> list[str]:
        num, den = piece.code.values
        value = printer.print(num) if den == ONE else printer.quotient(num, den)
        first = f"    {printer.inverse} = 1.0 / {printer.variable}"
        if den == ONE and printer.inverse in value and first not in lines:
            lines = [first, *lines]
        if not any(isinstance(n, (tree.Laplace, tree.InverseLaplace)) for n in piece.code.nodes()):
            value = f"{value} + {self.dialect.space}.zeros_like({self.variable})"
        return [*lines, *statement("return", value, "    ")]


@dataclass(frozen=True)
class PythonPrinter(InfixPrinter):
    """Prints expressions as Python of numpy."""

    space: str = "np"

    cut_off: ClassVar = "{space}.where({space}.abs({z}) <= {end!r}, {z}, {space}.full_like({z}, {space}.nan))"

    def assignment(self, name: str, value: tree.CodeNode, indent: str) -> list[str]:
        """Return the lines of an assignment."""
        return statement(self.locals[name], self.print(value), indent)

    @property
    def pi(self) -> str:
        """The number pi."""
        return f"{self.space}.pi"

    def applied(self, function: str, argument: tree.CodeNode) -> str:
        """Return the text of a function's value."""
        if function == "complex_exp":
            return f"_complex_exp({self.print(argument)})"
        return f"{self.space}.{NUMPY_FUNCTIONS[function]}({self.print(argument)})"

    def complex_number(self, real: float, imaginary: float) -> str:
        """Return a number as text that needs no parentheses."""
        if not real:
            return f"({imaginary!r}j)"
        return f"({real!r}{imaginary:+}j)" if imaginary else f"({real!r}+0j)"


@dataclass(frozen=True)
class NumpyPrinter(PythonPrinter):
    """Prints expressions as Python of numpy, with what follows matrices along x."""

    # What calls the functions of x that members vary like.
    follows: Mapping[tree.Straight, str] = field(default_factory=dict, kw_only=True)

    def with_lists(self, node: tree.CodeNode) -> str:
        """Return the text of what takes lists or gives them."""
        match node:
            case tree.ScaledSum(amplitudes, exponents):
                return self.call("scaled_sum", [self.list_of(x) for x in (amplitudes, exponents)])
            case tree.FundamentalMinors(start, length, bases, along, places, wanted):
                ends = [self.print(start), self.print(length), self.list_of(bases)]
                arguments = (places, wanted, node.beginning)
                return self.call("fundamental_minors", [self.follows[along], *ends, *map(repr, arguments)])
        return super().with_lists(node)


@dataclass(frozen=True)
class ArrayPrinter(PythonPrinter):
    """Prints expressions as Python of any library of arrays."""

    # Values of the assignments that depend on no argument. Functions of these are printed as numbers, because
    # array libraries take arrays only.
    numbers: Mapping[str, Any] = field(default_factory=dict)
    has_fixed_sizes: bool = False  # true to print magnitudes as ``_size``, which has no derivative
    leading: str = ""  # first arguments of functions that look others up

    def print(self, node: tree.CodeNode) -> str:
        """Return the text of an expression."""
        if isinstance(node, tree.LargerRoot):
            return f"_larger({self.leading}{self.print(node.middle)}, {self.print(node.product)})"
        return super().print(node)

    def applied(self, function: str, argument: tree.CodeNode) -> str:
        """Return the text of a function's value."""
        number = number_of(tree.Apply(function, argument), self.numbers)
        if number is not None and isfinite(number):
            return repr(complex(number)) if isinstance(number, complex) else f"({float(number)!r})"
        if function == "abs" and self.has_fixed_sizes:
            return f"_size({self.print(argument)})"
        if function == "complex_exp":
            # numpy's one tangent costs less than a complex exponential, but its derivative loses digits.
            return f"{self.space}.exp({self.print(argument)})"
        return super().applied(function, argument)


def statement(target: str, value: str, indent: str) -> list[str]:
    """Return ``target = value``, or ``return value``, on as many lines as it needs."""
    opening = f"{indent}{target} " if target == "return" else f"{indent}{target} = "
    if len(opening) + len(value) <= WIDTH:
        return [opening + value]
    lines = statement_lines(value, WIDTH, f"{indent}    ", "")
    return [f"{opening}(", *lines, f"{indent})"]


Cases = tuple[tuple[tuple[int, bool], ...], ...]  # alternatives: tests with the results they must have
SIZES = np.logspace(-12, 60, 145)
DIRECTIONS: NDArray[np.complex128] = np.exp(1j * np.array([0.9, -0.9, 2.2, -2.2]))
"""Frequencies [rad/s] and directions, one in every quadrant and on no axis, among which places are sought."""
INWARDS = 1.5  # decades between a place and the lower end of the range that a piece serves, or its only end


def in_pieces(program: Piecewise) -> Piecewise:
    """Return a program whose pieces are quotients by themselves; a lumped one's denominator is one."""
    if not program.is_lumped:
        return program
    needs = (piece.code.needed(piece.code.values) for piece in program.code)
    return replace(
        program,
        code=tuple(
            CodePiece(replace(alternative, values=(*alternative.values, ONE))) for alternative in needs
        ),
    )


def cases_of(program: Piecewise) -> tuple[Cases, ...]:
    """Return for every piece the results of tests under which it serves."""
    cases_by_piece: list[list[tuple[tuple[int, bool], ...]]] = [[] for _ in program.code]

    def split(table: tuple[int, ...], test: int, results: tuple[tuple[int, bool], ...]) -> None:
        if len(set(table)) == 1:
            cases_by_piece[table[0]].append(results)
            return
        failed, held = table[::2], table[1::2]
        if failed == held:
            split(failed, test + 1, results)
            return
        split(failed, test + 1, (*results, (test, False)))
        split(held, test + 1, (*results, (test, True)))

    split(program.pieces, 0, ())
    return tuple(tuple(cases) for cases in cases_by_piece)


def places_of(program: Piecewise, values: Mapping[str, float]) -> tuple[complex, ...]:
    """Return for every piece an argument at which it is regular, some way from where others take over."""
    given = {name: values.get(name, 1.0) for name in program.parameters}
    points = SIZES[:, None] * DIRECTIONS
    with np.errstate(all="ignore"):
        numbers = np.broadcast_to(numbers_of_pieces(program, points, given), points.shape)
        served = np.array(program.pieces)[numbers]
        changes = np.flatnonzero((served[1:] != served[:-1]).any(axis=1))
        last = float(np.log10(SIZES[changes[-1]])) if len(changes) else 0.0
        return tuple(_place(piece, points, served == k, last, given) for k, piece in enumerate(program.code))


def _place(
    piece: CodePiece,
    points: NDArray[np.complex128],
    serves: NDArray[np.bool_],
    last: float,
    given: Mapping[str, float],
) -> complex:
    """Return a place, near the logarithm aimed at and in a direction in which the piece serves.

    One that serves nowhere for these parameters is put beyond the last change from one piece to another.
    """
    rows = np.flatnonzero(serves.any(axis=1))
    logarithms = np.log10(SIZES)
    aim = last + INWARDS
    if len(rows) and rows[0] > 0:
        aim = logarithms[rows[0]] + INWARDS
    elif len(rows):
        aim = min(logarithms[rows[-1]], last) - INWARDS
    distance = np.abs(logarithms - aim)[:, None] + np.where(serves.any(axis=0), 0.0, 1e3)
    for position in np.argsort(distance, axis=None, kind="stable"):
        point = points.flat[position] * np.array([1.0, 0.999, 1.001])
        if np.all(np.isfinite(value_of_piece(piece, point, given))):
            return complex(points.flat[position])
    return complex(points.flat[0])
