"""Libraries of extras: each that is missing is one line, and what does not need it goes on."""

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from mjforage.base.errors import UserError
from mjforage.base.extras import extra_with, how_to_install, require
from mjforage.testing import check_policy

REPOSITORY = Path(__file__).parents[3]
PROJECT = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf-8"))["project"]


@pytest.mark.parametrize(
    ("module", "extra"),
    [
        ("torch", "learn"),
        ("torch.utils.tensorboard", "learn"),
        ("tensorboard", "learn"),
        ("torchrl.modules", "learn"),
        ("av", "film"),
        ("OpenGL.GL", "film"),
        ("distributed", "cluster"),
        ("stable_baselines3.common", "libraries"),
        ("pyogrio.raw", "places"),
        ("shapely", "places"),
        ("pyproj", "places"),
        ("numpy", ""),
        ("no_such_thing", ""),
    ],
)
def test_a_module_comes_with_an_extra(module: str, extra: str) -> None:
    assert extra_with(module) == extra
    assert (f"'mjforage[{extra}]'" in how_to_install(module)) == bool(extra)


def test_what_is_not_installed_is_asked_for_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    require("a test", "numpy", "pytest")
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(UserError) as told:
        require("policy ddqn", "numpy", "torch")
    assert str(told.value) == (
        "policy ddqn: needs torch; install it with pip install 'mjforage[learn]'"
    )


def test_all_names_extras_that_there_are() -> None:
    there = PROJECT["optional-dependencies"]
    named = there["all"][0].removeprefix("mjforage[").removesuffix("]").split(",")
    assert set(named) == there.keys() - {"all", "dev", "docs"}


def test_a_check_that_needs_no_torch_loads_none() -> None:
    """Nor does `import mjforage`, an environment of it, or the pictures of one."""
    blocked = [
        "torch",
        "torchrl",
        "tensordict",
        "tensorboard",
        "av",
        "OpenGL",
        "distributed",
        "pyogrio",
        "pyproj",
        "shapely",
    ]
    program = f"""
import sys
sys.modules.update(dict.fromkeys({blocked}))
from mjforage.testing import check_policy
import mjforage.view.render, mjforage.cli.schemas, mjforage.runs.evaluate, gymnasium
mjforage.cli.schemas.schemas_of_files()
assert gymnasium.make("mjforage/Foraging-v0").unwrapped
try:
    from mjforage.testing import check_algorithm
except ImportError as error:
    raise SystemExit(f"an ImportError: {{error}}")
except mjforage.base.errors.UserError as error:
    print(error)
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("check_algorithm: needs torch; install it")
    assert callable(check_policy)
