#include "widgets/profile/decimate.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace seamwright {

namespace {

int segment_of(const Profile& profile, bool filtered, std::size_t i) {
    return filtered ? profile.segment[i] : 0;
}

bool has_point(const Profile& profile, std::size_t i) {
    return std::isfinite(profile.x_mm[i]) && std::isfinite(profile.z_mm[i]);
}

}  // namespace

void decimate(const Profile& profile, const TraceScale& scale, std::vector<ColumnStroke>& strokes,
              std::vector<int>& outliers) {
    strokes.clear();
    outliers.clear();
    const bool filtered = profile.filtered();
    // A point beside the picture takes part once, as the neighbour that the rim's stroke is joined to.
    const double far_px = 4.0 * (scale.height_px + 16);
    bool joined = false;  // the last stroke and this point belong together
    int last_segment = kOutlier;
    for (std::size_t i = 0; i < profile.size(); ++i) {
        if (!has_point(profile, i)) continue;
        const double u = (profile.x_mm[i] - scale.x_left_mm) * scale.px_per_mm;
        const double v = std::clamp((scale.z_top_mm - profile.z_mm[i]) * scale.px_per_mm, -far_px, far_px);
        if (!(u > -1e6 && u < 1e6)) continue;
        const int segment = segment_of(profile, filtered, i);
        const int column = static_cast<int>(std::floor(u));
        const bool inside = column >= 0 && column < scale.width_px;
        if (segment < 0) {
            if (inside) outliers.push_back(static_cast<int>(i));
            continue;
        }
        if (!inside) {
            joined = false;
            last_segment = segment;
            continue;
        }
        const float y = static_cast<float>(v);
        joined = joined && segment == last_segment && !strokes.empty();
        last_segment = segment;
        if (joined && strokes.back().column == column) {
            strokes.back().low = std::min(strokes.back().low, y);
            strokes.back().high = std::max(strokes.back().high, y);
            continue;
        }
        ColumnStroke stroke{column, y, y, segment};
        if (joined && std::abs(column - strokes.back().column) == 1) {
            ColumnStroke& before = strokes.back();
            if (y > before.high) {
                const float middle = 0.5F * (y + before.high);
                before.high = middle;
                stroke.low = middle;
            } else if (y < before.low) {
                const float middle = 0.5F * (y + before.low);
                before.low = middle;
                stroke.high = middle;
            }
        }
        strokes.push_back(stroke);
        joined = true;
    }
}

int nearest_point(const Profile& profile, double x_mm, double z_mm, double radius_mm) {
    const bool filtered = profile.filtered();
    double best = radius_mm * radius_mm;
    int index = -1;
    for (std::size_t i = 0; i < profile.size(); ++i) {
        if (!has_point(profile, i) || segment_of(profile, filtered, i) < 0) continue;
        const double dx = profile.x_mm[i] - x_mm, dz = profile.z_mm[i] - z_mm;
        const double square = dx * dx + dz * dz;
        if (square <= best) {
            best = square;
            index = static_cast<int>(i);
        }
    }
    return index;
}

void residuals_to_reference(const Profile& profile, const Profile& reference,
                            std::vector<double>& residuals_mm) {
    constexpr double kReach_mm = 3;
    residuals_mm.clear();
    struct Piece {
        double x0, z0, x1, z1;
    };
    std::vector<Piece> pieces;
    const bool filtered_reference = reference.filtered();
    double longest = 0;
    std::size_t before = reference.size();
    for (std::size_t i = 0; i < reference.size(); ++i) {
        if (!has_point(reference, i) || segment_of(reference, filtered_reference, i) < 0) continue;
        if (before < reference.size() && segment_of(reference, filtered_reference, i) ==
                                             segment_of(reference, filtered_reference, before)) {
            Piece piece{reference.x_mm[before], reference.z_mm[before], reference.x_mm[i], reference.z_mm[i]};
            if (piece.x0 > piece.x1) {
                std::swap(piece.x0, piece.x1);
                std::swap(piece.z0, piece.z1);
            }
            longest = std::max(longest, piece.x1 - piece.x0);
            pieces.push_back(piece);
        }
        before = i;
    }
    if (pieces.empty()) return;
    std::sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) { return a.x0 < b.x0; });
    const bool filtered = profile.filtered();
    for (std::size_t i = 0; i < profile.size(); ++i) {
        if (!has_point(profile, i) || segment_of(profile, filtered, i) < 0) continue;
        const double x = profile.x_mm[i], z = profile.z_mm[i];
        const auto first =
            std::lower_bound(pieces.begin(), pieces.end(), x - kReach_mm - longest,
                             [](const Piece& piece, double limit) { return piece.x0 < limit; });
        double best = kReach_mm, signed_best = 0;
        bool found = false;
        for (auto piece = first; piece != pieces.end() && piece->x0 <= x + kReach_mm; ++piece) {
            const double dx = piece->x1 - piece->x0, dz = piece->z1 - piece->z0;
            const double square = dx * dx + dz * dz;
            if (square <= 0) continue;
            const double along = ((x - piece->x0) * dx + (z - piece->z0) * dz) / square;
            if (along < 0 || along > 1) continue;
            const double across = ((z - piece->z0) * dx - (x - piece->x0) * dz) / std::sqrt(square);
            if (std::abs(across) < best) {
                best = std::abs(across);
                signed_best = across;
                found = true;
            }
        }
        if (found) residuals_mm.push_back(signed_best);
    }
}

}  // namespace seamwright
