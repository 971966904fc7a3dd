// Times PCL's Euclidean clusters on points that the benchmark wrote: three 32-bit numbers a point, metres above the floor.
// clusters_pcl FILE ROUNDS euclidean|adaptive|fec; prints what stopwatch.h says, and the clusters.
#include "stopwatch.h"
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>
#include <string>
#include <vector>
#ifdef WITH_FEC
#include "FEC.h"
#endif

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

static std::size_t euclidean(const Cloud::Ptr& cloud, double gap_m, int least) {
    if (cloud->empty()) return 0;
    pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
    tree->setInputCloud(cloud);
    std::vector<pcl::PointIndices> found;
    pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
    extraction.setClusterTolerance(gap_m);
    extraction.setMinClusterSize(least);
    extraction.setMaxClusterSize(30000);
    extraction.setSearchMethod(tree);
    extraction.setInputCloud(cloud);
    extraction.extract(found);
    return found.size();
}

// Nested rings whose gap grows by 0.1 m from each to the next (Yan et al. 2017); the lidar is 0.8 m above the floor.
static std::size_t adaptive(const Cloud& all) {
    static const float WIDTHS_M[] = {2, 3, 3, 3, 3, 3, 3, 2, 3, 3, 3, 3, 3, 3};
    std::vector<Cloud::Ptr> rings;
    for (std::size_t ring = 0; ring < 14; ++ring) rings.emplace_back(new Cloud);
    for (const auto& point : all) {
        const float z = point.z - 0.8f;
        if (z < -0.7f || z > 1.2f) continue;
        const float range = std::sqrt(point.x * point.x + point.y * point.y + z * z);
        float outer = 0;
        for (std::size_t ring = 0; ring < 14; ++ring) {
            outer += WIDTHS_M[ring];
            if (range <= outer) {
                rings[ring]->push_back(point);
                break;
            }
        }
    }
    std::size_t count = 0;
    for (std::size_t ring = 0; ring < 14; ++ring)
        if (rings[ring]->size() > 5) count += euclidean(rings[ring], 0.1 * (ring + 1), 5);
    return count;
}

int main(int count, char** arguments) {
    if (count != 4) return 2;
    std::FILE* file = std::fopen(arguments[1], "rb");
    if (!file) return 3;
    Cloud::Ptr cloud(new Cloud);
    float xyz[3];
    while (std::fread(xyz, sizeof(float), 3, file) == 3) cloud->push_back(pcl::PointXYZ(xyz[0], xyz[1], xyz[2]));
    std::fclose(file);
    const std::string kind = arguments[3];
    Rounds rounds;
    std::size_t found = 0;
    for (int round = 0; round < std::atoi(arguments[2]); ++round) {
        if (kind == "euclidean") rounds.time([&] { found = euclidean(cloud, 0.3, 1); });
        else if (kind == "adaptive") rounds.time([&] { found = adaptive(*cloud); });
#ifdef WITH_FEC
        else if (kind == "fec") rounds.time([&] { found = FEC(cloud, 1, 0.3, 50).size(); });
#endif
        else return 2;
    }
    if (rounds.empty()) return 2;
    rounds.print();
    std::printf(" %zu\n", found);
}
