"""A live stream, watched by a client of the viewers' protocol."""

import asyncio
import json
import socket
import struct
import threading
from queue import Queue
from typing import Any

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore
from tornado.httpclient import HTTPRequest
from tornado.websocket import websocket_connect

import mjforage as mf
from mjforage.base.errors import UserError

MESSAGE = 1  # opcode of binary data in the protocol foxglove.sdk.v1


async def watch(address: str, topic: str) -> list[tuple[int, Any]]:
    """Times and messages of a topic until the server ends."""
    request = HTTPRequest(address, headers={"Sec-WebSocket-Protocol": "foxglove.sdk.v1"})
    viewer = await websocket_connect(request, subprotocols=["foxglove.sdk.v1"])
    channels: dict[str, dict[str, Any]] = {}
    while topic not in channels:
        told = json.loads(await viewer.read_message() or "{}")
        channels |= {one["topic"]: one for one in told.get("channels", [])}
    wanted = channels[topic]
    known = get_typestore(Stores.ROS2_JAZZY)
    subscription = {"id": 7, "channelId": wanted["id"]}
    await viewer.write_message(json.dumps({"op": "subscribe", "subscriptions": [subscription]}))
    found = []
    while (data := await viewer.read_message()) is not None:
        if isinstance(data, bytes) and data[0] == MESSAGE:
            number, time_ns = struct.unpack_from("<IQ", data, 1)
            assert number == 7
            found.append((time_ns, known.deserialize_cdr(data[13:], wanted["schemaName"])))
    viewer.close()
    await asyncio.sleep(0)
    return found


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> mf.Run:
    folder = tmp_path_factory.mktemp("run") / "run"
    return mf.evaluate("comb-port", ["greedy"], episodes=1, folder=folder, horizon=30)


def test_a_viewer_gets_every_message_in_the_pace_of_the_episode(run: mf.Run) -> None:
    addresses: Queue[str] = Queue()
    options: dict[str, Any] = {"port": 0, "speed": 1000.0, "ready": addresses.put}
    serving = threading.Thread(target=run.stream, kwargs=options)
    serving.start()
    address = addresses.get(timeout=60)
    assert address.startswith("ws://127.0.0.1:")
    found = asyncio.run(watch(address, "/scouts_0/odom"))
    serving.join(timeout=60)
    assert not serving.is_alive()
    shown = run.recording()
    assert [time for time, _ in found] == [k * 10**10 for k in range(31)]
    places = [(one.pose.pose.position.x, one.pose.pose.position.y) for _, one in found]
    np.testing.assert_allclose(places, shown.track_pose[:, 0, :2])


def test_a_port_that_is_taken_is_one_line(run: mf.Run) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(UserError, match=f"port {port}: cannot be served"):
            run.stream(port=port)
    with pytest.raises(UserError, match="port 65536: give"):
        run.stream(port=65536)
