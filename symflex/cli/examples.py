"""``symflex examples``: the models that come with the program, listed and copied."""

from __future__ import annotations

import filecmp
import os
import textwrap
import tomllib
from pathlib import Path

import click

from symflex.cli.reporting import emit_json, note, reporting, say, terminal_width
from symflex.errors import Diagnostic, UsageError
from symflex.files.examples import FOLDERS, find_example, title_of
from symflex.files.examples import examples as every_example


class _Examples(click.Group):
    """The list, and what is done with an entry."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Say how an example is copied when its name stands where ``copy`` is expected."""
        if args[0] not in self.commands and not args[0].startswith("-"):
            ctx.fail(f"No such command '{args[0]}'. An example is copied by: symflex examples copy NAME")
        return super().resolve_command(ctx, args)


@click.group(
    "examples", cls=_Examples, invoke_without_command=True, subcommand_metavar="[copy NAME [FOLDER]]"
)
@click.option("--json", "as_json", is_flag=True, help="Print the list as JSON.")
@click.pass_context
@reporting
def examples(context: click.Context, *, as_json: bool) -> int:
    """List the example models that come with symflex, or copy one.

    The list has folders, and below each the models in it. Both are examples: 'symflex report NAME' writes a
    report on either, without a copy.
    """
    if context.invoked_subcommand is not None:
        return 0
    examples = every_example()
    if as_json:
        rows = [
            {
                "name": name,
                "kind": "folder" if name in FOLDERS else "model",
                "title": title_of(name, path),
                "path": str(path),
            }
            for name, path in examples.items()
        ]
        emit_json({"schema": "symflex.examples/1", "examples": rows})
        return 0
    for name, path in examples.items():
        width = max(len(p.stem) for p in examples.values() if p.parent in (path, path.parent))
        head = f"{name.ljust(width + 2)}  " if name in FOLDERS else f"  {path.stem.ljust(width)}  "
        said = textwrap.fill(head + title_of(name, path), terminal_width(), subsequent_indent=" " * len(head))
        say(said)
    return 0


@examples.command("copy")
@click.argument("name")
@click.argument("folder", required=False, type=click.Path())
@reporting
def copy(name: str, folder: str | None) -> int:
    """Copy the example NAME into FOLDER.

    NAME is a folder or a model of the list, such as eppinger1988, eppinger1988/two_mass or two_mass. A folder
    is copied with everything in it, by default into a folder of its name. A model is copied with the models
    and data that it needs, by default into the current folder. FOLDER is created if it does not exist, and no
    existing file is overwritten unless it is the same.
    """
    from symflex.files.write import write_tree  # a list writes nothing

    path = find_example(name)
    target = Path(folder or (path.name if path.is_dir() else "."))
    files = _all_in(path) if path.is_dir() else _needed_by(path)
    for inside, file in files.items():
        there = target / inside
        if os.path.lexists(there) and not (there.is_file() and filecmp.cmp(there, file, shallow=False)):
            message, hint = f"'{there}' exists and is not overwritten", "name another FOLDER"
            raise UsageError(Diagnostic("SF903", message, None, hint))
    write_tree(target, {inside: file.read_bytes() for inside, file in files.items()})
    first = target if path.is_dir() else target / path.name
    tries = "report" if path.is_dir() else "derive"
    others = f" and what it needs: {', '.join(list(files)[1:])}" if len(files) > 1 else ""
    others = f", {len(files)} files" if path.is_dir() else others
    note(f"wrote {first}{others}; try: symflex {tries} {first}")
    return 0


def _all_in(folder: Path) -> dict[str, Path]:
    """Return the files of a folder and below, by their places in it."""
    files = sorted(p for p in folder.rglob("*") if p.is_file() and not p.name.startswith("."))
    return {p.relative_to(folder).as_posix(): p for p in files}


def _needed_by(model: Path) -> dict[str, Path]:
    """Return a model, the models in its blocks, and the data that its figures show, by place."""
    from symflex.model.spec import parse, read  # a list parses nothing

    folder, waiting = model.parent, [model.name]
    needed: dict[str, Path] = {}
    while waiting:
        name = waiting.pop()
        if name not in needed:
            needed[name] = folder / name
            source = read(needed[name])
            parse(source)  # says what is wrong where somebody has changed the file
            nested, shows_data = _reads(tomllib.loads(source.text))
            waiting += nested
            if shows_data:
                needed |= {
                    n: p for n, p in _all_in(folder).items() if p.suffix not in (".toml", ".md", ".tex")
                }
    return needed


def _reads(value: object) -> tuple[list[str], bool]:
    """Return the specifications that tables name, and whether one of them shows measured data."""
    match value:
        case {"type": "model", "spec": str(spec)}:
            return [spec], False
        case {"data": True}:
            return [], True
        case dict():
            inside = [_reads(v) for v in value.values()]
            return [name for names, _ in inside for name in names], any(data for _, data in inside)
        case _:
            return [], False
