#pragma once
// A round piece of contour and the straights that run tangentially into it, fitted together.
//
// Centre c, radius R, and where the arc ends: between the directions n(phi_L) and n(phi_R) from c it is round, beyond it goes
// on along its tangent. A point p lies off the arc by |p - c| - R and off a straight by n . (p - c) - R, n that of its end;
// the two and their derivatives meet at the end, so Gauss-Newton finds the ends as it finds the circle, and the straight's
// points say where the rim's tangent is instead of drawing the rim to themselves.
//
// Whether a few points at the arc's end are round or straight noise may hide. What is asked for is then the mean over both
// readings, each weighted by exp(-chi^2 / 2 - unknowns / 2) (Burnham and Anderson, Model Selection and Multimodel Inference,
// 2nd ed., 4.3.2, with half of Akaike's price of an unknown, or short straights count too little), and the covariance has their
// disagreement.

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/features/contour/contour_noise.h"

namespace seamwright {

struct Circle {
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();
    double radius = 0;
    double distance(double x, double z) const { return std::hypot(x - centre.x(), z - centre.y()) - radius; }
};

// Points `first` to `last` are on the rim, those from `from` to `to` belong to the same piece of contour.
struct ArcPlace {
    Circle circle;
    int first = 0, last = 0, from = 0, to = 0;
};

struct FittedArc {
    Circle circle;
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  // of the centre
    Eigen::Matrix2d within =
        Eigen::Matrix2d::Zero();  // the part of it that is not the readings' disagreement
    double arc = 0;               // rad, that is round
    double rms = 0;
    int used = 0;
};

class ArcFit {
  public:
    // `known`: the radius stays. False: no straight runs into the arc, or too little is there to tell.
    bool fit(std::span<const double> x, std::span<const double> z, ArcPlace place, bool known,
             const ProfileNoise& noise, FittedArc& fitted);

  private:
    enum Side { left, right };
    using Vector5 = Eigen::Matrix<double, 5, 1>;
    using Matrix5 = Eigen::Matrix<double, 5, 5>;
    // Centre, radius, and by how much the arc reaches from its middle to either side, rad.
    struct Shape {
        Vector5 p = Vector5::Zero();
        std::array<bool, 2> straight{};
        Matrix5 normal = Matrix5::Identity();
        double rss = 0;
        int used = 0;
        std::array<int, 2> on_straight{};
        int on_arc = 0;
        Circle circle() const { return {p.head<2>(), p[2]}; }
        int unknowns(bool known) const { return (known ? 2 : 3) + straight[left] + straight[right]; }
    };
    enum class Where { arc, left, right };
    // Of the arc: outwards from the centre, and whether the angle grows there outwards along the contour.
    struct Ends {
        Ends(const ArcFit& fit, const Shape& shape);
        std::array<Eigen::Vector2d, 2> out;
        std::array<double, 2> sign;
    };
    double residual(const Shape& shape, const Ends& ends, int i, Vector5& row, Where& where) const;
    void sum(Shape& shape, Vector5& gradient) const;
    bool minimise(Shape& shape, int rounds) const;
    bool choose_points(const Shape& shape);
    bool settle(Shape& shape);
    int reach(const ArcPlace& place, Side side, double length) const;
    double end_of_data(const Shape& shape, Side side) const;
    bool fit_at(const ArcPlace& place, Shape& shape);
    bool try_straights(const ArcPlace& place, std::array<bool, 2> may, Shape& best);
    enum class Found { tangent, kink, curved };
    Found check(const Shape& shape, Side side) const;
    void average(const Shape& fullest, const ProfileNoise& noise, FittedArc& fitted);

    std::span<const double> x_, z_;
    bool known_ = false;
    int from_ = 0, to_ = 0, middle_ = 0;
    double towards_ = 0,
           turn_ = 1;   // direction of the arc's middle from the centre; +1: its angle grows with the index
    double least_ = 0;  // of a point's noise
    double apart_ = 1;  // lines that count as one
    ArcPlace before_;
    std::vector<std::uint8_t> keep_;
    std::vector<double> scratch_;
};

}  // namespace seamwright
