"""The export target ``c``: C99 source and header."""

from symflex.codegen.c.module import C99

__all__ = ["C99"]
