import pytest

from tests.unit.audit.beam import COLOCATED, SCALE, TIP, VAUGHAN, specification

KEYS = {
    "tf", "source", "verdict", "certified", "unread", "printed", "scale", "where", "ratio", "changes",
    "corrected", "derived", "counterexample", "agreed_points", "deviation", "laws", "units", "numeric",
    "right_where",
}  # fmt: skip


@pytest.fixture
def beam(tmp_path):
    def write(expr, where=VAUGHAN, scale=SCALE):
        path = tmp_path / "beam.toml"
        path.write_text(specification("V_tip", expr, where, scale), encoding="utf-8")
        return str(path)

    return write


def test_an_equal_formula_exits_with_zero_under_strict(shell, beam):
    assert shell("audit", beam(TIP), "--strict").code == 0


@pytest.mark.slow
def test_a_difference_is_a_result_and_exits_with_four_under_strict(shell, beam):
    path = beam(COLOCATED)
    done = shell("audit", path)
    assert done.code == 0
    assert "DIFFERS" in done.out
    strict = shell("audit", path, "--json", "--strict")
    assert strict.code == 4
    assert strict.json["schema"] == "symflex.audit/1"
    assert [set(entry) for entry in strict.json["audits"]] == [KEYS]


def test_what_is_not_proved_exits_with_four_under_strict(shell, beam):
    done = shell("audit", beam(f"log(exp(1))*{TIP}"), "--strict")
    assert done.code == 4
    assert "NOT PROVED" in done.out


@pytest.mark.slow
def test_json_says_what_changes(shell, beam):
    (entry,) = shell("audit", beam(TIP.replace("*C*(", "*S*(")), "--json").json["audits"]
    assert entry["changes"] == [{"place": "numerator", "printed": "S", "derived": "C"}]
    assert entry["corrected"]["expr"] == TIP


def test_a_formula_that_was_not_published_is_a_usage_error(shell, beam):
    done = shell("audit", beam(TIP), "--tf", "V_act/F")
    assert done.code == 2
    assert "nothing is published for 'V_act/F'" in done.err


def test_a_specification_that_publishes_nothing_says_so(shell, tmp_path, beam):
    path = beam(TIP)
    text = (tmp_path / "beam.toml").read_text(encoding="utf-8").partition("[published")[0]
    (tmp_path / "beam.toml").write_text(text, encoding="utf-8")
    done = shell("audit", path)
    assert (done.code, done.out) == (0, "")
    assert "nothing is published" in done.err


def test_a_mistake_in_a_formula_is_shown_at_its_place(shell, beam):
    done = shell("audit", beam("1/(rho*Area)"))
    assert done.code == 3
    assert "error[SF210]: unknown name 'Area' in a printed formula" in done.err


def test_mistakes_in_several_formulas_are_shown_together(shell, tmp_path, beam):
    path = beam("1/Area")
    with open(path, "a", encoding="utf-8") as file:
        file.write('[published."V_act/F"]\nexpr = "s^l"\n')
    done = shell("audit", path)
    assert done.code == 3
    assert "SF210" in done.err
    assert "SF225" in done.err
