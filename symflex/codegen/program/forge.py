"""The workbench on which programs are made: every expression exists once, so that shared parts are shared.

Expressions are numbers of nodes in a table. The operands of a node there are numbers too, of nodes that stand
before it; so nothing here recurs, however deep a polynomial nests.

    forge.multiply([forge.s, forge.parameter("k")])    0: Laplace()
                                                       1: ParameterValue('k')
                                                       2: Multiply((1, 0)), parameters first
    forge.multiply([forge.parameter("k"), forge.s])    2 again

In the end straight-line code is made of them: some values get a name, in the order of the table.

    k*(k + s)^2 + b*k*(k + s)    becomes    c_1 = b*k             free of s: once a call
                                            t_1 = k + s           used more than once
                                            k*(t_1*t_1) + c_1*t_1
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from enum import IntFlag
from fractions import Fraction
from functools import reduce
from operator import or_
from typing import Any, cast

from symflex.codegen.program import nodes as tree


class Depends(IntFlag):
    """What a value varies with, besides parameters."""

    PARAMETERS = 0
    S = 1
    INVERSE = 2


@dataclass
class Forge:
    """Makes expressions; equal ones get the same number."""

    nodes: list[tree.CodeNode] = field(default_factory=list)
    depends: list[Depends] = field(default_factory=list)
    labels: dict[int, str] = field(default_factory=dict)
    # Makes what stands in place of s, where functions are of a root of it.
    root: Callable[[Forge, int], int] | None = None
    _numbers: dict[tree.CodeNode, int] = field(default_factory=dict)

    def operands(self, x: int) -> tuple[int, ...]:
        """Return what an expression is made of."""
        return cast("tuple[int, ...]", self.nodes[x].children)

    def make(self, kind: Callable[..., tree.CodeNode], *operands: Any) -> int:  # noqa: ANN401 (numbers of nodes)
        """Return a node of a kind, with what it holds."""
        node = kind(*operands)
        if node in self._numbers:
            return self._numbers[node]
        x = len(self.nodes)
        self.nodes.append(node)
        leaves = {tree.Laplace: Depends.S, tree.InverseLaplace: Depends.INVERSE}
        of_leaf = leaves.get(type(node), Depends.PARAMETERS)
        self.depends.append(reduce(or_, (self.depends[o] for o in self.operands(x)), of_leaf))
        self._numbers[node] = x
        return x

    def constant(self, value: Fraction | int, pi_power: int = 0) -> int:
        """Return ``value * pi**pi_power``."""
        exact = Fraction(value)
        if exact == 0:
            pi_power = 0
        number = self.make(tree.RealNumber, abs(exact), pi_power)
        return self.negate(number) if exact < 0 else number

    def ratio(self, value: Fraction) -> int:
        """Return a quotient of two integers."""
        return self.divide(self.constant(value.numerator), self.constant(value.denominator))

    def complex_number(self, real: Fraction | int, imaginary: Fraction | int) -> int:
        """Return ``real + 1j*imaginary``."""
        return self.make(tree.ComplexNumber, Fraction(real), Fraction(imaginary))

    def to_complex(self, x: int) -> int:
        """Return a real number as a complex one; see :class:`nodes.ToComplex`."""
        minus, size = self.signed(x)
        if self.is_number(size, 0):
            return size
        number = self.complex_number(1, 0) if self.is_number(size, 1) else self.make(tree.ToComplex, size)
        return self.negate(number) if minus else number

    def parameter(self, name: str) -> int:
        """Return a parameter."""
        return self.make(tree.ParameterValue, name)

    @property
    def s(self) -> int:
        """The Laplace variable, or the root that stands in place of it."""
        s = self.make(tree.Laplace)
        return s if self.root is None else self.root(self, s)

    @property
    def inverse(self) -> int:
        """The quotient 1/s."""
        return self.make(tree.InverseLaplace)

    def is_number(self, x: int, value: int) -> bool:
        """Tell whether ``x`` is the given non-negative integer."""
        node = self.nodes[x]
        return isinstance(node, tree.RealNumber) and node.value == value and not node.pi_power

    def signed(self, x: int) -> tuple[bool, int]:
        """Return whether ``x`` is minus something, and that."""
        return (True, self.operands(x)[0]) if isinstance(self.nodes[x], tree.Negate) else (False, x)

    def negate(self, x: int) -> int:
        """Return minus ``x``."""
        is_negative, inner = self.signed(x)
        if is_negative or self.is_number(inner, 0):
            return inner
        return self.make(tree.Negate, x)

    def add(self, terms: Iterable[int]) -> int:
        """Return a sum; a term without minus sign comes first when there is one."""
        kept = [t for t in terms if not self.is_number(t, 0)]
        if not kept:
            return self.constant(0)
        first = next((i for i, t in enumerate(kept) if not self.signed(t)[0]), None)
        if first is None:
            return self.negate(self.add([self.negate(t) for t in kept]))
        kept.insert(0, kept.pop(first))
        return kept[0] if len(kept) == 1 else self.make(tree.Add, tuple(kept))

    def multiply(self, factors: Sequence[int]) -> int:
        """Return a product, its parameters multiplied first, so that they are multiplied once per call."""
        is_negative = False
        free: list[int] = []
        bound: list[int] = []
        for factor in factors:
            minus, size = self.signed(factor)
            is_negative ^= minus
            if self.is_number(size, 0):
                return size
            if not self.is_number(size, 1):
                (bound if self.depends[size] else free).append(size)
        parts = ([self._product(free)] if free else []) + bound
        product = self._product(parts) if parts else self.constant(1)
        return self.negate(product) if is_negative else product

    def _product(self, factors: Sequence[int]) -> int:
        return factors[0] if len(factors) == 1 else self.make(tree.Multiply, tuple(factors))

    def divide(self, above: int, below: int) -> int:
        """Return a quotient."""
        minus_above, numerator = self.signed(above)
        minus_below, denominator = self.signed(below)
        quotient = numerator
        if not self.is_number(denominator, 1) and not self.is_number(numerator, 0):
            quotient = self.make(tree.Divide, numerator, denominator)
        return quotient if minus_above == minus_below else self.negate(quotient)

    def power(self, base: int, exponent: int) -> int:
        """Return a non-negative integer power; what depends on s is multiplied out, squares first."""
        if exponent == 0:
            return self.constant(1)
        if exponent == 1 or self.is_number(base, 1):
            return base
        is_negative, size = self.signed(base)
        if is_negative:
            power = self.power(size, exponent)
            return self.negate(power) if exponent % 2 else power
        if not self.depends[base]:
            return self.make(tree.IntegerPower, base, exponent)
        if exponent % 2:
            return self._product([self.power(base, exponent - 1), base])
        half = self.power(base, exponent // 2)
        return self._product([half, half])

    def apply(self, function: str, argument: int) -> int:
        """Return an elementary function."""
        return self.make(tree.Apply, function, argument)

    def solutions(self, coefficients: Sequence[int], terms: int) -> tuple[int, ...]:
        """Return a differential equation's solutions at 1; see :class:`nodes.Solutions`."""
        row = self.label(self.make(tree.Solutions, tuple(coefficients), terms), "solutions")
        return tuple(self.item(row, k) for k in range(len(coefficients)))

    def item(self, values: int, position: int) -> int:
        """Return one value of a list."""
        return self.make(tree.Item, values, position)

    def label(self, x: int, name: str) -> int:
        """Ask for an assignment of ``x``; the first name given stays."""
        if self.operands(x):
            self.labels.setdefault(x, name)
        return x


DEEPEST = 8  # nesting from which an intermediate value gets a name, for the reader's sake and the parser's


def schedule(
    forge: Forge, parameters: tuple[str, ...], near: int, far: int | None, limit: float
) -> tree.Piecewise:
    """Return the program that computes ``near``, or ``far`` where ``abs(s)`` exceeds ``limit``."""
    return _Schedule(forge, near, far).program(parameters, limit)


def schedule_all(
    forge: Forge, parameters: tuple[str, ...], near: Sequence[int], far: Sequence[int] | None, limit: float
) -> tree.Piecewise:
    """Return the program that computes several values, which share what they have in common."""
    run = _Schedule(forge, near[0], None)
    every = [*near, *(far or ())]
    late = set() if far is None else run.reached(list(far)) - run.reached(list(near))
    constants, at_near, at_far = run.sections(every, late, shared=True)
    first = tree.Straight(constants, at_near, tuple(run.nodes[x] for x in near))
    if far is None:
        return tree.lumped(parameters, first, None, limit)
    second = tree.Straight(constants, at_near + at_far, tuple(run.nodes[x] for x in far))
    return tree.lumped(parameters, first, second, limit)


def straight(forge: Forge, values: Sequence[int]) -> tree.Straight:
    """Return the code that computes several values."""
    run = _Schedule(forge, values[0], None)
    constants, assignments, _ = run.sections(list(values), set(), shared=True)
    return tree.Straight(constants, assignments, tuple(run.nodes[v] for v in values))


@dataclass
class _Schedule:
    forge: Forge
    near: int
    far: int | None
    nodes: dict[int, tree.CodeNode] = field(default_factory=dict)
    depth: dict[int, int] = field(default_factory=dict)
    taken: dict[str, int] = field(default_factory=dict)

    def program(self, parameters: tuple[str, ...], limit: float) -> tree.Piecewise:
        roots = [x for x in (self.near, self.far) if x is not None]
        late = set() if self.far is None else self.reached([self.far]) - self.reached([self.near])
        constants, at_near, at_far = self.sections(roots, late)
        near, far = tree.Straight(constants, at_near, (self.nodes[self.near],)), None
        if self.far is not None:
            far = tree.Straight(constants, at_near + at_far, (self.nodes[self.far],))
        return tree.lumped(parameters, near, far, limit)

    def sections(
        self, roots: list[int], late: set[int], *, shared: bool = False
    ) -> tuple[tuple[tree.Assignment, ...], tuple[tree.Assignment, ...], tuple[tree.Assignment, ...]]:
        """Return assignments free of s, those with s, and those in ``late``; expressions go to ``nodes``."""
        reached = self.reached(roots)
        uses = self._uses(reached)
        sections: tuple[list[tree.Assignment], list[tree.Assignment], list[tree.Assignment]] = ([], [], [])
        for x in sorted(reached):
            operands, free = self.forge.operands(x), self.forge.depends[x] == Depends.PARAMETERS
            node = self.forge.nodes[x].with_children(self.nodes[o] for o in operands)
            deep = 1 + max(self.depth[o] for o in operands) if operands else 0
            wanted = roots.count(x)  # more than once by a matrix that is symmetric
            is_inner = not wanted or (shared and uses[x][0] + wanted > 1)
            is_minus = isinstance(node, tree.Negate)
            is_plain = not operands or (is_minus and not self.forge.operands(operands[0]))
            is_hoisted = free and uses[x][1] and not is_minus
            is_shared = uses[x][0] + wanted > 1
            has_name = x in self.forge.labels or is_shared or is_hoisted or deep > DEEPEST
            if is_inner and has_name and not is_plain:
                section = 0 if not self.forge.depends[x] else 2 if x in late else 1
                name = self._name(x)
                sections[section].append(tree.Assignment(name, node))
                node, deep = tree.Assigned(name), 0
            self.nodes[x], self.depth[x] = node, deep
        constants, early, after = (tuple(section) for section in sections)
        return constants, early, after

    def reached(self, roots: list[int]) -> set[int]:
        """Return the expressions that some are made of, these among them."""
        visited: set[int] = set()
        pending = list(roots)
        while pending:
            x = pending.pop()
            if x not in visited:
                visited.add(x)
                pending += self.forge.operands(x)
        return visited

    def _uses(self, reached: set[int]) -> dict[int, tuple[int, bool]]:
        """Return how often each expression is used, and whether something that depends on s uses it."""
        counts = dict.fromkeys(reached, (0, False))
        for x in reached:
            for operand in self.forge.operands(x):
                count, hoisted = counts[operand]
                counts[operand] = (count + 1, hoisted or bool(self.forge.depends[x]))
        return counts

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
