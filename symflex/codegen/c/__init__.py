"""The export target ``c``: C99 source and header."""

from symflex.codegen.c.module import CExport, c_files

__all__ = ["CExport", "c_files"]
