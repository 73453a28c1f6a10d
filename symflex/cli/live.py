"""``symflex live``."""

from __future__ import annotations

from symflex.cli.command import Specification, bare_command
from symflex.cli.reporting import check_place, say
from symflex.options import LiveOptions


@bare_command("live", LiveOptions)
def live(given: LiveOptions) -> int:
    """Write a page with a slider for every parameter of a model.

    The page shows the drawing, formula, Bode plot, poles and zeros, step response and modes, and all of them
    follow the sliders. It is one file that opens without a network. A slider covers the parameter's 'range',
    or else from a tenth of its value to ten times its value. With several SPECs, the page has a list of
    models. Functions without a short formula, such as those of frames, use the values in the file: they are
    shown and do not move. If there is no such file, symflex takes the example of that name.
    """
    from symflex import pipeline
    from symflex.cli.progress import ProgressBar
    from symflex.files.examples import file_or_example
    from symflex.files.write import write_atomically
    from symflex.live.page import live_page

    specs = [file_or_example(spec) for spec in given.specs]
    path = check_place(given.output or f"{specs[0].stem if len(specs) == 1 else 'live'}.html", (".html",))
    with ProgressBar() as bar:
        models = []
        for spec in specs:
            model = Specification(str(spec), tuple(map(str, given.allow_outside)), {}).load()
            models.append((model, pipeline.pick_pairs(model, given.tfs)))
        page = live_page(models, bar)
    write_atomically(path, page.encode())
    say(f"open {path}")
    return 0
