#include "core/calibration/pose/hand_eye/hand_eye_start.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <cmath>
#include <optional>

#include "core/geometry/decompositions.h"

namespace seamwright::hand_eye {
namespace {

// Relative motions A' X = X B' with A' = A_j^-1 A_i and B' = C_j C_i^-1 over all pairs i > j.
struct Motion {
    Pose a, b;
};

std::vector<Motion> motions(const std::vector<Pose>& a, const std::vector<Pose>& c) {
    std::vector<Motion> list;
    for (size_t i = 0; i < a.size(); ++i)
        for (size_t j = 0; j < i; ++j) list.push_back({a[j].inverse() * a[i], c[j] * c[i].inverse()});
    return list;
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& m) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d guard(1, 1, 1);
    guard[2] = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
    return svd.matrixU() * guard.asDiagonal() * svd.matrixV().transpose();
}

// (R_A' - I) t = R t_B' - t_A', stacked.
Eigen::Vector3d translation_for(const std::vector<Motion>& list, const Eigen::Matrix3d& rotation) {
    Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (const auto& m : list) {
        const Eigen::Matrix3d left = m.a.linear() - Eigen::Matrix3d::Identity();
        h.noalias() += left.transpose() * left;
        g.noalias() += left.transpose() * (rotation * m.b.translation() - m.a.translation());
    }
    return least_squares(h, g).x;
}

Eigen::Quaterniond positive(const Eigen::Matrix3d& rotation) {
    Eigen::Quaterniond q(rotation);
    q.normalize();
    if (q.w() < 0) q.coeffs() *= -1;
    return q;
}

Eigen::Matrix3d park_martin(const std::vector<Motion>& list) {
    Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
    for (const auto& motion : list)
        m.noalias() += rotation_log(motion.a.linear()) * rotation_log(motion.b.linear()).transpose();
    return nearest_rotation(m);
}

// Quaternion that turns the axes of B' into those of A': largest eigenvector of the sum of Q(a)^T W(b).
Eigen::Matrix3d horaud(const std::vector<Motion>& list) {
    Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
    for (const auto& motion : list) {
        const Eigen::Vector3d a = positive(motion.a.linear()).vec(), b = positive(motion.b.linear()).vec();
        Eigen::Matrix4d left, right;  // a * q and q * b as matrices on (w, x, y, z)
        left << 0, -a.transpose(), a, skew(a);
        right << 0, -b.transpose(), b, -skew(b);
        sum.noalias() += (left - right).transpose() * (left - right);
    }
    const Eigen::Vector4d q = symmetric_eigen(sum).vectors.col(0);
    return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
}

// vec(R_A' R - R R_B') = 0 as (I (x) R_A' - R_B'^T (x) I) vec(R) = 0, columns stacked.
std::optional<Eigen::Matrix3d> andreff(const std::vector<Motion>& list) {
    Eigen::Matrix<double, 9, 9> h = Eigen::Matrix<double, 9, 9>::Zero();
    for (const auto& motion : list) {
        Eigen::Matrix<double, 9, 9> k = Eigen::Matrix<double, 9, 9>::Zero();
        for (int col = 0; col < 3; ++col) {
            k.block<3, 3>(3 * col, 3 * col) += motion.a.linear();
            for (int other = 0; other < 3; ++other)
                k.block<3, 3>(3 * col, 3 * other) -=
                    motion.b.linear()(other, col) * Eigen::Matrix3d::Identity();
        }
        h.noalias() += k.transpose() * k;
    }
    const Eigen::VectorXd v = symmetric_eigen(h).vectors.col(0);
    Eigen::Matrix3d m = Eigen::Map<const Eigen::Matrix3d>(v.data());
    const double det = m.determinant();
    constexpr double kSingular = 1e-9;
    if (std::abs(det) < kSingular) return std::nullopt;
    m *= (det > 0 ? 1 : -1) / std::cbrt(std::abs(det));
    return nearest_rotation(m);
}

// Dual quaternions: null space (two-dimensional) of the stacked 6x8 of (3.21) in the paper, then the unit
// constraint.
std::optional<Pose> daniilidis(const std::vector<Motion>& list) {
    constexpr double kHalfTurn = 1e-6;      // scalar part of a quaternion, below which it is a half turn
    constexpr double kNoQuadratic = 1e-15;  // a coefficient of the unit constraint up to that is none
    constexpr double kNoLength2 = 1e-12;    // of the rotation's share of the null space: shorter is no answer
    Eigen::Matrix<double, 8, 8> h = Eigen::Matrix<double, 8, 8>::Zero();
    for (const auto& motion : list) {
        const Eigen::Quaterniond qa = positive(motion.a.linear());
        Eigen::Quaterniond qb = positive(motion.b.linear());
        // Half turns: both signs are the same rotation; the scalar parts must agree.
        if (qa.w() < kHalfTurn && qa.vec().dot(qb.vec()) < -1) qb.coeffs() *= -1;
        const auto dual = [](const Eigen::Quaterniond& q, const Eigen::Vector3d& t) -> Eigen::Vector3d {
            return 0.5 * (q.w() * t + t.cross(q.vec()));
        };
        const Eigen::Vector3d a = qa.vec(), b = qb.vec();
        const Eigen::Vector3d da = dual(qa, motion.a.translation()), db = dual(qb, motion.b.translation());
        Eigen::Matrix<double, 6, 8> s = Eigen::Matrix<double, 6, 8>::Zero();
        s.block<3, 1>(0, 0) = a - b;
        s.block<3, 3>(0, 1) = skew(a + b);
        s.block<3, 1>(3, 0) = da - db;
        s.block<3, 3>(3, 1) = skew(da + db);
        s.block<3, 1>(3, 4) = a - b;
        s.block<3, 3>(3, 5) = skew(a + b);
        h.noalias() += s.transpose() * s;
    }
    const SymmetricEigen eigen = symmetric_eigen(h);
    const Eigen::VectorXd v1 = eigen.vectors.col(0), v2 = eigen.vectors.col(1);
    const Eigen::Vector4d u1 = v1.head<4>(), w1 = v1.tail<4>(), u2 = v2.head<4>(), w2 = v2.tail<4>();
    // q = l1 u1 + l2 u2, q' = l1 w1 + l2 w2 with q.q' = 0 and |q| = 1; s = l1 / l2.
    const double qa = u1.dot(w1), qb = u1.dot(w2) + u2.dot(w1), qc = u2.dot(w2);
    double best = -1;
    Eigen::Vector2d weights;
    const auto consider = [&](double l1, double l2) {
        const double square = (l1 * u1 + l2 * u2).squaredNorm() / (l1 * l1 + l2 * l2);
        if (square <= best) return;
        best = square;
        const double norm = (l1 * u1 + l2 * u2).norm();
        weights = Eigen::Vector2d(l1, l2) / norm;
    };
    const double root = qb * qb - 4 * qa * qc;
    if (root < 0) return std::nullopt;
    if (std::abs(qa) > kNoQuadratic) {
        consider((-qb + std::sqrt(root)) / (2 * qa), 1);
        consider((-qb - std::sqrt(root)) / (2 * qa), 1);
    } else {
        consider(1, 0);
        if (std::abs(qb) > kNoQuadratic) consider(-qc / qb, 1);
    }
    if (best < kNoLength2) return std::nullopt;
    const Eigen::Vector4d q = weights[0] * u1 + weights[1] * u2, d = weights[0] * w1 + weights[1] * w2;
    const Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]), dual(d[0], d[1], d[2], d[3]);
    return make_pose(rotation.normalized().toRotationMatrix(), 2 * (dual * rotation.conjugate()).vec());
}

// Rotation of X and Y from R_A R_X R_C = R_Y: sum of (R_C (x) R_A), largest singular pair, columns stacked.
Closed shah(const std::vector<Pose>& a, const std::vector<Pose>& c) {
    Eigen::Matrix<double, 9, 9> k = Eigen::Matrix<double, 9, 9>::Zero();
    for (size_t i = 0; i < a.size(); ++i)
        for (int row = 0; row < 3; ++row)
            for (int col = 0; col < 3; ++col)
                k.block<3, 3>(3 * row, 3 * col) += c[i].linear()(col, row) * a[i].linear();
    const SingularValues svd = singular_values(k);
    const Eigen::VectorXd u = svd.u.col(0), v = svd.v.col(0);
    Eigen::Matrix3d ry = Eigen::Map<const Eigen::Matrix3d>(u.data()),
                    rx = Eigen::Map<const Eigen::Matrix3d>(v.data());
    if (rx.determinant() < 0) {
        rx = -rx;
        ry = -ry;
    }
    rx = nearest_rotation(rx);
    ry = nearest_rotation(ry);
    // R_A (R_X t_C + t_X) + t_A = t_Y
    Eigen::Matrix<double, 6, 6> h = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> g = Eigen::Matrix<double, 6, 1>::Zero();
    for (size_t i = 0; i < a.size(); ++i) {
        Eigen::Matrix<double, 3, 6> j;
        j.leftCols<3>() = a[i].linear();
        j.rightCols<3>() = -Eigen::Matrix3d::Identity();
        h.noalias() += j.transpose() * j;
        g.noalias() -= j.transpose() * (a[i].linear() * rx * c[i].translation() + a[i].translation());
    }
    const Eigen::Matrix<double, 6, 1> t = least_squares(h, g).x;
    return {"Shah", make_pose(rx, t.head<3>()), make_pose(ry, t.tail<3>())};
}

// Mean of A_i X C_i.
Pose target_for(const std::vector<Pose>& a, const std::vector<Pose>& c, const Pose& x) {
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Zero();
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();
    for (size_t i = 0; i < a.size(); ++i) {
        const Pose y = a[i] * x * c[i];
        rotation += y.linear();
        translation += y.translation();
    }
    return make_pose(nearest_rotation(rotation), translation / static_cast<double>(a.size()));
}

}  // namespace

std::vector<Closed> closed_forms(const std::vector<Pose>& a, const std::vector<Pose>& c) {
    const auto list = motions(a, c);
    std::vector<Closed> found;
    const auto add = [&](const char* name, const Pose& x) {
        if (x.matrix().allFinite()) found.push_back({name, x, target_for(a, c, x)});
    };
    const auto add_rotation = [&](const char* name, const Eigen::Matrix3d& rotation) {
        if (rotation.allFinite()) add(name, make_pose(rotation, translation_for(list, rotation)));
    };
    add_rotation("Park-Martin", park_martin(list));
    add_rotation("Horaud", horaud(list));
    if (const auto rotation = andreff(list)) add_rotation("Andreff", *rotation);
    if (const auto x = daniilidis(list)) add("Daniilidis", *x);
    const Closed both = shah(a, c);
    if (both.x.matrix().allFinite() && both.y.matrix().allFinite()) found.push_back(both);
    return found;
}

}  // namespace seamwright::hand_eye
