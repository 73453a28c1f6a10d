"""Difference equations: generated code runs a controller, in C and in Python."""

import ctypes
import io
import re
import runpy
import subprocess
import zipfile
from collections import Counter
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from xml.etree import ElementTree

import mpmath
import numpy as np
import pytest
from flint import acb, arb
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

from symflex import Model, loads
from symflex.analysis.sampling import sampled_transfer_function
from symflex.codegen import fmu
from symflex.codegen.difference import DifferenceEquation, difference_equation
from symflex.codegen.exporters import SAMPLED
from symflex.codegen.sampled import DifferenceExporter
from symflex.state_space.sampled import Sampling
from symflex.transfer.of_model import derive_all
from tests.unit.analysis.systems import rational
from tests.unit.codegen import hostile_names as hostile

CONTROLLER = """
symflex = 1
parameters = { k_p = "40", T_d = "0.1 s", T_f = "20 ms", T_i = "0.5 s" }
inputs  = { e = {} }
outputs = { u = "k_p*(1 + 1/(T_i*s) + T_d*s/(1 + T_f*s))*e", mean = "e/2" }
"""
PLANT = """
symflex = 1
parameters = { m = "1 kg", b = "0.8 N*s/m", k = "20 N/m", T = { value = "LATE s", assume = "nonnegative" } }
inputs  = { u = { unit = "N" } }
signals = { late = "D*u" }
outputs = { x = "late/(m*s^2 + b*s + k)" }
blocks.D = { type = "delay", T = "T" }
"""


def plant(late):
    return loads(PLANT.replace("LATE", str(late))).transfer_function("x", "u").bind().bound


def exported(language, text=CONTROLLER, stem="pid", **options):
    model = loads(text).resolved
    sampling = options.pop("sampling", Sampling(Fraction(1, 100), "tustin"))
    exporter = DifferenceExporter(SAMPLED[language], sampling, **options)
    return exporter.export(model, derive_all(model), stem, is_alone=False)


def compiled(folder, export, stem="pid"):
    """Return the library that a strict compiler makes of the source and its header."""
    (folder / f"{stem}.c").write_text(export.text, encoding="utf-8")
    (folder / f"{stem}.h").write_text(export.companions[".h"], encoding="utf-8")
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O1", "-ffp-contract=off"]
    library = folder / f"{stem}.so"
    done = subprocess.run(
        ["gcc", *flags, "-shared", "-fPIC", "-o", library, folder / f"{stem}.c"],
        check=False,
        capture_output=True,
        text=True,
    )
    assert not done.returncode, done.stderr
    return ctypes.CDLL(str(library))


def stepper(library, name):
    """Return a function of one sample after the other."""
    step = getattr(library, f"{name}_step")
    step.restype = ctypes.c_double
    step.argtypes = [ctypes.c_void_p, ctypes.c_double]
    state = ctypes.create_string_buffer(4096)
    return lambda u: step(state, u)


def closed_loop(controller, late, count, h=0.01):
    """Return positions at samples: the plant is integrated between the moments at which its input changes."""
    state, given, positions = np.zeros(2), [], []
    for k in range(count):
        positions.append(state[0])
        given.append(controller(1.0 - state[0]))
        moments = sorted({0.0, (late / h % 1) * h, h})
        for begin, end in pairwise(moments):
            acting = int(np.floor((k * h + (begin + end) / 2 - late) / h))
            force = given[acting] if acting >= 0 else 0.0
            state = solve_ivp(
                lambda _, w, f=force: [w[1], f - 0.8 * w[1] - 20 * w[0]],
                (begin, end),
                state,
                method="DOP853",
                rtol=1e-13,
                atol=1e-15,
            ).y[:, -1]
    return np.array(positions)


@pytest.mark.needs_tool("gcc")
@pytest.mark.parametrize("samples", [0.0, 2.7])
def test_a_compiled_controller_in_the_loop_moves_the_plant_as_the_sampled_model_says(tmp_path, samples):
    library = compiled(tmp_path, exported("c"))
    moved = closed_loop(stepper(library, "pid_u_over_e"), samples * 0.01, 60)
    # The same loop in z: C P/(1 + C P), of both sampled functions.
    sampled = sampled_transfer_function(plant(samples * 0.01), Sampling(Fraction(1, 100)))
    pid = loads(CONTROLLER).transfer_function("u", "e").bind().discretise("10 ms", "tustin")
    (above, below), (num, den) = pid.coefficients(), sampled.coefficients()
    forward, back = np.polymul(above, num), np.polymul(below, den)
    whole = np.polyadd(forward, back)
    expected = lfilter(np.concatenate([np.zeros(len(whole) - len(forward)), forward]), whole, np.ones(60))
    assert np.max(np.abs(moved - expected)) < 1e-9
    assert 0.5 < moved[-1] < 1.5


@pytest.mark.slow
@pytest.mark.needs_tool("gcc")
def test_a_sampled_loop_comes_to_the_continuous_one_with_the_sampling_time(tmp_path):
    # (s^2 + 0.8 s + 20) x = u, u = C (1 - x), integrated as one system; a hold is late by half a sample.
    def motion(_, w):
        x, v, integral, filtered = w
        e = 1 - x
        rate = (e - filtered) / 0.02
        return [v, 40 * (e + 2 * integral + 0.1 * rate) - 0.8 * v - 20 * x, e, rate]

    times = np.arange(0.1, 1.0, 0.1)
    continuous = solve_ivp(motion, (0, 1), np.zeros(4), t_eval=times, method="DOP853", rtol=1e-11, atol=1e-12)
    errors = []
    for fine in (4, 8):
        sampling = Sampling(Fraction(1, 100 * fine), "tustin")
        library = compiled(tmp_path, exported("c", stem=f"pid{fine}", sampling=sampling), f"pid{fine}")
        moved = closed_loop(stepper(library, f"pid{fine}_u_over_e"), 0.0, 100 * fine, 0.01 / fine)
        errors.append(np.max(np.abs(moved[10 * fine :: 10 * fine] - continuous.y[0])))
    assert errors[1] < 0.02
    assert 1.7 < errors[0] / errors[1] < 2.3


@pytest.mark.parametrize("is_direct", [False, True])
def test_python_and_the_run_that_is_measured_take_the_same_steps(tmp_path, is_direct):
    (tmp_path / "pid.py").write_text(exported("numpy", is_direct=is_direct).text, encoding="utf-8")
    names = runpy.run_path(str(tmp_path / "pid.py"))
    bound = loads(CONTROLLER).transfer_function("u", "e").bind().bound
    made = difference_equation(
        sampled_transfer_function(bound, Sampling(Fraction(1, 100), "tustin")), is_direct=is_direct
    )
    u = np.random.default_rng(2).normal(size=50).tolist()
    w = names["u_over_e_start"]()
    assert [names["u_over_e_step"](w, value) for value in u] == made.run(u)
    assert names["mean_over_e_step"](names["mean_over_e_start"](), 3.0) == 1.5
    assert names["SAMPLE_TIME"] == 0.01


def test_a_step_takes_arrays_of_inputs(tmp_path):
    text = PLANT.replace("LATE", "0.027")
    sampling = Sampling(Fraction(1, 100))
    (tmp_path / "plant.py").write_text(exported("numpy", text, sampling=sampling).text, encoding="utf-8")
    names = runpy.run_path(str(tmp_path / "plant.py"))
    u = np.random.default_rng(3).normal(size=(30, 4))
    w = names["x_over_u_start"]()
    both = np.array([row * 0 + names["x_over_u_step"](w, row) for row in u])
    num, den = sampled_transfer_function(plant(0.027), sampling).coefficients()
    expected = lfilter(np.concatenate([np.zeros(len(den) - len(num)), num]), den, u, axis=0)
    assert np.max(np.abs(both - expected)) < 1e-12


def test_sections_are_the_polynomials_they_come_from():
    bound = rational("(s^2 + 1*s + 900)*(s + 3)/((s^2 + 30*s + 900)*(s^2 + 2*s + 25)*(s + 1)*(s + 2))")
    sampled = sampled_transfer_function(bound, Sampling(Fraction(1, 20)))
    made = difference_equation(sampled)
    assert sorted(len(section.below) for section in made.sections) == [1, 1, 2, 2]
    u = np.random.default_rng(4).normal(size=200)
    num, den = sampled.coefficients()
    expected = lfilter(np.concatenate([np.zeros(len(den) - len(num)), num]), den, u)
    assert np.max(np.abs(np.array(made.run(u.tolist())) - expected)) < 1e-9 * np.max(np.abs(expected))


def test_poles_that_cannot_be_told_apart_share_a_section():
    # (s + 1)^2, whose poles come to p = 19/21; enclosures that contain both may be real or a pair.
    sampled = sampled_transfer_function(rational("1/(s^2 + 2*s + 1)"), Sampling(Fraction(1, 10), "tustin"))
    poles = tuple(acb(pole.real, arb(0, 1e-20)) for pole in sampled.poles)
    (section,) = difference_equation(replace(sampled, poles=poles)).sections
    assert section.below == pytest.approx((-38 / 21, (19 / 21) ** 2), rel=1e-14)


def test_an_integrator_beside_another_pole_does_not_leak():
    made = difference_equation(
        sampled_transfer_function(rational("(s^2 + 1*s + 4)/(s*(s + 3))"), Sampling(Fraction(1, 70)))
    )
    ((a, b),) = (section.below for section in made.sections)
    assert 1 + a + b == 0


def test_sections_lose_far_less_than_one_direct_form():
    bound = rational("1/((s + 1)*(s + 2)*(s + 3)*(s + 4)*(s + 5)*(s + 6))")
    sampled = sampled_transfer_function(bound, Sampling(Fraction(1, 1000)))
    by_two, direct = (difference_equation(sampled, is_direct=x) for x in (False, True))
    assert by_two.error_of_response() < 1e-7
    assert direct.error_of_response() > 1e3 * by_two.error_of_response()
    assert "rounding costs" in direct.measured()[1]


@pytest.mark.parametrize(
    ("text", "rate", "method"),
    [
        ("40*(1 + 1/(0.5*s) + 0.1*s/(1 + 0.02*s))", 100, "tustin"),
        ("1/(s^2 + s/10 + 9)", 10, "zoh"),
        ("1/s^2", 100, "zoh"),
        ("exp(-0.3*s)/(s + 1)", 10, "zoh"),
    ],
)
def test_the_bound_of_the_output_holds_for_every_sequence(text, rate, method):
    # The recursion in sixty digits by mpmath; inputs at random, and the one that makes the output largest.
    sampled = sampled_transfer_function(rational(text), Sampling(Fraction(1, rate), method))
    made = difference_equation(sampled)
    error, largest = made.bounds_of_output()
    with mpmath.workdps(60):
        num, den = (
            [mpmath.mpf(c.mid().str(60, radius=False)) for c in side]
            for side in (sampled.numerator, sampled.denominator)
        )

        def exact(u):
            late, y = [0.0] * sampled.late + u, []
            for k in range(len(u)):
                now = sum(b * late[k - i] for i, b in enumerate(num[: k + 1]))
                y.append(now - sum(a * y[k - i] for i, a in enumerate(den[1 : k + 1], 1)))
            return y

        impulse = exact([1.0] + [0.0] * 999)
        sequences = [np.random.default_rng(seed).choice([-1.0, 1.0], 1000).tolist() for seed in range(2)]
        sequences.append([1.0 if x >= 0 else -1.0 for x in reversed(impulse)])
        for u in sequences:
            outputs = exact(u)
            assert max(abs(y - x) for x, y in zip(made.run(u), outputs, strict=True)) <= error
            assert max(map(abs, outputs)) <= largest * (1 + 1e-15)
        assert abs(outputs[-1]) == pytest.approx(largest, rel=1e-12)
    assert error < 1e-11 * largest
    (stated,) = re.findall(r"takes the output off by at most (\S+);", made.measured()[0])
    assert error <= float(stated) <= 1.1 * error


# ------------------------------------------------------------------------- names and texts that are hostile


def written(target, tfs, model):
    made = DifferenceExporter(SAMPLED[target], Sampling(Fraction(1, 100), "tustin")).export(
        model, tfs, "plant", is_alone=False
    )
    text = "\n".join([*made.companions.values(), made.text])
    ends = (re.escape(end) for end in (SAMPLED[target].comment.opening, SAMPLED[target].comment.closing))
    return text, re.sub(r"(?:\br)?" + ".*?".join(ends), "", text, flags=re.DOTALL)


@pytest.fixture
def springs(monkeypatch):
    monkeypatch.setattr(DifferenceEquation, "measured", lambda _: ("Rounding costs nothing.", None))
    monkeypatch.setattr(
        fmu, "_compiled", lambda _: None
    )  # compiled units are simulated in integration/test_fmu
    model = hostile.mass_on_springs(("k_1",))
    return model, derive_all(model)


@pytest.mark.parametrize("target", SAMPLED)
def test_prose_changes_no_statement_of_a_sampled_language(target, springs):
    model, tfs = springs
    statements = set()
    for text in ("tame", *hostile.TEXTS):
        prose = hostile.with_prose(model, text)
        whole, code = written(target, [replace(tf, model=prose) for tf in tfs], prose)
        assert all(line.isprintable() for line in whole.split("\n")), text
        statements.add(code)
        assert len(statements) == 1, text


@pytest.mark.parametrize("target", SAMPLED)
def test_names_of_a_sampled_language_are_identifiers_of_their_own(target, springs):
    model, (tf,) = springs
    names = [*hostile.ODD, *hostile.NAMES[::20], *(n.upper() for n in hostile.NAMES[::20])]
    _, code = written(target, hostile.with_names(tf, names, names[::-1]), model)
    found = re.findall(r"\w+_step\b", code)
    steps = Counter(name.lower() for name in found) if SAMPLED[target].is_caseless else Counter(found)
    assert len(steps) == len(names)
    assert len(set(steps.values())) == 1
    assert all(re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name) for name in steps)


def test_the_variables_of_a_unit_have_names_of_their_own(monkeypatch):
    # FMI 3.0, section 2.4.7: names are unique, and the independent variable has one, too.
    monkeypatch.setattr(DifferenceEquation, "measured", lambda _: ("Rounding costs nothing.", None))
    monkeypatch.setattr(fmu, "_compiled", lambda _: b"")
    for inputs, output, expected in [
        ("u", "y", ["u", "y"]),
        ("time", "y", ["time_", "y"]),
        ("u", "time", ["u", "time_"]),
        ("time", "time", ["time_", "time_2"]),
        ("u", "u", ["u", "u_"]),
        ("time time_", "y", ["time_2", "time_", "y"]),
    ]:
        names = inputs.split()
        model = Model(inputs={n: {} for n in names}, outputs={output: f"({' + '.join(names)})/s"}).resolved
        exporter = DifferenceExporter(SAMPLED["fmu"], Sampling(Fraction(1, 100), "zoh"))
        made = exporter.export(model, derive_all(model), "unit", is_alone=False)
        archive = zipfile.ZipFile(io.BytesIO(made.archive))
        described = ElementTree.fromstring(archive.read("modelDescription.xml"))
        variables = described.findall("ModelVariables/Float64")
        assert [v.get("name") for v in variables] == ["time", *expected], (inputs, output)
        assert [v.get("causality") for v in variables[1:]] == [*["input"] * len(names), "output"]
        renamed = [a for a, b in zip([*names, output], expected, strict=True) if a != b]
        assert [w.split()[1] for w in made.warnings] == renamed, (inputs, output)
