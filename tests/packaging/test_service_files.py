"""Files for the services around the code fit their schemas and agree with what they repeat."""

import re
import tomllib
from typing import Any

import pytest
from check_jsonschema.builtin_schemas import get_builtin_schema
from jsonschema import validators
from ruamel.yaml import YAML

from tests.packaging.contents import REPOSITORY

FORMS = sorted((REPOSITORY / ".github" / "ISSUE_TEMPLATE").glob("*.yml"))
FILES = {
    ".github/workflows/ci.yml": "vendor.github-workflows",
    "CITATION.cff": "vendor.citation-file-format",
} | {
    str(form.relative_to(REPOSITORY)): "vendor.github-issue-config"
    if form.stem == "config"
    else "vendor.github-issue-forms"
    for form in FORMS
}
PROJECT = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf-8"))["project"]


def yaml(path: str) -> Any:
    return YAML(typ="safe", pure=True).load(REPOSITORY / path)


@pytest.mark.parametrize(("path", "schema"), FILES.items())
def test_it_fits_the_public_schema(path: str, schema: str) -> None:
    rules = get_builtin_schema(schema)
    validators.validator_for(rules)(rules).validate(yaml(path))


def test_the_service_has_the_pythons_of_the_classifiers() -> None:
    start = "Programming Language :: Python :: "
    asked = [c.removeprefix(start) for c in PROJECT["classifiers"] if c.startswith(f"{start}3.")]
    jobs = yaml(".github/workflows/ci.yml")["jobs"]
    ran = {name: jobs[name]["strategy"]["matrix"]["python"] for name in ("test", "dist")}
    assert ran["dist"] == asked
    assert set(ran["test"]) < set(asked), "all of them: the comment in ci.yml is out of date"


def test_hooks_have_the_versions_that_the_tests_have() -> None:
    fixed = (REPOSITORY / "constraints.txt").read_text("utf-8").splitlines()
    hooks = yaml(".pre-commit-config.yaml")["repos"][0]["hooks"]
    asked = [line for hook in hooks for line in hook.get("additional_dependencies", [])]
    assert len(asked) == 2
    assert set(asked) <= set(fixed)


def test_the_citation_is_of_this_version_and_licence() -> None:
    cited = yaml("CITATION.cff")
    assert (cited["version"], cited["license"]) == (PROJECT["version"], PROJECT["license"])
    changes = (REPOSITORY / "CHANGELOG.md").read_text("utf-8")
    heading = re.search(r"^## (\S+) \((.*)\)$", changes, re.M)
    assert heading is not None
    assert heading[1] == PROJECT["version"]
    released = "unreleased" if "date-released" not in cited else str(cited["date-released"])
    assert heading[2] == released
