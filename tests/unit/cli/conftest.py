"""The shell all tests of this folder use."""

from tests.unit.cli.commands import shell

__all__ = ["shell"]
