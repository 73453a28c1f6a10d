"""Plant faults in the derivation and the print, and see whether the program's two own checks notice them.

    python -m tests.planted --sample 200

changes a sign, drops a factor or swaps two arguments in one place at a time of the modules that derive and
print, and derives and prints every file of derivations/ with each change, in all forms. A change counts as
noticed where SF991 or SF992 is raised, as broken where another error is, as none where nothing printed is
different; the rest is shown with its place. No test takes part.
"""

from __future__ import annotations

import argparse
import ast
import importlib.abc
import importlib.util
import json
import subprocess
import sys
from collections import Counter
from pathlib import Path
from random import Random

ROOT = Path(__file__).resolve().parents[1]
MODULES = ("symflex/transfer", "symflex/equations", "symflex/print/forms", "symflex/algebra/propagators.py")
SPARED = {"direct_solve.py", "against_equations.py", "read_back.py", "probes.py", "__init__.py"}
"""The checks themselves, and what holds no arithmetic."""
LONG = {"two_link_arm", "six_mass", "portal_frame", "fitted_resonances", "polynomial_resonance"}
"""Derivations that take two thirds of the time, and go the ways of others."""
SEED = 37
CHECKS = {"SF991", "SF992"}


class Places(ast.NodeTransformer):
    """Counts the places of a module that can be changed, and changes the one with a number."""

    def __init__(self, wanted: int = -1) -> None:
        self.wanted, self.count, self.line, self.depth = wanted, 0, 0, 0

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
            self.line = getattr(node, "lineno", 0)
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


def printed(path: Path) -> list[str]:
    """Return everything that is printed of a model."""
    from symflex import pipeline
    from symflex.errors import UsageError
    from symflex.print.forms import FORMS, print_form
    from symflex.print.text import derive_text
    from symflex.transfer import bind_any

    found, model = [], pipeline.load(path)
    for tf in pipeline.derive_all(model):
        found.append(str(bind_any(tf)(0.7 + 0.9j)))
        for form in (None, *FORMS):
            try:
                found.append(derive_text(tf, print_form(tf, form), 80))
            except UsageError:  # the function has no such form
                continue
    return found


def run(before: dict[str, list[str]] | None) -> tuple[str, dict[str, list[str]]]:
    """Print all derivations; return what came of it, and all prints where there are none to compare with."""
    found: dict[str, list[str]] = {}
    for path in sorted((ROOT / "derivations").rglob("*.toml"), key=lambda p: p.stat().st_size):
        if path.name == "claims.toml" or path.stem in LONG:
            continue
        try:
            found[path.stem] = printed(path)
        except Exception as error:  # noqa: BLE001 (whatever a fault leads to is one of the answers)
            codes = {d.code for d in getattr(error, "diagnostics", ())}
            return ("noticed" if codes & CHECKS else f"broken: {type(error).__name__}"), found
        if before is not None and found[path.stem] != before[path.stem]:
            return f"different: {path.stem}", found
    return "none", found


def main() -> None:
    """Plant faults, one a process, and print the shares."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sample", type=int, default=200)
    parser.add_argument("--one", nargs=3, metavar=("MODULE", "NUMBER", "BEFORE"))
    given = parser.parse_args()
    if given.one:
        module, number, before = given.one
        name = ".".join(Path(module).with_suffix("").parts)
        text, _ = changed(ROOT / module, int(number))
        if int(number) >= 0:
            sys.meta_path.insert(0, Changed(name, text))
        known = json.loads(Path(before).read_text(encoding="utf-8")) if Path(before).exists() else None
        verdict, found = run(known)
        if known is None:
            Path(before).write_text(json.dumps(found), encoding="utf-8")
        print(verdict)
        return
    before = ROOT / "build" / "planted.json"
    before.parent.mkdir(exist_ok=True)
    before.unlink(missing_ok=True)
    one = (sys.executable, "-m", "tests.planted", "--one")
    subprocess.run((*one, "symflex/transfer/derive.py", "-1", str(before)), cwd=ROOT, check=True)
    files = [
        p for m in MODULES for p in sorted([ROOT / m] if m.endswith(".py") else (ROOT / m).rglob("*.py"))
    ]
    places = []
    for path in files:
        if path.name not in SPARED:
            counted = Places()
            counted.visit(ast.parse(path.read_text(encoding="utf-8")))
            places += [(str(path.relative_to(ROOT)), n) for n in range(counted.count)]
    verdicts: Counter[str] = Counter()
    Random(SEED).shuffle(places)
    for module, number in places:
        if sum(verdicts.values()) - verdicts["none"] >= given.sample:
            break
        try:
            done = subprocess.run(
                (*one, module, str(number), str(before)),
                cwd=ROOT,
                capture_output=True,
                text=True,
                timeout=120,
                check=False,
            )
            verdict = (done.stdout.strip().splitlines() or ["broken: ended"])[-1]
        except subprocess.TimeoutExpired:
            verdict = "broken: too long"
        verdicts[verdict.partition(":")[0]] += 1
        print(f"{verdict:40} {module}:{changed(ROOT / module, number)[1]} ({number})", flush=True)
    print(f"{len(places)} places; tried: {dict(verdicts)}")
    told = verdicts["noticed"] + verdicts["different"]
    print(f"noticed by the checks: {verdicts['noticed']} of {told} that print something else")


if __name__ == "__main__":
    main()
