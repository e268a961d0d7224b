"""The list of slow tests names tests that are there."""

import re

from tests.conftest import SLOW, slow_tests


def test_every_name_is_of_a_test() -> None:
    for file, tests in slow_tests().items():
        text = (SLOW.parents[1] / file).read_text("utf-8")
        assert tests <= set(re.findall(r"^def (test_\w+)\(", text, re.MULTILINE)), file
