"""Pictures and films of an episode: a drawing from above, or MuJoCo's view of the harbour."""

from mjforage.render.films import default_camera, needs_opengl, render_replay
from mjforage.render.times import STEPS_PER_VIDEO_SECOND, frame_times
from mjforage.render.top_view import TopView
from mjforage.render.video import write_video

__all__ = [
    "STEPS_PER_VIDEO_SECOND",
    "TopView",
    "default_camera",
    "frame_times",
    "needs_opengl",
    "render_replay",
    "write_video",
]
