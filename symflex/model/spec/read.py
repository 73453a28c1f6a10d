"""Read a file of hostile kind: never hang on it, never hold more of it than the limit."""

from __future__ import annotations

import os
import re
import stat
from pathlib import Path
from typing import Final

from symflex.errors import Diagnostic, Source, Span, SpecError, UsageError, nearest

DATA: Final = (
    ".csv", ".tsv", ".frd", ".zma", ".s1p", ".s2p", ".uff", ".unv", ".npz", ".npy", ".mat", ".h5", ".hdf5",
    ".tdms", ".xlsx", ".lvm",
)  # fmt: skip
"""Ends of the names of files that contain measured data and never a specification."""
NETLISTS: Final = (".cir", ".net", ".sp", ".ckt")  # ends of names of SPICE netlists, which are read too
_NUMBERS = re.compile(rb"^[-+\d.][-+\d.e]*[\t ,;]+[-+\d.][-+\d.e \t,;]*\r?\n[-+\d.]", re.M | re.I)
"""Two lines of numbers, as in a table."""
_UTF16_MARKS = (b"\xff\xfe", b"\xfe\xff")


def read(path: str | Path) -> Source:
    """Read a specification's text without byte order mark; SF901 unless a UTF-8 file of at most 1 MB."""
    name = os.fspath(path)
    data = read_file(name, MAX_BYTES)
    if name.lower().endswith(DATA) or (_NUMBERS.search(data) and b"symflex" not in data):
        raise SpecError(
            Diagnostic("SF901", f"'{name}' is measured data, not a specification: symflex fit {name}")
        )
    if len(data) > MAX_BYTES:
        message = f"'{name}' is larger than {MAX_BYTES} bytes"
        raise SpecError(Diagnostic("SF901", message, hint="is this the right file?"))
    if name.lower().endswith(NETLISTS):
        from symflex.model.spec.netlist import specification_of  # few specifications are netlists

        return specification_of(Source(name, _decoded(data)), lambda other: _beside(name, other))
    try:
        return Source(name, data.decode("utf-8").removeprefix("\ufeff"))
    except UnicodeDecodeError as error:
        raise SpecError(_not_utf8(name, data, error.start)) from None


def _decoded(data: bytes) -> str:
    """Return the text of a netlist, in the encodings in which LTspice has saved them."""
    if data.startswith(_UTF16_MARKS):
        return data.decode("utf-16", "replace")
    if data[1:2] == b"\0":
        return data.decode("utf-16-le", "replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def _beside(netlist: str, other: str) -> Source:
    """Return a file that a netlist includes. Raises SpecError: SF258 outside of its folder."""
    folder = os.path.realpath(os.path.dirname(netlist) or ".")
    path = os.path.realpath(os.path.join(folder, other))
    if os.path.commonpath([folder, path]) != folder:
        raise SpecError(Diagnostic("SF258", "it is outside of the folder of the netlist"))
    try:
        data = read_bytes(path, MAX_BYTES)
    except (OSError, ValueError, UsageError):
        raise SpecError(Diagnostic("SF901", "it cannot be read")) from None
    return Source(other, _decoded(data[:MAX_BYTES]))


def read_file(name: str, limit: int) -> bytes:
    """Return the bytes of a file as :func:`read_bytes`; SF901 when it cannot be opened."""
    try:
        return read_bytes(name, limit)
    except OSError as error:
        raise _unreadable(name, error.strerror or "input/output error", _meant(name)) from None
    except ValueError:
        raise _unreadable(name, "the name contains a character that file names cannot have") from None


def read_bytes(name: str, limit: int) -> bytes:
    """Return the bytes of a regular file (SF901 else), and of a larger one a byte more than the limit."""
    # O_NONBLOCK: a FIFO that takes the file's place after the first look must not hang the open.
    if not stat.S_ISREG(os.stat(name).st_mode):
        raise _unreadable(name, "not a regular file")
    flags = os.O_RDONLY
    for name_of_flag in ("O_NONBLOCK", "O_CLOEXEC", "O_BINARY"):
        flags |= getattr(os, name_of_flag, 0)
    with open(os.open(name, flags), "rb") as file:
        if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
            raise _unreadable(name, "not a regular file")
        return file.read(limit + 1)


def _unreadable(name: str, reason: str, hint: str | None = None) -> UsageError:
    return UsageError(Diagnostic("SF901", f"cannot read '{name}': {reason}", None, hint))


def _meant(name: str) -> str | None:
    """Return a hint to the example of this name, to a file beside it with nearly this name, or to a start."""
    from symflex.files.examples import example_of  # most files are there

    if name == "-":
        return "a file's name is needed: standard input is not read"
    if example := example_of(name):
        return f"'symflex examples copy {example}' writes a model of this name"
    folder, file_name = os.path.split(name)
    stem, suffix = os.path.splitext(file_name)
    try:
        beside = sorted(f for f in os.listdir(folder or ".") if f.endswith(suffix) and f != file_name)[
            :MOST_FILES
        ]
    except OSError:
        return None
    if meant := nearest(stem, [f.removesuffix(suffix) for f in beside]):
        return f"{meant[:-2]}{suffix}'?"
    start = "'symflex new' writes a specification to start from, 'symflex examples' lists models to copy"
    return start if suffix == ".toml" else None


def _not_utf8(name: str, data: bytes, offset: int) -> Diagnostic:
    source = Source(name, data.decode("utf-8", "replace"))
    start = len(data[:offset].decode("utf-8"))
    message = f"not UTF-8: byte 0x{data[offset]:02x} at byte offset {offset}"
    utf16 = data.startswith(_UTF16_MARKS)
    hint = "this is UTF-16; save the file as UTF-8" if utf16 else "a specification is text in UTF-8"
    return Diagnostic("SF901", message, Span(source, start, start + 1), hint)


MAX_BYTES: Final = 1_000_000
MOST_FILES: Final = 500  # of a folder, among which a file of nearly the name is sought
MAX_NESTING: Final = 32
MAX_LEVELS: Final = 64
MAX_ENTRIES: Final = 20_000
MAX_KEY_PARTS: Final = 16
MAX_LITERAL: Final = 400
MAX_EXPONENT: Final = 400
MAX_ERRORS: Final = 20

_SHOWN_DIGITS = 20

_NUMBER = re.compile(r"[+-]?\.?[0-9][0-9A-Za-z_.+\-]*+")
_EXPONENT = re.compile(r"[+-]?[0-9][0-9_]*+(?:\.[0-9_]*+)?[eE]([+-]?[0-9_]++)")


def number_problem(literal: str) -> str | None:
    """Say why a number is refused, or ``None`` when it is not (or is not a number).

    >>> number_problem("1e999999999")
    'exponent 999999999; exponents go from -400 to 400'
    >>> number_problem("1e400") is None
    True
    """
    if len(literal) > MAX_LITERAL:
        if _NUMBER.fullmatch(literal):
            return f"number of {len(literal)} characters; at most {MAX_LITERAL} are allowed"
        return None
    match = _EXPONENT.fullmatch(literal)
    if match is None:
        return None
    digits = match[1].replace("_", "")
    if not digits.lstrip("+-") or abs(int(digits)) <= MAX_EXPONENT:
        return None
    shown = digits if len(digits) <= _SHOWN_DIGITS else f"{digits[:_SHOWN_DIGITS]}..."
    return f"exponent {shown}; exponents go from -{MAX_EXPONENT} to {MAX_EXPONENT}"
