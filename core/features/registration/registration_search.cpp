#include "core/features/registration/registration_search.h"
#include "core/features/contour/face_order.h"
#include "core/features/contour/reduce_contour.h"

#include <algorithm>
#include <cmath>

namespace seamwright {
namespace {

// Appends the polygon through `kept` with no edge longer than `spacing`.
void append_polygon(const std::vector<double>& x, const std::vector<double>& z, const std::vector<int>& kept,
                    double spacing, ReducedContour& out) {
    for (std::size_t i = 0; i < kept.size(); ++i) {
        const double x0 = x[kept[i]], z0 = z[kept[i]];
        double before = 0, after = 0;
        int parts = 1;
        if (i > 0) {
            const double length = std::hypot(x0 - x[kept[i - 1]], z0 - z[kept[i - 1]]);
            before = length / std::max(1.0, std::ceil(length / spacing));
        }
        double x1 = x0, z1 = z0;
        if (i + 1 < kept.size()) {
            x1 = x[kept[i + 1]];
            z1 = z[kept[i + 1]];
            const double length = std::hypot(x1 - x0, z1 - z0);
            parts = std::max(1, static_cast<int>(std::ceil(length / spacing)));
            after = length / parts;
        }
        out.x.push_back(x0);
        out.z.push_back(z0);
        out.weight.push_back(std::max(0.5 * (before + after), 0.5 * spacing));
        for (int k = 1; k < parts; ++k) {
            const double t = double(k) / parts;
            out.x.push_back(x0 + t * (x1 - x0));
            out.z.push_back(z0 + t * (z1 - z0));
            out.weight.push_back(after);
        }
    }
}

}  // namespace

void ReducedContour::clear() {
    x.clear();
    z.clear();
    weight.clear();
}

CentredPose moved_along(const CentredPose& pose, const Eigen::Vector3d& body_twist, double amount) {
    const double vx = body_twist.x() * amount, vz = body_twist.y() * amount, turn = body_twist.z() * amount;
    double a = 1, b = 0;  // sin(turn) / turn and (1 - cos(turn)) / turn
    if (std::abs(turn) > 1e-6) {
        a = std::sin(turn) / turn;
        b = (1 - std::cos(turn)) / turn;
    } else {
        b = 0.5 * turn;
    }
    const double mx = a * vx - b * vz, mz = b * vx + a * vz;
    return {pose.dx + pose.cosine * mx - pose.sine * mz, pose.dz + pose.sine * mx + pose.cosine * mz,
            pose.phi + turn};
}

// The points that have neighbours.
void SceneContour::take_solid(const std::vector<double>& px, const std::vector<double>& pz) {
    solid_x_.clear();
    solid_z_.clear();
    const double near = 6 * pitch.distance;
    const int count = static_cast<int>(px.size());
    for (int i = 0; i < count; ++i) {
        int support = 0;
        for (int k = std::max(0, i - 3); k <= std::min(count - 1, i + 3); ++k) {
            const double dx = px[k] - px[i], dz = pz[k] - pz[i];
            if (k != i && dx * dx + dz * dz < near * near) ++support;
        }
        if (support < 2) continue;
        solid_x_.push_back(px[i]);
        solid_z_.push_back(pz[i]);
    }
}

void SceneContour::gather(const Profile& scene, const Eigen::Vector2d& origin, const Eigen::Vector2d& centre,
                          double reach) {
    x.clear();
    z.clear();
    all_x_.clear();
    all_z_.clear();
    const bool marked = scene.filtered();
    for (std::size_t i = 0; i < scene.size() && i < scene.z_mm.size(); ++i) {
        const double px = scene.x_mm[i] - origin.x(), pz = scene.z_mm[i] - origin.y();
        if (!std::isfinite(px) || !std::isfinite(pz) || (marked && scene.segment[i] == kOutlier)) continue;
        all_x_.push_back(px);
        all_z_.push_back(pz);
        if (std::abs(px - centre.x()) > reach || std::abs(pz - centre.y()) > reach) continue;
        x.push_back(px);
        z.push_back(pz);
    }
    const std::size_t n = x.size();
    if (n < 2) return;
    pitch = contour_pitch(x, z, scratch_);
    // In sensor order a neighbour is near. In a shuffled set it is anywhere.
    const auto [lo, hi] = std::minmax_element(x.begin(), x.end());
    const bool shuffled = n > 20 && pitch.along_x > 0.1 * (*hi - *lo);
    if (shuffled) {
        sorted_.clear();
        for (std::size_t i = 0; i < n; ++i) sorted_.push_back({x[i], z[i], 0});
        std::sort(sorted_.begin(), sorted_.end());
        for (std::size_t i = 0; i < n; ++i) {
            x[i] = sorted_[i][0];
            z[i] = sorted_[i][1];
        }
        pitch = contour_pitch(x, z, scratch_);
    }
    if (order_faces(pitch, x, z)) pitch = contour_pitch(x, z, scratch_);
    mixed_.clear();
    // Noise that many neighbours share shows in the whole profile: a few bends within reach would pass for it.
    ProfileNoise whole;
    if (!shuffled) {
        take_solid(all_x_, all_z_);
        whole = profile_noise(solid_x_, solid_z_, scratch_, SharedOver::many);
    }
    take_solid(x, z);
    ProfileNoise noise = profile_noise(solid_x_, solid_z_, scratch_);
    sigma_mm = noise.point_mm;
    if (whole.apart() > noise.apart()) noise = whole;
    pitch.shared = noise.apart();
    if (pitch.alike() > 1) sigma_mm = std::max(sigma_mm, noise.alone_mm);
    leave_out_mixed();
    jumps.clear();
    const int solid = static_cast<int>(solid_x_.size());
    for (int i = 0; i + 1 < solid; ++i) {
        const double dx = solid_x_[i + 1] - solid_x_[i], dz = solid_z_[i + 1] - solid_z_[i];
        if (pitch.is_gap(dx, dz) &&
            gap_ends(solid_x_, solid_z_, i, 0, solid - 1, sigma_mm, pitch.most_open(), jumps))
            continue;
        if (!pitch.is_wall(dx, dz) &&
            !pitch.is_step(solid_x_, solid_z_, static_cast<std::size_t>(i), sigma_mm))
            continue;
        const bool rising = solid_z_[i + 1] > solid_z_[i];
        JumpEnd end = jump_end(solid_x_, solid_z_, rising ? i : i + 1, rising ? i + 1 : i, 0, solid - 1,
                               sigma_mm, pitch.most_open());
        end.outline = outline_at(solid_x_, solid_z_, i, 0, solid - 1, sigma_mm);
        jumps.push_back(end);
    }
}

void SceneContour::leave_out_mixed() {
    run_x_.clear();
    run_z_.clear();
    for (std::size_t i = 0; i < solid_x_.size();) {
        const int many = pitch.mixed(solid_x_, solid_z_, i, sigma_mm);
        if (many == 0) {
            run_x_.push_back(solid_x_[i]);
            run_z_.push_back(solid_z_[i++]);
            continue;
        }
        for (int k = 0; k < many; ++k, ++i) mixed_.push_back({solid_x_[i], solid_z_[i]});
    }
    if (mixed_.empty()) return;
    solid_x_.swap(run_x_);
    solid_z_.swap(run_z_);
    // The same points, in the same order, among all of them.
    std::size_t next = 0, kept = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (next < mixed_.size() && x[i] == mixed_[next][0] && z[i] == mixed_[next][1]) {
            ++next;
            continue;
        }
        x[kept] = x[i];
        z[kept++] = z[i];
    }
    x.resize(kept);
    z.resize(kept);
}

void SceneContour::add_polygon_edge(double x0, double z0, double x1, double z1) {
    if (x0 > x1) {
        std::swap(x0, x1);
        std::swap(z0, z1);
    }
    const int cells = static_cast<int>(grid_count.size());
    auto add = [&](int cell, double height) {
        std::uint8_t& count = grid_count[cell];
        float* heights = &grid_z[static_cast<std::size_t>(cell) * kHeights];
        for (int i = 0; i < count; ++i)
            if (std::abs(heights[i] - height) < 0.5 * grid_step) return;
        if (count < kHeights) heights[count++] = static_cast<float>(height);
    };
    const double from = (x0 - grid_origin) / grid_step, to = (x1 - grid_origin) / grid_step;
    const int first = std::clamp(static_cast<int>(std::ceil(from)), 0, cells - 1);
    const int last = std::clamp(static_cast<int>(std::floor(to)), 0, cells - 1);
    for (int cell = first; cell <= last; ++cell) {
        const double t = to > from ? std::clamp((cell - from) / (to - from), 0.0, 1.0) : 0.5;
        add(cell, z0 + t * (z1 - z0));
    }
}

void SceneContour::reduce(double tolerance, double spacing) {
    reduced.clear();
    const auto [lo, hi] = std::minmax_element(x.begin(), x.end());
    grid_step = 0.25 * spacing;
    // A scene far wider than any template (one stray point a kilometre off) must not ask for a gigantic grid.
    constexpr double kMostCells = 20000;
    grid_step = std::max(grid_step, (*hi - *lo) / kMostCells);
    grid_origin = *lo - grid_step;
    const auto cells = static_cast<std::size_t>((*hi - *lo) / grid_step) + 4;
    grid_count.assign(cells, 0);
    grid_z.resize(cells * kHeights);

    const double near = std::max(6 * pitch.distance, 2 * tolerance);
    auto flush = [&] {
        if (run_x_.size() >= 3) {
            reduce_contour(run_x_, run_z_, tolerance, kept_);
            append_polygon(run_x_, run_z_, kept_, spacing, reduced);
            for (std::size_t i = 1; i < kept_.size(); ++i)
                add_polygon_edge(run_x_[kept_[i - 1]], run_z_[kept_[i - 1]], run_x_[kept_[i]],
                                 run_z_[kept_[i]]);
        }
        run_x_.clear();
        run_z_.clear();
    };
    run_x_.clear();
    run_z_.clear();
    for (std::size_t i = 0; i < solid_x_.size(); ++i) {
        if (!run_x_.empty()) {
            const double dx = solid_x_[i] - run_x_.back(), dz = solid_z_[i] - run_z_.back();
            // Walls stay in the polygon when they are low: the step is part of the shape.
            const bool bridged =
                std::hypot(dx, dz) < near || (pitch.is_wall(dx, dz) && std::abs(dz) < 10 * spacing);
            if (!bridged) flush();
        }
        run_x_.push_back(solid_x_[i]);
        run_z_.push_back(solid_z_[i]);
    }
    flush();
    // Sorted by x for the windowed search of the EM-ICP.
    if (!std::is_sorted(reduced.x.begin(), reduced.x.end())) {
        sorted_.clear();
        for (std::size_t i = 0; i < reduced.x.size(); ++i)
            sorted_.push_back({reduced.x[i], reduced.z[i], reduced.weight[i]});
        std::sort(sorted_.begin(), sorted_.end());
        for (std::size_t i = 0; i < sorted_.size(); ++i) {
            reduced.x[i] = sorted_[i][0];
            reduced.z[i] = sorted_[i][1];
            reduced.weight[i] = sorted_[i][2];
        }
    }
}

MotionBox motion_box(const SearchWindow& window, const Eigen::Vector2d& origin,
                     const Eigen::Vector2d& reference, double phi) {
    const double c = std::cos(phi), s = std::sin(phi);
    // The reference r moves by m: centroid motion = m + r' - R r' with r' = r - origin.
    auto turned = [&](const Eigen::Vector2d& p) {
        return Eigen::Vector2d(p.x() - (c * p.x() - s * p.y()), p.y() - (s * p.x() + c * p.y()));
    };
    const Eigen::Vector2d a = window.centre_mm + turned(reference - origin);
    MotionBox box{a.x() - window.dx_mm, a.x() + window.dx_mm, a.y() - window.dz_mm, a.y() + window.dz_mm};
    if (window.pivot == SearchPivot::reference_or_origin) {
        const Eigen::Vector2d b = window.centre_mm + turned(-origin);
        box.x0 = std::min(box.x0, b.x() - window.dx_mm);
        box.x1 = std::max(box.x1, b.x() + window.dx_mm);
        box.z0 = std::min(box.z0, b.y() - window.dz_mm);
        box.z1 = std::max(box.z1, b.y() + window.dz_mm);
    }
    return box;
}

void RegistrationSearch::prepare(const ContourModel& contour) {
    const double extent = contour.extent_mm();
    half_extent_ = 0.5 * extent;
    step_ = std::max(std::clamp(extent / 24, 0.3, 1.2), 1.5 * contour.pitch().distance);
    tolerance_ = std::max(3 * contour.sigma_mm(), 0.003 * extent);
    reduced_.clear();
    std::vector<double> x, z;
    std::vector<int> kept;
    const auto& edges = contour.edges();
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (x.empty()) {
            x.push_back(contour.x()[edges[e].point]);
            z.push_back(contour.z()[edges[e].point]);
        }
        x.push_back(contour.x()[edges[e].point + 1]);
        z.push_back(contour.z()[edges[e].point + 1]);
        if (e + 1 == edges.size() || edges[e + 1].run != edges[e].run) {
            reduce_contour(x, z, tolerance_, kept);
            append_polygon(x, z, kept, step_, reduced_);
            x.clear();
            z.clear();
        }
    }
    weight_sum_ = 0;
    for (const double w : reduced_.weight) weight_sum_ += w;
    turned_x_.resize(reduced_.x.size());
    turned_z_.resize(reduced_.x.size());
}

double RegistrationSearch::rate(const SceneContour& scene, const CentredPose& pose, double tolerance) const {
    const int cells = static_cast<int>(scene.grid_count.size());
    const double per_mm = 1 / scene.grid_step, over = 1 / tolerance;
    double sum = 0;
    for (std::size_t j = 0; j < reduced_.x.size(); ++j) {
        const double px = pose.cosine * reduced_.x[j] - pose.sine * reduced_.z[j] + pose.dx;
        const double pz = pose.sine * reduced_.x[j] + pose.cosine * reduced_.z[j] + pose.dz;
        const double place = (px - scene.grid_origin) * per_mm + 0.5;
        if (!(place >= 0 && place < cells)) continue;
        const int cell = static_cast<int>(place);
        double best = 1;
        for (int k = 0; k < scene.grid_count[cell]; ++k)
            best = std::min(
                best,
                std::abs(scene.grid_z[static_cast<std::size_t>(cell) * SceneContour::kHeights + k] - pz) *
                    over);
        sum += reduced_.weight[j] * (1 - best * best);
    }
    return sum / weight_sum_;
}

void RegistrationSearch::find(const SceneContour& scene, const SearchWindow& window,
                              const Eigen::Vector2d& origin, const Eigen::Vector2d& reference, int most,
                              std::vector<SearchCandidate>& candidates) {
    candidates.clear();
    rated_.clear();
    const int points = static_cast<int>(reduced_.x.size());
    const int cells = static_cast<int>(scene.grid_count.size());
    if (scene.reduced.x.size() < 3 || points < 3) return;

    // Steps such that a pose between two of them still misses by less than a histogram cell.
    double step = step_;
    const MotionBox level = motion_box(window, origin, reference, 0);
    const double most_turns = 64, most_shifts = 256;
    step = std::max(step, (level.x1 - level.x0) / most_shifts);
    const double turn_step =
        std::max(std::clamp(1.2 * step / half_extent_, 0.02, 0.09), 2 * window.phi_rad / most_turns);
    const int turns = std::max(0, static_cast<int>(std::ceil(window.phi_rad / turn_step)));
    const double cell_mm = 0.7 * step;
    const double per_mm = 1 / scene.grid_step, per_cell = 1 / cell_mm;
    for (int turn = -turns; turn <= turns; ++turn) {
        const double phi = turns > 0 ? window.phi_rad * turn / turns : 0;
        const CentredPose turned(0, 0, phi);
        for (int j = 0; j < points; ++j) {
            turned_x_[j] = turned.cosine * reduced_.x[j] - turned.sine * reduced_.z[j] - scene.grid_origin;
            turned_z_[j] = turned.sine * reduced_.x[j] + turned.cosine * reduced_.z[j];
        }
        const MotionBox box = motion_box(window, origin, reference, phi);
        const int shifts = std::max(1, static_cast<int>(std::ceil((box.x1 - box.x0) / step)));
        const double low = box.z0 - cell_mm;
        const int heights = static_cast<int>(std::min(2000.0, (box.z1 - box.z0) * per_cell + 4));
        histogram_.resize(static_cast<std::size_t>(heights) + 1);
        for (int shift = 0; shift <= shifts; ++shift) {
            const double dx = box.x0 + (box.x1 - box.x0) * shift / shifts;
            std::fill(histogram_.begin(), histogram_.end(), 0.0);
            for (int j = 0; j < points; ++j) {
                const double place = (turned_x_[j] + dx) * per_mm + 0.5;
                if (!(place >= 0 && place < cells)) continue;
                const auto cell = static_cast<std::size_t>(place);
                const float* z = &scene.grid_z[cell * SceneContour::kHeights];
                for (int k = 0; k < scene.grid_count[cell]; ++k) {
                    const double height = (z[k] - turned_z_[j] - low) * per_cell;
                    if (height >= 0 && height < heights)
                        histogram_[static_cast<int>(height)] += reduced_.weight[j];
                }
            }
            int best = 0;
            double best_sum = -1;
            for (int h = 0; h < heights; ++h) {
                const double sum = histogram_[h] + histogram_[h + 1];
                if (sum > best_sum) {
                    best_sum = sum;
                    best = h;
                }
            }
            if (best_sum <= 0) continue;
            const double dz =
                low + cell_mm * (best + (histogram_[best] * 0.5 + histogram_[best + 1] * 1.5) / best_sum);
            rated_.push_back({CentredPose(dx, dz, phi), best_sum / weight_sum_});
        }
    }
    // Best first, each at least two steps from the better ones. A partial sort is enough: few are taken.
    auto better = [](const SearchCandidate& a, const SearchCandidate& b) { return a.score > b.score; };
    const std::size_t sorted = std::min<std::size_t>(rated_.size(), 200);
    std::partial_sort(rated_.begin(), rated_.begin() + static_cast<std::ptrdiff_t>(sorted), rated_.end(),
                      better);
    for (std::size_t i = 0; i < sorted && static_cast<int>(candidates.size()) < most; ++i) {
        const CentredPose& p = rated_[i].pose;
        bool apart = true;
        for (const SearchCandidate& c : candidates)
            apart = apart &&
                    (std::abs(p.dx - c.pose.dx) > 2.5 * step || std::abs(p.dz - c.pose.dz) > 2.5 * step ||
                     std::abs(p.phi - c.pose.phi) > 2.5 * turn_step);
        if (apart) candidates.push_back(rated_[i]);
    }
    for (SearchCandidate& c : candidates) {
        expectation_maximisation(scene, c.pose);
        c.score = rate(scene, c.pose, 0.5 * step_);
    }
    std::sort(candidates.begin(), candidates.end(), better);
}

// EM-ICP (3.31), (3.34) with the roles that a template in a larger scene asks for: every reduced template
// point spreads over the scene points it may correspond to, so scene beside the template pulls at nothing.
// The uniform outlier term stands in the denominator (clutter and occlusion; the thesis has none). The M-step
// is the weighted rigid closed form, which corrects (3.41)-(3.43), a similarity. sigma^2 shrinks by a
// constant factor.
void RegistrationSearch::expectation_maximisation(const SceneContour& scene, CentredPose& pose) const {
    const ReducedContour& s = scene.reduced;
    const int points = static_cast<int>(reduced_.x.size());
    const double start = 1.6 * step_, end = 0.35 * step_, factor = 0.75, outlier = 0.15;
    for (double sigma = start; sigma > end; sigma *= factor) {
        const double reach = 3 * sigma, over = -0.5 / (sigma * sigma);
        double weight = 0;
        Eigen::Vector2d mean_m(0, 0), mean_s(0, 0);
        double dot = 0, cross = 0;
        for (int j = 0; j < points; ++j) {
            const double mx = reduced_.x[j], mz = reduced_.z[j];
            const double px = pose.cosine * mx - pose.sine * mz + pose.dx;
            const double pz = pose.sine * mx + pose.cosine * mz + pose.dz;
            double a = 0, ax = 0, az = 0;
            auto i =
                static_cast<std::size_t>(std::lower_bound(s.x.begin(), s.x.end(), px - reach) - s.x.begin());
            for (; i < s.x.size() && s.x[i] < px + reach; ++i) {
                const double ex = s.x[i] - px, ez = s.z[i] - pz;
                const double e = std::exp(over * (ex * ex + ez * ez));
                a += e;
                ax += e * s.x[i];
                az += e * s.z[i];
            }
            if (a < 1e-6) continue;
            const double w = reduced_.weight[j] * a / (a + outlier);
            const double sx = ax / a, sz = az / a;
            weight += w;
            mean_m += w * Eigen::Vector2d(mx, mz);
            mean_s += w * Eigen::Vector2d(sx, sz);
            dot += w * (mx * sx + mz * sz);
            cross += w * (mx * sz - mz * sx);
        }
        if (!(weight > 0)) return;
        mean_m /= weight;
        mean_s /= weight;
        dot -= weight * mean_m.dot(mean_s);
        cross -= weight * (mean_m.x() * mean_s.y() - mean_m.y() * mean_s.x());
        if (!(std::hypot(dot, cross) > 0)) return;
        CentredPose turned(0, 0, std::atan2(cross, dot));
        const Eigen::Vector2d shift = mean_s - turned * mean_m;
        turned.dx = shift.x();
        turned.dz = shift.y();
        pose = turned;
    }
}

void RegistrationSearch::find_along(const SceneContour& scene, const CentredPose& pose,
                                    const Eigen::Vector3d& body_twist, double reach, double step,
                                    double tolerance, const SearchWindow& window,
                                    const Eigen::Vector2d& origin, const Eigen::Vector2d& reference, int most,
                                    std::vector<SearchCandidate>& candidates) {
    candidates.clear();
    rated_.clear();
    const int steps = std::min(400, static_cast<int>(reach / step));
    for (int i = -steps; i <= steps; ++i) {
        const CentredPose p = moved_along(pose, body_twist, i * step);
        if (std::abs(p.phi) > 1.1 * window.phi_rad + 0.02) continue;
        if (!motion_box(window, origin, reference, p.phi).contains(p.dx, p.dz, step_)) continue;
        rated_.push_back({p, rate(scene, p, tolerance)});
    }
    for (std::size_t i = 0; i < rated_.size(); ++i) {
        if ((i > 0 && rated_[i - 1].score > rated_[i].score) ||
            (i + 1 < rated_.size() && rated_[i + 1].score >= rated_[i].score))
            continue;
        candidates.push_back(rated_[i]);
    }
    std::sort(candidates.begin(), candidates.end(),
              [](const SearchCandidate& a, const SearchCandidate& b) { return a.score > b.score; });
    if (static_cast<int>(candidates.size()) > most) candidates.resize(static_cast<std::size_t>(most));
}

}  // namespace seamwright
