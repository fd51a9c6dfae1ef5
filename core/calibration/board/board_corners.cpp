#include "core/calibration/board/board_corners.h"

#include <algorithm>
#include <cmath>

#include "core/calibration/board/board_saddles.h"
#include "core/median.h"

namespace seamwright::detail {
namespace {

constexpr double kWindowShare = 0.45;  // of the least step or lean: the window stays inside the four squares
// Of the window's pixels foreign: something lies beside the corner, it is held to less.
constexpr double kForeignDoubt = 0.05;
// Least departure from the corners around that drops a doubtful corner.
constexpr double kPulledDoubtful_px = 0.15;
constexpr double kPulled_px = 0.3;       // ... any corner
constexpr double kPulledDoubtful = 3.5;  // times the usual departure that drops a doubtful corner
constexpr double kPulled = 6.0;          // ... any corner
constexpr double kMostForeign = 0.1;     // of the window: a corner added by prediction has to be clean
// Of the usual contrast, for a corner added in the searched picture.
constexpr double kLeastContrastSearched = 0.65;
constexpr double kMostNoiseSearched = 0.2;  // of its own contrast, for such a corner
constexpr double kOffPrediction = 0.12;     // of the least step: farther off it is another thing
constexpr double kStrayed = 0.25;           // of the least step, from where its fit began
constexpr double kMisfitMeasured = 0.1;     // of a step, from where the corners around a measured corner say
// The usual rest of the fit, over its contrast: above (plus kRestMore) the window holds something else.
constexpr double kRestTimes = 1.7;
constexpr double kRestMore = 0.02;             // of the contrast: small rests drop no corner
constexpr double kLeastContrastAround = 0.75;  // of the contrast of the corners around
// Of the usual contrast, for a corner that the searched scale was too coarse for.
constexpr double kLeastContrastAdded = 0.7;

using Eigen::Vector2d;

int window_at(const LatticePlace& place, int most) {
    // Inside the four squares, whichever way their edges lean.
    const double lean =
        std::abs(place.along_i.x() * place.along_j.y() - place.along_i.y() * place.along_j.x()) /
        std::max(place.along_i.norm(), place.along_j.norm());
    return std::clamp(static_cast<int>(kWindowShare * std::min(lean, place.least_step())), 2, most);
}

CornerStart start_at(const LatticeCell& cell, const LatticePlace& place, const Vector2d& at, int most) {
    CornerStart s;
    s.at = at;
    const bool even = (cell.first + cell.second) % 2 == 0;
    const Vector2d i = place.along_i.normalized(), j = place.along_j.normalized();
    s.first = even ? i : j;
    s.second = even ? j : Vector2d(-i);
    s.half_px = window_at(place, most);
    return s;
}

constexpr int kRough = 5;  // px, half a window
// How far to look for corners that say where this one lies: with few of them perspective is not seen.
int reach_around(const SaddleLattice& lattice, const LatticeCell& cell) {
    constexpr int kNearest = 2, kFarthest = 5, kEnough = 12;
    for (int reach = kNearest; reach < kFarthest; ++reach) {
        int around = 0;
        for (int i = cell.first - reach; i <= cell.first + reach; ++i)
            for (int j = cell.second - reach; j <= cell.second + reach; ++j)
                around += static_cast<int>(lattice.count({i, j}));
        if (around > kEnough) return reach;
    }
    return kFarthest;
}

// What a stripe or a glint beside it has pulled departs from where the corners around it say.
void drop_pulled(const std::map<LatticeCell, CornerFit>& fits, SaddleLattice& lattice) {
    for (int round = 0; round < 3; ++round) {
        std::vector<std::pair<double, LatticeCell>> off;
        std::vector<double> sizes;
        for (const auto& [cell, corner] : lattice)
            if (const auto place = predict(lattice, cell.first, cell.second, reach_around(lattice, cell))) {
                off.emplace_back((corner.at - place->at).norm(), cell);
                sizes.push_back(off.back().first);
            }
        const double usual = median(sizes);
        std::sort(off.rbegin(), off.rend());
        std::size_t dropped = 0;
        for (const auto& [size, cell] : off) {
            const auto fit = fits.find(cell);
            const double doubt = fit == fits.end() ? 0 : fit->second.foreign;
            if (size < std::max((doubt > kForeignDoubt ? kPulledDoubtful_px : kPulled_px),
                                (doubt > kForeignDoubt ? kPulledDoubtful : kPulled) * usual))
                continue;
            lattice.erase(cell);
            if (++dropped > lattice.size() / 10) break;
        }
        if (!dropped) return;
    }
}

}  // namespace

double measure_corners(const cv::Mat& small, SaddleLattice& lattice) {
    std::map<LatticeCell, CornerFit> fits;
    std::vector<LatticeCell> tried;
    double blur_px = 1;
    for (int round = 0; round < 3; ++round) {
        std::vector<LatticeCell> bad;
        for (auto& [cell, corner] : lattice) {
            if (fits.count(cell)) continue;
            const auto place = predict(lattice, cell.first, cell.second, 3);
            if (!place) {
                bad.push_back(cell);
                continue;
            }
            const auto fit = fit_corner(small, start_at(cell, *place, corner.at, kRough));
            if (!fit || !sound(*fit) || (fit->at - corner.at).norm() > kStrayed * place->least_step())
                bad.push_back(cell);
            else
                fits.emplace(cell, *fit);
        }
        for (const LatticeCell& c : bad) lattice.erase(c);
        for (auto& [cell, fit] : fits) lattice[cell].at = fit.at;
        if (lattice.size() < 6) return blur_px;
        std::vector<double> contrasts;
        for (const auto& [cell, fit] : fits) contrasts.push_back(fit.half_contrast);
        const double usual = median(contrasts);
        std::vector<double> blurs;
        for (const auto& [cell, fit] : fits) blurs.push_back(fit.blur_px);
        blur_px = median(blurs);
        const LatticeBox box = box_of(lattice);
        bool more = false;
        std::vector<std::pair<LatticeCell, CornerFit>> extra;
        for (int i = box.low_i - 1; i <= box.high_i + 1; ++i)
            for (int j = box.low_j - 1; j <= box.high_j + 1; ++j) {
                const LatticeCell cell{i, j};
                if (lattice.count(cell) || std::count(tried.begin(), tried.end(), cell)) continue;
                const auto place = predict(lattice, i, j);
                if (!place) continue;
                if (round > 0) tried.push_back(cell);
                const auto fit = fit_corner(small, start_at(cell, *place, place->at, kRough));
                if (!fit || !sound(*fit) || fit->foreign > kMostForeign ||
                    fit->half_contrast < kLeastContrastSearched * usual ||
                    fit->noise > kMostNoiseSearched * fit->half_contrast ||
                    (fit->at - place->at).norm() > kOffPrediction * place->least_step())
                    continue;
                extra.emplace_back(cell, *fit);
                more = true;
            }
        for (const auto& [cell, fit] : extra) {
            lattice[cell] = {fit.at, -1};
            fits.emplace(cell, fit);
        }
        if (!more) break;
    }
    drop_misfits(lattice, kMisfitMeasured);
    return blur_px;
}

void refine_corners(const cv::Mat& grey, double factor, double blur_px, SaddleLattice& lattice) {
    const LatticeBox box = box_of(lattice);
    for (auto& [cell, corner] : lattice)
        corner.at = (corner.at + Vector2d(0.5, 0.5)) * factor - Vector2d(0.5, 0.5);
    constexpr std::size_t kSomeCorners = 120, kManyCorners = 400;  // of many, a smaller window
    const int usual_half = lattice.size() > kManyCorners ? 6 : lattice.size() > kSomeCorners ? 8 : 11;
    // A soft edge needs a window that reaches beyond it.
    const int most = std::clamp(static_cast<int>(3 * blur_px), usual_half, 26);
    std::map<LatticeCell, CornerFit> fits;
    std::vector<LatticeCell> bad;
    for (const auto& entry : lattice) {
        const LatticeCell& cell = entry.first;
        const LatticeCorner& corner = entry.second;
        const auto place = predict(lattice, cell.first, cell.second, 3);
        if (!place) {
            bad.push_back(cell);
            continue;
        }
        CornerStart s = start_at(cell, *place, corner.at, most);
        const auto bend = [&](int di, int dj) -> Vector2d {
            for (const int shift : {0, 1, -1}) {
                const auto a = lattice.find({cell.first + (shift - 1) * di, cell.second + (shift - 1) * dj}),
                           b = lattice.find({cell.first + shift * di, cell.second + shift * dj}),
                           c = lattice.find({cell.first + (shift + 1) * di, cell.second + (shift + 1) * dj});
                if (a == lattice.end() || b == lattice.end() || c == lattice.end()) continue;
                return (a->second.at - 2 * b->second.at + c->second.at) /
                       (0.25 * (c->second.at - a->second.at).squaredNorm());
            }
            return Vector2d::Zero();
        };
        const bool even = (cell.first + cell.second) % 2 == 0;
        const Vector2d along_i = bend(1, 0), along_j = bend(0, 1);
        const Vector2d &one = even ? along_i : along_j, &two = even ? along_j : along_i;
        s.bend1 = one.dot(Vector2d(-s.first.y(), s.first.x()));
        s.bend2 = two.dot(Vector2d(s.second.y(), -s.second.x()));
        if (const auto fit = fit_corner(grey, s); fit && sound(*fit))
            fits.emplace(cell, *fit);
        else
            bad.push_back(cell);
    }

    // What the model explains worse than on the rest of the board, or with less contrast than around it, has
    // something else in its window.
    std::vector<double> rests, levels;
    for (const auto& [cell, fit] : fits) {
        rests.push_back(fit.noise / fit.half_contrast);
        levels.push_back(fit.half_contrast);
    }
    const double usual_contrast = median(levels);
    const double usual = median(rests);
    for (const auto& [cell, fit] : fits) {
        std::vector<double> contrasts;
        for (int di = -2; di <= 2; ++di)
            for (int dj = -2; dj <= 2; ++dj)
                if (const auto n = fits.find({cell.first + di, cell.second + dj}); n != fits.end())
                    contrasts.push_back(n->second.half_contrast);
        if (fit.noise > (kRestTimes * usual + kRestMore) * fit.half_contrast ||
            fit.half_contrast < kLeastContrastAround * median(contrasts))
            bad.push_back(cell);
    }
    for (auto& [cell, fit] : fits) lattice[cell].at = fit.at;
    for (const LatticeCell& c : bad) lattice.erase(c);
    // What the searched scale was too coarse for.
    for (int i = box.low_i; i <= box.high_i; ++i)
        for (int j = box.low_j; j <= box.high_j; ++j) {
            if (fits.count({i, j})) continue;
            const auto place = predict(lattice, i, j);
            if (!place) continue;
            const auto fit = fit_corner(grey, start_at({i, j}, *place, place->at, most));
            if (!fit || !sound(*fit) || fit->foreign > kMostForeign ||
                fit->half_contrast < kLeastContrastAdded * usual_contrast ||
                fit->noise > (kRestTimes * usual + kRestMore) * fit->half_contrast ||
                (fit->at - place->at).norm() > kOffPrediction * place->least_step())
                continue;
            lattice[{i, j}] = {fit->at, -1};
            fits.emplace(LatticeCell{i, j}, *fit);
        }
    drop_pulled(fits, lattice);
}

}  // namespace seamwright::detail
