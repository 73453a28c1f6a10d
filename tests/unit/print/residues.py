"""Printed forms and kernels read as numbers of a prime field: equal functions have equal residues.

Parameters, s and the exponentials of the arguments are random residues; square roots are roots in the field,
and of parameters, which are of odd order, ``sqrt(x*y) = sqrt(x)*sqrt(y)`` as of positive numbers; ``exp(a*q +
b*j*q)`` is ``E^a*z^b``. Two rational functions of these that differ agree at a random point with odds of
about their degree over the prime, 1e-16. Entries of a fundamental matrix are random residues of their own.
"""

from itertools import combinations
from random import Random

from sympy.ntheory import sqrt_mod

from symflex.expressions import Call, Name, Negative, Number, Power, Product, Quotient, Sum
from symflex.model.along import varies_along_x

PRIME = 2**61 + 294569
"""One more than eight times an odd number; 2, 3, 5 and 7 are of odd order."""
ODD = (PRIME - 1) // 8
UNIT = sqrt_mod(-1, PRIME)
REACH = 8


class NoRootError(Exception):
    """A square root is not in the field: another point must be tried."""


def inverse(x):
    return pow(x, -1, PRIME)


def is_of_odd_order(x):
    return pow(x, ODD, PRIME) == 1


def root(x):
    """Return a square root; of a residue of odd order the one that is multiplicative."""
    if is_of_odd_order(x):
        return pow(x, (ODD + 1) // 2, PRIME)
    found = sqrt_mod(x % PRIME, PRIME)
    if found is None:
        raise NoRootError
    return found


class Point:
    """Random residues for one transfer function, and its exact value there."""

    def __init__(self, tf, seed):
        self._random = Random(seed)
        self.values = {"s": self.draw(), "pi": self.draw()}
        self.values |= {p.name: self.draw() for p in tf.model.parameters}
        self._parameters = set(self.values)
        self._exponentials = {0: 1}
        self._solutions = {}
        for d in tf.model.definitions:
            self.values.setdefault(d.name, self.read(d.expression, {}))
        self.truth = self._of_kernels(tf)

    def draw(self):
        return pow(self._random.randrange(2, PRIME), 8, PRIME)

    def _of_kernels(self, tf):
        """Return the transfer function's value by the definitions of its kernels."""
        values = dict(self.values)
        constants = (c for c in tf.constants if not varies_along_x(c.expression))
        values |= {c.generator: self.read(c.expression, {}) for c in constants}
        for d in tf.kernels.dispersions:
            c = [self._product(x, values) for x in d.characteristic]
            if d.kind == "bending":
                if not is_of_odd_order(c[0]):
                    raise NoRootError
                found = [root(root(c[0] * inverse(4)))]
            elif d.kind == "wave":
                found = [root(-c[0])]
            elif d.kind == "pair":
                split = root(c[2] ** 2 * inverse(4) - c[0])
                found = [root(split - c[2] * inverse(2)), root(-split - c[2] * inverse(2))]
            else:
                found = []
            values |= dict(zip(d.wavenumbers, found, strict=True))
        for kernel in tf.kernels.kernels:
            length = self._product(kernel.length, values)
            if kernel.function == "fundamental":
                values[kernel.generator] = self._solution(kernel.order, length)
                continue
            if kernel.function == "entry":
                law = kernel.dispersion
                row, column = divmod(kernel.order, law.order)
                (start,) = (self._product(x, values) for x in law.start)
                values[kernel.generator] = self._solution(f"Z_{row + 1}{column + 1}", start + length)
                continue
            if kernel.function == "exp":
                argument = -self._product(kernel.dispersion.shift, values) * length
            else:
                argument = values[kernel.wavenumber] * length
            self._learn(argument, circular=kernel.dispersion.kind == "bending")
            values[kernel.generator] = self._function(kernel.function, argument)
        halves = {}
        for k in (k for k in tf.kernels.kernels if k.wavenumber):
            half = values[k.wavenumber] * self._product(k.length, values) * inverse(2) % PRIME
            halves.setdefault(k.wavenumber, {})[half] = k.dispersion.kind == "bending"
        for own in halves.values():
            self._learn_sums(list(own), circular=any(own.values()))
        return self._product(tf.ratio, values)

    def _learn(self, argument, *, circular):
        """Draw ``exp(argument/2)``, and ``exp(j*argument/2)``; know their multiples."""
        half = argument * inverse(2) % PRIME
        if half in self._exponentials:
            return
        e, z = self.draw(), self.draw() if circular else 1
        for a in range(-REACH, REACH + 1):
            for b in range(-REACH, REACH + 1) if circular else (0,):
                key = (a + b * UNIT) * half % PRIME
                self._exponentials[key] = pow(e, a, PRIME) * pow(z, b, PRIME) % PRIME

    def _learn_sums(self, halves, *, circular):
        """Know the exponentials of sums of arguments and of differences, which forms may be written in."""
        both = [(x, -y) for pair in combinations(halves, 2) for x, y in (pair, pair[::-1])]
        for n in range(2, min(len(halves), 4) + 1):
            for parts in (*combinations(halves, n), *both * (n == 2)):
                for a in range(-REACH, REACH + 1):
                    for b in range(-REACH, REACH + 1) if circular else (0,):
                        turn, value = a + b * UNIT, 1
                        for half in parts:
                            value = value * self._exponentials[turn * half % PRIME] % PRIME
                        self._exponentials.setdefault(turn * sum(parts) % PRIME, value)

    def _exp(self, argument):
        if argument % PRIME not in self._exponentials:  # of a parameter
            self._learn(argument, circular=False)
        return self._exponentials[argument % PRIME]

    def _function(self, name, argument):
        if name == "exp":
            return self._exp(argument)
        if name == "sqrt":
            return root(argument)
        if name in ("tanh", "tan"):
            return self._function(f"sin{name[3:]}", argument) * inverse(
                self._function(f"cos{name[3:]}", argument)
            )
        x = argument * (UNIT if name in ("cos", "sin") else 1)
        up, down = self._exp(x), self._exp(-x)
        if name in ("cosh", "cos"):
            return (up + down) * inverse(2) % PRIME
        return (up - down) * inverse(2 * (UNIT if name == "sin" else 1)) % PRIME

    def _solution(self, order, at):
        return self._solutions.setdefault((order, at % PRIME), self.draw())

    def _product(self, value, values):
        total = value.unit.numerator * inverse(value.unit.denominator)
        for factor, exponent in value.factors:
            number = 0
            for monomial, coefficient in factor.terms():
                term = int(coefficient)
                for name, power in zip(value.ring.names, monomial, strict=True):
                    if power:
                        term = term * pow(values[name], int(power), PRIME) % PRIME
                number += term
            total = total * pow(number % PRIME, exponent, PRIME) % PRIME
        return total % PRIME

    def form(self, num, den, where):
        """Return the value of a printed form."""
        lines = dict(where)
        assert len(lines) == len(where)
        assert not set(lines) & self._parameters
        return self.read(num, lines) * inverse(self.read(den, lines)) % PRIME

    def read(self, expression, lines):
        """Return the value of an expression."""
        match expression:
            case Number(value):
                return value.numerator * inverse(value.denominator) % PRIME
            case Name(name) if name in lines:
                rest = {k: e for k, e in lines.items() if k != name}
                return self.read(lines[name], rest)
            case Name(name):
                return self.values[name]
            case Negative(operand):
                return -self.read(operand, lines) % PRIME
            case Sum(terms):
                return sum(self.read(t, lines) for t in terms) % PRIME
            case Product(factors):
                product = 1
                for factor in factors:
                    product = product * self.read(factor, lines) % PRIME
                return product
            case Quotient(above, below):
                return self.read(above, lines) * inverse(self.read(below, lines)) % PRIME
            case Power(base, Number(value)):
                return pow(self.read(base, lines), value.numerator, PRIME)
            case Call(name, argument, order) if order or name.startswith("h"):
                return self._solution(order, self.read(argument, lines))
            case Call(name, argument) if name.startswith("Z_"):
                return self._solution(name, self.read(argument, lines))
            case Call(name, argument):
                return self._function(name, self.read(argument, lines))
        raise TypeError(type(expression).__name__)


def point_for(tf, seed=1, tries=400):
    """Return a point where every square root is in the field."""
    for i in range(tries):
        try:
            return Point(tf, seed * tries + i)
        except NoRootError:
            continue
    message = "no point found"
    raise AssertionError(message)
