// Times linefit_ground_segmentation on labelled frames: three 32-bit numbers a point, metres above the floor.
// ground_linefit ROUNDS FILE.f32 LABELS.u8 …; prints nanoseconds of the fastest round and of the median one, precision, recall.
#include "stopwatch.h"
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>
#include "ground_segmentation/ground_segmentation.h"

int main(int count, char** arguments) {
    GroundSegmentationParams parameters;
    // As its authors ship them for a car, with this lidar's height; one thread.
    parameters.sensor_height = 0.9;
    parameters.n_threads = 1;
    parameters.r_min_square = 0.5 * 0.5;
    parameters.r_max_square = 50 * 50;
    parameters.n_bins = 120;
    parameters.n_segments = 360;
    parameters.max_dist_to_line = 0.05;
    parameters.max_slope = 0.3;
    parameters.max_error_square = 0.05 * 0.05;
    parameters.long_threshold = 1.0;
    parameters.max_long_height = 0.1;
    parameters.max_start_height = 0.2;
    parameters.line_search_angle = 0.1;
    Rounds rounds;
    double right = 0, claimed = 0, truth = 0;
    for (int index = 2; index + 1 < count; index += 2) {
        std::FILE* file = std::fopen(arguments[index], "rb");
        std::FILE* labels = std::fopen(arguments[index + 1], "rb");
        if (!file || !labels) return 3;
        PointCloud cloud;
        float xyz[3];
        while (std::fread(xyz, sizeof(float), 3, file) == 3) cloud.push_back(pcl::PointXYZ(xyz[0], xyz[1], xyz[2] - 0.9f));
        std::vector<int> floor;
        GroundSegmentation segmentation(parameters);
        for (int round = 0; round < std::atoi(arguments[1]); ++round) {
            rounds.time([&] { segmentation.segment(cloud, &floor); });
        }
        for (int found : floor) {
            const bool is_floor = std::fgetc(labels) == 0;
            claimed += found == 1;
            truth += is_floor;
            right += found == 1 && is_floor;
        }
        std::fclose(file);
        std::fclose(labels);
    }
    if (rounds.empty()) return 2;
    rounds.print();
    std::printf(" %.3f %.3f\n", right / std::max(claimed, 1.0), right / std::max(truth, 1.0));
}
