import errno
import json
import os
import resource
import threading
from pathlib import Path

import pytest

from mjforage.base.atomic_files import (
    atomic_write,
    remove_parts,
    write_bytes,
    write_errors,
    write_json,
)
from mjforage.base.errors import UserError


def error_of(number: int, path: Path) -> str:
    with pytest.raises(UserError) as caught, write_errors(path):
        raise OSError(number, os.strerror(number))
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(
    ("number", "words"),
    [
        (errno.ENOSPC, "(No space left on device); free some space"),
        (errno.EDQUOT, "quota exceeded); free some space"),
        (errno.EACCES, "(Permission denied); give a place that you may write to"),
        (errno.EROFS, "(Read-only file system); give a place that you may write to"),
        (errno.ENAMETOOLONG, "(File name too long); give a shorter name"),
        (errno.ENOTDIR, "(a file is there, or where a folder above it should be); move what is"),
        (errno.EISDIR, "(Is a directory); move what is there away"),
        (errno.EIO, "(Input/output error); see to that disk"),
    ],
)
def test_the_cause_is_named_and_not_another(number: int, words: str, tmp_path: Path) -> None:
    message = error_of(number, tmp_path / "a")
    assert message.startswith(f"{tmp_path / 'a'}: cannot be written (")
    assert words in message
    assert ("space" in message) == (number in (errno.ENOSPC, errno.EDQUOT))


def test_other_errors_pass(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError), write_errors(tmp_path):
        raise ZeroDivisionError
    with pytest.raises(ValueError, match="odd"), write_errors(tmp_path):
        raise ValueError("odd")


def test_a_path_that_cannot_be_one_is_an_error_of_one_line(tmp_path: Path) -> None:
    names = ("a\0b", r"a\x00b: no file can have this"), ("x" * 300, "too long"), ("", "")
    for name, words in names:
        with pytest.raises(UserError) as caught:
            write_bytes(tmp_path / name, b"")
        assert words in str(caught.value)
        assert "\0" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def test_two_writers_of_a_file_do_not_meet(tmp_path: Path) -> None:
    path, both = tmp_path / "a", threading.Barrier(2, timeout=60.0)

    def write(letter: bytes) -> None:
        with atomic_write(path) as beside:
            beside.write_bytes(letter * 10)
            both.wait()  # both have written before one is renamed

    writers = [threading.Thread(target=write, args=(letter,)) for letter in (b"a", b"b")]
    for writer in writers:
        writer.start()
    for writer in writers:
        writer.join()
    assert path.read_bytes() in (b"a" * 10, b"b" * 10)
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("error", [KeyboardInterrupt(), ZeroDivisionError(), OSError(5, "x")])
def test_a_failure_leaves_the_old_file_and_no_other(tmp_path: Path, error: BaseException) -> None:
    path = tmp_path / "a"
    path.write_bytes(b"older")
    with pytest.raises((type(error), UserError)), atomic_write(path) as beside:
        beside.write_bytes(b"half")
        raise error
    assert path.read_bytes() == b"older"
    assert list(tmp_path.iterdir()) == [path]


def test_a_full_disk_leaves_nothing(tmp_path: Path) -> None:
    """A file size limit of the process stands for the full disk."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, hard))
    try:
        with pytest.raises(UserError, match=r"a: cannot be written \(File too large\); free some"):
            write_bytes(tmp_path / "a", bytes(2000))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert list(tmp_path.iterdir()) == []


def test_a_folder_in_the_way_is_named_and_left(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    with pytest.raises(UserError, match=r"a: cannot be written .*; move what is there away"):
        write_bytes(tmp_path / "a", b"1")
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_links_and_devices_stay_what_they_are(tmp_path: Path) -> None:
    (tmp_path / "real").write_bytes(b"older")
    (tmp_path / "link").symlink_to(tmp_path / "real")
    write_bytes(tmp_path / "link", b"newer")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_bytes() == b"newer"
    write_bytes(Path(os.devnull), b"lost")
    assert not Path(os.devnull).is_file()


def test_the_longest_name_is_written(tmp_path: Path) -> None:
    path = tmp_path / ("x" * 255)
    write_bytes(path, b"1")
    assert path.read_bytes() == b"1"


def test_what_killed_writers_left_can_be_removed(tmp_path: Path) -> None:
    left, other = tmp_path / ".[a].json.0123.part", tmp_path / ".b.json.0123.part"
    for path in (left, other):
        path.write_bytes(b"")
    remove_parts(tmp_path / "[a].json")
    assert list(tmp_path.iterdir()) == [other]


def test_json_is_strict_and_untouched_where_equal(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    write_json(path, {"a": None, "b": [1.5]})
    assert json.loads(path.read_text()) == {"a": None, "b": [1.5]}
    inode = path.stat().st_ino
    write_json(path, {"a": None, "b": [1.5]})
    assert path.stat().st_ino == inode
    with pytest.raises(ValueError, match="JSON compliant"):
        write_json(path, {"a": float("nan")})
    assert json.loads(path.read_text())["b"] == [1.5]
    assert list(tmp_path.iterdir()) == [path]
    with pytest.raises(UserError, match="give a place in a folder that exists"):
        write_json(tmp_path / "none" / "a.json", {})
