"""Transfer functions as one function file that MATLAB and Octave run.

Input: the contents of a file.
Output: its text.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from symflex.codegen.export import Export, Language
from symflex.codegen.matlab.expression import WIDTH, continued
from symflex.codegen.matlab.pieces import LONGEST, LocalFunctions, roles_of
from symflex.codegen.matlab.systems import RationalSystem, system_functions
from symflex.codegen.module_text import (
    COST,
    default_value,
    described,
    formula_lines,
    headline,
    origin_lines,
)
from symflex.codegen.program import identifiers, inert, wrapped
from symflex.codegen.source_parts import called_parts, parts_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from symflex.codegen.export import Contents, Member
    from symflex.model import Model

KEYWORDS = frozenset(
    "__FILE__ __LINE__ arguments break case catch classdef continue do else elseif end end_try_catch "
    "end_unwind_protect endarguments endclassdef endenumeration endevents endfor endfunction endif "
    "endmethods endparfor "
    "endproperties endspmd endswitch endwhile enumeration events for function global if methods "
    "otherwise parfor persistent properties return spmd switch try until unwind_protect "
    "unwind_protect_cleanup while".split()
)
"""Of both languages."""

FUNCTIONS = frozenset(
    "i j pi e eps Inf inf NaN nan NA ans true false end nargin nargout varargin varargout exp log sqrt sin "
    "cos tan sinh cosh tanh abs real imag conj complex any all size zeros ones reshape numel unique isempty "
    "isnumeric islogical isreal isscalar isstruct isfield isa ischar char double error cell cellfun "
    "fieldnames struct2cell mod max min find repmat eye eig diag ceil log2 isfinite sum struct".split()
)
"""What generated code uses, and constants that a reader would miss."""

WORDS = frozenset({"s", "G", "given", "value"})
"""Variables of the generated code; parameters leave them to it."""

TOOLBOX = frozenset({"tf", "zpk", "ss", "frd", "roots"})
"""What no function of the file may hide."""

PARTS = parts_of("matlab.m")

NAMES = frozenset({"default_parameters"}.union(*PARTS))
"""Names of the functions that others call."""

RESERVED = KEYWORDS | FUNCTIONS | NAMES | WORDS

TITLE_LENGTH = 30
"""Characters of a title that a function is named by."""

LONGEST_STEM = 64
"""Characters of a file's name that a message shows."""

EXPANSION = (
    "s and parameters are expanded against each other, as operators expand them. "
    "Values are not finite at poles."
)

_LINK = re.compile(r"<(?=[A-Za-z/])")


def matlab_function_file(contents: Contents) -> Export:
    """Return a function file; the struct that its main function returns has a handle per transfer function.

    Its main function is called as the file is, or from the model's title. A warning says so when MATLAB
    cannot call a file of that name.
    """
    model, members, digits = contents.model, contents.members, contents.digits
    stem = contents.stem
    main = main_name(stem or model.title)
    fields = identifiers({m.key: m.wanted for m in members}, RESERVED | _OTHER_FIELDS, LONGEST)
    taken = RESERVED | {main}
    public = identifiers({m.key: fields[m.key] for m in members}, taken | TOOLBOX, LONGEST)
    taken |= set(public.values())
    systems = {m.key: s for m in members if not m.program.is_real and (s := RationalSystem.of(m.tf))}
    roles = {f"{m.key} {role}": f"{public[m.key]}_{role}" for m in members for role in roles_of(m.program)}
    roles |= {f"{key} {role}": f"{public[key]}_{role}" for key in systems for role in _SYSTEM_ROLES}
    private = identifiers(roles, taken, LONGEST)
    taken |= set(private.values())
    parameters = identifiers({p.name: p.name for p in model.parameters}, taken, LONGEST)
    makers = {fields[key]: [private[f"{key} {role}"] for role in _SYSTEM_ROLES] for key in systems}
    blocks = [
        _main(model, main, members, fields, public, parameters, makers, digits),
        _defaults(model, parameters),
    ]
    code = ""
    for m in members:
        own = {role: private[f"{m.key} {role}"] for role in roles_of(m.program)}
        functions = LocalFunctions(m.program, public[m.key], parameters, taken - WORDS, own)
        local = functions.blocks()
        blocks += [_public(m, public[m.key], functions, digits), *local]
        code += "\n".join([*functions.call(), *local])
        if m.key in systems:
            made, read = makers[fields[m.key]]
            blocks += system_functions(systems[m.key], (made, read), parameters, taken, _string)
    always = ("numbers", "columns", *(["system_of"] if systems else []))
    blocks += called_parts(code, PARTS, always)
    shown = inert(stem[:LONGEST_STEM])
    warning = f"MATLAB cannot call a file '{shown}.m': name it '{main}.m', as its function"
    return Export("\n".join(blocks), (warning,) if stem and main != stem else (), name=main)


_OTHER_FIELDS = frozenset(
    "parameters units descriptions transfer_functions frequency_responses systems coefficients".split()
)
_SYSTEM_ROLES = ("system", "coefficients")


def main_name(text: str) -> str:
    """Return a text as the name of a function file: the text itself where it can be one.

    Examples
    --------
    >>> main_name("six_mass"), main_name("exp"), main_name("2 masses, joined"), main_name("")
    ('six_mass', 'exp_', 'p_2_masses__joined', 'model')
    """
    short = text if re.fullmatch(r"[A-Za-z]\w*", text, re.ASCII) else text[:TITLE_LENGTH].strip()
    return identifiers({"main": short or "model"}, RESERVED, LONGEST)["main"]


# -------------------------------------------------------------------------------------------------- text


def _comment(lines: Sequence[str]) -> list[str]:
    """Return lines as a comment; they hold no line end, and a blank stands before them."""
    return [f"%   {line}".rstrip() for line in lines]


def _text(text: str) -> str:
    """Return text on one line without what MATLAB or Octave would obey in a help text or on the screen."""
    return inert(_disarmed(text))


def _disarmed(text: str) -> str:
    """Return text in which links are not links, and no mark asks for Texinfo."""
    return _LINK.sub("< ", text).replace("-*-", "- * -")


def _string(text: str) -> str:
    """Return a string literal: inert text, quotes doubled."""
    return "'" + _text(text).replace("'", "''") + "'"


def _main(
    model: Model,
    main: str,
    members: Sequence[Member],
    fields: Mapping[str, str],
    public: Mapping[str, str],
    parameters: Mapping[str, str],
    makers: Mapping[str, Sequence[str]],
    digits: int,
) -> str:
    title = _text(model.title).strip()
    first = f"%{main.upper()}  Transfer functions{f' of: {title}' if title else ' of a linear system.'}"
    lines = [f"function G = {main}()", *wrapped(first, WIDTH, "", "%   "), "%"]
    named = [(m, fields[m.key]) for m in members]
    lines += _comment(_usage(main, named, model, parameters, makers, digits))
    lines += ["", *(f"  G.{fields[m.key]} = @{public[m.key]};" for m in members)]
    for i, group in enumerate(("systems", "coefficients") if makers else ()):
        lines.append(f"  G.{group} = struct();")
        lines += [f"  G.{group}.{field} = @{pair[i]};" for field, pair in makers.items()]
    lines.append("  G.parameters = default_parameters();")
    for field, texts in (
        ("units", {p.name: p.unit for p in model.parameters}),
        ("descriptions", {p.name: p.doc for p in model.parameters}),
    ):
        lines.append(f"  G.{field} = struct();")
        lines += [f"  G.{field}.{parameters[name]} = {_string(text)};" for name, text in texts.items()]
    for field, is_real in (("transfer_functions", False), ("frequency_responses", True)):
        rows = [(m.tf.name, fields[m.key]) for m in members if m.program.is_real == is_real]
        lines.append(f"  G.{field} = cell({len(rows)}, 2);")
        for i, (name, field_name) in enumerate(rows, 1):
            lines.append(f"  G.{field}({i}, :) = {{{_string(name)}, '{field_name}'}};")
    return "\n".join([*lines, "end", ""])


def _usage(
    main: str,
    members: Sequence[tuple[Member, str]],
    model: Model,
    parameters: Mapping[str, str],
    makers: Mapping[str, Sequence[str]],
    digits: int,
) -> list[str]:
    """Return the body of the help text."""
    lines: list[str] = []
    if members:
        lines += [
            f"G = {main.upper()}() is a struct of functions and of the model's parameters.",
            "",
            *_examples(main, members, parameters, makers),
            "",
            *wrapped(EXPANSION, _ROOM),
            "",
            "Functions",
        ]
    for m, field in members:
        lines += wrapped(
            f"{field}: {_disarmed(headline(m.tf, is_real=m.program.is_real))}", _ROOM, "  ", "      "
        )
        lines += wrapped(_text(m.verification.text(digits)), _ROOM, "      ")
    if model.parameters:
        lines += ["", "Parameters"]
        for p in model.parameters:
            value = default_value(p) or "no value"
            text = f"{parameters[p.name]} = {value}: {_disarmed(described(p, parameters[p.name]))}"
            lines += wrapped(text, _ROOM, "  ", "      ")
    if model.source.strip():
        lines += ["", *wrapped(f"Source: {_text(model.source)}", _ROOM)]
    return [*lines, "", "Written by symflex."]


_ROOM = WIDTH - 4


def _examples(
    main: str,
    members: Sequence[tuple[Member, str]],
    parameters: Mapping[str, str],
    makers: Mapping[str, Sequence[str]],
) -> list[str]:
    member, field = members[0]
    rows = [(f"G = {main}();", ""), (f"G.{field}(s)", "s: Laplace variable [rad/s], of any size")]
    if member.tf.parameters:
        first = member.tf.parameters[0]
        name, value = parameters[first.name], default_value(first) or "1.0"
        rows += [
            (f"G.{field}(s, '{name}', {value})", "another value, or an array of values"),
            ("p = G.parameters;", "in SI units, [] where there is none"),
            (f"p.{name} = {value};", ""),
            (f"G.{field}(s, p)", "a struct of values, all or some"),
        ]
    real = next((f for m, f in members if m.program.is_real), None)
    if real is not None:
        rows.append((f"G.{real}(omega)", "at s = 1i*omega, in real arithmetic"))
    rows += [
        ("w = 2*pi*logspace(0, 3, 1000);", "[rad/s]"),
        (f"H = frd(G.{field}(1i*w), w);", "for the Control System Toolbox"),
    ]
    rational = next(iter(makers), None)
    more = [
        (f"H = G.systems.{rational}();", "a tf; parameters may follow"),
        (f"H = G.systems.{rational}('zpk');", "or 'ss'"),
        (f"[num, den] = G.coefficients.{rational}();", "without any toolbox"),
    ]
    return [*_in_columns(rows), *(_in_columns(more) if rational is not None else ())]


def _in_columns(rows: Sequence[tuple[str, str]]) -> list[str]:
    """Return lines of code with what is said of each beside it."""
    width = min(max(len(code) for code, _ in rows), WIDTH // 2)
    return [f"  {code.ljust(width)}   {said}".rstrip() for code, said in rows]


def _defaults(model: Model, parameters: Mapping[str, str]) -> str:
    lines = ["function p = default_parameters()", "%DEFAULT_PARAMETERS  Values of the model, in SI units."]
    lines.append("  p = struct();")
    lines += [f"  p.{parameters[p.name]} = {default_value(p) or '[]'};" for p in model.parameters]
    return "\n".join([*lines, "end", ""])


def _public(member: Member, name: str, functions: LocalFunctions, digits: int) -> str:
    """Return the function behind a handle."""
    tf, variable = member.tf, functions.variable
    lines = [f"function value = {name}({variable}, varargin)"]
    first = f"%{name.upper()}  {_disarmed(headline(tf, is_real=member.program.is_real))}"
    lines += wrapped(first, WIDTH, "", "%   ")
    help_text = ["", *(_disarmed(line) for line in formula_lines(tf, _ROOM)), ""]
    if origin := origin_lines(tf.model, _ROOM):
        help_text += [*(_disarmed(line) for line in origin), ""]
    help_text += wrapped(_text(member.verification.text(digits)), _ROOM)
    if member.program.solves:
        help_text += wrapped(COST, _ROOM)
    lines += _comment(help_text)
    names = ", ".join(f"'{functions.parameters[p]}'" for p in member.program.parameters)
    lines += continued(f"given = numbers(varargin, {{{names}}});", "  ")
    return "\n".join([*lines, *functions.call(), "end", ""])


MATLAB = Language(
    ".m",
    "MATLAB and Octave function file, a handle per transfer function, verified likewise",
    matlab_function_file,
)
