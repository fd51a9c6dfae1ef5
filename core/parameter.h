#pragma once
// One description of a setting: validation, command-line help and screen editors all read it.

#include <map>
#include <string>
#include <vector>

#include "core/error.h"

namespace seamwright {

struct ParameterInfo {
    std::string name;  // as in files and flags: "window_left_mm"
    std::string unit;  // "mm", "deg", "px", "" (dimensionless)
    double minimum = 0, maximum = 0, default_value = 0;
    int decimals = 3;
    std::string help;  // one sentence
    // A choice by name ("left", "right"): the value is the index, minimum 0 and maximum size - 1. Empty: a
    // number.
    std::vector<std::string> choices = {};
};

// Settings by name; what is absent has its default.
using ParameterValues = std::map<std::string, double>;

// The value or its default. Precondition (asserted): `name` is described in `infos`.
double parameter(const ParameterValues& values, const std::vector<ParameterInfo>& infos,
                 const std::string& name);

// Refuses unknown names, non-finite values and values out of range, naming parameter, range and unit.
Expected<void> validate(const ParameterValues& values, const std::vector<ParameterInfo>& infos,
                        const Text& where);

}  // namespace seamwright
