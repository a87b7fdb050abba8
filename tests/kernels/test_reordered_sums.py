"""Sums in any order: the same bits wherever the arrays lie in memory."""

import ast

from bearingwear.provenance import PACKAGE


def is_whole_number(value: ast.expr) -> bool:
    """Returns whether a term of a sum is written as a whole number, or as a choice of two."""
    if isinstance(value, ast.IfExp):
        return is_whole_number(value.body) and is_whole_number(value.orelse)
    return isinstance(value, ast.Constant) and isinstance(value.value, int)


def sums_and_stores(loop: ast.For) -> bool:
    """Returns whether an innermost loop adds to a float variable and writes to an array."""
    body = [node for statement in loop.body for node in ast.walk(statement)]
    if any(isinstance(node, ast.For) for node in body):
        return False
    sums = any(
        isinstance(node, ast.AugAssign)
        and isinstance(node.target, ast.Name)
        and not is_whole_number(node.value)
        for node in body
    )
    stores = any(isinstance(n, ast.Subscript) and isinstance(n.ctx, ast.Store) for n in body)
    return sums and stores


def functions_that_sum_and_store(source: str) -> list[str]:
    """Returns the names of fastmath functions with a loop that sums and stores."""
    names = []
    for function in ast.walk(ast.parse(source)):
        if not isinstance(function, ast.FunctionDef):
            continue
        options = [k.arg for d in function.decorator_list for k in getattr(d, "keywords", ())]
        loops = (node for node in ast.walk(function) if isinstance(node, ast.For))
        if "fastmath" in options and any(map(sums_and_stores, loops)):
            names.append(function.name)
    return names


def test_no_fastmath_loop_sums_and_stores():
    """Its order of summation, and so its bits, would depend on where the arrays lie in memory."""
    kernels = sorted((PACKAGE / "kernels").rglob("*.py"))
    assert kernels
    for path in kernels:
        assert functions_that_sum_and_store(path.read_text()) == [], path


def test_a_fastmath_loop_that_sums_and_stores_is_detected():
    body = "    for j in range(3):\n        a[j] = b[j]\n        s += a[j]\n"
    assert functions_that_sum_and_store("@jit(fastmath=X)\ndef f(a, b, s):\n" + body) == ["f"]
    assert functions_that_sum_and_store("@jit\ndef f(a, b, s):\n" + body) == []
