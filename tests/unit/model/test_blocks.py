"""Which files a ``model`` block reads, and what messages show of them."""

import numpy as np
import pytest

import symflex
from symflex import pipeline, transfer
from symflex.cli import run
from symflex.errors import SpecError

INNER = 'symflex = 1\n[inputs]\nF = {}\n[outputs]\nX = "F/(s + 2)"\n'
SECRET = "tresor"
COMMANDS = {
    "check": (), "derive": (), "roots": (), "rational": (), "sweep": ("--over", "k=1,2"),
    "stability": ("--gain", "k"), "colocation": ("--tf", "X/F", "--with", "X/F"),
    "plot": ("bode", "-o", "figure.svg"), "export": ("--to", "numpy"), "audit": (),
    "measure": ("--tf", "X/F", "-o", "measured.csv"), "report": ("--no-pdf", "-o", "report"),
}  # fmt: skip


def outer(path):
    return (
        'symflex = 1\n[parameters]\nk = "1"\n[blocks]\n'
        f'G = {{ type = "model", spec = "{path}", tf = "X/F" }}\n'
        '[inputs]\nF = {}\n[outputs]\nX = "k*G*F"\n[analysis]\nband = ["0.01 Hz", "1 Hz"]\n'
    )


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A folder to work in, with a folder beside it."""
    for name in ("work", "beside"):
        (tmp_path / name).mkdir()
    monkeypatch.chdir(tmp_path / "work")
    return tmp_path


@pytest.fixture
def beside(place):
    """A file in the folder beside, of which a block of the specification is made."""
    (place / "work" / "outer.toml").write_text(outer("../beside/inner.toml"))
    (place / "beside" / "inner.toml").write_text(INNER)
    return place / "beside" / "inner.toml"


def test_a_block_does_not_read_a_file_outside_the_folder_of_the_specification(place, beside):
    (place / "work" / "below").mkdir()
    (place / "work" / "link.toml").symlink_to(beside)
    (place / "work" / "away").symlink_to(place / "beside")
    for path in ["../beside/inner.toml", "below/../../beside/inner.toml", "link.toml", "away/inner.toml"]:
        (place / "work" / "outer.toml").write_text(outer(path))
        with pytest.raises(SpecError) as raised:
            pipeline.load("outer.toml")
        assert [d.code for d in raised.value.diagnostics] == ["SF258"], path


def test_a_file_outside_is_the_same_to_messages_as_one_that_is_not_there(beside, capsys):
    beside.unlink()
    run(["check", "outer.toml"])
    without = capsys.readouterr()
    for text in [INNER, f"{SECRET}:x:0", f"symflex = {SECRET}\n", f'symflex = 1\nk = "{SECRET}"\n']:
        beside.write_text(text)
        run(["check", "outer.toml"])
        assert capsys.readouterr() == without, text


def test_nothing_is_shown_of_a_file_that_does_not_declare_the_format(place, capsys):
    (place / "work" / "outer.toml").write_text(outer("inner.txt"))
    for content in [
        b"tresor:x:0\n",
        b"[symflex]\ntresor = 1\n",
        b"\xff\xfetresor",
        b"a = 1\n[x]\nsymflex = 1 # tresor\n",
    ]:
        (place / "work" / "inner.txt").write_bytes(content)
        assert run(["check", "outer.toml"]) == 3, content
        printed = capsys.readouterr()
        assert SECRET not in printed.out + printed.err, content


def test_nothing_is_shown_of_an_invalid_file_outside_that_may_be_read(beside, capsys):
    for text in [f'symflex = 1\n[outputs]\nX = "{SECRET}*"\n', f"symflex = 1\n{SECRET} = 3 4\n"]:
        beside.write_text(text)
        assert run(["check", "outer.toml", "--allow-outside", "../beside"]) == 3, text
        printed = capsys.readouterr()
        assert "SF258" in printed.err, text
        assert SECRET not in printed.out + printed.err, text


def test_a_block_inside_a_block_is_held_to_the_folder_of_the_outermost_file(place):
    (place / "work" / "below").mkdir()
    (place / "work" / "below" / "middle.toml").write_text(outer("../inner.toml"))
    (place / "work" / "inner.toml").write_text(INNER)
    (place / "work" / "outer.toml").write_text(outer("below/middle.toml"))
    assert pipeline.load("outer.toml").transfer_functions == (("X", "F"),)
    with pytest.raises(SpecError, match="SF258"):
        pipeline.load("below/middle.toml")


def assert_taken(commands, capsys):
    for command in commands:
        run([command, "outer.toml", "--allow-outside", "../beside", *COMMANDS[command]])
        assert "SF258" not in capsys.readouterr().err, command


DEAR = {"sweep", "report"}


@pytest.mark.usefixtures("beside")
def test_every_command_that_reads_a_specification_refuses_a_file_outside(capsys):
    for command, options in COMMANDS.items():
        assert run([command, "outer.toml", *options]) == 3, command
        assert "SF258" in capsys.readouterr().err, command


@pytest.mark.usefixtures("beside")
@pytest.mark.slow
def test_every_command_that_reads_a_specification_takes_a_folder_outside(capsys):
    assert_taken(sorted(COMMANDS.keys() - DEAR), capsys)
    assert symflex.load("outer.toml", allow_outside=["../beside"]).outputs == ("X",)


@pytest.mark.slow
@pytest.mark.usefixtures("beside")
def test_a_sweep_and_a_report_take_a_folder_outside(capsys):
    assert_taken(sorted(DEAR), capsys)


@pytest.mark.slow
def test_a_report_of_a_folder_lets_its_specifications_read_all_of_it(place, capsys):
    for name in ("one", "two"):
        (place / "work" / name).mkdir()
    (place / "work" / "one" / "inner.toml").write_text(INNER)
    (place / "work" / "two" / "outer.toml").write_text(outer("../one/inner.toml"))
    run(["report", ".", "-o", "../report", "--no-pdf", "-j", "1"])
    assert "SF258" not in capsys.readouterr().err


def test_a_report_of_a_folder_follows_no_link_out_of_it(place, beside, capsys):
    (place / "work" / "link.toml").symlink_to(beside)
    assert run(["report", ".", "-o", "../report", "--no-pdf", "-j", "1"]) == 2
    assert "leads out of the folder" in capsys.readouterr().err


@pytest.mark.parametrize(
    "written",
    [
        '"K*s/(s + 2)"',
        '{ num = "K*s", den = [1, 2] }',
        '{ num = [1, 0], den = "(s + 2)/K" }',
        '{ type = "tf", num = "K*s", den = "s + 2" }',
    ],
)
def test_a_block_is_a_formula_or_a_ratio_without_a_type(written):
    text = f"""symflex = 1
parameters.K = 3
blocks.G = {written}
signals.y = "G*r"
inputs.r = {{}}
outputs.Y = "y"
"""
    (function,) = pipeline.derive_all(pipeline.loads(text))
    assert transfer.bind(function)(4j) == pytest.approx(12j / (2 + 4j), rel=1e-15)


@pytest.mark.parametrize(
    ("block", "said"),
    [
        ('{ type = "delay", tau = 1 }', "write T"),
        ('{ type = "pid", Kp = 1 }', "write k_p"),
        ('{ type = "low_pass", f = "5 Hz", zeta = 1 }', "write omega"),
        ('{ type = "pid", k_p = 1, T_i = 2 }', 'write k_i = "k_p/T_i"'),
        ('{ type = "pid", k_p = 1, T_v = 2 }', 'write k_d = "k_p*T_v"'),
    ],
)
def test_a_key_that_is_called_otherwise_elsewhere_is_one_problem(block, said):
    with pytest.raises(SpecError) as caught:
        pipeline.loads(
            f'symflex = 1\nblocks.G = {block}\nsignals.y = "G*r"\ninputs.r = {{}}\noutputs.Y = "y"\n'
        )
    assert [(d.code, d.hint) for d in caught.value.diagnostics] == [("SF207", said)]


def model_of_ports(a, b, c, d=0, **changes):
    names = [f"u_{i}" for i in range(b.shape[1])], [f"y_{i}" for i in range(len(c))]
    block = {"type": "ss", "from": names[0], "to": names[1], "A": a, "B": b, "C": c, "D": d} | changes
    block = {key: np.asarray(x).tolist() if key in "ABCD" else x for key, x in block.items() if x is not None}
    inputs, outputs = {u: {} for u in names[0]}, {y.upper(): y for y in names[1]}
    return symflex.Model(blocks={"G": block}, signals={"r": "u_0"}, inputs=inputs, outputs=outputs)


@pytest.mark.parametrize(("inputs", "outputs", "direct"), [(2, 2, True), (1, 3, True), (3, 1, False)])
def test_state_equations_with_ports_have_the_transfer_matrix(inputs, outputs, direct):
    a, b, c = (np.random.default_rng(1).integers(-3, 4, n) for n in ((3, 3), (3, inputs), (outputs, 3)))
    d, s = np.arange(outputs * inputs).reshape(outputs, inputs) * direct, 0.3 + 1.7j
    model = model_of_ports(a, b, c, d if direct else 0)
    found = [[model.transfer_function(y, u).bind()(s) for u in model.inputs] for y in model.outputs]
    expected = c @ np.linalg.solve(s * np.eye(3) - a, b) + d
    assert np.array(found, complex) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"to": ["y_0", "r"]}, "'r' is a signal already"),
        ({"C": [[1, 0]]}, "C of ss 'G' must be 2 x 2, found 1 x 2"),
        ({"from": ["r", "r", "r"]}, "B of ss 'G' must be 2 x 3, found 2 x 2"),
        ({"states": ["p"]}, "A of ss 'G' must be 1 x 1, found 2 x 2"),
        ({"from": None}, "ss 'G' lacks from"),
    ],
)
def test_ports_and_matrices_that_do_not_fit_are_one_problem(change, said):
    with pytest.raises(SpecError) as refused:
        model_of_ports(*[np.eye(2, dtype=int)] * 3, **change)
    assert [d.message for d in refused.value.diagnostics if "unknown name" not in d.message] == [said]
