"""Numerators and denominators as tapes: what a page needs to certify poles and zeros under a slider.

Input: a :class:`symflex.transfer.TransferFunction`, and the identifiers of parameters in the exported module.
Output: a dict that JSON can say, or one with the reason why there is no tape, ``{"refused": "..."}``.

A tape is a list of instructions; instruction i computes register i. ``m*s^2 + k`` is::

    [["p", 0], ["p", 1], ["s"], ["*", 2, 2], ["*", 0, 3], ["+", 4, 1]]

``symflex/live/roots.js`` evaluates it on discs: a result holds every value that the function takes on the
disc of s, for exactly these doubles as parameters. Let F be analytic and F(conj s) = conj F(s).

Interval Newton (Moore 1966; complex: Krawczyk 1969). Let F' on a disc about z lie in a disc G without 0. If
``z - F(z)/G`` lies within the disc about z, that holds one zero of F, and it is simple.

Argument principle (Cauchy 1831). F has as many zeros in a polygon, counted with multiplicity, as its argument
turns on the way around; if the polygon is its own mirror image, the upper half of it turns half as often.

A numerator or denominator with kernels is a polynomial in wavenumbers q and exponentials, times powers of q
that make it analytic and the same for every choice of q among the roots that it is: so on a disc any branch
serves that is continuous there. :class:`~symflex.roots.functions.kernel_function.KernelFunction` tells these
powers, ``algebra/vanishing`` the order of the zero at s = 0; both for all values at once. The tape divides by
``exp(growth)``, which has no zeros, and what its argument turns is added to the count. The count is valid
where the laws of q have no poles: their divisors are on the tape, too, and must not vanish in the window.

A polynomial in s of degree n has n zeros: n discs that are apart hold them all, and need no count.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial, reduce

from symflex.algebra import Factored
from symflex.algebra.vanishing import OriginSeries
from symflex.codegen.program import nodes as tree
from symflex.codegen.program.band import is_closed
from symflex.codegen.program.build import TERM_LIMIT, Generators, forge_of
from symflex.codegen.program.derivative import differentiated
from symflex.codegen.program.distributed import Pieces
from symflex.codegen.program.evaluate import nearest_double
from symflex.codegen.program.forge import straight
from symflex.errors import Diagnostic, SymflexError, UncertifiedError
from symflex.roots import Everything, Modes, PoleZeroMap
from symflex.roots.functions.kernel_function import SERIES_TERMS, KernelFunction
from symflex.roots.locate import locate
from symflex.roots.passivity import energy_proof
from symflex.transfer import AnyTransferFunction, BoundTransferFunction, TransferFunction, bind

MODES = 10  # number of modes that a page follows; the edge of its window lies between that and the next ones
FIXED = "it is evaluated by a product over its roots, whose parameters are fixed"
ULP = 2.0**-52  # bound of the relative error of a number that is rounded to a double


def tape_of(
    tf: AnyTransferFunction, names: Mapping[str, str], modes: int = MODES
) -> tuple[dict[str, object], PoleZeroMap | None]:
    """Return the tapes of numerator and denominator, and the roots from which they are followed.

    Without tapes it is said why there are none; ``names`` are identifiers.
    """
    if (reason := _refusal(tf)) or not tf.is_reduced:
        return {"refused": reason}, None
    try:
        moved = [p.name for p in tf.model.parameters if p.value is not None and p.value.rational]
        bound = bind(tf, varied=moved)
        located = locate(bound, Everything() if tf.is_rational else Modes(modes + 2), digits=17)
        sides = {"poles": list(_parts(tf, bound, 1)), "zeros": list(_parts(tf, bound, 0))}
    except SymflexError as error:
        return {"refused": error.diagnostics[0].message}, None
    # One of each conjugate pair, and those at 0 left out.
    start = {
        kind: [[z.real, z.imag] for z in map(complex, getattr(located, kind)) if z and z.imag >= 0]
        for kind in sides
    }
    # Energy decides on stability whatever the values are, if they are positive.
    every = tuple(p.name for p in tf.model.parameters)
    passive = energy_proof(tf.model, output=tf.output, free=every).is_passive
    named = {"parameters": [names[p.name] for p in tf.parameters], "modes": modes, "passive": passive}
    return named | {"start": start, **sides}, located


def _refusal(tf: AnyTransferFunction) -> str:
    """Return why there is no tape of a function, empty where there may be one."""
    if not is_closed(tf):
        return FIXED
    if not tf.is_reduced or tf.is_large or tf.length > TERM_LIMIT:
        return "its polynomials would have too many terms"
    if tf.model.root is not None or tf.model.imaginary:
        return "it is a function of a root of s, or its coefficients are complex"
    return "it is zero" if tf.is_zero else ""


def _parts(tf: TransferFunction, bound: BoundTransferFunction, number: int) -> Iterator[dict[str, object]]:
    """Yield what numerator (0) or denominator (1) is a product of, with tapes and orders at s = 0."""
    side, ring = (tf.num, tf.den)[number], tf.ratio.ring
    if not any(side.depends_on(k.generator) for k in tf.kernels.kernels):
        for polynomial, exponent in side.factors:
            forge = forge_of(tf.model)
            value, degree = Generators(forge, tf, is_far=False).polynomial(ring, polynomial)
            if degree:
                lowest = min(int(monomial[0]) for monomial in polynomial.monoms())
                counts = {"degree": degree, "order": lowest, "multiplicity": exponent}
                yield counts | _taped(tf, straight(forge, [value]))
        return
    exact = (bound.num, bound.den)[number]
    function, factor = KernelFunction(bound, exact), Factored.number(ring, 1)
    for wave in tf.kernels.wavenumbers:
        q = exact.ring.generator(wave)
        change = function.part.exponent_of(q) - exact.exponent_of(q)
        factor = factor * Factored.generator(ring, wave) ** change
    orders = [OriginSeries(ring, tf.kernels, terms=n).order(side * factor) for n in SERIES_TERMS]
    order = next((n for n in orders if n is not None), None)
    if function.power > 1 or order is None:
        message = f"a part of {tf.name} has no value of its own for every s"
        raise UncertifiedError(Diagnostic("SF404", message))
    counts = {"degree": 0, "order": order, "multiplicity": 1}
    yield counts | _taped(tf, Pieces(tf).side(number, factor))


def _taped(tf: TransferFunction, code: tree.Straight) -> dict[str, object]:
    """Return the tape of code, with the registers of its value, slope, growth and divisors."""
    tape, both = _Tape({p.name: i for i, p in enumerate(tf.parameters)}), differentiated(code)
    for a in both.every:
        tape.names[a.name] = tape.register(a.value)
    value, slope, *others = (tape.register(v) for v in (*both.values[:2], *both.values[2::2]))
    return {
        "tape": tape.instructions,
        "value": value,
        "slope": slope,
        "growth": others[:1],
        "divisors": others[1:],
    }


@dataclass
class _Tape:
    """Instructions while they are written."""

    places: Mapping[str, int]  # of parameters
    names: dict[str, int] = field(default_factory=dict)  # registers of assigned values
    instructions: list[tuple[object, ...]] = field(default_factory=list)
    _known: dict[tuple[object, ...], int] = field(default_factory=dict)

    def _write(self, *row: object) -> int:
        if row not in self._known:
            self._known[row] = len(self.instructions)
            self.instructions.append(row)
        return self._known[row]

    def _number(self, re: Fraction | int, im: Fraction | int = 0, pi_power: int = 0) -> int:
        x, y = nearest_double(Fraction(re), pi_power), nearest_double(Fraction(im))
        is_exact = not pi_power and (Fraction(x), Fraction(y)) == (re, im)
        return self._write("#", x, y, 0.0 if is_exact else ULP * (abs(x) + abs(y)))

    def _is_zero(self, x: int) -> bool:
        return self.instructions[x] == ("#", 0.0, 0.0, 0.0)

    def _joined(self, sign: str, x: int, y: int) -> int:
        """Write a sum, difference or product that zeros do not make needless."""
        if self._is_zero(y):
            return y if sign == "*" else x
        return self._write(sign, x, y) if sign == "-" or not self._is_zero(x) else x if sign == "*" else y

    def register(self, node: tree.CodeNode) -> int:
        """Write what computes an expression, and return its register."""
        match node:
            case tree.RealNumber(value, pi_power):
                return self._number(value, pi_power=pi_power)
            case tree.ComplexNumber(re, im):
                return self._number(re, im)
            case tree.ParameterValue(name):
                return self._write("p", self.places[name])
            case tree.Laplace():
                return self._write("s")
            case tree.Assigned(name):
                return self.names[name]
            case tree.ToComplex(operand) | tree.LargerRoot(operand):
                return self.register(operand)
            case tree.Negate(operand):
                return self._joined("-", self._number(0), self.register(operand))
            case tree.Add((first, *others)):
                total = self.register(first)
                for x in others:
                    sign, size = ("-", x.operand) if isinstance(x, tree.Negate) else ("+", x)
                    total = self._joined(sign, total, self.register(size))
                return total
            case tree.Multiply(factors):
                return reduce(partial(self._joined, "*"), map(self.register, factors))
            case tree.Divide(above, below):
                return self._joined("*", self.register(above), self._write("/", self.register(below)))
            case tree.IntegerPower(base, exponent):
                return reduce(partial(self._joined, "*"), [self.register(base)] * exponent)
            case tree.Apply(function, argument):
                return self._applied(function.removeprefix("complex_"), self.register(argument))
        raise UncertifiedError(Diagnostic("SF404", f"{type(node).__name__} has no enclosure in doubles"))

    def _applied(self, function: str, x: int) -> int:
        match function:
            case "abs":  # what programs add there is less than a rounding: analytic functions do without
                return self._number(0)
            case "sqrt":
                return x if self._is_zero(x) else self._write("sqrt", x)
            case "exp":
                return self._write("exp", x)
            case "tan" | "tanh":
                above, below = (self._applied(name + function[3:], x) for name in ("sin", "cos"))
                return self._joined("*", above, self._write("/", below))
            case "cosh" | "sinh" | "cos" | "sin":
                turn = (1, 0) if function.endswith("h") else (0, 1)
                rate, is_even = self._joined("*", x, self._number(*turn)), function.startswith("cos")
                up, down = (self._write("exp", y) for y in (rate, self._joined("-", self._number(0), rate)))
                # cosh = (up + down)/2, sinh = (up - down)/2, sin = (up - down)/2j
                re, im = (1, 0) if is_even else (turn[0], -turn[1])
                half = self._number(Fraction(re, 2), Fraction(im, 2))
                return self._joined("*", self._joined("+" if is_even else "-", up, down), half)
        raise UncertifiedError(Diagnostic("SF404", f"{function} has no enclosure in doubles"))
