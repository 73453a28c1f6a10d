"""The text a model was read from: all of the above follows from it."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING

from symflex.report.document import Code, Listing, text
from symflex.report.part import ChapterPart

if TYPE_CHECKING:
    from symflex.report.study import Study


def specification_section(study: Study) -> ChapterPart:
    """Return the specification as it was read, with its checksum."""
    content = study.text.encode()
    checksum = hashlib.sha256(content).hexdigest()
    name = f"data/{study.stem}.toml"
    return ChapterPart(
        "Specification",
        (text("SHA-256 ", Code(checksum)), Listing(f"{study.stem}.toml", study.text)),
        {name: content},
    )
