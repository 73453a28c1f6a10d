"""Netlists as ngspice reads them: values by hand, letters that stay, and what is refused."""

import cmath
import re
from fractions import Fraction

import pytest

import symflex
from symflex.errors import Source, SymflexError
from symflex.model.spec.netlist import specification_of


def loaded(folder, body):
    path = folder / "circuit.cir"
    path.write_text(f"title\nV1 in 0 AC 1\n{body}\n")
    return symflex.load(path)


def value(folder, body, output="V_out", s=1j):
    model = loaded(folder, body)
    return complex(model.nested(output, model.inputs[0]).bind()(s))


def refusal(body):
    with pytest.raises(SymflexError) as raised:
        specification_of(Source("a.cir", f"title\nV1 in 0 AC 1\n{body}\n"), None)
    return raised.value.diagnostics[0]


def load_of(resistance):
    """A divider with 1 kOhm above: out/in = R/(R + 1k)."""
    return resistance / (resistance + 1000)


VALUES = {  # of a resistor from out to ground, by hand
    ".param r=2k q={r/2}\nR2 out 0 {q}": 1000,
    ".param q={r/2} r=2k\nR2 out 0 {q}": 1000,
    ".param r=1k\n.param r=3k\nR2 out 0 {r}": 3000,
    ".param r=1k\n.subckt s a b\n.param r=2k q={r/2}\nR1 a b {q}\n.ends\nX1 out 0 s": 1000,
    ".param r=1k\n.subckt s a b r=2k\nR1 a b {r}\n.ends\nX1 out 0 s r={3*r}": 3000,
    ".subckt s a b\n.param r=5k\nR1 a b {r}\n.ends\nX1 out 0 s r=3k": 3000,
    ".subckt s a b z={r/2} r=2k\nR1 a b {z}\n.ends\nX1 out 0 s r=4k": 2000,
    ".param w=1k\n.subckt s a b w=7k z=5\nR1 a b {z}\n.ends\nX1 out 0 s z={w}": 7000,
    # What X gives is computed before the subcircuit's own expressions: z sees the outer a.
    ".param a=1k\n.subckt s a1 b z=5\n.param a={2*6k}\nR1 a1 b {z}\n.ends\nX1 out 0 s z={a}": 1000,
    ".param r=1k\n.subckt i a b\nR1 a b {r}\n.ends\n.subckt o a b r=2k\nX1 a b i\n.ends\nX1 out 0 o": 2000,
    ".temp 50\nR2 out 0 1k tc1=0.01": 1230,
    ".temp 77\nR2 out 0 1k tc=0.01,0.001": 4000,
    ".options temp=50 tnom=20\nR2 out 0 1k tc1=0.01": 1300,
    ".temp 77\n.options temp=50\nR2 out 0 1k tc1=0.01": 1500,
    ".temp 77\nR2 out 0 1k tc1=0.01 temp=37": 1100,
    "R2 out 0 1k tc1=0.01 dtemp=10": 1100,
    ".param r=1k t=0.01\nR2 out 0 {r} tc1={t} dtemp=10": 1100,
    ".model rm r(tc1=0.01 tnom=17)\nR2 out 0 1k rm": 1100,
    ".model rm r(r=5k)\nR2 out 0 rm": 5000,
    ".param r={1k*(1+temper/100)}\n.temp 50\nR2 out 0 {r}": 1500,
    ".param a=1k\nR2 out 0 {a+1k}": 2000,
    ".param a=2 b=3\nR2 out 0 {1k*(a+b)}\nL1 out x {a*1m+1u}\nC1 x 0 {b*1p}": 5000,
    "R2 out 0 {2k}": 2000,
    "R2 out 0 {0.001meg+1kohm}": 2000,
    "R2 out 0 {8k/2*4}": 16000,
    "R2 out 0 {-2^2+104}": 100,
    "R2 out 0 '1k*sqrt(16)'": 4000,
    "R2 out 0 {pow(10,3)+sqr(10)}": 1100,
    "R2 out 0 {{1k}*2}": 2000,
    ".func f(x,y) {x*y+k}\n.param k=1k\nR2 out 0 {f(2,500)}": 2000,
    "R2 out 0 1E3": 1000,
    "R2 out 0 08k": 8000,
    "R2 out 0 .5k": 500,
    "R2 out 0 1k m=1": 1000,
    "R2 out 0 1k $hello": 1000,
    "R2 out 0 1k\nV3 x out 0 Rser=0 m=1\nI3 0 out 0 m=1\nRx x 0 1k": 500,
}


@pytest.mark.parametrize("body", VALUES)
def test_a_value_is_that_of_ngspice(body, tmp_path):
    found = value(tmp_path, f"R1 in out 1k\n{body}\n.print ac v(out)", s=1e-9j)
    assert found == pytest.approx(load_of(VALUES[body]), rel=1e-9)


FORMULAS = {
    ".subckt amp p n o params: Avol=200k Rout=100\nE1 1 0 p n {Avol}\nR1 1 o {Rout}\n.ends\n"
    "X1 in out out amp Avol=100k": {"X1_Avol"},  # without a load, Rout changes nothing
    "R1 in a 1\nL1 a 0 1m\nL2 out 0 4m\nK12 L1 L2 0.25\nR2 out 0 5": {"R1", "L1", "L2", "K12", "R2"},
    "R1 in out R1\nC1 out 0 C1": {"R1", "C1"},
    ".param R1=1k\nR1 in out R1\nC1 out 0 1u": {"R1", "C1"},
    "R1 in out 1k tc1=0.01 dtemp=3\nC1 out 0 1u": {"R1", "C1"},
}


@pytest.mark.parametrize("body", FORMULAS)
def test_values_stay_letters(body, tmp_path):
    model = loaded(tmp_path, f"{body}\n.print ac v(out)")
    written = str(model.transfer_function("V_out/V1")).partition(" = ")[2]
    assert {*re.findall(r"[A-Z]\w*", written)} == FORMULAS[body]


def test_a_lossless_line_has_the_transfer_function_of_the_textbook(tmp_path):
    # b/in = Z0*R2/(Z0*(R1 + R2)*cosh(s*TD) + (R1*R2 + Z0^2)*sinh(s*TD)); Pozar 2011, section 2.1
    s = 3e5 + 2e6j
    expected = 75 * 100 / (75 * 150 * cmath.cosh(s * 1e-6) + (5000 + 75**2) * cmath.sinh(s * 1e-6))
    for given in ("Z0=75 TD=1u", "Z0=75 F=250k", "Z0=75 F=1MEG NL=1", "zo={z} td={1/1meg}"):
        line = f".param z=75\nR1 in a 50\nT1 a 0 out 0 {given}\nR2 out 0 100\n.print ac v(out)"
        assert value(tmp_path, line, s=s) == pytest.approx(expected, rel=1e-12), given
    assert "cosh" in str(loaded(tmp_path, line).transfer_function("V_out/V1"))


def test_a_shorted_stub_has_the_impedance_of_the_textbook(tmp_path):
    # Z0*tanh(s*TD) behind R1; Pozar 2011, section 2.3
    s = 3e5 + 2e6j
    stub = 75 * cmath.tanh(s * 1e-6)
    for ends in ("out 0 0 0", "out 0 x x", "0 0 out 0"):
        body = f"R1 in out 50\nT1 {ends} Z0=75 TD=1u\n.print ac v(out)"
        assert value(tmp_path, body, s=s) == pytest.approx(stub / (50 + stub), rel=1e-12), ends


def test_windings_in_series_have_no_loose_end(tmp_path):
    body = "R1 in out 10\nL1 out q 1m\nL2 q 0 1m\nK1 L1 L2 0.3\n.print ac v(out)"
    assert loaded(tmp_path, body).warnings == ()
    s = 1e4j
    assert value(tmp_path, body, s=s) == pytest.approx(2.6e-3 * s / (2.6e-3 * s + 10))  # L1 + L2 + 2*M


def test_three_windings_are_solved_together(tmp_path):
    body = "L1 in 0 1\nL2 out 0 1\nL3 c 0 1\nK1 L1 L2 0.5\nK2 L2 L3 0.4\nK3 L1 L3 0.3\n.print ac v(out) v(c)"
    # Without a load, v_2 = k*v_1 and v_3 = k*v_1.
    assert (value(tmp_path, body), value(tmp_path, body, "V_c")) == (
        pytest.approx(0.5),
        pytest.approx(0.3),
    )


def test_a_linear_function_is_read_and_its_constant_left_out(tmp_path):
    for source in (
        "E1 out 0 VALUE={3*V(m)+V(in,m)/2+7}",
        "E1 out 0 vol='3*V(m)+(V(in)-V(m))/2'",
        "B1 out 0 V=3*V(m)+V(in,m)/2",
        "E1 out 0 POLY(2) m 0 in m 7 3 0.5",
        "G1 0 out VALUE = {3m*V(m)+V(in,m)/2k}\nR9 out 0 1k",
        "Vs m y 0\nR3 y 0 1e40\nH1 x 0 Vs 0\nB1 out x V=5*V(m)/2+V(in)/2+I(Vs)",
    ):
        body = f"R1 in m 1k\nR2 m 0 1k\n{source}\n.print ac v(out)"
        assert value(tmp_path, body) == pytest.approx(1.75), source  # 3/2 + 1/4


def test_currents_have_the_signs_of_spice(tmp_path):
    body = "E1 out 0 in 0 2\nR1 out 0 1k\nL1 in x 1\nL2 in x 1\nK1 L1 L2 0\nRx x 0 1\n"
    found = [value(tmp_path, f"{body}.print ac i({n})", f"I_{n}", s=1e-9j) for n in ("E1", "V1", "L1")]
    assert found == [pytest.approx(x, rel=1e-6) for x in (-0.002, -1, 0.5)]


def test_names_that_meet_stay_apart(tmp_path):
    body = (
        ".subckt s p\nR_a p q 1k\nR_b q 0 1k\n.ends\nX1 out s\nR1 in out 1k\nR9 X1_q out 1k\nR8 X1_q 0 1k\n"
    )
    assert value(tmp_path, f"{body}.print ac v(out) v(x1.q)", "V_X1_q") == pytest.approx(Fraction(1, 4))
    names = [f"R{c}1 out 0 2k" for c in "-+_"]
    assert value(tmp_path, "\n".join(["R1 in out 1k", *names, "Rx_1 out 0 2k"])) == pytest.approx(1 / 3)


REFUSED = {
    "R1 in 0 4k7": "4.7k",
    "R1 in 0 4R7": "4.7k",
    "R1 in 0 1ek": "1e3",
    "R1 in 0 0x10": "4.7k",
    "R1 in 0 0xf": "1e3",
    "R1 in 0 {2^3^2}": "(2^3)^2",
    "R1 in 0 {1mil}": "25.4u",
    "R1 in 0 {4k7}": "4.7k",
    "R1 in 0 {2>1?5:6}": "value that it chooses",
    "R1 in 0 {max(2,3)}": "value that it chooses",
    "R1 in 0 {(1>0)*5}": "value that it chooses",
    "R1 in 0 {V(in)*2}": "a source E, G, F or H",
    "R1 in 0 {1/0}": "",
    "R1 in 0 {x}": ".param x=1k",
    "R1 in 0 Rx": ".param Rx=1k",
    "R1 in 0 {1 2}": "",
    "R1 in 0 {foo(2)}": ".func",
    "R1 in 0} 1k": "close what it opens",
    'R1 in "0 1k': "close what it opens",
    "R1 in 0 1k tc1=": "",
    ".param x={y} y={x}\nR1 in 0 {x}": "another name",
    ".param x={x}\nR1 in 0 {x}": "another name",
    ".param a = 1k + 2k b = 3\nR1 in 0 {a}": "in braces",
    ".subckt s a b\nR1 a b 1k\n.ends\nX1 in 0 s r=3k": "declare it",
    ".subckt s a b\nR1 a b 1k\n.ends\n.subckt s a b\nR1 a b 2k\n.ends\nX1 in 0 s": "rename",
    ".temp 50 60\nR1 in 0 1k": ".temp 50",
    ".temp 50C\nR1 in 0 1k": ".temp 50",
    ".options rshunt=1k\nR1 in 0 1k": "every node",
    ".model rm r(rsh=10)\nR1 in 0 rm": "components",
    ".if (1)\nR1 in 0 1k\n.endif": "lines that hold",
    "R1 in 0 1k\n.end\nR2 in 0 1k": "remove it",
    "R1 in 0 1k\n.control\nalter r1=2k\n.endc": "remove the line",
    "B1 out 0 V=V(in)*V(in)": "slope",
    "E1 out 0 VALUE={1/V(in)}": "slope",
    "T1 in 0 b 0 Z0=50": "TD=1n",
    "O1 in 0 b 0 line": "[fields]",
    "F1 0 out V9 2": "voltage source of 0 V",
    "R1 in 0 1k ac=2k": "components",
    "R1 in 0 1k scale=2": "components",
    "R1 in 0 1k tce=2": "components",
    ".print ac v(nowhere)\nR1 in 0 1": "",
}


@pytest.mark.parametrize("body", REFUSED)
def test_what_would_be_read_otherwise_is_refused_with_what_to_write(body):
    problem = refusal(body)
    assert (problem.code, problem.span is not None) == ("SF105", True)
    assert REFUSED[body] in (problem.hint or "")


@pytest.mark.parametrize("first", ["V1 in 0 AC 1", "R1 in out 1k", ".param x=1k", ".temp 50"])
def test_a_first_line_that_is_no_title_is_refused(first):
    with pytest.raises(SymflexError, match="first line"):
        specification_of(Source("a.cir", f"{first}\nV2 in 0 AC 1\nR2 in 0 1k\n"), None)


def test_repeated_subcircuits_count_against_the_limit_of_lines():
    levels = [
        f".subckt s{n} a b\n" + "".join(f"X{k} a b s{n + 1}\n" for k in range(10)) + ".ends" for n in range(9)
    ]
    problem = refusal("X1 in 0 s0\n" + "\n".join([*levels, ".subckt s9 a b", "R1 a b 1", ".ends"]))
    assert (problem.code, problem.span is not None) == ("SF103", True)


def test_included_files_count_against_the_limit_of_lines():
    files = {f"f{n}": f".include f{n + 1}\n" * 10 for n in range(9)}
    with pytest.raises(SymflexError, match="SF103"):
        specification_of(
            Source("a.cir", "title\n.include f0\n"), lambda name: Source(name, files.get(name, "* nothing\n"))
        )


def test_functions_that_double_each_other_count_against_the_limit_of_lines():
    body = ".func f0(x) {x+1}\n" + "".join(
        f".func f{n}(x) {{f{n - 1}(x)+f{n - 1}(x)}}\n" for n in range(1, 30)
    )
    assert refusal(f"{body}R1 in 0 {{f29(1)}}").code == "SF103"


def test_a_long_chain_of_parameters_is_read(tmp_path):
    chain = "\n".join(f".param p{n}={{p{n + 1}+1}}" for n in range(300))
    text = specification_of(
        Source("a.cir", f"title\nV1 in 0 AC 1\n{chain}\n.param p300=1\nR1 in 0 {{p0}}\n"), None
    ).text
    assert 'p299 = "p300 + 1"' in text


def test_a_section_of_a_library_is_read(tmp_path):
    (tmp_path / "b.lib").write_text(".lib ff\n.param r=1\n.endl\n.lib tt\n.param r=3k\n.endl\n")
    body = ".lib b.lib TT\nR1 in out 1k\nR2 out 0 {r}\n.lib missing.lib\n"
    assert value(tmp_path, body) == pytest.approx(0.75)


def test_a_place_in_an_included_file_is_told_with_its_line(tmp_path):
    (tmp_path / "b.inc").write_text("R2 out 0 1k\nD1 out 0 diode\n")
    with pytest.raises(SymflexError) as raised:
        loaded(tmp_path, "R1 in out 1k\n.include b.inc")
    assert str(raised.value.diagnostics[0].span) == "b.inc:2:1"


def test_a_problem_of_the_circuit_is_told_at_its_statement(tmp_path):
    (tmp_path / "b.inc").write_text("* nothing\nR3 out loose 1k\n")
    model = loaded(tmp_path, "R1 in out 1k\n.include b.inc\nR2 x y\n+ 1k\n.print ac v(out)")
    places = {w.message.split("'")[1]: str(w.span).rpartition("/")[2] for w in model.warnings}
    assert places == {"R3": "b.inc:2:1", "R2": "circuit.cir:5:1"}
