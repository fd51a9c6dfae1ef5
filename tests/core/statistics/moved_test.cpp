#include "core/statistics/moved.h"

#include <gtest/gtest.h>

#include "tests/core/statistics/carrier_line.h"

namespace seamwright {
namespace {

using namespace carrier_line;

std::vector<Pattern> door_patterns() {
    std::vector<HoldingElement> elements;
    for (const Locator& l : door_locators()) elements.push_back({l.p, {l.n}});
    return fixture_patterns(elements).elements;
}

struct Fault {
    std::size_t carrier = 0, locator = 0;
    double mm = 0;
    std::size_t from = 0;  // car
};

// Carriers go round; every part sits in its locators with a seating error `sigma` at each, and is measured with `noise`.
struct Line {
    std::size_t carriers = 10, cars = 400;
    double sigma = 0.05, noise_mm = 0.02, noise_rad = 3e-5;
    std::vector<Fault> faults;
    Eigen::Vector3d cell_shift = Eigen::Vector3d::Zero();
    std::size_t cell_from = 1u << 30;
    double cell_drift_mm_per_car = 0;
    double echo = 0;  // of the seating errors from car to car of a carrier

    std::vector<CarLies> run(unsigned seed) const {
        std::mt19937_64 random(seed);
        std::normal_distribution<double> normal;
        const auto locators = door_locators();
        std::vector<std::vector<double>> own(carriers, std::vector<double>(6)), last = own;
        for (auto& carrier : own)
            for (double& v : carrier) v = 0.3 * normal(random);
        std::vector<CarLies> out;
        for (std::size_t k = 0; k < cars; ++k) {
            const std::size_t c = k % carriers;
            std::vector<double> give = own[c];
            for (std::size_t i = 0; i < 6; ++i) {
                last[c][i] = echo * last[c][i] + std::sqrt(1 - echo * echo) * sigma * normal(random);
                give[i] += last[c][i];
            }
            for (const Fault& f : faults)
                if (f.carrier == c && k >= f.from) give[f.locator] += f.mm;
            Motion m = seated(locators, give);
            if (k >= cell_from) m.t += cell_shift;
            m.t.x() += cell_drift_mm_per_car * static_cast<double>(k);
            CarLies car;
            car.carrier = c;
            car.day = static_cast<double>(k) / 400;
            car.at << m.t, rotation_vector(m.r);
            for (int i = 0; i < 6; ++i) car.at(i) += (i < 3 ? noise_mm : noise_rad) * normal(random);
            car.covariance.diagonal() << Eigen::Vector3d::Constant(noise_mm * noise_mm),
                Eigen::Vector3d::Constant(noise_rad * noise_rad);
            out.push_back(car);
        }
        return out;
    }
};

TEST(Moved, PatternsAreTheMotionsOfASeatedPart) {
    const auto patterns = door_patterns();
    ASSERT_EQ(patterns.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) {
        std::vector<double> give(6, 0.0);
        give[i] = 0.01;
        const Motion m = seated(door_locators(), give);
        Vector6 expected;
        expected << m.t, rotation_vector(m.r);
        EXPECT_LT((patterns[i].col(0) * 0.01 - expected).norm(), 1e-5) << i;
    }
}

TEST(Moved, AFixtureThatLeavesThePartFreeSaysHow) {
    std::vector<HoldingElement> elements;
    for (const Locator& l : door_locators()) elements.push_back({l.p, {l.n}});
    elements.pop_back();  // nothing holds it along X
    const auto loose = fixture_patterns(elements);
    EXPECT_EQ(loose.status, FixtureStatus::loose);
    EXPECT_GT(std::abs(loose.free_motion(0)), 0.99);
    EXPECT_LT(loose.free_motion.tail<5>().norm(), 1e-6);
    EXPECT_EQ(fixture_patterns({}).status, FixtureStatus::loose);
}

TEST(Moved, APinAndAHingeHoldInSeveralDirections) {
    // A door on two hinges and a striker: 3 + 2 + 1.
    const std::vector<HoldingElement> elements{{{0, 0, 100}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
                                               {{0, 0, 900}, {{1, 0, 0}, {0, 1, 0}}},
                                               {{1000, 0, 500}, {{0, 1, 0}}}};
    const auto door = fixture_patterns(elements);
    ASSERT_EQ(door.status, FixtureStatus::ok);
    // The upper hinge by 1 mm along Y: the lower hinge and the striker stay.
    const Vector6 m = door.elements[1].col(1);
    const auto at = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
        return m.head<3>() + m.tail<3>().cross(p);
    };
    EXPECT_NEAR(at({0, 0, 900}).y(), 1, 1e-9);
    EXPECT_LT(at({0, 0, 100}).norm(), 1e-9);
    EXPECT_NEAR(at({1000, 0, 500}).y(), 0, 1e-9);
}

TEST(Moved, NamesCarrierLocatorAmountAndCar) {
    Line line;
    line.faults = {{7, 4, 0.4, 237}};
    const auto cars = line.run(3);
    const Diagnosis d = diagnose(cars, line.carriers, door_patterns());
    ASSERT_EQ(d.changes.size(), 1u);
    const Change& change = d.changes.front();
    EXPECT_EQ(change.what, Moved::carrier);
    EXPECT_EQ(change.carrier, 7u);
    EXPECT_EQ(change.first_car, 237u);
    EXPECT_EQ(change.elements.front().element, 4u);
    EXPECT_GT(change.elements.front().probability, 0.95);
    EXPECT_NEAR(change.elements.front().amount_mm(0), 0.4, 4 * change.elements.front().sigma_mm(0));
    EXPECT_LT(change.elements.front().sigma_mm(0), 0.06);
}

TEST(Moved, TheCellMovesAllCarriersAlike) {
    Line line;
    line.cell_shift = {0.1, -0.05, 0.15};
    line.cell_from = 200;
    const Diagnosis d = diagnose(line.run(5), line.carriers, door_patterns());
    ASSERT_EQ(d.changes.size(), 1u);
    EXPECT_EQ(d.changes.front().what, Moved::cell);
    EXPECT_EQ(d.changes.front().how, MovedBy::step);
    EXPECT_TRUE(d.changes.front().elements.empty());
    EXPECT_NEAR(d.changes.front().motion(2), 0.15, 0.03);

    Line drifting;
    drifting.cell_drift_mm_per_car = 0.0005;
    const Diagnosis slow = diagnose(drifting.run(6), drifting.carriers, door_patterns());
    ASSERT_GE(slow.changes.size(), 1u);
    EXPECT_EQ(slow.changes.front().what, Moved::cell);
    EXPECT_EQ(slow.changes.front().how, MovedBy::trend);
    EXPECT_NEAR(slow.changes.front().motion(0), 0.2, 0.04);
}

TEST(Moved, AFaultAndACellDriftAreBothFound) {
    Line line;
    line.faults = {{2, 0, 0.5, 150}};
    line.cell_shift = {0, 0.2, 0};
    line.cell_from = 300;
    const Diagnosis d = diagnose(line.run(8), line.carriers, door_patterns());
    ASSERT_EQ(d.changes.size(), 2u);
    const std::size_t carrier = d.changes[0].what == Moved::carrier ? 0 : 1;
    EXPECT_EQ(d.changes[carrier].carrier, 2u);
    EXPECT_EQ(d.changes[carrier].elements.front().element, 0u);
    EXPECT_EQ(d.changes[1 - carrier].what, Moved::cell);
}

TEST(Moved, SingleOddCarsAreNoChange) {
    Line line;
    auto cars = line.run(9);
    for (const std::size_t k : {55u, 131u, 260u})
        cars[k].at += (Vector6() << 2, -3, 5, 1e-3, 0, -2e-3).finished();
    const Diagnosis d = diagnose(cars, line.carriers, door_patterns());
    EXPECT_TRUE(d.changes.empty());
    EXPECT_EQ(d.odd_cars, 3u);
}

TEST(Moved, WhatTheLeversDoNotTellApartIsSaid) {
    // Two locators at one place, one direction: nothing tells which gave way, ever.
    auto elements = std::vector<HoldingElement>{};
    for (const Locator& l : door_locators()) elements.push_back({l.p, {l.n}});
    elements.push_back(elements[3]);
    const auto patterns = fixture_patterns(elements);
    ASSERT_EQ(patterns.status, FixtureStatus::ok);
    Matrix6 car = Matrix6::Zero();
    car.diagonal() << 0.01, 0.01, 0.01, 1e-8, 1e-8, 1e-8;
    EXPECT_TRUE(std::isinf(cars_to_tell_apart(patterns.elements[3], patterns.elements[6], car, 0.5)));
    EXPECT_LT(cars_to_tell_apart(patterns.elements[0], patterns.elements[5], car, 0.5), 10);
    // A measurement ten times as noisy takes a hundred times as many cars.
    const double few = cars_to_tell_apart(patterns.elements[0], patterns.elements[1], car, 0.01);
    EXPECT_NEAR(cars_to_tell_apart(patterns.elements[0], patterns.elements[1], 100 * car, 0.01) / few, 100,
                1);
}

TEST(Moved, TooFewCarsSayNothing) {
    Line line;
    line.cars = 25;
    EXPECT_EQ(diagnose(line.run(1), line.carriers, door_patterns()).status, DiagnosisStatus::too_few);
    EXPECT_EQ(diagnose({}, 1, door_patterns()).status, DiagnosisStatus::too_few);
}

TEST(Moved, CarriersThatDifferFromTheBeginningAreNoChange) {
    Line line;  // 0.3 mm from carrier to carrier, as they were built
    const Diagnosis d = diagnose(line.run(21), line.carriers, door_patterns());
    EXPECT_TRUE(d.changes.empty());
    double largest = 0;
    for (const CarrierEffect& e : d.carriers) largest = std::max(largest, e.motion.head<3>().norm());
    EXPECT_GT(largest, 0.2);
}

}  // namespace
}  // namespace seamwright
