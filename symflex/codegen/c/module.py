"""Transfer functions as a C99 source file and its header."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import count

from symflex.codegen.c.body import KEYWORDS, LANE_FUNCTIONS, PARTS, RESERVED
from symflex.codegen.c.functions import Functions, entries_in_lanes, fits_lanes, is_rational_in_lanes
from symflex.codegen.export import MATRIX, Contents, Export, Language, MatrixMember, Outline, called_parts
from symflex.codegen.module_text import (
    WIDTH,
    BlockComment,
    default_value,
    identifiers,
    inert,
    value_as_written,
    wrapped,
)
from symflex.errors import refused

_FILE_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.+-]*")
COMMENT = BlockComment("/*", "*/", " * ", ("??",))  # a comment of C; trigraphs begin with two question marks
OUTLINE = Outline(WIDTH - 3, formula="  ")


def c_files(contents: Contents) -> Export:
    """Return C99 source and header, or one file; SF902 when no include directive can name it."""
    name = None if contents.is_alone else contents.stem
    if name is not None and not _FILE_NAME.fullmatch(name):
        message = f"'{inert(name)[:64]}' cannot be the name of a C header"
        raise refused(message, "use only ASCII letters, digits and _ . + -")
    return _Files(contents, name).made()


def prefix_of(name: str | None) -> str:
    """Return what all public names begin with."""
    prefix = identifiers({"": name or "model"}, KEYWORDS)[""]
    # Private functions are called value_of_... and piece_0_of_...
    return f"{prefix}_" if prefix.endswith("_of") else prefix


def source_and_header(
    name: str | None, introduction: Sequence[str], included: Sequence[str], inside: Sequence[str], source: str
) -> Export:
    """Return the source file and its header, which declares what is ``inside``; without a name, one file."""
    guard = f"{prefix_of(name).upper()}_H"
    opening = [*COMMENT.lines(introduction), f"#ifndef {guard}", f"#define {guard}", "", *included]
    opening += ["#ifdef __cplusplus", 'extern "C" {', "#endif", ""]
    closing = ["#ifdef __cplusplus", "}", "#endif", "", "#endif"]
    header = "\n".join([*opening, *inside, *closing]) + "\n"
    if name is None:
        return Export(f"{header}\n{source}")
    (first,) = COMMENT.lines([f"{name}.c: the functions that {name}.h declares."])
    return Export(f'{first}\n\n#include "{name}.h"\n\n{source}', companions={".h": header})


INCLUDED = (
    "#include <stddef.h>",
    "#if !defined(__cplusplus) && !defined(__STDC_NO_COMPLEX__)",
    "#include <complex.h>",
    "#endif",
    "",
)


class _Files:
    def __init__(self, contents: Contents, name: str | None) -> None:
        self.model = contents.model
        self.name = name
        self.prefix = prefix_of(name)
        self.structure = f"{self.prefix}_parameters"
        self.members = identifiers({p.name: p.name for p in self.model.parameters}, RESERVED)
        self.of_s = {m.tf.name: m for m in contents.members if not m.is_response}
        responses = (m for m in contents.members if m.is_response)
        self.on_axis = {m.tf.name: m for m in responses if fits_lanes(m.program)}
        self.functions: dict[str, Functions] = {}
        taken: set[str] = set()
        # Identifiers stay different with ``_freq`` behind some of them.
        for key, identifier in identifiers({k: m.wanted for k, m in self.of_s.items()}, RESERVED).items():
            free = (identifier + "_" * n for n in count())
            own_name = next(n for n in free if taken.isdisjoint((n, f"{n}_freq")))
            taken |= {own_name, f"{own_name}_freq"}
            arguments = (own_name, self.prefix, self.structure, self.members, self.of_s[key].program)
            axis = self.on_axis[key].program if key in self.on_axis else None
            self.functions[key] = Functions(*arguments, axis)
        self.matrix = contents.matrix
        free = (f"{self.prefix}_{MATRIX}" + "_" * n for n in count())
        self.whole = next(n for n in free if n.removeprefix(f"{self.prefix}_") not in taken)

    def made(self) -> Export:
        declared = []
        for key, functions in self.functions.items():
            declared += [*COMMENT.lines(self._described(key)), f"{functions.freq_prototype};", ""]
        with_complex = [
            "#if !defined(__cplusplus) && !defined(__STDC_NO_COMPLEX__)",
            *COMMENT.lines(["Values at any complex s [rad/s]."]),
            *(f"{functions.value_prototype};" for functions in self.functions.values()),
            "#endif",
            "",
        ]
        if self.matrix is not None:
            declared += [*COMMENT.lines(self._said_of_matrix(self.matrix)), f"{self._matrix_head()};", ""]
        inside = [*self._parameters(), *declared, *with_complex]
        return source_and_header(self.name, self._introduction(), INCLUDED, inside, self._source())

    # ---------------------------------------------------------------------------------------- the header

    def _introduction(self) -> list[str]:
        files = f"{self.name}.h" if self.name else "C99"
        public = [f"{self.prefix}_{f.name}" for f in self.functions.values()]
        example = public[0] if public and len(public[0]) < WIDTH // 2 else f"{self.prefix}_OUT_over_IN"
        paragraphs = [
            f"Written by symflex. For every transfer function OUT/IN there are {example}(s, p), its value at "
            f"the Laplace variable s, and {example}_freq(omega, real, imag, n, p), which writes the real and "
            "imaginary parts of the values at s = j omega[i] for all i < n. omega is an angular frequency "
            "[rad/s]: 2 pi times the frequency in Hz. It may be negative. One of real and imag may be the "
            "array omega.",
            "Nothing is allocated and nothing is kept between calls: all functions are reentrant. Values at "
            "poles are not finite. Parameters are real numbers in SI units; p may be "
            f"&{self.prefix}_defaults, or point to a changed copy of it. Functions in band form ignore p. "
            "Link with the mathematical library, and compile without -ffast-math.",
            "Errors named below were measured with these operations in IEEE double precision; the library's "
            "own errors in exp, sin and similar functions come in addition.",
        ]
        return OUTLINE.heading(f"{files}: transfer functions of a linear system.", self.model, paragraphs)

    def _parameters(self) -> list[str]:
        lines = [*COMMENT.lines(["Parameters, in SI units."]), f"typedef struct {self.structure} {{"]
        for parameter in self.model.parameters:
            member = self.members[parameter.name]
            words = [inert(parameter.doc).rstrip(".")] if parameter.doc.strip() else []
            words += [f"'{inert(parameter.name)}' in the model"] if member != parameter.name else []
            words += [] if default_value(parameter) else ["no value in the model"]
            unit = f"[{inert(parameter.unit)}]" if parameter.unit else ""
            text = " ".join(x for x in (", ".join(words), unit) if x)
            declaration = f"    double {member};"
            if not text:
                lines.append(declaration)
            elif len(one := f"{declaration:<24}/* {COMMENT.harmless(text)} */") <= WIDTH:
                lines.append(one)
            else:
                lines += [f"    {line}" for line in COMMENT.lines(wrapped(text, WIDTH - 7))]
                lines.append(declaration)
        if not self.model.parameters:
            lines.append("    char none;    /* C has no empty structures */")
        missing = [p for p in self.model.parameters if not default_value(p)]
        what = "The values of the model" + ("; those it does not have are NAN." if missing else ".")
        return [
            *lines,
            f"}} {self.structure};",
            "",
            *COMMENT.lines([what]),
            f"extern const {self.structure} {self.prefix}_defaults;",
            "",
        ]

    def _described(self, key: str) -> list[str]:
        member = self.of_s[key]
        said = member.verification.text()
        sentences = [f"At s = j omega, {said}."]
        if key in self.on_axis:
            real = self.on_axis[key].verification.text()
            sentences = [f"Of s, {said}.", f"At s = j omega, in real arithmetic, {real}."]
        lines = OUTLINE.about(member)
        for sentence in sentences:
            lines += wrapped(inert(sentence), OUTLINE.room)
        return lines

    def _said_of_matrix(self, matrix: MatrixMember) -> list[str]:
        rows, columns = matrix.shape
        what = (
            f"At s = j omega[i] for all i < n. Entry (j, k) stands at ({columns} j + k) n + i of real and "
            f"imag, which have room for {rows * columns} n numbers; neither may be omega."
        )
        said = OUTLINE.verified(matrix, ".") if self._is_shared(matrix) else []
        return [matrix.headline, "", *wrapped(what, OUTLINE.room), *said]

    def _is_shared(self, matrix: MatrixMember) -> bool:
        return matrix.program is not None and is_rational_in_lanes(matrix.program)

    def _matrix_head(self) -> str:
        given = "const double *omega, double *real, double *imag, size_t n"
        opening = f"void {self.whole}_freq("
        return f"{opening}{given},\n{' ' * len(opening)}const {self.structure} *p)"

    def _matrix(self, matrix: MatrixMember) -> str:
        """Return the function of all entries, which calls those of single entries, or its own."""
        lines = [self._matrix_head(), "{"]
        if matrix.program is not None and self._is_shared(matrix):
            return "\n".join([*lines, *entries_in_lanes(matrix.program, self.members), "}", ""])
        for k, member in enumerate(matrix.each):
            own, at = self.functions[member.tf.name], f" + {k} * n" if k else ""
            lines.append(f"    {self.prefix}_{own.name}_freq(omega, real{at}, imag{at}, n, p);")
        return "\n".join([*lines, "}", ""])

    # ---------------------------------------------------------------------------------------- the source

    def _source(self) -> str:
        printed = {key: functions.text() for key, functions in self.functions.items()}
        # Comments tell nothing about which functions are called.
        order = max((f.order for f in self.functions.values()), default=1)
        whole = "" if self.matrix is None else self._matrix(self.matrix)
        below = helpers("\n".join([*printed.values(), whole]), self.structure, order)
        code = "\n".join("\n".join([*COMMENT.lines([inert(key)]), "", text]) for key, text in printed.items())
        signs = {"float": "FLT_EVAL_METHOD", "math": "", "stdint": "uint64_t", "string": "memcpy("}
        includes = "".join(f"#include <{name}.h>\n" for name, sign in signs.items() if sign in below)
        parts = [includes, self._defaults(), below, code]
        return "\n".join(part for part in [*parts, whole] if part)

    def _defaults(self) -> str:
        lines = [f"const {self.structure} {self.prefix}_defaults = {{"]
        for parameter in self.model.parameters:
            entry = f"    .{self.members[parameter.name]} = {default_value(parameter) or 'NAN'},"
            written = value_as_written(parameter)
            lines.append(f"{entry} /* {COMMENT.harmless(inert(written))} */" if written else entry)
        if not self.model.parameters:
            lines.append("    0")
        return "\n".join([*lines, "};"]) + "\n"


def helpers(code: str, parameters: str, order: int) -> str:
    """Return what some code calls: of a type of ``parameters``, and equations of at most an ``order``."""
    always, others = ["cx"], ""
    if re.search(r"\bLANES\b", code):
        called = [f for f in LANE_FUNCTIONS if re.search(rf"\blane_{f}\(", code)]
        always += ["ROUNDER", "OTHERWISE"] if called else ["LANES"]
        others = "".join(f"#define lane_{f} {f}\n" for f in called)
    text = "\n".join(called_parts(code, PARTS, always)).replace("OTHERWISE\n", others)
    return text.replace("PARAMETERS", parameters).replace("CX_ORDER", str(max(order, 1)))


C99 = Language(
    ".c",
    "C99 source and header, values at s and arrays of frequencies, verified likewise",
    c_files,
    has_real=True,
    shares=True,
)
