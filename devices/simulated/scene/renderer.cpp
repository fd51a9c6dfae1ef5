#include "devices/simulated/scene/renderer.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>

#include "devices/simulated/scene/random.h"

namespace seamwright {
namespace {

constexpr double kStep_px = 0.35;
constexpr double kSkip_mm = 0.01;  // end of a shadow ray that may touch its own surface
constexpr int kBlock = 16;
constexpr double kBoardLight = 40;  // a lamp on the board, in units of the ambient light on everything else

// Standard normal numbers, to be read from a random place on.
constexpr std::size_t kNoiseSize = std::size_t{1} << 17;
const std::vector<float>& noise_table() {
    static const std::vector<float> table = [] {
        std::vector<float> t(kNoiseSize + 65536);  // the tail repeats the start, so that a row never wraps
        Random random(0x5EA3);
        for (std::size_t i = 0; i < kNoiseSize; ++i) t[i] = static_cast<float>(random.normal());
        for (std::size_t i = kNoiseSize; i < t.size(); ++i) t[i] = t[i - kNoiseSize];
        return t;
    }();
    return table;
}

// Quantiles of the exponential distribution, mean 1: intensity of fully developed speckle.
const std::array<float, 1024>& speckle_table() {
    static const std::array<float, 1024> table = [] {
        std::array<float, 1024> t{};
        double sum = 0;
        for (std::size_t i = 0; i < t.size(); ++i) {
            t[i] = static_cast<float>(
                -std::log(1.0 - (static_cast<double>(i) + 0.5) / static_cast<double>(t.size())));
            sum += t[i];
        }
        for (float& v : t) v = static_cast<float>(v * static_cast<double>(t.size()) / sum);
        return t;
    }();
    return table;
}

// Value noise in [0, 1]: random numbers on a lattice, smoothly interpolated.
double value_noise(const Eigen::Vector3d& p, std::uint64_t seed) {
    const Eigen::Vector3d base = p.array().floor();
    Eigen::Vector3d f = p - base;
    f = f.array() * f.array() * (3 - 2 * f.array());
    double sum = 0;
    for (int c = 0; c < 8; ++c) {
        std::uint64_t key = seed;
        double weight = 1;
        for (int k = 0; k < 3; ++k) {
            const int bit = (c >> k) & 1;
            key = hash64(key ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(base[k]) + bit));
            weight *= bit ? f[k] : 1 - f[k];
        }
        sum += weight * static_cast<double>(key >> 11) * 0x1.0p-53;
    }
    return sum;
}

}  // namespace

SensorModel sensor_model_of(const OpticsSettings& o) {
    const double theta = rad_from_deg(o.triangulation_deg);
    const double distance = o.stand_off_mm / std::cos(theta);
    SensorModel m;
    CameraModel& c = m.camera;
    c.fx = c.fy = o.width * distance / o.field_mm;
    c.cx = 0.5 * (o.width - 1) + 3.5;  // no lens sits exactly in the middle
    c.cy = 0.5 * (o.height - 1) - 2.25;
    c.k1 = o.k1;
    c.k2 = o.k2;
    c.p1 = o.p1;
    c.p2 = o.p2;
    c.k3 = o.k3;
    c.width = o.width;
    c.height = o.height;
    const Eigen::Vector3d eye(0, -o.stand_off_mm * std::tan(theta), o.stand_off_mm);
    Eigen::Matrix3d r;  // rows: the camera's axes in the sensor frame
    r.row(2) = -eye.normalized().transpose();
    r.row(0) = Eigen::Vector3d::UnitX().transpose();
    r.row(1) = r.row(2).cross(r.row(0));
    m.camera_from_laser = make_pose(r, -r * eye);
    return m;
}

StripeRenderer::StripeRenderer(const OpticsSettings& optics, const SurfaceSettings& surface,
                               const NoiseSettings& noise)
    : optics_(optics), surface_(surface), noise_(noise), model_(sensor_model_of(optics)) {
    laser_ = {0, 0, optics.stand_off_mm};
    camera_ = model_.camera_from_laser.inverse().translation();
    const double theta = rad_from_deg(optics.triangulation_deg);
    const double px_per_mm = model_.camera.fx / camera_.norm();
    const double thickness = optics.laser_width_mm / 2.3548 * std::cos(theta) * px_per_mm;
    sigma_u_ = optics.blur_px;
    sigma_v_ = std::hypot(optics.blur_px, thickness);
    stride_ = (static_cast<std::size_t>(optics.width) + kBlock - 1) / kBlock * kBlock;
    electrons_.assign(stride_ * static_cast<std::size_t>(optics.height), 0.0F);
    rows_drawn_.resize(stride_ / kBlock);
    ambient_.assign(electrons_.size(), 0.0F);
    for (int v = 0; v < optics.height; ++v) {  // vignetting: cos^4 of the field angle
        for (int u = 0; u < optics.width; ++u) {
            const double x = (u - model_.camera.cx) / model_.camera.fx,
                         y = (v - model_.camera.cy) / model_.camera.fy;
            const double c2 = 1 / (1 + x * x + y * y);
            ambient_[static_cast<std::size_t>(v) * stride_ + static_cast<std::size_t>(u)] =
                static_cast<float>(c2 * c2);
        }
    }
    if (surface.dark_share > 0) {  // the threshold that this share of the surface exceeds
        std::vector<double> values(20000);
        Random random(0xDA4C);
        for (double& v : values) {
            const Eigen::Vector3d p(random.uniform(0, 500), random.uniform(0, 500), random.uniform(0, 500));
            v = value_noise(p, 1);
        }
        const auto at = values.begin() + static_cast<std::ptrdiff_t>(static_cast<double>(values.size() - 1) *
                                                                     (1 - std::min(surface.dark_share, 1.0)));
        std::nth_element(values.begin(), at, values.end());
        dark_threshold_ = *at;
    }
}

std::size_t StripeRenderer::image_bytes() const {
    return static_cast<std::size_t>(optics_.width) * static_cast<std::size_t>(optics_.height) *
           (optics_.bit_depth > 8 ? 2 : 1);
}

double StripeRenderer::albedo_at(const Eigen::Vector3d& p, std::uint64_t seed) const {
    if (board_.columns > 0) {
        const double i = std::floor(p.x() / board_.pitch_mm + 0.5 * (board_.columns + 1));
        const double k = std::floor(p.y() / board_.pitch_mm + 0.5 * (board_.rows + 1));
        const bool on_board = i >= 0 && k >= 0 && i <= board_.columns && k <= board_.rows;
        if (on_board && (static_cast<long>(i + k) & 1) == 0) return board_.dark_albedo;
        return surface_.albedo;
    }
    if (!(surface_.dark_share > 0)) return surface_.albedo;
    const double over = (value_noise(p / surface_.dark_size_mm, hash64(seed)) - dark_threshold_) / 0.01;
    const double share = std::clamp(over + 0.5, 0.0, 1.0);
    return surface_.albedo + share * (surface_.dark_albedo - surface_.albedo);
}

void StripeRenderer::trace(const MeshTree& part, const Pose& part_from_sensor, double scale,
                           std::uint64_t surface_seed) {
    const Pose sensor_from_part = part_from_sensor.inverse();
    const Eigen::Vector3d plane = part_from_sensor.linear().col(1);
    const Eigen::Vector3d laser = part_from_sensor * laser_, camera = part_from_sensor * camera_;
    // Everything that the camera can see of the plane lies in this sphere; what it does not see is clipped
    // below.
    const double reach = 1.5 * optics_.stand_off_mm;
    part.cut(plane, plane.dot(part_from_sensor.translation()), part_from_sensor.translation(), reach,
             segments_);
    // Along x, so that neighbours follow each other and the order of the tree's leaves decides nothing.
    cuts_.clear();
    for (const CutSegment& s : segments_) {
        Cut c{sensor_from_part * s.a, sensor_from_part * s.b, s.triangle};
        if (c.a.x() > c.b.x()) std::swap(c.a, c.b);
        cuts_.push_back(c);
    }
    std::sort(cuts_.begin(), cuts_.end(), [](const Cut& a, const Cut& b) {
        return a.a.x() != b.a.x() ? a.a.x() < b.a.x() : a.triangle < b.triangle;
    });
    const double half_fan = std::tan(rad_from_deg(0.5 * optics_.fan_deg));
    const double margin = 8, w = optics_.width + margin, h = optics_.height + margin;
    const auto inside = [&](const Eigen::Vector2d& p) {
        return p.x() > -margin && p.x() < w && p.y() > -margin && p.y() < h;
    };
    int bounce = 0;
    std::optional<Eigen::Vector2d> last_ghost;
    for (const Cut& s : cuts_) {
        const Eigen::Vector3d &a = s.a, &b = s.b;
        const double clip = laser_.z() - 1;  // in front of laser and camera
        if (a.z() >= clip || b.z() >= clip) continue;
        const auto pa = model_.to_pixel({a.x(), a.z()}), pb = model_.to_pixel({b.x(), b.z()});
        if (!pa || !pb) continue;
        if (std::max(pa->x(), pb->x()) < -margin || std::min(pa->x(), pb->x()) > w ||
            std::max(pa->y(), pb->y()) < -margin || std::min(pa->y(), pb->y()) > h) {
            continue;
        }
        Eigen::Vector3d normal = sensor_from_part.linear() * part.normal(s.triangle);
        if (normal.dot(laser_ - a) < 0) normal = -normal;
        if (normal.isZero()) continue;
        const double length = (*pb - *pa).norm();
        const int n = std::clamp(static_cast<int>(std::ceil(length / kStep_px)), 1, 20000);
        const double step = length / n;
        for (int i = 0; i < n; ++i) {
            const Eigen::Vector3d p = a + (b - a) * ((i + 0.5) / n);
            if (std::abs(p.x()) > half_fan * (laser_.z() - p.z())) continue;
            const auto pixel = model_.to_pixel({p.x(), p.z()});
            if (!pixel || !inside(*pixel)) continue;
            const Eigen::Vector3d to_laser = (laser_ - p).normalized(),
                                  to_camera = (camera_ - p).normalized();
            const double incidence = normal.dot(to_laser);
            if (incidence < 1e-3) continue;
            const Eigen::Vector3d p_part = part_from_sensor * p;
            if (part.blocked(p_part, laser, s.triangle, kSkip_mm)) continue;
            const double light = scale * laser_.z() / (laser_ - p).norm();
            const Eigen::Vector3d mirrored = 2 * incidence * normal - to_laser;
            if (normal.dot(to_camera) > 1e-3 && !part.blocked(p_part, camera, s.triangle, kSkip_mm)) {
                const double shine = std::max(0.0, mirrored.dot(to_camera));
                const double e = light * (albedo_at(p_part, surface_seed) * incidence +
                                          surface_.gloss * std::pow(shine, surface_.shininess));
                samples_.push_back({static_cast<float>(pixel->x()), static_cast<float>(pixel->y()),
                                    static_cast<float>(p.x()), static_cast<float>(p.z()),
                                    static_cast<float>(e), static_cast<float>(step), false});
            }
            if (surface_.mirror <= 0 || ++bounce % 3 != 0) continue;
            const Eigen::Vector3d way = part_from_sensor.linear() * mirrored;
            const auto before = std::exchange(last_ghost, std::nullopt);
            const auto hit = part.first_hit(p_part, way, 0.5, 200, s.triangle);
            if (!hit) continue;
            const Eigen::Vector3d q_part = p_part + hit->distance_mm * way;
            Eigen::Vector3d second = sensor_from_part.linear() * part.normal(hit->triangle);
            if (second.dot(mirrored) > 0) second = -second;
            const Eigen::Vector3d q = sensor_from_part * q_part;
            if (second.dot(camera_ - q) <= 0 || part.blocked(q_part, camera, hit->triangle, kSkip_mm))
                continue;
            const Eigen::Vector2d ghost = model_.camera.project(model_.camera_from_laser * q);
            if (!ghost.allFinite() || !inside(ghost)) continue;
            last_ghost = ghost;
            // The light of three samples, spread from the last landing to this one where they are neighbours.
            const double e =
                light * surface_.mirror * albedo_at(q_part, surface_seed) * -second.dot(mirrored) * 3 * step;
            const double spread = before ? (ghost - *before).norm() : 1e9;
            const int spots =
                spread < 30 ? std::max(1, static_cast<int>(std::ceil(spread / (2 * kStep_px)))) : 1;
            for (int k = 0; k < spots; ++k) {
                const Eigen::Vector2d at =
                    spots > 1 ? Eigen::Vector2d(*before + (ghost - *before) * ((k + 1.0) / spots)) : ghost;
                const double stretch = std::max(spread < 30 ? spread / spots : 1.0, 0.05);
                samples_.push_back({static_cast<float>(at.x()), static_cast<float>(at.y()),
                                    static_cast<float>(p.x()), static_cast<float>(p.z()),
                                    static_cast<float>(e / spots / stretch), static_cast<float>(stretch),
                                    true});
            }
        }
    }
}

void StripeRenderer::add_strays(std::uint64_t seed) {
    Random random(seed, 2);
    if (random.uniform() >= noise_.stray_probability) return;
    const std::size_t real = samples_.size();
    const int count = 1 + static_cast<int>(random.uniform() * 3);
    for (int k = 0; k < count; ++k) {
        const double middle = random.uniform(0, optics_.width),
                     half = random.uniform(0.03, 0.15) * optics_.width;
        const double sign = random.uniform() < 0.5 ? -1 : 1;
        const double shift = sign * random.uniform(12, 0.12 * optics_.height),
                     tilt = random.uniform(-0.15, 0.15);
        const double strength = random.uniform(0.3, 2.0);
        for (std::size_t i = 0; i < real; ++i) {
            StripeSample s = samples_[i];
            const double along = s.u_px - middle;
            if (s.ghost || std::abs(along) > half) continue;
            s.v_px = static_cast<float>(s.v_px + shift + tilt * along);
            s.electrons = static_cast<float>(s.electrons * strength);
            s.ghost = true;
            samples_.push_back(s);
        }
    }
}

void StripeRenderer::draw() {
    const int ru = static_cast<int>(std::ceil(4 * sigma_u_)), rv = static_cast<int>(std::ceil(4 * sigma_v_));
    const double peak = 1 / (std::sqrt(2 * kPi) * sigma_u_);
    std::array<float, 64> wu, wv;
    if (2 * ru + 2 > static_cast<int>(wu.size()) || 2 * rv + 2 > static_cast<int>(wv.size())) return;
    for (StripeSample& s : samples_) {
        const int u0 = static_cast<int>(std::lround(s.u_px)), v0 = static_cast<int>(std::lround(s.v_px));
        const int first_u = std::max(0, u0 - ru), last_u = std::min(optics_.width - 1, u0 + ru);
        const int first_v = std::max(0, v0 - rv), last_v = std::min(optics_.height - 1, v0 + rv);
        if (first_u > last_u || first_v > last_v) continue;
        const double bright = s.electrons * s.length_px * peak;
        for (int u = first_u; u <= last_u; ++u) {
            const double d = (u - s.u_px) / sigma_u_;
            wu[static_cast<std::size_t>(u - first_u)] = static_cast<float>(bright * std::exp(-0.5 * d * d));
        }
        for (int v = first_v; v <= last_v; ++v) {
            const double d = (v - s.v_px) / sigma_v_;
            wv[static_cast<std::size_t>(v - first_v)] = static_cast<float>(std::exp(-0.5 * d * d));
        }
        for (int v = first_v; v <= last_v; ++v) {
            float* row = electrons_.data() + static_cast<std::size_t>(v) * stride_ + first_u;
            const float weight = wv[static_cast<std::size_t>(v - first_v)];
            for (int k = 0; k <= last_u - first_u; ++k) row[k] += weight * wu[static_cast<std::size_t>(k)];
        }
        for (int block = first_u / kBlock; block <= last_u / kBlock; ++block) {
            auto& [first, last] = rows_drawn_[static_cast<std::size_t>(block)];
            first = std::min(first, first_v);
            last = std::max(last, last_v);
        }
    }
}

void StripeRenderer::bloom_and_speckle(std::uint64_t seed) {
    const auto& speckle = speckle_table();
    const std::uint64_t key = hash64(seed, 3);
    const auto contrast = static_cast<float>(2 * noise_.speckle);
    const auto grain = [&](int u, int v) {
        const auto at =
            (static_cast<std::uint64_t>(static_cast<std::uint32_t>(v)) << 32) | static_cast<std::uint32_t>(u);
        return speckle[hash64(key ^ at) >> 54];
    };
    hot_.clear();
    constexpr auto kSpillFrom = static_cast<float>(1.5 * kFullWellElectrons);
    for (std::size_t block = 0; block < rows_drawn_.size(); ++block) {
        const int u0 = static_cast<int>(block) * kBlock;
        for (int v = rows_drawn_[block].first; v <= rows_drawn_[block].second; ++v) {
            float* row = electrons_.data() + static_cast<std::size_t>(v) * stride_ + u0;
            for (int k = 0; k < kBlock; ++k) {
                if (row[k] < 1) continue;
                if (contrast > 0) {
                    const int u = u0 + k;
                    const float mean =
                        0.25F * (grain(u, v) + grain(u + 1, v) + grain(u, v + 1) + grain(u + 1, v + 1));
                    row[k] *= 1 + contrast * (mean - 1);
                }
                if (row[k] > kSpillFrom)
                    hot_.push_back(static_cast<std::size_t>(row + k - electrons_.data()));
            }
        }
    }
    if (hot_.empty()) return;
    // Charge above the limit is drained, but a share runs out along the column, alike to both sides, and
    // fills what is not yet full.
    std::sort(hot_.begin(), hot_.end(), [&](std::size_t a, std::size_t b) {
        return a % stride_ != b % stride_ ? a % stride_ < b % stride_ : a < b;
    });
    const auto share = static_cast<float>(0.5 * optics_.blooming);
    for (std::size_t k = 0; k < hot_.size();) {
        const std::size_t top = hot_[k];
        std::size_t bottom = top;
        float excess = 0;
        for (; k < hot_.size() && hot_[k] - bottom <= stride_ && hot_[k] % stride_ == top % stride_; ++k) {
            bottom = hot_[k];
            excess += electrons_[bottom] - kSpillFrom;
            electrons_[bottom] = kSpillFrom;
        }
        float up = share * excess, down = up;
        for (std::size_t i = top; i >= stride_ && up > 0;) {
            i -= stride_;
            const float taken = std::min(up, std::max(0.0F, kSpillFrom - electrons_[i]));
            electrons_[i] += taken;
            up -= taken;
        }
        for (std::size_t i = bottom + stride_; i < electrons_.size() && down > 0; i += stride_) {
            const float taken = std::min(down, std::max(0.0F, kSpillFrom - electrons_[i]));
            electrons_[i] += taken;
            down -= taken;
        }
    }
}

void StripeRenderer::draw_board(const Pose& part_from_sensor, double electrons) {
    const auto pixels = static_cast<std::size_t>(optics_.width) * static_cast<std::size_t>(optics_.height);
    if (rays_.size() != pixels) {
        rays_.resize(pixels);
        for (int v = 0; v < optics_.height; ++v) {
            for (int u = 0; u < optics_.width; ++u) {
                rays_[static_cast<std::size_t>(v) * static_cast<std::size_t>(optics_.width) +
                      static_cast<std::size_t>(u)] =
                    model_.camera.undistort(Eigen::Vector2d(u, v)).cast<float>();
            }
        }
    }
    const Pose part_from_camera = part_from_sensor * model_.camera_from_laser.inverse();
    const Eigen::Vector3d eye = part_from_camera.translation();
    const Eigen::Matrix3d r = part_from_camera.linear();
    for (int v = 0; v < optics_.height; ++v) {
        for (int u = 0; u < optics_.width; ++u) {
            // Four rays a pixel soften the edges of the squares.
            float sum = 0;
            const auto& ray = rays_[static_cast<std::size_t>(v) * static_cast<std::size_t>(optics_.width) +
                                    static_cast<std::size_t>(u)];
            for (int k = 0; k < 4; ++k) {
                const double du = (k & 1 ? 0.25 : -0.25) / model_.camera.fx,
                             dv = (k & 2 ? 0.25 : -0.25) / model_.camera.fy;
                const Eigen::Vector3d d = r * Eigen::Vector3d(ray.x() + du, ray.y() + dv, 1);
                if (std::abs(d.z()) < 1e-9) continue;
                const double t = -eye.z() / d.z();
                const Eigen::Vector3d p = eye + t * d;
                const double half_x = board_.pitch_mm * (0.5 * board_.columns + 1.5),
                             half_y = board_.pitch_mm * (0.5 * board_.rows + 1.5);
                if (t <= 0 || std::abs(p.x()) > half_x || std::abs(p.y()) > half_y) continue;
                sum += static_cast<float>(albedo_at(p, 0));
            }
            const std::size_t at = static_cast<std::size_t>(v) * stride_ + static_cast<std::size_t>(u);
            electrons_[at] += 0.25F * sum * static_cast<float>(electrons) * ambient_[at];
        }
    }
}

void StripeRenderer::expose(const Exposure& exposure, std::span<std::byte> pixels) {
    const int full = (1 << optics_.bit_depth) - 1;
    const auto gain = static_cast<float>(std::pow(10.0, exposure.gain_db / 20) * full / kFullWellElectrons);
    const auto ambient = static_cast<float>(noise_.ambient_electrons_per_ms * exposure.exposure_us / 1000);
    const float shot = noise_.shot ? 1.0F : 0.0F;
    const auto read2 = static_cast<float>(noise_.read_electrons * noise_.read_electrons);
    const float offset = 0.01F * static_cast<float>(full) + 0.5F;  // black level, and rounding
    const auto top = static_cast<float>(full) + 0.5F;
    const auto& table = noise_table();
    Random random(exposure.seed, 4);
    alignas(64) std::array<float, kBlock> value;
    for (int v = 0; v < optics_.height; ++v) {
        const float* e = electrons_.data() + static_cast<std::size_t>(v) * stride_;
        const float* b = ambient_.data() + static_cast<std::size_t>(v) * stride_;
        const float* n = table.data() + random.bits() % kNoiseSize;
        const std::size_t line = static_cast<std::size_t>(v) * static_cast<std::size_t>(optics_.width);
        for (std::size_t u = 0; u < stride_; u += kBlock) {
            for (std::size_t k = 0; k < kBlock; ++k) {
                const float signal = e[u + k] + ambient * b[u + k];
                const float noisy = signal + std::sqrt(shot * signal + read2) * n[u + k];
                value[k] = std::min(std::max(noisy * gain + offset, 0.0F), top);
            }
            const std::size_t count =
                std::min<std::size_t>(kBlock, static_cast<std::size_t>(optics_.width) - u);
            if (optics_.bit_depth == 8) {
                std::array<std::uint8_t, kBlock> grey;
                for (std::size_t k = 0; k < kBlock; ++k)
                    grey[k] = static_cast<std::uint8_t>(static_cast<int>(value[k]));
                std::copy_n(reinterpret_cast<const std::byte*>(grey.data()), count, pixels.data() + line + u);
            } else {
                std::array<std::uint16_t, kBlock> grey;
                for (std::size_t k = 0; k < kBlock; ++k)
                    grey[k] = static_cast<std::uint16_t>(static_cast<int>(value[k]));
                std::copy_n(reinterpret_cast<const std::byte*>(grey.data()), 2 * count,
                            pixels.data() + 2 * (line + u));
            }
        }
    }
}

void StripeRenderer::render(const MeshTree& part, const Pose& part_from_sensor, const Exposure& exposure,
                            std::uint64_t surface_seed, std::span<std::byte> pixels,
                            std::vector<StripeSample>* truth, const PlatePattern& board) {
    assert(pixels.size() == image_bytes());
    board_ = board;
    samples_.clear();
    std::fill(rows_drawn_.begin(), rows_drawn_.end(), std::pair(optics_.height, -1));
    std::fill(electrons_.begin(), electrons_.end(), 0.0F);
    if (exposure.laser_on) {
        trace(part, part_from_sensor, kBrightElectronsPerMs * exposure.exposure_us / 1000, surface_seed);
        add_strays(exposure.seed);
    }
    draw();
    bloom_and_speckle(exposure.seed);
    if (board_.columns > 0) {
        draw_board(part_from_sensor,
                   kBoardLight * noise_.ambient_electrons_per_ms * exposure.exposure_us / 1000);
    }
    expose(exposure, pixels);
    if (truth) *truth = samples_;
}

}  // namespace seamwright
