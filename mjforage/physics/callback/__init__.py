"""The forces of water, air and thrusters in MuJoCo, as one passive callback for all our models.

`install` puts it in place: the native route, or, where that fails its self-test, the Python route
with a warning. It may be called any number of times; models of other people are left alone.
"""

from mjforage.physics.callback.installation import Route, calling, install, installed, uninstall

__all__ = ["Route", "calling", "install", "installed", "uninstall"]
