#!/usr/bin/env python3
"""Brings the samples of any inertial sensor's ROS 2 driver to floorguard, by the book's "IMU link".

    source /opt/ros/jazzy/setup.bash
    python3 ros2_imu_samples.py --topic /imu/data --to 127.0.0.1:2371

and robot.toml:

    [imu]
    model = "bridged"
    source = "udp:127.0.0.1:2371"

Each sensor_msgs/Imu is one sample. Its axes are those of REP 103, forward, left and up of the sensor, and its accelerations hold gravity:
both as the link wants them. A sample is sent as a fault where the driver says that it has no rates or no accelerations (a covariance that
begins with -1), or where one of them is not finite.

--vector prints the frames of three samples without ROS, for a test.
"""

import argparse
import math
import time
from types import SimpleNamespace

from imu_samples import FAULT, Bridge


def sample_of(message):
    """Rates, accelerations and flags of a sensor_msgs/Imu."""
    rates = [getattr(message.angular_velocity, axis) for axis in "xyz"]
    accelerations = [getattr(message.linear_acceleration, axis) for axis in "xyz"]
    is_missing = message.angular_velocity_covariance[0] == -1 or message.linear_acceleration_covariance[0] == -1
    if is_missing or not all(math.isfinite(each) for each in rates + accelerations):
        return [0.0] * 3, [0.0] * 3, FAULT
    return rates, accelerations, 0


class Printed:
    """Stands for the socket of a bridge and prints what is sent."""

    def sendto(self, frame, _):
        print(frame.hex())


def vector():
    """A sample of a sensor that turns to the left, one without rates, and one that is not a number."""
    bridge = Bridge(("127.0.0.1", 0))
    bridge.socket, bridge.sender = Printed(), 7

    def message(turn_radps, covariance):
        return SimpleNamespace(
            angular_velocity=SimpleNamespace(x=0.0, y=0.0, z=turn_radps),
            angular_velocity_covariance=[covariance] + [0.0] * 8,
            linear_acceleration=SimpleNamespace(x=0.25, y=0.0, z=9.75),
            linear_acceleration_covariance=[0.0] * 9,
        )

    for number, each in enumerate((message(0.5, 0.0), message(0.5, -1), message(math.nan, 0.0))):
        bridge.sample(1_000_000 + number * 10_000, *sample_of(each))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--topic", default="/imu/data")
    parser.add_argument("--to", default="127.0.0.1:2371", help="ADDRESS:PORT of [imu] source")
    parser.add_argument("--vector", action="store_true", help="print the frames of three samples and end")
    arguments = parser.parse_args()
    if arguments.vector:
        vector()
        return
    import rclpy
    from rclpy.qos import qos_profile_sensor_data
    from sensor_msgs.msg import Imu

    host, port = arguments.to.rsplit(":", 1)
    bridge = Bridge((host, int(port)))

    def take(message):
        # The moment of arrival: clocks of other computers may differ.
        bridge.sample(time.monotonic_ns() // 1000, *sample_of(message))

    rclpy.init()
    node = rclpy.create_node("floorguard_imu_samples")
    node.create_subscription(Imu, arguments.topic, take, qos_profile_sensor_data)
    rclpy.spin(node)


if __name__ == "__main__":
    main()
