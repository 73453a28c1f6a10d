"""Functions of distributed systems as Python text: one per piece, and the choice among them.

Input: a :class:`Piecewise` program and identifiers.
Output: lines of a module that imports numpy only.
"""

from __future__ import annotations

import inspect
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.algebra import modal_amplitudes, mode_values
from symflex.codegen.numpy.expression import WIDTH, Printer, statement
from symflex.codegen.program import (
    Apply,
    Assignment,
    Laplace,
    Multiply,
    Node,
    Piece,
    Piecewise,
    Straight,
    identifiers,
    runtime,
)
from symflex.codegen.program.calls import RuntimeCalls
from symflex.codegen.program.real_axis import needed

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

PIECES_SUPPORT = '''\
def _in_pieces(tests, pieces, arguments, unit):
    """Return the value of the piece that serves, element by element.

    Test i adds 2**i to the number of the piece where it holds. The unit, a power
    of 1j, is a factor that the pieces leave out.
    """
    shape = np.broadcast_shapes(*(np.shape(a) for a in arguments))
    if not shape:
        number = sum(2**i for i, holds in enumerate(tests(*arguments)) if holds)
        value = complex(unit * pieces[number](*arguments))
        if np.isfinite(value):
            return value
        # At a pole numbers are divided otherwise than arrays.
        given = (np.atleast_1d(arguments[0]), *arguments[1:])
        return complex(_in_pieces(tests, pieces, given, unit)[0])
    columns = [
        np.broadcast_to(a, shape).reshape(-1) if np.ndim(a) else a for a in arguments
    ]
    value = np.zeros(shape, dtype=complex)
    flat = value.reshape(-1)
    line = flat.imag if unit in (1j, -1j) else flat.real
    for start in range(0, flat.size, BLOCK):
        part = flat[start : start + BLOCK]
        given = [a[start : start + BLOCK] if np.ndim(a) else a for a in columns]
        number, mixed = 0, False
        held = tests(*given)
        for i, holds in enumerate(held):
            if np.all(holds):
                number += 2**i
            elif np.any(holds):
                mixed = True
        if not mixed:
            found = pieces[number](*given)
            if np.iscomplexobj(found):
                part[:] = found if unit == 1 else unit * found
            elif unit in (1, 1j):
                line[start : start + BLOCK] = found
            else:
                np.negative(found, out=line[start : start + BLOCK])
            continue
        numbers = sum(2**i * holds for i, holds in enumerate(held))
        for k in np.unique(numbers):
            where = np.broadcast_to(numbers == k, part.shape)
            found = pieces[k](*(a[where] if np.ndim(a) else a for a in given))
            part[where] = unit * found
    return value
'''

ARRAY_SUPPORT = '''\
def _in_array(tests, pieces, arguments):
    """Return what _in_pieces does, a number as part of an array.

    Matrix exponentials magnify the last bit, which numbers may round differently.
    """
    shape = np.broadcast_shapes(*(np.shape(a) for a in arguments))
    given = (np.atleast_1d(arguments[0]), *arguments[1:])
    value = _in_pieces(tests, pieces, given, 1).reshape(shape)
    return value if shape else complex(value[()])
'''

LEFT_SUPPORT = '''\
def _is_left(x, scale):
    """Tell where the real part of a product is negative."""
    if np.ndim(scale) == 0 and np.imag(scale) == 0.0 and np.real(scale) > 0.0:
        return np.real(x) < 0.0
    return np.real(scale * x) < 0.0
'''

REAL_SUPPORT = '''\
def _in_real_pieces(limits, sizes, pieces, arguments, unit):
    """Return the response at angular frequencies of any sign.

    Size i below limit i adds 2**i to the number of the piece where it is. Pieces return
    numerator and denominator at a positive frequency, without the unit, 1 or 1j; at
    a negative one the response is conjugate.
    """
    shape = np.broadcast_shapes(*(np.shape(a) for a in arguments))
    bounds = limits(*arguments[1:])
    if not shape:
        size = sizes(abs(arguments[0]), *arguments[1:])
        number = sum(2**i for i, x in enumerate(size) if x < bounds[i])
        num, den = pieces[number](abs(arguments[0]), *arguments[1:])
        found = num / den
        if np.iscomplexobj(num):
            value = complex(unit * found)
        else:
            value = complex(found, 0.0) if unit == 1 else complex(0.0, found)
        return value.conjugate() if np.signbit(arguments[0]) else value
    columns, bounds = (
        [np.broadcast_to(a, shape).reshape(-1) if np.ndim(a) else a for a in group]
        for group in (arguments, bounds)
    )
    value = np.empty(shape, dtype=complex)
    flat = value.reshape(-1)
    line = flat.real if unit == 1 else flat.imag
    block = 2 * BLOCK  # Real values take half the space.
    for start in range(0, flat.size, block):
        part, out = flat[start : start + block], line[start : start + block]
        part[:] = 0.0
        given, below = (
            [a[start : start + block] if np.ndim(a) else a for a in group]
            for group in (columns, bounds)
        )
        turned = np.fmin.reduce(np.ravel(given[0])) < 0.0
        if turned:
            is_negative = np.signbit(given[0])
            given[0] = np.abs(given[0])
        number, mixed = 0, False
        held = [x < limit for x, limit in zip(sizes(*given), below, strict=True)]
        for i, holds in enumerate(held):
            if np.all(holds):
                number += 2**i
            elif np.any(holds):
                mixed = True
        if not mixed:
            num, den = pieces[number](*given)
            if np.iscomplexobj(num):
                part[:] = unit * (num / den)
            else:
                np.divide(num, den, out=out)
        else:
            numbers = sum(2**i * holds for i, holds in enumerate(held))
            for k in np.unique(numbers):
                where = np.broadcast_to(numbers == k, part.shape)
                num, den = pieces[k](*(a[where] if np.ndim(a) else a for a in given))
                if np.iscomplexobj(num):
                    part[where] = unit * (num / den)
                else:
                    out[where] = num / den
        if turned:
            np.negative(part.imag, out=part.imag, where=is_negative)
    return value


def _real_numbers(*arguments: ArrayLike) -> tuple[NDArray[np.float64], ...]:
    """Return real numbers."""
    arrays = [np.asarray(value) for value in arguments]
    for array in arrays:
        if array.dtype.kind not in "biuf":
            message = f"real numbers or arrays of them are wanted, not {array.dtype}"
            raise TypeError(message)
    return tuple(a.astype(float, copy=False)[()] for a in arrays)
'''

LINTS = "ANN001, ANN201, ANN202, N816, PLR0912, PLR0914, PLR1704, PLR2004"
"""Rules that the private functions of the pieces do not follow."""


def private_copy(function: Callable[..., object]) -> str:
    """Return the text of a run-time function as a private one, without annotations.

    Parameters
    ----------
    function : callable
        Of this package.

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


def support(programs: Sequence[Piecewise]) -> list[str]:
    """Return the functions that generated pieces call, those in use only."""
    if not programs:
        return []
    blocks = [PIECES_SUPPORT]
    if any(p.solves for p in programs):
        blocks.append(ARRAY_SUPPORT)
    if any(p.is_real for p in programs):
        blocks.append(REAL_SUPPORT)
    if any(not c.limit for p in programs if not p.is_real for c in p.conditions):
        blocks.append(LEFT_SUPPORT)
    calls = RuntimeCalls.of(programs)
    nodes = (n for p in programs for piece in p.code for n in piece.code.nodes())
    has_exponentials = any(isinstance(n, Apply) and n.function == "complex_exp" for n in nodes)
    wanted: tuple[tuple[bool, tuple[Callable[..., object], ...]], ...] = (
        (has_exponentials or calls.modes, (runtime.complex_exp,)),
        (calls.series, (runtime.series_solutions,)),
        (calls.propagation, (runtime.propagated,)),
        (calls.roots, (runtime.characteristic_roots,)),
        (calls.modes, (mode_values, modal_amplitudes, runtime.modal_value)),
        (calls.means, (runtime.mean_over_circle,)),
    )
    return [*blocks, *(private_copy(f) for is_called, functions in wanted if is_called for f in functions)]


@dataclass(frozen=True)
class PiecesText:
    """Prints the private functions behind one transfer function.

    Parameters
    ----------
    program : Piecewise
        What they compute.
    name : str
        Identifier of the public function.
    variable : str
        Its first argument, ``s`` or ``omega``.
    parameters : mapping of str to str
        Identifiers of the parameters.
    reserved : set of str
        Identifiers that intermediates cannot have.
    """

    program: Piecewise
    name: str
    variable: str
    parameters: Mapping[str, str]
    reserved: frozenset[str]

    def call(self) -> str:
        """Return the call that computes the value of ``arguments``."""
        if not self.program.is_real:
            if self.program.solves:
                return f"_in_array(_tests_of_{self.name}, _pieces_of_{self.name}, arguments)"
            return f"_in_pieces(_tests_of_{self.name}, _pieces_of_{self.name}, arguments, 1)"
        parts = ", ".join(f"_{part}_of_{self.name}" for part in ("limits", "sizes", "pieces"))
        return f"_in_real_pieces({parts}, arguments, {'1j' if self.program.turn else '1'})"

    def functions(self) -> list[str]:
        """Return the lines of all functions.

        Names begin with what a private function is, so that ``A_over_F_0`` may be another function.
        """
        tests = self._real_tests() if self.program.is_real else self._tests()
        lines = [*tests, "", ""]
        for i, piece in enumerate(self.program.code):
            lines += [*self._piece(i, piece), "", ""]
        names = [f"_piece_{i}_of_{self.name}" for i in self.program.pieces]
        comma = "," if len(names) == 1 else ""
        return [*lines, *statement(f"_pieces_of_{self.name}", f"({', '.join(names)}{comma})", "")]

    def _head(self, name: str, *, is_free: bool = False) -> list[str]:
        """Return the first lines of a function, without the first argument if it is free of that."""
        given = [self.parameters[p] for p in self.program.parameters]
        if not is_free:
            given = [self.variable, *given]
        line = f"def {name}({', '.join(given)}):"
        if len(line) <= WIDTH:
            return [line]
        return [f"def {name}(", *(f"    {g}," for g in given), "):"]

    def _printer(self, code: Straight, variable: str) -> Printer:
        assignments: list[Assignment] = [*code.constants, *code.assignments]
        taken = {*self.reserved, *self.parameters.values(), self.variable, variable, "z"}
        names = identifiers({a.name: a.name for a in assignments}, taken)
        return Printer(self.parameters, names, variable, "inverse")

    def _body(self, code: Straight, printer: Printer) -> list[str]:
        lines: list[str] = []
        for assignment in (*code.constants, *code.assignments):
            lines += printer.assignment(assignment.name, assignment.value, "    ")
        return lines

    def _tests(self) -> list[str]:
        program = self.program
        lines = self._head(f"_tests_of_{self.name}")
        printer = self._printer(program.tests, self.variable)
        lines += self._body(program.tests, printer)
        tests = []
        for condition in program.conditions:
            text = printer.print(condition.quantity)
            scale = printer.print(condition.scale)
            if not condition.limit:
                tests.append(f"_is_left({text}, {scale})")
                continue
            below = f" / np.abs({scale})" if scale != "1.0" else ""
            tests.append(f"np.abs({text}) < {condition.limit!r}{below}")
        return [*lines, *statement("return", f"[{', '.join(tests)}]", "    ")]

    def _real_tests(self) -> list[str]:
        """Return two functions: of the limits, made once per call, and of the sizes, made per block."""
        program = self.program
        printer = self._printer(program.tests, self.variable)
        limits: list[str] = []
        sizes: list[Node] = []
        for condition in program.conditions:
            if not condition.limit:
                limits.append("0.0")
                sizes.append(Multiply((condition.scale, condition.quantity)))
                continue
            scale = printer.print(condition.scale)
            limits.append(repr(condition.limit) + (f" / np.abs({scale})" if scale != "1.0" else ""))
            is_positive = isinstance(condition.quantity, Laplace)
            sizes.append(condition.quantity if is_positive else Apply("abs", condition.quantity))
        fixed = needed(program.tests, [c.scale for c in program.conditions if c.limit])
        return [
            *self._head(f"_limits_of_{self.name}", is_free=True),
            *self._body(fixed, printer),
            *statement("return", f"[{', '.join(limits)}]", "    "),
            "",
            "",
            *self._head(f"_sizes_of_{self.name}"),
            *self._body(needed(program.tests, sizes), printer),
            *statement("return", f"[{', '.join(printer.print(x) for x in sizes)}]", "    "),
        ]

    def _piece(self, number: int, piece: Piece) -> list[str]:
        name, parts = (f"_{word}_{number}_of_{self.name}" for word in ("piece", "parts"))
        if piece.circle:
            given = ", ".join(["z", *(self.parameters[p] for p in self.program.parameters)])
            printer = self._printer(piece.code, self.variable)
            values = ", ".join(printer.print(v) for v in piece.code.values)
            whole = f"_mean_over_circle(lambda z: {parts}({given}), {self.variable}, {piece.circle})"
            return [
                *self._head(parts),
                *self._body(piece.code, printer),
                *statement("return", values, "    "),
                "",
                "",
                *self._head(name),
                *statement("return", whole, "    "),
            ]
        lines = self._head(name)
        variable = self.variable
        if piece.is_complex:
            variable = identifiers({"s": "s"}, {*self.reserved - {"s"}, *self.parameters.values()})["s"]
            lines.append(f"    {variable} = 1j * {self.variable}")
        printer = self._printer(piece.code, variable)
        lines += self._body(piece.code, printer)
        num, den = piece.code.values
        if not self.program.is_real:
            return [*lines, *statement("return", printer.quotient(num, den), "    ")]
        above, below = printer.print(num), printer.print(den)
        if piece.is_complex:
            # The factor that the real pieces leave out comes after.
            above = f"{'-1j' if self.program.turn else '(1+0j)'} * ({above})"
        whole = f"{above}, {below}"
        return [*lines, *statement("return", whole, "    ")]
