#include "core/profile/contour_sequence.h"

namespace seamwright {
namespace {

using namespace contour;

constexpr double kAbsurd = 1e100;
// Preference for the stronger candidate, in units of squared sigma: so small that a hundred lines of a
// reflection twice as bright do not pay for leaving the stripe and coming back.
constexpr double kIntensityCost = 0.1;

Workspace& workspace() {
    thread_local Workspace w;
    return w;
}

}  // namespace

Expected<void> track_stripe(const ProfileCandidates& input, const FilterOptions& options, Profile& profile) {
    if (input.lines < 0 || input.per_line < 1)
        return input_error("the candidates have no lines or no room per line", "lines, per_line",
                           "give lines >= 0 and per_line >= 1");
    const std::size_t lines = std::size_t(input.lines), all = lines * std::size_t(input.per_line);
    if (input.count.size() != lines || input.x_mm.size() != all || input.z_mm.size() != all ||
        (!input.intensity.empty() && input.intensity.size() != all))
        return input_error("the arrays of the candidates differ in length", "count, x_mm, z_mm, intensity",
                           "give lines counts and lines * per_line values");

    Workspace& w = workspace();
    w.candidates.clear(), w.first.clear(), w.path.clear();
    w.chosen.clear();  // slot of each candidate
    const double nan = std::numeric_limits<double>::quiet_NaN();
    profile.x_mm.assign(lines, nan), profile.z_mm.assign(lines, nan);
    if (input.intensity.empty())
        profile.intensity.clear();
    else
        profile.intensity.assign(lines, 0.f);
    const auto take = [&](std::size_t line, int slot) {
        profile.x_mm[line] = input.x_mm[std::size_t(slot)],
        profile.z_mm[line] = input.z_mm[std::size_t(slot)];
        if (!input.intensity.empty()) profile.intensity[line] = input.intensity[std::size_t(slot)];
    };
    for (int line = 0; line < input.lines; ++line) {
        if (input.count[std::size_t(line)] > input.per_line)
            return input_error("a line has more candidates than room", "count[" + std::to_string(line) + "]",
                               "raise per_line");
        const int begin = int(w.candidates.size());
        double strongest = 0;
        int best = -1;
        for (int c = 0; c < input.count[std::size_t(line)]; ++c) {
            const int slot = input.index(line, c);
            const double x = input.x_mm[std::size_t(slot)], z = input.z_mm[std::size_t(slot)];
            if (!(std::abs(x) < kAbsurd) || !(std::abs(z) < kAbsurd)) continue;
            const double grey = input.intensity.empty() ? 1 : double(input.intensity[std::size_t(slot)]);
            if (best < 0 || grey > strongest) strongest = grey, best = int(w.candidates.size());
            w.candidates.push_back({x, z, grey, line});
            w.chosen.push_back(slot);
        }
        if (best < 0) continue;
        w.first.push_back(begin);
        w.path.push_back(best);
        take(std::size_t(line), w.chosen[std::size_t(best)]);
        for (std::size_t c = std::size_t(begin); c < w.candidates.size(); ++c) {
            const double share = strongest > 0 ? std::clamp(w.candidates[c].cost / strongest, 0., 1.) : 1;
            w.candidates[c].cost = kIntensityCost * (1 - share);
        }
    }
    w.first.push_back(int(w.candidates.size()));
    if (!w.candidates.empty()) {
        const Model model(estimate_scale(w, w.path, false, options), options);
        cheapest_sequence(w, model, options.lookahead);
        for (const int c : w.path)
            take(std::size_t(w.candidates[std::size_t(c)].line), w.chosen[std::size_t(c)]);
    }
    return filter_profile(profile, options);
}

}  // namespace seamwright
