"""Generated bad inputs, and what a command says of one."""

import io
import json
import os
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from typing import Any

from hypothesis import HealthCheck, Phase, settings
from hypothesis import strategies as st

from mjforage.cli import main

EXAMPLES = int(os.environ.get("BAD_INPUTS", "12"))
some = settings(
    max_examples=EXAMPLES,
    database=None,
    suppress_health_check=list(HealthCheck),
    phases=[Phase.generate],
)
few = settings(some, max_examples=max(1, EXAMPLES // 6))  # of what takes a second each
DEEP = 100_000  # brackets, more than any parser follows
SHORT = ("--episodes", "1", "--set", "horizon=2", "--set", "items.mean=3", "--set", "items.std=0")

numbers = st.one_of(
    st.integers(-(2**70), 2**70),
    st.sampled_from([0, -1, 1, 2**31, 2**63, 10**400, 0.0, -0.0, 3e38, 1e-320, 1e308]),
    st.floats(),
)
texts = st.one_of(
    st.sampled_from(["", "\0", "a\0b", "x" * 5000, "/", ".", "..", "/dev/null/x", "[b]", "\ud800"]),
    st.text(max_size=8),
)
plain = st.one_of(st.none(), st.booleans(), numbers, texts)
values = st.recursive(
    plain,
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=4), inner, max_size=2)
    ),
    max_leaves=4,
)
indices = st.integers(0, 2**32)


def as_toml(value: Any) -> str:
    """A value in TOML's words, or in nobody's."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list):
        return f"[{', '.join(map(as_toml, value))}]"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{as_toml(k)} = {as_toml(v)}' for k, v in value.items())}}}"
    if isinstance(value, float):
        return repr(value)
    return json.dumps(value) if not isinstance(value, int) else hex(value)


def outcome(*arguments: object) -> str:
    """Run a command; what it said if it refused, in one line with exit code 2."""
    said, printed = io.StringIO(), io.StringIO()
    with redirect_stderr(said), redirect_stdout(printed):
        try:
            main([str(argument) for argument in arguments])
        except SystemExit as end:
            lines = [line for line in said.getvalue().splitlines() if line.startswith("mjforage: ")]
            if not end.code:
                return ""
            assert end.code == 2, (arguments, end.code, said.getvalue())
            assert len(lines) == 1, (arguments, said.getvalue())
            assert said.getvalue().endswith(f"{lines[0]}\n"), (arguments, said.getvalue())
            return lines[0]
    return ""


def spoilt(data: bytes, draw: Callable[..., Any]) -> bytes:
    """A file's content with some bytes changed, or cut, or with more of it."""
    out = bytearray(data)
    for _ in range(draw(st.integers(1, 3))):
        at = draw(indices) % (len(out) + 1)
        kind = draw(st.sampled_from(["flip", "flip", "cut", "put", "drop", "twice"]))
        if kind == "flip" and at < len(out):
            out[at] ^= 1 << draw(st.integers(0, 7))
        elif kind == "cut":
            del out[at:]
        elif kind == "put":
            out[at:at] = draw(st.binary(max_size=8))
        elif kind == "drop":
            del out[at : at + draw(st.integers(1, 40))]
        elif kind == "twice":
            out[at:at] = out[: draw(st.integers(0, 200))]
    return bytes(out)


def changed(tree: Any, draw: Callable[..., Any]) -> Any:
    """A tree with one node replaced, removed or renamed, anywhere in it."""
    tree = json.loads(json.dumps(tree))
    node, depth = tree, draw(st.integers(0, 5))
    for _ in range(depth):
        inner = node.values() if isinstance(node, dict) else node
        inside = [entry for entry in inner if isinstance(entry, dict | list) and entry]
        if not inside:
            break
        node = inside[draw(indices) % len(inside)]
    keys = list(node) if isinstance(node, dict) else list(range(len(node)))
    key = keys[draw(indices) % len(keys)]
    kind = draw(st.sampled_from(["replace", "replace", "replace", "remove", "add"]))
    if kind == "replace":
        node[key] = draw(values)
    elif kind == "remove":
        del node[key]
    elif isinstance(node, dict):
        node[draw(texts)] = draw(values)
    else:
        node.append(draw(values))
    return tree
