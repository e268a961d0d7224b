"""The mission: loop, moves, knowledge, sensing, link, items, log and scores. No MuJoCo."""
