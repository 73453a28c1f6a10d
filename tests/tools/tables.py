"""Makes the tables ``grammar.json`` of the grammars: ``python -m tests.tools.tables`` after a change."""

import json
from pathlib import Path

from lark import Lark

from symflex.quantities import grammar as quantities

ROOT = Path(__file__).resolve().parents[2] / "symflex"
EXPRESSIONS = ROOT / "expressions"


def larks():
    expressions = (EXPRESSIONS / "grammar.lark").read_text(encoding="utf-8")
    return {
        EXPRESSIONS / "grammar.json": Lark(
            expressions, parser="lalr", lexer="basic", start=["sum", "equation"]
        ),
        ROOT / "quantities" / "grammar.json": Lark(
            quantities.GRAMMAR, parser="lalr", start=["quantity", "unit"]
        ),
    }


def parts_of(rule):
    """Return the parts of a rule that its method is given, and which of them are lists of parts."""
    return [
        [i, not s.is_term and s.name.startswith("_")]
        for i, s in enumerate(rule.expansion)
        if not (s.is_term and s.filter_out)
    ]


def table_of(lark):
    lexer = lark.parser.lexer
    lexer = getattr(lexer, "root_lexer", lexer)
    table = lark.parser.parser._parse_table
    place = {rule: i for i, rule in enumerate(lark.rules)}
    # States get their numbers in the order in which they are reached, as Lark's differ from run to run.
    numbers = {}
    waiting = [table.start_states[name] for name in sorted(table.start_states)]
    while waiting:
        state = waiting.pop(0)
        if state in numbers:
            continue
        numbers[state] = len(numbers)
        actions = table.states[state]
        waiting += [actions[n][1] for n in sorted(actions) if isinstance(actions[n][1], int)]
    return {
        "terminals": {t.name: t.pattern.to_regexp() for t in lexer.terminals},
        "ignored": sorted(lexer.ignore_types),
        "starts": {
            name: [numbers[first], numbers[table.end_states[name]]]
            for name, first in sorted(table.start_states.items())
        },
        "rules": [
            [
                rule.origin.name,
                len(rule.expansion),
                parts_of(rule),
                "" if rule.origin.name.startswith("_") else rule.alias or str(rule.origin.name),
                bool(rule.options.expand1 and not rule.alias),
            ]
            for rule in lark.rules
        ],
        "states": [
            {
                name: numbers[arg] if isinstance(arg, int) else ~place[arg]
                for name, (_, arg) in sorted(table.states[state].items())
            }
            for state in numbers
        ],
    }


def written(lark):
    return json.dumps(table_of(lark), ensure_ascii=False, separators=(",", ":")) + "\n"


if __name__ == "__main__":
    for path, lark in larks().items():
        path.write_text(written(lark), encoding="utf-8")
