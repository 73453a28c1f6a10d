"""What holds for all commands: exit codes, streams, width, colour, pipes."""

import errno
import os
import pty
import re
import subprocess
import sys

import pytest

from symflex import __version__
from symflex.cli import COMMANDS, run
from symflex.cli.reporting import listed
from symflex.errors import BudgetError, Diagnostic
from symflex.library.elements import ELEMENTS
from symflex.transfer import of_model
from tests.unit.cli.commands import ROOT, TWO_MASS

SPEC_COMMANDS = (
    ("check",),
    ("derive",),
    ("roots",),
    ("rational",),
    ("plot", "bode"),
    ("export", "--to", "numpy"),
)
WIDE = (
    "eppinger1988/base_flexure",
    "eppinger1988/polynomial_resonance",
    "eppinger1988/sliding_free_beam",
    "eppinger1988/loops/lumped_bending_beam_force",
    "classics/rod_tip_mass",
)
"""Long fractions, decimals of many digits, definitions of a beam, a loop, a field with its laws."""
UNBREAKABLE = re.compile(r"^ *\S*$")


def with_spec(command, spec):
    return (command[0], spec, *command[1:])


def subprocess_environment(**more):
    return {**os.environ, "PYTHONPATH": str(ROOT), **more}


def test_a_file_that_cannot_be_used_ends_with_its_code_and_prints_nothing_to_stdout(shell):
    for command in SPEC_COMMANDS:
        for name, code, said in (
            ("nowhere.toml", 2, "error[SF901]"),
            ("wrong.toml", 3, "error[SF210]"),
            ("floating.toml", 3, "error[SF301]"),
        ):
            done = shell(*with_spec(command, name))
            assert (done.code, done.out, said in done.err) == (code, "", True), (command, name)


def test_what_kept_derivations_is_refused_with_a_hint(shell):
    for words in (("cache",), ("cache", "--clear"), ("derive", "two_mass.toml", "--no-cache")):
        done = shell(*words)
        assert (done.code, done.out) == (2, ""), words
        assert "no longer caches derivations on disk: leave this option out" in done.err, words


def test_an_exceeded_budget_ends_with_code_5(shell, monkeypatch):
    def too_large(*_):
        raise BudgetError(Diagnostic("SF501", "too large, for this test"))

    monkeypatch.setattr(of_model, "derive_from", too_large)
    done = shell("derive", "x.toml", "--representation", "expanded")
    assert (done.code, done.err) == (5, "error[SF501]: too large, for this test\n")


def test_what_the_system_refuses_is_an_error_with_a_code(shell, monkeypatch):
    def refuse(*_):
        raise OSError(errno.EMFILE, os.strerror(errno.EMFILE))

    monkeypatch.setattr(of_model, "derive_from", refuse)
    done = shell("derive", "x.toml")
    assert (done.code, done.out) == (2, "")
    assert done.err == "error[SF905]: the system refused an operation: Too many open files\n"


def test_what_is_too_large_expanded_is_printed_in_nested_form(shell, monkeypatch):
    def too_large(*_):
        raise BudgetError(Diagnostic("SF501", "too large, for this test"))

    monkeypatch.setattr(of_model, "derive_from", too_large)
    done = shell("derive", "x.toml")
    assert (done.code, done.err) == (0, "in nested form: too large, for this test\n")
    assert "hidden modes: not examined" in done.out


def test_exhausted_memory_ends_with_code_5(shell, monkeypatch):
    def exhausted(*_):
        raise MemoryError

    monkeypatch.setattr(of_model, "derive_from", exhausted)
    done = shell("derive", "x.toml")
    assert (done.code, done.err.splitlines()[0]) == (5, "error[SF504]: out of memory")


def test_a_command_used_wrongly_ends_with_code_2(shell):
    for arguments in (("derve",), ("derive",), ("derive", "x.toml", "--wrong"), ("--wrong",)):
        done = shell(*arguments)
        assert (done.code, done.out) == (2, ""), arguments
    assert "Did you mean 'derive'?" in shell("derve").err


def test_a_value_that_a_later_one_would_replace_is_refused(shell):
    done = shell("contact", "x.toml", "--environment", "spring", "--port", "a", "--port", "b")
    assert (done.code, done.out) == (2, "")
    assert "'--port' is given 2 times" in done.err


def test_a_range_without_both_ends_says_how_it_is_written(shell):
    for words in (["--range", "K", "10"], ["--range", "a", "b", "--over", "K"]):
        assert "needs both ends" in shell("passivity", "x.toml", *words).err


def test_without_a_command_the_help_is_shown(shell):
    done = shell()
    assert "Analyse:" in done.out + done.err


def test_every_command_has_help_in_80_columns(shell):
    for command in COMMANDS:
        done = shell(command, "--help")
        assert done.code == 0, command
        assert max(map(len, done.out.splitlines())) <= 80, command


def test_the_version_is_the_packages(shell):
    assert shell("--version").out == f"symflex, version {__version__}\n"


@pytest.mark.slow
def test_output_keeps_to_80_columns(shell, monkeypatch):
    # The path printed is the one given, and where the checkout lies is not the program's to shorten.
    monkeypatch.chdir(ROOT)
    wide = {}
    for name in WIDE:
        for command in (("check",), ("derive",), ("roots", "--digits", "15")):
            out = shell(*with_spec(command, f"derivations/{name}.toml")).out
            wide[name, command] = [x for x in out.splitlines() if len(x) > 80 and not UNBREAKABLE.match(x)]
    assert {key: lines for key, lines in wide.items() if lines} == {}


def test_the_library_keeps_to_80_columns(shell):
    for name in (None, *ELEMENTS):
        out = shell("elements", *([name] if name else [])).out
        assert max(map(len, out.splitlines())) <= 80, name


def test_a_long_list_is_broken_between_its_items_only():
    text = listed("names: ", [f"OUT_{i}/IN" for i in range(40)])
    assert max(map(len, text.splitlines())) <= 80
    assert " ".join(text.split()) == "names: " + ", ".join(f"OUT_{i}/IN" for i in range(40))


def test_an_error_is_not_coloured_where_there_is_no_terminal(shell):
    assert "\x1b" not in shell("check", "wrong.toml").err


def error_on_a_terminal(folder, **environment):
    """Return what ``symflex check wrong.toml`` writes to stderr when that is a terminal."""
    control, terminal = pty.openpty()
    variables = {k: v for k, v in subprocess_environment(**environment).items() if v}
    command = [sys.executable, "-m", "symflex", "check", "wrong.toml"]
    subprocess.run(
        command, cwd=folder, env=variables, stderr=terminal, stdout=subprocess.DEVNULL, check=False
    )
    os.close(terminal)
    written = os.read(control, 100_000)
    os.close(control)
    return written


@pytest.mark.slow
def test_an_error_is_coloured_on_a_terminal_unless_no_color_is_set(shell):
    assert b"\x1b[31m" in error_on_a_terminal(shell.folder, NO_COLOR="")
    assert b"\x1b" not in error_on_a_terminal(shell.folder, NO_COLOR="1")


@pytest.mark.parametrize("words", [("derive", str(TWO_MASS)), ("roots", "--help")])
@pytest.mark.slow
def test_a_reader_that_goes_away_is_no_error(words):
    command = [sys.executable, "-m", "symflex", *words]
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(
        command, env=subprocess_environment(), stdout=writing, stderr=subprocess.PIPE, text=True, check=False
    )
    os.close(writing)
    assert (done.returncode, done.stderr) == (0, "")


def test_control_characters_of_a_file_do_not_reach_the_terminal(shell):
    (shell.folder / "evil.toml").write_text('symflex = 1\n[parameters]\nm = "2 \\u001b[31mkg"\n')
    assert "\x1b" not in shell("check", "evil.toml").err


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["poles", "axis.toml"], "Write: symflex roots SPEC"),
        (["help"], "Write: symflex --help"),
        (["axis.toml"], "The command comes first: symflex derive axis.toml"),
        (["bode", "axis.toml"], "symflex plot SPEC bode"),
    ],
)
def test_a_command_by_another_name_is_told_its_own(arguments, said, shell):
    done = shell(*arguments)
    assert done.code == 2
    assert said in done.err


@pytest.mark.parametrize(
    ("words", "spelling"),
    [
        (("roots", "SPEC", "--symbolic"), ("roots", "SPEC", "--letters")),
        (("stability", "SPEC", "--symbolic"), ("stability", "SPEC", "--letters")),
        (("derive", "SPEC"), ("derive", "SPEC", "--symbolic")),
        (("new", "--help"), ("init", "--help")),
    ],
)
def test_earlier_and_common_spellings_do_the_same(words, spelling, capsys):
    printed = []
    for said in (words, spelling):
        run([str(TWO_MASS) if word == "SPEC" else word for word in said])
        printed.append(capsys.readouterr().out.replace("symflex init", "symflex new"))
    assert printed[0] == printed[1] != ""
