#!/usr/bin/env python3
"""Bridges any spinning lidar to floorguard: encodes its columns as datagrams, by the book's "Lidar link".

Take `encode` and `Bridge` into a program that reads your lidar, and set robot.toml:

    [lidar]
    model = "columns"
    source = "udp:127.0.0.1:2368"
    elevations_deg = [-15.0, -13.0, ...]

To see that datagrams arrive, without a lidar (a round room of 3 m, ten turns a second):

    python3 lidar_columns.py --to 127.0.0.1:2368 --seconds 10

Python's standard library is all it needs.
"""

import argparse
import math
import os
import socket
import struct
import time
import zlib

HEAD = struct.Struct("<2sBBIIQBBBB")
COLUMNS_A_DATAGRAM = 16


def encode(sender, sequence, stamp_us, unit_mm, columns):
    """The bytes of a datagram.

    columns: up to 24 of (azimuth_cdeg, offset_us, cells), clockwise and in time; cells: (range in counts, reflectivity) of each ring,
    the lowest first; a range of 0 is no return.
    """
    rings = len(columns[0][2])
    body = HEAD.pack(
        b"FG", 1, 4, sender, sequence & 0xFFFFFFFF, stamp_us, rings, len(columns), unit_mm, 0
    )
    for azimuth_cdeg, offset_us, cells in columns:
        body += struct.pack("<HH", azimuth_cdeg % 36000, offset_us)
        for counts, reflectivity in cells:
            body += struct.pack("<HB", counts, reflectivity)
    return body + struct.pack("<I", zlib.crc32(body))


class Bridge:
    """Collects columns and sends them; one for each lidar."""

    def __init__(self, address, unit_mm=4):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.address = address
        self.unit_mm = unit_mm
        # Another number with each start: a bridge that is started anew counts its datagrams from the beginning.
        self.sender = struct.unpack("<I", os.urandom(4))[0] | 1
        self.sequence = 0
        self.begun_us = 0
        self.columns = []

    def column(self, stamp_us, azimuth_deg, cells):
        """What all rings measured at an azimuth, clockwise from ahead: (range in metres or None, reflectivity 0 to 255)."""
        if not self.columns:
            self.begun_us = stamp_us
        counts = [
            (0 if range_m is None else min(65535, max(1, round(range_m * 1000 / self.unit_mm))), reflectivity)
            for range_m, reflectivity in cells
        ]
        self.columns.append((round(azimuth_deg * 100), stamp_us - self.begun_us, counts))
        if len(self.columns) == COLUMNS_A_DATAGRAM:
            datagram = encode(self.sender, self.sequence, self.begun_us, self.unit_mm, self.columns)
            self.socket.sendto(datagram, self.address)
            self.sequence += 1
            self.columns = []


def round_room(address, seconds, elevations_deg):
    """A room of 3 m around a lidar that is 0.8 m high."""
    bridge = Bridge(address)
    columns = 1024
    cells = []
    for elevation_deg in elevations_deg:
        elevation = math.radians(elevation_deg)
        floor_m = 0.8 / math.sin(-elevation) if elevation < 0 else math.inf
        cells.append((min(3.0 / math.cos(elevation), floor_m), 40))
    begun = time.monotonic()
    number = 0
    while time.monotonic() < begun + seconds:
        at_s = begun + number * 0.1 / columns
        time.sleep(max(0.0, at_s - time.monotonic()))
        bridge.column(int(at_s * 1e6), number % columns * 360.0 / columns, cells)
        number += 1
    return bridge.sequence


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--to", default="127.0.0.1:2368", help="ADDRESS:PORT of [lidar] source")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--vector", action="store_true", help="print the book's example datagram and end")
    arguments = parser.parse_args()
    if arguments.vector:
        columns = [(35980, 0, [(250, 10), (0, 0)]), (0, 98, [(251, 11), (65535, 255)])]
        print(encode(7, 42, 1_000_000_123, 4, columns).hex())
        return
    host, port = arguments.to.rsplit(":", 1)
    sent = round_room((host, int(port)), arguments.seconds, [-15.0 + 2.0 * ring for ring in range(16)])
    print(f"{sent} datagrams")


if __name__ == "__main__":
    main()
