"""`python -m tests.site.links build/links/output.json`: what linkcheck found about other sites.

Exit code 1 if a link is broken, or if no site answered: without a network nothing is known. A site
that did not answer among others that did is named, and is no fault of the page.
"""

import json
import re
import sys
from collections import Counter
from pathlib import Path

GOOD, BROKEN, UNKNOWN = "good", "broken", "not checked"
_UNREACHED = re.compile(r"NameResolutionError|NewConnectionError|Timeout|Connection aborted")


def state(found: dict[str, str]) -> str:
    """Return what one line of linkcheck's says of its link."""
    if found["status"] in {"working", "redirected"}:
        return GOOD
    if found["status"] == "broken" and not _UNREACHED.search(found["info"]):
        return BROKEN
    return UNKNOWN


def reason(found: dict[str, str]) -> str:
    """Return why, short: errors of the network are a paragraph each."""
    unreached = _UNREACHED.search(found["info"])
    return unreached[0] if unreached else found["info"] or found["status"]


def report(lines: list[str]) -> tuple[list[str], bool]:
    """Return what to tell the reader, and whether links are good as far as is known.

    Parameters
    ----------
    lines : of linkcheck's output.json; links inside of the site are `python -m tests.site`'s
    """
    links = [one for one in map(json.loads, lines) if re.match("https?:", one["uri"])]
    states = [state(one) for one in links]
    said = [
        f"{one['filename']}:{one['lineno']}: {is_}: {one['uri']} ({reason(one)})"
        for one, is_ in zip(links, states, strict=True)
        if is_ != GOOD
    ]
    counts = Counter(states)
    said.append(
        f"links to other sites: {len(links)}; "
        + ", ".join(f"{counts[one]} {one}" for one in (GOOD, BROKEN, UNKNOWN))
    )
    if links and counts[UNKNOWN] == len(links):
        said.append("No site answered: there seems to be no network here.")
    return said, not counts[BROKEN] and counts[UNKNOWN] < max(1, len(links))


if __name__ == "__main__":
    words, good = report(Path(sys.argv[1]).read_text("utf-8").splitlines())
    sys.stdout.write("".join(f"{line}\n" for line in words))
    sys.exit(not good)
