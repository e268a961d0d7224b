"""The Gymnasium ids, by name only: nothing of an environment is imported before it is made."""

from gymnasium import register, registry

_HERE = "mjforage.learning.environments"

ENTRIES = {
    "mjforage/Foraging-v0": ("foraging:ForagingEnv", "vector:ForagingVectorEnv"),
    "mjforage/SharedPolicy-v0": ("shared_policy:SharedPolicyEnv", None),
    "mjforage/Waypoint-v0": ("waypoint:WaypointEnv", "waypoint_vector:make_waypoint_batch"),
}
"""Id -> class of one environment, and of a batch where there is one of our own."""


def register_all() -> None:
    """Make the ids known to `gymnasium.make` and `gymnasium.make_vec`."""
    for name, (single, batch) in ENTRIES.items():
        if name not in registry:
            register(
                id=name,
                entry_point=f"{_HERE}.{single}",
                vector_entry_point=f"{_HERE}.{batch}" if batch else None,
            )
