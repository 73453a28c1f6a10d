from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from symflex.cache import derivation_cache
from symflex.cache.folder import cache_folder

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="folders are those of Linux")


@pytest.fixture(autouse=True)
def _no_variables(monkeypatch):
    for name in ("SYMFLEX_NO_CACHE", "SYMFLEX_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)


def test_the_folder_is_that_of_the_user(monkeypatch, tmp_path):
    monkeypatch.setenv("HOME", str(tmp_path))
    assert cache_folder() == tmp_path / ".cache" / "symflex"
    monkeypatch.setenv("XDG_CACHE_HOME", "/scratch")
    assert cache_folder() == Path("/scratch/symflex")


def test_a_relative_cache_home_is_ignored_as_its_specification_says(monkeypatch, tmp_path):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", "scratch")
    assert cache_folder() == tmp_path / ".cache" / "symflex"


def test_a_folder_that_is_named_comes_first(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", "/scratch")
    monkeypatch.setenv("SYMFLEX_CACHE_DIR", str(tmp_path))
    assert cache_folder() == tmp_path
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SYMFLEX_CACHE_DIR", "kept")
    assert cache_folder() == tmp_path / "kept"


@pytest.mark.parametrize(("value", "is_off"), [("1", True), ("yes", True), ("0", False), ("", False)])
def test_the_cache_can_be_switched_off(monkeypatch, tmp_path, value, is_off):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("SYMFLEX_NO_CACHE", value)
    assert (cache_folder() is None) is is_off


def test_a_home_that_does_not_exist_is_not_made(monkeypatch, tmp_path):
    monkeypatch.setenv("HOME", str(tmp_path / "nonexistent"))
    assert cache_folder() is None


def test_without_a_home_there_is_no_folder(monkeypatch):
    monkeypatch.setattr(os.path, "expanduser", lambda path: path)
    assert cache_folder() is None
    with derivation_cache() as store:
        assert store is None
