"""Values a distributed part cannot have: told from numbers, from declared values and from assumed signs."""

from symflex import pipeline
from symflex.errors import Source, SpecError
from symflex.model import load_model

PARAMETERS = """symflex = 1
[parameters]
E = "70 GPa"
rho = "2700 kg/m^3"
A = "1e-3 m^2"
l = "1.2 m"
l_2 = {}
x_1 = { value = "1.2 m", assume = "real" }
z = { value = "0 m", assume = "nonnegative" }
d = { assume = "real" }
[definitions]
rest = "l - x_1"
"""
ROD = {"E": "E", "rho": "rho", "A": "A", "l": "l"}
REST = '[inputs]\nF = { force = "b" }\n[outputs]\nX = "b"\n'
DELAY = """symflex = 1
[parameters]
T = "2 ms"
T_r = { assume = "real" }
[blocks]
D = { type = "delay", T = "%s" }
[inputs]
u = {}
[outputs]
y = "D*u"
"""


def rod(**changed):
    keys = "".join(f'{name} = "{value}"\n' for name, value in {**ROD, **changed}.items())
    return PARAMETERS + f'[elements.bar]\ntype = "rod"\nbetween = ["a", "b"]\n{keys}' + REST


def codes(text):
    try:
        load_model(Source("spec.toml", text))
    except SpecError as error:
        return [d.code for d in error.diagnostics]
    return []


def test_a_length_that_may_be_positive_is_accepted():
    for length in ["l", "l - x_1/2", "l_2", "d", "l - l_2", "l + z", "0.5*rest + l"]:
        assert codes(rod(l=length)) == [], length


def test_a_length_known_to_be_zero_or_negative_is_refused():
    for length in [
        "0 m", "-1 m", "-l", "-l_2", "l - x_1", "l - 2*x_1", "rest", "z", "2*z", "-l - l_2", "l - 1.2",
    ]:  # fmt: skip
        assert codes(rod(l=length)) == ["SF209"], length


def test_a_stiffness_known_to_be_zero_or_negative_is_refused():
    for modulus in ["0", "-3", "E - E", "-E", "0 GPa"]:
        assert codes(rod(E=modulus)) == ["SF209"], modulus


def test_a_stiffness_divided_by_a_sum_has_the_sign_of_its_value():
    # The modulus divided by 1 minus 1.2 is negative, that divided by 1 minus 0.5 is not.
    for length, code in (("1.2", ["SF209"]), ("0.5", [])):
        text = rod(E="E/(1 - r)").replace("[definitions]", f"r = {length}\n[definitions]")
        assert codes(text) == code, length


def test_what_may_be_zero_is_accepted_as_zero():
    for key in ["eta", "rho"]:
        assert codes(rod(**{key: "0"})) == [], key


def test_a_modulus_that_depends_on_s_is_accepted():
    assert codes(rod(E="E*(1 + 0.001*s)")) == []


def test_a_negative_elastic_foundation_is_accepted():
    assert codes(rod(k_f="-5 N/m^2")) == []


def test_a_value_with_another_mistake_is_reported_once():
    assert codes(rod(l="-l*unheard")) == ["SF210"]


def test_a_delay_that_may_not_be_negative_is_accepted():
    for time in ["T", "0 s", "T - T", "T_r", "T_r - T", "T*(3 - 2)"]:
        assert codes(DELAY % time) == [], time


def test_a_delay_known_to_be_negative_is_refused():
    for time in ["-T", "T - 2*T", "-2 ms", "T - 0.003"]:
        assert codes(DELAY % time) == ["SF209"], time


def test_a_domain_without_length_by_value_is_refused():
    for end in ["z", "l - x_1", "0*l"]:
        text = (
            PARAMETERS
            + f'[fields.u]\ndomain = ["0", "{end}"]\nequation = "E*u\'\' = rho*s^2*u"\n'
            + 'conditions = ["u(0) = F", "u\'(0) = 0"]\n[inputs]\nF = {}\n[outputs]\nX = "u(0)"\n'
        )
        assert "SF240" in codes(text), end


def test_a_section_may_end_in_a_tip_however_it_is_written():
    for section in ('A = "a*(1 - x/l)", I = "i*(1 - x/l)^3"', 'A = "a - a*x/l", I = "i*((l - x)/l)^3"'):
        text = 'symflex = 1\nparameters = { a = "1 m^2", i = "1 m^4", l = "1 m" }\n[elements]\n'
        text += f'wedge = {{ type = "beam", between = ["root", "tip"], {section}, '
        text += 'E = "1 Pa", rho = "1 kg/m^3", l = "l" }\n[inputs]\nz = { displacement = "root" }\n'
        assert pipeline.loads(text + '[outputs]\nY = "wedge.y(l/2)"\n').elements
