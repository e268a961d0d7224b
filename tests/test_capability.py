"""What torch is told to use and this processor lacks: tests say so, and torch is not told."""

import os

import pytest

from tests import conftest


@pytest.mark.parametrize(
    ("asked", "kept", "why"),
    [
        ("avx512", None, "torch finds avx2 on this processor, no avx512"),
        ("avx2", "avx2", ""),
        ("default", "default", ""),
    ],
)
def test_torch_is_not_told_to_use_what_is_not_there(
    asked: str, kept: str | None, why: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(conftest.CAPABILITY, asked)
    monkeypatch.setenv(conftest.LACKING, "")
    monkeypatch.setattr(conftest, "capability", lambda: "avx2")
    conftest.pytest_configure()
    assert os.environ.get(conftest.CAPABILITY) == kept
    assert os.environ[conftest.LACKING] == why
