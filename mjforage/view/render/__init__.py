"""Pictures and films of an episode: a drawing from above, or MuJoCo's view of the harbour."""

from mjforage.view.render.films import map_film, render_recording
from mjforage.view.render.video import write_video

__all__ = ["map_film", "render_recording", "write_video"]
