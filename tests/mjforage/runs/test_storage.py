import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import polars as pl
import pytest

from mjforage.base.atomic_files import write_json
from mjforage.base.errors import UserError
from mjforage.mission.setup import Setup
from mjforage.runs.costs import Cost
from mjforage.runs.identity import hull_facts
from mjforage.runs.resuming import archive
from mjforage.runs.run_info import AGAIN
from mjforage.runs.storage import Chunk, RunFolder
from mjforage.runs.tables import SCHEMAS, TABLES
from mjforage.scenario.scenario_file import load_scenario

INFO: dict[str, Any] = {
    "command": "mjforage study paper --policy greedy",
    "scenario": {"name": "x", "team": {"scouts": {"count": 2}}},
    "map": {"name": "m", "navigable": ["01", "11"]},
    "versions": {"mjforage": "1", "mujoco": "3", "numpy": "2", "python": "3.11"},
    "code": {"mjforage": "ab"},
    "seed": 0,
    "episodes": 3,
    "worlds": ["graph"],
    "policies": ["greedy"],
    "agents": [{"name": "scouts_0"}],
}
FIRST, SECOND = Chunk("graph", "greedy", 0, 2), Chunk("graph", "greedy", 2, 1)
COST = Cost("graph", "greedy", 2, 300, 1.5, 2.0, 1e9, "node7-1", "now", "processes", 1)


def frames(chunk: Chunk) -> dict[str, pl.DataFrame]:
    """One row per episode in every table, its number in every column that is not a key."""
    keys = {"world": chunk.world, "policy": chunk.policy}
    numbers = [episode for _, _, episode in chunk.keys]
    return {
        table: pl.DataFrame({name: keys.get(name, numbers) for name in schema}).cast(schema)  # type: ignore[arg-type]
        for table, schema in SCHEMAS.items()
    }


@pytest.fixture
def run(tmp_path: Path) -> RunFolder:
    """Return an open run with one chunk of two."""
    folder = RunFolder(tmp_path / "run")
    folder.open(INFO)
    folder.write(FIRST, frames(FIRST), COST)
    return folder


def chunk_folder(run: RunFolder) -> Path:
    return run.path / "chunks" / FIRST.name


def error_of(function: Callable[..., object], *arguments: object) -> str:
    with pytest.raises(UserError) as caught:
        function(*arguments)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_chunks_merge_in_the_given_order_and_go(run: RunFolder) -> None:
    assert run.has(FIRST)
    assert not run.has(SECOND)
    run.write(SECOND, frames(SECOND), COST)
    assert run.costs([FIRST, SECOND]) == [COST, COST]
    assert not run.complete
    run.merge([SECOND, FIRST])
    assert not run.complete
    write_json(run.path / "summary.json", {})
    assert run.complete
    run.finish([FIRST, SECOND])
    assert sorted(path.name for path in run.path.iterdir()) == sorted(
        ["run.json", "summary.json", *(f"{table}.parquet" for table in TABLES)]
    )
    for table in TABLES:
        assert run.table(table)["episode"].to_list() == [2, 0, 1]
        assert dict(run.table(table).schema) == SCHEMAS[table]  # of a run without metrics
    assert run.episodes([FIRST, SECOND]).height == 3


def test_brackets_and_stars_in_a_folder_name_are_letters(tmp_path: Path) -> None:
    folder = RunFolder(tmp_path / "a [1]*?")
    folder.open(INFO)
    folder.write(FIRST, frames(FIRST), COST)
    assert folder.has(FIRST)
    folder.merge([FIRST])
    assert folder.table("items").height == 2


def test_same_run_may_be_opened_again_and_keeps_its_file(run: RunFolder) -> None:
    before = (run.path / "run.json").read_bytes()
    unlike = INFO["versions"] | {"python": "3.12", "mjforage": "2"}
    run.open(INFO | {"started": "later", "versions": unlike})
    assert (run.path / "run.json").read_bytes() == before


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("seed", 7, "seed is 0 there and 7 here"),
        ("episodes", 2, "episodes is 3 there and 2 here, and a run goes on to more only"),
        ("policies", ["levy"], 'policies is ["greedy"] there and ["levy"] here'),
        ("worlds", ["physics"], 'worlds is ["graph"] there and ["physics"] here'),
        ("scenario", {"name": "x", "team": {"scouts": {"count": 3}}}, "scouts.count is 2 there"),
        ("scenario", {"name": "x", "team": {}}, '.scouts is {"count": 2} there and miss'),
        ("map", {"name": "m", "navigable": ["11", "11"]}, "map.navigable is"),
        ("versions", INFO["versions"] | {"mujoco": "4"}, 'mujoco is "3" there and "4" here'),
        (
            "code",
            {"mjforage": "ef"},
            'is "ab" there and "ef" here; give resume="accept',
        ),
        ("agents", [{"name": "other_0"}], "agents is"),
    ],
)
def test_another_run_is_refused_with_the_difference(
    run: RunFolder, key: str, value: object, words: str
) -> None:
    message = error_of(run.open, INFO | {key: value})
    assert message.startswith(f"{run.path}: holds another run: ")
    assert words in message
    assert run.has(FIRST)


def test_changed_code_is_accepted_on_request_and_noted(run: RunFolder) -> None:
    changed = INFO | {"code": {"mjforage": "ef"}, "hash": "new"}
    for _ in range(2):  # once accepted it is the same run
        content = run.open(changed, accept=True)
        written = json.loads((run.path / "run.json").read_text())
        assert written["code"] == changed["code"] and written["hash"] == "new"
        (note,) = written["accepted"]
        assert content["accepted"] == [note]
        assert note["differences"] == ['code.mjforage is "ab" there and "ef" here']
    assert run.open(changed)["accepted"] == [note]
    run.open(INFO, accept=True)
    assert len(json.loads((run.path / "run.json").read_text())["accepted"]) == 2
    message = error_of(run.open, changed | {"seed": 7}, True)
    assert "seed is 0 there" in message and "accept-code-change" not in message


def test_what_a_fresh_run_replaces_is_kept_beside(run: RunFolder) -> None:
    before = {path.name: path.read_bytes() for path in run.path.rglob("*") if path.is_file()}
    aside = archive(run.path, "run")
    assert aside is not None and aside.name.startswith("run.before-") and not run.path.exists()
    kept = {path.name: path.read_bytes() for path in aside.rglob("[!.]*") if path.is_file()}
    assert kept == before
    run.open(INFO | {"seed": 7})
    again = archive(run.path, "run")
    assert again is not None and again != aside


def test_a_folder_that_holds_no_run_is_not_renamed(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("")
    assert archive(tmp_path, "run") is None and (tmp_path / "thesis.tex").exists()


@pytest.mark.parametrize("text", ["", "{", "[1]", "\udcff", "null"])
def test_a_run_json_that_is_none_is_refused_and_kept(tmp_path: Path, text: str) -> None:
    file = tmp_path / "run.json"
    file.write_bytes(text.encode("utf-8", "surrogateescape"))
    message = error_of(RunFolder(tmp_path).open, INFO)
    assert message == f"{file}: is not the run.json of a run; choose another folder"
    assert file.read_bytes() == text.encode("utf-8", "surrogateescape")


@pytest.mark.parametrize("text", ["{}", '{"versions": 3, "scenario": [], "map": null}'])
def test_a_foreign_run_json_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "run.json").write_text(text)
    assert "holds another run" in error_of(RunFolder(tmp_path).open, INFO)


def test_a_folder_of_something_else_is_refused_but_hidden_files_do_not_count(
    tmp_path: Path,
) -> None:
    (tmp_path / ".hidden").write_text("")
    RunFolder(tmp_path).open(INFO)
    (tmp_path / "run.json").rename(tmp_path / "thesis.tex")
    message = error_of(RunFolder(tmp_path).open, INFO)
    assert message.startswith(f"{tmp_path}: holds thesis.tex but no run.json")
    assert not (tmp_path / "run.json").exists()


def truncate(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def damage(path: Path) -> None:
    """Spoil what is inside; the footer, which holds the schema, stays."""
    content = bytearray(path.read_bytes())
    content[4:40] = bytes(36)
    path.write_bytes(bytes(content))


def replace(path: Path) -> None:
    pl.DataFrame({"price": [1.0]}).write_parquet(path)


def retype(path: Path) -> None:
    frame = pl.read_parquet(path)
    frame.with_columns(pl.col("episode").cast(pl.Float64)).write_parquet(path)


@pytest.mark.parametrize("table", TABLES)
@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (truncate, "missing, truncated or not Parquet"),
        (Path.unlink, "missing, as in a run that is not finished; move "),
        (damage, "damaged"),
        (replace, "differ)"),
        (retype, "(episode differ)"),
    ],
)
def test_a_spoilt_chunk_is_named_and_left(
    run: RunFolder, table: str, spoil: Callable[[Path], object], words: str
) -> None:
    path = chunk_folder(run) / f"{table}.parquet"
    spoil(path)
    left = sorted(chunk_folder(run).iterdir())
    message = error_of(run.has, FIRST)
    assert message.startswith(f"{path}: ")
    assert words in message
    assert message.endswith(f"move {chunk_folder(run)} away and {AGAIN}")
    assert sorted(chunk_folder(run).iterdir()) == left


@pytest.mark.parametrize(
    "other", [SECOND, Chunk("graph", "levy", 0, 2), Chunk("sea", "greedy", 0, 2)]
)
def test_a_chunk_of_other_episodes_is_named(run: RunFolder, other: Chunk) -> None:
    for name, frame in frames(other).items():
        frame.write_parquet(chunk_folder(run) / f"{name}.parquet")
    assert "does not hold the 2 episodes that it should" in error_of(run.has, FIRST)


@pytest.mark.parametrize("text", [None, "{", '{"cpu_s": "much"}', '{"cpu_s": null}'])
def test_a_spoilt_cost_of_a_chunk_is_named(run: RunFolder, text: str | None) -> None:
    path = chunk_folder(run) / "cost.json"
    path.unlink()
    if text is not None:
        path.write_text(text)
    words = f"delete {chunk_folder(run)} and {AGAIN}"
    assert words in error_of(run.has, FIRST)


@pytest.mark.parametrize("spoil", [truncate, replace])
def test_a_foreign_table_beside_the_chunks_is_refused_and_not_overwritten(
    run: RunFolder, spoil: Callable[[Path], object]
) -> None:
    path = run.path / "steps.parquet"
    shutil.copy(chunk_folder(run) / "steps.parquet", path)
    run.open(INFO)
    spoil(path)
    before = path.read_bytes()
    assert f"move {path} away" in error_of(run.open, INFO)
    assert path.read_bytes() == before
    assert run.has(FIRST)


def test_a_merged_table_of_other_episodes_is_named(run: RunFolder) -> None:
    run.merge([FIRST])
    assert run.episodes([FIRST]).height == 2
    assert "does not hold the 3 episodes" in error_of(run.episodes, [FIRST, SECOND])


def test_finishing_leaves_what_is_not_of_the_run(run: RunFolder) -> None:
    mine = run.path / "chunks" / "notes.txt"
    mine.write_text("mine")
    (run.path / "chunks" / ".half-written").mkdir()
    run.finish([FIRST])
    assert [path.name for path in (run.path / "chunks").iterdir()] == ["notes.txt"]


def test_a_chunk_that_another_process_finished_first_stays(run: RunFolder) -> None:
    before = (chunk_folder(run) / "steps.parquet").stat().st_ino
    run.write(FIRST, frames(FIRST), COST)
    assert (chunk_folder(run) / "steps.parquet").stat().st_ino == before
    assert [path.name for path in (run.path / "chunks").iterdir()] == [FIRST.name]


def test_a_chunk_that_cannot_be_written_leaves_nothing(tmp_path: Path) -> None:
    run = RunFolder(tmp_path / "run")
    run.open(INFO)
    run.write(FIRST, frames(FIRST), COST)
    (chunk_folder(run) / "steps.parquet").unlink()
    message = error_of(run.write, FIRST, frames(FIRST), COST)
    assert "steps.parquet: missing, as in a run" in message
    assert [path.name for path in (run.path / "chunks").iterdir()] == [FIRST.name]


@pytest.mark.parametrize("place", ["file/run", "/proc/nowhere/run", "x" * 300])
def test_an_impossible_folder_is_one_error(tmp_path: Path, place: str) -> None:
    (tmp_path / "file").write_text("")
    message = error_of(RunFolder(tmp_path / place).open, INFO)
    assert "cannot be written" in message
    assert "; give a " in message or "; move what is there away" in message


def test_a_folder_is_written_by_one_process_at_a_time(tmp_path: Path) -> None:
    hold = "import sys; from pathlib import Path; from mjforage.runs.storage import RunFolder\n"
    hold += "with RunFolder(Path(sys.argv[1])).lock(): print('mine', flush=True); input()"
    other = subprocess.Popen(
        [sys.executable, "-c", hold, str(tmp_path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    with other:
        assert other.stdout is not None
        assert other.stdout.readline() == "mine\n"
        with (
            pytest.raises(UserError, match="another process is writing this run"),
            RunFolder(tmp_path).lock(),
        ):
            pass
        other.communicate("\n")
    with RunFolder(tmp_path).lock():
        pass


@pytest.mark.parametrize(
    ("scenario", "worlds", "decides"),
    [
        (["rules.capture=calibrated"], ["graph"], True),  # items are taken by it
        ([], ["graph", "intake"], True),  # `belief` plans by it
        ([], ["graph"], False),
        ([], ["debris"], False),
        (["physics.capture=node"], ["physics"], False),
    ],
)
def test_capture_models_are_part_of_a_run_that_goes_by_them(
    scenario: list[str], worlds: list[str], decides: bool
) -> None:
    setup = Setup.of(load_scenario("comb-port-weather", scenario))
    assert ("captures" in hull_facts(setup, worlds)) == decides
