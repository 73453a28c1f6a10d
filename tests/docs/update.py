"""Write into the pages what the program prints: ``python -m tests.docs.update [PAGE...]``, all by default.

Tables of the program's registries are written too. Sessions that still hold stay as they are, with their
``...``; look at what changed before you keep it.
"""

import contextlib
import doctest
import io
import os
import re
import shlex
import sys
import tempfile
from pathlib import Path

from symflex.cli import run
from tests.docs.reference import with_tables
from tests.house.repository import ROOT, blocks, pages


def printed(command):
    """Return what a command prints, notes before results, as a page shows it."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        run(shlex.split(command)[1:])
    return err.getvalue() + out.getvalue()


def copy_files(page):
    """Write the titled files of a page into the current folder, and the examples that it copies."""
    for block in blocks(page):
        if block.title:
            Path(block.title).write_text(block.text, encoding="utf-8")
    for command in dict.fromkeys(re.findall(r"symflex examples copy [\w/]+", page.read_text("utf-8"))):
        printed(command)


def shown_now(text):
    """Return the text of a block of sessions with what its commands print today."""
    parts = re.split(r"^\$ ", text, flags=re.MULTILINE)
    found = [parts[0]]
    for session in parts[1:]:
        command, _, expected = session.partition("\n")
        now = printed(command)
        holds = doctest.OutputChecker().check_output(expected, now, doctest.ELLIPSIS)
        found.append(f"$ {command}\n{expected if holds else now}")
    return "".join(found)


def update(page):
    """Rewrite the sessions of one page, in a folder with the files that it titles."""
    text = with_tables(page.read_text("utf-8"))
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        copy_files(page)
        for block in blocks(page):
            if block.language == "console" and block.text.startswith("$ symflex"):
                text = text.replace(block.text, shown_now(block.text))
    if text != page.read_text("utf-8"):
        page.write_text(text, encoding="utf-8")
        print(page.relative_to(ROOT))


if __name__ == "__main__":
    os.environ["COLUMNS"] = "80"
    for one in [Path(name).resolve() for name in sys.argv[1:]] or pages():
        update(one)
