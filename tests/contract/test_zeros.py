"""A key of value 0 leaves what the model without it says, declared so, set so or bound so."""

from __future__ import annotations

from functools import cache, partial

import pytest

from symflex import pipeline
from symflex.errors import SymflexError
from symflex.library.blocks import BLOCKS
from symflex.library.elements import ELEMENTS
from symflex.roots.region import Modes
from tests.contract.zeros import (
    AROUND,
    BLOCKS_AROUND,
    LETTER,
    SOURCES,
    Zero,
    may_be_zero,
    zeros,
)
from tests.tools.ways import contradictions

CASES = tuple(zeros())
POINTS = (0.3 + 0.7j, 1.1j, 2 - 0.4j)  # [rad/s]
SHARE = 10  # of the cases, one is quick
ROUNDING = 1e-12  # relative, of a double


def said_by(bind, model):
    """Return per transfer function what its roots are, and its values at some points."""
    region = Modes(2) if model.is_distributed else None
    bounds = [bind(pair) for pair in model.transfer_functions]
    return [(pipeline.roots(b, region, 12), [b(s) for s in POINTS]) for b in bounds]


def derived(text, settings=None):
    model = pipeline.loads(text, settings=settings)
    return said_by(lambda pair: pipeline.derive_for_roots(model, [pair])[0], model)


def bound_at_zero(text, zero):
    model = pipeline.loads(text)
    return said_by(lambda pair: pipeline.bind(pipeline.derive_all(model, [pair])[0], {LETTER: zero}), model)


def ways_of(case: Zero):
    """Return what says what a model with a letter is at 0."""

    def declared(value):
        return case.letter.replace("@", f'parameters.{LETTER} = {{ value = "{value}", assume = "real" }}\n')

    return {
        "declared": partial(derived, declared(case.zero)),
        "set": partial(derived, declared(case.one), {LETTER: case.zero}),
        "bound": partial(bound_at_zero, declared(case.one), case.zero),
    }


def attempt(way):
    """Return what is said, or the code of what is refused."""
    try:
        return way()
    except SymflexError as error:
        return error.diagnostics[0].code


def differences(wanted, got):
    if isinstance(wanted, str) or isinstance(got, str):
        return [] if wanted == got and wanted != "SF991" else [f"{wanted} / {got}"]
    found = []
    for (one, values), (other, others) in zip(wanted, got, strict=True):
        found += contradictions(one, other)
        for key in ("word", "hidden_motion"):
            words = [getattr(m.verdict, key) for m in (one, other)]
            found += [] if words[0] == words[1] else [" / ".join(words)]
        hidden = [sum(h.root.multiplicity for h in m.hidden) for m in (one, other)]
        found += [] if hidden[0] == hidden[1] else [f"hidden modes {hidden}"]
        found += [] if one.certificate.certified == other.certificate.certified else ["certified"]
        if any(abs(a - b) > ROUNDING * abs(a) for a, b in zip(values, others, strict=True)):
            found.append(f"values {values} / {others}")
    return found


def wrong(cases):
    without = cache(lambda text: attempt(partial(derived, text.replace("@", ""))))
    return [
        f"{case}, {name}: {'; '.join(found)}"
        for case in cases
        for name, way in ways_of(case).items()
        if (found := differences(without(case.without), attempt(way)))
    ]


def test_every_key_of_the_library_that_may_be_0_is_tried():
    assert set(AROUND) | set(SOURCES) | {"fixed", "slider", "pin"} == set(ELEMENTS)
    assert set(BLOCKS_AROUND) == set(BLOCKS)
    tried = {(case.kind, case.key) for case in CASES}
    for kind, thing in {**{k: ELEMENTS[k] for k in AROUND}, **BLOCKS}.items():
        wanted = {p.name for p in thing.parameters if may_be_zero(kind, p) and not p.of}
        composed = {part for p in thing.parameters if (kind, p.name) in tried for part in p.of}
        composed |= {part for p in thing.parameters if p.of and p.sign == "positive" for part in p.of}
        assert wanted - composed <= {name for k, name in tried if k == kind}, kind


def test_a_tenth_of_the_keys_at_0_leave_what_the_model_without_them_says():
    lumped = [case for case in CASES if case.kind not in ("beam", "frame", "rod", "shaft", "string")]
    assert wrong(lumped[::SHARE]) == []


@pytest.mark.slow
@pytest.mark.parametrize("kind", list(AROUND) + list(BLOCKS_AROUND))
def test_every_key_at_0_leaves_what_the_model_without_it_says(kind):
    assert wrong(case for case in CASES if case.kind == kind) == []
