"""Archives that a browser starts from sooner, with the same program in them.

Input: archives by name, and names of the sources that were imported to answer a first model. Output: the
archives, with these sources compiled, and without exports of libraries that no module beside them imports:
Pyodide links by going through all exports of a library for each of the modules that use it.

``pack.mjs`` runs this in Pyodide, as a version of Python reads what it compiled itself. Stages:

1. :func:`packed` goes through the files of each archive.
2. :func:`compiled` turns a source into what Python writes beside it, valid whatever the time of the source.
3. :func:`trimmed` shortens the section of exports of a module of WebAssembly.
"""

from __future__ import annotations

import importlib.util
import io
import marshal
import zipfile
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping

MOMENT: Final = (1980, 1, 1, 0, 0, 0)
"""The date of all files in an archive, so that the same sources make the same bytes."""
NOT_RUN: Final = (".pyi", ".pxd", ".pyx")
UNCHECKED: Final = (1).to_bytes(4, "little")
"""Flags of compiled code whose source is not looked for."""
HEADER: Final = 8  # bytes before the first section of a module
IMPORTS, EXPORTS = 2, 7
LINKED: Final = (b"__wasm_", b"PyInit_")
"""How names begin that Pyodide and Python ask a module for."""
FUNCTION, TABLE, MEMORY, GLOBAL, TAG = range(5)


def packed(archives: Mapping[str, bytes], imported: Collection[str]) -> dict[str, bytes]:
    """Return the archives, packed anew."""
    return {name: _packed(zipfile.ZipFile(io.BytesIO(data)), imported) for name, data in archives.items()}


def _packed(old: zipfile.ZipFile, imported: Collection[str]) -> bytes:
    files = {name: old.read(name) for name in old.namelist() if not name.endswith((*NOT_RUN, "/"))}
    needed = {name for data in files.values() if data[:4] == b"\0asm" for name in imports(data)}
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as new:
        for name, data in files.items():
            is_compiled = name in imported and name.endswith(".py")
            entry = zipfile.ZipInfo(name + "c" * is_compiled, MOMENT)
            entry.compress_type = zipfile.ZIP_DEFLATED
            new.writestr(entry, compiled(data, name) if is_compiled else trimmed(data, needed))
    return out.getvalue()


def compiled(source: bytes, name: str) -> bytes:
    """Return what Python imports instead of a source."""
    code = compile(source, name, "exec", dont_inherit=True)
    checked = importlib.util.source_hash(source)
    return importlib.util.MAGIC_NUMBER + UNCHECKED + checked + marshal.dumps(code)


def trimmed(module: bytes, needed: Collection[bytes]) -> bytes:
    """Return a module of WebAssembly without exports that nobody needs; other files as they are."""
    if module[:4] != b"\0asm":
        return module
    out = bytearray(module[:HEADER])
    for kind, start, content, end in _sections(module):
        if kind == EXPORTS:
            kept = [e for name, e in _exports(module, content) if name in needed or name.startswith(LINKED)]
            body = _encoded(len(kept)) + b"".join(kept)
            out += bytes([kind]) + _encoded(len(body)) + body
        else:
            out += module[start:end]
    return bytes(out)


def imports(module: bytes) -> Iterator[bytes]:
    """Yield the names that a module of WebAssembly imports."""
    for kind, _, content, _ in _sections(module):
        if kind == IMPORTS:
            count, i = _number(module, content)
            for _ in range(count):
                _, i = _name(module, i)
                name, i = _name(module, i)
                i = _after_type(module, i)
                yield name


def _sections(module: bytes) -> Iterator[tuple[int, int, int, int]]:
    """Yield kind, start, start of the content and end of each section."""
    i = HEADER
    while i < len(module):
        size, content = _number(module, i + 1)
        yield module[i], i, content, content + size
        i = content + size


def _exports(module: bytes, i: int) -> Iterator[tuple[bytes, bytes]]:
    """Yield names of exports, and the bytes of each."""
    count, i = _number(module, i)
    for _ in range(count):
        start = i
        name, i = _name(module, i)
        _, i = _number(module, i + 1)
        yield name, module[start:i]


def _after_type(module: bytes, i: int) -> int:
    """Return where the description of an import ends."""
    kind, i = module[i], i + 1
    if kind == GLOBAL:
        return i + 2
    if kind in {FUNCTION, TAG}:
        return _number(module, i + (kind == TAG))[1]
    i += kind == TABLE
    has_maximum = module[i] & 1
    _, i = _number(module, i + 1)
    return _number(module, i)[1] if has_maximum else i


def _name(module: bytes, i: int) -> tuple[bytes, int]:
    size, i = _number(module, i)
    return module[i : i + size], i + size


def _number(module: bytes, i: int) -> tuple[int, int]:
    """Return a number of variable length (LEB128), and where it ends."""
    value = shift = 0
    while module[i] & 0x80:
        value |= (module[i] & 0x7F) << shift
        shift, i = shift + 7, i + 1
    return value | module[i] << shift, i + 1


def _encoded(value: int) -> bytes:
    out = bytearray()
    while value > 0x7F:  # noqa: PLR2004 (seven bits a byte)
        out.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes([*out, value])
