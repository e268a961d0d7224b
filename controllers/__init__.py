"""Guidance, heading and speed loops, thrust allocation and collision avoidance.

Floor 1 of the house: pure functions on arrays, batched over (episode, vessel), knowing nobody.
The controllers arrive together with the MuJoCo vessels; graph-level missions need none.
"""
