// Times PCL's plane segmentation on points that measure.py wrote: three 32-bit numbers a point.
// Prints nanoseconds of the fastest and of the median round, the normal, and the distance.
#include "stopwatch.h"
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <pcl/ModelCoefficients.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/segmentation/sac_segmentation.h>
#include <vector>

int main(int count, char** arguments) {
    if (count != 3) return 2;
    std::FILE* file = std::fopen(arguments[1], "rb");
    if (!file) return 3;
    pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
    float xyz[3];
    while (std::fread(xyz, sizeof(float), 3, file) == 3) cloud->push_back(pcl::PointXYZ(xyz[0], xyz[1], xyz[2]));
    std::fclose(file);
    Rounds rounds;
    pcl::ModelCoefficients plane;
    for (int round = 0; round < std::atoi(arguments[2]); ++round) {
        pcl::PointIndices inliers;
        rounds.time([&] {
            pcl::SACSegmentation<pcl::PointXYZ> segmentation;
            segmentation.setOptimizeCoefficients(true);
            segmentation.setModelType(pcl::SACMODEL_PLANE);
            segmentation.setMethodType(pcl::SAC_RANSAC);
            segmentation.setDistanceThreshold(0.02);
            segmentation.setMaxIterations(100);
            segmentation.setInputCloud(cloud);
            segmentation.segment(inliers, plane);
        });
        if (plane.values.size() != 4) return 1;
    }
    if (rounds.empty()) return 2;
    rounds.print();
    std::printf(" %.9g %.9g %.9g %.9g\n", plane.values[0], plane.values[1], plane.values[2], plane.values[3]);
}
