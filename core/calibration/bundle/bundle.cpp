#include "core/calibration/bundle/bundle.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/calibration/bundle/bundle_limits.h"
#include "core/calibration/bundle/bundle_units.h"
#include "core/calibration/bundle/onto_rays.h"
#include "core/calibration/camera/camera_costs.h"
#include "core/calibration/numbers.h"
#include "core/calibration/pose_set.h"
#include "core/calibration/statistics.h"
#include "core/geometry/decompositions.h"

namespace seamwright {
namespace {

constexpr double kGoodObject_mm = 0.2, kUsableObject_mm = 1.0;  // three sigma at the worst feature
constexpr double kOpen = 1e-9;  // smallest eigenvalue of the information scaled to unit diagonal
constexpr double kRival = 3.0;  // a rival's misfit, in those of the best and at least the unknown noise
constexpr double kRivalApart_rad = 0.02;
constexpr double kRivalFloor = 0.1;            // of the unknown noise's squares: the best counts as no better
constexpr double kUnseen = 1e-300;             // information of a direction that no sight tells
constexpr double kSameFeature_mm = 1e-6;       // apart at most, of one feature's places on the object
constexpr double kLeastRestSight_px2 = 1e-12;  // squares that exact sights leave, beside a wrong one ..
constexpr double kLeastRestCamera_px2 = 1e-9;  // .. and beside a wrong camera
constexpr int kFolds = 10;
constexpr std::size_t kRefined = 6;

struct Fit {
    Pose pose = Pose::Identity();
    double squares = std::numeric_limits<double>::infinity();  // weighted, px^2
    Matrix6 information = Matrix6::Zero();
    bool determined = false;
};

class Bundle {
  public:
    Bundle(const std::vector<PlacedCamera>& cameras, const std::vector<BundleSight>& sights)
        : cameras_(cameras), sights_(sights) {}

    Fit refine(const Pose& start, const std::vector<char>& use) const {
        std::vector<camera_costs::Sights> seen;
        for (const PlacedCamera& c : cameras_)
            seen.push_back({intrinsics_of(c.camera), c.world_from_camera.pose.inverse(), {}});
        for (std::size_t i = 0; i < sights_.size(); ++i)
            if (use[i])
                seen[sights_[i].camera].corners.push_back(
                    {sights_[i].object_mm, sights_[i].pixel, std::sqrt(sights_[i].weight)});
        Fit fit;
        fit.pose = start;
        const auto known = camera_costs::solve_pose(std::move(seen), fit.pose);
        fit.squares = known.cost;
        fit.information = known.information;
        if (!std::isfinite(fit.squares) || !fit.information.allFinite()) return fit;
        const Vector6 scale = fit.information.diagonal().cwiseMax(kUnseen).cwiseSqrt().cwiseInverse();
        const Matrix6 unit = scale.asDiagonal() * fit.information * scale.asDiagonal();
        fit.determined = symmetric_eigen(unit).values(0) > kOpen;
        return fit;
    }

    // From everywhere: the best, and the best of those that are elsewhere.
    std::vector<Fit> search(const std::vector<char>& use, const std::optional<Pose>& start) const {
        std::vector<Pose> from = onto_rays(rays(use), kRefined);
        if (start) from.push_back(*start);
        std::vector<Fit> fits;
        for (const Pose& one : from) {
            const Fit fit = refine(one, use);
            if (std::isfinite(fit.squares)) fits.push_back(fit);
        }
        std::sort(fits.begin(), fits.end(), [](const Fit& a, const Fit& b) { return a.squares < b.squares; });
        std::vector<Fit> apart;
        for (const Fit& fit : fits)
            if (apart.empty() || angle_rad(fit.pose, apart.front().pose) > kRivalApart_rad) {
                apart.push_back(fit);
                if (apart.size() == 2) break;
            }
        return apart;
    }

    Eigen::Vector2d off(std::size_t i, const Pose& world_from_object) const {
        const BundleSight& s = sights_[i];
        const PlacedCamera& c = cameras_[s.camera];
        return c.camera.project(c.world_from_camera.pose.inverse() * (world_from_object * s.object_mm)) -
               s.pixel;
    }
    double distance_mm(std::size_t i, const Pose& world_from_object) const {
        const BundleSight& s = sights_[i];
        return (cameras_[s.camera].world_from_camera.pose.inverse() * (world_from_object * s.object_mm)).z();
    }

    // How the places of the cameras move the answer.
    Matrix6 of_places(const Fit& fit, const std::vector<char>& use) const {
        const Matrix6 inverse = inverse_matrix(fit.information);
        Matrix6 covariance = Matrix6::Zero();
        for (std::size_t c = 0; c < cameras_.size(); ++c) {
            const UncertainPose& place = cameras_[c].world_from_camera;
            if (place.covariance.isZero()) continue;
            Matrix6 cross = Matrix6::Zero();
            for (std::size_t i = 0; i < sights_.size(); ++i)
                if (use[i] && sights_[i].camera == c)
                    cross += sights_[i].weight * by_object(i, fit.pose).transpose() * by_place(i, fit.pose);
            const Matrix6 gain = inverse * cross;
            covariance += gain * place.covariance * gain.transpose();
        }
        return covariance;
    }
    // What the places add to the weighted sum of squares on average.
    double squares_of_places(const Fit& fit, const std::vector<char>& use) const {
        const Matrix6 inverse = inverse_matrix(fit.information);
        double sum = 0;
        for (std::size_t c = 0; c < cameras_.size(); ++c) {
            const Matrix6& place = cameras_[c].world_from_camera.covariance;
            if (place.isZero()) continue;
            Matrix6 own = Matrix6::Zero(), cross = Matrix6::Zero();
            for (std::size_t i = 0; i < sights_.size(); ++i) {
                if (!use[i] || sights_[i].camera != c) continue;
                const auto p = by_place(i, fit.pose);
                own += sights_[i].weight * p.transpose() * p;
                cross += sights_[i].weight * by_object(i, fit.pose).transpose() * p;
            }
            sum += ((own - cross.transpose() * inverse * cross) * place).trace();
        }
        return sum;
    }

    const std::vector<PlacedCamera>& cameras() const { return cameras_; }
    const std::vector<BundleSight>& sights() const { return sights_; }

  private:
    using Jacobian = Eigen::Matrix<double, 2, 6>;

    template <class At>
    static Jacobian derivative(const At& at) {
        Jacobian j;
        for (int k = 0; k < 6; ++k) {
            Vector6 step = Vector6::Zero();
            step(k) = k < 3 ? kPoseStep_mm : kPoseStep_rad;
            j.col(k) = (at(step) - at(-step)) / (2 * step(k));
        }
        return j;
    }
    Jacobian by_object(std::size_t i, const Pose& pose) const {
        return derivative([&](const Vector6& step) { return off(i, retract(pose, step)); });
    }
    Jacobian by_place(std::size_t i, const Pose& pose) const {
        const PlacedCamera& c = cameras_[sights_[i].camera];
        const Eigen::Vector3d at = pose * sights_[i].object_mm;
        return derivative([&](const Vector6& step) -> Eigen::Vector2d {
            return c.camera.project(retract(c.world_from_camera.pose, step).inverse() * at);
        });
    }
    std::vector<SightRay> rays(const std::vector<char>& use) const {
        std::vector<SightRay> list;
        for (std::size_t i = 0; i < sights_.size(); ++i) {
            if (!use[i]) continue;
            const BundleSight& s = sights_[i];
            const PlacedCamera& c = cameras_[s.camera];
            const Eigen::Vector3d ray = c.camera.undistort(s.pixel).homogeneous();
            if (!ray.allFinite()) continue;
            list.push_back({c.world_from_camera.pose.translation(),
                            (c.world_from_camera.pose.linear() * ray).normalized(), s.object_mm, s.weight});
        }
        return list;
    }

    const std::vector<PlacedCamera>& cameras_;
    const std::vector<BundleSight>& sights_;
};

bool named(const std::vector<std::string>& list, const std::string& id) {
    return std::find(list.begin(), list.end(), id) != list.end();
}

// An object and cameras that are all nearer than a centimetre to where they are counted from are metres.
Expected<void> check_lengths(const std::vector<PlacedCamera>& cameras,
                             const std::vector<BundleSight>& sights) {
    std::vector<Pose> places;
    bool stand = false;
    for (const PlacedCamera& c : cameras) {
        places.push_back(c.world_from_camera.pose);
        stand |= !places.back().translation().isZero(0);
    }
    for (const BundleSight& s : sights) places.push_back(make_pose(Eigen::Matrix3d::Identity(), s.object_mm));
    return stand ? check_millimetres(places, "cameras and features") : Expected<void>();
}

Expected<void> check(const std::vector<PlacedCamera>& cameras, const std::vector<BundleSight>& sights,
                     const BundleOptions& options) {
    SEAM_OK(check_cameras(cameras));
    std::map<std::string, Eigen::Vector3d> places;
    std::set<std::string> known;
    for (const PlacedCamera& c : cameras) known.insert(c.id);
    std::set<std::pair<std::size_t, std::string>> pairs;
    for (const BundleSight& s : sights) {
        const Text where("feature '{}'", s.feature);
        if (s.camera >= cameras.size())
            return input_error(Text("there is no camera {}", s.camera), where, "cameras count from 0");
        if (!std::isfinite(s.weight) || s.weight < 0)
            return input_error("the weight must be 0 or positive", where,
                               "give 1 for an ordinary feature, 0 for none");
        if (!s.object_mm.allFinite() || s.object_mm.cwiseAbs().maxCoeff() > kLargestBody_mm)
            return input_error("its place on the object is not finite or beyond 100 m", where,
                               "give millimetres");
        if (s.weight > 0) SEAM_OK(check_pixel(cameras[s.camera], s.pixel, where));
        const auto [at, fresh] = places.emplace(s.feature, s.object_mm);
        if (!fresh && (at->second - s.object_mm).norm() > kSameFeature_mm)
            return input_error("the same feature stands at two places of the object", where,
                               "give different features different ids");
        if (!pairs.emplace(s.camera, s.feature).second)
            return input_error(Text("camera '{}' sees the feature twice", cameras[s.camera].id), where,
                               "give the better of them");
        known.insert(s.feature);
    }
    SEAM_OK(check_lengths(cameras, sights));
    for (const std::string& id : options.exclude)
        if (!known.contains(id))
            return input_error(Text("there is no camera and no feature '{}'", id), "exclude");
    if (options.sigma_px && !(std::isfinite(*options.sigma_px) && *options.sigma_px > 0))
        return input_error("sigma_px is not a positive number", "sigma_px");
    return {};
}

int count_of(const std::vector<char>& use) {
    return static_cast<int>(std::count(use.begin(), use.end(), 1));
}

std::set<std::string> features_of(const std::vector<BundleSight>& sights, const std::vector<char>& use) {
    std::set<std::string> list;
    for (std::size_t i = 0; i < sights.size(); ++i)
        if (use[i]) list.insert(sights[i].feature);
    return list;
}

// Wrong sights, one after the other: the one whose absence explains the misfit (F test of its two numbers).
void drop_wrong(const Bundle& bundle, std::vector<char>& use, std::vector<Fit>& fits, BundleResult& result) {
    while (!fits.empty()) {
        const double redundancy = 2.0 * (count_of(use) - 1) - 6;
        if (redundancy < 2) return;
        std::size_t suspect = use.size();
        std::vector<Fit> best;
        for (std::size_t i = 0; i < use.size(); ++i) {
            if (!use[i]) continue;
            std::vector<char> without = use;
            without[i] = 0;
            const Fit fit = bundle.refine(fits.front().pose, without);
            if (fit.determined && fit.squares < (best.empty() ? fits.front() : best.front()).squares) {
                best = {fit};
                suspect = i;
            }
        }
        if (suspect == use.size()) return;
        const double f = (fits.front().squares - best.front().squares) / 2 /
                         (std::max(best.front().squares, kLeastRestSight_px2) / redundancy);
        const double miss = bundle.off(suspect, best.front().pose).norm();
        if (f < outlier_limit(redundancy) || !(miss > kSmallestWrong_px)) return;
        use[suspect] = 0;
        result.sights[suspect].wrong = true;
        fits = bundle.search(use, best.front().pose);
    }
}

// A tenth of the features at a time, by the others.
void hold_out(const Bundle& bundle, const std::vector<char>& use, const Pose& pose, HoldOut& out) {
    const auto set = features_of(bundle.sights(), use);
    const std::vector<std::string> features(set.begin(), set.end());
    const int folds = std::min<int>(kFolds, static_cast<int>(features.size()));
    double px = 0, mm = 0;
    int sights = 0;
    out.max_mm = 0;
    for (int fold = 0; fold < folds; ++fold) {
        std::vector<char> rest = use;
        std::vector<std::size_t> left;
        int features_left = 0;
        for (std::size_t k = static_cast<std::size_t>(fold); k < features.size();
             k += static_cast<std::size_t>(folds)) {
            ++features_left;
            for (std::size_t i = 0; i < use.size(); ++i)
                if (use[i] && bundle.sights()[i].feature == features[k]) {
                    rest[i] = 0;
                    left.push_back(i);
                }
        }
        if (features_of(bundle.sights(), rest).size() < 3) continue;
        const Fit fit = bundle.refine(pose, rest);
        if (!fit.determined) continue;
        for (const std::size_t i : left) {
            const double off = bundle.off(i, fit.pose).norm();
            if (!std::isfinite(off)) continue;
            const double off_mm =
                off * bundle.distance_mm(i, pose) / bundle.cameras()[bundle.sights()[i].camera].camera.fx;
            px += off * off;
            mm += off_mm * off_mm;
            out.max_mm = std::max(out.max_mm, off_mm);
            ++sights;
        }
        ++out.folds;
        out.left_out = std::max(out.left_out, features_left);
    }
    if (sights == 0) {
        out = {};
        return;
    }
    out.rms_px = std::sqrt(px / sights);
    out.rms_mm = std::sqrt(mm / sights);
}

// The camera whose absence explains the misfit (F test); empty: none.
std::string camera_against_the_others(const Bundle& bundle, const std::vector<char>& use, const Fit& all) {
    std::string worst;
    double largest = 1;
    for (std::size_t c = 0; c < bundle.cameras().size(); ++c) {
        // A place that may err is no contradiction: its share is in the covariance.
        if (!bundle.cameras()[c].world_from_camera.covariance.isZero()) continue;
        std::vector<char> without = use;
        int own = 0;
        for (std::size_t i = 0; i < use.size(); ++i)
            if (use[i] && bundle.sights()[i].camera == c) without[i] = 0, ++own;
        const double redundancy = 2.0 * count_of(without) - 6;
        if (own == 0 || redundancy < 4 || features_of(bundle.sights(), without).size() < 3) continue;
        const Fit fit = bundle.refine(all.pose, without);
        if (!fit.determined) continue;
        const double f = (all.squares - fit.squares) / (2.0 * own) /
                         (std::max(fit.squares, kLeastRestCamera_px2) / redundancy);
        // The more numbers it has, the less each may be off.
        const double limit = (1 + (outlier_limit(redundancy) - 1) * 2 / (2.0 * own));
        if (f / limit > largest) {
            largest = f / limit;
            worst = bundle.cameras()[c].id;
        }
    }
    return worst;
}

// `squares`: weighted, px^2; `of_places`: of those, what the cameras' places may add.
Judgement judged(const BundleResult& r, const std::string& against, double redundancy, double squares,
                 double of_places, const BundleOptions& options) {
    const Text fit("{} features, {:.2f} px rms, three sigma at the worst feature {:.3f} mm", r.features,
                   r.rms_px, 3 * r.worst_mm);
    if (!against.empty() && r.sigma_px > kGoodNoise_px)
        return {Verdict::poor, Text("camera '{}' contradicts the others", against),
                "check its place, or leave it out"};
    if (options.sigma_px &&
        contradicts_stated((squares - of_places) / std::pow(*options.sigma_px, 2), redundancy))
        return {Verdict::poor, Text("the features miss by more than the stated noise allows: {}", fit),
                "check the features' places on the object and where the cameras stand"};
    if (3 * r.worst_mm > kUsableObject_mm || r.sigma_px > kUsableNoise_px)
        return {Verdict::poor, fit, "let more cameras see more features, far apart, or find them better"};
    if (redundancy <= 0)
        return {Verdict::usable, Text("nothing is left to check with; {}", fit),
                "let one more feature be seen"};
    if (3 * r.worst_mm > kGoodObject_mm || r.sigma_px > kGoodNoise_px)
        return {Verdict::usable, fit, "let more cameras see more features, far apart"};
    return {Verdict::good, fit, ""};
}

void rows_of_cameras(const Bundle& bundle, const BundleOptions& options, BundleResult& r) {
    for (std::size_t c = 0; c < bundle.cameras().size(); ++c) {
        PoseResidual row;
        row.id = bundle.cameras()[c].id;
        row.excluded = named(options.exclude, row.id);
        double px = 0, mm = 0;
        int sights = 0;
        std::string wrong;
        for (std::size_t i = 0; i < r.sights.size(); ++i) {
            const BundleSight& s = bundle.sights()[i];
            if (s.camera != c || s.weight == 0) continue;
            if (r.sights[i].wrong) wrong += (wrong.empty() ? "" : ", ") + s.feature;
            if (!r.sights[i].used && !row.excluded) continue;
            const double off = r.sights[i].off_px.norm();
            if (!std::isfinite(off)) continue;
            px += off * off;
            mm +=
                std::pow(off * bundle.distance_mm(i, r.world_from_object) / bundle.cameras()[c].camera.fx, 2);
            ++sights;
        }
        row.used = !row.excluded && sights > 0;
        if (sights > 0) {
            row.rms_px = std::sqrt(px / sights);
            row.rms_mm = std::sqrt(mm / sights);
        }
        row.contradicts = !wrong.empty();
        row.note = row.excluded     ? Text("excluded by the user")
                   : !wrong.empty() ? Text("contradict the others and are left out: {}", wrong)
                   : sights == 0    ? Text("it sees no feature")
                                    : Text();
        r.report.poses.push_back(std::move(row));
    }
}

}  // namespace

Expected<BundleResult> locate_object(const std::vector<PlacedCamera>& cameras,
                                     const std::vector<BundleSight>& sights, const BundleOptions& options) {
    SEAM_TRY(auto found, bundle::locate_as_given(cameras, sights, options));
    if (!serves(found.report.judgement.verdict))
        if (Text unit = bundle::other_unit(cameras, sights, options); !unit.empty())
            found.report.judgement.cure = std::move(unit);
    return found;
}

Expected<BundleResult> bundle::locate_as_given(const std::vector<PlacedCamera>& cameras,
                                               const std::vector<BundleSight>& sights,
                                               const BundleOptions& options) {
    SEAM_OK(check(cameras, sights, options));
    const Bundle bundle(cameras, sights);
    BundleResult r;
    r.sights.resize(sights.size());
    std::vector<char> use(sights.size());
    for (std::size_t i = 0; i < sights.size(); ++i)
        use[i] = sights[i].weight > 0 && !named(options.exclude, cameras[sights[i].camera].id) &&
                 !named(options.exclude, sights[i].feature);
    const auto open = [&](Text reason, Text cure) {
        r.report.judgement = {Verdict::undetermined, std::move(reason), std::move(cure)};
        r.report.poses.clear();
        for (const PlacedCamera& c : cameras) {
            PoseResidual row;
            row.id = c.id;
            row.excluded = named(options.exclude, c.id);
            row.used = !row.excluded;
            r.report.poses.push_back(std::move(row));
        }
        return r;
    };
    if (features_of(sights, use).size() < 3)
        return open("fewer than three features are seen", "let three or more features be seen");
    std::vector<Fit> fits = bundle.search(use, options.start);
    if (fits.empty())
        return open("no place of the object explains what the cameras see",
                    "check the features' places, which camera saw them, and where the cameras stand");
    drop_wrong(bundle, use, fits, r);
    const Fit& best = fits.front();
    if (!best.determined)
        return open("the features lie on one line: the turn about it is not determined",
                    "let a feature be seen that lies off that line");

    const double count = count_of(use), redundancy = 2 * count - 6;
    const double floor = count * kUnknownNoise_px * kUnknownNoise_px;
    if (fits.size() > 1 && fits[1].determined &&
        fits[1].squares < kRival * std::max(best.squares, kRivalFloor * floor)) {
        r.rival = fits[1].pose;
        const bool nearer =
            options.start && angle_rad(*options.start, fits[1].pose) < angle_rad(*options.start, best.pose);
        if (!options.start)
            return open(Text("two places explain the features almost equally, {:.1f} degrees apart",
                             deg_from_rad(angle_rad(fits[1].pose, best.pose))),
                        "say where the object roughly stands (start), or let another camera see it");
        if (nearer) {
            r.rival = best.pose;
            std::swap(fits[0], fits[1]);
        }
    }
    const Fit& fit = fits.front();
    r.determined = true;
    r.world_from_object = fit.pose;
    r.features = static_cast<int>(features_of(sights, use).size());
    r.rms_px = std::sqrt(fit.squares / count);
    for (std::size_t i = 0; i < sights.size(); ++i) {
        r.sights[i].used = use[i] != 0;
        if (sights[i].weight > 0) r.sights[i].off_px = bundle.off(i, fit.pose);
    }
    const double of_places = bundle.squares_of_places(fit, use);
    double student = 1;
    if (options.sigma_px) {
        r.sigma_px = *options.sigma_px;
    } else if (redundancy > 0) {
        // What the cameras' places add is not the pixels' noise; a tenth stays in any case.
        r.sigma_px =
            std::sqrt(std::max(fit.squares - of_places, kLeastNoiseShare * fit.squares) / redundancy);
        student = student_quantile(kUpper95, redundancy) / normal_quantile(kUpper95);
    } else {
        r.sigma_px = kUnknownNoise_px;
    }
    r.covariance =
        std::pow(student * r.sigma_px, 2) * inverse_matrix(fit.information) + bundle.of_places(fit, use);
    for (std::size_t i = 0; i < sights.size(); ++i) {
        if (!use[i]) continue;
        Eigen::Matrix<double, 3, 6> j;
        j << Eigen::Matrix3d::Identity(), -skew(fit.pose.linear() * sights[i].object_mm);
        r.worst_mm = std::max(r.worst_mm, worst_sigma(j * r.covariance * j.transpose()));
    }
    add_pose(r.report, fit.pose);
    state_covariance(r.report, r.covariance);
    rows_of_cameras(bundle, options, r);
    hold_out(bundle, use, fit.pose, r.report.hold_out);
    r.report.judgement = judged(r, camera_against_the_others(bundle, use, fit), redundancy, fit.squares,
                                4 * of_places, options);
    return r;
}

}  // namespace seamwright
