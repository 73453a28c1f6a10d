"""What the playground loads, packed such that it starts sooner."""

import importlib.util
import io
import runpy
import zipfile

import pytest

from tests.house.repository import ROOT


@pytest.fixture(scope="module")
def packing():
    spec = importlib.util.spec_from_file_location("packing", ROOT / "docs" / "hooks" / "packing.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def section(kind, *entries):
    content = bytes([len(entries)]) + b"".join(entries)
    return bytes([kind, len(content)]) + content


def name(text):
    return bytes([len(text)]) + text


# By hand from the specification of WebAssembly: sections 1, 2, 3, 7 and 10 of a module with one type, that of
# functions from nothing to nothing, imports of every kind, and two functions without a body.
START = b"\0asm\1\0\0\0" + section(1, b"\x60\0\0")
IMPORTS = section(
    2,
    name(b"env") + name(b"called") + b"\0\0",
    name(b"env") + name(b"table") + b"\1\x70\0\x81\1",  # at least 129 references to functions
    name(b"env") + name(b"memory") + b"\2\1\1\2",  # one to two pages
    name(b"env") + name(b"base") + b"\3\x7f\0",
    name(b"env") + name(b"thrown") + b"\4\0\0",
    name(b"GOT.func") + name(b"pointed_at") + b"\3\x7f\1",
)
FUNCTIONS = section(3, b"\0", b"\0")
CODE = section(10, b"\2\0\x0b", b"\2\0\x0b")


def exports(*names):
    return section(7, *(name(n) + b"\0\1" for n in names))


def test_imports_of_every_kind_are_found(packing):
    found = list(packing.imports(START + IMPORTS + FUNCTIONS))
    assert found == [b"called", b"table", b"memory", b"base", b"thrown", b"pointed_at"]


def test_exports_that_nobody_imports_are_left_out_and_all_else_stays(packing):
    module = START + IMPORTS + FUNCTIONS
    given = module + exports(b"__wasm_call_ctors", b"PyInit_fmpz", b"unused", b"pointed_at") + CODE
    expected = module + exports(b"__wasm_call_ctors", b"PyInit_fmpz", b"pointed_at") + CODE
    assert packing.trimmed(given, {b"pointed_at"}) == expected
    assert packing.trimmed(b"a text", set()) == b"a text"


def test_archives_hold_compiled_code_of_what_was_imported_and_sources_of_the_rest(packing, tmp_path):
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w") as made:
        made.writestr("used.py", "answer = 42\n")
        made.writestr("other.py", "answer = 43\n")
        made.writestr("other.pyi", "answer: int\n")
        made.writestr("user.so", START + IMPORTS)
        made.writestr("lib.so", START + FUNCTIONS + exports(b"called", b"unused"))
    packed = packing.packed({"a.zip": archive.getvalue()}, {"used.py"})["a.zip"]
    with zipfile.ZipFile(io.BytesIO(packed)) as new:
        assert new.namelist() == ["used.pyc", "other.py", "user.so", "lib.so"]
        assert new.read("other.py") == b"answer = 43\n"
        assert new.read("lib.so") == START + FUNCTIONS + exports(b"called")
        code = new.read("used.pyc")
    assert code[:8] == importlib.util.MAGIC_NUMBER + b"\1\0\0\0"  # valid whatever the source (PEP 552)
    (tmp_path / "used.pyc").write_bytes(code)
    assert runpy.run_path(tmp_path / "used.pyc")["answer"] == 42
