#include "core/features/kinds/feature_registry.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/features/kinds/feature_kinds.h"

namespace seamwright {

const std::vector<FeatureKind>& feature_kinds() {
    static const std::vector<FeatureKind> kinds{
        contour_end_kind(), corner_kind(),   circle_kind(),
        extremum_kind(),    template_kind(), sensor_point_kind(),
    };
    return kinds;
}

const FeatureKind* feature_kind(std::string_view name) {
    const auto& kinds = feature_kinds();
    const auto it =
        std::find_if(kinds.begin(), kinds.end(), [&](const FeatureKind& k) { return k.name == name; });
    return it == kinds.end() ? nullptr : &*it;
}

Expected<std::unique_ptr<FeatureFinder>> make_feature_finder(const FeatureRecipe& recipe) {
    const FeatureKind* kind = feature_kind(recipe.kind);
    if (!kind) {
        std::string known;
        for (const FeatureKind& k : feature_kinds())
            known += (known.empty() ? "" : ", ") + std::string(k.name);
        return input_error(Text("unknown kind of feature \"{}\"", recipe.kind), "kind",
                           Text("known are: {}", known));
    }
    SEAM_OK(validate(recipe.parameters, kind->parameters, std::string(kind->name)));
    return kind->make(recipe);
}

SearchWindow search_window(const FeatureRecipe& recipe) {
    if (recipe.kind == template_kind().name) return template_window(recipe.parameters);
    SearchWindow window;
    window.dx_mm = window.dz_mm = 20;
    return window;
}

}  // namespace seamwright
