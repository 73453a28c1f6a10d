"""What cancels is hidden, counted and judged, wherever it stands and however it is written."""

from itertools import islice

import pytest
import sympy as sp

from tests.independent.hidden_places import PLACES
from tests.independent.hidden_products import (
    COMMANDS,
    DYNAMICS,
    SPELLINGS,
    WRONG,
    Case,
    cases,
    examined,
    truth,
)

TENTH, BATCH = 10, 2  # every tenth case, two at a time
REFUSED = {  # what may be refused, and where
    "SF202": "parameter as a formula",  # of names of constants
    "SF222": "potential energy",
    "SF801": "letters",  # with delays and waves
    "SF803": "one of two equations gain",  # K stands in both, so it is squared in a loop with a root of s
    "SF910": "root",  # roots of s, and delays in the equation of a field
}
LUMPED = [case for case in cases() if case.place.rows is not None]
WAVES = [  # a third, without roots of s, beside which waves have false poles where a stiffness vanishes
    case
    for i, case in enumerate(cases())
    if case.place.rows is None and not i % 3 and "root" not in case.dynamics.name
]


def _commands(number: int, case: Case, *, has_all: bool) -> list[str]:
    """Return roots and another command, which takes turns; stable gains with a root of s take seconds."""
    rest = [each for each in COMMANDS[1:] if has_all or "root" not in case.dynamics.name or each != "gain"]
    return [COMMANDS[0], rest[number % len(rest)]]


def _faults(given: list[tuple[Case, list[str]]]) -> list[str]:
    faults = []
    for case, commands in given:
        for command, said in examined(case, commands).items():
            code = said.split()[1] if said.startswith("refused") else ""
            where = f"{case.place.name} {command} {case.dynamics.name}"
            inside = case.place.rows is None and case.dynamics.kernel is not None
            if WRONG in said or (code and REFUSED.get(code, "nowhere") not in where and not inside):
                faults.append(f"{case}: {command}: {said}")
    return faults


def test_there_are_at_least_600_cases():
    assert len(LUMPED) + len(WAVES) > 600


def test_each_dynamics_meets_each_place_and_each_spelling():
    assert {(case.dynamics.name, case.place.name) for case in cases()} == {
        (dynamics.name, place.name) for dynamics in DYNAMICS for place in PLACES
    }
    assert {(case.dynamics.name, case.spelling) for case in cases()} == {
        (dynamics.name, spelling) for dynamics in DYNAMICS for spelling in SPELLINGS
    }


def test_a_twin_of_a_spring_has_the_poles_of_its_equations():
    # s^2 + 3 s + 2 + 1/(s + 2), times s + 2; the pole 1 is that of z' = z + u
    place = next(place for place in PLACES if place.name == "spring k")
    true = truth(place, "blocks", DYNAMICS[0])
    s = sp.Symbol("s")
    assert true.visible.monic().as_expr() == sp.expand((s**2 + 3 * s + 2) * (s + 2) + 1)
    assert true.hidden.monic().as_expr() == s - 1


@pytest.mark.parametrize("start", range(0, len(LUMPED), TENTH * BATCH))
def test_a_pole_that_cancels_is_hidden_and_judged(start: int):
    numbers = islice(range(start, len(LUMPED), TENTH), BATCH)
    assert not _faults([(LUMPED[i], _commands(i // TENTH, LUMPED[i], has_all=False)) for i in numbers])


@pytest.mark.slow
@pytest.mark.parametrize("place", [place.name for place in PLACES if place.rows is not None])
def test_every_pole_that_cancels_is_hidden_and_judged(place: str):
    own = [(i, case) for i, case in enumerate(LUMPED) if case.place.name == place]
    assert not _faults([(case, _commands(i, case, has_all=True)) for i, case in own])


@pytest.mark.slow
@pytest.mark.parametrize("place", [place.name for place in PLACES if place.rows is None])
def test_a_pole_that_cancels_beside_waves_is_hidden_and_judged(place: str):
    own = [(i, case) for i, case in enumerate(WAVES) if case.place.name == place]
    assert not _faults([(case, _commands(i, case, has_all=True)) for i, case in own])
