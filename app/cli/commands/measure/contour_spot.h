#pragma once
// A spot of `correct` and `plan` that is told by contours in place of points: "reference_curve", the taught piece, is
// found again in "curve", the profile of the run, and carries the spot's reference point along. Found by the
// feature kind "template" (core/features/kinds/), hence by the registration that `match` and the runs use (thesis
// 3.2: EM-ICP, then a trimmed point-to-line finish; methods.md 2).
//
// What enters the region: the point (x, z) of the reference in the run's profile, with the covariance that the
// registration states for it, plus what the spot says of itself ("sigma_mm" in both axes, "covariance_mm2"): what
// all points of a curve err by together, which no residual shows.

#include <Eigen/Core>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "core/correction/correction.h"
#include "core/features/feature.h"

namespace seamwright::cli {

// No registration states less than this, mm: curves without any noise would be infinitely sure.
inline constexpr double kSurestContour_mm = 1e-3;

// Of the accepted points of a filtered profile: the landmark of a template whose is not told.
Eigen::Vector2d middle_of(const Profile& profile);

// Fields of a spot that make it one of contours.
bool told_by_contours(const nlohmann::json& spot);

struct ContourSpot {
    Eigen::Vector2d reference_mm;  // x, z
    Feature found;                 // not ok: the spot is refused, `message` says why
};
// `measured`: in the spot's "curve"; else in "reference_curve" itself, which says what the contour can tell and how
// noisy it was when taught. Curves are lists of [x,z] in sensor order (z null: no return) or names of CSV files beside
// `folder`, in mm; filtered here unless a file carries its segments. Error (input): no such curve, not numbers, no
// template (fewer than 5 points, no extent), a window that is none.
Expected<ContourSpot> find_contour(const nlohmann::json& spot, const std::string& path,
                                   const std::filesystem::path& folder, bool measured);

// Reference, measure and covariance of the spot from what was found; `own` is what the spot says of itself, mm^2.
void take_contour(const ContourSpot& contour, const Eigen::Matrix2d& own, SpotObservation& spot);

}  // namespace seamwright::cli
