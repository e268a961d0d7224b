"""Roll, pitch and heave: the check that does not apply to planar hulls."""

from mjforage.physics.validation.known_checks import Parts, check


@check("roll-pitch-heave", "7", "Decay of roll, pitch and heave")
def roll_pitch_heave() -> Parts:
    """Does not apply: hulls move in surge, sway and yaw only, so there is no such motion to decay.

    What is lost by that is measured by checks 5 and 6 and by the tests: there an independent model
    of the otter with all six degrees of freedom agrees with the planar hull.
    """
    return (), ()
