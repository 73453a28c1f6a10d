"""The loops of derivations/eppinger1988/loops: what their README states."""

import re

import pytest

import symflex
from symflex.contact.over import passive_over
from symflex.contact.passivity import find_passivity
from symflex.loops.of_model import characteristic_loop
from symflex.options import PassivityOptions
from tests.house.repository import ROOT

FOLDER = ROOT / "derivations" / "eppinger1988" / "loops"
TABLES = [
    [cell.strip() for cell in line.strip("|").split("|")]
    for line in (FOLDER / "README.md").read_text("utf-8").splitlines()
    if line.startswith("| `")
]
ROWS, CONTACTS, HELD = ([row for row in TABLES if len(row) == columns] for columns in (5, 3, 2))
NUMBER = re.compile(r"\d+\.\d+")


def test_the_table_has_every_model():
    stems = {path.stem.rsplit("_", 1)[0] for path in FOLDER.glob("*.toml")}
    assert {row[0].strip("`") for row in ROWS} == stems


def check_row(row):
    name = row[0].strip("`")
    position = symflex.load(FOLDER / f"{name}_position.toml").stability("K")
    force = symflex.load(FOLDER / f"{name}_force.toml").stability("K")
    assert position.certified, name
    assert force.certified, name
    # Colocated, no gain that was examined is too large.
    assert position.boundaries == ()
    assert position.is_stable
    gains, frequencies = ([float(x) for x in NUMBER.findall(cell)] for cell in row[2:4])
    assert len(gains) == len(force.boundaries)
    for boundary, gain, frequency in zip(force.boundaries, gains, frequencies, strict=True):
        assert abs(float(boundary.gain) / gain - 1) < 1e-4, name
        assert abs(boundary.frequencies_hz[0] / frequency - 1) < 1e-4, name
    bandwidth = [float(x) for x in NUMBER.findall(row[4])]
    assert force.bandwidth_hz == (pytest.approx(bandwidth[0], rel=1e-4) if bandwidth else float("inf"))
    assert position.bandwidth_hz == (pytest.approx(6.591, rel=1e-3) if "range" in row[1] else float("inf"))
    return position.proved.method, force.proved.method


def test_every_gain_and_frequency_of_the_table_of_lumped_models():
    lumped = [row for row in ROWS if "sliding_free_beam" not in row[0]]
    assert {check_row(row) for row in lumped} == {("polynomials", "polynomials")}


def test_the_stiffnesses_of_a_contact_at_which_lumped_force_loops_lose_stability():
    lumped = [row for row in CONTACTS if "sliding_free_beam" not in row[0]]
    assert len(lumped) == len(ROWS) - 1
    for name, stable, _ in lumped:
        found = symflex.load(FOLDER / f"{name.strip('`')}_force.toml").stability("k_c", limits=(0, "inf"))
        stated = [1e3 * float(x) for x in NUMBER.findall(stable)]
        assert [float(b.gain) for b in found.boundaries] == pytest.approx(stated, rel=1e-4), name
        assert found.certified, name


@pytest.mark.parametrize("row", HELD[:-1], ids=lambda row: row[0])
def test_the_gain_up_to_which_anything_passive_may_hold_the_tip(row):
    # 3.50213, 4.88568 and 3.87097 are also where a grid of Re Y of numpy's nodal equations turns negative.
    name, stated = row[0].strip("`"), [float(x) for x in NUMBER.findall(row[1])]
    found = passive_over(
        symflex.load(FOLDER / f"{name}_force.toml").resolved, PassivityOptions(("tip",), ("K",), (0, 100))
    )
    assert found.certified
    ends = [float(i.high.mid()) for i in found.passive]
    assert ends == pytest.approx(stated or [100], rel=1e-4)


@pytest.mark.slow
def test_the_beam_may_be_held_up_to_a_gain_of_0_93():
    for gain, is_passive in ((0.93, True), (0.94, False)):
        model = symflex.load(FOLDER / "sliding_free_beam_force.toml", {"K": gain}).resolved
        assert find_passivity(model, "tip", is_explained=False).passive is is_passive


@pytest.mark.slow
def test_every_gain_and_frequency_of_the_table_of_the_beam():
    (beam,) = [row for row in ROWS if "sliding_free_beam" in row[0]]
    # The beam loses energy in its material, so poles far out are proved in the left half-plane, and the
    # others are counted in half a disc: passivity need not be asked.
    assert check_row(beam) == ("argument principle", "argument principle")


@pytest.mark.slow
def test_the_beam_goes_to_its_zero_in_the_right_half_plane():
    from fractions import Fraction

    from symflex.loops import trace_locus

    model = symflex.load(FOLDER / "sliding_free_beam_force.toml").resolved
    locus = trace_locus(characteristic_loop(model, "K"), (Fraction(0), Fraction(10**5)), modes=2)
    assert locus.arrived
    (zero,) = [z for z in locus.end.zeros if 0 < float(z.re.mid()) < 100]
    target = float(zero.re.mid())
    assert zero.is_real
    assert min(abs(branch[-1] - target) for branch in locus.branches) < 0.02 * target
