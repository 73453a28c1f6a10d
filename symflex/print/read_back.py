"""What is about to be printed, read back: its values against those of the transfer function.

Input: a transfer function and a form of it, before any printer sees it.
Output: nothing, or an error where the two differ.

    where q = s*l*c,  1/cosh(q)     at s = -83/64, l = 41/64, c = 107/64:    0.49...
    the function itself             1/cosh(s*l/c) there:                     0.89...   SF992

A form is read twice: as the tree from which LaTeX, MathML and SymPy are made, and as its text, which is
parsed as a user's would be. Names are what their lines define, in principal branches; functions of x are what
their differential equations say. Balls that do not meet prove that a form is wrong.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import islice
from typing import TYPE_CHECKING, Final, TypeVar

from flint import acb, arb

from symflex.algebra import LAPLACE, Dispersion, Factored, Kernel
from symflex.balls import Value, at_centre, ball, precision
from symflex.budget import spend
from symflex.errors import REPORT, Diagnostic, InternalError, SpecError, Text
from symflex.expressions import (
    PROGRAM_LIMITS,
    Bessel,
    Call,
    Derivative,
    Equation,
    Expression,
    Name,
    format_expression,
    is_longer,
    names,
    parse,
    parse_equation,
    product_of,
    replace_values,
)
from symflex.model.along import COORDINATE
from symflex.model.analysis import lines_in_order
from symflex.transfer import AnyTransferFunction
from symflex.transfer.enclose import principal_values
from symflex.transfer.probes import SOLVED_BITS, Probes, probes_of

if TYPE_CHECKING:
    from symflex.print.forms.printed import PrintedForm

PRECISIONS: Final = (64, 192, 576)  # bits at which points are tried that are not decided with fewer
LONGEST_TEXT: Final = 5000  # characters of one form that are parsed, at some 10 microseconds each
ENOUGH: Final = 24  # bits of a value that leave a wrong form no place to hide, as points have no meaning
INSIDE: Final = Fraction(3, 8)  # part of a member at whose end coefficients that vary along it are compared
E = TypeVar("E", bound=Expression)


class _DiffersError(Exception):
    """A form is wrong; its argument says where, or why it cannot be read."""


def read_back(tf: AnyTransferFunction, form: PrintedForm, digits: int | None = None) -> int:
    """Return at how many points a form has the values of its function; SF992 where they differ."""
    every = probes_of(tf)
    probes = every if digits is None else every.declared
    try:
        agreed = _Reader(tf, form, probes, digits).compared()
        # Most texts are read as the very tree they are made of.
        if (read := _as_read(form)) != form:
            _Reader(tf, read, probes, digits).compared()
        if form.closed:
            _Reader(tf, form, every.solved, digits).compared()
    except _DiffersError as error:
        message = f"the {form.name} form of {tf.name} is not shown, as it is wrong: {error}"
        raise InternalError(Diagnostic("SF992", message, None, REPORT)) from None
    return agreed


def read_hidden(
    tf: AnyTransferFunction,
    form: PrintedForm,
    factors: Sequence[tuple[Expression, int]],
    scales: Sequence[Fraction] = (),
) -> None:
    """Compare the factors that are said to have cancelled with those that have; SF992 where they differ.

    A factor is one up to a fourth root of its scale, or of 1, and may be that for s to the left, as
    wavenumbers are roots.
    """
    if not (tf.is_reduced and tf.hidden):
        return
    probes, bits = probes_of(tf), PRECISIONS[1]
    chosen = [i for i, (_, (re, _)) in enumerate(probes.points) if re > 0]
    with precision(bits):
        try:
            whole = replace(form, num=product_of([e for e, _ in factors]))
            points = _Points(_Reader(tf, whole, probes, None), bits, chosen)
            every = scales or [Fraction(1)] * len(factors)
            for (printed, _), known, scale in zip(factors, tf.hidden, every, strict=True):
                right = probes.values_of(Factored.polynomial(tf.ring, known.polynomial), bits, chosen)
                for x, y in zip(points.value(printed), right, strict=True):
                    if (x / y).is_finite() and not ((x / y) ** 4 * ball(scale)).contains(1):
                        raise _DiffersError(format_expression(printed))
        except _DiffersError as error:
            message = f"what cancelled from {tf.name} is not shown, as it is wrong: {error}"
            raise InternalError(Diagnostic("SF992", message, None, REPORT)) from None


@dataclass(frozen=True, eq=False)
class _Reader:
    """Evaluates one form at test points."""

    tf: AnyTransferFunction
    form: PrintedForm
    probes: Probes
    digits: int | None

    def compared(self) -> int:
        """Return at how many points the form is right."""
        pending: Sequence[int] = range(len(self.probes.points))
        agreed, is_printed, is_derived = 0, False, False
        for bits in (SOLVED_BITS, PRECISIONS[-1]) if self.probes.is_solved else PRECISIONS:
            spend()
            with precision(bits):
                pairs = self._pairs(bits, pending)
                is_printed |= any(x.is_finite() for x, _ in pairs)
                is_derived |= any(y.is_finite() for _, y in pairs)
                undecided = [i for i, pair in zip(pending, pairs, strict=True) if not self._is_decided(*pair)]
            agreed += len(pending) - len(undecided)
            pending = undecided
            if not pending:
                break
        if is_derived and not is_printed:
            raise _DiffersError("it has no value where the function has one")
        return agreed

    def _pairs(self, bits: int, chosen: Sequence[int]) -> list[tuple[acb, acb]]:
        """Return what is printed at some points, and what is right."""
        points, form = _Points(self, bits, chosen), self.form
        num, den = points.value(form.num), points.value(form.den)
        printed, derived = [x / y for x, y in zip(num, den, strict=True)], self.probes.values(bits, chosen)
        self.check(chosen, printed, derived, "its value")
        self.check(chosen, points.value(form.argument), points.known[LAPLACE], "its argument")
        points.check_laws()
        return list(zip(printed, derived, strict=True))

    def _is_decided(self, printed: acb, derived: acb) -> bool:
        """Tell whether balls that meet are narrow; those of decimals are as wide as these are rounded."""
        if not (printed.is_finite() and derived.is_finite()):
            return False
        bits = min(printed.rel_accuracy_bits(), derived.rel_accuracy_bits())
        return self.digits is not None or bool(bits >= ENOUGH)

    def check(self, chosen: Sequence[int], printed: Sequence[acb], right: Sequence[acb], what: str) -> None:
        """Raise an error where two balls do not meet."""
        for i, x, y in zip(chosen, printed, right, strict=True):
            if x.is_finite() and y.is_finite() and not x.overlaps(y):
                _, (re, im) = self.probes.points[i]
                at = complex(float(re), float(im))
                message = (
                    f"at s = {at:.4g} {what} is {complex(x.mid()):.4g} and should be {complex(y.mid()):.4g}"
                )
                raise _DiffersError(message)

    @cached_property
    def lines(self) -> Mapping[str, Expression]:
        """What names stand for, each after those it needs."""
        if not (self.form.where or self.form.laws or self.form.closed):
            return {}
        lines = dict(self.form.where)
        lines |= {left.name: e for left, e in self.form.closed if isinstance(left, Name)}
        laws = {name: law for name, law in self.form.laws if not isinstance(law.left, Derivative | Call)}
        joined = {name: self._with_laws(e, laws) for name, e in lines.items()}
        form = self.form
        roots = [form.num, form.den, form.argument, *laws.values(), *(law for _, law in form.laws)]
        roots += [e for _, e in form.closed]
        order, circle = lines_in_order(roots, joined)
        if circle:
            raise _DiffersError(f"names are defined in a circle: {' -> '.join(circle)}")
        return {name: lines[name] for name in order}

    @staticmethod
    def _with_laws(expression: Expression, laws: Mapping[str, Equation]) -> Expression:
        """Return an expression with the laws of the functions in it beside it, for what it needs first."""
        called = dict.fromkeys(n.name for n in names(expression) if isinstance(n, Call) and n.name in laws)
        for name in called:
            expression = Equation(expression, laws[name])
        return expression

    @cached_property
    def laws(self) -> Mapping[str, tuple[Equation, int]]:
        """The differential equations of functions of x, with their orders."""
        laws = {}
        for name, law in self.form.laws:
            if not isinstance(law.left, Derivative | Call):
                orders = (n.order for n in names(law) if isinstance(n, Derivative) and n.name == name)
                laws[name] = law, max(orders, default=0)
        return laws

    @property
    def kernels(self) -> Sequence[Kernel]:
        """The kernels of the transfer function."""
        return self.tf.kernels.kernels

    @cached_property
    def matrices(self) -> Sequence[tuple[Dispersion, tuple[tuple[str, Equation], ...]]]:
        """The laws that vary along x, each with the printed line of every row."""
        if not (self.tf.is_reduced and self.form.laws):
            return ()
        rows = iter([(name, law) for name, law in self.form.laws if isinstance(law.left, Derivative)])
        used = self.tf.ratio.ring.used_in(f for f, _ in self.tf.ratio.factors)
        table = self.tf.kernels
        return [
            (d, tuple(islice(rows, d.order)))
            for d in table.dispersions
            if any(k.function == "entry" and k.generator in used for k in table.kernels_of(d))
        ]

    @cached_property
    def entries(self) -> Mapping[str, tuple[Dispersion, int, int]]:
        """Row and column of what is called an entry of a fundamental matrix."""
        return {
            f"{name[:-1]}{j + 1}": (d, i, j)
            for d, rows in self.matrices
            for i, (name, _) in enumerate(rows)
            for j in range(len(rows))
        }


class _Points:
    """A form at some of the points, at the current precision."""

    def __init__(self, reader: _Reader, bits: int, chosen: Sequence[int]) -> None:
        self._reader, self._bits, self._chosen = reader, bits, chosen
        self._functions: dict[tuple[str, Expression], list[tuple[Value, ...]]] = {}
        self.known = reader.probes.numbers(chosen, bits)
        for name, line in reader.lines.items():
            self.known[name] = self.value(line)

    def value(self, expression: Expression, more: Mapping[str, list[acb]] | None = None) -> list[acb]:
        """Return the values of an expression, in which more names may be known."""
        values = self.known if more is None else {**self.known, **more}

        def named(name: str) -> list[acb]:
            if name not in values:
                raise _DiffersError(f"nothing says what {name} is")
            return values[name]

        return principal_values(expression, len(self._chosen), named, self._call, self._number)

    def _number(self, value: Fraction) -> arb:
        """Return a number, a decimal with what rounding took away."""
        middle = ball(value)
        digits = self._reader.digits
        return middle if digits is None else arb(middle, abs(middle) * arb(10) ** (1 - digits) / 2)

    def _call(self, call: Call, argument: list[acb]) -> list[acb]:
        if isinstance(call, Bessel):
            order = acb(ball(call.index))
            return [getattr(x, f"bessel_{call.kind.lower()}")(order) for x in argument]
        if call.name in self._reader.laws:
            key = call.name, call.argument
            if key not in self._functions:
                self._functions[key] = self._solutions(call.name, argument)
            return [at_centre(solutions[call.order]) for solutions in self._functions[key]]
        if call.name in self._reader.entries:
            return self._entry(call.name, argument)
        raise _DiffersError(f"nothing says what {call.name} is a function of")

    def _solutions(self, name: str, argument: list[acb]) -> list[tuple[Value, ...]]:
        """Return a function of x and its derivatives, as its differential equation says."""
        from symflex.transfer.enclose_kernels import fundamental_functions  # only with beams

        law, order = self._reader.laws[name]
        states = [Name(f"{name}{chr(39) * k}") for k in range(order + 1)]
        opened = replace_values(law.left, {Derivative(name, k): state for k, state in enumerate(states)})
        count = len(argument)
        parts = [self.value(opened, {x.name: [acb(int(x is own))] * count for x in states}) for own in states]
        solutions = []
        for *coefficients, leading, x in zip(*parts, argument, strict=True):
            solutions.append(fundamental_functions([c / leading for c in coefficients], x))
        return solutions

    def _entry(self, name: str, place: list[acb]) -> list[acb]:
        """Return an entry of a fundamental matrix."""
        tf, probes = self._reader.tf, self._reader.probes
        assert tf.is_reduced
        d, i, j = self._reader.entries[name]
        for kernel in self._reader.kernels:
            if kernel.dispersion is not d or kernel.order != i * d.order + j:
                continue
            right = probes.values_of(d.start[0] + kernel.length, self._bits, self._chosen)
            if all(x.overlaps(y) for x, y in zip(place, right, strict=True)):
                own = Factored.generator(tf.ratio.ring, kernel.generator)
                return probes.values_of(own, self._bits, self._chosen)
        raise _DiffersError(f"{name} is taken where nothing ends")

    def check_laws(self) -> None:
        """Compare the lines of laws that vary along x with these, and what is said of their solutions."""
        probes, check = self._reader.probes, self._reader.check
        for d, rows in self._reader.matrices:
            length = next(k.length for k in self._reader.kernels if k.dispersion is d)
            place = probes.values_of(d.start[0] + length * INSIDE, self._bits, self._chosen)
            for j in range(d.order):
                states = {name: [acb(int(i == j))] * len(place) for i, (name, _) in enumerate(rows)}
                for i, (name, law) in enumerate(rows):
                    printed = self.value(law.right, {**states, COORDINATE: place})
                    right = probes.along(d.matrix[i][j], place, self._bits, self._chosen)
                    check(self._chosen, printed, right, f"the equation of {name}")
        if not probes.is_solved:
            return
        for left, expression in self._reader.form.closed:
            if isinstance(left, Call):
                check(self._chosen, self.value(expression), self.value(left), format_expression(left))


def _as_read(form: PrintedForm) -> PrintedForm:
    """Return a form as its text is read; one too long, or with Bessel functions, as it is."""
    room = LONGEST_TEXT

    def read(expression: E, reader: Callable[..., E]) -> E:
        nonlocal room
        if is_longer([expression], room):
            return expression
        text = format_expression(expression)
        room -= len(text)
        if room < 0:
            return expression
        try:
            return reader(Text.alone("<printed>", text), limits=PROGRAM_LIMITS)
        except SpecError as error:
            if error.diagnostics[0].code == "SF103":
                return expression
            raise _DiffersError(f"its text cannot be read, {error.diagnostics[0].message}") from None

    return replace(
        form,
        num=read(form.num, parse),
        den=read(form.den, parse),
        where=tuple((name, read(e, parse)) for name, e in form.where),
        laws=tuple((name, read(law, parse_equation)) for name, law in form.laws),
    )
