"""Studies: variants of a scenario on the same episodes, benchmark tasks."""
