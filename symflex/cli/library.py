"""What models are made of: ``new``, ``elements`` and ``units``."""

from __future__ import annotations

import os
import textwrap
from collections.abc import Sequence
from decimal import Decimal
from fractions import Fraction
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

import click

from symflex.cli.reporting import emit_json, reporting, say, terminal_width, write
from symflex.errors import Diagnostic, SpecError, SymflexError, Text, UsageError, no_such, refused

if TYPE_CHECKING:
    from symflex.library.blocks import Block
    from symflex.library.elements import Element, ParameterPort
    from symflex.quantities.units import Unit


TEMPLATES: dict[str, str] = {
    "mass_spring": "A mass on a spring and a damper, driven by a force.",
    "two_mass": "Two masses joined by a spring and a damper.",
    "motor_axis": "A motor with a current loop, a ball screw and a carriage.",
    "motor_loop": "Current, velocity and position loop of a motor with a load.",
    "servo": "PI speed loop of a servo drive with an elastic shaft.",
    "bending_beam": "A sliding mass, a massless beam and a rigid body at its end.",
    "sliding_beam": "A beam that slides at one end, as a boundary-value problem.",
    "flexible_arm": "A flexible arm on a driven hub, with a gripper at its tip.",
}


@click.command(
    "new", epilog="\b\n" + "\n".join(("Templates:", *(f"  {n}: {s}" for n, s in TEMPLATES.items())))
)
@click.argument("template", required=False)
@click.option("--list", "is_list", is_flag=True, help="List the templates.")
@click.option(
    "--from",
    "netlist",
    metavar="FILE",
    help="A SPICE netlist (.cir, .net, .sp), or a paper with equations of motion (.tex), to write as a "
    "specification.",
)
@click.option("-o", "--output", type=click.Path(), help="File to write.  [default: standard output]")
@reporting
def new(template: str | None, *, output: str | None, is_list: bool, netlist: str | None) -> int:
    """Write a specification to start from; without TEMPLATE, list the templates.

    A template begins with comments that say what it is and what to try next.
    """
    if netlist is not None:
        from symflex.model.spec.read import NETLISTS, read  # imports the packages of models

        if netlist.lower().endswith(".tex"):
            _write_new(_of_paper(Path(netlist)), output)
            return 0
        if not netlist.lower().endswith(NETLISTS):
            hint = f"the name of a netlist ends in {', '.join(NETLISTS)}, that of a paper in .tex"
            raise refused(f"'{netlist}' is not a netlist by its name", hint)
        _write_new(read(netlist).text, output)
        return 0
    if template is None or is_list:
        width = max(len(name) for name in TEMPLATES)
        for name, summary in TEMPLATES.items():
            say(f"{name.ljust(width)}  {summary}")
        return 0
    if template not in TEMPLATES:
        raise no_such("template", template, TEMPLATES)
    text = (files("symflex") / "templates" / f"{template}.toml").read_text(encoding="utf-8")
    _write_new(text if output is None else text.replace(f"{template}.toml", Path(output).name), output)
    return 0


def _of_paper(path: Path) -> str:
    """Return the equations of motion in a paper as a specification; what is wrong with it is a gap, too."""
    from symflex import pipeline
    from symflex.papers.motion import motion_specification
    from symflex.papers.source import read_paper

    text = motion_specification(read_paper(path), path.name)
    try:
        pipeline.loads(text, "model.toml")
    except SymflexError as error:
        gaps = "".join(f"# GAP: {d.message}\n" for d in error.diagnostics)
        return gaps + text
    return text


def _write_new(text: str, output: str | None) -> None:
    if output is None:
        say(text, nl=False)
        return
    if Path(output).exists():
        raise UsageError(
            Diagnostic("SF903", f"'{output}' exists and is not overwritten", None, "choose another name")
        )
    write(output, text, f"; try: symflex derive {output}, and read its comments")


MODEL_SIGNATURE = "model(spec, tf)"
MODEL_SUMMARY = "A transfer function of another specification"
MODEL_DOC = (
    "A transfer function of another specification. Its parameters are shared by name with those of the "
    "specification that uses it."
)
SIGNATURE_WIDTH = 30
DOMAIN_WORDS = {"any": "any domain", "plane": "in the plane", "whole": "planar or not"}


@click.command("elements")
@click.argument("name", required=False)
@click.option("--json", "as_json", is_flag=True, help="Print the library, or the entry NAME, as JSON.")
@reporting
def elements(name: str | None, *, as_json: bool) -> int:
    """List the elements and blocks of the library, or describe the entry NAME."""
    from symflex.library.blocks import BLOCKS, MODEL_BLOCK
    from symflex.library.elements import ELEMENTS
    from symflex.library.words import hint_of_type

    if name is not None and name not in (*ELEMENTS, *BLOCKS, MODEL_BLOCK):
        hint = hint_of_type(name, (*ELEMENTS, *BLOCKS, MODEL_BLOCK)) or "'symflex elements' lists them"
        raise refused(f"there is no element or block '{name[:64]}'", hint)
    elements = [e for e in ELEMENTS.values() if name in (None, e.type_name)]
    blocks = [b for b in BLOCKS.values() if name in (None, b.type_name)]
    if as_json:
        emit_json(
            {
                "schema": "symflex.elements/1",
                "elements": [_element_json(e) for e in elements],
                "blocks": [
                    {
                        "type": b.type_name,
                        "summary": b.summary,
                        "parameters": [_parameter_json(p) for p in b.parameters],
                    }
                    for b in blocks
                ],
            }
        )
    elif name is None:
        say("elements")
        for element in elements:
            say(_entry(_signature(element.type_name, _element_keys(element)), element.summary))
        say("blocks")
        for block in blocks:
            say(_entry(_signature(block.type_name, _block_keys(block)), block.summary))
        say(_entry(MODEL_SIGNATURE, MODEL_SUMMARY))
    elif elements:
        _describe(elements[0])
    elif blocks:
        _describe_block(blocks[0])
    else:
        say(MODEL_SIGNATURE)
        say(_paragraph(MODEL_DOC, "  ", "  "))
        say(_key("spec", "path of the other specification, relative to the one that names it"))
        say(_key("tf", "OUT/IN of that specification"))
    return 0


def _signature(name: str, keys: Sequence[str]) -> str:
    return f"{name}({', '.join(keys)})"


def _element_keys(element: Element) -> list[str]:
    """Return the keys of an element's table: those that must be given, then choices and options.

    Products in place of their factors, and what goes with one choice only, are left out.
    """
    every = [p for p in element.parameters if not (p.only or p.of)]
    required = [p.name for p in every if p.default is None]
    options = [p.name for p in every if p.default is not None]
    return [*(p.name for p in element.ports), *required, *(c.name for c in element.choices), *options]


def _block_keys(block: Block) -> list[str]:
    return [p.name for p in block.parameters]


def _entry(signature: str, summary: str) -> str:
    """Return a line of the library; what does not fit beside the signature stands below it."""
    first, margin = f"  {signature.ljust(SIGNATURE_WIDTH)}  ", " " * (SIGNATURE_WIDTH + 4)
    if len(signature) > SIGNATURE_WIDTH:
        lines = textwrap.wrap(signature, terminal_width(), initial_indent="  ", subsequent_indent=margin)
        first = "\n".join([*lines, margin])
    room = terminal_width() - len(margin)
    return first + f"\n{margin}".join(textwrap.wrap(summary, room, break_long_words=False))


def _describe(element: Element) -> None:
    signature = _signature(element.type_name, _element_keys(element))
    say(textwrap.fill(signature, terminal_width(), subsequent_indent="    "))
    say(_paragraph(" ".join((element.__doc__ or "").replace("``", "").split()), "  ", "  "))
    for port in element.ports:
        nodes = "node" if port.terminals == 1 else f"{port.terminals} nodes"
        default = f", default {', '.join(port.default)}" if port.default is not None else ""
        pair = f"; or {port.pair}, 2 nodes, with the reaction on the second" if port.pair else ""
        pair = "; or 2 nodes, with the reaction on the second" if port.reacts else pair
        words = DOMAIN_WORDS.get(port.domain, port.domain)
        say(_key(port.name, f"{nodes}, {words}: {port.doc}{default}{pair}"))
    for parameter in element.parameters:
        say(_parameter(parameter, f", only with {' or '.join(parameter.only)}" if parameter.only else ""))
    for choice in element.choices:
        words = ", ".join(f'"{v}"' + " (default)" * (v == choice.default) for v in choice.values)
        say(_key(choice.name, f"{choice.doc}: {'true or false (default)' if choice.is_flag else words}"))
    if element.through:
        say(_key("offers", ", ".join(f"name.{q}" for q in element.through)))


def _describe_block(block: Block) -> None:
    say(_signature(block.type_name, _block_keys(block)))
    say(_paragraph(block.summary, "  ", "    "))
    for parameter in block.parameters:
        say(_parameter(parameter))


def _parameter(parameter: ParameterPort, only: str = "") -> str:
    default = f", default {parameter.default}" if parameter.default is not None else ""
    default = f", in place of {'*'.join(parameter.of)}" if parameter.of else default
    unit = f" [{parameter.unit}]" if parameter.unit else ""
    return _key(parameter.name, f"{parameter.doc}{unit}{default}{only}")


def _key(name: str, text: str) -> str:
    return _paragraph(text.removeprefix("a ").removeprefix("an "), f"  {name:10} ", " " * 13)


def _paragraph(text: str, first: str, following: str) -> str:
    return textwrap.fill(
        text,
        terminal_width(),
        initial_indent=first,
        subsequent_indent=following,
        break_long_words=False,
        break_on_hyphens=False,
    )


def _element_json(element: Element) -> dict[str, object]:
    return {
        "type": element.type_name,
        "summary": element.summary,
        "ports": [
            {
                "name": p.name,
                "nodes": p.terminals,
                "domain": p.domain,
                "doc": p.doc,
                "default": None if p.default is None else list(p.default),
                "pair": p.pair or None,
            }
            for p in element.ports
        ],
        "parameters": [_parameter_json(p) | {"only": list(p.only)} for p in element.parameters],
        "choices": [
            {"name": c.name, "values": list(c.values), "default": c.default, "doc": c.doc}
            for c in element.choices
        ],
        "through": list(element.through),
    }


def _parameter_json(parameter: ParameterPort) -> dict[str, object]:
    return {
        "name": parameter.name,
        "unit": parameter.unit or None,
        "doc": parameter.doc,
        "default": parameter.default,
        **({"of": list(parameter.of)} if parameter.of else {}),
    }


LONGEST_FACTOR = 16  # characters of an exact factor beyond which it is said about how large it is


@click.command("units")
@click.argument("unit", required=False)
@click.option("--json", "as_json", is_flag=True, help="Print the units, or UNIT alone, as JSON.")
@reporting
def units(unit: str | None, *, as_json: bool) -> int:
    """List units and prefixes, or say what UNIT is, such as 'lbf*s/in'.

    Units can be multiplied, divided and raised to powers: 'N*m/A', 'kg*m^2', 'mm/rev'. Factors are exact.
    """
    from symflex.quantities.units import PLAIN_UNITS, PREFIXABLE_UNITS, PREFIXES

    units = {**PREFIXABLE_UNITS, **PLAIN_UNITS} if unit is None else {unit: _checked_unit(unit)}
    if as_json:
        rows = [
            {
                "unit": name,
                "factor": str(one.scale),
                "power_of_pi": one.pi_power,
                "si": str(one.dimension),
                "cycles": one.cycles,
                "radians": one.radians,
                "takes_prefix": name in PREFIXABLE_UNITS,
            }
            for name, one in units.items()
        ]
        prefixes = {name: str(factor) for name, factor in PREFIXES.items()} if unit is None else {}
        emit_json({"schema": "symflex.units/1", "units": rows, "prefixes": prefixes})
    elif unit is not None:
        say(f"{unit} = {in_si(units[unit])}")
    else:
        for title, table in (("with a prefix", PREFIXABLE_UNITS), ("without", PLAIN_UNITS)):
            say(title)
            say("\n".join(f"  {name:8} {in_si(one)}" for name, one in table.items()))
        say("prefixes")
        say(_paragraph(", ".join(f"{n} {_power(f)}" for n, f in PREFIXES.items()), "  ", "  "))
    return 0


def _checked_unit(text: str) -> Unit:
    from symflex.quantities import parse_unit

    try:
        return parse_unit(Text.alone("<unit>", text))
    except SpecError as problem:
        (wrong, *_) = problem.diagnostics
        raise refused(wrong.message, wrong.hint or "'symflex units' lists them") from None


def in_si(unit: Unit) -> str:
    """Return a unit in SI base units, exactly where that is short.

    >>> from symflex.quantities import unit_of
    >>> in_si(unit_of("in")), in_si(unit_of("deg")), in_si(unit_of("rpm")), in_si(unit_of("lbf"))
    ('0.0254 m', 'pi/180 rad', '1/60 cycle/s', '4.4482216152605 N')
    """
    above, below = unit.scale.numerator, unit.scale.denominator
    decimal = f"{Decimal(f'{float(unit.scale):.14g}'):f}"
    if unit.pi_power:
        factor = f"{'' if above == 1 else f'{above}*'}pi{'' if below == 1 else f'/{below}'}"
    else:
        factor = decimal if Fraction(decimal) == unit.scale else str(unit.scale)
    si = str(unit.dimension)
    for name, count in (("rad", unit.radians), ("cycle", unit.cycles)):
        power = name + ("" if abs(count) == 1 else f"^{abs(count)}")
        if count > 0:
            si = power if si == "1" else f"{power}/{si[2:]}" if si.startswith("1/") else f"{power}*{si}"
        elif count < 0:
            si = f"{si}/{power}"
    exactly = f"{factor} {si}".removesuffix(" 1")
    return (
        exactly
        if len(factor) <= LONGEST_FACTOR
        else f"{exactly}, about {Decimal(f'{float(unit.scale):.6g}'):f}"
    )


def _power(factor: Fraction) -> str:
    digits = max(factor.numerator, factor.denominator)
    return f"10^{'-' if factor < 1 else ''}{len(str(digits)) - 1}"


@click.command("schema")
@click.option("-o", "--output", type=click.Path(), help="File to write.  [default: standard output]")
@reporting
def schema(*, output: str | None) -> int:
    """Write the JSON Schema of specifications, for editors that complete and check TOML.

    Begin a specification with '#:schema symflex.schema.json', or tell your editor once for all files named
    *.symflex.toml. 'symflex check' reports what a schema cannot know, such as units and names.
    """
    import json

    from symflex.model.schema import json_schema

    text = json.dumps(json_schema(), indent=1, ensure_ascii=False) + "\n"
    if output is None:
        say(text, nl=False)
    else:
        write(output, text)
    return 0


@click.command("lsp")
@reporting
def lsp() -> int:
    """Serve problems, fixes, completion and formulas to an editor.

    An editor starts this command and speaks the Language Server Protocol with it. The page "Editors" of the
    documentation has the settings of VS Code, Neovim, Helix and Zed. It needs pip install 'symflex[editor]'.
    """
    from importlib.metadata import version

    from symflex.errors.optional import installed

    installed("pygls.lsp.server")
    from symflex.editor.server import language_server

    # The server closes what it reads and writes; the program still flushes its own.
    with os.fdopen(os.dup(0), "rb") as asked, os.fdopen(os.dup(1), "wb") as answered:
        language_server(version("symflex")).start_io(asked, answered)
    return 0
