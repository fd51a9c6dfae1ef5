#include "core/profile/sensor_model.h"

#include <cassert>
#include <cmath>
#include <limits>

namespace seamwright {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr int kFixedPointSteps = 3;
constexpr int kNewtonSteps = 20;
constexpr double kConverged = 1e-13;  // normalised; 1e-10 px at a focal length of 1000 px

constexpr double kTowardsAxis = 0.7;  // of the radius: a start beyond the fold comes nearer
constexpr double kLeastStep = 1e-6;   // of Newton's step
constexpr double kFound = 1e-12;      // of 1 and the pixel's normalised coordinates
constexpr double kAlongPlane = 1e-9;  // sine: a ray that does not meet the laser plane

const Eigen::Vector2d kNowhere(kNaN, kNaN);

// d(r_distorted)/dr of the radial part as a polynomial of s = r^2.
double radial_slope(const CameraModel& c, double s) {
    return 1 + s * (3 * c.k1 + s * (5 * c.k2 + s * 7 * c.k3));
}

// Whether the radial part rises all the way from the axis to r^2 = s: the slope is positive at s and at its
// own extrema below s.
bool before_fold(const CameraModel& c, double s) {
    if (!(radial_slope(c, s) > 0)) return false;
    const double a = 21 * c.k3, b = 10 * c.k2, d = 3 * c.k1;  // of the slope's derivative a s^2 + b s + d
    const auto rises = [&](double at) { return !(at > 0 && at < s) || radial_slope(c, at) > 0; };
    if (a == 0) return b == 0 || rises(-d / b);
    const double discriminant = b * b - 4 * a * d;
    if (discriminant < 0) return true;
    const double root = std::sqrt(discriminant);
    return rises((-b - root) / (2 * a)) && rises((-b + root) / (2 * a));
}

bool has_distortion(const CameraModel& c) {
    return c.k1 != 0 || c.k2 != 0 || c.k3 != 0 || c.p1 != 0 || c.p2 != 0;
}

struct Distorted {
    double x, y, xx, xy, yy;  // value and symmetric Jacobian
};

Distorted distort(const CameraModel& c, double x, double y) {
    const double s = x * x + y * y;
    const double radial = 1 + s * (c.k1 + s * (c.k2 + s * c.k3));
    const double slope = 2 * (c.k1 + s * (2 * c.k2 + s * 3 * c.k3));  // d radial/ds * 2
    return {x * radial + 2 * c.p1 * x * y + c.p2 * (s + 2 * x * x),
            y * radial + c.p1 * (s + 2 * y * y) + 2 * c.p2 * x * y,
            radial + x * x * slope + 2 * c.p1 * y + 6 * c.p2 * x, x * y * slope + 2 * c.p1 * x + 2 * c.p2 * y,
            radial + y * y * slope + 6 * c.p1 * y + 2 * c.p2 * x};
}

}  // namespace

Eigen::Vector2d CameraModel::project(const Eigen::Vector3d& point) const {
    if (!(point.z() > 0)) return kNowhere;
    const double x = point.x() / point.z(), y = point.y() / point.z();
    if (!has_distortion(*this)) return {fx * x + cx, fy * y + cy};
    if (!before_fold(*this, x * x + y * y)) return kNowhere;
    const Distorted d = distort(*this, x, y);
    return {fx * d.x + cx, fy * d.y + cy};
}

Eigen::Vector2d CameraModel::undistort(const Eigen::Vector2d& pixel) const {
    const double u = (pixel.x() - cx) / fx, v = (pixel.y() - cy) / fy;
    if (!std::isfinite(u) || !std::isfinite(v)) return kNowhere;
    if (!has_distortion(*this)) return {u, v};
    double x = u, y = v;
    for (int i = 0; i < kFixedPointSteps; ++i) {
        const double s = x * x + y * y;
        const double radial = 1 + s * (k1 + s * (k2 + s * k3));
        const double dx = 2 * p1 * x * y + p2 * (s + 2 * x * x), dy = p1 * (s + 2 * y * y) + 2 * p2 * x * y;
        const double nx = (u - dx) / radial, ny = (v - dy) / radial;
        // Near the fold the iteration leaves the lens; Newton then starts from the last point inside.
        if (!(radial > 0) || !before_fold(*this, nx * nx + ny * ny)) break;
        x = nx;
        y = ny;
    }
    while (!before_fold(*this, x * x + y * y)) {
        x *= kTowardsAxis;
        y *= kTowardsAxis;
    }
    Distorted d = distort(*this, x, y);
    double miss = std::hypot(d.x - u, d.y - v);
    for (int i = 0; i < kNewtonSteps && miss > kConverged; ++i) {
        const double det = d.xx * d.yy - d.xy * d.xy;
        if (!(det > 0)) return kNowhere;
        const double sx = (d.yy * (u - d.x) - d.xy * (v - d.y)) / det,
                     sy = (d.xx * (v - d.y) - d.xy * (u - d.x)) / det;
        bool better = false;
        for (double share = 1; share > kLeastStep; share *= 0.5) {
            const double nx = x + share * sx, ny = y + share * sy;
            if (!before_fold(*this, nx * nx + ny * ny)) continue;
            const Distorted tried = distort(*this, nx, ny);
            const double tried_miss = std::hypot(tried.x - u, tried.y - v);
            if (tried_miss >= miss) continue;
            x = nx;
            y = ny;
            d = tried;
            miss = tried_miss;
            better = true;
            break;
        }
        if (!better) break;
    }
    const double scale = 1 + std::abs(u) + std::abs(v);
    return miss <= kFound * scale ? Eigen::Vector2d(x, y) : kNowhere;
}

std::optional<Eigen::Vector2d> LookupTable::at(const Eigen::Vector2d& pixel) const {
    const auto nodes =
        static_cast<std::size_t>(columns > 0 ? columns : 0) * static_cast<std::size_t>(rows > 0 ? rows : 0);
    if (columns < 2 || rows < 2 || x_mm.size() != nodes || z_mm.size() != nodes) return std::nullopt;
    const double fu = (pixel.x() - u0) / step_u, fv = (pixel.y() - v0) / step_v;
    if (!(fu >= 0 && fu <= columns - 1 && fv >= 0 && fv <= rows - 1)) return std::nullopt;
    const int i = std::min(static_cast<int>(fu), columns - 2), j = std::min(static_cast<int>(fv), rows - 2);
    const double a = fu - i, b = fv - j;
    const auto n =
        static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(i);
    const auto m = n + static_cast<std::size_t>(columns);
    const auto between = [&](const std::vector<double>& t) {
        return (1 - b) * ((1 - a) * t[n] + a * t[n + 1]) + b * ((1 - a) * t[m] + a * t[m + 1]);
    };
    const Eigen::Vector2d xz(between(x_mm), between(z_mm));
    // NaN corners spread through the sum, also with weight 0.
    if (!xz.allFinite()) return std::nullopt;
    return xz;
}

std::optional<Eigen::Vector2d> SensorModel::to_laser(const Eigen::Vector2d& pixel) const {
    if (table) return table->at(pixel);
    const Eigen::Vector2d ray = camera.undistort(pixel);
    if (!ray.allFinite()) return std::nullopt;
    const Eigen::Vector3d direction(ray.x(), ray.y(), 1.0);
    const Eigen::Matrix3d rotation = camera_from_laser.linear();
    const Eigen::Vector3d origin = camera_from_laser.translation();
    const Eigen::Vector3d normal = rotation.col(1);
    const double along = normal.dot(direction);
    if (!(std::abs(along) > kAlongPlane * direction.norm())) return std::nullopt;
    const double depth = normal.dot(origin) / along;
    if (!(depth > 0)) return std::nullopt;
    const Eigen::Vector3d from_origin = depth * direction - origin;
    const Eigen::Vector2d xz(rotation.col(0).dot(from_origin), rotation.col(2).dot(from_origin));
    if (!xz.allFinite()) return std::nullopt;
    return xz;
}

std::optional<Eigen::Vector2d> SensorModel::to_pixel(const Eigen::Vector2d& xz_mm) const {
    const Eigen::Vector2d pixel =
        camera.project(camera_from_laser * Eigen::Vector3d(xz_mm.x(), 0, xz_mm.y()));
    if (!pixel.allFinite()) return std::nullopt;
    return pixel;
}

LookupTable tabulate(const SensorModel& model, double step_px) {
    assert(step_px > 0);
    SensorModel camera_form = model;
    camera_form.table.reset();
    LookupTable table;
    table.step_u = table.step_v = step_px;
    table.columns = static_cast<int>(std::ceil(std::max(0, model.camera.width - 1) / step_px)) + 1;
    table.rows = static_cast<int>(std::ceil(std::max(0, model.camera.height - 1) / step_px)) + 1;
    const auto nodes = static_cast<std::size_t>(table.columns) * static_cast<std::size_t>(table.rows);
    table.x_mm.reserve(nodes);
    table.z_mm.reserve(nodes);
    for (int j = 0; j < table.rows; ++j) {
        for (int i = 0; i < table.columns; ++i) {
            const auto xz = camera_form.to_laser({i * step_px, j * step_px});
            table.x_mm.push_back(xz ? xz->x() : kNaN);
            table.z_mm.push_back(xz ? xz->y() : kNaN);
        }
    }
    return table;
}

void to_millimetres(const StripePeaks& peaks, const SensorModel& model, ProfileCandidates& candidates) {
    candidates.lines = peaks.lines;
    candidates.per_line = peaks.per_line;
    const auto lines = static_cast<std::size_t>(peaks.lines),
               slots = lines * static_cast<std::size_t>(peaks.per_line);
    candidates.count.assign(lines, 0);
    candidates.x_mm.resize(slots);
    candidates.z_mm.resize(slots);
    candidates.intensity.resize(slots);
    for (int line = 0; line < peaks.lines; ++line) {
        int kept = 0;
        for (int k = 0; k < peaks.count[line]; ++k) {
            const int from = peaks.index(line, k);
            if (!peaks.flags.empty() && (peaks.flags[from] & StripePeaks::kTruncated)) continue;
            const auto xz = model.to_laser(pixel_of(peaks.scan, line, peaks.position_px[from]));
            if (!xz) continue;
            const int to = candidates.index(line, kept++);
            candidates.x_mm[to] = xz->x();
            candidates.z_mm[to] = xz->y();
            candidates.intensity[to] = peaks.intensity[from];
        }
        candidates.count[line] = static_cast<std::uint8_t>(kept);
    }
}

}  // namespace seamwright
