#include "core/profile/contour_sequence.h"

namespace seamwright {
namespace {

using namespace contour;

constexpr double kAbsurd = 1e100;
constexpr double kBeyondReach = 1e300;  // squared distance of a candidate that no track takes

// Costs in the filter's unit (half a squared sigma; "outliers" are m.outlier_cost of it), set so that the
// right explanation of a frame with reflections is the cheapest. What tells a reflection from the stripe:
//   - it begins or ends while the stripe goes on: leaving a track before its end, or entering one behind its
//     beginning, costs more than a step of the stripe, where one track ends and another begins;
//   - it stands far off: a step costs by the logarithm of its size;
//   - it is brighter or darker than the stripe is nearby. Being the strongest of a line says nothing.
constexpr double kSkipOpen = 1, kSkipLine = 2, kSkipMost = 60;  // of lines left out in a row
constexpr double kEdge = 5, kJump = 2.5;  // of a sharp edge and a new segment, in outliers
constexpr double kJumpSize = 0.75;        // of each factor e in the distance of a new segment, in outliers
constexpr double kUnfinished = 10;        // of leaving or entering a track in its middle, in outliers
constexpr int kWholeTrack = 24;           // points of a track passed over from which that is its middle
constexpr int kWindow = 40;               // lines over which the stripe may be lost and found again
constexpr int kTrackGap = 6;              // lines over which a track may be interrupted
constexpr double kReflection = 2.5;       // of a candidate of a track that another one outlasts, per line:
    // more than leaving the line out, however the stripe is broken there
constexpr int kOutlasts = 12;  // lines by which a stretch is shorter than another at an end
constexpr int kAlone = 30;     // of the kWindow lines beyond its end, on which the other one is seen alone
constexpr double kSideBySide = 0.08;  // share of the shorter one's lines on which both are seen
constexpr double kIntensityCost = 1;  // of a candidate of foreign brightness
constexpr double kForeign = 0.7;      // logarithm of the brightness ratio from which it is foreign,
constexpr double kForeignSpread = 3;  // or, far from lines that tell, this many of their deviations
constexpr double kBrightLines = 64;   // over which brightness is averaged
constexpr double kDimmest = 1e-3, kBrightest = 1e9;  // grey values, whatever a caller hands in
constexpr double kBrightPrior = 8;                   // weight of the whole frame's, in lines
constexpr double kOneOfMany = 1e-3;  // weight of a line's strongest: it speaks where no line has but one

// A stretch of candidates that continue each other smoothly, whatever they are: stripe or reflection.
struct Track {
    State state;
    int last = 0;    // candidate
    int points = 0;  // so far
    int first = 0;   // candidate
    int piece = 0;   // what it is a piece of: see join_tracks()
};

// Tracks that one straight on from the other joins across lines where neither is seen.
struct Stretch {
    int points = 0, first_line = 0, last_line = 0;
    bool reflection = false;
};

struct Tracks {
    std::vector<Track> tracks;
    std::vector<int> open;                 // tracks that may still continue
    std::vector<int> track_of, number_of;  // per candidate: its track, and how many of it come before
    std::vector<Stretch> stretches;
    std::vector<int> order;         // of the tracks long enough for one, by their first line
    std::vector<Candidate> hidden;  // from the filter: reflections that a line shows
    std::vector<int> beside;        // per stretch: lines on which it and the present one are seen
    struct Pair {
        double d2;
        int track, candidate;
    };
    std::vector<Pair> pairs;
};

// Follows every track from line to line, each candidate going to the track that predicts it best.
void follow_tracks(const Workspace& w, const Model& m, Tracks& t) {
    t.tracks.clear(), t.open.clear();
    t.track_of.assign(w.candidates.size(), -1);
    t.number_of.assign(w.candidates.size(), 0);
    for (std::size_t line = 0; line + 1 < w.first.size(); ++line) {
        const int begin = w.first[line], end = w.first[line + 1];
        const int here = w.candidates[std::size_t(begin)].line;
        std::erase_if(t.open, [&](int k) {
            return here - w.candidates[std::size_t(t.tracks[std::size_t(k)].last)].line > kTrackGap;
        });
        t.pairs.clear();
        for (const int k : t.open) {
            const Track& track = t.tracks[std::size_t(k)];
            const int i = here - w.candidates[std::size_t(track.last)].line;
            for (int c = begin; c < end; ++c) {
                const Candidate& p = w.candidates[std::size_t(c)];
                double d2;
                if (track.state.age < 2) {
                    const double ratio = reach_ratio(m, track.state, p.x, p.z, i);
                    d2 = ratio < 1 ? m.outlier_cost * (1 + ratio) : kBeyondReach;
                } else {
                    d2 = deviation(m, track.state, p.x, p.z, i).d2;
                }
                if (d2 < 2 * m.outlier_cost) t.pairs.push_back({d2, k, c});
            }
        }
        std::sort(t.pairs.begin(), t.pairs.end(),
                  [](const Tracks::Pair& a, const Tracks::Pair& b) { return a.d2 < b.d2; });
        for (const auto& pair : t.pairs) {
            Track& track = t.tracks[std::size_t(pair.track)];
            const Candidate& p = w.candidates[std::size_t(pair.candidate)];
            const int i = here - w.candidates[std::size_t(track.last)].line;
            if (i == 0 || t.track_of[std::size_t(pair.candidate)] >= 0) continue;
            if (track.state.age < 2)
                accept_any_direction(m, track.state, p.x, p.z, i);
            else
                accept(m, track.state, deviation(m, track.state, p.x, p.z, i), i);
            t.track_of[std::size_t(pair.candidate)] = pair.track;
            t.number_of[std::size_t(pair.candidate)] = track.points++;
            track.last = pair.candidate;
        }
        for (int c = begin; c < end; ++c) {
            if (t.track_of[std::size_t(c)] >= 0) continue;
            const Candidate& p = w.candidates[std::size_t(c)];
            t.track_of[std::size_t(c)] = int(t.tracks.size());
            t.open.push_back(int(t.tracks.size()));
            t.tracks.push_back({first_point(m, p.x, p.z), c, 1, c, -1});
        }
    }
}

// Tracks of which one begins where the other's end points to, up to kWindow lines farther on: a stripe that is broken
// by what outshines it is one all the same.
void join_tracks(const Workspace& w, const Model& m, Tracks& t) {
    constexpr int kFewest = 6;     // points that know a direction
    constexpr int kAtOnce = 3;     // lines
    constexpr double kAim = 0.03;  // rad, what a contour may turn where it is not seen
    t.stretches.clear();
    t.order.clear();
    for (std::size_t k = 0; k < t.tracks.size(); ++k)
        if (t.tracks[k].points >= kFewest) t.order.push_back(int(k));
    const auto line_of = [&](int candidate) { return w.candidates[std::size_t(candidate)].line; };
    // Tracks rise with their first candidate, so with their first line.
    for (const int k : t.order) {
        Track& track = t.tracks[std::size_t(k)];
        const Candidate& begin = w.candidates[std::size_t(track.first)];
        double nearest = 1;
        for (const int j : t.order) {
            if (j >= k) break;
            const Track& before = t.tracks[std::size_t(j)];
            const Stretch& stretch = t.stretches[std::size_t(before.piece)];
            const int i = begin.line - line_of(before.last);
            if (i < 1 || i > kWindow || stretch.last_line != line_of(before.last)) continue;
            const double gone = i * before.state.spacing();
            const double off = std::hypot(begin.x - before.state.x - i * before.state.vx,
                                          begin.z - before.state.z - i * before.state.vz);
            const double within = m.band * m.scale.largest() * std::sqrt(1 + before.state.p11) + kAim * gone +
                                  0.5 * m.scale.spacing;
            if (off / within < nearest) nearest = off / within, track.piece = before.piece;
        }
        // Or at a sharp edge or a step of the contour: one ends where the other begins.
        if (track.piece < 0 && track.points >= kWholeTrack) {
            double least = std::numeric_limits<double>::infinity();
            for (const int j : t.order) {
                if (j >= k) break;
                const Track& before = t.tracks[std::size_t(j)];
                const int i = begin.line - line_of(before.last);
                if (i < 1 || i > kAtOnce || before.points < kWholeTrack ||
                    t.stretches[std::size_t(before.piece)].last_line != line_of(before.last))
                    continue;
                const double step = std::hypot(begin.x - before.state.x, begin.z - before.state.z);
                if (step < least) least = step, track.piece = before.piece;
            }
        }
        if (track.piece < 0) {
            track.piece = int(t.stretches.size());
            t.stretches.push_back({0, begin.line, 0, false});
        }
        Stretch& stretch = t.stretches[std::size_t(track.piece)];
        stretch.points += track.points;
        stretch.last_line = std::max(stretch.last_line, line_of(track.last));
    }
}

// A reflection begins or ends where the stripe goes on: a stretch that another one, seen beside it here and there,
// outlasts at one end at least, alone there, and does not fall short of at the other. At a step or at the field's rim
// both may end.
void find_reflections(const Workspace& w, Tracks& t) {
    const auto piece_of = [&](int c) { return t.tracks[std::size_t(t.track_of[std::size_t(c)])].piece; };
    // Lines from..to on which the stretch is seen and no other one. A stripe that is interrupted has its reflection to
    // itself for a while, and then both go on.
    const auto alone = [&](int from, int to, int piece) {
        int lines = 0;
        for (std::size_t k = 0; k + 1 < w.first.size(); ++k) {
            const int line = w.candidates[std::size_t(w.first[k])].line;
            if (line < from || line > to) continue;
            bool here = false, others = false;
            for (int c = w.first[k]; c < w.first[k + 1]; ++c) {
                const int other = piece_of(c);
                here |= other == piece;
                others |=
                    other >= 0 && other != piece && t.stretches[std::size_t(other)].points >= kWholeTrack;
            }
            lines += here && !others;
        }
        return lines;
    };
    for (std::size_t a = 0; a < t.stretches.size(); ++a) {
        Stretch& s = t.stretches[a];
        if (s.points < kWholeTrack) continue;
        t.beside.assign(t.stretches.size(), 0);
        for (std::size_t line = 0; line + 1 < w.first.size(); ++line) {
            bool seen = false;
            for (int c = w.first[line]; c < w.first[line + 1]; ++c) seen |= piece_of(c) == int(a);
            if (!seen) continue;
            for (int c = w.first[line]; c < w.first[line + 1]; ++c) {
                const int other = piece_of(c);
                if (other < 0 || other == int(a)) continue;
                ++t.beside[std::size_t(other)];
            }
        }
        for (std::size_t b = 0; b < t.stretches.size(); ++b) {
            const Stretch& o = t.stretches[b];
            if (b == a || o.points < kWholeTrack || t.beside[b] < std::max(4., kSideBySide * s.points))
                continue;
            if (std::min(s.first_line - o.first_line, o.last_line - s.last_line) <= -kOutlasts) continue;
            if (alone(s.first_line - kWindow, s.first_line - 1, int(b)) >= kAlone ||
                alone(s.last_line + 1, s.last_line + kWindow, int(b)) >= kAlone)
                s.reflection = true;
        }
    }
}

// Frames of one size differ in their number of candidates; room for the most there can be.
void reserve(Workspace& w, Tracks& t, std::size_t lines, std::size_t per_line) {
    const std::size_t all = lines * per_line, open = (kTrackGap + 1) * std::min<std::size_t>(per_line, 255);
    w.candidates.reserve(all), w.nodes.reserve(all), w.chosen.reserve(all);
    w.enter.reserve(all), w.leave.reserve(all);
    w.first.reserve(lines + 1), w.path.reserve(lines);
    w.samples_x.reserve(lines), w.samples_z.reserve(lines);
    t.tracks.reserve(all), t.track_of.reserve(all), t.number_of.reserve(all);
    t.stretches.reserve(all / 6), t.order.reserve(all / 6), t.beside.reserve(all / 6);
    t.hidden.reserve(lines);
    t.open.reserve(open), t.pairs.reserve(open * std::min<std::size_t>(per_line, 16));
}

// Turns the grey values in `cost` into costs. What the stripe looks like is learned from lines with one
// candidate only, near ones above all, and a reflection told by being brighter or darker than that; far from
// such lines their mean is the reference, as sharp as they agree with each other.
void price_brightness(Workspace& w) {
    const std::size_t lines = w.first.size() - 1;
    auto& sum = w.samples_x;
    auto& weight = w.samples_z;
    for (auto& p : w.candidates)
        p.cost = std::log(p.cost > kDimmest ? std::min(p.cost, kBrightest) : kDimmest);
    const auto only = [&](std::size_t k) { return w.first[k + 1] - w.first[k] == 1; };
    double mean = 0, square = 0, lone = 0;
    for (std::size_t k = 0; k < lines; ++k) {
        const double level = w.candidates[std::size_t(w.path[k])].cost;
        const double share = only(k) ? 1 : kOneOfMany;
        mean += share * level, square += share * level * level, lone += share;
    }
    mean /= lone;
    const double spread = std::sqrt(std::max(0., square / lone - mean * mean));
    const double vague = std::max(kForeign, kForeignSpread * spread);
    sum.assign(lines, kBrightPrior * mean), weight.assign(lines, kBrightPrior);
    for (const bool backward : {false, true}) {
        double s = 0, n = 0;
        for (std::size_t i = 0; i < lines; ++i) {
            const std::size_t k = backward ? lines - 1 - i : i;
            if (only(k)) s += w.candidates[std::size_t(w.first[k])].cost, n += 1;
            sum[k] += s, weight[k] += n;
            s *= 1 - 1. / kBrightLines, n *= 1 - 1. / kBrightLines;
        }
    }
    for (std::size_t k = 0; k < lines; ++k) {
        const double usual = sum[k] / weight[k], unsure = kBrightPrior / weight[k];
        const double ratio = unsure * vague + (1 - unsure) * kForeign;
        for (int c = w.first[k]; c < w.first[k + 1]; ++c) {
            double& cost = w.candidates[std::size_t(c)].cost;
            cost = kIntensityCost * std::min(1., std::abs(cost - usual) / ratio);
        }
    }
}

Tracks& tracks() {
    thread_local Tracks t;
    return t;
}

Workspace& workspace() {
    thread_local Workspace w;
    return w;
}

}  // namespace

Expected<void> track_stripe(const ProfileCandidates& input, const FilterOptions& options, Profile& profile,
                            std::span<const signed char> known) {
    SEAM_OK(check(options));
    if (input.lines < 0 || input.per_line < 1)
        return input_error("the candidates have no lines or no room per line", "lines, per_line",
                           "give lines >= 0 and per_line >= 1");
    const std::size_t lines = std::size_t(input.lines), all = lines * std::size_t(input.per_line);
    if (input.count.size() != lines || input.x_mm.size() != all || input.z_mm.size() != all ||
        (!input.intensity.empty() && input.intensity.size() != all) ||
        (!known.empty() && known.size() != all))
        return input_error("the arrays of the candidates differ in length", "count, x_mm, z_mm, intensity",
                           "give lines counts and lines * per_line values");

    Workspace& w = workspace();
    Tracks& all_tracks = tracks();
    all_tracks.hidden.clear();
    reserve(w, all_tracks, lines, std::size_t(input.per_line));
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
    }
    w.first.push_back(int(w.candidates.size()));
    price_brightness(w);
    if (!w.candidates.empty()) {
        Model model(estimate_scale(w, w.path, false, options), options);
        // Leaving out a stretch must be cheaper than following a reflection there and coming back.
        model.skip_line = kSkipLine;
        model.skip_open = kSkipOpen;
        model.skip_most = kSkipMost;
        model.window = model.longest_gap = kWindow;
        model.jump_cost = kJump * model.outlier_cost;
        model.jump_size_cost = kJumpSize * model.outlier_cost;
        model.edge_cost = kEdge * model.outlier_cost;
        model.edge_window = 2;
        const auto known_of = [&](int c) {
            return known.empty() ? 0 : int(known[std::size_t(w.chosen[std::size_t(c)])]);
        };
        follow_tracks(w, model, all_tracks);
        join_tracks(w, model, all_tracks);
        find_reflections(w, all_tracks);
        const auto is_reflection = [&](int c) {
            if (const int k = known_of(c); k != 0) return k < 0;
            const int piece = all_tracks.tracks[std::size_t(all_tracks.track_of[std::size_t(c)])].piece;
            return piece >= 0 && all_tracks.stretches[std::size_t(piece)].reflection;
        };
        for (std::size_t c = 0; c < w.candidates.size(); ++c) {
            if (known_of(int(c)) > 0) w.candidates[c].cost = 0;
            if (is_reflection(int(c))) w.candidates[c].cost += kReflection;
        }
        w.enter.resize(w.candidates.size()), w.leave.resize(w.candidates.size());
        const auto unfinished = [&](int points) {
            return kUnfinished * model.outlier_cost * std::min(1., double(points) / kWholeTrack);
        };
        for (std::size_t c = 0; c < w.candidates.size(); ++c) {
            const int number = all_tracks.number_of[c];
            w.enter[c] = unfinished(number);
            w.leave[c] =
                unfinished(all_tracks.tracks[std::size_t(all_tracks.track_of[c])].points - 1 - number);
        }
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
                if (is_reflection(c)) continue;
                const double t = double(p.line - a.line) / (b.line - a.line);
                const double distance = std::hypot(p.x - a.x - t * (b.x - a.x), p.z - a.z - t * (b.z - a.z));
                if (p.line == line && distance >= nearest) continue;
                line = p.line, nearest = distance;
                take(std::size_t(line), w.chosen[std::size_t(c)]);
            }
        }
        // Of lines left out the strongest is shown, but where that is a reflection the filter may not take it for a
        // contour of its own.
        for (const int c : w.path) all_tracks.track_of[std::size_t(c)] = -1;  // taken all the same
        for (std::size_t c = 0; c < w.candidates.size(); ++c) {
            const Candidate& p = w.candidates[c];
            const auto line = std::size_t(p.line);
            if (all_tracks.track_of[c] < 0 || !is_reflection(int(c)) || profile.x_mm[line] != p.x ||
                profile.z_mm[line] != p.z)
                continue;
            all_tracks.hidden.push_back(p);
            profile.z_mm[line] = nan;
        }
    }
    const auto filtered = filter_profile(profile, options);
    for (const Candidate& p : all_tracks.hidden) profile.z_mm[std::size_t(p.line)] = p.z;
    return filtered;
}

}  // namespace seamwright
