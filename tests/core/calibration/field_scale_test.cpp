// Known answers of the scale and shear of a field.

#include "core/calibration/field_scale.h"

#include <gtest/gtest.h>

#include <vector>

namespace seamwright {
namespace {

// Errors of all places that one number of size `sigma` makes.
Eigen::MatrixXd made_by(const std::vector<Eigen::Vector2d>& places, const Eigen::Matrix2d& linear,
                        double sigma) {
    Eigen::VectorXd e(2 * static_cast<Eigen::Index>(places.size()));
    for (std::size_t i = 0; i < places.size(); ++i)
        e.segment<2>(2 * static_cast<Eigen::Index>(i)) = sigma * (linear * places[i]);
    return e * e.transpose();
}

TEST(FieldScale, OfErrorsThatAreScaleShearAndTurn) {
    std::vector<Eigen::Vector2d> places;
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 3; ++k) places.emplace_back(20.0 * i - 25, 15.0 * k + 180);
    const Eigen::Matrix2d x{{1, 0}, {0, 0}}, z{{0, 0}, {0, 1}}, shear{{0, 1}, {0, 0}}, turn{{0, 1}, {-1, 0}};
    const FieldScale found =
        field_scale(places, made_by(places, x, 1e-3) + made_by(places, z, 2e-3) +
                                made_by(places, shear, 3e-3) + made_by(places, turn, 0.01));
    EXPECT_NEAR(found.scale_sigma.x(), 1e-3, 1e-12);
    EXPECT_NEAR(found.scale_sigma.y(), 2e-3, 1e-12);
    EXPECT_NEAR(found.shear_sigma, 3e-3, 1e-12);
    // A shift and a turn in the plane are the hand-eye's.
    Eigen::MatrixXd shift = Eigen::MatrixXd::Constant(24, 24, 0.25);
    const FieldScale rigid = field_scale(places, made_by(places, turn, 0.01) + shift);
    EXPECT_LT(rigid.scale_sigma.norm() + rigid.shear_sigma, 1e-9);
}

TEST(FieldScale, PlacesThatDoNotTellGiveNothing) {
    const std::vector<Eigen::Vector2d> line{{0, 0}, {1, 1}, {2, 2}, {3, 3}};
    const FieldScale found = field_scale(line, Eigen::MatrixXd::Identity(8, 8));
    EXPECT_EQ(found.scale_sigma, Eigen::Vector2d::Zero());
    EXPECT_EQ(field_scale({}, Eigen::MatrixXd()).shear_sigma, 0);
    EXPECT_EQ(field_scale(line, Eigen::MatrixXd::Identity(6, 6)).shear_sigma, 0);
}

TEST(FieldScale, OfTwoThatHoldTheSmallerUnlessOneIsShown) {
    const FieldScale plate{{1e-4, 3e-4}, 2e-4, false}, cuts{{7e-4, 1e-4}, 6e-4, false};
    const FieldScale both = better_known(plate, cuts);
    EXPECT_EQ(both.scale_sigma, Eigen::Vector2d(1e-4, 1e-4));
    EXPECT_EQ(both.shear_sigma, 2e-4);
    const FieldScale shown{{5e-3, 1e-3}, 6e-4, true};
    EXPECT_EQ(better_known(plate, shown).scale_sigma, shown.scale_sigma);
    EXPECT_EQ(better_known(shown, plate).scale_sigma, shown.scale_sigma);
    EXPECT_EQ(better_known({}, cuts).scale_sigma, cuts.scale_sigma);
    EXPECT_EQ(better_known(cuts, {}).shear_sigma, cuts.shear_sigma);
}

}  // namespace
}  // namespace seamwright
