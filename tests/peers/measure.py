"""Times what a user would install today, on the inputs that `floorguard-bench --peers` wrote.

Usage: measure.py FOLDER MODELS BENCH [TASK …], where BENCH holds the benchmark's inputs; with tasks, only those. Prints one JSON
object a line: {"task", "input", "peer", "version", "ns", "fastest_ns", "note", "aim"}, or {"task", "peer", "skipped"}. A peer that is
not installed, or fails, is a line and no error.

Peers in C++ are built here, if their sources and libraries are there: PCL_FLAGS says where PCL, Eigen and Boost are (the system's
by default), and FEC_DIR, LINEFIT_DIR and BAYES_TRACKING_DIR where those were cloned to.
"""

import gzip
import importlib.metadata
import json
import os
import statistics
import subprocess
import sys
import time

# One core, as for ours.
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import numpy as np

FOLDER, MODELS, BENCH = sys.argv[1:4]
TASKS = sys.argv[4:]
TRACKS = os.path.join(BENCH, "track")
GAP_M = 0.3
TARGETS = (10, 50, 100)


class Absent(Exception):
    """A peer that is not here; the text says how to get it."""


class Times(float):
    """Nanoseconds of the median round, and of the fastest one: what the machine can do when nobody else is at it. The same by
    what this process, with all its threads, computed meanwhile."""

    def __new__(cls, times, computed):
        self = super().__new__(cls, statistics.median(times))
        self.fastest = min(times)
        self.computed = {"cpu_ns": statistics.median(computed), "fastest_cpu_ns": min(computed)}
        return self


class Clock:
    """Of one round."""

    def __enter__(self):
        self.cpu, self.wall = time.process_time_ns(), time.perf_counter_ns()
        return self

    def __exit__(self, *_):
        self.wall = time.perf_counter_ns() - self.wall
        self.cpu = time.process_time_ns() - self.cpu


def times_of(clocks):
    return Times([clock.wall for clock in clocks], [clock.cpu for clock in clocks])


def tell(task, peer, package, version=None, **what):
    what["version"] = version or importlib.metadata.version(package)
    what["fastest_ns"] = getattr(what["ns"], "fastest", what["ns"])
    what.update(getattr(what["ns"], "computed", {}))
    print(json.dumps({"task": task, "peer": peer, **what}), flush=True)


def median_ns(work, rounds):
    """The first call warms up and does not count."""
    work()
    clocks = []
    for _ in range(rounds):
        with Clock() as clock:
            work()
        clocks.append(clock)
    return times_of(clocks)


# A peer whose time grows exponentially is not waited for any longer.
ANSWER_S = 60
HERE = os.path.dirname(os.path.abspath(__file__))
PCL = os.environ.get("PCL_FLAGS", "-I/usr/include/pcl-1.13 -I/usr/include/eigen3").split()
PCL_ABSENT = "absent: apt install libpcl-dev, or PCL_FLAGS=\"-I… -L…\" where it is"


def folder(variable, url, more=""):
    path = os.environ.get(variable, "")
    if not os.path.isdir(path):
        raise Absent(f"absent: git clone {url}, and {variable}=where it is{more}")
    return path


def built(name, arguments, absent):
    """A program out of the sources beside this file, built where there is none newer than they are."""
    program = os.path.join(FOLDER, name)
    sources = [argument for argument in arguments if argument.endswith((".cpp", ".cc"))]
    if os.path.exists(program) and all(os.path.getmtime(source) < os.path.getmtime(program) for source in sources):
        return program
    command = ["g++", "-O3", "-DNDEBUG", *arguments, "-o", program]
    try:
        build = subprocess.run(command, capture_output=True, text=True)
    except FileNotFoundError:
        raise Absent("absent: apt install g++")
    if build.returncode != 0:
        error = next((line for line in build.stderr.splitlines() if "error" in line), "").strip()
        raise Absent(f"{absent} ({error[-120:]})")
    return program


def answers(program, *arguments):
    command = [program, *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=ANSWER_S)
    # Some libraries print words of their own.
    return list(map(float, done.stdout.strip().splitlines()[-1].split()))


def timed(fastest, median, fastest_cpu, median_cpu):
    """What a program in C++ says of its rounds (stopwatch.h)."""
    times = Times([median], [median_cpu])
    times.fastest = fastest
    times.computed["fastest_cpu_ns"] = fastest_cpu
    return times


def pcl_clusters(task, kind, peer, rounds):
    """A kind of clusters out of PCL, on the inputs of a task."""
    extra = []
    if kind == "fec":
        source = folder("FEC_DIR", "https://github.com/YizhenLAO/FEC", "; it needs PCL, too")
        extra = ["-DWITH_FEC", "-fpermissive", "-w", "-I" + os.path.join(source, "cpp")]
    libraries = ["-lpcl_segmentation", "-lpcl_search", "-lpcl_kdtree", "-lpcl_common"]
    arguments = ["-std=c++17", *extra, os.path.join(HERE, "clusters_pcl.cpp"), *PCL, *libraries]
    program = built("clusters_" + kind, arguments, PCL_ABSENT)
    stem = "sweep" if task == "detector" else "things"
    for name, points in clouds(stem):
        path = os.path.join(FOLDER, f"{stem}-{name}.f32")
        *times, found = answers(program, path, rounds, kind)
        note = f"{found:.0f} clusters of {len(points)} points"
        if task == "detector":
            note += "; without features and classifier"
        aim = {"fec": 20, "adaptive": 150}.get(kind)
        tell(task, peer, None, version="of today" if kind == "fec" else "1.13", input=name, ns=timed(*times), note=note, aim=aim)


def detector_pcl():
    pcl_clusters("detector", "adaptive", "PCL, adaptive clusters in rings", 5)


def clusters_pcl():
    pcl_clusters("clusters", "euclidean", "PCL EuclideanClusterExtraction", 5)


def clusters_fec():
    pcl_clusters("clusters", "fec", "FEC on PCL", 9)


def ground_linefit():
    source = folder("LINEFIT_DIR", "https://github.com/lorenwel/linefit_ground_segmentation", "; it needs PCL, too")
    source = os.path.join(source, "linefit_ground_segmentation")
    sources = [os.path.join(source, "src", name) for name in ("bin.cc", "ground_segmentation.cc", "segment.cc")]
    paths = ["-I" + os.path.join(HERE, "linefit_stub"), "-I" + os.path.join(source, "include")]
    arguments = ["-std=c++17", "-w", *paths, os.path.join(HERE, "ground_linefit.cpp"), *sources, *PCL, "-lpcl_common", "-lpthread"]
    program = built("ground_linefit", arguments, PCL_ABSENT)
    frames = []
    for name, _ in clouds("labelled"):
        frames += [os.path.join(FOLDER, f"labelled-{name}.f32"), os.path.join(FOLDER, f"labelled-{name}.u8")]
    *times, precision, recall = answers(program, 20, *frames)
    note = f"precision {precision:.3f}, recall {recall:.3f}; one thread"
    tell("ground", "linefit", None, version="of today", input="synthetic_vlp16", ns=timed(*times), note=note, aim=50)


def bayes_program():
    source = folder("BAYES_TRACKING_DIR", "https://github.com/LCAS/bayestracking", "; it needs Boost (libboost-dev)")
    sources = []
    for path, _, names in os.walk(os.path.join(source, "src")):
        # Its window needs an old OpenCV, a filter that nobody asks for LAPACK.
        left_out = ("trackwin.cpp", "infRtFlt.cpp")
        sources += [os.path.join(path, name) for name in sorted(names) if name.endswith(".cpp") and name not in left_out]
    arguments = ["-std=c++14", "-w", "-I" + os.path.join(source, "include"), *PCL, os.path.join(HERE, "tracker_bayes.cpp"), *sources]
    return built("tracker_bayes", arguments, "absent: apt install libboost-dev, or PCL_FLAGS=\"-I…\" where it is")


def bayes(task, name, path, kind, steps, aim=None):
    program = bayes_program()
    association = "nn" if task == "tracker" else "nnjpda"
    # The median step of each run: its fastest step says nothing of a whole one.
    runs = [answers(program, path, kind, association, steps) for _ in range(5 if task == "tracker" else 2)]
    times = Times([median for _, median, *_ in runs], [median_cpu for _, _, _, median_cpu, *_ in runs])
    tell(task, f"bayestracking {kind.upper()}", None, version="of today", input=name, ns=times, aim=aim)


def tracker_bayes():
    for targets in TARGETS:
        path = os.path.join(FOLDER, f"track_{targets:03}.csv")
        with gzip.open(os.path.join(TRACKS, f"track_{targets:03}.csv.gz"), "rb") as packed, open(path, "wb") as plain:
            plain.write(packed.read())
        for kind in ("ekf", "ukf"):
            bayes("tracker", f"{targets} targets", path, kind, 1000, aim=20 if targets == 100 else None)


def joint_bayes():
    for targets in (10, 14, 16):
        name, path = f"{targets} targets in a crowd", os.path.join(FOLDER, f"crowd_{targets:03}.csv")
        try:
            bayes("joint", name, path, "ukf", 12)
        except subprocess.TimeoutExpired:
            why = f"no answer within {ANSWER_S} s for 12 steps with {name}"
            print(json.dumps({"task": "joint", "peer": "bayestracking UKF", "skipped": why}), flush=True)


def clouds(kind):
    for name in sorted(os.listdir(FOLDER)):
        if name.startswith(kind + "-") and name.endswith(".f32"):
            stem = name[len(kind) + 1 : -4]
            yield stem, np.fromfile(os.path.join(FOLDER, name), "<f4").reshape(-1, 3)


def clusters_sklearn():
    from sklearn.cluster import DBSCAN

    for name, points in clouds("things"):
        ns = median_ns(lambda: DBSCAN(eps=GAP_M, min_samples=1, n_jobs=1).fit_predict(points), 5)
        tell("clusters", "scikit-learn DBSCAN", "scikit-learn", input=name, ns=ns, note=f"{len(points)} points")


def clusters_open3d():
    import open3d

    for name, points in clouds("things"):
        cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points.astype(float)))
        ns = median_ns(lambda: cloud.cluster_dbscan(GAP_M, 1), 5)
        tell("clusters", "Open3D cluster_dbscan", "open3d", input=name, ns=ns, note=f"{len(points)} points")


def told(floor, truth):
    right = int(np.count_nonzero(floor & truth))
    return right / max(1, np.count_nonzero(floor)), right / max(1, np.count_nonzero(truth))


def ground(peer, package, find, rounds):
    """Precision and recall over all labelled frames together, time of the median frame."""
    times, floors, truths = [], [], []
    for name, points in clouds("labelled"):
        truth = np.fromfile(os.path.join(FOLDER, f"labelled-{name}.u8"), "u1") == 0
        times.append(median_ns(lambda: find(points), rounds))
        floor = np.zeros(len(points), bool)
        floor[find(points)] = True
        floors.append(floor)
        truths.append(truth)
    precision, recall = told(np.concatenate(floors), np.concatenate(truths))
    note = f"precision {precision:.3f}, recall {recall:.3f}"
    tell("ground", peer, package, input="synthetic_vlp16", ns=Times(times, [one.computed["cpu_ns"] for one in times]), note=note)


def ground_open3d():
    import open3d

    open3d.utility.random.seed(1)

    def find(points):
        cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points.astype(float)))
        return cloud.segment_plane(0.05, 3, 100)[1]

    ground("Open3D segment_plane", "open3d", find, 5)


def ground_patchwork():
    import pypatchworkpp

    parameters = pypatchworkpp.Parameters()
    parameters.sensor_height = 0.9
    finder = pypatchworkpp.patchworkpp(parameters)

    def find(points):
        # The frame of the sensor, which is 0.9 m above the floor.
        shifted = np.column_stack([points[:, :2], points[:, 2] - 0.9, np.zeros(len(points))])
        finder.estimateGround(shifted.astype(np.float32))
        return finder.getGroundIndices()

    ground("Patchwork++", "pypatchworkpp", find, 5)


def svm_libsvm():
    import ctypes

    from libsvm import svmutil
    from libsvm.svm import gen_svm_nodearray, libsvm

    model = svmutil.svm_load_model(os.path.join(MODELS, "flobot_pedestrian.model"))
    with gzip.open(os.path.join(MODELS, "flobot_svm_key.csv.gz"), "rt") as key:
        rows = [list(map(float, line.split(",")))[3:] for line in key.read().splitlines()[1:]][:81]
    # Nodes are made before: only the machine itself is timed.
    nodes = [gen_svm_nodearray({i + 1: value for i, value in enumerate(row)})[0] for row in rows]
    shares = (ctypes.c_double * 2)()

    def work():
        for node in nodes:
            libsvm.svm_predict_probability(model, node, shares)

    tell("svm", "libsvm", "libsvm-official", input="81 vectors", ns=median_ns(work, 20), note="C library, called from Python")


def tracks(targets):
    steps = {}
    with gzip.open(os.path.join(TRACKS, f"track_{targets:03}.csv.gz"), "rt") as rows:
        for line in rows:
            if not line.startswith("#"):
                step, kind, identity, x, y = line.split(",")
                steps.setdefault(int(step), ([], []))[int(kind)].append((float(x), float(y)))
    return [steps[step] for step in sorted(steps)]


def per_step(targets, begin, follow, steps=None, passes=1):
    """Median over the second half, when everybody is followed; several times over."""
    medians, everything = [], tracks(targets)[:steps]
    for _ in range(passes):
        times, state = [], begin()
        for step, (_, detections) in enumerate(everything):
            with Clock() as clock:
                state = follow(state, step, detections)
            times.append(clock)
        medians.append(times_of(times[len(times) // 2 :]))
    return Times(medians, [one.computed["cpu_ns"] for one in medians])


def tracker_norfair():
    import norfair

    for targets in TARGETS:
        begin = lambda: norfair.Tracker(distance_function="euclidean", distance_threshold=1.0)

        def follow(tracker, _, detections):
            tracker.update([norfair.Detection(np.array([place])) for place in detections])
            return tracker

        tell("tracker", "norfair", "norfair", input=f"{targets} targets", ns=per_step(targets, begin, follow, passes=3))


def stone_soup(targets, associate, steps):
    from datetime import datetime, timedelta

    from stonesoup.models.measurement.linear import LinearGaussian
    from stonesoup.models.transition.linear import CombinedLinearGaussianTransitionModel, ConstantVelocity
    from stonesoup.predictor.kalman import KalmanPredictor
    from stonesoup.types.detection import Detection
    from stonesoup.types.state import GaussianState
    from stonesoup.types.track import Track
    from stonesoup.updater.kalman import KalmanUpdater

    start = datetime(2026, 1, 1)
    model = LinearGaussian(4, (0, 2), np.diag([0.01, 0.01]))
    transition = CombinedLinearGaussianTransitionModel([ConstantVelocity(0.4), ConstantVelocity(0.4)])
    predictor, updater = KalmanPredictor(transition), KalmanUpdater(model)
    associator, update = associate(predictor, updater)

    def begin():
        places = tracks(targets)[0][0]
        covariance = np.diag([0.04, 1.0, 0.04, 1.0])
        states = [GaussianState([[x], [0], [y], [0]], covariance, timestamp=start) for x, y in places]
        return {Track([state]) for state in states}

    def follow(people, step, places):
        now = start + timedelta(seconds=0.1 * (step + 1))
        seen = {Detection([[x], [y]], timestamp=now, measurement_model=model) for x, y in places}
        for track, hypotheses in associator.associate(people, seen, now).items():
            update(track, hypotheses)
        return people

    return per_step(targets, begin, follow, steps, passes=2)


def tracker_stone_soup():
    def nearest(predictor, updater):
        from stonesoup.dataassociator.neighbour import NearestNeighbour
        from stonesoup.hypothesiser.distance import DistanceHypothesiser
        from stonesoup.measures import Mahalanobis

        hypothesiser = DistanceHypothesiser(predictor, updater, Mahalanobis(), missed_distance=3)

        def update(track, hypothesis):
            track.append(updater.update(hypothesis) if hypothesis else hypothesis.prediction)

        return NearestNeighbour(hypothesiser), update

    for targets in (10, 50):
        ns = stone_soup(targets, nearest, 12)
        tell("tracker", "Stone Soup, nearest", "stonesoup", input=f"{targets} targets", ns=ns)


def joint_stone_soup():
    from stonesoup.dataassociator.probability import JPDA
    from stonesoup.hypothesiser.probability import PDAHypothesiser
    from stonesoup.types.array import StateVectors
    from stonesoup.functions import gm_reduce_single
    from stonesoup.types.update import GaussianStateUpdate

    def joint(predictor, updater):
        hypothesiser = PDAHypothesiser(predictor, updater, clutter_spatial_density=0.00125, prob_detect=0.95)

        def update(track, hypotheses):
            states = [updater.update(one) if one else one.prediction for one in hypotheses]
            weights = np.array([float(one.probability) for one in hypotheses])
            means = StateVectors([state.state_vector for state in states])
            covariances = np.stack([state.covar for state in states], axis=2)
            mean, covariance = gm_reduce_single(means, covariances, weights)
            track.append(GaussianStateUpdate(mean, covariance, hypotheses, hypotheses[0].measurement.timestamp))

        return JPDA(hypothesiser=hypothesiser), update

    ns = stone_soup(10, joint, 12)
    tell("joint", "Stone Soup JPDA", "stonesoup", input="10 targets, spread", ns=ns, note="all events; who is far apart is pruned")


def filter_filterpy():
    from filterpy.kalman import KalmanFilter

    people = []
    for index in range(100):
        one = KalmanFilter(dim_x=4, dim_z=2)
        one.F = np.array([[1, 0.1, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.1], [0, 0, 0, 1]])
        one.H = np.array([[1, 0, 0, 0], [0, 0, 1, 0]])
        one.R *= 0.01
        one.Q *= 0.001
        people.append((one, np.array([index * 1.0, index * 2.0])))

    def work():
        for one, place in people:
            one.predict()
            one.update(place)

    tell("filter", "filterpy KalmanFilter", "filterpy", input="100 targets", ns=median_ns(work, 20), note="predict and update")


def degrees_between(a, b):
    a, b = np.asarray(a, float), np.asarray(b, float)
    return float(np.degrees(np.arccos(min(1.0, abs(a @ b) / np.linalg.norm(a) / np.linalg.norm(b)))))


def depth_frames():
    """Name, points in the camera's frame as 64-bit numbers, and the true plane."""
    import cv2

    with open(os.path.join(BENCH, "depth", "truth.json")) as file:
        truth = json.load(file)
    for frame in truth["frames"]:
        path = os.path.join(BENCH, "depth", f"depth_{frame['k']}.png")
        depth = cv2.imread(path, cv2.IMREAD_UNCHANGED) if os.path.exists(path) else None
        if depth is None:
            continue
        rows, columns = np.nonzero(depth)
        z = depth[rows, columns] * 0.001
        x, y = (columns - truth["cx"]) * z / truth["fx"], (rows - truth["cy"]) * z / truth["fy"]
        yield f"depth_{frame['k']}", np.column_stack([x, y, z]), frame


def plane_note(normal, distance, frame, more=""):
    angle, height = degrees_between(normal, frame["normal"]), abs(abs(distance) - frame["h"])
    return f"{angle:.3f}°, {1000 * height:.1f} mm off{more}"


def plane_open3d():
    import open3d

    open3d.utility.random.seed(1)
    for name, points, frame in depth_frames():
        cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points))
        found = []
        ns = median_ns(lambda: found.append(cloud.segment_plane(0.02, 3, 100)[0]), 5)
        note = plane_note(found[-1][:3], found[-1][3], frame, "; points made before")
        tell("plane", "Open3D segment_plane", "open3d", input=name, ns=ns, note=note)


def plane_pcl():
    """PCL is in no Python registry: a program of its own."""
    libraries = ["-lpcl_segmentation", "-lpcl_sample_consensus", "-lpcl_search", "-lpcl_kdtree", "-lpcl_common"]
    arguments = ["-std=c++17", os.path.join(HERE, "plane_pcl.cpp"), *PCL, *libraries]
    program = built("plane_pcl", arguments, PCL_ABSENT)
    for name, points, frame in depth_frames():
        path = os.path.join(FOLDER, f"{name}.xyz")
        points.astype("<f4").tofile(path)
        *times, a, b, c, d = answers(program, path, 9)
        note = plane_note((a, b, c), d, frame, "; points made before")
        tell("plane", "PCL SACSegmentation", None, version="1.13", input=name, ns=timed(*times), note=note, aim=8)


def plane_numpy():
    """Least squares on what lies near the plane before, ten times: what one writes without a library."""
    for name, points, frame in depth_frames():
        start = np.array([0.0, -0.8, -0.6, 0.8])

        def fit():
            plane = start
            for band in (0.3, 0.2, 0.1, 0.08, 0.06, 0.05, 0.04, 0.03, 0.03, 0.03):
                near = points[np.abs(points @ plane[:3] + plane[3]) < band]
                centre = near.mean(axis=0)
                shifted = near - centre
                normal = np.linalg.eigh(shifted.T @ shifted)[1][:, 0]
                plane = np.append(normal, -normal @ centre)
            return plane

        plane = fit()
        ns = median_ns(fit, 5)
        tell("plane", "NumPy, trimmed least squares", "numpy", input=name, ns=ns, note=plane_note(plane[:3], plane[3], frame, "; points made before"))


def dirt_frames():
    import cv2

    cv2.setNumThreads(1)
    folder = os.path.join(BENCH, "dirt")
    for name in sorted(os.listdir(folder)):
        if name.endswith(".png") and not name.endswith("_mask.png"):
            image = cv2.imread(os.path.join(folder, name))
            mask = cv2.imread(os.path.join(folder, name[:-4] + "_mask.png"), cv2.IMREAD_GRAYSCALE)
            if image is not None and mask is not None:
                yield name[:-4], image, mask > 0


def block_features(image):
    """Mean and standard deviation of the gradient of L, a and b in blocks of 16 x 16."""
    import cv2

    lab = cv2.cvtColor(image.astype(np.float32) / 255, cv2.COLOR_BGR2Lab)
    features = []
    for channel in cv2.split(lab):
        gradient = cv2.magnitude(cv2.Sobel(channel, cv2.CV_32F, 1, 0, ksize=1) / 2, cv2.Sobel(channel, cv2.CV_32F, 0, 1, ksize=1) / 2)
        size = (gradient.shape[1] // 16, gradient.shape[0] // 16)
        gradient = gradient[: size[1] * 16, : size[0] * 16]
        mean = cv2.resize(gradient, size, interpolation=cv2.INTER_AREA)
        squares = cv2.resize(gradient * gradient, size, interpolation=cv2.INTER_AREA)
        features.append(np.column_stack([mean.ravel(), np.sqrt(np.maximum(squares - mean * mean, 0)).ravel()]))
    return features


def block_auc(scores, mask):
    """Area under the curve of blocks, of which one is dirty from five dirty pixels on."""
    from sklearn.metrics import roc_auc_score

    rows, columns = mask.shape[0] // 16, mask.shape[1] // 16
    counts = mask[: rows * 16, : columns * 16].reshape(rows, 16, columns, 16).sum(axis=(1, 3))
    return roc_auc_score((counts.ravel() / 256 >= 0.02), scores)


def dirt(peer, package, score_channel):
    def score(image):
        return -sum(score_channel(features) for features in block_features(image))

    for name, image, mask in dirt_frames():
        note = f"block AUC {block_auc(score(image), mask):.4f}; the published method"
        aim = 8 if peer == "OpenCV and its EM" else None
        tell("dirt", peer, package, input=name, ns=median_ns(lambda: score(image), 5), note=note, aim=aim)


def dirt_opencv():
    import cv2

    def em(features):
        cv2.setRNGSeed(1)
        model = cv2.ml.EM_create()
        model.setClustersNumber(3)
        model.setCovarianceMatrixType(cv2.ml.EM_COV_MAT_GENERIC)
        model.setTermCriteria((cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 30, 1e-3))
        samples = features.astype(np.float64)
        return model.trainEM(samples)[1].ravel()

    dirt("OpenCV and its EM", "opencv-python-headless", em)


def dirt_sklearn():
    from sklearn.mixture import GaussianMixture

    def fit(features):
        return GaussianMixture(3, tol=1e-3, max_iter=30, random_state=1).fit(features).score_samples(features)

    dirt("OpenCV and scikit-learn GaussianMixture", "scikit-learn", fit)

def tours():
    for name in sorted(os.listdir(FOLDER)):
        if name.startswith("tour-") and name.endswith(".i32"):
            stem = os.path.join(FOLDER, name[:-4])
            flat = np.fromfile(stem + ".i32", "<i4")
            count = int(round(len(flat) ** 0.5))
            with open(stem + ".length") as file:
                ours = int(file.read())
            yield name[5:-4].replace("_", ", ") + " cells", flat.reshape(count, count), ours


def told_tour(peer, package, name, ours, length, ns):
    note = f"closed tour of {length} units; ours is {100 * (ours / length - 1):+.2f} % longer"
    tell("tour", peer, package, input=name, ns=ns, note=note, length=int(length))


def tour_lkh():
    import elkai

    for name, distances, ours in tours():
        with Clock() as clock:
            order = elkai.DistanceMatrix(distances.tolist()).solve_tsp(runs=1 if len(distances) > 500 else 10)
        length = int(sum(distances[a, b] for a, b in zip(order, order[1:])))
        told_tour("LKH (elkai)", "elkai", name, ours, length, times_of([clock]))


def tour_or_tools():
    from ortools.constraint_solver import pywrapcp, routing_enums_pb2

    for name, distances, ours in tours():
        table = distances.tolist()
        manager = pywrapcp.RoutingIndexManager(len(table), 1, 0)
        routing = pywrapcp.RoutingModel(manager)
        way = lambda a, b: table[manager.IndexToNode(a)][manager.IndexToNode(b)]
        routing.SetArcCostEvaluatorOfAllVehicles(routing.RegisterTransitCallback(way))
        parameters = pywrapcp.DefaultRoutingSearchParameters()
        parameters.local_search_metaheuristic = routing_enums_pb2.LocalSearchMetaheuristic.GUIDED_LOCAL_SEARCH
        parameters.time_limit.FromSeconds(10)
        with Clock() as clock:
            solution = routing.SolveWithParameters(parameters)
        told_tour("OR-Tools, guided local search, 10 s", "ortools", name, ours, solution.ObjectiveValue(), times_of([clock]))


def graph_gtsam():
    import gtsam

    for name in sorted(os.listdir(FOLDER)):
        if not name.startswith("graph-"):
            continue
        graph, initial = gtsam.readG2o(os.path.join(FOLDER, name), False)
        first = min(initial.keys())
        noise = gtsam.noiseModel.Diagonal.Variances(np.full(3, 1.0e-6))
        graph.add(gtsam.PriorFactorPose2(first, initial.atPose2(first), noise))
        # From the vertices of the file, as its users do; ours begins with the edges alone.
        solve = lambda: gtsam.LevenbergMarquardtOptimizer(graph, initial).optimize()
        ns = median_ns(solve, 5)
        note = f"chi-squared {2 * graph.error(solve()):.3f}"
        tell("graph", "gtsam Levenberg-Marquardt", "gtsam", input=name[6:-4], ns=ns, note=note)


def office_sweeps():
    for name, points in clouds("odometry"):
        yield points.astype(np.float64)


def odometry_kiss():
    from kiss_icp.config import KISSConfig
    from kiss_icp.kiss_icp import KissICP

    config = KISSConfig()
    config.data.max_range = 60.0
    # Indoors; its default of a hundredth of the range loses track of small rooms.
    config.mapping.voxel_size = 0.3
    odometry, clocks = KissICP(config), []
    for points in office_sweeps():
        stamps = np.linspace(0.0, 1.0, len(points))
        with Clock() as clock:
            odometry.register_frame(points, stamps)
        clocks.append(clock)
    drift_m = float(np.linalg.norm(odometry.last_pose[:3, 3]))
    note = f"{len(clocks)} sweeps, {100 * drift_m:.2f} cm drift, voxels of 0.3 m"
    tell("odometry", "kiss-icp", "kiss-icp", input="einride_office_600rpm", ns=times_of(clocks), note=note)


def odometry_small_gicp():
    import small_gicp

    pose, clocks, target = np.eye(4), [], small_gicp.GaussianVoxelMap(0.3)
    for points in office_sweeps():
        with Clock() as clock:
            cloud, _ = small_gicp.preprocess_points(points, downsampling_resolution=0.1, num_threads=1)
            if clocks:
                pose = small_gicp.align(target, cloud, init_T_target_source=pose, num_threads=1).T_target_source
            target.insert(cloud, pose)
        clocks.append(clock)
    note = f"{len(clocks)} sweeps, {100 * float(np.linalg.norm(pose[:3, 3])):.2f} cm drift, VGICP, voxels of 0.3 m"
    tell("odometry", "small_gicp", "small-gicp", input="einride_office_600rpm", ns=times_of(clocks), note=note)


def scans_lama():
    raise Absent("absent: git clone https://github.com/iris-ua/iris_lama, and build its examples (CMake, Eigen)")


MEASURES = [
    ("tour", "LKH (elkai)", tour_lkh),
    ("tour", "OR-Tools, guided local search, 10 s", tour_or_tools),
    ("detector", "PCL, adaptive clusters in rings", detector_pcl),
    ("clusters", "FEC on PCL", clusters_fec),
    ("clusters", "PCL EuclideanClusterExtraction", clusters_pcl),
    ("clusters", "scikit-learn DBSCAN", clusters_sklearn),
    ("clusters", "Open3D cluster_dbscan", clusters_open3d),
    ("ground", "linefit", ground_linefit),
    ("ground", "Open3D segment_plane", ground_open3d),
    ("ground", "Patchwork++", ground_patchwork),
    ("plane", "PCL SACSegmentation", plane_pcl),
    ("plane", "Open3D segment_plane", plane_open3d),
    ("plane", "NumPy, trimmed least squares", plane_numpy),
    ("dirt", "OpenCV and its EM", dirt_opencv),
    ("dirt", "OpenCV and scikit-learn GaussianMixture", dirt_sklearn),
    ("svm", "libsvm", svm_libsvm),
    ("tracker", "bayestracking", tracker_bayes),
    ("tracker", "norfair", tracker_norfair),
    ("tracker", "Stone Soup, nearest", tracker_stone_soup),
    ("joint", "bayestracking UKF", joint_bayes),
    ("joint", "Stone Soup JPDA", joint_stone_soup),
    ("filter", "filterpy KalmanFilter", filter_filterpy),
    ("graph", "gtsam Levenberg-Marquardt", graph_gtsam),
    ("odometry", "kiss-icp", odometry_kiss),
    ("odometry", "small_gicp", odometry_small_gicp),
    ("odometry", "iris_lama (2-D)", scans_lama),
]
# Where a module comes from that is called otherwise.
PACKAGES = {"kiss_icp": "kiss-icp", "small_gicp": "small-gicp", "sklearn": "scikit-learn", "cv2": "\"opencv-python-headless<5\"", "libsvm": "libsvm-official"}


def absent(error):
    if isinstance(error, Absent):
        return str(error)
    if isinstance(error, ImportError):
        module = (error.name or "it").split(".")[0]
        return f"absent: pip install {PACKAGES.get(module, module)} ({error})"
    return f"failed: {type(error).__name__}: {error}"


for task, peer, measure in MEASURES:
    if TASKS and task not in TASKS:
        continue
    try:
        measure()
    except Exception as error:  # A peer that fails is a line, not the end.
        print(json.dumps({"task": task, "peer": peer, "skipped": absent(error)}), flush=True)
