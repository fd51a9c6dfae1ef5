#include "core/calibration/sphere/tcp_sphere_solve.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/calibration/statistics.h"
#include "core/geometry/decompositions.h"

namespace seamwright::tcp_sphere {
namespace {

constexpr double kDisagreementTold = 0.99;  // of chi squared: the poses are worse than the profiles
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
    // Of M = S - P^T A P, S block by block the squares, P the pulls side by side: the disagreement is d^T M d of the
    // centres' errors d, with mean tr M and variance 2 tr M^2 of a unit error.
    double of_squares = 0;
    Matrix10 of_both = Matrix10::Zero(), of_pulls = Matrix10::Zero();
    for (const auto& section : sections) {
        if (!section.used) continue;
        own += section.own_squares;
        own_freedom += section.count() - 3;
        between += disagreement(section, model);
        used += 1;
        // What a centre error shows, less what the common parameters take up of it.
        const CentreError error = centre_error(section, model);
        shown += error.squares.trace() - (inverse_information * error.pull).cwiseProduct(error.pull).sum();
        of_squares += error.squares.squaredNorm();
        of_both.noalias() += error.pull * error.squares * error.pull.transpose();
        of_pulls.noalias() += error.pull * error.pull.transpose();
    }
    noise.point_variance = own / std::max(1.0, own_freedom);
    noise.redundancy = 3 * used - (radius_free ? 10 : 9);
    if (noise.redundancy < 1) return noise;
    const Matrix10 pulled = inverse_information * of_pulls;
    const double spread =
        of_squares - 2 * inverse_information.cwiseProduct(of_both).sum() + (pulled * pulled).trace();
    noise.freedom = spread > 0 && shown > 0 ? std::clamp(shown * shown / spread, 1.0, noise.redundancy)
                                            : noise.redundancy;
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
