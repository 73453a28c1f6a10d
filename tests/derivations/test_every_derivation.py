"""Every specification in derivations/ is answered by the form, the engine and the method that should do it.

Several forms print the same function, several engines find the same roots, several methods give the same
response. Where one of them fails another one takes over, and no result shows it: ``who_answers.toml`` says
who has to answer.
"""

import tomllib
from fractions import Fraction
from pathlib import Path

import pytest

from symflex import pipeline
from symflex.analysis.time_response import SampleTimes, time_response
from symflex.analysis.time_response.sample_times import default_until
from symflex.print.forms import print_forms
from tests.house.repository import ROOT, specifications

FOLDER = ROOT / "derivations"
PATHS = {str(p.relative_to(FOLDER).with_suffix("")): p for p in specifications(FOLDER, "**/*.toml")}
KINDS = tomllib.loads((Path(__file__).parent / "who_answers.toml").read_text("utf-8"))["kind"]


def forms_of(model, pairs):
    shown, _ = pipeline.derive_as(model, pairs, is_read=True)
    return [form.name for form in print_forms(shown)[0]]


def engine_of(bound):
    certificate = pipeline.roots(bound, digits=15).certificate
    return certificate.engine if certificate.certified else f"not certified: {certificate.reason}"


def method_of(bound):
    times = SampleTimes.evenly(Fraction(default_until(bound)), 3)
    return time_response(bound, "step", times, 6).method


def differing(name, kind):
    """Return what is answered otherwise, by question and transfer function, each with what was expected."""
    model = pipeline.load(PATHS[name])
    pairs = {f"{output}/{source}": (output, source) for output, source in model.transfer_functions}
    bounds, found = {}, {}
    for question in ("form", "roots", "step"):
        expected = kind.get(question, {})
        expected = dict.fromkeys(pairs, expected) if isinstance(expected, str) else expected
        asked = [tf for tf in expected if tf in pairs]  # a table is of several models
        if question == "form" and asked:
            answers = forms_of(model, [pairs[tf] for tf in asked])
        elif asked:
            bounds = bounds or dict(
                zip(pairs, pipeline.derive_for_roots(model, [*pairs.values()]), strict=True)
            )
            answers = [{"roots": engine_of, "step": method_of}[question](bounds[tf]) for tf in asked]
        for tf, answer in zip(asked, answers if asked else (), strict=True):
            if answer != expected[tf]:
                found[name, question, tf] = (answer, expected[tf])
    return found


@pytest.mark.parametrize(
    ("kind", "name"),
    [
        pytest.param(
            kind, name, id=f"{name}: {kind['what']}", marks=[pytest.mark.slow] * kind.get("slow", False)
        )
        for kind in KINDS
        for name in kind["models"]
    ],
)
def test_every_derivation_is_answered_by_whom_it_should(kind, name):
    assert differing(name, kind) == {}


def test_every_derivation_is_in_the_table_and_says_where_it_comes_from():
    entries = {name: tomllib.loads(path.read_text("utf-8")) for name, path in PATHS.items()}
    assert entries
    assert [name for name, entry in entries.items() if not entry.get("source")] == []
    every = {
        name: {f"{output}/{source}" for output in entry["outputs"] for source in entry["inputs"]}
        for name, entry in entries.items()
    }
    for question in ("form", "roots"):
        answered = {name: set() for name in every}
        for kind in KINDS:
            for name in kind["models"]:
                told = kind.get(question, ())
                answered[name] |= every[name] if isinstance(told, str) else every[name].intersection(told)
        assert answered == every, question
