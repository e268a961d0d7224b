"""Comparison of the run in a folder with the requested one, and the ways to go on.

Only what decides the numbers is compared. A change of code or of a library's version alone may be
accepted; it is then noted in the folder's file, and the computed results stay.
"""

import json
import logging
from collections.abc import Iterable, Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Literal, NamedTuple

from mjforage.base.atomic_files import write_errors, write_json
from mjforage.base.called import what_was_called
from mjforage.base.errors import UserError
from mjforage.runs.foreign import check_files
from mjforage.runs.lock import folder_lock
from mjforage.runs.run_info import read_json

CODE = ("versions", "code")
ACCEPTABLE = (*CODE, "metrics")
"""Keys whose differences can be accepted: episodes depend on neither name nor number of metrics."""
GROWS = "episodes"
"""The key whose value may be larger than it was: episodes depend on seed and number alone."""
UNCOMPARED = ("mjforage", "python")
"""Versions that are kept to be read: of mjforage the code counts, Python computes no number."""
Resume = Literal["same", "fresh", "accept-code-change"]
"""Treatment of a folder that holds a run: resume the same one only, keep the old folder aside and
begin anew, or resume although code or versions differ."""
_logger = logging.getLogger(__name__)
_LONGEST = 60  # characters of a value in a message
_NAMED = 3  # differences in a message


class Difference(NamedTuple):
    """Difference between the run in a folder and the requested one."""

    key: str  # of the file
    words: str


def differences(
    there: Mapping[str, Any], here: Mapping[str, Any], keys: Iterable[str]
) -> list[Difference]:
    """Differences between a folder's file and the requested content, in the order of the keys.

    `there`, `here`: contents; `keys`: that decide.
    """
    here = json.loads(json.dumps(here))
    return [
        Difference(key, _by_file(words, here))
        for key in keys
        for words in _words(_compared(there, key), _compared(here, key), (key,))
    ]


def _by_file(words: str, here: Mapping[str, Any]) -> str:
    """Words on a difference; a record of the weather is named by its file, not by its key."""
    if not words.startswith("map.record "):
        return words
    return words.replace("map.record", f"record {here['scenario']['weather']['file']}", 1)


def _compared(info: Mapping[str, Any], key: str) -> Any:
    value = info.get(key)
    if key == "versions" and isinstance(value, dict):
        return {name: text for name, text in value.items() if name not in UNCOMPARED}
    if key == "metrics" and isinstance(value, list):
        return {one.get("key"): True for one in value if isinstance(one, dict)}
    return value


def _words(there: object, here: object, path: tuple[str, ...]) -> Iterator[str]:
    if path == (GROWS,) and isinstance(there, int) and isinstance(here, int) and there < here:
        return
    if isinstance(there, dict) and isinstance(here, dict):
        for name in {**there, **here}:
            yield from _words(there.get(name), here.get(name), (*path, name))
    elif there != here:
        key, values = ".".join(path), (_shown(there), _shown(here))
        more = ", and a run goes on to more only" if path == (GROWS,) else ""
        if max(map(len, values)) > _LONGEST:
            yield f"{key} differs"
        else:
            yield f"{key} is {values[0]} there and {values[1]} here{more}"


def _shown(value: object) -> str:
    return "missing" if value is None else json.dumps(value)


def refusal(kind: str, found: list[Difference]) -> str:
    """Reason why a folder's run is not resumed, and the remedies that there are.

    Another policy comes with other code, of which nothing is said then.
    """
    accept = 'resume="accept-code-change" (--accept-code-change) to go on and note it, '
    found = [one for one in found if one.key not in CODE] or found
    words = "; ".join(one.words for one in found[:_NAMED])
    more = f"; and {len(found) - _NAMED} more" if len(found) > _NAMED else ""
    return (
        f"holds another {kind}: {words}{more}; give {accept if acceptable(found) else ''}"
        'resume="fresh" (--fresh) to keep that folder aside and begin anew, or choose another'
    )


def acceptable(found: list[Difference]) -> bool:
    """True if only code, versions and metrics differ."""
    return all(one.key in ACCEPTABLE for one in found)


def with_accepted(
    there: Mapping[str, Any], here: Mapping[str, Any], found: list[Difference]
) -> dict[str, Any]:
    """Requested content, with the changes accepted so far and, if any, those found now.

    Each has the time, the command and what differed.
    """
    before = there.get("accepted", [])
    if found:
        note = {
            "time": datetime.now(UTC).isoformat(timespec="seconds"),
            "command": what_was_called(),
            "differences": [one.words for one in found],
        }
        before = [*before, note]
    return {**here, "accepted": before} if before else dict(here)


def found_in(
    path: Path, kind: str, info: Mapping[str, Any], identity: Iterable[str], accept: bool = False
) -> tuple[dict[str, Any] | None, list[Difference]]:
    """Content of a folder's file, None if the folder may be begun; and the accepted differences.

    Nothing is written. Parameters and errors are those of `open_folder`.
    """
    file = path / f"{kind}.json"
    with write_errors(path):
        inside = path.iterdir() if path.is_dir() else ()
        found = sorted(entry.name for entry in inside if entry.name[0] != ".")
    if file.name not in found:
        if found:
            raise UserError(
                f"{path}: holds {found[0]} but no {file.name}, so it is no {kind} folder; choose "
                "another"
            )
        return None, []
    check_files(file)
    try:
        there = read_json(file)
    except UserError as error:
        raise UserError(
            f"{file}: is not the {file.name} of a {kind}; choose another folder"
        ) from error
    differing = differences(there, info, identity)
    if differing and set(identity) <= set(there) and _holds_nothing(path, file.name):
        return None, []
    if differing and not (accept and acceptable(differing)):
        raise UserError(f"{path}: {refusal(kind, differing)}")
    return there, differing


def open_folder(
    path: Path, kind: str, info: Mapping[str, Any], identity: Iterable[str], accept: bool = False
) -> dict[str, Any]:
    """Create a folder with its file `<kind>.json`, or check that the file says the same.

    One that holds fewer episodes of the same goes on to more: it is no longer complete then. Raises
    `UserError` if the folder holds another one (the difference is named) or something else, or
    cannot be written, or is just being written.

    Returns: the content that the file is to have, changes accepted so far included.

    Parameters
    ----------
    path : the folder
    kind : run, study or training
    info : content of the file
    identity : its keys that must be the same, unless nothing has been computed yet
    accept : go on although code or versions differ; the file then says so
    """
    with write_errors(path):
        path.mkdir(parents=True, exist_ok=True)
    file = path / f"{kind}.json"
    there, differing = found_in(path, kind, info, identity, accept)
    if there is None:
        write_json(file, info)
        return dict(info)
    content = with_accepted(there, info, differing)
    grown = there.get(GROWS) != info.get(GROWS)
    if differing or grown:
        keys = (*ACCEPTABLE, "hash", "accepted", *(("command", GROWS) if grown else ()))
        changed = {key: content[key] for key in keys if key in content}
        with folder_lock(path), write_errors(path):
            if grown:
                (path / "summary.json").unlink(missing_ok=True)  # before the file asks for more
            write_json(file, there | changed)
    return content


def _holds_nothing(path: Path, file: str) -> bool:
    """True if a folder has only the file that names its content."""
    with write_errors(path):
        return not any(
            entry.name != file and entry.name[0] != "." and not _is_empty(entry)
            for entry in path.iterdir()
        )


def _is_empty(entry: Path) -> bool:
    return entry.is_dir() and all(one.name[0] == "." for one in entry.iterdir())


def archive(path: Path, kind: str) -> Path | None:
    """Rename a folder that holds a run, study or training, so that its place is free.

    Raises `UserError` if another process is writing it, or it cannot be renamed.

    Returns: its new name; None if there was none.
    """
    if not (path / f"{kind}.json").is_file():
        return None
    now = f"{datetime.now(UTC):%Y%m%dT%H%M%S}"
    names = (f"{path.name}.before-{now}{more}" for more in ("", *(f"-{n}" for n in range(2, 100))))
    with folder_lock(path), write_errors(path):
        aside = next(path.parent / name for name in names if not (path.parent / name).exists())
        path.rename(aside)
    _logger.warning("%s: what it held is kept as %s", path, aside)
    return aside
