"""Tables of elements, blocks, commands and units in the pages, and formulas, made by the program.

A table stands between two comments, each on a line of its own, ``<!-- reference: elements -->`` and
``<!-- end of reference -->``. ``python -m tests.docs.update`` writes it, and a test compares.
"""

from __future__ import annotations

import inspect
import re
import textwrap
from typing import TYPE_CHECKING

import click

import symflex
from symflex.cli import COMMANDS, GROUPS, group
from symflex.cli.library import in_si
from symflex.errors import Text
from symflex.expressions import parse_equation
from symflex.library.blocks import BLOCKS
from symflex.library.elements import ELEMENTS
from symflex.library.words import THINGS
from symflex.print.latex.expression import Writer
from symflex.quantities.units import PLAIN_UNITS, PREFIXABLE_UNITS, PREFIXES
from tests.house.repository import ROOT

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from symflex.library.blocks import Block
    from symflex.library.elements import Choice, Element, ParameterPort, Port

END = "<!-- end of reference -->"
PLACE = re.compile(rf"^(<!-- reference: (\w+)(?: (\w+))? -->)$.*?^{END}$", re.MULTILINE | re.DOTALL)


FORMULA_END = "<!-- end of formula -->"
TITLED = re.compile(r'^```toml title="([\w.]+)"\n(.*?)^```$', re.MULTILINE | re.DOTALL)
FORMULA = re.compile(rf"^(<!-- (formula|equation): (.+) -->)$.*?^{FORMULA_END}$", re.MULTILINE | re.DOTALL)


def with_tables(markdown: str) -> str:
    """Return a page with its tables and formulas as the program makes them now."""
    markdown = PLACE.sub(lambda match: f"{match[1]}\n\n{_part(match[2], match[3])}\n\n{END}", markdown)
    titled = {block[1]: block[2] for block in TITLED.finditer(markdown)}

    def latex(match: re.Match[str]) -> str:
        return _equation(match[3]) if match[2] == "equation" else _formula(titled, *match[3].split())

    return FORMULA.sub(lambda match: f"{match[1]}\n```math\n{latex(match)}\n```\n{FORMULA_END}", markdown)


def _part(what: str, name: str | None) -> str:
    return command(name) if name else PARTS[what]()


def _formula(titled: Mapping[str, str], path: str, pair: str) -> str:
    output, source = pair.split("/")
    model = symflex.loads(titled[path]) if path in titled else symflex.load(ROOT / path)
    return model.transfer_function(output, source).latex()


def _equation(text: str) -> str:
    equation = parse_equation(Text.alone("a page", text))
    writer = Writer({})
    return f"{writer.piece(equation.left).markup} = {writer.piece(equation.right).markup}"


def elements() -> str:
    """Return one section per element, in the registry's order."""
    return "\n\n".join(_element(name, element) for name, element in ELEMENTS.items())


def blocks() -> str:
    """Return one section per block, in the registry's order."""
    return "\n\n".join(_block(name, block) for name, block in BLOCKS.items())


def things() -> str:
    """Return what engineers call things, and what these are here."""
    rows = [
        (", ".join(w.replace("_", " ") for w in t.words), f"`{t.use}`" * bool(t.use), _escaped(t.how))
        for t in THINGS
    ]
    return _table(rows, ("you have", "write", "how"))


def command(name: str) -> str:
    """Return the help of a command."""
    with group.make_context("symflex", [], resilient_parsing=True) as context:
        found = group.get_command(context, name)
        assert found is not None, name
        return _command(name, found, context, "")


def commands() -> str:
    """Return a table of all commands, in the groups of ``symflex --help``."""
    rows: list[tuple[str, ...]] = []
    for title, names in GROUPS.items():
        rows.append((f"**{title}**", ""))
        rows += [(f"[`{name}`](commands/{name}.md)", COMMANDS[name][1]) for name in names.split()]
    return _table(rows, ("command", "what it does"))


def units() -> str:
    """Return the symbols of units and prefixes."""
    rows = [
        ("with a prefix", list(PREFIXABLE_UNITS)),
        ("without", list(PLAIN_UNITS)),
        ("prefixes", list(PREFIXES)),
    ]
    lines = [f"| {what} | {' '.join(f'`{name}`' for name in names)} |" for what, names in rows]
    factors = [f"| `{name}` | {in_si(unit)} |" for name, unit in PLAIN_UNITS.items()]
    return "\n".join(
        ["| | symbols |", "|---|---|", *lines, "", "| unit | in SI |", "|---|---|", *factors]
    ).replace("*", r"\*")


def _element(name: str, element: Element) -> str:
    rows = [
        *map(_port_row, element.ports),
        *map(_element_parameter_row, element.parameters),
        *map(_choice_row, element.choices),
    ]
    about = " ".join((element.__doc__ or "").replace("``", "`").split())
    return "\n\n".join([f"### `{name}`", _escaped(about), _keys(rows)])


def _keys(rows: Iterable[tuple[str, ...]]) -> str:
    """Return a line for every key: its value or unit, what it means, its default."""
    lines = []
    for key, value, meaning, default in rows:
        end = {"required": ""}.get(default, f"; {'' if 'place' in default else 'default '}{default}")
        lines.append(f"- {key}, {value}: {_escaped(meaning)}{end}")
    return "\n".join(lines)


def _escaped(text: str) -> str:
    """Keep the stars of formulas outside code from being read as emphasis."""
    parts = text.split("`")
    return "`".join(part if i % 2 else part.replace("*", r"\*") for i, part in enumerate(parts))


def _block(name: str, block: Block) -> str:
    return "\n\n".join([f"### `{name}`", f"`{block.summary}`", _keys(map(_parameter_row, block.parameters))])


def _command(name: str, command: click.Command, parent: click.Context, heading: str) -> str:
    context = click.Context(command, info_name=name, parent=parent)
    usage = command.get_usage(context).removeprefix("Usage: ")
    formatter, epilog = context.make_formatter(), context.make_formatter()
    command.format_options(context, formatter)
    command.format_epilog(context, epilog)
    own, _, common = formatter.getvalue().partition("Common options:\n")
    options = textwrap.dedent(own.removeprefix("Options:\n")) + epilog.getvalue()
    names = ", ".join(f"`{name}`" for name in re.findall(r"^  (?:-\w, )?(--[\w-]+)", common, re.MULTILINE))
    about = inspect.cleandoc(command.help or "").replace("\b\n", "")
    inside = command.commands.items() if isinstance(command, click.Group) else ()
    parts = [_command(f"{name} {inner}", one, parent, f"## symflex {name} {inner}") for inner, one in inside]
    shared = [f"[Common options](../command-line.md#common-options): {names}."] if names else []
    found = [heading, _text(usage), about, _text(options) if options.strip() else "", *shared, *parts]
    return "\n\n".join(part for part in found if part)


def _text(content: str) -> str:
    return f"```text\n{content.rstrip()}\n```"


def _table(rows: Iterable[tuple[str, ...]], head: tuple[str, ...]) -> str:
    return "\n".join(f"| {' | '.join(row)} |" for row in [head, ("---",) * len(head), *rows])


def _port_row(port: Port) -> tuple[str, ...]:
    count = "node" if port.terminals == 1 else f"{port.terminals} nodes"
    count += ", or two" * port.reacts
    default = "required" if port.default is None else ", ".join(f"`{node}`" for node in port.default)
    return f"`{port.name}`", f"{count} ({port.domain})", port.doc, default


def _parameter_row(parameter: ParameterPort) -> tuple[str, ...]:
    unit = f"`{parameter.unit}`" if parameter.unit else "inferred"
    default = "required" if parameter.default is None else f"`{parameter.default}`"
    default = f"in place of `{'*'.join(parameter.of)}`" if parameter.of else default
    return f"`{parameter.name}`", unit, _bare(parameter.doc), default


def _element_parameter_row(parameter: ParameterPort) -> tuple[str, ...]:
    name, unit, doc, default = _parameter_row(parameter)
    only = f" (only with {' or '.join(parameter.only)})" if parameter.only else ""
    return name, unit, doc + only, default


def _bare(doc: str) -> str:
    return doc.removeprefix("a ").removeprefix("an ")


def _choice_row(choice: Choice) -> tuple[str, ...]:
    if choice.is_flag:
        return f"`{choice.name}`", "`true`, `false`", _bare(choice.doc), "`false`"
    words = ", ".join(f'`"{value}"`' for value in choice.values)
    return f"`{choice.name}`", words, _bare(choice.doc), f'`"{choice.default}"`'


PARTS: dict[str, Callable[[], str]] = {
    "elements": elements,
    "blocks": blocks,
    "things": things,
    "commands": commands,
    "units": units,
}
