"""Journals that were damaged, and outputs that two processes want."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import numpy as np
import pytest

from symflex.errors import SymflexError, UsageError
from symflex.files.lock import held
from symflex.sweep.files import MAGIC, archive, npz_bytes, open_journal, read_sweep
from symflex.sweep.run import run_sweep
from tests.unit.sweep.test_run import task_and_design

ROWS = {"point_status": np.zeros(1, np.int32), "re": np.ones((1, 2))}


@pytest.fixture
def journal(tmp_path):
    """A journal of one chunk."""
    opened = open_journal(tmp_path / "a.nc", "key")
    opened.write(0, ROWS)
    return opened


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


@pytest.mark.parametrize("damage", CHUNKS.values(), ids=CHUNKS)
def test_a_damaged_chunk_is_not_read(journal, damage):
    damage(journal.folder / "chunk-000000.npz")
    assert journal.read(0) is None
    assert journal.read(1) is None


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


@pytest.mark.parametrize("content", ABOUTS.values(), ids=ABOUTS)
def test_a_journal_whose_owner_cannot_be_read_is_refused(tmp_path, journal, content):
    (journal.folder / "sweep.json").write_bytes(content)
    with pytest.raises(UsageError, match="SF916"):
        open_journal(tmp_path / "a.nc", "key")


@pytest.mark.parametrize("make", [os.mkfifo, os.mkdir, lambda path: os.symlink(path, path)])
def test_a_journal_whose_owner_is_no_file_is_refused(tmp_path, journal, make):
    (journal.folder / "sweep.json").unlink()
    make(journal.folder / "sweep.json")
    with pytest.raises(UsageError, match="SF916"):
        open_journal(tmp_path / "a.nc", "key")


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


@pytest.mark.parametrize("make", [os.mkfifo, os.mkdir, lambda path: os.symlink("/etc/passwd", path)])
def test_a_lock_that_is_no_file_is_refused(tmp_path, make):
    make(tmp_path / "a.nc.lock")
    with pytest.raises(UsageError, match="SF903"), held(tmp_path / "a.nc"):
        pass


HEADERS = {
    "deeply nested": "[" * 50_000,
    "a list": "[]",
    "no arrays": "{}",
    "arrays that are none": '{"arrays": [1], "attributes": {}, "coordinates": []}',
    "an array that is missing": '{"arrays": {"x": {"dims": [], "unit": "", "doc": ""}}}',
}


@pytest.mark.parametrize("header", HEADERS.values(), ids=HEADERS)
def test_an_archive_with_a_false_header_holds_no_sweep(tmp_path, header):
    (tmp_path / "a.npz").write_bytes(archive({"header": np.array(header)}))
    with pytest.raises(SymflexError, match="SF915"):
        read_sweep(tmp_path / "a.npz")


@pytest.mark.parametrize("make", [os.mkfifo, os.mkdir, lambda path: os.symlink("/dev/zero", path)])
def test_what_is_no_file_holds_no_sweep(tmp_path, make):
    make(tmp_path / "a.npz")
    with pytest.raises(UsageError, match="SF901"):
        read_sweep(tmp_path / "a.npz")


def test_a_damaged_journal_gives_the_same_bytes(tmp_path):
    task, design = task_and_design(2)
    expected = npz_bytes(run_sweep(task, design))
    run_sweep(task, design, journal=open_journal(tmp_path / "a.nc", "key"))
    path = tmp_path / "a.nc.part" / "chunk-000001.npz"
    path.write_bytes(path.read_bytes().replace(b"\xf0\xbf", b"\xf0\x3f", 1)[:-1] + b"\1")
    again = open_journal(tmp_path / "a.nc", "key")
    assert npz_bytes(run_sweep(task, design, journal=again)) == expected
