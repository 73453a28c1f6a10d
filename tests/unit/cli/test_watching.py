from symflex.cli import watching
from symflex.cli.watching import watched


def test_a_watched_command_runs_again_when_a_file_is_saved_and_ends_with_ctrl_c(tmp_path, monkeypatch):
    file, runs, pauses = tmp_path / "x.toml", [], []
    file.write_text("symflex = 1\n")

    def pause(_):
        pauses.append(len(runs))
        if len(pauses) == 2:
            file.write_text("symflex = 1 # saved\n")
        elif len(pauses) == 4:
            (tmp_path / "beside.toml").write_text("")
        elif len(pauses) == 6:
            raise KeyboardInterrupt

    monkeypatch.setattr(watching, "sleep", pause)
    assert watched(str(file), lambda: runs.append(file.read_text()) or 3) == 0
    assert pauses == [1, 1, 2, 2, 3, 3]
    assert runs == ["symflex = 1\n", *["symflex = 1 # saved\n"] * 2]
