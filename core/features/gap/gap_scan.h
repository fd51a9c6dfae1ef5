#pragma once
// Gap check: width and orientation of a gap along a path of profiles with poses, and where a nozzle would not
// pass (thesis 6: continuous inspection between the measuring spots).
//
// Each profile is measured by GapFlushGauge. A cut that does not run square to the gap sees it too wide, so
// the gap's own direction is taken from its middles: t = unit direction of the straight line through the
// middles within `window_mm` of path (of the neighbours, where they stand farther apart), and
//     width = |g - (g . t) t|,     g = the gap's vector from the reference edge to the other, in space,
// negative when the parts overlap. Path: distance along the sensor's positions, in the order given.
//
// One profile cannot tell the gap from a dark patch. The gap's place in the profile follows a straight line
// over six windows to either side, robustly (median of slopes, then of offsets); what was found more than
// aside_mm beside it is not the gap. Where the contour runs on unbroken over that place the gap is closed.
//
// Sigma of a width: the larger of the gauge's own (edges known to a pitch) and the scatter of the widths
// about their straight line within the window, which holds noise of the edges that one profile cannot tell.
// Under noise the outermost return of an edge is the one that noise threw out farthest: the gap then reads
// too narrow by up to about two standard deviations of the noise; the blur of a camera's image carries either
// edge outward by about a pixel more. Both err to the safe side and are not in sigma. Dark surface right at
// an edge, over less than aside_mm, cannot be told from gap.
//
// Verdict against need = nozzle + 2 clearance: passes when width - 3 sigma >= need, too_narrow when width <
// need, else doubtful.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/features/gap/gap_flush.h"
#include "core/geometry/pose.h"
#include "core/parameter.h"
#include "core/text.h"

namespace seamwright {

enum class GapVerdict { passes, doubtful, too_narrow, closed, not_measured };
std::string_view to_string(GapVerdict verdict);
// A width was found.
inline bool has_width(GapVerdict verdict) {
    return verdict < GapVerdict::closed;
}

struct GapSection {
    Pose frame_from_sensor = Pose::Identity();
    Profile profile;  // filtered; empty when none came
};

struct GapScanOptions {
    GapFlushSettings gauge;
    double nozzle_mm = 3, clearance_mm = 0.5;  // width of the nozzle; what must be left on either side
    double window_mm = 5;                      // half width, along the path
    double hole_mm = 5;                        // of path without a measure; beyond, the stretch does not pass
    double aside_mm = 3;
    double need_mm() const { return nozzle_mm + 2 * clearance_mm; }
};

// Names, ranges and defaults of the options: nozzle_mm, clearance_mm, window_mm, hole_mm, aside_mm, and
// surface_mm, edge_skip_mm, x_min_mm, x_max_mm of the gauge.
const std::vector<ParameterInfo>& gap_scan_parameters();
// `options` with the values given. Refuses unknown names and values out of range.
Expected<GapScanOptions> with_values(GapScanOptions options, const ParameterValues& values);

struct GapPoint {
    std::size_t section = 0;
    double path_mm = 0;
    GapVerdict verdict = GapVerdict::not_measured;
    double width_mm = 0, sigma_mm = 0, flush_mm = 0;
    double cut_mm = 0;    // as the cut sees it
    double yaw_deg = 0;   // by which the cut is turned out of square to the gap, about the sensor's Z
    double tilt_deg = 0;  // of the reference surface in the sensor's plane, from +x towards +z
    Eigen::Vector3d middle_mm = Eigen::Vector3d::Zero();  // in the frame; the sensor's origin without a width
    Eigen::Vector3d across = Eigen::Vector3d::UnitX(),
                    along = Eigen::Vector3d::UnitY();  // unit, in the frame
    Text message;                                      // why without a width
};

// Neighbouring points that the nozzle does not pass: blocked (too narrow, and closed where any of them is),
// doubtful, or not measured.
struct GapStretch {
    GapVerdict verdict = GapVerdict::too_narrow;
    double from_mm = 0, to_mm = 0;  // path; not measured: from the measure before to the one after
    std::size_t sections = 0;
    double narrowest_mm = 0, sigma_mm = 0, at_mm = 0;    // 0 and no sigma where closed or not measured
    Eigen::Vector3d place_mm = Eigen::Vector3d::Zero();  // of the narrowest; of the first closed one
    Text message;                                        // of the first without a width
};

struct GapScan {
    std::vector<GapPoint> points;  // one a section
    std::vector<GapStretch> stretches;
    double length_mm = 0;
    std::size_t measured = 0;
    double narrowest_mm = 0, widest_mm = 0;
    double largest_yaw_deg = 0;
    bool passes() const { return measured > 0 && stretches.empty(); }
};

// Refuses (Error): no section, a pose that is none, a profile that was not filtered, options out of range.
Expected<GapScan> scan_gap(std::span<const GapSection> sections, const GapScanOptions& options);

}  // namespace seamwright
