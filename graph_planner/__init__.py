"""The graph of a map, and the policies that decide from node to node.

`graph` stands below the mission, all else above it. Neither knows physics or files of runs.
"""
