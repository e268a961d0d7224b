"""Pictures of maps and manoeuvres."""
