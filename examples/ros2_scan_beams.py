#!/usr/bin/env python3
"""Brings the scans of any scanner's ROS 2 driver to floorguard, by the book's "Scan link".

    source /opt/ros/jazzy/setup.bash
    python3 ros2_scan_beams.py --topic /scan --to 127.0.0.1:2370

and robot.toml, with the angles that the node prints at its first scan:

    [scanner]
    model = "bridged"
    source = "udp:127.0.0.1:2370"
    beams = 1440
    first_deg = -180.0
    step_deg = 0.25
    period_s = 0.1
    farthest_m = 30.0
    accept_uncertified_mps = 0.3

Each sensor_msgs/LaserScan is one scan. Beams keep their angles; those of a driver whose `angle_increment` is negative are reversed. A
range that is not finite, or outside of `range_min` to `range_max`, is unknown, infinity too: it says that nothing came back, which is
what a leg in black does. A full turn that begins elsewhere is sent from -180° on. A driver that sends another number of beams with each turn cannot be bridged: set it to a fixed number.

A scan comes when its turn is over; its last beam was measured at its arrival, the others before, by `time_increment`, or by `scan_time`
where that is 0.

--vector prints the datagrams of two scans without ROS, for a test.
"""

import argparse
import math
import time
from types import SimpleNamespace

from scan_beams import Bridge


def scan_of(message):
    """First angle and step in degrees, seconds from beam to beam, and ranges (None: unknown) of a sensor_msgs/LaserScan."""
    count = len(message.ranges)
    if count < 2 or not math.isfinite(message.angle_min) or not message.angle_increment:
        raise ValueError(f"a scan of {count} ranges {message.angle_increment} rad apart from {message.angle_min} rad")
    between_s = message.time_increment
    if not between_s > 0.0:
        # Many drivers leave it out: a turn has as many beams as fit into it.
        turn = math.tau / abs(message.angle_increment)
        between_s = message.scan_time / turn if message.scan_time > 0.0 else 0.0
    ranges_m = [each if message.range_min <= each <= message.range_max else None for each in message.ranges]
    first, step = message.angle_min, message.angle_increment
    if step < 0.0:
        # Beams run counter-clockwise; the device measures the last of them first.
        first, step, between_s = first + (count - 1) * step, -step, -between_s
        ranges_m.reverse()
    first_deg, ranges_m = within_half_turns(math.degrees(first), math.degrees(step), ranges_m)
    return first_deg, math.degrees(step), between_s, ranges_m


def within_half_turns(first_deg, step_deg, ranges_m):
    """The same beams between -180° and 180°; the middle of the scan in time stays what it is."""
    if len(ranges_m) * step_deg > 360.01:
        # The last beam looks where the first one does: the nearer of both counts.
        both = [each for each in (ranges_m[0], ranges_m[-1]) if each is not None]
        ranges_m = [min(both) if both else None] + ranges_m[1:-1]
    first_deg = (first_deg + 180.0) % 360.0 - 180.0
    if abs(first_deg + 360.0 - 180.0) < 1e-3:
        first_deg = -180.0
    beyond = next((beam for beam in range(len(ranges_m)) if first_deg + beam * step_deg > 180.0 - 1e-3), None)
    if beyond is not None and len(ranges_m) * step_deg < 360.0 - 0.5 * step_deg:
        raise ValueError(f"beams from {first_deg:.2f}° run past 180°: turn the frame of the scan, and the mounting, by half a turn")
    if beyond is not None:
        first_deg, ranges_m = first_deg + beyond * step_deg - 360.0, ranges_m[beyond:] + ranges_m[:beyond]
    return first_deg, ranges_m


def send(bridge, arrived_us, message):
    """A scan whose newest beam was measured when it came."""
    first_deg, step_deg, between_s, ranges_m = scan_of(message)
    duration_us = round(abs(between_s) * (len(ranges_m) - 1) * 1e6)
    first_beam_us = arrived_us - (duration_us if between_s > 0.0 else 0)
    bridge.scan(first_beam_us, first_deg, step_deg, between_s, ranges_m)
    return f"beams = {len(ranges_m)}, first_deg = {first_deg:.4f}, step_deg = {step_deg:.5f}"


class Printed:
    """Stands for the socket of a bridge and prints what is sent."""

    def sendto(self, datagram, _):
        print(datagram.hex())


def vector():
    """A box before a wall, seen by a device that turns counter-clockwise, and by one that turns clockwise."""
    bridge = Bridge(("127.0.0.1", 0))
    bridge.socket, bridge.sender = Printed(), 7
    count = 1440
    increment = math.tau / count
    ranges = []
    for beam in range(count):
        bearing = -math.pi + beam * increment
        # A wall 4 m ahead, a box of 40 cm 1.5 m ahead, and nothing behind.
        ahead = math.cos(bearing)
        wall_m = 4.0 / ahead if ahead > 0.2 else math.inf
        box_m = 1.5 / ahead if ahead > 0.0 and abs(1.5 * math.tan(bearing)) <= 0.2 else math.inf
        ranges.append(min(wall_m, box_m))
    ranges[0], ranges[1] = math.nan, 0.01
    common = {"scan_time": 0.1, "range_min": 0.05, "range_max": 30.0}
    turning = SimpleNamespace(
        angle_min=-math.pi, angle_increment=increment, time_increment=0.1 / count, ranges=ranges, **common
    )
    clockwise = SimpleNamespace(
        angle_min=-math.pi + (count - 1) * increment, angle_increment=-increment, time_increment=0.0,
        ranges=ranges[::-1], **common
    )
    for number, message in enumerate((turning, clockwise)):
        send(bridge, 1_000_000 + (number + 1) * 100_000, message)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--topic", default="/scan")
    parser.add_argument("--to", default="127.0.0.1:2370", help="ADDRESS:PORT of [scanner] source")
    parser.add_argument("--vector", action="store_true", help="print the datagrams of two scans and end")
    arguments = parser.parse_args()
    if arguments.vector:
        vector()
        return
    import rclpy
    from rclpy.qos import qos_profile_sensor_data
    from sensor_msgs.msg import LaserScan

    host, port = arguments.to.rsplit(":", 1)
    bridge = Bridge((host, int(port)))
    shown = []

    def take(message):
        # The moment of arrival: clocks of other computers may differ.
        keys = send(bridge, time.monotonic_ns() // 1000, message)
        if shown != [keys]:
            shown[:] = [keys]
            print(keys)

    rclpy.init()
    node = rclpy.create_node("floorguard_scan_beams")
    node.create_subscription(LaserScan, arguments.topic, take, qos_profile_sensor_data)
    rclpy.spin(node)


if __name__ == "__main__":
    main()
