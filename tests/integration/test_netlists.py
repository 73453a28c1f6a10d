"""SPICE netlists: voltages and currents against ngspice, what is refused, and netlists nobody trusts."""

import random
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

import symflex
from symflex.errors import SymflexError
from symflex.report.study import Study
from tests.unit.refusals import refusal

NETLISTS = {  # a line of a tilde stands for an empty one
    text.partition("\n")[0]: text.replace("\n~\n", "\n\n")
    for file in sorted((Path(__file__).parent / "netlists").iterdir())
    for text in file.read_text("utf-8").strip("\n").split("\n\n")
}


def by_ngspice(folder, text):
    """Return frequencies [Hz] and values of what a netlist prints."""
    asked = re.search(r"^\.print ac (.*)$", text, re.IGNORECASE | re.MULTILINE)[1].lower()
    body = re.sub(r"^\.print.*$", "", text, flags=re.IGNORECASE | re.MULTILINE)
    steps = ["set wr_singlescale", "set numdgt=16", "ac dec 3 10 2e7", f"wrdata out.data {asked}"]
    (folder / "run.cir").write_text("\n".join([body, ".control", *steps, ".endc", ".end\n"]))
    run = subprocess.run(
        ["ngspice", "-b", "run.cir"], cwd=folder, capture_output=True, text=True, check=False
    )
    assert (folder / "out.data").exists(), run.stdout[-500:]
    data = np.loadtxt(folder / "out.data")
    return data[:, 0], [data[:, k] + 1j * data[:, k + 1] for k in range(1, data.shape[1], 2)]


@pytest.mark.slow
@pytest.mark.needs_tool("ngspice")
@pytest.mark.parametrize("title", NETLISTS)
def test_a_netlist_has_the_voltages_that_ngspice_has(title, tmp_path):
    text = NETLISTS[title]
    path = tmp_path / "circuit.cir"
    path.write_text(f"{text}\n.end\n")
    model = symflex.load(path)
    hertz, values = by_ngspice(tmp_path, text)
    scale = 2 if "AC 2" in text else 1
    source = model.inputs[0]
    for output, expected in zip(model.outputs, values, strict=True):
        function = model.nested(output, source).bind()
        found = scale * np.array([complex(function(2j * np.pi * f)) for f in hertz])
        size = np.maximum(abs(expected), 1e-9 * max(abs(expected)))
        # Amplifiers with a gain of a million cost ngspice, which solves in doubles, that many digits.
        assert np.max(abs(found - expected) / size) < (1e-6 if "1e6" in text else 1e-9), output


def as_file(folder, body, name="circuit.cir", encoding="utf-8"):
    path = folder / name
    path.write_text("title\n" + body, encoding=encoding)
    return path


REFUSED = {
    "V1 in 0 AC 1\nD1 in 0 1N4148": "SF105",
    "V1 in 0 AC 1\nQ1 c in 0 BC547": "SF105",
    "V1 in 0 AC 1\nM1 d in 0 0 nmos": "SF105",
    "V1 in 0 AC 1\nS1 in out c 0 sw": "SF105",
    "V1 in 0 AC 1\nB1 out 0 V=V(in)^2": "SF105",
    "V1 in 0 AC 1\nE1 out 0 POLY(1) in 0 0 1 1": "SF105",
    "V1 in 0 AC 1\nE1 out 0 POLY(1) in 0 5": "SF105",  # a constant for ngspice, a gain for others
    "V1 in 0 AC 1\nE1 out 0 in 0 laplace=1/(1+s)": "SF105",
    "V1 in 0 AC 1\nR1 in out": "SF105",
    "V1 in 0 AC 1\nR1 in out ten": "SF105",
    "V1 in 0 AC 1\nR1 in out 1k\nR1 out 0 1k": "SF105",
    "V1 in 0 AC 1\nX1 in out filter": "SF105",
    "V1 in 0 AC 1\nX1 in a b c filter\n.subckt filter a b\nR1 a b 1\n.ends": "SF105",
    "V1 in 0 AC 1\nX1 in 0 f\n.subckt f a b\nX1 a b f\n.ends": "SF105",
    "V1 in 0 AC 1\n.subckt f a b\nR1 a b 1": "SF105",
    "V1 in 0 AC 1\nL1 in 0 1\nL2 b 0 1\nK1 L1 L2 1\nK2 L2 L1 1": "SF105",
    "V1 in 0 AC 1\nK1 L1 L2 0.5": "SF105",
    "R1 in out 1k": "SF105",
    "V1 in 0 AC 1\n.include ../outside.inc": "SF105",
    "V1 in 0 AC 1\n.include /etc/passwd": "SF105",
    "V1 in 0 AC 1\n.include circuit.cir": "SF105",
    "V1 in 0 AC 1\nF1 0 out V9 2\nR1 out 0 1": "SF105",
    "V1 in 0 AC 1\nR1 in 0 {__import__('os')}": "SF105",
    "V1 in 0 AC 1\nR1 in 0 {R1[0]}": "SF105",
    "V1 in 0 AC 1\n.explode now": "SF105",
    "V1 in 0 AC 1\nR1 in 0 1k m=2": "SF105",
    "V1 in 0 AC 1\nR1 in 0 10 k": "SF105",
    "V1 in 0 AC 1\nC1 in 0 1n Rser=1": "SF105",
    "V1 in 0 AC 1 Rser=50\nR1 in 0 1k": "SF105",
    "V1 in 0 AC 1\nE1 out 0 fdopamp in 0 cm 1e5\nR1 out cm 1": "SF105",
    "V1 in 0 AC 1\nX1 = 1": "SF105",
    "V1 in 0 AC 1\nR1 in 0 1e9999999999k": "SF105",
    "V1 in 0 AC 1\nX1 in 0 f m=2\n.subckt f a b\nR1 a b 1\n.ends": "SF105",
    "V1 in 0 AC 1\nX1 in out adj LT1083": "SF105",  # a regulator
    "V1 in 0 AC 1\nX1 in 0 p m out opamp": "SF105",  # LTspice's has three pins
    "V1 in 0 AC 1\nX1 in out p m out level.3a Avol=1Meg GBW=10Meg": "SF105",  # with a second pole
    "V1 in 0 AC 1\nX1 in out opamp Cin=1p": "SF105",
    "V1 in 0 AC 1\n.func f(x) {2*f(x)}\nR1 in 0 {f(1)}": "SF105",
    "V1 in 0 AC 1\n.func f(x,y) {2*x}\nR1 in 0 {f(1)}": "SF105",
    "V1 in 0 AC 1\nR1 in out 4,7k\nR2 out 0 1k": "SF105",
    "V1 in 0 AC 1\n.print ac v(ot)\nR1 in out 1k\nR2 out 0 1k": "SF105",
}


@pytest.mark.parametrize("body", REFUSED)
def test_what_has_no_linear_model_is_refused_with_its_place(body, tmp_path):
    (tmp_path / "outside.inc").write_text("R9 in 0 1k\n")
    inner = tmp_path / "inner"
    inner.mkdir()
    assert refusal(symflex.load, as_file(inner, body)) == f"SpecError {REFUSED[body]}"


def test_a_diode_is_named_with_its_place_and_its_replacement(tmp_path):
    with pytest.raises(SymflexError) as raised:
        symflex.load(as_file(tmp_path, "V1 in 0 AC 1\nD1 in out 1N4148\nR1 out 0 1k"))
    (problem,) = raised.value.diagnostics
    assert (problem.span.line, "diode" in problem.message, "resistor" in problem.hint) == (3, True, True)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1", "utf-16"])
def test_netlists_are_read_in_the_encodings_of_ltspice(encoding, tmp_path):
    path = as_file(tmp_path, "V1 in 0 AC 1\nR1 in out 1k\nC1 out 0 1µ\n", encoding=encoding)
    assert str(symflex.load(path).transfer_function("V_out/V1")) == "V_out/V1 = 1/(R1*C1*s + 1)"


@pytest.mark.parametrize(
    "body",
    [
        ".source V1\n.detector V_out\nV1 in 0 V value=0 dc=0\nR1 in out R value={R} noisetemp=0\n"
        "C1 out 0 C value={C} vinit=0\n.param R=1k C=1u",  # SLiCAP
        "V1 in 0 AC 1\nR1 in out 1k\nC1 out 0 1u\n.ac lin 1 1k 1k\n.end\n* R2 out 0 1k",
        "V1 in 0 AC 1\nXU1 out o out opamp Aol=1e9\nR1 in o 1k\nC1 o 0 1u\n.print ac v(out)",
        "V1 in 0 AC 1\nXU1 in n p m out level.2 Avol=2 Rin=1k Rout=1k Slew=1\nR1 n 0 1k\nC1 out 0 1u",
        "V1 Net-(R1-Pad1) 0 AC 1\nR1 Net-(R1-Pad1) out {log10((10))*1k}\nC1 out 0 1u",  # KiCad
        'V1 in 0 AC 1\nR1 in x 0\nR2 x out 1k tol=1 pwr=0.1\nC1 out 0 1u V=25 Rser=0 mfg="any"',
    ],
)
def test_other_programs_write_a_low_pass_in_their_ways(body, tmp_path):
    model = symflex.load(as_file(tmp_path, body))
    assert complex(model.nested("V_out", "V1").bind()(1000j)) == pytest.approx(0.5 - 0.5j, rel=1e-7)


def test_a_file_beside_the_netlist_is_included(tmp_path):
    (tmp_path / "lib").mkdir()
    (tmp_path / "lib" / "parts.inc").write_text(".subckt half a b\nR1 a b 1k\nR2 b 0 1k\n.ends\n")
    path = as_file(tmp_path, "V1 in 0 AC 1\n.include lib/parts.inc\nX1 in out half\n")
    assert complex(symflex.load(path).transfer_function("V_out/V1").bind()(1j)) == pytest.approx(0.5)


def test_an_op_amp_of_ltspice_follows(tmp_path):
    amplifier = "XU1 in out vcc vee out level.2 Avol=1Meg GBW=10Meg\nVc vcc 0 15\nVe vee 0 -15\n"
    path = as_file(tmp_path, f"V1 in 0 AC 1\n{amplifier}.print ac v(out)")
    found = complex(symflex.load(path).transfer_function("V_out/V1").bind()(2j * np.pi * 1e6))
    assert found == pytest.approx(1 / (1 + 1e-6 + 0.1j), rel=1e-12)  # A(s) = 1/(1e-6 + s/(2 pi 10 MHz))


@pytest.mark.parametrize("seed", range(20))
def test_broken_netlists_end_in_a_model_or_a_typed_error(seed, tmp_path):
    rng = random.Random(seed)
    for number in range(10):
        text = list(rng.choice(list(NETLISTS.values())))
        for _ in range(rng.randrange(1, 12)):
            place = rng.randrange(len(text))
            text[place : place + rng.randrange(3)] = rng.choice([*"{}=\n\0('é+*.X ", "9" * 40])
        path = tmp_path / f"{number}.cir"
        path.write_text("".join(text), encoding="utf-8")
        assert refusal(symflex.load, path).split(" ")[0] in ("", "SpecError", "ModelError")


def test_a_report_shows_a_netlist_as_a_specification(tmp_path):
    path = as_file(tmp_path, "V1 in 0 AC 1\nR1 in out 1k\nC1 out 0 1u\n", encoding="utf-16")
    assert Study.of(path, "circuit").text.startswith("symflex = 1\n")
