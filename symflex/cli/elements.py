"""``symflex elements``."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

import click

from symflex.cli.report import emit_json, reporting
from symflex.errors import Diagnostic, UsageError
from symflex.errors.diagnostic import nearest

if TYPE_CHECKING:
    from symflex.blocks import Block
    from symflex.elements import Element


@click.command("elements")
@click.argument("name", required=False)
@click.option("--json", "as_json", is_flag=True, help="Print the library as JSON.")
@reporting
def command(name: str | None, *, as_json: bool) -> int:
    """List the element and block library, or describe one entry NAME."""
    from symflex.blocks import BLOCKS
    from symflex.elements import ELEMENTS

    if as_json:
        emit_json(
            {
                "schema": "symflex.elements/1",
                "elements": [_element_json(e) for e in ELEMENTS.values()],
                "blocks": [_block_json(b) for b in BLOCKS.values()],
            }
        )
        return 0
    if name is None:
        click.echo("elements")
        for element in ELEMENTS.values():
            click.echo(f"  {_signature(element)}")
        click.echo("blocks")
        for block in BLOCKS.values():
            click.echo(f"  {block.type_name}({', '.join(p.name for p in block.parameters)})")
        click.echo("  model(spec, tf)")
        return 0
    if name in ELEMENTS:
        _describe(ELEMENTS[name])
    elif name in BLOCKS:
        _describe_block(BLOCKS[name])
    else:
        known = [*ELEMENTS, *BLOCKS]
        hint = nearest(name, known) or "symflex elements lists them"
        raise UsageError(Diagnostic("SF902", f"there is no element or block '{name[:64]}'", None, hint))
    return 0


def _signature(element: Element) -> str:
    names = [p.name for p in element.ports] + [p.name for p in element.parameters]
    return f"{element.type_name}({', '.join(names)})"


def _describe(element: Element) -> None:
    click.echo(_signature(element))
    click.echo(textwrap.indent(textwrap.fill(_plain(element.__doc__), 76), "  "))
    for port in element.ports:
        nodes = "node" if port.terminals == 1 else f"{port.terminals} nodes"
        click.echo(f"  {port.name:10} {nodes}, {port.domain}: {port.doc}")
    for parameter in element.parameters:
        default = f", default {parameter.default}" if parameter.default is not None else ""
        unit = f" [{parameter.unit}]" if parameter.unit else ""
        click.echo(f"  {parameter.name:10} {parameter.doc}{unit}{default}")
    if element.through:
        click.echo("  offers     " + ", ".join(f"name.{q}" for q in element.through))


def _describe_block(block: Block) -> None:
    click.echo(f"{block.type_name}: {block.summary}")
    for parameter in block.parameters:
        default = f", default {parameter.default}" if parameter.default is not None else ""
        unit = f" [{parameter.unit}]" if parameter.unit else ""
        click.echo(f"  {parameter.name:10} {parameter.doc}{unit}{default}")


def _plain(doc: str | None) -> str:
    return " ".join((doc or "").replace("``", "").split())


def _element_json(element: Element) -> dict[str, object]:
    return {
        "type": element.type_name,
        "summary": element.summary,
        "ports": [{"name": p.name, "nodes": p.terminals, "domain": p.domain} for p in element.ports],
        "parameters": [
            {"name": p.name, "unit": p.unit, "doc": p.doc, "default": p.default} for p in element.parameters
        ],
        "through": list(element.through),
    }


def _block_json(block: Block) -> dict[str, object]:
    return {
        "type": block.type_name,
        "summary": block.summary,
        "parameters": [
            {"name": p.name, "unit": p.unit, "doc": p.doc, "default": p.default} for p in block.parameters
        ],
    }
