"""Whether a folder holds the run that is asked for: what differs, and what may be done about it.

What decides the numbers is compared, no more and no less. A change of code or of a library's
version alone may be accepted; it is then noted in the folder's file, and what was computed stays.
"""

import json
import shlex
import sys
from collections.abc import Iterable, Iterator, Mapping
from datetime import UTC, datetime
from typing import Any, Literal, NamedTuple

CODE = ("versions", "code")
"""Keys whose differences can be accepted."""
UNCOMPARED = ("python",)
"""Versions that are kept to be read: Python computes no number of a run by itself."""
Resume = Literal["same", "fresh", "accept-code-change"]
"""What to do with a folder that holds a run: go on with the same one only, keep the old folder
aside and begin anew, or go on although code or versions differ."""
_LONGEST = 60  # characters of a value in a message
_NAMED = 3  # differences in a message


class Difference(NamedTuple):
    """Where a folder's run is another one."""

    key: str  # of the file
    words: str


def differences(
    there: Mapping[str, Any], here: Mapping[str, Any], keys: Iterable[str]
) -> list[Difference]:
    """What differs between a folder's file and what is asked for, in the order of the keys.

    Parameters
    ----------
    there, here : contents
    keys : that decide
    """
    here = json.loads(json.dumps(here))
    return [
        Difference(key, words)
        for key in keys
        for words in _words(_compared(there, key), _compared(here, key), (key,))
    ]


def _compared(info: Mapping[str, Any], key: str) -> Any:
    value = info.get(key)
    if key == "versions" and isinstance(value, dict):
        return {name: text for name, text in value.items() if name not in UNCOMPARED}
    return value


def _words(there: object, here: object, path: tuple[str, ...]) -> Iterator[str]:
    if isinstance(there, dict) and isinstance(here, dict):
        for name in {**there, **here}:
            yield from _words(there.get(name), here.get(name), (*path, name))
    elif there != here:
        key = ".".join(path)
        if path[0] == "code":
            yield _of_code(there, here, path[-1])
        elif key == "map.navigable":
            yield "the map's cells differ"
        elif key == "agents":
            yield "the agents are others or in another order"
        else:
            yield f"{key} is {_short(there)} there and {_short(here)} here"


def _of_code(there: object, here: object, file: str) -> str:
    if file == "code":
        return "it does not say of which code it is" if there is None else "the code differs"
    if there is None or here is None:
        return f"{file} is {'not there' if there is None else 'gone'}"
    return f"{file} differs"


def _short(value: object) -> str:
    text = json.dumps(value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def refusal(kind: str, found: list[Difference]) -> str:
    """Why a folder's run is not gone on with, and the remedies that there are."""
    words = "; ".join(one.words for one in found[:_NAMED])
    more = f"; and {len(found) - _NAMED} more" if len(found) > _NAMED else ""
    accept = "--accept-code-change to go on and note it, " if acceptable(found) else ""
    return (
        f"holds another {kind}: {words}{more}; give {accept}--fresh to keep that folder aside and "
        "begin anew, or choose another --out"
    )


def acceptable(found: list[Difference]) -> bool:
    """Whether code and versions alone differ."""
    return all(one.key in CODE for one in found)


def with_accepted(
    there: Mapping[str, Any], here: Mapping[str, Any], found: list[Difference]
) -> dict[str, Any]:
    """What is asked for, with the changes that were accepted so far and, if any, those found now.

    Each has the time, the command and what differed.
    """
    before = there.get("accepted", [])
    if found:
        note = {
            "time": datetime.now(UTC).isoformat(timespec="seconds"),
            "command": shlex.join(["mjforage", *sys.argv[1:]]),
            "differences": [one.words for one in found],
        }
        before = [*before, note]
    return {**here, "accepted": before} if before else dict(here)
