"""Speeds on this machine."""
