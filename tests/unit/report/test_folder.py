from __future__ import annotations

import os
from pathlib import Path

import pytest

from symflex.errors import UsageError
from symflex.report.published import write_tree


def test_files_go_where_they_belong(tmp_path):
    write_tree(tmp_path / "new" / "report", {"index.html": b"a", "figures/one.svg": b"b"})
    assert (tmp_path / "new" / "report" / "figures" / "one.svg").read_bytes() == b"b"


@pytest.mark.parametrize("name", ["../x", "a/../../x", "/etc/x", "a\\b", "", "a\0b"])
def test_no_path_leads_out_of_the_folder(name, tmp_path):
    with pytest.raises(ValueError, match="leads out"):
        write_tree(tmp_path, {"fine": b"", name: b""})
    assert os.listdir(tmp_path) == []


def test_a_subfolder_that_is_a_link_is_refused(tmp_path):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    folder = tmp_path / "report"
    folder.mkdir()
    (folder / "data").symlink_to(elsewhere)
    with pytest.raises(UsageError, match="SF903"):
        write_tree(folder, {"data/x.json": b"{}"})
    assert os.listdir(elsewhere) == []


def test_a_file_that_is_a_link_is_refused(tmp_path):
    target = tmp_path / "target"
    target.write_text("kept", encoding="utf-8")
    folder = tmp_path / "report"
    folder.mkdir()
    (folder / "index.html").symlink_to(target)
    with pytest.raises(UsageError, match="SF903"):
        write_tree(folder, {"index.html": b"new"})
    assert target.read_text(encoding="utf-8") == "kept"


def test_a_file_in_place_of_a_subfolder_is_an_error(tmp_path):
    (tmp_path / "data").write_text("", encoding="utf-8")
    with pytest.raises(UsageError, match="SF903"):
        write_tree(tmp_path, {"data/x": b""})


def test_other_files_stay(tmp_path):
    (tmp_path / "mine").write_text("kept", encoding="utf-8")
    write_tree(Path(tmp_path), {"index.html": b""})
    assert (tmp_path / "mine").read_text(encoding="utf-8") == "kept"
