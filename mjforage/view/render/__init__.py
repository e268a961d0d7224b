"""Pictures and films of an episode: a drawing from above, or MuJoCo's view of the harbour."""

from mjforage.view.render.films import default_camera, needs_opengl, render_replay
from mjforage.view.render.times import STEPS_PER_VIDEO_SECOND, frame_times
from mjforage.view.render.top_view import TopView
from mjforage.view.render.video import write_video

__all__ = [
    "STEPS_PER_VIDEO_SECOND",
    "TopView",
    "default_camera",
    "frame_times",
    "needs_opengl",
    "render_replay",
    "write_video",
]
