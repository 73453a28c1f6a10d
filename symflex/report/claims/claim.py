"""A statement of a publication with the checks that judge it, and the table of all of them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from symflex.errors import counted
from symflex.report.document import Aside, Badge, Cell, Run, Section, Table, Tone, Verdict, columns, text
from symflex.report.facts import ModelFacts

Models = Mapping[str, ModelFacts]  # facts by the name of the model's file, without suffix
Predicate = Callable[..., "Finding"]  # what may be checked, of facts, names and values by keyword
WORST: Final[tuple[Verdict, ...]] = ("not examined", "does not hold", "holds with a condition", "holds")
"""Verdicts; of several checks the first one here counts."""


@dataclass(frozen=True, slots=True)
class Finding:
    """What a check found."""

    verdict: Verdict  # ``holds``, ``holds with a condition``, ``does not hold`` or ``not examined``
    evidence: tuple[Run, ...]  # the numbers it rests on, or why nothing was examined
    missing: tuple[str, ...] = field(default=(), repr=False)  # models that it needs, not in the report


@dataclass(frozen=True, slots=True)
class Check:
    """A predicate with what its author adds to the evidence."""

    predicate: Predicate  # with its values, but for what is checked
    of: tuple[str, ...]  # what is checked: ``"model: OUT/IN"``, or the name of a model's file without suffix
    # note and condition: Sentences; with a condition, what holds does so under it.
    note: str = ""
    condition: str = ""

    def judge(self, models: Models) -> Finding:
        """Return the finding with what was added."""
        finding = self.predicate(models, self.of)
        condition = self.condition and f"Condition: {self.condition}"
        added = [f" {text}" for text in (self.note, condition) if text]
        is_conditional = self.condition and finding.verdict == "holds"
        verdict: Verdict = "holds with a condition" if is_conditional else finding.verdict
        return Finding(verdict, (*finding.evidence, *added))


@dataclass(frozen=True, slots=True)
class Claim:
    """A statement of a publication."""

    key: str  # a short name, of letters and hyphens
    place: str  # the section it stands in
    quote: str  # its words
    checks: tuple[Check, ...]  # all of them have to hold
    is_quotation: bool = True  # the words are the publication's own

    def judge(self, models: Models) -> Finding:
        """Return the finding; what needs a model that is not there is not examined."""
        needs = dict.fromkeys(model_of(name) for check in self.checks for name in check.of)
        missing = [name for name in needs if name not in models]
        if missing:
            why = f"The report does not include {', '.join(missing)}."
            return Finding("not examined", (why,), tuple(missing))
        try:
            findings = [check.judge(models) for check in self.checks]
        except KeyError as lacking:
            return Finding("not examined", (f"The models have no {lacking.args[0]} with numbers.",))
        lines: list[Run] = []
        for one in findings:
            lines += ["\n", *one.evidence]
        return Finding(min((one.verdict for one in findings), key=WORST.index), tuple(lines[1:]))


@dataclass(frozen=True, slots=True)
class Publication:
    """A publication and what it claims of its models."""

    name: str  # what the ``source`` of its specifications begins with
    title: str  # its title
    models: tuple[str, ...]  # its models, in its own order
    claims: tuple[Claim, ...]  # in the order in which it makes them


def model_of(name: str) -> str:
    """Return the model that ``"model: OUT/IN"`` or ``"model"`` names."""
    return name.partition(":")[0]


def judged(is_true: bool, *evidence: Run, condition: bool = False) -> Finding:
    """Return a finding: does not hold unless true, and holds with a condition when the evidence names one."""
    holds: Verdict = "holds with a condition" if condition else "holds"
    return Finding(holds if is_true else "does not hold", evidence)


ANCHOR: Final = "claims"
VERDICTS: Final[dict[str, tuple[Tone, str]]] = {  # their tones, and what is said of several claims
    "holds": ("good", "hold"),
    "holds with a condition": ("fair", "hold with a condition"),
    "does not hold": ("bad", "do not hold"),
    "not examined": ("quiet", "are not examined"),
}
SCHEMA: Final = "symflex.report-claims/1"


def publication_of(sources: Iterable[str], known: Iterable[Publication]) -> Publication | None:
    """Return the publication that any of the sources names, None without one."""
    return next((p for source in sources for p in known if is_of(source, p.name)), None)


def is_of(source: str, name: str) -> bool:
    """Tell whether a source is a publication, or a model made after it."""
    return source.removeprefix("after ").startswith(name)


def judge_all(publication: Publication, models: Sequence[ModelFacts]) -> tuple[Finding, ...]:
    """Return the finding on each claim, in order."""
    named = {m.stem: m for m in models if is_of(m.source, publication.name)}
    return tuple(claim.judge(named) for claim in publication.claims)


def verdict_counts(findings: Sequence[Finding]) -> str:
    """Say how many claims have each verdict, and how many are about other models."""
    counts: Counter[str] = Counter(finding.verdict for finding in findings if not finding.missing)
    others = sum(bool(finding.missing) for finding in findings)
    elsewhere = (
        [f"{others} {'are' if others > 1 else 'is'} about models that this report lacks"] if others else []
    )
    said = [f"{n} {many if n > 1 else v}" for v, (_, many) in VERDICTS.items() if (n := counts[v])]
    return ", ".join([*said, *elsewhere])


def claim_section(publication: Publication, findings: Sequence[Finding]) -> Section:
    """Return the claims with their verdicts and the evidence."""
    rows: list[tuple[Cell, ...]] = []
    for claim, finding in zip(publication.claims, findings, strict=True):
        if finding.missing:
            continue
        quote = f"“{claim.quote}”" if claim.is_quotation else claim.quote
        mark = Badge(finding.verdict, VERDICTS[finding.verdict][0])
        rows.append(((quote, "\n", Aside(claim.place)), (mark,), finding.evidence))
    lead = text(
        f"{publication.name}, {publication.title}: {counted(len(findings), 'claim')}, of which "
        f"{verdict_counts(findings)}. Each verdict is computed from the models below, with their values of "
        "the parameters. If a claim depends on a condition, the verdict names it."
    )
    table = Table(columns("Claim", ("Verdict", "plain"), "What was computed"), tuple(rows))
    return Section("Claims of the publication", (lead, table), ANCHOR)


def claims_json(publication: Publication, findings: Sequence[Finding]) -> dict[str, object]:
    """Return the claims as JSON data."""
    claims = []
    for claim, finding in zip(publication.claims, findings, strict=True):
        said = {"verdict": finding.verdict, "evidence": "".join(map(_plain, finding.evidence))}
        claims.append({"key": claim.key, "place": claim.place, "quote": claim.quote} | said)
    return {"schema": SCHEMA, "publication": publication.name, "claims": claims}


def _plain(run: object) -> str:
    return run if isinstance(run, str) else str(getattr(run, "text", None) or getattr(run, "latex", ""))
