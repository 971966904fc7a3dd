#!/usr/bin/env python3
"""Brings the point clouds of any lidar's ROS 2 driver to floorguard, by the book's "Lidar link".

    source /opt/ros/jazzy/setup.bash
    python3 ros2_lidar_columns.py --topic /points --to 127.0.0.1:2368

and robot.toml:

    [lidar]
    model = "columns"
    source = "udp:127.0.0.1:2368"
    elevations_deg = [-15.0, -13.0, -11.0, -9.0, -7.0, -5.0, -3.0, -1.0, 1.0, 3.0, 5.0, 7.0, 9.0, 11.0, 13.0, 15.0]

Each cloud is one turn. Its points go into sixteen rings, each to the nearest elevation, and into columns clockwise; of several points in
a cell the nearest is kept, and a cell without one is unknown. A cloud comes when its turn is over, so what the robot sees is older by a
turn than with a driver of floorguard's own: set `response_s` of [limits] 0.1 s higher.

--vector prints the datagrams of a round room without ROS, for a test.
"""

import argparse
import math
import struct
import time

from lidar_columns import Bridge

COLUMNS = 900
PERIOD_US = 100_000
UNIT_MM = 4
FLOAT32, FLOAT64 = 7, 8


def points_of(message):
    """x, y, z and intensity of each point of a sensor_msgs/PointCloud2."""
    fields = {field.name: field for field in message.fields}
    missing = [name for name in "xyz" if name not in fields]
    if missing:
        raise ValueError(f"the cloud has no field {missing[0]}; it has {sorted(fields)}")
    order = ">" if message.is_bigendian else "<"

    def reader(name):
        field = fields.get(name)
        if field is None or field.datatype not in (FLOAT32, FLOAT64):
            return None
        return struct.Struct(order + ("f" if field.datatype == FLOAT32 else "d")), field.offset

    readers = [reader(name) for name in ("x", "y", "z", "intensity")]
    if None in readers[:3]:
        raise ValueError("x, y and z of the cloud are no floating-point numbers")
    data = bytes(message.data)
    for row in range(message.height):
        for column in range(message.width):
            at = row * message.row_step + column * message.point_step
            yield tuple(0.0 if each is None else each[0].unpack_from(data, at + each[1])[0] for each in readers)


def columns_of(points, elevations_deg):
    """The columns of a turn, clockwise from behind: (azimuth in degrees, cells as `Bridge.column` takes them)."""
    last = len(elevations_deg) - 1
    gaps = [b - a for a, b in zip(elevations_deg, elevations_deg[1:])]
    edges = [
        (
            elevation - (gaps[ring - 1] if ring else gaps[0]) / 2,
            elevation + (gaps[ring] if ring < last else gaps[-1]) / 2,
        )
        for ring, elevation in enumerate(elevations_deg)
    ]
    cells = [[None] * len(elevations_deg) for _ in range(COLUMNS)]
    for x, y, z, intensity in points:
        plane_m = math.hypot(x, y)
        if not plane_m > 0.05 or not math.isfinite(plane_m + z):
            continue
        elevation = math.degrees(math.atan2(z, plane_m))
        ring = next((ring for ring, (low, high) in enumerate(edges) if low <= elevation < high), None)
        if ring is None:
            continue
        azimuth = (180.0 - math.degrees(math.atan2(y, x))) % 360.0
        column = cells[min(COLUMNS - 1, int(azimuth * COLUMNS / 360.0))]
        # The distance in the plane is the point's own, whatever the elevation of its ring.
        range_m = plane_m / math.cos(math.radians(elevations_deg[ring]))
        if column[ring] is None or range_m < column[ring][0]:
            column[ring] = (range_m, int(min(255.0, max(0.0, intensity))) if math.isfinite(intensity) else 0)
    for number, column in enumerate(cells):
        azimuth_deg = ((number + 0.5) * 360.0 / COLUMNS + 180.0) % 360.0
        yield azimuth_deg, [(None, 0) if cell is None else cell for cell in column]


def send(bridge, stamp_us, points, elevations_deg):
    """A cloud whose turn ended at `stamp_us`."""
    for number, (azimuth_deg, cells) in enumerate(columns_of(points, elevations_deg)):
        bridge.column(stamp_us - PERIOD_US + number * PERIOD_US // COLUMNS, azimuth_deg, cells)


class Printed:
    """Stands for the socket of a bridge and prints what is sent."""

    def sendto(self, datagram, _):
        print(datagram.hex())


def vector(elevations_deg):
    """Two turns in a round room of 3 m, 0.8 m above its floor: the points of a lidar with 64 rings."""
    bridge = Bridge(("127.0.0.1", 0), UNIT_MM)
    bridge.socket, bridge.sender = Printed(), 7
    points = []
    for ring in range(64):
        elevation = math.radians(-22.5 + ring * 45.0 / 63.0)
        for step in range(1024):
            azimuth = math.tau * step / 1024
            plane_m = min(3.0, 0.8 / math.tan(-elevation) if elevation < 0 else math.inf)
            points.append((plane_m * math.cos(azimuth), plane_m * math.sin(azimuth), plane_m * math.tan(elevation), 40.0))
    for turn in range(2):
        send(bridge, 1_000_000 + (turn + 1) * PERIOD_US, points, elevations_deg)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--topic", default="/points")
    parser.add_argument("--to", default="127.0.0.1:2368", help="ADDRESS:PORT of [lidar] source")
    parser.add_argument(
        "--elevations-deg", type=float, nargs=16, default=[-15.0 + 2.0 * ring for ring in range(16)],
        help="as elevations_deg of [lidar]",
    )
    parser.add_argument("--vector", action="store_true", help="print the datagrams of a round room and end")
    arguments = parser.parse_args()
    if arguments.vector:
        vector(arguments.elevations_deg)
        return
    import rclpy
    from rclpy.qos import qos_profile_sensor_data
    from sensor_msgs.msg import PointCloud2

    host, port = arguments.to.rsplit(":", 1)
    bridge = Bridge((host, int(port)), UNIT_MM)

    def take(message):
        # The moment of arrival: clocks of other computers may differ.
        send(bridge, time.monotonic_ns() // 1000, points_of(message), arguments.elevations_deg)

    rclpy.init()
    node = rclpy.create_node("floorguard_lidar_columns")
    node.create_subscription(PointCloud2, arguments.topic, take, qos_profile_sensor_data)
    rclpy.spin(node)


if __name__ == "__main__":
    main()
