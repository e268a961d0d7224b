"""Write the picture of the layers into CONTRIBUTING.md: `python -m tests.layers`."""

import re

from tests.layers.picture import REPOSITORY, picture

PAGE = REPOSITORY / "CONTRIBUTING.md"
DRAWN = re.compile(
    r"(?P<head>^<!-- Drawn by `python -m tests.layers`. -->\n```text\n).*?(?=^```$)", re.S | re.M
)


def renewed(text: str) -> str:
    """Return a page with the picture of today.

    Raises
    ------
    ValueError
        If the page has no place for it, or several.
    """
    new, count = DRAWN.subn(lambda found: found["head"] + picture(), text)
    if count != 1:
        raise ValueError(f"{count} places for the picture in {PAGE.name}, 1 expected")
    return new


if __name__ == "__main__":
    PAGE.write_text(renewed(PAGE.read_text("utf-8")))
