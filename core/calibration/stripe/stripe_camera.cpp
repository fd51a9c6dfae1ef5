#include "core/calibration/stripe/stripe_camera.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>

#include "core/calibration/camera/camera_limits.h"
#include "core/calibration/stripe/stripe_camera_solver.h"

namespace seamwright {
namespace detail {
namespace {

constexpr double kStartCorner_px = 0.3;  // sigma of the corners until the residuals tell it
// What corners can be, whatever the residuals say: sigmas from .. to.
constexpr double kBestCorner_px = 0.01, kWorstCorner_px = 3.0;
constexpr double kLeastCornerFreedom = 10.0;

}  // namespace

// From simple to rich. With a free stretch of the plate the two focal lengths stay one: they are hard to tell
// apart.
const std::vector<StripeCameraSolver::Model>& StripeCameraSolver::model_ladder() {
    static const std::vector<Model> ladder{
        {{false, false, 1, false}, ShapeFreedom::rigid},   {{false, true, 1, false}, ShapeFreedom::rigid},
        {{true, true, 2, false}, ShapeFreedom::rigid},     {{false, false, 1, false}, ShapeFreedom::in_plane},
        {{false, true, 1, false}, ShapeFreedom::in_plane}, {{false, false, 1, false}, ShapeFreedom::bowed},
        {{false, true, 1, false}, ShapeFreedom::bowed},    {{false, true, 2, false}, ShapeFreedom::bowed},
        {{false, true, 3, true}, ShapeFreedom::bowed},
    };
    return ladder;
}

Expected<StripeCameraResult> StripeCameraSolver::run() {
    SEAM_OK(collect());
    SEAM_OK(start());
    choose_model();
    refine_without_stripe();
    SEAM_OK(check_scale_again());
    locate_stripes();
    refine_with_stripe();
    measure();
    list_parameters();
    if (has_robot()) measure_size();
    list_poses();
    result_.report.judgement = verdict();
    return std::move(result_);
}

Expected<void> StripeCameraSolver::collect() {
    std::set<std::string> ids;
    for (const auto& o : observations_) {
        if (!ids.insert(o.id).second)
            return input_error(Text("the frame id '{}' occurs twice", o.id), o.id, "name frames apart");
        if (o.width != observations_.front().width || o.height != observations_.front().height)
            return input_error(
                Text("the images have different sizes ({}x{} and {}x{})", observations_.front().width,
                     observations_.front().height, o.width, o.height),
                o.id, "give frames of one camera at one resolution");
    }
    for (const auto& e : options_.exclude)
        if (!ids.count(e))
            return input_error(Text("there is no frame '{}' to exclude", e), "exclude",
                               "name a frame of the set");
    if (observations_.empty())
        return input_error("there is no frame", "images", "give at least 5 frames that show the plate");
    data_.width = observations_.front().width;
    data_.height = observations_.front().height;
    for (std::size_t i = 0; i < observations_.size(); ++i) {
        const auto& o = observations_[i];
        StripeFrameResult f;
        f.id = o.id;
        f.board_found = o.board.has_value();
        result_.boards_found += f.board_found;
        const bool excluded = std::count(options_.exclude.begin(), options_.exclude.end(), o.id) > 0;
        if (excluded)
            f.note = "excluded";
        else if (!f.board_found)
            f.note = o.miss.counted || o.miss.several ? why_missed(spec_, o.miss) : "no board found";
        else if (const int twin = same_as_earlier(*o.board); twin >= 0)
            f.note = Text("the same image as {}", observations_[static_cast<std::size_t>(twin)].id);
        else {
            view_frame_.push_back(i);
            data_.views.push_back({o.id, o.board->object_mm, o.board->pixel});
            f.used = true;
        }
        result_.frames.push_back(std::move(f));
    }
    if (result_.boards_found == 0) {
        for (const auto& o : observations_)
            if (o.miss.counted || o.miss.several)
                return input_error(why_missed(spec_, o.miss), "board", cure_of(o.miss));
        return input_error(Text("no board of {}x{} points was found in any of {} images", spec_.columns,
                                spec_.rows, observations_.size()),
                           "board", "check the number of inner corners, the light and the focus");
    }
    if (count() < 3)
        return input_error(Text("only {} different frames show the board, at least 3 are needed", count()),
                           "images", "take 8 or more frames with the plate tilted in different directions");
    return {};
}

int StripeCameraSolver::same_as_earlier(const FoundBoard& board) const {
    for (const auto i : view_frame_) {
        const auto& other = *observations_[i].board;
        if (other.pixel.size() != board.pixel.size()) continue;
        double worst = 0;
        for (std::size_t k = 0; k < board.pixel.size(); ++k)
            worst = std::max(worst, (board.pixel[k] - other.pixel[k]).norm());
        if (worst < kSamePicture_px) return static_cast<int>(i);
    }
    return -1;
}

Expected<void> StripeCameraSolver::start() {
    const auto first = start_camera(data_);
    if (!first)
        return input_error("no camera explains the boards", "images", "check the number of inner corners");
    state_.intrinsics = first->intrinsics;
    state_.camera_from_target = first->camera_from_target;
    state_.shape.middle_mm = {0.5 * (spec_.columns - 1) * spec_.pitch_mm,
                              0.5 * (spec_.rows - 1) * spec_.pitch_mm};
    state_.shape.half_mm = 0.5 * (std::max(spec_.columns, spec_.rows) - 1) * spec_.pitch_mm;
    bundle_.data = &data_;
    bundle_.view_used.assign(count(), 1);
    bundle_.base_from_flange.assign(count(), std::nullopt);
    for (std::size_t k = 0; k < count(); ++k)
        bundle_.base_from_flange[k] = observations_[view_frame_[k]].base_from_flange;
    bundle_.corner_sigma_px = kStartCorner_px;
    // A model that a person names is meant as it stands.
    bundle_.hold_exactly = options_.freedom.has_value();
    return start_robot();
}

// Mean squared corner error of each view, predicted by the others.
std::vector<double> StripeCameraSolver::cross_validate(const Model& model) {
    PlateBundle p = bundle_;
    p.freedom = model.freedom;
    p.shape = model.shape;
    const auto all = solve_plate_bundle(p, state_);
    std::vector<double> error(count(), std::numeric_limits<double>::infinity());
    if (!std::isfinite(all.cost)) return error;
    for (std::size_t k = 0; k < count(); ++k) {
        p.view_used.assign(count(), 1);
        p.view_used[k] = 0;
        const auto rest = solve_plate_bundle(p, all.state);
        CameraPoints view = data_.views[k];
        for (auto& x : view.object_mm) x = rest.state.shape.apply(x);
        if (const auto t = locate_target(camera_of(rest.state.intrinsics, data_.width, data_.height), view))
            error[k] = t->rms_px * t->rms_px;
    }
    return error;
}

// The simplest model whose predictions are not worse than the best model's by more than one standard
// error.
void StripeCameraSolver::choose_model() {
    std::size_t chosen = 0;
    if (options_.freedom || options_.shape) {
        model_ = {options_.freedom.value_or(CameraFreedom{false, true, 1, false}),
                  options_.shape.value_or(ShapeFreedom::rigid)};
    } else if (count() < 5) {
        model_ = model_ladder().front();
    } else {
        const auto& ladder = model_ladder();
        std::vector<std::vector<double>> errors;
        std::vector<double> mean;
        for (const auto& m : ladder) {
            errors.push_back(cross_validate(m));
            mean.push_back(std::accumulate(errors.back().begin(), errors.back().end(), 0.0) /
                           static_cast<double>(count()));
        }
        const auto best = static_cast<std::size_t>(std::min_element(mean.begin(), mean.end()) - mean.begin());
        chosen = best;
        for (std::size_t m = 0; m < best; ++m) {
            if (!std::isfinite(mean[m])) continue;
            const double gap = mean[m] - mean[best];
            double variance = 0;
            for (std::size_t k = 0; k < count(); ++k) {
                const double d = errors[m][k] - errors[best][k] - gap;
                variance += d * d;
            }
            const double n = static_cast<double>(count());
            if (gap < std::sqrt(variance / (n * (n - 1)))) {
                chosen = m;
                break;
            }
        }
        model_ = ladder[chosen];
        result_.report.hold_out.folds = static_cast<int>(count());
        result_.report.hold_out.left_out = 1;
        result_.report.hold_out.rms_px = std::sqrt(mean[chosen]);
    }
    bundle_.freedom = model_.freedom;
    bundle_.shape = model_.shape;
}

// Sigmas from the residuals, within what robots and corners can be.
void StripeCameraSolver::estimate_sigmas(const PlateBundleFit& fit) {
    const double free = 2.0 * static_cast<double>(fit.corners) - 6.0 * static_cast<double>(count()) -
                        static_cast<double>(fit.normal.gg.rows());
    bundle_.corner_sigma_px = std::clamp(std::sqrt(fit.corner_cost / std::max(free, kLeastCornerFreedom)),
                                         kBestCorner_px, kWorstCorner_px);
    if (has_robot()) estimate_robot_sigmas(fit);
}

void StripeCameraSolver::refine_without_stripe() {
    for (int i = 0; i < 4; ++i) {
        fit_ = solve_plate_bundle(bundle_, state_);
        state_ = fit_.state;
        estimate_sigmas(fit_);
    }
}

}  // namespace detail

Expected<StripeCameraResult> calibrate_stripe_camera(const std::vector<StripeObservation>& observations,
                                                     const BoardSpec& spec,
                                                     const StripeCameraOptions& options) {
    SEAM_OK(validate(spec));
    return detail::StripeCameraSolver(observations, spec, options).run();
}

}  // namespace seamwright
