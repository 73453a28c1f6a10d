import pytest

from symflex.editor import completions, examined, fixes, folds, hover, renamed, tidied
from symflex.errors import UsageError

MODEL = """symflex = 1
title = "Mass m on a spring k"
[parameters]
m = "3 kg"
k = { value = "20 kN/m", doc = "wire" }
[definitions]
omega_0 = "sqrt(k/m)"
[elements]
body = { type = "mass", at = "x", m = "m" }
wire = { type = "spring", between = ["x", "ground"], k = "m*omega_0^2" }
[inputs]
F = { force = "x" }
[outputs]
"X" = "x"
V = "s*x"
"""


def document(text=MODEL):
    return examined(text, "a.toml")


def place(text, what, nth=0):
    at = -1
    for _ in range(nth + 1):
        at = text.index(what, at + 1)
    return at


def test_names_are_where_they_are_defined_and_used_and_prose_has_none():
    names = document().names
    assert [MODEL[n.span.start : n.span.end] for n in names] == [n.name for n in names]
    by_name = {}
    for n in names:
        by_name.setdefault(n.name, []).append((n.span.line, n.is_definition, n.is_node))
    assert by_name["m"] == [(4, True, False), (7, False, False), (9, False, False), (10, False, False)]
    assert by_name["x"] == [
        (9, True, True), (10, False, True), (12, False, True), (14, False, True), (15, False, True),
    ]  # fmt: skip
    assert by_name["X"] == [(14, True, False)]
    assert "wire" not in by_name and "spring" not in by_name


def test_problems_are_those_of_check_and_a_broken_text_keeps_its_names():
    broken = document(MODEL.replace('"3 kg"', '"3 kgg"') + "oops\n")
    assert [(p.code, p.span.line) for p in broken.problems] == [("SF201", 4), ("SF101", 16)]
    assert broken.model is None and "omega_0" in {n.name for n in broken.names}
    assert document().problems == () and document().model is not None


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ('"3 kg"', '"3 kgg"'),
        ('type = "mass"', 'type = "mas"'),
        ('at = "x", m = "m"', 'at = "x", m = m'),
        ("symflex = 1\n", ""),
        ("[outputs]", "[output]"),
    ],
)
def test_a_fix_gives_back_the_text_without_the_slip(before, after):
    slipped = document(MODEL.replace(before, after))
    offered = [fix for problem in slipped.problems for fix in fixes(slipped, problem)]
    assert offered and offered[0].applied(slipped.source.text) == MODEL


def test_a_hint_that_asks_to_think_is_no_fix():
    slipped = document(MODEL.replace("sqrt(k/m)", "sqrt k"))
    assert not [fix for problem in slipped.problems for fix in fixes(slipped, problem)]


@pytest.mark.parametrize(
    ("old", "new"), [("m", "m_1"), ("x", "q"), ("F", "load"), ("X", "Y"), ("omega_0", "w0")]
)
def test_a_name_changes_everywhere_or_nowhere(old, new):
    text = renamed(document(), old, new)
    after = document(text)
    assert after.problems == () and old not in {n.name for n in after.names}
    assert renamed(after, new, old) == MODEL


AT_REST = """symflex = 1
[parameters]
k = "3 N/m"
[equations]
unknowns = ["x"]
equations = ["s^2*x + k*x^3 = F"]
[operating_point]
x = 2
F = "8*k"
[inputs]
F = {}
[outputs]
X = "x"
[published."X/F"]
expr = "1/(s^2 + 12*k)"
[tables.first]
of = "poles"
tf = "X/F"
prints = "omega"
rows = [{ set = { k = "3 N/m" }, values = [6] }]
"""


@pytest.mark.parametrize("old", ["x", "F", "X", "k"])
def test_a_name_changes_in_keys_too(old):
    assert document(AT_REST).model is not None
    text = renamed(document(AT_REST), old, "new")
    assert renamed(document(text), "new", old) == AT_REST
    assert old not in {n.name for n in document(text).names}


def test_names_of_another_file_stay_and_a_shared_parameter_is_not_parted(tmp_path):
    (tmp_path / "inner.toml").write_text(MODEL)
    block = '[blocks]\nG = { type = "model", spec = "inner.toml", tf = "X/F" }\n'
    text = f'symflex = 1\n[parameters]\nm = "3 kg"\n{block}[inputs]\nF = {{}}\n[outputs]\nX = "m*G*F"\n'
    outer = examined(text, str(tmp_path / "outer.toml"))
    assert renamed(outer, "F", "u").count("F") == 1 and renamed(outer, "X", "Y").count("X") == 1
    with pytest.raises(UsageError, match="several meanings"):
        renamed(outer, "m", "m_1")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("m", "k"),
        ("m", "s"),
        ("m", "1m"),
        ("spring", "coil"),
        ("x", "ground"),
        ("ground", "wall"),
        ("s", "p"),
    ],
)
def test_a_rename_that_would_change_the_model_is_refused(old, new):
    with pytest.raises(UsageError):
        renamed(document(), old, new)


@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("[elem", {"elements"}),
        ('[elements]\na = { type = "massle', {"massless_beam", "massless_rod"}),
        ('[elements]\na = { type = "spring", ', {"between", "k", "eta_s", "latex", "doc"}),
        ('[elements.a]\ntype = "spring"\n', {"between", "k", "eta_s", "latex", "doc"}),
        ('[parameters]\nm = "3 k', {"kip", "ksi", "knot"}),
        ("[analysis]\nmod", {"modes"}),
    ],
)
def test_what_may_follow_is_offered(typed, offered):
    text = f"symflex = 1\n{typed}"
    got = {c.text for c in completions(document(text), len(text))}
    assert offered <= got or got <= offered
    assert got


def test_nodes_are_offered_at_ends_and_names_in_values():
    text = MODEL.replace('["x", "ground"], k = "m*omega_0^2"', '["", "ground"], k = ""')
    at_end = {c.text for c in completions(document(text), place(text, '["') + 2)}
    in_value = {c.text for c in completions(document(text), place(text, 'k = ""') + 5)}
    assert at_end == {"x", "ground"}
    assert {"m", "k", "omega_0", "sqrt"} <= in_value


@pytest.mark.parametrize(
    ("at", "said"),
    [
        ('m = "3', "**m** = 3 kg"),
        ("k = { value", "wire"),
        ("omega_0 =", "sqrt(k/m)"),
        ("X", "X/F"),
        ("mass", "Point mass"),
        ('x", m', "body, wire"),
    ],
)
def test_hover_says_what_a_name_is(at, said):
    assert said in hover(document(), MODEL.index(at))


def test_tables_fold_and_layout_leaves_what_is_quoted():
    assert folds(document())[0] == (2, 4)
    loose = (
        MODEL.replace("[elements]", "\n\n\n[elements]   ").replace('m = "3 kg"', 'm = "3 kg"  # mass  ')
        + "\n\n"
    )
    assert "\n\n\n" not in (text := tidied(document(loose))) and not any(
        line != line.rstrip() for line in text.splitlines()
    )
    quoted = 'doc = """two  \n\n\n\nlines  \n"""\n'
    assert tidied(document(quoted + MODEL)) == quoted + MODEL
    assert tidied(document(text)) == text
