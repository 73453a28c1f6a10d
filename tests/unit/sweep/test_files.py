import csv
import io
import json
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from symflex.cli import run
from symflex.errors import DataError, UsageError
from symflex.figures import draw_sweep, render
from symflex.sweep.files import WRITERS, netcdf_bytes, npz_bytes, read_sweep, sweep_bytes
from tests.unit.refusals import refusal
from tests.unit.sweep.models import ALGEBRAIC, LOOP, OSCILLATOR, SLIDING_FREE, oscillator


@pytest.fixture(scope="module")
def sweep():
    return oscillator().sweep({"b": [0.1, 1, 3], "k": [1, 2]})


def test_what_is_written_is_read_back(sweep, tmp_path):
    for suffix in [".nc", ".npz"]:
        path = tmp_path / f"a{suffix}"
        path.write_bytes(sweep_bytes(sweep, suffix))
        again = read_sweep(path)
        assert dict(again.attributes) == dict(sweep.attributes), suffix
        assert [c.name for c in again.coordinates] == [c.name for c in sweep.coordinates], suffix
        assert len(again.variables) == len(sweep.variables), suffix
        for a, b in zip(*(sorted(s.variables, key=lambda v: v.name) for s in (sweep, again)), strict=True):
            assert (a.name, a.dims, a.unit, a.doc) == (b.name, b.dims, b.unit, b.doc), suffix
            assert a.values.tolist() == b.values.tolist() or np.array_equal(
                a.values, b.values, equal_nan=True
            ), suffix
        assert sweep_bytes(again, suffix) == sweep_bytes(sweep, suffix), suffix


def test_a_table_has_a_row_for_each_root(sweep):
    rows = list(csv.DictReader(io.StringIO(sweep_bytes(sweep, ".csv").decode())))
    assert len(rows) == int(np.sum(sweep["status"] > 0))
    first = rows[0]
    assert (float(first["b"]), float(first["k"]), first["mode"]) == (0.1, 1.0, "1")
    assert float(first["im"]) == sweep["im"][0, 0, 0]


@pytest.mark.slow
@pytest.mark.needs_module("pyarrow")
@pytest.mark.slow
def test_parquet_holds_the_same_table(sweep):
    from pyarrow import parquet

    table = parquet.read_table(io.BytesIO(sweep_bytes(sweep, ".parquet")))
    rows = list(csv.DictReader(io.StringIO(sweep_bytes(sweep, ".csv").decode())))
    assert table.column_names == list(rows[0])
    assert table.column("re").to_pylist() == [float(row["re"]) for row in rows]
    assert table.schema.metadata[b"of"] == b"poles"


@pytest.mark.slow
@pytest.mark.needs_module("xarray")
@pytest.mark.slow
def test_xarray_reads_the_file_and_selects_by_label(sweep, tmp_path):
    import xarray

    path = tmp_path / "a.nc"
    path.write_bytes(netcdf_bytes(sweep))
    with xarray.open_dataset(path, engine="scipy") as found:
        assert float(found["im"].sel(b=1, k=2, mode=1)) == sweep["im"][1, 1, 0]
    dataset = sweep.to_xarray()
    assert complex(dataset["s"].sel(b=1, k=2, mode=1)) == pytest.approx(-0.5 + 1j * 1.75**0.5)
    assert dataset["k"].attrs["units"] == "N/m"


@pytest.mark.parametrize(("library", "act"), [("pyarrow", ".parquet"), ("xarray", None)])
def test_a_missing_library_is_named(sweep, monkeypatch, library, act):
    monkeypatch.setitem(__import__("sys").modules, library, None)
    with pytest.raises(UsageError, match="SF914") as caught:
        sweep.to_xarray() if act is None else sweep_bytes(sweep, act)
    assert "symflex[sweep]" in caught.value.diagnostics[0].hint


def test_a_file_that_holds_no_sweep_is_refused(tmp_path):
    path = tmp_path / "a.nc"
    for content in (
        b"",
        b"CDF\x01",
        b"CDF\x02" + b"\xff" * 200,
        b"PK\x03\x04",
        b"\x89HDF\r\n\x1a\n" + bytes(100),
        b"k,mode\n1,2\n",
    ):
        path.write_bytes(content)
        assert refusal(read_sweep, path) == "DataError SF915", content


def test_files_cut_short_are_refused(sweep, tmp_path):
    for make in (netcdf_bytes, npz_bytes):
        whole = make(sweep)
        for share in (0.1, 0.5, 0.9):
            path = tmp_path / "a"
            path.write_bytes(whole[: int(share * len(whole))])
            with pytest.raises(DataError, match="SF915"):
                read_sweep(path)


def test_what_is_said_of_stability_is_said_whole_and_in_known_words(sweep, tmp_path):
    path = tmp_path / "a.npz"
    odd = [replace(v, values=v.values + 9) if v.name == "verdict" else v for v in sweep.variables]
    for variables in (odd, [v for v in sweep.variables if v.name != "hidden_motion"]):
        path.write_bytes(npz_bytes(replace(sweep, variables=tuple(variables))))
        with pytest.raises(DataError, match="SF915"):
            read_sweep(path)
    former = tuple(v for v in sweep.variables if v.name not in ("verdict", "hidden_motion"))
    path.write_bytes(npz_bytes(replace(sweep, variables=former)))
    assert read_sweep(path).of == "poles"


# ------------------------------------------------------------------------------------------- command line


@pytest.fixture
def spec(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.toml").write_text(OSCILLATOR)
    (tmp_path / "loop.toml").write_text(LOOP)
    (tmp_path / "beam.toml").write_text(SLIDING_FREE)
    return "a.toml"


def test_a_summary_as_json(spec, capsys):
    assert run(["sweep", spec, "--over", "k=1,4", "--tf", "X/F", "--workers", "1", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["schema"] == "symflex.sweep/1"
    assert document["certified"] is True
    assert document["points"]["certified"] == 2
    (mode,) = document["modes"]
    assert mode["frequency_hz"] == pytest.approx([1 / (2 * np.pi), 2 / (2 * np.pi)])


@pytest.mark.slow
def test_every_format_is_written_twice_alike(spec, tmp_path):
    command = ["sweep", spec, "--over", "k=1:2", "--monte-carlo", "3", "--workers", "1", "-o"]
    for suffix in WRITERS:
        if suffix == ".parquet" and find_spec("pyarrow") is None:
            continue
        assert run([*command, f"one{suffix}"]) == 0, suffix
        assert run([*command, f"two{suffix}"]) == 0, suffix
        assert (tmp_path / f"one{suffix}").read_bytes() == (tmp_path / f"two{suffix}").read_bytes(), suffix
    assert not list(tmp_path.glob("*.part"))


EXIT_CODES = {
    2: (
        "",
        "--over q=1,2",
        "--over k=1,2 -o a.txt",
        "--over k=1,2 -o no/such/a.nc",
        "--over k=1,2 --of margins",
        "--over k=1,2 --gain k",
        "--over k=1,2 --of response",
        "--over k=1,2 --of response --band 0 1",
        "--over k=1,2 --count 5",
        "--over k=1,2 --modes 2 --band 1 2",
        "--over k=1,2 --fresh",
        "--over k=1,2 --workers 2 --scheduler tcp://127.0.0.1:1",
        "--over k=1,2 --of margins --gain zz",
    ),
    5: ("--over k=1:2:lin:2000000",),
}


def test_exit_codes(spec, capsys):
    for code, commands in EXIT_CODES.items():
        for arguments in commands:
            assert run(["sweep", spec, *arguments.split()]) == code, arguments
            assert capsys.readouterr().err, arguments


def test_a_link_is_refused_before_anything_is_computed(spec, tmp_path, capsys):
    (tmp_path / "a.nc").symlink_to(tmp_path / "elsewhere.nc")
    assert run(["sweep", spec, "--over", "k=1,2", "--workers", "1", "-o", "a.nc"]) == 2
    assert "SF903" in capsys.readouterr().err
    assert not (tmp_path / "a.nc.part").exists()


def test_a_point_that_fails_is_no_success(spec, capsys):
    Path("loop.toml").write_text(ALGEBRAIC)
    assert run(["sweep", "loop.toml", "--over", "c=0,1", "--workers", "1"]) == 4
    assert "1 failed" in capsys.readouterr().out


def test_lines_fit_a_terminal(spec, capsys):
    assert run(["sweep", spec, "--over", "b=0.1:4:lin:3", "--over", "k=1:2:lin:3", "--workers", "1"]) == 0
    assert max(map(len, capsys.readouterr().out.splitlines())) <= 80


RESPONSE = ["--of", "response", "--band", "0.01", "10", "--count", "20"]


@pytest.mark.slow
def test_every_kind_of_sweep_is_drawn_the_same_twice(spec, tmp_path):
    for arguments in (
        ["a.toml", "--over", "b=0.1:3:lin:9"],
        ["a.toml", "--over", "k=1:100", "--monte-carlo", "9", *RESPONSE],
        ["loop.toml", "--over", "K=0.5:5:lin:5", "--of", "margins", "--gain", "K"],
        ["beam.toml", "--over", "l=1:2", "--monte-carlo", "5", "--modes", "2"],
    ):
        assert run(["sweep", *arguments, "--workers", "1", "-o", "s.nc"]) == 0, arguments
        assert run(["plot", "sweep", "s.nc", "-o", "s.svg"]) == 0, arguments
        assert run(["plot", "s.nc", "sweep", "-o", "t.svg"]) == 0, arguments
        assert (tmp_path / "s.svg").read_bytes() == (tmp_path / "t.svg").read_bytes(), arguments
        (tmp_path / "s.nc").unlink()


def test_a_few_values_of_a_second_parameter_are_lines_of_their_own():
    frequencies = draw_sweep(oscillator().sweep({"b": [0.1, 0.5, 1], "k": [1, 2]})).axes[0]
    for line, k in zip(frequencies.lines, (1, 2), strict=True):
        assert np.allclose(line.get_xdata(), [0.1, 0.5, 1])
        assert np.allclose(line.get_ydata(), np.sqrt(k) / (2 * np.pi))
    pale, full = (line.get_alpha() for line in frequencies.lines)
    assert pale < full == 1


@pytest.mark.slow
def test_many_values_of_two_parameters_are_bars():
    many = oscillator().sweep({"b": [0.1 * i for i in range(1, 14)], "k": [1.0 * i for i in range(1, 15)]})
    (bar,) = [line for line in draw_sweep(many).axes[0].lines if line.get_linewidth() > 3]
    assert len(bar.get_xdata()) == 2


@pytest.mark.slow
def test_loci_show_every_point(sweep):
    figure = draw_sweep(sweep)
    marks = [c for axes in figure.axes for c in axes.collections if len(c.get_offsets()) > 1]
    assert len(marks[0].get_offsets()) == int(np.sum(sweep["status"] > 0))
    assert render(figure, "png")[:4] == b"\x89PNG"


def test_what_is_no_sweep_is_not_drawn(spec, capsys):
    assert run(["plot", "sweep", "a.toml"]) == 3
    assert run(["plot", "sweep", "none.nc"]) == 2
    assert run(["plot", "sweep", "a.toml", "--gain", "k"]) == 2
