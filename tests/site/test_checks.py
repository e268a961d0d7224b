"""The checks of a made site refuse each fault, and nothing else."""

from pathlib import Path

import pytest

from tests.site import checks
from tests.site.checks import faults

GOOD = """<link rel="stylesheet" href="a.css?v=1"><link rel="canonical" href="https://x.org/">
<a href="#here" id="here">x</a><a href="sub/b.html#there">y</a><a href="https://x.org">z</a>
<img src="data:image/png;base64,AA==" style="background: url(i.png)"><img src="i.png">"""


@pytest.fixture
def site(tmp_path: Path) -> Path:
    (tmp_path / "sub").mkdir()
    (tmp_path / "index.html").write_text(GOOD)
    (tmp_path / "sub" / "b.html").write_text('<p id="there"><a href="../index.html">back</a>')
    (tmp_path / "a.css").write_text("p { background: url('i.png#x') }")
    (tmp_path / "i.png").write_bytes(b"")
    return tmp_path


def test_a_sound_site_has_no_faults(site: Path) -> None:
    assert faults(site) == []


@pytest.mark.parametrize(
    ("file", "text", "word"),
    [
        ("index.html", '<script src="https://cdn.org/x.js"></script>', "network"),
        ("index.html", '<script src="//cdn.org/x.js"></script>', "network"),
        ("index.html", '<link rel="shortcut icon" href="https://cdn.org/x.ico">', "network"),
        ("index.html", '<img srcset="i.png 1x, https://x.org/i.png 2x">', "network"),
        ("index.html", '<video poster="none.png"></video>', "not there"),
        ("index.html", '<p style="background: url(https://x.org/i.png)">', "network"),
        ("index.html", '<img src="none.png">', "not there"),
        ("index.html", '<a href="none.html">x</a>', "not there"),
        ("index.html", '<a href="sub/b.html#nowhere">x</a>', "anchor"),
        ("index.html", '<a href="#nowhere">x</a>', "anchor"),
        ("a.css", "@import 'https://x.org/a.css';", "network"),
        ("a.css", "@font-face { src: url(none.woff2) }", "not there"),
    ],
)
def test_each_fault_is_told_with_its_file(site: Path, file: str, text: str, word: str) -> None:
    (site / file).write_text((site / file).read_text() + text)
    (found,) = faults(site)
    assert found.startswith(f"{file}: ")
    assert word in found


def test_a_site_that_is_too_large_or_empty_is_refused(
    site: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(checks, "LARGEST", 10)
    assert "MB, more than" in faults(site)[0]
    (found,) = faults(site / "none")
    assert "make docs" in found
