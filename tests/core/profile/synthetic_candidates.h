#pragma once
// Stripe candidates with known truth: a stripe of several pieces and reflections of it, as a camera sees them
// on shiny sheet metal. For the tests and benchmarks of stripe tracking.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "core/profile/profile.h"

namespace seamwright::synthetic {

struct Scenery {
    int lines = 1024, per_line = 3;
    double pitch = 1;             // distance of lines: 1 px, or mm
    double noise = 0.15;          // in pitches
    double bright_share = 0.3;    // of the lines where a reflection outshines the stripe
    bool parallel = true;         // a reflection at constant distance
    bool crossing = true;         // one that crosses the stripe
    double missing_share = 0.04;  // stretches without stripe
    double clutter_share = 0.1;   // single false candidates
    bool shuffled = true;
    int jumps = 0;  // steps of the stripe, which its reflection takes too
};

struct Scene {
    ProfileCandidates candidates;
    std::vector<double> true_z;  // NaN: no stripe on this line
    double noise = 0;
};

inline Scene reflections(const Scenery& s, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(random); };
    std::normal_distribution<> normal;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    Scene scene;
    scene.noise = s.noise * s.pitch;
    auto& c = scene.candidates;
    c.lines = s.lines, c.per_line = s.per_line;
    c.count.assign(std::size_t(s.lines), 0);
    c.x_mm.assign(std::size_t(s.lines * s.per_line), nan), c.z_mm = c.x_mm;
    c.intensity.assign(c.x_mm.size(), 0.f);
    scene.true_z.assign(std::size_t(s.lines), nan);

    std::vector<int> jump_at;
    for (int k = 0; k < s.jumps; ++k) jump_at.push_back(int(uniform(0.1, 0.9) * s.lines));
    const double wave = uniform(20, 60), length = uniform(300, 900), phase = uniform(0, 6.28),
                 tilt = uniform(-0.4, 0.4);
    double offset = uniform(200, 300);
    struct Stretch {
        int from, to;
    };
    const auto stretches = [&](double share, int longest) {
        std::vector<Stretch> out;
        for (int budget = int(share * s.lines); budget > 0;) {
            const int n = std::min(budget, int(uniform(10, longest))), from = int(uniform(0, s.lines - n));
            out.push_back({from, from + n});
            budget -= n;
        }
        return out;
    };
    const auto within = [](const std::vector<Stretch>& list, int line) {
        return std::any_of(list.begin(), list.end(),
                           [&](Stretch t) { return line >= t.from && line < t.to; });
    };
    const auto bright = stretches(s.bright_share, 120), missing = stretches(s.missing_share, 25);
    const auto parallel = stretches(0.7, 300);
    const double distance = (uniform(0, 1) < 0.5 ? -1 : 1) * uniform(8, 40);
    const double cross_slope = uniform(-0.5, 0.5), cross_at = uniform(0.2, 0.8) * s.lines;
    const int cross_half = int(uniform(60, 250));
    double cross_z = nan;
    for (int line = 0; line < s.lines; ++line) {
        if (std::count(jump_at.begin(), jump_at.end(), line))
            offset += (uniform(0, 1) < 0.5 ? -1 : 1) * uniform(12, 60);
        const double z = offset + tilt * line + wave * std::sin(2 * std::numbers::pi * line / length + phase);
        struct Peak {
            double z;
            float grey;
        };
        std::vector<Peak> peaks;
        const bool outshone = within(bright, line);
        if (!within(missing, line)) {
            scene.true_z[std::size_t(line)] = s.pitch * z;
            peaks.push_back({z + s.noise * normal(random), float(uniform(140, 180))});
        }
        const auto glare = [&] { return float(outshone ? uniform(200, 255) : uniform(40, 110)); };
        if (s.parallel && within(parallel, line))
            peaks.push_back({z + distance + s.noise * normal(random), glare()});
        if (s.crossing && std::abs(line - cross_at) < cross_half) {
            if (std::isnan(cross_z)) cross_z = z - (cross_slope - tilt) * cross_half;
            const double here = cross_z + cross_slope * (line - cross_at + cross_half);
            if (std::abs(here - z) > 2) peaks.push_back({here + s.noise * normal(random), glare()});
        }
        if (uniform(0, 1) < s.clutter_share) peaks.push_back({uniform(0, 600), glare()});
        // A frame keeps the strongest ones.
        std::sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) { return a.grey > b.grey; });
        if (int(peaks.size()) > s.per_line) peaks.resize(std::size_t(s.per_line));
        if (s.shuffled) std::shuffle(peaks.begin(), peaks.end(), random);
        c.count[std::size_t(line)] = std::uint8_t(peaks.size());
        for (std::size_t k = 0; k < peaks.size(); ++k) {
            const std::size_t slot = std::size_t(c.index(line, int(k)));
            c.x_mm[slot] = s.pitch * line, c.z_mm[slot] = s.pitch * peaks[k].z,
            c.intensity[slot] = peaks[k].grey;
        }
    }
    return scene;
}

// What a reader of one peak per line would take.
inline Profile strongest(const ProfileCandidates& c) {
    Profile p;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    p.x_mm.assign(std::size_t(c.lines), nan), p.z_mm = p.x_mm;
    p.segment.assign(std::size_t(c.lines), kOutlier);
    for (int line = 0; line < c.lines; ++line) {
        int best = -1;
        for (int k = 0; k < c.count[std::size_t(line)]; ++k)
            if (best < 0 || c.intensity[std::size_t(c.index(line, k))] > c.intensity[std::size_t(best)])
                best = c.index(line, k);
        if (best < 0) continue;
        p.x_mm[std::size_t(line)] = c.x_mm[std::size_t(best)],
        p.z_mm[std::size_t(line)] = c.z_mm[std::size_t(best)];
        p.segment[std::size_t(line)] = 0;
    }
    return p;
}

// Share of the lines with a stripe candidate on which a profile has the stripe, accepted.
struct KeptShare {
    int lines = 0, kept = 0, wrong = 0;
    void add(const Scene& s, const Profile& p) {
        for (std::size_t k = 0; k < s.true_z.size(); ++k) {
            bool offered = false;
            for (int c = 0; c < s.candidates.count[k]; ++c)
                offered |= std::abs(s.candidates.z_mm[std::size_t(s.candidates.index(int(k), c))] -
                                    s.true_z[k]) < 6 * s.noise;
            if (!offered) continue;
            ++lines;
            const bool right = std::abs(p.z_mm[k] - s.true_z[k]) < 6 * s.noise;
            kept += right && p.segment[k] >= 0;
            wrong += !right && p.segment[k] >= 0;
        }
    }
    double share() const { return lines ? double(kept) / lines : 1; }
};

}  // namespace seamwright::synthetic
