#pragma once
// Residuals across an edge as equations of a small motion: the inside of fit_edges (not for others).

#include <cstddef>
#include <vector>

#include "core/cloud/fit_steps.h"

namespace seamwright::edge_fitting {

// One residual: the place moves against `direction`.
struct Row {
    Eigen::Vector3d place, direction;  // base
    double value_mm = 0, gate_by_mm = 0;
};

struct Equations {
    FitSystem system;
    std::size_t inside = 0;
    double badness = 1;  // mean squared distance over the gate's, at most 1 each
};

// fit.h's system of rows in pairs (outward, normal): both count by the distance of the pair.
Equations equations(const std::vector<Row>& rows, double gate_mm, std::size_t asked);

// The step that lowers the residuals; directions that the ends leave open are not moved.
Vector6 step_of(const FitSystem& s, double least = kOpenShare / 3);

Pose moved(const Pose& pose, const FitSystem& s, const Vector6& motion);

}  // namespace seamwright::edge_fitting
