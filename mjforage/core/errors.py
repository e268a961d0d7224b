"""The error that a user can mend, under the name that every floor of mjforage imports."""

from graph_planner.errors import UserError

__all__ = ["UserError"]
