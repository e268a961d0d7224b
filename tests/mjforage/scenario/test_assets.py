"""Places of the shipped data: the wheel, then the checkout."""

from pathlib import Path

import pytest

from mjforage.base.errors import UserError
from mjforage.scenario import assets


def test_missing_data_folder_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(assets, "_PLACES", (tmp_path / "a", tmp_path / "b"))
    with pytest.raises(UserError) as caught:
        assets.models_folder()
    assert str(tmp_path / "a") in str(caught.value)
    assert str(tmp_path / "b") in str(caught.value)


def test_installed_data_folder_is_found(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "wheel" / "maps").mkdir(parents=True)
    monkeypatch.setattr(assets, "_PLACES", (tmp_path / "wheel", tmp_path / "checkout"))
    assert assets.models_folder() == tmp_path / "wheel"
