"""What another package found, as the class a Python user holds: the same fields, and pictures besides."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Face = TypeVar("Face", bound="DataclassInstance")


def face_of(face: type[Face], inner: DataclassInstance) -> Face:
    """Return a dataclass as one of its subclasses, which adds methods and no fields."""
    return face(**{field.name: getattr(inner, field.name) for field in fields(inner)})
