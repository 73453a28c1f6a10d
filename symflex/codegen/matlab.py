"""Transfer functions as one function file for MATLAB and Octave: everything printed in MATLAB."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Final

from symflex.algebra import LAPLACE, Factored
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
from symflex.codegen.infix import InfixPrinter, PrivateFunctions, in_lines
from symflex.codegen.module_text import (
    FORMULA_TERMS,
    WIDTH,
    default_value,
    identifiers,
    inert,
    origin_lines,
    wrapped,
)
from symflex.codegen.program.nodes import CodeNode, CodePiece, Piecewise
from symflex.expressions import Expression, Name, format_expression, number, substitute, sum_of
from symflex.print.forms.arrange import Arranger
from symflex.print.forms.notation import constant_symbols, plain_printer
from symflex.transfer import AnyTransferFunction, TransferFunction

LONGEST = 63  # characters that MATLAB tells identifiers apart by

KEYWORDS = frozenset(  # keywords of both languages
    "__FILE__ __LINE__ arguments break case catch classdef continue do else elseif end end_try_catch "
    "end_unwind_protect endarguments endclassdef endenumeration endevents endfor endfunction endif "
    "endmethods endparfor "
    "endproperties endspmd endswitch endwhile enumeration events for function global if methods "
    "otherwise parfor persistent properties return spmd switch try until unwind_protect "
    "unwind_protect_cleanup while".split()
)

FUNCTIONS = frozenset(  # what generated code uses, and constants that a reader would miss
    "i j pi e eps Inf inf NaN nan NA ans true false end nargin nargout varargin varargout exp log sqrt sin "
    "cos tan sinh cosh tanh atan abs real imag conj complex any all size zeros ones reshape numel unique "
    "isempty isnumeric islogical isreal isscalar isstruct isfield isa ischar char double error cell cellfun "
    "fieldnames struct2cell mod max min find repmat eye eig diag ceil log2 isfinite sum struct "
    "acos cumsum diff fliplr floor interp1 inv isequal ismember kron nchoosek num2cell prod sort".split()
)
WORDS = frozenset({"s", "G", "given", "value"})  # variables of generated code; parameters leave them to it
TOOLBOX = frozenset({"tf", "zpk", "ss", "frd", "roots"})  # what no function of the file may hide
PARTS = parts_of("matlab.m")
NAMES = frozenset({"default_parameters"}.union(*PARTS))  # names of the functions that others call
RESERVED = KEYWORDS | FUNCTIONS | NAMES | WORDS
TITLE_LENGTH, LONGEST_STEM = 30, 64  # characters of a title in a function's name, and of a file's in messages

EXPANSION = (
    "s and parameters are expanded against each other, as operators expand them. "
    "Values are not finite at poles."
)

_LINK = re.compile(r"<(?=[A-Za-z/])")
ROOM = WIDTH - 4  # columns of help texts

OTHER_FIELDS = frozenset(  # other fields of the struct that the main function returns
    "parameters units descriptions transfer_matrix transfer_functions frequency_responses systems "
    "coefficients".split()
)
SYSTEM_ROLES = ("system", "coefficients")  # the two functions of a rational transfer function


# ------------------------------------------------------------------------------------------- expressions


@dataclass(frozen=True)
class MatlabPrinter(InfixPrinter):
    """Prints expressions whose values are numbers or columns."""

    times: ClassVar = ".*"
    over: ClassVar = "./"
    power: ClassVar = "{}.^{}"
    cut_off: ClassVar = "({z} + 0.0 ./ (abs({z}) <= {end!r}))"
    listed: ClassVar = "{{{}}}"
    item: ClassVar = "{}{{{}}}"
    called: ClassVar = "{}({})"
    first: ClassVar = 1
    together: ClassVar = "{{{}}}"

    def to_complex(self, operand: CodeNode) -> tuple[str, int]:
        """Return the number itself: a square root needs no complex operand to be complex."""
        return self._print(operand)

    def complex_number(self, real: float, imaginary: float) -> str:
        """Return a number as text that needs no parentheses."""
        if not imaginary:
            return repr(real) if real >= 0 else f"({real!r})"
        return (
            f"({real!r} {'-' if imaginary < 0 else '+'} {abs(imaginary)!r}i)" if real else f"({imaginary!r}i)"
        )


def continued(text: str, indent: str) -> list[str]:
    """Return one statement, without strings that contain blanks, continued over lines where it is long."""
    if len(indent) + len(text) <= WIDTH:
        return [indent + text]
    more = indent + "    "
    lines = in_lines(text, WIDTH - len(more) - 4)
    broken = [f"{line} ..." for line in lines[:-1]]
    return [f"{more if i else indent}{line}" for i, line in enumerate([*broken, lines[-1]])]


@dataclass(frozen=True)
class LocalFunctions(PrivateFunctions):
    """Prints the local functions that compute with columns."""

    printer: ClassVar = MatlabPrinter
    longest: ClassVar = LONGEST

    names: Mapping[str, str]  # identifiers of these functions, by their roles

    def statement(self, target: str, value: str, depth: int = 1) -> list[str]:
        """Return ``target = value``."""
        return continued(f"{target} = {value};", "  " * depth)

    def call(self) -> list[str]:
        """Return the statement that computes the value of ``s`` and ``given``."""
        if self.program.is_lumped:
            return self.statement("value", f"everywhere(@{self.names['value']}, s, given)")
        pieces = ", ".join(f"@{self.names[str(i)]}" for i in self.program.pieces)
        return self.statement("value", f"in_pieces(@{self.names['number']}, {{{pieces}}}, s, given)")

    # ------------------------------------------------------------------------------------------- functions

    def _function(self, outputs: str, role: str, variable: str, body: Sequence[str]) -> str:
        given = ", ".join(self.arguments(variable))
        head = continued(f"function {outputs} = {self.names[role]}({given})", "")
        return "\n".join([*head, *body, "end", ""])

    def _lumped(self, program: Piecewise) -> str:
        near, far, late = program.near, program.far, program.late
        words = ("s", "value", "limit", "is_far", "far_value", "inverse")[: 2 if far is None else 6]
        printer, (s, value, *others) = self.scope((*near.every, *late), *words)
        lines = [*self.assigned(near.every, printer), *self.statement(value, printer.all_of(near.values))]
        if far is not None:
            limit, is_far, far_value, inverse = others
            chosen = self.statement(f"{value}({is_far})", f"{far_value}({is_far})", 2)
            if len(far.values) > 1:
                chosen = self.statement(value, f"replaced({value}, {far_value}, {is_far})", 2)
            lines += [
                *self.statement(limit, repr(program.limit)),
                *self.statement(is_far, f"abs({s}) > {limit}"),
                f"  if any({is_far})",
                *self.statement(inverse, f"1.0 ./ {s}", 2),
                *self.assigned(late, printer, 2),
                *self.statement(far_value, printer.all_of(far.values), 2),
                *chosen,
                "  end",
            ]
        return self._function(value, "value", s, lines)

    def _choice(self, program: Piecewise) -> str:
        """Return the function that tells which piece serves."""
        printer, (s, number) = self.scope(program.tests.every, "s", "number")
        lines = [
            *self.assigned(program.tests.every, printer),
            *self.statement(number, printer.piece_number(program) or "0"),
        ]
        return self._function(number, "number", s, lines)

    def _piece(self, number: int, piece: CodePiece) -> list[str]:
        assignments = piece.code.every
        if piece.circle:
            printer, (s, *results) = self.scope(assignments, "s", "num", "den", "growth", "radius")
            lines = self.assigned(assignments, printer)
            for name, node in zip(results, piece.code.values, strict=True):
                lines += self.statement(name, printer.print(node))
            parts = self._function(f"[{', '.join(results)}]", f"{number}_parts", s, lines)
            _, (s, value, z) = self.scope((), "s", "value", "z")
            given = ", ".join(self.arguments(z))
            parts_of_z = f"@({z}) {self.names[f'{number}_parts']}({given})"
            mean = self.statement(value, f"mean_over_circle({parts_of_z}, {s}, {piece.circle})")
            return [parts, self._function(value, str(number), s, mean)]
        printer, (s, value) = self.scope(assignments, "s", "value")
        lines = self.assigned(assignments, printer)
        lines += self.statement(value, printer.quotient(*piece.code.values))
        return [self._function(value, str(number), s, lines)]


# -------------------------------------------------------------------------------------------------- text


def main_name(text: str) -> str:
    """Return a text as the name of a function file: the text itself where it can be one."""
    short = text if re.fullmatch(r"[A-Za-z]\w*", text, re.ASCII) else text[:TITLE_LENGTH].strip()
    return identifiers({"main": short or "model"}, RESERVED, LONGEST)["main"]


def _helped(first: str, lines: Sequence[str] = ()) -> list[str]:
    """Return a help text: a first line, and others, which contain no line end, with a blank before them."""
    return [*wrapped(f"%{first}", WIDTH, "", "%   "), *(f"%   {line}".rstrip() for line in lines)]


def _disarmed(text: str) -> str:
    """Return text in which links are not links, and no mark asks for Texinfo."""
    return _LINK.sub("< ", text).replace("-*-", "- * -")


def _text(text: str) -> str:
    """Return text on one line without what MATLAB or Octave would obey in a help text or on the screen."""
    return inert(_disarmed(text))


def _string(text: str) -> str:
    """Return a string literal: inert text, quotes doubled."""
    return "'" + _text(text).replace("'", "''") + "'"


def _given(names: Iterable[str]) -> list[str]:
    """Return the statement that reads the values of some parameters."""
    quoted = ", ".join(f"'{name}'" for name in names)
    return continued(f"given = numbers(varargin, {{{quoted}}});", "  ")


def _function(*lines: str) -> str:
    return "\n".join([*lines, "end", ""])


OUTLINE = Outline(ROOM, unset="no value", disarmed=_disarmed, formula="", argument="  ", more="      ")


# -------------------------------------------------------------------------------------------------- file


class _File:
    """The file, and the names of everything in it; its main function returns handles in a struct."""

    def __init__(self, contents: Contents) -> None:
        self.model, self.members = contents.model, contents.members
        self.stem, self.matrix = contents.stem, contents.matrix
        self.main = main_name(self.stem or self.model.title)
        wanted = {m.key: m.wanted for m in self.members}
        self.fields = identifiers(wanted, RESERVED | OTHER_FIELDS, LONGEST)
        self.public = identifiers(self.fields, RESERVED | {self.main} | TOOLBOX, LONGEST)
        self.taken = {*RESERVED, self.main, *self.public.values()}
        pairs = ((m, RationalSystem.of(m.tf)) for m in self.members if not m.is_response)
        self.systems = {m.key: system for m, system in pairs if system is not None}
        # Private functions, by member and role.
        roles = {
            (m.key, role): f"{self.public[m.key]}_{role}" for m in self.members for role in self._roles(m)
        }
        joined = identifiers({"\n".join(pair): text for pair, text in roles.items()}, self.taken, LONGEST)
        self.private = dict(zip(roles, joined.values(), strict=True))
        self.taken |= set(self.private.values())
        names = {p.name: p.name for p in self.model.parameters}
        self.parameters = identifiers(names, self.taken, LONGEST)

    @property
    def whole(self) -> str:
        """The name of the function of a whole matrix."""
        return identifiers({"": MATRIX}, self.taken, LONGEST)[""]

    def _matrix(self, matrix: MatrixMember) -> str:
        """Return the function of all entries, which calls those of single entries, or its own."""
        rows, columns = matrix.shape
        said = [
            _disarmed(matrix.headline),
            f"Of size [{rows} {columns} numel(s)] for a vector s, else [{rows} {columns} size(s)].",
            *OUTLINE.verified(matrix, "."),
        ]
        head = f"function value = {self.whole}(s, varargin)"
        first = f"{self.whole.upper()}  {said[0]}"
        if matrix.program is not None:
            own = identifiers({"": f"{self.whole}_value"}, {*self.taken, self.whole}, LONGEST)[""]
            taken = {*self.taken, self.whole, own} - WORDS
            local = LocalFunctions(matrix.program, self.whole, self.parameters, taken, {"value": own})
            given = _given(self.parameters[p] for p in matrix.program.parameters)
            called = local.statement("value", f"entries(@{own}, s, given, [{rows}, {columns}])")
            whole = _function(head, *_helped(first, said[1:]), *given, *called)
            return "\n".join([whole, local.entries()])
        lines = [f"  parts = cell({rows}, {columns});"]
        for i, row in enumerate(matrix.rows, 1):
            for j, m in enumerate(row, 1):
                lines += continued(f"parts{{{i}, {j}}} = {self.public[m.key]}(s, varargin{{:}});", "  ")
        return _function(head, *_helped(first, said[1:]), *lines, "  value = stacked(parts);")

    def _roles(self, member: Member) -> list[str]:
        """Return what the private functions of a member are for; their names end so."""
        program = member.program
        if member.is_response:
            return []
        roles = ["value"] if program.is_lumped else ["number"]
        for i, piece in enumerate(() if program.is_lumped else program.code):
            roles += [f"{i}_parts", str(i)] if piece.circle else [str(i)]
        return [*roles, *(SYSTEM_ROLES if member.key in self.systems else ())]

    def made(self) -> Export:
        blocks, code = [self._main(), self._defaults()], ""
        for m in self.members:
            if m.is_response:
                blocks.append(self._response(m))
                code += blocks[-1]
                continue
            private_names = {role: self.private[m.key, role] for role in self._roles(m)}
            functions = LocalFunctions(
                m.program, self.public[m.key], self.parameters, self.taken - WORDS, private_names
            )
            local = functions.blocks()
            given = _given(self.parameters[p] for p in m.program.parameters)
            blocks += [_function(*self._head(m, "s"), *given, *functions.call()), *local]
            code += "\n".join([*functions.call(), *local])
            if m.key in self.systems:
                blocks += self._system_functions(self.systems[m.key], private_names)
        always = ["numbers", "columns", *(["system_of"] if self.systems else [])]
        if self.matrix is not None:
            blocks.append(self._matrix(self.matrix))
            code += blocks[-1]
            always.append("stacked")
        blocks += called_parts(code, PARTS, always)
        shown = inert(self.stem[:LONGEST_STEM])
        warning = f"MATLAB cannot call a file '{shown}.m': name it '{self.main}.m', as its function"
        is_other = self.stem and self.main != self.stem
        return Export("\n".join(blocks), (warning,) if is_other else (), name=self.main)

    def _main(self) -> str:
        parameters = self.model.parameters
        title = _text(self.model.title).strip()
        first = f"{self.main.upper()}  Transfer functions of{f': {title}' if title else ' a linear system.'}"
        lines = [f"function G = {self.main}()", *_helped(first), *_helped("", self._usage()), ""]
        lines += [f"  G.{self.fields[m.key]} = @{self.public[m.key]};" for m in self.members]
        lines += [f"  G.{MATRIX} = @{self.whole};"] if self.matrix is not None else []
        for group, role in (("systems", "system"), ("coefficients", "coefficients")):
            lines += [f"  G.{group} = struct();"] if self.systems else []
            lines += [f"  G.{group}.{self.fields[key]} = @{self.private[key, role]};" for key in self.systems]
        lines.append("  G.parameters = default_parameters();")
        for field, texts in (
            ("units", {p.name: p.unit for p in parameters}),
            ("descriptions", {p.name: p.doc for p in parameters}),
        ):
            lines.append(f"  G.{field} = struct();")
            lines += [f"  G.{field}.{self.parameters[n]} = {_string(text)};" for n, text in texts.items()]
        for field, is_response in (("transfer_functions", False), ("frequency_responses", True)):
            rows = [m for m in self.members if m.is_response == is_response]
            lines.append(f"  G.{field} = cell({len(rows)}, 2);")
            for i, m in enumerate(rows, 1):
                lines.append(f"  G.{field}({i}, :) = {{{_string(m.tf.name)}, '{self.fields[m.key]}'}};")
        return _function(*lines)

    def _usage(self) -> list[str]:
        """Return the body of the help text."""
        lines: list[str] = []
        if self.members:
            first = f"G = {self.main.upper()}() is a struct of functions and of the model's parameters."
            lines += [first, "", *self._examples(), "", *wrapped(EXPANSION, ROOM), "", "Functions"]
        for m in self.members:
            lines += wrapped(f"{self.fields[m.key]}: {_disarmed(m.headline)}", ROOM, "  ", "      ")
            lines += wrapped(_text(m.verification.text()), ROOM, "      ")
        lines += ["", "Parameters"] if self.model.parameters else []
        lines += OUTLINE.arguments(self.model.parameters, self.parameters)
        if self.model.source.strip():
            lines += ["", *wrapped(f"Source: {_text(self.model.source)}", ROOM)]
        return [*lines, "", "Written by symflex."]

    def _examples(self) -> list[str]:
        """Return lines of code with what is said of each beside it."""
        member = self.members[0]
        field = self.fields[member.key]
        rows = [(f"G = {self.main}();", ""), (f"G.{field}(s)", "s: Laplace variable [rad/s], of any size")]
        for p in member.parameters[:1]:
            name, value = self.parameters[p.name], default_value(p) or "1.0"
            rows += [
                (f"G.{field}(s, '{name}', {value})", "another value, or an array of values"),
                ("p = G.parameters;", "in SI units, [] where there is none"),
                (f"p.{name} = {value};", ""),
                (f"G.{field}(s, p)", "a struct of values, all or some"),
            ]
        for m in [m for m in self.members if m.is_response][:1]:
            rows.append((f"G.{self.fields[m.key]}(omega)", "at s = 1i*omega"))
        rows += [
            ("w = 2*pi*logspace(0, 3, 1000);", "[rad/s]"),
            (f"H = frd(G.{field}(1i*w), w);", "for the Control System Toolbox"),
        ]
        more = [
            row
            for rational in [self.fields[key] for key in self.systems][:1]
            for row in (
                (f"H = G.systems.{rational}();", "a tf; parameters may follow"),
                (f"H = G.systems.{rational}('zpk');", "or 'ss'"),
                (f"[num, den] = G.coefficients.{rational}();", "without any toolbox"),
            )
        ]
        lines: list[str] = []
        for group in (rows, more):
            width = min(max((len(code) for code, _ in group), default=0), WIDTH // 2)
            lines += [f"  {code.ljust(width)}   {said}".rstrip() for code, said in group]
        return lines

    def _defaults(self) -> str:
        names = self.parameters
        return _function(
            "function p = default_parameters()",
            "%DEFAULT_PARAMETERS  Values of the model, in SI units.",
            "  p = struct();",
            *(f"  p.{names[p.name]} = {default_value(p) or '[]'};" for p in self.model.parameters),
        )

    def _response(self, member: Member) -> str:
        """Return the function of the angular frequency, which calls that of s."""
        of_s = next(m.key for m in self.members if m.tf is member.tf)
        value = f"value = on_axis(@{self.public[of_s]}, omega, varargin);"
        return _function(*self._head(member, "omega"), *continued(value, "  "))

    def _head(self, member: Member, variable: str) -> list[str]:
        """Return the first line of a function behind a handle, and its help text."""
        name = self.public[member.key]
        headline, *help_text = OUTLINE.about(member)
        help_text += [_disarmed(line) for line in origin_lines(member.tf.model, ROOM)]
        help_text += OUTLINE.verified(member)
        first = f"{name.upper()}  {headline}"
        return [f"function value = {name}({variable}, varargin)", *_helped(first, help_text)]

    def _system_functions(self, system: RationalSystem, names: Mapping[str, str]) -> list[str]:
        """Return the function of the coefficients, and the one that makes a system of them."""
        tf, (made, read) = system.tf, (names[role] for role in SYSTEM_ROLES)
        used = [self.parameters[p.name] for p in tf.parameters]
        taken = {*self.taken, *self.parameters.values()}
        local = identifiers({n: n for n in ("num", "den", "delay")}, taken).values()
        renamed: dict[str, Expression] = {
            name: Name(identifier) for name, identifier in self.parameters.items()
        }

        def text(expression: Expression) -> str:
            return format_expression(substitute(expression, renamed))

        rows = [f"[{', '.join(map(text, row))}]" for row in (system.num, system.den)]
        lines = [
            *continued(f"function [{', '.join(local)}] = {read}(varargin)", ""),
            *_helped(f"{read.upper()}  Coefficients by descending powers of s, delay [s]."),
            *_given(used),
            *(continued(f"[{', '.join(used)}] = given{{:}};", "  ") if used else ()),
        ]
        for name, value in zip(local, (*rows, text(system.delay)), strict=True):
            lines += continued(f"{name} = {value};", "  ")
        ends = (tf.input, tf.output)
        units = ("" if end.dimension is None else str(end.dimension) for end in ends)
        more = [
            *continued(f"function value = {made}(varargin)", ""),
            *_helped(f"{made.upper()}  A system of kind 'tf', or of that named first: 'zpk', 'ss'."),
            "  kind = 'tf';",
            "  if mod(numel(varargin), 2) == 1 && ischar(varargin{1})",
            "    kind = varargin{1};",
            "    varargin(1) = [];",
            "  end",
            *continued(f"[num, den, delay] = {read}(varargin{{:}});", "  "),
            # Strings are not broken over lines.
            f"  ends = {{{', '.join(_string(end.name) for end in ends)}}};",
            f"  units = {{{', '.join(map(_string, units))}}};",
            "  value = system_of(kind, num, den, delay, ends, units);",
        ]
        return [_function(*lines), _function(*more)]


MATLAB = Language(
    ".m",
    "MATLAB and Octave function file, a handle per transfer function, verified likewise",
    lambda contents: _File(contents).made(),
    shares=True,
)


MOST_COEFFICIENTS: Final = 200


@dataclass(frozen=True, slots=True)
class RationalSystem:
    """A quotient of polynomials in s, and a delay."""

    tf: TransferFunction  # what it is
    # num and den: coefficients by descending powers of s.
    num: tuple[Expression, ...]
    den: tuple[Expression, ...]
    delay: Expression  # [s]; the number 0 without one

    @staticmethod
    def of(tf: AnyTransferFunction) -> RationalSystem | None:
        """Return a transfer function as a rational one; the result is None if it is none, or too long."""
        if not tf.is_reduced or tf.is_large or tf.length > FORMULA_TERMS or tf.is_zero:
            return None
        exponentials = {k.generator: k for k in tf.kernels.kernels if k.function == "exp"}
        ring = tf.ratio.ring
        others = {*tf.kernels.generators, *(w for d in tf.kernels.dispersions for w in d.wavenumbers)}
        polynomial = Factored.number(ring, tf.ratio.unit)
        delays: list[Expression] = []
        for factor, exponent in tf.ratio.factors:
            one = Factored.polynomial(ring, factor)
            kernel = next((k for g, k in exponentials.items() if factor == ring.generator(g)), None)
            if kernel is None:
                if any(one.depends_on(name) for name in others if name in ring.index):
                    return None
                polynomial = polynomial * one**exponent
                continue
            delay = kernel.dispersion.shift * kernel.length * exponent
            delay = delay / Factored.generator(delay.ring, LAPLACE)
            if exponent < 0 or delay.depends_on(LAPLACE):
                return None
            delays.append(plain_printer(tf).quotient(delay))
        arranger = Arranger.plain(ring, constant_symbols(tf))
        num, den = (
            tuple(number(0) if part.is_zero() else arranger.coefficient(part) for part in coefficients)
            for side in (polynomial.numerator(), polynomial.denominator())
            for coefficients in (reversed(ring.coefficients(side.expand())),)
        )
        if max(len(num), len(den)) > MOST_COEFFICIENTS:
            return None
        return RationalSystem(tf, num, den, sum_of(delays) if delays else number(0))
