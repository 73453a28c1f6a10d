"""Printed tables: entries of books and own solves, right, mistyped, or of another machine."""

import pytest

from symflex.audit.slips import audit_tables
from symflex.errors import Source, SpecError
from symflex.model import load_with

BEAM = """symflex = 1
[parameters]
E = "200 GPa"
I = "1e-8 m^4"
rho = "7800 kg/m^3"
A = "1e-4 m^2"
l = "1 m"
[elements]
wall = { type = "fixed", at = "a" }
arm = { type = "beam", between = ["a", "b"], E = "E", I = "I", rho = "rho", A = "A", l = "l" }
[inputs]
F = { force = "b" }
[outputs]
Y = "b"
"""
CHAIN = """symflex = 1
[parameters]
m_1 = "1 kg"
m_2 = "3 kg"
k_1 = "4 kN/m"
k_2 = "7 kN/m"
c = "20 N*s/m"
[elements]
a = { type = "mass", at = "x", m = "m_1" }
b = { type = "mass", at = "y", m = "m_2" }
s = { type = "spring", between = ["ground", "x"], k = "k_1" }
t = { type = "spring", between = ["x", "y"], k = "k_2" }
[inputs]
F = { force = "y" }
[outputs]
X = "x"
Y = "y"
"""
# omega^2 is a root of m_1 m_2 w^2 - (m_2 (k_1 + k_2) + m_1 k_2) w + k_1 k_2 = 3 w^2 - 40000 w + 28e6:
# omega = 27.22506, 112.21466.
LAMBDA = "omega*l^2*sqrt(rho*A/(E*I))"


def judged(model, table):
    source = Source("model.toml", f'{model}[tables."T"]\n{table}\n')

    def load(text):
        return load_with(text, {})

    (found,) = audit_tables(load(source), source, load)
    return found


def verdicts(found):
    return [entry.verdict for entry in found.entries]


def test_a_books_table_of_a_cantilever_is_right():
    # R. D. Blevins, Formulas for natural frequency and mode shape, 1979, table 8-1: lambda^2.
    found = judged(BEAM, f'prints = "{LAMBDA}"\nvalues = ["3.51602", "22.0345", "61.6972", "120.902"]')
    assert found.verdict == "right"
    assert (found.right, found.count) == (4, 4)


def test_an_entry_off_by_one_in_the_last_digit_is_badly_rounded():
    found = judged(BEAM, f'prints = "{LAMBDA}"\nvalues = ["3.5161", "22.034"]')
    assert verdicts(found) == ["rounded", "right"]
    assert found.verdict == "rounded"


def test_exchanged_digits_are_named():
    # A paper of 2015 prints 3.15601 for 3.516015.
    found = judged(BEAM, f'prints = "{LAMBDA}"\nvalues = ["3.15601", "22.0345"]')
    assert (found.entries[0].verdict, found.entries[0].right, found.entries[0].digits) == (
        "wrong",
        "3.51602",
        1,
    )
    assert "3.51601 with two digits exchanged" in found.slip


def test_a_root_left_out_and_an_entry_without_one_are_named():
    found = judged(BEAM, f'prints = "{LAMBDA}"\nvalues = ["3.516", "61.697", "80.11", "120.90"]')
    assert verdicts(found) == ["right", "missing", "right", "extra", "right"]
    assert found.entries[1].right == "22.034"


@pytest.mark.parametrize(
    "values",
    [
        ["1.8751", "4.6941", "7.8548", "10.996"],  # beta*l
        ["1", "6.2669", "17.547", "34.386"],  # ratios
        ["28.336", "177.58", "497.23"],  # Hz
        ["178.04", "1115.8", "3124.2"],  # rad/s
        ["1700.2", "10655", "29834"],  # rpm
    ],
    ids=["wavenumbers", "ratios", "Hz", "rad/s", "rpm"],
)
def test_other_normalisations_are_not_called_wrong(values):
    # 1.8751, 4.6941, 7.8548, 10.9955 (Blevins); their squares times sqrt(E I/(rho A))/l^2 = 50.63697 rad/s.
    assert judged(BEAM, f"values = {values}".replace("'", '"')).verdict == "right"


def test_a_table_of_nothing_is_not_decided():
    found = judged(BEAM, 'values = ["17.1", "99.3", "101.4"]')
    assert (found.verdict, found.prints) == ("undecided", None)
    assert "say it" in found.reason


def test_rows_with_other_values_and_gaps():
    # A tip mass as heavy as the beam: 1 + cosh b cos b + b (cos b sinh b - sin b cosh b) = 0,
    # b = 1.2479174, 4.0311391 (mpmath).
    model = BEAM.replace("[inputs]", 'load = { type = "mass", at = "b", m = "m" }\n[inputs]')
    model = model.replace('l = "1 m"', 'l = "1 m"\nm = { value = "0 kg", assume = "nonnegative" }')
    rows = '[["3.516", "-", "61.697"], { set = { m = "780 g" }, values = ["1.5573", "16.250"] }]'
    found = judged(model, f'prints = "{LAMBDA}"\nrows = {rows}')
    assert found.verdict == "right"
    assert verdicts(found) == ["right", "gap", "right", "right", "right"]


def test_zeros_at_the_end_of_an_integer_may_only_fill_it():
    found = judged(BEAM, 'prints = "60*f"\nvalues = ["1700", "10700", "29800"]')
    assert found.verdict == "right"


def test_hertz_for_radians_is_named():
    found = judged(CHAIN, 'prints = "f"\nvalues = ["27.225", "112.21"]')
    assert "2 pi times" in found.slip


def test_exchanged_masses_are_named():
    # 3 w^2 - (1*(4000 + 7000) + 3*7000) w + 28e6 = 0: omega = 31.01141, 98.51375.
    found = judged(CHAIN, 'prints = "omega"\nvalues = ["31.011", "98.514"]')
    assert found.verdict == "wrong"
    assert "m_1 and m_2 are exchanged" in found.slip


def test_a_spring_left_out_is_named():
    # Without k_1: w = k_2 (1/m_1 + 1/m_2) = 9333.33.
    found = judged(CHAIN, 'prints = "omega"\nvalues = ["96.6092"]')
    assert "k_1 is left out" in found.slip


NUMBERS = """symflex = 1
[elements]
a = { type = "mass", at = "x", m = "1 kg" }
b = { type = "mass", at = "y", m = 3 }
s = { type = "spring", between = ["ground", "x"], k = "4 kN/m" }
t = { type = "spring", between = ["x", "y"], k = "7 kN/m" }
[inputs]
F = { force = "y" }
[outputs]
X = "x"
"""


@pytest.mark.parametrize(
    ("model", "values", "slip"),
    [
        # m_1 m_2 w^2 - (m_2 (k_1 + k_2) + m_1 k_2) w + k_1 k_2 = 0 with other numbers, solved with numpy.
        (CHAIN, ["25.6306", "109.893"], "k_1 is 3.4 kN/m, not 4 kN/m"),
        (CHAIN, ["30.1522", "184.456"], "k_2 is 23.2 kN/m, not 7 kN/m"),
        (NUMBERS, ["26.9707", "106.090"], "m of a is 1.14 kg, not 1 kg"),
        (NUMBERS, ["17.1880", "107.509"], "m of b is 8.2, not 3"),
        (NUMBERS, ["28.4596", "107.347"], "k of s and k of t are exchanged"),
        (NUMBERS, ["31.1214", "310.427"], "k of t is 10 times the declared value"),
    ],
    ids=["digits", "another value", "in an element", "bare", "exchanged", "a factor"],
)
def test_another_number_is_named(model, values, slip):
    found = judged(model, f'prints = "omega"\nvalues = {values}'.replace("'", '"'))
    assert slip in found.slip


def test_a_number_in_a_row_is_named():
    # As above with m_2 = 6.6 kg, where 6 kg is set.
    rows = '[["27.2251", "112.215"], { set = { m_2 = "6 kg" }, values = ["19.0437", "108.157"] }]'
    found = judged(CHAIN, f'prints = "omega"\nrows = {rows}')
    assert found.slip.startswith("all 4 entries are right if m_2 in row 2 is 6.6 kg, not 6 kg")


@pytest.mark.slow
def test_a_condition_of_a_field_is_named():
    # A clamped end for a pinned one: 1.8751041^2 and 4.6940911^2 for no root at all.
    model = (
        BEAM.split("[elements]", maxsplit=1)[0]
        + """[fields.w]
domain = ["0", "l"]
equation = "E*I*w'''' + rho*A*s^2*w = 0"
conditions = ["w(0) = 0", "w''(0) = 0", "w''(l) = 0", "E*I*w'''(l) = F"]
[inputs]
F = {}
[outputs]
W = "w(l)"
"""
    )
    found = judged(model, f'prints = "{LAMBDA}"\nvalues = ["3.51602", "22.0345"]')
    assert "a condition of w is w'(0) = 0, not w''(0) = 0" in found.slip


def test_entries_that_no_number_explains_get_no_explanation():
    assert not judged(CHAIN, 'prints = "omega"\nvalues = ["25.811", "117.43"]').slip


@pytest.mark.slow
def test_another_support_is_named():
    # tan b = tanh b: b = 3.92660231, 7.06858275, 10.21017612 (Blevins, table 8-1).
    found = judged(BEAM, 'prints = "f"\nvalues = ["124.26", "402.67", "840.15"]')
    assert "wall is a pin, not fixed" in found.slip


def test_one_wrong_entry_of_few_digits_gets_no_explanation():
    assert not judged(CHAIN, 'prints = "omega"\nvalues = ["27.2", "145."]').slip


TABULAR = r"""
\begin{tabular}{|c|c|c|} \hline
Mode & \multicolumn{2}{c|}{Frequency (Hz)} \\ \cline{2-3}
 & Present & FEM \\ \hline
1 & 28.336 & 28.34 \\
2 & $177{,}58$ & 171.6 \\
3 & \textbf{497.23}$^{a}$ & -- \\ \hline
\end{tabular}
"""


def test_a_decimal_comma_is_a_point_where_no_thousands_can_be_meant():
    found = judged(CHAIN, 'prints = "omega"\nvalues = ["27,2251", "112,215"]')
    assert verdicts(found) == ["right", "right"]


def test_a_tabular_is_read_as_it_is_typed():
    # The cantilever's frequencies are those of Blevins' wavenumbers: 28.336, 177.58 and 497.23 Hz.
    found = judged(BEAM, f"latex = '''{TABULAR}'''")
    assert [(row.heading, row.entries) for row in found.table.rows] == [
        ("Frequency (Hz) Present", ("28.336", "177.58", "497.23")),
        ("FEM", ("28.34", "171.6", "-")),
    ]
    assert (found.reading, verdicts(found)) == ("f [Hz]", ["right"] * 4 + ["wrong", "gap"])


def test_natural_frequencies_in_any_order_and_columns_of_other_quantities():
    # m_1 x'' + c x' + k_1 x with 1 kg, 20 N s/m, 4 kN/m: omega_n = 63.2456, zeta = 0.158114, sigma = -10.
    # m_2 alone on 7 kN/m: omega_n = 48.3046.
    model = CHAIN.replace('between = ["x", "y"], k = "k_2"', 'between = ["ground", "y"], k = "k_2"')
    model = model.replace("s = {", 'd = { type = "damper", between = ["ground", "x"], b = "c" }\ns = {')
    model = model.replace('X = "x"', 'X = "x + y"').replace("F = { force", 'G = { force = "x" }\nF = { force')
    model = model.replace('X = "x + y"\nY = "y"', 'X = "x"')
    assert judged(model, 'values = ["63.2456"]').reading == "omega_n [rad/s]"
    table = r"n & $f$ & error \\% \\\\ 1 & 9.9392 & 3 \\\\ 2 & 17 & 4"
    assert judged(model, 'prints = "-sigma"\nvalues = ["10.000"]').verdict == "right"
    assert judged(BEAM, 'prints = "f"\nvalues = ["177.58", "28.336"]').verdict == "right"
    assert judged(BEAM, f"latex = '{table}'").verdict == "undecided"


def test_zeros_and_damping_ratios():
    # X/F has no zeros; Y/F those of m_1 on both springs, sqrt(11000).
    assert judged(CHAIN, 'of = "zeros"\ntf = "Y/F"\nprints = "omega"\nvalues = ["104.88"]').verdict == "right"
    # m_2 alone on k_2 and c: zeta = c/(2 sqrt(k m)) = 20/(2 sqrt(21000)).
    model = CHAIN.replace("s = {", 'd = { type = "damper", between = ["ground", "y"], b = "c" }\ns = {')
    model = model.replace(
        't = { type = "spring", between = ["x", "y"]', 't = { type = "spring", between = ["ground", "y"]'
    )
    found = judged(model, 'tf = "Y/F"\nprints = "zeta"\nvalues = ["0.0690"]')
    assert found.entries[0].verdict == "right"


@pytest.mark.parametrize(
    ("table", "code"),
    [
        ('prints = "f"', "SF214"),
        ('prints = "x"\nvalues = ["1"]', "SF212"),
        ('prints = "k_1"\nvalues = ["1"]', "SF208"),
        ('prints = "omega*q"\nvalues = ["1"]', "SF210"),
        ("latex = 'a & b'", "SF208"),
        ('values = ["1"]\nlatex = "1 & 2"', "SF214"),
        ('values = ["1,875"]', "SF206"),
        ('values = ["1e999"]', "SF206"),
        ("values = [true]", "SF206"),
        ('rows = "1"', "SF206"),
        ('of = "nodes"\nvalues = ["1"]', "SF208"),
        ('tf = "X/G"\nvalues = ["1"]', "SF218"),
        ('rows = [{ set = { q = 1 }, values = ["1"] }]', "SF210"),
        ('rows = [{ set = { m_1 = "1 m" }, values = ["1"] }]', "SF203"),
        ('rows = [{ set = { m_1 = "-1 kg" }, values = ["1"] }]', "SF209"),
        ('rows = [{ set = { m_1 = "1 kg" } }]', "SF214"),
        ('print = "f"\nvalues = ["1"]', "SF207"),
        ("values = [" + '"1", ' * 2001 + "]", "SF103"),
    ],
)
def test_what_is_no_table_is_refused_at_its_place(table, code):
    with pytest.raises(SpecError) as error:
        judged(CHAIN, table)
    (problem,) = error.value.diagnostics
    assert problem.code == code
    assert problem.span is not None
