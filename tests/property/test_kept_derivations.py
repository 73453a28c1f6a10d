"""What is printed does not depend on whether it was derived or read from the cache."""

from __future__ import annotations

import os
import subprocess
import sys
from functools import partial

import pytest

from symflex import pipeline
from symflex.cache import derivation_cache, remember
from symflex.cli import caching, run
from tests.house.repository import ROOT

LONG_PRINTS = {"fitted_resonances", "polynomial_resonance", "robot_axis"}
SPECIFICATIONS = [
    pytest.param(p, id=p.stem, marks=[pytest.mark.slow] if p.stem in LONG_PRINTS else [])
    for p in sorted((ROOT / "derivations").rglob("*.toml"))
]
COMMANDS = [
    pytest.param(("derive", "--json"), id="derive"),
    pytest.param(("roots", "--json", "--modes", "3"), id="roots", marks=pytest.mark.slow),
    pytest.param(("export", "--to", "c"), id="export", marks=pytest.mark.slow),
]


@pytest.fixture
def everything_kept(tmp_path, monkeypatch):
    """Keep what the command line derives, however quick that is."""
    monkeypatch.setattr(caching, "derivation_cache", partial(derivation_cache, tmp_path, 0.0))
    return tmp_path


@pytest.mark.parametrize("words", COMMANDS)
@pytest.mark.parametrize("path", SPECIFICATIONS)
@pytest.mark.slow
def test_output_is_the_same_byte_by_byte(path, words, everything_kept, monkeypatch, capfd):
    def printed(*more):
        code = run([words[0], str(path), *words[1:], *more])
        return code, capfd.readouterr()

    derived = printed("--no-cache")
    assert not list(everything_kept.iterdir())
    assert printed() == derived
    assert list(everything_kept.iterdir())
    with monkeypatch.context() as patched:
        # Nothing is left to derive.
        patched.setattr(remember, "derive_all", None)
        assert printed() == derived


KEYS = """
from symflex import pipeline
from symflex.cache.key import derivation_key
for name in ("classics/one_link_arm", "eppinger1988/robot_axis", "eppinger1988/six_mass"):
    model = pipeline.load(f"derivations/{name}.toml")
    print(derivation_key(pipeline.assemble(model), model.transfer_functions))
"""


@pytest.mark.slow
def test_keys_are_the_same_in_every_process():
    def keys(seed):
        environment = os.environ | {"PYTHONHASHSEED": seed}
        command = [sys.executable, "-c", KEYS]
        return subprocess.run(
            command, cwd=ROOT, env=environment, capture_output=True, text=True, check=True
        ).stdout

    assert len(set(keys("0").split())) == 3
    assert keys("0") == keys("1")


@pytest.mark.slow
def test_processes_that_derive_the_same_model_at_once_agree(tmp_path):
    code = (
        "import sys\n"
        "from functools import partial\n"
        "from symflex.cache import derivation_cache\n"
        "from symflex.cli import caching, run\n"
        f"caching.derivation_cache = partial(derivation_cache, {str(tmp_path)!r}, 0.0)\n"
        "for _ in range(5):\n"
        "    run(['derive', 'derivations/classics/rod_tip_mass.toml'])\n"
    )
    started = [
        subprocess.Popen([sys.executable, "-c", code], cwd=ROOT, stdout=subprocess.PIPE) for _ in range(4)
    ]
    printed = {process.communicate()[0] for process in started}
    assert [process.returncode for process in started] == [0] * 4
    assert len(printed) == 1
    assert b"cosh" in printed.pop()
    assert len(list(tmp_path.iterdir())) == 1


def test_a_damaged_entry_is_derived_anew_and_written_again(everything_kept, capfd):
    path = str(ROOT / "derivations" / "classics" / "rod_tip_mass.toml")
    assert run(["derive", path]) == 0
    expected = capfd.readouterr().out
    (entry,) = everything_kept.iterdir()
    whole = entry.read_bytes()
    for damaged in (b"", whole[:100], whole[:-1], whole[:200] + b"\0" + whole[201:], os.urandom(5000)):
        entry.write_bytes(damaged)
        assert run(["derive", path]) == 0
        assert capfd.readouterr().out == expected
        assert entry.read_bytes() == whole


# The rod's exponents have a formula, those of the field's equation have none, and the two are joined.
BESIDE = """
symflex = 1
parameters = { E = "1 Pa", A = "1 m^2", rho = "1 kg/m^3", l = "1 m", c = "1 m/s", d = "1 m^3/s" }
inputs = { F = { force = "x" }, u = {} }
outputs = { X = "x", V = "v(l/2)" }
[elements]
bar = { type = "rod", between = ["ground", "x"], E = "E", A = "A", rho = "rho", l = "l" }
[fields.v]
domain = ["0", "l"]
equation = "d*v''' + c*v' + s*v = 0"
conditions = ["v(0) = x", "v(l) = 0", "v'(l) = 0"]
"""


def test_what_is_derived_without_names_is_kept_too(tmp_path, monkeypatch):
    model = pipeline.loads(BESIDE)
    plain = pipeline.derive_all(model)
    assert any(tf.is_nameless for tf in plain)
    with derivation_cache(tmp_path, 0.0):
        pipeline.derive_all(model)
        monkeypatch.setattr(remember, "derive_all", None)
        again = pipeline.derive_all(model)
    assert len(list(tmp_path.iterdir())) == 2
    assert [str(tf.ratio) for tf in plain] == [str(tf.ratio) for tf in again]
