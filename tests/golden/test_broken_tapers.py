"""Mistakes where coefficients vary along x: each is refused at its place, which «» mark, in a sentence."""

import re

import pytest

from symflex.cli import run

HEAD = """symflex = 1
[parameters]
E = "200 GPa"
G = "77 GPa"
rho = "7800 kg/m^3"
A_0 = "16 cm^2"
I_0 = "21.3 cm^4"
N_0 = "2 kN"
l = "1 m"
a = "0.7 1/m"
c = 0.5
"""
FORCE = """
[inputs]
F = { unit = "N" }
"""
TAPER = "(E*I_0*(1 - c*x/l)*w'')''"
MASS = "rho*A_0*s^2*w = 0"
CLAMPED = '"w(0) = 0", "w\'(0) = 0"'
FREE = "\"w''(l) = 0\", \"E*I_0*w'''(l) = -F\""
MOVED = '"w(0) = F*l/N_0", "w\'(0) = 0"'


def field(equation, conditions=f"{CLAMPED}, {FREE}", domain='"0", "l"', output="w(l)", more=""):
    return (
        f'{HEAD}{more}[fields.w]\ndomain = [{domain}]\nequation = "{equation}"\n'
        f'conditions = [{conditions}]\n{FORCE}[outputs]\ny = "{output}"\n'
    )


def tapered(**given):
    return field(f"{TAPER} + {MASS}", **given)


def stiffened(stiffness):
    return field(f"«(E*I_0*{stiffness}*w'')'' + {MASS}»")


def member(values, kind="beam", nodes='"ground", "tip"', force='force = "tip"', output="tip", more=""):
    return (
        f'{HEAD}[elements]\n«arm» = {{ type = "{kind}", between = [{nodes}], '
        f'rho = "rho", l = "l", {values} }}\n{more}\n[inputs]\nF = {{ {force} }}\n[outputs]\ny = "{output}"\n'
    )


def arm(values, **given):
    """Return a beam of which the values are marked."""
    return member(f'E = "E", {values}', **given).replace("«arm»", "arm")


NO_X = "unknown name 'x'"
BROKEN = {
    # What vanishes, or is not analytic, at the values given.
    "stiffness_vanishes_inside": (stiffened("(1 - 2*x/l)^2"), "SF250", "'w' is not analytic near x = 0.5 m"),
    "leading_coefficient_vanishes": (
        field(f"«E*I_0*(1 - 2*x/l)*w'''' + {MASS}»"),
        "SF250",
        "a coefficient of 'w' is not analytic near x = 0.5 m",
    ),
    "pole_inside": (
        field("«E*I_0*w'''' + rho*A_0/(1 - 4*x/l)*s^2*w = 0»"),
        "SF250",
        "a coefficient of 'w' is not analytic near x = 0.25 m",
    ),
    "branch_point_inside": (stiffened("sqrt(1 - 1.6*x/l)"), "SF250", "not analytic near x = 0.625 m"),
    "root_of_negative_numbers": (stiffened("sqrt(-1 - x/l)"), "SF250", "not analytic near x = 0 m"),
    "logarithm_of_zero": (stiffened("log(x/l)"), "SF250", "not analytic near x = 0 m"),
    "tangent_beyond_its_pole": (stiffened("tan(2*x/l + 1)"), "SF250", "not analytic near x = 0.285398 m"),
    "exponential_overflows": (stiffened("exp(1e11*x/l)"), "SF250", "a coefficient of 'w' is too steep near"),
    "singular_by_its_value": (stiffened("(1 - 4*c*x/l)"), "SF250", "not analytic near x = 0.5 m"),
    "system_singular_inside": (
        f'{HEAD}[fields.f]\nunknowns = ["w", "v"]\ndomain = ["0", "l"]\n'
        'equations = ["«w\' = x/l*v»", "(1 - 2*x/l)*v\' = -c*a^2*s^2*w/(1 + x/l)"]\n'
        f'conditions = ["w(0) = 0", "v(l) = F/N_0"]\n{FORCE}[outputs]\ny = "w(l)"\n',
        "SF250",
        "a coefficient of 'f' is not analytic near x = 0.5 m",
    ),
    "section_with_a_pole": (
        member('E = "E", I = "I_0", A = "A_0/(1 - 4*x/l)^2"'),
        "SF250",
        "a coefficient of 'arm' is not analytic near x = 0.25 m",
    ),
    "section_with_a_branch_point_at_its_end": (
        member('E = "E", I = "I_0*sqrt(1 - x/l)", A = "A_0"'),
        "SF250",
        "a coefficient of 'arm' is not analytic near x = 1 m",
    ),
    "section_with_a_pole_at_its_end": (
        member('E = "E", I = "I_0", A = "A_0/(1 - x/l)"'),
        "SF250",
        "a stiffness of 'arm' vanishes at x = l: inertia does not vanish with the stiffness",
    ),
    "tip_that_is_loaded": (
        member('E = "E", I = "I_0*(1 - x/l)^3", A = "A_0*(1 - x/l)"'),
        "SF250",
        "a stiffness of beam 'arm' vanishes at its end 'tip', which can be neither held nor loaded",
    ),
    "tip_that_is_irregular": (
        field("«(E*I_0*(1 - x/l)^7*w'')'' + rho*A_0*(1 - x/l)*s^2*w = 0»", MOVED),
        "SF250",
        "a stiffness of 'w' vanishes at x = l: this is an irregular singular point",
    ),
    "tip_with_a_fractional_power": (
        member('E = "E", I = "I_0*(1 - x/l)*sqrt(1 - x/l)", A = "A_0"'),
        "SF250",
        "a stiffness of 'arm' vanishes at x = l: a function of x also vanishes there",
    ),
    "tip_with_a_sine": (
        stiffened("x/l*sin(a*x)"),
        "SF250",
        "a stiffness of 'w' vanishes at x = 0: a function of x also vanishes there",
    ),
    "tips_at_both_ends": (stiffened("x/l*(1 - x/l)"), "SF910", "stiffnesses vanish at both ends of 'w'"),
    "stiffness_zero_everywhere": (
        field(f"(E*I_0*(x/l - x/l)*w'')'' + {MASS}").replace("[fields.w]", "[fields.«w»]"),
        "SF305",
        "the equations of field 'w' do not determine the highest derivatives of w",
    ),
    # Signs at the values given.
    "section_negative_at_its_end": (
        arm('I = "«I_0*(1 - 2*x/l)^3»", A = "A_0"'),
        "SF209",
        "I of beam 'arm' at x = l is negative (-2.13e-07); a second moment of area must be positive",
    ),
    "section_negative_between_its_ends": (
        arm('I = "I_0", A = "«A_0*(1 - 5*x/l*(1 - x/l))»"'),
        "SF209",
        "A of beam 'arm' at x = 0.28125 m is negative (-1.71875e-05); a cross-sectional area cannot be",
    ),
    "section_zero_between_its_ends": (
        arm('I = "«I_0*(1 - 2*x/l)^2»", A = "A_0"'),
        "SF209",
        "I of beam 'arm' at x = 0.5 m is 0; a second moment of area must be positive",
    ),
    "section_that_is_nothing": (
        arm('I = "«I_0*(x/l - x/l)»", A = "A_0"'),
        "SF209",
        "I of beam 'arm' is 0; a second moment of area must be positive",
    ),
    "tension_that_turns_negative": (
        arm('N = "«N_0*cos(2*x/l)»", A = "A_0"', kind="string").replace('E = "E", ', ""),
        "SF209",
        "N of string 'arm' at x = l is negative (-832.294); a tension must be positive",
    ),
    # x where it means nothing.
    "x_in_a_domain": (tapered(domain='"0", "«x»"'), "SF210", NO_X),
    "x_in_a_point": (tapered(conditions=f'"w(«x») = 0", "w\'(0) = 0", {FREE}'), "SF210", NO_X),
    "x_in_front_of_a_condition": (tapered(conditions=f'"w(0) = 0", "«x»*w\'(0) = 0", {FREE}'), "SF210", NO_X),
    "x_in_an_output": (tapered(output="w(«x»)"), "SF210", NO_X),
    "x_beside_an_output": (tapered(output="«x»*w(l)"), "SF210", NO_X),
    "x_in_a_definition": (tapered(more='[definitions]\nI_1 = "I_0*(1 - c*«x»/l)"\n'), "SF210", NO_X),
    "x_in_a_parameter": (
        tapered(more='I_1 = "1 - «x»"\n'),
        "SF202",
        "unexpected 'x' in the quantity '1 - x'",
    ),
    "x_in_a_block": (
        tapered(more='[blocks]\nK = { type = "tf", num = "«x»", den = "1 + s" }\n'),
        "SF210",
        NO_X,
    ),
    "x_in_a_signal": (tapered(more='[signals]\nu = "«x»*F"\n'), "SF210", NO_X),
    "x_in_a_spring": (
        arm(
            'I = "I_0", A = "A_0"', more='k = { type = "spring", between = ["tip", "ground"], k = "N_0/«x»" }'
        ),
        "SF210",
        NO_X,
    ),
    "x_in_a_modulus": (
        arm('I = "I_0", A = "A_0"').replace('E = "E",', 'E = "E*(1 - c*«x»/l)",'),
        "SF210",
        NO_X,
    ),
    "a_quantity_in_a_formula": (
        arm('I = "4e-8 m^4*(1 «-» c*x/l)^3", A = "A_0"'),
        "SF202",
        "unexpected '-' in the quantity",
    ),
    "x_in_a_loss": (arm('I = "I_0", A = "A_0", eta = "0.1*«x»/l"'), "SF210", NO_X),
    "x_in_a_shear_coefficient": (
        arm('I = "I_0", A = "A_0", theory = "timoshenko", G = "G", kappa = "0.85*(1 - c*«x»/l)"'),
        "SF210",
        NO_X,
    ),
    "x_in_a_point_of_a_member": (arm('I = "I_0*(1 - c*x/l)", A = "A_0"', output="arm.y(«x»)"), "SF210", NO_X),
    "x_in_a_printed_formula": (
        tapered() + '[published."y/F"]\nexpr = "«x»/N_0"\nsource = "nobody"\n',
        "SF210",
        "unknown name 'x' in a printed formula",
    ),
    "load_of_x_alone": (
        field(f"{TAPER} + rho*A_0*s^2*w = «a*x»"),
        "SF221",
        "this term is constant and the others vary in time",
    ),
    "a_member_of_a_frame_tapers": (
        member(
            'E = "E", I = "I_0*(1 - c*x/l)", A = "A_0"', kind="frame", force='force = "tip.y"', output="tip.y"
        ),
        "SF910",
        "a frame member that varies along x ('arm') is not available yet",
    ),
    # Units.
    "x_added_to_a_number": (
        arm('I = "«I_0*(1 - x)»", A = "A_0"'),
        "SF203",
        "I of beam 'arm' is in 'm^5'; a second moment of area is in 'm^4'",
    ),
    "x_added_to_a_mass": (
        field("E*I_0*w'''' + (rho*A_0 + «x»)*s^2*w = 0"),
        "SF205",
        "terms of a sum disagree: rho*A_0 in 'kg/m' and x in 'm'",
    ),
    "exponential_of_a_length": (
        field(f"(E*I_0*exp(«x»)*w'')'' + {MASS}"),
        "SF203",
        "the argument of exp is in 'm'; it must be a pure number",
    ),
    # Not linear, or no coefficient.
    "unknown_times_itself": (field(f"(«E*I_0*w*w''»)'' + {MASS}"), "SF222", "is not linear"),
    "function_of_the_unknown": (field(f"{TAPER} + rho*A_0*s^2*«exp(w)» = 0"), "SF222", "is not linear"),
    "power_of_a_name": (
        field(f"(E*I_0*(1 + x/l)^«c»*w'')'' + {MASS}"),
        "SF225",
        "an exponent must be an integer number",
    ),
    "function_of_s_and_x": (
        field(f"(E*I_0*«exp(a*s*x)»*w'')'' + {MASS}"),
        "SF910",
        "exp of an expression in s is not available yet",
    ),
    # Primes.
    "primes_on_a_parameter": (
        field(f"E*«I_0'»*w'''' + {MASS}"),
        "SF210",
        "'I_0' is not an unknown of this field",
    ),
    "primes_on_a_function": (field(f"sin(x/l)«'»*w'''' + {MASS}"), "SF111", "unexpected \"'\" after ')'"),
    "primes_beyond_the_highest_order": (
        field(f"«(E*I_0*w)'''''''''''''' + {MASS}»"),
        "SF103",
        "field 'w' is of order 14 in x; at most 12 is allowed",
    ),
    "primes_without_a_point": (
        tapered(conditions=f"{CLAMPED}, \"w''(l) = 0\", \"«(E*I_0*(1 - c*x/l)*w'')'» = -F\""),
        "SF241",
        "a bracket with primes varies along x; only its value at a point is allowed here",
    ),
    "primes_beyond_the_domain": (
        tapered(conditions=f"{CLAMPED}, \"w''(l) = 0\", \"(E*I_0*w'')'(«2*l») = -F\""),
        "SF240",
        "the point '2*l' (2) lies beyond the end of the domain of field 'w', 'l' (1)",
    ),
    "primes_in_a_section": (
        arm('I = "«(I_0*(1 - c*x/l))\'»", A = "A_0"'),
        "SF223",
        "a derivative of a bracket along x belongs in the equations and conditions of [fields]",
    ),
}


@pytest.mark.slow
def test_a_broken_taper_is_refused_at_its_place_in_a_sentence(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name, (marked, code, sentence) in BROKEN.items():
        before, _, after = marked.partition("«")
        line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
        marked_text = after.partition("»")[0]
        (tmp_path / "taper.toml").write_text(re.sub("[«»]", "", marked), encoding="utf-8")
        assert run(["check", "taper.toml"]) == 3, name
        printed = capsys.readouterr().err
        headline, source, carets, *_ = printed.splitlines()
        assert headline.startswith(f"taper.toml:{line}:{column}: error[{code}]: "), name
        assert sentence in headline, name
        assert carets.count("^") == len(marked_text), name
        assert marked_text in source, name
        assert printed.count("error[") == 1, name
        assert ("declare it in [parameters]" in printed) is (name == "a_quantity_in_a_formula"), name
