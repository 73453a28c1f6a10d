from __future__ import annotations

import copy
import errno
import json
import os
from dataclasses import fields, replace
from pathlib import Path

import pytest

from symflex import pipeline
from symflex.cache import derivation_cache, remember
from symflex.cache.entry import entry_content, read_entry
from symflex.cache.key import derivation_key, programs_digest
from symflex.model import Model, with_numbers
from symflex.transfer import TransferFunction, derive_all

CHAIN = """
symflex = 1
title = "Two masses"
[parameters]
m_1 = { value = "60 kg", doc = "actuator side" }
m_2 = "20 kg"
k   = "95 kN/m"
b   = { value = "40 N*s/m", assume = "nonnegative" }
[elements]
left   = { type = "mass",   at = "x_1", m = "m_1" }
right  = { type = "mass",   at = "x_2", m = "m_2" }
drive  = { type = "spring", between = ["x_1", "x_2"], k = "k" }
loss   = { type = "damper", between = ["x_1", "x_2"], b = "b" }
[inputs]
F = { force = "x_1" }
[outputs]
X_1 = "x_1"
X_2 = "x_2"
"""
ROD = """
symflex = 1
[parameters]
E = "210 GPa"
rho = "7800 kg/m^3"
A = "2 cm^2"
l = "1.5 m"
[elements]
bar = { type = "rod", between = ["ground", "tip"], E = "E", rho = "rho", A = "A", l = "l" }
[inputs]
F = { force = "tip" }
[outputs]
X = "tip"
"""


def equations_of(text):
    return pipeline.assemble(pipeline.loads(text))


def key_of(text, pairs=None):
    equations = equations_of(text)
    return derivation_key(equations, pairs or equations.model.transfer_functions)


@pytest.fixture(params=[CHAIN, ROD], ids=["lumped", "distributed"])
def derived(request):
    equations = equations_of(request.param)
    pairs = equations.model.transfer_functions
    return equations, pairs, derive_all(equations, pairs)


def test_an_entry_gives_back_what_was_derived(derived):
    equations, pairs, first = derived
    found = read_entry(entry_content(first), equations, pairs)
    assert entry_content(found) == entry_content(first)
    for a, b in zip(first, found, strict=True):
        assert (a.output, a.input, a.quantity, a.unit) == (b.output, b.input, b.quantity, b.unit)
        assert a.ratio.factors == b.ratio.factors
        assert a.ratio.unit == b.ratio.unit
        assert a.hidden == b.hidden
        assert (a.closed and a.closed.den) == (b.closed and b.closed.den)
        assert [k.generator for k in a.kernels.kernels] == [k.generator for k in b.kernels.kernels]
        assert all(any(k.dispersion is d for d in b.kernels.dispersions) for k in b.kernels.kernels)


def test_an_entry_holds_every_field_of_a_transfer_function():
    """One that is added must be written and read too, or taken from the equations."""
    held = {"output", "input", "reduced", "closed", "hidden", "kernels", "parts"}
    at_hand = {"quantity", "unit", "base", "definitions", "constants", "model"}
    assert {f.name for f in fields(TransferFunction)} == held | at_hand


def test_nothing_of_the_model_but_names_takes_part_in_a_derivation(derived):
    equations, pairs, first = derived
    model = equations.model
    bare = Model(
        parameters=tuple(replace(p, value=None, unit="", latex="", doc="") for p in model.parameters),
        inputs=model.inputs,
        outputs=model.outputs,
        quotients=model.quotients,
    )
    assert entry_content(derive_all(replace(equations, model=bare), pairs)) == entry_content(first)


def test_the_key_is_that_of_the_content():
    assert key_of(CHAIN) == key_of(CHAIN)
    for old, new in [
        ("Two masses", "Zwei Massen"),
        ("actuator side", "motor"),
        ("symflex = 1\n", "symflex = 1\n\n# moved down\n"),
        ("60 kg", "61 kg"),
    ]:
        assert key_of(CHAIN.replace(old, new)) == key_of(CHAIN)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('m = "m_2"', 'm = "2*m_2"'),
        ('"x_2"]', '"ground"]'),
        ('"nonnegative"', '"real"'),
        ('X_2 = "x_2"', 'X_2 = "s*x_2"'),
        ("m_1", "m_3"),
        ('force = "x_1"', 'force = "x_2"'),
        ('X_1 = "x_1"\n', ""),
    ],
)
def test_what_changes_the_equations_changes_the_key(old, new):
    assert key_of(CHAIN.replace(old, new)) != key_of(CHAIN)


def test_other_pairs_and_numbers_put_in_have_other_keys():
    model = pipeline.loads(CHAIN)
    numbers = with_numbers(model)
    heavier = with_numbers(pipeline.loads(CHAIN.replace("60 kg", "61 kg")))
    every = model.transfer_functions
    keys = {
        derivation_key(pipeline.assemble(m), pairs)
        for m, pairs in [
            (model, every),
            (model, every[:1]),
            (model, every[::-1]),
            (numbers, every),
            (heavier, every),
        ]
    }
    assert len(keys) == 5


def test_other_programs_have_other_keys(monkeypatch):
    before = key_of(CHAIN)
    monkeypatch.setattr("symflex.cache.key.programs_digest", lambda: "of another version")
    assert key_of(CHAIN) != before


def test_programs_whose_text_is_not_there_keep_nothing(monkeypatch, tmp_path):
    monkeypatch.setattr("symflex.cache.key.programs_digest", lambda: "")
    with derivation_cache(tmp_path, seconds=0) as store:
        assert pipeline.derive_all(pipeline.loads(CHAIN))
        assert store.usage().entries == 0


def test_programs_whose_folders_cannot_be_listed_keep_nothing(monkeypatch):
    def refuse(*_):
        raise OSError(errno.EMFILE, os.strerror(errno.EMFILE))

    monkeypatch.setattr(Path, "glob", refuse)
    assert programs_digest.__wrapped__() == ""


def test_what_is_kept_is_not_derived_again(monkeypatch, tmp_path):
    model = pipeline.loads(CHAIN)
    with derivation_cache(tmp_path, seconds=0):
        first = pipeline.derive_all(model)
        monkeypatch.setattr(remember, "derive_all", None)
        assert entry_content(pipeline.derive_all(model)) == entry_content(first)


def test_what_is_derived_at_once_is_not_kept(tmp_path):
    with derivation_cache(tmp_path, seconds=1000) as store:
        pipeline.derive_all(pipeline.loads(ROD))
        assert store.usage().entries == 0


def test_without_the_context_nothing_is_kept(tmp_path, monkeypatch):
    monkeypatch.setenv("SYMFLEX_NO_CACHE", "0")
    monkeypatch.setenv("SYMFLEX_CACHE_DIR", str(tmp_path / "kept"))
    pipeline.derive_all(pipeline.loads(ROD))
    assert not (tmp_path / "kept").exists()


def test_a_model_that_cannot_be_solved_is_explained_every_time(tmp_path):
    floating = (
        CHAIN.replace('k = "k"', 'k = "0*k"').replace('b = "b"', 'b = "0*b"').replace('"m_2"', '"0*m_2"')
    )
    messages = []
    with derivation_cache(tmp_path, seconds=0) as store:
        for _ in range(2):
            with pytest.raises(Exception, match="SF30") as raised:
                pipeline.derive_all(pipeline.loads(floating))
            messages.append(str(raised.value))
        assert store.usage().entries == 0
    assert messages[0] == messages[1]


ODD = [
    None,
    True,
    -1,
    10**6,
    2**80,
    1.5,
    float("nan"),
    "",
    "0x",
    "zz",
    "-0x" + "f" * 10**6,
    [],
    [[]],
    {},
    [0] * 7,
]


def places(data, path=()):
    """Return the paths to everything inside JSON data."""
    found = [path]
    inner = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for name, value in inner:
        found += places(value, (*path, name))
    return found


def changed(data, path, value):
    result = copy.deepcopy(data)
    if not path:
        return value
    at = result
    for name in path[:-1]:
        at = at[name]
    at[path[-1]] = value
    return result


def test_a_forged_entry_is_refused_or_is_made_of_values_of_the_right_kind(derived):
    equations, pairs, first = derived
    data = json.loads(entry_content(first))
    for path in places(data)[::3]:
        for value in ODD:
            found = read_entry(json.dumps(changed(data, path, value)).encode(), equations, pairs)
            for tf in found or ():
                # Whatever was read can be written: every part of it is what it should be.
                assert isinstance(tf, TransferFunction)
                assert entry_content([tf])


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\xff\xfe",
        b"null",
        b"[]",
        b"{}",
        b"[" * 100_000,
        b'{"schema":' * 50_000,
        b'{"schema":"symflex.derivation/1"}',
        b'{"schema":"symflex.derivation/1","rings":' + b"9" * 400_000 + b"}",
        b'{"schema":"symflex.derivation/2","rings":[]}',
    ],
    ids=range(10),
)
def test_what_is_no_entry_is_not_read(derived, content):
    equations, pairs, _ = derived
    assert read_entry(content, equations, pairs) is None


def test_a_forged_entry_under_the_right_checksum_is_derived_anew(tmp_path):
    model = pipeline.loads(CHAIN)
    expected = entry_content(pipeline.derive_all(model))
    with derivation_cache(tmp_path, seconds=0) as store:
        pipeline.derive_all(model)
        (path,) = tmp_path.iterdir()
        store.write(path.stem, json.dumps({"schema": "symflex.derivation/1", "rings": [["s"] * 9]}).encode())
        assert entry_content(pipeline.derive_all(model)) == expected
        assert store.read(path.stem) == expected
