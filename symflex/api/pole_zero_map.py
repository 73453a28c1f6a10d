"""Poles and zeros as a notebook shows them."""

from __future__ import annotations

from dataclasses import dataclass, fields

from symflex import roots as roots_room


@dataclass(frozen=True, slots=True)
class PoleZeroMap(roots_room.PoleZeroMap):
    """Poles, zeros and hidden modes; in a notebook, a table. See :class:`symflex.roots.PoleZeroMap`."""

    @staticmethod
    def of(found: roots_room.PoleZeroMap) -> PoleZeroMap:
        """Return the face of a map."""
        return PoleZeroMap(*(getattr(found, field.name) for field in fields(found)))

    def _repr_html_(self) -> str:
        from symflex.print.html import roots_html  # only notebooks ask

        return roots_html(self)
