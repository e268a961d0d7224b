"""A study folder as its report reads it: the settings, and the logs of every variant."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from mjforage.base.errors import UserError
from mjforage.mission.scoring import Description, describe
from mjforage.runs.costs import Cost, load_costs
from mjforage.runs.run_info import AGAIN, RunInfo
from mjforage.runs.studies.study import StudyInfo, load_study_info, variant_folder
from mjforage.view.page import style
from mjforage.view.report.run_logs import Case, RunLogs, load_logs


@dataclass(frozen=True)
class StudyLogs:
    """Logs of a study."""

    folder: Path
    info: StudyInfo
    runs: Mapping[str, RunLogs]  # of every variant
    costs: Mapping[str, tuple[Cost, ...]]  # of every variant

    @property
    def worlds(self) -> tuple[str, ...]:
        """Worlds in which any variant is played."""
        own = (world for one in self.info.variants.values() for world in one.worlds)
        return tuple(dict.fromkeys((*self.info.worlds, *own)))

    @property
    def bounds(self) -> frozenset[str]:
        """Policies that see the truth, in any variant."""
        return frozenset(policy for one in self.runs.values() for policy in one.run.bounds)

    @property
    def told(self) -> dict[str, str]:
        """Policy -> what it is told of the items, in any variant."""
        return {who: what for one in self.runs.values() for who, what in one.run.told.items()}

    @property
    def whole(self) -> RunLogs:
        """Logs of the variant that is the scenario as it is."""
        return next(iter(self.runs.values()))

    @property
    def base(self) -> RunInfo:
        """The run of that variant."""
        return self.whole.run

    @property
    def policies(self) -> tuple[str, ...]:
        """Policies of that variant, in their fixed order."""
        return self.whole.policies

    def title(self, variant: str) -> str:
        """Variant in words."""
        return self.info.variants[variant].title

    def case(self, variant: str, world: str, policy: str) -> Case:
        """A policy in a world of a variant."""
        return Case(self.runs[variant], world, policy)

    def plays(self, policy: str, variant: str) -> bool:
        """True if a policy plays a variant."""
        return variant in self.runs and policy in self.runs[variant].run.policies

    def suffix(self, world: str) -> str:
        """The world, where there are several."""
        return f" · {world}" if len(self.worlds) > 1 else ""

    def measured(self, keys: tuple[str, ...]) -> list[Description]:
        """Metrics that are defined in any episode of any variant."""
        runs = self.runs.values()
        return [describe(k) for k in keys if any(one.has(k) and one.defined(k) for one in runs)]


def ordered_policies(logs: StudyLogs) -> tuple[str, ...]:
    """Policies of all variants, in their fixed order."""
    return style.ordered(policy for one in logs.runs.values() for policy in one.run.policies)


def load_study(folder: Path) -> StudyLogs:
    """Load a study folder.

    Raises `UserError` if a file of the study or of one of its runs is missing, truncated or
    foreign.
    """
    file = folder / "study.json"
    info = load_study_info(file)
    if not (folder / "summary.json").is_file():
        remedy = f"{AGAIN}, it completes the folder"
        raise UserError(f"{folder}: the study is not finished; {remedy}")
    places = {name: variant_folder(folder, name) for name in info.variants}
    runs = {name: load_logs(place) for name, place in places.items()}
    costs = {name: load_costs(place / "costs.json") for name, place in places.items()}
    return StudyLogs(folder, info, runs, costs)
