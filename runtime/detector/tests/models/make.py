"""Makes small models with the output layouts of YOLOX and of YOLOv8 and YOLO11, and what independent libraries say of them.

Usage: python3 make.py FOLDER SEED
Needs numpy, onnx, onnxruntime (runs the models) and opencv-python-headless (scales pictures, suppresses boxes).
The weights are random: the models find nothing, but they compute the same everywhere.
"""
import json
import sys

import cv2
import numpy as np
import onnx
import onnxruntime
from onnx import TensorProto, helper, numpy_helper

FRAME, CLASSES, WIDTH = 64, 3, 8
STRIDES = (8, 16, 32)
CELLS = sum((FRAME // s) ** 2 for s in STRIDES)
folder, seed = sys.argv[1], int(sys.argv[2])


class Graph:
    def __init__(self, random):
        self.random, self.nodes, self.constants, self.count = random, [], [], 0

    def constant(self, values):
        self.count += 1
        name = f"c{self.count}"
        self.constants.append(numpy_helper.from_array(np.ascontiguousarray(values), name))
        return name

    def op(self, kind, inputs, **attributes):
        self.count += 1
        name = f"v{self.count}"
        self.nodes.append(helper.make_node(kind, inputs, [name], **attributes))
        return name

    def conv(self, x, out, into, size, stride, bias=0.0):
        w = self.random.normal(0, 1.6 / np.sqrt(out * size * size), (into, out, size, size)).astype(np.float32)
        b = (self.random.normal(0, 0.3, into) + bias).astype(np.float32)
        pad = size // 2
        return self.op("Conv", [x, self.constant(w), self.constant(b)], kernel_shape=[size] * 2,
                       strides=[stride] * 2, pads=[pad] * 4)

    def block(self, x, out, into, stride):
        y = self.conv(x, out, into, 3, stride)
        return self.op("Mul", [y, self.op("Sigmoid", [y])])

    def pyramid(self, factor):
        x = self.op("Mul", ["images", self.constant(np.array(factor, np.float32))])
        x = self.block(x, 3, WIDTH, 2)
        x = self.op("MaxPool", [x], kernel_shape=[2, 2], strides=[2, 2])
        a = self.block(x, WIDTH, WIDTH, 2)
        b = self.block(a, WIDTH, WIDTH, 2)
        c = self.block(b, WIDTH, WIDTH, 2)
        up = self.op("Resize", [b, "", self.constant(np.array([1, 1, 2, 2], np.float32))], mode="nearest",
                     coordinate_transformation_mode="asymmetric", nearest_mode="floor")
        return [self.block(self.op("Concat", [a, up], axis=1), 2 * WIDTH, WIDTH, 1), b, c]


def heads(graph, channels, bias, factor):
    parts = []
    for level in graph.pyramid(factor):
        y = graph.conv(level, WIDTH, channels, 1, 1, bias)
        parts.append(graph.op("Reshape", [y, graph.constant(np.array([1, channels, -1], np.int64))]))
    return graph.op("Concat", parts, axis=2)


def cut(graph, x, begin, end):
    at = lambda value: graph.constant(np.array([value], np.int64))
    return graph.op("Slice", [x, at(begin), at(end), at(1)])


def grids():
    rows = [(c, r, s) for s in STRIDES for r in range(FRAME // s) for c in range(FRAME // s)]
    return np.array(rows, np.float32).T


def yolox(random):
    graph = Graph(random)
    x = heads(graph, 5 + CLASSES, 0.2, 1 / 255)
    sure = graph.op("Sigmoid", [cut(graph, x, 4, 5 + CLASSES)])
    place = graph.op("Mul", [cut(graph, x, 0, 4), graph.constant(np.array(0.3, np.float32))])
    y = graph.op("Transpose", [graph.op("Concat", [place, sure], axis=1)], perm=[0, 2, 1])
    return graph, y, [1, CELLS, 5 + CLASSES]


def yolov8(random):
    graph = Graph(random)
    x = heads(graph, 4 + CLASSES, 0.2, 1.0)
    column, row, stride = grids()
    place = graph.op("Sigmoid", [cut(graph, x, 0, 2)])
    place = graph.op("Add", [place, graph.constant(np.stack([column, row])[None])])
    place = graph.op("Mul", [place, graph.constant(stride[None, None])])
    size = graph.op("Mul", [cut(graph, x, 2, 4), graph.constant(np.array(0.3, np.float32))])
    size = graph.op("Exp", [size])
    size = graph.op("Mul", [size, graph.constant(2 * stride[None, None])])
    sure = graph.op("Sigmoid", [cut(graph, x, 4, 4 + CLASSES)])
    return graph, graph.op("Concat", [place, size, sure], axis=1), [1, 4 + CLASSES, CELLS]


def picture(width, height):
    x, y, c = np.meshgrid(np.arange(width), np.arange(height), np.arange(3), indexing="xy")
    return ((7 * x + 13 * y + 29 * c + x * y // 5) % 256).astype(np.uint8)


def letterboxed(image, middle):
    height, width = image.shape[:2]
    scale = min(FRAME / width, FRAME / height)
    if not middle:
        w, h, left, top = int(width * scale), int(height * scale), 0, 0
    else:
        w, h = round(width * scale), round(height * scale)
        left, top = round((FRAME - w) / 2 - 0.1), round((FRAME - h) / 2 - 0.1)
    frame = np.full((FRAME, FRAME, 3), 114, np.uint8)
    frame[top:top + h, left:left + w] = cv2.resize(image, (w, h), interpolation=cv2.INTER_LINEAR)
    return frame, scale, left, top


def boxes(name, answer, scale, left, top):
    if name == "yolox":
        column, row, stride = grids()
        rows = answer[0]
        xy = (rows[:, :2] + np.stack([column, row], 1)) * stride[:, None]
        wh = np.exp(rows[:, 2:4]) * stride[:, None]
        score = rows[:, 4] * rows[:, 5]
    else:
        rows = answer[0].T
        xy, wh, score = rows[:, :2], rows[:, 2:4], rows[:, 4]
    low = xy - wh / 2
    kept = cv2.dnn.NMSBoxes(np.concatenate([low, wh], 1).tolist(), score.tolist(), 0.3, 0.45)
    found = []
    for index in np.array(kept).ravel()[:32]:
        edges = [(low[index][0] - left) / scale, (low[index][1] - top) / scale,
                 (low[index][0] + wh[index][0] - left) / scale, (low[index][1] + wh[index][1] - top) / scale]
        limits = [100, 60, 100, 60]
        found.append([float(score[index])] + [float(min(max(e, 0), m)) for e, m in zip(edges, limits)])
    return found


for number, (name, make) in enumerate([("yolox", yolox), ("yolov8", yolov8)]):
    graph, output, shape = make(np.random.default_rng(seed + number))
    info = lambda label, sizes: helper.make_tensor_value_info(label, TensorProto.FLOAT, sizes)
    model = helper.make_model(
        helper.make_graph(graph.nodes, name, [info("images", [1, 3, FRAME, FRAME])], [info(output, shape)],
                          graph.constants),
        opset_imports=[helper.make_opsetid("", 17)], ir_version=8, producer_name="floorguard")
    onnx.checker.check_model(model)
    onnx.save(model, f"{folder}/{name}.onnx")
    session = onnxruntime.InferenceSession(f"{folder}/{name}.onnx", providers=["CPUExecutionProvider"])
    run = lambda planes: session.run(None, {"images": planes.astype(np.float32)})[0]
    ramp = (np.arange(3 * FRAME * FRAME) * 37 % 256 / 255).reshape(1, 3, FRAME, FRAME)
    image = picture(100, 60)
    frame, scale, left, top = letterboxed(image, name == "yolov8")
    colours = frame[:, :, ::-1] if name == "yolox" else frame / 255
    found = boxes(name, run(colours.transpose(2, 0, 1)[None]), scale, left, top)
    key = {
        "onnxruntime": onnxruntime.__version__,
        "opencv": cv2.__version__,
        "ramp": [round(float(v), 6) for v in run(ramp).ravel()],
        "frame": frame.transpose(2, 0, 1).ravel()[::7].tolist(),
        "boxes": found,
    }
    with open(f"{folder}/{name}.json", "w") as file:
        json.dump(key, file, separators=(",", ":"))
    print(name, len(found), "boxes")
