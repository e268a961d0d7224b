"""Dynamics of a mission in MuJoCo: vessels carry decisions out among floating bodies."""
