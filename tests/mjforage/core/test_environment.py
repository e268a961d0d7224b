"""Variables of other people's libraries matter only where something is drawn."""

import subprocess
import sys

import pytest

IMPORTS = """
import os
names = ("MUJOCO_GL", "MPLBACKEND", "PYOPENGL_PLATFORM")
before = [os.environ.get(name) for name in names]
import mjforage.runs.evaluate, mjforage.view.report
import matplotlib, mujoco
mujoco.MjModel.from_xml_string("<mujoco/>")
assert [os.environ.get(name) for name in names] == before, "what is set stays for whoever asks"
"""


@pytest.mark.parametrize(
    "variable",
    [
        "MUJOCO_GL=osmesa",
        "MUJOCO_GL=nonsense",
        "MPLBACKEND=module://matplotlib_inline.backend_inline",
        "MPLBACKEND=nonsense",
        "PYOPENGL_PLATFORM=nonsense",
    ],
)
def test_libraries_are_imported_whatever_they_are_told(variable: str) -> None:
    name, _, value = variable.partition("=")
    program = f"import os\nos.environ[{name!r}] = {value!r}\n{IMPORTS}"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_a_backend_that_is_there_is_chosen() -> None:
    program = (
        "import os\nos.environ['MPLBACKEND'] = 'svg'\n"
        "import mjforage.view.report, matplotlib; print(matplotlib.get_backend())"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)
    assert done.stdout.strip() == b"svg"
