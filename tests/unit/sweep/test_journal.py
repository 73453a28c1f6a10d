"""Journals that were damaged, and outputs that two processes want."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

from symflex.errors import SymflexError, UsageError
from symflex.files.lock import held
from symflex.sweep.files import MAGIC, archive, open_journal, read_sweep
from tests.unit.refusals import refusal

ROWS = {"point_status": np.zeros(1, np.int32), "re": np.ones((1, 2))}


def journal_in(folder):
    """Return a journal of one chunk, of a sweep to ``a.nc``."""
    folder.mkdir(exist_ok=True)
    opened = open_journal(folder / "a.nc", "key")
    opened.write(0, ROWS)
    return opened


@pytest.fixture
def journal(tmp_path):
    return journal_in(tmp_path)


def test_a_chunk_is_read_as_it_was_written(journal):
    assert {k: v.tolist() for k, v in journal.read(0).items()} == {k: v.tolist() for k, v in ROWS.items()}


def test_a_chunk_with_a_flipped_bit_is_not_read(journal):
    path = journal.folder / "chunk-000000.npz"
    data = path.read_bytes()
    for place in range(0, len(data), 7):
        path.write_bytes(data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :])
        assert journal.read(0) is None


CHUNKS = {
    "other values": lambda path: path.write_bytes(path.read_bytes()[:-100] + b"\0" * 100),
    "without a checksum": lambda path: path.write_bytes(archive(ROWS)),
    "with a checksum of zeros": lambda path: path.write_bytes(MAGIC + bytes(32) + archive(ROWS)),
    "of another number": lambda path: path.rename(path.with_name("chunk-000001.npz")),
    "empty": lambda path: path.write_bytes(b""),
    "only its head": lambda path: path.write_bytes(path.read_bytes()[:48]),
    "twice": lambda path: path.write_bytes(path.read_bytes() * 2),
    "a folder": lambda path: (path.unlink(), path.mkdir()),
    "a pipe": lambda path: (path.unlink(), os.mkfifo(path)),
    "a link to nothing": lambda path: (path.unlink(), path.symlink_to("nothing")),
    "a link in a circle": lambda path: (path.unlink(), path.symlink_to(path)),
    "a link to a device": lambda path: (path.unlink(), path.symlink_to("/dev/zero")),
}


def test_a_damaged_chunk_is_not_read(tmp_path):
    for name, damage in CHUNKS.items():
        journal = journal_in(tmp_path / name)
        damage(journal.folder / "chunk-000000.npz")
        assert journal.read(0) is None, name
        assert journal.read(1) is None, name


def test_a_chunk_of_another_sweep_is_not_read(tmp_path, journal):
    other = open_journal(tmp_path / "b.nc", "other")
    (other.folder / "chunk-000000.npz").write_bytes((journal.folder / "chunk-000000.npz").read_bytes())
    assert other.read(0) is None


ABOUTS = {
    "nothing": b"",
    "no JSON": b"\xff{",
    "deeply nested": b"[" * 100_000,
    "a list": b"[]",
    "another schema": json.dumps({"schema": "x", "key": "key"}).encode(),
    "a key that is none": json.dumps({"schema": "symflex.sweep.journal/1", "key": [1]}).encode(),
    "very long": b" " * 1_000_000 + b"{}",
}


NO_FILES = {
    "a pipe": os.mkfifo,
    "a folder": os.mkdir,
    "a link in a circle": lambda path: os.symlink(path, path),
    "a link to a device": lambda path: os.symlink("/dev/zero", path),
    "a link to a file": lambda path: os.symlink("/etc/passwd", path),
}


def test_a_journal_whose_owner_cannot_be_read_is_refused(tmp_path, journal):
    owner = journal.folder / "sweep.json"
    for name, content in ABOUTS.items():
        owner.write_bytes(content)
        assert refusal(open_journal, tmp_path / "a.nc", "key") == "UsageError SF916", name


def test_a_journal_whose_owner_is_no_file_is_refused(tmp_path):
    for name, make in NO_FILES.items():
        owner = journal_in(tmp_path / name).folder / "sweep.json"
        owner.unlink()
        make(owner)
        assert refusal(open_journal, tmp_path / name / "a.nc", "key") == "UsageError SF916", name


def test_a_folder_among_what_is_left_is_refused(tmp_path, journal):
    (journal.folder / ".symflex-0.tmp").mkdir()
    with pytest.raises(SymflexError, match="SF903"):
        open_journal(tmp_path / "a.nc", "key")


def test_a_kill_while_a_journal_is_removed_leaves_a_journal(tmp_path, journal, monkeypatch):
    def killed(path):
        raise KeyboardInterrupt

    journal.write(1, ROWS)
    monkeypatch.setattr("shutil.rmtree", killed)
    with pytest.raises(KeyboardInterrupt):
        journal.remove()
    monkeypatch.undo()
    assert open_journal(tmp_path / "a.nc", "key").kept == 0


def test_who_holds_an_output_is_said(tmp_path):
    with held(tmp_path / "a.nc"), pytest.raises(UsageError, match="SF919") as raised, held(tmp_path / "a.nc"):
        pass
    assert f"process {os.getpid()}" in str(raised.value)


def test_what_held_an_output_is_gone_afterwards(tmp_path):
    with held(tmp_path / "a.nc"):
        assert os.listdir(tmp_path) == ["a.nc.lock"]
    assert os.listdir(tmp_path) == []


def test_the_lock_of_a_process_that_was_killed_holds_nothing(tmp_path):
    script = (
        "import os, signal, sys; from pathlib import Path; from symflex.files.lock import held\n"
        "with held(Path(sys.argv[1])): os.kill(os.getpid(), signal.SIGKILL)"
    )
    done = subprocess.run([sys.executable, "-c", script, str(tmp_path / "a.nc")], check=False)
    assert done.returncode < 0
    assert os.listdir(tmp_path) == ["a.nc.lock"]
    with held(tmp_path / "a.nc"):
        pass
    assert os.listdir(tmp_path) == []


def test_a_file_that_is_no_lock_is_left_alone(tmp_path):
    (tmp_path / "a.nc.lock").write_text("mine")
    with pytest.raises(UsageError, match="SF903"), held(tmp_path / "a.nc"):
        pass
    assert (tmp_path / "a.nc.lock").read_text() == "mine"


def test_a_lock_that_is_no_file_is_refused(tmp_path):
    for name, make in NO_FILES.items():
        make(tmp_path / f"{name}.lock")
        assert refusal(held(tmp_path / name).__enter__) == "UsageError SF903", name


HEADERS = {
    "deeply nested": "[" * 50_000,
    "a list": "[]",
    "no arrays": "{}",
    "arrays that are none": '{"arrays": [1], "attributes": {}, "coordinates": []}',
    "an array that is missing": '{"arrays": {"x": {"dims": [], "unit": "", "doc": ""}}}',
}


def test_an_archive_with_a_false_header_holds_no_sweep(tmp_path):
    for name, header in HEADERS.items():
        (tmp_path / "a.npz").write_bytes(archive({"header": np.array(header)}))
        assert refusal(read_sweep, tmp_path / "a.npz").endswith(" SF915"), name


def test_what_is_no_file_holds_no_sweep(tmp_path):
    for name in ("a pipe", "a folder", "a link to a device"):
        NO_FILES[name](tmp_path / f"{name}.npz")
        assert refusal(read_sweep, tmp_path / f"{name}.npz") == "UsageError SF901", name
