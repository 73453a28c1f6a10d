from random import Random

import pytest
from lark import Tree, UnexpectedCharacters, UnexpectedToken

from symflex.quantities.lalr import END, Grammar, Reading, UnexpectedError
from tests.tools.tables import larks, written

LARKS = larks()
WORDS = [
    *"()+-*/^=.' ", "**", "2", "0.5e-3", "1", ".5", "pi", "kg", "m", "w''", "arm.y", "\u00b7", "\u00b2",
    "\u2009", "#", "_a", "\u03c0",
]  # fmt: skip


@pytest.fixture(params=LARKS, ids=lambda path: path.parent.name)
def path(request):
    return request.param


class Named:
    """Builds of each rule its name and its parts."""

    def __getattr__(self, name):
        return lambda *parts: (name, *parts)


def texts():
    random = Random(7)
    return [random.choice(["", " "]).join(random.choices(WORDS, k=random.randint(1, 7))) for _ in range(1500)]


def plain(value):
    return (str(value.data), *map(plain, value.children)) if isinstance(value, Tree) else str(value)


def plain_parts(value):
    return tuple(map(plain_parts, value)) if isinstance(value, tuple) else str(value)


def by_lark(lark, text, start):
    try:
        return plain(lark.parse(text, start=start))
    except UnexpectedCharacters as error:
        return error.pos_in_stream, None
    except UnexpectedToken as error:
        token = error.token
        expected = lark.options.lexer == "basic" and error.expected
        return (END if token.type == END else token.start_pos), token.type, str(token), expected


def by_tables(grammar, text, start, *, is_basic):
    reading = Reading(grammar, text, start)
    try:
        for _ in reading.words():
            pass
        return plain_parts(reading.end())
    except UnexpectedError as error:
        token = error.token
        if token is None:
            return error.start, None
        place = END if token.type == END else error.start
        return place, token.type, str(token), is_basic and error.expected


def test_the_tables_are_those_that_lark_makes_of_the_grammar(path):
    assert path.read_text(encoding="utf-8") == written(LARKS[path])


def test_texts_are_read_and_refused_as_lark_does(path):
    lark = LARKS[path]
    is_basic = lark.options.lexer == "basic"
    grammar = Grammar(path, Named(), is_contextual=not is_basic)
    for text in texts():
        for start in grammar.starts:
            assert by_tables(grammar, text, start, is_basic=is_basic) == by_lark(lark, text, start), text
