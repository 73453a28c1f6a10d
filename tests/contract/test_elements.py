"""What every element of the registry promises, tested the moment it is registered."""

import copy
from dataclasses import replace
from itertools import product

from symflex import pipeline
from symflex.algebra import Factored, Ring
from symflex.cli import run
from symflex.library.elements import (
    ACROSS_UNIT,
    CIRCUITS,
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

PORT_DOMAINS = ("translation", "rotation", *CIRCUITS, "planar", "plane", "any", "whole")
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


def test_it_is_documented_under_its_own_name():
    for kind, element in ELEMENTS.items():
        assert element.type_name == kind
        assert type(element).__doc__.strip(), kind
        assert element.summary.strip(), kind
        assert type(element).stamp.__doc__.strip(), kind


def test_its_ports_are_documented_and_of_a_known_domain():
    for kind, element in ELEMENTS.items():
        for port in element.ports:
            assert port.doc.strip(), kind
            assert port.domain in PORT_DOMAINS, kind
            assert port.terminals in (1, 2, 4), kind


def test_its_parameters_and_choices_are_documented_with_the_defaults_they_may_have():
    for kind, element in ELEMENTS.items():
        docs = [item.doc for item in (*element.parameters, *element.choices)]
        assert all(doc.startswith(("a ", "an ", "Young's ")) for doc in docs), kind
        assert all(choice.default in choice.values for choice in element.choices), kind
        earlier = []
        for parameter in element.parameters:
            default = parameter.default
            assert default is None or default in earlier or float(default) == 0, (kind, parameter.name)
            earlier.append(parameter.name)


def test_what_is_said_of_its_parameters_names_them_and_words_that_can_be_chosen():
    for kind, element in ELEMENTS.items():
        words = {v for c in element.choices for v in c.values}
        assert all(set(p.only) <= words for p in element.parameters), kind
        law = element.passive
        said = {element.stiffness, element.damping, *(law.of_any_sign + law.equal if law else ())} - {""}
        assert said <= {p.name for p in element.parameters}, kind


def test_the_units_of_its_parameters_and_quantities_parse():
    for (kind, element), domain in product(ELEMENTS.items(), ACROSS_UNIT):
        domains = domains_of(element, domain)
        for name in (*(p.name for p in element.parameters), *element.quantities(domains)):
            assert unit_of(element.unit_of(name, domains)).scale == 1, (kind, domain, name)


def test_it_stamps_the_quantities_it_offers_and_as_many_rows_as_unknowns_of_its_name():
    for (kind, element), domain in product(ELEMENTS.items(), ACROSS_UNIT):
        use = use_of(element, domain)
        stamp = element.stamp(use)
        assert tuple(n for n, _ in stamp.through) == element.quantities(use.domains), (kind, domain)
        assert len(stamp.rows) == len(stamp.unknowns), (kind, domain)
        assert {r.about for r in stamp.rows} == set(stamp.unknowns), (kind, domain)
        assert all((v.kind, v.owner) == ("through", "part") for v in stamp.unknowns), (kind, domain)


def test_it_has_no_state_and_its_stamp_is_pure():
    for kind, element in ELEMENTS.items():
        assert vars(element) == {}, kind
        use = use_of(element)
        before = copy.copy((dict(use.terminals), dict(use.values), dict(use.forms)))
        first = shown(element.stamp(use))
        assert shown(element.stamp(use)) == first, kind
        assert (dict(use.terminals), dict(use.values), dict(use.forms)) == before, kind


def test_it_is_derivable_in_a_smallest_model_where_its_value_matters():
    for kind, element in ELEMENTS.items():
        (tf,) = pipeline.derive_all(pipeline.loads(element_model(kind)))
        bound = pipeline.bind(tf)
        assert bound(1.7j) is not None, kind
        assert [p.name for p in tf.parameters][:1] == ["p"], kind
        if element.passive:
            assert_passive(kind, bound)


def assert_passive(kind, bound):
    """A passive port's flow over effort has no negative real part where Re(s) > 0 (Brune 1931)."""
    for s in (0.1 + 0.3j, 1 + 2j, 3 - 1j, 0.01 + 5j, 0.5 + 0j):
        flow = complex(bound(s)) * (1 if MODELS[kind][1] in ("current", "flow") else s)
        assert flow.real >= -1e-12 * abs(flow), kind


def test_every_quantity_it_offers_can_be_an_output():
    for kind in ELEMENTS:
        text = element_model(kind)
        (use,) = [u for u in pipeline.loads(text).elements if u.name == "part_1"]
        names = use.element.quantities(dict(use.domains))
        model = pipeline.loads(text + "".join(f'Q_{name} = "part_1.{name}"\n' for name in names))
        equations = pipeline.assemble(model)
        dimensions = {o.name: o.dimension for o in model.outputs}
        for name in names:
            tf = pipeline.derive(equations, f"Q_{name}", "U")
            assert pipeline.bind(tf)(0.3 + 1.7j) is not None, (kind, name)
            wanted = use.element.unit_of(name, dict(use.domains))
            assert dimensions[f"Q_{name}"] == unit_of(wanted).dimension, (kind, name)


def test_the_command_line_lists_it_with_every_key(capsys):
    assert run(["elements"]) == 0
    listed = capsys.readouterr().out.splitlines()
    for kind, element in ELEMENTS.items():
        first = next(i for i, x in enumerate(listed) if x.strip().startswith(f"{kind}("))
        last = next(i for i in range(first, len(listed)) if ")" in listed[i])
        lines = listed[first : last + 1]
        given = (*element.ports, *element.choices, *(p for p in element.parameters if not (p.of or p.only)))
        assert all(p.name in "".join(lines) for p in given), kind
        assert max(map(len, lines)) <= 80, kind


def test_the_command_line_describes_it(capsys):
    for kind, element in ELEMENTS.items():
        assert run(["elements", kind]) == 0, kind
        described = capsys.readouterr().out
        items = (*element.ports, *element.parameters, *element.choices)
        words = [word for choice in element.choices for word in choice.values if not choice.is_flag]
        assert [x for x in (*(item.name for item in items), *words) if x not in described] == [], kind


LINES = {kind: element for kind, element in ELEMENTS.items() if isinstance(element, LineElement)}


def chosen(element):
    """Return every combination of an element's choices."""
    return [
        dict(zip([c.name for c in element.choices], words, strict=True))
        for words in product(*(c.values for c in element.choices))
    ]


def test_a_line_element_has_its_length_among_its_parameters_in_metres():
    for kind, element in LINES.items():
        assert [p.unit for p in element.parameters if p.name == element.length] == ["m"], kind


def test_a_line_element_s_theories_are_registered_and_of_its_state():
    for kind, element in LINES.items():
        for choices in chosen(element):
            words = choices.values()
            values = {
                p.name: Factored.generator(RING, "p")
                for p in element.parameters
                if p.applies(words) or p.default is not None
            } | dict.fromkeys(DIRECTION, Factored.generator(RING, "p"))
            system = FIELDS[element.theory(choices)](Factored.generator(RING, "s"), values)
            assert len(system.states) == len(element.ends) + len(element.through), kind
            assert system.states[len(element.ends) :] == element.through, kind


def test_a_line_element_that_transmits_its_state_unchanged_is_a_rigid_and_massless_joint():
    for kind, element in LINES.items():
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
            assert law in ({f"n2{dot}": 1, f"n1{dot}": -1}, {f"part.{name}": -1, f"part.{name}_a": -1}), kind


def test_a_line_element_at_ground_has_no_across_there():
    for kind, element in LINES.items():
        use = use_of(element)
        (port,) = use.terminals
        grounded = replace(use, terminals={port: (PortTerminal(), use.terminals[port][1])})
        stamp = element.stamp(grounded)
        assert not any(str(v).startswith("n1") for row in stamp.rows for v, _ in row.form.terms), kind
        assert len(stamp.rows) == len(stamp.unknowns), kind


def test_every_element_has_a_smallest_model():
    assert set(MODELS) == set(ELEMENTS)


def test_across_times_through_is_an_energy_or_a_power():
    """Newton metres for motion, volt amperes for electricity, Pa m^3/s for sound (IEC 80000).

    Heat flow is a power itself; with the temperature beside it, it is the pseudo power of bond graphs.
    """
    for domain, across in ACROSS_UNIT.items():
        energy = unit_of(across).dimension * unit_of(THROUGH_UNIT[domain]).dimension
        power = "K*W" if domain == "thermal" else "W"
        assert energy == unit_of(power if domain in CIRCUITS else "J").dimension, domain
        assert THROUGH_NAME[domain] in ("f", "tau", "i", "q", "phi"), domain
