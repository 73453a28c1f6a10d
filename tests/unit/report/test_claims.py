"""Claims of publications: read with the place of every mistake, and judged from facts alone."""

import re
from dataclasses import replace
from inspect import signature

import pytest

from symflex.errors import SpecError
from symflex.report.claims.claim import claim_section, judge_all
from symflex.report.claims.predicates import PREDICATES
from symflex.report.claims.read import read_claims
from symflex.report.facts import (
    ColocationFact,
    LoopFacts,
    ModelFacts,
    RootFact,
    TransferFacts,
    TruncationFacts,
)
from symflex.report.report import find_claims, find_specifications
from tests.house.repository import ROOT

HEAD = 'symflex-claims = 1\npublication = "Nobody 2001"\ntitle = "On carts"\nmodels = ["cart"]\n'
CLAIM = '[[claims]]\nkey = "one"\nplace = "Section 3"\nquote = "It moves."\n'


def read(tmp_path, text):
    path = tmp_path / "claims.toml"
    path.write_text(text, encoding="utf-8")
    return read_claims(path)


def judged(tmp_path, checks, **models):
    """Return verdict and evidence of one claim about models of one function each, X/F."""
    (claim,) = read(tmp_path, f"{HEAD}{CLAIM}checks = [{checks}]\n").claims
    facts = {
        stem: m if isinstance(m, ModelFacts) else ModelFacts(stem, functions=(m,))
        for stem, m in models.items()
    }
    found = claim.judge(facts)
    return found.verdict, "".join(map(str, found.evidence))


def root(re_, im, place="plane"):
    return RootFact(re_, im, 1e-9, place, 1, abs(complex(re_, im)))


def axis(*sizes):
    return tuple(root(0.0, sign * w, "imaginary axis") for w in sizes for sign in (1, -1))


def function(**more):
    plain = TransferFacts(
        "X/F", "receptance", (), (), True, False, (0, 2), None, None, True, "", "always", "so"
    )
    return replace(plain, **more)


def test_a_claim_is_a_quotation_with_checks(tmp_path):
    claims = read(
        tmp_path, f'{HEAD}{CLAIM}checks = [{{ is = "counts", of = "cart: X/F", zeros = 0, poles = 2 }}]'
    )
    assert (claims.name, claims.title, claims.models) == ("Nobody 2001", "On carts", ("cart",))
    (claim,) = claims.claims
    assert (claim.key, claim.place, claim.quote, claim.is_quotation) == (
        "one",
        "Section 3",
        "It moves.",
        True,
    )


def test_claims_about_models_that_are_not_there_are_counted_and_not_listed(tmp_path):
    checks = 'checks = [{ is = "counts", of = "cart: X/F", zeros = 0, poles = 2 }]\n'
    other = CLAIM.replace("one", "two").replace("It moves", "It stays") + checks.replace("cart", "crane")
    claims = read(tmp_path, HEAD + CLAIM + checks + other)
    findings = judge_all(claims, [ModelFacts("cart", source="Nobody 2001", functions=(function(),))])
    lead, table = claim_section(claims, findings).blocks
    assert "1 is about models that this report lacks" in str(lead)
    assert "It moves." in str(table) and "It stays." not in str(table)


def test_what_is_wrong_is_said_with_its_place(tmp_path):
    for text, code, place in (
        (HEAD.replace("symflex-claims = 1\n", ""), "SF200", "1:1"),
        (HEAD.replace("= 1", "= 2"), "SF200", "1:18"),
        (HEAD.replace("title", "titel"), "SF207", "3:1"),
        (HEAD + "claims = 3\n", "SF206", "5:10"),
        (HEAD + CLAIM, "SF214", "5:1"),
        (HEAD + CLAIM + "checks = []\n", "SF206", "9:10"),
        (
            HEAD + CLAIM.replace('"one"', '"<b>"') + "checks = [{ is = 'colocated', of = 'cart' }]\n",
            "SF213",
            "6:7",
        ),
        (HEAD + CLAIM + "checks = [{ is = 'count', of = 'cart' }]\n", "SF208", "9:18"),
        (HEAD + CLAIM + "checks = [{ is = 'counts', of = 'cart', zeros = 1 }]\n", "SF214", "9:11"),
        (
            HEAD + CLAIM + "checks = [{ is = 'counts', of = 'cart', zeros = 1.5, poles = 2 }]\n",
            "SF206",
            "9:49",
        ),
        (HEAD + CLAIM + "checks = [{ is = 'colocated', of = 'cart', zeros = 1 }]\n", "SF207", "9:44"),
        (
            HEAD + CLAIM + "checks = [{ is = 'modes-at', of = 'c', hertz = ['x'], within = 1 }]\n",
            "SF206",
            "9:48",
        ),
        (HEAD + 2 * (CLAIM + "checks = [{ is = 'colocated', of = 'cart' }]\n"), "SF208", "5:1"),
        (HEAD + "[[claims]", "SF101", "5:"),
    ):
        with pytest.raises(SpecError) as caught:
            read(tmp_path, text)
        found = [(d.code, str(d.span)) for d in caught.value.diagnostics]
        assert any(c == code and f"claims.toml:{place}" in at for c, at in found), found


def test_a_file_of_claims_is_no_specification_and_another_file_of_its_name_is(tmp_path):
    (tmp_path / "a.toml").write_text("symflex = 1\n", encoding="utf-8")
    (tmp_path / "claims.toml").write_text(HEAD, encoding="utf-8")
    assert [p.name for p in find_specifications([tmp_path])] == ["a.toml"]
    assert [p.name for p in find_claims([tmp_path / "a.toml"])] == ["Nobody 2001"]
    (tmp_path / "claims.toml").write_text("symflex = 1\n", encoding="utf-8")
    assert [p.name for p in find_specifications([tmp_path])] == ["a.toml", "claims.toml"]
    assert find_claims([tmp_path / "a.toml"]) == ()


def test_claims_behind_a_link_that_leads_out_are_not_read(tmp_path):
    inside, outside = tmp_path / "inside", tmp_path / "outside"
    inside.mkdir()
    outside.mkdir()
    (outside / "claims.toml").write_text(HEAD, encoding="utf-8")
    (inside / "claims.toml").symlink_to(outside / "claims.toml")
    assert find_claims([inside / "a.toml"]) == ()
    assert len(find_claims([inside / "a.toml"], [outside])) == 1


def test_a_claim_about_a_model_or_a_function_that_is_not_there_is_not_examined(tmp_path):
    verdict, evidence = judged(tmp_path, '{ is = "colocated", of = "cart: X/F" }')
    assert (verdict, evidence) == ("not examined", "The report does not include cart.")
    verdict, evidence = judged(tmp_path, '{ is = "colocated", of = "cart: Y/F" }', cart=function())
    assert verdict == "not examined"
    assert "Y/F" in evidence


def test_the_worst_of_several_checks_counts_and_all_evidence_is_shown(tmp_path):
    right, wrong = (f'{{ is = "counts", of = "cart: X/F", zeros = {n}, poles = 2 }}' for n in (0, 1))
    assert judged(tmp_path, right, cart=function())[0] == "holds"
    verdict, evidence = judged(tmp_path, f"{right}, {wrong}", cart=function())
    assert verdict == "does not hold"
    assert evidence.count("no zeros and 2 poles") == 2


def test_a_condition_makes_what_holds_hold_with_it_and_nothing_else(tmp_path):
    check = '{{ is = "counts", of = "cart: X/F", zeros = {}, poles = 2, condition = "on Earth." }}'
    verdict, evidence = judged(tmp_path, check.format(0), cart=function())
    assert verdict == "holds with a condition"
    assert evidence.endswith("Condition: on Earth.")
    assert judged(tmp_path, check.format(5), cart=function())[0] == "does not hold"


SPRUNG = function(counts=(1, 4), rigid=(0, 2), undamped=(0, 4), zeros=(root(-5.0, 0.0, "real axis"),))
MIRRORED = (root(3.0, 0.0, "real axis"), root(-3.0, 0.0, "real axis"))
LOOP = LoopFacts("K", "1", ((0.0, 2.0),), 2, (9.0,), True, True, 1.0, True)
FREE = replace(LOOP, stable=((0.0, None),), unstable_at_last=0, crossings_hz=())
APART = ColocationFact("X/F", "Z/F", 10.0, 1.0, 3.0, 100.0, True)


def of_loop(loop):
    return ModelFacts("cart", loops=(loop,))


def test_a_predicate_tells_what_is_so_from_what_is_not(tmp_path):
    for checks, holds, fails in (
        (
            'is = "modes-at", hertz = [2, 4], within = 0.1',
            function(poles=axis(2.0, 4.05)),
            function(poles=axis(2.0)),
        ),
        (
            'is = "modes-at", hertz = 2, within = 0.1, lowest = true',
            function(poles=axis(2.0, 9.0)),
            function(),
        ),
        ('is = "counts", zeros = 0, poles = 2', function(), function(counts=None)),
        (
            'is = "arrangement", pole_pairs = 1, zero_pairs = 0, zeros_at_origin = 1, other_poles = 2',
            function(poles=axis(2.0), zeros=(root(0, 0, "origin"),), counts=(1, 4)),
            function(poles=axis(2.0), counts=(0, 2)),
        ),
        ('is = "added-per-mode", zeros = 1, poles = 2, zeros_are_real = true', SPRUNG, function()),
        ('is = "added-per-mode", zeros = 2, poles = 2', replace(SPRUNG, counts=(2, 4)), SPRUNG),
        ('is = "colocated"', function(), function(colocated=False)),
        ('is = "infinitely-many"', function(is_infinite=True), function()),
        (
            'is = "modes-suffice"',
            function(truncation=TruncationFacts(5, 10.0, 5.0, 11.0)),
            function(truncation=TruncationFacts(5, 10.0, 5.0, 9.0)),
        ),
        (
            'is = "interlacing"',
            function(poles=axis(1, 3), zeros=axis(2)),
            function(poles=axis(1, 2), zeros=axis(3)),
        ),
        ('is = "mirrored-real-zeros", count = 2', function(zeros=MIRRORED), function(zeros=MIRRORED[:1])),
        ('is = "minimum-phase"', function(), function(condition="for these values")),
        ('is = "nonminimum-phase"', function(zeros=MIRRORED), function()),
    ):
        check = f'{{ {checks}, of = "cart: X/F" }}'
        found = [judged(tmp_path, check, cart=each)[0] for each in (holds, fails)]
        assert found == ["holds", "does not hold"], checks


def test_what_dampers_bring_is_a_condition(tmp_path):
    check = '{ is = "added-per-mode", of = "cart: X/F", zeros = 1, poles = 2, needs_dampers = true }'
    verdict, evidence = judged(tmp_path, check, cart=SPRUNG)
    assert verdict == "holds with a condition"
    assert "without dampers it has no zeros" in evidence
    assert judged(tmp_path, check, cart=replace(SPRUNG, undamped=(1, 4)))[0] == "does not hold"


def test_functions_of_two_models_are_compared(tmp_path):
    more = replace(SPRUNG, counts=(2, 4))
    one, other = (function(poles=axis(w)) for w in (1, 2))
    for name, first, second, verdict in (
        ("fewer-zeros-added", SPRUNG, more, "holds"),
        ("fewer-zeros-added", more, SPRUNG, "does not hold"),
        ("same-poles", one, one, "holds"),
        ("same-poles", one, other, "does not hold"),
    ):
        check = f'{{ is = "{name}", of = ["one: X/F", "other: X/F"] }}'
        assert judged(tmp_path, check, one=first, other=second)[0] == verdict, (name, verdict)


def test_loops_are_judged_by_their_gains(tmp_path):
    for name, yes, no in (("unstable-at-high-gain", LOOP, FREE), ("always-stable", FREE, LOOP)):
        check = f'{{ is = "{name}", of = "cart" }}'
        found = [judged(tmp_path, check, cart=each)[0] for each in (of_loop(yes), of_loop(no), function())]
        assert found == ["holds", "does not hold", "not examined"], name


def test_outputs_that_part_early_are_together_up_to_there(tmp_path):
    near, far = (
        ModelFacts(
            stem, functions=(function(poles=axis(10.0)),), colocations=(replace(APART, bandwidth_hz=end),)
        )
        for stem, end in (("near", 9.0), ("far", 3.0))
    )
    verdict, evidence = judged(tmp_path, '{ is = "together", of = "far: X/F" }', far=far)
    assert verdict == "holds with a condition"
    assert "up to 3 Hz" in evidence
    order = '{{ is = "together-farthest", of = ["{}: X/F", "{}: X/F"] }}'
    assert judged(tmp_path, order.format("near", "far"), near=near, far=far)[0] == "holds"
    assert judged(tmp_path, order.format("far", "near"), near=near, far=far)[0] == "does not hold"


def test_a_printed_formula_is_judged_by_its_audit(tmp_path):
    check = '{ is = "printed-formula", of = "cart: X/F" }'

    def audited(verdict):
        return ModelFacts("cart", audits=(("X/F", verdict, "sign: + should be -"),))

    assert judged(tmp_path, check, cart=audited("equal"))[0] == "holds"
    assert judged(tmp_path, check, cart=audited("differs"))[0] == "does not hold"
    assert judged(tmp_path, check, cart=audited("undecided"))[0] == "not examined"


def test_every_predicate_and_its_keys_are_in_the_documentation():
    page = (ROOT / "docs" / "report.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| `([a-z-]+)` \|(.*)\|$", page, re.MULTILINE))
    for name, predicate in PREDICATES.items():
        keys = [f"`{key}`" for key in signature(predicate).parameters if key not in ("models", "of")]
        assert all(key in rows[name] for key in keys), name
