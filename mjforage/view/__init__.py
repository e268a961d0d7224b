"""What people look at: reports, films, pictures, the web player."""

from mjforage.base.environment import matplotlib_despite, mujoco_despite

matplotlib_despite()
mujoco_despite()
