"""The parts of the belief planner: where items may float, and where each agent goes.

Knowledge: `tracks` of the items seen, `wind` from their displacements, `hotspots` and what is left
unseen of them. Search: `ways` (decisions between nodes), `routes` of the foragers together,
`sweeps` of the scouts. `planner` composes them; `settings` switches them. Constants here that name
no source are estimates.
"""
