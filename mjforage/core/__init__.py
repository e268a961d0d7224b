"""The mission itself: scenario, map, world, dynamics of the graph, log and scores. No MuJoCo."""
