#!/usr/bin/env python3
"""Bridges any inertial sensor to floorguard: encodes its samples as frames, by the book's "IMU link".

Take `encode` and `Bridge` into a program that reads your sensor, and set robot.toml:

    [imu]
    model = "bridged"
    source = "udp:127.0.0.1:2371"

To see that frames arrive, without a sensor (one that lies still, a hundred samples a second):

    python3 imu_samples.py --to 127.0.0.1:2371 --seconds 10

Python's standard library is all it needs.
"""

import argparse
import os
import socket
import struct
import time
import zlib

HEAD = struct.Struct("<2sBBIIQIB3x")
SAMPLE = struct.Struct("<6fB3x")
SATURATED, FAULT = 1, 2


def encode(sender, sequence, first_sample_us, between_us, samples):
    """The bytes of a frame.

    samples: 1 to 3 of (rates of turn in rad/s, accelerations in m/s², flags), the oldest first; axes forward, left, up. sequence: the
    number of the first one. first_sample_us: the sender's clock at the first one. between_us: from sample to sample.
    """
    body = HEAD.pack(b"FG", 1, 6, sender, sequence & 0xFFFFFFFF, first_sample_us, between_us, len(samples))
    for rates, accelerations, flags in samples:
        body += SAMPLE.pack(*rates, *accelerations, flags)
    return body + struct.pack("<I", zlib.crc32(body))


class Bridge:
    """Sends samples; one for each sensor."""

    def __init__(self, address):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.address = address
        # Another number with each start: a bridge that is started anew counts its samples from the beginning.
        self.sender = struct.unpack("<I", os.urandom(4))[0] | 1
        self.sequence = 0

    def sample(self, measured_us, rates, accelerations, flags=0):
        """A sample: rad/s, and m/s² with gravity; forward, left, up."""
        frame = encode(self.sender, self.sequence, measured_us, 0, [(rates, accelerations, flags)])
        self.socket.sendto(frame, self.address)
        self.sequence += 1


def lying_still(address, seconds):
    """A sensor that lies still, with a little noise: one that repeats itself to the bit is taken for frozen."""
    bridge = Bridge(address)
    begun = time.monotonic()
    while bridge.sequence * 0.01 < seconds:
        time.sleep(max(0.0, begun + bridge.sequence * 0.01 - time.monotonic()))
        noise = [(byte - 127.5) * 1e-5 for byte in os.urandom(6)]
        bridge.sample(time.monotonic_ns() // 1000, noise[:3], [noise[3], noise[4], 9.81 + noise[5]])
    return bridge.sequence


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--to", default="127.0.0.1:2371", help="ADDRESS:PORT of [imu] source")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--vector", action="store_true", help="print the book's example frame and end")
    arguments = parser.parse_args()
    if arguments.vector:
        samples = [((0.5, -0.25, 0.125), (1.5, -2.5, 9.75), 0), ((0.0, 0.0, -1.0), (0.0, 0.0, 10.0), SATURATED)]
        print(encode(7, 42, 1_000_000_123, 10_000, samples).hex())
        return
    host, port = arguments.to.rsplit(":", 1)
    sent = lying_still((host, int(port)), arguments.seconds)
    print(f"{sent} samples")


if __name__ == "__main__":
    main()
