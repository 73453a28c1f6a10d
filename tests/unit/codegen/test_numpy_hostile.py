"""Where tests of other rooms take hostile texts from; see hostile_names.py."""

from __future__ import annotations

from tests.unit.codegen.hostile_names import HOSTILE

__all__ = ["HOSTILE"]
