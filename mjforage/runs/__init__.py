"""Runs on disk: folders, tables, evaluations, studies, workers, clusters, replays."""
