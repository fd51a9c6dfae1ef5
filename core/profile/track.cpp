#include "core/profile/contour_sequence.h"

namespace seamwright {
namespace {

using namespace contour;

constexpr double kAbsurd = 1e100;

// Costs in the filter's unit (half a squared sigma), set so that the right explanation of a frame with
// reflections is the cheapest: leaving out the lines where the stripe is missing and coming back must cost
// less than a new segment on a reflection and another one back, and a hundred lines of a reflection half as
// bright again must not pay for that.
constexpr double kIntensityCost = 1;  // of choosing a candidate of no intensity beside a strong one
constexpr double kSkipOpen = 1, kSkipLine = 2, kSkipMost = 60;  // of lines left out in a row
constexpr double kEdge = 5, kJump = 10;  // of a sharp edge and a new segment, in outliers
constexpr int kWindow = 40;              // lines over which the stripe may be lost and found again

Workspace& workspace() {
    thread_local Workspace w;
    return w;
}

}  // namespace

Expected<void> track_stripe(const ProfileCandidates& input, const FilterOptions& options, Profile& profile) {
    if (auto ok = check(options); !ok) return ok;
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
        Model model(estimate_scale(w, w.path, false, options), options);
        // Leaving out a stretch must be cheaper than following a reflection there and coming back.
        model.skip_line = kSkipLine;
        model.skip_open = kSkipOpen;
        model.skip_most = kSkipMost;
        model.window = model.longest_gap = kWindow;
        model.jump_cost = kJump * model.outlier_cost;
        model.edge_cost = kEdge * model.outlier_cost;
        model.edge_window = 2;
        cheapest_sequence(w, model);
        for (const int c : w.path)
            take(std::size_t(w.candidates[std::size_t(c)].line), w.chosen[std::size_t(c)]);
        // Lines left out between two of the path: the candidate nearest to the straight line between them.
        for (std::size_t k = 1; k < w.path.size(); ++k) {
            const int from = w.path[k - 1], to = w.path[k];
            const Candidate &a = w.candidates[std::size_t(from)], &b = w.candidates[std::size_t(to)];
            if (b.line - a.line > kWindow || w.nodes[std::size_t(to)].link == Link::start) continue;
            int line = -1;
            double nearest = 0;
            for (int c = from + 1; c < to; ++c) {
                const Candidate& p = w.candidates[std::size_t(c)];
                if (p.line == a.line || p.line == b.line) continue;
                const double t = double(p.line - a.line) / (b.line - a.line);
                const double distance = std::hypot(p.x - a.x - t * (b.x - a.x), p.z - a.z - t * (b.z - a.z));
                if (p.line == line && distance >= nearest) continue;
                line = p.line, nearest = distance;
                take(std::size_t(line), w.chosen[std::size_t(c)]);
            }
        }
    }
    return filter_profile(profile, options);
}

}  // namespace seamwright
