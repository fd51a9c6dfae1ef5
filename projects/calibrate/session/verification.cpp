// What captures that were kept back say of a solution.

#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "projects/calibrate/session/session.h"

namespace seamwright {

// Where the robot has not moved in between: such a capture agrees with whatever was solved. Not of a method that asks for no
// robot: there the target is moved.
const SessionCapture* CalibrationSession::solved_at_its_place(const SessionCapture& judge) const {
    constexpr double kSame_mm = 0.5, kSame_deg = 0.1;
    if (!method_->robot || !judge.taken->base_from_flange) return nullptr;
    for (const SessionCapture& c : state_.captures)
        if (!c.left_out && !c.verification && c.taken->base_from_flange &&
            distance_mm(*c.taken->base_from_flange, *judge.taken->base_from_flange) < kSame_mm &&
            angle_rad(*c.taken->base_from_flange, *judge.taken->base_from_flange) < rad_from_deg(kSame_deg))
            return &c;
    return nullptr;
}

// The limit is three times what the solution promises for a pose it has not seen: its own leave-out residual,
// or the residual of the poses used where the method leaves none out.
Verification CalibrationSession::verification() const {
    Verification v;
    const CalibrationSolution* solved = solution();
    if (!solved) return v;
    const HoldOut& hold_out = solved->report.hold_out;
    const auto judge = [&](double PoseRow::*part, double promised, double floor, double& worst,
                           double& limit) {
        double squares = 0;
        int used = 0;
        for (const PoseRow& row : rows()) {
            if (std::isnan(row.*part)) continue;
            if (row.verification && !row.left_out)
                worst = std::isnan(worst) ? row.*part : std::max(worst, row.*part);
            else if (!row.left_out && !row.contradicts)
                squares += (row.*part) * (row.*part), ++used;
        }
        const double fitted = used > 0 ? std::sqrt(squares / used) : 0;
        limit = std::max(3 * (std::isnan(promised) ? fitted : std::max(promised, fitted)), floor);
    };
    judge(&PoseRow::rms_mm, hold_out.rms_mm, 0.05, v.worst_mm, v.limit_mm);
    judge(&PoseRow::deg, hold_out.rms_deg, 0.02, v.worst_deg, v.limit_deg);
    judge(&PoseRow::rms_px, hold_out.rms_px, 0.3, v.worst_px, v.limit_px);
    for (const SessionCapture& c : state_.captures) {
        if (c.left_out || !c.verification) continue;
        if (const SessionCapture* solved_with = solved_at_its_place(c)) {
            v.repeats.emplace_back(c.taken->id, solved_with->taken->id);
            continue;
        }
        ++v.poses;
    }
    const auto holds = [](double worst, double limit) { return std::isnan(worst) || worst <= limit; };
    v.confirmed =
        v.poses > 0 && !(std::isnan(v.worst_mm) && std::isnan(v.worst_deg) && std::isnan(v.worst_px)) &&
        holds(v.worst_mm, v.limit_mm) && holds(v.worst_deg, v.limit_deg) && holds(v.worst_px, v.limit_px);
    return v;
}

}  // namespace seamwright
