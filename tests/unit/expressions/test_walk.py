import pickle
import sys
from fractions import Fraction

from hypothesis import given, settings

from symflex.expressions import (
    Attribute,
    Call,
    Derivative,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    fold,
    format_expression,
    names,
    parse,
    parse_equation,
    substitute,
)
from tests.unit.expressions.trees import SHAPE_LIMITS, trees
from tests.unit.quantities.texts import text_of

a, b, c, x = (Name(name) for name in "abcx")


def tree(value):
    return parse(text_of(value))


def test_names_come_in_order_of_appearance_as_often_as_they_appear():
    found = names(tree("b*sin(a) - motor.i/w'' + a^w'(l)"))
    expected = (b, Call("sin", a), a, Attribute("motor", "i"), Derivative("w", 2), a)
    assert found == (*expected, Call("w", Name("l"), 1), Name("l"))


def test_names_keep_their_places():
    assert [str(name.span) for name in names(tree("k*(a - k)"))] == ["a.toml:1:1", "a.toml:1:4", "a.toml:1:8"]


def test_names_of_an_equation_are_those_of_both_sides():
    assert names(parse_equation(text_of("a = b"))) == (a, b)


def test_a_number_has_no_names():
    assert names(tree("2 + 3")) == ()


@settings(max_examples=25)
@given(trees)
def test_names_appear_in_the_order_of_the_printed_text(expression):
    read = parse(text_of(format_expression(expression)), limits=SHAPE_LIMITS)
    starts = [name.span.start for name in names(read)]
    assert starts == sorted(starts)


def test_substitution_replaces_names_all_at_once_and_simplifies_nothing():
    for written, mapping, expected in [
        ("x", {"x": "a + b"}, "a + b"),
        ("x + c", {"x": "a + b"}, "a + b + c"),
        ("c*x", {"x": "a*b"}, "c*a*b"),
        ("c*x", {"x": "a + b"}, "c*(a + b)"),
        ("c - x", {"x": "a + b"}, "c - (a + b)"),
        ("x^2", {"x": "-a"}, "(-a)^2"),
        ("a/x", {"x": "b/c"}, "a/(b/c)"),
        ("-x", {"x": "-a"}, "--a"),
        ("x + 0*x", {"x": "0"}, "0 + 0*0"),
        ("a*b", {"a": "b", "b": "a"}, "b*a"),
        ("w''(x) + w'", {"x": "l/2", "w": "a"}, "w''(l/2) + w'"),
        ("sin(x)*motor.i", {"x": "a", "motor.i": "b", "sin": "c", "motor": "c", "i": "c"}, "sin(a)*b"),
    ]:
        found = substitute(tree(written), {name: tree(value) for name, value in mapping.items()})
        assert found == tree(expected), (written, mapping)


def test_substitution_reaches_both_sides_of_an_equation():
    found = substitute(parse_equation(text_of("a = x")), {"x": b, "a": c})
    assert found == parse_equation(text_of("c = b"))


def test_a_part_without_a_replaced_name_is_the_same_object():
    whole = tree("a*b + x")
    assert substitute(whole, {"x": c}).terms[0] is whole.terms[0]


def test_a_rebuilt_part_keeps_its_place():
    assert substitute(tree("c + a*x"), {"x": b}).terms[1].span.text == "a*x"


def test_the_original_is_left_as_it_was():
    whole = tree("a + x")
    substitute(whole, {"x": b})
    assert whole == tree("a + x")


@settings(max_examples=25)
@given(trees, trees)
def test_a_substituted_tree_is_printed_and_read_back_as_itself(expression, value):
    assert substitute(expression, {}) is expression
    bare = {name.name for name in names(expression) if isinstance(name, Name)}
    # Exponents stay small: this is about the shape, the limits have their own tests.
    if any(isinstance(node, Power) for node in _nodes(expression)):
        return
    found = substitute(expression, dict.fromkeys(bare, value))
    assert parse(text_of(format_expression(found)), limits=SHAPE_LIMITS) == found


def _nodes(expression):
    pending, found = [expression], []
    while pending:
        node = pending.pop()
        found.append(node)
        pending.extend(node.children)
    return found


def test_trees_deeper_than_the_interpreter_can_call_are_walked():
    deep, expected, depth = x, Number(Fraction(1)), 2 * sys.getrecursionlimit()
    for _ in range(depth):
        deep, expected = Negative(Quotient(deep, a)), Negative(Quotient(expected, b))
    found = substitute(deep, {"x": Number(Fraction(1)), "a": b})
    assert len(names(deep)) == depth + 1
    assert format_expression(found) == format_expression(expected)


def test_a_node_lists_its_operands():
    for node, children in [
        (a, ()),
        (Call("sin", a), (a,)),
        (Negative(a), (a,)),
        (Sum((a, b)), (a, b)),
        (Product((a, b)), (a, b)),
        (Quotient(a, b), (a, b)),
        (Power(a, b), (a, b)),
    ]:
        assert node.children == children, node


def test_a_node_forgets_its_hash_where_it_is_pickled_as_texts_have_others_in_another_process():
    node = tree("a*(b + c)")
    assert hash(node) == hash(tree("a*(b + c)"))
    assert not hasattr(pickle.loads(pickle.dumps(node)), "_hash")


def test_a_sum_that_is_in_a_tree_twice_is_valued_once():
    shared, seen = tree("a + b"), []
    values = {"a": 2, "b": 3}
    whole = Product((shared, Power(shared, Number(Fraction(2)))))

    def total(terms):
        seen.append(terms)
        return sum(terms)

    value = fold(
        whole,
        number=int,
        name=values.get,
        power=lambda base, exponent: base ** int(exponent.value),
        call=None,
        total=total,
    )
    assert (value, seen) == (5**3, [[2, 3]])
