"""Generated bad files and flags: a command succeeds or says one clear line.

`BAD_INPUTS=2000 pytest tests/mjforage/cli -k bad` tries so many of each kind.
"""

import io
import shutil
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from mjforage.scenario.assets import models_folder
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.schema import rows
from tests.mjforage.cli.spoiling import (
    DEEP,
    SHORT,
    as_toml,
    indices,
    numbers,
    outcome,
    some,
    spoilt,
    values,
)

pytestmark = pytest.mark.usefixtures("place")

KEYS = [row.key for row in rows(Scenario)]


@some
@given(data=st.data())
def test_scenario_keys(data: st.DataObject) -> None:
    key = data.draw(st.sampled_from(KEYS)).replace("NAME", "foragers")
    value = as_toml(data.draw(values))
    outcome("evaluate", "--policy", "random", *SHORT, "--set", f"{key}={value}")
    shutil.rmtree("runs", ignore_errors=True)


@some
@given(data=st.data())
def test_scenario_files(data: st.DataObject) -> None:
    whole = (models_folder() / "scenarios" / "published.toml").read_bytes()
    Path("bad.toml").write_bytes(spoilt(whole, data.draw))
    outcome("evaluate", "bad.toml", "--policy", "random", *SHORT, "--out", "out")
    shutil.rmtree("out", ignore_errors=True)


@some
@given(data=st.data())
def test_maps(data: st.DataObject) -> None:
    suffix = data.draw(st.sampled_from(["csv", "png", "gif", "bmp", "jpg"]))
    path = Path(f"map.{suffix}")
    if suffix == "csv":
        whole = b"1,1,0\n1,1,1\n0,1,1\n"
    else:
        image = Image.new(
            data.draw(st.sampled_from(["L", "RGB"] if suffix == "jpg" else ["L", "RGB", "P"])),
            (4, 3),
            255,
        )
        stream = io.BytesIO()
        image.save(stream, {"jpg": "jpeg"}.get(suffix, suffix))
        whole = stream.getvalue()
    path.write_bytes(spoilt(whole, data.draw))
    outcome("maps", path, "-o", "map-picture.png")
    outcome("evaluate", "--policy", "random", *SHORT, "--map", path, "--out", "out")
    shutil.rmtree("out", ignore_errors=True)


@some
@given(data=st.data())
def test_vessels(data: st.DataObject) -> None:
    whole = (models_folder() / "vessels" / "otter.toml").read_bytes()
    if data.draw(st.booleans()):
        lines = whole.decode().splitlines()
        numbered = [i for i, line in enumerate(lines) if "value =" in line]
        at = numbered[data.draw(indices) % len(numbered)]
        before, _, after = lines[at].partition("value =")
        value = as_toml(data.draw(values))
        lines[at] = f"{before}value = {value},{after.partition(',')[2]}"
        content = "\n".join(lines).encode("utf-8", "surrogatepass")
    else:
        content = spoilt(whole, data.draw)
    Path("hull.toml").write_bytes(content)
    outcome("manoeuvre", "hull.toml", "--test", "straight", "--duration", "0.2", "--out", "a.csv")


@some
@given(data=st.data())
def test_schedules(data: st.DataObject) -> None:
    Path("plan.csv").write_bytes(spoilt(b"t_s,left,right\n0,10,10\n0.1,0,-5\n", data.draw))
    outcome("manoeuvre", "otter", "--schedule", "plan.csv", "--duration", "0.2")


PATHS = (
    ("evaluate", "--policy", "random", *SHORT, "--out", "{}"),
    ("compare", "--policy", "random", *SHORT, "--out", "{}"),
    ("study", "corruption", "--policy", "random", "--step", "0.25", *SHORT, "--out", "{}"),
    ("train", "ddqn", "--updates", "0", "--out", "{}"),
    ("manoeuvre", "otter", "--test", "stop", "--duration", "0.1", "--out", "{}"),
    ("manoeuvre", "otter", "--test", "stop", "--duration", "0.1", "--plot", "{}"),
    ("manoeuvre", "otter", "--duration", "0.1", "--schedule", "{}"),
    ("manoeuvre", "{}", "--test", "stop"),
    ("validate", "{}"),
    ("maps", "comb_port", "-o", "{}"),
    ("maps", "{}"),
    ("schemas", "--out", "{}"),
    ("schemas", "--pages", "{}"),
    ("report", "{}"),
    ("render", "{}", "-o", "a.png"),
    ("render", "run", "-o", "{}"),
    ("render", "run", "-o", "{}.png"),
    ("evaluate", "{}", "--policy", "random"),
    ("evaluate", "--policy", "{}", *SHORT),
    ("evaluate", "--policy", "random", *SHORT, "--map", "{}"),
    ("evaluate", "--policy", "random", *SHORT, "--set", 'map.file="{}"'),
    ("evaluate", "--policy", "random", *SHORT, "--set", 'physics.vessels.scouts="{}"'),
    ("evaluate", "--policy", "random", *SHORT, "--set", "{}"),
    ("scenarios", "--explain", "{}"),
    ("bench", "--json", "{}"),
    ("evaluate", "--policy", "random", "--set", "horizon=2", "--episodes", "{}"),
    ("evaluate", "--policy", "random", "--seed", "{}"),
    ("evaluate", "--policy", "random", "--world", "{}"),
    ("evaluate", "--policy", "random", *SHORT, "--scheduler", "{}"),
    ("train", "ddqn", "--updates", "0", "--learning", "{}"),
    ("train", "ddqn", "--updates", "0", "--also", "{}"),
    ("train", "ddqn", "--updates", "0", "--teacher", "{}"),
    ("train", "ddqn", "--updates", "0", "--device", "{}"),
    ("render", "run", "-o", "a.png", "--camera", "{}"),
    ("render", "run", "-o", "a.png", "--follow", "{}"),
    ("render", "run", "-o", "a.png", "--start", "{}"),
    ("render", "run", "-o", "a.png", "--width", "{}"),
    ("render", "run", "-o", "a.png", "--episode", "{}"),
    ("manoeuvre", "scout", "--test", "straight", "--wind", "{}"),
    ("manoeuvre", "otter", "--test", "straight", "--heading", "{}"),
    ("manoeuvre", "otter", "--test", "straight", "--duration", "{}"),
    ("manoeuvre", "otter", "--test", "straight", "--dt", "{}"),
)
odd_paths = st.one_of(
    st.sampled_from(["", "\0", "a\0b", "x" * 300, "x/" * 3000, "/dev/null/x", "\ud800", "a\nb"]),
    st.text(max_size=8).filter(lambda text: not text.startswith("/") and ".." not in text),
    numbers.map(str).filter(lambda text: len(text) < 4 or "e" in text),
)


@some
@given(data=st.data())
def test_flags(data: st.DataObject, run: Path) -> None:
    words = data.draw(odd_paths)
    case = data.draw(st.sampled_from(PATHS))
    outcome(*(word.replace("{}", words) for word in case))


def test_toml_without_end() -> None:
    deep = "[" * DEEP
    Path("deep.toml").write_text(f"name = {deep}")
    assert "not readable as TOML" in outcome("evaluate", "deep.toml", "--policy", "random")
    assert "not readable as TOML" in outcome("manoeuvre", "deep.toml", "--test", "stop")
    assert "horizon = " in outcome("evaluate", "--policy", "random", "--set", f"horizon={deep}")
    assert "batch = " in outcome("train", "ddqn", "--learning", f"batch={deep}")
    assert "greedy" in outcome("evaluate", "--policy", f"greedy(distance={deep})")
