#pragma once
// The smooth map as the nodes of a table, where samples support it. Private to core/calibration/table.

#include <Eigen/Core>
#include <vector>

#include "core/calibration/table/smooth_map.h"
#include "core/profile/sensor_model.h"

namespace seamwright::lookup_table {

// How far a point lies outside the hull; below 0 inside.
double outside(const std::vector<Eigen::Vector2d>& hull, const Eigen::Vector2d& p);

// Where samples support the map.
struct Support {
    std::vector<Eigen::Vector2d> hull;
    double spacing = 0;  // px, as if the samples stood on a square grid

    explicit Support(const std::vector<Eigen::Vector2d>& pixel);
};

double table_error_mm(const SmoothMap& map, const Eigen::Vector2d& corner, double step);

LookupTable build_table(const SmoothMap& map, const Support& support,
                        const std::vector<Eigen::Vector2d>& pixel, int width, int height, double step,
                        int& folded);

}  // namespace seamwright::lookup_table
