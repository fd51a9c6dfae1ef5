#include "core/panel/double_head.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>

#include "core/median.h"
#include "core/profile/no_return.h"

namespace seamwright {
namespace {

constexpr int kSharedCellsOfOneSegment = 3;
constexpr int kDirectionCells = 5;  // to either side, for the direction of the contour in a cell
// A step that the heads see at different places.
constexpr int kStepCells = 8, kFewestStepCells = 3;           // of a surface beside it, for its line
constexpr double kStepSigma = 6;                              // of a shared cell's distance
constexpr double kOnTheLine = 0.3;                            // of the step
constexpr std::size_t kFewestOfTwo = 64, kFewestOfOne = 256;  // lines

struct Point {
    double x, z;
    float intensity;
    int piece;  // of both heads, counted through
    double weight;
};

struct Side {
    std::vector<Point> points;  // in sensor order
    double pitch = 0;
    double off_plane = 0;
    std::array<int, 2> empty{};  // lines without a usable return beyond the points, towards -x and +x
    bool every_line = false;     // the profile lists them
};

// The points of one head in a cell that belong to one piece.
struct Group {
    int piece, head, count = 0;
    std::vector<Point> points{};
    double x = 0, z = 0, weight = 0;
};

struct Shared {
    std::int64_t cell;
    const Group *first, *second;
    Eigen::Vector2d mean;
    double weight;
};

Expected<void> check_head(const Profile& profile, const Head& head, const Text& where) {
    const std::size_t n = profile.x_mm.size();
    if (profile.z_mm.size() != n || (!profile.intensity.empty() && profile.intensity.size() != n))
        return input_error("the columns of the profile differ in length", where);
    if (n > 0 && !profile.filtered())
        return input_error("the profile is not filtered", where, "filter it before the heads are merged");
    SEAM_OK(pose_from_matrix(head.sensor_from_head.matrix(), where));
    if (!(head.sigma_mm > 0) || !std::isfinite(head.sigma_mm))
        return input_error(Text("sigma of {} mm is not positive", head.sigma_mm), where,
                           "state the standard deviation of a point");
    return {};
}

Side side_of(const Profile& profile, const Head& head, int first_piece, int& pieces) {
    Side side;
    std::map<std::int32_t, int> piece_of;
    std::vector<double> steps;
    std::size_t first = profile.size(), last = 0;
    for (std::size_t i = 0; i < profile.size(); ++i) {
        const double x = profile.x_mm[i], z = profile.z_mm[i];
        if (profile.segment[i] == kOutlier || !std::isfinite(x) || !std::isfinite(z)) continue;
        first = std::min(first, i);
        last = i;
        const Eigen::Vector3d p = head.sensor_from_head * Eigen::Vector3d(x, 0, z);
        const int piece =
            piece_of.try_emplace(profile.segment[i], first_piece + static_cast<int>(piece_of.size()))
                .first->second;
        if (!side.points.empty() && side.points.back().piece == piece)
            steps.push_back(std::hypot(p.x() - side.points.back().x, p.z() - side.points.back().z));
        side.off_plane = std::max(side.off_plane, std::abs(p.y()));
        side.points.push_back({p.x(), p.z(), profile.intensity.empty() ? 0.f : profile.intensity[i], piece,
                               1 / (head.sigma_mm * head.sigma_mm)});
    }
    pieces = static_cast<int>(piece_of.size());
    if (!steps.empty()) {
        const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
        std::nth_element(steps.begin(), middle, steps.end());
        side.pitch = *middle;
    }
    if (!side.points.empty()) {
        side.empty = {static_cast<int>(first), static_cast<int>(profile.size() - 1 - last)};
        if (side.points.front().x > side.points.back().x) std::swap(side.empty[0], side.empty[1]);
    }
    return side;
}

// Cell -> groups, the points of a group in an order that does not depend on how they came.
using Cells = std::map<std::int64_t, std::vector<Group>>;

void add_to(Cells& cells, const Side& side, int head, double pitch) {
    for (const Point& p : side.points) {
        auto& groups = cells[static_cast<std::int64_t>(std::floor(p.x / pitch))];
        auto group =
            std::find_if(groups.begin(), groups.end(), [&](const Group& g) { return g.piece == p.piece; });
        if (group == groups.end()) group = groups.insert(groups.end(), Group{p.piece, head});
        group->points.push_back(p);
    }
}

void close(Cells& cells) {
    for (auto& [cell, groups] : cells)
        for (Group& g : groups) {
            std::sort(g.points.begin(), g.points.end(),
                      [](const Point& a, const Point& b) { return std::tie(a.x, a.z) < std::tie(b.x, b.z); });
            for (const Point& p : g.points) {
                g.x += p.weight * p.x;
                g.z += p.weight * p.z;
                g.weight += p.weight;
                ++g.count;
            }
            g.x /= g.weight;
            g.z /= g.weight;
        }
}

// The nearest pair of the two heads in each cell. Cells where both see something, but nothing in common, are
// counted in `contradicting`.
std::vector<Shared> share(const Cells& cells, int& contradicting) {
    std::vector<Shared> out;
    for (const auto& [cell, groups] : cells) {
        std::optional<Shared> best;
        double nearest = kSameSurfaceMm;
        bool both = false;
        for (const Group& a : groups)
            for (const Group& b : groups) {
                if (a.head != 0 || b.head != 1) continue;
                both = true;
                const double off = std::abs(b.z - a.z);
                if (off > nearest) continue;
                nearest = off;
                const double w = a.weight + b.weight;
                best = Shared{
                    cell, &a, &b,
                    Eigen::Vector2d(a.weight * a.x + b.weight * b.x, a.weight * a.z + b.weight * b.z) / w, w};
            }
        if (best)
            out.push_back(*best);
        else
            contradicting += both;
    }
    return out;
}

// Across the contour around cell k, on the sensor's side.
Eigen::Vector2d normal_at(const std::vector<Shared>& shared, std::size_t k) {
    const auto reach = static_cast<std::size_t>(kDirectionCells);
    const std::size_t from = k > reach ? k - reach : 0, to = std::min(shared.size(), k + reach + 1);
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();
    int n = 0;
    const auto same = [&](std::size_t i) {
        return shared[i].first->piece == shared[k].first->piece &&
               shared[i].second->piece == shared[k].second->piece;
    };
    for (std::size_t i = from; i < to; ++i)
        if (same(i)) {
            centre += shared[i].mean;
            ++n;
        }
    centre /= n;
    double xx = 0, xz = 0, zz = 0;
    for (std::size_t i = from; i < to; ++i)
        if (same(i)) {
            const Eigen::Vector2d d = shared[i].mean - centre;
            xx += d.x() * d.x();
            xz += d.x() * d.y();
            zz += d.y() * d.y();
        }
    const double angle = 0.5 * std::atan2(2 * xz, xx - zz);
    const Eigen::Vector2d normal(-std::sin(angle), std::cos(angle));
    return normal.y() < 0 ? Eigen::Vector2d(-normal) : normal;
}

// A step that one head sees farther on than the other: in the cells [first, last] of `shared` one of them still sees the
// surface on the left, the other already that on the right.
struct StepZone {
    std::size_t first, last;
    bool first_head_on_left;
};

// z of the surface that the cells from `from` on show in both heads, going on to x; nullopt: there is none.
template <class Apart>
std::optional<double> beside(const std::vector<Shared>& shared, std::ptrdiff_t from, std::ptrdiff_t step,
                             double x, const Apart& apart) {
    double n = 0, sx = 0, sz = 0, sxx = 0, sxz = 0;
    for (std::ptrdiff_t k = from; k >= 0 && k < static_cast<std::ptrdiff_t>(shared.size()) && n < kStepCells;
         k += step) {
        const Shared& s = shared[static_cast<std::size_t>(k)];
        if (apart(s)) break;
        const double ahead = s.mean.x() - x;
        n += 1;
        sx += ahead, sz += s.mean.y(), sxx += ahead * ahead, sxz += ahead * s.mean.y();
    }
    if (n < kFewestStepCells) return std::nullopt;
    return (sxx * sz - sx * sxz) / (n * sxx - sx * sx);
}

std::vector<StepZone> steps_between(const std::vector<Shared>& shared) {
    // The same with the heads exchanged.
    std::vector<double> off, back;
    for (const Shared& s : shared) {
        off.push_back(s.second->z - s.first->z);
        back.push_back(-off.back());
    }
    const double usual = off.empty() ? 0 : 0.5 * (median(off) - median(back));
    const auto sigma = [](const Shared& s) { return std::sqrt(1 / s.first->weight + 1 / s.second->weight); };
    const auto apart = [&](const Shared& s) {
        return std::abs(s.second->z - s.first->z - usual) > kStepSigma * sigma(s);
    };
    std::vector<StepZone> zones;
    for (std::size_t k = 0; k < shared.size(); ++k) {
        if (!apart(shared[k])) continue;
        std::size_t last = k;
        while (last + 1 < shared.size() && apart(shared[last + 1])) ++last;
        bool first_left = true, second_left = true;
        for (std::size_t i = k; i <= last; ++i) {
            const Shared& s = shared[i];
            const auto left = beside(shared, static_cast<std::ptrdiff_t>(k) - 1, -1, s.mean.x(), apart);
            const auto right = beside(shared, static_cast<std::ptrdiff_t>(last) + 1, 1, s.mean.x(), apart);
            const double height = left && right ? std::abs(*left - *right) : 0;
            const auto on = [&](const Group& g, double z) { return std::abs(g.z - z) < kOnTheLine * height; };
            first_left = first_left && height > 0 && on(*s.first, *left) && on(*s.second, *right);
            second_left = second_left && height > 0 && on(*s.second, *left) && on(*s.first, *right);
        }
        if (first_left != second_left) zones.push_back({k, last, first_left});
        k = last;
    }
    return zones;
}

// Gives the points beyond x their own piece, of those that belong to `piece`.
void part(Side& side, int piece, double x, int& pieces) {
    for (Point& p : side.points)
        if (p.piece == piece && p.x >= x) p.piece = pieces;
    ++pieces;
}

void compare(const std::vector<Shared>& shared, DoubleHeadProfile& out) {
    double squares = 0, sum = 0, weights = 0;
    for (std::size_t k = 0; k < shared.size(); ++k) {
        const Group &a = *shared[k].first, &b = *shared[k].second;
        const double d = normal_at(shared, k).dot(Eigen::Vector2d(b.x - a.x, b.z - a.z));
        const double weight = 1 / (1 / a.weight + 1 / b.weight);
        squares += d * d;
        sum += weight * d;
        weights += weight;
    }
    out.disagreement_mm = std::sqrt(squares / static_cast<double>(shared.size()));
    out.offset_mm = sum / weights;
    out.offset_sigma_mm = 1 / std::sqrt(weights);
}

// Pieces that became one: union-find over all pieces of both heads.
class Pieces {
  public:
    explicit Pieces(int count) : parent_(static_cast<std::size_t>(count)) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }
    int root(int piece) {
        while (parent_[static_cast<std::size_t>(piece)] != piece)
            piece = parent_[static_cast<std::size_t>(piece)];
        return piece;
    }
    void join(int a, int b) { parent_[static_cast<std::size_t>(root(a))] = root(b); }

  private:
    std::vector<int> parent_;
};

struct Merged {
    double x, z, intensity, sigma;
    int piece;
};

// Lines without return beyond the outermost points: as many as the head that saw them has there, of both the fewer, and one
// more, which makes the profile's first and last line the rims of the field. None where that head does not list them.
int empty_beyond(const Side& a, const Side& b, std::size_t end, double cell_mm) {
    const auto reach = [&](const Side& s) {
        double most = -std::numeric_limits<double>::infinity();
        for (const Point& p : s.points) most = std::max(most, end == 0 ? -p.x : p.x);
        return most;
    };
    const double outermost = std::max(reach(a), reach(b));
    std::optional<int> fewest;
    for (const Side* s : {&a, &b})
        if (s->every_line && reach(*s) >= outermost - cell_mm)
            fewest = std::min(fewest.value_or(s->empty[end]), s->empty[end]);
    return fewest ? 1 + *fewest : 0;
}

void write(std::vector<Merged> points, const std::array<int, 2>& empty, bool with_intensity,
           DoubleHeadProfile& out) {
    std::map<int, std::pair<double, double>> first;  // least (x, z) of a piece
    for (const Merged& p : points) {
        const auto at = std::pair(p.x, p.z);
        if (auto [it, added] = first.try_emplace(p.piece, at); !added) it->second = std::min(it->second, at);
    }
    std::vector<std::pair<std::pair<double, double>, int>> order;
    for (const auto& [piece, at] : first) order.push_back({at, piece});
    std::sort(order.begin(), order.end());
    std::map<int, std::int32_t> number;
    for (const auto& [at, piece] : order) number[piece] = static_cast<std::int32_t>(number.size());
    for (Merged& p : points) p.piece = number[p.piece];
    std::sort(points.begin(), points.end(), [](const Merged& a, const Merged& b) {
        return std::tie(a.piece, a.x, a.z) < std::tie(b.piece, b.x, b.z);
    });
    const auto line = [&](const Merged& p) {
        out.profile.x_mm.push_back(p.x);
        out.profile.z_mm.push_back(p.z);
        out.profile.segment.push_back(p.piece);
        if (with_intensity) out.profile.intensity.push_back(static_cast<float>(p.intensity));
        out.sigma_mm.push_back(p.sigma);
    };
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const Merged none{kNone, kNone, 0, kNone, kOutlier};
    for (int i = 0; i < empty[0]; ++i) line(none);
    for (const Merged& p : points) line(p);
    for (int i = 0; i < empty[1]; ++i) line(none);
}

void merge(const Cells& cells, const std::vector<Shared>& shared, int pieces, const std::array<int, 2>& empty,
           bool with_intensity, DoubleHeadProfile& out) {
    Pieces joined(pieces);
    for (const Shared& s : shared) joined.join(s.first->piece, s.second->piece);
    std::vector<Merged> points;
    auto next = shared.begin();
    for (const auto& [cell, groups] : cells) {
        const Shared* both = next != shared.end() && next->cell == cell ? &*next++ : nullptr;
        for (const Group& g : groups) {
            if (both && (&g == both->first || &g == both->second)) continue;
            for (const Point& p : g.points)
                points.push_back({p.x, p.z, p.intensity, 1 / std::sqrt(p.weight), joined.root(p.piece)});
        }
        if (!both) continue;
        const auto total = [](const Group& g) {
            double sum = 0;
            for (const Point& p : g.points) sum += p.weight * static_cast<double>(p.intensity);
            return sum;
        };
        points.push_back({both->mean.x(), both->mean.y(),
                          (total(*both->first) + total(*both->second)) / both->weight,
                          1 / std::sqrt(both->weight), joined.root(both->first->piece)});
    }
    write(std::move(points), empty, with_intensity, out);
}

}  // namespace

std::string_view to_string(DoubleHeadStatus status) {
    constexpr std::array<std::string_view, 5> names{"ok", "no_points", "not_coplanar", "no_overlap",
                                                    "disagree"};
    return names[static_cast<std::size_t>(status)];
}

Expected<DoubleHeadProfile> merge_heads(const Profile& first, const Head& first_head, const Profile& second,
                                        const Head& second_head, const DoubleHeadOptions& options) {
    SEAM_OK(check_head(first, first_head, "first head"));
    SEAM_OK(check_head(second, second_head, "second head"));
    if (!(options.disagreement_limit_mm > 0 && options.disagreement_limit_mm < kSameSurfaceMm))
        return input_error(
            Text("a disagreement limit of {} mm is out of range", options.disagreement_limit_mm),
            "disagreement_limit_mm", Text("give more than 0 and less than {} mm", kSameSurfaceMm));
    if (!(options.plane_limit_mm > 0) || !(options.minimum_overlap_mm > 0))
        return input_error("a limit of the double head is not positive",
                           "plane_limit_mm, minimum_overlap_mm");

    DoubleHeadProfile out;
    int first_pieces = 0, second_pieces = 0;
    Side a = side_of(first, first_head, 0, first_pieces);
    Side b = side_of(second, second_head, first_pieces, second_pieces);
    if (!(a.pitch > 0) || !(b.pitch > 0)) {
        out.message = Text("the {} head saw no usable contour", a.pitch > 0 ? "second" : "first");
        return out;
    }
    if (const double off = std::max(a.off_plane, b.off_plane); off > options.plane_limit_mm) {
        out.status = DoubleHeadStatus::not_coplanar;
        out.message = Text("the laser planes of the heads lie {:.2f} mm apart, allowed are {:.2f} mm", off,
                           options.plane_limit_mm);
        return out;
    }
    // Two fields that lie evenly about their heads' x = 0 do so by chance together less than one.
    const auto lists = [&](std::size_t fewest) {
        return std::pair(lists_every_line(first, a.pitch, first_head.sigma_mm, fewest),
                         lists_every_line(second, b.pitch, second_head.sigma_mm, fewest));
    };
    std::tie(a.every_line, b.every_line) = lists(kFewestOfTwo);
    if (!a.every_line || !b.every_line) std::tie(a.every_line, b.every_line) = lists(kFewestOfOne);
    const double pitch = std::max(a.pitch, b.pitch);
    int pieces = first_pieces + second_pieces;
    Cells cells;
    int contradicting = 0;
    std::vector<Shared> shared;
    const auto compare_cells = [&] {
        cells.clear();
        add_to(cells, a, 0, pitch);
        add_to(cells, b, 1, pitch);
        close(cells);
        contradicting = 0;
        shared = share(cells, contradicting);
    };
    compare_cells();
    // At a step each head's contour is divided where this head sees it; in between they show two surfaces.
    std::set<std::int64_t> two_surfaces;
    const auto zones = steps_between(shared);
    for (auto zone = zones.rbegin(); zone != zones.rend(); ++zone) {
        const double from = double(shared[zone->first].cell) * pitch,
                     to = double(shared[zone->last].cell + 1) * pitch;
        std::set<int> of_first, of_second;
        for (std::size_t k = zone->first; k <= zone->last; ++k) {
            of_first.insert(shared[k].first->piece);
            of_second.insert(shared[k].second->piece);
            two_surfaces.insert(shared[k].cell);
        }
        for (const int piece : of_first) part(a, piece, zone->first_head_on_left ? to : from, pieces);
        for (const int piece : of_second) part(b, piece, zone->first_head_on_left ? from : to, pieces);
    }
    if (!two_surfaces.empty()) {
        compare_cells();
        std::erase_if(shared, [&](const Shared& s) { return two_surfaces.contains(s.cell); });
    }
    std::map<std::pair<int, int>, int> together;
    for (const Shared& s : shared) ++together[{s.first->piece, s.second->piece}];
    std::erase_if(shared, [&](const Shared& s) {
        return together[{s.first->piece, s.second->piece}] < kSharedCellsOfOneSegment;
    });

    out.shared_cells = static_cast<int>(shared.size());
    out.overlap_mm = pitch * out.shared_cells;
    if (contradicting > out.shared_cells) {
        out.status = DoubleHeadStatus::disagree;
        out.disagreement_mm = kSameSurfaceMm;
        out.message =
            Text("the heads show surfaces more than {:g} mm apart in most of the overlap", kSameSurfaceMm);
        return out;
    }
    if (!(out.overlap_mm >= options.minimum_overlap_mm)) {
        out.status = DoubleHeadStatus::no_overlap;
        out.message = Text("the stripes of the heads share {:.1f} mm, needed are {:.1f} mm", out.overlap_mm,
                           options.minimum_overlap_mm);
        return out;
    }
    compare(shared, out);
    merge(cells, shared, pieces, {empty_beyond(a, b, 0, pitch), empty_beyond(a, b, 1, pitch)},
          !first.intensity.empty() && !second.intensity.empty(), out);
    out.status = DoubleHeadStatus::ok;
    if (!(out.disagreement_mm <= options.disagreement_limit_mm)) {
        out.status = DoubleHeadStatus::disagree;
        out.message = Text(
            "the heads disagree by {:.3f} mm in the overlap, allowed are {:.3f} mm: calibrate their relation",
            out.disagreement_mm, options.disagreement_limit_mm);
    }
    return out;
}

}  // namespace seamwright
