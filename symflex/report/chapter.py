"""The chapter about one model, computed in a process of its own: nothing in it belongs to an engine."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from symflex import pipeline
from symflex.errors import SpecError, SymflexError
from symflex.report.document import Block, Notice, Section, code_of, text
from symflex.report.facts import ModelFacts, bare_facts, facts_of
from symflex.report.sections import OF_CONTINUOUS, SECTIONS
from symflex.report.study import Study, attempt, said

if TYPE_CHECKING:
    from symflex.data.measurement import MeasuredResponse
    from symflex.roots import Progress


@dataclass(frozen=True, slots=True)
class Chapter:
    """The chapter of one model in a report, and the files that go with it."""

    stem: str  # its anchor, and the name its files begin with
    section: Section  # title and sections
    facts: ModelFacts  # what the comparison and the claims read
    files: Mapping[str, bytes]  # content by path inside the report's folder
    warnings: tuple[str, ...]  # what the user should be told
    # Exit code: 0, 4 when something is not certified or a figure that was asked for cannot be drawn, 5 when a
    # budget was exceeded.
    code: int
    failure: str = ""  # why the chapter says nothing else; empty for all others


def failed_chapter(
    path: Path, stem: str, reason: str, code: int, allow_outside: tuple[Path, ...] = ()
) -> Chapter:
    """Return the chapter of a model that nothing else can be said of."""
    model = attempt(lambda: pipeline.load(path, allow_outside))
    facts = ModelFacts(stem) if isinstance(model, SymflexError) else bare_facts(stem, model)
    section = Section(facts.title or stem, (Notice(f"Not computed: {reason}."),), stem)
    return Chapter(stem, section, facts, {}, (f"{stem} is not computed: {reason}",), code, reason)


def chapter_of(
    path: Path,
    stem: str,
    measured: tuple[MeasuredResponse, ...] = (),
    allow_outside: tuple[Path, ...] = (),
    progress: Progress | None = None,
) -> Chapter:
    """Read a specification, return its chapter; a section that cannot be computed says why in its place."""
    opened = attempt(lambda: Study.of(path, stem, measured, allow_outside))
    if isinstance(opened, SymflexError):
        if opened.exit_code <= SpecError.exit_code:
            raise opened
        return failed_chapter(path, stem, said(opened), opened.exit_code, allow_outside)
    study = opened
    model = study.model
    blocks: list[Block] = []
    if model.source:
        blocks.append(text(f"{model.source[:1].upper()}{model.source[1:]}."))
    files: dict[str, bytes] = {}
    doubts = pipeline.warnings(model)
    blocks += [Notice(f"Warning: {w.message}.") for w in doubts]
    warnings = [f"{w.span}: {w.message} ({w.code})" for w in doubts]
    code = 0
    given = {k: make for k, make in SECTIONS.items() if not (model.sampled and k in OF_CONTINUOUS)}
    for i, (key, make) in enumerate(given.items()):
        if progress is not None:
            progress.report(i / len(given), f"{stem}: {key}")
        part = attempt(lambda m=make: m(study))  # type: ignore[misc]
        if isinstance(part, SymflexError):
            reason = said(part)
            blocks.append(Section(key.capitalize(), (Notice(reason),), f"{stem}-{key}"))
            warnings.append(f"{stem}, {key}: {reason}")
            code = max(code, code_of(part))
        elif part is not None:
            blocks.append(Section(part.title, part.blocks, f"{stem}-{key}"))
            files.update(part.files)
            warnings += part.warnings
            code = max(code, part.code)
    gathered = attempt(lambda: facts_of(study))
    if isinstance(gathered, SymflexError):
        warnings.append(f"{stem} is not compared: {said(gathered)}")
        code, facts = max(code, code_of(gathered)), bare_facts(stem, model)
    else:
        facts = gathered
    if not all(f.certified for f in facts.functions):
        code = max(code, 4)
    files[f"data/{stem}_facts.json"] = json.dumps(facts.to_json_dict(), indent=1).encode()
    title = model.title or stem
    return Chapter(stem, Section(title, tuple(blocks), stem), facts, files, tuple(warnings), code)
