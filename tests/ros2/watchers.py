"""Programs that watch a robot as its users' screens do: Foxglove, and the operator's panel in a browser.

Usage: watchers.py foxglove|panel ADDRESS:PORT SECONDS

Foxglove's watcher subscribes to every channel; the panel's asks as its page does. Prints how many messages came.
"""

import asyncio
import http.client
import json
import sys
import time
import urllib.request

import websockets


async def foxglove(address, ends):
    subscription = ["foxglove.sdk.v1", "foxglove.websocket.v1"]
    async with websockets.connect(f"ws://{address}", subprotocols=subscription, max_size=None) as socket:
        count, channels = 0, 0
        while time.monotonic() < ends:
            try:
                message = await asyncio.wait_for(socket.recv(), ends - time.monotonic())
            except (TimeoutError, websockets.ConnectionClosed):
                break
            if isinstance(message, bytes):
                count += 1
                continue
            message = json.loads(message)
            if message["op"] == "advertise":
                wanted = [{"id": channels + at, "channelId": each["id"]} for at, each in enumerate(message["channels"])]
                channels += len(wanted)
                await socket.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))
        return count


def panel(address, ends):
    count, number = 0, 0
    while time.monotonic() < ends:
        try:
            with urllib.request.urlopen(f"http://{address}/state?after={number}") as answer:
                body = answer.read()
        except (OSError, http.client.HTTPException):
            break  # the run has ended
        number = json.loads(body)["number"] if body else number
        count += 1
    return count


def main():
    what, address, seconds = sys.argv[1], sys.argv[2], float(sys.argv[3])
    ends = time.monotonic() + seconds
    count = asyncio.run(foxglove(address, ends)) if what == "foxglove" else panel(address, ends)
    print(json.dumps({"watcher": what, "messages": count}))
    return 0 if count else 1


if __name__ == "__main__":
    sys.exit(main())
