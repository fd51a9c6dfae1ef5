#include "app/cli/arguments/feature_setting.h"
#include "core/features/kinds/feature_registry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>

namespace seamwright::cli {

Expected<double> setting_value(const ParameterInfo& info, const std::string& text) {
    for (std::size_t i = 0; i < info.choices.size(); ++i)
        if (info.choices[i] == text) return static_cast<double>(i);
    double value = 0;
    const char* end = text.data() + text.size();
    auto [stop, failure] = std::from_chars(text.data(), end, value);
    if (failure != std::errc() || stop != end || text.empty())
        return usage_error(
            Text("\"{}\" is not {}", text,
                 info.choices.empty() ? "a number" : fmt::format("one of {}", fmt::join(info.choices, ", "))),
            info.name);
    return value;
}

Expected<double> feature_setting(const FeatureKind& kind, const std::string& name, const std::string& text) {
    auto info = std::find_if(kind.parameters.begin(), kind.parameters.end(),
                             [&](const ParameterInfo& p) { return p.name == name; });
    if (info == kind.parameters.end()) {
        std::vector<std::string> known;
        for (const ParameterInfo& p : kind.parameters) known.push_back(p.name);
        return usage_error(Text("the kind \"{}\" has no setting \"{}\"", kind.name, name), "",
                           Text("known are: {}", fmt::join(known, ", ")));
    }
    return setting_value(*info, text);
}

Expected<std::pair<std::string, double>> feature_setting(const FeatureKind& kind,
                                                         const std::string& assignment) {
    const std::size_t equals = assignment.find('=');
    if (equals == std::string::npos)
        return usage_error(Text("\"{}\" is not NAME=VALUE", assignment), "--set");
    const std::string name = assignment.substr(0, equals);
    SEAM_TRY(auto value, feature_setting(kind, name, assignment.substr(equals + 1)));
    return std::pair{name, value};
}

Expected<const FeatureKind*> find_feature_kind(const std::string& name) {
    if (const FeatureKind* kind = feature_kind(name)) return kind;
    std::vector<std::string_view> known;
    for (const FeatureKind& k : feature_kinds()) known.push_back(k.name);
    return usage_error(Text("unknown feature kind \"{}\"", name), "--kind",
                       Text("known are: {}", fmt::join(known, ", ")));
}

}  // namespace seamwright::cli
