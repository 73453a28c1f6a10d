"""What can be refused is refused before anything is computed."""

import pytest

from symflex import pipeline
from symflex.analysis import measured


@pytest.fixture(autouse=True)
def _nothing_is_computed(monkeypatch):
    for name in ("assemble", "derive_all", "derive_as", "derive_bound"):
        monkeypatch.setattr(pipeline, name, None)
    for name in ("fit", "measure"):
        monkeypatch.setattr(measured, name, None)


def test_a_place_that_cannot_be_written_is_refused_before_anything_is_computed(shell):
    for arguments in (
        ("export", "x.toml", "--to", "c", "-o", "no/such/a.c"),
        ("export", "x.toml", "--to", "latex", "-o", "x.toml/"),
        ("plot", "x.toml", "bode", "-o", "no/such/a.pdf"),
        ("measure", "x.toml", "--band", "1", "10", "-o", "no/such/a.csv"),
        ("fit", "x.csv", "-o", "no/such/a.toml"),
        ("fit", "x.csv", "--plot", "no/such/a.pdf"),
        ("report", "x.toml", "-o", "x.toml/below"),
        ("sweep", "x.toml", "--over", "k=1:2:lin:2", "-o", "no/such/a.npz"),
    ):
        (shell.folder / "x.csv").write_text("frequency_hz,re,im\n1,1,0\n")
        done = shell(*arguments)
        assert done.code == 2, arguments
        assert "SF903" in done.err, arguments
