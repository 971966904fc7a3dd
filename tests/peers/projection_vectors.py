"""Vectors of core-nostd/mapping/src/people_removal/camera_tests.rs: where OpenCV's projectPoints puts lidar points.

    pip install opencv-python-headless && python tests/peers/projection_vectors.py
"""

import random

import cv2
import numpy

CAMERA = numpy.array([[615.2, 0.0, 322.4], [0.0, 617.9, 243.7], [0.0, 0.0, 1.0]])
LENS = numpy.array([-0.281, 0.0912, 0.0007, -0.0011, -0.0123])  # k1 k2 p1 p2 k3
AXES = numpy.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]])  # from x forward to z forward
ROTATION = cv2.Rodrigues(numpy.array([0.034, -0.021, 0.012]))[0] @ AXES
TRANSLATION = numpy.array([0.06, -0.11, -0.07])

random.seed(25)
points = []
for _ in range(12):
    x = round(random.uniform(0.8, 12.0), 2)
    points.append([x, round(random.uniform(-0.8, 0.8) * x, 2), round(random.uniform(-0.5, 0.5) * x, 2)])
pixels, _ = cv2.projectPoints(numpy.array(points), cv2.Rodrigues(ROTATION)[0], TRANSLATION, CAMERA, LENS)
print("// OpenCV", cv2.__version__)
for row in ROTATION:
    print("[" + ", ".join(f"{value:.9f}" for value in row) + "],")
for point, pixel in zip(points, pixels.reshape(-1, 2)):
    print(f"({point}, [{pixel[0]:.4f}, {pixel[1]:.4f}]),")
