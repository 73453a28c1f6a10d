"""Inputs, outputs and elements without effect are told; those with effect are not."""

from symflex import pipeline

CHAIN = """symflex = 1
[parameters]
m = "1 kg"
k = "2 N/m"
[elements]
a = {{ type = "mass", at = "x", m = "m" }}
b = {{ type = "mass", at = "y", m = "m" }}
wall = {{ type = "spring", between = ["x", "ground"], k = "k" }}
{elements}
[inputs]
{inputs}
[outputs]
{outputs}
"""
LINK = 'link = { type = "spring", between = ["x", "y"], k = "k" }'


def told(elements=LINK, inputs='F = { force = "x" }', outputs='X = "x"'):
    model = pipeline.loads(CHAIN.format(elements=elements, inputs=inputs, outputs=outputs))
    return [(w.code, w.span.text) for w in pipeline.warnings(model)]


def test_in_a_chain_everything_has_an_effect():
    assert told() == []


def test_an_input_on_a_part_that_no_output_sees_reaches_nothing():
    found = told(elements="", inputs='F = { force = "x" }\nG = { force = "y" }')
    assert found == [("SF654", "b"), ("SF652", "G")]


def test_an_output_on_a_part_that_no_input_drives_is_zero():
    assert told(elements="", outputs='X = "x"\nY = "y"') == [("SF654", "b"), ("SF653", "Y")]


def test_the_only_input_and_the_only_output_that_do_not_meet_are_told_once():
    assert told(elements="", outputs='Y = "y"') == [("SF652", "F")]


def test_a_mass_on_a_beam_has_an_effect_and_one_beside_it_has_none():
    rod = 'type = "rod", E = "70 GPa", rho = "2700 kg/m^3", A = "1e-4 m^2", l = "1 m"'
    beam = (
        f'arm = {{ {rod}, between = ["x", "y"] }}\n'
        'c = { type = "mass", at = "z", m = "m" }\n'
        'held = { type = "spring", between = ["z", "ground"], k = "k" }'
    )
    assert told(elements=beam) == [("SF654", "c")]


def test_a_member_that_hangs_on_what_nothing_moves_or_nothing_reads_has_no_effect():
    # The rod from the held node to a misspelt one has left the model; with its end at x it has an effect.
    line = 'E = "70 GPa", rho = "2700 kg/m^3", A = "1e-4 m^2", l = "1 m"'
    beam = f'type = "beam", I = "1e-9 m^4", {line}'
    frame = f'type = "frame", I = "1e-9 m^4", angle = "0.3 rad", {line}'
    hold = 'base = { type = "fixed", at = "root" }'
    rod = f'type = "rod", {line}'
    for kind, end, expected in (
        *((kind, "p", [("SF654", "arm")]) for kind in (rod, beam, frame)),
        *((kind, "x", []) for kind in (rod, beam)),
    ):
        arm = f'{hold}\narm = {{ {kind}, between = ["root", "{end}"] }}'
        assert told(elements=f"{LINK}\n{arm}") == expected, (kind, end)
    # What a source moves and nothing reads: the rod on z follows x and acts on nothing.
    rod = f'rod = {{ {rod}, between = ["z", "ground"] }}'
    push = f'push = {{ type = "force_source", at = "z", f = "k*x" }}\n{rod}'
    assert told(elements=f"{LINK}\n{push}") == [("SF654", "rod")]
    for read in ("rod.f", "rod.u(0.5 m)"):
        assert told(elements=f"{LINK}\n{push}", outputs=f'X = "x"\nY = "{read}"') == [], read


def messages(**parts):
    model = pipeline.loads(CHAIN.format(**{"elements": LINK, "inputs": FORCE, "outputs": 'X = "x"'} | parts))
    return [(w.code, w.message, w.hint, w.severity) for w in pipeline.warnings(model)]


FORCE = 'F = { force = "x" }'
LOOSE = "is a node's name misspelt, or does an end hang free?"


def test_an_output_that_is_zero_only_by_balance_is_told():
    # A spring without mass: k x is the force at every frequency.
    elements = 'held = { type = "spring", between = ["z", "ground"], k = "k" }\n' + LINK
    outputs = 'X = "z"\nY = "k*z - F"'
    assert messages(elements=elements, inputs='F = { force = "z" }', outputs=outputs)[-1] == (
        "SF653",
        "no input reaches output 'Y': all its transfer functions are 0",
        "check the spelling of the names in its expression and on the way to it",
        "warning",
    )


def test_an_idle_input_is_told_with_what_may_be_wrong():
    assert messages(inputs=f"{FORCE}\nu = {{}}", outputs='X = "x + u - u"') == [
        (
            "SF652",
            "input 'u' reaches no output: all its transfer functions are 0",
            "check the spelling of the names on its way, or add an output",
            "warning",
        )
    ]


def test_one_part_that_nothing_moves_is_told_as_one():
    first, _ = messages(elements="", outputs='X = "x"\nY = "y"')
    assert first == ("SF654", "mass 'b' changes no transfer function: no input moves it", LOOSE, "warning")


def test_parts_that_nothing_strains_are_told_together_at_the_first():
    # Nothing holds p and q: they move with y, and the three springs carry no force.
    ring = "\n".join(
        f'{name} = {{ type = "spring", between = ["{one}", "{two}"], k = "k" }}'
        for name, one, two in (("r_1", "y", "p"), ("r_2", "p", "q"), ("r_3", "q", "y"))
    )
    assert told(elements=f"{LINK}\n{ring}") == [("SF654", "r_1")]
    ((code, message, hint, severity),) = messages(elements=f"{LINK}\n{ring}")
    assert (code, hint, severity) == ("SF654", LOOSE, "warning")
    assert message.endswith("change no transfer function: no input strains them")
    assert [name in message for name in ("spring 'r_1'", "spring 'r_2'", "spring 'r_3'")] == [True] * 3


def test_a_part_that_is_driven_one_way_is_one_that_no_output_sees():
    # The force on y follows from x, and y acts on nothing.
    push = 'push = { type = "force_source", at = "y", f = "k*x" }'
    assert messages(elements=push) == [
        ("SF654", "mass 'b' changes no transfer function: no output depends on it", LOOSE, "warning")
    ]


def test_a_part_whose_own_force_is_read_is_seen_though_both_its_ends_are_held():
    # The gauge's force is k times the displacement imposed: F/z = k.
    gauge = 'gauge = { type = "spring", between = ["z", "ground"], k = "k" }'
    assert (
        told(
            elements=f"{LINK}\n{gauge}",
            inputs='z_0 = { displacement = "z" }\nF = { force = "x" }',
            outputs='X = "x"\nF_z = "gauge.f"',
        )
        == []
    )
