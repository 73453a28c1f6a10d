"""What all commands share: errors and notes on stderr, JSON on stdout, exit codes."""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import wraps
from pathlib import Path
from typing import Final, ParamSpec, TextIO

import click

from symflex.cli.progress import hushed
from symflex.errors import Diagnostic, SymflexError, UsageError, refused
from symflex.errors.diagnostic import printable

P = ParamSpec("P")
SMALLER = "ask for fewer transfer functions, roots or points, or give parameters numbers in place of symbols"
LIBRARIES = ("numpy", "scipy", "matplotlib", "sympy", "mpmath", "pyuff")
"""What many commands need and some do not, such as those that run in a browser."""
PICTURES = (".pdf", ".pgf", ".svg", ".png")
LAYOUT = "\n\t" + "".join(map(chr, (0xA0, 0x1680, *range(0x2000, 0x200B), 0x202F, 0x205F, 0x3000)))
"""Ends of lines and blanks, which Python does not count as printable and terminals show."""


def reporting(command: Callable[P, int | None]) -> Callable[P, int]:
    """Turn a :class:`SymflexError` into its message on stderr and its exit code; a closed pipe has none."""

    @wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> int:
        try:
            return command(*args, **kwargs) or 0
        except SymflexError as error:
            show_error(error)
            return error.exit_code
        except MemoryError:
            show_error(SymflexError(Diagnostic("SF504", "out of memory", None, SMALLER)))
            return 5
        except ModuleNotFoundError as error:
            library = (error.name or "").partition(".")[0]
            if library not in LIBRARIES:
                raise
            said = f"this needs the library {library}, which is not installed here"
            show_error(UsageError(Diagnostic("SF902", said, None, f"pip install {library}")))
            return UsageError.exit_code
        except BrokenPipeError:
            # The reader of a pipe went away; nothing is left to tell it, neither now nor at exit.
            silence(sys.stdout)
            return 0
        except OSError as error:
            # What reads or writes a file reports it with its own code; this is all else a system can refuse.
            location = f"'{error.filename}': " if error.filename else ""
            said = f"the system refused an operation: {location}{error.strerror or error}"
            show_error(UsageError(Diagnostic("SF905", said)))
            return UsageError.exit_code

    return run


COLOUR_OF_WORD: Final = {
    **dict.fromkeys(("certified", "stable", "PASSIVE"), "green"),
    **dict.fromkeys(("NOT CERTIFIED", "not proved", "marginal"), "yellow"),
    **dict.fromkeys(("unstable", "ACTIVE", "not minimum phase"), "red"),
}
VERDICT: Final = re.compile(rf"\b(?:{'|'.join(sorted(COLOUR_OF_WORD, key=len, reverse=True))})\b")


def colours() -> bool:
    """Tell whether stderr is a terminal that may be coloured."""
    return sys.stderr.isatty() and "NO_COLOR" not in os.environ


def show_error(error: SymflexError) -> None:
    """Print every diagnostic to stderr."""
    show(error.diagnostics)


def show(diagnostics: Iterable[Diagnostic]) -> None:
    """Print errors in red and warnings in yellow to stderr."""
    for diagnostic in diagnostics:
        text = diagnostic.render()
        if colours():
            colour = "red" if diagnostic.severity == "error" else "yellow"
            text = text.replace(diagnostic.mark, click.style(diagnostic.mark, fg=colour, bold=True), 1)
        _print(text, err=True)


def check_place(name: str, endings: Iterable[str]) -> Path:
    """Return the path of a file; SF902 when it has none of some endings, SF903 when it cannot be written."""
    from symflex.files.write import check_writable

    path = Path(name)
    *others, last = endings
    if path.suffix.lower() not in (*others, last):
        listed_endings = f"{', '.join(others)} or {last}" if others else last
        raise refused(f"'{path.name}' must end in {listed_endings}")
    check_writable(path)
    return path


def keep(source: str | Path | None, output: object) -> None:
    """Refuse to write over the specification that is read: SF903."""
    if not (source and output and Path(source).is_file() and Path(str(output)).exists()):
        return
    if Path(source).samefile(str(output)):
        message = f"'{output}' is the specification that is read, and is not overwritten"
        raise UsageError(Diagnostic("SF903", message, None, "choose another name with -o"))


def say(text: str, *, nl: bool = True, err: bool = False) -> None:
    """Print a text, what could drive a terminal escaped; SF903 when standard output cannot be written."""
    _print(printable(text, LAYOUT), nl=nl, err=err)


def _print(text: str, *, nl: bool = True, err: bool = False) -> None:
    try:
        with hushed():
            click.echo(text, nl=nl, err=err)
    except BrokenPipeError:
        raise
    except OSError as error:
        silence(sys.stderr if err else sys.stdout)
        if not err:
            message = f"cannot write to standard output: {error.strerror or 'input/output error'}"
            raise UsageError(Diagnostic("SF903", message)) from None


def silence(stream: TextIO) -> None:
    """Let what a stream still holds, and cannot write, go nowhere, also when the interpreter ends."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
        stream.flush()


def note(message: str) -> None:
    """Print a line to stderr."""
    say(message, err=True)


def write(name: str | Path, content: str | bytes, said: str = "") -> None:
    """Write a file and say so, with what else is to be said."""
    from symflex.files.write import write_atomically  # most commands print

    write_atomically(Path(name), content.encode() if isinstance(content, str) else content)
    note(f"wrote {name}{said}")


def emit_json(document: Mapping[str, object]) -> None:
    """Print a document as JSON to stdout; what could drive a terminal is escaped."""
    text = json.dumps(document, indent=2, ensure_ascii=False)
    _print("".join(c if c.isprintable() or c == "\n" else json.dumps(c)[1:-1] for c in text))


def answer(is_json: bool, document: Callable[[], Mapping[str, object]], text: Callable[[], str]) -> None:
    """Print a result as JSON or as a text; the other one is not made."""
    if is_json:
        emit_json(document())
    else:
        say_coloured(text())


def say_coloured(text: str) -> None:
    """Print a text whose verdicts are in colour on a terminal."""
    if sys.stdout.isatty() and "NO_COLOR" not in os.environ:
        _print(coloured(printable(text, LAYOUT)))
    else:
        say(text)


def coloured(text: str) -> str:
    """Return a text with the words of verdicts in colour: what is proved, what is not, what is wrong."""
    return VERDICT.sub(lambda found: click.style(found[0], fg=COLOUR_OF_WORD[found[0]], bold=True), text)


def diagnostic_json(diagnostic: Diagnostic) -> dict[str, object]:
    """Return a diagnostic as JSON data."""
    span = diagnostic.span
    return {
        "code": diagnostic.code,
        "message": diagnostic.message,
        "file": span.origin.source.name if span else None,
        "line": span.line if span else None,
        "column": span.column if span else None,
        "end_line": span.end_line if span else None,
        "end_column": span.end_column if span else None,
        "hint": diagnostic.hint,
    }


def terminal_width() -> int:
    """Return the columns to use: the terminal's, at most 120, and 80 when there is none."""
    if not sys.stdout.isatty():
        return 80
    return max(40, min(120, os.get_terminal_size(sys.stdout.fileno()).columns))


def listed(title: str, items: Sequence[str], separator: str = ", ", indent: str = "  ") -> str:
    """Return a title and items in lines that fit the terminal, broken between items only."""
    width, lines = terminal_width(), [indent + title]
    for i, item in enumerate(items):
        piece = item + (separator if i < len(items) - 1 else "")
        if len(lines[-1]) + len(piece.rstrip()) > width and lines[-1].strip():
            lines.append(2 * indent)
        lines[-1] += piece
    return "\n".join(line.rstrip() for line in lines)
