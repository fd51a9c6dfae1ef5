#pragma once
// What the measures of a region tell of the part's shape (modes.h), at a displacement.

#include "core/correction/region_system.h"
#include "core/elastic/modes.h"

namespace seamwright::elastic {

// The spots in the order of a learning; an observation's slot among them, -1: none.
struct ShapeInformation {
    Eigen::VectorXd measured;           // y, 3 a slot
    std::vector<Eigen::Matrix3d> seen;  // L
    Eigen::MatrixXd motions;            // G
    int shared = 0;                     // of its columns, the last ones
    Eigen::MatrixXd information;        // M
    Eigen::MatrixXd rigid_from_shape;   // (G^T L G)^-1 G^T L: tangent of pose.h by what is measured of u
    int rank = 0;
    bool regular = false;  // the rigid motion is determined
};

// `used` false: the observation tells nothing.
ShapeInformation shape_information(std::size_t slots, std::span<const int> slot_of,
                                   std::span<const SpotObservation> observations,
                                   const CorrectionOptions& options, const Displacement& displacement,
                                   const std::vector<bool>& used);

// The slot of every observation by id.
std::vector<int> slots_of(std::span<const ElasticSpot> spots, std::span<const SpotObservation> observations);

}  // namespace seamwright::elastic
