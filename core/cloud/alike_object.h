#pragma once
// What seamwright_alike.so (core/loaded_object.h) hands out, which alone links PCL's features; nobody but coarse.cpp calls it.

#include <vector>

#include "core/cloud/cloud.h"

namespace seamwright {

inline constexpr const char* kAlike = "seamwright_alike.so";

// For every point of `scan` those `count` of `part` whose surroundings look most alike, the most first, by fast point feature
// histograms within `radius_mm`. Both have normals. None for a point without a histogram; nothing at all where a point of the part
// has none.
extern "C" void seamwright_alike(const Cloud& scan, const Cloud& part, double radius_mm, int count,
                                 std::vector<std::vector<int>>& alike);

}  // namespace seamwright
