import os
from pathlib import Path

import pytest

from symflex.errors import UsageError
from symflex.files.write import write_tree
from tests.unit.refusals import refusal


def test_files_go_where_they_belong(tmp_path):
    write_tree(tmp_path / "new" / "report", {"index.html": b"a", "figures/one.svg": b"b"})
    assert (tmp_path / "new" / "report" / "figures" / "one.svg").read_bytes() == b"b"


def test_no_path_leads_out_of_the_folder(tmp_path):
    for name in ("../x", "a/../../x", "/etc/x", "a\\b", "", ".", "..", "a\0b"):
        with pytest.raises(ValueError, match="leads out"):
            write_tree(tmp_path, {"fine": b"", name: b""})
        assert os.listdir(tmp_path) == [], name


def test_a_subfolder_or_file_that_is_a_link_is_refused(tmp_path):
    elsewhere, target, folder = tmp_path / "elsewhere", tmp_path / "target", tmp_path / "report"
    elsewhere.mkdir()
    target.write_text("kept", encoding="utf-8")
    folder.mkdir()
    (folder / "data").symlink_to(elsewhere)
    (folder / "index.html").symlink_to(target)
    for name in ("data/x.json", "index.html"):
        assert refusal(write_tree, folder, {name: b"new"}) == "UsageError SF903", name
    assert os.listdir(elsewhere) == []
    assert target.read_text(encoding="utf-8") == "kept"


def test_a_file_in_place_of_a_subfolder_is_an_error(tmp_path):
    (tmp_path / "data").write_text("", encoding="utf-8")
    with pytest.raises(UsageError, match="SF903"):
        write_tree(tmp_path, {"data/x": b""})


def test_other_files_stay(tmp_path):
    (tmp_path / "mine").write_text("kept", encoding="utf-8")
    write_tree(Path(tmp_path), {"index.html": b""})
    assert (tmp_path / "mine").read_text(encoding="utf-8") == "kept"
