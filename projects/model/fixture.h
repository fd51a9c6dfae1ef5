#pragma once
// What holds a part in its carrier: the elements that place it, and how a part's name tells its carrier. What moved of
// it is told by projects/diagnosis/diagnosis.h.

#include <Eigen/Core>
#include <string>
#include <vector>

namespace seamwright {

// A place at which the part is held, and the directions in which it is held there: a locator one, a pin across its axis
// two, a hinge that carries three.
struct FixtureElement {
    std::string id;                                   // "locator 2"
    Eigen::Vector3d at_mm = Eigen::Vector3d::Zero();  // work object
    std::vector<Eigen::Vector3d> directions;  // unit, work object, at right angles to each other; 1 to 3
    bool operator==(const FixtureElement&) const = default;
};

struct Fixture {
    std::string id = "fixture";
    std::vector<FixtureElement> elements;
    // ECMAScript, searched in a part's name; its first group is the carrier: "-C([0-9]+)$". Empty: the parts name no
    // carrier, one fixture holds them all.
    std::string carrier_pattern;
    bool operator==(const Fixture&) const = default;
};

}  // namespace seamwright
