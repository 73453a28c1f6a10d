"""Transfer functions as a Julia module without dependencies: everything that is printed in Julia.

Input: the contents of a module.
Output: its text. Read from the top: expressions, the private functions that compute, the module around them.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from symflex.codegen.export import Export, Language, called_parts, parts_of
from symflex.codegen.infix import InfixPrinter, NumberFunctions, in_lines
from symflex.codegen.module_text import (
    default_value,
    described,
    formula_lines,
    identifiers,
    inert,
    origin_lines,
    wrapped,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from symflex.codegen.export import Contents, Member
    from symflex.model import Model

WIDTH = 92
"""Columns, as Julia's own style has it."""

LAST_OF_FOUR_DIGITS = 0xFFFF
"""The last character that ``\\u`` names."""

KEYWORDS = frozenset(
    "abstract as baremodule begin break catch const continue do else elseif end export false finally for "
    "function global if import in isa let local macro module mutable outer primitive public quote return "
    "struct true try type using where while".split()
)

NAMES = frozenset(
    "pi im e Inf NaN Inf64 NaN64 nothing missing exp log sqrt sin cos tan sinh cosh tanh abs abs2 real imag "
    "conj complex float signbit cis zero one zeros length eltype iszero isfinite all max min maximum ceil "
    "log2 fill push findfirst zip Base Core Main LinearAlgebra Number Real Complex ComplexF64 Float64 Int "
    "Tuple Vector Vararg Dict String NamedTuple eval include PARAMETERS TRANSFER_FUNCTIONS "
    "FREQUENCY_RESPONSES".split()
)
"""What generated code uses, and names that a reader or the module itself would miss."""

RESERVED = KEYWORDS | NAMES | {"s"}

WORDS_OF_TITLE = 4
"""Words of the title that name a module."""


# ---------------------------------------------------------------------------------- expressions


@dataclass(frozen=True)
class JuliaPrinter(InfixPrinter):
    """Prints expressions whose values are numbers."""

    power: ClassVar = "{}^{}"
    cut_off: ClassVar = "ifelse(abs({z}) <= {end!r}, {z}, NaN * {z})"
    first: ClassVar = 1

    def complex_number(self, real: float, imaginary: float) -> str:
        """Return a number as text that needs no parentheses."""
        return f"complex({real!r}, {imaginary!r})"


def head(name: str, arguments: Sequence[str]) -> list[str]:
    """Return the first lines of a function.

    Examples
    --------
    >>> head("f", ["s", "l"])
    ['function f(s, l)']
    """
    line = f"function {name}({', '.join(arguments)})"
    if len(line) <= WIDTH:
        return [line]
    return [f"function {name}(", *(f"    {a}," for a in arguments[:-1]), f"    {arguments[-1]}", ")"]


# ---------------------------------------------------------------------------- private functions


class JuliaFunctions(NumberFunctions):
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

    def branch(self, test: str, body: Sequence[str]) -> list[str]:
        """Return statements that are executed where a test holds."""
        return [f"    if {test}", *body, "    end"]

    def function(self, name: str, arguments: Sequence[str], body: Sequence[str]) -> str:
        """Return a function."""
        return "\n".join([*head(name, arguments), *body, "end", ""])


# -------------------------------------------------------------------------------------- the module


def julia_module(contents: Contents) -> Export:
    """Return a module with one function ``OUT_over_IN(s; parameter = default, ...)`` per transfer function.

    Its name is made from the file's, or from the model's title.
    """
    model, members = contents.model, contents.members
    main = module_name(contents.stem or model.title)
    public, parameters = contents.names(RESERVED | {main})
    taken = {*RESERVED, main, *public.values()}
    blocks, code = [_parameter_table(model, parameters)], ""
    for m in members:
        functions = JuliaFunctions(m.program, public[m.key], parameters, taken - {"s"})
        of_s = public[f"of {m.tf.name}"]
        private = [] if m.is_response else functions.blocks()
        blocks += [_public(m, functions, of_s), *private]
        code += "\n".join(private)
    blocks += called_parts(code, parts_of("julia.jl"))
    for table, is_response in (("TRANSFER_FUNCTIONS", False), ("FREQUENCY_RESPONSES", True)):
        blocks.append(_function_table(table, [m for m in members if m.is_response == is_response], public))
    header = [*_docstring(_header(model, members)), f"module {main}", ""]
    if public:
        first, *others = in_lines(", ".join(public.values()), WIDTH - len("export "))
        header += [f"export {first}", *(f"    {line}" for line in others), ""]
    text = "\n".join([*header, "\n".join(blocks), f"end # module {main}", ""])
    return Export(text, name=main)


def module_name(text: str) -> str:
    """Return a text as the name of a module, capitals for the first letters of words.

    Examples
    --------
    >>> module_name("six_mass"), module_name("Main"), module_name("2 masses, joined"), module_name("")
    ('SixMass', 'Main_', 'P2MassesJoined', 'TransferFunctions')
    """
    words = re.findall(r"[A-Za-z0-9]+", text)[:WORDS_OF_TITLE]
    joined = "".join(word[:1].upper() + word[1:] for word in words) or "TransferFunctions"
    plain = joined if joined[0].isalpha() else f"P{joined}"
    return identifiers({"main": plain}, RESERVED)["main"]


def _disarmed(text: str) -> str:
    """Return inert text in which no Markdown fence begins, for these may hold code to be run."""
    return text.replace("`", "'").replace("~~~", "~ ~ ~")


def _docstring(lines: Sequence[str]) -> list[str]:
    """Return lines, which hold no double quote, as a docstring."""
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
    return f"\\u{ord(c):04x}" if ord(c) <= LAST_OF_FOUR_DIGITS else f"\\U{ord(c):08x}"


def _header(model: Model, members: Sequence[Member]) -> list[str]:
    lines = ["Transfer functions of a linear system.", ""]
    lines += [_disarmed(line) for line in origin_lines(model, WIDTH)]
    lines += wrapped(
        "Written by symflex. Each function evaluates OUT/IN at the Laplace variable s [rad/s], a number; "
        "with a dot, as in OUT_over_IN.(s), it takes arrays.",
        WIDTH,
    )
    for m in (m for m in members if not m.is_response):
        text = _disarmed(inert(f"{m.tf.name}: {m.verification.text()}"))
        lines += ["", *wrapped(text, WIDTH)]
    return lines


def _parameter_table(model: Model, names: Mapping[str, str]) -> str:
    lines = ['"""', "Values in SI units, units and descriptions of the model's parameters.", '"""']
    if not model.parameters:
        return "\n".join([*lines, "const PARAMETERS = NamedTuple()", ""])
    lines.append("const PARAMETERS = (")
    for p in model.parameters:
        value = default_value(p) or "nothing"
        entries = f"value = {value}, unit = {_string(p.unit)}, doc = {_string(p.doc)}"
        lines.append(f"    {names[p.name]} = ({entries}),")
    return "\n".join([*lines, ")", ""])


def _function_table(table: str, members: Sequence[Member], public: Mapping[str, str]) -> str:
    lines = [f"    {_string(m.tf.name)} => {public[m.key]}," for m in members]
    opening = f"const {table} = Dict{{String, Function}}("
    return "\n".join([opening, *lines, ")", ""] if lines else [f"{opening})", ""])


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
    lines += [_disarmed(member.headline), ""]
    lines += [f"    {_disarmed(line)}" for line in formula_lines(member.formula, WIDTH - 4)]
    what = "angular frequency" if member.is_response else "Laplace variable"
    lines += ["", "# Arguments", f"- {variable}: {what} [rad/s]."]
    for p, name in parameters:
        value = default_value(p)
        text = f"- {name}{f' = {value}' if value else ''}: {_disarmed(described(p, name))}"
        lines += wrapped(text, WIDTH, "", "  ")
    lines += ["", *wrapped(_disarmed(inert(f"{member.verification.text()}.")), WIDTH)]
    lines.append("Not finite at poles.")
    whole = f"{opening}{'; ' if signature else ''}{', '.join(signature)})"
    first = [f"function {whole}"]
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


JULIA = Language(".jl", "Julia module, one function per transfer function, verified likewise", julia_module)
