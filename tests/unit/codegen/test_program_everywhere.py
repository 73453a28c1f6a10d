"""Programs whose pieces are all evaluated everywhere: cases, places, and lumped functions as pieces."""

from itertools import product

import numpy as np
import pytest

from symflex import pipeline
from symflex.codegen.program.build import build_program
from symflex.codegen.program.evaluate import evaluate, numbers_of_pieces, value_of_piece
from symflex.codegen.program.verify import doubles
from symflex.codegen.python.pieces import cases_of, in_pieces, places_of
from tests.unit.codegen.exportable import DELAY, free_chain, program_of
from tests.unit.codegen.test_numpy_distributed import functions_of, specification

TEXTS = [*map(specification, ("sliding_free", "rod_tip_mass", "two_beams", "tension")), DELAY]


@pytest.fixture(scope="module")
def programs():
    """Return programs of distributed functions, and the values of their parameters."""
    return [(program_of(tf), doubles(pipeline.bind(tf))) for text in TEXTS for tf in functions_of(text)]


def test_for_every_result_of_tests_one_piece_serves_the_right_one(programs):
    for program, _ in programs:
        cases = cases_of(program)
        for results in product((False, True), repeat=len(program.conditions)):
            serving = [
                k
                for k, alternatives in enumerate(cases)
                if any(all(results[test] is wanted for test, wanted in case) for case in alternatives)
            ]
            assert serving == [program.pieces[sum(2**i for i, r in enumerate(results) if r)]]


def test_a_piece_is_regular_at_its_place_whatever_the_parameters(programs):
    random = np.random.default_rng(1)
    for program, values in programs:
        for piece, place in zip(program.code, places_of(program, values), strict=True):
            for _ in range(8):
                given = {n: v * 10 ** random.uniform(-1, 1) for n, v in values.items()}
                with np.errstate(all="ignore"):
                    assert np.isfinite(value_of_piece(piece, np.complex128(place), given))


def test_a_place_lies_where_its_piece_serves(programs):
    # A piece of two beams may serve at none of the points that are tried.
    for program, values in (*programs[:3], programs[-1]):
        for k, place in enumerate(places_of(program, values)):
            number = int(numbers_of_pieces(program, np.complex128(place), values))
            assert program.pieces[number] == k


def test_a_lumped_function_with_a_far_branch_is_two_pieces():
    (tf,) = pipeline.derive_all(pipeline.loads(free_chain(8)))
    program = build_program(tf)
    assert program.far is not None
    pieces = in_pieces(program)
    assert len(pieces.code) == 2
    s, values = 1j * np.logspace(-6, 13, 60), {"m": 2.0, "k": 3000.0}
    assert evaluate(pieces, s, values).tolist() == evaluate(program, s, values).tolist()
