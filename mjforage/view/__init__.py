"""Output for people: reports, videos, figures, the web player."""
