#include "core/calibration/board/board_checker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/calibration/board/board_borders.h"
#include "core/calibration/board/board_corners.h"
#include "core/calibration/board/board_saddles.h"

namespace seamwright::detail {
namespace {

using Eigen::Vector2d;

// One lattice, in the coordinates of the searched scale until it is known to be the board.
class Candidate {
  public:
    // `small`: `grey` at the scale of the search, `factor` times smaller; `soft` what was searched.
    Candidate(const cv::Mat& grey, const cv::Mat& small, const cv::Mat& soft, double factor,
              SaddleLattice lattice, const BoardSpec& spec)
        : grey_(grey),
          small_(small),
          soft_(soft),
          factor_(factor),
          lattice_(std::move(lattice)),
          spec_(spec) {}

    BoardSearch run() {
        const double blur_px = measure_corners(small_, lattice_);
        BoardSearch out;
        if (lattice_.size() < 6) return out;
        trimmed = trim(soft_, lattice_);
        if (lattice_.size() < 6) return out;
        box_ = box_of(lattice_);
        borders_ = borders_of(soft_, lattice_);
        if (!coloured(soft_, lattice_)) return out;
        if (const auto window = placed()) {
            refine_corners(grey_, factor_, blur_px * factor_, lattice_);
            if (enough()) out.board = ordered(*window);
            spanned = box_.columns() * box_.rows() == spec_.columns * spec_.rows;
        } else {
            out.miss.counted = counted();
            too_large = exceeds();
        }
        return out;
    }

    // Every corner that was not seen was looked for in the picture as taken.
    bool spanned = false;
    // More corners in a row than the board has: another board, whatever a part of it may look like.
    bool too_large = false;
    // Something at the rim was taken for corners.
    bool trimmed = false;

  private:
    // How many corners the board has along an axis: seen, and promised by squares beyond. nullopt where an end
    // of the board is not seen and not cut off by the picture's rim, or both are cut off: it might have any.
    static std::optional<int> length(int seen, const Border& low, const Border& high) {
        if (!(low.ended || high.ended) || !(low.ended || low.cut) || !(high.ended || high.cut))
            return std::nullopt;
        return low.more + seen + high.more;
    }

    bool enough() const {
        constexpr std::size_t kLeastPercent = 45, kFewest = 7;  // of the board's corners
        const std::size_t total =
            static_cast<std::size_t>(spec_.columns) * static_cast<std::size_t>(spec_.rows);
        return lattice_.size() * 100 >= total * kLeastPercent && lattice_.size() >= kFewest;
    }

    struct Window {
        int i0, j0;
        bool across;  // the board's columns run along j
    };
    std::optional<Window> placed() const {
        const auto columns = length(box_.columns(), borders_[1], borders_[0]),
                   rows = length(box_.rows(), borders_[3], borders_[2]);
        if (!columns || !rows || !enough()) return std::nullopt;
        const bool across = *columns != spec_.columns;
        if (std::pair(*columns, *rows) !=
            (across ? std::pair(spec_.rows, spec_.columns) : std::pair(spec_.columns, spec_.rows)))
            return std::nullopt;
        return Window{box_.low_i - borders_[1].more, box_.low_j - borders_[3].more, across};
    }

    FoundBoard ordered(const Window& window) const {
        const auto [i0, j0, across] = window;
        FoundBoard board;
        const auto to_board = [&, w = window](const LatticeCell& cell) {
            const int i = cell.first - w.i0, j = cell.second - w.j0;
            return w.across ? LatticeCell{j, spec_.rows - 1 - i} : LatticeCell{i, j};
        };
        for (const auto& [cell, corner] : lattice_) {
            const LatticeCell at = to_board(cell);
            board.index.push_back(at.second * spec_.columns + at.first);
            board.pixel.push_back(corner.at);
            board.object_mm.emplace_back(at.first * spec_.pitch_mm, at.second * spec_.pitch_mm, 0);
        }
        // The square between (0, 0) and (1, 1) in the lattice: its lowest corner.
        const bool dark_first = (i0 + j0 + (across ? spec_.rows - 2 : 0)) % 2 != 0;
        int turns = 0;
        if ((spec_.columns + spec_.rows) % 2 == 1) {
            board.symmetry = 1;
            turns = dark_first ? 0 : 2;
        } else {
            // Alike: the reading whose columns run to the right in the picture. An odd square board tells
            // quarter turns apart by colour.
            const bool square = spec_.columns == spec_.rows, odd = spec_.columns % 2 == 1;
            board.symmetry = square && !odd ? 4 : 2;
            double best = -1e300;
            for (int t = 0; t < 4; t += square ? 1 : 2) {
                if (square && odd && (t % 2 == 1) == dark_first) continue;
                const double right = to_the_right(turned(board, spec_, t));
                if (right > best) best = right, turns = t;
            }
        }
        if (turns) board = turned(board, spec_, turns);
        std::vector<std::size_t> order(board.index.size());
        for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
        std::sort(order.begin(), order.end(),
                  [&](std::size_t a, std::size_t b) { return board.index[a] < board.index[b]; });
        FoundBoard out;
        out.symmetry = board.symmetry;
        for (const std::size_t k : order) {
            out.index.push_back(board.index[k]);
            out.pixel.push_back(board.pixel[k]);
            out.object_mm.push_back(board.object_mm[k]);
        }
        const auto total = static_cast<std::size_t>(spec_.columns) * static_cast<std::size_t>(spec_.rows);
        out.detector = out.index.size() == total ? "lattice" : "lattice, some corners hidden";
        return out;
    }

    // Slope of the picture's u over the board's x.
    static double to_the_right(const FoundBoard& board) {
        double mean_x = 0, mean_u = 0, sum = 0;
        const auto n = static_cast<double>(board.index.size());
        for (std::size_t k = 0; k < board.index.size(); ++k)
            mean_x += board.object_mm[k].x() / n, mean_u += board.pixel[k].x() / n;
        for (std::size_t k = 0; k < board.index.size(); ++k)
            sum += (board.object_mm[k].x() - mean_x) * (board.pixel[k].x() - mean_u);
        return sum;
    }

    bool exceeds() const {
        std::map<int, int> in_i, in_j;
        for (const auto& [cell, corner] : lattice_) ++in_i[cell.first], ++in_j[cell.second];
        const auto extent = [](const std::map<int, int>& in) {
            int low = 1 << 20, high = -low;
            for (const auto& [k, count] : in)
                if (count >= 2) low = std::min(low, k), high = std::max(high, k);
            return high - low + 1;
        };
        const int a = extent(in_i), b = extent(in_j);
        return std::max(a, b) > std::max(spec_.columns, spec_.rows) ||
               std::min(a, b) > std::min(spec_.columns, spec_.rows);
    }

    std::optional<BoardCount> counted() const {
        for (const Border& b : borders_)
            if (!b.ended) return std::nullopt;
        int columns = box_.columns() + borders_[0].more + borders_[1].more,
            rows = box_.rows() + borders_[2].more + borders_[3].more;
        if ((columns < rows) != (spec_.columns < spec_.rows)) std::swap(columns, rows);
        if (columns < 3 || rows < 3 || (columns == spec_.columns && rows == spec_.rows)) return std::nullopt;
        return BoardCount{columns, rows};
    }

    const cv::Mat& grey_;
    const cv::Mat& small_;
    const cv::Mat& soft_;
    double factor_;
    SaddleLattice lattice_;
    const BoardSpec& spec_;
    LatticeBox box_;
    std::array<Border, 4> borders_;  // +i, -i, +j, -j
};

}  // namespace

BoardSearch find_checker(const cv::Mat& grey, double full_scale, const BoardSpec& spec) {
    const auto total = static_cast<std::size_t>(spec.columns) * static_cast<std::size_t>(spec.rows);
    // The finest scale that a search looks at has about a megapixel; a board whose squares are too small for
    // it fills a corner of a large picture.
    constexpr double kFinest = 1.7e6;
    constexpr double kRadius = 4;
    constexpr int kSmallestPicture_px = 48;
    int finest = 1;
    while (static_cast<double>(grey.total()) / (finest * finest) > kFinest) finest *= 2;
    BoardSearch best;
    bool spanned = false, other = false;
    const auto look = [&](int factor) {
        cv::Mat small;
        if (factor == 1)
            small = grey;
        else
            cv::resize(grey(cv::Rect(0, 0, grey.cols / factor * factor, grey.rows / factor * factor)), small,
                       {grey.cols / factor, grey.rows / factor}, 0, 0, cv::INTER_AREA);
        if (std::min(small.cols, small.rows) < kSmallestPicture_px) return false;
        const cv::Mat soft = softened_root(small, full_scale);
        const auto saddles = find_saddles(soft, kRadius);
        const auto lattices =
            grow_lattices(soft, saddles, std::min<std::size_t>(9, std::max<std::size_t>(6, total / 3)));
        constexpr std::size_t kMost = 3;  // more pictures of boards than one are worth a word
        std::optional<FoundBoard> here;
        for (std::size_t k = 0; k < std::min(kMost, lattices.size()); ++k) {
            Candidate candidate(grey, small, soft, factor, lattices[k], spec);
            BoardSearch found = candidate.run();
            if (candidate.too_large) other = true;
            spanned |= found.board && candidate.spanned;
            best.miss.several |= here && found.board;
            if (found.board && !here) here = std::move(found.board);
            if (found.miss.counted && !best.miss.counted) best.miss.counted = found.miss.counted;
            // A whole board of another size: what another scale made of it would be less.
            if (found.miss.counted && k == 0 && !here && !best.board && !candidate.trimmed) other = true;
        }
        if (here && (!best.board || here->index.size() > best.board->index.size()))
            best.board = std::move(here);
        return spanned || other;
    };
    for (const int factor : {2 * finest, finest, 4 * finest})
        if (look(factor)) break;
    if ((other && !spanned) || best.miss.several) best.board.reset();
    if (best.board || best.miss.several) best.miss.counted.reset();
    return best;
}

}  // namespace seamwright::detail