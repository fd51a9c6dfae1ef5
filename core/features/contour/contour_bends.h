#pragma once
// The bends of a contour: where one straight stretch of it turns into the next. What a corner chooses from.
//
// The points are gathered to at most 600 nodes (medians of neighbouring points, blind to single
// outliers), and the nodes divided into straight stretches: of all divisions that with the least
//     sum of squared distances from the stretches' lines / noise^2 + kStretchCost (stretches)
// by dynamic programming, quadratic in the nodes. Stretches of fewer than four nodes, or shorter than twice
// the blend zone, are what lies in a bend (radius, burr). Neighbours that turn by less than the least angle
// and meet are one stretch; several bends to one side with only short stretches in between are one (a
// radius). No bend lies where two lines meet far from their stretches: there the contour jumps.
//
// Noise model: independent, equal, across the contour; estimated from the nodes.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace seamwright {

struct Bend {
    int first, last;  // points of the two stretches it joins: first..split belong to the left one
    int split;        // number of points before the bend's middle
    double turn_rad;  // from the left to the right stretch, -pi..pi
    Eigen::Vector2d place = Eigen::Vector2d::Zero();  // where their lines meet
};

class ContourBends {
  public:
    // In contour order. Turns of at least `least_angle_rad`; none for fewer than 8 points.
    const std::vector<Bend>& find(std::span<const double> x, std::span<const double> z,
                                  double least_angle_rad, double blend_mm);

  private:
    struct Stretch {
        int first, last;  // nodes
        Eigen::Vector2d centre, direction;
        double begin, end;  // along the direction from the centre
        double length() const { return end - begin; }
    };
    void take_nodes(std::span<const double> x, std::span<const double> z);
    Stretch stretch(int first, int last) const;
    void divide();

    std::vector<double> node_x_, node_z_, scratch_, cost_;
    std::vector<int> node_first_;  // point, and one past the last
    std::vector<int> from_;
    std::vector<std::array<double, 5>> sums_;
    std::vector<Stretch> stretches_;
    std::vector<std::uint8_t> joint_;
    std::vector<Bend> bends_;
    double noise_ = 0;
};

}  // namespace seamwright
