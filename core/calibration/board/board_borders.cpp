#include "core/calibration/board/board_borders.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/median.h"

namespace seamwright::detail {
namespace {

// Where a square's and a corner's grey are read, in steps of the lattice from their middle.

// Off the middle, clear of the edges around.
constexpr double kSampleAside = 0.2;

// Levels: paper is 1, ink -1 (Levels::of).

// In the softened root, paper above ink: below, there is no board to read.
constexpr double kLeastLevelGap = 0.05;
// Of the right sign: the colour is the square's own, not grey between two.
constexpr double kClearLevel = 0.3;
// Of the seen squares of a row that show their colour clearly, or the board does not go on.
constexpr double kLeastRightShare = 0.8;
// Of the squares inside that have their colour, or it is no checkerboard.
constexpr double kLeastColouredShare = 0.85;
constexpr double kSameLevel = 0.7;   // two places closer than this in level are of one colour
constexpr double kOtherLevel = 1.3;  // two places farther apart than this are paper and ink

// Steps of the lattice.

// The dark squares' ends of a row that end on one line: the plate is cut there.
constexpr double kStraightWithin = 0.15;
constexpr double kOnLineWithin = 0.12;  // from the line of corners: the step of grey counts as lying on it
constexpr double kEndFrom = 0.2;        // inside a square's middle: where the look for its end begins
constexpr double kEndTo = 0.8;          // outside of it: where the look ends
constexpr double kEndStep = 0.05;
// Where paper or the next square is looked for if the middle of the next one hides.
constexpr double kBehindNear = 0.75;
constexpr double kBehindFar = 1.3;  // ... and if that hides too
// Ways out beside a square's own, in its neighbour: near the corner between them.
constexpr double kAsideNear = 0.7;
constexpr double kAsideFar = 0.85;  // ... and nearer to the neighbour's middle

using Eigen::Vector2d;

class Surroundings {
  public:
    Surroundings(const cv::Mat& soft, const SaddleLattice& lattice)
        : soft_(soft), lattice_(lattice), box_(box_of(lattice)) {}

    // Grey of a square in the searched picture; nothing outside.
    std::optional<double> grey_of_square(int i, int j, int reach) const {
        const auto place = predict(lattice_, i + 0.5, j + 0.5, reach);
        if (!place) return std::nullopt;
        double sum = 0;
        for (const auto& [a, b] : {std::pair{0.0, 0.0},
                                   {kSampleAside, 0.0},
                                   {-kSampleAside, 0.0},
                                   {0.0, kSampleAside},
                                   {0.0, -kSampleAside}}) {
            const auto g = grey_at(place->at + a * place->along_i + b * place->along_j);
            if (!g) return std::nullopt;
            sum += *g / 5;
        }
        return sum;
    }

    std::optional<double> grey_at(const Vector2d& q) const {
        if (!(q.x() >= 0 && q.y() >= 0 && q.x() <= soft_.cols - 1 && q.y() <= soft_.rows - 1))
            return std::nullopt;
        const int x = std::min(static_cast<int>(q.x()), soft_.cols - 2),
                  y = std::min(static_cast<int>(q.y()), soft_.rows - 2);
        const double fx = q.x() - x, fy = q.y() - y;
        const float *a = soft_.ptr<float>(y) + x, *b = soft_.ptr<float>(y + 1) + x;
        return (1 - fy) * ((1 - fx) * static_cast<double>(a[0]) + fx * static_cast<double>(a[1])) +
               fy * ((1 - fx) * static_cast<double>(b[0]) + fx * static_cast<double>(b[1]));
    }

    static double sign_of(int i, int j) { return (i + j) % 2 == 0 ? 1 : -1; }

    // Square number `along` of the row `beyond` rows outside a side (0: the squares that the last corners
    // share in; -1: the last inside).
    LatticeCell square_of(int side, int beyond, int along) const {
        switch (side) {
            case 0:
                return {box_.high_i + beyond, box_.low_j - 1 + along};
            case 1:
                return {box_.low_i - 1 - beyond, box_.low_j - 1 + along};
            case 2:
                return {box_.low_i - 1 + along, box_.high_j + beyond};
            default:
                return {box_.low_i - 1 + along, box_.low_j - 1 - beyond};
        }
    }
    int squares_along(int side) const { return 1 + (side < 2 ? box_.rows() : box_.columns()); }

    struct Levels {
        double white, black;
        double of(double grey) const { return (2 * grey - white - black) / (white - black); }
    };
    // Paper and ink by the squares nearest to a side of which three corners are seen at least: what hides corners
    // hides the squares' colours.
    std::optional<Levels> levels_at(int side) const {
        std::vector<std::pair<int, double>> white, black;
        for (int i = box_.low_i; i < box_.high_i; ++i)
            for (int j = box_.low_j; j < box_.high_j; ++j) {
                if (lattice_.count({i, j}) + lattice_.count({i + 1, j}) + lattice_.count({i, j + 1}) +
                        lattice_.count({i + 1, j + 1}) <
                    3)
                    continue;
                const int away = side == 0   ? box_.high_i - i
                                 : side == 1 ? i - box_.low_i
                                 : side == 2 ? box_.high_j - j
                                             : j - box_.low_j;
                if (const auto g = grey_of_square(i, j, 2))
                    (sign_of(i, j) > 0 ? white : black).emplace_back(away, *g);
            }
        const auto usual = [&](std::vector<std::pair<int, double>>& squares) {
            std::sort(squares.begin(), squares.end());
            std::vector<double> near;
            for (const auto& [away, grey] : squares)
                if (near.size() < static_cast<std::size_t>(squares_along(side))) near.push_back(grey);
            return median(near);
        };
        if (white.empty() || black.empty()) return std::nullopt;
        const Levels levels{usual(white), usual(black)};
        if (!(levels.white > levels.black + kLeastLevelGap)) return std::nullopt;
        return levels;
    }

    // Whether most of the squares of a row are seen and have the colours of the board.
    bool go_on(int side, int beyond, const Levels& levels) const {
        int seen = 0, right = 0;
        double score = 0;
        const int count = squares_along(side);
        for (int k = 0; k < count; ++k) {
            const LatticeCell c = square_of(side, beyond, k);
            const auto g = grey_of_square(c.first, c.second, 3 + beyond);
            if (!g) continue;
            const double level = levels.of(*g);
            if (level > 2) continue;  // a stripe or a glint
            const double match = sign_of(c.first, c.second) * std::clamp(level, -1.0, 1.0);
            ++seen;
            right += match > kClearLevel;
            score += match;
        }
        return seen >= 3 && 2 * seen >= count && score > 0.5 * seen && right >= kLeastRightShare * seen;
    }

    // What the grey values say along a way outwards over the line of corners that would be next.
    struct Way {
        double inside = 0, outside = 0;  // levels right before and right behind that line
        double step_at = -1;             // where half of the step between them is passed, once
    };
    enum class Seen { yes, out_of_picture, outshone };
    Vector2d outwards(int side, const LatticePlace& square) const {
        return (side % 2 == 0 ? 1.0 : -1.0) * (side < 2 ? square.along_i : square.along_j);
    }
    // `aside`: off the square's middle; `line`: how far out of it the line is expected; in steps.
    Seen look_out(int side, const LatticePlace& square, double aside, double line, const Levels& levels,
                  Way& way) const {
        const Vector2d out = outwards(side, square),
                       from = square.at + aside * (side < 2 ? square.along_j : square.along_i);
        constexpr std::size_t kSteps = 11, kFlat = 3;
        constexpr double kStep = 0.05, kReach = kStep * (kSteps - 1) / 2;
        std::array<double, kSteps> level;
        for (std::size_t k = 0; k < kSteps; ++k) {
            const auto g = grey_at(from + (line - kReach + kStep * static_cast<double>(k)) * out);
            if (!g) return Seen::out_of_picture;
            level[k] = levels.of(*g);
            if (level[k] > 2) return Seen::outshone;
        }
        way = {};
        for (std::size_t k = 0; k < kFlat; ++k) {
            way.inside += level[k] / kFlat;
            way.outside += level[kSteps - 1 - k] / kFlat;
        }
        if (std::abs(way.outside - way.inside) < 0.5) return Seen::yes;
        const double middle = 0.5 * (way.inside + way.outside);
        int steps = 0;
        for (std::size_t k = 0; k + 1 < kSteps; ++k)
            if ((level[k] < middle) != (level[k + 1] < middle)) {
                ++steps;
                way.step_at =
                    line - kReach +
                    kStep * (static_cast<double>(k) + (middle - level[k]) / (level[k + 1] - level[k]));
            }
        if (steps != 1) way.step_at = -1;
        return Seen::yes;
    }

    // How much farther out than the corners around say, in steps, the line behind a square of the ring lies where a
    // lens bends the lattice: by the last three corners of the lines to both sides of it.
    double bent(int side, const LatticeCell& c, const LatticePlace& square) const {
        const bool i = side < 2;
        const Vector2d out = outwards(side, square);
        double sum = 0;
        int lines = 0;
        for (const int to : {0, 1}) {
            const auto corner = [&](int inwards) {
                const int o = side % 2 == 0 ? -inwards : 1 + inwards;
                return lattice_.find(i ? LatticeCell{c.first + o, c.second + to}
                                       : LatticeCell{c.first + to, c.second + o});
            };
            const auto a = corner(0), b = corner(1), d = corner(2);
            if (a == lattice_.end() || b == lattice_.end() || d == lattice_.end()) continue;
            const Vector2d next = 3 * a->second.at - 3 * b->second.at + d->second.at;
            const Vector2d expected =
                square.at + 0.5 * out + (to - 0.5) * (i ? square.along_j : square.along_i);
            sum += (next - expected).dot(out) / out.squaredNorm();
            ++lines;
        }
        return lines ? std::clamp(sum / lines, -0.25, 0.25) : 0;
    }

    // The board's end behind the row of squares `beyond`, counted in pairs of neighbours in that row.
    struct End {
        // A square ends on the lattice's line over its width, and behind its neighbour of the other colour lies the
        // same as behind it: if the board went on, that would be of the other colour too, and a thing in front of
        // the board would have to end on that line, and along it.
        int on_line = 0, going_on = 0, unclear = 0, outshone = 0, out_of_picture = 0;
        // Of all pairs: the two squares that would follow are both as bright as paper; of two colours.
        int pairs = 0, paper = 0, squares = 0;
        // Where the dark squares of the row end, in steps from their middle.
        int dark_ends = 0;
        double first_end = 2, last_end = -1;

        bool seen() const {
            if (going_on + squares > 0 && 2 * (going_on + squares) >= on_line) return false;
            // One pair alone beside much that is hidden may be what a paper in front of the board lets through.
            if (on_line > 1 || (on_line == 1 && unclear <= 1)) return true;
            // Under a stripe all along: paper on its far side.
            if (unclear + out_of_picture == 0 && outshone > 0 && paper >= 2) return true;
            return false;
        }
        // The plate may be cut through its squares: the dark ones end on a line along the lattice.
        bool straight() const {
            return dark_ends >= 3 && 4 * dark_ends >= pairs && last_end - first_end < kStraightWithin;
        }
        // On that line, over most of the side.
        bool seen_on_cut() const { return on_line >= 4 && going_on == 0 && 2 * on_line >= on_line + unclear; }
        bool cut() const {
            return on_line + going_on + squares == 0 && unclear + outshone <= 2 && out_of_picture >= 4;
        }
    };
    // `cut_at`: the line where the plate is cut, in steps from the squares' middle.
    End end_of(int side, int beyond, const Levels& levels, std::optional<double> cut_at = {}) const {
        End end;
        const int count = squares_along(side);
        // Paper or a square of the board in the middle of what would be the next row's square.
        std::vector<std::optional<double>> behind(static_cast<std::size_t>(count));
        std::vector<char> right(behind.size(), 0);
        for (int k = 0; k < count; ++k) {
            const LatticeCell c = square_of(side, beyond, k);
            const auto square = predict(lattice_, c.first + 0.5, c.second + 0.5, 3 + beyond);
            if (!square) continue;
            const double colour = sign_of(c.first, c.second);
            const auto level_at = [&](double out) -> std::optional<double> {
                const auto g = grey_at(square->at + out * outwards(side, *square));
                return g && levels.of(*g) < 2 ? std::optional(levels.of(*g)) : std::nullopt;
            };
            const auto own = level_at(-0.25);
            right[static_cast<std::size_t>(k)] = own && colour * *own > kClearLevel;
            for (const double out : {1.0, kBehindNear, kBehindFar})
                if (!behind[static_cast<std::size_t>(k)]) behind[static_cast<std::size_t>(k)] = level_at(out);
            if (colour < 0 && right[static_cast<std::size_t>(k)])
                for (double out = -kEndFrom; out < kEndTo; out += kEndStep) {
                    const auto level = level_at(out);
                    if (!level) break;
                    if (*level < 0) continue;
                    ++end.dark_ends;
                    end.first_end = std::min(end.first_end, out);
                    end.last_end = std::max(end.last_end, out);
                    break;
                }

            const double line = cut_at ? *cut_at : 0.5 + (beyond == 0 ? bent(side, c, *square) : 0);
            bool on_line = true, inside_picture = true, dim = true;
            double outside = 0;
            for (const double aside : {-0.25, 0.0, 0.25}) {
                Way way;
                const Seen seen = look_out(side, *square, aside, line, levels, way);
                inside_picture &= seen != Seen::out_of_picture;
                dim &= seen != Seen::outshone;
                on_line &= seen == Seen::yes && colour * way.inside > kClearLevel &&
                           std::abs(way.step_at - line) < kOnLineWithin;
                outside += way.outside / 3;
            }
            for (const int towards : {-1, 1}) {
                if (k + towards < 0 || k + towards >= count) continue;
                bool same = on_line, other = on_line, in_picture = inside_picture, plain = dim;
                for (const double aside : {kAsideNear, kAsideFar}) {
                    Way way;
                    const Seen seen = look_out(side, *square, towards * aside, line, levels, way);
                    in_picture &= seen != Seen::out_of_picture;
                    plain &= seen != Seen::outshone;
                    const bool clear = seen == Seen::yes && colour * way.inside < -kClearLevel;
                    same &= clear && std::abs(way.outside - outside) < kSameLevel;
                    other &= clear && std::abs(way.outside - outside) > 1;
                }
                if (!in_picture)
                    ++end.out_of_picture;
                else if (same)
                    ++end.on_line;
                else if (other)
                    ++end.going_on;
                else if (colour < 0)
                    ++(plain ? end.unclear : end.outshone);
            }
        }
        for (std::size_t k = 0; k + 1 < behind.size(); ++k) {
            ++end.pairs;
            if (!right[k] || !right[k + 1] || !behind[k] || !behind[k + 1]) continue;
            const double apart = std::abs(*behind[k] - *behind[k + 1]);
            end.paper += apart < kSameLevel && std::min(*behind[k], *behind[k + 1]) > 0.5;
            end.squares += apart > kOtherLevel && *behind[k] * *behind[k + 1] < 0;
        }
        return end;
    }

    Border border(int side) const {
        Border b;
        const auto levels = levels_at(side);
        if (!levels) return b;
        constexpr int kFarthest = 4;
        int rows = 0;
        while (rows < kFarthest && go_on(side, rows, *levels)) ++rows;
        b.more = std::max(0, rows - 1);
        const End end = end_of(side, b.more, *levels);
        b.ended = end.seen();
        if (!b.ended && end.straight())
            b.ended = end_of(side, b.more, *levels, 0.5 * (end.first_end + end.last_end)).seen_on_cut();
        b.cut = !b.ended && end.cut();
        return b;
    }

    // The corner that the squares k and k + 1 of the row `beyond` share on their near side.
    std::optional<LatticePlace> corner_beyond(int side, int beyond, int k) const {
        const LatticeCell a = square_of(side, beyond, k + 1);
        return predict(lattice_, a.first + (side == 1 ? 1 : 0), a.second + (side == 3 ? 1 : 0), 3 + beyond);
    }

    // How many of the corners `beyond` rows outside a side would be seen: inside the picture and not under a
    // stripe.
    int corners_in_sight(int side, int beyond, const Levels& levels) const {
        int seen = 0;
        const int count = squares_along(side) - 1;
        for (int k = 0; k < count; ++k) {
            const auto place = corner_beyond(side, beyond, k);
            if (!place) continue;
            bool clear = true;
            for (const auto& [x, y] : {std::pair{0.0, 0.0},
                                       {kSampleAside, kSampleAside},
                                       {-kSampleAside, kSampleAside},
                                       {kSampleAside, -kSampleAside},
                                       {-kSampleAside, -kSampleAside}}) {
                const auto g = grey_at(place->at + x * place->along_i + y * place->along_j);
                clear &= g && levels.of(*g) < 2;
            }
            seen += clear;
        }
        return seen;
    }

    // The corners of the last row of a side, where something beyond the board was taken for it: one or two
    // where a whole row would be seen. Empty: there is none.
    std::vector<LatticeCell> row_that_is_none(int side) const {
        const auto levels = levels_at(side);
        if (!levels) return {};
        std::vector<LatticeCell> row;
        for (const auto& [cell, corner] : lattice_)
            if (cell.first == (side == 0   ? box_.high_i
                               : side == 1 ? box_.low_i
                                           : cell.first) &&
                cell.second == (side == 2   ? box_.high_j
                                : side == 3 ? box_.low_j
                                            : cell.second))
                row.push_back(cell);
        const auto n = static_cast<int>(row.size());
        if (n > 2 || 10 * n >= 4 * corners_in_sight(side, 0, *levels)) return {};
        // Beside a thing in front of the board a corner still has its four squares.
        int wrong = 0;
        for (const LatticeCell& c : row)
            for (const int di : {-1, 0})
                for (const int dj : {-1, 0})
                    if (const auto g = grey_of_square(c.first + di, c.second + dj, 3))
                        wrong += sign_of(c.first + di, c.second + dj) * levels->of(*g) < 0;
        return wrong < n ? std::vector<LatticeCell>{} : row;
    }

    // The squares inside have the colours of a checkerboard.
    bool coloured() const {
        int seen = 0, right = 0;
        std::vector<double> white, black;
        for (int i = box_.low_i; i < box_.high_i; ++i)
            for (int j = box_.low_j; j < box_.high_j; ++j)
                if (lattice_.count({i, j}) && lattice_.count({i + 1, j + 1}) && lattice_.count({i + 1, j}) &&
                    lattice_.count({i, j + 1}))
                    if (const auto g = grey_of_square(i, j, 2))
                        (sign_of(i, j) > 0 ? white : black).push_back(*g);
        if (white.empty() || black.empty()) return false;
        const Levels levels{median(white), median(black)};
        if (!(levels.white > levels.black)) return false;
        // A stripe or a glint is no colour.
        for (const double g : white)
            if (levels.of(g) < 2) ++seen, right += levels.of(g) > 0;
        for (const double g : black)
            if (levels.of(g) < 2) ++seen, right += levels.of(g) < 0;
        return seen >= 2 && right >= kLeastColouredShare * seen;
    }

  private:
    const cv::Mat& soft_;
    const SaddleLattice& lattice_;
    LatticeBox box_;
};

}  // namespace

std::array<Border, 4> borders_of(const cv::Mat& soft, const SaddleLattice& lattice) {
    const Surroundings around(soft, lattice);
    return {around.border(0), around.border(1), around.border(2), around.border(3)};
}

bool coloured(const cv::Mat& soft, const SaddleLattice& lattice) {
    return Surroundings(soft, lattice).coloured();
}

bool trim(const cv::Mat& soft, SaddleLattice& lattice) {
    bool trimmed = false;
    for (bool again = true; again;) {
        again = false;
        for (int side = 0; side < 4 && !again; ++side) {
            const LatticeBox box = box_of(lattice);
            if (box.columns() < 3 || box.rows() < 3) return trimmed;
            const auto row = Surroundings(soft, lattice).row_that_is_none(side);
            for (const LatticeCell& c : row) lattice.erase(c);
            again = !row.empty();
            trimmed |= again;
        }
        if (lattice.size() < 6) return trimmed;
    }
    return trimmed;
}

}  // namespace seamwright::detail
