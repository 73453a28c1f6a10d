"""From expressions to straight-line code: which values get a name, and in which order they are computed.

k*(k + s)^2 + b*k*(k + s)    becomes    c_1 = b*k             free of s: once a call
t_1 = k + s           used more than once
k*(t_1*t_1) + c_1*t_1
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from symflex.codegen.program.forge import Depends
from symflex.codegen.program.nodes import Assigned, Assignment, CodeNode, Negate, Piecewise, Straight, lumped

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.codegen.program.forge import Forge

DEEPEST = 8
"""Nesting from which an intermediate value gets a name, for the reader's sake and the parser's."""


def schedule(
    forge: Forge, parameters: tuple[str, ...], near: int, far: int | None, limit: float
) -> Piecewise:
    """Return the program that computes ``near``, or ``far`` where ``abs(s)`` exceeds ``limit``."""
    return _Schedule(forge, near, far).program(parameters, limit)


def straight(forge: Forge, values: Sequence[int]) -> Straight:
    """Return the code that computes several values."""
    run = _Schedule(forge, values[0], None)
    constants, assignments, _ = run.sections(list(values), set(), shared=True)
    return Straight(constants, assignments, tuple(run.nodes[v] for v in values))


@dataclass
class _Schedule:
    forge: Forge
    near: int
    far: int | None
    nodes: dict[int, CodeNode] = field(default_factory=dict)
    depth: dict[int, int] = field(default_factory=dict)
    taken: dict[str, int] = field(default_factory=dict)

    def program(self, parameters: tuple[str, ...], limit: float) -> Piecewise:
        roots = [x for x in (self.near, self.far) if x is not None]
        late = set() if self.far is None else self._reached([self.far]) - self._reached([self.near])
        constants, at_near, at_far = self.sections(roots, late)
        near = Straight(constants, at_near, (self.nodes[self.near],))
        if self.far is None:
            return lumped(parameters, near)
        return lumped(parameters, near, Straight(constants, at_near + at_far, (self.nodes[self.far],)), limit)

    def sections(
        self, roots: list[int], late: set[int], *, shared: bool = False
    ) -> tuple[tuple[Assignment, ...], tuple[Assignment, ...], tuple[Assignment, ...]]:
        """Return assignments free of s, those with s, and those in ``late``; expressions go to ``nodes``.

        With ``shared``, a root that others are made of is assigned as well.
        """
        reached = self._reached(roots)
        uses = self._uses(reached)
        sections: tuple[list[Assignment], list[Assignment], list[Assignment]] = ([], [], [])
        for x in sorted(reached):
            node, deep = self._node(x)
            is_inner = x not in roots or (shared and uses[x][0] > 0)
            if is_inner and self._deserves_name(x, (uses[x][0] + (x in roots), uses[x][1]), deep):
                section = 0 if not self.forge.depends[x] else 2 if x in late else 1
                name = self._name(x)
                sections[section].append(Assignment(name, node))
                node, deep = Assigned(name), 0
            self.nodes[x], self.depth[x] = node, deep
        constants, early, after = (tuple(section) for section in sections)
        return constants, early, after

    def _reached(self, roots: list[int]) -> set[int]:
        found: set[int] = set()
        pending = list(roots)
        while pending:
            x = pending.pop()
            if x not in found:
                found.add(x)
                pending += self.forge.operands(x)
        return found

    def _uses(self, reached: set[int]) -> dict[int, tuple[int, bool]]:
        """Return how often each expression is used, and whether something that depends on s uses it."""
        counts = dict.fromkeys(reached, (0, False))
        for x in reached:
            for operand in self.forge.operands(x):
                count, hoisted = counts[operand]
                counts[operand] = (count + 1, hoisted or bool(self.forge.depends[x]))
        return counts

    def _deserves_name(self, x: int, uses: tuple[int, bool], deep: int) -> bool:
        operands = self.forge.operands(x)
        is_minus = isinstance(self.forge.nodes[x], Negate)
        if not operands or (is_minus and not self.forge.operands(operands[0])):
            return False
        count, used_with_s = uses
        is_free = self.forge.depends[x] == Depends.PARAMETERS
        is_hoisted = is_free and used_with_s and not is_minus
        return x in self.forge.labels or count > 1 or is_hoisted or deep > DEEPEST

    def _name(self, x: int) -> str:
        wanted = self.forge.labels.get(x)
        if wanted is not None and wanted not in self.taken:
            self.taken[wanted] = 1
            return wanted
        stem = "c" if not self.forge.depends[x] else "t"
        while True:
            count = self.taken[stem] = self.taken.get(stem, 0) + 1
            if (name := f"{stem}_{count}") not in self.taken:
                self.taken[name] = 1
                return name

    def _node(self, x: int) -> tuple[CodeNode, int]:
        operands = self.forge.operands(x)
        deep = 1 + max(self.depth[o] for o in operands) if operands else 0
        return self.forge.nodes[x].with_children(self.nodes[o] for o in operands), deep
