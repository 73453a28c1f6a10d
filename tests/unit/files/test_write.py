import os
import stat

import pytest

from symflex.errors import UsageError
from symflex.files.write import check_folder, check_writable, write_atomically, write_tree


def refusal(path):
    with pytest.raises(UsageError) as caught:
        write_atomically(path, b"new")
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == "SF903"
    return diagnostic.message


def fail(*_):
    raise OSError(28, "No space left on device")


def test_a_file_is_written_or_replaced_and_no_temporary_one_remains(tmp_path):
    for data in (b"\x00a longer content\r\n", b"new"):
        write_atomically(tmp_path / "a.svg", data)
        assert (tmp_path / "a.svg").read_bytes() == data
        assert os.listdir(tmp_path) == ["a.svg"]


def test_a_failure_on_the_way_leaves_the_old_content_or_nothing(tmp_path, monkeypatch):
    (tmp_path / "old.svg").write_bytes(b"old")
    for function in ["fsync", "replace"]:
        with monkeypatch.context() as patch:
            patch.setattr(os, function, fail)
            refusal(tmp_path / "old.svg")
            refusal(tmp_path / "new.svg")
        assert (tmp_path / "old.svg").read_bytes() == b"old", function
        assert os.listdir(tmp_path) == ["old.svg"], function


def test_a_full_disk_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr(os, "fsync", fail)
    assert refusal(tmp_path / "a.svg").endswith("a.svg': No space left on device")


def test_a_missing_folder_is_named(tmp_path):
    folder = tmp_path / "figures"
    assert refusal(folder / "a.svg") == f"cannot write '{folder / 'a.svg'}': there is no folder '{folder}'"


def test_what_is_no_regular_file_is_not_overwritten(tmp_path):
    os.mkfifo(tmp_path / "fifo")
    assert refusal(tmp_path).endswith("it is not a regular file")
    assert refusal(tmp_path / "fifo").endswith("it is not a regular file")
    assert refusal(tmp_path / "a\0.svg").endswith("the name contains a character that file names cannot have")
    (tmp_path / "file").write_bytes(b"")
    assert refusal(tmp_path / "file" / "a.svg").endswith("Not a directory")


def test_a_symbolic_link_is_not_written_through(tmp_path):
    (tmp_path / "target").write_bytes(b"old")
    for name in ("target", "nothing"):
        (tmp_path / f"{name}.svg").symlink_to(tmp_path / name)
        assert "symbolic link" in refusal(tmp_path / f"{name}.svg"), name
    assert (tmp_path / "target").read_bytes() == b"old"
    assert not (tmp_path / "nothing").exists()


@pytest.mark.skipif(os.name == "posix" and os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_without_write_permission_is_an_error(tmp_path):
    tmp_path.chmod(0o500)
    message = refusal(tmp_path / "a.svg")
    tmp_path.chmod(0o700)
    assert message.endswith("Permission denied")


def test_an_existing_file_keeps_its_permissions(tmp_path):
    (tmp_path / "a.svg").write_bytes(b"old")
    (tmp_path / "a.svg").chmod(0o640)
    write_atomically(tmp_path / "a.svg", b"new")
    assert stat.S_IMODE((tmp_path / "a.svg").stat().st_mode) == 0o640


def test_a_new_file_gets_the_permissions_of_the_umask(tmp_path):
    before = os.umask(0o027)
    write_atomically(tmp_path / "a.svg", b"new")
    os.umask(before)
    assert stat.S_IMODE((tmp_path / "a.svg").stat().st_mode) == 0o640


def test_a_folder_is_made_and_filled(tmp_path):
    write_tree(tmp_path / "new", {"a.tex": b"first", "b.tex": "größer".encode()})
    assert (tmp_path / "new" / "b.tex").read_text(encoding="utf-8") == "größer"
    write_tree(tmp_path / "new", {"a.tex": b"second"})
    assert sorted(p.name for p in (tmp_path / "new").iterdir()) == ["a.tex", "b.tex"]
    assert (tmp_path / "new" / "a.tex").read_text(encoding="utf-8") == "second"


def test_a_folder_that_cannot_be_made_is_a_usage_error(tmp_path):
    (tmp_path / "file").write_text("")
    for folder in ["file", "file/b", "a\0"]:
        with pytest.raises(UsageError, match="SF903"):
            write_tree(tmp_path / folder, {"a.tex": b""})


def test_what_could_not_be_written_is_refused_beforehand(tmp_path):
    (tmp_path / "folder").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "elsewhere")
    for name in ["no/such/folder/a.svg", "folder", "link", "a\0b", "x" * 300]:
        with pytest.raises(UsageError, match="SF903"):
            check_writable(tmp_path / name)


def test_what_can_be_written_is_not_touched_beforehand(tmp_path):
    check_writable(tmp_path / "a.svg")
    assert list(tmp_path.iterdir()) == []


def test_a_folder_below_a_file_is_refused_beforehand(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(UsageError, match="SF903"):
        check_folder(tmp_path / "file" / "below")


def test_folders_that_can_be_made_are_not_made_beforehand(tmp_path):
    check_folder(tmp_path / "a" / "b")
    assert list(tmp_path.iterdir()) == []
