// What is asked of a point's nearest neighbours: PCL's kd-tree, single precision about the cloud's middle. Compiled from its headers:
// its library pulls a hundred others along at every start.

#define PCL_NO_PRECOMPILE
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/cloud/cloud.h"

namespace seamwright {
namespace {

class Neighbours {
  public:
    explicit Neighbours(const Cloud& cloud) : middle_(cloud.box().center()) {
        const pcl::PointCloud<pcl::PointXYZ>::Ptr points(new pcl::PointCloud<pcl::PointXYZ>);
        points->reserve(cloud.size());
        for (const Eigen::Vector3d& p : cloud.points) points->push_back(converted(p));
        tree_.setInputCloud(points);
    }
    // Squared distances, nearest first, the point itself among them.
    int of(const Eigen::Vector3d& p, int count) {
        return tree_.nearestKSearch(converted(p), count, index, squared);
    }
    std::vector<int> index;
    std::vector<float> squared;

  private:
    pcl::PointXYZ converted(const Eigen::Vector3d& p) const {
        const Eigen::Vector3f q = (p - middle_).cast<float>();
        return {q.x(), q.y(), q.z()};
    }
    Eigen::Vector3d middle_;
    pcl::KdTreeFLANN<pcl::PointXYZ> tree_;
};

}  // namespace

std::vector<char> statistical_inliers(const Cloud& cloud, int neighbours, double ratio) {
    std::vector<char> keep(cloud.size(), 1);
    if (cloud.size() <= static_cast<std::size_t>(neighbours)) return keep;
    Neighbours near(cloud);
    std::vector<double> mean(cloud.size());
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const int found = near.of(cloud.points[i], neighbours + 1);
        double total = 0;
        for (int k = 1; k < found; ++k)
            total += std::sqrt(static_cast<double>(near.squared[static_cast<std::size_t>(k)]));
        mean[i] = total / std::max(1, found - 1);
        sum += mean[i];
        squares += mean[i] * mean[i];
    }
    const double n = static_cast<double>(cloud.size()), average = sum / n;
    const double limit = average + ratio * std::sqrt(std::max(0.0, squares / n - average * average));
    constexpr double kRounding_mm = 1e-9;
    for (std::size_t i = 0; i < cloud.size(); ++i) keep[i] = mean[i] <= limit + kRounding_mm;
    return keep;
}

void estimate_normals(Cloud& cloud, int neighbours) {
    constexpr double kOnLine = 1e-4;  // of variances
    cloud.normals.assign(cloud.size(), Eigen::Vector3f::Zero());
    if (cloud.size() < 3) return;
    Neighbours near(cloud);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const int found = near.of(cloud.points[i], neighbours + 1);
        Eigen::Vector3d mean = Eigen::Vector3d::Zero();
        Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
        for (int k = 0; k < found; ++k) {
            const Eigen::Vector3d d =
                cloud.points[static_cast<std::size_t>(near.index[static_cast<std::size_t>(k)])] -
                cloud.points[i];
            mean += d;
            spread += d * d.transpose();
        }
        mean /= found;
        spread = spread / found - mean * mean.transpose();
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
        solver.computeDirect(spread);
        if (!(solver.eigenvalues()[1] > kOnLine * solver.eigenvalues()[2])) continue;
        Eigen::Vector3f n = solver.eigenvectors().col(0).cast<float>();
        if (cloud.has_towards() && n.dot(cloud.towards[i]) < 0) n = -n;
        cloud.normals[i] = n;
    }
}

double spacing_mm(const Cloud& cloud) {
    if (cloud.size() < 2) return 0;
    Neighbours near(cloud);
    std::vector<double> nearest;
    const std::size_t step = std::max<std::size_t>(1, cloud.size() / 2000);
    for (std::size_t i = 0; i < cloud.size(); i += step) {
        if (near.of(cloud.points[i], 2) < 2) continue;
        nearest.push_back(std::sqrt(static_cast<double>(near.squared[1])));
    }
    if (nearest.empty()) return 0;
    std::nth_element(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2),
                     nearest.end());
    return nearest[nearest.size() / 2];
}

}  // namespace seamwright
