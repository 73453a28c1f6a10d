"""Transfer functions as a Julia module without dependencies: everything that is printed in Julia."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

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
from symflex.codegen.module_text import default_value, identifiers
from symflex.codegen.program.nodes import ONE, CodePiece, Laplace, Piecewise

WIDTH = 92  # columns, as Julia's own style has it

KEYWORDS = frozenset(
    "abstract as baremodule begin break catch const continue do else elseif end export false finally for "
    "function global if import in isa let local macro module mutable outer primitive public quote return "
    "struct true try type using where while".split()
)

NAMES = frozenset(  # what generated code uses, and names that a reader or the module itself would miss
    "pi im e Inf NaN Inf64 NaN64 nothing missing exp log sqrt sin cos tan sinh cosh tanh atan abs abs2 real "
    "imag conj complex float signbit cis zero one zeros length eltype iszero isfinite all max min maximum "
    "ceil log2 fill push findfirst zip Base Core Main LinearAlgebra Number Real Complex ComplexF64 Float64 "
    "Int Tuple Vector Vararg Dict String NamedTuple eval include PARAMETERS TRANSFER_FUNCTIONS "
    "FREQUENCY_RESPONSES permutedims reshape".split()
)
RESERVED = KEYWORDS | NAMES | {"s"}


# ---------------------------------------------------------------------------------- expressions


@dataclass(frozen=True)
class JuliaPrinter(InfixPrinter):
    """Prints expressions whose values are numbers."""

    power: ClassVar = "{}^{}"
    cut_off: ClassVar = "ifelse(abs({z}) <= {end!r}, {z}, NaN * {z})"
    first: ClassVar = 1
    together: ClassVar = "({})"

    def complex_number(self, real: float, imaginary: float) -> str:
        """Return a number as text that needs no parentheses."""
        return f"complex({real!r}, {imaginary!r})"


# ---------------------------------------------------------------------------- private functions


class JuliaFunctions(PrivateFunctions):
    """Prints the functions that compute, of positional arguments; all begin with an underscore."""

    printer: ClassVar = JuliaPrinter

    def statement(self, target: str, value: str, depth: int = 1) -> list[str]:
        """Return ``target = value``, or ``return value``, in parentheses where it takes several lines."""
        indent = "    " * depth
        opening = f"{indent}{target} " if target == "return" else f"{indent}{target} = "
        if len(opening) + len(value) <= WIDTH:
            return [opening + value]
        lines = in_lines(value, WIDTH - len(indent) - 4)
        return [f"{opening}(", *(f"{indent}    {line}" for line in lines), f"{indent})"]

    def _function(self, kind: str, variable: str, body: Sequence[str]) -> str:
        given = self.arguments(variable)
        head = [f"function _{kind}_of_{self.name}({', '.join(given)})"]
        if len(head[0]) > WIDTH:
            head = [
                f"function _{kind}_of_{self.name}(",
                *(f"    {x}," for x in given[:-1]),
                f"    {given[-1]}",
                ")",
            ]
        return "\n".join([*head, *body, "end", ""])

    def _call(self, kind: str, variable: str) -> str:
        return f"_{kind}_of_{self.name}({', '.join(self.arguments(variable))})"

    def _lumped(self, program: Piecewise) -> str:
        near, far, late = program.near, program.far, program.late
        printer, (s, inverse) = self.scope((*near.every, *late), "s", "inverse")
        lines = self.assigned(near.every, printer)
        if far is not None:
            one = printer.quotient(ONE, Laplace())
            body = [
                *self.statement(inverse, one, 2),
                *self.assigned(late, printer, 2),
                *self.statement("return", printer.all_of(far.values), 2),
            ]
            lines += [f"    if abs({s}) > {program.limit!r}", *body, "    end"]
        return self._function("value", s, [*lines, *self.statement("return", printer.all_of(near.values))])

    def _choice(self, program: Piecewise) -> str:
        """Return the function that finds the piece that serves."""
        printer, (s, number) = self.scope(program.tests.every, "s", "number")
        lines = self.assigned(program.tests.every, printer)
        if program.conditions:
            lines += self.statement(number, printer.piece_number(program))
        served = {k: [n for n, piece in enumerate(program.pieces) if piece == k] for k in set(program.pieces)}
        *others, last = sorted(served)
        for k in others:
            test = " || ".join(f"{number} == {n}" for n in served[k])
            lines += [f"    if {test}", *self.statement("return", self._call(f"piece_{k}", s), 2), "    end"]
        return self._function("value", s, [*lines, *self.statement("return", self._call(f"piece_{last}", s))])

    def _piece(self, number: int, piece: CodePiece) -> list[str]:
        printer, (s,) = self.scope(piece.code.every, "s")
        lines = self.assigned(piece.code.every, printer)
        if piece.circle:
            values = self.statement("return", printer.all_of(piece.code.values))
            parts = self._function(f"parts_{number}", s, [*lines, *values])
            _, (s, z) = self.scope((), "s", "z")
            parts_of_z = f"{z} -> {self._call(f'parts_{number}', z)}"
            mean = self.statement("return", f"_mean_over_circle({parts_of_z}, {s}, {piece.circle})")
            return [parts, self._function(f"piece_{number}", s, mean)]
        lines += self.statement("return", printer.quotient(*piece.code.values))
        return [self._function(f"piece_{number}", s, lines)]


# -------------------------------------------------------------------------------------- the module


def julia_module(contents: Contents) -> Export:
    """Return a module, named by its file or the model's title, with one function per transfer function."""
    model, members = contents.model, contents.members
    main = module_name(contents.stem or model.title)
    public, parameters = contents.names(RESERVED | {main})
    taken = {*RESERVED, main, *public.values()}
    rows = JULIA_OUTLINE.parameter_rows(model, parameters)
    table = ["const PARAMETERS = (", *rows, ")"] if rows else ["const PARAMETERS = NamedTuple()"]
    docs = "Values in SI units, units and descriptions of the model's parameters."
    blocks, code = ["\n".join([*_docstring([docs]), *table, ""])], ""
    for m in members:
        functions = JuliaFunctions(m.program, public[m.key], parameters, taken - {"s"})
        of_s = public[f"of {m.tf.name}"]
        private = [] if m.is_response else functions.blocks()
        blocks += [_public(m, functions, of_s), *private]
        code += "\n".join(private)
    if contents.matrix is not None:
        (whole,) = identifiers({"": MATRIX}, taken).values()
        blocks.append(_matrix(contents.matrix, whole, public, parameters))
        if contents.matrix.program is not None:
            functions = JuliaFunctions(contents.matrix.program, whole, parameters, taken - {"s"})
            blocks.append(functions.entries())
            code += blocks[-1]
        public = {**public, "": whole}
    blocks += called_parts(code, parts_of("julia.jl"))
    for name, is_response in (("TRANSFER_FUNCTIONS", False), ("FREQUENCY_RESPONSES", True)):
        named = {m.tf.name: public[m.key] for m in members if m.is_response == is_response}
        rows = JULIA_OUTLINE.function_rows(named)
        opening = f"const {name} = Dict{{String, Function}}("
        blocks.append("\n".join([opening, *rows, ")", ""] if rows else [f"{opening})", ""]))
    written = (
        "Written by symflex. Each function evaluates OUT/IN at the Laplace variable s [rad/s], a number; "
        "with a dot, as in OUT_over_IN.(s), it takes arrays."
    )
    verified = [m.verification for m in members if not m.is_response]
    heading = JULIA_OUTLINE.heading("Transfer functions of a linear system.", model, [written], verified)
    header = [*_docstring(heading), f"module {main}", ""]
    if public:
        first, *others = in_lines(", ".join(public.values()), WIDTH - len("export "))
        header += [f"export {first}", *(f"    {line}" for line in others), ""]
    text = "\n".join([*header, "\n".join(blocks), f"end # module {main}", ""])
    return Export(text, name=main)


def _matrix(matrix: MatrixMember, name: str, public: Mapping[str, str], parameters: Mapping[str, str]) -> str:
    """Return the function of all entries, which calls those of single entries, or its own."""
    rows, columns = matrix.shape
    signature = []
    for p in matrix.parameters:
        default = default_value(p)
        signature.append(f"{parameters[p.name]}::Number{f' = {default}' if default else ''}")
    lines = [f"    {name}(s{'; ...' if signature else ''})", "", _disarmed(matrix.headline), ""]
    lines += ["Parameters are those of its functions.", *JULIA_OUTLINE.verified(matrix, ".")]
    head = [f"function {name}(s::Number;", *(f"    {x}," for x in signature), ")"]
    if not signature:
        head = [f"function {name}(s::Number)"]
    body = ["    values = ["]
    for member in matrix.each if matrix.program is None else ():
        given = "; " * bool(member.parameters)
        given += ", ".join(f"{parameters[p.name]} = {parameters[p.name]}" for p in member.parameters)
        body.append(f"        {public[member.key]}(s{given}),")
    body.append("    ]")
    if matrix.program is not None:
        own = ["complex(float(s))", *(f"float({parameters[p]})" for p in matrix.program.parameters)]
        call = f"_value_of_{name}({', '.join(own)})"
        body = in_lines(f"values = [complex(x) for x in {call}]", WIDTH - 8)
        body = [f"    {'    ' * bool(i)}{line}" for i, line in enumerate(body)]
    body += [f"    return permutedims(reshape(values, {columns}, {rows}))", "end", ""]
    return "\n".join([*_docstring(lines), *head, *body])


def module_name(text: str) -> str:
    """Return a text as the name of a module, capitals for the first letters of words."""
    words = re.findall(r"[A-Za-z0-9]+", text)[:4]  # the first of them name it
    joined = "".join(word[:1].upper() + word[1:] for word in words) or "TransferFunctions"
    plain = joined if joined[0].isalpha() else f"P{joined}"
    return identifiers({"main": plain}, RESERVED)["main"]


def _disarmed(text: str) -> str:
    """Return inert text in which no Markdown fence begins, for these may hold code to be run."""
    return text.replace("`", "'").replace("~~~", "~ ~ ~")


def _docstring(lines: Sequence[str]) -> list[str]:
    """Return lines, which contain no double quote, as a docstring."""
    escaped = (line.rstrip().replace("\\", "\\\\").replace("$", "\\$") for line in lines)
    return ['"""', *escaped, '"""']


def _string(text: str) -> str:
    """Return a string literal that holds only printable characters."""
    return '"' + "".join(_character(c) for c in text) + '"'


def _character(c: str) -> str:
    if c in '"\\$':
        return f"\\{c}"
    if c.isprintable():
        return c
    return f"\\U{ord(c):08x}" if ord(c) > 0xFFFF else f"\\u{ord(c):04x}"  # noqa: PLR2004 (the last of \\u)


JULIA_OUTLINE = Outline(
    WIDTH,
    _string,
    "nothing",
    disarmed=_disarmed,
    argument="- ",
    more="  ",
    parameter="    {} = (value = {}, unit = {}, doc = {}),",
    function="    {} => {},",
)


def _public(member: Member, functions: JuliaFunctions, of_s: str) -> str:
    """Return the function that a user calls; a frequency response calls the function of s."""
    parameters = [(p, functions.parameters[p.name]) for p in member.parameters]
    variable, kind = ("omega", "Real") if member.is_response else ("s", "Number")
    variable += "_" * any(name == variable for _, name in parameters)
    signature, arguments = [], ["complex(float(s))"]
    for p, name in parameters:
        default = default_value(p)
        signature.append(f"{name}::{kind}{f' = {default}' if default else ''}")
        arguments.append(f"float({name})")
    opening = f"{functions.name}({variable}::{kind}"
    lines = [f"    {functions.name}({variable}{'; ...' if parameters else ''})", ""]
    lines += JULIA_OUTLINE.about(member)
    what = "angular frequency" if member.is_response else "Laplace variable"
    lines += ["# Arguments", f"- {variable}: {what} [rad/s]."]
    lines += [*JULIA_OUTLINE.arguments(member.parameters, functions.parameters), ""]
    lines += [*JULIA_OUTLINE.verified(member, "."), "Not finite at poles."]
    heading = f"{opening}{'; ' if signature else ''}{', '.join(signature)})"
    first = [f"function {heading}"]
    if len(first[0]) > WIDTH:
        first = [f"function {opening};", *(f"    {x}," for x in signature[:-1]), f"    {signature[-1]})"]
    body = f"    return complex(_value_of_{functions.name}({', '.join(arguments)}))"
    if member.is_response:
        given = "; " * bool(parameters) + ", ".join(f"{name} = {name}" for _, name in parameters)
        body = "\n".join(functions.statement("return", f"{of_s}(complex(0.0, float({variable})){given})"))
    elif len(body) > WIDTH:
        inside = [f"        {a}," for a in arguments[:-1]] + [f"        {arguments[-1]}))"]
        body = "\n".join([f"    return complex(_value_of_{functions.name}(", *inside])
    return "\n".join([*_docstring(lines), *first, body, "end", ""])


JULIA = Language(
    ".jl",
    "Julia module, one function per transfer function, verified likewise",
    julia_module,
    shares=True,
)
