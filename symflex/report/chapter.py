"""The chapter about one model, computed in a process of its own: nothing in it belongs to an engine."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from symflex.errors import SymflexError
from symflex.report.document import Notice, Section, text
from symflex.report.facts import ModelFacts
from symflex.report.sections import SECTIONS
from symflex.report.study import Study, attempt

if TYPE_CHECKING:
    from symflex.measurement import MeasuredResponse
    from symflex.report.document import Block


@dataclass(frozen=True, slots=True)
class Chapter:
    """What a report says about one model, and the files that go with it.

    Parameters
    ----------
    stem : str
        Its anchor, and the name its files begin with.
    section : Section
        Title and sections.
    facts : ModelFacts
        What the comparison and the claims read.
    files : mapping of str to bytes
        Content by path inside the report's folder.
    warnings : tuple of str
        What the user should be told.
    code : int
        Exit code: 0, 4 when something is not certified, 5 when a budget was exceeded.
    """

    stem: str
    section: Section
    facts: ModelFacts
    files: Mapping[str, bytes]
    warnings: tuple[str, ...]
    code: int


def chapter_of(
    path: Path,
    stem: str,
    measured: tuple[MeasuredResponse, ...] = (),
    allow_outside: tuple[Path, ...] = (),
) -> Chapter:
    """Read a specification and return its chapter, with measured responses where they fit.

    A section that cannot be computed, for want of a value or because it would be too large, says why in its
    place; the others stand.

    Raises
    ------
    SpecError, ModelError
        When the file is no solvable model.
    """
    study = Study.of(path, stem, measured, allow_outside)
    model = study.model
    blocks: list[Block] = []
    if model.source:
        blocks.append(text(f"{model.source}."))
    files: dict[str, bytes] = {}
    warnings: list[str] = []
    code = 0
    for key, make in SECTIONS.items():
        part = attempt(lambda m=make: m(study))  # type: ignore[misc]
        if isinstance(part, SymflexError):
            reason = "; ".join(d.message for d in part.diagnostics)
            blocks.append(Section(key.capitalize(), (Notice(reason),), f"{stem}-{key}"))
            warnings.append(f"{stem}, {key}: {reason}")
            code = max(code, part.exit_code if part.exit_code > 3 else 0)  # noqa: PLR2004 - 4 and 5
        elif part is not None:
            blocks.append(Section(part.title, part.blocks, f"{stem}-{key}"))
            files.update(part.files)
            warnings += part.warnings
    facts = study.facts
    if not all(f.certified for f in facts.functions):
        code = max(code, 4)
    files[f"data/{stem}_facts.json"] = json.dumps(facts.to_json_dict(), indent=1).encode()
    title = model.title or stem
    return Chapter(stem, Section(title, tuple(blocks), stem), facts, files, tuple(warnings), code)
