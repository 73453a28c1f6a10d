"""A command made of a function and a dataclass of :mod:`symflex.options`.

    symflex rational SPEC --modes 3 --set K=2

calls the function below ``@command_of("rational", RationalOptions)`` with
``Specification("SPEC", (), {"K": "2"})`` and ``RationalOptions(modes=3)``.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import Field, dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Protocol, TypeVar

import click

from symflex.cli.budgeting import budgeted
from symflex.cli.reporting import keep, note, reporting
from symflex.errors import refused
from symflex.errors.diagnostic import counted
from symflex.options import OUTSIDE, option

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from symflex.errors import Source
    from symflex.model import Model
    from symflex.transfer import AnyBoundFunction

T = TypeVar("T")


class Ends(Protocol):
    """Options that name the columns and rows of a matrix."""

    @property
    def inputs(self) -> str:
        """Names of inputs, between commas."""

    @property
    def outputs(self) -> str:
        """Names of outputs, between commas."""


class Rows(Ends, Protocol):
    """Options of one transfer function or of a matrix."""

    @property
    def tf(self) -> str | None:
        """The transfer function."""

    @property
    def is_matrix(self) -> bool:
        """Whether all are asked for."""


@dataclass(frozen=True, eq=False, repr=False)
class _Setting:
    """The values that stand in place of declared ones, and where else files are read; last in the help."""

    settings: tuple[str, ...] = option(
        (),
        "--set",
        multiple=True,
        metavar="NAME=VALUE",
        help="Change a parameter: k='80 kN/m', or a number in SI units; may be repeated.",
    )
    allow_outside: tuple[str, ...] = option((), "--allow-outside", **OUTSIDE)


@dataclass(frozen=True)
class Specification:
    """Which file a command reads, and with which values."""

    path: str  # the file
    allow_outside: tuple[str, ...]  # folders that its ``model`` blocks may read besides its own
    settings: Mapping[str, str]  # other values of parameters

    def source(self) -> Source:
        """Return the text of the specification."""
        from symflex.model.spec import read

        return read(Path(self.path))

    def load_changed(self, source: Source) -> Model:
        """Return the model of another text in its place."""
        from symflex.model import load_with

        return load_with(source, self.settings, allow_outside=self.allow_outside)

    def load(self) -> Model:
        """Read the specification; how many warnings it has is the last that the command prints."""
        from symflex import pipeline

        model = pipeline.load(self.path, self.allow_outside, self.settings)
        if count := len(pipeline.warnings(model)):
            said = f"{counted(count, 'warning')}: symflex check {self.path}"
            click.get_current_context().call_on_close(lambda: note(said))
        return model


@dataclass(frozen=True, eq=False, repr=False)
class _Watching:
    """Whether a command runs once."""

    watch: bool = option(False, "--watch", help="Run again whenever the file is saved.")


COMMON: Final = frozenset("--json --set --allow-outside --budget --memory --help".split())  # to many commands


class Command(click.Command):
    """A command with each option once; its help lists those of nearly every command last."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Read the arguments; a value that a later one would replace without a word is refused."""
        given = Counter(self.make_parser(ctx).parse_args([*args])[2])
        for one, times in given.items():
            is_one = isinstance(one, click.Option) and not (one.multiple or one.is_flag)
            if times > 1 and is_one and not ctx.resilient_parsing:
                message = f"'{one.opts[0]}' is given {times} times: give it once"
                raise click.BadOptionUsage(one.opts[0], message, ctx)
        return super().parse_args(ctx, args)

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the options of this command, then the common ones."""
        for title, is_common in (("Options", False), ("Common options", True)):
            options = (p for p in self.get_params(ctx) if isinstance(p, click.Option))
            chosen = (p for p in options if is_common is not COMMON.isdisjoint(p.opts))
            if rows := [row for p in chosen if (row := p.get_help_record(ctx))]:
                with formatter.section(title):
                    formatter.write_dl(rows)


def command_of(
    name: str, options: type[T], cls: type[click.Command] = Command, *, watches: bool = False
) -> Callable[[Callable[[Specification, T], int | None]], click.Command]:
    """Make a command of a function of a specification and options; one that ``watches`` has ``--watch``."""

    def made(run: Callable[[Specification, T], int | None]) -> click.Command:
        def called(
            spec: str, allow_outside: tuple[str, ...], settings: tuple[str, ...], **given: object
        ) -> int:
            from symflex.model import read_settings  # a command's help needs none of it

            keep(spec, given.get("output"))
            is_watched = given.pop("watch", False)

            def once() -> int:
                return run(Specification(spec, allow_outside, read_settings(settings)), options(**given)) or 0

            if not is_watched:
                return once()
            from symflex.cli.watching import watched  # few ask for it

            return watched(spec, reporting(once))

        called.__doc__ = run.__doc__
        faced = budgeted(with_parameters(_Setting, reporting(called)))
        if watches:
            faced = with_parameters(_Watching, faced)
        asked = click.argument("spec", type=click.Path())(with_parameters(options, faced))
        return click.command(name, cls=cls)(asked)

    return made


def bare_command(name: str, options: type[T]) -> Callable[[Callable[[T], int]], click.Command]:
    """Make a command of a function of options alone, among which is what it reads."""

    def made(run: Callable[[T], int]) -> click.Command:
        def called(**given: object) -> int:
            return run(options(**given))

        called.__doc__ = run.__doc__
        return click.command(name, cls=Command)(with_parameters(options, budgeted(reporting(called))))

    return made


def with_parameters(options: type, run: Callable[..., int]) -> Callable[..., int]:
    """Give a function the parameters that the fields of a dataclass stand for, in their order."""
    for one in reversed(fields(options)):
        run = _parameter(one)(run)
    return run


def _parameter(one: Field[Any]) -> Callable[[Callable[..., int]], Callable[..., int]]:
    said = dict(one.metadata)
    flags = said.pop("flags")
    if one.default is False:
        said["is_flag"] = True
    if "choices" in said:
        said["type"] = click.Choice(said.pop("choices"))
    elif "least" in said:
        is_real = said.get("type") is float
        said.setdefault("metavar", "X" if is_real else "D" if "--digits" in flags else "N")
        kind = (click.FloatRange if is_real else click.IntRange)(said.pop("least"), said.pop("most", None))
        kind.name = "number" if is_real else "whole number"
        said["type"] = kind
    elif said.pop("is_path", False):
        said["type"] = click.Path()
    elif said.pop("is_folder", False):
        said["type"] = click.Path(exists=True, file_okay=False)
    if not flags:
        return click.argument(one.name, **said)
    if not said.get("required"):
        said["default"] = one.default
    return click.option(*flags, one.name, shell_complete=_completed, **said)


def _completed(context: click.Context, parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    from symflex.cli.completion import completed  # only the tab key needs it

    return completed(context, parameter, incomplete)


def names_in(text: str) -> list[str]:
    """Return the names in a text with commas."""
    return [name for part in text.split(",") if (name := part.strip())]


def first_pair(model: Model, tf: str | None, doing: str) -> tuple[str, str]:
    """Return the transfer function that is named, or the first one, and then say which others there are."""
    from symflex import pipeline

    pairs = pipeline.pick_pairs(model, [tf] if tf else [])
    if tf is None and len(pairs) > 1:
        others = ", ".join("/".join(pair) for pair in pairs[1:])
        note(f"{doing} {'/'.join(pairs[0])}; choose with --tf: {others}")
    return pairs[0]


def refuse_ends(given: Ends) -> None:
    """Refuse names of inputs and outputs without the matrix whose rows and columns they choose."""
    if given.inputs or given.outputs:
        raise refused("--in and --out choose the columns and rows of a matrix", "add --matrix, or name --tf")


def bound_rows(model: Model, given: Rows) -> tuple[tuple[AnyBoundFunction, ...], ...]:
    """Return the functions asked for with numbers, a row per output; the first pair without ``--matrix``."""
    from symflex import pipeline

    if not given.is_matrix:
        refuse_ends(given)
        pair = first_pair(model, given.tf, "showing")
        return (tuple(pipeline.derive_for_roots(model, [pair], is_explained=True)),)
    from symflex.matrices.transfer_matrix import picked

    if given.tf:
        raise refused("--tf names a single function", "choose rows and columns with --out and --in")
    outputs, inputs = names_in(given.outputs), names_in(given.inputs)
    rows = picked("output", outputs, [o.name for o in model.outputs])
    columns = picked("input", inputs, [i.name for i in model.inputs])
    every = pipeline.derive_for_roots(
        model, [(row, column) for row in rows for column in columns], is_explained=True
    )
    return tuple(tuple(every[i : i + len(columns)]) for i in range(0, len(every), len(columns)))
