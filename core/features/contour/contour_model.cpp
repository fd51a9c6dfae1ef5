#include "core/features/contour/contour_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/features/contour/contour_noise.h"
#include "core/features/contour/face_order.h"

namespace seamwright {
namespace {

// Below a tenth of a micrometre nothing measured is meant: it stands for drawn (noise-free) contours and
// rounding.
constexpr double kSmallestSigma_mm = 1e-4;
constexpr int kNodesPerEdge = 64;
// Sigmas of the next order's coefficient that a window may show.
constexpr double kAlike = 1.05;
constexpr double kLineBend = 1.2, kParabolaBend = 2.2;

// Sums over the point numbers of a window of m equally numbered points, counted from its middle:
// s2 = sum xi^2, s4 = sum (xi^2 - mean2)^2 and s6 = sum (xi^3 - slope3 xi)^2 (the orthogonal parabola and
// cubic).
struct WindowSums {
    double s2, s4, s6, mean2, slope3;
    explicit WindowSums(int m)
        : s2(m * (double(m) * m - 1) / 12.0),
          s4(m * (double(m) * m - 1) * (double(m) * m - 4) / 180.0),
          s6(m * (double(m) * m - 1) * (double(m) * m - 4) * (double(m) * m - 9) / 2800.0),
          mean2((double(m) * m - 1) / 12.0),
          slope3((3 * double(m) * m - 7) / 20.0) {}
};

}  // namespace

void ContourModel::build(const Profile& profile, double shared, double sigma_mm) {
    x_.clear();
    z_.clear();
    edges_.clear();
    const bool marked = profile.filtered();
    for (std::size_t i = 0; i < profile.size() && i < profile.z_mm.size(); ++i) {
        const double x = profile.x_mm[i], z = profile.z_mm[i];
        if (!std::isfinite(x) || !std::isfinite(z) || (marked && profile.segment[i] == kOutlier)) continue;
        if (!x_.empty() && x == x_.back() && z == z_.back()) continue;
        x_.push_back(x);
        z_.push_back(z);
    }
    const std::size_t all = x_.size();
    if (all < 5) return;
    origin_ = {std::accumulate(x_.begin(), x_.end(), 0.0) / double(all),
               std::accumulate(z_.begin(), z_.end(), 0.0) / double(all)};
    for (double& v : x_) v -= origin_.x();
    for (double& v : z_) v -= origin_.y();
    const auto [x0, x1] = std::minmax_element(x_.begin(), x_.end());
    const auto [z0, z1] = std::minmax_element(z_.begin(), z_.end());
    lower_ = {*x0, *z0};
    upper_ = {*x1, *z1};
    extent_ = (upper_ - lower_).norm();
    if (!(extent_ > 0) || !std::isfinite(extent_)) return;
    pitch_ = contour_pitch(x_, z_, scratch_);
    if (order_faces(pitch_, x_, z_)) pitch_ = contour_pitch(x_, z_, scratch_);
    if (!(pitch_.distance > 0)) return;
    const ProfileNoise noise = profile_noise(x_, z_, scratch_);
    sigma_ = std::max(noise.point_mm, kSmallestSigma_mm);
    pitch_.shared = shared > 0 ? shared : noise.apart();
    if (pitch_.alike() > 1) sigma_ = std::max({sigma_, noise.alone_mm, sigma_mm});

    // Points within a step are no part of the contour.
    const std::vector<double> all_x = x_, all_z = z_;
    x_.clear();
    z_.clear();
    for (std::size_t i = 0; i < all_x.size();) {
        if (const int many = pitch_.mixed(all_x, all_z, i, sigma_); many > 0) {
            i += static_cast<std::size_t>(many);
            continue;
        }
        x_.push_back(all_x[i]);
        z_.push_back(all_z[i++]);
    }
    const std::size_t n = x_.size();
    if (n < 5) return;
    link_.assign(n, 0);
    run_first_.assign(n, 0);
    run_last_.assign(n, 0);
    const double highest_wall = std::max(20.0, 5 * pitch_.distance);
    for (std::size_t i = 0; i + 1 < n; ++i) {
        const double dx = x_[i + 1] - x_[i], dz = z_[i + 1] - z_[i];
        if (pitch_.is_gap(dx, dz)) continue;
        const bool wall = pitch_.is_wall(dx, dz) || pitch_.is_step(x_, z_, i, sigma_);
        link_[i] = !wall ? 1 : std::hypot(dx, dz) <= highest_wall ? 2 : 0;
    }
    for (std::size_t i = 0, first = 0; i < n; ++i)
        if (link_[i] != 1) {
            for (std::size_t j = first; j <= i; ++j) {
                run_first_[j] = static_cast<int>(first);
                run_last_[j] = static_cast<int>(i);
            }
            first = i + 1;
        }

    sums_.assign(n + 1, {});
    const double middle = 0.5 * double(n);
    for (std::size_t i = 0; i < n; ++i) {
        const double k = double(i) - middle, x = x_[i], z = z_[i];
        const std::array<double, 11> term{x,     z,     k * x, k * z,         k * k * x,    k * k * z,
                                          x * x, x * z, z * z, k * k * k * x, k * k * k * z};
        for (int j = 0; j < 11; ++j) sums_[i + 1][j] = sums_[i][j] + term[j];
    }
    // Differences of neighbours are less than the noise where it is alike in neighbours (interpolation, smoothing): what the
    // fits leave then says how much shape it hides.
    const double of_neighbours = sigma_;
    fit_edges();
    if (sigma_ > kAlike * of_neighbours) {
        edges_.clear();
        fit_edges();
    }
    if (usable()) build_nodes();
}

ContourModel::Window ContourModel::window(int first, int count) const {
    const WindowSums w(count);
    std::array<double, 11> s;
    for (int j = 0; j < 11; ++j) s[j] = sums_[first + count][j] - sums_[first][j];
    Window r;
    r.first = first;
    r.count = count;
    r.centre = first + 0.5 * (count - 1);
    const double c = r.centre - 0.5 * double(x_.size());
    Eigen::Vector2d m0(s[0], s[1]), m1(s[2], s[3]), m2(s[4], s[5]), m3(s[9], s[10]);
    m3 += -3 * c * m2 + 3 * c * c * m1 - c * c * c * m0;
    m2 += -2 * c * m1 + c * c * m0;
    m1 -= c * m0;
    m3 -= w.slope3 * m1;
    m2 -= w.mean2 * m0;
    r.b0 = m0 / count;
    r.b1 = m1 / w.s2;
    r.b2 = count > 2 ? Eigen::Vector2d(m2 / w.s4) : Eigen::Vector2d(0, 0);
    r.b3 = count > 3 ? Eigen::Vector2d(m3 / w.s6) : Eigen::Vector2d(0, 0);
    r.xx = s[6];
    r.xz = s[7];
    r.zz = s[8];
    return r;
}

bool ContourModel::fit_window(int point, const Window& window, int degree, Edge& edge, double& residual2,
                              double& bend) const {
    const WindowSums w(window.count);
    const double xi = point + 0.5 - window.centre;
    Eigen::Vector2d position = window.b0 + window.b1 * xi, slope = window.b1;
    if (degree == 2) {
        position += window.b2 * (xi * xi - w.mean2);
        slope += 2 * xi * window.b2;
    }
    const double speed = slope.norm();
    if (!(speed > 1e-12)) return false;
    const Eigen::Vector2d t = slope / speed, n(-t.y(), t.x());
    const auto across = [&](const Eigen::Vector2d& v) { return n.dot(v) * n.dot(v); };
    residual2 = n.x() * n.x() * window.xx + 2 * n.x() * n.y() * window.xz + n.y() * n.y() * window.zz -
                window.count * across(window.b0) - w.s2 * across(window.b1);
    edge.curvature = 0;
    if (degree == 2) {
        residual2 -= w.s4 * across(window.b2);
        edge.curvature = 2 * n.dot(window.b2) / (speed * speed);
        bend = std::sqrt(across(window.b3) * w.s6);
    } else {
        bend = std::sqrt(across(window.b2) * w.s4);
    }
    residual2 = std::max(residual2, 0.0);
    edge.cx = position.x();
    edge.cz = position.y();
    edge.tx = t.x();
    edge.tz = t.y();
    edge.half = 0.5 * speed;
    edge.index_mm = 1 / speed;
    edge.xi = xi;
    edge.centre = window.centre;
    edge.first = window.first;
    edge.count = window.count;
    edge.degree = degree;
    return true;
}

// A line over the point number is the same line however its points are spaced, but not a stretch of it: where one head's points
// give way to another's, or returns are missing, the fit would have it up to several spacings from its own two points.
void ContourModel::put_at_points(Edge& edge) const {
    constexpr double kAside = 0.5,
                     kNoise = 3;  // spacings, sigma: less is the fit's smoothing of noise along the contour
    const auto k = static_cast<std::size_t>(edge.point);
    const Eigen::Vector2d t(edge.tx, edge.tz), n(-t.y(), t.x()), p(x_[k], z_[k]), q(x_[k + 1], z_[k + 1]);
    const double aside = t.dot(0.5 * (p + q) - Eigen::Vector2d(edge.cx, edge.cz));
    if (std::abs(aside) < kAside * pitch_.distance + kNoise * sigma_) return;
    const Eigen::Vector2d shift = aside * t + 0.5 * edge.curvature * aside * aside * n;
    const Eigen::Vector2d turned = (t + edge.curvature * aside * n).normalized();
    edge.cx += shift.x();
    edge.cz += shift.y();
    edge.tx = turned.x();
    edge.tz = turned.y();
    if (const double half = 0.5 * turned.dot(q - p); half > 0) edge.half = half;
}

void ContourModel::fit_edges() {
    const int n = static_cast<int>(x_.size());
    length_ = 0;
    int run = 0;
    double pooled = 0, freedom = 0;
    const double variance = sigma_ * sigma_;
    for (int k = 0; k + 1 < n; ++k) {
        if (link_[k] == 0) {
            ++run;
            continue;
        }
        Edge best{};
        double residual2 = 0, bend = 0;
        if (!fit_window(k, window(k, 2), 1, best, residual2, bend)) continue;
        if (link_[k] == 1) {
            double best_variance = weights(best, 0).value_variance;
            double best_residual2 = 0;
            const int first_allowed = run_first_[k], last_allowed = run_last_[k];
            int refused = 0;
            for (int count = 4; count <= 64 && count <= last_allowed - first_allowed + 1; count *= 2) {
                bool accepted = false;
                const int centred = std::clamp(k - count / 2 + 1, first_allowed, last_allowed - count + 1);
                const int places[3] = {centred, k + 2 - count, k};
                for (int place = 0; place < 3; ++place) {
                    const int first = places[place];
                    if (first < first_allowed || first + count - 1 > last_allowed) continue;
                    if (place > 0 && first == centred) continue;
                    bool here = false, parabola = false, straight = false;
                    Edge bent{};
                    double bent_residual2 = 0;
                    const Window moments = window(first, count);
                    for (int degree = 2; degree >= 1; --degree) {
                        Edge edge{};
                        if (!fit_window(k, moments, degree, edge, residual2, bend)) continue;
                        const double dof = count - degree - 1;
                        if (residual2 > variance * (dof + 2.5 * std::sqrt(2 * dof))) break;
                        // The next order must not be seen above the noise: it is what would bend the fit. A
                        // line, where it does, has four ninths of the parabola's variance.
                        if (bend >
                            (degree == 1 ? kLineBend : kParabolaBend) * sigma_ * std::sqrt(pitch_.alike()))
                            continue;
                        here = true;
                        (degree == 2 ? parabola : straight) = true;
                        if (degree == 2) bent = edge, bent_residual2 = residual2;
                        const double v = weights(edge, 0).value_variance;
                        if (v < best_variance) {
                            best_variance = v;
                            best_residual2 = residual2;
                            best = edge;
                        }
                    }
                    // Seen over the larger window the contour is bent, so a line over a smaller one is a chord, all of
                    // a rounding's to the same side of it.
                    if (place == 0 && parabola && !straight && best.degree == 1 && best.count >= 4) {
                        best = bent;
                        best_variance = weights(bent, 0).value_variance;
                        best_residual2 = bent_residual2;
                    }
                    accepted = accepted || here;
                    if (here && place == 0) break;  // one-sided windows are for corners and ends
                }
                // Noise alone refuses a window now and then: two in a row mean shape.
                refused = accepted ? 0 : refused + 1;
                if (refused >= 2) break;
            }
            if (best.count > 4) {
                pooled += best_residual2;
                freedom += best.count - best.degree - 1;
            }
        }
        best.point = k;
        put_at_points(best);
        best.wall = link_[k] == 2;
        best.run = run;
        best.previous = best.next = -1;
        const int number = static_cast<int>(edges_.size());
        if (number > 0 && edges_.back().run == run) {
            best.previous = number - 1;
            edges_.back().next = number;
        }
        edges_.push_back(best);
        if (!best.wall) length_ += 2 * best.half;
    }
    if (freedom > 20) sigma_ = std::max(kSmallestSigma_mm, std::sqrt(pooled / freedom));
}

ContourModel::Weights ContourModel::weights(const Edge& edge, double u) const {
    const WindowSums w(edge.count);
    const double xi = edge.xi + u * edge.index_mm;
    Weights r;
    r.a0 = 1.0 / edge.count;
    r.a1 = xi / w.s2;
    r.a2 = 0;
    r.value_variance = 1.0 / edge.count + xi * xi / w.s2;
    r.slope_variance = 1 / w.s2;
    if (edge.degree == 2) {
        const double q = xi * xi - w.mean2;
        r.a2 = q / w.s4;
        r.a0 -= w.mean2 * r.a2;
        r.value_variance += q * q / w.s4;
        r.slope_variance += 4 * xi * xi / w.s4;
    }
    r.slope_variance *= edge.index_mm * edge.index_mm;
    return r;
}

void ContourModel::build_nodes() {
    along_z_ = (upper_ - lower_).y() > 2 * (upper_ - lower_).x();
    std::vector<std::array<double, 3>> nodes;
    nodes.reserve(edges_.size() * 2);
    node_reach_ = 0;
    for (std::size_t e = 0; e < edges_.size(); ++e) {
        const Edge& edge = edges_[e];
        const int parts = std::clamp(static_cast<int>(std::ceil(2 * edge.half / (1.5 * pitch_.distance))), 1,
                                     kNodesPerEdge);
        const double half = edge.half / parts;
        node_reach_ = std::max(node_reach_, half);
        for (int i = 0; i < parts; ++i) {
            const double u = -edge.half + (2 * i + 1) * half;
            const double x = edge.cx + u * edge.tx, z = edge.cz + u * edge.tz;
            nodes.push_back({along_z_ ? z : x, along_z_ ? x : z, double(e)});
        }
    }
    auto before = [](const auto& a, const auto& b) { return a[0] < b[0]; };
    if (!std::is_sorted(nodes.begin(), nodes.end(), before)) std::sort(nodes.begin(), nodes.end(), before);
    const std::size_t n = nodes.size();
    node_a_.resize(n);
    node_b_.resize(n);
    node_edge_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        node_a_[i] = nodes[i][0];
        node_b_[i] = nodes[i][1];
        node_edge_[i] = static_cast<int>(nodes[i][2]);
    }
    const double span = node_a_.back() - node_a_.front();
    bin_origin_ = node_a_.front();
    bins_per_mm_ = span > 0 ? double(n) / span : 0;
    bin_.assign(n + 1, 0);
    std::size_t i = 0;
    for (std::size_t b = 0; b <= n; ++b) {
        while (i < n && (node_a_[i] - bin_origin_) * bins_per_mm_ < double(b)) ++i;
        bin_[b] = static_cast<int>(i);
    }
}

ContourModel::Foot ContourModel::nearest(double px, double pz, double radius) const {
    const double a = along_z_ ? pz : px, b = along_z_ ? px : pz;
    const int n = static_cast<int>(node_a_.size());
    const double reach = radius + node_reach_;
    double best = reach * reach;
    int found = -1;
    const double place = (a - bin_origin_) * bins_per_mm_;
    const int start = bin_[place <= 0 ? 0 : place >= double(n) ? n : static_cast<int>(place)];
    for (int i = start; i < n; ++i) {
        const double da = node_a_[i] - a;
        if (da > 0 && da * da >= best) break;
        const double db = node_b_[i] - b, d2 = da * da + db * db;
        if (d2 < best) {
            best = d2;
            found = i;
        }
    }
    for (int i = start - 1; i >= 0; --i) {
        const double da = a - node_a_[i];
        if (da > 0 && da * da >= best) break;
        const double db = node_b_[i] - b, d2 = da * da + db * db;
        if (d2 < best) {
            best = d2;
            found = i;
        }
    }
    Foot foot;
    if (found < 0) return foot;
    // The nearest node's edge or one of its neighbours holds the foot.
    double nearest2 = radius * radius;
    bool past_end = false;
    const int middle = node_edge_[found];
    const int candidates[3] = {middle, edges_[middle].previous, edges_[middle].next};
    for (const int e : candidates) {
        if (e < 0) continue;
        const Edge& edge = edges_[e];
        const double dx = px - edge.cx, dz = pz - edge.cz;
        const double u = dx * edge.tx + dz * edge.tz, v = dz * edge.tx - dx * edge.tz;
        const double beyond = std::abs(u) - edge.half;
        // An end of the contour: half a pitch more, since the surface ends somewhere before the next missing
        // point.
        if (beyond > 0.5 * pitch_.distance && (u > 0 ? edge.next : edge.previous) < 0) {
            past_end = true;
            continue;
        }
        const double residual = v - 0.5 * edge.curvature * u * u;
        const double out = std::max(beyond, 0.0);
        const double d2 = out * out + residual * residual;
        if (d2 < nearest2) {
            nearest2 = d2;
            foot.edge = e;
            foot.u = u;
            foot.residual = residual;
            foot.beyond = out;
        }
    }
    // Past the contour's own end, where more of the surface may follow, the way across the end drawn out is all.
    if (past_end) foot.beyond = 0;
    return foot;
}

}  // namespace seamwright
