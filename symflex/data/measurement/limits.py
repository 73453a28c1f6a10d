"""How large a data file may be; beyond, it is refused before anything is built from it."""

from __future__ import annotations

from typing import Final

MAX_BYTES: Final = 50_000_000
MAX_LINES: Final = 1_000_000
MAX_RESPONSES: Final = 100
MAX_ERRORS: Final = 20
