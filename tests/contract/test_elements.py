"""What every element of the registry promises, tested the moment it is registered."""

from __future__ import annotations

import copy
from dataclasses import replace
from itertools import product

import pytest

from symflex import pipeline
from symflex.algebra import Factored, Ring
from symflex.cli import run
from symflex.library.elements import (
    ACROSS_UNIT,
    COMPONENTS,
    ELEMENTS,
    THROUGH_NAME,
    THROUGH_UNIT,
    ElementUse,
    LinearForm,
    LineElement,
    PortTerminal,
    Variable,
)
from symflex.library.fields import FIELDS
from symflex.quantities import unit_of
from tests.contract.smallest import MODELS, element_model

EVERY = pytest.mark.parametrize("kind", ELEMENTS)
PORT_DOMAINS = ("translation", "rotation", "electrical", "planar", "plane", "any", "whole")
RING = Ring(("s", "p", "q"))
DIRECTION = ("cos", "sin", "cos_cos", "cos_sin")


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
            if domains[port.name] in COMPONENTS:
                moving = {c: Variable("node", f"n{count}", c) for c in COMPONENTS[domains[port.name]]}
                found.append(PortTerminal(**moving))
            else:
                found.append(PortTerminal(Variable("node", f"n{count}")))
        terminals[port.name] = tuple(found)
    p = Factored.generator(RING, "p")
    values = {x.name: p + i for i, x in enumerate(element.parameters) if not x.signal}
    if any(x.is_direction for x in element.parameters):
        values |= {name: p * (i + 2) for i, name in enumerate(DIRECTION)}
    signal = LinearForm.of((Variable("signal", "u"), p))
    forms = {x.name: signal for x in element.parameters if x.signal}
    s = Factored.generator(RING, "s")
    choices = {c.name: c.default for c in element.choices}
    size = len(element.ends) + len(element.through) if isinstance(element, LineElement) else 0
    transmission = tuple(tuple(p + 7 * i + j for j in range(size)) for i in range(size))
    return ElementUse("part", s, terminals, domains, values, forms, choices, transmission)


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
def test_its_choices_are_documented_and_their_default_is_one_of_them(kind):
    for choice in ELEMENTS[kind].choices:
        assert choice.doc.startswith(("a ", "an "))
        assert choice.default in choice.values


@EVERY
def test_a_parameter_goes_only_with_words_that_can_be_chosen(kind):
    words = {v for c in ELEMENTS[kind].choices for v in c.values}
    assert all(set(p.only) <= words for p in ELEMENTS[kind].parameters)


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


@pytest.mark.parametrize("kind", [kind for kind, element in ELEMENTS.items() if element.passive])
def test_what_is_called_passive_only_takes_energy_in(kind):
    """A passive port's flow over effort has no negative real part where Re(s) > 0 (Brune 1931)."""
    (tf,) = pipeline.derive_all(pipeline.loads(element_model(kind)))
    bound = pipeline.bind(tf)
    for s in (0.1 + 0.3j, 1 + 2j, 3 - 1j, 0.01 + 5j, 0.5 + 0j):
        flow = complex(bound(s)) * (1 if MODELS[kind][1] == "current" else s)
        assert flow.real >= -1e-12 * abs(flow)


@EVERY
def test_what_is_said_of_its_parameters_names_them(kind):
    element = ELEMENTS[kind]
    law = element.passive
    said = {element.stiffness, element.damping, *(law.of_any_sign + law.equal if law else ())} - {""}
    assert said <= {p.name for p in element.parameters}


@EVERY
def test_the_command_line_lists_it_with_every_key(kind, capsys):
    assert run(["elements"]) == 0
    line = next(x for x in capsys.readouterr().out.splitlines() if x.strip().startswith(f"{kind}("))
    element = ELEMENTS[kind]
    assert all(p.name in line for p in (*element.ports, *element.parameters, *element.choices))
    assert len(line) <= 80


@EVERY
def test_the_command_line_describes_it(kind, capsys):
    assert run(["elements", kind]) == 0
    described = capsys.readouterr().out
    for item in (*ELEMENTS[kind].ports, *ELEMENTS[kind].parameters, *ELEMENTS[kind].choices):
        assert item.name in described
    assert all(word in described for choice in ELEMENTS[kind].choices for word in choice.values)


LINES = pytest.mark.parametrize("kind", [k for k, e in ELEMENTS.items() if isinstance(e, LineElement)])


def chosen(element):
    """Return every combination of an element's choices."""
    return [
        dict(zip([c.name for c in element.choices], words, strict=True))
        for words in product(*(c.values for c in element.choices))
    ]


@LINES
def test_a_line_element_has_its_length_among_its_parameters_in_metres(kind):
    element = ELEMENTS[kind]
    assert [p.unit for p in element.parameters if p.name == element.length] == ["m"]


@LINES
def test_a_line_element_s_theories_are_registered_and_of_its_state(kind):
    element = ELEMENTS[kind]
    for choices in chosen(element):
        words = choices.values()
        values = {
            p.name: Factored.generator(RING, "p")
            for p in element.parameters
            if p.applies(words) or p.default is not None
        } | dict.fromkeys(DIRECTION, Factored.generator(RING, "p"))
        system = FIELDS[element.theory(choices)](Factored.generator(RING, "s"), values)
        assert len(system.states) == len(element.ends) + len(element.through)
        assert system.states[len(element.ends) :] == element.through


@LINES
def test_a_line_element_that_transmits_its_state_unchanged_is_a_rigid_and_massless_joint(kind):
    element = ELEMENTS[kind]
    use = use_of(element)
    size = len(use.transmission)
    zero, one = use.one * 0, use.one
    unit = tuple(tuple(one if i == j else zero for j in range(size)) for i in range(size))
    stamp = element.stamp(replace(use, transmission=unit))
    laws = [{str(v): c.unit for v, c in row.form.terms} for row in stamp.rows]
    dots = [""] if element.ends == ("across",) else [f".{end}" for end in element.ends]
    twice = zip((*element.through, *element.through), (*dots, *dots), laws, strict=True)
    for name, dot, law in twice:
        # The ends move alike; what is delivered at one end is taken at the other.
        assert law in ({f"n2{dot}": 1, f"n1{dot}": -1}, {f"part.{name}": -1, f"part.{name}_a": -1})


@LINES
def test_a_line_element_at_ground_has_no_across_there(kind):
    element = ELEMENTS[kind]
    use = use_of(element)
    (port,) = use.terminals
    grounded = replace(use, terminals={port: (PortTerminal(), use.terminals[port][1])})
    stamp = element.stamp(grounded)
    assert not any(str(v).startswith("n1") for row in stamp.rows for v, _ in row.form.terms)
    assert len(stamp.rows) == len(stamp.unknowns)


def test_every_element_has_a_smallest_model():
    assert set(MODELS) == set(ELEMENTS)


@pytest.mark.parametrize("domain", ACROSS_UNIT)
def test_across_times_through_is_an_energy_or_a_power(domain):
    """Newton metres for motion, volt amperes for electricity (IEC 80000)."""
    product = unit_of(ACROSS_UNIT[domain]).dimension * unit_of(THROUGH_UNIT[domain]).dimension
    assert product == unit_of("W" if domain == "electrical" else "J").dimension
    assert THROUGH_NAME[domain] in ("f", "tau", "i")
