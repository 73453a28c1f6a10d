"""The export target ``c``: C99 source and header."""
