from symflex.library.blocks import BLOCKS
from symflex.library.elements import ELEMENTS

ENTRIES = [*ELEMENTS, *BLOCKS, "model"]


def test_the_list_names_every_element_and_block(shell):
    listed = {
        line.split("(")[0].strip() for line in shell("elements").out.splitlines() if line[2:3].isalpha()
    }
    assert set(ENTRIES) <= listed


def test_every_entry_is_described_with_all_its_keys(shell):
    for name in ENTRIES:
        done = shell("elements", name)
        assert done.code == 0, name
        keys = " ".join(done.out.split(")")[0].split("(")[1].split()).split(", ")
        lines = done.out.splitlines()
        assert all(any(line.startswith(f"  {key} ") for line in lines) for key in keys), name


def test_json_lists_the_library_with_the_documented_keys(shell):
    document = shell("elements", "--json").json
    assert document["schema"] == "symflex.elements/1"
    assert [e["type"] for e in document["elements"]] == list(ELEMENTS)
    assert [b["type"] for b in document["blocks"]] == list(BLOCKS)
    one = shell("elements", "dc_motor", "--json").json
    (motor,) = one["elements"]
    assert one["blocks"] == []
    assert set(motor) == {"type", "summary", "ports", "parameters", "choices", "through"}
    assert set(motor["ports"][0]) == {"name", "nodes", "domain", "doc", "default", "pair"}
    assert set(motor["parameters"][0]) == {"name", "unit", "doc", "default", "only"}


def test_an_unknown_entry_is_a_usage_error_with_a_hint(shell):
    done = shell("elements", "sprnig")
    assert (done.code, done.out) == (2, "")
    assert "did you mean 'spring'?" in done.err
