"""The graph: nodes, shortest ways, lines of sight and the boundary of the map."""
