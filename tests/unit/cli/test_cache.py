from __future__ import annotations

from importlib import import_module

import pytest

from symflex.cache.store import Store
from symflex.cli import COMMANDS, caching

DERIVING = [name for name in COMMANDS if name not in {"check", "new", "elements", "cache"}]


@pytest.fixture
def folder(monkeypatch, tmp_path):
    monkeypatch.delenv("SYMFLEX_NO_CACHE")
    monkeypatch.setenv("SYMFLEX_CACHE_DIR", str(tmp_path / "kept"))
    return tmp_path / "kept"


@pytest.mark.parametrize("name", DERIVING)
def test_every_command_that_derives_can_do_without_the_cache(name):
    command = import_module(f"symflex.cli.{name}").command
    assert "--no-cache" in [option for p in command.params for option in p.opts]


def test_a_command_enters_the_cache_unless_it_is_told_not_to(folder, shell, monkeypatch):
    seen = []
    monkeypatch.setattr(caching, "derivation_cache", lambda: seen.append("entered") or Nothing())
    assert shell("derive", "x.toml", "--no-cache").code == 0
    assert seen == []
    assert shell("derive", "x.toml").code == 0
    assert seen == ["entered"]


class Nothing:
    def __enter__(self):
        return None

    def __exit__(self, *_):
        return None


def test_a_small_model_leaves_no_folder_behind(folder, shell):
    assert shell("derive", "x.toml").code == 0
    assert not folder.exists()


def test_the_cache_is_shown_and_cleared(folder, shell):
    assert shell("cache").out == f"folder: {folder}\nentries: 0, 0.0 MiB, of at most 256 MiB\n"
    Store(folder).write("a" * 64, b"x")
    size = Store(folder).usage().size
    shown = shell("cache", "--json").json
    assert shown == {
        "schema": "symflex.cache/1",
        "folder": str(folder),
        "writable": True,
        "entries": 1,
        "bytes": size,
        "maximum_bytes": 256 * 2**20,
        "removed": 0,
    }
    assert "removed: 1, 0.0 MiB" in shell("cache", "--clear").out
    assert shell("cache", "--json").json["entries"] == 0


def test_a_cache_that_is_switched_off_is_said_to_be(shell):
    assert shell("cache").out.startswith("no cache: SYMFLEX_NO_CACHE is set")
    assert shell("cache", "--clear", "--json").json["folder"] is None


def test_a_folder_that_cannot_be_written_changes_nothing(monkeypatch, tmp_path, shell):
    expected = shell("derive", "x.toml").out
    (tmp_path / "file").write_text("")
    monkeypatch.delenv("SYMFLEX_NO_CACHE")
    monkeypatch.setenv("SYMFLEX_CACHE_DIR", str(tmp_path / "file" / "below"))
    result = shell("derive", "x.toml")
    assert (result.code, result.out, result.err) == (0, expected, "")
    shown = shell("cache")
    assert shown.code == 0
    assert "nothing can be kept there" in shown.out
    assert shell("cache", "--json").json["writable"] is False


def test_looking_whether_the_cache_can_be_written_leaves_nothing(folder, shell):
    assert shell("cache", "--json").json["writable"] is True
    assert not folder.exists() and not any(p.name.startswith(".symflex") for p in folder.parent.iterdir())
    folder.mkdir()
    assert shell("cache", "--json").json["writable"] is True
    assert not any(folder.iterdir())


@pytest.mark.parametrize("path", ["/dev/null", "/dev/null/below", "/proc/nope"])
def test_a_place_that_holds_no_folder_is_said_to_keep_nothing(monkeypatch, shell, path):
    monkeypatch.delenv("SYMFLEX_NO_CACHE")
    monkeypatch.setenv("SYMFLEX_CACHE_DIR", path)
    assert "nothing can be kept there" in shell("cache").out
