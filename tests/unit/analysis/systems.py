from symflex.equations import assemble
from symflex.errors import Source, SymflexError
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


def words(call, *given, **named):
    """Return the kind and the words of the error that a call raises; "" for none."""
    try:
        call(*given, **named)
    except SymflexError as error:
        return f"{type(error).__name__} {error}"
    return ""
