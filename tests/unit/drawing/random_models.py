"""Random models of all kinds of parts, those of them that are sound."""

from symflex import pipeline
from symflex.errors import SymflexError
from tests.random_models import anything


def models(first, count):
    """Yield so many sound models, each with its seed."""
    seed, found = first, 0
    while found < count:
        text = anything(seed)
        try:
            model = pipeline.loads(text) if text else None
        except SymflexError:
            model = None
        if model is not None:
            found += 1
            yield seed, model
        seed += 1
