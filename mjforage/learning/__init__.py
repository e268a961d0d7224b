"""Environments for learners, and training."""
