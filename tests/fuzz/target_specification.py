"""Whole specifications: syntax, meaning, and whether the equations can be solved."""

from contextlib import suppress

from symflex import pipeline
from symflex.errors import SymflexError
from tests.house.repository import ROOT, specifications

ROOMS = ("symflex.model.spec", "symflex.model", "symflex.equations")


def seeds():
    """Return worked models and specifications with mistakes."""
    places = ("derivations/classics", "derivations/eppinger1988", "tests/golden/broken", "symflex/templates")
    files = [path for place in places for path in specifications(ROOT / place, "*.toml")]
    return [data for path in files if len(data := path.read_bytes()) < 4_000]


def run(data):
    """Check a specification."""
    with suppress(SymflexError):
        pipeline.assemble(pipeline.loads(data.decode("utf-8", "replace"), "/nonexistent/a.toml"))
