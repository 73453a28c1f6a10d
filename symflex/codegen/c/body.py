"""Expressions in C, and the body of a function while it is printed: variables, statements, branches.

C's own complex multiplication and division look for infinities in every result, which costs several times the
arithmetic and depends on compiler flags. Here an expression is known to be real, imaginary or complex when it
is printed, and only products and quotients of two complex numbers take complex arithmetic. On the frequency
axis powers of s are real or imaginary, and so is most of what they are multiplied by.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from fractions import Fraction
from itertools import count

from symflex.codegen.export import parts_of
from symflex.codegen.module_text import WIDTH, identifiers, statement_lines
from symflex.codegen.program import nodes as tree
from symflex.codegen.program.evaluate import nearest_double

FEW, DEEPEST = 3, 3  # powers up to this are products; from as many nested calls a variable is made
_SUM, _PRODUCT, _SIGN, _LEAF = range(4)

REAL_FUNCTIONS = {  # what C calls each of the elementary functions of a real number
    name: name for name in ("sqrt", "exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "atan")
} | {"complex_exp": "exp"}


LANE_FUNCTIONS = ("tan", "exp")  # functions of real numbers that there are without branches


class Kind(Enum):
    """What kind of number an expression is."""

    REAL = "real"
    IMAGINARY = "imaginary"
    COMPLEX = "complex"

    @property
    def type(self) -> str:
        """The C type of a variable that contains it; of an imaginary number it is the imaginary part."""
        return "cx" if self is Kind.COMPLEX else "double"


@dataclass(frozen=True, slots=True)
class Term:
    """An expression of C."""

    text: str  # the expression; of an imaginary number, its imaginary part
    kind: Kind  # what kind of number it is
    varies: bool = False  # true when it depends on s
    binding: int = _LEAF  # how tightly its outermost operator binds
    depth: int = 0  # how many calls are nested in it

    def within(self, tightest: int) -> str:
        """Return the text, in parentheses where an operator around it binds tighter."""
        return self.text if self.binding >= tightest else f"({self.text})"


def _complex(real: float, imaginary: float) -> Term:
    if not real:
        return Term(repr(imaginary), Kind.IMAGINARY, binding=_SIGN if imaginary < 0 else _LEAF)
    if not imaginary:
        return Term(repr(real), Kind.REAL, binding=_SIGN if real < 0 else _LEAF)
    return Term(f"cx_of({real!r}, {imaginary!r})", Kind.COMPLEX)


def _cut_off(s: Term, end: float) -> Term:
    """Return s up to an absolute value, beyond which it is not a number."""
    if s.kind is Kind.COMPLEX:
        return _call("cx_scale", Kind.COMPLEX, Term(f"cx_abs({s.text}) <= {end!r} ? 1.0 : NAN", Kind.REAL), s)
    return replace(s, text=f"(fabs({s.text}) <= {end!r} ? {s.text} : NAN)", binding=_LEAF)


def _roots(s: Term, factor: tree.RootFactor) -> Term:
    """Return the factor of two or four roots, a real number where the imaginary axis mirrors them."""
    im, re = ([Term(repr(x), Kind.REAL) for x in part] for part in (factor.im, factor.re))
    if s.kind is Kind.IMAGINARY and factor.is_real_on_axis:
        if not factor.is_mirrored:
            return _call("cx_axial", Kind.REAL, s, *im)
        if not factor.is_pair:
            return _call("cx_two", Kind.REAL, s, re[0])
        return _call("cx_four", Kind.REAL, s, *im, re[0])
    s = complex_term(s)
    if not factor.is_pair:
        return _call("cx_mirrored", Kind.COMPLEX, s, *re)
    term = _call("cx_pair", Kind.COMPLEX, s, *im, *re)
    minus = [Term(repr(-x), Kind.REAL) for x in factor.re]
    return product(term, _call("cx_pair", Kind.COMPLEX, s, *im, *minus)) if factor.is_mirrored else term


def _infix(x: Term, operator: str, y: Term, kind: Kind) -> Term:
    binding, others = (_SUM, (_SUM, _PRODUCT)) if operator in "+-" else (_PRODUCT, (_PRODUCT, _SIGN))
    text = f"{x.within(others[0])} {operator} {y.within(others[1])}"
    return Term(text, kind, x.varies or y.varies, binding, max(x.depth, y.depth))


def _call(name: str, kind: Kind, *arguments: Term) -> Term:
    text = ", ".join(a.text for a in arguments)
    depth = 1 + max(a.depth for a in arguments)
    return Term(f"{name}({text})", kind, any(a.varies for a in arguments), _LEAF, depth)


def complex_term(x: Term) -> Term:
    """Return the same number as a complex one."""
    zero = Term("0.0", Kind.REAL)
    match x.kind:
        case Kind.REAL:
            return _call("cx_of", Kind.COMPLEX, x, zero)
        case Kind.IMAGINARY:
            return _call("cx_of", Kind.COMPLEX, zero, x)
        case Kind.COMPLEX:
            return x


def negative(x: Term) -> Term:
    """Return minus a number."""
    if x.kind is Kind.COMPLEX:
        return _call("cx_neg", Kind.COMPLEX, x)
    return replace(x, text=f"-{x.within(_LEAF)}", binding=_SIGN)


# What computes with a complex number: plus another, another less it, times another, by the other's kind.
_SUMS = {Kind.COMPLEX: "cx_add", Kind.REAL: "cx_addr", Kind.IMAGINARY: "cx_addi"}
_DIFFERENCES = {Kind.COMPLEX: "cx_sub", Kind.REAL: "cx_rsub", Kind.IMAGINARY: "cx_isub"}
_PRODUCTS = {Kind.COMPLEX: "cx_mul", Kind.REAL: "cx_scale", Kind.IMAGINARY: "cx_turn"}


def total(x: Term, y: Term) -> Term:
    """Return the sum of two numbers."""
    if Kind.COMPLEX in (x.kind, y.kind):
        first, second = (x, y) if x.kind is Kind.COMPLEX else (y, x)
        return _call(_SUMS[second.kind], Kind.COMPLEX, first, second)
    if x.kind is y.kind:
        return _infix(x, "+", y, x.kind)
    return _call("cx_of", Kind.COMPLEX, *((x, y) if x.kind is Kind.REAL else (y, x)))


def difference(x: Term, y: Term) -> Term:
    """Return one number less another."""
    if y.kind is Kind.COMPLEX:
        return _call(_DIFFERENCES[x.kind], Kind.COMPLEX, x, y)
    return _infix(x, "-", y, x.kind) if x.kind is y.kind else total(x, negative(y))


def product(x: Term, y: Term) -> Term:
    """Return the product of two numbers."""
    if Kind.COMPLEX in (x.kind, y.kind):
        first, second = (x, y) if y.kind is Kind.COMPLEX else (y, x)
        return _call(_PRODUCTS[first.kind], Kind.COMPLEX, first, second)
    if x.kind is not y.kind:
        return _infix(x, "*", y, Kind.IMAGINARY)
    term = _infix(x, "*", y, Kind.REAL)
    return negative(term) if x.kind is Kind.IMAGINARY else term


def quotient(x: Term, y: Term) -> Term:
    """Return the quotient of two numbers."""
    if y.kind is Kind.COMPLEX:
        return _call("cx_div", Kind.COMPLEX, complex_term(x), y)
    if x.kind is Kind.COMPLEX:
        return _call("cx_over" if y.kind is Kind.REAL else "cx_under", Kind.COMPLEX, x, y)
    term = _infix(x, "/", y, Kind.REAL if x.kind is y.kind else Kind.IMAGINARY)
    return negative(term) if (x.kind, y.kind) == (Kind.REAL, Kind.IMAGINARY) else term


def _power(base: Term, exponent: int) -> Term:
    """Return a power of what does not vary with s."""
    if base.kind is not Kind.REAL:
        result = base
        for _ in range(exponent - 1):
            result = product(result, base)
        return result
    if exponent <= FEW and base.binding == _LEAF and not base.depth:
        return Term(" * ".join([base.text] * exponent), Kind.REAL, base.varies, _PRODUCT)
    return _call("pow", Kind.REAL, base, Term(f"{exponent}.0", Kind.REAL))


PARTS = parts_of("c.c")

KEYWORDS = frozenset(
    """
    auto break case char const continue default do double else enum extern float for goto if inline int long
    register restrict return short signed sizeof static struct switch typedef union unsigned void volatile
    while asm fortran typeof near far huge interrupt
    alignas alignof bool constexpr false nullptr static_assert thread_local true typeof_unqual
    and and_eq bitand bitor catch char16_t char32_t char8_t class co_await co_return co_yield compl concept
    const_cast consteval constinit decltype delete dynamic_cast explicit export final friend import module
    mutable namespace new noexcept not not_eq operator or or_eq override private protected public
    reinterpret_cast requires static_cast template this throw try typeid typename using virtual wchar_t xor
    xor_eq
    """.split()
)  # keywords of C up to C23, of C++, whose programs include the header, and of compilers for small machines

MACROS = frozenset(
    """
    I J complex imaginary CMPLX CMPLXF CMPLXL NULL offsetof errno EDOM ERANGE EILSEQ assert NDEBUG EOF stdin
    stdout stderr BUFSIZ RAND_MAX CLOCKS_PER_SEC INFINITY NAN HUGE HUGE_VAL HUGE_VALF HUGE_VALL MAXFLOAT
    FP_FAST_FMA FP_ILOGB0 FP_ILOGBNAN FP_INFINITE FP_NAN FP_NORMAL FP_SUBNORMAL FP_ZERO MATH_ERRNO
    MATH_ERREXCEPT math_errhandling DOMAIN SING OVERFLOW UNDERFLOW PLOSS TLOSS X_TLOSS
    M_E M_LOG2E M_LOG10E M_LN2 M_LN10 M_PI M_PI_2 M_PI_4 M_1_PI M_2_PI M_2_SQRTPI M_SQRT2 M_SQRT1_2 M_TWOPI
    PI TWO_PI HALF_PI EULER DEG_TO_RAD RAD_TO_DEG HIGH LOW INPUT OUTPUT DEFAULT F
    FLT_EVAL_METHOD FLT_RADIX FLT_ROUNDS DECIMAL_DIG SIZE_MAX PTRDIFF_MAX PTRDIFF_MIN WCHAR_MAX WCHAR_MIN
    SIG_ATOMIC_MAX SIG_ATOMIC_MIN WINT_MAX WINT_MIN UINT8_C UINT16_C UINT32_C UINT64_C INT8_C INT16_C INT32_C
    INT64_C INTMAX_C UINTMAX_C LANES ROUNDER
    unix linux i386 i486 i586 i686 sun vax mips hpux sgi arm pdp11 m68k sparc BSD
    min max small hyper interface pascal cdecl stdcall IN OUT OPTIONAL CONST VOID FAR NEAR TRUE FALSE ERROR
    BOOL DELETE STRICT
    fpclassify isfinite isgreater isgreaterequal isinf isless islessequal islessgreater isnan isnormal
    isunordered signbit signgam
    """.split()
    + [
        f"{kind}_{limit}"
        for kind in ("FLT", "DBL", "LDBL")
        for limit in "DIG EPSILON MANT_DIG MAX MAX_10_EXP MAX_EXP MIN MIN_10_EXP MIN_EXP".split()
    ]
    + [
        f"{sign}INT{kind}_{limit}"
        for sign in ("", "U")
        for kind in ("MAX", "PTR", *(f"{k}{n}" for k in ("", "_FAST", "_LEAST") for n in (8, 16, 32, 64)))
        for limit in ("MAX", "MIN")
    ]
)
"""Of the headers that the code includes, of compilers that define names without underscores, and of headers
that firmware and Windows programs often include first."""

FUNCTIONS = frozenset(  # what the code calls, and the types it uses
    """
    main size_t ptrdiff_t
    sqrt exp log log2 ldexp ceil fmax fmin sin cos tan sinh cosh tanh atan fabs hypot pow copysign
    creal cimag
    memcpy uint64_t rint
    """.split()
).union(*PARTS)
LOCALS = frozenset("s p omega n i j w x g re im real imag sign value padded near is_near count".split())
"""Arguments and variables that every function has under these names."""
RESERVED = KEYWORDS | MACROS  # what a member of the structure of parameters cannot be called
TAKEN = RESERVED | FUNCTIONS | LOCALS  # what a variable cannot be called besides


STEP = "    "
S = Term("s", Kind.COMPLEX, varies=True)
LANE = Term("w[j]", Kind.REAL, varies=True)
AXIS_LANE = Term("w[j]", Kind.IMAGINARY, varies=True)
"""What s is: complex; one of several frequencies w of a response in real arithmetic; one of several j w."""
_NUMBERED = re.compile(r"[a-z]_\d{1,9}")


def statement(opening: str, value: str, depth: int) -> list[str]:
    """Return ``opening value;`` on as many lines as it needs."""
    return statement_lines(f"{opening} {value};", WIDTH, STEP * depth)


@dataclass
class Body:
    """The variables of one C function, the statements that make them, and expressions of them."""

    # Identifiers of the variables that contain parameters, by the names in the model.
    parameters: Mapping[str, str]
    s: Term  # what s is
    depth: int = 1  # how far statements are indented
    lines: list[str] = field(default_factory=list)  # the statements so far
    # Assigned values by their names in the program; of lists, the identifier of the array.
    values: dict[str, Term] = field(default_factory=dict)
    used: set[str] = field(default_factory=set)  # names of the parameters in use
    _taken: set[str] = field(default_factory=set)
    _shared: dict[tuple[str, Kind], Term] = field(default_factory=dict)

    @classmethod
    def of(cls, members: Mapping[str, str], s: Term) -> Body:
        """Return the scope of a function of parameters that are members of a structure."""
        body = cls(identifiers(members, TAKEN), s)
        body._taken |= {*TAKEN, *body.parameters.values()}
        return body

    def within(self, depth: int | None = None) -> Body:
        """Return the scope of a block: it sees these variables, and what it makes stays known to itself."""
        return replace(self, depth=depth or self.depth + 1, lines=[], values=dict(self.values))

    def name(self, wanted: str) -> str:
        """Return an identifier that nothing else in the function has."""
        name = wanted
        if not _NUMBERED.fullmatch(wanted):
            name = identifiers({"": wanted}, self._taken)[""]
        elif wanted in self._taken:
            stem, _, number = wanted.partition("_")
            others = (f"{stem}_{n}" for n in count(int(number)))
            name = next(other for other in others if other not in self._taken)
        self._taken.add(name)
        return name

    @property
    def in_lanes(self) -> bool:
        """True to call functions without branches where there are such."""
        return self.s in (LANE, AXIS_LANE)

    def say(self, opening: str, value: str) -> None:
        """Add a statement."""
        self.lines += statement(opening, value, self.depth)

    def add(self, *lines: str) -> None:
        """Add lines as they are, indented."""
        self.lines += [STEP * self.depth + line for line in lines]

    def enclose(self, opening: str, lines: Sequence[str]) -> None:
        """Add a block: what opens it, statements as they are, and a brace."""
        self.lines += [STEP * self.depth + opening, *lines, f"{STEP * self.depth}}}"]

    def assign(self, assignments: Sequence[tree.Assignment]) -> None:
        """Make variables; what is free of s and made already is not made again."""
        for assignment in assignments:
            if isinstance(assignment.value, tree.Solutions):
                self.values[assignment.name] = self._array(assignment.value, assignment.name)
                continue
            term = self.whole(assignment.value)
            key = (term.text, term.kind)
            if term.varies:
                self.values[assignment.name] = self.hold(assignment.name, term)
                continue
            if key not in self._shared:
                self._shared[key] = self.hold(assignment.name, term)
            self.values[assignment.name] = self._shared[key]

    def hold(self, wanted: str, term: Term) -> Term:
        """Make a variable with a value."""
        name = self.name(wanted)
        self.say(f"const {term.kind.type} {name} =", term.text)
        return Term(name, term.kind, term.varies)

    def opening(self, members: Mapping[str, str]) -> list[str]:
        """Return the lines that take the parameters in use out of their structure."""
        lines = [
            f"{STEP}const double {variable} = p->{members[name]};"
            for name, variable in self.parameters.items()
            if name in self.used
        ]
        return lines or [f"{STEP}(void)p;"]

    def _array(self, node: tree.Solutions, wanted: str) -> Term:
        """Declare an array with the values of a list."""
        terms = [complex_term(self.term(c)) for c in node.coefficients]
        given, order = self.name("coefficients"), len(terms)
        self.say(f"const cx {given}[{order}] =", f"{{{', '.join(t.text for t in terms)}}}")
        array = self.name(wanted)
        self.add(f"cx {array}[{order}];", f"cx_series({given}, {order}, {node.terms}, {array});")
        return Term(array, Kind.COMPLEX, any(t.varies for t in terms))

    # ---------------------------------------------------------------------------------------- expressions

    def term(self, node: tree.CodeNode) -> Term:
        """Return an expression, evaluated in the order of the tree; calls nested deeply become variables."""
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
                self.used.add(name)
                return Term(self.parameters[name], Kind.REAL)
            case tree.Assigned(name):
                return self.values[name]
            case tree.Laplace():
                return self.s
            case tree.InverseLaplace():
                return self.quotient(Term("1.0", Kind.REAL), self.s)
            case tree.Add(terms):
                return self._sum(terms)
            case tree.Multiply(factors):
                result = self.term(factors[0])
                for factor in factors[1:]:
                    result = product(self._short(result), self.term(factor))
                return result
            case tree.Divide(numerator, denominator):
                return self.quotient(self.term(numerator), self.term(denominator))
            case tree.IntegerPower(base, exponent):
                return _power(self.term(base), exponent)
            case tree.Negate(operand):
                return negative(self.term(operand))
            case tree.Apply(function, argument):
                return self._apply(function, self.term(argument))
        return self._special(node)

    def _special(self, node: tree.CodeNode) -> Term:
        match node:
            case tree.Item(tree.Assigned(name), position):
                held = self.values[name]
                return Term(f"{held.text}[{position}]", held.kind, held.varies)
            case tree.Within(point, end):
                return _cut_off(self.term(point), end)
            case tree.RootFactor(point) if node.is_pair or node.is_mirrored:
                return _roots(self.term(point), node)
            case tree.RootFactor():
                return self.whole(node.spelled)
        raise TypeError(type(node).__name__)

    def quotient(self, x: Term, y: Term) -> Term:
        """Return the quotient of two numbers, in lanes without branches."""
        if self.in_lanes and y.kind is Kind.COMPLEX and (x.varies or y.varies):
            return _call("lane_div", Kind.COMPLEX, complex_term(x), y)
        return quotient(x, y)

    def _sum(self, terms: Sequence[tree.CodeNode]) -> Term:
        result = self.term(terms[0])
        for term in terms[1:]:
            if isinstance(term, tree.Negate):
                result = difference(self._short(result), self.term(term.operand))
            else:
                result = total(self._short(result), self.term(term))
        return result

    def _short(self, term: Term) -> Term:
        return self.hold("t_1" if term.varies else "c_1", term) if term.depth > DEEPEST else term

    def _apply(self, function: str, x: Term) -> Term:
        if function == "abs":
            return _call("cx_abs" if x.kind is Kind.COMPLEX else "fabs", Kind.REAL, x)
        if function == "complex_sqrt":
            return _call("cx_sqrt", Kind.COMPLEX, complex_term(x))
        if function == "complex_exp" and x.kind is not Kind.REAL:
            return _call("cx_cis" if x.kind is Kind.IMAGINARY else "cx_exp", Kind.COMPLEX, x)
        assert x.kind is Kind.REAL
        name = REAL_FUNCTIONS[function]
        if self.in_lanes and x.varies and name in LANE_FUNCTIONS:
            return _call(f"lane_{name}", Kind.REAL, x)
        return _call(name, Kind.REAL, x)


def conditions_of(program: tree.Piecewise, scope: Body) -> list[str]:
    """Print what conditions need, and return the conditions."""
    scope.assign(program.tests.needed([c.scale for c in program.conditions]).constants)
    limits = [limit_text(c, scope) for c in program.conditions]
    scope.assign(program.tests.needed([c.quantity for c in program.conditions]).every)
    conditions = []
    for condition, limit in zip(program.conditions, limits, strict=True):
        quantity = scope.term(condition.quantity)
        if not condition.limit:
            scaled = product(scope.term(condition.scale), quantity)
            text = {Kind.COMPLEX: f"{scaled.text}.re", Kind.REAL: scaled.text, Kind.IMAGINARY: "0.0"}[
                scaled.kind
            ]
            conditions.append(f"{text} < 0.0")
            continue
        size = "cx_abs" if quantity.kind is Kind.COMPLEX else "fabs"
        conditions.append(f"{size}({quantity.text}) < {limit}")
    return conditions


def limit_text(condition: tree.Condition, scope: Body) -> str:
    """Return the text of a limit, a variable unless it is a number."""
    if not condition.limit or condition.scale == tree.RealNumber(Fraction(1)):
        return repr(condition.limit)
    scale = scope.term(condition.scale)
    size = f"cx_abs({scale.text})" if scale.kind is Kind.COMPLEX else f"fabs({scale.text})"
    return scope.hold("limit", Term(f"{condition.limit!r} / {size}", Kind.REAL)).text


def choose(
    program: tree.Piecewise, conditions: Sequence[str], scope: Body, piece: Callable[[int], str]
) -> None:
    """Return the value of the piece that serves: test i adds ``2**i`` to its number."""
    default = program.pieces[0]
    if len(set(program.pieces)) > 1:
        names = []
        for i, test in enumerate(conditions):
            name = scope.name(f"test_{i}")
            scope.say(f"const int {name} =", test)
            names.append(f"{2**i} * {name}" if i else name)
        scope.add(f"switch ({' + '.join(names)}) {{")
        for k in sorted({*program.pieces} - {default}):
            scope.add(*(f"case {n}:" for n, number in enumerate(program.pieces) if number == k))
            scope.lines += statement("return", piece(k), scope.depth + 1)
        scope.add("}")
    scope.say("return", piece(default))
