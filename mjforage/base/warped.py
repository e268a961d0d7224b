"""Formulas for Warp, from the text that numba compiles.

A formula is an `@kernel` or `@inlined` function of numbers, named tuples and records, without
arrays and without keywords. `warped` makes a function of Warp of it and of all that it calls.
`float` is a float32 there, a pair of floats a `vec2`, a named tuple or record a struct.
"""

import ast
import inspect
import linecache
import sys
from collections.abc import Callable
from functools import cache
from typing import Any, get_type_hints

import warp as wp

_PAIR = "tuple[float, float]"


@cache
def warped(formula: Callable[..., object]) -> Any:
    """The function of Warp for a formula.

    Raises
    ------
    ValueError
        If it is not of this package: its text is compiled and run.
    """
    plain = getattr(formula, "py_func", formula)
    if not plain.__module__.startswith("mjforage."):
        raise ValueError(f"formula {plain.__module__}.{plain.__name__}: is not one of mjforage")
    (tree,) = ast.parse(inspect.getsource(plain)).body
    assert isinstance(tree, ast.FunctionDef)
    tree = _Plain().visit(tree)
    known = vars(sys.modules[plain.__module__])
    used = {one.id for one in ast.walk(tree) if isinstance(one, ast.Name)}
    names = {name: _meaning(known[name]) for name in used if name in known}
    return wp.func(_made(tree, names | {"__name__": plain.__module__, "wp": wp}))


@cache
def struct_of(record: type) -> Any:
    """The struct of Warp with the fields of a named tuple or of a record, all of them numbers."""
    about = {"__annotations__": get_type_hints(record), "__module__": record.__module__}
    return wp.struct(type(record.__name__, (), about))


class _Plain(ast.NodeTransformer):
    """The words of a formula as Warp reads them."""

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.FunctionDef:
        """No decorators, docstring and type of the result; a pair is a vector."""
        self.generic_visit(node)
        node.decorator_list, node.returns = [], None
        node.body = node.body[ast.get_docstring(node) is not None :]
        for one in node.args.args:
            if one.annotation is not None and ast.unparse(one.annotation) == _PAIR:
                one.annotation = ast.parse("wp.vec2", mode="eval").body
        return node

    def visit_Assign(self, node: ast.Assign) -> list[ast.Assign]:
        """`a = b = 0.0` is two statements, and the number the first value of a variable."""
        self.generic_visit(node)
        value = node.value
        if isinstance(value, ast.Constant) and type(value.value) in (int, float):
            kind = ast.Name(type(value.value).__name__, ast.Load())
            value = ast.Call(kind, [value], [])
        return [ast.Assign([one], value) for one in node.targets]


def _meaning(value: Any) -> Any:
    """A name of a formula's module, as Warp is to have it."""
    if isinstance(value, type) and getattr(value, "__annotations__", None):
        return struct_of(value)
    ours = callable(value) and getattr(value, "__module__", "").startswith("mjforage.")
    return warped(value) if ours else value


def _made(tree: ast.FunctionDef, names: dict[str, Any]) -> Any:
    """The function of a tree; Warp finds its text by the name of its file."""
    text, file = ast.unparse(ast.fix_missing_locations(tree)), f"<{names['__name__']}.{tree.name}>"
    linecache.cache[file] = len(text), None, text.splitlines(keepends=True), file
    exec(compile(text, file, "exec"), names)  # our own source
    return names[tree.name]
