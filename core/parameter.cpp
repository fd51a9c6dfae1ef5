#include "core/parameter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace seamwright {
namespace {

const ParameterInfo* find(const std::vector<ParameterInfo>& infos, const std::string& name) {
    auto it =
        std::find_if(infos.begin(), infos.end(), [&](const ParameterInfo& p) { return p.name == name; });
    return it == infos.end() ? nullptr : &*it;
}

}  // namespace

double parameter(const ParameterValues& values, const std::vector<ParameterInfo>& infos,
                 const std::string& name) {
    const ParameterInfo* info = find(infos, name);
    assert(info && "parameter is not described");
    auto it = values.find(name);
    return it == values.end() ? info->default_value : it->second;
}

Expected<void> validate(const ParameterValues& values, const std::vector<ParameterInfo>& infos,
                        const Text& where) {
    for (const auto& [name, value] : values) {
        const ParameterInfo* info = find(infos, name);
        if (!info) {
            std::string known;
            for (const auto& p : infos) known += (known.empty() ? "" : ", ") + p.name;
            return input_error(Text("unknown parameter \"{}\"", name), where, Text("known are: {}", known));
        }
        if (!std::isfinite(value) || value < info->minimum || value > info->maximum)
            return input_error(Text("{} = {} is out of range", name, value), where,
                               Text("give {} to {} {}", info->minimum, info->maximum, info->unit));
    }
    return {};
}

}  // namespace seamwright
