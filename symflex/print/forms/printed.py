"""What a form is, the contract of its maker, and which forms a function has."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from symflex.algebra import LAPLACE, Factored
from symflex.errors import UsageError, refused
from symflex.expressions import (
    FUNCTIONS,
    Bessel,
    Call,
    Equation,
    Expression,
    Name,
    format_expression,
    names,
)
from symflex.transfer import TransferFunction
from symflex.transfer.transfer_function import degree

if TYPE_CHECKING:
    from symflex.roots.pole_zero_map import StabilityVerdict


S: Final = Name(LAPLACE)


@dataclass(frozen=True, slots=True)
class Approximation:
    """What is proved of a formula that is not exact."""

    said: tuple[str, ...]  # a sentence an entry
    facts: dict[str, object]  # the same as JSON data
    is_whole: bool = False  # nothing was left out


@dataclass(frozen=True, slots=True)
class PrintedForm:
    """A transfer function as an author would write it."""

    name: str  # the form's name, a key of ``FORMS``
    # num and den: numerator and denominator, terms and factors in the order of print.
    num: Expression
    den: Expression
    # The names that occur and what they stand for; a line may use the names of any other, without cycles.
    where: tuple[tuple[str, Expression], ...] = ()
    # Functions of x that occur, with the differential equation each solves: at x = 0 the highest but one of
    # its derivatives is one and those before it are zero. Only for field equations whose exponents have no
    # formula. Where coefficients vary along x, a line per state: ``Z_1j' = ...``, and ``Z_ij(0) = delta_ij``.
    laws: tuple[tuple[str, Equation], ...] = ()
    # What the functions of laws are where a closed form is known, and the names in it: defined, and what by.
    closed: tuple[tuple[Expression, Expression], ...] = ()
    argument: Expression = S  # of the transfer function: s, or the imaginary unit times the angular frequency
    definitions: frozenset[str] = frozenset()  # the names of lines that the model itself has
    # The function in the names of the form, where definitions are closed that its own ring has opened.
    source: TransferFunction | None = field(default=None, compare=False, repr=False)
    # Of a form that lists poles: whether the model is stable, which hidden modes decide too.
    stability: StabilityVerdict | None = None
    approximation: Approximation | None = None  # of a form that is not exact

    @property
    def remarks(self) -> tuple[str, ...]:
        """What is said of it besides the formula, a sentence an entry."""
        verdict = (self.stability.headline,) if self.stability else ()
        return verdict + (self.approximation.said if self.approximation else ())

    def at(self, name: str) -> str:
        """Return what a signal is called, with the argument where that is not s: ``X(omega)``."""
        return name if self.argument == S else f"{name}({format_expression(self.argument)})"


@dataclass(frozen=True, slots=True)
class BegunForm:
    """A form of a function with kernels before its sums are arranged, which is what takes long."""

    terms: int  # of numerator and denominator
    finish: Callable[[], PrintedForm]


def terms_of(value: Factored) -> int:
    """Return the number of terms of all factors."""
    return sum(len(factor) for factor, _ in value.factors)


Arrange = Callable[..., PrintedForm]  # arranges a transfer function; one that prints decimals takes digits
Begin = Callable[..., BegunForm | None]  # begins a form; ``None`` if it is no other than the first one
RATIONAL = ("definitions", "factored", "polynomial", "monic", "constant", "zpk", "frequency")
"""The forms of a rational function."""
DISTRIBUTED = ("hyperbolic", "factored", "krylov", "vaughan", "frequency", "polynomial")
"""The forms of a function with kernels of wavenumbers that have a formula."""
WITHOUT_FORMULA = ("hyperbolic", "krylov", "factored", "polynomial")
"""The forms of a function whose wavenumbers have none."""
KERNELS_ONLY, RATIONAL_ONLY = ("hyperbolic", "krylov", "vaughan"), ("monic", "constant", "zpk")
FORMULA_ONLY = ("vaughan", "frequency")
NOT_ENTIRE = "in lowest terms its numerator and denominator could not be shown to be entire in s"


def functions_in(form: PrintedForm) -> dict[str, str]:
    """Return labels of functions of x and of Bessel functions that occur, by name; empty if to be made."""
    every = (form.num, form.den, *(e for _, e in (*form.where, *form.closed)))
    calls = [n for e in every for n in names(e) if isinstance(n, Call) and n.name not in FUNCTIONS]
    return {n.name: n.latex if isinstance(n, Bessel) else "" for n in calls}


def forms_of(tf: TransferFunction) -> tuple[str, ...]:
    """Return the forms a transfer function has."""
    if tf.is_rational:
        return RATIONAL
    return WITHOUT_FORMULA if not tf.has_formula else DISTRIBUTED


def require(tf: TransferFunction, form: str) -> None:
    """Refuse a form that a transfer function has not. Raises UsageError: SF902."""
    if form in ("zpk", "frequency") and tf.model.root is not None:
        reason = "it contains roots of s"
    elif form in KERNELS_ONLY and tf.is_rational:
        reason = "it is a rational function of s"
    elif form in RATIONAL_ONLY and not tf.is_rational:
        reason = "it is not a rational function of s"
    elif form in FORMULA_ONLY and not tf.has_formula:
        reason = "the exponents of its field equations have no formula"
    else:
        return
    raise lacks(tf, form, reason)


def lacks(tf: TransferFunction, form: str, reason: str) -> UsageError:
    """Return the error that a transfer function has not a form, which hints at those it has."""
    hint = f"forms of {tf.name}: " + ", ".join(name for name in forms_of(tf) if name != form)
    return refused(f"{tf.name} has no {form} form: {reason}", hint)


def counts_of(tf: TransferFunction) -> tuple[int | None, int | None]:
    """Return the numbers of zeros and poles, ``None`` for infinitely many."""
    return _roots_of(tf.num, tf), _roots_of(tf.den, tf)


def _roots_of(value: Factored, tf: TransferFunction) -> int | None:
    ring = value.ring
    kernels = [
        k for k in tf.kernels.kernels if any(f == ring.generator(k.generator) for f, _ in value.factors)
    ]
    places = [ring.index[k.generator] for k in tf.kernels.kernels]
    in_sums = any(len(f) > 1 and any(int(f.degrees()[i]) for i in places) for f, _ in value.factors)
    # An exponential by itself is nowhere zero.
    if in_sums or any(k.function != "exp" for k in kernels):
        return None
    return degree(value.numerator())
