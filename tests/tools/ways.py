"""The two ways to poles and zeros held against each other: by the closed form, and by the equations.

Input: files of specifications and folders of them, and how many random models. Without any, the worked models
of ``derivations`` and the templates.
Output: a line for each transfer function: whether both ways agree, else in what they differ, and the seconds
of processor time of either. The exit code is 1 where two proved facts contradict each other, or a way fails.

Ways agree if they prove the same roots, multiplicities, hidden modes and words of stability. Enclosures of
one root overlap; where they do not, one way is wrong. A way proves less if it has no certificate, or does not
know whether the model is stable.

Examples
--------
>>> text = (FOLDERS[1] / "mass_spring.toml").read_text("utf-8")
>>> [line.outcome for line in compared("mass_spring", text, seconds=10)]
['agrees', 'agrees']
"""

from __future__ import annotations

import argparse
import re
import sys
from collections import Counter
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from random import Random
from time import process_time
from typing import TYPE_CHECKING

from symflex import pipeline
from symflex.budget import GB, Budget
from symflex.errors import SymflexError
from symflex.roots.locate import locate
from symflex.roots.region import Modes
from symflex.roots.root import Root, overlap
from symflex.transfer import bind
from symflex.transfer.nested_form import bind_nested
from symflex.transfer.of_model import derive_all, derive_nested
from tests import random_models
from tests.house.repository import ROOT, specifications

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from symflex.model import Model
    from symflex.roots.pole_zero_map import PoleZeroMap

FOLDERS = (ROOT / "derivations", ROOT / "symflex" / "templates")
DIGITS, MODES, MEMORY = 15, 5, 3 * GB
RANDOM = (
    ("members", lambda seed: random_models.random_members(seed, most=3)),  # the formula of four takes minutes
    ("network", lambda seed: random_models.networks(Random(seed))),
    ("passive", lambda seed: random_models.passive_networks(Random(seed))),
)
WAYS = (  # the formula and the equations, of a model and a pair of output and input
    lambda model, pair: bind(derive_all(model, [pair])[0]),
    lambda model, pair: bind_nested(derive_nested(model, [pair])[0]),
)
AGREES, WORDS, LESS, REFUSED, DIFFERS = "agrees", "other words", "proves less", "refused", "differs"
BY_FORMULA = " (the equations proved too little, so that the formula was asked)"


@dataclass(frozen=True)
class Line:
    """A line of the table."""

    name: str
    outcome: str  # one of the words above, and what differs
    seconds: tuple[float, ...] = (0.0, 0.0)  # of processor time, by formula and by equations

    def __str__(self) -> str:
        return f"{self.name:<56} {self.seconds[0]:7.2f} {self.seconds[1]:7.2f}  {self.outcome}"


def contradictions(one: PoleZeroMap, other: PoleZeroMap) -> list[str]:
    """Return which facts two ways prove that cannot both be true.

    Examples
    --------
    >>> from symflex.roots.pole_zero_map import find_pole_zero_map
    >>> from symflex.roots.problem import RootProblem
    >>> poles = (RootProblem.from_rationals([k, 0, 1]) for k in (4, 9))
    >>> one, other = (find_pole_zero_map("x/F", each, RootProblem(())) for each in poles)
    >>> contradictions(one, one), contradictions(one, other)
    ([], ['poles 0 + 2.000j / 0 + 3.000j'])
    """
    words, counts = ([getattr(m.verdict, key) for m in (one, other)] for key in ("word", "right"))
    wrong = []
    if "unknown" not in words and words[0] != words[1]:
        wrong = [f"verdicts {words[0]} / {words[1]}"]
    if None not in counts and counts[0] != counts[1]:
        wrong.append(f"poles in the right half-plane {counts[0]} / {counts[1]}")
    every = [_roots(m) for m in (one, other)]
    certified = [m.certificate.certified for m in (one, other)]
    for what in every[0]:
        sides, alone = [roots[what] for roots in every], [[], []]
        if all(certified):
            alone = [_alone(*sides), _alone(*reversed(sides))]
        elif any(certified):  # what is proved of single roots must be among all that there are
            part, whole = certified.index(False), certified.index(True)
            most = max((float(r.size().lower()) for r in sides[whole]), default=0.0)
            proved = [r for r in sides[part] if r.certified and r.size() < most]
            alone[part] = _alone(proved, [*chain(*every[whole].values())])
        if any(alone):
            wrong.append(f"{what} {_shown(alone[0])} / {_shown(alone[1])}")
    return wrong


def _roots(found: PoleZeroMap) -> dict[str, Sequence[Root]]:
    return {"poles": found.poles, "zeros": found.zeros, "hidden modes": [h.root for h in found.hidden]}


def _alone(ones: Sequence[Root], others: Sequence[Root]) -> list[Root]:
    """Return the roots that are not in another list, as often."""

    def times(root: Root, among: Sequence[Root]) -> int:
        return sum(other.multiplicity for other in among if overlap(root, other))

    return [root for root in ones if times(root, others) < times(root, ones)]


def _shown(roots: Sequence[Root]) -> str:
    shown = [(root.decimal(4), root.multiplicity) for root in roots if not root.im < 0]
    return ", ".join(f"{x.re} + {x.im}j" + f" ({n} times)" * (n > 1) for x, n in shown[:4]) or "none"


def _judged(one: PoleZeroMap, other: PoleZeroMap) -> str:
    """Return the outcome of two ways that both found something."""
    if wrong := contradictions(one, other):
        return f"{DIFFERS}: {'; '.join(wrong)}"
    reasons = [m.certificate.reason or "certified" for m in (one, other)]
    same = one.certificate.engine == other.certificate.engine and one.is_infinite
    said = [] if one.certificate.certified == other.certificate.certified else [" / ".join(reasons)]
    if one.verdict.word != other.verdict.word:
        said.append(f"{one.verdict.sentence} / {other.verdict.sentence}")
    if said:
        return f"{LESS}: {'; '.join(said)}" + BY_FORMULA * same
    if one.verdict.to_json_dict() != other.verdict.to_json_dict():
        texts = (f"{m.verdict.sentence}; {m.verdict.hidden_motion}" for m in (one, other))
        return f"{WORDS}: {' / '.join(texts)}"
    return AGREES + BY_FORMULA * same


def _compared(name: str, model: Model, pair: tuple[str, str], seconds: float) -> Line:
    found: list[PoleZeroMap] = []
    times, refused = [], []
    region = Modes(MODES) if model.is_distributed else None
    for derived in WAYS:
        begin = process_time()
        try:
            with Budget(seconds, clock=process_time, memory=MEMORY).entered():
                found.append(locate(derived(model, pair), region, DIGITS))
            refused.append("-")
        except SymflexError as error:
            refused.append(f"{error.diagnostics[0].code}: {error.diagnostics[0].message}")
        except (ArithmeticError, AssertionError, LookupError, TypeError, ValueError) as error:
            return Line(name, f"{DIFFERS}: {type(error).__name__}: {error}")
        times.append(process_time() - begin)
    outcome = _judged(*found) if len(found) == len(WAYS) else f"{REFUSED}: {' / '.join(refused)}"
    return Line(name, outcome, tuple(times))


def compared(name: str, text: str, seconds: float) -> Iterator[Line]:
    """Compare the ways for every transfer function of a specification."""
    try:
        model = pipeline.loads(text, name)
    except SymflexError as error:
        return iter([Line(name, f"{REFUSED}: {error.diagnostics[0].code} at loading")])
    return (_compared(f"{name} {'/'.join(p)}", model, p, seconds) for p in model.transfer_functions)


def models(paths: Sequence[Path], seeds: Sequence[int]) -> Iterator[tuple[str, str]]:
    """Yield the names and texts of specifications in files and folders, and of random models."""
    for path in paths:
        for file in specifications(path, "**/*.toml") if path.is_dir() else [path]:
            yield str(file), file.read_text("utf-8")
    for seed in seeds:
        kind, recipe = RANDOM[seed % len(RANDOM)]
        yield f"{kind} {seed}", random_models.to_toml(recipe(seed))


def main() -> int:
    """Print the table and its summary."""
    parser = argparse.ArgumentParser(prog="python -m tests.tools.ways")
    parser.add_argument("paths", nargs="*", type=Path, help="specifications, or folders of them")
    parser.add_argument("--random", type=int, default=0, metavar="N", help="this many random models besides")
    parser.add_argument("--first", type=int, default=0, metavar="SEED", help="the first of them")
    parser.add_argument("--seconds", type=float, default=30.0, help="processor time of each way, at most")
    given = parser.parse_args()
    paths, lines = given.paths or (() if given.random else FOLDERS), list[Line]()
    print(f"{'transfer function':<56} formula equations [s]")
    for name, text in models(paths, range(given.first, given.first + given.random)):
        for line in compared(name, text, given.seconds):
            print(line, flush=True)
            lines.append(line)
    counts = Counter(re.split(r":| \(", line.outcome)[0] for line in lines)
    print(f"{len(lines)} transfer functions: " + ", ".join(f"{n} {kind}" for kind, n in counts.most_common()))
    print("seconds:", *(f"{sum(x.seconds[i] for x in lines):.1f}" for i in range(len(WAYS))))
    return int(DIFFERS in counts)


if __name__ == "__main__":
    sys.exit(main())
