"""Generated damage to what runs, studies and trainings leave: one clear line, or none needed."""

import json
import shutil
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from safetensors import safe_open
from safetensors.torch import save_file

from mjforage.base.errors import UserError
from mjforage.graph_planner.networks.weights import shipped_weights
from mjforage.runs.episode_recording import Recording
from tests.mjforage.cli.spoiling import DEEP, SHORT, changed, outcome, some, spoilt

pytestmark = pytest.mark.usefixtures("place")


def spoil(folder: Path, data: st.DataObject) -> Path:
    """A copy of a folder with one of its files spoilt."""
    copy = Path("copy")
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(folder, copy)
    files = sorted(
        path
        for path in copy.rglob("*")
        if path.is_file() and path.suffix in (".json", ".parquet", ".npz", ".safetensors", ".csv")
    )
    path = data.draw(st.sampled_from(files))
    if path.suffix == ".json" and data.draw(st.integers(0, 3)):
        text = json.dumps(changed(json.loads(path.read_text()), data.draw))
        if not data.draw(st.integers(0, 20)):
            text = "[" * DEEP
        path.write_text(text)
    else:
        path.write_bytes(spoilt(path.read_bytes(), data.draw))
    return copy


@some
@given(data=st.data())
def test_run_folders(data: st.DataObject, run: Path) -> None:
    copy = spoil(run, data)
    outcome("report", copy)
    outcome("render", copy, "-o", "a.png", "--width", "160", "--height", "120")
    outcome("evaluate", "--policy", "random", *SHORT, "--out", copy)


@some
@given(data=st.data())
def test_weights(data: st.DataObject) -> None:
    source = shipped_weights("ddqn")
    if data.draw(st.booleans()):
        with safe_open(source, "pt") as file:
            tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
            notes = file.metadata()
        name = data.draw(st.sampled_from(sorted(tensors)))
        number = data.draw(st.sampled_from([3e38, -3e38, float("inf"), float("nan"), 1e20, 0.0]))
        if data.draw(st.booleans()):
            tensors[name].fill_(number)
        else:
            tensors[name].view(-1)[0] = number
        save_file(tensors, "odd.safetensors", notes)
    else:
        head = data.draw(st.booleans())
        whole = source.read_bytes()
        size = 8 + int.from_bytes(whole[:8], "little")
        content = (
            spoilt(whole[:size], data.draw) + whole[size:] if head else spoilt(whole, data.draw)
        )
        Path("odd.safetensors").write_bytes(content)
    outcome("evaluate", "--policy", "odd", *SHORT, "--out", "out")
    shutil.rmtree("out", ignore_errors=True)


@pytest.mark.parametrize("deep", ["[" * DEEP, '{"a":' * DEEP])
@pytest.mark.parametrize("file", ["run.json", "summary.json"])
def test_json_without_end(file: str, deep: str, run: Path) -> None:
    copy = Path("copy")
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(run, copy)
    (copy / file).write_text(deep)
    assert f"copy/{file}: cannot be read as JSON" in outcome("report", copy)


def test_a_flipped_bit_in_a_replay(run: Path) -> None:
    """Wherever it is: as a film's source and as the report's."""
    (whole,) = run.glob("replay/*.npz")
    content, file = whole.read_bytes(), Path("flipped.npz")
    refused = 0
    for at in range(0, len(content), 29):
        file.write_bytes(content[:at] + bytes([content[at] ^ (1 << at % 8)]) + content[at + 1 :])
        try:
            Recording.load(file)
        except UserError as error:
            assert str(error).startswith("replay flipped.npz: ")
            refused += 1
    assert refused > 50
