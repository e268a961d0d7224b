"""Forces of water, air and thrusters on a vessel: pure kernels on the record of `pack`.

Body axes x forward, y port; forces at midships. Nothing here knows MuJoCo.
"""
