"""What publications claim about their models, judged from computed facts.

The spec language says what a model is and what was printed about it (``[published]``). What a text says in
words stands in a ``claims.toml`` beside the specifications: quotations with checks, each a predicate of a
registry, applied to the specifications whose ``source`` begins with the publication's name.
"""

from symflex.report.claims.claim import Claim, Finding, Models, Publication, claim_section, publication_of
from symflex.report.claims.predicates import PREDICATES
from symflex.report.claims.read import CLAIMS, is_claims, read_claims

__all__ = [
    "CLAIMS",
    "PREDICATES",
    "Claim",
    "Finding",
    "Models",
    "Publication",
    "claim_section",
    "is_claims",
    "publication_of",
    "read_claims",
]
