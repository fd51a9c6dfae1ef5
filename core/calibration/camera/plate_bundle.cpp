#include "core/calibration/camera/plate_bundle.h"

#include <algorithm>
#include <limits>

#include "core/numbers.h"

namespace seamwright {
namespace {

// Inverse of the left Jacobian of rotation, first order in the (small) residual.
Eigen::Matrix3d log_jacobian(const Eigen::Vector3d& w) {
    return Eigen::Matrix3d::Identity() - 0.5 * skew(w) + skew(w) * skew(w) / 12;
}

// Tangent basis of the unit sphere at n.
Eigen::Matrix<double, 3, 2> tangent(const Eigen::Vector3d& n) {
    Eigen::Matrix<double, 3, 2> t;
    t.col(0) = n.unitOrthogonal();
    t.col(1) = n.cross(t.col(0));
    return t;
}

}  // namespace

Eigen::Vector3d PlateShape::bow_basis(double x, double y) const {
    const double a = (x - middle_mm.x()) / half_mm, b = (y - middle_mm.y()) / half_mm;
    return {a * a, a * b, b * b};
}

Eigen::Vector3d PlateShape::apply(const Eigen::Vector3d& p) const {
    const double x = p.x() - middle_mm.x(), y = p.y() - middle_mm.y();
    return {p.x() - 0.5 * stretch * x + 0.5 * shear * y, p.y() + 0.5 * stretch * y + 0.5 * shear * x,
            p.z() + height_mm(p.x(), p.y())};
}

Eigen::Matrix<double, 3, 5> PlateShape::jacobian(const Eigen::Vector3d& p) const {
    const double x = p.x() - middle_mm.x(), y = p.y() - middle_mm.y();
    Eigen::Matrix<double, 3, 5> j = Eigen::Matrix<double, 3, 5>::Zero();
    j.col(0) << -0.5 * x, 0.5 * y, 0;
    j.col(1) << 0.5 * y, 0.5 * x, 0;
    j.block<1, 3>(2, 2) = bow_basis(p.x(), p.y()).transpose();
    return j;
}

std::optional<Eigen::Vector3d> meet_plate(const CameraModel& camera, const Eigen::Vector2d& pixel,
                                          const Pose& camera_from_target, const PlateShape& shape,
                                          bool on_bow) {
    const Eigen::Vector3d ray = camera.undistort(pixel).homogeneous();
    if (!ray.allFinite()) return std::nullopt;
    const Eigen::Vector3d normal = camera_from_target.linear().col(2);
    const double along = normal.dot(ray);
    if (std::abs(along) < 1e-3 * ray.norm()) return std::nullopt;
    const double base = normal.dot(camera_from_target.translation());
    double s = base / along;
    if (on_bow && !shape.bow_mm.isZero())
        for (int i = 0; i < 8; ++i) {
            const Eigen::Vector3d q = camera_from_target.inverse() * (s * ray);
            s = (base + shape.height_mm(q.x(), q.y())) / along;
        }
    if (!(s > 0) || !std::isfinite(s)) return std::nullopt;
    return s * ray;
}

PlateBundleFit solve_plate_bundle(const PlateBundle& problem, const PlateBundleState& start) {
    const CameraData& data = *problem.data;
    PlateBundleFit fit;
    fit.basis = freedom_basis(problem.freedom);
    const Eigen::Index free = fit.basis.cols();
    const Intrinsics held_at = conform(start.intrinsics, problem.freedom, data.width, data.height);
    HeldIntrinsics held;
    if (!problem.hold_exactly) {
        held = held_intrinsics(problem.freedom, 0.5 * (held_at(0) + held_at(1)), data.width);
        fit.basis.conservativeResize(9, free + held.sigma.size());
        fit.basis.rightCols(held.sigma.size()) = held.directions;
    }
    Eigen::Index shared = fit.basis.cols();
    const Eigen::Index shape_count = problem.shape == ShapeFreedom::rigid      ? 0
                                     : problem.shape == ShapeFreedom::in_plane ? 2
                                                                               : 5;
    if (shape_count) fit.shape_at = shared, shared += shape_count;
    const bool robot = start.flange_from_camera && start.base_from_target;
    if (robot) {
        fit.hand_eye_at = shared;
        fit.target_at = shared + 6;
        shared += 12;
    }
    if (start.plane) fit.plane_at = shared, shared += 3;
    const auto used = [&](std::size_t i) { return problem.view_used.empty() || problem.view_used[i]; };

    const auto evaluate = [&](const PlateBundleState& s, BlockNormal* normal) {
        if (!(s.intrinsics(0) > 1e-3) || !(s.intrinsics(1) > 1e-3)) return kInfinity;
        if (normal) normal->reset(shared, data.views.size());
        const CameraModel camera = camera_of(s.intrinsics, data.width, data.height);
        double cost = 0, corner_cost = 0, robot_mm = 0, robot_rad = 0, stripe_mm = 0;
        std::size_t corners = 0, robot_views = 0, rows = 0;
        Eigen::MatrixXd jg;
        Eigen::Matrix<double, 2, 3> by_point;
        Eigen::Matrix<double, 2, 9> by_k;
        for (std::size_t i = 0; i < data.views.size(); ++i) {
            if (!used(i)) {
                if (normal) normal->vv[i].setIdentity();
                continue;
            }
            const auto& view = data.views[i];
            const Pose& pose = s.camera_from_target[i];
            const double wc = 1 / problem.corner_sigma_px;
            for (std::size_t k = 0; k < view.pixel.size(); ++k) {
                if (!problem.point_used.empty() && !problem.point_used[i][k]) continue;
                const Eigen::Vector3d turned = pose.linear() * s.shape.apply(view.object_mm[k]);
                const Eigen::Vector3d point = turned + pose.translation();
                if (!(point.z() > 1e-6)) return kInfinity;
                Eigen::Vector2d pixel;
                project_with_jacobian(s.intrinsics, point, pixel, &by_point, &by_k);
                const Eigen::Vector2d e = pixel - view.pixel[k];
                corner_cost += e.squaredNorm();
                ++corners;
                cost += wc * wc * e.squaredNorm();
                if (!normal) continue;
                jg.setZero(2, shared);
                jg.leftCols(fit.basis.cols()) = wc * by_k * fit.basis;
                if (shape_count)
                    jg.middleCols(fit.shape_at, shape_count) =
                        wc * by_point * pose.linear() *
                        s.shape.jacobian(view.object_mm[k]).leftCols(shape_count);
                Eigen::Matrix<double, 2, 6> jv;
                jv << wc * by_point, -wc * by_point * skew(turned);
                normal->gg.noalias() += jg.transpose() * jg;
                normal->g.noalias() += wc * jg.transpose() * e;
                normal->gv[i].noalias() += jg.transpose() * jv;
                normal->vv[i].noalias() += jv.transpose() * jv;
                normal->v[i].noalias() += wc * jv.transpose() * e;
            }
            if (robot && problem.base_from_flange[i]) {
                // base_from_flange * flange_from_camera * camera_from_target against base_from_target.
                const Pose& a = *problem.base_from_flange[i];
                const Pose& x = *s.flange_from_camera;
                const Pose& z = *s.base_from_target;
                const Pose found = a * x * pose;
                const Eigen::Vector3d dt = found.translation() - z.translation();
                const Eigen::Vector3d dw = rotation_log(found.linear() * z.linear().transpose());
                const double wt = 1 / problem.robot_sigma_mm, wr = 1 / problem.robot_sigma_rad;
                robot_mm += dt.squaredNorm();
                robot_rad += dw.squaredNorm();
                ++robot_views;
                cost += wt * wt * dt.squaredNorm() + wr * wr * dw.squaredNorm();
                if (normal) {
                    Vector6 e;
                    e << wt * dt, wr * dw;
                    jg.setZero(6, shared);
                    const Eigen::Matrix3d ra = a.linear(), rax = a.linear() * x.linear(),
                                          l = log_jacobian(dw);
                    jg.block<3, 3>(0, fit.hand_eye_at) = wt * ra;
                    jg.block<3, 3>(0, fit.hand_eye_at + 3) = -wt * ra * skew(x.linear() * pose.translation());
                    jg.block<3, 3>(3, fit.hand_eye_at + 3) = wr * l * ra;
                    jg.block<3, 3>(0, fit.target_at) = -wt * Eigen::Matrix3d::Identity();
                    jg.block<3, 3>(3, fit.target_at + 3) = -wr * log_jacobian(-dw);
                    Matrix6 jv = Matrix6::Zero();
                    jv.block<3, 3>(0, 0) = wt * rax;
                    jv.block<3, 3>(3, 3) = wr * l * rax;
                    normal->gg.noalias() += jg.transpose() * jg;
                    normal->g.noalias() += jg.transpose() * e;
                    normal->gv[i].noalias() += jg.transpose() * jv;
                    normal->vv[i].noalias() += jv.transpose() * jv;
                    normal->v[i].noalias() += jv.transpose() * e;
                }
            }
            if (s.plane && i < problem.stripe.size() && problem.stripe_used[i]) {
                const Eigen::Vector3d n = s.plane->normal, m = pose.linear().col(2), t = pose.translation();
                const Eigen::Matrix<double, 3, 2> across = tangent(n);
                for (const auto& pixel : problem.stripe[i]) {
                    const auto met = meet_plate(camera, pixel, pose, s.shape, problem.stripe_on_bow);
                    if (!met) return kInfinity;
                    const double e = n.dot(*met) + s.plane->offset_mm;
                    stripe_mm += e * e;
                    ++rows;
                    // Huber at 3 sigma: a reflection must not pull the plane.
                    const double q = std::abs(e) / problem.stripe_sigma_mm;
                    const double w = (q <= 3 ? 1.0 : std::sqrt(3 / q)) / problem.stripe_sigma_mm;
                    cost += q <= 3 ? q * q : 3 * (2 * q - 3);
                    if (!normal) continue;
                    const double depth = met->z();
                    const Eigen::Vector3d ray = *met / depth;
                    const double mr = m.dot(ray), nr = n.dot(ray);
                    Eigen::Vector2d back;
                    project_with_jacobian(s.intrinsics, ray, back, &by_point, &by_k);
                    Eigen::Matrix<double, 3, 9> ray_by_k = Eigen::Matrix<double, 3, 9>::Zero();
                    ray_by_k.topRows<2>() = -by_point.leftCols<2>().inverse() * by_k;
                    jg.setZero(1, shared);
                    jg.leftCols(fit.basis.cols()) =
                        (depth * (n.transpose() - nr / mr * m.transpose()) * ray_by_k) * fit.basis;
                    if (shape_count == 5 && problem.stripe_on_bow) {
                        const Eigen::Vector3d q_plate = pose.inverse() * *met;
                        jg.middleCols(fit.shape_at + 2, 3) =
                            nr / mr * s.shape.bow_basis(q_plate.x(), q_plate.y()).transpose();
                    }
                    jg.middleCols(fit.plane_at, 2) = met->transpose() * across;
                    jg(0, fit.plane_at + 2) = 1;
                    Eigen::Matrix<double, 1, 6> jv;
                    jv.leftCols<3>() = nr / mr * m.transpose();
                    jv.rightCols<3>() = nr / mr * (m.cross(t) - depth * m.cross(ray)).transpose();
                    jg *= w;
                    jv *= w;
                    normal->gg.noalias() += jg.transpose() * jg;
                    normal->g.noalias() += w * e * jg.transpose();
                    normal->gv[i].noalias() += jg.transpose() * jv;
                    normal->vv[i].noalias() += jv.transpose() * jv;
                    normal->v[i].noalias() += w * e * jv.transpose();
                }
            }
        }
        for (Eigen::Index j = 0; j < held.sigma.size(); ++j) {
            const auto d = held.directions.col(j);
            const double e = d.dot(s.intrinsics - held_at) / (d.squaredNorm() * held.sigma(j));
            cost += e * e;
            if (!normal) continue;
            normal->gg(free + j, free + j) += 1 / (held.sigma(j) * held.sigma(j));
            normal->g(free + j) += e / held.sigma(j);
        }
        if (normal) {
            normal->cost = cost;
            fit.corners = corners;
            fit.corner_cost = corner_cost;
            fit.corner_rms_px = corners ? std::sqrt(corner_cost / static_cast<double>(corners)) : 0;
            fit.robot_rms_mm = robot_views ? std::sqrt(robot_mm / static_cast<double>(robot_views)) : 0;
            fit.robot_rms_rad = robot_views ? std::sqrt(robot_rad / static_cast<double>(robot_views)) : 0;
            fit.stripe_rms_mm = rows ? std::sqrt(stripe_mm / static_cast<double>(rows)) : 0;
        }
        return std::isfinite(cost) ? cost : kInfinity;
    };
    const auto apply = [&](PlateBundleState& s, const Eigen::VectorXd& step,
                           const std::vector<Vector6>& view_steps) {
        s.intrinsics += fit.basis * step.head(fit.basis.cols());
        if (shape_count) {
            s.shape.stretch += step(fit.shape_at);
            s.shape.shear += step(fit.shape_at + 1);
            if (shape_count == 5) s.shape.bow_mm += step.segment<3>(fit.shape_at + 2);
        }
        if (robot) {
            s.flange_from_camera = retract(*s.flange_from_camera, step.segment<6>(fit.hand_eye_at));
            s.base_from_target = retract(*s.base_from_target, step.segment<6>(fit.target_at));
        }
        if (s.plane) {
            s.plane->normal =
                (s.plane->normal + tangent(s.plane->normal) * step.segment<2>(fit.plane_at)).normalized();
            s.plane->offset_mm += step(fit.plane_at + 2);
        }
        for (std::size_t i = 0; i < s.camera_from_target.size(); ++i)
            if (used(i)) s.camera_from_target[i] = retract(s.camera_from_target[i], view_steps[i]);
    };
    fit.state = start;
    if (problem.hold_exactly) fit.state.intrinsics = held_at;
    if (shape_count == 0) fit.state.shape.stretch = fit.state.shape.shear = 0;
    if (shape_count < 5) fit.state.shape.bow_mm.setZero();
    fit.converged = minimise_blocks(fit.state, fit.normal, evaluate, apply, 60, 1e-9);
    fit.covariance = shared_covariance(fit.normal);
    return fit;
}

}  // namespace seamwright
