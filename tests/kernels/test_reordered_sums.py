"""Sums in any order: the same bits wherever the arrays lie in memory."""

import ast

from bearingwear.provenance import PACKAGE


def counts(value: ast.expr) -> bool:
    """Whether a term is a whole number."""
    if isinstance(value, ast.IfExp):
        return counts(value.body) and counts(value.orelse)
    return isinstance(value, ast.Constant) and isinstance(value.value, int)


def sums_and_stores(loop: ast.For) -> bool:
    """Whether an innermost loop adds to a float variable and writes into an array."""
    body = [node for statement in loop.body for node in ast.walk(statement)]
    if any(isinstance(node, ast.For) for node in body):
        return False
    sums = any(
        isinstance(node, ast.AugAssign)
        and isinstance(node.target, ast.Name)
        and not counts(node.value)
        for node in body
    )
    stores = any(isinstance(n, ast.Subscript) and isinstance(n.ctx, ast.Store) for n in body)
    return sums and stores


def offenders(source: str) -> list[str]:
    computed = []
    for function in ast.walk(ast.parse(source)):
        if not isinstance(function, ast.FunctionDef):
            continue
        options = [k.arg for d in function.decorator_list for k in getattr(d, "keywords", ())]
        loops = (node for node in ast.walk(function) if isinstance(node, ast.For))
        if "fastmath" in options and any(map(sums_and_stores, loops)):
            computed.append(function.name)
    return computed


def test_no_loop_that_sums_in_any_order_stores():
    kernels = sorted((PACKAGE / "kernels").rglob("*.py"))
    computed = {path.name: offenders(path.read_text()) for path in kernels}
    assert not {name: names for name, names in computed.items() if names}


def test_the_lint_finds_one():
    body = "    for j in range(3):\n        a[j] = b[j]\n        s += a[j]\n"
    assert offenders("@jit(fastmath=X)\ndef f(a, b, s):\n" + body) == ["f"]
    assert offenders("@jit\ndef f(a, b, s):\n" + body) == []
