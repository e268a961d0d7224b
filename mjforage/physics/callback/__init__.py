"""The forces of water, air and thrusters in MuJoCo, as one passive callback for all our models.

`install` puts it in place, any number of times; models of other people are left alone.
"""

from mjforage.physics.callback.installation import install

__all__ = ["install"]
