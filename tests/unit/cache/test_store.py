from __future__ import annotations

import multiprocessing
import os
import zlib

import pytest

from symflex.cache import store as store_module
from symflex.cache.store import Store, Usage

KEY = "0123456789abcdef" * 4
OTHER = "f" * 64
CONTENT = bytes(range(64)) * 4


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path / "cache")


@pytest.fixture
def path(store):
    store.write(KEY, CONTENT)
    (found,) = store.folder.iterdir()
    return found


def test_what_is_written_is_read(store, path):
    assert store.read(KEY) == CONTENT
    assert store.read(OTHER) is None
    assert store.usage() == Usage(1, path.stat().st_size)


def test_entries_are_for_the_user_alone(path):
    assert path.stat().st_mode & 0o077 == 0
    assert path.parent.stat().st_mode & 0o077 == 0


def test_every_truncation_is_a_missing_entry(store, path):
    whole = path.read_bytes()
    for length in range(len(whole)):
        path.write_bytes(whole[:length])
        assert store.read(KEY) is None


def test_every_flipped_bit_is_a_missing_entry_or_the_same_content(store, path):
    whole = path.read_bytes()
    for place in range(len(whole)):
        for bit in (0, 3, 7):
            changed = bytearray(whole)
            changed[place] ^= 1 << bit
            path.write_bytes(changed)
            assert store.read(KEY) in {None, CONTENT}


@pytest.mark.parametrize("more", [b"\0", b"symflex", CONTENT])
def test_bytes_after_an_entry_make_it_a_missing_one(store, path, more):
    path.write_bytes(path.read_bytes() + more)
    assert store.read(KEY) is None


def test_an_entry_of_another_key_is_a_missing_one(store, path):
    path.rename(path.with_name(f"{OTHER}.sfd"))
    assert store.read(OTHER) is None


def test_an_entry_of_another_format_is_a_missing_one(store, path):
    path.write_bytes(path.read_bytes().replace(b"derivation 1", b"derivation 2"))
    assert store.read(KEY) is None


def test_a_missing_entry_is_written_again(store, path):
    path.write_bytes(b"")
    store.write(KEY, CONTENT)
    assert store.read(KEY) == CONTENT


def test_no_file_makes_more_of_itself_than_an_entry_may_hold(store, path, monkeypatch):
    monkeypatch.setattr(store_module, "MAXIMUM_CONTENT", 100)
    assert store.read(KEY) is None
    whole = path.read_bytes()
    path.write_bytes(whole[: store_module._HEAD] + zlib.compress(bytes(10**8)))
    assert store.read(KEY) is None


def test_a_link_a_folder_and_a_pipe_are_not_entries(store, path, tmp_path):
    moved = path.rename(tmp_path / "elsewhere")
    path.symlink_to(moved)
    assert store.read(KEY) is None
    path.unlink()
    path.mkdir()
    assert store.read(KEY) is None
    store.write(KEY, CONTENT)
    path.rmdir()
    os.mkfifo(path)
    assert store.read(KEY) is None


def test_writing_replaces_a_link_and_does_not_follow_it(store, path, tmp_path):
    kept = tmp_path / "kept"
    kept.write_bytes(b"mine")
    path.unlink()
    path.symlink_to(kept)
    store.write(KEY, CONTENT)
    assert kept.read_bytes() == b"mine"
    assert store.read(KEY) == CONTENT


@pytest.mark.parametrize("folder", ["file", "file/below", "nul\0"])
def test_a_folder_that_cannot_be_is_a_cache_without_entries(tmp_path, folder):
    (tmp_path / "file").write_text("")
    store = Store(f"{tmp_path}/{folder}")
    store.write(KEY, CONTENT)
    assert store.read(KEY) is None
    assert store.usage() == store.clear() == Usage(0, 0)


def test_what_was_not_used_for_longest_is_removed_first(tmp_path):
    noise = [os.urandom(1000) for _ in range(4)]
    store = Store(tmp_path, maximum=3600)
    for i, content in enumerate(noise[:3]):
        store.write(f"{i}" * 64, content)
        os.utime(tmp_path / f"{str(i) * 64}.sfd", (i, i))
    assert store.read("0" * 64) == noise[0]
    store.write("3" * 64, noise[3])
    assert [store.read(f"{i}" * 64) for i in range(4)] == [noise[0], None, noise[2], noise[3]]


def test_clearing_removes_entries_and_nothing_else(store, path):
    (store.folder / "README").write_text("mine")
    (store.folder / f"{KEY}.{'0' * 16}.tmp").write_bytes(b"left by a process that was stopped")
    size = path.stat().st_size
    assert store.clear() == Usage(1, size)
    assert [p.name for p in store.folder.iterdir()] == ["README"]


def test_a_temporary_file_that_was_left_is_removed_when_it_is_old(store, path):
    old, new = (store.folder / f"{KEY}.{digit * 16}.tmp" for digit in "01")
    old.write_bytes(b"")
    os.utime(old, (0, 0))
    new.write_bytes(b"")
    store.write(OTHER, CONTENT)
    assert not old.exists()
    assert new.exists()


def write_and_read(folder, contents):
    """Write one key again and again; return how often something else than one of the contents was read."""
    store, wrong = Store(folder), 0
    for i in range(60):
        store.write(KEY, contents[i % len(contents)])
        found = store.read(KEY)
        wrong += found is None or found not in contents
    return wrong


def test_processes_that_write_the_same_key_do_not_disturb_each_other(tmp_path):
    contents = [bytes([i]) * 200_000 + os.urandom(1000) for i in range(3)]
    with multiprocessing.get_context("spawn").Pool(4) as pool:
        wrong = pool.starmap(write_and_read, [(tmp_path, contents)] * 4)
    assert wrong == [0, 0, 0, 0]
    assert [p.name for p in tmp_path.iterdir()] == [f"{KEY}.sfd"]
