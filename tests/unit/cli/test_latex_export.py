"""LaTeX from the command line: columns, forms, one document or files for a paper."""

import re

import pytest

# A third mass would need no more of the printer; long names need lines in a column.
CHAIN = """symflex = 1
[parameters]
m_actuator = "2 kg"
m_payload = "3 kg"
k_transmission = "18 N/m"
b_transmission = "0.5 N*s/m"
[elements]
a = { type = "mass", at = "x", m = "m_actuator" }
b = { type = "mass", at = "y", m = "m_payload" }
c = { type = "spring", between = ["x", "y"], k = "k_transmission" }
d = { type = "damper", between = ["x", "y"], b = "b_transmission" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
Y = "y"
"""


@pytest.fixture
def chain(shell):
    (shell.folder / "chain.toml").write_text(CHAIN, encoding="utf-8")
    return shell


def test_an_equation_is_broken_to_the_column_asked_for(chain):
    arguments = ("derive", "chain.toml", "--tf", "X/F", "--format", "latex", "--form", "polynomial")
    plain, wide, narrow = (
        chain(*arguments, *more).out for more in ((), ("--width", "300mm"), ("--width", "ieee"))
    )
    assert plain == wide
    assert r"\begin{align}" not in plain
    assert narrow.count(r"\\") == 4


def test_a_width_or_form_that_does_not_apply_is_a_usage_error(shell):
    for arguments in (
        ("derive", "x.toml", "--width", "ieee"),
        ("derive", "x.toml", "--json", "--format", "latex", "--width", "ieee"),
        ("derive", "x.toml", "--format", "latex", "--width", "wide"),
        ("export", "x.toml", "--to", "numpy", "--width", "ieee"),
        ("export", "x.toml", "--to", "numpy", "--form", "monic"),
        ("export", "x.toml", "--to", "numpy", "--no-figures"),
        ("export", "x.toml", "--to", "latex", "--width", "3mm"),
        ("export", "x.toml", "--to", "latex", "--form", "hyperbolic"),
    ):
        done = shell(*arguments)
        assert (done.code, done.out) == (2, ""), arguments
        assert "error[SF902]" in done.err, arguments


@pytest.mark.slow
def test_a_folder_holds_a_file_for_every_function_and_table(chain):
    done = chain("export", "chain.toml", "--to", "latex", "-o", "paper/")
    assert (done.code, done.out, done.err) == (0, "", "wrote 12 files to paper/\n")
    files = {p.name: p.read_text(encoding="ascii") for p in (chain.folder / "paper").iterdir()}
    tables = [f"{tf}_over_F{kind}.tex" for tf in "XY" for kind in ("", "_poles", "_zeros")]
    figures = [f"{kind}.pgf" for kind in ("bode", "poles_zeros", "modes")]
    assert set(files) == {"document.tex", "modes.tex", "parameters.tex", *tables, *figures}
    inputs = re.findall(r"\\input\{([^}]*)\}", files.pop("document.tex"))
    figures = {"bode.pgf", "poles_zeros.pgf", "modes.pgf"}
    assert {name if name in figures else f"{name}.tex" for name in inputs} == set(files)
    assert r"\label{eq:X_over_F}" in files["X_over_F.tex"]
    needs = {name: re.search(r"\\usepackage\{([a-z,]+)\}", text)[1] for name, text in files.items()}
    assert needs["bode.pgf"] == "pgf"
    assert needs["X_over_F.tex"] == "amsmath"
    assert needs["X_over_F_poles.tex"] == "amsmath,array,booktabs,siunitx"


def test_the_files_make_the_same_document_as_the_document(chain):
    whole = chain("export", "chain.toml", "--to", "latex", "--width", "120").out
    chain("export", "chain.toml", "--to", "latex", "--width", "120", "--no-figures", "-o", "paper/")

    def contents(match):
        lines = (chain.folder / "paper" / f"{match[1]}.tex").read_text().splitlines()
        return "\n".join(lines[2:])

    document = (chain.folder / "paper" / "document.tex").read_text()
    joined = re.sub(r"\\input\{([^}]*)\}", contents, document)
    assert [line for line in joined.splitlines() if line] == [line for line in whole.splitlines() if line]


def test_a_model_without_values_has_no_poles_but_a_document(shell):
    done = shell("export", "symbolic.toml", "--to", "latex", "--strict")
    assert (done.code, done.err) == (0, "")
    assert "Poles" not in done.out
    assert "symbolic" in done.out


def test_functions_whose_files_would_share_a_name_have_two(shell):
    text = (shell.folder / "x.toml").read_text().replace('V = "s*x"', 'V = "s*x", v = "2*s*x"')
    (shell.folder / "case.toml").write_text(text, encoding="utf-8")
    assert shell("export", "case.toml", "--to", "latex", "--no-figures", "-o", "paper/").code == 0
    names = [p.name.lower() for p in (shell.folder / "paper").iterdir()]
    assert len(set(names)) == len(names)
    assert {"v_over_f.tex", "v_over_f_2.tex"} <= set(names)
