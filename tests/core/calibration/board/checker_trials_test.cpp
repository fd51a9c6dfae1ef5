// How often a checkerboard is found, and that none is ever read wrongly: rendered pictures of every difficulty.

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "core/calibration/board/board_checker.h"
#include "tests/core/calibration/board/board_scene.h"

namespace seamwright {
namespace {

using test::BoardScene;
using Draw = std::function<double()>;

struct BoardTally {
    int boards = 0, found = 0, wrong = 0, undecided = 0, asked = 0, misread = 0;
    double squares = 0, worst = 0;
    std::size_t corners = 0;
};

double pitch_px(const BoardScene& s) {
    return (test::seen_at(s, 1, 1) - test::seen_at(s, 0, 0)).norm() / std::sqrt(2.0);
}

// A cover of any place and direction over `share` of the corners at most.
void hide(BoardScene& s, double share, const Draw& u) {
    const Eigen::Vector2d at = test::seen_at(s, s.columns * u() - 0.5, s.rows * u() - 0.5);
    const double shape = 0.5 + 1.5 * u(), deg = 180 * u(), grey = 30 + 190 * u();
    std::array<double, 6> cover{at.x(), at.y(), 0, 0, deg, grey};
    for (double half = 5; half < 2000; half *= 1.03) {
        const std::array<double, 6> next{at.x(), at.y(), half * shape, half, deg, grey};
        int hidden = 0;
        for (int r = 0; r < s.rows; ++r)
            for (int c = 0; c < s.columns; ++c) {
                const Eigen::Vector2d p = test::seen_at(s, c, r);
                hidden += test::scene_detail::under(next, p.x(), p.y());
            }
        if (hidden > share * s.columns * s.rows) break;
        cover = next;
    }
    s.covers.push_back(cover);
}

void add_stripe(BoardScene& s, bool along_a_row, const Draw& u) {
    s.stripe_px = 3 + 12 * u();
    s.stripe_halo = 10 * u();
    s.stripe_deg = 180 * u();
    s.stripe_through = test::seen_at(s, (s.columns - 1) * u(), (s.rows - 1) * u());
    if (!along_a_row) return;
    const int row = static_cast<int>(u() * s.rows);
    const Eigen::Vector2d a = test::seen_at(s, 0, row), b = test::seen_at(s, s.columns - 1, row);
    s.stripe_through = 0.5 * (a + b);
    s.stripe_deg = std::atan2(b.y() - a.y(), b.x() - a.x()) * 180 / M_PI;
}

BoardTally run(const std::string& kind, int count) {
    static constexpr std::array<std::pair<int, int>, 8> sizes{
        {{7, 6}, {9, 6}, {11, 8}, {8, 6}, {6, 5}, {6, 6}, {7, 7}, {5, 4}}};
    BoardTally tally;
    for (int n = 0; n < count; ++n) {
        std::mt19937 random(static_cast<unsigned>(7919 * n + 31 * static_cast<int>(kind.size()) + kind[0]));
        std::uniform_real_distribution<double> uniform(0, 1);
        const Draw u = [&] { return uniform(random); };
        BoardScene s;
        s.width = 800, s.height = 640, s.focal = 950, s.seed = static_cast<unsigned>(n + 1);
        std::tie(s.columns, s.rows) = sizes[random() % sizes.size()];
        double tilt = 45 * u();
        if (kind == "tilted") tilt = 60;
        if (kind == "wide lens")
            s.focal = 565, s.k1 = -0.3, tilt = std::min(tilt, 40.0), s.vignette = 0.5 * u();
        // A cover leaves the board's edge in the picture.
        s = test::posed(s, tilt, kind.starts_with("hidden") ? 45 : 12, random);
        if (kind == "blurred") s.blur_px = std::min(1 + 2 * u(), pitch_px(s) / 12);
        if (kind == "dim") s.light = 0.1;
        if (kind == "noisy") s.noise = 5;
        if (kind == "stripe" || kind == "stripe on a row") add_stripe(s, kind != "stripe", u);
        if (kind == "hidden side") hide(s, 0.3, u);
        if (kind == "hidden") do {
                s.covers.clear();
                hide(s, 0.3, u);
            } while (!test::every_end_seen(s));
        if (kind == "reflections")
            for (int i = 0; i < 4; ++i) {
                const Eigen::Vector2d p = test::seen_at(s, s.columns * u(), s.rows * u());
                s.glints.push_back({p.x(), p.y(), pitch_px(s) * (0.1 + 0.4 * u())});
            }
        auto picture = test::render(s);
        BoardSpec spec;
        spec.columns = s.columns, spec.rows = s.rows, spec.pitch_mm = 10;
        const cv::Mat grey(picture.height, picture.width, CV_8U, picture.pixels.data());
        ++tally.boards;
        if (const auto found = detail::find_checker(grey, 255, spec); found.board) {
            if (const auto errors = test::errors_of(*found.board, s, picture)) {
                ++tally.found;
                for (const double e : errors->px) tally.squares += e * e;
                tally.corners += errors->px.size();
                tally.worst = std::max(tally.worst, errors->worst);
            } else {
                ++tally.wrong;
                ADD_FAILURE() << "wrong lattice: " << kind << " " << n;
            }
        } else {
            // A whole side hidden or cut off: nothing says that the board ends there.
            const bool seen = test::every_end_seen(s);
            tally.undecided += !seen;
            std::printf("not found: %s %d%s\n", kind.c_str(), n, seen ? "" : " (an end is not seen)");
        }
        // Asked for with its squares counted, and for other sizes.
        for (const auto& [c, r] : {std::pair{1, 1}, {1, 0}, {-1, 0}, {0, -1}}) {
            BoardSpec other = spec;
            other.columns += c, other.rows += r;
            if (other.columns < 3 || other.rows < 3 ||
                (other.columns == spec.rows && other.rows == spec.columns))
                continue;
            ++tally.asked;
            if (detail::find_checker(grey, 255, other).board) {
                ++tally.misread;
                std::printf("read as %dx%d: %s %d\n", other.columns, other.rows, kind.c_str(), n);
            }
        }
    }
    std::printf("%-16s %d of %d found, %d wrong, rms %.4f px, worst %.3f px\n", kind.c_str(), tally.found,
                tally.boards, tally.wrong, std::sqrt(tally.squares / static_cast<double>(tally.corners + 1)),
                tally.worst);
    return tally;
}

TEST(CheckerboardTrials, FoundAndNeverWrong) {
    int boards = 0, found = 0, undecided = 0, asked = 0, misread = 0;
    for (const char* kind : {"plain", "tilted", "blurred", "dim", "noisy", "stripe", "stripe on a row",
                             "hidden", "hidden side", "wide lens", "reflections"}) {
        const BoardTally t = run(kind, 20);
        boards += t.boards, found += t.found, undecided += t.undecided, asked += t.asked,
            misread += t.misread;
        EXPECT_EQ(t.wrong, 0) << kind;
        // Of a board with few corners little may be left beside a thing in front of it.
        const bool hidden = std::string(kind).starts_with("hidden");
        EXPECT_GE(t.found, (hidden ? 0.85 : 0.995) * (t.boards - t.undecided)) << kind;
    }
    // Where a whole side is covered or cut off nothing says how large the board is: those may be refused.
    std::printf(
        "%d of %d found, %d more with an end that is not seen; %d of %d questions for another size "
        "answered\n",
        found, boards, undecided, misread, asked);
    EXPECT_EQ(misread, 0);
}

}  // namespace
}  // namespace seamwright
