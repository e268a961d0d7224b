"""An episode as a live stream on this machine, for Foxglove and other viewers of its kind."""

import io
import threading
import time
from collections.abc import Callable

from mjforage.base.errors import UserError
from mjforage.base.extras import require
from mjforage.mission.setup import Setup
from mjforage.runs.episode_recording import Recording
from mjforage.runs.exporting.ros import BAG, mcap_files

HOST = "127.0.0.1"


def stream(
    setup: Setup, recording: Recording, port: int, speed: float, ready: Callable[[str], None]
) -> None:
    """Serve an episode once, from when the first viewer has subscribed to a topic.

    The messages are those of the bag (`ros.messages`), at the times of their headers. Raises
    `UserError` if the port is taken, or a library is missing.

    Parameters
    ----------
    port : TCP port; 0 for any that is free
    speed : simulated seconds per second
    ready : called with the address for the viewer
    """
    require("a live stream", "foxglove", "mcap", "mcap_ros2")
    import foxglove
    from foxglove.websocket import ServerListener
    from mcap.reader import make_reader

    watched = threading.Event()

    class Listener(ServerListener):
        def on_subscribe(self, *_: object) -> None:
            watched.set()

    bag = make_reader(io.BytesIO(mcap_files(setup, recording)[BAG]))
    context, summary, channels = foxglove.Context(), bag.get_summary(), {}
    assert summary is not None
    for number, one in summary.channels.items():
        known = summary.schemas[one.schema_id]
        schema = foxglove.Schema(name=known.name, encoding=known.encoding, data=known.data)
        channels[number] = foxglove.Channel(
            one.topic, schema=schema, message_encoding=one.message_encoding, context=context
        )
    try:
        server = foxglove.start_server(
            name="mjforage", host=HOST, port=port, server_listener=Listener(), context=context
        )
    except RuntimeError as error:
        raise UserError(f"port {port}: cannot be served ({error}); choose another") from error
    try:
        ready(f"ws://{HOST}:{server.port}")
        while not watched.wait(0.2):  # returns to Python, so that Ctrl-C ends it
            pass
        began, first = time.monotonic(), None
        for _, one, message in bag.iter_messages():
            first = message.log_time if first is None else first
            due = began + 1e-9 * (message.log_time - first) / speed
            time.sleep(max(0.0, due - time.monotonic()))
            channels[one.id].log(message.data, log_time=message.log_time)
    finally:
        server.stop()
