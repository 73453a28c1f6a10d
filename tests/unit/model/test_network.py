"""Nodes take their domain from what touches them; nested models, analysis and figures are read."""

from fractions import Fraction

import pytest

from symflex import pipeline
from symflex.errors import ModelError, SpecError

HEADER = "symflex = 1\n"
MOVING = '[inputs]\nF = { force = "x" }\n[outputs]\nX = "x"\n'


def domains(elements, rest=MOVING):
    model = pipeline.loads(f"{HEADER}[parameters]\np = 1\n[elements]\n{elements}\n{rest}")
    return {n.name: n.domain for n in model.nodes}


def codes(text, read=pipeline.loads):
    with pytest.raises(SpecError) as caught:
        read(text)
    return [d.code for d in caught.value.diagnostics]


def test_a_node_translates_or_is_planar_by_what_touches_it():
    mass = 'M = { type = "mass", at = "x", m = "p" }\n'
    body = 'B = { type = "rigid_body", at = "x", m = "p" }'
    turned = 'T = { type = "torsion_spring", between = ["x.theta", "ground"], k = "p" }'
    assert domains(mass) == {"x": "translation"}
    assert domains(mass + body) == domains(mass + turned) == {"x": "planar"}


def test_the_label_of_an_element_is_kept_and_refused_where_it_is_no_mathematics():
    mass = '[elements]\nM = {{ type = "mass", at = "x", m = 1, latex = \'{}\' }}\n'
    (kept,) = pipeline.loads(HEADER + mass.format(r"\text{motor}") + MOVING).elements
    assert kept.latex == r"\text{motor}"
    with pytest.raises(SpecError, match="input"):
        pipeline.loads(HEADER + mass.format(r"\input{x}") + MOVING)


def test_a_translational_element_at_a_planar_node_acts_on_y_and_a_rotational_one_on_theta():
    text = f"""{HEADER}[parameters]
m = 2
J = 3
k = 5
t = 7
[elements]
B = {{ type = "rigid_body", at = "p", m = "m", J = "J" }}
K = {{ type = "spring", between = ["p", "ground"], k = "k" }}
T = {{ type = "torsion_spring", between = ["p", "ground"], k = "t" }}
[inputs]
F = {{ force = "p" }}
M = {{ torque = "p" }}
[outputs]
Y = "p"
Q = "p.theta"
"""
    values = {tf.name: pipeline.bind(tf)(1 + 0j) for tf in pipeline.derive_all(pipeline.loads(text))}
    assert values == {"Y/F": pytest.approx(1 / 7), "Y/M": 0, "Q/F": 0, "Q/M": pytest.approx(1 / 10)}


def test_a_node_used_in_two_domains_is_refused():
    elements = (
        '[elements]\nM = { type = "mass", at = "x", m = 1 }\nJ = { type = "inertia", at = "x", J = 1 }\n'
    )
    assert codes(HEADER + elements + MOVING) == ["SF220"]


def test_elements_nodes_outputs_and_inputs_may_share_a_name():
    text = f'{HEADER}[elements]\nx = {{ type = "mass", at = "x", m = 1 }}\n'
    (tf,) = pipeline.derive_all(pipeline.loads(text + '[inputs]\nF = { force = "x" }\n[outputs]\nx = "x"\n'))
    assert pipeline.bind(tf)(1 + 0j) == 1


def test_nodes_that_are_numbers_are_told_how_to_be_named():
    found = {}
    for node in ("0", "1"):
        with pytest.raises(SpecError) as error:
            pipeline.loads(f"""symflex = 1
elements.R = {{ type = "resistor", between = ["a", "{node}"], R = 1 }}
inputs.V = {{ voltage = "a" }}
outputs.I = "V.i"
""")
        found[node] = error.value.diagnostics[0].hint
    assert found == {"0": "the ground is 'ground'", "1": "a name begins with a letter: write 'n1'"}


def test_a_name_that_can_be_read_two_ways_is_refused():
    text = f'{HEADER}[parameters]\nx = 1\n[elements]\nM = {{ type = "mass", at = "x", m = 1 }}\n'
    assert set(codes(text + MOVING)) == {"SF211"}


def test_a_name_that_can_be_read_two_ways_is_one_problem():
    text = f'{HEADER}[parameters]\nx = 1\n[elements]\nM = {{ type = "mass", at = "x", m = 1 }}\n'
    more = '[inputs]\nF = { force = "x" }\n[outputs]\na = "x"\nb = "2*x"\nc = "x - 3*x"\n'
    assert codes(text + more) == ["SF211"]


def test_a_parameter_may_bear_the_name_of_a_node_where_only_a_parameter_can_stand():
    text = """symflex = 1
    parameters = { b = "3 N*s/m", l = "2 m", N = "8 N" }
    inputs = { F = { force = "b" } }
    outputs = { X = "w(l)", V = "l" }
    elements.loss = { type = "damper", between = ["b", "ground"], b = "2*b" }
    elements.mass = { type = "mass", at = "b", m = "1 kg" }
    elements.link = { type = "spring", between = ["b", "c"], k = "5 N/m" }
    elements.end = { type = "damper", between = ["c", "ground"], b = "b" }
    fields.w = { domain = ["0", "l"], equation = "N*w'' = 0", conditions = ["w(0) = 0", "N*w'(l) = F"] }
    """.replace("\n    ", "\n")
    other = text.replace('"b"', '"x"').replace('b = "x"', 'b = "b"').replace('V = "l"', 'V = "c"')
    text = text.replace('V = "l"', 'V = "c"')
    found, wanted = (
        [pipeline.bind(tf)(1 + 2j) for tf in pipeline.derive_all(pipeline.loads(t))] for t in (text, other)
    )
    assert found == wanted


# -------------------------------------------------------------------------------------- nested models

INNER = """symflex = 1
[parameters]
m = "3 kg"
inner_only = "2 N/m"
[elements]
M = { type = "mass", at = "x", m = "m" }
K = { type = "spring", between = ["x", "ground"], k = "inner_only" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
"""


def nested(tmp_path, outer, folder="parts"):
    (tmp_path / folder).mkdir()
    (tmp_path / folder / "inner.toml").write_text(INNER, "utf-8")
    path = tmp_path / "outer.toml"
    path.write_text(outer, "utf-8")
    return path


OUTER = (
    HEADER
    + '{parameters}[blocks]\nG = {{ type = "model", spec = "parts/inner.toml", tf = "X/F" }}\n'
    + '[inputs]\nu = {{}}\n[outputs]\nY = "G*u"\n'
)


def test_a_nested_model_is_found_relative_to_the_outer_file_and_brings_its_parameters(tmp_path):
    model = pipeline.load(nested(tmp_path, OUTER.format(parameters="")))
    assert [p.name for p in model.parameters] == ["m", "inner_only"]
    (tf,) = pipeline.derive_all(model)
    assert pipeline.bind(tf)(1 + 0j) == pytest.approx(1 / 5)


def test_a_parameter_is_shared_when_its_value_is_equal_and_refused_otherwise(tmp_path):
    path = nested(tmp_path, OUTER.format(parameters='[parameters]\nm = "3000 g"\n'))
    assert [p.name for p in pipeline.load(path).parameters] == ["m", "inner_only"]
    path.write_text(OUTER.format(parameters='[parameters]\nm = "4 kg"\n'), "utf-8")
    assert codes(path, pipeline.load) == ["SF226"]
    path.write_text(OUTER.format(parameters='[parameters]\nk = 2\n[definitions]\nm = "2*k"\n'), "utf-8")
    assert codes(path, pipeline.load) == ["SF211"]


def test_two_blocks_with_one_parameter_of_two_values_are_both_named(tmp_path):
    more = 'H = { type = "model", spec = "parts/other.toml", tf = "X/F" }\n[inputs]'
    outer = OUTER.format(parameters="").replace("[inputs]", more).replace("G*u", "G*u + H*u")
    path = nested(tmp_path, outer)
    (tmp_path / "parts" / "other.toml").write_text(INNER.replace('m = "3 kg"', 'm = "4 kg"'), "utf-8")
    with pytest.raises(SpecError, match=r"in block 'H' \(.*other\.toml:.* than in block 'G' \(.*inner\.toml"):
        pipeline.load(path)


def test_a_model_that_hides_a_late_part_is_refused_as_a_block(tmp_path):
    path = nested(tmp_path, OUTER.format(parameters=""))
    late = HEADER + 'inputs.F = {}\noutputs.X = "(2 - exp(-s))*y"\nsignals.y = "F/((2 - exp(-s))*(s + 1))"\n'
    (tmp_path / "parts" / "inner.toml").write_text(late, "utf-8")
    with pytest.raises(ModelError, match="contains waves, a delay or a root of s") as caught:
        pipeline.derive_all(pipeline.load(path))
    assert caught.value.diagnostics[0].code == "SF910"


def test_a_model_that_nests_itself_is_refused(tmp_path):
    path = tmp_path / "self.toml"
    path.write_text(OUTER.format(parameters="").replace("parts/inner", "self"), "utf-8")
    assert codes(path, pipeline.load) == ["SF215"]


# --------------------------------------------------------------------------------- analysis and figures

MASS = f'{HEADER}[elements]\nM = {{ type = "mass", at = "x", m = 1 }}\n{MOVING}'


def test_the_band_is_in_hertz():
    model = pipeline.loads(MASS + '[analysis]\nband = ["60 rpm", "1 kHz"]\nmodes = 5\ndigits = 30\n')
    assert model.analysis.band == (Fraction(1), Fraction(1000))
    assert (model.analysis.modes, model.analysis.digits) == (5, 30)


def test_a_band_that_is_none_is_refused():
    for band, code in [
        ('["1 kHz", "1 Hz"]', "SF227"),
        ('["0 Hz", "1 Hz"]', "SF227"),
        ('["1 Hz"]', "SF206"),
        ('["1 m", "2 Hz"]', "SF203"),
    ]:
        assert codes(MASS + f"[analysis]\nband = {band}\n") == [code], band


DRAWN = f"{MASS}[drawing]\n"


def test_hints_for_a_drawing_are_read():
    hints = pipeline.loads(f'{DRAWN}order = ["x"]\nrollers = false\n').drawing
    assert (hints.order, hints.rollers, hints.symbols) == (("x",), False, ())
    assert pipeline.loads(MASS).drawing.rollers is None


def test_a_hint_that_cannot_be_followed_is_refused():
    for line, code in [
        ('order = ["xx"]', "SF210"),
        ('order = ["x", "x"]', "SF213"),
        ("order = 3", "SF206"),
        ('rollers = "yes"', "SF206"),
        ('up = "yes"', "SF206"),
        ('colour = "red"', "SF207"),
        ('symbols = { M = "rack" }', "SF210"),
        ('symbols = "rack"', "SF206"),
    ]:
        assert codes(f"{DRAWN}{line}\n") == [code], line


def test_an_unknown_symbol_is_refused():
    gear = 'G = { type = "transformer", from = "x", to = "y", ratio = 2 }\n'
    text = MASS.replace("[elements]\n", f"[elements]\n{gear}")
    assert codes(f'{text}[drawing.symbols]\nG = "pulley"\n') == ["SF208"]


def test_a_count_that_is_none_is_refused():
    for key in ["modes = 0", "modes = -1", "modes = 1.5", 'digits = "3"', "digits = 100000"]:
        assert codes(MASS + f"[analysis]\n{key}\n") == ["SF206"], key


def figure(keys):
    return f'{MASS}[figures.one]\nkind = "bode"\n{keys}\n'


def test_a_figure_has_a_kind_functions_and_perhaps_a_band_and_data():
    (found,) = pipeline.loads(figure('of = ["X/F"]\nband = [2, "1 kHz"]\ndata = true')).figures
    assert (found.name, found.kind, found.of, found.band) == ("one", "bode", (("X", "F"),), (2, 1000))
    assert found.has_data


def test_a_figure_that_cannot_be_drawn_is_refused():
    for keys, code in [
        ('of = ["Y/F"]', "SF218"),
        ("band = [3, 2]", "SF227"),
        ('band = ["1 m", 2]', "SF203"),
        ('of = ["X/F"]\ndata = "yes"', "SF206"),
    ]:
        assert codes(figure(keys)) == [code], keys
    # Data stand in a Bode plot.
    assert codes(figure('of = ["X/F"]\ndata = true').replace('"bode"', '"poles_zeros"')) == ["SF207"]


def locus(keys):
    gain = '[parameters]\ng = { value = 1, unit = "N/m" }\n[definitions]\nG = "g"\n'
    return f'{MASS}{gain}[figures.one]\nkind = "locus"\n{keys}\n'


def test_a_locus_has_a_range_in_the_units_of_its_gain():
    (found,) = pipeline.loads(locus('gain = "g"\nrange = [0, "2 N/mm"]')).figures
    assert found.limits == (0, 2000)
    for keys, code in [
        ("range = [0, 1]", "SF207"),
        ('gain = "g"\nrange = 3', "SF206"),
        ('gain = "g"\nrange = [1, "1 m"]', "SF203"),
        ('gain = "g"\nrange = [2, 1]', "SF227"),
    ]:
        assert codes(locus(keys)) == [code], keys


def test_a_name_that_is_unknown_in_several_lines_is_one_problem():
    text = f'{MASS}Y = "K_p*x"\nZ = "K_p"\n[parameters]\nk_p = 2\n[definitions]\nG = "K_p"\n'
    with pytest.raises(SpecError) as caught:
        pipeline.loads(text)
    (found,) = caught.value.diagnostics
    assert (found.span.line, found.hint) == (8, "did you mean 'k_p'?; also in lines 9, 13")


def test_the_unit_of_a_ratio_tells_the_other_side_however_it_is_written():
    head = '[parameters]\np = 1\nn = 4\nr = "5 mm/rad"\nJ = "2 kg*m^2"\n[elements]\n'
    rotor = 'R = { type = "inertia", at = "phi", J = "J" }\n'
    for ratio in ("r", "n*r", "2*r", "r/n"):
        lever = f'T = {{ type = "transformer", from = "phi", to = "z", ratio = "{ratio}" }}\n'
        rest = '[inputs]\nM = { torque = "phi" }\n[outputs]\nZ = "z"\n'
        model = pipeline.loads(HEADER + head + rotor + lever + rest)
        assert {n.name: n.domain for n in model.nodes} == {"phi": "rotation", "z": "translation"}, ratio


HELD = """
[parameters]
m = "2 kg"
J = "3 kg*m^2"
E = "70 GPa"
I = "1e-9 m^4"
[elements]
M = { type = "mass", at = "x", m = "m" }
R = { type = "inertia", at = "r", J = "J" }
C = { type = "capacitor", between = ["v", "ground"], C = "1 F" }
B = { type = "massless_beam", between = ["ground", "p"], EI = "E*I", l = "0.8 m" }
joint = { type = "fixed", between = ["ONE", "OTHER"] }
[elements.Q]
type = "frame"
between = ["ground", "q"]
E = "E"
I = "I"
rho = "1 kg/m^3"
A = "1 m^2"
l = "1 m"
angle = 0
[inputs]
F = { force = "p" }
T = { torque = "p.theta" }
[outputs]
Y = "p.y"
phi = "p.theta"
"""


def test_what_is_held_to_a_single_coordinate_follows_it_in_either_order():
    # The stiffness of a cantilever is 3 EI/l^3; turned at its free end it is EI/l with the deflection free.
    stiffness = 70e9 * 1e-9
    expected = {("x", "p"): 1 / (2 * 9 + 3 * stiffness / 0.8**3), ("r", "p"): 1 / (3 * 9 + stiffness / 0.8)}
    for (one, other), value in expected.items():
        name, of = ("Y", "F") if one == "x" else ("phi", "T")
        for pair in ((one, other), (other, one)):
            text = HELD.replace("ONE", pair[0]).replace("OTHER", pair[1])
            (bound,) = pipeline.derive_bound(pipeline.loads(HEADER + text), [(name, of)])
            assert complex(bound(3)) == pytest.approx(value, rel=1e-12), pair


def test_what_is_held_to_a_coordinate_of_another_kind_is_refused():
    pairs = {("x", "r"): "SF220", ("p.theta", "x"): "SF220", ("v", "x"): "SF220", ("p", "v"): "SF220"}
    pairs |= {("q", "x"): "SF219"}
    for pair, code in pairs.items():
        for one, other in (pair, pair[::-1]):
            assert codes(HEADER + HELD.replace("ONE", one).replace("OTHER", other)) == [code], pair
