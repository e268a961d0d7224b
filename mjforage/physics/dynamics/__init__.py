"""Dynamics of a mission in MuJoCo: hulls carry decisions out among floating bodies."""
