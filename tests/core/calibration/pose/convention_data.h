#pragma once
// Poses as other robots write them, by a generator that shares nothing with what reads them: turns from their
// matrices' elements, angles by searching for the three whose turns give the rotation.

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/geometry/pose.h"

namespace seamwright::elsewhere {

inline Eigen::Matrix3d turn(char axis, double rad) {
    const double c = std::cos(rad), s = std::sin(rad);
    Eigen::Matrix3d m;
    if (axis == 'x') m << 1, 0, 0, 0, c, -s, 0, s, c;
    if (axis == 'y') m << c, 0, s, 0, 1, 0, -s, 0, c;
    if (axis == 'z') m << c, -s, 0, s, c, 0, 0, 0, 1;
    return m;
}

inline Eigen::Matrix3d turned(const std::string& axes, bool fixed, const Eigen::Vector3d& rad) {
    const Eigen::Matrix3d a = turn(axes[0], rad[0]), b = turn(axes[1], rad[1]), c = turn(axes[2], rad[2]);
    return fixed ? Eigen::Matrix3d(c * b * a) : Eigen::Matrix3d(a * b * c);
}

// Newton on the nine elements from many starts; any angles that give the rotation.
inline Eigen::Vector3d angles(const std::string& axes, bool fixed, const Eigen::Matrix3d& r) {
    for (int start = 0; start < 64; ++start) {
        Eigen::Vector3d a(0.1 + 1.55 * (start % 4), 0.2 + 0.77 * (start / 4 % 4), -0.15 + 1.6 * (start / 16));
        for (int i = 0; i < 60; ++i) {
            const Eigen::Matrix3d off = turned(axes, fixed, a) - r;
            const Eigen::Map<const Eigen::Matrix<double, 9, 1>> e(off.data());
            if (e.norm() < 1e-12)
                return a.unaryExpr([](double v) { return std::remainder(v, 2 * 3.14159265358979323846); });
            Eigen::Matrix<double, 9, 3> j;
            for (int k = 0; k < 3; ++k) {
                Eigen::Vector3d up = a, down = a;
                up[k] += 1e-6;
                down[k] -= 1e-6;
                const Eigen::Matrix3d d = (turned(axes, fixed, up) - turned(axes, fixed, down)) / 2e-6;
                j.col(k) = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(d.data());
            }
            const Eigen::Matrix3d h =
                Eigen::Matrix3d(j.transpose() * j) + 1e-10 * Eigen::Matrix3d::Identity();
            a -= h.inverse() * (j.transpose() * e);
        }
    }
    throw std::runtime_error("no angles found");
}

inline const std::vector<std::string>& orders() {
    static const std::vector<std::string> all = {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx",
                                                 "xyx", "xzx", "yxy", "yzy", "zxz", "zyz"};
    return all;
}

struct Writing {
    std::string axes = "zyx";
    bool fixed = false, radian = false, inverse = false;
    double mm = 1;  // of its unit of length
    std::string code() const {
        return "euler-" + axes + (fixed ? "-extrinsic" : "-intrinsic") + (radian ? ",rad" : ",deg") +
               (mm == 1      ? ",mm"
                : mm == 1000 ? ",m"
                             : ",in") +
               (inverse ? ",inverse" : "");
    }
};

struct Written {
    Eigen::Vector3d position, angles;
};
inline Written write(const Pose& pose, const Writing& w) {
    Eigen::Matrix3d r = pose.linear();
    Eigen::Vector3d t = pose.translation();
    if (w.inverse) {
        r.transposeInPlace();
        t = -(r * t);
    }
    Eigen::Vector3d a = angles(w.axes, w.fixed, r);
    if (!w.radian) a *= 180 / 3.14159265358979323846;
    return {t / w.mm, a};
}

}  // namespace seamwright::elsewhere
