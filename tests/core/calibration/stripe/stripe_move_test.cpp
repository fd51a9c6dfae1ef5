#include "core/calibration/stripe/stripe_move.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace seamwright::detail {
namespace {

enum class Noise { normal, heavy, between };

// Stripes across a field of 60 mm, tilted by the way; each of the two numbers of a frame errs by 0.02 mm.
std::vector<StripeOff> frames_of(std::mt19937& random, std::size_t count, Noise noise) {
    std::uniform_real_distribution<double> u(-1, 1);
    std::normal_distribution<double> n(0, 1);
    std::student_t_distribution<double> t(3);
    std::vector<StripeOff> frames(count);
    for (StripeOff& f : frames) {
        const double across = 30 * u(random), along = 10 * u(random), half = 15 + 3 * u(random);
        const double turn = 0.4 * u(random);
        f.by_plane << across, along, 1, half * std::sin(turn), half * std::cos(turn), 0;
        const auto err = [&] { return noise == Noise::heavy ? t(random) / std::sqrt(3.0) : n(random); };
        f.off_mm = f.by_plane * Eigen::Vector3d(0.02, -0.01, 0.4) + 0.02 * Eigen::Vector2d(err(), err());
        if (noise == Noise::between) f.off_mm += 0.1 * Eigen::Vector2d(n(random), n(random));
        f.noise_mm2 = 4e-4 * Eigen::Matrix2d::Identity();
    }
    return frames;
}

TEST(StripeMove, FramesOfOneLaserAreSeldomBlamed) {
    std::mt19937 random(3);
    for (const Noise noise : {Noise::normal, Noise::heavy, Noise::between}) {
        int blamed = 0;
        for (int trial = 0; trial < 400; ++trial)
            blamed +=
                find_move(frames_of(random, 6 + static_cast<std::size_t>(trial) % 20, noise)).has_value();
        EXPECT_LE(blamed, 4) << static_cast<int>(noise);
    }
}

TEST(StripeMove, IsFoundWhereItHappened) {
    std::mt19937 random(4);
    int found = 0;
    for (int trial = 0; trial < 100; ++trial) {
        auto frames = frames_of(random, 12, Noise::normal);
        const std::size_t at = 3 + static_cast<std::size_t>(trial) % 7;
        for (std::size_t k = at; k < frames.size(); ++k)
            frames[k].off_mm += frames[k].by_plane * Eigen::Vector3d(0, 0.002, 0.3);
        const auto move = find_move(frames);
        if (!move) continue;
        EXPECT_NEAR(static_cast<double>(move->first_after), static_cast<double>(at), 1);
        EXPECT_NEAR(move->apart_mm, 0.3, 0.1);
        ++found;
    }
    EXPECT_GE(found, 98);
}

// One frame alone is no move, wherever it stands.
TEST(StripeMove, OneFrameThatContradictsIsNotTaken) {
    std::mt19937 random(5);
    int blamed = 0;
    for (int trial = 0; trial < 240; ++trial) {
        auto frames = frames_of(random, 12, Noise::normal);
        frames[static_cast<std::size_t>(trial) % 12].off_mm(0) += 0.5;
        blamed += find_move(frames).has_value();
    }
    EXPECT_LE(blamed, 2);
}

TEST(StripeMove, WhatFramesDifferByIsFound) {
    std::mt19937 random(6);
    double squares = 0, honest = 0;
    for (int trial = 0; trial < 200; ++trial) {
        squares += std::pow(between_frames_mm(frames_of(random, 12, Noise::between)), 2) / 200;
        honest += std::pow(between_frames_mm(frames_of(random, 12, Noise::normal)), 2) / 200;
    }
    EXPECT_NEAR(std::sqrt(squares), 0.1, 0.01);
    EXPECT_LT(std::sqrt(honest), 0.01);
}

}  // namespace
}  // namespace seamwright::detail
