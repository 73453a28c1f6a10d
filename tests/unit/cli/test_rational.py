import pytest

from tests.unit.analysis.rods import CLAMPED_ROD
from tests.unit.cli.commands import ROOT

KEYS = {
    "schema", "tf", "quantity", "unit", "form", "modes", "exact", "certified", "gain", "num", "den", "poles",
    "zeros", "residues", "correction", "order_at_zero", "leading_coefficient", "valid_to_hz", "error",
    "outside_hz", "sampled", "omitted_hz", "stability",
}  # fmt: skip


@pytest.fixture
def rod(shell):
    (shell.folder / "rod.toml").write_text(CLAMPED_ROD, encoding="utf-8")
    return shell


def test_json_has_the_documented_keys(rod):
    for form in ("product", "modal"):
        done = rod("rational", "rod.toml", "--tf", "X/F", "--modes", "1", "--form", form, "--json")
        assert (done.code, done.err) == (0, ""), form
        assert set(done.json) == KEYS, form
    page = (ROOT / "docs" / "commands" / "rational.md").read_text(encoding="utf-8")
    section = page.partition("### `symflex.rational/1`")[2].partition("\n#")[0]
    assert all(f"`{key}`" in section for key in KEYS - {"schema"})


def test_json_of_a_modal_form_lists_residues(rod):
    # tanh(s)/s = sum 2/(s^2 + ((n - 1/2) pi)^2): residue 1/(j (n - 1/2) pi)
    document = rod("rational", "rod.toml", "--tf", "X/F", "--modes", "1", "--form", "modal", "--json").json
    (first, second) = document["residues"]
    assert float(first["coefficients"][0]["im"]) == pytest.approx(-2 / 3.141592653589793)
    assert float(second["coefficients"][0]["im"]) == pytest.approx(2 / 3.141592653589793)


def test_text_says_where_it_is_valid_and_that_this_is_sampled(rod):
    out = rod("rational", "rod.toml", "--tf", "X/F", "--modes", "2").out
    assert "within 1 % of the exact function up to " in out
    assert "within 5 % of the exact function up to " in out
    assert "not proved" in out


def test_text_of_a_lumped_system_says_that_it_is_exact(shell):
    done = shell("rational", "x.toml")
    assert "  exact: nothing is left out of this rational function" in done.out.splitlines()
    assert "  gain: 0.5" in done.out.splitlines()
    assert done.err == "showing X/F; choose with --tf: V/F\n"


@pytest.mark.slow
def test_text_fits_eighty_columns(shell):
    for name in ("eppinger1988/six_mass", "classics/clamped_free"):
        for form in ("product", "modal"):
            out = shell("rational", ROOT / "derivations" / f"{name}.toml", "--form", form).out
            assert max(map(len, out.splitlines())) <= 80, (name, form)
    assert shell("rational", "x.toml", "--form", "partial").code == 2


SUM = """
symflex = 1
inputs = { u = {}, v = {} }
outputs = { y = "u/(s + 1) + v/(s + 50)", z = "u/(s + 900)" }
"""


@pytest.fixture
def several(shell):
    (shell.folder / "sum.toml").write_text(SUM, encoding="utf-8")
    return shell


def test_state_equations_have_a_proved_error_and_the_documented_keys(several):
    # y/u is kept whole; 1/(s + 900) keeps its static value 1/900 only, and is off by that far out.
    done = several("rational", "sum.toml", "--matrix", "--modes", "2", "--json")
    assert done.code == 0 and done.json["error"]["least"] <= 1 / 900 <= done.json["error"]["most"] * 1.0001
    page = (ROOT / "docs" / "commands" / "rational.md").read_text(encoding="utf-8")
    section = page.partition("### `symflex.reduced/1`")[2].partition("\n#")[0]
    assert all(f"`{key}`" in section for key in done.json.keys() - {"schema"})


def test_a_specification_of_the_equations_is_written(several):
    done = several("rational", "sum.toml", "--tf", "y/u", "--error", "0.1", "-o", "reduced.toml")
    assert done.code == 0 and done.err == "wrote reduced.toml\n"
    assert several("derive", "reduced.toml").code == 0


def test_an_error_is_a_share_with_or_without_percent(several):
    # y/u has one mode with all of it: the fewest for any error.
    for share in ("10%", "10 %", "0.1"):
        done = several("rational", "sum.toml", "--tf", "y/u", "--error", share, "--json")
        assert done.code == 0 and done.json["modes"] == 1, share


def test_norms_of_a_matrix_are_printed(several):
    # By hand: the largest singular value is at 0 Hz; squares of H2 norms are 1/2, 1/100 and 1/1800.
    assert "largest singular value 1.000" in several("peak", "sum.toml", "--matrix").out
    norm = several("peak", "sum.toml", "--matrix", "--h2", "--json").json
    assert float(norm["h2"]["value"]) == pytest.approx((1 / 2 + 1 / 100 + 1 / 1800) ** 0.5)
    page = (ROOT / "docs" / "commands" / "peak.md").read_text(encoding="utf-8")
    section = page.partition("### `symflex.h2/1`")[2].partition("\n#")[0]
    assert all(f"`{key}`" in section for key in norm.keys() - {"schema"})


def test_options_that_do_not_go_together_are_refused(several):
    for given in (
        ("rational", "sum.toml", "--error", "0.1", "--modes", "2"),
        ("rational", "sum.toml", "--error", "0.1", "--form", "modal"),
        ("rational", "sum.toml", "--error", "-1"),
        ("rational", "sum.toml", "--in", "u"),
        ("rational", "sum.toml", "--matrix", "--tf", "y/u"),
        ("rational", "sum.toml", "--matrix", "--in", "w"),
        ("peak", "sum.toml", "--noise", "1/s"),
        ("peak", "sum.toml", "--h2", "--band", "1", "2"),
        ("peak", "sum.toml", "--h2", "--noise", "1/(s + w)"),
        ("peak", "sum.toml", "--out", "y"),
    ):
        done = several(*given)
        assert done.code in (2, 3) and "error[SF" in done.err, given
