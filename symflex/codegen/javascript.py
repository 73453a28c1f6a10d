"""Transfer functions as an ES module without dependencies: everything that is printed in JavaScript.

JavaScript has no complex numbers, and a pair for every intermediate value would cost ten times the
arithmetic. So every complex value is two constants, and what is known to be real or imaginary is one::

    m*s^2 + k    becomes    const t_1_re = k + m * (s_re * s_re - s_im * s_im),
                                  t_1_im = m * (2 * s_re * s_im);

A function takes parameters and returns a function of s, so that what does not vary with s is computed once.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import reduce
from itertools import count

from symflex.codegen.export import (
    MATRIX,
    Contents,
    Export,
    Language,
    MatrixMember,
    Member,
    Outline,
    called_parts,
    parts_of,
)
from symflex.codegen.module_text import identifiers, statement_lines
from symflex.codegen.program import nodes as tree
from symflex.codegen.program.derivative import differentiated
from symflex.codegen.program.evaluate import nearest_double

WIDTH = 100  # columns of generated JavaScript

KEYWORDS = frozenset(
    """
    abstract arguments as async await boolean break byte case catch char class const continue debugger
    default delete do double else enum eval export extends false final finally float for from function get
    goto if implements import in instanceof int interface let long native new null of package private
    protected public return set short static super switch synchronized this throw throws transient true try
    typeof undefined var void volatile while with yield
    """.split()
)

NAMES = frozenset(  # what generated code uses, and names that a reader would miss
    """
    Infinity NaN Math Object Array Float64Array Number String Symbol Proxy Reflect JSON Map Set Promise Error
    RangeError TypeError globalThis window self document name length prototype constructor isFinite isNaN
    parseInt parseFloat PARAMETERS TRANSFER_FUNCTIONS p into value s s_re s_im number
    """.split()
)
PARTS = parts_of("javascript.js")
RESERVED = KEYWORDS | NAMES | {name for names in PARTS for name in names}
LONGEST = 60  # characters of an expression that is used more than once, from which it gets a name
_SUM, _PRODUCT, _SIGN, _LEAF = range(4)
_ATOM = re.compile(r"\w+|-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


# ---------------------------------------------------------------------------------- real expressions


@dataclass(frozen=True, slots=True)
class Real:
    """An expression whose value is a real number."""

    text: str
    binding: int = _LEAF  # how tightly its outermost operator binds

    def within(self, tightest: int) -> str:
        """Return the text, in parentheses where an operator around it binds tighter."""
        return self.text if self.binding >= tightest else f"({self.text})"


Part = Real | None  # one part of a complex number; None is exactly zero


def _literal(value: float) -> Part:
    return Real(repr(value), _SIGN if value < 0 else _LEAF) if value else None


def _negative(x: Part) -> Part:
    if x is not None and x.binding == _SIGN:
        return Real(x.text[1:])
    return None if x is None else Real(f"-{x.within(_LEAF)}", _SIGN)


def _added(x: Part, sign: str, y: Part) -> Part:
    if x is None or y is None:
        return x if y is None else y if sign == "+" else _negative(y)
    if y.binding == _SIGN:
        return _added(x, "-" if sign == "+" else "+", _negative(y))
    return Real(f"{x.within(_SUM)} {sign} {y.within(_PRODUCT)}", _SUM)


def _product(x: Part, y: Part) -> Part:
    if x is None or y is None:
        return None
    for one, other in ((x, y), (y, x)):
        if one.text in ("1.0", "-1.0"):
            return other if one.text == "1.0" else _negative(other)
    return Real(f"{x.within(_PRODUCT)} * {y.within(_SIGN)}", _PRODUCT)


def _quotient(x: Part, y: Real) -> Part:
    return None if x is None else Real(f"{x.within(_PRODUCT)} / {y.within(_SIGN)}", _PRODUCT)


@dataclass(frozen=True, slots=True)
class ComplexParts:
    """A complex number."""

    re: Part
    im: Part = None


_S = ComplexParts(Real("s_re"), Real("s_im"))


def _text(x: Part) -> str:
    return "0.0" if x is None else x.text


def _size(z: ComplexParts) -> Real:
    return Real(f"size({_text(z.re)}, {_text(z.im)})" if z.im else f"Math.abs({_text(z.re)})")


# ------------------------------------------------------------------------------------------ functions


@dataclass
class PairBody:
    """The statements of one function of s while they are printed."""

    parameters: Mapping[str, str]  # identifiers of parameters by their names in the model
    taken: set[str]  # identifiers that a constant cannot have
    depth: int = 1  # how far statements are indented
    lines: list[str] = field(default_factory=list)
    values: dict[str, ComplexParts | str] = field(default_factory=dict)  # assigned ones; of lists, the array
    shared: dict[str, str] = field(default_factory=dict)  # constants by what they were made of

    def within(self, depth: int) -> PairBody:
        """Return the body of a block that sees these constants."""
        return replace(self, depth=depth, lines=[], values=dict(self.values), shared=dict(self.shared))

    def name(self, wanted: str) -> str:
        """Return an identifier that nothing else in the function has; so are those of its parts."""
        stem, _, number = wanted.rpartition("_")
        if number.isdigit() and stem:
            names = (f"{stem}_{n}" for n in count(int(number)))
            name = next(x for x in names if self.taken.isdisjoint((x, f"{x}_re", f"{x}_im")))
        else:
            name = identifiers({"": wanted}, self.taken)[""]
        self.taken |= {name, f"{name}_re", f"{name}_im"}
        return name

    def call(self, wanted: str, text: str) -> ComplexParts:
        """Return the complex value of a call that leaves its imaginary part."""
        if text not in self.shared:
            name = self.shared[text] = self.name(wanted)
            self.say(f"const {name}_re = {text}, {name}_im = imaginary;")
        return ComplexParts(Real(f"{self.shared[text]}_re"), Real(f"{self.shared[text]}_im"))

    def say(self, text: str) -> None:
        """Add a statement."""
        self.lines += statement_lines(text, WIDTH, "    " * self.depth)

    def hold(self, wanted: str, x: Real, least: int = 0, name: str = "") -> Real:
        """Return a constant with a value, or the value itself if that is an atom, or short."""
        if len(x.text) <= least or _ATOM.fullmatch(x.text):
            return x
        if x.text not in self.shared:
            self.shared[x.text] = name or self.name(wanted)
            self.say(f"const {self.shared[x.text]} = {x.text};")
        return Real(self.shared[x.text])

    def pair(self, wanted: str, z: ComplexParts, least: int = 0) -> ComplexParts:
        """Return a complex number whose parts are constants."""
        if z.re is None or z.im is None:
            return ComplexParts(
                z.re and self.hold(wanted, z.re, least), z.im and self.hold(wanted, z.im, least)
            )
        if all(_ATOM.fullmatch(x.text) or x.text in self.shared for x in (z.re, z.im)):
            return ComplexParts(self.hold(wanted, z.re), self.hold(wanted, z.im))
        name = self.name(wanted)
        return ComplexParts(
            *(self.hold("", x, least, name + end) for x, end in ((z.re, "_re"), (z.im, "_im")))
        )

    def assign(self, assignments: Sequence[tree.Assignment]) -> None:
        """Make constants."""
        for a in assignments:
            wanted = a.name.replace("slope of ", "d_")
            if not isinstance(a.value, tree.Solutions | tree.SolutionSlopes):
                self.values[a.name] = self.pair(wanted, self.value(a.value))
                continue
            given = [self._array(a.value.coefficients), str(a.value.terms)]
            given += [self._array(a.value.slopes)] if isinstance(a.value, tree.SolutionSlopes) else []
            name = self.values[a.name] = self.name(wanted)
            self.say(f"const {name} = solutions({', '.join(given)});")

    def _array(self, nodes: Sequence[tree.CodeNode]) -> str:
        parts = [_text(x) for z in map(self.value, nodes) for x in (z.re, z.im)]
        return f"[{', '.join(parts)}]"

    # -------------------------------------------------------------------------------------- expressions

    def value(self, node: tree.CodeNode) -> ComplexParts:
        """Return an expression, evaluated in the order of the tree."""
        match node:
            case tree.RealNumber(value, pi_power):
                return ComplexParts(_literal(nearest_double(value, pi_power)))
            case tree.ComplexNumber(real, imaginary):
                return ComplexParts(_literal(nearest_double(real)), _literal(nearest_double(imaginary)))
            case tree.ToComplex(operand):
                return self.value(operand)
            case tree.LargerRoot() | tree.RootFactor():
                return self.value(node.spelled)
            case tree.ParameterValue(name):
                return ComplexParts(Real(self.parameters[name]))
            case tree.Assigned(name):
                assigned = self.values[name]
                assert isinstance(assigned, ComplexParts)
                return assigned
            case tree.Item(tree.Assigned(name), position):
                array = self.values[name]
                return ComplexParts(Real(f"{array}[{2 * position}]"), Real(f"{array}[{2 * position + 1}]"))
            case tree.Laplace():
                return _S
            case tree.InverseLaplace():
                return self.divide(ComplexParts(Real("1.0")), _S)
        return self._operation(node)

    def _operation(self, node: tree.CodeNode) -> ComplexParts:
        match node:
            case tree.Add((first, *others)):
                return self._sum(first, others)
            case tree.Multiply(factors):
                return reduce(self.multiply, map(self.value, factors))
            case tree.Divide(above, below):
                return self.divide(self.value(above), self.value(below))
            case tree.IntegerPower(base, exponent):
                return self._power(self.pair("c_1", self.value(base)), exponent)
            case tree.Negate(operand):
                z = self.value(operand)
                return ComplexParts(_negative(z.re), _negative(z.im))
            case tree.Within(point, end):
                z = self.pair("t_1", self.value(point))
                inside = f"size({_text(z.re)}, {_text(z.im)}) <= {end!r}"
                return ComplexParts(self.hold("t_1", Real(f"{inside} ? {_text(z.re)} : NaN")), z.im)
            case tree.Apply(function, argument):
                return self._apply(function, self.value(argument))
        raise TypeError(type(node).__name__)

    def _sum(self, first: tree.CodeNode, others: Sequence[tree.CodeNode]) -> ComplexParts:
        result = self.value(first)
        for term in others:
            sign, node = ("-", term.operand) if isinstance(term, tree.Negate) else ("+", term)
            z = self.value(node)
            result = ComplexParts(_added(result.re, sign, z.re), _added(result.im, sign, z.im))
        return result

    def multiply(self, x: ComplexParts, y: ComplexParts) -> ComplexParts:
        """Return a product; parts that occur twice in it are constants."""
        if x.re and x.im and y.re and y.im:
            x, y = self.pair("t_1", x), (self.pair("t_1", y) if y != x else self.pair("t_1", x))
        elif (x.re and x.im) or (y.re and y.im):
            single, other = (x, y) if not (x.re and x.im) else (y, x)
            x, y = self.pair("t_1", single, LONGEST // 4), other
        re = _added(_product(x.re, y.re), "-", _product(x.im, y.im))
        return ComplexParts(re, _added(_product(x.re, y.im), "+", _product(x.im, y.re)))

    def divide(self, x: ComplexParts, y: ComplexParts) -> ComplexParts:
        """Return a quotient."""
        if y.re and y.im:
            return self.call("q_1", f"quotient({', '.join(map(_text, (x.re, x.im, y.re, y.im)))})")
        by = self.hold("t_1", y.re or y.im or Real("0.0"), LONGEST // 4)
        if y.re:
            return ComplexParts(_quotient(x.re, by), _quotient(x.im, by))
        return ComplexParts(_quotient(x.im, by), _negative(_quotient(x.re, by)))

    def _power(self, base: ComplexParts, exponent: int) -> ComplexParts:
        if base.im is None:
            return ComplexParts(base.re and Real(f"Math.pow({base.re.text}, {exponent})"))
        result = base
        for _ in range(exponent - 1):
            result = self.multiply(result, base)
        return result

    def _apply(self, function: str, z: ComplexParts) -> ComplexParts:
        name = function.removeprefix("complex_")
        if function == "abs":
            return ComplexParts(_size(z))
        if function == "complex_sqrt":
            return self.call("r_1", f"root({_text(z.re)}, {_text(z.im)})")
        if z.im is None:
            return ComplexParts(Real(f"Math.{name}({_text(z.re)})"))
        assert name == "exp"
        angle = self.hold("t_1", z.im)
        turned = ComplexParts(Real(f"Math.cos({angle.text})"), Real(f"Math.sin({angle.text})"))
        if z.re is None:
            return self.pair("e_1", turned)
        growth = self.hold("e_1", Real(f"Math.exp({z.re.text})"))
        return self.pair("e_1", ComplexParts(_product(growth, turned.re), _product(growth, turned.im)))

    # ---------------------------------------------------------------------------------------- statements

    def leave(self, z: ComplexParts) -> None:
        """Return a complex number: its real part, after its imaginary part was left."""
        z = self.pair("t_1", z)
        self.say(f"imaginary = {_text(z.im)};")
        self.say(f"return {_text(z.re)};")

    def write(self, values: Sequence[ComplexParts]) -> None:
        """Write complex numbers into an array."""
        for i, x in enumerate(x for z in values for x in (z.re, z.im)):
            self.say(f"into[{i}] = {_text(x)};")


ENTRIES = "values"  # what private functions of a whole matrix are called


@dataclass(frozen=True)
class PairFunctions:
    """Prints the private functions of one transfer function: its value, and the parts of its quotient."""

    program: tree.Piecewise
    name: str  # identifier of the public function
    parameters: Mapping[str, str]

    @property
    def used(self) -> list[str]:
        """Identifiers of the parameters, in declared order."""
        return [self.parameters[p] for p in self.program.parameters]

    def blocks(self, *kinds: str) -> list[str]:
        """Return the functions, by default of value and parts, each as text that ends with a line end."""
        blocks: list[str] = []
        for kind in kinds or ("value", "parts"):
            for number, piece in enumerate(self.program.code):
                blocks += self._piece(kind, number, piece)
            blocks.append(self._choice(kind))
        return blocks

    def _body(self) -> PairBody:
        return PairBody(self.parameters, {*RESERVED, *self.parameters.values()}, 1)

    def _function(
        self, name: str, outer: PairBody, inner: PairBody, arguments: str, *, takes: str = ""
    ) -> str:
        """Return a function of parameters, by default each by its name, that returns one of s."""
        listed = takes or (f"{{ {', '.join(self.used)} }}" if self.used else "_")
        opening = [f"function {name}({listed}) {{"]
        if len(opening[0]) > WIDTH:
            opening = [f"function {name}(", *statement_lines(listed, WIDTH, "    "), ") {"]
        return "\n".join(
            [*opening, *outer.lines, f"    return ({arguments}) => {{", *inner.lines, "    };", "}", ""]
        )

    def _piece(self, kind: str, number: int, piece: tree.CodePiece) -> list[str]:
        """Return what computes a piece: the value, or numerator and denominator with their derivatives."""
        name = f"{kind}_{number}_of_{self.name}"
        code = piece.code if kind == ENTRIES else _quotient_of(piece.code)
        outer = self._body()
        if kind == "parts":
            code = differentiated(code)
        elif not piece.circle:
            code = piece.code  # of a matrix, with the values of all entries
        outer.assign(code.constants)
        inner = outer.within(2)
        inner.assign(code.assignments)
        if kind == "value" and not piece.circle:
            values = [inner.value(v) for v in code.values]
            inner.leave(inner.divide(*values) if len(values) > 1 else values[0])
            return [self._function(name, outer, inner, "s_re, s_im")]
        inner.write([inner.value(v) for v in code.values])
        if not piece.circle:
            return [self._function(name, outer, inner, "s_re, s_im, into")]
        around = f"around_{name}"
        mean_body = outer.within(2)
        step = 2 if kind == "parts" else 1
        mean_body.lines = []
        mean = f"circle(parts, s_re, s_im, {piece.circle}, {step})"
        mean_body.say(f"return over({mean});" if kind == "value" else f"into.set({mean});")
        ahead = self._body()
        ahead.say(f"const parts = {around}(p);")
        given = "s_re, s_im" + ", into" * (kind == "parts")
        text = self._function(name, ahead, mean_body, given, takes="p")
        return [self._function(around, outer, inner, "s_re, s_im, into"), text]

    def _choice(self, kind: str) -> str:
        """Return the function that finds the piece that serves."""
        program, into = self.program, ", into" * (kind != "value")
        outer = self._body()
        served = {k: [n for n, piece in enumerate(program.pieces) if piece == k] for k in set(program.pieces)}
        for k in sorted(served):
            outer.say(f"const piece_{k} = {kind}_{k}_of_{self.name}(p);")
        if self.used and program.conditions:
            outer.say(f"const {{ {', '.join(self.used)} }} = p;")
        outer.assign(program.tests.constants)
        scales = [outer.pair("c_1", outer.value(c.scale)) for c in program.conditions]
        inner = outer.within(2)
        inner.assign(program.tests.assignments)
        terms, below = [], "<=" if program.is_lumped else "<"
        for i, (condition, scale) in enumerate(zip(program.conditions, scales, strict=True)):
            quantity = inner.value(condition.quantity)
            test = f"{_size(quantity).text} * {_size(scale).text} {below} {condition.limit!r}"
            if not condition.limit:
                test = f"{_text(inner.multiply(scale, quantity).re)} < 0.0"
            terms.append(f"{2**i} * ({test})")
        *others, last = sorted(served)
        if others:
            inner.say(f"const number = {' + '.join(terms)};")
        for k in others:
            test = " || ".join(f"number === {n}" for n in served[k])
            inner.say(f"if ({test}) return piece_{k}(s_re, s_im{into});")
        inner.say(f"return piece_{last}(s_re, s_im{into});")
        return self._function(f"{kind}_of_{self.name}", outer, inner, f"s_re, s_im{into}", takes="p")


def _quotient_of(code: tree.Straight) -> tree.Straight:
    """Return code whose first two values are a numerator and a denominator."""
    if len(code.values) > 1:
        return code
    (value,), sign = code.values, False
    while isinstance(value, tree.Negate):
        value, sign = value.operand, not sign
    above, below = (
        (value.numerator, value.denominator) if isinstance(value, tree.Divide) else (value, tree.ONE)
    )
    return tree.Straight(code.constants, code.assignments, (tree.Negate(above) if sign else above, below))


# -------------------------------------------------------------------------------------------- the module


def javascript_module(contents: Contents) -> Export:
    """Return an ES module with one function ``OUT_over_IN(s, values)`` per transfer function."""
    model, members = contents.model, [m for m in contents.members if not m.is_response]
    public, parameters = contents.names(RESERVED)
    rows = JAVASCRIPT_OUTLINE.parameter_rows(model, parameters)
    docs = "/** Values in SI units, units and descriptions of the model's parameters. */"
    blocks = ["\n".join([docs, "export const PARAMETERS = Object.freeze({", *rows, "});", ""])]
    code = ""
    for m in members:
        functions = PairFunctions(m.program, public[m.key], parameters)
        private = functions.blocks()
        blocks += [*private, _public(m, functions)]
        code += "\n".join(private)
    if contents.matrix is not None:
        (whole,) = identifiers({"": MATRIX}, {*RESERVED, *public.values()}).values()
        blocks.append(_matrix(contents.matrix, whole, public, parameters))
        code += blocks[-1]
    blocks += called_parts(code, PARTS, ["imaginary", "offered"])
    rows = JAVASCRIPT_OUTLINE.function_rows({m.tf.name: public[m.key] for m in members})
    table = ["export const TRANSFER_FUNCTIONS = Object.freeze({", *rows, "});", ""]
    verified = (m.verification for m in members)
    title = "Transfer functions of a linear system."
    heading = JAVASCRIPT_OUTLINE.heading(title, model, [INTRODUCTION], verified)
    return Export("\n".join([*comment(heading), "", "\n".join(blocks), *table]))


INTRODUCTION = (
    "Written by symflex. A complex number is [re, im]. Each function evaluates OUT/IN at the Laplace "
    "variable s [rad/s]: a real number, [re, im], or two Float64Arrays [re, im], which give two such "
    "arrays. Its second argument is an object of parameters in SI units; those left out have the model's "
    "values. .numerator, .denominator, .numeratorDerivative and .denominatorDerivative take the same "
    "arguments: the parts of the quotient, up to a common factor without zeros, and their derivatives "
    "in s."
)


def string(text: str) -> str:
    r"""Return a string literal that ends neither a script nor a comment of a page.

    >>> string("</script>\u2028")
    '"\\u003c/script>\\u2028"'
    """
    return json.dumps(text).replace("<", "\\u003c")


def comment(lines: Sequence[str]) -> list[str]:
    """Return lines as a block comment that what stands in them cannot end."""
    inner = (re.sub(r"<(?=[/!A-Za-z])", "< ", line.replace("*/", "* /")) for line in lines)
    return ["/**", *(f" * {line}".rstrip() for line in inner), " */"]


JAVASCRIPT_OUTLINE = Outline(
    WIDTH - 3,
    string,
    "null",
    argument="    ",
    parameter="    {}: Object.freeze({{ value: {}, unit: {}, doc: {} }}),",
)


def _public(member: Member, functions: PairFunctions) -> str:
    lines = [
        *JAVASCRIPT_OUTLINE.about(member),
        "@param {number|number[]|Float64Array[]} s Laplace variable [rad/s]",
        "@param {Object} [values] parameters by name:",
        *JAVASCRIPT_OUTLINE.arguments(member.parameters, functions.parameters),
        "@returns {number[]|Float64Array[]} [re, im]; not finite at poles",
        "",
        *JAVASCRIPT_OUTLINE.verified(member, "."),
    ]
    used = f"[{', '.join(map(string, functions.used))}]"
    name = functions.name
    call = [f"export const {name} = offered("]
    call += [*statement_lines(f"value_of_{name}, parts_of_{name}, {used}", WIDTH, "    "), ");"]
    return "\n".join([*comment(lines), *call, ""])


def _matrix(matrix: MatrixMember, name: str, public: Mapping[str, str], parameters: Mapping[str, str]) -> str:
    """Return the function of all entries, which calls those of single entries, or its own."""
    said = [matrix.headline, "", *JAVASCRIPT_OUTLINE.verified(matrix, ".")]
    said.append("@returns {Array} rows of values, each as of its function")
    head = f"export const {name} = (s, values = {{}}) =>"
    if matrix.program is not None:
        rows, columns = matrix.shape
        functions = PairFunctions(matrix.program, name, parameters)
        used = f"[{', '.join(map(string, functions.used))}]"
        call = f"entries(s, values, {ENTRIES}_of_{name}, {used}, {rows}, {columns});"
        own = functions.blocks(ENTRIES)
        return "\n".join([*own, *comment(said), head, *statement_lines(call, WIDTH, "    "), ""])
    calls = ([f"{public[m.key]}(s, values)" for m in row] for row in matrix.rows)
    lines = [line for row in calls for line in statement_lines(f"[{', '.join(row)}],", WIDTH, "    ")]
    return "\n".join([*comment(said), f"{head} [", *lines, "];", ""])


JAVASCRIPT = Language(
    ".js",
    "ES module without dependencies, with numerators and denominators, verified likewise",
    javascript_module,
    shares=True,
)
