"""Experiments over many episodes: each turns a scenario and policies into a run folder."""
