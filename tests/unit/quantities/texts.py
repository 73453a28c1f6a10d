from symflex.errors import Source, Span, Text


def text_of(value):
    return Text(value, Span(Source("a.toml", value), 0, len(value)))
