#pragma once
// Spots from the drawing, confirmed on the part: each is measured as in teaching, its shift against the drawing is shown
// and judged, and what was measured becomes its reference (methods.md 11).
//
// Shift of a spot: measured minus drawn reference in its sensor frame (x, z). Its sigma: the measurements' spread, at
// least what the feature itself states, over the root of the arrivals. A spot is refused where
//   - the feature is not found, or does not agree with itself (teach.h);
//   - the contour is not the drawn one: the piece of it about the reference, registered in what was seen
//     (core/features/registration), does not match, lies off by more than kShapeMm rms, or elsewhere than the feature;
//   - its shift is over shift_limit_mm;
//   - it contradicts the others: a part that lies elsewhere shifts all spots of a region by one rigid displacement.
//     Solved for it as a run would be (solve_region), each coordinate with the measurement's sigma and form_mm, by which
//     a sound part may differ from its drawing; what a spot is off beyond chance is named. Spots of the region
//     that were confirmed earlier count too. Fewer than two coordinates more than unknowns say nothing: `judged` is
//     false, and the shift's limit alone holds.
// All are taken or none.
//
// What the displacement means: the references are those of the part as it stood. A path that was taught on this part
// is right as it is; a path from the drawing is off by the displacement, and the frame it runs in must be set by it.
// A shift along the travel is not seen by a spot; only spots across it tell.

#include <functional>
#include <nlohmann/json.hpp>
#include <stop_token>
#include <string>
#include <vector>

#include "projects/station/station.h"
#include "projects/station/teach.h"

namespace seamwright {

inline constexpr double kShapeMm = 0.5;

struct ConfirmOptions {
    // Which: these, else those of the region, else all of the project; of a region and of all, those not yet confirmed.
    std::vector<std::string> spot_ids;
    std::string region_id;
    int repeats = TeachOptions().repeats;  // arrivals
    double shift_limit_mm = 5;             // 0.1 to 15
    double form_mm = 0.2;                  // one standard deviation, 0.01 to 2
    std::stop_token cancel;
    std::function<void(const RunProgress&)> progress;
};

enum class ConfirmFinding { ok, not_measured, other_contour, shifted_too_far, contradicts };
std::string_view to_string(ConfirmFinding finding);

struct SpotConfirmation {
    std::string spot_id;
    ConfirmFinding finding = ConfirmFinding::not_measured;
    Text reason;  // of a refusal
    // Not a number where nothing was measured.
    Eigen::Vector2d shift_mm, sigma_mm;   // sensor frame, x and z
    Eigen::Vector3d shift_workobject_mm;  // the same shift along the work object's axes
    double contour_rms_mm = 0;
    double left_mm =
        0;  // of the shift, once the common displacement is taken off; not a number where none is known
    SpotConfirmation();
};

// What the shifts of a region have in common.
struct CommonShift {
    std::string region_id;
    bool judged = false;
    Text why_not;  // not judged
    Displacement displacement;
    double largest_mm = 0;  // by which it moves any of the region's spots
    double rms_mm = 0;      // left at the spots
    int redundancy = 0;
    bool consistent = true;
};

struct Confirmation {
    std::vector<SpotConfirmation> spots;
    std::vector<CommonShift> regions;
    bool ok = false;
    Project project;  // with the measured references where ok; else as it was
};

// Which spots they are, in the order of measuring: known before a device is touched. Errors as below.
Expected<std::vector<std::string>> spots_to_confirm(const Project& project, const ConfirmOptions& options);

// Measures on the connected station and changes nothing; who takes the project saves it (Station::edit). Error (usage): no
// such spot or region, options out of range; (input): nothing to confirm, a spot without its expected profile; (device);
// cancelled.
Expected<Confirmation> confirm_spots(Station& station, const ConfirmOptions& options);

// The same from what was measured, pure: `taught[i]` of spot `ids[i]`, or why it was not.
Expected<Confirmation> judge_confirmation(const Project& project, const std::vector<std::string>& ids,
                                          const std::vector<Expected<TaughtSpot>>& taught,
                                          const ConfirmOptions& options);

// One sentence: how many, and by how much at most; of a refusal the first.
Text said_of(const Confirmation& confirmation);
nlohmann::json confirmation_json(const Confirmation& confirmation);

}  // namespace seamwright
