"""Whether a made site can be read without a network: what it loads and where its links lead."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LARGEST = 40 * 2**20  # bytes of all files
_LOADED = {"script", "img", "source", "video", "audio", "iframe", "embed", "track", "input"}
_LINKS_LOADED = {"stylesheet", "icon", "preload", "modulepreload", "manifest", "shortcut"}
_IN_CSS = re.compile(r"""(?:url\(\s*|@import\s+)["']?([^"')\s;]+)""")


@dataclass
class Page(HTMLParser):
    """What a page loads, where it links, and which anchors it has."""

    text: str
    loads: list[str] = field(default_factory=list)
    links: list[str] = field(default_factory=list)
    anchors: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        super().__init__()
        self.feed(self.text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        told = {name: value or "" for name, value in attrs}
        self.anchors.add(told.get("id", ""))
        if tag in _LOADED:
            self.loads += [told[name] for name in ("src", "poster") if name in told]
            self.loads += [part.split()[0] for part in told.get("srcset", "").split(",") if part]
        elif tag == "object":
            self.loads.append(told.get("data", ""))
        elif tag == "link" and _LINKS_LOADED & set(told.get("rel", "").split()):
            self.loads.append(told.get("href", ""))
        elif tag == "a" and "href" in told:
            self.links.append(told["href"])
        if "style" in told:
            self.loads += _IN_CSS.findall(told["style"])


def faults(site: Path) -> list[str]:
    """One line for each thing that a reader without a network would miss."""
    paths = [path for path in sorted(site.rglob("*.html")) if path.parent.name != "_static"]
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in paths}  # less the theme's own
    if not pages:
        return [f"{site}: no page; run `make docs`"]
    found = [line for path in pages for line in _of_page(site, path, pages)]
    for path in sorted(site.rglob("*.css")):
        for target in _IN_CSS.findall(path.read_text(encoding="utf-8")):
            found += _of_load(site, path, target)
    size = sum(path.stat().st_size for path in site.rglob("*") if path.is_file())
    if size > LARGEST:
        found.append(f"{site}: {size / 2**20:.1f} MB, more than {LARGEST / 2**20:.0f}")
    return found


def _of_page(site: Path, path: Path, pages: dict[Path, Page]) -> Iterator[str]:
    name = path.relative_to(site)
    for target in pages[path].loads:
        yield from _of_load(site, path, target)
    for link in pages[path].links:
        parts = urlsplit(link)
        if parts.scheme or parts.netloc:
            continue
        there = (path.parent / unquote(parts.path)).resolve() if parts.path else path.resolve()
        if not there.is_file():
            yield f"{name}: links to {link}, which is not there"
        elif there in pages and unquote(parts.fragment) not in pages[there].anchors | {""}:
            yield f"{name}: links to {link}, which has no such anchor"


def _of_load(site: Path, path: Path, target: str) -> Iterator[str]:
    parts = urlsplit(target)
    if parts.scheme == "data" or not target or target.startswith("#"):
        return
    if parts.scheme or parts.netloc:
        yield f"{path.relative_to(site)}: loads {target} from the network"
    elif not (path.parent / unquote(parts.path)).resolve().is_file():
        yield f"{path.relative_to(site)}: loads {target}, which is not there"
