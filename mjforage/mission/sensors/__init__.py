"""Sensors of the mission: detection, missed detections, false positives, filtered maps."""
