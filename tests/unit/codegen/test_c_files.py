"""Exported C: compiled and run on the models of derivations/, against ball arithmetic and libm."""

import ctypes
import itertools
import math
import re
import subprocess
from functools import cache
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest
from scipy.linalg import expm

from symflex import pipeline
from symflex.cli import run
from symflex.codegen.c.body import Kind, Term, complex_term, difference, product, quotient, total
from symflex.codegen.c.module import C99, helpers
from symflex.codegen.exporters import EXPORTERS
from symflex.errors import UsageError
from tests.house.repository import ROOT, blocks
from tests.unit.codegen.against_balls import axis_points, worst_errors
from tests.unit.codegen.exportable import BAR, DELAY, DERIVATIONS, derived, free_chain
from tests.unit.codegen.exportable import BEAM as BEAM_OF_BAR
from tests.unit.codegen.test_numpy_distributed import specification

pytestmark = pytest.mark.needs_tool("gcc")

STRICT = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"]
ACCURACY = 1e-13
POINTER = ctypes.POINTER(ctypes.c_double)


def compiled(folder, files, name="plant", flags=("-O1",)):
    """Compile exported files into a library, with functions that take arrays for ctypes."""
    (folder / f"{name}.c").write_text(files.text, encoding="utf-8")
    (folder / f"{name}.h").write_text(files.companions[".h"], encoding="utf-8")
    functions = re.findall(r"^double complex (\w+)\(", files.companions[".h"], re.MULTILINE)
    lines = [f'#include "{name}.h"', "#include <string.h>"]
    for i, function in enumerate(functions):
        lines.append(f"""
void at_{i}(const double *s, double *value, size_t n, const double *p)
{{
    for (size_t k = 0; k < n; k++) {{
        double complex z;
        memcpy(&z, s + 2 * k, sizeof z);
        z = {function}(z, p ? (const {name}_parameters *)(const void *)p : &{name}_defaults);
        memcpy(value + 2 * k, &z, sizeof z);
    }}
}}
void freq_{i}(const double *omega, double *real, double *imag, size_t n, const double *p)
{{
    {function}_freq(omega, real, imag, n, p ? (const {name}_parameters *)(const void *)p : &{name}_defaults);
}}""")
    (folder / "arrays.c").write_text("\n".join(lines) + "\n", encoding="utf-8")
    command = ["gcc", *STRICT, *flags, "-shared", "-fPIC", "-o", "library.so", f"{name}.c", "arrays.c", "-lm"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return ctypes.CDLL(str(folder / "library.so")), functions


def built(folder, code, *flags):
    """Compile a few functions into a library."""
    includes = "".join(f"#include <{name}.h>\n" for name in ("float", "math", "stdint", "string"))
    (folder / "code.c").write_text(f"{includes}{code}\n", encoding="utf-8")
    command = ["gcc", "-std=c99", *flags, "-shared", "-fPIC", "-o", "code.so", "code.c", "-lm"]
    subprocess.run(command, cwd=folder, check=True)
    return ctypes.CDLL(str(folder / "code.so"))


def pointer(array):
    return None if array is None else array.ctypes.data_as(POINTER)


def value_at(library, number, s, parameters=None):
    s = np.ascontiguousarray(np.atleast_1d(s), dtype=complex)
    value = np.empty_like(s)
    function = getattr(library, f"at_{number}")
    function(pointer(s.view(float)), pointer(value.view(float)), ctypes.c_size_t(s.size), pointer(parameters))
    return value


def response(library, number, omega, parameters=None):
    omega = np.ascontiguousarray(np.atleast_1d(omega), dtype=float)
    real, imag = np.full_like(omega, np.nan), np.full_like(omega, np.nan)
    function = getattr(library, f"freq_{number}")
    function(pointer(omega), pointer(real), pointer(imag), ctypes.c_size_t(omega.size), pointer(parameters))
    return real + 1j * imag


def exported(text, **options):
    model = pipeline.loads(text)
    return C99.export(model, pipeline.derive_all(model), stem="plant", is_alone=False, samples=5, **options)


# ------------------------------------------------------------------------------------------ values


FOUNDATION = f"""
symflex = 1
[parameters]
{BAR}k_f = "3 kN/m^2"
[elements]
arm = {{ {BEAM_OF_BAR}, between = ["ground", "q"], l = "l", k_f = "k_f" }}
[inputs]
F = {{ force = "q" }}
[outputs]
X = "q"
"""
KINDS = {
    "a sign that depends on the frequency": (FOUNDATION, (1e-2, 1e5), 1e-13),
    "two beams": (specification("two_beams"), (1e-2, 1e5), 1e-13),
    "axial force": (specification("tension"), (1e-2, 1e5), 1e-13),
    "a delay": (DELAY, (1e-2, 1e3), 1e-13),
}


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_kernel_agrees_with_balls(kind, tmp_path):
    text, ends, allowed = KINDS[kind]
    tf = pipeline.derive_all(pipeline.loads(text))[0]
    files = C99.export(tf.model, [tf], stem="plant", is_alone=False, samples=5)
    library, _ = compiled(tmp_path, files)
    omega = np.geomspace(*ends, 13)
    found, negative = response(library, 0, omega), response(library, 0, -omega)
    computed = found, negative.conj(), value_at(library, 0, 1j * omega)
    assert max(worst_errors(tf, 1j * omega, *computed)) <= allowed
    if kind != "a delay":  # it grows without bounds to the left
        s = omega * np.exp(1j * np.linspace(0.1, 6.2, len(omega)))
        assert worst_errors(tf, s, value_at(library, 0, s))[0] <= allowed


SMALL = """
symflex = 1
parameters = { m = "2 kg", b = { unit = "N*s/m" }, k = "18 N/m" }
inputs.F = { force = "x" }
outputs = { X = "x", V = "s*x" }
[elements]
body = { type = "mass", at = "x", m = "m" }
loss = { type = "damper", between = ["x", "ground"], b = "b" }
spring = { type = "spring", between = ["x", "ground"], k = "k" }
"""


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    return compiled(tmp_path_factory.mktemp("small"), exported(SMALL))


def test_parameters_can_be_changed_and_missing_ones_are_nan(small):
    library, functions = small
    assert functions == ["plant_X_over_F", "plant_V_over_F"]
    given = np.array([3.0, 0.5, 7.0])
    s = np.array([1j, -2.0 + 0.5j])
    expected = 1 / (3 * s**2 + 0.5 * s + 7)
    assert value_at(library, 0, s, given) == pytest.approx(expected, rel=1e-15)
    assert value_at(library, 1, s, given) == pytest.approx(s * expected, rel=1e-15)
    assert response(library, 0, [1.0], given) == pytest.approx(expected[:1], rel=1e-15)
    assert np.isnan(value_at(library, 0, s)).all()


def test_a_pole_is_not_finite_and_nothing_is_written_for_no_frequencies(small):
    library, _ = small
    lossless = np.array([2.0, 0.0, 18.0])
    assert not np.isfinite(value_at(library, 0, [3j], lossless)).any()
    assert not np.isfinite(response(library, 0, [3.0], lossless)).any()
    untouched = np.full(3, 5.0)
    library.freq_0(pointer(untouched), pointer(untouched), pointer(untouched), ctypes.c_size_t(0), None)
    assert (untouched == 5.0).all()


BEAM = """
symflex = 1
parameters = { E = "200 GPa", I = "4e-9 m^4", rho = "7850 kg/m^3", A = "4.8e-4 m^2", l = "1.086 m" }
inputs.F = { force = "p" }
outputs.V = "s*p"
[elements]
arm = { type = "beam", between = ["p", "q"], E = "E", I = "I", rho = "rho", A = "A", l = "l" }
slide = { type = "slider", at = "p" }
"""


LIBRARIES = {"beam": BEAM, "six_masses": DERIVATIONS["six_mass"].read_text(encoding="utf-8")}


@cache
def of_either(name):
    return exported(LIBRARIES[name])


@pytest.fixture(scope="module")
def beam(tmp_path_factory):
    return compiled(tmp_path_factory.mktemp("beam"), of_either("beam"))[0]


@pytest.fixture(scope="module")
def six_masses(tmp_path_factory):
    return compiled(tmp_path_factory.mktemp("six_masses"), of_either("six_masses"))[0]


@pytest.fixture(params=["beam", pytest.param("six_masses", marks=pytest.mark.slow)])
def either(request):
    return request.getfixturevalue(request.param)


@pytest.mark.parametrize("name", LIBRARIES)
@pytest.mark.slow
def test_values_agree_with_balls_on_the_axis_and_all_around(name, request):
    library = request.getfixturevalue(name)
    for number, tf in enumerate(pipeline.derive_all(pipeline.loads(LIBRARIES[name]))[:2]):
        # Beside resonances and zeros too.
        omega = axis_points(tf, 40)
        found = response(library, number, omega)
        computed = found, value_at(library, number, 1j * omega)
        assert max(worst_errors(tf, 1j * omega, *computed)) <= ACCURACY
        elsewhere = np.geomspace(1e-2, 1e5, 12) * np.exp(1j * np.linspace(0.1, 6.2, 12))
        assert worst_errors(tf, elsewhere, value_at(library, number, elsewhere))[0] <= ACCURACY
        # Reflection, and a length that no block of frequencies divides.
        assert np.array_equal(response(library, number, -omega[:37]), found[:37].conj())


@pytest.mark.slow
def test_one_array_may_be_the_frequencies_themselves(either):
    omega = np.geomspace(1e-3, 1e4, 75)
    expected = response(either, 0, omega)
    for place in (0, 1):
        arrays = [np.empty_like(omega), np.empty_like(omega)]
        arrays[place] = omega.copy()
        either.freq_0(pointer(arrays[place]), *map(pointer, arrays), ctypes.c_size_t(75), None)
        assert np.array_equal(arrays[0] + 1j * arrays[1], expected)


def test_a_value_does_not_depend_on_its_neighbours(either):
    omega = np.geomspace(1e-7, 1e6, 75)
    alone = np.array([response(either, 0, [w])[0] for w in omega])
    assert np.array_equal(alone, response(either, 0, omega))


def test_nothing_overflows_from_1e_minus_9_to_1e12(beam):
    omega = np.logspace(-9, 12, 85)
    # Rigid at low frequencies, semi-infinite on average at high ones: decreasing, and finite throughout.
    found = np.abs(response(beam, 0, omega))
    assert np.isfinite(found).all()
    assert found[0] == pytest.approx(1 / (7850 * 4.8e-4 * 1.086 * 1e-9), rel=1e-12)
    assert np.isfinite(value_at(beam, 0, 1j * omega)).all()


def test_powers_of_s_that_would_overflow_are_divided_out(tmp_path):
    files = exported(free_chain(8, m="1 kg", k="1 N/m"))
    assert "if (cx_abs(s) > " in files.text
    library, _ = compiled(tmp_path, files)
    omega = np.array([1e3, 1e12, 1e15])
    # |X_8/F| -> k^7 / (m^8 omega^16)
    expected = omega**-16.0
    assert np.abs(response(library, 0, omega)) == pytest.approx(expected, rel=1e-4)
    assert np.abs(value_at(library, 0, 1j * omega)) == pytest.approx(expected, rel=1e-4)


# --------------------------------------------------------------------------- functions without branches

FUNCTIONS = """
#define CALL(name) \\
    void at_##name(const double *x, double *y, size_t n) \\
    { for (size_t i = 0; i < n; i++) y[i] = lane_##name(x[i]); }
CALL(tan) CALL(exp)
"""


@pytest.fixture(scope="module")
def elementary(tmp_path_factory):
    code = helpers("LANES lane_tan( lane_exp(", "void", 1)
    return built(tmp_path_factory.mktemp("elementary"), f"{code}{FUNCTIONS}", "-O2")


@pytest.mark.parametrize(
    ("name", "bound", "points"),
    [
        ("tan", 4.0, [*np.linspace(-40.0, 40.0, 501), *np.logspace(-12, 0, 101)]),
        ("exp", 2.0, [*np.linspace(-700.0, 700.0, 501), *np.linspace(-1.0, 1.0, 201)]),
    ],
)
def test_functions_without_branches_are_accurate_to_a_few_units(elementary, name, points, bound):
    points = np.array(points)
    found = np.empty_like(points)
    getattr(elementary, f"at_{name}")(pointer(points), pointer(found), ctypes.c_size_t(points.size))
    with mp.workdps(40):
        for x, y in zip(points.tolist(), found.tolist(), strict=True):
            exact = getattr(mp, name)(mp.mpf(x))
            # Of a tangent also what one rounding of the argument causes.
            ulps = 1 + (abs(x * (1 + exact**2) / exact) if name == "tan" and x else 0)
            assert abs(y - exact) <= bound * mp.mpf(2) ** -53 * abs(exact) * ulps


# ------------------------------------------------------------------------------------------ the files


@cache
def files_of(name):
    model, tfs = derived(name)
    return C99.export(model, tfs, stem=name, is_alone=False, samples=5)


def written(folder, *names):
    """Write the files of models into a folder."""
    for name in names:
        files = files_of(name)
        (folder / f"{name}.c").write_text(files.text, encoding="utf-8")
        (folder / f"{name}.h").write_text(files.companions[".h"], encoding="utf-8")
    return [f"{name}.c" for name in names]


MIXED = ("six_mass", "sliding_free_beam", "timoshenko_cantilever", "kelvin_voigt_cantilever")
"""Lumped; in real arithmetic; with series and circles; with damping."""


@pytest.mark.slow
@pytest.mark.needs_tool("nm")
def test_no_compiler_warns_and_objects_call_no_allocator_and_hold_no_variables(tmp_path):
    sources = written(tmp_path, *MIXED)
    for flags in ("-ffast-math", "-D__STDC_NO_COMPLEX__ -Wno-unused-function"):
        command = ["gcc", *STRICT, *flags.split(), "-fsyntax-only", *sources]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
    subprocess.run(["gcc", *STRICT, "-c", *sources], cwd=tmp_path, check=True)
    objects = [f"{name}.o" for name in MIXED]
    listed = subprocess.run(["nm", *objects], cwd=tmp_path, capture_output=True, text=True, check=True)
    symbols = [line.split()[-2:] for line in listed.stdout.splitlines() if line and not line.endswith(":")]
    called = {symbol for kind, symbol in symbols if kind == "U"}
    assert called <= {"sqrt", "exp", "sin", "cos", "hypot", "pow", "fabs", "copysign", "memcpy"}
    # t is code and r constant data; d and b would be variables.
    assert {kind.lower() for kind, _ in symbols} <= {"t", "r", "u"}


@pytest.mark.slow
def test_objects_of_two_models_are_linked_together(tmp_path):
    sources = written(tmp_path, "two_mass", "sliding_free_beam")
    (tmp_path / "main.c").write_text(
        '#include "two_mass.h"\n#include "sliding_free_beam.h"\n#include <stdio.h>\n'
        "int main(void)\n{\n    double omega = 0.0, real, imag;\n"
        "    two_mass_parameters p = two_mass_defaults;\n    p.m_1 = 2.0 * p.m_1;\n"
        "    two_mass_V_act_over_F_freq(&omega, &real, &imag, 1, &p);\n"
        '    printf("%d", sliding_free_beam_defaults.l > 1.0);\n    return 0;\n}\n',
        encoding="utf-8",
    )
    subprocess.run(["gcc", *STRICT, "main.c", *sources, "-o", "both", "-lm"], cwd=tmp_path, check=True)
    done = subprocess.run([tmp_path / "both"], capture_output=True, text=True, check=True)
    assert done.stdout == "1"


@pytest.mark.needs_tool("g++")
def test_a_cpp_program_includes_the_header_and_links(tmp_path):
    written(tmp_path, "sliding_free_beam")
    (tmp_path / "main.cpp").write_text(
        '#include "sliding_free_beam.h"\n#include <cmath>\n'
        "int main()\n{\n    double omega[2] = {10.0, -10.0}, real[2], imag[2];\n"
        "    sliding_free_beam_V_tip_over_F_freq(omega, real, imag, 2, &sliding_free_beam_defaults);\n"
        "    return imag[0] == -imag[1] && std::isfinite(imag[0]) ? 0 : 1;\n}\n",
        encoding="utf-8",
    )
    subprocess.run(["gcc", *STRICT, "-c", "sliding_free_beam.c"], cwd=tmp_path, check=True)
    command = ["g++", "-std=c++11", "-Wall", "-Wextra", "-Werror", "-pedantic", "main.cpp"]
    command += ["sliding_free_beam.o", "-o", "program", "-lm"]
    subprocess.run(command, cwd=tmp_path, check=True)
    assert subprocess.run([tmp_path / "program"], check=False).returncode == 0


def test_without_a_name_everything_is_one_file_that_compiles(tmp_path):
    model = pipeline.loads(SMALL)
    export = EXPORTERS["c"].export(model, pipeline.derive_all(model))
    assert not export.companions
    (tmp_path / "one.c").write_text(export.text, encoding="utf-8")
    subprocess.run(["gcc", *STRICT, "-c", "one.c"], cwd=tmp_path, check=True)


def test_only_functions_that_are_called_are_in_the_file():
    assert not re.search(r"cx_(roots|modal|propagated|begun)\(", of_either("six_masses").text)


def test_the_header_tells_the_verified_error_units_and_what_omega_is():
    header = files_of("sliding_free_beam").companions[".h"]
    assert "against ball arithmetic" in " ".join(header.replace("*", " ").split())
    assert "2 pi times the frequency in Hz" in " ".join(header.replace("*", " ").split())
    assert re.search(r"double rho; +/\* density \[kg/m\^3\] \*/", header)
    assert re.search(r"double I_; +/\* second moment of area, 'I' in the model \[m\^4\] \*/", header)
    assert all(len(line) <= 88 for line in header.split("\n"))


@pytest.mark.slow
def test_the_text_is_the_same_each_time():
    first, second = of_either("beam"), exported(BEAM)
    assert (first.text, first.companions[".h"]) == (second.text, second.companions[".h"])


def test_a_name_that_cannot_be_included_is_refused():
    model = pipeline.loads(SMALL)
    tfs = pipeline.derive_all(model)
    for name in ("", "a b", 'a"b', "../a", "a\nb", "é", "a>b", "-a"):
        with pytest.raises(UsageError, match="cannot be the name of a C header"):
            C99.export(model, tfs, stem=name, is_alone=False, samples=5)


# --------------------------------------------------------------------------------------- expressions


VALUES = {Kind.REAL: 1.5, Kind.IMAGINARY: -0.75j, Kind.COMPLEX: 2.5 + 0.5j}
OTHERS = {Kind.REAL: -3.0, Kind.IMAGINARY: 2.25j, Kind.COMPLEX: 0.25 - 4.0j}
OPERATIONS = {
    total: complex.__add__,
    difference: complex.__sub__,
    product: complex.__mul__,
    quotient: complex.__truediv__,
}
TEXTS = {Kind.REAL: "{0}_{1}.re", Kind.IMAGINARY: "{0}_{1}.im", Kind.COMPLEX: "{0}_{1}"}


def test_every_pair_of_kinds_computes_what_complex_numbers_do(tmp_path):
    lines, expected = [], []
    for letter, values in (("x", VALUES), ("y", OTHERS)):
        for kind, value in values.items():
            z = complex(value)
            lines.append(f"    const cx {letter}_{kind.value} = cx_of({z.real}, {z.imag});")
    for x, y in itertools.product(VALUES, OTHERS):
        for operation, exact in OPERATIONS.items():
            terms = [Term(TEXTS[k].format(letter, k.value), k) for letter, k in (("x", x), ("y", y))]
            found = complex_term(operation(*terms))
            lines.append(f"    z = {found.text};")
            lines.append(f"    value[{2 * len(expected)}] = z.re; value[{2 * len(expected) + 1}] = z.im;")
            expected.append(exact(complex(VALUES[x]), complex(OTHERS[y])))
    body = "\n".join(lines)
    run = f"void run(double *value)\n{{\n    cx z;\n{body}\n}}\n"
    found = np.zeros(len(expected), dtype=complex)
    built(tmp_path, f"{helpers(body, 'void', 1)}\n{run}").run(pointer(found.view(float)))
    assert found == pytest.approx(expected, rel=1e-15)


def test_a_quotient_of_numbers_of_any_size_neither_overflows_nor_vanishes(tmp_path):
    code = helpers("cx_div( lane_div(", "void", 1)
    calls = "".join(
        f"void run_{name}(const cx *z, const cx *w, cx *q)\n{{\n    *q = {name}(*z, *w);\n}}\n"
        for name in ("cx_div", "lane_div")
    )
    library = built(tmp_path, f"{code}\n{calls}")
    for z, w in itertools.product((1e200 + 2e200j, 3e-200 - 1e-200j, -2e150j), repeat=2):
        if not 1e-300 < abs(z) / abs(w) < 1e300:
            continue
        with mp.workdps(30):
            exact = complex(mp.mpc(z) / mp.mpc(w))
        for function in (library.run_cx_div, library.run_lane_div):
            found = np.zeros(1, dtype=complex)
            given = [np.array([v], dtype=complex) for v in (z, w)]
            function(*(pointer(v.view(float)) for v in given), pointer(found.view(float)))
            assert abs(found[0] - exact) <= 1e-15 * abs(exact)


# -------------------------------------------------------------------------------- the page and the command


def output_of(name):
    """Return what the program of a page prints, beside the files of the page, and what the page shows."""
    page = blocks(ROOT / "docs" / name)
    for block in page:
        if block.title:
            Path(block.title).write_text(block.text, encoding="utf-8")
    said = ""
    for command in [
        line.split() for block in page if block.language == "sh" for line in block.text.splitlines()
    ]:
        if command[0] == "symflex":
            assert run(command[1:]) == 0
        else:
            said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    return said, Path("output").read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_loop_of_an_exported_plant_and_controller_moves_as_the_machine(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said, output = output_of("code-on-a-drive.md")
    assert said == output
    # The plant's state equations, exact from one sample to the next; the force is delayed by 4.3 samples.
    rigid, vibrating = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0, 1.0], [-30e6, -4e3]])
    vibrating[1] *= 1 / 20 + 1 / 40
    system = np.zeros((5, 5))  # centre of mass, x_1 - x_2, force
    system[:2, :2], system[2:4, 2:4], system[1, 4], system[3, 4] = rigid, vibrating, 1 / 60, 1 / 20
    early, late = (expm(system * share * 1e-4)[:4] for share in (0.3, 0.7))
    state, forces, rate, error = np.zeros(4), [0.0] * 5, 0.0, 0.0
    shown = []
    for k in range(1001):
        position = state[0] + 40 / 60 * state[2]
        shown += [f"{0.1 * k:.1f} ms  {1e3 * position:.7f} mm"] if k % 200 == 0 else []
        before, error = error, 1e-3 - position
        # Tustin's rule for s/(1 + T_f s): 2/h is 20000/s.
        rate = (2e4 * (error - before) - (1 - 2e-4 * 2e4) * rate) / (1 + 2e-4 * 2e4)
        forces.append(5e5 * (error + 20e-3 * rate))
        for step, force in ((early, forces[-6]), (late, forces[-5])):
            state = step @ np.append(state, force)
    assert output.splitlines() == shown


@pytest.mark.slow
def test_the_example_of_the_page_prints_what_it_says(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said, output = output_of("export-c.md")
    assert said == output
    # Vaughan 1968: V_tip/F at a length l, by the closed form of the sliding-free beam.
    q = (7850 * 4.8e-4 / (200e9 * 4e-9)) ** 0.25 * math.sqrt(math.tau * 10) * 0.543
    exact = -(math.cos(q) + math.cosh(q)) / (math.cosh(q) * math.sin(q) + math.sinh(q) * math.cos(q))
    exact *= q / (7850 * 4.8e-4 * 0.543 * math.tau * 10)
    assert float(output.split()[1]) == pytest.approx(exact, abs=1e-6)
