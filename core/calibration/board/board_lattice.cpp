#include "core/calibration/board/board_lattice.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace seamwright::detail {

namespace {

// Weight on the perspective's two numbers in predict(): with few corners around, it is not seen and held small.
constexpr double kHoldFew = 3e-3;       // with six to eight corners
constexpr double kHold = 1e-4;          // with more
constexpr double kRidge8 = 1e-12;       // keeps the normal equations solvable
constexpr double kLeastScatter = 1e-9;  // guards the scale

}  // namespace

using Eigen::Vector2d;

LatticeBox box_of(const SaddleLattice& lattice) {
    LatticeBox box;
    bool first = true;
    for (const auto& [cell, corner] : lattice) {
        if (first) box = {cell.first, cell.first, cell.second, cell.second};
        first = false;
        box.low_i = std::min(box.low_i, cell.first), box.high_i = std::max(box.high_i, cell.first);
        box.low_j = std::min(box.low_j, cell.second), box.high_j = std::max(box.high_j, cell.second);
    }
    return box;
}

std::optional<LatticePlace> predict(const SaddleLattice& lattice, double i, double j, int reach) {
    const int ci = static_cast<int>(std::floor(i)), cj = static_cast<int>(std::floor(j));
    const bool whole = i == ci && j == cj;
    struct Known {
        double a, b;
        Vector2d at;
    };
    static thread_local std::vector<Known> known;
    known.clear();
    double low_a = 1e9, high_a = -1e9, low_b = 1e9, high_b = -1e9;
    Vector2d mean(0, 0);
    for (int di = -reach; di <= reach + (whole ? 0 : 1); ++di) {
        auto it = lattice.lower_bound({ci + di, cj - reach});
        for (; it != lattice.end() && it->first.first == ci + di &&
               it->first.second <= cj + reach + (whole ? 0 : 1);
             ++it) {
            if (whole && di == 0 && it->first.second == cj) continue;
            const double a = it->first.first - i, b = it->first.second - j;
            known.push_back({a, b, it->second.at});
            mean += it->second.at;
            low_a = std::min(low_a, a), high_a = std::max(high_a, a);
            low_b = std::min(low_b, b), high_b = std::max(high_b, b);
        }
    }
    if (known.size() < 4 || high_a - low_a < 0.5 || high_b - low_b < 0.5) return std::nullopt;
    mean /= static_cast<double>(known.size());
    double scale = 0;
    for (const Known& k : known) scale += (k.at - mean).norm();
    scale = static_cast<double>(known.size()) / std::max(scale, kLeastScatter);
    // x (1 + g a + h b) = x0 + x1 a + x2 b, the same for y; g and h held small where few corners carry them.
    Eigen::Matrix<double, 8, 8> normal = Eigen::Matrix<double, 8, 8>::Zero();
    Eigen::Matrix<double, 8, 1> right = Eigen::Matrix<double, 8, 1>::Zero();
    for (const Known& k : known) {
        const Vector2d q = scale * (k.at - mean);
        // Nearer corners count more: the lens bends what lies farther off.
        const double weight = 1 / (1 + 0.25 * (k.a * k.a + k.b * k.b));
        Eigen::Matrix<double, 8, 1> r;
        r << 1, k.a, k.b, 0, 0, 0, -q.x() * k.a, -q.x() * k.b;
        normal.noalias() += weight * r * r.transpose();
        right += weight * q.x() * r;
        r << 0, 0, 0, 1, k.a, k.b, -q.y() * k.a, -q.y() * k.b;
        normal.noalias() += weight * r * r.transpose();
        right += weight * q.y() * r;
    }
    const double hold = known.size() < 6 ? 1 : known.size() < 9 ? kHoldFew : kHold;
    normal.diagonal().array() += kRidge8;
    normal(6, 6) += hold;
    normal(7, 7) += hold;
    const Eigen::Matrix<double, 8, 1> x = normal.ldlt().solve(right);
    if (!x.allFinite()) return std::nullopt;
    LatticePlace place;
    const Vector2d at(x(0), x(3));
    place.at = at / scale + mean;
    place.along_i = (Vector2d(x(1), x(4)) - x(6) * at) / scale;
    place.along_j = (Vector2d(x(2), x(5)) - x(7) * at) / scale;
    if (place.along_i.squaredNorm() < 1 || place.along_j.squaredNorm() < 1) return std::nullopt;
    return place;
}

void drop_misfits(SaddleLattice& lattice, double share) {
    for (int round = 0; round < 3; ++round) {
        std::vector<std::pair<double, LatticeCell>> off;
        for (const auto& [cell, corner] : lattice)
            if (const auto place = predict(lattice, cell.first, cell.second))
                if (const double d = (corner.at - place->at).norm() / place->least_step(); d > share)
                    off.emplace_back(d, cell);
        if (off.empty()) return;
        // A wrong corner spoils its neighbours' prediction: the worst go first.
        std::sort(off.begin(), off.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
        for (std::size_t k = 0; k < std::max<std::size_t>(1, off.size() / 4); ++k)
            lattice.erase(off[k].second);
    }
}

namespace {

// Of a step, from where the corners around say: dropped from a grown lattice.
constexpr double kSeedMisfit = 0.2;
// Looking along an edge for the next corner, px and px per px of way.
constexpr double kLookAround_px = 2.5;  // of the way's point, at its start
constexpr double kLookWiden = 0.12;     // how the look around widens on the way
constexpr double kLeastAhead_px = 3.5;  // nearer is the corner itself
constexpr double kMostAside = 0.17;     // of the way ahead, beside the edge's direction (besides one pixel)
constexpr double kSidesFrom_px = 1.5;   // off the edge, where its two colours are compared
constexpr double kSidesWiden = 0.1;     // ... more, on the way
// Of the saddle's contrast between the edge's sides: less is a lost edge.
constexpr double kLeastSides = 0.15;
// What fits to a corner as its neighbour.
constexpr double kMostRaySine = 0.35;  // 20 degrees between the edge's directions at its two ends
constexpr double kLeastContrastRatio = 0.3;
constexpr double kMostContrastRatio = 3.3;
// Of the shorter step, by which the fourth corner misses the others' parallelogram.
constexpr double kMostUnclosed = 0.35;
// Sine between a cell's directions: flatter, corners are not told apart.
constexpr double kLeastCrossing = 0.15;
constexpr double kMostEdgeSine = 0.42;    // between a corner's edge and the lattice's direction, 25 degrees
constexpr double kNextWithin = 0.25;      // of a step from where it is expected: the next corner
constexpr double kBeyondGapWithin = 0.2;  // ... over a gap

double cross(const Vector2d& a, const Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

class Grower {
  public:
    Grower(const cv::Mat& soft, const std::vector<Saddle>& saddles)
        : soft_(soft),
          saddles_(saddles),
          across_(soft.cols / kBucket + 1),
          down_(soft.rows / kBucket + 1),
          buckets_(static_cast<std::size_t>(across_ * down_)),
          taken_(saddles.size(), 0) {
        for (std::size_t k = 0; k < saddles.size(); ++k)
            buckets_[bucket(static_cast<int>(saddles[k].at.x()) / kBucket,
                            static_cast<int>(saddles[k].at.y()) / kBucket)]
                .push_back(static_cast<int>(k));
    }

    std::vector<SaddleLattice> run(std::size_t least) {
        std::vector<SaddleLattice> out;
        for (std::size_t k = 0; k < saddles_.size(); ++k) {
            if (taken_[k]) continue;
            auto seed = square_at(static_cast<int>(k));
            if (!seed) continue;
            grow(*seed);
            drop_misfits(*seed, kSeedMisfit);
            constexpr std::size_t kSettled = 9;
            if (seed->size() >= kSettled)
                for (const auto& [cell, corner] : *seed) taken_[static_cast<std::size_t>(corner.saddle)] = 1;
            if (seed->size() >= least) out.push_back(std::move(*seed));
        }
        std::sort(out.begin(), out.end(),
                  [](const SaddleLattice& a, const SaddleLattice& b) { return a.size() > b.size(); });
        return out;
    }

  private:
    static constexpr int kBucket = 8;  // px

    std::size_t bucket(int x, int y) const { return static_cast<std::size_t>(y * across_ + x); }
    const Saddle& at(int k) const { return saddles_[static_cast<std::size_t>(k)]; }

    template <typename Visit>
    void around(const Vector2d& p, double reach, Visit visit) const {
        const int x0 = std::max(0, static_cast<int>((p.x() - reach) / kBucket)),
                  x1 = std::min(across_ - 1, static_cast<int>((p.x() + reach) / kBucket));
        const int y0 = std::max(0, static_cast<int>((p.y() - reach) / kBucket)),
                  y1 = std::min(down_ - 1, static_cast<int>((p.y() + reach) / kBucket));
        for (int y = y0; y <= y1; ++y)
            for (int x = x0; x <= x1; ++x)
                for (const int k : buckets_[bucket(x, y)])
                    if ((at(k).at - p).squaredNorm() <= reach * reach) visit(k);
    }

    // The grey of one side of an edge less the other's, at a place beside it.
    double sides(const Vector2d& p, const Vector2d& normal) const {
        const Vector2d a = p + normal, b = p - normal;
        if (!(std::min(a.x(), b.x()) >= 0 && std::min(a.y(), b.y()) >= 0 &&
              std::max(a.x(), b.x()) < soft_.cols - 1 && std::max(a.y(), b.y()) < soft_.rows - 1))
            return 0;
        const auto grey = [&](const Vector2d& at) {
            return soft_.at<float>(static_cast<int>(std::lround(at.y())),
                                   static_cast<int>(std::lround(at.x())));
        };
        return static_cast<double>(grey(a) - grey(b));
    }

    // The next corner along an edge of `from`: along its first edge (`second` false) forwards or backwards.
    // It is the first one on the way whose colours are the other way round; the edge must go on up to it.
    int next(int from, bool second, double sign) const {
        const Saddle& s = at(from);
        const Vector2d along = sign * (second ? s.second : s.first);
        // Ahead of `from` the bright sector lies to one side of the ray, whether it goes forwards or backwards.
        const Vector2d normal = Vector2d(-along.y(), along.x()) * (second ? -1 : 1);
        int lost = 0;
        constexpr double kFarthest = 170, kStride = 3;
        for (double t = 4; t < kFarthest; t += kStride) {
            const Vector2d p = s.at + t * along;
            if (p.x() < 1 || p.y() < 1 || p.x() > soft_.cols - 2 || p.y() > soft_.rows - 2) return -1;
            int best = -1;
            double least = 1e9;
            around(p, kLookAround_px + kLookWiden * t, [&](int k) {
                if (k == from) return;
                const Vector2d d = at(k).at - s.at;
                const double ahead = d.dot(along), aside = std::abs(cross(along, d));
                if (ahead < kLeastAhead_px || aside > 1 + kMostAside * ahead || !opposite(s, at(k), second))
                    return;
                if (ahead < least) least = ahead, best = k;
            });
            if (best >= 0) return best;
            lost = sides(p, (kSidesFrom_px + kSidesWiden * t) * normal) > kLeastSides * s.contrast ? 0
                                                                                                   : lost + 1;
            if (lost >= 3) return -1;
        }
        return -1;
    }

    // Whether `b` is what follows `a` along a's edge: the same edges within 25 degrees, colours swapped.
    static bool opposite(const Saddle& a, const Saddle& b, bool along_second) {
        const Vector2d& ray = along_second ? a.second : a.first;
        const Vector2d& side = along_second ? a.first : a.second;
        const Vector2d& b_ray = along_second ? b.first : b.second;
        const Vector2d& b_side = along_second ? b.second : b.first;
        if (std::abs(cross(ray, b_ray)) > kMostRaySine || std::abs(cross(side, b_side)) > kMostEdgeSine)
            return false;
        return b.contrast > kLeastContrastRatio * a.contrast && b.contrast < kMostContrastRatio * a.contrast;
    }

    // Four corners that close a square with `k` as one of them.
    std::optional<SaddleLattice> square_at(int k) const {
        const Saddle& s = at(k);
        for (const int si : {1, -1}) {
            const int b = next(k, false, si);
            if (b < 0 || taken_[static_cast<std::size_t>(b)]) continue;
            for (const int sj : {1, -1}) {
                const int c = next(k, true, sj);
                if (c < 0 || taken_[static_cast<std::size_t>(c)]) continue;
                // At b and c the edges have swapped names.
                const double to_j = at(b).first.dot(sj * s.second) > 0 ? 1 : -1;
                const double to_i = at(c).second.dot(si * s.first) > 0 ? 1 : -1;
                const int d = next(b, false, to_j), e = next(c, true, to_i);
                if (d < 0 || d != e || d == k || taken_[static_cast<std::size_t>(d)]) continue;
                const Vector2d u = at(b).at - s.at, v = at(c).at - s.at, w = at(d).at - s.at;
                // The fourth closes the others' parallelogram as perspective lets it.
                if ((w - u - v).norm() > kMostUnclosed * std::min(u.norm(), v.norm())) continue;
                if (cross(si * u, sj * v) <= 0) continue;
                SaddleLattice lattice;
                lattice[{0, 0}] = {s.at, k};
                lattice[{si, 0}] = {at(b).at, b};
                lattice[{0, sj}] = {at(c).at, c};
                lattice[{si, sj}] = {at(d).at, d};
                return lattice;
            }
        }
        return std::nullopt;
    }

    int fitting(const SaddleLattice& lattice, const std::vector<char>& own, const LatticeCell& cell,
                double share, int reach) const {
        const auto place = predict(lattice, cell.first, cell.second, reach);
        if (!place) return -1;
        const double step = place->least_step();
        if (step < 3) return -1;
        const Vector2d i = place->along_i.normalized(), j = place->along_j.normalized();
        const double between = std::abs(cross(i, j));
        if (between < kLeastCrossing) return -1;
        const double tolerance = std::min(kMostEdgeSine, 0.5 * between);
        const bool even = (cell.first + cell.second) % 2 == 0;
        int best = -1;
        double least = share * step + 0.5;
        around(place->at, least, [&](int k) {
            if (taken_[static_cast<std::size_t>(k)] || own[static_cast<std::size_t>(k)]) return;
            const Saddle& s = at(k);
            if (std::abs(cross(even ? s.first : s.second, i)) > tolerance ||
                std::abs(cross(even ? s.second : s.first, j)) > tolerance)
                return;
            if (const double d = (s.at - place->at).norm(); d < least) least = d, best = k;
        });
        return best;
    }

    void grow(SaddleLattice& lattice) const {
        std::vector<char> own(saddles_.size(), 0);
        for (const auto& [cell, corner] : lattice) own[static_cast<std::size_t>(corner.saddle)] = 1;
        std::map<LatticeCell, std::size_t> tried;  // with how many corners around
        const auto around_it = [&](const LatticeCell& c, int reach) {
            std::size_t n = 0;
            for (int di = -reach; di <= reach; ++di) {
                auto it = lattice.lower_bound({c.first + di, c.second - reach});
                for (; it != lattice.end() && it->first.first == c.first + di &&
                       it->first.second <= c.second + reach;
                     ++it)
                    ++n;
            }
            return n;
        };
        constexpr std::size_t kMost = 45000;
        // Side by side first; then over a gap of one row and of two, as a stripe leaves it.
        for (int gap = 1; gap <= 3 && lattice.size() < kMost;) {
            std::vector<LatticeCell> frontier;
            for (const auto& [cell, corner] : lattice)
                for (const auto& [di, dj] : {LatticeCell{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
                    const LatticeCell n{cell.first + gap * di, cell.second + gap * dj};
                    if (!lattice.count(n)) frontier.push_back(n);
                }
            std::sort(frontier.begin(), frontier.end());
            frontier.erase(std::unique(frontier.begin(), frontier.end()), frontier.end());
            bool added = false;
            for (const LatticeCell& n : frontier) {
                const std::size_t near = around_it(n, gap + 1);
                if (near < (gap == 1 ? 4U : 6U)) continue;
                auto& before = tried[n];
                if (before == near) continue;
                before = near;
                const int k = fitting(lattice, own, n, gap == 1 ? kNextWithin : kBeyondGapWithin, gap + 1);
                if (k < 0) continue;
                lattice[n] = {at(k).at, k};
                own[static_cast<std::size_t>(k)] = 1;
                added = true;
            }
            gap = added ? 1 : gap + 1;
            if (lattice.size() < 6 && gap > 1) break;
        }
    }

    const cv::Mat& soft_;
    const std::vector<Saddle>& saddles_;
    int across_, down_;
    std::vector<std::vector<int>> buckets_;
    std::vector<char> taken_;
};

}  // namespace

std::vector<SaddleLattice> grow_lattices(const cv::Mat& soft, const std::vector<Saddle>& saddles,
                                         std::size_t least) {
    return Grower(soft, saddles).run(least);
}

}  // namespace seamwright::detail
