"""Poles, zeros and their certificate."""

from __future__ import annotations

import json
from fractions import Fraction

from symflex.roots import (
    ROOT_FINDERS,
    Band,
    Modes,
    PolynomialInS,
    Rectangle,
    RootProblem,
    find_pole_zero_map,
)
from tests.unit.roots.polynomials import problem, with_root_of_two

POLES = problem(0, 0, 9, 0, 1)  # s^2 (s^2 + 9)
ZEROS = problem(4, 0, 1)


def test_json_has_the_keys_of_the_schema():
    data = find_pole_zero_map("x_tip/F", POLES, ZEROS).to_json_dict()
    assert {"schema", "tf", "region", "certified", "poles", "zeros", "hidden"} <= set(data)
    assert (data["schema"], data["tf"], data["certified"]) == ("symflex.roots/1", "x_tip/F", True)


def test_json_of_a_root_has_the_keys_of_the_schema():
    (root, *_) = find_pole_zero_map("x/F", POLES, ZEROS).to_json_dict()["zeros"]
    keys = {"re", "im", "radius", "multiplicity", "frequency_hz", "damping_ratio"}
    assert keys <= set(root)
    assert [type(root[key]) for key in ("re", "im", "radius")] == [str, str, str]


def test_json_survives_a_round_trip():
    data = find_pole_zero_map("x/F", POLES, ZEROS, Band(Fraction(0), Fraction(1))).to_json_dict()
    assert json.loads(json.dumps(data, allow_nan=False)) == data


def test_both_members_of_a_pair_are_listed():
    poles = find_pole_zero_map("x/F", POLES, ZEROS, digits=5).to_json_dict()["poles"]
    assert [(p["im"], p["multiplicity"]) for p in poles] == [("0", 2), ("3.0000", 1), ("-3.0000", 1)]


def test_the_rigid_body_has_no_damping_ratio():
    poles = find_pole_zero_map("x/F", POLES, ZEROS).to_json_dict()["poles"]
    assert [p["damping_ratio"] for p in poles] == [None, 0.0, 0.0]


def test_regions_are_named_in_the_json():
    unit = [Fraction(x) for x in (-1, 0, -5, 5)]
    regions = [None, Band(Fraction(1), Fraction(2)), Rectangle(*unit), Modes(3)]
    kinds = [find_pole_zero_map("x/F", POLES, ZEROS, r).to_json_dict()["region"]["kind"] for r in regions]
    assert kinds == ["everything", "band", "rectangle", "modes"]


def test_the_certificate_counts_every_degree():
    certificate = find_pole_zero_map("x/F", POLES, ZEROS, Modes(0)).certificate
    assert (certificate.certified, certificate.counted, certificate.found) == (True, 6, 6)


def test_hidden_modes_are_reported_with_their_cause():
    hidden = ((problem(25, 0, 1), "unobservable"),)
    found = find_pole_zero_map("x/F", POLES, ZEROS, Modes(1), 3, hidden)
    assert [(h.root.decimal(3).im, h.cause) for h in found.hidden] == [
        ("5.00", "unobservable"),
        ("-5.00", "unobservable"),
    ]
    assert found.certificate.counted == 8


def test_hidden_modes_outside_a_band_are_left_out():
    hidden = ((problem(25, 0, 1), "cancelled"),)
    assert find_pole_zero_map("x/F", POLES, ZEROS, Band(Fraction(2), Fraction(9)), 3, hidden).hidden == ()


def test_a_cluster_makes_the_map_uncertified_and_says_why():
    double = with_root_of_two(lambda root, one: (2 * one, -2 * root, one))
    certificate = find_pole_zero_map("x/F", RootProblem(((double, 1),)), ZEROS).certificate
    assert (certificate.certified, certificate.counted, certificate.found) == (False, 4, 4)
    assert "told apart" in certificate.reason


def test_the_engine_is_named():
    finder = ROOT_FINDERS["laguerre"]
    assert find_pole_zero_map("x/F", POLES, ZEROS, finder=finder).certificate.engine == "laguerre"


def test_a_numerator_without_s_has_no_zeros():
    assert find_pole_zero_map("x/F", POLES, RootProblem(((PolynomialInS.from_integers([7]), 1),))).zeros == ()
