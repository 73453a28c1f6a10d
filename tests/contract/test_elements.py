"""What every element of the registry promises, tested the moment it is registered."""

from __future__ import annotations

import copy

import pytest

from symflex import pipeline
from symflex.cli import run
from symflex.elements import (
    ACROSS_UNIT,
    ANNOUNCED,
    ELEMENTS,
    THROUGH_NAME,
    THROUGH_UNIT,
    ElementUse,
    LinearForm,
    Terminal,
    Variable,
)
from symflex.errors import SpecError
from symflex.kernels import Factored, Ring
from symflex.quantities import unit_of
from tests.contract.smallest import MODELS, element_model

EVERY = pytest.mark.parametrize("kind", ELEMENTS)
PORT_DOMAINS = ("translation", "rotation", "electrical", "planar", "any", "whole")
RING = Ring(("s", "p", "q"))


def domains_of(element, any_domain="translation"):
    replacement = {"any": any_domain, "whole": any_domain}
    return {p.name: replacement.get(p.domain, p.domain) for p in element.ports}


def use_of(element, any_domain="translation"):
    """Return a use with every terminal at a node of its own and every value a generator or signal."""
    domains, terminals, count = domains_of(element, any_domain), {}, 0
    for port in element.ports:
        found = []
        for _ in range(port.terminals):
            count += 1
            if domains[port.name] == "planar":
                y, theta = (Variable("node", f"n{count}", c) for c in ("y", "theta"))
                found.append(Terminal(None, y, theta))
            else:
                found.append(Terminal(Variable("node", f"n{count}")))
        terminals[port.name] = tuple(found)
    p = Factored.generator(RING, "p")
    values = {x.name: p + i for i, x in enumerate(element.parameters) if not x.signal}
    signal = LinearForm.of((Variable("signal", "u"), p))
    forms = {x.name: signal for x in element.parameters if x.signal}
    return ElementUse("part", Factored.generator(RING, "s"), terminals, domains, values, forms)


def shown(stamp):
    """Return a stamp as text, for comparison: coefficients have no equality of their own."""

    def form(value):
        return [(str(v), str(c)) for v, c in value.terms]

    return (
        [(str(b.a), str(b.b), str(b.admittance)) for b in stamp.branches],
        [(str(i.node), form(i.form)) for i in stamp.injections],
        [str(v) for v in stamp.unknowns],
        [(str(r.about), form(r.form), r.role) for r in stamp.rows],
        [(n, form(f)) for n, f in stamp.through],
    )


@EVERY
def test_the_key_is_the_type_s_own_name(kind):
    assert ELEMENTS[kind].type_name == kind


@EVERY
def test_it_is_documented(kind):
    element = ELEMENTS[kind]
    assert type(element).__doc__.strip()
    assert element.summary.strip()
    assert type(element).stamp.__doc__.strip()


@EVERY
def test_its_ports_are_documented_and_of_a_known_domain(kind):
    for port in ELEMENTS[kind].ports:
        assert port.doc.strip()
        assert port.domain in PORT_DOMAINS
        assert port.terminals in (1, 2)


@EVERY
def test_its_parameters_are_documented(kind):
    for parameter in ELEMENTS[kind].parameters:
        assert parameter.doc.startswith(("a ", "an "))


@EVERY
@pytest.mark.parametrize("domain", ACROSS_UNIT)
def test_the_units_of_its_parameters_and_quantities_parse(kind, domain):
    element = ELEMENTS[kind]
    domains = domains_of(element, domain)
    for name in (*(p.name for p in element.parameters), *element.quantities(domains)):
        assert unit_of(element.unit_of(name, domains)).scale == 1


@EVERY
def test_a_default_is_a_number_or_an_earlier_parameter(kind):
    earlier = []
    for parameter in ELEMENTS[kind].parameters:
        default = parameter.default
        assert default is None or default in earlier or float(default) == 0
        earlier.append(parameter.name)


@EVERY
@pytest.mark.parametrize("domain", ACROSS_UNIT)
def test_it_stamps_exactly_the_quantities_it_offers(kind, domain):
    element = ELEMENTS[kind]
    use = use_of(element, domain)
    assert tuple(n for n, _ in element.stamp(use).through) == element.quantities(use.domains)


@EVERY
@pytest.mark.parametrize("domain", ACROSS_UNIT)
def test_its_stamp_has_as_many_rows_as_unknowns(kind, domain):
    stamp = ELEMENTS[kind].stamp(use_of(ELEMENTS[kind], domain))
    assert len(stamp.rows) == len(stamp.unknowns)
    assert {r.about for r in stamp.rows} == set(stamp.unknowns)


@EVERY
def test_its_unknowns_bear_its_name(kind):
    stamp = ELEMENTS[kind].stamp(use_of(ELEMENTS[kind]))
    assert all((v.kind, v.owner) == ("through", "part") for v in stamp.unknowns)


@EVERY
def test_its_stamp_is_pure(kind):
    element = ELEMENTS[kind]
    use = use_of(element)
    before = copy.copy((dict(use.terminals), dict(use.values), dict(use.forms)))
    first = shown(element.stamp(use))
    assert shown(element.stamp(use)) == first
    assert (dict(use.terminals), dict(use.values), dict(use.forms)) == before


@EVERY
def test_it_has_no_state(kind):
    assert vars(ELEMENTS[kind]) == {}


@EVERY
def test_it_is_derivable_in_a_smallest_model(kind):
    (tf,) = pipeline.derive_all(pipeline.loads(element_model(kind)))
    assert pipeline.bind(tf)(1.7j) is not None


@EVERY
def test_its_value_matters_in_a_smallest_model(kind):
    (tf,) = pipeline.derive_all(pipeline.loads(element_model(kind)))
    assert [p.name for p in tf.parameters][:1] == ["p"]


@EVERY
def test_every_quantity_it_offers_can_be_an_output(kind):
    text = element_model(kind)
    (use,) = [u for u in pipeline.loads(text).elements if u.name == "part_1"]
    for quantity in use.element.quantities(dict(use.domains)):
        model = pipeline.loads(text + f'Q = "part_1.{quantity}"\n')
        tf = pipeline.derive(pipeline.assemble(model), "Q", "U")
        assert pipeline.bind(tf)(0.3 + 1.7j) is not None
        output = next(o for o in model.outputs if o.name == "Q")
        wanted = use.element.unit_of(quantity, dict(use.domains))
        assert output.dimension == unit_of(wanted).dimension


@EVERY
def test_the_command_line_lists_it_with_every_key(kind, capsys):
    assert run(["elements"]) == 0
    line = next(x for x in capsys.readouterr().out.splitlines() if x.strip().startswith(f"{kind}("))
    element = ELEMENTS[kind]
    assert all(p.name in line for p in (*element.ports, *element.parameters))


@EVERY
def test_the_command_line_describes_it(kind, capsys):
    assert run(["elements", kind]) == 0
    described = capsys.readouterr().out
    for item in (*ELEMENTS[kind].ports, *ELEMENTS[kind].parameters):
        assert item.name in described


def test_every_element_has_a_smallest_model():
    assert set(MODELS) == set(ELEMENTS)


def test_no_announced_element_is_there_already():
    assert not set(ANNOUNCED) & set(ELEMENTS)


@pytest.mark.parametrize("kind", ANNOUNCED)
def test_an_announced_element_is_said_to_be_not_available_yet(kind):
    text = f'symflex = 1\n[elements]\ne = {{ type = "{kind}" }}\n[inputs]\nU = {{}}\n[outputs]\nX = "U"\n'
    with pytest.raises(SpecError) as caught:
        pipeline.loads(text)
    assert [d.code for d in caught.value.diagnostics] == ["SF911"]


@pytest.mark.parametrize("domain", ACROSS_UNIT)
def test_across_times_through_is_an_energy_or_a_power(domain):
    """Newton metres for motion, volt amperes for electricity (IEC 80000)."""
    product = unit_of(ACROSS_UNIT[domain]).dimension * unit_of(THROUGH_UNIT[domain]).dimension
    assert product == unit_of("W" if domain == "electrical" else "J").dimension
    assert THROUGH_NAME[domain] in ("f", "tau", "i")
