"""What is read of the law of an environment, and the specification with it."""

import pytest

from symflex import loads
from symflex.contact.law import read_environment, share_name, with_environment
from symflex.errors import SpecError, UsageError
from symflex.model import load_with
from symflex.model.ports import port_named

MACHINE = """
symflex = 1
parameters = { m = "1 kg", J = "1 kg*m^2", k_e = "1 N/m" }
elements = { body = { type = "rigid_body", at = "tip", m = "m", J = "J" } }
inputs = { F = { force = "tip.y" } }
outputs = { Y = "k_e*tip.y" }
"""


def elements_of(text: str, port: str = "tip.y") -> list[tuple[str, str, str]]:
    """Return type, parameter and value of each element."""
    model = loads(MACHINE).resolved
    return list(read_environment(model, port_named(model, port), text).elements)


@pytest.mark.parametrize(
    ("text", "elements"),
    [
        ("k_w + b_w*s", [("spring", "k", "k_w"), ("damper", "b", "b_w")]),
        ("s*(-b_w) + s^2*m/2", [("damper", "b", "-b_w"), ("mass", "m", "m/2")]),
        ("s", [("damper", "b", "1")]),
        ("k_w/(1 + s*T)", [("spring", "k", "k_w/(1 + s*T)")]),
        ("k_w*s^3", [("spring", "k", "k_w*s^3")]),
        ("2 kN/m", [("spring", "k", "2 kN/m")]),
        ("mass", [("mass", "m", "m_e")]),
        ("spring", [("spring", "k", "k_e_2")]),
    ],
)
def test_a_law_becomes_elements_by_powers_of_s(text: str, elements: list[tuple[str, str, str]]) -> None:
    assert elements_of(text) == elements


def test_a_part_of_a_planar_node_is_turned() -> None:
    assert elements_of("k_w + J_w*s^2", "tip.theta") == [
        ("torsion_spring", "k", "k_w"),
        ("inertia", "J", "J_w"),
    ]


def test_names_of_the_machine_stay_its_own_and_others_get_units() -> None:
    model = loads(MACHINE).resolved
    environment = read_environment(model, port_named(model, "tip"), "k_e + b_w*s")
    assert environment.letters == ("b_w",)
    source = loads(MACHINE)._source
    units = {p.name: p.unit for p in load_with(with_environment(source, model, environment), {}).parameters}
    assert units["b_w"] == "N*s/m"
    assert units["k_e"] == "N/m"


def test_a_letter_of_any_value_is_made_of_its_share() -> None:
    model = loads(MACHINE).resolved
    environment = read_environment(model, port_named(model, "tip"), "b_w*s")
    text = with_environment(loads(MACHINE)._source, model, environment, {"b_w": "10 N*s/m"})
    names = {p.name for p in load_with(text, {}).parameters}
    assert share_name("b_w") in names and "b_w" not in names


def test_a_mistake_is_shown_in_the_option() -> None:
    with pytest.raises(SpecError, match=r"--environment:1:5"):
        elements_of("k_w +")


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("Any", "any"),
        ("any ", "any"),
        ("passive", "any"),
        ("Wall", "wall"),
        ("dashpot", "damper"),
        ("spring_damper", "spring-damper"),
        ("SPRING DAMPER", "spring-damper"),
    ],
)
def test_a_class_that_is_written_differently_is_no_letter(text: str, meant: str) -> None:
    with pytest.raises(UsageError, match=f"did you mean '{meant}'"):
        elements_of(text)


def test_a_parameter_may_have_such_a_name() -> None:
    model = loads(MACHINE.replace("k_e", "Wall")).resolved
    assert read_environment(model, port_named(model, "tip.y"), "Wall").elements == (("spring", "k", "Wall"),)


def test_a_lone_letter_is_said_to_be_a_spring() -> None:
    model = loads(MACHINE).resolved
    lone = [
        read_environment(model, port_named(model, "tip.y"), x).lone for x in ("k_w", "k_e", "spring", "k_w*s")
    ]
    assert lone == ["spring", None, None, None]
