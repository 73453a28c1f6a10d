"""The walks of docs/architecture.md pass the files they list, in that order."""

import re
import sys

import pytest

import symflex
from symflex.quantities.grammar import evaluate
from tests.house.repository import ROOT, blocks

PAGE = ROOT / "docs" / "architecture.md"
BEAM = ROOT / "derivations" / "eppinger1988" / "sliding_free_beam.toml"


def walk(heading):
    """Return the files that the table under a heading lists."""
    _, _, after = PAGE.read_text(encoding="utf-8").partition(f"### {heading}")
    found = re.findall(r"^\| `([\w/]+)` \|", after.partition("\n###")[0], re.MULTILINE)
    assert found
    return [f"{name}.py" for name in found]


def passed(run):
    """Return the files of the package in the order in which a run first calls a function of each."""
    run()  # what is imported or remembered once is no part of a walk
    evaluate.cache_clear()  # but quantities are, which are remembered by their texts
    found, seen = {}, set()

    def note(frame, event, _):
        if event != "call" or frame.f_code in seen:
            return
        seen.add(frame.f_code)
        folder, inside, file = frame.f_code.co_filename.partition(f"{ROOT / 'symflex'}/")
        if inside and not folder and frame.f_code.co_name != "<module>":
            found.setdefault(file, len(found))

    sys.setprofile(note)
    try:
        run()
    finally:
        sys.setprofile(None)
    return found


def spring(folder):
    (text,) = (b.text for b in blocks(PAGE) if b.language == "toml" and "wall" in b.text)
    (folder / "spring.toml").write_text(f"symflex = 1\n{text}", encoding="utf-8")
    (tf,) = symflex.load(folder / "spring.toml").transfer_functions()
    assert r"\frac{1}{m s^{2} + k}" in tf.latex()


def beam(_):
    assert "V_tip_over_F" in symflex.load(BEAM).export_numpy()


def pole(_):
    assert symflex.load(BEAM).transfer_functions()[0].bind().poles()


WALKS = {"`k` of a spring": spring, "A beam": beam, "A pole": pole}


@pytest.mark.slow
@pytest.mark.parametrize("heading", WALKS)
def test_a_walk_passes_the_files_it_lists_in_order(heading, tmp_path):
    order = passed(lambda: WALKS[heading](tmp_path))
    listed = walk(heading)
    assert not [file for file in listed if file not in order]
    assert listed == sorted(listed, key=order.__getitem__)
