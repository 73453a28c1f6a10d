from __future__ import annotations

import tomllib

import pytest

from symflex.cli.new import TEMPLATES
from symflex.emit.exporters import EXPORTERS


@pytest.mark.parametrize(
    ("suffix", "begin"), [("pdf", b"%PDF"), ("svg", b"<?xml"), ("png", b"\x89PNG")], ids=str
)
def test_a_figure_is_written_in_the_format_of_its_name(shell, suffix, begin):
    done = shell("plot", "x.toml", "poles_zeros", "-o", f"a.{suffix}")
    assert (done.code, done.out, done.err) == (0, "", f"wrote a.{suffix}\n")
    assert (shell.folder / f"a.{suffix}").read_bytes().startswith(begin)


def test_as_many_modes_are_drawn_as_asked_for(shell):
    chain = (
        'symflex = 1\ninputs.F = { force = "x" }\noutputs = { X = "x", Y = "y" }\n[elements]\n'
        'a = { type = "mass", at = "x", m = "1 kg" }\nb = { type = "mass", at = "y", m = "1 kg" }\n'
        'c = { type = "spring", between = ["x", "y"], k = "1 N/m" }\n'
        'd = { type = "spring", between = ["x", "ground"], k = "1 N/m" }\n'
    )
    (shell.folder / "chain.toml").write_text(chain, encoding="utf-8")
    sizes = []
    for count in (1, 2):
        done = shell("plot", "chain.toml", "modes", "--modes", count, "-o", f"{count}.svg")
        assert (done.code, done.err) == (0, f"wrote {count}.svg\n")
        sizes.append((shell.folder / f"{count}.svg").stat().st_size)
    assert sizes[0] < sizes[1]


def test_a_figure_is_named_after_specification_and_kind_by_default(shell):
    assert shell("plot", "x.toml", "bode", "--tf", "X/F").code == 0
    assert (shell.folder / "x_bode.pdf").exists()


def test_a_figure_of_the_specification_is_drawn_by_its_name(shell):
    assert shell("plot", "x.toml", "paper", "-o", "paper.svg").code == 0


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (("bod",), "SF902"),
        (("later",), "SF911"),
        (("bode", "-o", "a.gif"), "SF902"),
        (("bode", "-o", "no/such/folder/a.pdf"), "SF903"),
        (("bode", "--tf", "X/G"), "SF902"),
    ],
    ids=str,
)
def test_a_figure_that_cannot_be_made_is_a_usage_error(shell, arguments, code):
    done = shell("plot", "x.toml", *arguments)
    assert done.code == 2
    assert f"error[{code}]" in done.err


def test_a_figure_without_values_says_which(shell):
    done = shell("plot", "symbolic.toml", "bode")
    assert done.code == 3
    assert "parameter 'm' has no value" in done.err


@pytest.mark.parametrize("target", EXPORTERS)
def test_every_target_is_exported_to_stdout(shell, target):
    done = shell("export", "x.toml", "--to", target)
    assert done.code == 0
    assert done.out


def test_an_exported_module_computes_the_receptance(shell):
    assert (
        shell("export", "x.toml", "--to", "numpy", "--tf", "X/F", "-o", "x_over_f.py").err
        == "wrote x_over_f.py\n"
    )
    space = {}
    exec(compile((shell.folder / "x_over_f.py").read_text(), "x_over_f.py", "exec"), space)  # noqa: S102
    # 1/(m s^2 + k) at s = j, with m = 2 and k = 18
    assert space["X_over_F"](1j) == pytest.approx(1 / 16)


def test_the_help_lists_the_targets(shell):
    text = shell("export", "--help").out
    assert all(f"  {target} " in text for target in EXPORTERS)


def test_code_that_could_not_be_verified_is_a_warning(shell):
    done = shell("export", "symbolic.toml", "--to", "numpy")
    assert done.code == 0
    assert "warning: X/F is not verified" in done.err


def test_code_that_could_not_be_verified_ends_with_code_4_when_strict(shell):
    assert shell("export", "symbolic.toml", "--to", "numpy", "--strict").code == 4


def test_an_unknown_target_is_a_usage_error_that_lists_the_targets(shell):
    done = shell("export", "x.toml", "--to", "fortran")
    assert done.code == 2
    assert f"targets: {', '.join(EXPORTERS)}" in done.err


def test_templates_are_listed_with_a_summary(shell):
    lines = shell("new").out.splitlines()
    assert [line.split()[0] for line in lines] == list(TEMPLATES)


@pytest.mark.parametrize("template", TEMPLATES)
def test_every_template_is_a_specification_that_derives(shell, template):
    done = shell("new", template, "-o", "fresh.toml")
    assert (done.code, done.out) == (0, "")
    assert tomllib.loads((shell.folder / "fresh.toml").read_text())["symflex"] == 1
    assert shell("derive", "fresh.toml").code == 0
    assert shell("roots", "fresh.toml").code == 0


def test_a_template_is_printed_without_a_file_name(shell):
    assert shell("new", "two_mass").out.startswith("symflex = 1\n")


def test_an_existing_file_is_not_overwritten(shell):
    before = (shell.folder / "x.toml").read_text()
    done = shell("new", "two_mass", "-o", "x.toml")
    assert (done.code, (shell.folder / "x.toml").read_text()) == (2, before)
    assert "error[SF903]" in done.err


def test_an_unknown_template_is_a_usage_error_with_a_hint(shell):
    done = shell("new", "two_mas")
    assert done.code == 2
    assert "did you mean 'two_mass'?" in done.err


def test_a_transfer_function_that_is_zero_is_left_out_of_a_plot(shell):
    path = shell.folder / "zero.toml"
    path.write_text(path.with_name("x.toml").read_text().replace('V = "s*x"', 'V = "s*x", Z = "0*x"'))
    done = shell("plot", "zero.toml", "poles_zeros", "-o", "a.svg")
    assert (done.code, done.err) == (0, "Z/F is identically zero and is left out\nwrote a.svg\n")
