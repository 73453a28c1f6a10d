import tomllib
from importlib.resources import files

import pytest

from symflex.cli.library import TEMPLATES
from symflex.codegen.exporters import EXPORTERS, SUMMARIES
from tests.unit.cli.commands import WORKED


def test_a_figure_is_written_in_the_format_of_its_name(shell):
    # tests/unit/figures writes the other formats.
    for suffix, begin in (("pgf", b"% Figure of 88.9 mm by"), ("svg", b"<?xml")):
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


def test_the_specification_that_is_read_is_never_overwritten(shell):
    read = shell.folder / "x.toml"
    before = read.read_bytes()
    (shell.folder / "data.csv").write_text("", encoding="utf-8")
    for arguments in (("export", "x.toml", "--to", "c"), ("fit", "data.csv", "--base", "x.toml")):
        done = shell(*arguments, "-o", "../" + shell.folder.name + "/x.toml")
        assert (done.code, read.read_bytes()) == (2, before), arguments
        assert "SF903" in done.err


@pytest.mark.slow
def test_a_figure_is_named_after_specification_and_kind_by_default_and_drawn_by_its_own_name(shell):
    assert shell("plot", "x.toml", "later").code == 0
    assert (shell.folder / "x_later.pdf").exists()


def test_a_figure_that_cannot_be_made_is_a_usage_error(shell):
    for arguments, code in (
        (("bod",), "SF902"), (("bode", "-o", "a.gif"), "SF902"),
        (("bode", "-o", "no/such/folder/a.pdf"), "SF903"), (("bode", "--tf", "X/G"), "SF902"),
        (("bode", "--font", "tims"), "SF902"), (("bode", "--width", "wide"), "SF902"),
        (("bode", "--width", "20"), "SF902"), (("bode", "--band", "2", "1"), "SF902"),
        (("bode", "--band", "0", "1"), "SF902"), (("nyquist", "--band", "0", "1"), "SF902"),
        (("poles_zeros", "--band", "nan", "1"), "SF902"), (("bode", "--band", "1", "2 kg"), "SF902"),
        (("bode", "--band", "1", "2", "--xlim", "1", "2"), "SF902"), (("bode", "--xlim", "0", "1"), "SF902"),
        (("bode", "--ylim", "0", "inf"), "SF902"), (("bode", "--ylim", "0 kg", "1"), "SF902"),
        (("bode", "--phase", "10", "-10"), "SF902"), (("nyquist", "--phase", "-10", "10"), "SF902"),
        (("nyquist", "--xlim", "nan", "1"), "SF902"), (("poles_zeros", "--ylim", "1", "1"), "SF902"),
        (("poles_zeros", "--xlim", "-1 m", "1"), "SF902"), (("modes", "--ylim", "-1", "1"), "SF902"),
    ):  # fmt: skip
        done = shell("plot", "x.toml", *arguments)
        assert done.code == 2, (arguments, code)
        assert f"error[{code}]" in done.err, (arguments, code)


def test_a_figure_is_as_wide_as_asked_for(shell):
    for width, written in (("ieee", "88.5mm"), ("120.5 mm", "120.5mm")):
        assert shell("plot", "x.toml", "poles_zeros", "--width", width, "-o", "a.pgf").code == 0
        text = (shell.folder / "a.pgf").read_text(encoding="ascii")
        assert rf"\pgfpathrectangle{{\pgfpointorigin}}{{\pgfqpoint{{{written}}}" in text, width


@pytest.mark.parametrize(
    "arguments",
    [
        "bode --tf X/F --band 0.5 2kHz --ylim -60dB 20 --phase -200deg 10",
        "poles_zeros --tf X/F --band 0 10 --xlim -3 1Hz --ylim 0 10rad/s",
    ],
)
def test_a_figure_shows_the_part_asked_for(shell, arguments):
    done = shell("plot", "x.toml", *arguments.split(), "-o", "a.svg")
    assert (done.code, done.err) == (0, "wrote a.svg\n")


@pytest.mark.slow
def test_a_band_on_the_command_line_comes_before_that_of_the_figure(shell):
    text = (shell.folder / "x.toml").read_text(encoding="utf-8")
    figure = '\n[figures.near]\nkind = "bode"\nof = ["X/F"]\nband = ["1 Hz", "2 Hz"]\n'
    (shell.folder / "near.toml").write_text(text + figure, encoding="utf-8")
    for name, more in (("own", ()), ("same", ("--band", "1", "2")), ("other", ("--band", "1", "3"))):
        assert shell("plot", "near.toml", "near", *more, "-o", f"{name}.svg").code == 0
    own, same, other = ((shell.folder / f"{name}.svg").read_bytes() for name in ("own", "same", "other"))
    assert own == same
    assert own != other


@pytest.mark.slow
def test_a_figure_takes_the_font_asked_for(shell):
    done = shell("plot", "x.toml", "bode", "--font", "latex", "-o", "a.pdf")
    assert (done.code, done.err) == (0, "wrote a.pdf\n")
    assert b"Cmr10" in (shell.folder / "a.pdf").read_bytes()


def test_a_figure_without_values_says_which(shell):
    done = shell("plot", "symbolic.toml", "bode")
    assert done.code == 3
    assert "parameter 'm' has no value" in done.err


def test_without_a_target_all_targets_are_listed(shell):
    done = shell("export", "x.toml")
    assert done.code == 2
    assert all(target in done.err for target in ("--to", *EXPORTERS))


@pytest.mark.slow
def test_every_target_is_exported_to_stdout(shell):
    for target in EXPORTERS:
        done = shell("export", "x.toml", "--to", target, *(["--no-figures"] if target == "latex" else []))
        assert done.code == 0, target
        assert done.out, target


def test_code_that_could_not_be_verified_is_a_warning_and_ends_with_code_4_when_strict(shell):
    done = shell("export", "symbolic.toml", "--to", "numpy")
    assert done.code == 0
    assert "warning: X/F is not verified" in done.err
    assert shell("export", "symbolic.toml", "--to", "numpy", "--strict").code == 4


def test_a_target_of_two_files_writes_both(shell):
    done = shell("export", "x.toml", "--to", "c", "--tf", "X/F", "-o", "plant.c")
    assert (done.code, done.err) == (0, "wrote plant.c\nwrote plant.h\n")
    assert '#include "plant.h"' in (shell.folder / "plant.c").read_text()
    assert "plant_X_over_F_freq(" in (shell.folder / "plant.h").read_text()


def test_an_unknown_target_or_an_option_of_another_one_is_a_usage_error(shell):
    for options, said in (
        (("--to", "numpy", "--minimal"), "--minimal is for --to state-space"),
        (("--to", "fortran"), f"targets: {', '.join(SUMMARIES)}"),
        (("--to", "c", "-o", "plant.h"), "end its name with .c"),
    ):
        done = shell("export", "x.toml", *options)
        assert (done.code, said in done.err) == (2, True), options
    assert not (shell.folder / "plant.h").exists()


def test_what_has_no_state_equations_ends_with_code_3_and_a_hint(shell):
    for text, code in (
        ('blocks.D = { type = "delay", T = "1 s" }\ninputs.u = {}\noutputs.y = "D*u"', "SF235"),
        ('inputs.u = {}\noutputs.y = "s*u"', "SF236"),
    ):
        (shell.folder / "none.toml").write_text(f"symflex = 1\n{text}\n", encoding="utf-8")
        done = shell("export", "none.toml", "--to", "state-space")
        assert (done.code, done.out) == (3, ""), (text, code)
        assert f"error[{code}]" in done.err, (text, code)
        assert "hint: " in done.err, (text, code)


def test_the_help_of_export_lists_the_targets(shell):
    shown = " ".join(shell("export", "--help").out.split())
    assert all(f"{name} {summary}" in shown for name, summary in SUMMARIES.items())


def test_a_main_function_or_module_is_called_as_its_file(shell):
    assert shell("export", "x.toml", "--to", "matlab", "-o", "beam.m").err == "wrote beam.m\n"
    assert (shell.folder / "beam.m").read_text().startswith("function G = beam()\n%BEAM ")
    assert shell("export", "x.toml", "--to", "matlab").out.startswith("function G = x()\n")
    assert shell("export", "x.toml", "--to", "julia", "-o", "my_beam.jl").code == 0
    assert "\nmodule MyBeam\n" in (shell.folder / "my_beam.jl").read_text()


def test_a_file_that_matlab_could_not_call_is_warned_of(shell):
    for file, name in (("my-beam.m", "my_beam"), ("exp.m", "exp_"), ("2x.m", "p_2x")):
        done = shell("export", "x.toml", "--to", "matlab", "-o", file, "--strict")
        assert done.code == 4, (file, name)
        assert f"warning: MATLAB cannot call a file '{file}': name it '{name}.m'" in done.err, (file, name)
        assert (shell.folder / file).read_text().startswith(f"function G = {name}()\n"), (file, name)


def test_the_list_of_templates_and_the_help_give_a_sentence_to_each(shell):
    listed, said = shell("new").out, shell("new", "--help").out
    assert [line.split()[0] for line in listed.splitlines()] == list(TEMPLATES)
    assert shell("new", "--list").out == listed
    assert all(f"{name}: {text}" in said and text.endswith(".") for name, text in TEMPLATES.items())


def commands_of(template):
    """Return the commands that the head of a template proposes."""
    text = (files("symflex") / "templates" / f"{template}.toml").read_text(encoding="utf-8")
    head = [line for line in text.splitlines()[1:6] if line.startswith("#")]
    return head, [line.partition("symflex ")[2].split() for line in head if "symflex " in line]


def test_a_template_says_at_its_head_what_it_is_and_what_to_try_next():
    for template in TEMPLATES:
        head, commands = commands_of(template)
        assert head[0].endswith(".") and "Try next" in head[1], template
        assert len(commands) >= 2, template


LONG = ("servo", "motor_loop", "sliding_beam")


@pytest.mark.parametrize(
    "template", [pytest.param(t, marks=pytest.mark.slow) if t in LONG else t for t in TEMPLATES]
)
def test_a_template_derives_and_what_it_proposes_works(shell, template):
    done = shell("new", template, "-o", f"{template}.toml")
    assert (done.code, done.out) == (0, "")
    assert tomllib.loads((shell.folder / f"{template}.toml").read_text())["symflex"] == 1
    quick = [words for words in commands_of(template)[1] if words[0] != "plot"]
    for words in (["derive", f"{template}.toml"], ["roots", f"{template}.toml"], *quick):
        assert shell(*words).code == 0, words


@pytest.mark.slow
def test_figures_that_templates_propose_are_drawn(shell):
    for template in TEMPLATES:
        shell("new", template, "-o", f"{template}.toml")
        for words in commands_of(template)[1]:
            assert words[0] != "plot" or shell(*words).code == 0, words


def test_a_template_is_printed_without_a_file_name_and_overwrites_no_file(shell):
    assert shell("new", "two_mass").out.startswith("#:schema symflex.schema.json\nsymflex = 1\n")
    before = (shell.folder / "x.toml").read_text()
    done = shell("new", "two_mass", "-o", "x.toml")
    assert (done.code, (shell.folder / "x.toml").read_text()) == (2, before)
    assert "error[SF903]" in done.err
    unknown = shell("new", "two_mas")
    assert (unknown.code, "did you mean 'two_mass'?" in unknown.err) == (2, True)


def test_a_transfer_function_that_is_zero_is_left_out_of_a_plot(shell):
    path = shell.folder / "zero.toml"
    path.write_text(path.with_name("x.toml").read_text().replace('V = "s*x"', 'V = "s*x", Z = "0*x"'))
    done = shell("plot", "zero.toml", "poles_zeros", "-o", "a.svg")
    left_out = "Z/F is identically zero and is left out\nwrote a.svg\n1 warning: symflex check zero.toml\n"
    assert (done.code, done.err.endswith(left_out)) == (0, True)


def test_a_file_and_a_figure_in_the_wrong_order_are_put_right(shell):
    done = shell("plot", "bode", "x.toml")
    assert (done.code, done.err.endswith("the file comes first: symflex plot x.toml bode\n")) == (2, True)


@pytest.mark.slow
def test_what_is_written_in_band_form_is_called_so(shell):
    arm = WORKED / "frames" / "two_link_arm.toml"
    for target, said in (("c", "theta_2/tau is in band form"), ("numpy", "solved as a network")):
        assert shell("export", str(arm), "--to", target).err.startswith(said), target
