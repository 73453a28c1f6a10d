"""Specifications written to harm: each ends soon, in little memory, with a documented exit code.

Every case runs in a process of its own that may use 512 MB of address space and 20 s of processor time; texts
that are refused at sight (towers of powers, deep nesting) get 1 s.
Nothing a specification says may run: no payload succeeds in making the file ``canary``. Nothing it says may
drive a terminal: all output is printable. There is never a traceback.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.golden.limited import MEGABYTE, environment, run

pytest.importorskip("resource", reason="limits of processes are needed")

DOCUMENTED = {0, 2, 3, 5}


def symflex(folder, *arguments, seconds=20):
    code, written = run(folder, *arguments, seconds=seconds)
    printed = written.decode()
    assert code in DOCUMENTED, printed[-2000:]
    assert "Traceback" not in printed
    assert all(c.isprintable() or c == "\n" for c in printed)
    assert len(printed) < 200_000
    assert not (Path(folder) / "canary").exists()
    return code, printed


def check(folder, text, seconds=20):
    (Path(folder) / "spec.toml").write_bytes(text if isinstance(text, bytes) else text.encode())
    return symflex(folder, "check", "spec.toml", seconds=seconds)


def model(
    output="x", *, parameters="", definitions="", elements="", signals="", stiffness='"k"', blocks="", end=""
):
    """Return a mass on a spring with one output, and what else is given."""
    return f"""symflex = 1
[parameters]
m = "2 kg"
k = "95 kN/m"
{parameters}
[definitions]
{definitions}
[elements]
body = {{ type = "mass", at = "x", m = "m" }}
spring = {{ type = "spring", between = ["x", "ground"], k = {stiffness} }}
{elements}
[signals]
{signals}
[blocks]
{blocks}
[inputs]
F = {{ force = "x" }}
[outputs]
X = "{output}"
{end}"""


def lines(template, count, start=0):
    return "\n".join(template.format(i=i, before=i - 1, after=i + 1) for i in range(start, count))


EIGHT = "a+b+c+d+e+f+g+h"
EIGHT_SYMBOLS = "\n".join(f"{c} = {{}}" for c in "abcdefgh")

EXPRESSIONS = {
    "a tower of powers of two": "2^2^2^2^2^2*x",
    "a tower of powers of nine": "9^9^9^9*x",
    "a tower of powers of a name": "x*m^9^9^9",
    "a hundred thousand parentheses": "(" * 100_000 + "x" + ")" * 100_000,
    "a hundred thousand minus signs": "-" * 100_000 + "x",
    "nine thousand minus signs": "-" * 9_000 + "x",
    "nested calls": "sin(" * 2_000 + "m" + ")" * 2_000 + "*x",
    "primes": "x" + "'" * 9_000,
    "nine thousand digits": "1" * 9_000 + "*x",
    "a huge decimal exponent": "1e999999999*x",
    "a huge power of one": "1^999999999*x",
    "a fraction as large as allowed, often": "+".join(["7e200/3e200*x"] * 700),
    "five hundred different fractions": "x*(" + "+".join(f"1/(k+{i})" for i in range(500)) + ")",
    "five hundred filters": "+".join(f"x/(s+{i})" for i in range(1, 500)),
    "six hundred quotients in a row": "/".join(["x", *(f"(k+{i}*m)" for i in range(600))]),
    "five hundred functions": "(" + "+".join(f"sqrt(k+{i}*m)" for i in range(500)) + ")*x",
    "twelve hundred unknown names": "+".join(f"q{i}" for i in range(1_200)),
    "dots": "x" + ".x" * 3_000,
    "a name of five thousand letters": "a" * 5_000,
    "every character of Latin 1": "".join(chr(c) for c in range(0xA0, 0x100)),
    "Python that makes a file": "__import__('os').system('touch canary')",
    "a format string": "{0.__class__.__mro__}",
    "dunder attributes": "x.__class__",
}


def test_a_hostile_expression_is_answered(tmp_path):
    for name, expression in EXPRESSIONS.items():
        at_sight = name.startswith(("a tower", "a hundred thousand"))
        code, _ = check(tmp_path, model(expression), seconds=1 if at_sight else 20)
        assert code == 3 or not at_sight, name


def test_a_sum_of_eight_to_the_64th_plus_one_is_refused_as_too_large(tmp_path):
    # It has binomial(71, 7) terms, 1.3e9.
    expression = f"(({EIGHT})^64 + 1)*x"
    code, printed = check(tmp_path, model(expression, parameters=EIGHT_SYMBOLS))
    assert code == 5
    assert "SF501" in printed


def test_a_sum_of_eight_to_the_64th_plus_one_as_a_stiffness_is_answered(tmp_path):
    check(tmp_path, model(stiffness=f'"k*(({EIGHT})^64+1)"', parameters=EIGHT_SYMBOLS))


CHAINS = {
    "powers of powers": (12, '"a+1"', '"Z{before}^64 + 1"'),
    "squares of squares": (64, '"a+1"', '"Z{before}*Z{before}"'),
    "doubled sums": (64, '"a+1"', '"Z{before} + a*Z{before}"'),
    "doubled quotients": (64, '"a+1"', '"1/(Z{before} + 1/Z{before})"'),
    "roots of roots": (300, '"a+1"', '"sqrt(Z{before} + 1)"'),
    "minus signs": (900, '"a"', '"-Z{before}"'),
}


def test_a_chain_of_definitions_is_answered(tmp_path):
    for count, first, step in CHAINS.values():
        chain = f"Z0 = {first}\n" + lines("Z{i} = " + step, count, 1)
        check(tmp_path, model(f"Z{count - 1}*x", parameters="a = 2", definitions=chain))
    check(tmp_path, model(f"sqrt(Z{count - 1})*x", parameters="a = 2", definitions=chain))


@pytest.mark.slow
def test_ten_thousand_definitions_from_last_to_first_are_answered_and_in_a_circle_refused(tmp_path):
    chain = "\n".join(f'Z{i} = "Z{i - 1} + k"' for i in range(10_000, 0, -1))
    check(tmp_path, model("x", definitions=f'{chain}\nZ0 = "k"'))
    code, printed = check(tmp_path, model("x", definitions=f'{chain}\nZ0 = "Z9999"'))
    assert code == 3
    assert "SF215" in printed


# What is refused before much is built of it, and what is built of many parts.
REFUSED = {
    "twenty thousand elements": model(
        elements="\n".join(f's{i} = {{ type = "pin" }}' for i in range(20_000))
    ),
    "eighty million transfer functions": "symflex = 1\n[inputs]\n"
    + lines("F{i} = {{}}", 9_000)
    + "\n[outputs]\n"
    + lines('X{i} = "F{i}"', 9_000),
    "nineteen thousand unknown keys": "symflex = 1\n" + lines("paramet{i} = 1", 19_000),
    "ten thousand misspelt keys and types": model(
        elements=lines('s{i} = {{ type = "sprin", betwen = 1, z = 2, y= 3 }}', 3_500)
    ),
    "a spring between nineteen thousand nodes": model(
        elements='w = { type = "spring", between = [' + ",".join(f'"n{i}"' for i in range(19_000)) + "] }"
    ),
    "five thousand unknown names among five thousand": model(
        end=lines('Y{i} = "q{i}*x"', 5_000), parameters=lines("p{i} = 1", 5_000)
    ),
}
BUILT = {
    "a chain of a thousand masses": model(
        elements=lines(
            's{i} = {{ type = "spring", between = ["y{i}", "y{after}"], k = "k" }}\n'
            'm{i} = {{ type = "mass", at = "y{i}", m = "m" }}',
            1_000,
        )
        + '\nlast = { type = "mass", at = "y1000", m = "m" }'
    ),
    "three thousand parameters in one sum": model(
        "x", elements=lines('s{i} = {{ type = "spring", between = ["x", "ground"], k = "p{i}" }}', 3_000)
    ).replace("[definitions]", lines("p{i} = 1", 3_000) + "\n[definitions]"),
    "transformers that learn their domain from the last": model(
        elements=lines('t{i} = {{ type = "transformer", from = "n{after}", to = "n{i}", ratio = 2 }}', 1_000)
        + '\nlast = { type = "mass", at = "n1000", m = "m" }'
    ),
    "fifteen thousand signals, the first defined last": model(
        "u0", signals=lines('u{i} = "u{after}"', 15_000) + '\nu15000 = "F"'
    ),
    "signals whose units double their exponents": model(
        "u0", signals=lines('u{i} = "u{after}*u{after} + u{i}"', 1_000) + '\nu1000 = "F"'
    ),
    "a dense loop of signals": model(
        "u0",
        signals="\n".join(
            f'u{i} = "F + ' + " + ".join(f"u{j}/{i + j + 2}" for j in range(1, 60, 3)) + '"'
            for i in range(60)
        ),
    ),
    "published formulas of all of two thousand transfer functions": "symflex = 1\n[inputs]\n"
    + lines("F{i} = {{}}", 45)
    + "\n[outputs]\n"
    + lines('X{i} = "F0"', 45)
    + "\n[published]\n"
    + "\n".join(f'"X{i % 45}/F{i // 45}" = {{ expr = "1" }}' for i in range(2_000)),
    "four thousand coefficients": model(
        "G*x", blocks='G = { type = "tf", num = [' + "1," * 4_000 + "1], den = [" + "2," * 4_000 + "1] }"
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("texts", [REFUSED, BUILT], ids=["refused", "built"])
def test_a_specification_of_many_parts_is_answered(texts, tmp_path):
    for text in texts.values():
        check(tmp_path, text)


def test_a_megabyte_of_one_character_piece_or_value_is_answered(tmp_path):
    for piece in ("#", "[", "\0", '"""', "a\n", "[[a]]\n", '"\\u"'):
        check(tmp_path, piece * (1_000_000 // len(piece)))
    for piece in ("[1,", "{a=", "1_"):
        check(tmp_path, "symflex = 1\ntitle = " + piece * (990_000 // len(piece)))


TOML = {
    "nested arrays": "v = " + "[" * 100_000 + "]" * 100_000,
    "nested inline tables": "v = " + "{a=" * 100_000 + "1" + "}" * 100_000,
    "brackets around a header": "[" * 100_000 + "a" + "]" * 100_000,
    "a dotted key of a hundred thousand parts": ".".join(["a"] * 100_000) + " = 1",
    "a dotted header of a hundred thousand parts": "[" + ".".join(["a"] * 100_000) + "]",
    "half a million digits": "v = " + "1" * 500_000,
    "half a million digits in a quantity": '[parameters]\nm = "' + "1" * 500_000 + ' kg"',
    "a huge exponent": "[parameters]\nm = 1e999999999",
    "a huge exponent in a quantity": '[parameters]\nm = "1e999999999 kg"',
    "a huge power of a unit": '[parameters]\nm = "1 kg^999999999"',
    "ninety parentheses around a unit": '[parameters]\nm = "1 ' + "(" * 90 + "kg" + ")" * 90 + '"',
    "a hexadecimal number of four hundred thousand digits": "v = 0x" + "f" * 400_000,
    "a date that does not exist": "v = 9999-99-99T99:99:99.999999999999999Z",
    "an escape beyond Unicode": 'v = "\\UFFFFFFFF"',
    "half of a surrogate pair": 'v = "\\ud800"',
}


def test_hostile_toml_is_refused(tmp_path):
    for name, text in TOML.items():
        code, _ = check(tmp_path, f"symflex = 1\n{text}\n", seconds=1)
        assert code == 3, name


PAYLOADS = {
    "Python": "__import__('os').system('touch canary')",
    "a format string": "{0.__class__.__init__.__globals__}",
    "a shell command": "$(touch canary); `touch canary` | touch canary %s%n%(x)s%",
    "LaTeX": r"\write18{touch canary}\input{/etc/passwd}",
    "terminal escapes": "\x1b[2J\x1b]0;owned\x07\x9b31m",
    "control characters": "a\0b\x08\x7f\x85\r",
    "right-to-left overrides": "a\u202eb\u2066c\u200bd\ufeff",
    "line separators and markup": "a\nb\u2028c\u2029d<script>alert(1)</script>[red]x[/red]",
    "a very long text": "a" * 20_000,
    "emoji and private characters": "\U0001f600\ue000\U0010ffff",
}


def quoted(payload):
    """Return a TOML string that holds exactly the payload."""
    return '"' + "".join(c if c.isalnum() and c.isascii() else f"\\U{ord(c):08x}" for c in payload) + '"'


def everywhere(p):
    """Return a specification that bears the quoted payload wherever text is read."""
    return f"""{p} = {p}
symflex = 1
title = {p}
source = {p}
doc = {p}
[parameters]
{p} = 1
m = {p}
n = {{ value = {p}, unit = {p}, latex = {p}, doc = {p}, assume = {p}, {p} = 1 }}
[definitions]
{p} = {p}
D = {{ expr = {p}, latex = {p} }}
[elements]
{p} = {{ type = {p} }}
a = {{ type = {p}, at = {p} }}
b = {{ type = "mass", at = {p}, m = {p}, {p} = {p} }}
c = {{ type = "spring", between = [{p}, {p}], k = {p} }}
d = {{ type = "force_source", at = "x", f = {p} }}
[signals]
{p} = {p}
u = {p}
[blocks]
{p} = {p}
B = {{ type = {p} }}
G = {{ type = "model", spec = {p}, tf = {p} }}
R = {{ type = "tf", num = [{p}], den = {p} }}
[inputs]
{p} = {{ force = {p} }}
F = {{ force = {p}, unit = {p}, latex = {p} }}
[outputs]
{p} = {p}
X = {{ expr = {p}, latex = {p} }}
[analysis]
band = [{p}, {p}]
modes = {p}
{p} = 1
[figures.{p}]
kind = {p}
[figures.f]
kind = {p}
of = [{p}]
title = {p}
[published.{p}]
expr = {p}
scale = {p}
where = {{ {p} = {p} }}
[fields.{p}]
domain = {p}
[{p}]
{p} = {p}
"""


def test_a_payload_in_every_place_of_a_specification_is_refused_and_does_nothing(tmp_path):
    for name, payload in PAYLOADS.items():
        code, _ = check(tmp_path, everywhere(quoted(payload)))
        assert code == 3, name
        code, printed = symflex(tmp_path, "check", "--json", "spec.toml")
        assert (code, json.loads(printed)["ok"]) == (3, False), name


def test_a_payload_where_any_text_may_stand_is_accepted_and_does_nothing(tmp_path):
    for name, payload in PAYLOADS.items():
        text = f"title = {quoted(payload)}\nsource = {quoted(payload)}\n" + model()
        code, _ = check(tmp_path, text)
        assert code == 0, name


NAMES = {
    "Python keywords": "lambda class def None True False import yield async match self print exec eval",
    "names the program uses": "sum0 sum1 x0 A B C D E I S N O Q det num den stand_in value node",
    "names of functions": "sin cos sqrt exp log tanh atan abs max",
    "names of other languages": "int double while end function end_ inf nan NaN j i e",
}


def test_ordinary_names_with_another_meaning_elsewhere_are_accepted_everywhere(tmp_path):
    names = " ".join(NAMES.values()).split()
    for at in range(0, len(names), 5):
        parameter, definition, node, signal, element = (names * 5)[at : at + 5]
        text = f"""symflex = 1
[parameters]
{parameter} = "2 kg"
[definitions]
{definition} = "2*{parameter}"
[elements]
{element} = {{ type = "mass", at = "{node}", m = "{definition}" }}
push = {{ type = "force_source", at = "{node}", f = "{signal}" }}
[signals]
{signal} = "-3*{node}"
[inputs]
{names[0]} = {{ force = "{node}" }}
[outputs]
{names[-1]} = "{signal} + {element}.f"
"""
        code, printed = check(tmp_path, text)
        assert (code, "SF211" in printed) in {(0, False), (3, True)}, printed


def test_names_with_a_meaning_in_expressions_cannot_be_declared(tmp_path):
    for section, name in [("parameters", "s"), ("definitions", "pi"), ("signals", "ground")]:
        code, printed = check(tmp_path, model(**{section: f'{name} = "3"'}))
        assert (code, "SF213" in printed) == (3, True), (section, name)


def test_a_byte_order_mark_and_windows_line_ends_are_accepted(tmp_path):
    code, _ = check(tmp_path, b"\xef\xbb\xbf" + model().replace("\n", "\r\n").encode())
    assert code == 0


def test_what_is_not_utf_8_is_refused(tmp_path):
    for name, data in {
        "UTF-16": b"\xff\xfe" + model().encode("utf-16-le"),
        "a lone continuation byte": b"\x80",
        "a broken sequence": model().encode() + b"\xc3(",
        "every byte": bytes(range(256)) * 1_000,
    }.items():
        code, printed = check(tmp_path, data)
        assert (code, "SF901" in printed) == (3, True), name


def make_fifo(path):
    os.mkfifo(path)


def make_loop(path):
    path.symlink_to(path.name)


def make_huge(path):
    with path.open("wb") as file:
        file.truncate(100 * MEGABYTE)


SPECIAL = {
    "a pipe": make_fifo,
    "a folder": Path.mkdir,
    "a link to itself": make_loop,
    "a link to nothing": lambda path: path.symlink_to("nowhere"),
    "a link to an endless device": lambda path: path.symlink_to("/dev/zero"),
    "a file of 100 MB": make_huge,
    "a file that may not be read": lambda path: path.touch(mode=0),
}


def test_what_is_no_ordinary_small_file_is_refused_on_its_own_and_in_a_model_block(tmp_path):
    for number, (name, make) in enumerate(SPECIAL.items()):
        make(tmp_path / f"special_{number}.toml")
        code, printed = symflex(tmp_path, "check", f"special_{number}.toml")
        assert code in {2, 3}, name
        assert "SF901" in printed or "SF200" in printed, name  # the superuser reads every file: it is empty
        blocks = f'G = {{ type = "model", spec = "special_{number}.toml", tf = "X/F" }}'
        code, _ = check(tmp_path, model("G*x", blocks=blocks))
        assert code == 3, name


def test_a_model_block_of_a_hostile_path_is_refused(tmp_path):
    paths = ["/dev/zero", "/dev/stdin", "/proc/self/mem", "../" * 500 + "dev/zero", "a/" * 3_000]
    for path in [*paths, "", ".", "~", "\\u0000"]:
        code, _ = check(tmp_path, model(blocks=f'G = {{ type = "model", spec = "{path}", tf = "X/F" }}'))
        assert code == 3, path


def test_model_blocks_that_multiply_from_file_to_file_are_answered(tmp_path):
    for count in (1, 50):
        for level in range(12):
            spec = f"level{level + 1}.toml"
            blocks = lines(f'G{{i}} = {{{{ type = "model", spec = "{spec}", tf = "X/F" }}}}', count)
            text = model("G0*x", blocks=blocks) if level < 11 else model()
            (tmp_path / f"level{level}.toml").write_text(text)
        code, printed = symflex(tmp_path, "check", "level0.toml")
        assert (code, "SF103" in printed) == (3, True), count


@pytest.mark.slow
def test_a_file_whose_name_is_not_utf_8_is_accepted(tmp_path):
    name = os.fsdecode(b"\xff\x1b[31m.toml")
    try:
        (tmp_path / name).write_text(model())
    except OSError:
        pytest.skip("this file system has names in UTF-8 only")
    # From the start of Python, which decodes what it is called with.
    command = [sys.executable, "-m", "symflex", "check", name]
    done = subprocess.run(command, cwd=tmp_path, env=environment(), capture_output=True, check=False)
    assert done.returncode == 0, done.stderr


def dense(value):
    """Return thirty masses, each joined to each by a spring."""
    pairs = [(i, j) for i in range(30) for j in range(i)]
    springs = "\n".join(
        f's{i}_{j} = {{ type = "spring", between = ["n{i}", "n{j}"], k = {value(i, j)} }}' for i, j in pairs
    )
    masses = lines('m{i} = {{ type = "mass", at = "n{i}", m = 1 }}', 30)
    parameters = "\n".join(f"k{i}_{j} = {{}}" for i, j in pairs)
    return (
        f"symflex = 1\n[parameters]\n{parameters}\n[elements]\n{springs}\n{masses}\n"
        '[inputs]\nF = { force = "n0" }\n[outputs]\nX = "n29"\n'
    )


def test_the_closed_form_of_a_dense_network_of_thirty_masses_is_refused_as_too_large(tmp_path):
    (tmp_path / "spec.toml").write_text(dense(lambda i, j: 30 * i + j + 1 if j else f'"k{i}_{j}"'))
    code, printed = symflex(tmp_path, "derive", "spec.toml", "--representation", "expanded")
    assert code == 5
    assert "error[SF5" in printed


@pytest.mark.slow
def test_a_dense_network_of_thirty_masses_has_a_nested_form(tmp_path):
    code, _ = check(tmp_path, dense(lambda i, j: f'"k{i}_{j}"'))
    assert code == 0
    code, printed = symflex(tmp_path, "derive", "spec.toml")
    assert code == 0
    assert "in nested form: " in printed
