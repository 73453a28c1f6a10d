"""Expressions of a program tree as C text, with complex arithmetic spelled out.

C's own complex multiplication and division look for infinities in every result, which costs several times the
arithmetic and depends on compiler flags. Here an expression is known to be real, imaginary or complex when it
is printed, and only products and quotients of two complex numbers take complex arithmetic. On the frequency
axis powers of s are real or imaginary, and so is most of what they are multiplied by.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from typing import TYPE_CHECKING

from symflex.codegen.program import nodes as tree
from symflex.codegen.program.evaluate import nearest_double

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

FEW = 3
"""Powers up to this one are products."""

DEEPEST = 3
"""Calls nested in each other from which a variable is made, for the reader's sake."""

_SUM, _PRODUCT, _SIGN, _LEAF = range(4)

REAL_FUNCTIONS = {
    name: name for name in ("sqrt", "exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh")
} | {"complex_exp": "exp"}
"""What C calls each of the elementary functions of a real number."""


LANE_FUNCTIONS = ("tan", "exp", "tanh")
"""Functions of real numbers that there are without branches."""


class Kind(Enum):
    """What kind of number an expression is."""

    REAL = "real"
    IMAGINARY = "imaginary"
    COMPLEX = "complex"

    @property
    def type(self) -> str:
        """The C type of a variable that holds it; of an imaginary number it is the imaginary part."""
        return "cx" if self is Kind.COMPLEX else "double"


@dataclass(frozen=True, slots=True)
class Term:
    """An expression of C."""

    text: str  # the expression; of an imaginary number, its imaginary part
    kind: Kind  # what kind of number it is
    varies: bool = False  # true when it depends on s
    binding: int = _LEAF  # how tightly its outermost operator binds
    depth: int = 0  # how many calls are nested in it
    # Of an array of complex numbers, the position of the one that is real; negative for none.
    real_at: int = -1

    def within(self, tightest: int) -> str:
        """Return the text, in parentheses where an operator around it binds tighter."""
        return self.text if self.binding >= tightest else f"({self.text})"


@dataclass(frozen=True)
class CPrinter:
    """Prints expressions as C, evaluated in the order of the tree."""

    parameter: Callable[[str], str]  # returns the identifier of a parameter
    known: Mapping[str, Term]  # intermediate values; of lists, the identifier of the array
    s: Term  # what the leaf :class:`Laplace` stands for
    # Declares an array with the values of a list, and returns its identifier.
    array: Callable[[tree.CodeNode], Term]
    hold: Callable[[Term], Term]  # makes a variable with a value
    in_lanes: bool = False  # true to call functions without branches where there are such

    def print(self, node: tree.CodeNode) -> Term:
        """Return an expression as C; calls nested deeply become variables."""
        return self._short(self.whole(node))

    def whole(self, node: tree.CodeNode) -> Term:
        """Return an expression that gets a variable anyway."""
        match node:
            case tree.RealNumber(value, pi_power):
                return Term(repr(nearest_double(value, pi_power)), Kind.REAL)
            case tree.ComplexNumber(real, imaginary):
                return _complex(nearest_double(real), nearest_double(imaginary))
            case tree.ToComplex(operand) | tree.LargerRoot(operand):
                return self.whole(operand)
            case tree.ParameterValue(name):
                return Term(self.parameter(name), Kind.REAL)
            case tree.Assigned(name):
                return self.known[name]
            case tree.Laplace():
                return self.s
            case tree.InverseLaplace():
                return self.quotient(Term("1.0", Kind.REAL), self.s)
            case tree.Add(terms):
                return self._sum(terms)
            case tree.Multiply(factors):
                result = self.print(factors[0])
                for factor in factors[1:]:
                    result = product(self._short(result), self.print(factor))
                return result
            case tree.Divide(numerator, denominator):
                return self.quotient(self.print(numerator), self.print(denominator))
            case tree.IntegerPower(base, exponent):
                return _power(self.print(base), exponent)
            case tree.Negate(operand):
                return negative(self.print(operand))
            case tree.Apply(function, argument):
                return self._apply(function, self.print(argument))
            case tree.Item(values, position):
                held = self.listed(values)
                part, kind = (".re", Kind.REAL) if position == held.real_at else ("", held.kind)
                return Term(f"{held.text}[{position}]{part}", kind, held.varies)
        message = f"no text for {type(node).__name__}"
        raise TypeError(message)

    def quotient(self, x: Term, y: Term) -> Term:
        """Return the quotient of two numbers, in lanes without branches."""
        if self.in_lanes and y.kind is Kind.COMPLEX and (x.varies or y.varies):
            return _call("lane_div", Kind.COMPLEX, complex_term(x), y)
        return quotient(x, y)

    def listed(self, node: tree.CodeNode) -> Term:
        """Return the array that holds a list; it is declared where there is none yet."""
        return self.known[node.name] if isinstance(node, tree.Assigned) else self.array(node)

    def _sum(self, terms: Sequence[tree.CodeNode]) -> Term:
        result = self.print(terms[0])
        for term in terms[1:]:
            if isinstance(term, tree.Negate):
                result = difference(self._short(result), self.print(term.operand))
            else:
                result = total(self._short(result), self.print(term))
        return result

    def _short(self, term: Term) -> Term:
        return self.hold(term) if term.depth > DEEPEST else term

    def _apply(self, function: str, x: Term) -> Term:
        if function == "abs":
            return _call("cx_abs" if x.kind is Kind.COMPLEX else "fabs", Kind.REAL, x)
        if function == "complex_sqrt":
            return _call("cx_sqrt", Kind.COMPLEX, complex_term(x))
        if function == "complex_exp" and x.kind is not Kind.REAL:
            return _call("cx_cis" if x.kind is Kind.IMAGINARY else "cx_exp", Kind.COMPLEX, x)
        if x.kind is not Kind.REAL:
            message = f"no text for {function} of a complex number"
            raise TypeError(message)
        if self.in_lanes and x.varies and function in LANE_FUNCTIONS:
            return _call(f"lane_{function}", Kind.REAL, x)
        return _call(REAL_FUNCTIONS[function], Kind.REAL, x)


def _complex(real: float, imaginary: float) -> Term:
    if not real:
        return Term(repr(imaginary), Kind.IMAGINARY, binding=_SIGN if imaginary < 0 else _LEAF)
    if not imaginary:
        return Term(repr(real), Kind.REAL, binding=_SIGN if real < 0 else _LEAF)
    return Term(f"cx_of({real!r}, {imaginary!r})", Kind.COMPLEX)


def _infix(x: Term, operator: str, y: Term, kind: Kind) -> Term:
    binding, others = (_SUM, (_SUM, _PRODUCT)) if operator in "+-" else (_PRODUCT, (_PRODUCT, _SIGN))
    text = f"{x.within(others[0])} {operator} {y.within(others[1])}"
    return Term(text, kind, x.varies or y.varies, binding, max(x.depth, y.depth))


def _call(name: str, kind: Kind, *arguments: Term) -> Term:
    text = ", ".join(a.text for a in arguments)
    depth = 1 + max(a.depth for a in arguments)
    return Term(f"{name}({text})", kind, any(a.varies for a in arguments), _LEAF, depth)


def complex_term(x: Term) -> Term:
    """Return the same number as a complex one.

    Examples
    --------
    >>> complex_term(Term("a", Kind.REAL)).text
    'cx_of(a, 0.0)'
    """
    zero = Term("0.0", Kind.REAL)
    match x.kind:
        case Kind.REAL:
            return _call("cx_of", Kind.COMPLEX, x, zero)
        case Kind.IMAGINARY:
            return _call("cx_of", Kind.COMPLEX, zero, x)
        case Kind.COMPLEX:
            return x


def negative(x: Term) -> Term:
    """Return minus a number.

    Examples
    --------
    >>> negative(Term("a * b", Kind.IMAGINARY, binding=1)).text
    '-(a * b)'
    """
    if x.kind is Kind.COMPLEX:
        return _call("cx_neg", Kind.COMPLEX, x)
    return replace(x, text=f"-{x.within(_LEAF)}", binding=_SIGN)


def total(x: Term, y: Term) -> Term:
    """Return the sum of two numbers.

    Examples
    --------
    >>> total(Term("a", Kind.REAL), Term("b", Kind.IMAGINARY)).text
    'cx_of(a, b)'
    """
    match x.kind, y.kind:
        case (Kind.COMPLEX, Kind.COMPLEX):
            return _call("cx_add", Kind.COMPLEX, x, y)
        case (Kind.COMPLEX, Kind.REAL):
            return _call("cx_addr", Kind.COMPLEX, x, y)
        case (Kind.COMPLEX, Kind.IMAGINARY):
            return _call("cx_addi", Kind.COMPLEX, x, y)
        case (_, Kind.COMPLEX):
            return total(y, x)
        case (Kind.REAL, Kind.IMAGINARY):
            return _call("cx_of", Kind.COMPLEX, x, y)
        case (Kind.IMAGINARY, Kind.REAL):
            return _call("cx_of", Kind.COMPLEX, y, x)
    return _infix(x, "+", y, x.kind)


def difference(x: Term, y: Term) -> Term:
    """Return one number less another.

    Examples
    --------
    >>> difference(Term("a", Kind.REAL), Term("b", Kind.REAL)).text
    'a - b'
    """
    match x.kind, y.kind:
        case (Kind.COMPLEX, Kind.COMPLEX):
            return _call("cx_sub", Kind.COMPLEX, x, y)
        case (Kind.REAL, Kind.COMPLEX):
            return _call("cx_rsub", Kind.COMPLEX, x, y)
        case (Kind.IMAGINARY, Kind.COMPLEX):
            return _call("cx_sub", Kind.COMPLEX, complex_term(x), y)
        case (Kind.REAL, Kind.REAL) | (Kind.IMAGINARY, Kind.IMAGINARY):
            return _infix(x, "-", y, x.kind)
    return total(x, negative(y))


def product(x: Term, y: Term) -> Term:
    """Return the product of two numbers.

    Examples
    --------
    >>> product(Term("w", Kind.IMAGINARY), Term("w", Kind.IMAGINARY)).text
    '-(w * w)'
    """
    match x.kind, y.kind:
        case (Kind.COMPLEX, Kind.COMPLEX):
            return _call("cx_mul", Kind.COMPLEX, x, y)
        case (Kind.REAL, Kind.COMPLEX):
            return _call("cx_scale", Kind.COMPLEX, x, y)
        case (Kind.IMAGINARY, Kind.COMPLEX):
            return _call("cx_turn", Kind.COMPLEX, x, y)
        case (Kind.COMPLEX, _):
            return product(y, x)
        case (Kind.IMAGINARY, Kind.IMAGINARY):
            return negative(_infix(x, "*", y, Kind.REAL))
    return _infix(x, "*", y, Kind.REAL if x.kind is y.kind else Kind.IMAGINARY)


def quotient(x: Term, y: Term) -> Term:
    """Return the quotient of two numbers.

    Examples
    --------
    >>> quotient(Term("a", Kind.REAL), Term("w", Kind.IMAGINARY)).text
    '-(a / w)'
    """
    match x.kind, y.kind:
        case (_, Kind.COMPLEX):
            return _call("cx_div", Kind.COMPLEX, complex_term(x), y)
        case (Kind.COMPLEX, _):
            name = "cx_over" if y.kind is Kind.REAL else "cx_under"
            return _call(name, Kind.COMPLEX, x, y)
        case (Kind.REAL, Kind.IMAGINARY):
            return negative(_infix(x, "/", y, Kind.IMAGINARY))
        case (Kind.IMAGINARY, Kind.IMAGINARY):
            return _infix(x, "/", y, Kind.REAL)
    return _infix(x, "/", y, x.kind)


def _power(base: Term, exponent: int) -> Term:
    """Return a power of what does not vary with s."""
    if base.kind is not Kind.REAL:
        result = base
        for _ in range(exponent - 1):
            result = product(result, base)
        return result
    if exponent <= FEW and base.binding == _LEAF and not base.depth:
        text = " * ".join([base.text] * exponent)
        return Term(text, Kind.REAL, base.varies, _PRODUCT)
    return _call("pow", Kind.REAL, base, Term(f"{exponent}.0", Kind.REAL))
