import math
import re

import pytest

from tests.unit.cli.commands import OSCILLATOR, WORKED


def test_a_good_specification_is_summed_up_on_stdout(shell):
    done = shell("check", "x.toml")
    assert (done.code, done.err) == (0, "")
    assert done.out.splitlines() == [
        "x.toml: ok",
        "  Mass on a spring",
        "  2 parameters, 1 node, 2 elements",
        "  transfer functions: X/F, V/F",
    ]


def test_parameters_without_value_are_named_and_problems_are_reported_with_their_places(shell):
    assert "symbolic (no value): m" in shell("check", "symbolic.toml").out
    for name, said in (
        ("wrong.toml", ("wrong.toml:6:29: error[SF210]", "error[SF203]")),
        ("floating.toml", ("error[SF301]: nothing determines node 'x'",)),
    ):
        done = shell("check", name)
        assert (done.code, done.out) == (3, ""), name
        assert all(text in done.err for text in said), name


def test_json_of_a_good_specification(shell):
    assert shell("check", "x.toml", "--json").json == {
        "schema": "symflex.check/1",
        "ok": True,
        "problems": [],
        "warnings": [],
        "transfer_functions": ["X/F", "V/F"],
        "conversions": [],
        "free_ends": [],
    }


def test_what_is_declared_in_cycles_is_listed_as_it_is_used(shell):
    text = """symflex = 1
parameters = { f_c = "50 Hz", n = "3000 rpm", r = "5 mm/rev", f_s = "1 kHz", f = { unit = "Hz" } }
definitions = { f_0 = "10 Hz" }
inputs.u = {}
outputs.y = "u*f_c/(s + f_c) + n*u/s + exp(-s/f_s)*u + u*f_0/(s + f)"
outputs.x = "r*u"
"""
    (shell.folder / "turns.toml").write_text(text)
    assert shell("check", "turns.toml").out.splitlines()[-5:] == [
        "  f_c = 50 Hz, used as 314.159 rad/s",
        "  n = 3000 rpm, used as 314.159 rad/s",
        "  r = 5 mm/rev, used as 0.000795775 m/rad",
        "  f in Hz, used in rad/s",
        "  f_0 = 10 Hz, used as 62.8319 rad/s",
    ]
    found = shell("check", "turns.toml", "--json").json["conversions"]
    assert [c["name"] for c in found] == ["f_c", "n", "r", "f", "f_0"]
    assert found[1] == {
        "name": "n",
        "declared": 3000,
        "declared_unit": "rpm",
        "value": pytest.approx(100 * math.pi),
        "unit": "rad/s",
    }
    assert found[3]["declared"] is None is found[3]["value"]


def test_free_ends_are_counted_and_named(shell):
    line = 'EI = "9 N*m^2", rhoA = "2 kg/m", l = "1 m"'
    arms = "".join(f'{n} = {{ type = "beam", between = ["hub", "{n}_end"], {line} }}\n' for n in ("a", "b"))
    hub = 'hub = { type = "slider", at = "hub" }\n'
    ends = 'symflex = 1\ninputs.F = { force = "hub.y" }\noutputs.X = "hub.y"\n'
    (shell.folder / "arms.toml").write_text(f"{ends}[elements]\n{hub}{arms}", encoding="utf-8")
    assert shell("check", "arms.toml").out.splitlines()[-1] == "  2 free ends: a_end of a, b_end of b"
    assert shell("check", "arms.toml", "--json").json["free_ends"] == [
        {"element": "a", "node": "a_end"},
        {"element": "b", "node": "b_end"},
    ]


def test_json_of_a_wrong_specification_lists_the_problems_on_stdout(shell):
    done = shell("check", "wrong.toml", "--json")
    assert (done.code, done.err, done.json["ok"]) == (3, "", False)
    problem = next(p for p in done.json["problems"] if p["code"] == "SF210")
    place = {"file": "wrong.toml", "line": 6, "column": 29, "end_line": 6, "end_column": 30}
    assert {k: problem[k] for k in place} == place
    assert set(problem) == {"code", "message", *place, "hint"}


def test_json_of_a_file_that_does_not_exist_names_no_place(shell):
    done = shell("check", "nowhere.toml", "--json")
    assert done.code == 2
    assert done.json["problems"][0]["code"] == "SF901"
    assert done.json["problems"][0]["line"] is None


def test_models_of_every_kind_pass(shell):
    """Masses, a beam with a printed formula, a loop, a frame, and a field that tapers."""
    for name in (
        "classics/quarter_car",
        "eppinger1988/sliding_free_beam",
        "eppinger1988/loops/two_mass_force",
        "frames/portal_frame",
        "tapers/wedge",
    ):
        assert shell("check", WORKED / f"{name}.toml").code == 0, name


MISSPELT = OSCILLATOR.replace('"ground"', '"gruond"')


def test_a_warning_is_printed_with_its_place_and_the_model_is_ok(shell):
    (shell.folder / "y.toml").write_text(MISSPELT, encoding="utf-8")
    done = shell("check", "y.toml")
    assert (done.code, done.out.splitlines()[0]) == (0, "y.toml: ok, 1 warning")
    assert done.err.splitlines() == [
        "y.toml:9:44: warning[SF650]: only spring 'wall' touches node 'gruond' and nothing reads it: "
        "it changes nothing",
        '  9 | wall = { type = "spring", between = ["x", "gruond"], k = "k" }',
        "    |                                            ^^^^^^",
        "  hint: did you mean 'ground'?",
    ]


def test_strict_makes_a_warning_exit_3(shell):
    (shell.folder / "y.toml").write_text(MISSPELT, encoding="utf-8")
    assert [shell("check", name, "--strict").code for name in ("x.toml", "y.toml")] == [0, 3]


def test_warnings_stand_in_the_json_as_problems_do(shell):
    (shell.folder / "y.toml").write_text(MISSPELT, encoding="utf-8")
    done = shell("check", "y.toml", "--json", "--strict")
    assert (done.code, done.err, done.json["ok"], done.json["problems"]) == (3, "", True, [])
    (warning,) = done.json["warnings"]
    assert (warning["code"], warning["line"], warning["column"]) == ("SF650", 9, 44)


def wrong_warnings(shell, *commands):
    """Return the commands that print or count the warnings of a specification never, twice, or on stdout."""
    (shell.folder / "y.toml").write_text(MISSPELT, encoding="utf-8")
    done = {command: shell(command.split()[0], "y.toml", *command.split()[1:]) for command in commands}
    told = re.compile("SF650|1 warning: symflex check y.toml")
    return {c: d for c, d in done.items() if len(told.findall(d.err)) != 1 or told.search(d.out)}


@pytest.mark.slow
def test_every_command_that_reads_a_specification_prints_its_warnings_once(shell):
    assert not wrong_warnings(
        shell, "derive", "roots", "rational --modes 1", "export --to numpy", "audit", "stability --gain k",
        "measure --tf X/F --band 1 2 -o a.csv", "colocation --tf X/F --with V/F", "plot later -o a.svg",
    )  # fmt: skip


@pytest.mark.slow
def test_commands_that_take_long_print_their_warnings_once_too(shell):
    assert not wrong_warnings(shell, "sweep --over k=1,2 --of poles --workers 1", "report --no-pdf -o r")
