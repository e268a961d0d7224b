"""Words of a command: lists behind one flag, and messages about missing ones."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import cyclopts
from cyclopts import Token


def several(words: Sequence[str]) -> list[str]:
    """Words in which a flag that takes several values has one each, or one with commas.

    `--policy greedy levy` is `--policy greedy --policy levy`, and `--figures pdf png` is `--figures
    pdf,png`. A scenario or folder that follows is none of the values.
    """
    return list(_several(list(words)))


def _several(words: list[str]) -> Iterator[str]:
    """Values as `several` gives them; takes the words out of the list."""
    flags = _FLAGS.get(words[0] if words else "", {})
    while words:
        flag = words.pop(0)
        yield flag
        if flag not in flags or not words or words[0].startswith("-"):
            continue
        values = [words.pop(0)]
        while words and not words[0].startswith("-") and not flags[flag](words[0]):
            values.append(words.pop(0))
        if flag == "--policy":
            yield values[0]
            yield from (part for value in values[1:] for part in (flag, value))
        else:
            yield ",".join(values)


def _is_scenario(word: str) -> bool:
    from mjforage.scenario.scenario_file import preset_names

    name = word.partition("@")[0]
    return name.endswith(".toml") or name.replace("_", "-") in preset_names()


def _is_folder(word: str) -> bool:
    return Path(word).is_dir()


_PLAYED: dict[str, Callable[[str], bool]] = {"--policy": _is_scenario, "--replay": _is_scenario}
_FLAGS: dict[str, dict[str, Callable[[str], bool]]] = {
    **dict.fromkeys(("evaluate", "compare", "study"), _PLAYED),
    "report": {"--figures": _is_folder, "--tables": _is_folder},
}
"""Command -> flag -> what of the words behind it is another argument."""


def unknown(error: cyclopts.UnknownOptionError) -> str:
    """Message about an unknown flag, with the nearest one or the command that has it."""
    flag = (error.token.keyword or error.token.value).partition("=")[0]
    if flag in _FLAGS["report"]:
        return f"Unknown option: {flag}. Give it afterwards: mjforage report FOLDER {flag}"
    return str(error)


def _misspelt(error: cyclopts.MissingArgumentError, given: Sequence[str]) -> str:
    """The same of the first flag that the command does not know; "" if it knows all."""
    if error.app is None:
        return ""
    known = error.app.assemble_argument_collection()
    for word in given:
        flag = word.partition("=")[0]
        if flag.startswith("--") and flag != "--":
            try:
                known.match(flag)
            except ValueError:
                token = Token(keyword=flag, source="cli")
                return unknown(
                    cyclopts.UnknownOptionError(
                        token=token, argument_collection=known, verbose=False
                    )
                )
    return ""


def missing(error: cyclopts.MissingArgumentError, given: Sequence[str]) -> str:
    """Message about a missing argument, with the first sentence of its help; about a misspelt flag
    if one was given.
    """
    if error.argument is None or error.app is None:
        return str(error)
    if words := _misspelt(error, given):
        return words
    name = error.argument.name
    told = error.app.assemble_argument_collection(parse_docstring=True)
    words = next((one.parameter.help for one in told if one.name == name), None) or ""
    sentence = " ".join(words.split()).partition(". ")[0].rstrip(".")
    where = " ".join((*(error.command_chain or ()), name))
    return f"{where} is missing, or its value: {sentence or 'give it'}"
