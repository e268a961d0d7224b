"""Mission metrics with hulls in Warp against the CPU's, paired: `python -m ...warp_table`."""

import argparse
import sys

from mjforage import evaluate, metrics

METRICS = ("pta_d", "pta_c", "nt50", "nt90", "length", "rmse")


def main() -> None:
    """Play the same episodes on both, and print means and 95 % intervals of the differences."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--episodes", type=int, default=200)
    parser.add_argument("--scenario", default="comb-port-weather")
    given = parser.parse_args()
    play = {"episodes": given.episodes, "world": "physics", "record": ()}
    known, found = (
        evaluate(given.scenario, "greedy", device=device, **play).episodes.sort("episode")
        for device in ("cpu", "warp-cpu")
    )
    rows = ["| metric | CPU | Warp | difference, 95 % interval |", "|---|---|---|---|"]
    for name in METRICS:
        a, b = known[name].to_numpy(), found[name].to_numpy()
        gap = metrics.mean_interval(b - a)
        off = f"{gap.value:+.3g} ({gap.low:+.3g} to {gap.high:+.3g})"
        rows.append(f"| `{name}` | {a.mean():.4g} | {b.mean():.4g} | {off} |")
    sys.stdout.write("\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
