#!/usr/bin/env python3
"""Bridges any scanner of one plane to floorguard: encodes its scans as datagrams, by the book's "Scan link".

Take `encode` and `Bridge` into a program that reads your scanner, and set robot.toml:

    [scanner]
    model = "bridged"
    source = "udp:127.0.0.1:2370"
    beams = 1440
    first_deg = -180.0
    step_deg = 0.25
    period_s = 0.1
    farthest_m = 30.0
    accept_uncertified_mps = 0.3

To see that datagrams arrive, without a scanner (a round room of 3 m, ten scans a second):

    python3 scan_beams.py --to 127.0.0.1:2370 --seconds 10

Python's standard library is all it needs.
"""

import argparse
import os
import socket
import struct
import time
import zlib

HEAD = struct.Struct("<2sBBIIQiIiHBB")
BEAMS_A_DATAGRAM = 700


def encode(sender, sequence, first_beam_us, geometry, ranges_mm):
    """The datagrams of a scan.

    geometry: (first angle, step), both in millionths of a degree and counter-clockwise, and nanoseconds from beam to beam, negative where
    the device turns clockwise. first_beam_us: the sender's clock at the first beam. ranges_mm: of all beams; 0 is no return.
    """
    fragments = -(-len(ranges_mm) // BEAMS_A_DATAGRAM)
    datagrams = []
    for fragment in range(fragments):
        part = ranges_mm[fragment * BEAMS_A_DATAGRAM : (fragment + 1) * BEAMS_A_DATAGRAM]
        body = HEAD.pack(
            b"FG", 1, 5, sender, sequence & 0xFFFFFFFF, first_beam_us, *geometry, len(ranges_mm), fragment, fragments
        )
        body += struct.pack(f"<{len(part)}H", *part)
        datagrams.append(body + struct.pack("<I", zlib.crc32(body)))
    return datagrams


class Bridge:
    """Sends scans; one for each scanner."""

    def __init__(self, address):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.address = address
        # Another number with each start: a bridge that is started anew counts its scans from the beginning.
        self.sender = struct.unpack("<I", os.urandom(4))[0] | 1
        self.sequence = 0

    def scan(self, first_beam_us, first_deg, step_deg, between_s, ranges_m):
        """A scan, counter-clockwise. ranges_m: metres, None where nothing came back or the measurement is none."""
        geometry = (round(first_deg * 1e6), round(step_deg * 1e6), round(between_s * 1e9))
        for datagram in encode(self.sender, self.sequence, first_beam_us, geometry, [millimetres(each) for each in ranges_m]):
            self.socket.sendto(datagram, self.address)
        self.sequence += 1


def millimetres(range_m):
    """0 for what is no distance, or farther than sixteen bits reach: it is unknown, and never free."""
    if range_m is None or not 0.0 < range_m <= 65.5:
        return 0
    return max(1, round(range_m * 1000))


def round_room(address, seconds):
    """A room of 3 m around a scanner of 1,440 beams."""
    bridge = Bridge(address)
    begun = time.monotonic()
    number = 1
    while number * 0.1 <= seconds:
        # A scan can be sent when its turn is over.
        time.sleep(max(0.0, begun + number * 0.1 - time.monotonic()))
        first_beam_us = int((begun + (number - 1) * 0.1) * 1e6)
        bridge.scan(first_beam_us, -180.0, 0.25, 0.1 / 1440, [3.0] * 1440)
        number += 1
    return bridge.sequence


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--to", default="127.0.0.1:2370", help="ADDRESS:PORT of [scanner] source")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--vector", action="store_true", help="print the book's example datagram and end")
    arguments = parser.parse_args()
    if arguments.vector:
        geometry = (-20_000_000, 10_000_000, 125_000)
        for datagram in encode(7, 42, 1_000_000_123, geometry, [1000, 0, 1001, 30_000, 65_535]):
            print(datagram.hex())
        return
    host, port = arguments.to.rsplit(":", 1)
    sent = round_room((host, int(port)), arguments.seconds)
    print(f"{sent} scans")


if __name__ == "__main__":
    main()
