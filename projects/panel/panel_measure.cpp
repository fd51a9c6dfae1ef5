#include "projects/panel/panel_measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/geometry/notation.h"
#include "core/panel/double_head.h"
#include "projects/gate/safety_gate.h"
#include "projects/measure/fields.h"
#include "projects/measure/measure.h"

namespace seamwright {
namespace {

struct HeadSetup {
    std::string sensor_id;
    PeakOptions peaks;
    FilterOptions filter;
    std::optional<SensorModel> model;
    Pose flange_from_sensor = Pose::Identity();
    StripePeaks found;
    Capture capture;
    Profile profile;
};

const PanelPlace* find_place(const PanelJob& job, const std::string& id) {
    const auto it =
        std::find_if(job.places.begin(), job.places.end(), [&](const PanelPlace& p) { return p.id == id; });
    return it == job.places.end() ? nullptr : &*it;
}

}  // namespace

std::optional<Pose> gripper_from_place(const Project& project, const PanelPlace& place) {
    const Calibration* first = calibration_of(project, place.sensor_id);
    if (!first) return std::nullopt;
    if (place.second_sensor_id.empty()) return first->flange_from_sensor;
    const Calibration* second = calibration_of(project, place.second_sensor_id);
    if (!second) return std::nullopt;
    return interpolate(first->flange_from_sensor, second->flange_from_sensor, 0.5);
}

struct PanelMeasurer::Impl {
    PanelPlace place;
    Pose place_from_gripper = Pose::Identity();
    std::vector<HeadSetup> heads;
    DoubleHeadOptions merging;
    std::optional<GapFlushGauge> gauge;
    Profile profile;
    double surface_deg = 0;

    static PanelMeasurement no(PanelMeasurement m, SpotStatus status, Text message) {
        m.status = status;
        m.message = std::move(message);
        return m;
    }

    // Tracked profiles of all heads are there.
    PanelMeasurement evaluate(PanelMeasurement m) {
        profile = heads[0].profile;
        if (heads.size() == 2) {
            const auto sigma = [](const HeadSetup& h) {
                return h.filter.noise_mm > 0 ? h.filter.noise_mm : Head{}.sigma_mm;
            };
            const auto head = [&](const HeadSetup& h) {
                return Head{place_from_gripper * h.flange_from_sensor, sigma(h)};
            };
            auto merged =
                merge_heads(heads[0].profile, head(heads[0]), heads[1].profile, head(heads[1]), merging);
            if (!merged) return no(std::move(m), SpotStatus::no_stripe, merged.error().text());
            m.head_disagreement_mm = merged->disagreement_mm;
            m.head_offset_mm = merged->offset_mm;
            m.head_overlap_mm = merged->overlap_mm;
            if (merged->status != DoubleHeadStatus::ok)
                return no(std::move(m), SpotStatus::no_stripe, merged->message);
            profile = std::move(merged->profile);
        }
        const GapFlush measured = gauge->measure(profile);
        if (measured.status != GapFlushStatus::ok)
            return no(std::move(m), SpotStatus::no_feature, measured.message);
        m.gap_mm = measured.gap_mm;
        m.flush_mm = measured.flush_mm;
        m.gap_flush_covariance = measured.covariance;
        const Eigen::Vector2d along =
            measured.along.x() < 0 ? Eigen::Vector2d(-measured.along) : measured.along;
        surface_deg = deg_from_rad(std::atan2(along.y(), along.x()));
        m.panel_mm = {measured.other_point_mm.x(), 0, measured.other_point_mm.y()};
        m.body_mm = {measured.reference_point_mm.x(), 0, measured.reference_point_mm.y()};
        // Gap and flush are differences of two points: each has half of their variance, and two coordinates.
        m.sigma_mm = std::sqrt(place.sigma_mm * place.sigma_mm + 0.25 * measured.covariance.trace());
        m.status = SpotStatus::measured;
        return m;
    }

    PanelMeasurement started() {
        PanelMeasurement m;
        m.place_id = place.id;
        profile.clear();
        return m;
    }
    Text named(std::size_t head, const Text& message) const {
        return heads.size() == 1 ? message : Text("head {}: {}", heads[head].sensor_id, message);
    }
};

PanelMeasurer::PanelMeasurer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PanelMeasurer::PanelMeasurer(PanelMeasurer&&) noexcept = default;
PanelMeasurer& PanelMeasurer::operator=(PanelMeasurer&&) noexcept = default;
PanelMeasurer::~PanelMeasurer() = default;

Expected<PanelMeasurer> PanelMeasurer::make(const Project& project, const PanelJob& job,
                                            const PanelPlace& place) {
    const Text where("panel job {}, place {}", job.id, place.id);
    const auto at = [&](Error error) {
        error.within(where);
        return tl::unexpected(std::move(error));
    };
    auto impl = std::make_unique<Impl>();
    impl->place = place;
    impl->merging.disagreement_limit_mm = job.head_limit_mm;
    for (const std::string& id : {place.sensor_id, place.second_sensor_id}) {
        if (id.empty() && !impl->heads.empty()) continue;
        const SensorSetup* sensor = find_sensor(project, id);
        if (!sensor)
            return input_error(Text("its sensor \"{}\" is not in the project", id), where,
                               "choose one of the project's sensors");
        const Calibration* calibration = calibration_of(project, id);
        if (!calibration)
            return input_error(
                Text("its sensor \"{}\" has no calibration: where it stands on the gripper is not known", id),
                where, "calibrate it");
        HeadSetup& head = impl->heads.emplace_back();
        head.sensor_id = id;
        head.peaks = sensor->peaks;
        head.filter = sensor->filter;
        head.model = calibration->model;
        head.flange_from_sensor = calibration->flange_from_sensor;
        head.capture.spot_id = place.id;
        head.capture.sensor_id = id;
    }
    if (auto good = check(place.gauge); !good) return at(good.error());
    impl->gauge.emplace(place.gauge);
    impl->place_from_gripper = gripper_from_place(project, place)->inverse();
    return PanelMeasurer(std::move(impl));
}

PanelMeasurement PanelMeasurer::measure(const Frame& first, const Frame* second,
                                        const std::optional<Pose>& reported) {
    Impl& i = *impl_;
    PanelMeasurement m = i.started();
    const std::array<const Frame*, 2> frames{&first, second};
    // Every head's frame is captured before any is judged: replay finds them all.
    std::vector<std::pair<SpotStatus, Text>> captured;
    for (std::size_t k = 0; k < i.heads.size(); ++k) {
        HeadSetup& head = i.heads[k];
        if (!frames[k]) return Impl::no(std::move(m), SpotStatus::not_measured, i.named(k, "no frame came"));
        auto& [status, message] = captured.emplace_back();
        status = capture_frame(*frames[k], head.peaks, head.model ? &*head.model : nullptr, head.found,
                               head.capture, message);
        if (reported) head.capture.base_from_flange = reported;
        m.host_time_ns = std::max(m.host_time_ns, frames[k]->host_time_ns);
    }
    for (std::size_t k = 0; k < captured.size(); ++k)
        if (captured[k].first != SpotStatus::measured)
            return Impl::no(std::move(m), captured[k].first, i.named(k, captured[k].second));
    for (std::size_t k = 0; k < i.heads.size(); ++k)
        if (auto tracked = track_capture(i.heads[k].capture, i.heads[k].filter, i.heads[k].profile); !tracked)
            return Impl::no(std::move(m), SpotStatus::no_stripe, i.named(k, tracked.error().text()));
    return i.evaluate(std::move(m));
}

PanelMeasurement PanelMeasurer::measure(const Capture& first, const Capture* second) {
    Impl& i = *impl_;
    const std::array<const Capture*, 2> captures{&first, second};
    const auto with_image = [](const Capture* c) {
        return c && c->image && c->status == FrameStatus::ok && c->profile.size() == 0;
    };
    const auto as_frame = [](const Capture& c) {
        Frame frame;
        frame.status = c.status;
        frame.sequence = c.sequence;
        frame.device_time_ns = c.device_time_ns;
        frame.host_time_ns = c.host_time_ns;
        frame.base_from_flange = c.base_from_flange;
        if (c.image) frame.image = c.image->view();
        frame.profile = c.profile;
        return frame;
    };
    if (with_image(&first) && (i.heads.size() == 1 || with_image(second))) {
        const Frame one = as_frame(first);
        if (i.heads.size() == 1) return measure(one, nullptr, first.base_from_flange);
        const Frame two = as_frame(*second);
        return measure(one, &two, first.base_from_flange);
    }
    PanelMeasurement m = i.started();
    for (std::size_t k = 0; k < i.heads.size(); ++k) {
        if (!captures[k])
            return Impl::no(std::move(m), SpotStatus::not_measured, i.named(k, "no frame came"));
        m.host_time_ns = std::max(m.host_time_ns, captures[k]->host_time_ns);
    }
    for (std::size_t k = 0; k < i.heads.size(); ++k) {
        const Capture& c = *captures[k];
        if (c.status != FrameStatus::ok)
            return Impl::no(std::move(m), SpotStatus::damaged_frame,
                            i.named(k, Text("the frame is {}", to_string(c.status))));
        const auto& count = c.candidates.count;
        const bool candidates = std::any_of(count.begin(), count.end(), [](std::uint8_t n) { return n > 0; });
        if (c.profile.size() == 0 && !candidates)
            return Impl::no(std::move(m), SpotStatus::no_stripe,
                            i.named(k, "no stripe was found in the image"));
    }
    for (std::size_t k = 0; k < i.heads.size(); ++k)
        if (auto tracked = track_capture(*captures[k], i.heads[k].filter, i.heads[k].profile); !tracked)
            return Impl::no(std::move(m), SpotStatus::no_stripe, i.named(k, tracked.error().text()));
    return i.evaluate(std::move(m));
}

const PanelPlace& PanelMeasurer::place() const {
    return impl_->place;
}
int PanelMeasurer::heads() const {
    return static_cast<int>(impl_->heads.size());
}
const Capture& PanelMeasurer::capture(int head) const {
    return impl_->heads.at(static_cast<std::size_t>(head)).capture;
}
const Profile& PanelMeasurer::profile() const {
    return impl_->profile;
}
const Profile& PanelMeasurer::head_profile(int head) const {
    return impl_->heads.at(static_cast<std::size_t>(head)).profile;
}
double PanelMeasurer::surface_deg() const {
    return impl_->surface_deg;
}

Expected<PanelFit> fit_places(const Project& project, const PanelJob& job,
                              std::span<const PanelMeasurement> measurements) {
    std::vector<PanelSpot> spots;
    for (const PanelMeasurement& m : measurements) {
        const PanelPlace* place = find_place(job, m.place_id);
        if (!place || m.status != SpotStatus::measured) continue;
        const auto stands = gripper_from_place(project, *place);
        if (!stands) continue;
        PanelSpot s;
        s.id = place->id;
        s.gripper_from_sensor = *stands;
        s.panel = {place->panel_reference_mm, m.panel_mm};
        s.body = {place->body_reference_mm, m.body_mm};
        s.weights = place->weights;
        s.sigma_mm = m.sigma_mm;
        s.surface_rad = rad_from_deg(place->surface_deg);
        spots.push_back(std::move(s));
    }
    if (spots.empty())
        return input_error("no place of the panel job was measured", Text("panel job {}", job.id));
    PanelOptions options;
    options.limits = job.limits;
    options.sigma_limit_mm = std::max(options.sigma_limit_mm, job.sigma_limit_mm);
    options.sigma_limit_deg = std::max(options.sigma_limit_deg, job.sigma_limit_deg);
    options.deviation = job.deviation;
    return fit_panel(spots, options);
}

namespace {
// What is not a number is as far off as anything.
void judge_off(const std::string& place, const char* what, const char* of, double off_mm, double tolerance_mm,
               std::vector<Text>& reasons) {
    if (std::abs(off_mm) <= tolerance_mm) return;
    reasons.push_back(Text("place {}: {} a {} {:+.3f} mm off the taught one, tolerance {:.3f} mm", place,
                           what, of, off_mm, tolerance_mm));
}

// A tolerance that tolerates everything is none.
void judge_tolerances(const PanelJob& job, std::vector<Text>& reasons) {
    for (const Field<PanelJob>& f : panel_fields()) {
        if (f.info.name != "gap_tolerance_mm" && f.info.name != "flush_tolerance_mm") continue;
        const double value = f.get(job);
        if (!(value > 0 && value <= f.info.maximum))
            reasons.push_back(
                Text("{} of {} mm is no tolerance (above 0, up to {})", f.info.name, value, f.info.maximum));
    }
}
}  // namespace

std::vector<Text> beyond_tolerance(const PanelJob& job, const PanelFit& fit) {
    std::vector<Text> reasons;
    judge_tolerances(job, reasons);
    for (const PanelSpotResult& s : fit.spots) {
        // What the weights do not see cannot be predicted; it is judged when it is measured again.
        const PanelPlace* place = find_place(job, s.id);
        const GapFlushObserved seen =
            place ? observed_gap_flush(place->weights, rad_from_deg(place->surface_deg))
                  : GapFlushObserved{true, true};
        if (!s.residual_mm.allFinite())
            reasons.push_back(Text("place {}: what the best fit leaves is not a finite number", s.id));
        if (seen.gap)
            judge_off(s.id, "the best fit leaves", "gap", s.remaining.gap_mm, job.gap_tolerance_mm, reasons);
        if (seen.flush)
            judge_off(s.id, "the best fit leaves", "flush", s.remaining.flush_mm, job.flush_tolerance_mm,
                      reasons);
    }
    return reasons;
}

std::vector<Text> beyond_tolerance(const PanelJob& job, std::span<const PanelMeasurement> measured) {
    std::vector<Text> reasons;
    judge_tolerances(job, reasons);
    for (const PanelMeasurement& m : measured) {
        const PanelPlace* place = find_place(job, m.place_id);
        if (!place || m.status != SpotStatus::measured) continue;
        if (!(m.panel_mm.allFinite() && m.body_mm.allFinite() && m.gap_flush_covariance.allFinite() &&
              std::isfinite(m.sigma_mm) && std::isfinite(m.head_disagreement_mm) &&
              std::isfinite(m.head_offset_mm) && std::isfinite(m.head_overlap_mm)))
            reasons.push_back(
                Text("place {}: the measurement holds a value that is not a finite number", m.place_id));
        judge_off(m.place_id, "measured is", "gap", m.gap_mm - place->gap_mm, job.gap_tolerance_mm, reasons);
        judge_off(m.place_id, "measured is", "flush", m.flush_mm - place->flush_mm, job.flush_tolerance_mm,
                  reasons);
    }
    return reasons;
}

PanelVerdict judge_panel(const PanelJob& job, std::span<const PanelMeasurement> after) {
    bool any = false;
    for (const PanelMeasurement& m : after) {
        const PanelPlace* place = find_place(job, m.place_id);
        const bool measured = m.status == SpotStatus::measured;
        if (!measured && (!place || place->required)) return PanelVerdict::not_verified;
        any = any || measured;
    }
    if (!any) return PanelVerdict::not_verified;
    return beyond_tolerance(job, after).empty() ? PanelVerdict::in_tolerance : PanelVerdict::out_of_tolerance;
}

Pose moved_gripper(const Pose& base_from_gripper, const PanelFit& fit) {
    return base_from_gripper * fit.gripper_motion;
}

RegionCorrection motion_as_correction(const PanelJob& job, const Pose& base_from_gripper,
                                      const PanelFit& fit) {
    RegionCorrection c;
    c.status = fit.status;
    c.message = fit.message;
    c.rms_mm = fit.rms_mm;
    c.sigma_at_spots_mm = fit.sigma_at_spots_mm;
    c.unobservable = fit.unobservable;
    const Pose taught_from_gripper = job.base_from_gripper.inverse() * base_from_gripper;
    c.displacement.workobject_from_movedworkobject = taught_from_gripper * fit.gripper_motion;
    c.covariance =
        covariance_of_product(taught_from_gripper, Matrix6::Zero(), fit.gripper_motion, fit.covariance);
    c.sigma_xyz_mm = c.covariance.diagonal().head<3>().cwiseSqrt();
    const Eigen::Matrix3d to_abc = kuka_jacobian(c.displacement.workobject_from_movedworkobject.linear());
    const Eigen::Matrix3d abc = to_abc * c.covariance.bottomRightCorner<3, 3>() * to_abc.transpose();
    c.sigma_abc_deg = abc.diagonal().cwiseSqrt() * deg_from_rad(1);
    c.covariance_random = c.covariance;
    c.sigma_random = {c.sigma_xyz_mm, c.sigma_abc_deg};
    return c;
}

void place_servo(const PanelJob& job, PanelRecord& record) {
    PanelFit moved;
    moved.gripper_motion = record.servo->motion;
    record.base_from_moved_gripper = moved_gripper(record.base_from_gripper, moved);
    record.base_from_frame = corrected_frame(
        job.base_from_gripper, motion_as_correction(job, record.base_from_gripper, moved).displacement,
        job.base_from_frame);
}

ServoComparison compare_servo(const PanelRecord& record) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    ServoComparison out{0, kNone, kNone, kNone, kNone, kNone};
    const std::vector<PanelServoMove>& moves = record.servo->moves;
    if (!moves.empty()) {
        out.moves = static_cast<int>(moves.size()) - 1;
        out.before_rms_mm = moves.front().rms_mm;
        out.after_rms_mm = moves.back().rms_mm;
    }
    if (!record.fit) return out;
    double squares = 0;
    int values = 0;
    for (const PanelSpotResult& s : record.fit->spots)
        for (const double v : {s.remaining.gap_mm, s.remaining.flush_mm})
            if (std::isfinite(v)) squares += v * v, ++values;
    if (values > 0) out.single_rms_mm = std::sqrt(squares / values);
    out.apart_mm = distance_mm(record.servo->motion, record.fit->gripper_motion);
    out.apart_deg = deg_from_rad(angle_rad(record.servo->motion, record.fit->gripper_motion));
    return out;
}

void compute_panel(const Project& project, const PanelJob& job, PanelRecord& record) {
    record.fit.reset();
    record.base_from_moved_gripper = record.base_from_gripper;
    record.base_from_frame = job.base_from_frame;
    if (auto fit = fit_places(project, job, record.before)) {
        record.fit = std::move(*fit);
        record.base_from_moved_gripper = moved_gripper(record.base_from_gripper, *record.fit);
        record.base_from_frame =
            corrected_frame(job.base_from_gripper,
                            motion_as_correction(job, record.base_from_gripper, *record.fit).displacement,
                            job.base_from_frame);
    } else {
        const Text reason("the motion cannot be computed: {}", fit.error().text());
        if (std::find(record.refusals.begin(), record.refusals.end(), reason) == record.refusals.end())
            record.refusals.push_back(reason);
    }
    if (record.servo) place_servo(job, record);
    record.verdict = judge_panel(job, record.after);
}

}  // namespace seamwright
