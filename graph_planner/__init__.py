"""Decisions on a graph: navigation graph, knowledge, observation, legal moves and policies.

Floor 2 of the house. It knows neither physics nor files; `mjforage` composes it.
"""
