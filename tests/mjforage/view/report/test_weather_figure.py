"""The report draws wind and current over time, where they change."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from mjforage.view.report.curves import time_figures, time_series
from mjforage.view.report.run_logs import load_logs


def test_wind_and_current_are_drawn_where_they_change(
    evaluate_small: Callable[..., Path], finished: Path, tmp_path: Path
) -> None:
    given = ("map.file=open_bay", "weather.drift=forced", "weather.current_wander_mps=0.2")
    changing = load_logs(evaluate_small(tmp_path / "run", overrides=(*given, "map.starts=[]")))
    figures = {
        logs: [one.name for one in time_figures(logs)] for logs in (changing, load_logs(finished))
    }
    (names, still) = figures.values()
    assert "weather" in names and "weather" not in still
    assert not any("wind" in name or "bearing" in name for name in (*names, *still))
    drawn = time_series(changing.cases[0], "current_speed_mps")
    assert np.ptp(drawn.mean) > 0.01 and (drawn.n == changing.run.episodes).all()
