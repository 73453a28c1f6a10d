"""What publications claim about their models, judged from computed facts.

The spec language says what a model is and what was printed about it (``[published]``); what a text says in
words has no place there. So claims are data of the program, each a :class:`Claim` with a check that is a pure
function of facts, and they are applied to the specifications whose ``source`` begins with the publication's
name. A new publication is one module and one line in :data:`PUBLICATIONS`.
"""

from symflex.report.claims.claim import Claim, Finding, Models, Publication
from symflex.report.claims.eppinger1988 import EPPINGER_1988
from symflex.report.claims.section import claim_section, publication_of

PUBLICATIONS: dict[str, Publication] = {EPPINGER_1988.name: EPPINGER_1988}
"""By what the ``source`` of their specifications begins with."""

__all__ = [
    "PUBLICATIONS",
    "Claim",
    "Finding",
    "Models",
    "Publication",
    "claim_section",
    "publication_of",
]
