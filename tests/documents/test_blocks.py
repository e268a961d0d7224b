"""Blocks and statements of made-up pages."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.documents import __main__ as long_blocks
from tests.documents.blocks import REPOSITORY, blocks, pages
from tests.documents.shell import smaller, statements, words

PAGE = """# A page

```sh
mjforage policies
```

<!-- long -->
```sh
mjforage study paper
```

- <!-- long --> said in a sentence is no mark

  ```python
  # mine.py
  if True:
      pass
  ```

<!-- not run by the tests: needs a boat -->

```sh
ls
```
"""


def test_blocks_have_lines_languages_marks_and_files() -> None:
    found = blocks("page.md", PAGE)
    assert [(b.line, b.language, b.mark) for b in found] == [
        (3, "sh", ""),
        (8, "sh", "long"),
        (14, "python", ""),
        (22, "sh", "not run by the tests: needs a boat"),
    ]
    assert [b.file for b in found] == [None, None, "mine.py", None]
    assert found[2].text == "# mine.py\nif True:\n    pass\n"
    assert [(b.runs, b.long) for b in found] == [
        (True, False),
        (False, True),
        (True, False),
        (False, False),
    ]


def test_a_mark_may_say_how_long() -> None:
    (block,) = blocks("page.md", "<!-- long: two hours -->\n```sh\nls\n```\n")
    assert block.long and not block.runs


def test_a_mark_with_a_slip_is_none() -> None:
    (block,) = blocks("page.md", "<!-- too long -->\n```sh\nls\n```\n")
    assert block.runs


def test_pages_are_those_that_are_written() -> None:
    some = {"README.md", "CONTRIBUTING.md", "docs/start.md", "docs/policies/mappo.md"}
    assert some <= set(pages())
    assert not [page for page in pages() if "/_" in page]


def test_statements_are_whole() -> None:
    text = "# why\nmjforage a \\\n  --b c   # what\n\ncat > f <<'END'\nx $y\n\nEND\nls\n"
    found = list(statements(text))
    assert found == ["mjforage a    --b c   # what", "cat > f <<'END'\nx $y\n\nEND\n", "ls"]
    assert words(found[0]) == ["mjforage", "a", "--b", "c"]
    assert words(found[1]) is None


@pytest.mark.parametrize("text", ["a | b", "a && b", "M=1 a", "a > b", "a $M", 'a "$M"', "a; b"])
def test_what_only_a_shell_understands_is_left_to_it(text: str) -> None:
    assert words(text) is None


def test_quoted_signs_are_nothing_to_a_shell() -> None:
    assert words("""a 'b[c]' "d(e=1)" 'f > g'""") == ["a", "b[c]", "d(e=1)", "f > g"]


def test_numbers_are_cut_but_never_raised() -> None:
    given = ["evaluate", "--episodes", "100", "--jobs", "2", "--seed", "7"]
    assert smaller(given) == ["evaluate", "--episodes", "2", "--jobs", "1", "--seed", "7"]
    assert smaller(["--episodes", "1", "--episodes", "all"]) == [
        "--episodes",
        "1",
        "--episodes",
        "all",
    ]


def test_long_blocks_run_after_what_they_need(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    module = "```python\n# mine.py\nprint(2 + 3)\n```\n"
    page = f"{module}\n<!-- long -->\n```sh\npython mine.py | cat\n```\n"
    monkeypatch.setattr(long_blocks, "blocks", lambda name: blocks(name, page))
    assert long_blocks.run_page("page.md", tmp_path) == []
    assert capfd.readouterr().out.splitlines()[0] == "5"


def test_a_long_block_that_fails_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = "<!-- long -->\n```sh\nfalse | true\n```\n"
    monkeypatch.setattr(long_blocks, "blocks", lambda name: blocks(name, page))
    assert [str(block) for block in long_blocks.run_page("page.md", tmp_path)] == ["page.md:2"]


def test_the_command_refuses_a_page_that_is_none() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "tests.documents", "docs/none.md"],
        cwd=REPOSITORY,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 1
    assert "docs/none.md unknown" in done.stderr
