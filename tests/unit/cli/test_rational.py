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
    page = (ROOT / "docs" / "command-line.md").read_text(encoding="utf-8")
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
