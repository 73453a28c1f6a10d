"""Numbers of a specification that a printed entry asks for, and how a person may have typed them."""

from math import sqrt

from symflex.audit.literals import WrittenNumber, literals_of, refits
from symflex.errors import Source, Span
from symflex.model import PrintedTable
from symflex.model.spec import TableValue
from symflex.model.spec.parse import parse


def numbers(text, name="T"):
    source = Source("model.toml", text)
    sections = {e.key: e.value for e in parse(source).root.entries if isinstance(e.value, TableValue)}
    table = PrintedTable(name, ("X", "F"), "poles", None, (), span=Span(source, 0, 0))
    return [(n.path, n.with_number("#"), n.row) for n in literals_of(sections, table)]


def offered(whole, printed, at):
    literal = WrittenNumber("k", whole, whole.split(maxsplit=1)[0], 0, 0)
    now = at(float(literal.text))
    return [(r.said, r.digits) for r in refits(literal, printed, at, now)]


def test_numbers_are_found_wherever_they_are_written():
    found = numbers(
        'symflex = 1\n[parameters]\nm = { value = "2 kg", range = ["1 kg", "3 kg"] }\nq = 3.5\n'
        '[definitions]\nA = "pi*d^2/4"\n[elements]\na = { type = "mass", at = "x_1", m = "4.5 g" }\n'
        '[tables.T]\nrows = [["1"], { set = { m = "5 kg" }, values = ["2"] }]'
    )
    assert found == [
        ("m", "# kg", None),
        ("q", "#", None),
        ("m in row 2", "# kg", 2),
        ("A", "pi*d^2/#", None),
        ("m of a", "# g", None),
    ]


def test_a_factor_and_exchanged_digits_are_said():
    # sqrt(52/3) = 4.16333, with 3 kg on k.
    assert ("k is twice the declared value", 2) in offered("26 N/m", "4.1633", lambda k: sqrt(k / 3))
    assert ("k is 62 N/m, not 26 N/m", 2) in offered("26 N/m", "4.5461", lambda k: sqrt(k / 3))


def test_a_number_without_influence_or_without_value_is_left_alone():
    assert offered("26 N/m", "4.1633", lambda _: 3.0) == []
    assert offered("26 N/m", "4.1633", lambda k: None if k > 26 else sqrt(k / 3)) == []
