"""Environments for learning: thin views on the mission for Gymnasium and PettingZoo.

`import mjforage` registers `mjforage/Foraging-v0`, `mjforage/SharedPolicy-v0` and
`mjforage/Waypoint-v0`; `mjforage.parallel_env(...)` is the PettingZoo view. Modules are imported
when an environment is made.
"""
