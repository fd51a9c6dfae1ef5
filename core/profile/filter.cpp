#include "core/profile/filter.h"

#include <cmath>

#include "core/profile/filtering/filter_steps.h"
#include "core/profile/no_return.h"

namespace seamwright {
namespace {

using namespace contour;

constexpr double kAbsurd = 1e100;  // coordinates beyond are no return: their squares would overflow

Workspace& workspace() {
    thread_local Workspace w;
    return w;
}

bool usable(double v) {
    return std::abs(v) < kAbsurd;
}  // false for NaN

}  // namespace

Expected<void> check(const FilterOptions& o) {
    const auto refuse = [](const char* what, const char* where, const char* mend) -> Expected<void> {
        return input_error(what, where, mend);
    };
    if (!(o.noise_mm >= 0) || !std::isfinite(o.noise_mm))
        return refuse("the noise is not a length", "noise_mm", "give 0 (estimate it) or a positive number");
    if (!(o.band_sigmas >= 1 && o.band_sigmas <= 20))
        return refuse("the acceptance band is out of range", "band_sigmas",
                      "give 1 to 20 standard deviations");
    if (o.lookahead < 1 || o.lookahead > 50)
        return refuse("the lookahead is out of range", "lookahead", "give 1 to 50 points");
    if (!(o.average > 0 && o.average <= 1))
        return refuse("the weight of the moving average is out of range", "average",
                      "give a number above 0, at most 1");
    if (!(o.initial_sigma > 0 && o.initial_sigma <= 2))
        return refuse("the initial sigma of the spacing is out of range", "initial_sigma",
                      "give a number above 0, at most 2");
    if (o.min_segment_points < 1)
        return refuse("the shortest segment has no point", "min_segment_points", "give 1 or more");
    return {};
}

Expected<void> filter_profile(Profile& profile, const FilterOptions& options) {
    SEAM_OK(check(options));
    const std::size_t n = profile.x_mm.size();
    if (profile.z_mm.size() != n || (!profile.intensity.empty() && profile.intensity.size() != n))
        return input_error("the columns of the profile differ in length", "x_mm, z_mm, intensity",
                           "give one x, one z and, if any, one intensity per point");
    profile.segment.assign(n, kOutlier);
    if (const auto codes = find_no_return_codes(profile); !codes.empty())
        for (const NoReturnCode& c : codes) erase_no_returns(profile, {c.value});

    Workspace& w = workspace();
    w.candidates.clear(), w.first.clear(), w.path.clear();
    for (std::size_t k = 0; k < n; ++k) {
        if (!usable(profile.x_mm[k]) || !usable(profile.z_mm[k])) continue;
        w.first.push_back(int(w.candidates.size()));
        w.path.push_back(int(w.candidates.size()));
        w.candidates.push_back({profile.x_mm[k], profile.z_mm[k], 0, int(k)});
    }
    w.first.push_back(int(w.candidates.size()));
    if (w.candidates.empty()) return {};
    if (options.as_delivered) {
        for (const auto& c : w.candidates) profile.segment[static_cast<std::size_t>(c.line)] = 0;
        return {};
    }

    const Model rough(estimate_scale(w, w.path, false, options), options);
    cheapest_sequence(w, rough);
    const Model model(estimate_scale(w, w.path, true, options), options);
    take_in_rows(w, model, options.lookahead, options.min_segment_points);
    run_backward(w, model);
    const int pieces = verify(w, model);
    settle_doubtful(w, model);
    number_segments(w, model, pieces, options.min_segment_points, profile);
    settle_borders(w, model, profile.segment);
    return {};
}

}  // namespace seamwright
