#include "core/features/gap/gap_heads.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "core/features/gap/gap_limits.h"
#include "core/median.h"

namespace seamwright::gap {
namespace {

constexpr double kAroundLines = 3, kAroundSigmas = 6;
constexpr int kLeastAround = 4;        // points that tell a direction
constexpr double kLevel = 1.2;         // slope: 50 degrees
constexpr double kWithinPiece = 6;     // spacings
constexpr double kAcrossPieces = 1.8;  // spacings
constexpr double kBends = 0.25;        // beside what the slopes of two neighbours say, per spacing along x
constexpr double kMostNoise = 0.8;     // of the points have no more
constexpr double kStep_mm = 1;         // from point to point of a face
constexpr double kStepSpacings = 3, kStepLines = 2.5;
constexpr int kEndOfSheet = 40;  // points of a sheet that a face may hang on

}  // namespace

int HeadsContour::root(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
}

// Of the main direction around a point, NaN where too few are near; and what they scatter about it.
void HeadsContour::take_slope(const FeaturePoints& points, int i) {
    const auto& x = points.x;
    const auto& z = points.z;
    int n = 0;
    double mx = 0, mz = 0, xx = 0, xz = 0, zz = 0;
    const auto take = [&](int j) {
        const double dx = x[j] - x[i], dz = z[j] - z[i];
        if (std::abs(dz) > reach_) return;
        ++n;
        mx += dx, mz += dz, xx += dx * dx, xz += dx * dz, zz += dz * dz;
    };
    for (int j = i; j >= 0 && x[i] - x[j] <= reach_; --j) take(j);
    for (int j = i + 1; j < static_cast<int>(x.size()) && x[j] - x[i] <= reach_; ++j) take(j);
    slope_.push_back(std::numeric_limits<double>::quiet_NaN());
    if (n < kLeastAround) return;
    xx -= mx * mx / n, xz -= mx * mz / n, zz -= mz * mz / n;
    slope_.back() = std::tan(0.5 * std::atan2(2 * xz, xx - zz));
    const double across = 0.5 * (xx + zz - std::hypot(xx - zz, 2 * xz));
    scatter_.push_back(std::sqrt(std::max(0.0, across) / (n - 2)));
}

void HeadsContour::arrange(FeaturePoints& points, double noise_mm) {
    const int n = static_cast<int>(points.x.size());
    const double pitch = points.pitch.along_x;
    reach_ = std::max(kAroundLines * points.pitch.distance, kAroundSigmas * noise_mm);
    const auto in_order = [&] {
        x_.clear(), z_.clear();
        for (const int i : order_) x_.push_back(points.x[i]), z_.push_back(points.z[i]);
        points.x.swap(x_);
        points.z.swap(z_);
    };
    order_.resize(n);
    std::iota(order_.begin(), order_.end(), 0);
    std::sort(order_.begin(), order_.end(), [&](int a, int b) {
        return std::tie(points.x[a], points.z[a]) < std::tie(points.x[b], points.z[b]);
    });
    place_.assign(n, 0);
    for (std::size_t k = 0; k < points.pieces.size(); ++k)
        std::fill_n(place_.begin() + points.pieces[k].first, points.pieces[k].count, static_cast<int>(k));
    piece_.clear();
    for (const int i : order_) piece_.push_back(place_[i]);
    in_order();
    const auto& x = points.x;
    const auto& z = points.z;
    slope_.clear();
    scatter_.clear();
    for (int i = 0; i < n; ++i) take_slope(points, i);
    noise_ = noise_mm;
    if (!scatter_.empty()) {
        const auto most = scatter_.begin() +
                          static_cast<std::ptrdiff_t>(kMostNoise * static_cast<double>(scatter_.size() - 1));
        std::nth_element(scatter_.begin(), most, scatter_.end());
        noise_ = std::max(noise_, *most);
    }
    const auto level = [&](int i) { return std::abs(slope_[i]) < kLevel; };
    parent_.resize(n);
    std::iota(parent_.begin(), parent_.end(), 0);
    const double gate = kNoiseGate * std::sqrt(2.0) * noise_;
    for (int i = 0; i < n; ++i)
        for (int j = i + 1; level(i) && j < n && x[j] - x[i] <= kWithinPiece * pitch; ++j) {
            const double dx = x[j] - x[i], dz = z[j] - z[i];
            if (!level(j) || (piece_[i] != piece_[j] && dx > kAcrossPieces * pitch)) continue;
            const auto [flatter, steeper] = std::minmax(slope_[i], slope_[j]);
            const double off = gate + kBends * std::max(dx, pitch);
            if (dz > flatter * dx - off && dz < steeper * dx + off) parent_[root(j)] = root(i);
        }
    // Least x of a sheet: that of its first point in this order; how many it has.
    place_.assign(n, n);
    owner_.assign(n, 0);
    for (int i = n - 1; i >= 0; --i) place_[root(i)] = i, ++owner_[root(i)];
    std::iota(order_.begin(), order_.end(), 0);
    const auto sheet_of = [&](int i) {
        const int top = root(i);
        return owner_[top] >= kLeastGround ? place_[top] : n;
    };
    std::sort(order_.begin(), order_.end(),
              [&](int a, int b) { return std::pair(sheet_of(a), a) < std::pair(sheet_of(b), b); });
    sheets_.clear();
    for (int k = 0, before = n; k < n && sheet_of(order_[k]) < n; ++k) {
        if (const int sheet = sheet_of(order_[k]); sheet != before) {
            sheets_.push_back({k, k});
            before = sheet;
        }
        sheets_.back().last = k;
    }
    in_order();
}

bool HeadsContour::beside_another_sheet(const FeaturePoints& points, int i, const LevelSheet& before,
                                        const LevelSheet& after) const {
    for (const LevelSheet& sheet : sheets_) {
        if ((sheet.first >= before.first && sheet.last <= before.last) ||
            (sheet.first >= after.first && sheet.last <= after.last))
            continue;
        const auto end = points.x.begin() + sheet.last + 1;
        for (auto at = std::lower_bound(points.x.begin() + sheet.first, end, points.x[i] - reach_);
             at != end && *at <= points.x[i] + reach_; ++at)
            if (std::hypot(*at - points.x[i], points.z[at - points.x.begin()] - points.z[i]) < reach_)
                return true;
    }
    return false;
}

void HeadsContour::share_faces(const FeaturePoints& points, const LevelSheet& before,
                               const LevelSheet& after) {
    const auto distance = [&](int a, int b) {
        return std::hypot(points.x[a] - points.x[b], points.z[a] - points.z[b]);
    };
    faces_[0].clear(), faces_[1].clear(), loose_.clear(), away_.clear(), owner_.clear();
    for (int i = sheets_.empty() ? 0 : sheets_.back().last + 1; i < static_cast<int>(points.x.size()); ++i) {
        if (beside_another_sheet(points, i, before, after)) continue;
        loose_.push_back(i);
        double away = std::numeric_limits<double>::infinity();
        int owner = 0;
        const auto nearer = [&](int of, int from, int to) {
            for (int k = from; k <= to; ++k)
                if (const double d = distance(i, k); d < away) away = d, owner = of;
        };
        nearer(0, std::max(before.first, before.last - kEndOfSheet), before.last);
        nearer(1, after.first, std::min(after.last, after.first + kEndOfSheet));
        away_.push_back(away);
        owner_.push_back(owner);
    }
    scatter_.clear();
    for (const int i : loose_) {
        double spacing = std::numeric_limits<double>::infinity();
        for (const int j : loose_)
            if (j != i) spacing = std::min(spacing, distance(i, j));
        scatter_.push_back(spacing);
    }
    const double most = std::clamp(scatter_.empty() ? 0 : kStepSpacings * median(scatter_),
                                   kStepLines * points.pitch.distance,
                                   std::max(kStep_mm, kStepLines * points.pitch.distance));
    // The nearest of all that are left, again and again.
    while (!loose_.empty()) {
        const auto k = std::min_element(away_.begin(), away_.end()) - away_.begin();
        if (away_[k] > most) return;
        const int taken = loose_[k], of = owner_[k];
        faces_[of].push_back(taken);
        loose_[k] = loose_.back(), away_[k] = away_.back(), owner_[k] = owner_.back();
        loose_.pop_back(), away_.pop_back(), owner_.pop_back();
        for (std::size_t i = 0; i < loose_.size(); ++i)
            if (const double d = distance(taken, loose_[i]); d < away_[i]) away_[i] = d, owner_[i] = of;
    }
}

}  // namespace seamwright::gap
