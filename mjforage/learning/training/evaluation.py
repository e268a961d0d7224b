"""Evaluations of a training run: held-out episodes, shared out among scenarios and their harbours.

What is best on the map that a run is named after need not be best on others
(docs/evidence/why-scores-fell.md), so a run can be judged on maps of its own.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from mjforage import metrics
from mjforage.base.errors import UserError
from mjforage.learning.environments.choices import scenarios_of
from mjforage.learning.environments.cores import common_shapes
from mjforage.learning.environments.options import EnvironmentOptions
from mjforage.learning.training.task_families import ends
from mjforage.mission.policy import Policy
from mjforage.mission.scoring import METRICS, Scorer
from mjforage.physics.worlds import create_mission
from mjforage.scenario.scenario import Scenario

MAPS = ("pta_d", "pta_c", "nt90")  # of every map alone, where there are several
HELD_OUT = 1 << 40  # seed of evaluation episodes; training seeds are smaller
SCORES = ("pta_d", "pta_c", "nt50", "nt90", "csr", "rmse_columns", "length")

Make = Callable[[Scenario], EnvironmentOptions]


class Evaluation:
    """Held-out episodes on which the networks of a run are judged.

    Attributes
    ----------
    scenarios : as given; a map of one may be a family of harbours
    """

    def __init__(self, scenarios: Sequence[Scenario], make: Make, episodes: int) -> None:
        """Prepare; nothing is built before it is played.

        Raises `UserError` if a family's name is not well formed, or there are fewer episodes than
        maps.

        Parameters
        ----------
        scenarios : that share the episodes: episode i is on map i modulo their number of maps
        make : what a scenario is played with
        episodes : of all of them together
        """
        self.scenarios, self._make, self._episodes = tuple(scenarios), make, episodes
        self._each = [each for scenario in scenarios for each in scenarios_of(scenario)]
        if episodes < len(self._each):
            raise UserError(
                f"evaluate: {len(self._each)} maps for evaluate_episodes = {episodes}; give "
                f"fewer maps, or evaluate_episodes = {len(self._each)} or more"
            )

    def examples(self) -> list[EnvironmentOptions]:
        """Options of each scenario, on the ends of its maps."""
        played = [each for one in self.scenarios for each in ends(scenarios_of(one))]
        return [self._make(each) for each in played]

    def check(self, home: EnvironmentOptions) -> None:
        """Try all maps now, not hours later.

        Raises `UserError` if a scenario is not valid, or its fleet or arrays are not those of the
        run's first.
        """
        for each in self._each:
            self._make(each)
        common_shapes([home, *self.examples()])

    def scores(self, policy: Policy) -> dict[str, float]:
        """Means of all episodes by the names of `SCORES`, and `rank`: better when lower.

        `pta_c_sem` and so on are their standard errors, of episodes drawn anew on these maps. Of
        several maps also the means of `MAPS` of each, `pta_c/comb-port:harbour:combs:900`. Values
        that an episode does not define are left out.
        """
        found = [self._play(policy, number) for number in range(len(self._each))]
        row = {name: _mean(np.concatenate([part[name] for part in found])) for name in SCORES}
        for name in SCORES:
            row[f"{name}_sem"] = float(metrics.stratified_sem([part[name] for part in found]))
        row["rank"] = row["nt50"] + row["nt90"] + (100.0 - row["pta_c"]) / 20.0
        if len(found) > 1:
            for scenario, part in zip(self._each, found, strict=True):
                where = f"{scenario.name}:{scenario.map.file}"
                row |= {f"{name}/{where}": _mean(part[name]) for name in MAPS}
        return row

    def _play(self, policy: Policy, number: int) -> dict[str, NDArray[np.float64]]:
        """The scores of the episodes of a map, each (episode,)."""
        options = self._make(self._each[number])
        mission = create_mission(options.setup, options.world)
        mission.reset(HELD_OUT, np.arange(number, self._episodes, len(self._each)))
        scorer = Scorer(mission, [METRICS.find(key) for key in SCORES])
        mission.run(policy, (scorer,))
        return dict(scorer.scores().scalars)


def _mean(values: NDArray[np.float64]) -> float:
    """Mean of the defined values; NaN without any."""
    defined = values[np.isfinite(values)]
    return float(defined.mean()) if defined.size else float("nan")
