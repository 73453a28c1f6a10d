"""Exported networks of many members: solved at every s, in numpy and in C, and refused elsewhere."""

import re
from functools import cache

import numpy as np
import pytest
from mpmath import mp, mpf

from symflex import pipeline
from symflex.codegen.exporters import EXPORTERS
from tests.independent import plane_frames
from tests.independent.boundary_value import Problem, bending
from tests.independent.members import random_members, response, specification
from tests.unit.codegen.exportable import executed
from tests.unit.codegen.test_c_files import compiled, value_at
from tests.unit.codegen.test_c_files import response as c_response

POINTS = np.array([complex(20 * k - 150, 10 ** (k / 3)) for k in range(12)])
"""On both sides of the imaginary axis, up to where members of half a metre are some wavelengths long."""
MODULE_BYTES = 40_000


def exported(text, target="numpy", **options):
    """Return what a specification is exported to in nested form, with few samples."""
    model = pipeline.loads(text)
    tfs = pipeline.derive_nested(model)
    return EXPORTERS[target].export(model, tfs, "plant", is_alone=False, samples=20, **options)


in_numpy = cache(exported)


@cache
def functions(text):
    """Return the functions of a numpy module."""
    return executed(in_numpy(text).text)


def chain(count, length="0.5 m", last=""):
    """Return a clamped chain of different beams on springs, as a specification."""
    beams = "".join(
        f'b_{i} = {{ type = "beam", between = ["{f"p_{i - 1}" if i else "ground"}", "p_{i}"], E = "70 GPa", '
        f'I = "{10 + i}e-10 m^4", rho = "2700 kg/m^3", A = "1e-4 m^2", l = "l_{i}"{last} }}\n'
        f's_{i} = {{ type = "spring", between = ["p_{i}.y", "ground"], k = "{3 + i} kN/m" }}\n'
        for i in range(count)
    )
    lengths = "".join(f'l_{i} = "{length}"\n' for i in range(count))
    return (
        f"symflex = 1\n[parameters]\n{lengths}[elements]\n{beams}[inputs]\n"
        f'F = {{ force = "p_{count - 1}" }}\n[outputs]\nX = "p_0"\nY = "p_{count - 1}"\n'
    )


def receptance(count, s):
    """Return Y/F of the same chain by a boundary-value problem."""
    with mp.workdps(60):
        problem, end = Problem(), None
        for i in range(count):
            values = {"E": mpf("70e9"), "I": (10 + i) * mpf("1e-10"), "rho": mpf(2700), "A": mpf("1e-4")}
            line = problem.line(bending(values | {"l": mpf("0.5")}, mp.mpc(s)))
            if end is None:
                problem.require(*line.start[:2])
            else:
                problem.require(*(x - y for x, y in zip(end[:3], line.start[:3], strict=True)))
                problem.require(end[3] - line.start[3] - end[0] * (2 + i) * 1000)
            end = line.at(mpf("0.5"))
        problem.require(end[2], end[3] + 1 - end[0] * (2 + count) * 1000)
        return complex(problem.solve()(end[0]))


# ------------------------------------------------------------------------------------------ values


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.slow
def test_a_numpy_module_has_the_responses_of_boundary_value_problems(seed):
    network = random_members(seed)
    found = functions(specification(network))["X_over_F"](POINTS)
    expected = np.array([complex(response(network, s)) for s in POINTS])
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-300)


SPANS = """symflex = 1
inputs.F = { force = "d" }
outputs.Y = "second.y(0.65 m)"
[parameters]
E = "210 GPa"
I = "4e-8 m^4"
A = "4e-4 m^2"
rho = "7800 kg/m^3"
l_1 = "1 m"
l_2 = "1.3 m"
l_3 = "0.8 m"
[elements]
left = { type = "pin", at = "a" }
first = { type = "beam", between = ["a", "b"], E = "E", I = "I", A = "A", rho = "rho", l = "l_1" }
middle = { type = "pin", at = "b" }
second = { type = "beam", between = ["b", "c"], E = "E", I = "I", A = "A", rho = "rho", l = "l_2" }
right = { type = "pin", at = "c" }
third = { type = "beam", between = ["c", "d"], E = "E", I = "I", A = "A", rho = "rho", l = "l_3" }
"""


def inside_the_second_span(s):
    """Return the deflection in the middle of the second span per force on the free end of the third."""
    with mp.workdps(60):
        values = {"E": mpf("210e9"), "I": mpf("4e-8"), "rho": mpf(7800), "A": mpf("4e-4")}
        problem, before, seen = Problem(), None, None
        for length in ("1", "1.3", "0.8"):
            line = problem.line(bending(values | {"l": mpf(length)}, mp.mpc(s)))
            problem.require(line.start[0])
            if before is None:
                problem.require(line.start[2])
            else:
                problem.require(before[0], before[1] - line.start[1], before[2] - line.start[2])
            before = line.at(mpf(length))
            seen = line.at(mpf("0.65"))[0] if length == "1.3" else seen
        problem.require(before[2], before[3] + 1)
        return complex(problem.solve()(seen))


@pytest.mark.slow
def test_three_spans_with_a_sensor_inside_are_solved_as_they_are_asked_for():
    model = pipeline.loads(SPANS)
    tfs, reason = pipeline.derive_as(model, model.transfer_functions, solves=True)
    assert "solved as a network" in reason
    made = EXPORTERS["numpy"].export(model, tfs, "plant", is_alone=False, samples=20)
    assert len(made.text) < MODULE_BYTES
    expected = np.array([inside_the_second_span(s) for s in POINTS])
    assert executed(made.text)["Y_over_F"](POINTS) == pytest.approx(expected, rel=1e-12)


@pytest.mark.slow
def test_long_members_neither_overflow_nor_lose_digits():
    # A cantilever's tip: Graff 1975, section 3.2. At 3e5 rad/s its cosh is one of 800, which is no double.
    omega = 3e5
    with mp.workdps(400):
        stiffness, mass = mpf("70e9") * mpf("1e-9"), 2700 * mpf("1e-4")
        wave = (mass * mpf(omega) ** 2 / stiffness) ** mpf("0.25")
        x = 6 * wave
        above = mp.sin(x) * mp.cosh(x) - mp.cos(x) * mp.sinh(x)
        free = above / (stiffness * wave**3 * (1 + mp.cos(x) * mp.cosh(x)))
        expected = float(1 / (1 / free + 3000))
    assert x > 800
    assert functions(chain(1, "6 m"))["Y_over_F"](1j * omega) == pytest.approx(expected, rel=1e-11)


@pytest.mark.slow
def test_a_frequency_at_which_a_member_is_resonant_between_clamps_is_one_like_others():
    # Blevins: cos x cosh x = 1 at x = 4.73004074486270402602, of the first beam of 0.5 m.
    x = mpf("4.73004074486270402602")
    omega = float((x / mpf("0.5")) ** 2 * mp.sqrt(mpf("70e9") * mpf("10e-10") / (2700 * mpf("1e-4"))))
    for y in (omega, np.nextafter(omega, 0), np.nextafter(omega, 1e9)):
        assert functions(chain(4))["Y_over_F"](1j * y) == pytest.approx(receptance(4, 1j * y), rel=1e-12)


def test_parameters_and_frequencies_are_broadcast():
    found = functions(chain(4))["Y_over_F"](np.array([100j, 900j]), l_0=np.array([[0.5], [0.6]]))
    assert found.shape == (2, 2)
    assert found[0, 1] == functions(chain(4))["Y_over_F"](900j)


@pytest.mark.slow
@pytest.mark.needs_tool("gcc")
def test_c_computes_what_numpy_computes(tmp_path):
    text = chain(4, last=', eta = "1e-6 s"')
    made = exported(text, "c")
    library, names = compiled(tmp_path, made)
    assert [n.removeprefix("plant_") for n in names] == ["X_over_F", "Y_over_F"]
    for number, (name, verified) in enumerate(zip(("X_over_F", "Y_over_F"), made.verified, strict=True)):
        end = 2 * np.pi * float(verified.band[1])
        omega, inside = np.geomspace(1, end, 20), POINTS[abs(POINTS) <= end]
        exact = functions(text)[name]
        assert c_response(library, number, omega) == pytest.approx(exact(1j * omega), rel=1e-12)
        assert value_at(library, number, inside) == pytest.approx(exact(inside), rel=1e-12)
        # Beyond its band the form holds nowhere, and C says so.
        assert np.isnan(c_response(library, number, np.array([1.001 * end, 100 * end]))).all()
        assert np.isnan(value_at(library, number, np.array([1.001 * end + 0j, 100j * end]))).all()


# ------------------------------------------------------------------------------------------ text


def test_a_docstring_names_the_members_instead_of_a_formula():
    text = re.sub(r"\s+", " ", functions(chain(4))["Y_over_F"].__doc__)
    assert "No formula: the network is solved at every s, beam b_0, beam b_1, beam b_2, beam b_3." in text


def test_the_error_over_the_band_is_measured_and_said():
    made = in_numpy(chain(4))
    assert all(v.error < 1e-13 and v.samples > 20 for v in made.verified)
    assert made.verified[0].form == "solved"
    assert made.warnings == ()


STEEL = 'E = "E", I = "I", A = "A", rho = "rho"'
FRAME = f"""
symflex = 1
parameters = {{ E = "210 GPa", I = "1e-8 m^4", A = "1e-4 m^2", rho = "7800 kg/m^3", alpha = "50 deg" }}
inputs.F = {{ force = "p.x" }}
outputs.Y = "r.y"
[elements]
left  = {{ type = "frame", between = ["ground", "p"], {STEEL}, l = "0.5 m", angle = "90 deg" }}
top   = {{ type = "frame", between = ["p", "q"], {STEEL}, l = "0.4 m", angle = "30 deg" }}
right = {{ type = "frame", between = ["q", "ground"], {STEEL}, l = "0.6 m", angle = "-alpha" }}
boom  = {{ type = "frame", between = ["q", "r"], {STEEL}, l = "0.3 m" }}
"""


@pytest.mark.slow
def test_a_module_of_a_frame_gives_the_response_of_its_dynamic_stiffness():
    steel = {"E": mpf(210e9), "I": mpf("1e-8"), "A": mpf("1e-4"), "rho": mpf(7800)}
    members = [
        plane_frames.Member(first, second, **steel, l=mpf(length), angle=mp.pi * degrees / 180)
        for first, second, length, degrees in (
            ("a", "p", "0.5", 90),
            ("p", "q", "0.4", 30),
            ("q", "b", "0.6", -50),
            ("q", "r", "0.3", 0),
        )
    ]
    found = functions(FRAME)["Y_over_F"](POINTS)
    held = plane_frames.clamped("a", "b")
    wanted = [plane_frames.response(members, held, ("p", "x"), ("r", "y"), s) for s in POINTS]
    assert np.abs(found / wanted - 1).max() < 1e-10
