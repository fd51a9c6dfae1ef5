#pragma once
// A world of its own for judging what calibrations state: rigid motions, a lens written out from the textbook and a
// plate's pose found from noisy corners, by Eigen alone. Nothing of it is shared with the estimators or the simulated
// cell.

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace seamwright::plain {

using Motion = Eigen::Isometry3d;
using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;

struct Dice {
    std::mt19937_64 engine;
    std::normal_distribution<double> normal;
    explicit Dice(unsigned seed) : engine(seed) {}
    double n() { return normal(engine); }
    double u(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine); }
    Vec3 noise(double sigma) { return {sigma * n(), sigma * n(), sigma * n()}; }
    Vec3 box(double x, double y, double z) { return {u(-x, x), u(-y, y), u(-z, z)}; }
};

inline Motion motion(const Vec3& turn, const Vec3& shift) {
    Motion m = Motion::Identity();
    if (turn.norm() > 0) m.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).matrix();
    m.translation() = shift;
    return m;
}

// What `found` is off `truth` by: shift, then turn about the reference frame's axes (rad).
inline Eigen::Matrix<double, 6, 1> off(const Motion& found, const Motion& truth) {
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(found.linear() * truth.linear().transpose()));
    Eigen::Matrix<double, 6, 1> d;
    d << found.translation() - truth.translation(), turn.angle() * turn.axis();
    return d;
}

struct Lens {
    double fx = 1450, fy = 1450, cx = 639.5, cy = 479.5, k1 = 0, k2 = 0, p1 = 0, p2 = 0;
    int width = 1280, height = 960;
    Vec2 see(const Vec3& p) const {
        const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
        const double bent = 1 + k1 * r2 + k2 * r2 * r2;
        return {cx + fx * (x * bent + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)),
                cy + fy * (y * bent + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y)};
    }
    bool has(const Vec2& q, double rim) const {
        return q.x() > rim && q.y() > rim && q.x() < width - 1 - rim && q.y() < height - 1 - rim;
    }
};

// As cameras are built: centre off by some per cent of the width, a lens that bends, pixels a little out of square.
inline Lens any_lens(Dice& dice) {
    Lens l;
    l.fx = dice.u(1100, 2200);
    l.fy = l.fx * (1 + 0.0005 * dice.n());
    l.cx += 0.015 * l.width * dice.n();
    l.cy += 0.015 * l.width * dice.n();
    l.k1 = dice.u(-0.2, 0.1);
    l.k2 = dice.u(-0.05, 0.1);
    l.p1 = 0.0005 * dice.n();
    l.p2 = 0.0005 * dice.n();
    return l;
}

struct Board {
    int columns = 9, rows = 6;
    double pitch = 20;
    Vec3 at(int i) const { return {(i % columns) * pitch, (i / columns) * pitch, 0}; }
    int count() const { return columns * rows; }
    Vec3 middle() const { return {0.5 * (columns - 1) * pitch, 0.5 * (rows - 1) * pitch, 0}; }
};

// Pose of the board from noisy corners of a known lens: least squares from near the truth, Gauss and Newton with
// differences for derivatives.
inline Motion board_pose(const Lens& lens, const Board& board, const std::vector<Vec2>& pixel, Motion pose) {
    const auto residuals = [&](const Motion& m) {
        Eigen::VectorXd r(2 * board.count());
        for (int i = 0; i < board.count(); ++i)
            r.segment<2>(2 * i) = lens.see(m * board.at(i)) - pixel[static_cast<std::size_t>(i)];
        return r;
    };
    for (int round = 0; round < 6; ++round) {
        const Eigen::VectorXd r = residuals(pose);
        Eigen::MatrixXd j(r.size(), 6);
        for (int k = 0; k < 6; ++k) {
            Eigen::Matrix<double, 6, 1> d = Eigen::Matrix<double, 6, 1>::Zero();
            d(k) = k < 3 ? 1e-3 : 1e-6;
            j.col(k) = (residuals(pose * motion(d.tail<3>(), d.head<3>())) - r) / d(k);
        }
        const Eigen::Matrix<double, 6, 1> step = -(j.transpose() * j).ldlt().solve(j.transpose() * r);
        pose = pose * motion(step.tail<3>(), step.head<3>());
    }
    return pose;
}

// How often a stated interval of 95 % holds, and how often two answers agree within theirs.
struct Share {
    int inside = 0, asked = 0;
    double nees = 0;
    void add(double error, double sigma) {
        inside += std::abs(error) < 1.959964 * sigma;
        ++asked;
        nees += error * error / (sigma * sigma);
    }
    void add(const Share& more) { inside += more.inside, asked += more.asked, nees += more.nees; }
    double value() const { return asked ? static_cast<double>(inside) / asked : 0; }
    void print(const std::string& what) const {
        std::printf("%-44s %.3f of %d, mean square %.2f\n", what.c_str(), value(), asked,
                    asked ? nees / asked : 0);
    }
};

}  // namespace seamwright::plain
