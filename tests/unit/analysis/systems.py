from __future__ import annotations

from symflex.equations import assemble
from symflex.errors import Source
from symflex.model import load_model
from symflex.transfer import bind, derive_all


def derived(text):
    """Return every transfer function of a specification given without its first line."""
    model = load_model(Source("test.toml", f"symflex = 1\n{text}"))
    return derive_all(assemble(model), model.transfer_functions)


def rational(expression):
    """Return y/u, bound, for y = expression * u."""
    (tf,) = derived(f'inputs.u = {{}}\noutputs.y = "({expression})*u"')
    return bind(tf)
