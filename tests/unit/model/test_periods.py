"""The inverse of a frequency in Hz is a period, wherever it is written and however far it is passed on."""

from cmath import exp, pi

import pytest

import symflex
from benchmarks.generated import imported
from symflex import pipeline
from symflex.codegen.exporters import EXPORTERS
from symflex.errors import SpecError

S = -300 + 4000j
FREE = "\n[inputs]\nu = {}\n[outputs]\ny = "


def text(rest, period='T_s = "1/f_s"', frequency="10 kHz"):
    return f'symflex = 1\n[parameters]\nf_s = "{frequency}"\nK = "2 V/A"\n[definitions]\n{period}\n{rest}'


def output(expression, blocks=""):
    return f'[blocks]\n{blocks}{FREE}"{expression}"\n'


def pid(gains):
    return output("C*u", f'C = {{ type = "pid", k_p = "K", {gains} }}\n')


D = 'D = { type = "delay", T = "1.5*T_s" }\n'
NOTCH = '{ type = "notch", omega = "pi/(2*T_s)", zeta_p = 0.5 }'
# What each is at s with the period T, by hand.
RIGHT = [
    (text(pid('k_i = "K/(20*T_s)"')), lambda s, T: 2 * (1 + 1 / (20 * T * s))),
    (text(pid('k_i = "K*0.05/T_s", k_d = "2*K*T_s", T_f = "T_s/2"')),
     lambda s, T: 2 * (1 + 0.05 / (T * s) + 2 * T * s / (1 + T * s / 2))),
    (text(pid('k_d = "K*(1/f_s)"')), lambda s, T: 2 * (1 + T * s)),
    (text(output("D*(1 + 3*T_s*s)/(1 + T_s*s)*u", D)),
     lambda s, T: exp(-1.5 * T * s) * (1 + 3 * T * s) / (1 + T * s)),
    (text(output("exp(-s*T_d)*u"), 'T_s = "1/f_s"\nT_d = "T_c + T_s/2"\nT_c = "T_s"'),
     lambda s, T: exp(-1.5 * T * s)),
    (text(output("exp(-1.5*s/f_s)*u/(1 + T_s*s)^2")), lambda s, T: exp(-1.5 * T * s) / (1 + T * s) ** 2),
    (text(output("u/(T_s^2*s^2 + 1.4*T_s*s + 1)")), lambda s, T: 1 / ((T * s) ** 2 + 1.4 * T * s + 1)),
    (text(output("u/(1 + (1/f_s)*s)")), lambda s, T: 1 / (1 + T * s)),
    (text(output("u/(1 + 2*s*f_s^-1)")), lambda s, T: 1 / (1 + 2 * T * s)),
    (text(output("L*u", 'L = { type = "lag", T = "3*T_s" }\n')), lambda s, T: 1 / (1 + 3 * T * s)),
    (text(output("L*N*u", f'L = {{ type = "lag", T = "3/f_s" }}\nN = {NOTCH}\n')),
     lambda s, T: (s**2 + (pi / 2 / T) ** 2) / (s**2 + pi / 2 / T * s + (pi / 2 / T) ** 2) / (1 + 3 * T * s)),
    (text(output("u/(1 + n*T_s*s)").replace("[blocks]", "[parameters.n]\nvalue = 4\n[blocks]")),
     lambda s, T: 1 / (1 + 4 * T * s)),
    (text(output("u/(1 + T_s*s)"), 'f_N = "f_s/2"\nT_s = "1/f_N"'), lambda s, T: 1 / (1 + 2 * T * s)),
    (text(output("u/(s + 2*pi*f_s/20)*exp(-T_s*s)")), lambda s, T: exp(-T * s) / (s + 2 * pi / 20 / T)),
    (text(output("u/(1 + T_s*s)"), 'T_s = "60/f_s"', "600 krpm"), lambda s, T: 1 / (1 + 60 * T * s)),
    # 1/(2*pi*f) is the time of a corner, and says so itself.
    (text(output("u/(1 + T_s*s)"), 'T_s = "1/(2*pi*f_s)"'), lambda s, T: 1 / (1 + T * s / (2 * pi))),
]  # fmt: skip


def test_a_period_is_the_same_wherever_it_is_used():
    wrong = []
    for spec, right in RIGHT:
        tf = symflex.loads(spec).transfer_function("y", "u")
        values = (tf.bind()(S), tf.bind(f_s="2 kHz")(S), tf.bind(f_s=2000)(S))
        if values != pytest.approx((right(S, 1e-4), right(S, 5e-4), right(S, 5e-4)), rel=1e-11):
            wrong.append(spec)
    assert wrong == []


@pytest.mark.slow
def test_exported_functions_take_the_frequency_in_hertz():
    wrong = []
    for spec, right in RIGHT:
        model = pipeline.loads(spec)
        module = imported(EXPORTERS["numpy"].export(model, pipeline.derive_all(model)).text, "periods")
        (function,) = module.TRANSFER_FUNCTIONS.values()
        if complex(function(S, f_s=2000.0)) != pytest.approx(right(S, 5e-4), rel=1e-9):
            wrong.append(spec)
    assert wrong == []


def test_a_formula_of_a_period_is_printed_without_pi():
    form = symflex.loads(RIGHT[0][0]).transfer_function("y", "u").form("polynomial")
    assert str(form) == "y/u = (20*K*s + f_s*K)/(20*s)"


def test_a_frequency_over_a_frequency_and_s_over_one_keep_their_meaning():
    # f_c/f_s counts cycles per sample; s/f_s compares with an angular frequency, as s + f_s does.
    ratio = text(output("f_c/f_s*u")).replace("[definitions]", 'f_c = "1 kHz"\n[definitions]')
    corner = text(output("u/(1 + s/f_s)"), 'T = "1 s"')
    values = [symflex.loads(x).transfer_function("y", "u").bind()(S) for x in (ratio, corner)]
    assert values == pytest.approx([0.1, 1 / (1 + S / (2 * pi * 1e4))], rel=1e-12)


def test_a_period_and_an_angular_frequency_may_stand_in_one_expression():
    both = symflex.loads(text(output("T_s*u/(s + f_s)"))).transfer_function("y", "u").bind()
    assert both(S) == pytest.approx(1e-4 / (S + 2e4 * pi), rel=1e-12)


def test_what_is_a_period_or_an_angular_frequency_is_refused():
    for spec in (pid('k_d = "K/f_s"'), output("f_s*T_s*u"), output("K/f_s*u")):
        with pytest.raises(SpecError, match="SF204"):
            symflex.loads(text(spec))
