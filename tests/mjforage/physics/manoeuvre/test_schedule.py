from pathlib import Path

import pytest

from mjforage.base.errors import UserError
from mjforage.physics.manoeuvre import parse_flow
from mjforage.physics.manoeuvre.schedule import Schedule, read_schedule
from mjforage.physics.vessels import load_vessel


def read(folder: Path, text: str, vessel: str = "otter") -> Schedule:
    path = folder / "plan.csv"
    path.write_text(text, encoding="utf-8")
    return read_schedule(path, load_vessel(vessel))


def test_rows_hold_until_the_next_and_nothing_runs_before_the_first() -> None:
    schedule = Schedule((2.0, 5.0), ((10.0, 20.0), (30.0, -40.0)))
    assert schedule.at(0.0) == schedule.at(1.999) == (0.0, 0.0)
    assert schedule.at(2.0) == schedule.at(4.999) == (10.0, 20.0)
    assert schedule.at(5.0) == schedule.at(1e6) == (30.0, -40.0)


def test_columns_may_stand_in_any_order_with_blanks_and_a_mark(tmp_path: Path) -> None:
    text = "\ufeffright, t_s ,left\r\n\r\n2, 0, 1\r\n4,1.5,3\r\n"
    assert read(tmp_path, text) == Schedule((0.0, 1.5), ((1.0, 2.0), (3.0, 4.0)))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "has columns none; expected t_s,left,right"),
        ("\n \n", "has columns none"),
        ("t_s,left,right\n", "has no row under its header"),
        ("t_s,left\n0,1\n", "has columns t_s,left; expected t_s,left,right"),
        ("0,1,1\n", "has columns 0,1,1"),
        ("t_s,left,left,right\n0,1,1,1\n", "has columns t_s,left,left,right"),
        ("t_s,left,right,rudder\n0,1,1,1\n", "has columns t_s,left,right,rudder"),
        ("t_s,left,right\n0,1\n", "line 2: 0,1; expected a number for each of t_s,left,right"),
        ("t_s,left,right\n0,1,fast\n", "line 2: 0,1,fast; expected a number for each"),
        ("t_s,left,right\n0,1,nan\n", "line 2: right = nan is out of range"),
        ("t_s,left,right\ninf,1,1\n", "line 2: t_s = inf; give finite seconds, 0 or later"),
        ("t_s,left,right\n-1,1,1\n", "line 2: t_s = -1; give finite seconds"),
        ("t_s,left,right\n0,1,1\n\n3,1,1\n2,1,1\n", "line 5: t_s = 2 is not after 3; put the"),
        ("t_s,left,right\n0,1,1\n0,2,2\n", "line 3: t_s = 0 is not after 0"),
        (
            "t_s,left,right\n0,1,1\n1,110,1\n",
            "line 3: left = 110 is out of range for otter; give -101.74 to 103.94 rad/s",
        ),
        ("t_s,left,right\n0,1,-102\n", "line 2: right = -102 is out of range for otter"),
    ],
)
def test_errors_name_line_value_and_remedy(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(UserError) as caught:
        read(tmp_path, text)
    assert str(caught.value).startswith("schedule plan.csv: ")
    assert message in str(caught.value)


def test_range_is_the_vessels_own_in_its_own_unit(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"for scout; give -19\.9 to 33\.6 N$"):
        read(tmp_path, "t_s,left,right\n0,60,60\n", "scout")


def test_files_that_are_not_there_or_not_text_are_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"schedule none\.csv: cannot be read .*; give a CSV file"):
        read_schedule(tmp_path / "none.csv", load_vessel("otter"))
    (tmp_path / "raw.csv").write_bytes(b"\xff\xfe\x00\x80")
    with pytest.raises(UserError, match=r"schedule raw\.csv: cannot be read"):
        read_schedule(tmp_path / "raw.csv", load_vessel("otter"))


def test_directions_are_where_it_flows_to_counter_clockwise_from_east() -> None:
    assert parse_flow("0.3@0", "--current") == (0.3, 0.0)
    assert parse_flow("0.3@90", "--current") == (0.0, 0.3)
    assert parse_flow("2@-90", "--wind") == (0.0, -2.0)
    assert parse_flow("2@540", "--wind") == (-2.0, 0.0)
    assert parse_flow("5@53.13010235415598", "--wind") == pytest.approx((3.0, 4.0))
