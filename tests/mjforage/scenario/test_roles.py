"""Names of agents: team and number, from which both can be told again."""

import pytest

from mjforage.scenario.roles import Fleet, Role


@pytest.mark.parametrize("teams", [("scouts", "foragers"), ("a", "a_1", "a-1", "a_1_0", "1")])
def test_a_name_is_team_and_number_whatever_the_team_is_called(teams: tuple[str, ...]) -> None:
    fleet = Fleet.of(dict.fromkeys(teams, Role(12, 1, 1.0, True)))
    assert len(set(fleet.names)) == len(fleet.names) == 12 * len(teams)
    told = [name.rpartition("_") for name in fleet.names]
    assert [team for team, _, _ in told] == [teams[i] for i in fleet.team.tolist()]
    assert [int(number) for _, _, number in told] == [*range(12)] * len(teams)
