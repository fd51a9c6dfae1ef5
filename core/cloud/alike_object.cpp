#include "core/cloud/alike_object.h"

#include <pcl/features/fpfh.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cmath>

namespace seamwright {
namespace {

using Features = pcl::PointCloud<pcl::FPFHSignature33>;

Features::Ptr features_of(const Cloud& cloud, double radius_mm) {
    const pcl::PointCloud<pcl::PointNormal>::Ptr points(new pcl::PointCloud<pcl::PointNormal>);
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : cloud.points) box.extend(p);
    const Eigen::Vector3d middle = box.center();
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        pcl::PointNormal p;
        p.getVector3fMap() = (cloud.points[i] - middle).cast<float>();
        p.getNormalVector3fMap() = cloud.normals[i];
        points->push_back(p);
    }
    pcl::FPFHEstimation<pcl::PointNormal, pcl::PointNormal, pcl::FPFHSignature33> estimation;
    estimation.setInputCloud(points);
    estimation.setInputNormals(points);
    estimation.setRadiusSearch(radius_mm);
    const Features::Ptr features(new Features);
    estimation.compute(*features);
    return features;
}

}  // namespace

void seamwright_alike(const Cloud& scan, const Cloud& part, double radius_mm, int count,
                      std::vector<std::vector<int>>& alike) {
    alike.clear();
    const Features::Ptr ours = features_of(scan, radius_mm), theirs = features_of(part, radius_mm);
    const auto whole = [](const pcl::FPFHSignature33& f) {
        return std::all_of(std::begin(f.histogram), std::end(f.histogram),
                           [](float v) { return std::isfinite(v); });
    };
    if (!std::all_of(theirs->begin(), theirs->end(), whole)) return;
    pcl::KdTreeFLANN<pcl::FPFHSignature33> tree;
    tree.setInputCloud(theirs);
    alike.resize(scan.size());
    for (std::size_t i = 0; i < scan.size(); ++i) {
        std::vector<float> squared;
        if (whole((*ours)[i])) tree.nearestKSearch((*ours)[i], count, alike[i], squared);
    }
}

}  // namespace seamwright
