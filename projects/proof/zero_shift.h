#pragma once
// Zero shift: the part as taught, not touched, measured several times. Every displacement must read zero; its
// mean tells bias, its scatter repeatability.

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "projects/model/evidence.h"
#include "projects/station/station.h"

namespace seamwright {

// Names of its runs' parts: "zero shift 1", ...
inline constexpr const char* kZeroShiftPrefix = "zero shift ";

struct ZeroShiftOptions {
    int runs = 5;           // 2 to 1000
    std::string part_type;  // of the part (RunOptions::part_type); the evidence is that type's
    std::stop_token cancel;
    std::function<void(const RunProgress&)> progress;    // spots of all runs
    std::function<void(const RunRecord& run)> measured;  // after each run
};

// Nothing is written to the robot. The outcome is in the file as evidence when this returns. Error: not
// connected, a device (with its sentence), cancelled; the runs made until then stay, the evidence does not
// come about.
Expected<ZeroShift> measure_zero_shift(Station& station, const ZeroShiftOptions& options);

// Of runs made with `setup`; regions in its order, those that were never corrected left out.
ZeroShift summarise_zero_shift(const Project& setup, const std::vector<RunRecord>& runs);

// How far the part lies off, mm, where one rigid displacement tells what all regions read: then it is the part that has moved,
// not what was taught of a region. The rest may be as large as a bend of the part. Nothing where a region reads zero or the
// regions disagree.
std::optional<double> displaced_as_one_mm(const Project& project, const ZeroShift& zero);

// The reference points of a region's enabled, calibrated spots on the part as taught, work object, mm.
std::vector<Eigen::Vector3d> reference_points(const Project& project, const Region& region);

}  // namespace seamwright
