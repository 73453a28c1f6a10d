"""Plant faults in the derivation and the print, and see whether the program's two own checks notice them.

    python -m tests.tools.planted --sample 200

changes a sign, drops a factor or swaps two arguments in one place at a time of the modules that derive and
print, and derives and prints with each change the files of derivations/ that come there, in all forms.
A change counts as

noticed     SF991 or SF992 is raised
broken      another error is, or it takes too long
value       a value is another, and neither check sees it
text        values are the same, and a print is another
refused     a form is refused that was printed, or the other way round
equal       nothing printed is different
unreached   no file comes there

No test takes part.
"""

from __future__ import annotations

import argparse
import ast
import importlib.abc
import importlib.util
import json
import os
import resource
import subprocess
import sys
from collections import Counter
from pathlib import Path
from random import Random
from time import process_time

ROOT = Path(__file__).resolve().parents[2]
MODULES = ("symflex/transfer", "symflex/equations", "symflex/print/forms", "symflex/algebra/propagators.py")
SPARED = {"direct_solve.py", "against_equations.py", "read_back.py", "probes.py", "__init__.py"}
"""The checks themselves, and what contains no arithmetic."""
LONG = {"two_link_arm", "six_mass", "portal_frame", "fitted_resonances", "polynomial_resonance"}
"""Derivations that take two thirds of the time, and go the ways of others."""
SEED = 37
CHECKS = {"SF991", "SF992"}
TOLD = ("noticed", "value", "text")
QUICK, EVERY = 3, 5
"""How many of the quickest files are run, and which share of the others."""
SECONDS = 60
"""Of the processor for one change."""


class Places(ast.NodeTransformer):
    """Counts the places of a module that can be changed, and changes the one with a number."""

    def __init__(self, wanted: int = -1) -> None:
        self.wanted, self.count, self.depth = wanted, 0, 0
        self.line = self.end = 0

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        self.depth += 1
        node.body = [self.visit(x) for x in node.body]
        self.depth -= 1
        return node

    def _is_here(self, node: ast.AST) -> bool:
        if not self.depth:
            return False
        self.count += 1
        if self.count - 1 == self.wanted:
            self.line, self.end = node.lineno, node.end_lineno
            return True
        return False

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        self.generic_visit(node)
        texts = any(isinstance(x, ast.Constant) and isinstance(x.value, str) for x in (node.left, node.right))
        if texts or isinstance(node.left, ast.JoinedStr) or isinstance(node.right, ast.JoinedStr):
            return node
        if isinstance(node.op, ast.Add | ast.Sub) and self._is_here(node):
            node.op = ast.Sub() if isinstance(node.op, ast.Add) else ast.Add()
        elif isinstance(node.op, ast.Mult) and self._is_here(node):
            return node.left
        elif isinstance(node.op, ast.Div) and self._is_here(node):
            node.op = ast.Mult()
        return node

    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.AST:
        self.generic_visit(node)
        is_number = isinstance(node.operand, ast.Constant)
        if isinstance(node.op, ast.USub) and not is_number and self._is_here(node):
            return node.operand
        return node

    def visit_Call(self, node: ast.Call) -> ast.AST:
        self.generic_visit(node)
        plain = len(node.args) == 2 and not any(isinstance(a, ast.Starred) for a in node.args)
        if plain and ast.dump(node.args[0]) != ast.dump(node.args[1]) and self._is_here(node):
            node.args.reverse()
        return node


def changed(module: Path, number: int) -> tuple[str, int]:
    """Return a module's text with one place changed, and its line."""
    places = Places(number)
    tree = places.visit(ast.parse(module.read_text(encoding="utf-8")))
    return ast.unparse(ast.fix_missing_locations(tree)), places.line


class Changed(importlib.abc.MetaPathFinder, importlib.abc.InspectLoader):
    """Imports one module from a text of its own."""

    def __init__(self, name: str, text: str) -> None:
        self.name, self.text = name, text

    def find_spec(self, fullname, path=None, target=None):
        return importlib.util.spec_from_loader(fullname, self) if fullname == self.name else None

    def get_source(self, fullname):
        return self.text


Prints = dict[str, str]
POINTS = (0.7 + 0.9j, -1.3 + 2.1j, 0.2 - 31j)
CLOSE = 1e-9
"""Parts by which values may differ that are rounded otherwise."""


def printed(path: Path) -> Prints:
    """Return everything that is printed of a model, and values, by name."""
    from symflex import pipeline
    from symflex.errors import SymflexError, UsageError
    from symflex.print.forms import FORMS, print_form
    from symflex.print.text import derive_text
    from symflex.transfer import bind_any

    found, model = {}, pipeline.load(path)
    for n, tf in enumerate(pipeline.derive_all(model)):
        for s in POINTS:
            try:
                found[f"{n} at {s}"] = str(bind_any(tf)(s))
            except SymflexError as error:  # has no value there, or parameters have none
                found[f"{n} at {s}"] = error.diagnostics[0].code
        for form in (None, *FORMS):
            try:
                found[f"{n} as {form}"] = derive_text([(tf, print_form(tf, form))], 80)
            except UsageError:  # the function has no such form
                continue
    return found


def files() -> list[Path]:
    """Return the files of derivations/ that are run, short ones first."""
    paths = sorted((ROOT / "derivations").rglob("*.toml"), key=lambda p: p.stat().st_size)
    return [p for p in paths if p.name != "claims.toml" and p.stem not in LONG]


class Lines:
    """Notes which lines of the modules run."""

    def __init__(self) -> None:
        self.wanted = tuple(str(ROOT / m) for m in MODULES)
        self.lines: set[tuple[str, int]] = set()

    def __call__(self, frame, event, arg):
        if not frame.f_code.co_filename.startswith(self.wanted):
            return None
        self.lines.add((frame.f_code.co_filename, frame.f_lineno))
        return self.inside

    def inside(self, frame, event, arg):
        self.lines.add((frame.f_code.co_filename, frame.f_lineno))
        return self.inside


def baseline() -> dict[str, dict]:
    """Return what is printed of each file without a change, which lines run, and how long it takes."""
    found = {}
    for path in files():
        lines = Lines()
        sys.settrace(lines)
        start = process_time()
        before = printed(path)
        sys.settrace(None)
        by_file: dict[str, list[int]] = {}
        for name, line in lines.lines:
            by_file.setdefault(str(Path(name).relative_to(ROOT)), []).append(line)
        found[path.stem] = {"prints": before, "lines": by_file, "seconds": process_time() - start}
    return found


def compared(found: Prints, before: Prints) -> str:
    """Return in which way prints differ, nothing where they do not."""
    kinds = {"": ""}
    for name in found.keys() | before.keys():
        one, other = found.get(name, ""), before.get(name, "")
        if one == other:
            continue
        if " as " in name:
            kinds["text" if one and other else "refused"] = name
            continue
        try:
            a, b = complex(one), complex(other)
            differ = abs(a - b) > CLOSE * abs(b)
        except ValueError:  # one of them is refused
            differ = True
        if differ:
            kinds["value"] = name
    kind = next(k for k in ("value", "refused", "text", "") if k in kinds)
    return f"{kind}: {kinds[kind]}" if kind else ""


def run(stems: list[str], before: dict[str, dict]) -> str:
    """Print the derivations with a name; return the worst that came of it."""
    worst = ""
    paths = {p.stem: p for p in files()}
    for stem in stems:
        try:
            found = printed(paths[stem])
        except Exception as error:  # noqa: BLE001 (whatever a fault leads to is one of the answers)
            codes = {d.code for d in getattr(error, "diagnostics", ())}
            if codes & CHECKS:
                return f"noticed: {stem}"
            return f"broken: {type(error).__name__} {' '.join(codes)} {stem}"
        told = compared(found, before[stem]["prints"])
        if told and (not worst or (told.startswith("value") and not worst.startswith("value"))):
            worst = f"{told} of {stem}"
    return worst or "equal"


def one(module: str, number: int, stems: list[str], before: dict[str, dict]) -> str:
    """Return what comes of one change, in a process of its own."""
    reader, writer = os.pipe()
    child = os.fork()
    if not child:
        os.close(reader)
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 1))
        resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))
        name = ".".join(Path(module).with_suffix("").parts)
        text, _ = changed(ROOT / module, number)
        sys.meta_path.insert(0, Changed(name, text))
        try:
            verdict = run(stems, before)
        except BaseException as error:  # noqa: BLE001 (imports, too)
            verdict = f"broken: {type(error).__name__}"
        os.write(writer, verdict.encode())
        os._exit(0)
    os.close(writer)
    with os.fdopen(reader, "rb") as pipe:
        verdict = pipe.read().decode()
    os.waitpid(child, 0)
    return verdict or "broken: too long"


def reached(module: str, number: int, before: dict[str, dict]) -> list[str]:
    """Return files that come to a place, quick ones first: of many a few."""
    places = Places(number)
    places.visit(ast.parse((ROOT / module).read_text(encoding="utf-8")))
    wanted = range(places.line, places.end + 1)
    stems = [k for k, v in before.items() if any(n in wanted for n in v["lines"].get(module, ()))]
    stems.sort(key=lambda k: before[k]["seconds"])
    return [*stems[:QUICK], *stems[QUICK::EVERY]]


def main() -> None:
    """Plant faults, one a process, and print the shares."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sample", type=int, default=200, help="changes that print something else")
    parser.add_argument("--baseline", metavar="FILE", help="write what is printed without a change, and end")
    parser.add_argument("--skip", type=int, default=0, help="places that were tried before")
    parser.add_argument("--only", nargs=2, metavar=("MODULE", "NUMBER"), help="try one place")
    given = parser.parse_args()
    if given.baseline:
        Path(given.baseline).write_text(json.dumps(baseline()), encoding="utf-8")
        return
    kept = ROOT / "build" / "planted.json"
    kept.parent.mkdir(exist_ok=True)
    if not (given.only or given.skip) or not kept.exists():
        command = (sys.executable, "-m", "tests.tools.planted", "--baseline", str(kept))
        subprocess.run(command, cwd=ROOT, check=True)
    before = json.loads(kept.read_text(encoding="utf-8"))
    modules = [
        p for m in MODULES for p in sorted([ROOT / m] if m.endswith(".py") else (ROOT / m).rglob("*.py"))
    ]
    places = []
    for path in modules:
        if path.name not in SPARED:
            counted = Places()
            counted.visit(ast.parse(path.read_text(encoding="utf-8")))
            places += [(str(path.relative_to(ROOT)), n) for n in range(counted.count)]
    Random(SEED).shuffle(places)
    if given.only:
        places = [(given.only[0], int(given.only[1]))]
    verdicts: Counter[str] = Counter()
    for module, number in places[given.skip :]:
        if sum(verdicts[k] for k in TOLD) >= given.sample:
            break
        stems = reached(module, number, before)
        verdict = one(module, number, stems, before) if stems else "unreached"
        verdicts[verdict.partition(":")[0]] += 1
        print(f"{verdict:40} {module}:{changed(ROOT / module, number)[1]} ({number})", flush=True)
    print(f"{len(places)} places; tried: {dict(verdicts)}")
    told = sum(verdicts[k] for k in TOLD)
    print(f"noticed by the checks: {verdicts['noticed']} of {told} that print something else")


if __name__ == "__main__":
    main()
