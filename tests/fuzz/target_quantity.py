"""Quantities and units as they stand in specifications."""

from contextlib import suppress

from symflex.errors import Source, Span, SymflexError, Text
from symflex.quantities import parse_quantity, parse_unit

ROOMS = ("symflex.quantities",)


def seeds():
    """Return texts of many kinds."""
    texts = (
        "1 kg",
        "-2.5e-3 N*m/A",
        "3 rev/min",
        "70 GPa",
        "1/3 m^2/s",
        "50 Hz",
        "2*pi rad",
        "5 %",
        "1e400 um",
    )
    return [text.encode() for text in texts]


def run(data):
    """Parse a text as a quantity and as a unit."""
    text = data.decode("utf-8", "replace")
    written = Text(text, Span(Source("a.toml", text), 0, len(text)))
    for parse in (parse_quantity, parse_unit):
        with suppress(SymflexError):
            found = parse(written)
            if parse is parse_quantity:
                found.angular()
                found.cyclic()
