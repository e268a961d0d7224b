"""The command line: lists, help, and what a user can mend."""

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from mjforage import __version__
from mjforage.bench.running import Rate
from mjforage.cli.commands import app
from mjforage.cli.studying import study
from mjforage.graph_planner.policies import policy_names
from mjforage.mission.scoring import METRICS, chosen_metrics
from mjforage.runs.studies.study import Study
from mjforage.scenario.scenario_file import load_scenario, preset_names
from tests.mjforage.cli.short_runs import EVALUATE, GREEDY, Refused

pytestmark = pytest.mark.usefixtures("here")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["evalute"], 'Unknown command "evalute". Did you mean "evaluate"?'),
        (["--nonsense"], "--nonsense"),
        (["evaluate", "--polcy", "greedy"], "--polcy. Did you mean --policy?"),
        (["render", "--polcy", "greedy"], "Unknown option: --polcy. Did you mean --policy?"),
        ([*EVALUATE, "--world", "physic"], "world 'physic': unknown; did you mean physics?"),
        (
            [*EVALUATE, "--set", "policy.gredy.distance=2"],
            "did you mean policy.greedy.distance? As it is, give policy.NAME.OPTION=VALUE",
        ),
        ([*EVALUATE, "--out", "x.html"], "for report.html and more; give --out x"),
        (["evaluate"], "--policy requires an argument"),
        (["train"], "ALGORITHM requires an argument"),
        (["completion", "csh"], "Choose from"),
        (["evaluate", "--policy", "levy", "gredy"], "gredy: unknown; did you mean greedy?"),
        (["evaluate", "--policy", "greedy", "--policy", "greedy"], "policy greedy: given twice"),
        ([*GREEDY, "--episodes", "0"], "episodes 0: give 1 to"),
        ([*GREEDY, "--episodes", "many"], '--episodes: unable to convert "many" into int'),
        ([*EVALUATE, "--jobs", "0"], "jobs 0"),
        ([*EVALUATE, "--seed", "-1"], "seed -1"),
        ([*EVALUATE, "--map", "comb_prot"], "did you mean comb_port?"),
        ([*EVALUATE, "--map", "open_bay"], "is on land in map open_bay; give map.starts = "),
        ([*EVALUATE, "--set", "team.scouts.count=-1"], "team.scouts.count = -1 should be "),
        (
            [*EVALUATE, "--set", "team.scout.count=3"],
            "set team.scout.count=3: did you mean team.scouts.count? As it is, scenario "
            "comb-port: missing team.scout.moves",
        ),
        ([*EVALUATE, "--set", "teams.scouts.count=3"], "did you mean team.scouts.count? As it is"),
        ([*EVALUATE, "--set", "wind_speed_mps=3"], "did you mean weather.wind_speed_mps? As it"),
        ([*EVALUATE, "--set", "mean=3"], "did you mean items.mean? As it is"),
        ([*EVALUATE, "--set", "zzz=3"], "scenario comb-port: unknown key zzz; known: name"),
        ([*EVALUATE, "--set", "horizon"], "set horizon: expected KEY=VALUE"),
        ([*EVALUATE, "--out", "/proc/nowhere/run"], "/proc/nowhere/run: cannot be written"),
        (["evaluate", "comb-prot", "--policy", "greedy"], "did you mean comb-port?"),
        (["report", "nowhere"], "nowhere/run.json: file is missing"),
        (["report"], "FOLDER"),
        (["render", "nowhere", "-o", "a.png"], "nowhere/run.json: file is missing"),
        (["render", "nowhere"], "--out requires an argument"),
        (["maps", "nowhere"], "map nowhere: neither a shipped map"),
        (["maps", "harbour:comb:7"], "no kind 'comb'; give harbour:KIND:SEED or harbour:KIND:SEED"),
        (["maps", "harbours:0-2", "-o", "a.csv"], "picture a.csv: unknown kind; give"),
        ([*EVALUATE, "--map", "harbours:0-2"], "give one, such as harbour:combs:0"),
        (["train", "ddqn", "--updates", "1", "--also", "comb-port:harbours:2-0"], "FIRST-LAST"),
        (["maps", "comb_port", "-o", "nowhere/a.png"], "nowhere/a.png: cannot be written"),
        (["bench", "--jsn", "a"], "--jsn. Did you mean --json?"),
    ],
)
def test_what_a_user_can_mend_is_one_line(
    arguments: list[object], words: str, refused: Refused, here: Path
) -> None:
    assert words in refused(*arguments)
    assert list(here.iterdir()) == []


def test_lists_name_everything_in_one_line_each(command: Callable[..., Any]) -> None:
    lists = {
        "policies": policy_names(),
        "scenarios": preset_names(),
        "metrics": [
            *(metric.key for metric in chosen_metrics()),
            *(name for name in METRICS.names() if METRICS.find(name).on_request),
        ],
    }
    for name, names in lists.items():
        lines = command(name).out.splitlines()
        assert [line.split()[0] for line in lines] == names
        assert all(len(line.split()) > 3 for line in lines)
    assert "comb_port: 62 x 46, 1297 nodes" in command("maps").out.splitlines()


def test_the_file_of_a_scenario_is_printed(
    command: Callable[..., Any], refused: Refused, here: Path
) -> None:
    for name in preset_names():
        Path("mine.toml").write_text(command("scenarios", name).out)
        assert load_scenario("mine.toml") == load_scenario(name)
    Path("mine.toml").unlink()
    assert "comb-prot: neither a shipped scenario nor a TOML file" in refused(
        "scenarios", "comb-prot"
    )
    both = ("scenarios", "comb-port", "--explain", "horizon")
    assert "scenarios comb-port --explain horizon: give one of them" in refused(*both)


def test_memory_that_is_not_there_is_one_line(
    refused: Refused, monkeypatch: pytest.MonkeyPatch
) -> None:
    def want() -> None:
        raise MemoryError("Unable to allocate 3 TiB")

    monkeypatch.setattr("mjforage.scenario.scenario_file.preset_names", want)
    words = refused("scenarios")
    assert "not enough memory (Unable to allocate 3 TiB); give smaller options" in words


def test_version_and_help(command: Callable[..., Any]) -> None:
    assert command("--version").out.strip() == command("-V").out.strip() == __version__
    text = command("--help").out
    for name in ("bench", "compare", "evaluate", "maps", "policies", "render", "validate"):
        assert name in text
        assert "Usage" in command(name, "--help").out
    assert command().out == text


IN_NO_NEW_PLACE = (
    *("policies", "metrics", "scenarios", "validate", "vessels", "compile", "report", "stream"),
    "answer",
)


def test_every_command_that_writes_takes_the_same_flag() -> None:
    writing = 0
    for told in app, study:
        for name in told:
            if name.startswith("-") or name in ("study", "completion"):
                continue
            flags = {
                flag for one in told[name].assemble_argument_collection() for flag in one.names
            }
            if flags & {"--out", "--output", "-o"}:
                writing += 1
                assert {"--out", "--output", "-o"} <= flags, name
            else:
                assert name in IN_NO_NEW_PLACE, name
    assert writing >= 15


@pytest.mark.parametrize(
    ("words", "whole_team"),
    [
        (("corruption",), False),
        (("corruption", "--whole-team"), True),
        (("paper",), True),
        (("paper", "--per-agent"), False),
    ],
)
def test_a_study_corrupts_whole_teams_or_each_agent_as_it_is_told(
    words: tuple[str, ...],
    whole_team: bool,
    command: Callable[..., Any],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    plans: list[Study] = []
    monkeypatch.setattr("mjforage.api.studies.run_study", lambda plan, *_, **__: plans.append(plan))
    command("study", *words, "--policy", "random", "--step", "0.25")
    (plan,) = plans
    choices = [one.scenario.corruption for one in plan.variants]
    assert {one.whole_team for one in choices if one.team} == {whole_team}
    assert plan.options["whole_team"] == whole_team, "the report says so"


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_shell_completes_commands_and_flags(shell: str, command: Callable[..., Any]) -> None:
    script = command("completion", shell).out
    assert "evaluate" in script and "accept-code-change" in script
    if shell == "bash":
        done = subprocess.run(["bash", "-n"], input=script, text=True, check=False)
        assert done.returncode == 0


def test_bench_writes_its_figures(
    command: Callable[..., Any], refused: Refused, monkeypatch: pytest.MonkeyPatch
) -> None:
    figures: dict[str, dict[str, Any]]
    figures = {"steps": {"value": 1234.6, "quickest": 2345.6, "unit": "steps per s"}}
    found = {key: Rate(**numbers) for key, numbers in figures.items()}
    monkeypatch.setattr("mjforage.bench.running.bench", lambda progress: found)
    for flag in ("-o", "--out", "--json"):
        told = command("bench", flag, f"figures{flag}.json").out
        assert "1,235" in told
        assert "2,346" in told
        assert json.loads(Path(f"figures{flag}.json").read_text()) == figures
    assert "cannot be written" in refused("bench", "--json", "nowhere/figures.json")


def test_a_near_miss_is_named_once(refused: Refused) -> None:
    for override in ("link.latenzy=3", "team.scouts.cont=2", "teams.scouts.count=3"):
        assert refused(*EVALUATE, "--set", override).count("did you mean") == 1
