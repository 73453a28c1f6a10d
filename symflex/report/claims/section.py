"""The table of claims."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Final, Literal

from symflex.report.document import Aside, Badge, Section, Table, columns, counted, text

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from symflex.report.claims.claim import Finding, Publication
    from symflex.report.facts import ModelFacts

ANCHOR: Final = "claims"
TONES: Final[dict[str, Literal["good", "fair", "bad", "quiet"]]] = {
    "holds": "good",
    "holds with a condition": "fair",
    "does not hold": "bad",
    "not examined": "quiet",
}
PLURALS: Final = {
    "holds": "hold",
    "holds with a condition": "hold with a condition",
    "does not hold": "do not hold",
    "not examined": "are not examined",
}
SCHEMA: Final = "symflex.report-claims/1"


def publication_of(sources: Iterable[str], known: Iterable[Publication]) -> Publication | None:
    """Return the publication that any of the sources names, None without one."""
    return next((p for source in sources for p in known if is_of(source, p.name)), None)


def is_of(source: str, name: str) -> bool:
    """Tell whether a source is a publication, or a model made after it.

    Examples
    --------
    >>> is_of("after Eppinger & Seering 1988, fig. 1", "Eppinger & Seering 1988")
    True
    """
    return source.removeprefix("after ").startswith(name)


def judge_all(publication: Publication, models: Sequence[ModelFacts]) -> tuple[Finding, ...]:
    """Return the finding on each claim, in order."""
    named = {m.stem: m for m in models if is_of(m.source, publication.name)}
    return tuple(claim.judge(named) for claim in publication.claims)


def claim_section(publication: Publication, findings: Sequence[Finding]) -> Section:
    """Return the claims with their verdicts and the evidence."""
    counts: Counter[str] = Counter(finding.verdict for finding in findings)
    summary = ", ".join(f"{counts[v]} {PLURALS[v]}" for v in TONES if counts[v])
    rows = tuple(
        (
            (f"“{claim.quote}”" if claim.is_quotation else claim.quote, "\n", Aside(claim.place)),
            (Badge(finding.verdict, TONES[finding.verdict]),),
            finding.evidence,
        )
        for claim, finding in zip(publication.claims, findings, strict=True)
    )
    lead = text(
        f"{publication.name}, {publication.title}: {counted(len(findings), 'claim')}, of which {summary}. "
        "Each verdict is computed from the models below, with their values of the parameters; a condition is "
        "named where the claim depends on it."
    )
    table = Table(columns("Claim", ("Verdict", "plain"), "What was computed"), rows)
    return Section("Claims of the publication", (lead, table), ANCHOR)


def claims_json(publication: Publication, findings: Sequence[Finding]) -> dict[str, object]:
    """Return the claims as JSON data."""
    return {
        "schema": SCHEMA,
        "publication": publication.name,
        "claims": [
            {
                "key": claim.key,
                "place": claim.place,
                "quote": claim.quote,
                "verdict": finding.verdict,
                "evidence": "".join(_plain(run) for run in finding.evidence),
            }
            for claim, finding in zip(publication.claims, findings, strict=True)
        ],
    }


def _plain(run: object) -> str:
    return run if isinstance(run, str) else str(getattr(run, "text", None) or getattr(run, "latex", ""))
