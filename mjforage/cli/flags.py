"""The flags that several commands have in common."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from mjforage.base.errors import UserError

if TYPE_CHECKING:
    from mjforage.runs.resuming import Resume

Water = Literal["light", "dark"]  # as `map.water` of a scenario
Words = Annotated[tuple[str, ...], Parameter(negative="")]

SCENARIO = Parameter(help="Name of a preset (see `mjforage scenarios`) or path of a TOML file.")
POLICY = Parameter(
    name="--policy",
    negative="",
    consume_multiple=True,
    help="A policy (see `mjforage policies`), MODULE:CLASS of your own, or NAME for weights "
    'NAME.safetensors here; with options as in "greedy(distance=2)". Several may follow the flag.',
)
METRIC = Parameter(
    name="--metric",
    negative="",
    help="A metric besides those of every run: mse_33, mse_66, mse_100, ptc_33, ptc_66 or ptc_100 "
    "(error of the belief and items removed after so many % of the steps), MODULE:CLASS of your "
    "own, or one of a package; repeatable.",
)
SET = Parameter(
    name="--set",
    negative="",
    help="Override KEY=VALUE in TOML syntax, for example team.scouts.count=3, or "
    "policy.greedy.distance=2 for an option of a policy; repeatable.",
)
MAP = Parameter(
    help="Map that replaces the scenario's grid: a name, harbour:KIND:SEED[:ROWSxCOLUMNS], table, "
    "grid or image. The rest stays, also the starts, which a generated harbour draws anew."
)
WATER = Parameter(
    help="Cells of that file that are water, light or dark: pixels of an image, 1 or 0 of a table."
)
SEED = Parameter(help="Seed of the run; episode i is the same in every world, policy and variant.")
EPISODES = Parameter(help="Episodes per policy and world; a larger number extends --out.")

Scenario = Annotated[str, SCENARIO]
Policies = Annotated[tuple[str, ...], POLICY]
Metrics = Annotated[tuple[str, ...], METRIC]
Overrides = Annotated[tuple[str, ...], SET]
Map = Annotated[str | None, MAP]
WaterOf = Annotated[Water | None, WATER]
Seed = Annotated[int, SEED]
Episodes = Annotated[int, EPISODES]


@dataclass(frozen=True)
class Computing:
    """Processes that compute.

    Parameters
    ----------
    jobs
        Worker processes.
    scheduler
        Address of a dask scheduler, for example tcp://host:8786, whose workers compute instead.
    """

    jobs: int = 1
    scheduler: str | None = None

    def asked(self) -> dict[str, Any]:
        """The same for the library."""
        if self.scheduler == "":  # of an unset variable of a shell, perhaps: not to compute here
            raise UserError("scheduler: the address is empty; give one such as tcp://host:8786")
        return {"jobs": self.jobs, "scheduler": self.scheduler or ""}


@dataclass(frozen=True)
class Resuming:
    """Treatment of an existing --out. Without these, only the same run is resumed.

    Parameters
    ----------
    fresh
        Begin anew; the old content of --out stays beside it, as NAME.before-TIME.
    accept_code_change
        Resume although code or versions of libraries differ; the folder's file notes it.
    """

    fresh: Annotated[bool, Parameter(negative="")] = False
    accept_code_change: Annotated[bool, Parameter(negative="")] = False

    @property
    def resume(self) -> "Resume":
        """The same for the library."""
        if self.fresh and self.accept_code_change:
            raise UserError("--fresh and --accept-code-change: give one of them")
        if self.fresh:
            return "fresh"
        return "accept-code-change" if self.accept_code_change else "same"


@dataclass(frozen=True)
class Trusting:
    """Code that files may name, besides shipped code and installed packages.

    Made of the command line alone: to make one is the user's word.

    Parameters
    ----------
    trust
        MODULE:CLASS of your own that a run folder, a study or weights may name, beside what this
        command names; any other code is refused. Repeatable.
    """

    trust: Words = ()

    def __post_init__(self) -> None:
        from mjforage.base.registry import trust

        trust(*self.trust)


THIS_PROCESS, SAME_ONLY, NOBODY = Computing(), Resuming(), Trusting()
By = Annotated[Computing, Parameter(name="*")]
GoingOn = Annotated[Resuming, Parameter(name="*")]
Trusted = Annotated[Trusting, Parameter(name="*")]
