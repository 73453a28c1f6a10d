"""The bar on stderr, with a clock and a terminal of the test's own."""

from io import StringIO

import pytest

from symflex.cli import progress
from symflex.cli.progress import ProgressBar, Waiting, hushed


class Screen(StringIO):
    """What a terminal shows: a carriage return goes back to the first column."""

    def __init__(self, terminal=True):
        super().__init__()
        self._terminal = terminal

    def isatty(self):
        return self._terminal

    @property
    def shown(self):
        cells = []
        column = 0
        for c in self.getvalue():
            if c == "\r":
                column = 0
                continue
            cells[column : column + 1] = [c]
            column += 1
        return "".join(cells)


class Clock:
    """Stands still until it is set."""

    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


@pytest.fixture(autouse=True)
def plain_environment(monkeypatch):
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("TERM", "xterm")


def bar(terminal=True):
    screen, clock = Screen(terminal), Clock()
    return ProgressBar(screen, clock), screen, clock


def test_a_bar_is_drawn_after_a_second():
    progress, screen, clock = bar()
    clock.now += 0.99
    progress.report(0.9, "roots")
    assert screen.getvalue() == ""
    clock.now += 0.01
    progress.report(0.5, "5 of 10 roots")
    assert screen.shown == "[##########----------]  50 %  5 of 10 roots"


def test_parts_outside_are_drawn_at_the_ends():
    for done, percent in ((-1, 0), (0, 0), (1, 100), (7, 100), (float("nan"), 0)):
        progress, screen, clock = bar()
        clock.now += 2
        progress.report(done, "")
        assert screen.shown.split("]")[1].split() == [str(percent), "%"], (done, percent)


def test_a_shorter_line_covers_a_longer_one():
    progress, screen, clock = bar()
    clock.now += 2
    progress.report(0.1, "a long description")
    clock.now += 1
    progress.report(0.2, "short")
    assert screen.shown.rstrip() == "[####----------------]  20 %  short"
    clock.now += 1
    progress.close()
    assert screen.shown.strip() == ""
    assert screen.getvalue().endswith("\r")


def test_it_is_drawn_ten_times_a_second_at_most():
    progress, screen, clock = bar()
    clock.now += 1
    for _ in range(1000):
        clock.now += 0.001
        progress.report(0.5, "")
    assert 9 <= screen.getvalue().count("\r") <= 11


def test_a_line_has_79_columns_at_most_and_is_ascii():
    progress, screen, clock = bar()
    clock.now += 2
    progress.report(0.5, "näch\n\x1b[31m" + "x" * 200)
    assert len(screen.shown) == 79
    assert screen.shown.isascii()
    assert screen.shown.isprintable()


@pytest.mark.parametrize(
    ("terminal", "name", "value"), [(False, "TERM", "xterm"), (True, "NO_COLOR", "1"), (True, "TERM", "dumb")]
)
def test_nothing_is_drawn_where_nobody_looks_or_lines_are_not_rewritten(monkeypatch, terminal, name, value):
    monkeypatch.setenv(name, value)
    progress, screen, clock = bar(terminal)
    clock.now += 10
    progress.report(0.5, "roots")
    progress.close()
    assert screen.getvalue() == ""


def test_it_erases_itself_after_an_error():
    screen, clock = Screen(), Clock()
    with pytest.raises(ZeroDivisionError), ProgressBar(screen, clock) as progress:
        clock.now += 2
        progress.report(0.5, "roots")
        _ = 1 / 0
    assert screen.shown.strip() == ""
    progress.report(0.6, "roots")
    progress.close()
    assert screen.shown.strip() == ""


def test_stderr_is_the_default(capsys):
    progress = ProgressBar()
    progress.report(0.5, "roots")
    progress.close()
    assert capsys.readouterr() == ("", "")


def test_a_command_without_a_bar_shows_its_seconds_and_gives_way_to_what_is_printed(monkeypatch):
    written, at = [], iter([0.0, 1.0, 3.2, 3.3, 3.4, 4.0])
    monkeypatch.setattr(progress, "monotonic", lambda: next(at))
    monkeypatch.setattr(progress.os, "write", lambda _, text: written.append(text.decode()))
    waiting = Waiting("draw")
    monkeypatch.setattr(progress, "_waiting", waiting)
    monkeypatch.setattr(Screen, "fileno", lambda _: 2)
    monkeypatch.setattr(progress.sys, "stderr", Screen())
    waiting._draw()  # too early
    waiting._draw()
    assert written == ["\rsymflex draw: 3 s"]
    with hushed():
        waiting._draw()
    assert written[1:] == [f"\r{' ' * 17}\r"]
    waiting._draw()
    assert len(written) == 2
