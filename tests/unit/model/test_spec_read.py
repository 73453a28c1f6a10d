"""Files that are no specification are refused without hanging."""

from __future__ import annotations

import os
import socket
from pathlib import Path

import pytest

from symflex.errors import Diagnostic, SpecError, SymflexError, UsageError
from symflex.model.spec import read


def refusal(path: str | Path) -> Diagnostic:
    with pytest.raises(SymflexError) as raised:
        read(path)
    assert raised.value.diagnostics[0].code == "SF901"
    return raised.value.diagnostics[0]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "a.toml"


def test_a_text_is_read_with_its_line_ends_without_a_byte_order_mark_and_through_a_link(path: Path) -> None:
    path.with_name("link.toml").symlink_to(path)
    for data, text in [("é = 1\r\n".encode(), "é = 1\r\n"), (b"\xef\xbb\xbfa = 1", "a = 1")]:
        path.write_bytes(data)
        assert (read(path).text, read(path).name) == (text, str(path))
        assert read(path.with_name("link.toml")).text == text


def test_bytes_that_are_not_utf8_are_named_with_their_place(path: Path) -> None:
    path.write_bytes("é = 1\nb = ".encode() + b"\xe9\n")
    problem = refusal(path)
    assert problem.message == "not UTF-8: byte 0xe9 at byte offset 11"
    assert problem.span is not None
    assert (problem.span.line, problem.span.column) == (2, 5)
    with pytest.raises(SpecError):
        read(path)


def test_utf16_is_recognised(path: Path) -> None:
    path.write_bytes("a = 1\n".encode("utf-16"))
    assert refusal(path).hint == "this is UTF-16; save the file as UTF-8"


def test_a_file_of_one_megabyte_is_read_and_a_larger_one_refused(path: Path) -> None:
    path.write_bytes(b"#" * 1_000_000)
    assert len(read(path).text) == 1_000_000
    path.write_bytes(b"#" * 1_000_001)
    assert "larger than 1000000 bytes" in refusal(path).message
    os.truncate(path, 1 << 40)  # larger than memory
    assert "larger than" in refusal(path).message


def test_a_missing_file_is_a_usage_error(path: Path) -> None:
    with pytest.raises(UsageError, match="No such file"):
        read(path)


def test_a_directory_is_refused(tmp_path: Path) -> None:
    assert "not a regular file" in refusal(tmp_path).message


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no FIFOs here")
def test_a_fifo_is_refused_without_waiting_for_a_writer(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "fifo")
    assert "not a regular file" in refusal(tmp_path / "fifo").message


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="no devices here")
def test_a_device_is_refused() -> None:
    assert "not a regular file" in refusal("/dev/zero").message


@pytest.mark.skipif(not hasattr(socket, "AF_UNIX"), reason="no sockets here")
def test_a_socket_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with socket.socket(socket.AF_UNIX) as server:
        server.bind("s")
        assert "not a regular file" in refusal("s").message


def test_a_name_no_file_can_have_is_refused() -> None:
    assert "file names cannot have" in refusal("a\0b").message


def test_a_loop_of_links_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a").symlink_to("a")
    assert "cannot read" in refusal(tmp_path / "a").message


def test_a_missing_file_has_a_hint_to_one_of_nearly_its_name(path: Path) -> None:
    path.with_name("quarter_cars.toml").touch()
    assert refusal(path.with_name("quarter_crs.toml")).hint == "did you mean 'quarter_cars.toml'?"
    assert "symflex new" in str(refusal(path.with_name("nothing.toml")).hint)
    # Without a suffix the whole names are compared, and the hint is a name that is there.
    assert refusal(path.with_name("quarter_cars")).hint == "did you mean 'quarter_cars.toml'?"
    path.with_name("broken.toml").touch()
    assert refusal(path.with_name("bode")).hint is None


def test_measured_data_are_named_as_data_for_fit_in_one_line(path: Path) -> None:
    for name, data in (
        ("a.csv", b"f,re,im\n1,2,3\n"),
        ("a.mat", b"MATLAB\xff\0" * 300_000),
        ("a.txt", b"* measured\r\n1.0\t-2,5\r\n2.0\t-3,5\r\n"),
    ):
        path.with_name(name).write_bytes(data)
        problem = refusal(path.with_name(name))
        assert problem.message.endswith(
            f"is measured data, not a specification: symflex fit {path.with_name(name)}"
        )
        assert problem.hint is None
    path.write_text("symflex = 1\nx = [\n1.0, 2.0,\n3.0, 4.0]\n")
    assert read(path).text
