"""Commands without what extras bring: the base goes on, and each door names its extra in a line."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

BLOCKED = (
    *("torch", "torchrl", "tensordict", "tensorboard", "av", "OpenGL", "distributed"),
    *("stable_baselines3", "pyogrio", "pyproj", "shapely"),
)
REMEDY = "install it with pip install 'mjforage["
SHORT = ("comb-port", "--episodes", "1", "--set", "horizon=4")
DDQN = ("evaluate", *SHORT, "--policy", "ddqn")
GREEDY = ("evaluate", *SHORT, "--policy", "greedy")
GOES = {
    "evaluate": (*GREEDY, "--out", "run"),
    "compare": ("compare", *SHORT, "--policy", "greedy", "--out", "both"),
    "report": ("report", "run"),
    "report of a learner": ("report", "learner"),
    "picture": ("render", "run", "-o", "run.png"),
    "board": ("study", "board", *SHORT, "--out", "board"),
    "policies": ("policies",),
    "schemas": ("schemas", "--out", "schemas"),
}
LACKS = {
    DDQN: "policy ddqn: needs torch; @learn",
    ("evaluate", *SHORT, "--policy", "mappo"): "policy mappo: needs torch; @learn",
    (*GREEDY, "--scheduler", "tcp://a:1"): "dask: needs distributed; @cluster",
    ("render", "run", "-o", "run.mp4"): "output run.mp4: needs av; @film",
    ("render", "run", "-o", "run.gif"): "output run.gif: needs av; @film",
    ("train", "ddqn", "--updates", "1"): "train ddqn: needs torch; @learn",
    ("train", "mappo", "--updates", "1"): "train mappo: needs torch; @learn",
    ("bench",): "bench: needs torch; @learn",
    ("place", "a.geojson", "--out", "a"): "place a.geojson: needs pyogrio; @places",
}
Outcomes = dict[tuple[str, ...], tuple[int, str]]
PROGRAM = f"""
import contextlib, io, json, sys
import scipy.stats  # which looks at sys.modules for torch
sys.modules.update(dict.fromkeys({BLOCKED}))
from mjforage.cli import main
done = []
for command in json.loads(sys.argv[1]):
    with contextlib.redirect_stderr(io.StringIO()) as said:
        try:
            code = main(command)
        except SystemExit as end:
            code = end.code
    done.append((code or 0, " ".join(said.getvalue().split())))
print(json.dumps(done))
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the commands work."""
    return tmp_path_factory.mktemp("base")


@pytest.fixture(scope="module")
def outcomes(folder: Path) -> Outcomes:
    """Code and words of each command, in one process that can import none of those libraries."""
    whole = [sys.executable, "-m", "mjforage", *DDQN, "--out", "learner"]
    subprocess.run(whole, cwd=folder, check=True, capture_output=True)
    commands = [*GOES.values(), *LACKS]
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, json.dumps(commands)],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout.splitlines()[-1])
    return {command: (code, words) for command, (code, words) in zip(commands, told, strict=True)}


@pytest.mark.parametrize("name", GOES)
def test_the_base_installation_goes_on(outcomes: Outcomes, name: str) -> None:
    assert outcomes[GOES[name]][0] == 0, outcomes[GOES[name]]


@pytest.mark.parametrize("command", LACKS)
def test_a_door_names_its_extra(outcomes: Outcomes, command: tuple[str, ...]) -> None:
    code, words = outcomes[command]
    wanted = f"mjforage: {LACKS[command].replace('@', REMEDY)}]'"
    assert code == 2
    assert words.endswith(wanted), words


def test_a_board_says_who_is_left_out_and_why(outcomes: Outcomes, folder: Path) -> None:
    assert outcomes[GOES["board"]][0] == 0
    left_out = json.loads((folder / "board" / "study.json").read_text("utf-8"))["left_out"]
    reasons = {one["policy"]: one["reason"] for one in left_out}
    assert reasons["ddqn"] == LACKS[DDQN].replace("@", REMEDY) + "]'"
    assert {"ddqn", "mappo"} < reasons.keys() and "greedy" not in reasons


def test_nothing_was_left_of_what_was_refused(tmp_path: Path) -> None:
    """The refusal comes before any folder is made."""
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, json.dumps([[*DDQN, "--out", "none"]])],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
    )
    assert json.loads(done.stdout.splitlines()[-1])[0][0] == 2
    assert list(tmp_path.iterdir()) == []
