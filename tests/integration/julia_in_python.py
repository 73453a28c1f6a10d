"""Arithmetic of generated Julia code as Python, for machines without Julia: another reading of the same text.

Only what generated functions consist of is understood: assignments, ``if``, ``return``, calls and operators.
The two functions of the run-time text that need loops are written anew here.
"""

import cmath
import keyword
import math
import re

_FUNCTION = re.compile(r"^function (_\w+)\((.*?)\)\n(.*?)^end$", re.DOTALL | re.MULTILINE)
_SUPPORT = ("_mean_over_circle", "_series_solutions")
_ALLOWED = re.compile(r"[\w\s.,+\-*/^()<>=|\[\]]*")
_NAME = re.compile(r"\b[A-Za-z]\w*")
_SHARED = {"if", "return"}


def _either(name):
    def function(x):
        return getattr(cmath if isinstance(x, complex) else math, name)(x)

    return function


def _mean_over_circle(parts, s, points):
    values = []
    center = parts(s)[2]
    radius = parts(s)[3]
    for k in range(points):
        above, below, growth, _ = parts(s + radius * cmath.exp(2j * cmath.pi * (k + 0.5) / points))
        values.append((above * cmath.exp(growth - center), below * cmath.exp(growth - center)))
    return sum(a for a, _ in values) / sum(b for _, b in values)


def _series_solutions(c, terms):
    n = len(c)
    found = [0.0]  # positions are counted from 1
    for k in range(n):
        y = [1.0 if i == k else 0.0 for i in range(n)]
        while len(y) < terms:
            m = len(y) - n
            y.append(-sum(c[i] * y[m + i] for i in range(n)))
        found.append(sum(value / math.factorial(m) for m, value in enumerate(y)))
    return found


NAMES = {
    **{
        name: _either(name)
        for name in ("sqrt", "exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "atan")
    },
    "abs": abs,
    "complex": complex,
    "pi": math.pi,
    "NaN": math.nan,
    "ifelse": lambda test, first, second: first if test else second,
    "real": lambda x: complex(x).real,
    "conj": lambda x: complex(x).conjugate(),
    "signbit": lambda x: math.copysign(1.0, x) < 0,
    "_mean_over_circle": _mean_over_circle,
    "_series_solutions": _series_solutions,
}


def functions_of(text):
    """Return the private functions of a module by name."""
    space = {"__builtins__": {}, **NAMES}
    for name, arguments, body in _FUNCTION.findall(text):
        if name in _SUPPORT:
            continue
        source = _translated(name, *(_NAME.sub(_renamed, part) for part in (arguments, body)))
        exec(compile(source, name, "exec"), space)  # noqa: S102
    return space


def _renamed(name):
    """Return a name of Julia that is a keyword of Python otherwise."""
    word = name[0]
    return f"{word}_in_julia" if keyword.iskeyword(word) and word not in _SHARED else word


def _translated(name, arguments, body):
    assert _ALLOWED.fullmatch(body), body
    # What stands in parentheses may take several lines.
    joined = re.sub(r"(?<=[(+\-*/,])\n\s+", " ", body)
    joined = re.sub(r"\n\s+\)", ")", joined)
    lines = [f"def {name}({' '.join(arguments.split())}):"]
    for line in joined.splitlines():
        code = line.strip()
        indent = " " * (len(line) - len(line.lstrip()))
        if code == "end":
            continue
        if code.startswith("if "):
            code += ":"
        code = re.sub(r"(\w+) -> ", r"lambda \1: ", code).replace("^", "**").replace("||", "or")
        lines.append(indent + code)
    return "\n".join(lines)
