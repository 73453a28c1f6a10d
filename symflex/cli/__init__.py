"""The command line. A command is imported when it runs, so that ``--help`` starts at once."""

from __future__ import annotations

import gc
import os
import signal
import sys
import warnings
from importlib import import_module
from io import StringIO, TextIOWrapper
from pathlib import Path
from types import FrameType

import click

BUDGET_EXCEEDED, STOPPED = 5, 130  # exit codes
YOUNG_OBJECTS = 100_000  # made between looks for cycles, some 20 MB; Python's 700 are few: a start keeps all
WATCHED = "watched"  # what the context holds of a command line that was started as a program

COMMANDS: dict[str, tuple[str, str]] = {
    "check": ("formulas", "Check a specification and report every problem at once."),
    "derive": ("formulas", "Print transfer functions in closed form."),
    "roots": ("analyses", "Print poles and zeros with certified enclosures."),
    "rational": ("analyses", "Print rational approximations, and up to which frequency they are valid."),
    "respond": ("respond", "Print the response to a step, an impulse or a ramp, with rigorous bounds."),
    "shape": ("respond", "Print an input shaper: impulses that leave no vibration."),
    "sweep": ("analyses", "Solve a model at many values of its parameters."),
    "stability": ("analyses", "Print the values of a gain, or any parameter, for which a model is stable."),
    "contact": ("analyses", "Print whether a model is stable with what touches it."),
    "peak": ("respond", "Print the largest magnitude over all frequencies."),
    "passivity": ("passivity", "Print whether a machine is passive where it is touched."),
    "colocation": ("analyses", "Print the frequency up to which two outputs move together."),
    "draw": ("plot", "Draw the model as a textbook would."),
    "plot": ("plot", "Draw a Bode plot, a pole-zero plot, mode shapes, a root locus or a Nyquist plot."),
    "live": ("live", "Write a page with a slider for every parameter."),
    "export": ("formulas", "Write numeric code, LaTeX, or a model for another program."),
    "audit": ("formulas", "Compare printed formulas with derived ones."),
    "referee": ("report", "Judge the formulas of a paper in LaTeX by models."),
    "fit": ("measured", "Fit resonances to measured frequency responses."),
    "measure": ("measured", "Write the frequency response of a time record or of a model."),
    "report": ("report", "Write a report: a page, a PDF, figures, code, data."),
    "new": ("library", "Write a specification to start from."),
    "examples": ("examples", "List the example models that come with symflex, or copy one."),
    "elements": ("library", "List the element and block library."),
    "units": ("library", "List the units and prefixes that quantities may have."),
    "schema": ("library", "Write the JSON Schema of specifications, for editors."),
    "lsp": ("library", "Serve problems, fixes, completion and formulas to an editor."),
}  # the module of each, in which its function has its name, and what it does
GROUPS = {  # how the help lists them
    "Begin": "new examples elements units schema lsp",
    "Model": "check derive draw",
    "Analyse": "roots rational respond shape sweep stability passivity contact peak colocation",
    "Draw and export": "plot live export report",
    "Papers and measurements": "audit referee fit measure",
}


MEANT = {  # what one command is called elsewhere, and what to write here
    **dict.fromkeys(("pole", "poles", "zeros", "eigenvalues", "frequencies"), "roots SPEC"),
    **dict.fromkeys(("simulate", "ramp", "response", "time"), "respond SPEC"),
    **dict.fromkeys(("norm", "hinf", "hinfnorm", "h2"), "peak SPEC"),
    **dict.fromkeys(("margin", "margins", "stable", "gain"), "stability SPEC --gain K"),
    **dict.fromkeys(("passive", "impedance", "admittance"), "passivity SPEC --port PORT"),
    **dict.fromkeys(("touch", "environment", "wall"), 'contact SPEC --port PORT --environment "k_e + b_e*s"'),
    **dict.fromkeys(("tf", "formula", "print", "show", "explain"), "derive SPEC"),
    **dict.fromkeys(("latex", "tex", "numpy", "c", "matlab", "python"), "export SPEC --to TARGET"),
    **dict.fromkeys(("slider", "sliders", "interactive", "html"), "live SPEC"),
    **dict.fromkeys(("help", "commands"), "--help"),
}
SPELLINGS = {"init": "new"}
"""Other names that commands answer to."""

NO_CACHE = "--no-cache"
GONE = "symflex no longer caches derivations on disk: leave this option out."
"""The hint for NO_CACHE and the command ``cache``, which earlier versions had."""


class LazyGroup(click.Group):
    """A group whose commands are imported when they run."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the command names in the order of a session."""
        del ctx
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import and return a command."""
        del ctx
        name = SPELLINGS.get(cmd_name, cmd_name)
        if name not in COMMANDS:
            return None
        module, _ = COMMANDS[name]
        command: click.Command = getattr(import_module(f"symflex.cli.{module}"), name)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands without importing them."""
        del ctx
        for title, names in GROUPS.items():
            with formatter.section(title):
                formatter.write_dl([(name, COMMANDS[name][1]) for name in names.split()])

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Name the nearest command when there is none of that name."""
        name = args[0]
        if name not in {*COMMANDS, *SPELLINGS} and not name.startswith("-"):
            from symflex.errors.diagnostic import nearest  # most commands go well
            from symflex.model.analysis import FIGURE_KINDS

            if name == "cache":
                hint: str | None = GONE
            elif name in FIGURE_KINDS:
                hint = f"a figure is drawn by: symflex plot SPEC {name}"
            elif name in MEANT:
                hint = f"write: symflex {MEANT[name]}"
            elif name.endswith(".toml"):
                hint = f"the command comes first: symflex derive {name}"
            else:
                hint = nearest(name, COMMANDS)
            ctx.fail(f"No such command '{name}'." + (f" {hint[0].upper()}{hint[1:]}" if hint else ""))
        return super().resolve_command(ctx, args)


@click.group(
    cls=LazyGroup,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog="Exit codes: 0 ok, 1 a bug in symflex, 2 usage, 3 invalid specification or data, 4 not certified, "
    "5 budget exceeded.",
)
@click.version_option(package_name="symflex", prog_name="symflex")
def group() -> None:
    """Derive closed-form transfer functions of flexible electromechanical systems.

    A model is one TOML file. You get its formulas, certified poles and zeros, figures, and code.
    """


def main(arguments: list[str] | None = None) -> None:
    """Run the command line and exit with the documented code."""
    # The matrices of a fit are small: threads that wait for each other cost more than they compute.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    gc.set_threshold(YOUNG_OBJECTS)
    if not sys.warnoptions:
        warnings.simplefilter("ignore")  # of libraries; those of models are diagnostics
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed by who started the program
            setattr(sys, name, Path(os.devnull).open("w", encoding="utf-8"))
    for stream in (sys.stdout, sys.stderr):
        # A unit such as µm must not stop a command where the terminal's encoding lacks the character.
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    before = signal.getsignal(signal.SIGINT)
    if before is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, _interrupt)
    code = run(arguments, is_program=True)
    if code != STOPPED:
        signal.signal(signal.SIGINT, before)
    try:
        sys.stdout.flush()
        sys.stderr.flush()
    except OSError as problem:
        code = _unwritable(problem)
    gc.freeze()  # what modules hold need not be searched for cycles once more at the end
    if code in (BUDGET_EXCEEDED, STOPPED):
        # Taking a large computation apart piece by piece would take time that is over. And Python ends by a
        # signal, without this code, if Ctrl-C has met it within 'exec'.
        os._exit(code)
    sys.exit(code)


def _interrupt(_: int, frame: FrameType | None) -> None:
    """Stop, once: the terminal and the process that watches may both send Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    raise KeyboardInterrupt


def run(arguments: list[str] | None = None, *, is_program: bool = False) -> int:
    """Run the command line and return the exit code.

    Parameters
    ----------
    arguments : list of str, optional
        Those of the process by default.
    is_program : bool
        This process does nothing else, so that a command may work in one of its own under watch.
    """
    printed_to = sys.stdout
    try:
        result = group.main(
            args=arguments, prog_name="symflex", standalone_mode=False, obj=WATCHED if is_program else None
        )
    except click.exceptions.Exit as stop:
        return stop.exit_code
    except click.exceptions.Abort:
        click.echo("stopped", err=True)
        return STOPPED
    except click.ClickException as problem:
        from symflex.cli.reporting import say  # most commands go well

        if isinstance(problem, click.NoSuchOption) and problem.option_name == NO_CACHE:
            problem = click.NoSuchOption(NO_CACHE, f"{problem.message} {GONE}", ctx=problem.ctx)
        shown = StringIO()
        problem.show(shown)
        say(shown.getvalue(), nl=False, err=True)
        return problem.exit_code
    except OSError as problem:
        return _unwritable(problem)  # of click's own texts, of help and version
    except SystemExit:
        if sys.stdout is printed_to:
            raise
        return 0  # click has put another in its place: the reader of a help text went away
    return result if isinstance(result, int) else 0


def _unwritable(problem: OSError) -> int:
    """Say that what a command printed could not be written, as to a full device; return the exit code."""
    from symflex.cli.reporting import note, silence  # most commands go well

    silence(sys.stdout)
    note(f"error[SF903]: cannot write to standard output: {problem.strerror or 'input/output error'}")
    return 2
