"""The report as a whole: chapters, what is said across them, and where all of it comes from."""

from __future__ import annotations

import json
import platform
import re
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from dataclasses import dataclass, replace
from functools import partial
from importlib import metadata
from pathlib import Path
from time import monotonic
from typing import Final

from symflex.budget import TIME_OVER, Budget, entered_budget
from symflex.data.measurement import MeasuredResponse
from symflex.errors import (
    BudgetError,
    SpecError,
    SymflexError,
    UncertifiedError,
    UsageError,
    counted,
    refused,
)
from symflex.errors.diagnostic import printable
from symflex.files.write import free_name
from symflex.report.chapter import Chapter, chapter_of, failed_chapter
from symflex.report.claims.claim import (
    Finding,
    Publication,
    claim_section,
    claims_json,
    judge_all,
    publication_of,
    verdict_counts,
)
from symflex.report.claims.read import CLAIMS, is_claims, read_claims
from symflex.report.comparison import comparison_section
from symflex.report.document import Badge, Block, Cell, Code, PageLink, Section, Table, columns, filled, text
from symflex.report.sections.roots import stability_mark
from symflex.report.study import Study, attempt
from symflex.roots import Progress
from symflex.roots.pole_zero_map import WORST_FIRST
from symflex.sweep.run import open_pool

MOST_MODELS: Final = 200
TICK: Final = 0.5  # seconds between two reports of progress while nothing ends
CHAPTERS: Final = 0.8  # part of the time after which chapters end, so that there is some for writing
WAITING: Final = 0.9  # part of the time after which those that do not end are no longer waited for
DATA_SUFFIXES: Final = frozenset((".csv", ".tsv", ".npz", ".mat", ".uff", ".unv"))  # looked for in folders
LIBRARIES: Final = ("python-flint", "numpy", "scipy", "sympy", "mpmath", "matplotlib")
TABLES: Final = {"claims": "Every claim with its verdict", "comparison": "All models in a table"}
"""What stands for the tables of a report until a reader opens them, by their anchors."""
RESERVED: Final = frozenset(("comparison", "claims", "contents", "models", "provenance", "top"))


@dataclass(frozen=True, slots=True)
class Report:
    """A report before it is printed."""

    title: str  # plain text
    subtitle: str  # whose models these are; may be empty
    date: str  # as shown; empty for none
    sections: tuple[Section, ...]  # overview, claims, comparison, a chapter per model, provenance
    files: Mapping[str, bytes]  # figures, code and data, by path inside the report's folder
    warnings: tuple[str, ...]  # what the user should be told
    code: int  # exit code


def find_specifications(
    paths: Sequence[Path], output: Path | None = None, allow_outside: Sequence[Path] = ()
) -> tuple[Path, ...]:
    """Return the specifications that arguments name; a folder stands for all in it and its subfolders.

    What stands in ``output`` is left out. Raises SF902 for none, for too many, and for a link that leads out
    of a folder and not to one of ``allow_outside``.
    """
    specifications: list[Path] = []
    for path in paths:
        if path.is_dir():
            inside = [p for p in _inside(path, frozenset((".toml",)), output) if not is_claims(p)]
            for file in inside:
                if _leads_out(file, (path, *allow_outside)):
                    message = f"'{file}' is a link that leads out of the folder"
                    raise refused(message, "--allow-outside FOLDER lets a report read another folder")
            if not inside:
                message = f"the folder '{path}' contains no specification"
                raise refused(message, "a specification is a file whose name ends in .toml")
            specifications += inside
        elif path.suffix.lower() in DATA_SUFFIXES:
            message = f"'{path}' is a file of measured data, not a specification"
            raise refused(message, "put it into a folder with the specification, and give the folder")
        else:
            specifications.append(path)
    distinct = tuple(dict.fromkeys(specifications))
    if len(distinct) > MOST_MODELS:
        raise refused(f"{len(distinct)} specifications; a report takes {MOST_MODELS}")
    return distinct


def name_specifications(paths: Sequence[Path]) -> dict[str, Path]:
    """Return paths by the name their files in the report begin with.

    The names are made of letters, digits and underscores, and differ also where capitals count as small.
    """
    named: dict[str, Path] = {}
    for path in paths:
        plain = re.sub(r"[^A-Za-z0-9_]", "_", path.stem)[:64]
        named[free_name(plain if plain[:1].isalpha() else f"m_{plain}", (*RESERVED, *named))] = path
    return named


def find_claims(
    specifications: Iterable[Path], allow_outside: Sequence[Path] = ()
) -> tuple[Publication, ...]:
    """Return what ``claims.toml`` beside specifications says; see :func:`.claims.read.read_claims`."""
    folders = dict.fromkeys(path.parent for path in specifications)
    files = [f / CLAIMS for f in folders if not _leads_out(f / CLAIMS, (f, *allow_outside))]
    return tuple(read_claims(file) for file in files if is_claims(file))


def find_measurements(
    paths: Sequence[Path], output: Path | None = None, allow_outside: Sequence[Path] = ()
) -> tuple[tuple[MeasuredResponse, ...], tuple[str, ...]]:
    """Return the measured responses in folders, outside ``output``, and why others were left out."""
    from symflex.data.measurement import read_measurement

    measurements: list[MeasuredResponse] = []
    warnings: list[str] = []
    for path in paths:
        for file in _inside(path, DATA_SUFFIXES, output) if path.is_dir() else ():
            if _leads_out(file, (path, *allow_outside)):
                warnings.append(f"{file} is left out: the link leads out of the folder (--allow-outside)")
                continue
            read = attempt(partial(read_measurement, file))
            if isinstance(read, SymflexError):
                warnings.append(f"{file} is left out: {read.diagnostics[0].message}")
            else:
                measurements += read
    return tuple(measurements), tuple(warnings)


def _inside(folder: Path, suffixes: frozenset[str], output: Path | None) -> list[Path]:
    """Return the files of a folder and below with some suffixes, those at the top first."""
    left_out = None if output is None else output.resolve()
    files = (p for p in folder.rglob("*") if p.suffix in suffixes and p.is_file())
    kept = (p for p in files if left_out is None or left_out not in p.resolve().parents)
    return sorted(kept, key=lambda p: (len(p.parts), p))


def _leads_out(file: Path, folders: Sequence[Path]) -> bool:
    return not any(file.resolve().is_relative_to(folder.resolve()) for folder in folders)


def check_specifications(named: Mapping[str, Path], allow_outside: tuple[Path, ...] = ()) -> None:
    """Refuse specifications that are no solvable models, with every problem of all files."""
    failed: list[SymflexError] = []
    for stem, path in named.items():
        checked = attempt(partial(Study.of, path, stem, allow_outside=allow_outside))
        # What exceeds a budget already here is for its own chapter to say.
        if isinstance(checked, SymflexError) and checked.exit_code <= SpecError.exit_code:
            failed.append(checked)
    if len(failed) == 1:
        raise failed[0]
    if failed:
        worst = SpecError if any(e.exit_code == SpecError.exit_code for e in failed) else UsageError
        raise worst(*(d for error in failed for d in error.diagnostics))


def write_chapters(
    named: Mapping[str, Path],
    processes: int,
    progress: Progress,
    measured: tuple[MeasuredResponse, ...] = (),
    allow_outside: tuple[Path, ...] = (),
) -> tuple[Chapter, ...]:
    """Return the chapters, in order, computed in so many ``processes`` once all specifications are checked.

    In a process of its own a model that ends it costs its own chapter only. ``measured`` responses are drawn
    with the transfer functions of the same names. Raises with every problem of all files that are not
    solvable models.
    """
    check_specifications(named, allow_outside)
    done: dict[str, Chapter] = {}
    if processes < 1 or len(named) == 1:
        for stem, path in named.items():
            progress.report(len(done) / len(named), f"model {len(done) + 1} of {len(named)}: {stem}")
            heard = progress if len(named) == 1 else None
            with entered_budget().share(CHAPTERS).entered():
                done[stem] = chapter_of(path, stem, measured, allow_outside, heard)
        return tuple(done.values())
    done = _in_processes(named, processes, progress, measured, allow_outside)
    # A process that ends takes with it what others have begun: alone, the models show which one it is.
    for stem, path in named.items():
        if stem not in done:
            done |= _in_processes({stem: path}, 1, progress, measured, allow_outside)
        if stem not in done:
            reason = "its process ended, perhaps for lack of memory"
            done[stem] = failed_chapter(path, stem, reason, BudgetError.exit_code, allow_outside)
    return tuple(done[stem] for stem in named)


def _in_processes(
    named: Mapping[str, Path],
    processes: int,
    progress: Progress,
    measured: tuple[MeasuredResponse, ...],
    allow_outside: tuple[Path, ...],
) -> dict[str, Chapter]:
    """Return the chapters of models whose processes came to an end of their own."""
    count = min(processes, len(named))
    done: dict[str, Chapter] = {}
    chapters, time = entered_budget().share(CHAPTERS), entered_budget().share(WAITING)
    with open_pool(count) as pool:
        given = (measured, allow_outside, chapters.deadline, chapters.memory)
        waiting = {pool.submit(_chapter_in, path, stem, *given): stem for stem, path in named.items()}
        total = len(waiting)
        while waiting:
            at_work = ", ".join(list(waiting.values())[:count])
            ended = total - len(waiting)
            progress.report(ended / (total + 1), f"{ended} of {counted(total, 'model')}; {at_work}")
            if time.left == 0:
                # Processes in an operation that cannot be asked end with this one.
                pool.shutdown(wait=False, cancel_futures=True)
                for stem in waiting.values():
                    reason, code = TIME_OVER.message, BudgetError.exit_code
                    done[stem] = failed_chapter(named[stem], stem, reason, code, allow_outside)
                break
            for future in wait(waiting, min(TICK, time.left or TICK), FIRST_COMPLETED).done:
                stem = waiting.pop(future)
                chapter = _outcome(future, named[stem], stem, allow_outside)
                if chapter is not None:
                    done[stem] = chapter
    return done


def _outcome(
    future: Future[Chapter], path: Path, stem: str, allow_outside: tuple[Path, ...] = ()
) -> Chapter | None:
    """Return the chapter, one that says how the program failed in it, or None where its process was ended."""
    error = future.exception()
    match error:
        case None:
            return future.result()
        case BrokenExecutor():
            return None
        case MemoryError():
            return failed_chapter(path, stem, "out of memory", BudgetError.exit_code, allow_outside)
        case Exception() if not isinstance(error, SymflexError):
            reason = f"the program fails here ({type(error).__name__}: {error}), please report it"
            return failed_chapter(path, stem, printable(reason), UncertifiedError.exit_code, allow_outside)
        case _:
            raise error


def _chapter_in(
    path: Path,
    stem: str,
    measured: tuple[MeasuredResponse, ...],
    allow_outside: tuple[Path, ...],
    deadline: float | None,
    memory: int | None,
) -> Chapter:
    """Return a chapter, with the budget of the process that asks for it."""
    # The clock of all processes began when the computer did.
    seconds = None if deadline is None else deadline - monotonic()
    with Budget(seconds, memory=memory).entered():
        return chapter_of(path, stem, measured, allow_outside)


def compose(chapters: Sequence[Chapter], date: str, publications: Sequence[Publication] = ()) -> Report:
    """Return the report of chapters; the first of the publications that is a source has its claims judged."""
    publication = publication_of((c.facts.source for c in chapters), publications)
    order = {name: i for i, name in enumerate(publication.models)} if publication else {}
    ordered = sorted(chapters, key=lambda c: order.get(c.facts.stem, len(order)))
    facts = [c.facts for c in ordered]
    findings = judge_all(publication, facts) if publication else ()
    files = {name: content for c in ordered for name, content in c.files.items()}
    sections: list[Section] = [_overview(ordered, publication, findings)]
    if publication:
        sections.append(claim_section(publication, findings))
        document = claims_json(publication, findings)
        files["data/claims.json"] = json.dumps(document, indent=1, ensure_ascii=False).encode()
    sections += filter(None, [comparison_section(facts)])
    sections += [c.section for c in ordered]
    if len(ordered) > 1:
        # The overview is what a reader sees first; the rest opens where it is asked for.
        sections[1:] = [replace(s, folded=_folded(s)) for s in sections[1:]]
    sections.append(_provenance(date))
    title, subtitle = _titles(ordered, publication)
    warnings = tuple(w for c in ordered for w in c.warnings)
    return Report(title, subtitle, date, tuple(sections), files, warnings, max(c.code for c in ordered))


def _folded(section: Section) -> str:
    """Return what a section holds, as a line that stands for it; empty where it contains little."""
    if section.anchor in TABLES:
        return TABLES[section.anchor]
    titles = [b.title for b in section.blocks if isinstance(b, Section) and b.title]
    return ", ".join(title if not i else title[:1].lower() + title[1:] for i, title in enumerate(titles))


def _titles(chapters: Sequence[Chapter], publication: Publication | None) -> tuple[str, str]:
    if publication:
        return publication.title, f"The models of {publication.name}, derived and examined"
    if len(chapters) == 1:
        return chapters[0].section.title, ""
    return counted(len(chapters), "model"), "Derived and examined"


def _overview(
    chapters: Sequence[Chapter], publication: Publication | None, findings: Sequence[Finding]
) -> Section:
    blocks: list[Block] = []
    if publication:
        lead = f"The publication makes {counted(len(findings), 'claim')}: {verdict_counts(findings)}. See "
        blocks.append(text(lead, PageLink("the claims", "#claims"), "."))
    rows: list[tuple[Cell, ...]] = []
    for c in chapters:
        functions = c.facts.functions
        if c.failure:
            mark = Badge("not computed", "bad")
        elif not functions:
            mark = Badge("no numbers", "quiet")
        else:
            certified = all(f.certified for f in functions)
            mark = Badge("certified", "good") if certified else Badge("not certified", "bad")
        link = PageLink(c.section.title, f"#{c.stem}")
        rows.append(((link,), (c.facts.source or "–",), (mark,), (_stability(c),)))
    heads = columns("Model", "Source", ("Poles and zeros", "plain"), ("Stability", "plain"))
    blocks.append(filled(heads, rows))
    return Section("Overview", tuple(blocks), "models")


def _stability(chapter: Chapter) -> Badge | str:
    """Return the worst that was found of a model's transfer functions."""
    verdicts = [f.verdict for f in chapter.facts.functions]
    worst = min(verdicts, key=lambda v: WORST_FIRST.index(v.word), default=None)
    return stability_mark(worst.brief) if worst else "–"


def _provenance(date: str) -> Section:
    versions = [("symflex", _version("symflex")), ("Python", platform.python_version())]
    versions += [(name, _version(name)) for name in LIBRARIES]
    rows = tuple(((name,), (Code(version),)) for name, version in versions)
    when = f" on {date}" if date else ""
    lead = text(
        f"Written by symflex {_version('symflex')}{when}. Every formula is derived exactly from the "
        "specification printed with its model; every root marked certified is enclosed in ball "
        "arithmetic, and none is missing from the region named. Results that were sampled rather "
        "than proved are marked as such."
    )
    return Section("Provenance", (lead, Table(columns("Program", ("Version", "plain")), rows)), "provenance")


def _version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return "(not installed as a package)"
