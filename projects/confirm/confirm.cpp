#include "projects/confirm/confirm.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/features/kinds/feature_registry.h"
#include "core/features/registration/registration.h"
#include "core/profile/taught_profile.h"

namespace seamwright {
namespace {

constexpr double kPieceMm = 22;      // of the drawn contour, about its reference
constexpr double kElsewhereMm = 1;   // the contour's place against the feature's
constexpr double kTurnedDeg = 5;     // of the contour in the laser plane
constexpr double kSameMm = 0.1;      // a template of what was seen, in what was seen
constexpr double kNearlyFree = 100;  // mm and degrees: what is not known at all is not judged
constexpr int kLeastRedundancy = 2;

const Region* region_with(const Project& project, const std::string& id) {
    for (const Region& r : project.regions)
        if (r.id == id) return &r;
    return nullptr;
}

Eigen::Vector2d in_plane(const Eigen::Vector3d& p) {
    return {p.x(), p.z()};
}

// The drawn contour about its reference, in what was seen.
void judge_contour(const Spot& drawn, const TaughtSpot& taught, const ConfirmOptions& o,
                   SpotConfirmation& out) {
    const auto refuse = [&](Text why) {
        out.finding = ConfirmFinding::other_contour;
        out.reason = std::move(why);
    };
    const Eigen::Vector2d at = in_plane(drawn.drawn->reference_mm);
    const Eigen::Vector2d reach(kPieceMm, kPieceMm);
    const Profile piece = cut_out(drawn.reference_profile, Eigen::AlignedBox2d(at - reach, at + reach));
    const auto matcher = ContourMatcher::make(piece, at);
    if (!matcher) return refuse(Text("the drawn contour cannot be matched: {}", matcher.error().text()));
    SearchWindow window;
    window.dx_mm = window.dz_mm = o.shift_limit_mm + kElsewhereMm;
    window.phi_rad = rad_from_deg(kTurnedDeg);
    const Registration found = matcher->match(taught.mean, window);
    out.contour_rms_mm = found.rms_mm;
    // A straight contour with one end has it from its end alone, along which the feature decides.
    if (found.status != RegistrationStatus::ok && found.status != RegistrationStatus::sliding)
        return refuse(Text("the contour is not the drawn one ({})", to_string(found.status)));
    if (!(found.rms_mm <= kShapeMm))
        return refuse(Text("the contour differs from the drawn one by {:.2f} mm rms, {:.2f} are allowed",
                           found.rms_mm, kShapeMm));
    Eigen::Vector2d apart = found.scene_from_template * at - in_plane(taught.spot.reference_mm);
    if (found.status == RegistrationStatus::sliding)
        apart -= apart.dot(found.sliding_direction) * found.sliding_direction;
    if (!(apart.norm() <= kElsewhereMm))
        return refuse(
            Text("its feature was found {:.2f} mm from where the drawn contour matches", apart.norm()));
    out.finding = ConfirmFinding::ok;
}

void judge_spot(const Project& project, const Spot& drawn, const TaughtSpot& taught, const ConfirmOptions& o,
                SpotConfirmation& out) {
    out.shift_mm = in_plane(taught.spot.reference_mm - drawn.drawn->reference_mm);
    Eigen::Vector2d stated = Eigen::Vector2d::Zero();
    for (const SpotMeasurement& m : taught.measurements)
        if (m.status == SpotStatus::measured)
            stated = stated.cwiseMax(m.feature.covariance_mm2.diagonal().cwiseMax(0.0).cwiseSqrt());
    out.sigma_mm = taught.spread_mm.cwiseMax(stated) / std::sqrt(std::max(1, taught.spot.reference_arrivals));
    const Pose stands = project.part.base_from_workobject.inverse() * drawn.base_from_flange *
                        calibration_of(project, drawn)->flange_from_sensor;
    out.shift_workobject_mm = stands.linear() * Eigen::Vector3d(out.shift_mm.x(), 0, out.shift_mm.y());
    // Farther than the contour is looked for it has no place to be compared with.
    if (!(out.shift_mm.norm() <= o.shift_limit_mm)) {
        out.finding = ConfirmFinding::shifted_too_far;
        out.reason = Text("it lies {:.2f} mm from where the drawing has it, {:.2f} are allowed",
                          out.shift_mm.norm(), o.shift_limit_mm);
        return;
    }
    judge_contour(drawn, taught, o, out);
}

// A spot as the common displacement sees it: where it was drawn, where it is.
SpotObservation drawn_and_found(const Project& project, const Spot& drawn, const Eigen::Vector3d& found,
                                const Eigen::Vector2d& sigma_mm, double form_mm) {
    SpotObservation o;
    o.id = drawn.id;
    o.workobject_from_sensor = project.part.base_from_workobject.inverse() * drawn.base_from_flange *
                               calibration_of(project, drawn)->flange_from_sensor;
    o.reference_mm = drawn.drawn->reference_mm;
    o.measured_mm = found;
    o.curve = drawn.curve;
    const double sigma = std::sqrt(0.5 * sigma_mm.squaredNorm() + form_mm * form_mm);
    o.sigma_mm = sigma;
    return o;
}

// Nothing: they do not determine one.
Expected<RegionCorrection> solve_common(const Region& region, const std::vector<SpotObservation>& spots) {
    CorrectionOptions options;
    options.sigma_limit_mm = options.sigma_limit_deg = kNearlyFree;
    auto solved = solve_region(spots, options);
    if (!solved || solved->status == CorrectionStatus::ok) return solved;
    // A part may lie any way; where the spots do not tell all, what the region leaves free.
    options.free = region.free;
    return solve_region(spots, options);
}

CommonShift common_shift(const Region& region, const std::vector<SpotObservation>& spots,
                         const Expected<RegionCorrection>& solved) {
    CommonShift common;
    common.region_id = region.id;
    if (!solved) {
        common.why_not = solved.error().text();
        return common;
    }
    common.redundancy = solved->redundancy;
    if (solved->status != CorrectionStatus::ok || solved->redundancy < kLeastRedundancy) {
        common.why_not = solved->status != CorrectionStatus::ok
                             ? solved->message
                             : Text("{} spots are too few to contradict each other", spots.size());
        return common;
    }
    common.judged = true;
    common.displacement = solved->displacement;
    common.rms_mm = solved->rms_mm;
    common.consistent = solved->consistent && std::all_of(solved->spots.begin(), solved->spots.end(),
                                                          [](const SpotResidual& s) { return s.used; });
    const Pose& d = solved->displacement.workobject_from_movedworkobject;
    for (const SpotObservation& s : spots) {
        const Eigen::Vector3d p = s.workobject_from_sensor * s.reference_mm;
        common.largest_mm = std::max(common.largest_mm, (d * p - p).norm());
    }
    return common;
}

// What is left of each spot's shift, and which ones contradict.
void name_contradiction(const Region& region, const RegionCorrection& solved, const CommonShift& common,
                        std::vector<SpotConfirmation>& all) {
    bool named = false;
    const SpotResidual* worst = nullptr;
    const auto of = [&](const std::string& id) -> SpotConfirmation* {
        for (SpotConfirmation& s : all)
            if (s.spot_id == id) return &s;
        return nullptr;
    };
    const auto refuse = [&](const SpotResidual& r) {
        SpotConfirmation* spot = of(r.id);
        if (!spot || spot->finding != ConfirmFinding::ok) return;
        spot->finding = ConfirmFinding::contradicts;
        spot->reason = Text(
            "it is {:.2f} mm off what region {} is displaced by as a whole, beyond chance: another place of "
            "the "
            "part, or another part",
            r.residual_mm.norm(), region.id);
        named = true;
    };
    for (const SpotResidual& r : solved.spots) {
        SpotConfirmation* spot = of(r.id);
        if (spot) spot->left_mm = r.residual_mm.norm();
        if (!r.used) refuse(r);
        if (spot && (!worst || r.residual_mm.norm() > worst->residual_mm.norm())) worst = &r;
    }
    if (!common.consistent && !named && worst) refuse(*worst);
}

void judge_region(const Project& project, const Region& region, const std::vector<std::string>& ids,
                  const std::vector<Expected<TaughtSpot>>& taught, const ConfirmOptions& o,
                  Confirmation& out) {
    std::vector<SpotObservation> spots;
    for (const std::string& id : region.spot_ids) {
        const Spot* drawn = find_spot(project, id);
        if (!drawn || !drawn->drawn || !calibration_of(project, *drawn)) continue;
        const auto at = std::find(ids.begin(), ids.end(), id);
        if (at == ids.end()) {
            if (drawn->reference_state == ReferenceState::measured && drawn->reference_profile.size() > 0)
                spots.push_back(drawn_and_found(project, *drawn, drawn->reference_mm,
                                                Eigen::Vector2d::Constant(drawn->sigma_mm), o.form_mm));
            continue;
        }
        const auto i = static_cast<std::size_t>(at - ids.begin());
        const SpotConfirmation& judged = out.spots[i];
        // One that is refused already says nothing about the others.
        if (judged.finding == ConfirmFinding::ok || judged.finding == ConfirmFinding::contradicts)
            spots.push_back(
                drawn_and_found(project, *drawn, taught[i]->spot.reference_mm, judged.sigma_mm, o.form_mm));
    }
    if (spots.empty()) return;
    const auto solved = solve_common(region, spots);
    out.regions.push_back(common_shift(region, spots, solved));
    if (out.regions.back().judged) name_contradiction(region, *solved, out.regions.back(), out.spots);
}

// The measured reference, and a template of what was seen where the drawn one was.
Expected<Spot> confirmed(const Spot& drawn, const TaughtSpot& taught) {
    Spot spot = drawn;
    spot.reference_mm = taught.spot.reference_mm;
    spot.reference_profile = taught.spot.reference_profile;
    spot.reference_arrivals = taught.spot.reference_arrivals;
    spot.reference_state = ReferenceState::measured;
    if (spot.feature.kind != "template") return spot;
    const Eigen::Vector2d reference = in_plane(spot.reference_mm), was = spot.feature.template_reference_mm;
    Eigen::AlignedBox2d box;
    const Profile& old = spot.feature.template_profile;
    for (std::size_t i = 0; i < old.size(); ++i)
        if (std::isfinite(old.z_mm[i])) box.extend(Eigen::Vector2d(old.x_mm[i], old.z_mm[i]));
    const Eigen::Vector2d rim(1, 1);
    box = Eigen::AlignedBox2d(box.min() - was + reference - rim, box.max() - was + reference + rim);
    spot.feature.template_profile = cut_out(taught.mean, box);
    spot.feature.template_reference_mm = reference;
    SEAM_TRY(const auto finder, make_feature_finder(spot.feature));
    const Feature again = finder->find(taught.mean);
    if (again.status != FeatureStatus::ok || !((again.point_mm - reference).norm() <= kSameMm))
        return input_error("the contour as measured makes no template", Text("spot {}", spot.id),
                           "look at its profile, and teach it by hand (Teach page)");
    return spot;
}

Expected<void> check_options(const ConfirmOptions& o) {
    if (!(o.shift_limit_mm >= 0.1 && o.shift_limit_mm <= 15))
        return usage_error("the limit of the shift is not from 0.1 to 15 mm", "confirm");
    if (!(o.form_mm >= 0.01 && o.form_mm <= 2))
        return usage_error("what a part may differ from its drawing is not from 0.01 to 2 mm", "confirm");
    if (o.repeats < 1 || o.repeats > 1000)
        return usage_error(Text("{} repeats", o.repeats), "confirm", "give 1 to 1000");
    return {};
}

}  // namespace

Expected<std::vector<std::string>> spots_to_confirm(const Project& project, const ConfirmOptions& o) {
    SEAM_OK(check_options(o));
    if (!o.spot_ids.empty() && !o.region_id.empty())
        return usage_error("spots and a region are named", "confirm", "name one or the other");
    std::vector<std::string> ids;
    const Region* region = region_with(project, o.region_id);
    if (!o.region_id.empty() && !region)
        return usage_error(Text("there is no region \"{}\"", o.region_id), project.name);
    std::set<std::string> named(o.spot_ids.begin(), o.spot_ids.end());
    for (const std::string& id : named)
        if (!find_spot(project, id)) return usage_error(Text("there is no spot \"{}\"", id), project.name);
    for (const Spot& spot : project.spots) {  // in the order of measuring
        const bool open = spot.reference_state == ReferenceState::from_drawing;
        const bool of_region =
            !region || std::count(region->spot_ids.begin(), region->spot_ids.end(), spot.id);
        if (named.empty() ? open && of_region : named.count(spot.id) > 0) ids.push_back(spot.id);
    }
    if (ids.empty())
        return input_error("there is no spot from the drawing that is not confirmed",
                           region ? Text("region {}", region->id) : Text(project.name));
    for (const std::string& id : ids) {
        const Spot& spot = *find_spot(project, id);
        const Text where("spot {}", id);
        if (spot.reference_state != ReferenceState::from_drawing && !spot.drawn)
            return input_error("it is not from the drawing", where, "measure its reference (Teach page)");
        if (spot.reference_state != ReferenceState::from_drawing)
            return input_error("its reference is measured on the part already", where,
                               "measure it again where it is taught (Teach page)");
        if (!spot.drawn || spot.reference_profile.size() == 0)
            return input_error("what the drawing lets expect was lost when its pose or feature was changed",
                               where, "measure its reference (Teach page), or propose it again");
        if (!calibration_of(project, spot))
            return input_error(Text("sensor {} has no calibration in use", spot.sensor_id), where,
                               "calibrate it");
    }
    return ids;
}

SpotConfirmation::SpotConfirmation()
    : shift_mm(Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN())),
      sigma_mm(shift_mm),
      shift_workobject_mm(Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN())),
      left_mm(std::numeric_limits<double>::quiet_NaN()) {}

std::string_view to_string(ConfirmFinding finding) {
    switch (finding) {
        case ConfirmFinding::ok:
            return "ok";
        case ConfirmFinding::not_measured:
            return "not_measured";
        case ConfirmFinding::other_contour:
            return "other_contour";
        case ConfirmFinding::shifted_too_far:
            return "shifted_too_far";
        case ConfirmFinding::contradicts:
            return "contradicts";
    }
    return "";
}

Expected<Confirmation> judge_confirmation(const Project& project, const std::vector<std::string>& ids,
                                          const std::vector<Expected<TaughtSpot>>& taught,
                                          const ConfirmOptions& options) {
    SEAM_OK(check_options(options));
    Confirmation out;
    out.project = project;
    std::vector<Spot> made(ids.size());
    for (std::size_t i = 0; i < ids.size(); ++i) {
        SpotConfirmation& judged = out.spots.emplace_back();
        judged.spot_id = ids[i];
        const Spot& drawn = *find_spot(project, ids[i]);
        if (!taught[i]) {
            judged.reason = taught[i].error().text();
            continue;
        }
        judge_spot(project, drawn, *taught[i], options, judged);
        if (judged.finding != ConfirmFinding::ok) continue;
        if (auto spot = confirmed(drawn, *taught[i])) {
            made[i] = std::move(*spot);
        } else {
            judged.finding = ConfirmFinding::other_contour;
            judged.reason = spot.error().text();
        }
    }
    for (const Region& region : project.regions)
        if (std::any_of(region.spot_ids.begin(), region.spot_ids.end(),
                        [&](const std::string& id) { return std::count(ids.begin(), ids.end(), id) > 0; }))
            judge_region(project, region, ids, taught, options, out);
    out.ok = std::all_of(out.spots.begin(), out.spots.end(),
                         [](const SpotConfirmation& s) { return s.finding == ConfirmFinding::ok; });
    if (out.ok)
        for (Spot& spot : out.project.spots)
            if (const auto at = std::find(ids.begin(), ids.end(), spot.id); at != ids.end())
                spot = made[static_cast<std::size_t>(at - ids.begin())];
    return out;
}

Expected<Confirmation> confirm_spots(Station& station, const ConfirmOptions& options) {
    SEAM_TRY(const auto ids, spots_to_confirm(station.project(), options));
    std::vector<Expected<TaughtSpot>> taught;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        TeachOptions teach;
        teach.repeats = options.repeats;
        teach.cancel = options.cancel;
        taught.push_back(teach_spot(station, *find_spot(station.project(), ids[i]), teach));
        // What the feature is not found in is a finding; a robot that does not move is none.
        if (!taught.back() && taught.back().error().kind != ErrorKind::input)
            return tl::unexpected(taught.back().error());
        if (options.progress)
            options.progress(
                {static_cast<int>(i) + 1, static_cast<int>(ids.size()), Text("{} measured", ids[i])});
    }
    return judge_confirmation(station.project(), ids, taught, options);
}

Text said_of(const Confirmation& confirmation) {
    double largest = 0;
    for (const SpotConfirmation& s : confirmation.spots) {
        if (s.finding != ConfirmFinding::ok) return Text("spot {} is not confirmed: {}", s.spot_id, s.reason);
        largest = std::max(largest, s.shift_mm.norm());
    }
    return Text("{} spots confirmed on the part, up to {:.3f} mm from where the drawing has them",
                confirmation.spots.size(), largest);
}

}  // namespace seamwright
