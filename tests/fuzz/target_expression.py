"""Expressions and equations as they stand in specifications."""

from contextlib import suppress

from symflex.errors import Source, Span, SymflexError, Text
from symflex.expressions import format_expression, parse, parse_equation

ROOMS = ("symflex.expressions",)


def seeds():
    """Return texts of many kinds."""
    texts = (
        "K*(r - x)",
        "EI*w'''' + rho*A*s^2*w = 0",
        "-(a + b)^2/(3*c*d)",
        "sqrt(k/m)*sin(2*pi*0.5)",
        "1.5e-3*x_1 - y'(l/2)",
        "w''(l) = 0",
        "exp(-s*T)*cosh(q)/sinh(q)",
        "2 kg*s^-2",
    )
    return [text.encode() for text in texts]


def run(data):
    """Parse a text both ways; what was read prints, and reads back as the same."""
    text = data.decode("utf-8", "replace")
    written = Text(text, Span(Source("a.toml", text), 0, len(text)))
    with suppress(SymflexError):
        parse_equation(written)
    with suppress(SymflexError):
        printed = format_expression(parse(written))
        again = parse(Text(printed, Span(Source("b.toml", printed), 0, len(printed))))
        if format_expression(again) != printed:
            message = f"{text!r} prints as {printed!r}, which prints as {format_expression(again)!r}"
            raise AssertionError(message)
