#include "core/calibration/sphere/tcp_sphere_solve.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "core/calibration/statistics.h"
#include "core/geometry/decompositions.h"

namespace seamwright::tcp_sphere {
namespace {

// A floor under scales and pivots, relative to a unit diagonal: directions without any information stay still.
constexpr double kFloor = 1e-12;
constexpr double kDisagreementTold = 0.99;  // of chi squared: the poses are worse than the profiles
// A section agrees with a solution that misses its points by no more than this.
constexpr double kAgrees_mm = 0.2;
// Starts in one basin: of the coarse search, and once they have been settled.
constexpr double kSameBasin_rad = 0.05, kSameBasin_mm = 10, kSameMinimum_rad = 0.02, kSameMinimum_mm = 5;
// A free radius is looked for from the largest cut on.
constexpr std::array<double, 3> kRadiusStarts{1.01, 1.15, 1.5};
// Scales of the loss, in millimetre squared: wide while a start is coarse, narrow when what does not belong is to go.
constexpr std::array<double, 3> kSettlingScales{10.0, 3.0, 1.0};
constexpr std::array<double, 2> kSubsetScales{1.0, 0.3};
constexpr double kReweight_mm = 0.1;      // residuals below this count alike in a start
constexpr double kStartRidge = 1e-9;      // on the unit diagonal of a start's normal equations
constexpr double kCoarseScale_mm = 10.0;  // of the loss, where every direction is tried
constexpr std::size_t kCoarseKept = 24;
// Levenberg and Marquardt on the statistics (of a start), and on the points; kFailedDamping: the least after a step that
// was none.
constexpr double kDampingDown = 0.1;
constexpr double kReducedDamping = 1e-4, kReducedDampingUp = 8, kLeastReducedDamping = 1e-10;
constexpr double kGainSettled = 1e-9, kExact_mm2 = 1e-18;  // relative gain, and cost, that end it
constexpr double kPointsDamping = 1e-7, kPointsDampingUp = 10, kFailedDamping = 1e-8;
constexpr double kStepSettled = 1e-11;  // mm and rad, of the largest entry

void update_statistics(Section& section) {
    const double a = section.circle.x_mm, b = section.circle.z_mm, rho = section.circle.radius_mm;
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    double squares = 0;
    for (size_t i = 0; i < section.x.size(); ++i) {
        const double dx = section.x[i] - a, dz = section.z[i] - b;
        const Eigen::Vector3d g(-2 * dx, -2 * dz, 1);
        const double nu = dx * dx + dz * dz - rho * rho;
        normal.noalias() += g * g.transpose();
        right += g * nu;
        squares += nu * nu;
    }
    const double scale = 1 / (4 * rho * rho);
    normal.diagonal() *= 1 + kFloor;
    const Eigen::LLT<Eigen::Matrix3d> llt(normal);
    section.best = -llt.solve(right);
    section.own_squares = std::max(0.0, (squares + right.dot(section.best)) * scale);
    section.root = llt.matrixU();
    section.root *= std::sqrt(scale);
}

// Solves (H + lambda diag(H)) x = -g over the free parameters.
Vector10 damped_step(const Matrix10& information, const Vector10& gradient, double lambda, bool radius_free) {
    Matrix10 h = information;
    Vector10 g = gradient;
    if (!radius_free) {
        h.row(9).setZero();
        h.col(9).setZero();
        h(9, 9) = 1;
        g[9] = 0;
    }
    // Scaled to a unit diagonal, with a floor that keeps directions without any information still.
    const Vector10 scale = h.diagonal().cwiseMax(kFloor).cwiseSqrt().cwiseInverse();
    h = scale.asDiagonal() * h * scale.asDiagonal();
    h.diagonal().array() += lambda + kFloor / 10;
    return -(scale.asDiagonal() * solve_symmetric(h, scale.asDiagonal() * g));
}

// Residual and Jacobian of root (v - best).
void reduced_residual(const Section& section, const Model& model, Eigen::Vector3d& u, Matrix3x10* jacobian) {
    const Eigen::Vector3d s = centre_in_sensor(section, model);
    const double dx = s.x() - section.circle.x_mm, dz = s.z() - section.circle.z_mm;
    const double rho = section.circle.radius_mm;
    const Eigen::Vector3d v(dx, dz,
                            dx * dx + dz * dz + s.y() * s.y() - model.radius * model.radius + rho * rho);
    u = section.root * (v - section.best);
    if (jacobian == nullptr) return;
    const Matrix3x10 js = centre_jacobian(section, model);
    Matrix3x10 jv;
    jv.row(0) = js.row(0);
    jv.row(1) = js.row(2);
    jv.row(2) = 2 * dx * js.row(0) + 2 * dz * js.row(2) + 2 * s.y() * js.row(1);
    jv(2, 9) -= 2 * model.radius;
    jacobian->noalias() = section.root.lazyProduct(jv);
}

double reduced_cost(const std::vector<Section>& sections, const Model& model, double scale2) {
    double cost = 0, used = 0;
    for (const auto& section : sections) {
        if (!section.used) continue;
        const double q = disagreement(section, model) / section.count();
        cost += std::isinf(scale2) ? q : q * scale2 / (q + scale2);
        used += 1;
    }
    return cost / std::max(1.0, used);
}

// Evenly spread directions on the whole sphere (Fibonacci spiral).
Eigen::Vector3d spiral_direction(int i, int n) {
    const double y = 1 - (2 * i + 1.0) / n;
    const double ring = std::sqrt(1 - y * y), angle = i * kPi * (3 - std::sqrt(5.0));
    return {ring * std::cos(angle), y, ring * std::sin(angle)};
}

// For an assumed sensor Y axis n (flange frame) the two in-plane components of R s_i + t = B_i^-1 c are
// linear in (cos, sin) of the turn about n, in the in-plane part of t and in c. Re-weighted against profiles
// that show something else.
Model start_for_axis(const std::vector<Section>& sections, const Eigen::Vector3d& n, double radius) {
    Eigen::Matrix3d basis;  // columns e1, e2, n: right-handed
    basis.col(0) = n.unitOrthogonal();
    basis.col(1) = n.cross(basis.col(0));
    basis.col(2) = n;
    using Vector7 = Eigen::Matrix<double, 7, 1>;
    using Matrix7 = Eigen::Matrix<double, 7, 7>;
    using Matrix2x7 = Eigen::Matrix<double, 2, 7>;
    // Base frame moved to the mean flange position: keeps the normal equations well scaled.
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();
    double used = 0;
    for (const auto& section : sections) {
        if (!section.used) continue;
        origin -= section.flange_from_base.linear().transpose() * section.flange_from_base.translation();
        used += 1;
    }
    origin /= std::max(1.0, used);
    const auto rows = [&](const Section& section, Matrix2x7& a, Eigen::Vector2d& right) {
        // R s + t - (Rinv (c - origin) + Rinv origin + tinv) = 0
        const double x = section.circle.x_mm, z = section.circle.z_mm;
        const Eigen::Matrix<double, 2, 3> project = basis.leftCols<2>().transpose();
        a.setZero();
        a(0, 0) = x;
        a(0, 1) = z;
        a(1, 0) = -z;
        a(1, 1) = x;
        a(0, 2) = a(1, 3) = 1;
        a.rightCols<3>() = -project * section.flange_from_base.linear();
        right = project * (section.flange_from_base * origin);
    };
    Vector7 solution = Vector7::Zero();
    std::vector<double> weight(sections.size(), 1.0);
    for (int round = 0; round < 3; ++round) {
        Matrix7 h = Matrix7::Zero();
        Vector7 g = Vector7::Zero();
        Matrix2x7 a;
        Eigen::Vector2d right;
        for (size_t i = 0; i < sections.size(); ++i) {
            if (!sections[i].used) continue;
            rows(sections[i], a, right);
            h.noalias() += weight[i] * a.transpose() * a;
            g.noalias() += weight[i] * a.transpose() * right;
        }
        const Vector7 scale = h.diagonal().cwiseMax(kFloor).cwiseSqrt().cwiseInverse();
        h = scale.asDiagonal() * h * scale.asDiagonal();
        h.diagonal().array() += kStartRidge;
        solution = scale.asDiagonal() * solve_symmetric(h, scale.asDiagonal() * g);
        for (size_t i = 0; i < sections.size(); ++i) {
            if (!sections[i].used) continue;
            rows(sections[i], a, right);
            weight[i] = 1 / ((a * solution - right).norm() + kReweight_mm);
        }
    }
    const double length = std::hypot(solution[0], solution[1]);
    const double cosine = length > kFloor ? solution[0] / length : 1,
                 sine = length > kFloor ? solution[1] / length : 0;
    // x axis: cos e1 + sin e2; z axis = x axis cross n: sin e1 - cos e2.
    Model model;
    model.radius = radius;
    Eigen::Matrix3d rotation;
    rotation.col(0) = cosine * basis.col(0) + sine * basis.col(1);
    rotation.col(1) = n;
    rotation.col(2) = sine * basis.col(0) - cosine * basis.col(1);
    model.centre_base = solution.tail<3>() + origin;
    // t again for the unit-length turn, then its component along n from |s_y| = sqrt(r^2 - rho^2).
    Eigen::Vector2d in_plane = Eigen::Vector2d::Zero();
    double sum = 0;
    std::vector<double> along, height;
    for (size_t i = 0; i < sections.size(); ++i) {
        const auto& section = sections[i];
        if (!section.used) continue;
        const Eigen::Vector3d target = section.flange_from_base * model.centre_base;
        const Eigen::Vector3d flat = rotation * Eigen::Vector3d(section.circle.x_mm, 0, section.circle.z_mm);
        in_plane += weight[i] * (basis.leftCols<2>().transpose() * (target - flat));
        sum += weight[i];
        along.push_back(n.dot(target));
        height.push_back(
            std::sqrt(std::max(0.0, radius * radius - section.circle.radius_mm * section.circle.radius_mm)));
    }
    in_plane /= sum;
    double best = std::numeric_limits<double>::infinity(), best_along = 0;
    for (size_t i = 0; i < along.size(); ++i) {
        for (const double sign : {-1.0, 1.0}) {
            const double t_n = along[i] - sign * height[i];
            double cost = 0;
            for (size_t k = 0; k < along.size(); ++k)
                cost += std::min(std::abs(std::abs(along[k] - t_n) - height[k]), radius);
            if (cost < best) {
                best = cost;
                best_along = t_n;
            }
        }
    }
    model.flange_from_sensor = make_pose(rotation, basis.leftCols<2>() * in_plane + best_along * n);
    return model;
}

}  // namespace

void take_inliers(Section& section, const CircleSection& circle) {
    section.circle = circle;
    section.x.clear();
    section.z.clear();
    for (int i : circle.inliers) {
        section.x.push_back(section.profile->x_mm[static_cast<size_t>(i)]);
        section.z.push_back(section.profile->z_mm[static_cast<size_t>(i)]);
    }
    update_statistics(section);
}

Eigen::Vector3d centre_in_sensor(const Section& section, const Model& model) {
    return model.flange_from_sensor.linear().transpose() *
           (section.flange_from_base * model.centre_base - model.flange_from_sensor.translation());
}

Matrix3x10 centre_jacobian(const Section& section, const Model& model) {
    // s = R^T (q - t), q = B^-1 c; R <- Exp(w) R gives ds = R^T (q - t) x ... = R^T [q - t]x w.
    const Eigen::Matrix3d rt = model.flange_from_sensor.linear().transpose();
    Matrix3x10 j;
    j.leftCols<3>() = -rt;
    j.middleCols<3>(3) =
        rt * skew(section.flange_from_base * model.centre_base - model.flange_from_sensor.translation());
    j.middleCols<3>(6) = rt * section.flange_from_base.linear();
    j.col(9).setZero();
    return j;
}

Model retracted(const Model& model, const Vector10& delta) {
    return {retract(model.flange_from_sensor, delta.head<6>()), model.centre_base + delta.segment<3>(6),
            model.radius + delta[9]};
}

double disagreement(const Section& section, const Model& model) {
    Eigen::Vector3d u;
    reduced_residual(section, model, u, nullptr);
    return u.squaredNorm();
}

double solve_reduced(const std::vector<Section>& sections, Model& model, bool radius_free, double scale_mm,
                     int iterations) {
    const double scale2 = scale_mm * scale_mm;
    double cost = reduced_cost(sections, model, scale2);
    double lambda = kReducedDamping;
    for (int iteration = 0; iteration < iterations; ++iteration) {
        Matrix10 h = Matrix10::Zero();
        Vector10 g = Vector10::Zero();
        double used = 0;
        for (const auto& section : sections) {
            if (!section.used) continue;
            Eigen::Vector3d u;
            Matrix3x10 j;
            reduced_residual(section, model, u, &j);
            const double q = u.squaredNorm() / section.count();
            double weight = 1 / section.count();
            if (!std::isinf(scale2)) weight *= (scale2 / (q + scale2)) * (scale2 / (q + scale2));
            h.noalias() += (weight * j.transpose()).lazyProduct(j);
            g.noalias() += weight * j.transpose() * u;
            used += 1;
        }
        bool moved = false;
        double gain = 0;
        for (int attempt = 0; attempt < 8; ++attempt) {
            const Model next = retracted(model, damped_step(h, g, lambda, radius_free));
            const double next_cost = reduced_cost(sections, next, scale2);
            if (next_cost < cost) {
                gain = (cost - next_cost) / cost;
                model = next;
                cost = next_cost;
                lambda = std::max(kLeastReducedDamping, lambda * kDampingDown);
                moved = true;
                break;
            }
            lambda *= kReducedDampingUp;
        }
        if (!moved || gain < kGainSettled || cost < kExact_mm2) break;
    }
    return cost;
}

namespace {

// All minima worth a look from every assumed axis, best first.
std::vector<Start> search(const std::vector<Section>& sections, double radius, bool radius_free) {
    std::vector<double> radii{radius};
    if (radius_free) {
        radii.clear();
        for (const double factor : kRadiusStarts) radii.push_back(radius * factor);
    }
    constexpr int kDirections = 96;
    std::vector<Start> coarse;
    for (const double r : radii) {
        for (int i = 0; i < kDirections; ++i) {
            Start start{start_for_axis(sections, spiral_direction(i, kDirections), r), 0};
            start.cost = solve_reduced(sections, start.model, false, kCoarseScale_mm, 4);
            if (std::isfinite(start.cost)) coarse.push_back(start);
        }
    }
    std::sort(coarse.begin(), coarse.end(), [](const Start& a, const Start& b) { return a.cost < b.cost; });
    if (coarse.size() > kCoarseKept) coarse.resize(kCoarseKept);
    std::vector<Start> found;
    const auto same = [](const Start& one, const Start& other, double rad, double mm) {
        return angle_rad(one.model.flange_from_sensor, other.model.flange_from_sensor) < rad &&
               distance_mm(one.model.flange_from_sensor, other.model.flange_from_sensor) < mm;
    };
    for (auto& start : coarse) {
        // Most starts have already run into a minimum that is known.
        if (std::any_of(found.begin(), found.end(), [&](const Start& other) {
                return same(start, other, kSameBasin_rad, kSameBasin_mm);
            }))
            continue;
        for (const double scale : kSettlingScales)
            start.cost = solve_reduced(sections, start.model, radius_free, scale, 25);
        const bool known = std::any_of(found.begin(), found.end(), [&](const Start& other) {
            return same(start, other, kSameMinimum_rad, kSameMinimum_mm);
        });
        if (!known && std::isfinite(start.cost)) found.push_back(start);
    }
    std::sort(found.begin(), found.end(), [](const Start& a, const Start& b) { return a.cost < b.cost; });
    if (found.size() > 4) found.resize(4);
    return found;
}

int agreeing(const std::vector<Section>& sections, const Model& model) {
    int count = 0;
    for (const auto& section : sections)
        count +=
            section.used && disagreement(section, model) / section.count() < kAgrees_mm * kAgrees_mm ? 1 : 0;
    return count;
}

}  // namespace

std::vector<Start> global_start(const std::vector<Section>& sections, double radius, bool radius_free,
                                bool subsets) {
    auto found = search(sections, radius, radius_free);
    std::vector<size_t> used;
    for (size_t i = 0; i < sections.size(); ++i)
        if (sections[i].used) used.push_back(i);
    const size_t few = radius_free ? 6 : 5;
    int best = found.empty() ? 0 : agreeing(sections, found.front().model);
    if (!subsets || best == static_cast<int>(used.size()) || used.size() <= few) return found;
    // Some profiles show something else: search within small subsets, count who agrees, polish on all.
    std::mt19937 random(7u);
    int since_better = 0;  // once most profiles agree, a dozen subsets without a better answer are enough
    for (int trial = 0; trial < 40 && best < static_cast<int>(used.size()) - 1; ++trial) {
        if (++since_better > 12 && 2 * best > static_cast<int>(used.size())) break;
        std::vector<Section> subset;
        std::vector<size_t> pick = used;
        for (size_t k = 0; k < few; ++k) {
            std::swap(pick[k], pick[k + random() % (pick.size() - k)]);
            subset.push_back(sections[pick[k]]);
        }
        for (auto& start : search(subset, radius, radius_free)) {
            if (agreeing(subset, start.model) < static_cast<int>(few)) continue;
            for (const double scale : kSubsetScales)
                start.cost = solve_reduced(sections, start.model, radius_free, scale, 25);
            const int count = agreeing(sections, start.model);
            if (count <= std::max(best, static_cast<int>(few) - 1)) continue;
            best = count;
            since_better = 0;
            start.cost = solve_reduced(sections, start.model, radius_free, 1.0, 25);
            found.insert(found.begin(), start);
        }
    }
    if (found.size() > 4) found.resize(4);
    return found;
}

System accumulate(const std::vector<Section>& sections, const Model& model, bool with_meat) {
    System system;
    for (const auto& section : sections) {
        if (!section.used || section.x.empty()) continue;
        const Eigen::Vector3d s = centre_in_sensor(section, model);
        const double sy2 = s.y() * s.y();
        // de/ds = (s - p) / |s - p| = (ux, uy, uz), de/dr = -1. Sums of their products over the points; each
        // in lanes so that the compiler may keep them in vector registers without reordering one sum.
        constexpr size_t kLanes = 4;
        using Lanes = Eigen::Array<double, kLanes, 1>;
        Lanes sum[13], meat[10];
        for (auto& lane : sum) lane.setZero();
        for (auto& lane : meat) lane.setZero();
        const auto point = [&](const Lanes& x, const Lanes& z, const Lanes& mask) {
            const Lanes dx = s.x() - x, dz = s.z() - z;
            const Lanes d = (dx * dx + sy2 + dz * dz).sqrt();
            const Lanes inverse = mask / d;
            const Lanes e = (d - model.radius) * mask;
            const Lanes ux = dx * inverse, uy = s.y() * inverse, uz = dz * inverse;
            sum[0] += ux * ux;
            sum[1] += ux * uy;
            sum[2] += ux * uz;
            sum[3] += uy * uy;
            sum[4] += uy * uz;
            sum[5] += uz * uz;
            sum[6] += ux;
            sum[7] += uy;
            sum[8] += uz;
            sum[9] += ux * e;
            sum[10] += uy * e;
            sum[11] += uz * e;
            sum[12] += e;
            const Lanes e2 = e * e;
            meat[9] += e2;
            if (!with_meat) return;
            meat[0] += e2 * ux * ux;
            meat[1] += e2 * ux * uy;
            meat[2] += e2 * ux * uz;
            meat[3] += e2 * uy * uy;
            meat[4] += e2 * uy * uz;
            meat[5] += e2 * uz * uz;
            meat[6] += e2 * ux;
            meat[7] += e2 * uy;
            meat[8] += e2 * uz;
        };
        const size_t n = section.x.size(), whole = n - n % kLanes;
        const Lanes one = Lanes::Ones();
        for (size_t i = 0; i < whole; i += kLanes)
            point(Eigen::Map<const Lanes>(&section.x[i]), Eigen::Map<const Lanes>(&section.z[i]), one);
        if (whole < n) {
            Lanes x = Lanes::Constant(s.x() + model.radius), z = Lanes::Constant(s.z()), mask = Lanes::Zero();
            for (size_t i = whole; i < n; ++i) {
                const auto k = static_cast<Eigen::Index>(i - whole);
                x[k] = section.x[i];
                z[k] = section.z[i];
                mask[k] = 1;
            }
            point(x, z, mask);
        }
        const auto block = [](const Lanes* lanes, double last) {
            Eigen::Matrix4d m;
            m << lanes[0].sum(), lanes[1].sum(), lanes[2].sum(), -lanes[6].sum(),  //
                lanes[1].sum(), lanes[3].sum(), lanes[4].sum(), -lanes[7].sum(),   //
                lanes[2].sum(), lanes[4].sum(), lanes[5].sum(), -lanes[8].sum(),   //
                -lanes[6].sum(), -lanes[7].sum(), -lanes[8].sum(), last;
            return m;
        };
        Eigen::Matrix<double, 4, 10> j = Eigen::Matrix<double, 4, 10>::Zero();
        j.topRows<3>() = centre_jacobian(section, model);
        j(3, 9) = 1;
        const auto add = [&j](const Eigen::Matrix4d& m, Matrix10& to) {
            const Eigen::Matrix<double, 4, 10> mj = m.lazyProduct(j);
            to.noalias() += j.transpose().lazyProduct(mj);
        };
        add(block(sum, static_cast<double>(n)), system.information);
        const double squares = meat[9].sum();
        if (with_meat) add(block(meat, squares), system.meat);
        system.gradient.noalias() +=
            j.transpose() * Eigen::Vector4d(sum[9].sum(), sum[10].sum(), sum[11].sum(), -sum[12].sum());
        system.squares += squares;
        system.count += static_cast<double>(n);
    }
    return system;
}

namespace {

// What an error d of a section's centre does to the normal equations. Each of its points errs by u^T d, so
// d^T squares d is added to the sum of squares and pull d to J^T e: the row of the radius (de/dr = -1) too.
struct CentreError {
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();  // sum u u^T
    Eigen::Matrix<double, 10, 3> pull;                  // sum J^T u^T
};

CentreError centre_error(const Section& section, const Model& model) {
    const Eigen::Vector3d s = centre_in_sensor(section, model);
    CentreError error;
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    for (size_t i = 0; i < section.x.size(); ++i) {
        const Eigen::Vector3d u =
            Eigen::Vector3d(s.x() - section.x[i], s.y(), s.z() - section.z[i]).normalized();
        error.squares.noalias() += u * u.transpose();
        sum += u.transpose();
    }
    error.pull = centre_jacobian(section, model).transpose() * error.squares;
    error.pull.row(9) = -sum;
    return error;
}

}  // namespace

NoiseLevels noise_levels(const std::vector<Section>& sections, const Model& model,
                         const Matrix10& inverse_information, bool radius_free) {
    NoiseLevels noise;
    double own = 0, own_freedom = 0, between = 0, used = 0, shown = 0;
    for (const auto& section : sections) {
        if (!section.used) continue;
        own += section.own_squares;
        own_freedom += section.count() - 3;
        between += disagreement(section, model);
        used += 1;
        // What a centre error shows, less what the common parameters take up of it.
        const CentreError error = centre_error(section, model);
        shown += error.squares.trace() - (inverse_information * error.pull).cwiseProduct(error.pull).sum();
    }
    noise.point_variance = own / std::max(1.0, own_freedom);
    noise.redundancy = 3 * used - (radius_free ? 10 : 9);
    if (noise.redundancy < 1) return noise;
    if (noise.point_variance > 0) noise.ratio = between / noise.redundancy / noise.point_variance;
    noise.poses_disagree =
        noise.ratio > chi_squared_quantile(kDisagreementTold, noise.redundancy) / noise.redundancy &&
        between / noise.redundancy > kFloor;
    if (noise.poses_disagree && shown > 0)
        noise.centre_variance = std::max(0.0, between - noise.point_variance * noise.redundancy) / shown;
    return noise;
}

Matrix10 covariance_of_centres(const std::vector<Section>& sections, const Model& model,
                               const Matrix10& inverse_information, double centre_variance) {
    Matrix10 sum = Matrix10::Zero();
    for (const auto& section : sections) {
        if (!section.used) continue;
        const Eigen::Matrix<double, 10, 3> gain = inverse_information * centre_error(section, model).pull;
        sum.noalias() += centre_variance * gain * gain.transpose();
    }
    return sum;
}

double solve_points(const std::vector<Section>& sections, Model& model, bool radius_free) {
    System system = accumulate(sections, model, false);
    double lambda = kPointsDamping;
    for (int iteration = 0; iteration < 30; ++iteration) {
        bool moved = false;
        double gain = 0;
        for (int attempt = 0; attempt < 10; ++attempt) {
            const Vector10 step = damped_step(system.information, system.gradient, lambda, radius_free);
            const Model next = retracted(model, step);
            const System after = accumulate(sections, next, false);
            if (after.squares <= system.squares) {
                gain = system.squares - after.squares;
                model = next;
                moved = step.cwiseAbs().maxCoeff() > kStepSettled;
                const bool small = gain <= kFloor * system.squares;
                system = after;
                lambda = std::max(kFloor, lambda * kDampingDown);
                if (small) moved = false;
                break;
            }
            lambda = std::max(kFailedDamping, lambda * kPointsDampingUp);
        }
        if (!moved) break;
    }
    return system.squares;
}

}  // namespace seamwright::tcp_sphere
