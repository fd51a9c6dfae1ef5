// The stripe among reflections that are as smooth, brighter, and of its own shape: by the frame alone, and with the taught
// contour. SEAMWRIGHT_TRIALS asks for more frames of each, SEAMWRIGHT_SEED for others, SEAMWRIGHT_SCENES for those that went
// wrong.

#include <gtest/gtest.h>

#include <cstdio>

#include "core/features/registration/taught_stripe.h"
#include "joints.h"

namespace seamwright::scenes {
namespace {

// What a camera delivers of a joint: the stripe, single false peaks, and over a part of its lines a reflection that is
// as smooth and brighter: a copy of the stripe beside it, or a line across. Of the lines under it the stripe may be lost
// on some.
enum class Ghost { none, beside, across, whole };
struct Frame {
    ProfileCandidates candidates;
    std::vector<double> ghost_z;  // per line; NaN: none
};
Frame frame_with(Ghost ghost, double lost, const std::vector<Sheet>& sheets, const SensorModel& s,
                 Dice& dice) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const Profile stripe = seen(sheets, s, dice);
    std::vector<double> x;
    for (int k = 0; k < s.points; ++k) x.push_back(-s.half_field() + s.pitch * (k + 0.5));
    const std::vector<double> clean = heights(sheets, x, s.steepest_deg);
    const auto n = static_cast<std::size_t>(s.points);
    Frame f;
    auto& c = f.candidates;
    c.lines = s.points, c.per_line = 3;
    c.count.assign(n, 0);
    c.x_mm.assign(3 * n, nan), c.z_mm = c.x_mm;
    c.intensity.assign(3 * n, 0.F);
    f.ghost_z.assign(n, nan);
    const double grey = dice.uniform(90, 140), wave = dice.uniform(0, 0.25), length = dice.uniform(5, 40);
    const double bright = grey * dice.uniform(1.2, 2.2),
                 shift = (dice.chance(0.5) ? 1 : -1) * dice.spread(0.8, 8);
    const double slope = dice.uniform(-0.3, 0.3), bow = dice.uniform(-0.004, 0.004);
    const auto lines =
        ghost == Ghost::whole ? n : static_cast<std::size_t>(dice.uniform(0.15, 0.6) * double(n));
    const auto from = static_cast<std::size_t>(dice.uniform(0, double(n - lines)));
    double middle = 0, last = 0;
    for (std::size_t k = from + lines / 2; k < n && middle == 0; ++k)
        if (std::isfinite(clean[k])) middle = last = clean[k];
    for (std::size_t k = 0; k < n; ++k) {
        const auto put = [&](double z, double light) {
            const std::size_t slot = 3 * k + c.count[k]++;
            c.x_mm[slot] = x[k], c.z_mm[slot] = z, c.intensity[slot] = float(light);
        };
        const bool in = ghost != Ghost::none && k >= from && k < from + lines;
        if (std::isfinite(stripe.z_mm[k]) && !(in && dice.chance(lost)))
            put(stripe.z_mm[k],
                grey * (1 + wave * std::sin(6.28 * x[k] / length)) * (1 + 0.08 * dice.normal()));
        if (in) {
            if (std::isfinite(clean[k])) last = clean[k];
            const double u = x[k] - x[from + lines / 2];
            f.ghost_z[k] =
                (ghost != Ghost::across ? last + shift : middle + shift + slope * u + bow * u * u) +
                s.noise * dice.normal();
            put(f.ghost_z[k], bright * (1 + 0.05 * dice.normal()));
        }
        if (dice.chance(0.03)) put(dice.uniform(-30, 30), dice.uniform(30, 120));
    }
    return f;
}

struct Tally {
    int right = 0, refused = 0, wrong = 0;
    void add(const Registration& r, double off_mm) {
        ++(r.status != RegistrationStatus::ok ? refused : off_mm < 0.5 ? right : wrong);
    }
};

constexpr JointMaker kMakers[] = {kJoints[0], kJoints[1], kJoints[2], kJoints[4],
                                  kJoints[5], kJoints[7], kJoints[10]};

TEST(Ghosts, TheTaughtContourTellsThemFromTheStripe) {
    struct Row {
        Ghost ghost;
        const char* name;
        double lost, least_right, most_wrong;
    };
    const Row rows[] = {{Ghost::none, "no ghost", 0, 0.995, 0},
                        {Ghost::beside, "a copy beside it", 0, 0.985, 0.003},
                        {Ghost::beside, "a copy, stripe lost on 30 %", 0.3, 0.95, 0.012},
                        {Ghost::across, "a line across", 0, 0.985, 0.001},
                        {Ghost::across, "a line, stripe lost on 30 %", 0.3, 0.96, 0.003},
                        // Nothing in a frame says which of two whole contours it is.
                        {Ghost::whole, "a copy as long as the field", 0, 0, 0.002}};
    std::printf("%-30s %27s   %s\n", "", "by the frame alone", "with what was taught");
    for (const Row& row : rows) {
        Dice dice(seed_of(103));
        Tally alone, taught_too;
        int lost_to_it = 0;
        const int trials = trials_of(120);
        for (int i = 0; i < trials; ++i) {
            const Joint joint = kMakers[dice.of(std::size(kMakers))](dice);
            SensorModel s;
            s.points = 800 + 240 * dice.of(3);
            s.pitch = dice.uniform(0.05, 0.1), s.noise = dice.spread(0.01, 0.04);
            s.grid = Grid::exact, s.missing = 0.01, s.steepest_deg = 80;
            Profile whole = seen(joint.sheets, s, dice);
            Profile piece;
            for (std::size_t k = 0; k < whole.size(); ++k)
                if (whole.x_mm[k] >= joint.from_x && whole.x_mm[k] <= joint.to_x)
                    piece.x_mm.push_back(whole.x_mm[k]), piece.z_mm.push_back(whole.z_mm[k]);
            const Vector2d mark(1, -1), shift(dice.uniform(-3, 3), dice.uniform(-3, 3));
            const double turn = rad(dice.uniform(-2, 2));
            const Vector2d d = mark + shift - turned(mark, turn);
            const PlanarMotion truth{d.x(), d.y(), turn};
            const Frame f = frame_with(row.ghost, row.lost, moved(joint.sheets, truth), s, dice);
            ASSERT_TRUE(filter_profile(piece, {}) && filter_profile(whole, {}));
            auto matcher = ContourMatcher::make(piece, mark);
            ASSERT_TRUE(matcher);
            SearchWindow window;
            window.dx_mm = window.dz_mm = 6, window.phi_rad = 0.1;
            auto taught = TaughtStripe::make(whole, mark, window);
            ASSERT_TRUE(taught);
            Profile tracked;
            const auto off = [&](const Registration& r) {
                return (r.scene_from_template * mark - truth * mark).norm();
            };
            ASSERT_TRUE(track_stripe(f.candidates, {}, tracked));
            const Registration by_frame = matcher->match(tracked, window);
            alone.add(by_frame, off(by_frame));
            const auto choice = taught->track(f.candidates, {}, tracked);
            ASSERT_TRUE(choice);
            Registration told = matcher->match(tracked, window);
            if (*choice == StripeChoice::undecided) told.status = RegistrationStatus::ambiguous;
            taught_too.add(told, off(told));
            const bool was_right = by_frame.status == RegistrationStatus::ok && off(by_frame) < 0.5;
            lost_to_it += was_right && told.status != RegistrationStatus::ok;
            if (told_of_each() && ((told.status == RegistrationStatus::ok && off(told) >= 0.5) ||
                                   (row.ghost != Ghost::whole && told.status != RegistrationStatus::ok)))
                std::printf("  %d %s: choice %d, %s, %.2f off; alone %s, %.2f off\n", i, joint.name,
                            int(*choice), std::string(to_string(told.status)).c_str(), off(told),
                            std::string(to_string(by_frame.status)).c_str(), off(by_frame));
        }
        std::printf(
            "%-30s right %4d refused %4d wrong %3d   right %4d refused %4d wrong %3d; refused now %d\n",
            row.name, alone.right, alone.refused, alone.wrong, taught_too.right, taught_too.refused,
            taught_too.wrong, lost_to_it);
        EXPECT_GE(taught_too.right, row.least_right * trials) << row.name;
        EXPECT_LE(taught_too.wrong, row.most_wrong > 0 ? 1 + row.most_wrong * trials : 0) << row.name;
        if (row.ghost != Ghost::whole) {
            EXPECT_LE(lost_to_it, 1 + 0.003 * trials) << row.name;
        }
    }
}

}  // namespace
}  // namespace seamwright::scenes
