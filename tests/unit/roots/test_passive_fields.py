"""Fields that are proved to be passive, and fields that only look as if they were."""

from __future__ import annotations

import pytest

from symflex import pipeline
from symflex.roots import Modes
from symflex.roots.passive_fields import are_passive

HEAD = """
symflex = 1
[parameters]
EI = "2 N*m^2"
T = "3 N"
rhoA = "1.5 kg/m"
J = "0.1 kg*m"
kGA = "50 N"
c = "0.2 N*s/m^2"
k = "7 N/m"
m = "0.4 kg"
eta = "0.01 s"
v = "0.3 m/s"
l = "1.2 m"
[inputs]
F = { unit = "N" }
"""
FIELD = """
[fields.w]
domain = ["0", "l"]
equation = "EQUATION"
conditions = CONDITIONS
[outputs]
y = "w(l)"
"""
BEAM = "EI*w'''' + rhoA*s^2*w = 0"
PULLED = "EI*w'''' - T*w'' + rhoA*s^2*w = 0"
STRING = "T*w'' = rhoA*s^2*w"
CLAMPED = ["w(0) = 0", "w'(0) = 0"]
FREE = [*CLAMPED, "w''(l) = 0", "EI*w'''(l) = -F"]
FIXED = ["w(0) = 0", "T*w'(l) = F"]


def model_of(equation, conditions):
    shown = "[" + ", ".join(f'"{each}"' for each in conditions) + "]"
    return pipeline.loads(HEAD + FIELD.replace("EQUATION", equation).replace("CONDITIONS", shown))


def known(model):
    return are_passive(model, ((p.name, p.value) for p in model.parameters))


PASSIVE = {
    "cantilever": (BEAM, FREE),
    "pinned at both ends": (BEAM, ["w(0) = 0", "w''(0) = 0", "w(l) = 0", "EI*w''(l) = F*l"]),
    "free at both ends": (BEAM, ["w''(0) = 0", "w'''(0) = 0", "w''(l) = 0", "EI*w'''(l) = -F"]),
    "a mass at the tip": (BEAM, [*FREE[:3], "EI*w'''(l) = m*s^2*w(l) - F"]),
    "a spring and a damper at the tip": (BEAM, [*FREE[:3], "EI*w'''(l) = (k + m*s^2 + c*l*s)*w(l) - F"]),
    "a spring that turns at the root": (BEAM, ["w(0) = 0", "EI*w''(0) = k*l^2*w'(0)", *FREE[2:]]),
    "with the loss of its material": (
        "EI*(1 + eta*s)*w'''' + rhoA*s^2*w = 0",
        [*FREE[:3], "w'''(l) = -F/EI"],
    ),
    "pulled, the end guided": (PULLED, [*CLAMPED, "w'(l) = 0", "EI*w'''(l) = -F"]),
    "pulled by its end": (PULLED, [*FREE[:3], "EI*w'''(l) - T*w'(l) = -F"]),
    "pulled along x": (
        "EI*w'''' - (T*(1 - x^2/l^2)*w')' + rhoA*s^2*w = 0",
        [*FREE[:3], "EI*w'''(l) = -F"],
    ),
    "with inertia of rotation": (
        "EI*w'''' - J*s^2*w'' + rhoA*s^2*w = 0",
        [*FREE[:3], "EI*w'''(l) - J*s^2*w'(l) = -F"],
    ),
    "on a foundation": ("EI*w'''' + (c*s + k/l + rhoA*s^2)*w = 0", FREE),
    "a taper": ("(EI*(1 - x/(2*l))^3*w'')'' + rhoA*(1 - x/(2*l))*s^2*w = 0", FREE),
    "a string": (STRING, FIXED),
    "a string with a mass": (STRING, ["w(0) = 0", "T*w'(l) = F - m*s^2*w(l)"]),
    "a force that comes late": (STRING, ["w(0) = 0", "(1 + eta*s)*T*w'(l) = F"]),
    "a string of growing mass": ("T*w'' = rhoA*exp(x/l)*s^2*w", FIXED),
}
NOT_PASSIVE = {
    "a negative mass at the tip": (BEAM, [*FREE[:3], "EI*w'''(l) = -m*s^2*w(l) - F"]),
    "a negative spring at the tip": (BEAM, [*FREE[:3], "EI*w'''(l) = -20*k*w(l) - F"]),
    "a negative damper at the tip": (BEAM, [*FREE[:3], "EI*w'''(l) = -c*l*s*w(l) - F"]),
    "a force that follows the slope": (PULLED, [*FREE[:3], "EI*w'''(l) = -F"]),
    "a force that follows the other end": (BEAM, ["w''(0) = 0", "EI*w'''(0) = k*w(l)", *FREE[2:]]),
    "a foundation that pushes": ("EI*w'''' - 30*k/l*w + rhoA*s^2*w = 0", FREE),
    "a foundation that feeds": ("EI*w'''' - c*s*w + rhoA*s^2*w = 0", FREE),
    "pushed": ("EI*w'''' + 4*T*w'' + rhoA*s^2*w = 0", [*FREE[:3], "EI*w'''(l) + 4*T*w'(l) = -F"]),
    "pushed somewhere": (
        "EI*w'''' - (T*(1 - 2*x/l)*w')' + rhoA*s^2*w = 0",
        [*FREE[:3], "EI*w'''(l) + T*w'(l) = -F"],
    ),
    "a string that moves along": ("T*w'' = rhoA*(s^2*w + 2*v*s*w' + v^2*w'')", FIXED),
    "a negative loss": ("EI*(1 - eta*s)*w'''' + rhoA*s^2*w = 0", [*FREE[:3], "w'''(l) = -F/EI"]),
    "a condition that an s in the right half plane meets": (
        STRING,
        ["w(0) = 0", "(s*l/v - 1)*T*w'(l) = F"],
    ),
    "not what a slope does": ("EI*w'''' - T*x/l*w'' + rhoA*s^2*w = 0", FREE),
}


@pytest.mark.parametrize("name", PASSIVE)
def test_energy_is_nowhere_supplied(name):
    assert known(model_of(*PASSIVE[name]))


@pytest.mark.parametrize("name", NOT_PASSIVE)
def test_what_may_supply_energy_is_not_said_to_be_passive(name):
    assert not known(model_of(*NOT_PASSIVE[name]))


@pytest.mark.parametrize(
    "name",
    ["a negative spring at the tip", "a foundation that pushes", "pushed", "a negative damper at the tip"],
)
def test_some_of_these_have_poles_in_the_right_half_plane(name):
    model = model_of(*NOT_PASSIVE[name])
    (bound,) = pipeline.derive_bound(model, model.transfer_functions)
    assert any(root.re > 0 for root in pipeline.roots(bound, Modes(3), 12).poles)


SHEARS = """
[fields.beam]
unknowns = ["w", "phi"]
domain = ["0", "l"]
equations = ["kGA*(w'' - phi') = rhoA*s^2*w", "EI*phi'' + kGA*(w' - SIGNphi) = J*s^2*phi"]
conditions = ["w(0) = 0", "phi(0) = 0", "phi'(l) = 0", "kGA*(w'(l) - phi(l)) = F"]
[outputs]
y = "w(l)"
"""


@pytest.mark.parametrize(("sign", "expected"), [("", True), ("-", False)])
def test_a_beam_that_shears_is_one_of_two_unknowns(sign, expected):
    assert known(pipeline.loads(HEAD + SHEARS.replace("SIGN", sign))) is expected


def test_all_poles_of_a_passive_field_are_said_to_be_on_the_axis_or_left_of_it():
    model = model_of(*PASSIVE["pulled by its end"])
    (bound,) = pipeline.derive_bound(model, model.transfer_functions)
    found = pipeline.roots(bound, Modes(2), 12)
    assert found.verdict.word == "marginal"


def test_nothing_is_known_beside_elements():
    model = pipeline.loads(
        HEAD
        + FIELD.replace("EQUATION", STRING).replace("CONDITIONS", '["w(0) = 0", "T*w\'(l) = F"]')
        + '[elements]\nbody = { type = "mass", at = "z", m = "m" }\n'
    )
    assert not known(model)


JOINED = """
[fields.a]
domain = ["0", "l"]
equation = "EI*a'''' + rhoA*s^2*a = 0"
conditions = ["a(0) = 0", "a'(0) = 0", "a(l) = b(l)", "a'(l) = b'(l)"]
[fields.b]
domain = ["l", "2*l"]
equation = "2*EI*b'''' + rhoA*s^2*b = 0"
conditions = [
  "a''(l) = 2*b''(l)", "EI*a'''(l) = 2*EI*b'''(l)SIGNm*s^2*a(l)", "b''(2*l) = 0", "2*EI*b'''(2*l) = -F"
]
[outputs]
y = "b(2*l)"
"""


@pytest.mark.parametrize(("sign", "expected"), [(" + ", True), (" - ", False)])
def test_two_fields_that_meet_at_a_mass(sign, expected):
    assert known(pipeline.loads(HEAD + JOINED.replace("SIGN", sign))) is expected


def test_an_s_behind_a_name_is_not_overlooked():
    text = HEAD + '[definitions]\nT_s = "T*(1 + eta*s)"\n'
    text += FIELD.replace("EQUATION", "T_s*w'' = rhoA*s^2*w")
    assert not known(pipeline.loads(text.replace("CONDITIONS", """["w(0) = 0", "T_s*w'(l) = F"]""")))
