"""Engineers' words, and what they lead to."""

from symflex.library.blocks import BLOCKS
from symflex.library.elements import ELEMENTS
from symflex.library.words import THINGS, hint_of_type


def test_engineers_words_lead_to_elements_and_blocks_that_exist():
    for each in THINGS:
        sections = {"[fields]", "[inputs]", "[signals]", ""}
        assert set(each.use.split(", ")) <= {*ELEMENTS, *BLOCKS, *sections}, each
        assert each.use or each.how, each
    words = [word for each in THINGS for word in each.words]
    assert len(words) == len(set(words))
    for word, hint in (
        ("voice coil actuator", "did you mean 'voice_coil'?"),
        ("rack", "for rack write transformer"),
        ("displacement", "for displacement write [inputs]"),
        ("Op-Amp", "for Op-Amp write op_amp"),
        ("sprnig", "did you mean 'spring'?"),
        ("pid", "'pid' is a block"),
        ("tortion_spring", "did you mean 'torsion_spring'?"),
        ("coil_spring", "did you mean 'spring'?"),
        ("acme screw", "for screw write transformer"),
        ("relay", "there is no relay: it is not linear"),
    ):
        found = hint_of_type(word, ELEMENTS, BLOCKS, "a block")
        assert found.startswith(hint), word
